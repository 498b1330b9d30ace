"""Permissible unbalance by the grades of ISO 21940-11 (values from secondary sources).

A grade G is the speed in mm/s at which a rigid rotor's centre of mass may go round: e = G / w, U = e m.

Balancing a rotor on its own bearings from readings with trial weights: the method of influence coefficients.

Readings are complex: amplitude times exp(i phase), as are weights.  A weight W in a plane changes the reading of a
sensor by its coefficient times W; one run with a trial weight in each plane gives all coefficients, and the corrections
are the weights that cancel the first run's readings, in the mean square where there are more sensors than planes.
T. P. Goodman, "A least-squares method for computing balance corrections", J. Eng. Ind. 86 (1964) 273-279.

The equivalent unbalance of a chain drive at a rotor's side: what the chain adds to every reading.

Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu, "Effects of Side Load Chains of a Combine Harvester on Unbalanced Dynamic
Vibrations of Its Threshing Drum", Shock and Vibration 2021, eqs. 1 to 13.  Reading C = chain A + weight B, as complex
numbers amplitude times exp(i phase), phases as the instrument counts them.  How much a weight adds is not known
beforehand: it is within the range in which every A lies on the side of the wrap.  A is then resolved into a tight side
A1 and a slack side A2 of given phases.
"""

from __future__ import annotations

from bisect import bisect_left
from cmath import exp
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import ComplexArray

GRADES_MM_S = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)
"""G 6.3 for machines and gears in general, G 16 for agricultural machinery."""


def permissible_unbalance_kg_mm(grade_mm_s: float, mass_kg: float, speed_rad_s: float) -> float:
    """U of a rotor at its highest speed, for both of its planes together; all arguments over zero."""
    return grade_mm_s / speed_rad_s * mass_kg


def grade_reached(unbalance_kg_mm: float, mass_kg: float, speed_rad_s: float) -> float:
    """The finest grade that an unbalance meets; infinity where it meets none."""
    reached = bisect_left(GRADES_MM_S, unbalance_kg_mm / mass_kg * speed_rad_s)
    return GRADES_MM_S[reached] if reached < len(GRADES_MM_S) else inf


LEAST_EFFECT = 1e-3
"""Share of the first readings by which a trial weight must change them: instruments show three digits."""

WORST_CONDITION = 1e3
"""Condition of the coefficients beyond which errors of readings in the third digit are all that corrections are of."""


@dataclass(frozen=True)
class TrialRun:
    """One run: the plane's trial weight (mass times exp(i angle)) and every sensor's reading with it."""

    weight: complex
    readings: tuple[complex, ...]


@dataclass(frozen=True, eq=False)
class Correction:
    """Coefficients (shape (sensors, planes)), the corrections of all planes, and the readings they should leave."""

    coefficients: ComplexArray
    weights: tuple[complex, ...]
    residual: tuple[complex, ...]


def balanced(first: Sequence[complex], trials: Sequence[TrialRun], key: str = "trials") -> Correction:
    """The corrections from the readings without weights and one trial in each plane, taken off again after its run.

    Raises WrongInput for ``key`` where sensors are fewer than planes, a trial has no weight or shows no effect, or the
    planes cannot be told apart by their effects.
    """
    start = np.array(first)
    _refuse(start, trials, key)
    columns = [(np.array(run.readings) - start) / run.weight for run in trials]
    coefficients: ComplexArray = np.column_stack(columns)
    scaled = coefficients / np.linalg.norm(coefficients, axis=0)
    if np.linalg.cond(scaled) > WORST_CONDITION:
        raise WrongInput("the trial weights' effects are all alike; choose planes farther apart", key=key)
    weights = np.linalg.lstsq(coefficients, -start, rcond=None)[0]
    residual = start + coefficients @ weights
    return Correction(coefficients, tuple(weights.tolist()), tuple(residual.tolist()))


def _refuse(start: ComplexArray, trials: Sequence[TrialRun], key: str) -> None:
    if len(trials) > start.size:
        raise WrongInput(f"{len(trials)} planes for {start.size} sensors; at least as many sensors are needed", key=key)
    for number, run in enumerate(trials):
        place = f"{key}.{number}"
        if len(run.readings) != start.size:
            problem = f"{len(run.readings)} readings, but the first run has {start.size}; give one for each sensor"
            raise WrongInput(problem, key=f"{place}.readings")
        if run.weight == 0:
            raise WrongInput("a trial weight of 0 shows nothing; give its mass", key=f"{place}.mass_g")
        if np.linalg.norm(np.array(run.readings) - start) <= LEAST_EFFECT * np.linalg.norm(start):
            raise WrongInput("the trial weight changes nothing; a heavier one is needed", key=f"{place}.readings")


