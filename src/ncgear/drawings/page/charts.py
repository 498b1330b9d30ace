"""A chart of the report as a value: a quantity over a driving angle, in one or several lines.

Where the page's tables are taken: close together, and on both sides of every angle at which a curve may jump.

Charts of the slider's motion, of force and power, and of the ratio, beside the uniform crank at the same speed.

Charts of a pair of gears over the angle of its own driving gear: pressure angle, transmission error, ratio.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import degrees, floor, log10

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.drawings.plots.canvas import joints_up_to
from ncgear.drawings.plots.contact import scaled
from ncgear.drawings.plots.curves import ACCELERATION, DISPLACEMENT, FORCE, POWER, VELOCITY, Quantity
from ncgear.kinematics.motion import SliderMotion
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

DIGITS = 4
"""Significant digits of the largest value of a line, which set the decimals of all of them."""

OWN, OTHER, UNIFORM = "own", "other", "uniform"
"""Roles of a line: this design, a second line of it, and the uniform crank."""

DRIVING = "driving"
"""The angle that the page is driven by: that of the driving shaft."""


@dataclass(frozen=True, eq=False)
class Line:
    """Values at rising angles in degrees, both of shape (n,), which repeat after ``period_deg``.

    ``name`` tells the line from the others of its chart.
    """

    role: str
    name: str
    angle_deg: Array
    values: Array
    period_deg: float


@dataclass(frozen=True, eq=False)
class Chart:
    """Lines of one quantity in ``unit``; the first one is this design's own.

    ``angle`` is the key of the angle that it is drawn over, which goes from 0 to ``end_deg``; ``joints_deg`` (shape
    (k,)) are marked; ``key`` is unique in the page.  Raises ValueError for a value that is not finite.
    """

    key: str
    name: str
    unit: str
    lines: tuple[Line, ...]
    end_deg: float
    joints_deg: Array
    angle: str = DRIVING
    angle_name: str = "driving angle in deg"

    def __post_init__(self) -> None:
        for line in self.lines:
            if not np.isfinite(line.values).all():
                raise ValueError(f"{self.name} holds a value that is not finite")

    @property
    def decimals(self) -> int:
        """Digits after the point with which all lines are read out."""
        largest = max(float(np.max(np.abs(line.values))) for line in self.lines)
        return decimals_of(largest)


def decimals_of(largest: float) -> int:
    """Digits after the point that show a largest value with four significant ones; none for 0."""
    return max(0, DIGITS - 1 - floor(log10(largest))) if largest > 0.0 else 0


LEAST = 2001
"""Samples over a cycle of the slider, between which the page goes along straight lines."""

SIDE_RAD = 1e-9
"""How far beside a jump the samples before and after it stand: far over the rounding of an angle, and too near to be
seen or hit."""


def cycle_angles_rad(drive: Drive) -> Array:
    """Rising driving angles over one cycle of the slider, both ends included, shape (n,) with n >= 2001."""
    cycle = drive.transmission.cycle_rad
    dead_centres = drive.machine.extended_rad, drive.uniform_machine.extended_rad
    return split_angles(cycle, (*joints_up_to(drive.transmission, cycle).tolist(), *dead_centres))


def split_angles(end_rad: float, jumps_rad: Iterable[float]) -> Array:
    """Rising angles from 0 to the end, shape (n,), evenly spread between the jumps.

    There is a sample on either side of each jump, and before the end.
    """
    inner = sorted({jump for jump in jumps_rad if SIDE_RAD < jump < end_rad - SIDE_RAD})
    bounds = [0.0, *inner, end_rad]
    stretches = [_stretch(a, b, end_rad) for a, b in pairwise(bounds)]
    angles = np.concatenate([*stretches, [end_rad]])
    angles[0] = 0.0
    return angles


def _stretch(start: float, end: float, whole: float) -> Array:
    count = 2 + int(np.ceil((LEAST - 1) * (end - start) / whole))
    # Two jumps may lie closer together than both their sides.
    side = min(SIDE_RAD, (end - start) / 3.0)
    return np.linspace(start + side, end - side, count)


MOTION, LOAD = (DISPLACEMENT, VELOCITY, ACCELERATION), (FORCE, POWER)

RATIO = Quantity("ratio", "ratio i\u2081\u2082", "", extreme=True)


def motion_charts(drive: Drive, end_rad: float) -> tuple[Chart, ...]:
    """Displacement to ratio from 0 to a driving angle; force and power where the design has a resistance."""
    phi1 = cycle_angles_rad(drive)
    tables = drive.machine.motion(phi1), drive.uniform_machine.motion(phi1)
    quantities = (*MOTION, *(LOAD if drive.design.resistance is not None else ()), RATIO)
    return tuple(_chart(drive, quantity.readable(*tables), *tables, end_rad) for quantity in quantities)


def _chart(drive: Drive, quantity: Quantity, own: SliderMotion, uniform: SliderMotion, end_rad: float) -> Chart:
    angle, period = np.degrees(own.phi1_rad), degrees(drive.transmission.cycle_rad)
    lines = (
        Line(OWN, "this design", angle, quantity.of(own), period),
        Line(UNIFORM, "uniform crank", angle, quantity.of(uniform), period),
    )
    joints = np.degrees(joints_up_to(drive.transmission, end_rad))
    return Chart(quantity.column, quantity.name, quantity.unit, lines, degrees(end_rad), joints)


BETWEEN = "between"
"""The angle of the shaft between two stages."""


def gear_charts(drive: Drive, contact: PairContact) -> tuple[Chart, ...]:
    """Of one pair; of a stage its own ratio, too."""
    charts = _pressure_angle(drive, contact), _transmission_error(drive, contact)
    return charts if drive.stage is None else (_ratio(drive, contact), *charts)


def _pressure_angle(drive: Drive, contact: PairContact) -> Chart:
    """At the first contact as designed; circular gears have the rack's angle all around."""
    designed = contact.as_designed
    sides = ((OWN, "pushing flanks", designed.pushing), (OTHER, "backs", designed.back))
    lines = [_line(contact, role, name, np.degrees(side.first.pressure_angle_rad)) for role, name, side in sides]
    circular = np.full(2, degrees(drive.rack.pressure_angle_rad))
    end = degrees(designed.placement.cycle_rad)
    uniform = Line(UNIFORM, "circular gears", np.array([0.0, end]), circular, end)
    return _chart_of_gear_charts(drive, contact, "pressure_angle", "pressure angle", "\u00b0", (*lines, uniform))


