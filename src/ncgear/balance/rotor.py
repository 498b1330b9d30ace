"""Balancing a rotor on its own bearings: permissible unbalance, correction weights, and a chain at its side.

Readings and weights are complex numbers: amplitude or mass times exp(i phase), phases as the instrument counts them.

Permissible unbalance follows from the grades of ISO 21940-11 (values from secondary sources).  A grade G is the speed
in mm/s at which the centre of mass of a rigid rotor may go round: e = G / w, U = e m.

Correction weights follow from influence coefficients.  A weight W in a plane changes the reading of a sensor by a
coefficient times W, and one run with a trial weight in each plane gives all coefficients.  The corrections are the
weights that cancel the readings of the first run, in the mean square where there are more sensors than planes.
T. P. Goodman, "A least-squares method for computing balance corrections", J. Eng. Ind. 86 (1964) 273-279.

A chain drive at the rotor's side adds its equivalent unbalance A to every reading: C = A + B with the weight's part B.
The effect of a weight is not known beforehand; it lies in the range that puts every A on the side of the wrap. A is
then resolved into a tight side A1 and a slack side A2 of given phases.  Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu, "Effects
of Side Load Chains of a Combine Harvester on Unbalanced Dynamic Vibrations of Its Threshing Drum", Shock and Vibration
2021, eqs. 1 to 13.
"""

from __future__ import annotations

from bisect import bisect_left
from cmath import exp
from collections.abc import Sequence
from math import inf, pi

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import ComplexArray

# --- permissible unbalance ------------------------------------------------------------------------------------------

GRADES_MM_S = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)
"""Balance grades: G 6.3 is for machines and gears in general, G 16 for agricultural machinery."""


def permissible_unbalance_kg_mm(grade_mm_s: float, mass_kg: float, speed_rad_s: float) -> float:
    """U of a rotor at its highest speed, for both of its planes together; all arguments are positive."""
    return grade_mm_s / speed_rad_s * mass_kg


def grade_reached(unbalance_kg_mm: float, mass_kg: float, speed_rad_s: float) -> float:
    """The finest grade that allows an unbalance; infinity where no grade allows it."""
    reached = bisect_left(GRADES_MM_S, unbalance_kg_mm / mass_kg * speed_rad_s)
    return GRADES_MM_S[reached] if reached < len(GRADES_MM_S) else inf


# --- corrections from trial weights ---------------------------------------------------------------------------------

LEAST_EFFECT = 1e-3
"""Least relative change of the first readings by a trial weight: instruments show three digits."""

WORST_CONDITION = 1e3
"""Condition number beyond which an error in the third digit of a reading is as large as the corrections."""


@dataclass(frozen=True)
class TrialRun:
    """A run with a trial weight in one plane: the weight, and the reading of every sensor with it."""

    weight: complex
    readings: tuple[complex, ...]


@dataclass(frozen=True, eq=False)
class Correction:
    """Coefficients (shape (sensors, planes)), the corrections of all planes, and the readings they should leave."""

    coefficients: ComplexArray
    weights: tuple[complex, ...]
    residual: tuple[complex, ...]


def balanced(first: Sequence[complex], trials: Sequence[TrialRun], key: str = "trials") -> Correction:
    """The corrections from readings without weights, and with a trial weight in one plane after the other.

    Raises WrongInput for ``key`` for fewer sensors than planes, trials without weight or effect, and planes with the
    same effect.
    """
    start = np.array(first)
    _check_trials(start, trials, key)
    columns = [(np.array(run.readings) - start) / run.weight for run in trials]
    coefficients: ComplexArray = np.column_stack(columns)
    scaled = coefficients / np.linalg.norm(coefficients, axis=0)
    if np.linalg.cond(scaled) > WORST_CONDITION:
        raise WrongInput("the trial weights' effects are all alike; choose planes farther apart", key=key)
    weights = np.linalg.lstsq(coefficients, -start, rcond=None)[0]
    residual = start + coefficients @ weights
    return Correction(coefficients, tuple(weights.tolist()), tuple(residual.tolist()))


