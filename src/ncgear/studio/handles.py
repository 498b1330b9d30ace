"""Points of the charts that can be dragged: where each one is, and which key of the design it moves, by how much.

A handle has a place on a chart of ``motion_charts``: the driving angle in degrees and the chart's value, both at the
operating speed.  Along each axis it may move one key: ``key = base + factor * (coordinate - at)``.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, pi
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ncgear.design.keys.base import FULL_TURN
from ncgear.design.laws.base import LawPoint
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
    points = drive.design.motion.law_points
    return [*(_of_point(drive, point) for point in points if len(points) <= MOST_HANDLES), *_of_wishes(drive)]


def _of_point(drive: Drive, point: LawPoint) -> Handle:
    """The handle of a point of the law."""
    quantity = Quantity[point.quantity.upper()]
    angle_deg = degrees(_driving_rad(drive, point))
    moves: dict[str, Any] = {}
    if point.angle_key:
        unit = point.angle_key.rpartition("_")[2]
        # Per degree of the chart, the part of a turn in the unit of the key.
        factor = FULL_TURN[unit] / 360.0
        moves["x"] = {
            "key": f"motion.{point.angle_key}",
            "base": getattr(drive.design.motion, point.angle_key),
            "factor": factor,
            "unit": {"pi": "pi", "deg": "\u00b0", "rad": "rad"}[unit],
        }
    if point.value_key:
        moves["y"] = {
            "key": f"motion.{point.value_key}",
            "base": point.value,
            "factor": _factor(drive, point, _value_at(drive, quantity, angle_deg)),
            "unit": quantity.unit_of(drive.linkage.OUTPUT).text,
        }
    return _handle(drive, point.name, quantity, angle_deg, moves)


def _factor(drive: Drive, point: LawPoint, shown: float) -> float:
    """The value of a point's key per value on the chart: other speed of the machine, other common factor."""
    faster = (point.speed_rpm or drive.law_speed_rpm) / drive.design.operation.speed_rpm
    match point.quantity:
        case "velocity":
            return faster
        case "acceleration":
            return faster**2
        case "ratio":
            return point.value / shown
    return 1.0


def _driving_rad(drive: Drive, point: LawPoint) -> float:
    """The driving angle of a point in rad."""
    if point.driven_share is None:
        assert point.phi1_rad is not None
        return point.phi1_rad
    law = drive.transmission
    driven = law.lobes.driven_period_rad * point.driven_share
    if driven == 0.0:
        return 0.0
    end = law.lobes.driving_period_rad
    return float(brentq(lambda phi1: float(law.driven_angle(np.array([phi1])).value[0]) - driven, 0.0, end))


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
