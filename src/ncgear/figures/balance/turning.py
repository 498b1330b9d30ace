"""Turning parts: gears as designed and as corrected, rotors balanced from readings, chain drives."""

from __future__ import annotations

from cmath import phase
from dataclasses import asdict
from math import degrees, radians
from typing import Any

from ncgear.balance.gears import GearBody
from ncgear.balance.rotor import (
    ChainUnbalance,
    balanced,
    chain_unbalance,
    grade_reached,
    opposite_weight_g,
    permissible_unbalance_kg_mm,
    predicted,
)
from ncgear.design.keys.balance import ChainDrive, Rotor
from ncgear.numerics.units import N_M_PER_N_MM, N_PER_KG_MM_S2, RAD_S_PER_RPM, STANDARD_GRAVITY_M_S2
from ncgear.project.balancing import (
    BalancedGear,
    Balancing,
    chain_phases_of,
    readings_of,
    trial_runs_of,
    weight_runs_of,
)

NOTICED = 0.1
"""Share of a gear's weight below which nobody notices the force of its unbalance: bearings and frame carry the weight
all the time."""


def gear_figures(balancing: Balancing) -> dict[str, Any]:
    """Both gears as designed and as corrected."""
    asked = balancing.balance.gears
    assert asked is not None
    return {gear: _gear(one, asked.grade) for gear, one in balancing.gears.items()}


def _gear(gear: BalancedGear, grade: float) -> dict[str, Any]:
    figures: dict[str, Any] = {
        "peak_speed_rpm": gear.speed_rad_s / RAD_S_PER_RPM,
        **_body(gear.body, gear.speed_rad_s, grade),
    }
    if gear.corrected is not None:
        # Grades are limits of fast rotors: beside the weight of a slow gear, what they forbid is not felt
        force, weight = figures["unbalance_force_n"], STANDARD_GRAVITY_M_S2 * gear.body.mass_kg
        figures["worth_correcting"] = not figures["permitted"] and force > NOTICED * weight
        boss = gear.corrected.boss
        left = _body(gear.corrected.body, gear.speed_rad_s, grade)
        figures["corrected"] = {
            **left,
            "force_removed_n": force - left["unbalance_force_n"],
            "holes": list(map(asdict, gear.corrected.holes)),
            "boss_height_mm": boss.height_mm if boss else None,
            "boss_area_mm2": float(boss.section.area) if boss else None,
        }
    return figures


def _body(body: GearBody, speed_rad_s: float, grade: float) -> dict[str, Any]:
    permissible = permissible_unbalance_kg_mm(grade, body.mass_kg, speed_rad_s)
    unbalance = abs(body.unbalance_kg_mm)
    reached = grade_reached(unbalance, body.mass_kg, speed_rad_s)
    return {
        "mass_kg": body.mass_kg,
        "eccentricity_mm": body.eccentricity_mm,
        "direction_deg": degrees(phase(body.unbalance_kg_mm)),
        "inertia_kg_mm2": body.inertia_kg_mm2,
        "unbalance_kg_mm": unbalance,
        "unbalance_force_n": N_PER_KG_MM_S2 * unbalance * speed_rad_s**2,
        "torque_of_weight_n_m": N_M_PER_N_MM * STANDARD_GRAVITY_M_S2 * unbalance,
        "couple_kg_mm2": abs(body.couple_kg_mm2),
        "permissible_kg_mm": permissible,
        "permitted": unbalance <= permissible,
        # JSON has no infinity: None stands for a gear that keeps none of the grades.
        "grade_reached": reached if reached < float("inf") else None,
    }


def rotor_figures(balancing: Balancing) -> dict[str, Any]:
    """Corrections of a rotor, and the readings expected after them."""
    asked = balancing.balance.rotor
    assert asked is not None
    found = balanced(readings_of(asked.first), trial_runs_of(asked), "rotor.trials")
    return {
        "planes": [_polar(weight, "correction_g", "angle_deg") for weight in found.weights],
        "sensors": [_polar(left, "expected_amplitude", "phase_deg") for left in found.residual],
        **_permissible(asked),
    }


def _permissible(asked: Rotor) -> dict[str, float]:
    """The unbalance that the grade allows in all planes together, also as a weight at the radius of the corrections."""
    if asked.mass_kg is None or asked.radius_mm is None:
        return {}
    allowed = permissible_unbalance_kg_mm(asked.grade, asked.mass_kg, asked.speed_rpm * RAD_S_PER_RPM)
    return {"permissible_kg_mm": allowed, "permissible_weight_g": 1000.0 * allowed / asked.radius_mm}


def chain_figures(balancing: Balancing) -> dict[str, Any]:
    """The ranges of a chain drive's equivalent unbalance, and predictions from them."""
    asked = balancing.balance.chain_drive
    assert asked is not None
    found = chain_unbalance(weight_runs_of(asked), chain_phases_of(asked), "chain_drive.runs")
    return {
        "effect_of_weight": asdict(found.weight),
        "tight_side": asdict(found.tight),
        "slack_side": asdict(found.slack),
        "predictions": [_prediction(asked, found, at) for at in asked.predict_deg],
    }


def _prediction(asked: ChainDrive, found: ChainUnbalance, weight_deg: float) -> dict[str, Any]:
    made = predicted(found, chain_phases_of(asked), radians(weight_deg))
    larger = max(made.by_tight, made.by_slack, key=abs)
    figures = {
        "weight_deg": weight_deg,
        **_polar(made.by_tight, "by_tight", "by_tight_deg"),
        **_polar(made.by_slack, "by_slack", "by_slack_deg"),
        "predicted_amplitude": made.amplitude,
    }
    if asked.effect_per_g is None:
        return figures
    weight = opposite_weight_g(made.amplitude, phase(larger), asked.effect_per_g)
    return {**figures, **_polar(weight, "correction_g", "correction_deg")}


def _polar(value: complex, amplitude: str, angle: str) -> dict[str, float]:
    return {amplitude: abs(value), angle: degrees(phase(value)) % 360.0}
