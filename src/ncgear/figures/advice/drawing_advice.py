"""Remarks about a contour that is drawn: its unit is not the one of its file, or its parts do not quite meet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ncgear.design.keys.pitch_shapes import UNIT_MM, DxfContour
from ncgear.figures.advice.values import Advice, Kind, Where
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive
from ncgear.ratio.laws.closed_curve import JOINED


def drawing(drive: Drive) -> Iterator[Advice]:
    """The size by both units, and the greatest gap between parts that count as joined."""
    given, facts = drive.design.motion.contour, drive.law.facts
    gap_mm, *sides_mm = (float(facts[f"contour_{name}_mm"] or 0.0) for name in ("gap", "width", "height"))
    if isinstance(given, DxfContour) and given.drawn_in not in (None, given.unit):
        yield _of_unit(given, given.drawn_in or "", sides_mm)
    if gap_mm > JOINED * max(sides_mm):
        yield _remark(
            f"parts of the contour miss each other by up to {to_digits(gap_mm, 2)} mm, as its rounded numbers do",
            "they are put together",
        )


def _of_unit(given: DxfContour, drawn_in: str, sides_mm: Sequence[float]) -> Advice:
    """That the drawing names another unit, with the size by both."""

    def size(unit: str) -> str:
        return " by ".join(to_digits(UNIT_MM[unit] / given.unit_mm * one, 3) for one in sides_mm) + " mm"

    return _remark(
        f"the drawing names {drawn_in} as its unit, and motion.dxf.unit is {given.unit}",
        f"the contour is taken as about {size(given.unit)}; in {drawn_in} it would be {size(drawn_in)}",
    )


def _remark(what: str, so: str) -> Advice:
    return Advice(Kind.DRAWING, (Where(),), what, so, matters=False, brief=f"{what}: {so}")
