"""Points of the charts that can be dragged: the place of each, the key of the design that it moves, and by how much.

A handle has a place on a chart of ``motion_charts``: the driving angle in degrees and the chart's value, both at the
operating speed.  Along each axis it may move one key, ``key = base + factor * (coordinate - at)``, and others with it.
Of dense points only some have a handle, which also moves the points beside it.  A point of a series moves its
coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import cos, degrees, pi, radians
from typing import Any, NamedTuple

import numpy as np

from ncgear.design.keys.base import FULL_TURN, given
from ncgear.design.laws.base import DraggedPoint, LawNumber
from ncgear.design.wishes.gentle_stop import GentleStop
from ncgear.design.words import spellings
from ncgear.drawings.charts.chart import Quantity
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import sample_angles
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.project.law import law_of
from ncgear.ratio.transmission import Transmission

Handle = dict[str, Any]

MOST_HANDLES = 60
"""Most points of a table or a spline that have a handle each; more could not be told apart on a chart."""

THINNED = (18, 36, MOST_HANDLES)
"""Numbers of handles for more points than that; the first of them at which no handle moves too many points is taken."""

MOST_TAKEN_ALONG = 180
"""Most points that one handle moves; a message to the studio changes up to 200 keys."""


def handles(drive: Drive) -> list[Handle]:
    """The handles of a drive's law and of its wishes.

    Each has ``name``, ``chart`` (key of a chart), ``x`` in deg, ``y`` in the chart's unit, and ``moves``: for ``x`` and
    ``y``, if they move a key, the ``key``, its value ``base`` at that place, its ``factor``, and its ``unit``.  A key
    within a formula has ``text``, the text before and after its number.  A move may have, instead of a key, ``along``:
    other keys that change from their ``base``, a number or a list, by ``sum`` times the step, by the growth to the
    ``power``, or by ``log`` times the logarithm of the growth.
    """
    points = drive.design.motion.law_points
    if not points:
        return [*(_of_number(drive, grip) for grip in grips(drive)), *_of_wishes(drive)]
    if len(points) <= MOST_HANDLES:
        return [*(_of_point(drive, *point) for point in _placed(drive, points)), *_of_wishes(drive)]
    return [*_of_few(drive, points), *_of_wishes(drive)]


def _of_few(drive: Drive, points: Sequence[DraggedPoint]) -> Iterator[Handle]:
    """Handles of some of the points, evenly spread over the driving angle; after the last handle comes the first.

    A point between two handles moves with each by the square of a cosine of its distance from it.  So all points move
    alike where all handles do, and the moved curve gets no new corner.  Ratios move by a common power.
    """
    count = len(points)
    if count > MOST_HANDLES * MOST_TAKEN_ALONG:
        return
    law, lobes = drive.transmission, drive.transmission.lobes
    over_driven = points[0].driven_share is not None
    at = np.array([point.driven_share if over_driven else point.phi1_rad for point in points])
    for number in THINNED:
        even = np.linspace(0.0, lobes.driving_period_rad, number, endpoint=False)
        wanted = law.driven_angle(even).value / lobes.driven_period_rad if over_driven else even
        places: list[int] = np.unique(np.argmin(np.abs(at - wanted[:, None]), axis=1)).tolist()
        places.append(places[0] + count)
        if max(after - before for before, after in pairwise(places)) <= MOST_TAKEN_ALONG // 2:
            break
    else:
        return
    placed = _placed(drive, [points[place] for place in places[:-1]])
    for drawn, before, place, after in zip(placed, [places[-2] - count, *places], places, places[1:], strict=False):
        made = _of_point(drive, *drawn)
        by = "power" if points[place].quantity == "ratio" else "sum"
        along = []
        for near in (*range(before + 1, place), *range(place + 1, after)):
            way = (near - place) / (after - place) if near > place else (place - near) / (place - before)
            other = points[near % count]
            along.append({"key": f"motion.{other.value_key}", "base": other.value, by: cos(pi / 2.0 * way) ** 2})
        made["moves"]["y"]["along"] = along
        yield made


def _placed(drive: Drive, points: Sequence[DraggedPoint]) -> list[tuple[DraggedPoint, float, float]]:
    """Each point with its driving angle in deg and the value of its quantity there."""
    period = drive.transmission.lobes.driven_period_rad
    shares = np.array([point.driven_share or 0.0 for point in points])
    angles = np.array([point.phi1_rad or 0.0 for point in points])
    turned = shares > 0.0
    angles[turned] = drive.machine.driving_angles(period * shares[turned])
    motion, output = drive.machine.motion(angles), drive.linkage.OUTPUT
    values = {name: Quantity[name.upper()].values(motion, output) for name in {point.quantity for point in points}}
    return [
        (point, degrees(angle), float(values[point.quantity][row]))
        for row, (point, angle) in enumerate(zip(points, angles.tolist(), strict=True))
    ]


def _of_point(drive: Drive, point: DraggedPoint, angle_deg: float, shown: float) -> Handle:
    """The handle of a point of the law."""
    quantity = Quantity[point.quantity.upper()]
    moves: dict[str, Any] = {}
    if point.angle_key:
        base, unit = getattr(drive.design.motion, point.angle_key), point.angle_key.rpartition("_")[2]
        moves["x"] = _along_angle(f"motion.{point.angle_key}", base, unit)
    if point.value_key:
        moves["y"] = {
            "key": f"motion.{point.value_key}",
            "base": point.value,
            "factor": _factor(drive, point, shown),
            "unit": quantity.unit_of(drive.linkage.OUTPUT).text,
        }
    if point.coefficients:
        along = [{"key": f"motion.{key}", "base": base, "log": by} for key, base, by in point.coefficients]
        moves["y"] = {"key": "", "base": shown, "factor": 1.0, "unit": "", "along": along}
    return _handle(drive, point.name, quantity, (angle_deg, shown), moves)


def _of_number(drive: Drive, grip: Grip) -> Handle:
    """The handle of a number in the law."""
    number = grip.number
    move: dict[str, Any] = {"key": f"motion.{number.key}", "base": number.value, "factor": grip.factor, "unit": ""}
    if number.before or number.after:
        move["text"] = [number.before, number.after]
    motion = drive.machine.motion(np.array([radians(grip.angle_deg)]))
    shown = float(Quantity.RATIO.values(motion, drive.linkage.OUTPUT)[0])
    return _handle(drive, number.name, Quantity.RATIO, (grip.angle_deg, shown), {"y": move})


def _factor(drive: Drive, point: DraggedPoint, shown: float) -> float:
    """The change of a point's key per change on the chart, for the speed of the machine and a common factor."""
    faster = (point.speed_rpm or drive.law_speed_rpm) / drive.design.operation.speed_rpm
    match point.quantity:
        case "velocity":
            return faster
        case "acceleration":
            return faster**2
        case "ratio":
            return point.value / shown
    return 1.0


