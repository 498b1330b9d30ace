"""Shaking forces and their cure: each mechanism, all mechanisms on one frame, the chassis, natural frequencies."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from math import degrees, radians
from typing import Any

from ncgear.balance import frame
from ncgear.balance.counterweights import least_squares, minimax, sweep
from ncgear.balance.excitation import Engine, Excitation, Shaft, margins, of_engine, of_shaft, of_slider
from ncgear.balance.mechanism import (
    Counterweight,
    DrivenCrank,
    JointMasses,
    accelerations,
    complete_balance,
    joint_masses,
    partial_counterweight,
)
from ncgear.balance.shaking import Shaking, Speed, Track, TwoTermFormula, shaking, two_term_formula
from ncgear.balance.waveform import Statistics
from ncgear.design.keys import balance as keys
from ncgear.errors import below
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.project.balancing import Balancing, crank_counterweight, joint_masses_of
from ncgear.ratio.laws.uniform import uniform_law

EVEN = 1e-12
"""A crank whose speeds differ by less than this, relatively, turns evenly: the difference is rounding."""


def mechanism_figures(given: keys.Mechanism, mechanism: DrivenCrank) -> dict[str, Any]:
    """All figures that the file asks for of one mechanism; keys end in their unit."""
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
        parts, rows = joint_masses_of(given.partial, mechanism), []
        for share in given.partial.shares:
            added = partial_counterweight(mechanism, parts, given.partial.arm_mm, share)
            rows.append({"share": share, **_added(added), **_left(mechanism, added)})
        figures["partial"] = rows
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
    """How far textbook formulas are from the exact forces; empty for an offset slider.

    For a crank that turns unevenly, also the forces of the same mechanism on an even crank with as many turns.
    """
    if mechanism.linkage.offset_mm != 0.0:
        return {}
    if turns_evenly(mechanism):
        return {"two_terms": _two_term_figures(two_term_formula(mechanism))}
    figures = {f"at_{speed}_speed": _two_term_figures(two_term_formula(mechanism, speed)) for speed in Speed}
    even = replace(mechanism, transmission=uniform_law(mechanism.transmission.lobes))
    return {"two_terms": figures, "even_crank": shaking_figures(shaking(even))}


def turns_evenly(mechanism: DrivenCrank) -> bool:
    """Whether the crank's speed is constant."""
    slowest, fastest = mechanism.transmission.slope_range
    return fastest.value <= slowest.value * (1.0 + EVEN)


def _two_term_figures(of: TwoTermFormula) -> dict[str, float]:
    return {"max_n": of.peak_n, "largest_error_percent": 100.0 * of.largest_error}


def _complete(asked: keys.Complete, mechanism: DrivenCrank) -> dict[str, float]:
    with below("complete"):
        found = complete_balance(mechanism, asked.rod_arm_mm, asked.crank_arm_mm)
    left = shaking(replace(mechanism, counterweights=(*mechanism.counterweights, found.rod, found.crank)))
    return {
        "rod_counterweight_kg": found.rod.mass_kg,
        "rod_angle_deg": degrees(found.rod.angle_rad),
        "mass_at_pin_kg": found.pin_kg,
        "crank_counterweight_kg": found.crank.mass_kg,
        "crank_angle_deg": degrees(found.crank.angle_rad),
        "moment_max_n_m": shaking_figures(left)["moment_max_n_m"],
    }


def _added(counterweight: Counterweight) -> dict[str, float]:
    return {"counterweight_kg": counterweight.mass_kg, "angle_deg": degrees(counterweight.angle_rad)}


def _best(asked: keys.Best, mechanism: DrivenCrank) -> dict[str, Any]:
    known = accelerations(mechanism)
    figures: dict[str, Any] = {}
    for name, found in ("least_squares", least_squares(mechanism, known)), ("least_peak", minimax(mechanism, known)):
        added = found.at(asked.arm_mm)
        figures[name] = {
            **_added(added),
            **_left(mechanism, added),
            **({} if found.bound_n is None else {"certified_bound_n": found.bound_n}),
        }
    return figures


def _left(mechanism: DrivenCrank, added: Counterweight) -> dict[str, float]:
    left = shaking(mechanism.with_counterweight(added)).force
    return {"max_n": left.maximum, "rms_n": left.rms}


def _sweep(asked: keys.Sweep, mechanism: DrivenCrank) -> list[dict[str, float]]:
    tried = sweep(mechanism, crank_counterweight(asked), asked.masses_kg)
    return [
        {
            "counterweight_kg": step.mass_kg,
            **{f"bearing_{key}": value for key, value in statistics_figures(step.bearing_n).items()},
            "shaking_max_n": step.shaking_n.maximum,
            "shaking_rms_n": step.shaking_n.rms,
            **_track(step.track),
        }
        for step in tried
    ]


def _track(of: Track) -> dict[str, float]:
    return {"track_along_mm": of.extent_mm[0], "track_across_mm": of.extent_mm[1], "track_area_mm2": of.area_mm2}


