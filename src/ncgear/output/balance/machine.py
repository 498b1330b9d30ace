"""Figures of what stands on one frame: all mechanisms together, the chassis, frequencies beside natural ones."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from math import degrees
from typing import Any

from ncgear.balance.chassis import dynamic_counterweights, static_counterweight_kg
from ncgear.balance.excitation import Excitation, margins, of_engine, of_shaft, of_slider
from ncgear.balance.frame import Mounted, best_phase, frame_shaking, frame_sweep
from ncgear.balance.joint_masses import JointMasses, joint_masses
from ncgear.balance.opposed import Crank, reciprocating_share, rotating_share
from ncgear.balancing import Balancing
from ncgear.design.balance_mechanism import Sweep
from ncgear.output.balance.mechanisms import shaking_figures, statistics_figures, turns_evenly
from ncgear.recipe.balance import chassis_of, crank_counterweight, engines_of, shafts_of


def frame_figures(balancing: Balancing) -> dict[str, Any]:
    """All mechanisms together, each pair's shares, and the best phase where one is looked for."""
    mounted, balance = balancing.mounted, balancing.balance
    figures: dict[str, Any] = {"together": shaking_figures(frame_shaking(mounted)), "pairs": _pairs(balancing)}
    swept = [(number, one) for number, one in enumerate(balance.mechanisms) if one.sweep is not None]
    if swept:
        figures["sweeps"] = {one.name: _sweep(one.sweep, mounted, number) for number, one in swept if one.sweep}
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


def _sweep(asked: Sweep, mounted: list[Mounted], moved: int) -> list[dict[str, float]]:
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
