"""Figures of the mechanisms of a balance file: what shakes, and what would stop it.

Figures of what turns: gears, rotors balanced from readings, chain drives.

Figures of what stands on one frame: all mechanisms together, the chassis, frequencies beside natural ones.

All figures of a balance file, and how the terminal shows them.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from math import degrees, radians
from pathlib import Path
from typing import Any

from ncgear.balance.counterweights import BestCounterweight, least_squares, minimax, sweep
from ncgear.balance.excitation import Excitation, margins, of_engine, of_shaft, of_slider
from ncgear.balance.frame import (
    Crank,
    Mounted,
    best_phase,
    dynamic_counterweights,
    frame_shaking,
    frame_sweep,
    reciprocating_share,
    rotating_share,
    static_counterweight_kg,
)
from ncgear.balance.gears import GearBody
from ncgear.balance.mechanism import (
    Carrier,
    Counterweight,
    DrivenCrank,
    JointMasses,
    accelerations,
    complete_balance,
    joint_masses,
    partial_counterweight_kg,
)
from ncgear.balance.rotor import (
    ChainUnbalance,
    Range,
    balanced,
    chain_unbalance,
    grade_reached,
    opposite_weight_g,
    permissible_unbalance_kg_mm,
    predicted,
)
from ncgear.balance.shaking import Failure, Shaking, Speed, failure, shaking
from ncgear.balance.waveform import Statistics
from ncgear.design.keys import balance as given_as
from ncgear.design.keys.balance import ChainDrive, Rotor, Sweep
from ncgear.design.keys.balance import Mechanism as GivenMechanism
from ncgear.figures.numbers import label_and_unit, shown
from ncgear.numerics.units import N_M_PER_N_MM, RAD_S_PER_RPM
from ncgear.project.balancing import (
    BalancedGear,
    Balancing,
    chain_phases_of,
    chassis_of,
    crank_counterweight,
    engines_of,
    joint_masses_of,
    readings_of,
    shafts_of,
    trial_runs_of,
    under,
    weight_runs_of,
)
from ncgear.ratio.laws.uniform import uniform_law

EVEN = 1e-12
"""Relative difference of the crank's speeds below which it turns evenly: rounding."""


def mechanism_figures(given: given_as.Mechanism, mechanism: DrivenCrank) -> dict[str, Any]:
    """All that is asked about one mechanism, keys with units."""
    joints = joint_masses(mechanism.linkage, mechanism.masses)
    figures: dict[str, Any] = {
        "name": given.name,
        "rotating_kg": joints.rotating_kg,
        "reciprocating_kg": joints.reciprocating_kg,
        "shaking": shaking_figures(shaking(mechanism)),
        **_classical(mechanism),
    }
    if given.complete is not None:
        figures["complete"] = _complete(given.complete, mechanism)
    if given.partial is not None:
        figures["partial"] = _partial(given.partial, mechanism)
    if given.best is not None:
        figures["best"] = _best(given.best, mechanism)
    if given.sweep is not None:
        figures["sweep"] = _sweep(given.sweep, mechanism)
    return figures


def shaking_figures(of: Shaking) -> dict[str, float]:
    """Shaking force and moment."""
    return {
        **statistics_figures(of.force),
        "peak_at_deg": degrees(of.peak.at),
        "moment_max_n_m": N_M_PER_N_MM * max(abs(extremum.value) for extremum in of.moment.extremes),
        "moment_rms_n_m": N_M_PER_N_MM * of.moment.rms,
    }


def statistics_figures(of: Statistics) -> dict[str, float]:
    """The columns of the published tables."""
    return {
        "min_n": of.minimum,
        "max_n": of.maximum,
        "mean_n": of.mean,
        "rms_n": of.rms,
        "peak_to_peak_n": of.peak_to_peak,
    }


def _classical(mechanism: DrivenCrank) -> dict[str, Any]:
    """Textbook formulas beside the truth; of an uneven crank also the same linkage on an even one, as often."""
    if mechanism.linkage.offset_mm != 0.0:
        return {}
    if turns_evenly(mechanism):
        return {"two_terms": _failure_figures(failure(mechanism))}
    figures = {f"at_{speed}_speed": _failure_figures(failure(mechanism, speed)) for speed in Speed}
    even = replace(mechanism, transmission=uniform_law(mechanism.transmission.lobes))
    return {"two_terms": figures, "even_crank": shaking_figures(shaking(even))}


def turns_evenly(mechanism: DrivenCrank) -> bool:
    """Whether the crank's speed is constant."""
    slowest, fastest = mechanism.transmission.slope_range
    return fastest.value <= slowest.value * (1.0 + EVEN)


def _failure_figures(of: Failure) -> dict[str, float]:
    return {"max_n": of.peak_n, "largest_error_percent": 100.0 * of.largest_error}


