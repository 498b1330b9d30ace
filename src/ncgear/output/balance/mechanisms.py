"""Figures of the mechanisms of a balance file: what shakes, and what would stop it."""

from __future__ import annotations

from dataclasses import replace
from math import degrees
from typing import Any

from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.balance.accelerations import accelerations
from ncgear.balance.best import BestCounterweight, least_squares, minimax
from ncgear.balance.classical import Failure, Speed, failure
from ncgear.balance.joint_masses import complete_balance, joint_masses, partial_counterweight_kg
from ncgear.balance.mechanism import Carrier, Counterweight, Mechanism
from ncgear.balance.shaking import Shaking, shaking
from ncgear.balance.sweep import sweep
from ncgear.balance.waveform import Statistics
from ncgear.balancing import under
from ncgear.design import balance_mechanism as given_as
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.recipe.balance import crank_counterweight, joint_masses_of

EVEN = 1e-12
"""Relative difference of the crank's speeds below which it turns evenly: rounding."""


def mechanism_figures(given: given_as.Mechanism, mechanism: Mechanism) -> dict[str, Any]:
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


def _classical(mechanism: Mechanism) -> dict[str, Any]:
    """Textbook formulas beside the truth; of an uneven crank also the same linkage on an even one, as often."""
    if mechanism.linkage.offset_mm != 0.0:
        return {}
    if turns_evenly(mechanism):
        return {"two_terms": _failure_figures(failure(mechanism))}
    figures = {f"at_{speed}_speed": _failure_figures(failure(mechanism, speed)) for speed in Speed}
    even = replace(mechanism, transmission=uniform_law(mechanism.transmission.lobes))
    return {"two_terms": figures, "even_crank": shaking_figures(shaking(even))}


def turns_evenly(mechanism: Mechanism) -> bool:
    """Whether the crank's speed is constant."""
    slowest, fastest = mechanism.transmission.slope_range
    return fastest.value <= slowest.value * (1.0 + EVEN)


def _failure_figures(of: Failure) -> dict[str, float]:
    return {"max_n": of.peak_n, "largest_error_percent": 100.0 * of.largest_error}


def _complete(asked: given_as.Complete, mechanism: Mechanism) -> dict[str, float]:
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


def _partial(asked: given_as.Partial, mechanism: Mechanism) -> list[dict[str, float]]:
    joints, rows = joint_masses_of(asked, mechanism), []
    for share in asked.shares:
        mass = partial_counterweight_kg(mechanism.linkage, joints, asked.arm_mm, share)
        added = Counterweight(Carrier.CRANK, mass, asked.arm_mm)
        rows.append({"share": share, "counterweight_kg": mass, **_left(mechanism, added)})
    return rows


def _best(asked: given_as.Best, mechanism: Mechanism) -> dict[str, Any]:
    known = accelerations(mechanism)
    found = {"least_squares": least_squares(mechanism, known), "least_peak": minimax(mechanism, known)}
    return {name: _best_figures(one, asked.arm_mm, mechanism) for name, one in found.items()}


def _best_figures(found: BestCounterweight, arm_mm: float, mechanism: Mechanism) -> dict[str, float]:
    added = found.at(arm_mm)
    figures = {"counterweight_kg": added.mass_kg, "angle_deg": degrees(added.angle_rad), **_left(mechanism, added)}
    return figures if found.bound_n is None else {**figures, "certified_bound_n": found.bound_n}


def _left(mechanism: Mechanism, added: Counterweight) -> dict[str, float]:
    left = shaking(replace(mechanism, counterweights=(*mechanism.counterweights, added))).force
    return {"max_n": left.maximum, "rms_n": left.rms}


def _sweep(asked: given_as.Sweep, mechanism: Mechanism) -> list[dict[str, float]]:
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