class WishHandle(NamedTuple):
    """A handle of a wish: its key below ``wishes`` and the key's value, which is moved along ``quantity``.

    It is placed where the output passes a place of a stroke, or at a driving angle in rad, with ``sign`` times the
    value on the chart.  An angle's handle has its ``unit``, moves along the driving angle, and is placed at ``shown``.
    """

    name: str
    quantity: Quantity
    key: str
    value: float
    place: float = 0.0
    returning: bool = False
    sign: float = 1.0
    angle_rad: float | None = None
    unit: str = ""
    shown: float = 0.0


def _of_wishes(drive: Drive) -> Iterator[Handle]:
    """Handles of wishes: places along the displacement, bounds along speed or acceleration, angles along angles."""
    wished = list(_wished(drive)) if drive.linkage.RETURNS else []
    if not wished:
        return
    motion, output = drive.machine.motion(sample_angles(drive.transmission)), drive.linkage.OUTPUT
    working, angle_deg = drive.machine.working(motion.phi2_rad), np.degrees(motion.phi1_rad)
    displacement, cycle = output.place.factor * motion.displacement, drive.transmission.cycle_rad
    for wish in wished:
        key, stroke = f"wishes.{wish.key}", ~working if wish.returning else working
        if wish.angle_rad is not None:
            at_deg = degrees(wish.angle_rad % cycle)
        else:
            at_deg = float(angle_deg[stroke][np.argmin(np.abs(displacement[stroke] - wish.place))])
        if wish.unit:
            moves, shown = {"x": _along_angle(key, wish.value, wish.unit)}, wish.shown
        else:
            text, shown = wish.quantity.unit_of(output).text, wish.sign * wish.value
            moves = {"y": {"key": key, "base": wish.value, "factor": wish.sign, "unit": text}}
        yield _handle(drive, wish.name, wish.quantity, (at_deg, shown), moves)


def _wished(drive: Drive) -> Iterator[WishHandle]:
    """The handles of all wishes that have places or bounds."""
    output, wishes = drive.linkage.OUTPUT, drive.design.wishes
    place, speed = output.place.ending, output.speed.ending
    for number, wish in enumerate(wishes.constant_speed):
        group, ends = f"constant_speed.{number}", [getattr(wish, f"{end}_{place}") for end in ("from", "to")]
        back = wish.stroke == "return"
        for end, at in zip(("from", "to"), ends, strict=True):
            yield WishHandle(f"even speed {end}", Quantity.DISPLACEMENT, f"{group}.{end}_{place}", at, at, back)
        if (wanted := getattr(wish, f"speed_{speed}")) is not None:
            key, middle = f"{group}.speed_{speed}", sum(ends) / 2.0
            yield WishHandle("even speed", Quantity.VELOCITY, key, wanted, middle, back, -1.0 if back else 1.0)
    for number, passed in enumerate(wishes.speed_at):
        group, at, back = f"speed_at.{number}", getattr(passed, f"at_{place}"), passed.stroke == "return"
        yield WishHandle("speed at", Quantity.DISPLACEMENT, f"{group}.at_{place}", at, at, back)
        for bound in ("at_least", "at_most"):
            if (value := getattr(passed, f"{bound}_{speed}")) is not None:
                key, sign = f"{group}.{bound}_{speed}", -1.0 if back else 1.0
                yield WishHandle(bound.replace("_", " "), Quantity.VELOCITY, key, value, at, back, sign)
    for number, gentle in enumerate(wishes.gentle_stop):
        yield from _gentle(drive, f"gentle_stop.{number}", gentle)


