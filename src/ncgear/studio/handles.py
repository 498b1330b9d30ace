"""Points of the charts that can be dragged: where each one is, and which key of the design it moves, by how much.

A handle has a place on a chart of ``motion_charts``: the driving angle in degrees and the chart's value, both at the
operating speed.  Along each axis it may move one key: ``key = base + factor * (coordinate - at)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import Any

import numpy as np

from ncgear.design.keys.base import FULL_TURN
from ncgear.design.laws.base import LawPoint
from ncgear.drawings.charts.slider_charts import Quantity
from ncgear.kinematics.motion import sample_angles
from ncgear.numerics.arrays import Array
from ncgear.numerics.zeros import zeros_between
from ncgear.project.drive import Drive

Handle = dict[str, Any]

MOST_HANDLES = 60
"""Points of a table or a spline that can be dragged; more could not be told apart on a chart."""


def handles(drive: Drive) -> list[Handle]:
    """The handles of a drive's law and of its wishes.

    Each has ``name``, ``chart`` (key of a chart), ``x`` in deg, ``y`` in the chart's unit, and ``moves``: for ``x`` and
    ``y``, where they move something, the ``key``, its value ``base`` at that place, its ``factor``, and its ``unit``.
    """
    return [*_of_points(drive), *_of_wishes(drive)]


def _of_points(drive: Drive) -> Iterator[Handle]:
    points = drive.design.motion.law_points
    if not 0 < len(points) <= MOST_HANDLES:
        return
    angles_rad = _driving_rad(drive, points)
    motion = drive.machine.motion(angles_rad)
    for place, point in enumerate(points):
        quantity = Quantity[point.quantity.upper()]
        shown = float(quantity.values(motion, drive.linkage.OUTPUT)[place])
        yield _of_point(drive, point, quantity, degrees(angles_rad[place]), shown)


def _of_point(drive: Drive, point: LawPoint, quantity: Quantity, angle_deg: float, shown: float) -> Handle:
    """The handle of a point of the law, which has a value on its chart."""
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
            "factor": _factor(drive, point, shown),
            "unit": quantity.unit_of(drive.linkage.OUTPUT).text,
        }
    return _handle(drive, point.name, quantity, (angle_deg, shown), moves)


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


def _driving_rad(drive: Drive, points: Sequence[LawPoint]) -> Array:
    """The driving angles of points in rad, shape (n,)."""
    if all(point.driven_share is None for point in points):
        return np.array([point.phi1_rad for point in points])
    law = drive.transmission
    driven = law.lobes.driven_period_rad * np.array([point.driven_share for point in points])
    end = np.full(driven.shape, law.lobes.driving_period_rad)
    return zeros_between(lambda phi1: law.driven_angle(phi1).value - driven, np.zeros(driven.shape), end)


def _of_wishes(drive: Drive) -> Iterator[Handle]:
    """Places of wishes along the displacement, their speeds along the speed, where the output is on its way out."""
    wished = list(_wished(drive)) if drive.linkage.RETURNS else []
    if not wished:
        return
    motion = drive.machine.motion(sample_angles(drive.transmission))
    out = drive.machine.working(motion.phi2_rad)
    displacement, angle_deg = drive.linkage.OUTPUT.place.factor * motion.displacement[out], np.degrees(motion.phi1_rad)
    for name, place, quantity, key, value in wished:
        nearest = int(np.argmin(np.abs(displacement - place)))
        unit = quantity.unit_of(drive.linkage.OUTPUT).text
        moves = {"y": {"key": f"wishes.{key}", "base": value, "factor": 1.0, "unit": unit}}
        yield _handle(drive, name, quantity, (float(angle_deg[out][nearest]), value), moves)


def _wished(drive: Drive) -> Iterator[tuple[str, float, Quantity, str, float]]:
    """Name, place of the output, quantity, key below ``wishes`` and value of each handle."""
    output, wishes = drive.linkage.OUTPUT, drive.design.wishes
    place, speed = output.place.ending, output.speed.ending
    for number, wish in enumerate(wishes.constant_speed):
        group, ends = f"constant_speed.{number}", [getattr(wish, f"{end}_{place}") for end in ("from", "to")]
        for end, at in zip(("from", "to"), ends, strict=True):
            yield f"even speed {end}", at, Quantity.DISPLACEMENT, f"{group}.{end}_{place}", at
        if (wanted := getattr(wish, f"speed_{speed}")) is not None:
            yield "even speed", sum(ends) / 2.0, Quantity.VELOCITY, f"{group}.speed_{speed}", wanted
    for number, passed in enumerate(wishes.speed_at):
        group, at = f"speed_at.{number}", getattr(passed, f"at_{place}")
        yield "speed at", at, Quantity.DISPLACEMENT, f"{group}.at_{place}", at
        for bound in ("at_least", "at_most"):
            if (value := getattr(passed, f"{bound}_{speed}")) is not None:
                yield bound.replace("_", " "), at, Quantity.VELOCITY, f"{group}.{bound}_{speed}", value


def _handle(drive: Drive, name: str, quantity: Quantity, at: tuple[float, float], moves: dict[str, Any]) -> Handle:
    chart = quantity.key_of(drive.linkage.OUTPUT)
    return {"name": name, "chart": chart, "x": at[0], "y": at[1], "moves": moves}