def _complete(asked: given_as.Complete, mechanism: DrivenCrank) -> dict[str, float]:
    with under("complete"):
        found = complete_balance(mechanism.linkage, mechanism.masses, asked.rod_arm_mm, asked.crank_arm_mm)
    added = (
        Counterweight(Carrier.ROD, found.rod_kg, asked.rod_arm_mm),
        Counterweight(Carrier.CRANK, found.crank_kg, asked.crank_arm_mm),
    )
    left = shaking(replace(mechanism, counterweights=added))
    return {
        "rod_counterweight_kg": found.rod_kg,
        "mass_at_pin_kg": found.pin_kg,
        "crank_counterweight_kg": found.crank_kg,
        "moment_max_n_m": shaking_figures(left)["moment_max_n_m"],
    }


def _partial(asked: given_as.Partial, mechanism: DrivenCrank) -> list[dict[str, float]]:
    joints, rows = joint_masses_of(asked, mechanism), []
    for share in asked.shares:
        mass = partial_counterweight_kg(mechanism.linkage, joints, asked.arm_mm, share)
        added = Counterweight(Carrier.CRANK, mass, asked.arm_mm)
        rows.append({"share": share, "counterweight_kg": mass, **_left(mechanism, added)})
    return rows


def _best(asked: given_as.Best, mechanism: DrivenCrank) -> dict[str, Any]:
    known = accelerations(mechanism)
    found = {"least_squares": least_squares(mechanism, known), "least_peak": minimax(mechanism, known)}
    return {name: _best_figures(one, asked.arm_mm, mechanism) for name, one in found.items()}


def _best_figures(found: BestCounterweight, arm_mm: float, mechanism: DrivenCrank) -> dict[str, float]:
    added = found.at(arm_mm)
    figures = {"counterweight_kg": added.mass_kg, "angle_deg": degrees(added.angle_rad), **_left(mechanism, added)}
    return figures if found.bound_n is None else {**figures, "certified_bound_n": found.bound_n}


def _left(mechanism: DrivenCrank, added: Counterweight) -> dict[str, float]:
    left = shaking(replace(mechanism, counterweights=(*mechanism.counterweights, added))).force
    return {"max_n": left.maximum, "rms_n": left.rms}


def _sweep(asked: given_as.Sweep, mechanism: DrivenCrank) -> list[dict[str, float]]:
    tried = sweep(mechanism, crank_counterweight(asked), asked.masses_kg)
    return [
        {
            "counterweight_kg": one.mass_kg,
            **{f"bearing_{key}": value for key, value in statistics_figures(one.bearing_n).items()},
            "shaking_max_n": one.shaking_n.maximum,
            "shaking_rms_n": one.shaking_n.rms,
            "track_along_mm": one.track.extent_mm[0],
            "track_across_mm": one.track.extent_mm[1],
            "track_area_mm2": one.track.area_mm2,
        }
        for one in tried
    ]


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
        holes, boss = gear.corrected.holes, gear.corrected.boss
        figures["corrected"] = {
            **_body(gear.corrected.body, gear.speed_rad_s, grade),
            "holes": [{"x_mm": hole.x_mm, "y_mm": hole.y_mm, "diameter_mm": hole.diameter_mm} for hole in holes],
            "boss_height_mm": boss.height_mm if boss else None,
            "boss_area_mm2": float(boss.section.area) if boss else None,
        }
    return figures


def _body(body: GearBody, speed_rad_s: float, grade: float) -> dict[str, Any]:
    permissible = permissible_unbalance_kg_mm(grade, body.mass_kg, speed_rad_s)
    unbalance = abs(body.unbalance_kg_mm)
    return {
        "mass_kg": body.mass_kg,
        "eccentricity_mm": body.eccentricity_mm,
        "direction_deg": degrees(phase(body.unbalance_kg_mm)),
        "inertia_kg_mm2": body.inertia_kg_mm2,
        "unbalance_kg_mm": unbalance,
        "couple_kg_mm2": abs(body.couple_kg_mm2),
        "permissible_kg_mm": permissible,
        "permitted": unbalance <= permissible,
        "grade_reached": _finite(grade_reached(unbalance, body.mass_kg, speed_rad_s)),
    }


def _finite(grade: float) -> float | None:
    """JSON knows no infinity: none of the grades."""
    return grade if grade < float("inf") else None


def rotor_figures(balancing: Balancing) -> dict[str, Any]:
    """Corrections of a rotor and the readings they should leave."""
    asked = balancing.balance.rotor
    assert asked is not None
    found = balanced(readings_of(asked.first), trial_runs_of(asked), "rotor.trials")
    return {
        "planes": [_polar(weight, "correction_g", "angle_deg") for weight in found.weights],
        "sensors": [_polar(left, "expected_amplitude", "phase_deg") for left in found.residual],
        **_permissible(asked),
    }