def frame_figures(balancing: Balancing) -> dict[str, Any]:
    """All mechanisms together, the shares of each pair, and the best phase where the file asks for one."""
    mounted, balance = balancing.mounted, balancing.balance
    figures: dict[str, Any] = {"together": shaking_figures(frame.frame_shaking(mounted)), "pairs": _pairs(balancing)}
    sweeps = {
        mechanism.name: _sweep_of_machine(mechanism.sweep, mounted, number)
        for number, mechanism in enumerate(balance.mechanisms)
        if mechanism.sweep is not None
    }
    if sweeps:
        figures["sweeps"] = sweeps
    if balance.move_phase_of is not None:
        moved = [mechanism.name for mechanism in balance.mechanisms].index(balance.move_phase_of)
        found = frame.best_phase(mounted, moved)
        best = [replace(in_frame, phase_rad=found.at) if k == moved else in_frame for k, in_frame in enumerate(mounted)]
        figures["best_phase"] = {
            "of": balance.move_phase_of,
            "phase_deg": degrees(found.at),
            **shaking_figures(frame.frame_shaking(best)),
        }
    return figures


def _sweep_of_machine(asked: keys.Sweep, mounted: list[frame.Mounted], moved: int) -> list[dict[str, float]]:
    tried = frame.frame_sweep(mounted, moved, crank_counterweight(asked), asked.masses_kg)
    return [
        {
            "counterweight_kg": mass,
            **{f"shaking_{key}": value for key, value in statistics_figures(force.force).items()},
            **_track(track),
        }
        for mass, force, track in tried
    ]


def _pairs(balancing: Balancing) -> list[dict[str, Any]]:
    """eta1 and eta2 of long rods, for every two cranks that turn evenly and whose sliders move along one direction."""
    names = [mechanism.name for mechanism in balancing.balance.mechanisms]
    even = [pair for pair in zip(names, balancing.mounted, strict=True) if turns_evenly(pair[1].mechanism)]
    return [
        {
            "first": name,
            "second": other_name,
            "eta1": frame.reciprocating_share(_crank(mechanism), _crank(other)),
            "eta2": frame.rotating_share(_crank(mechanism), _crank(other)),
        }
        for (name, mechanism), (other_name, other) in combinations(even, 2)
        if mechanism.direction_rad == other.direction_rad and _massive(mechanism) and _massive(other)
    ]


def _massive(mounted: frame.Mounted) -> bool:
    joints = joint_masses(mounted.mechanism.linkage, mounted.mechanism.masses)
    return joints.reciprocating_kg != 0.0 and joints.rotating_kg != 0.0


def _crank(mounted: frame.Mounted) -> frame.Crank:
    """The crank of the formulas; its angle is the one in the frame at time zero, in the sense of its turning.

    Masses are multiplied by the crank's length, because their forces are proportional to it.
    """
    sense, crank = (-1 if mounted.mirrored else 1), mounted.mechanism.linkage.crank_mm
    joints = joint_masses(mounted.mechanism.linkage, mounted.mechanism.masses)
    weighted = JointMasses(crank * joints.rotating_kg, crank * joints.reciprocating_kg)
    return frame.Crank(weighted, sense * mounted.phase_rad, sense)


def chassis_figures(balancing: Balancing) -> dict[str, Any]:
    """Counterweights at the tail: the worst case, and those at the dead centres."""
    asked = balancing.balance.chassis
    assert asked is not None
    number = [mechanism.name for mechanism in balancing.balance.mechanisms].index(asked.mechanism)
    chassis = frame.Chassis(asked.support_mm, asked.counterweight_mm, radians(asked.tilt_deg))
    found = frame.dynamic_counterweights(chassis, balancing.mounted[number].mechanism)
    static = frame.static_counterweight_kg(chassis, asked.slider_kg, asked.weight_kg, asked.weight_lever_mm)
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
    """All excitations in the file."""
    asked = balancing.balance.excitations
    assert asked is not None
    named = zip(balancing.balance.mechanisms, balancing.mounted, strict=True)
    engines = (Engine(of.name, of.speed_rpm, of.cylinders, of.strokes, of.inertia_order) for of in asked.engines)
    shafts = (Shaft(of.name, of.speed_rpm, of.rollers, of.teeth, of.roller_ratio) for of in asked.shafts)
    return [
        *(excitation for engine in engines for excitation in of_engine(engine)),
        *(excitation for shaft in shafts for excitation in of_shaft(shaft)),
        *(
            h
            for given, mounted in named
            if asked.harmonics
            for h in of_slider(given.name, mounted.mechanism, asked.harmonics)
        ),
    ]


def excitation_figures(balancing: Balancing) -> list[dict[str, Any]]:
    """The table of margins."""
    asked = balancing.balance.excitations
    assert asked is not None
    return [
        {**vars(near.excitation), "nearest_natural_hz": near.nearest_natural_hz, "ratio": near.ratio, "near": near.near}
        for near in margins(excitations_of(balancing), asked.natural_hz, asked.band)
    ]
