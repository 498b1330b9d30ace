"""The table from which a workshop can lay out the pitch curves: in the data sheet, and in finer steps as CSV."""

from __future__ import annotations

from math import ceil, degrees

import numpy as np

from ncgear.figures.csv_text import csv_text
from ncgear.figures.numbers import to_digits
from ncgear.figures.tables import Table, columns_of
from ncgear.numerics.arrays import Array
from ncgear.numerics.highest import largest_from
from ncgear.pitch.pair import PitchPair

STEPS_DEG = (5.0, 4.0, 3.0, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1)
"""Possible steps of the driving angle: whole parts of a turn that are easy to read."""

TURN_DEG = 360.0

ROUNDING = 1e-9
"""Part of a step by which a turn may exceed whole steps, so that no step is added for a rounding error."""

RADII = (f"pitch radius of {gear} gear, mm" for gear in ("driving", "driven"))
COLUMNS = columns_of("phi1, deg", "phi2, deg", "ratio i12", *RADII)


def pitch_table(pitch: PitchPair) -> Table:
    """Angles, ratio and both pitch radii over one turn of the driving gear, at least one row for each of its teeth.

    Gears that turn less than once have their range in place of a turn.  In the frame of a gear, the polar angle of a
    pitch point counts from the point where the gears meet at phi1 = 0.  It equals the gear's own turn, in the
    opposite sense.
    """
    phi1_deg = turn_deg(pitch.size.driving_teeth, _end_deg(pitch))
    columns = pitch_columns(pitch, np.radians(phi1_deg))
    columns[0] = phi1_deg
    columns[1] = np.degrees(columns[1])
    rows = tuple(tuple(map(float, row)) for row in columns.T)
    return Table("Pitch curves", COLUMNS, rows, (_interpolated(pitch, phi1_deg),), long=True)


def turn_deg(teeth: int, end_deg: float = TURN_DEG) -> Array:
    """Driving angles in deg over a turn or up to an end, in the coarsest step with at least one row for each tooth."""
    step = next((step for step in STEPS_DEG if end_deg / step >= teeth), end_deg / teeth)
    return np.linspace(0.0, end_deg, ceil(end_deg / step - ROUNDING) + 1)


def _end_deg(pitch: PitchPair) -> float:
    return TURN_DEG if pitch.toothed is None else degrees(pitch.toothed.covered_rad)


def pitch_columns(pitch: PitchPair, phi1_rad: Array) -> Array:
    """phi1, phi2 (rad), ratio and both pitch radii (mm) at driving angles of shape (n,), shape (5, n)."""
    driven = pitch.transmission.driven_angle(phi1_rad, 1)
    radii = [np.linalg.norm(curve.at_angle(phi1_rad).position, axis=1) for curve in (pitch.driving, pitch.driven)]
    return np.stack([phi1_rad, driven.value, 1.0 / driven.derivative(1), *radii])


OFF = [1, 3, 4]
"""The columns whose interpolation is judged: phi2 and both radii."""

PROBES, KNOWN = 4, 1e-3
"""Places between two rows where the search for the greatest error begins, and the accuracy of that error as a share."""


def _interpolated(pitch: PitchPair, phi1_deg: Array) -> str:
    """A note on the greatest error of straight interpolation between two rows."""
    rows = pitch_columns(pitch, np.radians(phi1_deg))

    def off(phi1_rad: Array) -> Array:
        found = pitch_columns(pitch, phi1_rad)
        straight = [np.interp(phi1_rad, rows[0], rows[column]) for column in OFF]
        return np.asarray(np.abs(straight - found[OFF]))

    inner = np.linspace(0.0, 1.0, PROBES, endpoint=False)
    places = np.append((rows[0, :-1, None] + np.diff(rows[0])[:, None] * inner).ravel(), rows[0, -1])
    values = off(places)
    angle, *radii = largest_from(off, places, values, KNOWN * values.max(axis=1))
    turned, moved = to_digits(degrees(angle.value), 2), to_digits(max(radius.value for radius in radii), 2)
    return (
        f"between two rows straight interpolation is off by up to {turned} deg of phi2 and {moved} mm of the radii; "
        "pitch.csv has more rows"
    )


CSV_STEPS = 720
"""Steps of half a degree over a turn of the driving gear; as many over a range."""

CSV_COLUMNS = ("phi1_deg", "phi2_deg", "ratio", "radius_driving_mm", "radius_driven_mm")


def pitch_csv(pitch: PitchPair) -> str:
    """Angles, ratio and pitch radii over one turn of the driving gear, every half degree."""
    angles = np.linspace(0.0, _end_deg(pitch), CSV_STEPS + 1)
    _, driven, *others = pitch_columns(pitch, np.radians(angles))
    return csv_text(CSV_COLUMNS, [angles, np.degrees(driven), *others])