def _check_trials(start: ComplexArray, trials: Sequence[TrialRun], key: str) -> None:
    """Raises WrongInput where runs do not fit the sensors, or a trial weight is zero or without effect."""
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


# --- a chain at the rotor's side -------------------------------------------------------------------------------------

ACROSS = 1e-12
"""Cosine of the angle between weight and wrap below which they are at right angles: rounding of degrees."""


@dataclass(frozen=True)
class WeightRun:
    """A run with the weight at a phase in rad, and the reading."""

    phase_rad: float
    reading: complex


@dataclass(frozen=True)
class AmplitudeRange:
    """From the smallest to the largest amplitude."""

    low: float
    high: float


@dataclass(frozen=True)
class ChainPhases:
    """Phases in rad: of the middle of the wrap, and of the equivalent unbalance of the tight and of the slack side."""

    wrap_rad: float
    tight_rad: float
    slack_rad: float


@dataclass(frozen=True)
class ChainUnbalance:
    """Ranges of the amplitudes: of the weight of the runs (L_B), the tight side (L_A1) and the slack side (L_A2)."""

    weight: AmplitudeRange
    tight: AmplitudeRange
    slack: AmplitudeRange


@dataclass(frozen=True)
class Prediction:
    """Bounds of the reading with a weight, one for each side of the chain; ``amplitude`` is half the larger bound."""

    by_tight: complex
    by_slack: complex
    amplitude: float


def chain_unbalance(runs: Sequence[WeightRun], phases: ChainPhases, key: str = "runs") -> ChainUnbalance:
    """The ranges that all runs with the same weight allow; amplitudes of the sides start from zero, as in the paper.

    All is linear in L_B. Raises WrongInput for ``key`` where no L_B puts every run's chain part on the wrap's side.
    """
    weight = _weight_range(runs, phases.wrap_rad)
    if not weight.low < weight.high < inf:
        raise WrongInput("no effect of the weight puts the chain's part of all runs on the side of the wrap", key=key)
    ends = (weight.low, weight.high)
    sides = [_sides(run.reading - end * exp(1j * run.phase_rad), phases) for run in runs for end in ends]
    tight, slack = (AmplitudeRange(min(column), max(column)) for column in zip(*sides, strict=True))
    return ChainUnbalance(weight, tight, slack)


def predicted(unbalance: ChainUnbalance, phases: ChainPhases, weight_phase_rad: float) -> Prediction:
    """Readings to expect with the weight at a phase in rad and one side of the chain; its largest effect counts."""
    weight = unbalance.weight.high * exp(1j * weight_phase_rad)
    tight = weight + unbalance.tight.high * exp(1j * phases.tight_rad)
    slack = weight + unbalance.slack.high * exp(1j * phases.slack_rad)
    return Prediction(tight, slack, max(abs(tight), abs(slack)) / 2.0)


def opposite_weight_g(amplitude: float, phase_rad: float, effect_per_g: float) -> complex:
    """The weight in g against an unbalance: amplitude divided by effect per g, at the opposite phase."""
    return amplitude / effect_per_g * exp(1j * (phase_rad + pi))


def _weight_range(runs: Sequence[WeightRun], wrap_rad: float) -> AmplitudeRange:
    """Values of L_B for which C - L_B exp(i phase) points to the side of the wrap in every run; (inf, -inf) if none."""
    low, high = 0.0, inf
    for run in runs:
        toward = (run.reading * exp(-1j * wrap_rad)).real
        slope = exp(1j * (run.phase_rad - wrap_rad)).real
        # toward - L_B slope > 0
        if slope > ACROSS:
            high = min(high, toward / slope)
        elif slope < -ACROSS:
            low = max(low, toward / slope)
        elif toward <= 0.0:
            return AmplitudeRange(inf, -inf)
    return AmplitudeRange(low, high)


def _sides(chain: complex, phases: ChainPhases) -> tuple[float, float]:
    """Amplitudes of the tight and the slack side that add up to the chain's part: two equations, two unknowns."""
    tight, slack = exp(1j * phases.tight_rad), exp(1j * phases.slack_rad)
    across = (tight.conjugate() * slack).imag
    return (chain.conjugate() * slack).imag / across, -(chain.conjugate() * tight).imag / across
