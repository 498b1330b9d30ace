"""Balancing a rotor on its own bearings from readings with trial weights: the method of influence coefficients.

Readings are complex: amplitude times exp(i phase), as are weights.  A weight W in a plane changes the reading of a
sensor by its coefficient times W; one run with a trial weight in each plane gives all coefficients, and the corrections
are the weights that cancel the first run's readings, in the mean square where there are more sensors than planes.
T. P. Goodman, "A least-squares method for computing balance corrections", J. Eng. Ind. 86 (1964) 273-279.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import ComplexArray

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
