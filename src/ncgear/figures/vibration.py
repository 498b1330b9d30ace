"""What is told of a mesh's vibration: figures, a line of text, and a table over the driving speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.figures.csv_text import rows_text
from ncgear.figures.numbers import fixed, known, to_digits
from ncgear.figures.quantities import figure
from ncgear.project.drive import Drive
from ncgear.strength.vibration import RESONANCE

if TYPE_CHECKING:
    from ncgear.project.strengthening import Rating
    from ncgear.project.vibration import SpeedSweep, ToldVibration


def vibration_of_rating(drive: Drive, rating: Rating) -> ToldVibration | None:
    """What is told of the vibration of rated teeth; None where nothing bears."""
    from ncgear.project.vibration import mesh_stiffness, told_vibration

    mesh, strength = mesh_stiffness(rating.loading, drive.running), rating.strength
    if mesh is None:
        return None
    contacts, factor = strength.contacts, strength.stresses.dynamic_factor
    # Sections of helical teeth have factors of their own, of which the mean by their loads is told.
    whole, loaded = (np.bincount(contacts.position, one) for one in (factor * contacts.force_n, contacts.force_n))
    mean = (whole / np.maximum(loaded, np.finfo(float).tiny))[contacts.position]
    return told_vibration(drive, drive.vibration, mesh, contacts.phi1_rad, mean, contacts.pair_force_n)


def vibration_figures(told: ToldVibration | None) -> dict[str, Any]:
    """The dynamic factor, the resonance ratios of a turn, and the critical speeds."""
    if told is None:
        return {}
    figures: dict[str, Any] = {
        "dynamic_factor": told.factor,
        "dynamic_factor_at_rad": told.phi1_rad,
        "peak_tooth_force_vibrating_n": told.most_n,
        "dynamic_factor_is": "given" if told.is_given else "computed",
        "resonance_ratio_min": told.least,
        "resonance_ratio_max": told.greatest,
        "resonates_between_deg": [list(ends) for ends in told.resonates_deg],
    }
    if told.critical_rpm is not None:
        figures |= dict(zip(("critical_speed_min_rpm", "critical_speed_max_rpm"), told.critical_rpm, strict=True))
    return figures


def vibration_words(told: ToldVibration) -> str:
    """The dynamic factor where a pair bears most, the largest force with it, and the critical speeds."""
    factor = f"K_V {to_digits(told.factor, 3)}{' as given' if told.is_given else ''}"
    factor += f", up to {figure('force_n', told.most_n)} with it"
    if told.critical_rpm is None:
        return f"{factor}; nothing that moves has inertia"
    low, high = (to_digits(one, 2) for one in told.critical_rpm)
    return f"{factor}; resonance at {low} to {high} r/min"


def stretches_words(told: ToldVibration) -> str:
    """``between phi1 = 20 and 55 deg``, for each stretch in which a mesh resonates."""
    return "between phi1 = " + ", ".join(
        f"{fixed(low, 0)} and {fixed(high, 0)} deg" for low, high in told.resonates_deg
    )


BAND = f"N from {RESONANCE[0]:g} to {RESONANCE[1]:g}"
"""The words for the resonance ratios of a resonance."""

COLUMNS = ("speed_rpm", "resonance_ratio_min", "resonance_ratio_max", "dynamic_factor_max", "load_factor_swinging")
"""Columns of the table over the driving speed."""


def speeds_csv(sweep: SpeedSweep) -> str:
    """A row for each driving speed; the last column is empty of swings without end, and of loads that change flanks."""
    swinging = [None] * sweep.speed_rpm.size if sweep.load_factor is None else map(known, sweep.load_factor.tolist())
    columns = (one.tolist() for one in (sweep.speed_rpm, sweep.least, sweep.greatest, sweep.factor))
    return rows_text(COLUMNS, zip(*columns, swinging, strict=True))