def _gentle(drive: Drive, group: str, wish: GentleStop) -> Iterator[WishHandle]:
    """The given ends of a gentle stretch, and its bound in the middle."""
    output, (bounded, value) = drive.linkage.OUTPUT, wish.bound
    key, place = f"{group}.{wish.bound_key(bounded)}", output.place.ending
    quantity = Quantity.VELOCITY if bounded == "speed" else Quantity.ACCELERATION
    start, end = wish.ends(output.place.factor * drive.linkage.stroke_mm)
    back, middle, angle = wish.stroke == "return", (start + end) / 2.0, None
    if (driving := wish.driving_rad) is not None:
        angle = sum(driving) / 2.0
        phi2 = drive.machine.motion(np.array([angle % drive.transmission.cycle_rad])).phi2_rad
        back = not bool(drive.machine.working(phi2)[0])
    # A falling speed is a negative acceleration on the way out, and a positive one on the way back
    sign = 1.0 if back is (quantity is Quantity.ACCELERATION) else -1.0
    yield WishHandle(f"gentle {bounded}", quantity, key, value, middle, back, sign, angle)
    for name, at in zip(("from", "to"), driving or (start, end), strict=True):
        if driving is not None:
            own = given(wish, spellings(f"{name}_phi1"))[0]
            written, unit = getattr(wish, own), own.rpartition("_")[2]
            yield WishHandle(
                f"gentle {name}", quantity, f"{group}.{own}", written, angle_rad=at, unit=unit, shown=sign * value
            )
        elif getattr(wish, f"{name}_{place}") is not None:
            yield WishHandle(f"gentle {name}", Quantity.DISPLACEMENT, f"{group}.{name}_{place}", at, at, back)


def _along_angle(key: str, base: Any, unit: str) -> dict[str, Any]:
    """The move of an angle's key: per degree of the chart, the part of a turn in the unit of the key."""
    shown = {"pi": "pi", "deg": "\u00b0", "rad": "rad"}[unit]
    return {"key": key, "base": base, "factor": FULL_TURN[unit] / 360.0, "unit": shown}


def _handle(drive: Drive, name: str, quantity: Quantity, at: tuple[float, float], moves: dict[str, Any]) -> Handle:
    chart = quantity.key_of(drive.linkage.OUTPUT)
    return {"name": name, "chart": chart, "x": at[0], "y": at[1], "moves": moves}


MOST_NUMBERS = 4
"""Most numbers of a law that have a handle: each needs one more law, some hundredths of a second."""

STEP = 0.01
"""Share by which a number is changed to see its effect."""

LEAST_EFFECT = 1e-6
"""Relative change of the ratio that counts as none, as for a factor that the closing of the cycle cancels."""

PLACES = 180
APART = 18
"""Number of places of a cycle where the ratio is compared, and least number of places between two handles."""


@dataclass(frozen=True)
class Grip:
    """A number, the driving angle in deg of its handle, and the number's change per change of the ratio there."""

    number: LawNumber
    angle_deg: float
    factor: float


def grips(drive: Drive) -> Iterator[Grip]:
    """The numbers of a drive's law that move its ratio."""
    angle = np.linspace(0.0, drive.transmission.lobes.driving_period_rad, PLACES, endpoint=False)
    ratio, free = _ratio(drive.transmission, angle), np.ones(PLACES, dtype=bool)
    for number in drive.design.motion.law_numbers[:MOST_NUMBERS]:
        step = STEP * (abs(number.value) or 1.0)
        try:
            change = _ratio(_with(drive, number, number.value + step), angle) - ratio
        except DesignError:
            continue
        most = int(np.argmax(np.where(free, np.abs(change), 0.0)))
        if not abs(change[most]) > LEAST_EFFECT * ratio[most]:
            continue
        free[np.arange(most - APART, most + APART + 1) % PLACES] = False
        yield Grip(number, degrees(angle[most]), step / float(change[most]))


def _with(drive: Drive, number: LawNumber, value: float) -> Transmission:
    """The law with another value of a number; raises DesignError where no such law exists."""
    motion = drive.design.motion
    changed = motion.model_copy(update={number.key: number.written(value)})
    return law_of(drive.design.model_copy(update={"motion": changed})).transmission


def _ratio(law: Transmission, angle: Array) -> Array:
    return 1.0 / law.driven_angle(angle, 1).derivative(1)
