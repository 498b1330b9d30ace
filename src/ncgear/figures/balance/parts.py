"""All figures of a balance file by the names of its parts, those of turning parts, and the answer told from them."""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from math import degrees, radians
from typing import Any

from ncgear.balance import rotor
from ncgear.balance.gears import GearBody
from ncgear.design.keys.balance import ChainDrive, Rotor
from ncgear.errors import below
from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.balance.shaking import chassis_figures, excitation_figures, frame_figures, mechanism_figures
from ncgear.figures.numbers import figure, fixed, to_digits
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
    return {gear: _gear(balanced, asked.grade) for gear, balanced in balancing.gears.items()}


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
    permissible = rotor.permissible_unbalance_kg_mm(grade, body.mass_kg, speed_rad_s)
    unbalance = abs(body.unbalance_kg_mm)
    reached = rotor.grade_reached(unbalance, body.mass_kg, speed_rad_s)
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
    found = rotor.balanced(readings_of(asked.first), trial_runs_of(asked), "rotor.trials")
    return {
        "planes": [_polar(weight, "correction_g", "angle_deg") for weight in found.weights],
        "sensors": [_polar(left, "expected_amplitude", "phase_deg") for left in found.residual],
        **_permissible(asked),
    }


def _permissible(asked: Rotor) -> dict[str, float]:
    """The unbalance that the grade allows in all planes together, also as a weight at the radius of the corrections."""
    if asked.mass_kg is None or asked.radius_mm is None:
        return {}
    allowed = rotor.permissible_unbalance_kg_mm(asked.grade, asked.mass_kg, asked.speed_rpm * RAD_S_PER_RPM)
    return {"permissible_kg_mm": allowed, "permissible_weight_g": 1000.0 * allowed / asked.radius_mm}


def chain_figures(balancing: Balancing) -> dict[str, Any]:
    """The ranges of a chain drive's equivalent unbalance, and predictions from them."""
    asked = balancing.balance.chain_drive
    assert asked is not None
    found = rotor.chain_unbalance(weight_runs_of(asked), chain_phases_of(asked), "chain_drive.runs")
    return {
        "effect_of_weight": asdict(found.weight),
        "tight_side": asdict(found.tight),
        "slack_side": asdict(found.slack),
        "predictions": [_prediction(asked, found, at) for at in asked.predict_deg],
    }


def _prediction(asked: ChainDrive, found: rotor.ChainUnbalance, weight_deg: float) -> dict[str, Any]:
    made = rotor.predicted(found, chain_phases_of(asked), radians(weight_deg))
    larger = max(made.by_tight, made.by_slack, key=abs)
    figures = {
        "weight_deg": weight_deg,
        **_polar(made.by_tight, "by_tight", "by_tight_deg"),
        **_polar(made.by_slack, "by_slack", "by_slack_deg"),
        "predicted_amplitude": made.amplitude,
    }
    if asked.effect_per_g is None:
        return figures
    weight = rotor.opposite_weight_g(made.amplitude, phase(larger), asked.effect_per_g)
    return {**figures, **_polar(weight, "correction_g", "correction_deg")}


def _polar(value: complex, amplitude: str, angle: str) -> dict[str, float]:
    return {amplitude: abs(value), angle: degrees(phase(value)) % 360.0}


PARTS = {
    "chassis": chassis_figures,
    "excitations": excitation_figures,
    "gears": gear_figures,
    "rotor": rotor_figures,
    "chain_drive": chain_figures,
}
"""Parts of the file beside its mechanisms, each with the function that computes its figures."""


def balancing_figures(balancing: Balancing) -> dict[str, Any]:
    """Every figure by the name of its part; keys end in their units."""
    balance = balancing.balance
    figures: dict[str, Any] = {"name": balance.name}
    if balance.mechanisms:
        figures["mechanisms"] = []
        for number, (given, mounted) in enumerate(zip(balance.mechanisms, balancing.mounted, strict=True)):
            with below(f"mechanisms.{number}"):
                figures["mechanisms"].append(mechanism_figures(given, mounted.mechanism))
    if len(balance.mechanisms) > 1:
        figures["frame"] = frame_figures(balancing)
    asked = {part: answer for part, answer in PARTS.items() if getattr(balance, part) is not None}
    return {**figures, **{part: answer(balancing) for part, answer in asked.items()}}


HEADS = "force up to", "r.m.s.", "counterweight", "leaves up to", "r.m.s."

NAMED = 3
"""Planes of a rotor and predictions of a chain drive that are told."""


def balance_answer(figures: Mapping[str, Any]) -> Answer:
    """How much each part shakes and what would stop it, and what is near a natural frequency."""
    rows, faults = list[Row](), list[Fault]()
    for mechanism in figures.get("mechanisms", []):
        rows += _mechanism(mechanism)
    for part, told in ROWS.items():
        if part in figures:
            rows += told(figures[part])
    faults += _unbalanced(figures.get("gears", {}))
    excitations = figures.get("excitations", [])
    faults += _near(excitations)
    return Answer(
        f"{figures['name']}: {_parts(figures)}",
        tuple(rows),
        tuple(faults),
        heads=HEADS,
        good="No frequency is near a natural one." if excitations else "",
        then="move a speed or a stiffness; campbell.png shows where"
        if any(source["near"] for source in excitations)
        else "",
    )


