"""Points of the charts that can be dragged: where each one is, and which key of the design it moves, by how much.

A handle has a place on a chart of ``motion_charts``: the driving angle in degrees and the chart's value, both at the
operating speed.  Along each axis it may move one key: ``key = base + factor * (coordinate - at)``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import degrees, pi
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ncgear.design.keys.base import FULL_TURN, given, spellings
from ncgear.design.laws.registry import LawName
from ncgear.design.laws.spline_ratio import SplineRatio
from ncgear.design.laws.table import VALUE_COLUMNS, TableLaw
from ncgear.design.laws.three_segment_stroke import ThreeSegmentStroke
from ncgear.drawings.charts.slider_charts import Quantity
from ncgear.project.drive import Drive

Handle = dict[str, Any]

MOST_HANDLES = 60
"""Points of a table or a spline that can be dragged; more could not be told apart on a chart."""


def handles(drive: Drive) -> list[Handle]:
    """The handles of a drive's law and of its wishes.

    Each has ``name``, ``chart`` (key of a chart), ``x`` in deg, ``y`` in the chart's unit, and ``moves``: for ``x`` and
    ``y``, where they move something, the ``key``, its value ``base`` at that place, its ``factor``, and its ``unit``.
    """
    of_law = OF_LAWS.get(LawName(drive.design.motion.law))
    found = list(of_law(drive)) if of_law else []
    return [*(found if len(found) <= MOST_HANDLES else []), *_of_wishes(drive)]


def _three_segments(drive: Drive) -> Iterator[Handle]:
    """theta1 to theta4 along the angle; v1 and v2, and a1 where it is given, along speed and acceleration."""
    motion = drive.design.motion
    assert isinstance(motion, ThreeSegmentStroke)
    speed = drive.linkage.OUTPUT.speed
    for name, along in (("theta1", "v1"), ("theta2", "v2"), ("theta3", "v2"), ("theta4", "")):
        angle_key = given(motion, spellings(name))[0]
        unit = angle_key.rpartition("_")[2]
        angle_deg = degrees(getattr(motion, name))
        moves = {
            "x": {
                "key": f"motion.{angle_key}",
                "base": getattr(motion, angle_key),
                "factor": FULL_TURN[unit] / 360.0,
                "unit": {"pi": "pi", "deg": "\u00b0", "rad": "rad"}[unit],
            }
        }
        value = getattr(motion, f"{along}_{speed.ending}") if along else None
        if value is not None:
            factor = drive.law_speed_rpm / drive.design.operation.speed_rpm
            moves["y"] = {"key": f"motion.{along}_{speed.ending}", "base": value, "factor": factor, "unit": speed.text}
        yield _handle(drive, f"{name}, {along}" if along else name, Quantity.VELOCITY, angle_deg, moves)
    acceleration = drive.linkage.OUTPUT.acceleration
    given_a1 = getattr(motion, f"a1_{acceleration.ending}")
    if given_a1 is not None:
        speeds = drive.design.operation.speed_rpm, motion.a1_speed_rpm or drive.law_speed_rpm
        key, factor = f"motion.a1_{acceleration.ending}", (speeds[1] / speeds[0]) ** 2
        moves = {"y": {"key": key, "base": given_a1, "factor": factor, "unit": acceleration.text}}
        # Just before the return, which may begin with another acceleration.
        yield _handle(drive, "a1", Quantity.ACCELERATION, degrees(motion.theta4) - 1e-6, moves)


def _table(drive: Drive) -> Iterator[Handle]:
    """Every point of a table that stands in the design file."""
    motion = drive.design.motion
    assert isinstance(motion, TableLaw)
    if motion.file is not None:
        return
    key = given(motion, VALUE_COLUMNS)[0]
    quantity = Quantity.RATIO if key == "ratio" else Quantity.DISPLACEMENT
    for place, (angle, value) in enumerate(zip(motion.phi1, getattr(motion, key), strict=True)):
        shown = _value_at(drive, quantity, degrees(angle))
        factor = value / shown if quantity is Quantity.RATIO else 1.0
        moves = {"y": {"key": f"motion.{key}.{place}", "base": value, "factor": factor, "unit": ""}}
        yield _handle(drive, f"point {place + 1}", quantity, degrees(angle), moves)


def _spline(drive: Drive) -> Iterator[Handle]:
    """Every point of a spline of the ratio, at the driving angle at which the driven one is that of the point."""
    motion = drive.design.motion
    assert isinstance(motion, SplineRatio)
    keys = given(motion, spellings("driven_angle"))
    count = len(motion.ratio)
    if motion.second_stage is not None or count > MOST_HANDLES:
        return
    shares = [value / FULL_TURN[keys[0].rpartition("_")[2]] for value in getattr(motion, keys[0])] if keys else None
    law = drive.transmission
    for place, value in enumerate(motion.ratio):
        driven = law.lobes.driven_period_rad * (shares[place] if shares else place / count)

        def beyond(phi1: float, driven: float = driven) -> float:
            return float(law.driven_angle(np.array([phi1])).value[0]) - driven

        phi1_deg = degrees(brentq(beyond, 0.0, law.lobes.driving_period_rad)) if driven > 0.0 else 0.0
        shown = _value_at(drive, Quantity.RATIO, phi1_deg)
        moves = {"y": {"key": f"motion.ratio.{place}", "base": value, "factor": value / shown, "unit": ""}}
        yield _handle(drive, f"point {place + 1}", Quantity.RATIO, phi1_deg, moves)


OF_LAWS: dict[LawName, Callable[[Drive], Iterator[Handle]]] = {
    LawName.THREE_SEGMENT_STROKE: _three_segments,
    LawName.TABLE: _table,
    LawName.SPLINE_RATIO: _spline,
}
"""The laws with points that can be dragged; the values of others are numbers."""


def _of_wishes(drive: Drive) -> Iterator[Handle]:
    """Places of wishes along the displacement, their speeds along the speed."""
    output = drive.linkage.OUTPUT
    if not drive.linkage.RETURNS:
        return
    place, speed = output.place, output.speed
    for number, wish in enumerate(drive.design.wishes.constant_speed):
        for end in ("from", "to"):
            key = f"{end}_{place.ending}"
            yield from _along_stroke(drive, f"even speed {end}", f"constant_speed.{number}.{key}", getattr(wish, key))
        wanted = getattr(wish, f"speed_{speed.ending}")
        if wanted is not None:
            middle = (getattr(wish, f"from_{place.ending}") + getattr(wish, f"to_{place.ending}")) / 2.0
            moves = _moved(f"wishes.constant_speed.{number}.speed_{speed.ending}", wanted, speed.text)
            yield {**_at_place(drive, "even speed", middle, Quantity.VELOCITY, moves), "y": wanted}
    for number, at in enumerate(drive.design.wishes.speed_at):
        key = f"at_{place.ending}"
        yield from _along_stroke(drive, "speed at", f"speed_at.{number}.{key}", getattr(at, key))
        for bound in ("at_least", "at_most"):
            value = getattr(at, f"{bound}_{speed.ending}")
            if value is not None:
                moves = _moved(f"wishes.speed_at.{number}.{bound}_{speed.ending}", value, speed.text)
                name = bound.replace("_", " ")
                yield {**_at_place(drive, name, getattr(at, key), Quantity.VELOCITY, moves), "y": value}


def _along_stroke(drive: Drive, name: str, key: str, value: float) -> Iterator[Handle]:
    unit = drive.linkage.OUTPUT.place.text
    yield _at_place(drive, name, value, Quantity.DISPLACEMENT, _moved(f"wishes.{key}", value, unit))


def _moved(key: str, value: float, unit: str) -> dict[str, Any]:
    return {"y": {"key": key, "base": value, "factor": 1.0, "unit": unit}}


def _at_place(drive: Drive, name: str, place: float, quantity: Quantity, moves: dict[str, Any]) -> Handle:
    """A handle where the output is at a place of its way out, in the unit of its displacement."""
    output, motion = drive.linkage.OUTPUT, drive.motion
    out = drive.machine.working(motion.phi2_rad)
    displacement = output.place.factor * motion.displacement[out]
    nearest = int(np.argmin(np.abs(displacement - place)))
    made = _handle(drive, name, quantity, degrees(float(motion.phi1_rad[out][nearest])), moves)
    return {**made, "y": place} if quantity is Quantity.DISPLACEMENT else made


def _handle(drive: Drive, name: str, quantity: Quantity, angle_deg: float, moves: dict[str, Any]) -> Handle:
    return {
        "name": name,
        "chart": quantity.key_of(drive.linkage.OUTPUT),
        "x": angle_deg,
        "y": _value_at(drive, quantity, angle_deg),
        "moves": moves,
    }


def _value_at(drive: Drive, quantity: Quantity, angle_deg: float) -> float:
    motion = drive.machine.motion(np.array([angle_deg * pi / 180.0]))
    return float(quantity.values(motion, drive.linkage.OUTPUT)[0])
