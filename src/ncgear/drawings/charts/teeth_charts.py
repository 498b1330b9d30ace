"""Charts of the teeth of a pair over the angle of its own driving gear, a whole cycle: contact, loads and stresses."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned
from ncgear.contact.pair import PairContact
from ncgear.contact.written.as_written import AsWritten
from ncgear.drawings.charts.chart import Chart, ChartLine, Role
from ncgear.figures.numbers import MICRORAD, to_digits
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.vibration import SpeedSweep
from ncgear.strength.answer import Strength
from ncgear.strength.holding import Damage, Weakest
from ncgear.strength.life import rated_for_pitting
from ncgear.strength.vibration import RESONANCE

PUSHING, BACKS = "pushing flanks as designed", "backs as designed"


def transmission_error(contact: PairContact) -> Chart:
    """Driven angle less the driven angle of the law, as designed and for the worst written outlines."""
    designed, written = contact.as_designed, worst_written(contact)
    lines = (
        ChartLine(Role.OWN, PUSHING, _angle_deg(designed), 1e6 * designed.pushing.error_rad),
        ChartLine(Role.WRITTEN, "pushing flanks as written", _angle_deg(designed), 1e6 * written.pushing_rad),
    )
    label = f"error of driven\nangle in {MICRORAD}"
    return Chart("transmission error", MICRORAD, lines, _cycle_deg(designed), axis_label=label)


def worst_written(contact: PairContact) -> AsWritten:
    """The form of the written outlines with the largest transmission error."""
    return max(contact.as_written, key=lambda outlines: outlines.transmission_error_rad)


def backlash(designed: AsDesigned) -> Chart:
    """Play of the driven gear."""
    line = ChartLine(Role.OWN, "as designed", _angle_deg(designed), 1e6 * designed.backlash_rad)
    return Chart("backlash", MICRORAD, (line,), _cycle_deg(designed))


def flanks_in_contact(designed: AsDesigned) -> Chart:
    """Number of touching pairs of flanks, on either side of the teeth."""
    counts = (side.simultaneous.astype(float) for side in (designed.pushing, designed.back))
    lines = _sides(designed, *counts)
    return Chart("flanks in contact", "", lines, _cycle_deg(designed), counts=True, axis_label="flanks\nin contact")


def pressure_angle(designed: AsDesigned) -> Chart:
    """Pressure angle of the foremost contact, on either side of the teeth."""
    angles = (np.degrees(side.first.pressure_angle_rad) for side in (designed.pushing, designed.back))
    return Chart("pressure angle", "deg", _sides(designed, *angles), _cycle_deg(designed))


def sliding(designed: AsDesigned) -> Chart:
    """Sliding speed at the foremost contact divided by the speed of the driving gear, on either side of the teeth."""
    speeds = (side.first.sliding_mm(designed.placement) for side in (designed.pushing, designed.back))
    return Chart("sliding", "mm per rad", _sides(designed, *speeds), _cycle_deg(designed))


def _sides(designed: AsDesigned, pushing: Array, back: Array) -> tuple[ChartLine, ChartLine]:
    """The lines of both flanks; the line of the pushing flanks comes last, and is drawn on top."""
    angle = _angle_deg(designed)
    return ChartLine(Role.OTHER, BACKS, angle, back), ChartLine(Role.OWN, PUSHING, angle, pushing)


def _angle_deg(designed: AsDesigned) -> Array:
    return np.degrees(designed.placement.phi1_rad)


def _cycle_deg(designed: AsDesigned) -> float:
    return degrees(designed.placement.cycle_rad)


SAME_LIMIT = 0.01
"""Relative difference below which two endured stresses are drawn as one line: the line's width on paper."""


def strength_charts(strength: Strength, found: Sequence[Weakest]) -> list[Chart]:
    """Forces of the two most loaded pairs, stresses at both roots, and pressure where the material has figures for it.

    Positions without load have values of 0.
    """
    charts = [_forces(strength), _root_stress(strength, found)]
    return charts if strength.driving.contact is None else [*charts, _pressure(strength, found)]