def _parts(figures: Mapping[str, Any]) -> str:
    count = len(figures.get("mechanisms", []))
    names = [f"{count} mechanism{'s' if count > 1 else ''}"] if count else []
    if "excitations" in figures:
        names.append(f"{len(figures['excitations'])} excitations")
    names += [part.replace("_", " ") for part in ("chassis", "gears", "rotor", "chain_drive") if part in figures]
    return ", ".join(names)


def _mechanism(found: Mapping[str, Any]) -> Iterator[Row]:
    """The shaking force of a mechanism, and what the counterweight with the least peak leaves of it."""
    shaking, best = found["shaking"], found.get("best", {}).get("least_peak")
    now = figure("max_n", shaking["max_n"]), figure("rms_n", shaking["rms_n"])
    if best is None:
        yield Row(found["name"], (*now, "", "", ""))
    else:
        added = f"{figure('counterweight_kg', best['counterweight_kg'])} at {figure('angle_deg', best['angle_deg'])}"
        left = figure("max_n", best["max_n"]), figure("rms_n", best["rms_n"])
        yield Row(found["name"], (*now, added, *left))
    if "even_crank" in found:
        even = found["even_crank"]
        yield Row("  on an even crank", (figure("max_n", even["max_n"]), figure("rms_n", even["rms_n"]), "", "", ""))
    if "complete" in found:
        complete = found["complete"]
        weights = " and ".join(
            f"{figure('counterweight_kg', complete[f'{part}_counterweight_kg'])} on the {part}"
            for part in ("rod", "crank")
        )
        yield Row("in full", (f"{weights} leave no force",))


def _frame(found: Mapping[str, Any]) -> Iterator[Row]:
    together = found["together"]
    yield Row("all on the frame", (figure("max_n", together["max_n"]), figure("rms_n", together["rms_n"]), "", "", ""))
    if "best_phase" in found:
        best = found["best_phase"]
        phase = f"{figure('phase_deg', best['phase_deg'])} of {best['of']}"
        yield Row("best phase", (f"{phase}: up to {figure('max_n', best['max_n'])}",))


def _chassis(found: Mapping[str, Any]) -> Iterator[Row]:
    against = figure("mass_kg", found["against_weight_kg"]), figure("mass_kg", found["against_inertia_worst_kg"])
    total = figure("total_worst_kg", found["total_worst_kg"])
    yield Row("chassis", (f"{total} at the tail: {against[0]} for the weight, {against[1]} for inertia",))


def _gears(found: Mapping[str, Any]) -> Iterator[Row]:
    for gear, balanced in found.items():
        key = "unbalance_kg_mm"
        said = f"unbalance {figure(key, balanced[key])}, {figure(key, balanced['permissible_kg_mm'])} permissible"
        if "corrected" in balanced:
            holes = len(balanced["corrected"]["holes"])
            said += (
                f"; {holes} holes leave {figure(key, balanced['corrected'][key])}" if holes else "; a boss cancels it"
            )
        yield Row(f"{gear} gear", (said,))


def _rotor(found: Mapping[str, Any]) -> Iterator[Row]:
    for number, plane in enumerate(found["planes"][:NAMED], start=1):
        weight = f"{figure('correction_g', plane['correction_g'])} at {figure('angle_deg', plane['angle_deg'])}"
        yield Row(f"rotor, plane {number}", (f"add {weight}",))


def _chain(found: Mapping[str, Any]) -> Iterator[Row]:
    for prediction in found["predictions"][:NAMED]:
        said = f"amplitude {to_digits(prediction['predicted_amplitude'], 3)} expected"
        if "correction_g" in prediction:
            correction = (
                figure("correction_g", prediction["correction_g"]),
                figure("angle_deg", prediction["correction_deg"]),
            )
            said += f"; {correction[0]} at {correction[1]} would cancel it"
        yield Row(f"chain drive, weight at {figure('weight_deg', prediction['weight_deg'])}", (said,))


ROWS = {"frame": _frame, "chassis": _chassis, "gears": _gears, "rotor": _rotor, "chain_drive": _chain}
"""The parts beside the mechanisms that have rows."""


def _unbalanced(gears: Mapping[str, Any]) -> list[Fault]:
    """Gears whose unbalance is felt; beside the weight of a slow gear, what a grade forbids is not."""
    return [
        Fault(
            f"the unbalance of the {gear} gear, {figure('force_n', gear_figures['unbalance_force_n'])}, is felt",
            ("correct it, as balance.json has it",),
        )
        for gear, gear_figures in gears.items()
        if gear_figures.get("worth_correcting")
    ]


def _near(excitations: list[Mapping[str, Any]]) -> list[Fault]:
    near = sorted((source for source in excitations if source["near"]), key=lambda source: abs(source["ratio"] - 1.0))
    return [
        Fault(
            f"{source['source']}, {source['kind']}: {figure('frequency_hz', source['frequency_hz'])} is "
            f"{fixed(100.0 * abs(source['ratio'] - 1.0), 1)} % from the natural "
            f"{figure('natural_hz', source['nearest_natural_hz'])}"
        )
        for source in near
    ]
