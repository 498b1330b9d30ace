"""Charts of the contact between the teeth of a pair: transmission error, backlash, contacts, pressure angle, sliding.

Their horizontal axis is a whole cycle of the angle of the pair's own driving gear.
"""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned
from ncgear.contact.pair import PairContact
from ncgear.contact.written.as_written import AsWritten
from ncgear.drawings.charts.chart import Chart, Line, Role
from ncgear.figures.numbers import MICRORAD
from ncgear.numerics.arrays import Array

PUSHING, BACKS = "pushing flanks as designed", "backs as designed"


def transmission_error(contact: PairContact) -> Chart:
    """Driven angle less that of the law, as designed and for the worst written outlines."""
    designed, written = contact.as_designed, worst_written(contact)
    lines = (
        Line(Role.OWN, PUSHING, _angle_deg(designed), 1e6 * designed.pushing.error_rad),
        Line(Role.WRITTEN, "pushing flanks as written", _angle_deg(designed), 1e6 * written.pushing_rad),
    )
    label = f"error of driven\nangle in {MICRORAD}"
    return Chart("transmission error", MICRORAD, lines, _cycle_deg(designed), axis_label=label)


def worst_written(contact: PairContact) -> AsWritten:
    """The form of the written outlines that has the largest transmission error."""
    return max(contact.as_written, key=lambda outlines: outlines.transmission_error_rad)


def backlash(designed: AsDesigned) -> Chart:
    """Play of the driven gear."""
    line = Line(Role.OWN, "as designed", _angle_deg(designed), 1e6 * designed.backlash_rad)
    return Chart("backlash", MICRORAD, (line,), _cycle_deg(designed))


def flanks_in_contact(designed: AsDesigned) -> Chart:
    """How many pairs of flanks touch, on either side of the teeth."""
    counts = (side.simultaneous.astype(float) for side in (designed.pushing, designed.back))
    lines = _sides(designed, *counts)
    return Chart("flanks in contact", "", lines, _cycle_deg(designed), counts=True, axis_label="flanks\nin contact")


def pressure_angle(designed: AsDesigned) -> Chart:
    """Pressure angle of the foremost contact, on either side of the teeth."""
    angles = (np.degrees(side.first.pressure_angle_rad) for side in (designed.pushing, designed.back))
    return Chart("pressure angle", "deg", _sides(designed, *angles), _cycle_deg(designed))


def sliding(designed: AsDesigned) -> Chart:
    """Speed of sliding at the foremost contact divided by that of the driving gear, on either side of the teeth."""
    speeds = (side.first.sliding_mm(designed.placement) for side in (designed.pushing, designed.back))
    return Chart("sliding", "mm per rad", _sides(designed, *speeds), _cycle_deg(designed))


def _sides(designed: AsDesigned, pushing: Array, back: Array) -> tuple[Line, Line]:
    """The lines of both flanks; that of the pushing flanks is the last one, which is drawn on top."""
    angle = _angle_deg(designed)
    return Line(Role.OTHER, BACKS, angle, back), Line(Role.OWN, PUSHING, angle, pushing)


def _angle_deg(designed: AsDesigned) -> Array:
    return np.degrees(designed.placement.phi1_rad)


def _cycle_deg(designed: AsDesigned) -> float:
    return degrees(designed.placement.cycle_rad)