ACROSS = 1e-12
"""Cosine of the angle between weight and wrap below which the weight stands across it: rounding of degrees."""


@dataclass(frozen=True)
class WeightRun:
    """A run with one weight at a phase in rad, and the reading."""

    phase_rad: float
    reading: complex


@dataclass(frozen=True)
class Range:
    """From the smallest to the largest amplitude."""

    low: float
    high: float


@dataclass(frozen=True)
class ChainPhases:
    """Phases in rad: the middle of the wrap, and the equivalent unbalance of the tight and of the slack side."""

    wrap_rad: float
    tight_rad: float
    slack_rad: float


@dataclass(frozen=True)
class ChainUnbalance:
    """Ranges of the amplitudes: of the weight used in the runs (L_B), of the tight (L_A1) and the slack side (L_A2)."""

    weight: Range
    tight: Range
    slack: Range


@dataclass(frozen=True)
class Prediction:
    """Bounds of the reading with a weight, one by each side of the chain, and half the larger amplitude, as
    expected."""

    by_tight: complex
    by_slack: complex
    amplitude: float


def chain_unbalance(runs: Sequence[WeightRun], phases: ChainPhases, key: str = "runs") -> ChainUnbalance:
    """The ranges that all runs with one and the same weight allow; the paper counts amplitudes of the sides from zero.

    Everything is linear in L_B, so that the largest values are at the ends of its range.  Raises WrongInput for ``key``
    where no L_B puts every chain's part on the side of the wrap.
    """
    weight = _weight_range(runs, phases.wrap_rad)
    if not weight.low < weight.high < inf:
        raise WrongInput("no effect of the weight puts the chain's part of all runs on the side of the wrap", key=key)
    ends = (weight.low, weight.high)
    sides = [_sides(run.reading - end * exp(1j * run.phase_rad), phases) for run in runs for end in ends]
    tight, slack = (Range(min(column), max(column)) for column in zip(*sides, strict=True))
    return ChainUnbalance(weight, tight, slack)


def predicted(unbalance: ChainUnbalance, phases: ChainPhases, weight_phase_rad: float) -> Prediction:
    """Readings to expect with the weight of the runs at a phase: all of one side and none of the other, the larger.

    The weight counts with its largest effect, which gives the published 1.24 and 1.4 mm/s from the published ranges.
    """
    weight = unbalance.weight.high * exp(1j * weight_phase_rad)
    tight = weight + unbalance.tight.high * exp(1j * phases.tight_rad)
    slack = weight + unbalance.slack.high * exp(1j * phases.slack_rad)
    return Prediction(tight, slack, max(abs(tight), abs(slack)) / 2.0)


def opposite_weight_g(amplitude: float, phase_rad: float, effect_per_g: float) -> complex:
    """The weight against an unbalance: amplitude by effect in grams, at the opposite phase."""
    return amplitude / effect_per_g * exp(1j * (phase_rad + pi))


def _weight_range(runs: Sequence[WeightRun], wrap_rad: float) -> Range:
    """L_B for which (C - L_B exp(i phase)) has a part towards the middle of the wrap in every run."""
    low, high = 0.0, inf
    for run in runs:
        toward = (run.reading * exp(-1j * wrap_rad)).real
        slope = exp(1j * (run.phase_rad - wrap_rad)).real
        # toward - L slope > 0
        if slope > ACROSS:
            high = min(high, toward / slope)
        elif slope < -ACROSS:
            low = max(low, toward / slope)
        elif toward <= 0.0:
            return Range(inf, -inf)
    return Range(low, high)


def _sides(chain: complex, phases: ChainPhases) -> tuple[float, float]:
    """Amplitudes of both sides whose sum is the chain's part: two equations in two unknowns."""
    tight, slack = exp(1j * phases.tight_rad), exp(1j * phases.slack_rad)
    across = (tight.conjugate() * slack).imag
    return (chain.conjugate() * slack).imag / across, -(chain.conjugate() * tight).imag / across