def _transmission_error(drive: Drive, contact: PairContact) -> Chart:
    """Driven angle beyond the law's: of the worst outlines as they are written, and as designed."""
    written = max(contact.as_written, key=lambda outlines: outlines.transmission_error_rad)
    factor, unit = scaled(written.pushing_rad)
    lines = (
        _line(contact, OWN, f"as written ({written.source.upper()})", factor * written.pushing_rad),
        _line(contact, OTHER, "as designed", factor * contact.as_designed.pushing.error_rad),
    )
    return _chart_of_gear_charts(drive, contact, "transmission_error", "transmission error", unit, lines)


def _ratio(drive: Drive, contact: PairContact) -> Chart:
    law, end = drive.pair.transmission, contact.as_designed.placement.cycle_rad
    angle = split_angles(end, joints_up_to(law, end).tolist())
    values = 1.0 / law.driven_angle(angle, 1).derivative(1)
    lines = (Line(OWN, "this design", np.degrees(angle), values, degrees(end)),)
    return _chart_of_gear_charts(drive, contact, "ratio", "ratio i\u2081\u2082", "", lines)


def _line(contact: PairContact, role: str, name: str, values: Array) -> Line:
    """Closed by its first value at the end of the cycle."""
    placement = contact.as_designed.placement
    angle = np.degrees(np.append(placement.phi1_rad, placement.cycle_rad))
    return Line(role, name, angle, np.append(values, values[0]), degrees(placement.cycle_rad))


def _chart_of_gear_charts(
    drive: Drive, contact: PairContact, key: str, name: str, unit: str, lines: tuple[Line, ...]
) -> Chart:
    end = contact.as_designed.placement.cycle_rad
    joints = np.degrees(joints_up_to(drive.pair.transmission, end))
    if drive.stage is None:
        return Chart(key, name, unit, lines, degrees(end), joints)
    shaft = (DRIVING, "driving angle in deg") if drive.stage == 1 else (BETWEEN, "angle of the shaft between in deg")
    return Chart(f"{key}_{drive.stage}", f"{name}, stage {drive.stage}", unit, lines, degrees(end), joints, *shaft)
