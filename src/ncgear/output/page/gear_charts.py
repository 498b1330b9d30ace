"""Charts of a pair of gears over the angle of its own driving gear: pressure angle, transmission error, ratio."""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.contact.pair_contact import PairContact
from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.output.joints import joints_up_to
from ncgear.output.page.chart import DRIVING, OTHER, OWN, UNIFORM, Chart, Line
from ncgear.output.page.sampling import split_angles
from ncgear.output.plots.mesh import scaled

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
    return _chart(drive, contact, "pressure_angle", "pressure angle", "\u00b0", (*lines, uniform))


def _transmission_error(drive: Drive, contact: PairContact) -> Chart:
    """Driven angle beyond the law's: of the worst outlines as they are written, and as designed."""
    written = max(contact.as_written, key=lambda outlines: outlines.transmission_error_rad)
    factor, unit = scaled(written.pushing_rad)
    lines = (
        _line(contact, OWN, f"as written ({written.source.upper()})", factor * written.pushing_rad),
        _line(contact, OTHER, "as designed", factor * contact.as_designed.pushing.error_rad),
    )
    return _chart(drive, contact, "transmission_error", "transmission error", unit, lines)


def _ratio(drive: Drive, contact: PairContact) -> Chart:
    law, end = drive.pair.transmission, contact.as_designed.placement.cycle_rad
    angle = split_angles(end, joints_up_to(law, end).tolist())
    values = 1.0 / law.driven_angle(angle, 1).derivative(1)
    lines = (Line(OWN, "this design", np.degrees(angle), values, degrees(end)),)
    return _chart(drive, contact, "ratio", "ratio i\u2081\u2082", "", lines)


def _line(contact: PairContact, role: str, name: str, values: Array) -> Line:
    """Closed by its first value at the end of the cycle."""
    placement = contact.as_designed.placement
    angle = np.degrees(np.append(placement.phi1_rad, placement.cycle_rad))
    return Line(role, name, angle, np.append(values, values[0]), degrees(placement.cycle_rad))


def _chart(drive: Drive, contact: PairContact, key: str, name: str, unit: str, lines: tuple[Line, ...]) -> Chart:
    end = contact.as_designed.placement.cycle_rad
    joints = np.degrees(joints_up_to(drive.pair.transmission, end))
    if drive.stage is None:
        return Chart(key, name, unit, lines, degrees(end), joints)
    shaft = (DRIVING, "driving angle in deg") if drive.stage == 1 else (BETWEEN, "angle of the shaft between in deg")
    return Chart(f"{key}_{drive.stage}", f"{name}, stage {drive.stage}", unit, lines, degrees(end), joints, *shaft)