def _permissible(asked: Rotor) -> dict[str, float]:
    """What may be left of the grade, as a weight at the corrections' radius; of all planes together."""
    if asked.mass_kg is None or asked.radius_mm is None:
        return {}
    allowed = permissible_unbalance_kg_mm(asked.grade, asked.mass_kg, asked.speed_rpm * RAD_S_PER_RPM)
    return {"permissible_kg_mm": allowed, "permissible_weight_g": 1000.0 * allowed / asked.radius_mm}


def chain_figures(balancing: Balancing) -> dict[str, Any]:
    """Ranges of a chain drive's equivalent unbalance, and predictions."""
    asked = balancing.balance.chain_drive
    assert asked is not None
    found = chain_unbalance(weight_runs_of(asked), chain_phases_of(asked), "chain_drive.runs")
    return {
        "effect_of_weight": _range(found.weight),
        "tight_side": _range(found.tight),
        "slack_side": _range(found.slack),
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


def _range(of: Range) -> dict[str, float]:
    return {"low": of.low, "high": of.high}


def frame_figures(balancing: Balancing) -> dict[str, Any]:
    """All mechanisms together, each pair's shares, and the best phase where one is looked for."""
    mounted, balance = balancing.mounted, balancing.balance
    figures: dict[str, Any] = {"together": shaking_figures(frame_shaking(mounted)), "pairs": _pairs(balancing)}
    swept = [(number, one) for number, one in enumerate(balance.mechanisms) if one.sweep is not None]
    if swept:
        figures["sweeps"] = {
            one.name: _sweep_of_machine(one.sweep, mounted, number) for number, one in swept if one.sweep
        }
    if balance.move_phase_of is not None:
        moved = [one.name for one in balance.mechanisms].index(balance.move_phase_of)
        found = best_phase(mounted, moved)
        best = [replace(one, phase_rad=found.at) if k == moved else one for k, one in enumerate(mounted)]
        figures["best_phase"] = {
            "of": balance.move_phase_of,
            "phase_deg": degrees(found.at),
            **shaking_figures(frame_shaking(best)),
        }
    return figures


def _sweep_of_machine(asked: Sweep, mounted: list[Mounted], moved: int) -> list[dict[str, float]]:
    """The counterweights of one mechanism tried with all the others."""
    tried = frame_sweep(mounted, moved, crank_counterweight(asked), asked.masses_kg)
    return [
        {
            "counterweight_kg": mass,
            **{f"shaking_{key}": value for key, value in statistics_figures(force.force).items()},
            "track_along_mm": way.extent_mm[0],
            "track_across_mm": way.extent_mm[1],
            "track_area_mm2": way.area_mm2,
        }
        for mass, force, way in tried
    ]


def _pairs(balancing: Balancing) -> list[dict[str, Any]]:
    """eta1 and eta2, of long rods, for every two even cranks whose sliders move along one direction."""
    names = [one.name for one in balancing.balance.mechanisms]
    even = [pair for pair in zip(names, balancing.mounted, strict=True) if turns_evenly(pair[1].mechanism)]
    return [
        {
            "first": name,
            "second": other_name,
            "eta1": reciprocating_share(_crank(one), _crank(other)),
            "eta2": rotating_share(_crank(one), _crank(other)),
        }
        for (name, one), (other_name, other) in combinations(even, 2)
        if one.direction_rad == other.direction_rad and _massive(one) and _massive(other)
    ]


def _massive(one: Mounted) -> bool:
    """Whether there is anything to share."""
    joints = joint_masses(one.mechanism.linkage, one.mechanism.masses)
    return joints.reciprocating_kg != 0.0 and joints.rotating_kg != 0.0


def _crank(one: Mounted) -> Crank:
    """The crank as the formulas have it: its angle in the frame at time zero, in the sense of its turning.

    Masses are weighted by the crank's length, by which their forces go.
    """
    sense, crank = (-1 if one.mirrored else 1), one.mechanism.linkage.crank_mm
    joints = joint_masses(one.mechanism.linkage, one.mechanism.masses)
    weighted = JointMasses(crank * joints.rotating_kg, crank * joints.reciprocating_kg)
    return Crank(weighted, sense * one.phase_rad, sense)


def chassis_figures(balancing: Balancing) -> dict[str, Any]:
    """Counterweights at the tail; the worst case beside the dead centres."""
    asked = balancing.balance.chassis
    assert asked is not None
    number = [one.name for one in balancing.balance.mechanisms].index(asked.mechanism)
    chassis = chassis_of(asked)
    found = dynamic_counterweights(chassis, balancing.mounted[number].mechanism)
    static = static_counterweight_kg(chassis, asked.slider_kg, asked.weight_kg, asked.weight_lever_mm)
    return {
        "against_inertia_retracted_kg": found.retracted_kg,
        "against_inertia_extended_kg": found.extended_kg,
        "against_inertia_worst_kg": found.worst_kg.value,
        "worst_at_deg": degrees(found.worst_kg.at),
        "against_weight_kg": static,
        "total_retracted_kg": found.retracted_kg + static,
        "total_worst_kg": found.worst_kg.value + static,
    }


def excitations_of(balancing: Balancing) -> list[Excitation]:
    """All excitations a file has."""
    asked = balancing.balance.excitations
    assert asked is not None
    named = zip(balancing.balance.mechanisms, balancing.mounted, strict=True)
    return [
        *(one for engine in engines_of(asked) for one in of_engine(engine)),
        *(one for shaft in shafts_of(asked) for one in of_shaft(shaft)),
        *(h for given, one in named if asked.harmonics for h in of_slider(given.name, one.mechanism, asked.harmonics)),
    ]


def excitation_figures(balancing: Balancing) -> list[dict[str, Any]]:
    """The table of margins."""
    asked = balancing.balance.excitations
    assert asked is not None
    return [
        {
            "source": one.excitation.source,
            "kind": one.excitation.kind,
            "frequency_hz": one.excitation.frequency_hz,
            "amplitude_m_s2": one.excitation.amplitude,
            "nearest_natural_hz": one.natural_hz,
            "ratio": one.ratio,
            "near": one.near,
        }
        for one in margins(excitations_of(balancing), asked.natural_hz, asked.band)
    ]


PARTS = {
    "chassis": chassis_figures,
    "excitations": excitation_figures,
    "gears": gear_figures,
    "rotor": rotor_figures,
    "chain_drive": chain_figures,
}
"""Parts of the file beside its mechanisms, and what is computed of each."""


def figures_of(balancing: Balancing) -> dict[str, Any]:
    """Every figure by the name of its part; keys end in their units."""
    balance = balancing.balance
    figures: dict[str, Any] = {"name": balance.name}
    if balance.mechanisms:
        pairs = zip(balance.mechanisms, balancing.mounted, strict=True)
        figures["mechanisms"] = [_of_mechanism(number, *pair) for number, pair in enumerate(pairs)]
    if len(balance.mechanisms) > 1:
        figures["frame"] = frame_figures(balancing)
    asked = {part: answer for part, answer in PARTS.items() if getattr(balance, part) is not None}
    return {**figures, **{part: answer(balancing) for part, answer in asked.items()}}


def _of_mechanism(number: int, given: GivenMechanism, mounted: Mounted) -> dict[str, Any]:
    with under(f"mechanisms.{number}"):
        return mechanism_figures(given, mounted.mechanism)


def balance_text(figures: Mapping[str, Any], paths: Sequence[Path]) -> str:
    """The figures as indented lines and tables, and the files written."""
    lines = [str(figures["name"])]
    for part, content in figures.items():
        if part == "mechanisms":
            for mechanism in content:
                lines += ["", mechanism["name"], *_lines({k: v for k, v in mechanism.items() if k != "name"})]
        elif part != "name":
            lines += ["", part.replace("_", " "), *_content(content)]
    return "\n".join([*lines, "", "Written", *(f"  {path}" for path in paths)])


def _content(content: Any) -> list[str]:
    return _table(content) if isinstance(content, list) else _lines(content)


def _lines(figures: Mapping[str, Any]) -> list[str]:
    """One line for each figure; groups and tables indented below their names."""
    plain = {key: value for key, value in figures.items() if not _is_group(value)}
    width = max((len(label_and_unit(key)[0]) for key in plain), default=0)
    lines = []
    for key, value in figures.items():
        label, unit = label_and_unit(key)
        if _is_group(value):
            lines += [f"  {key.replace('_', ' ')}", *(f"  {line}" for line in _content(value))]
        else:
            lines.append(f"  {label:<{width}}  {shown(value)} {unit if value is not None else ''}".rstrip())
    return lines


def _is_group(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def _table(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Columns as wide as their widest cell; those without any value are left out."""
    keys = [key for key in rows[0] if any(row[key] is not None for row in rows)] if rows else []
    heads = [", ".join(part for part in label_and_unit(key) if part) for key in keys]
    cells = [heads, *([shown(row[key]) for key in keys] for row in rows)]
    widths = [max(len(line[k]) for line in cells) for k in range(len(keys))]
    return ["  " + "  ".join(f"{cell:>{width}}" for cell, width in zip(line, widths, strict=True)) for line in cells]