def speed_charts(sweep: SpeedSweep) -> list[Chart]:
    """The effect of vibration on the teeth's load over the driving speed, and the resonance ratios of a turn."""
    speed = sweep.speed_rpm
    end, across = float(speed[-1]), "driving speed in r/min"
    factors = [ChartLine(Role.OWN, "K_V, greatest of a turn", speed, sweep.factor)]
    if sweep.load_factor is not None:
        finite = np.isfinite(sweep.load_factor)
        factors.append(ChartLine(Role.OTHER, "mesh as a spring that swings", speed[finite], sweep.load_factor[finite]))
    ends = np.array([0.0, end])
    ratios = [
        ChartLine(Role.OWN, "greatest of a turn", speed, sweep.greatest),
        ChartLine(Role.OTHER, "least of a turn", speed, sweep.least),
        *(ChartLine(Role.LIMIT, f"resonance, {ratio:g}", ends, np.full(2, ratio)) for ratio in RESONANCE),
    ]
    return [
        Chart("dynamic factor", "", tuple(factors), end, axis_label="load over\nload at rest", across=across),
        Chart("resonance ratio", "", tuple(ratios), end, axis_label="resonance\nratio N", across=across),
    ]


def _forces(strength: Strength) -> Chart:
    contacts = strength.contacts.of_pairs()
    angle = _position_deg(strength)
    # Sorted by position, then by falling force: the index within a position is the rank of a pair.
    order = np.lexsort((-contacts.force_n, contacts.position))
    position = contacts.position[order]
    rank = np.arange(position.size) - np.searchsorted(position, position)
    most, next_ = np.zeros(angle.size), np.zeros(angle.size)
    for values, place in ((most, 0), (next_, 1)):
        values[position[rank == place]] = contacts.force_n[order][rank == place]
    lines = (ChartLine(Role.OTHER, "the next pair", angle, next_), ChartLine(Role.OWN, "most loaded pair", angle, most))
    return Chart("force of a pair", "N", lines, degrees(strength.end_rad), names_extreme=True)


def _root_stress(strength: Strength, found: Sequence[Weakest]) -> Chart:
    angle, tension = _position_deg(strength), strength.stresses.tension_mpa
    roles = (Role.OTHER, Gear.DRIVEN, 1), (Role.OWN, Gear.DRIVING, 0)
    lines = [
        ChartLine(role, f"{gear.value} gear", angle, _largest(strength, tension[row])) for role, gear, row in roles
    ]
    limits = _limits(strength, found, Damage.BENDING)
    return Chart("root stress", "MPa", (*limits, *lines), degrees(strength.end_rad), names_extreme=True)


def _pressure(strength: Strength, found: Sequence[Weakest]) -> Chart:
    contacts, pressure = strength.contacts, strength.stresses.pressure_mpa
    angle = _position_deg(strength)
    lines = []
    kinds = (Role.OTHER, "of any pair", contacts.flanks), (Role.OWN, "rated", rated_for_pitting(contacts))
    for role, label, counted in kinds:
        # Where only edges touch, the pressure is unknown: no value is drawn there.
        known = np.ones(angle.size, dtype=bool)
        known[contacts.position] = False
        known[contacts.position[counted]] = True
        values = _largest(strength, np.where(counted, pressure, 0.0))
        lines.append(ChartLine(role, label, angle[known], values[known]))
    limits = _limits(strength, found, Damage.CONTACT)
    return Chart("contact pressure", "MPa", (*limits, *lines), degrees(strength.end_rad), names_extreme=True)


def _limits(strength: Strength, found: Sequence[Weakest], damage: Damage) -> list[ChartLine]:
    """The stresses that the weakest teeth endure, as level lines; one line for both gears if they endure the same."""
    endured = {weakest.gear: weakest.endured_mpa for weakest in found if weakest.damage is damage}
    ends = np.array([0.0, degrees(strength.end_rad)])
    driving, driven = endured[Gear.DRIVING], endured[Gear.DRIVEN]
    if abs(driving - driven) <= SAME_LIMIT * max(driving, driven):
        return [ChartLine(Role.LIMIT, "endured", ends, np.full(2, min(driving, driven)))]
    return [
        # Both are drawn alike: their values distinguish them.
        ChartLine(Role.LIMIT, f"{gear.value} gear endures {to_digits(value, 3)}", ends, np.full(2, value))
        for gear, value in endured.items()
    ]


def _position_deg(strength: Strength) -> Array:
    """The driving angle of every position, including positions without load, shape (n,)."""
    present, first = np.unique(strength.contacts.position, return_index=True)
    return np.degrees(np.interp(np.arange(present[-1] + 1), present, strength.contacts.phi1_rad[first]))


def _largest(strength: Strength, values: Array) -> Array:
    """The largest of the contacts' values at each position, 0 where there is none, shape (n,)."""
    largest = np.zeros(strength.contacts.position.max() + 1)
    np.maximum.at(largest, strength.contacts.position, values)
    return largest
