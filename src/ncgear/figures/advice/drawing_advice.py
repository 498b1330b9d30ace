"""Remarks about a contour that is drawn: its unit is not the one of its file, or its parts do not quite meet."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ncgear.design.keys.pitch_shapes import UNIT_MM, DxfContour
from ncgear.design.laws.pitch_curve import PitchCurve
from ncgear.figures.advice.values import Advice, Kind, Where
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive
from ncgear.ratio.laws.closed_curve import JOINED


def contour_of(drive: Drive) -> DxfContour | None:
    """The contour of a DXF file that the design names; None where it names none."""
    motion = drive.design.motion
    return motion.dxf if isinstance(motion, PitchCurve) else None


def drawing(drive: Drive) -> Iterator[Advice]:
    """The size by both units, and the greatest gap between parts that count as joined."""
    given = contour_of(drive)
    assert given is not None
    sides_mm = _sides_mm(given)

    def size(unit: str) -> str:
        by_unit = UNIT_MM[unit] / UNIT_MM[given.unit]
        return " by ".join(to_digits(by_unit * side_mm, 3) for side_mm in sides_mm) + " mm"

    if given.drawn_in is not None and given.drawn_in != given.unit:
        yield _remark(
            f"the drawing names {given.drawn_in} as its unit, and motion.dxf.unit is {given.unit}",
            f"the contour is taken as about {size(given.unit)}; in {given.drawn_in} it would be {size(given.drawn_in)}",
        )
    gap_mm = drive.law.facts["contour_gap_mm"]
    assert isinstance(gap_mm, float)
    if gap_mm > JOINED * max(sides_mm):
        yield _remark(
            f"parts of the contour miss each other by up to {to_digits(gap_mm, 2)} mm, as its rounded numbers do",
            "they are put together",
        )


PER_PART = 33
"""Points of a smooth part by which the size of a drawing is told, to three digits."""


def _sides_mm(given: DxfContour) -> tuple[float, float]:
    """Width and height of the contour in mm."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for curve in given.contour()[0]:
        for part in curve.smooth_parts():
            x, y = part.at(np.linspace(part.breaks[0], part.breaks[-1], PER_PART), 0)
            points = np.stack([x.value, y.value])
            low, high = np.minimum(low, points.min(axis=1)), np.maximum(high, points.max(axis=1))
    width, height = high - low
    return float(width), float(height)


def _remark(what: str, so: str) -> Advice:
    return Advice(Kind.DRAWING, (Where(),), what, so, matters=False, brief=f"{what}: {so}")
