"""The best law of the published three-segment family: least peak acceleration under a power cap, or conversely.

Seven numbers describe a law (``family_samples``).  Sobol points of their box are looked at all at once.  From each of
the best that lie apart, sequential quadratic programming (D. Kraft, DFVLR-FB 88-28, 1988) goes down to a local
optimum, with all samples of acceleration and power as constraints and the peak as a variable of its own; then it does
so from random neighbours of the best.  The result is made into a law as a design file would make it and judged by its
exact peaks, with masses those of the one loaded machine (``ncgear.dynamics.loaded_machine``), from which the samples
of the power come as well; where exact peaks exceed the cap between samples, the cap is tightened by as much.  The
same seed gives the same law.  A local method proves no optimum: that is what the certified limits are for.
"""

from __future__ import annotations

from math import inf, isfinite

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from ncgear.dynamics.driving_shaft import DrivingShaft, counting_masses
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.optimum.family_samples import BOX, Family, Peak, constant_at, request_at, sampled_laws
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.working_stroke import StrokeRequest, solved_stroke

SOBOL_POWER = 12
"""2^12 points of the box are looked at."""

AT_ONCE = 512
"""Points that are sampled at once: with masses this takes half the time that all of them at once take."""

APART = 0.2
"""Distance, in the unit box, of one start from the others."""

PENALTY = 20.0
"""Price of a relative excess over the cap, in peaks, while starts are chosen."""

HOPS, HOP = 1, 0.1
"""Neighbours of the best that are tried, for each start, and their standard deviation in the unit box."""

ALMOST = 1e-3
"""Relative excess over the cap that does not count while local optima are ranked: constraints hold to rounding."""

STEP = 1e-6
"""Step of the difference quotients, in the unit box."""

TIGHTENINGS = 4
WITHIN = 1e-6
"""Relative excess of the exact peak over the cap that counts as none."""

IMPOSSIBLE = 1e6
"""What stands for a sample that is not finite, in units of the objective and of the cap."""


@dataclass(frozen=True, eq=False)
class FamilyOptimum:
    """The best law found: its stroke, as ``solve_for: v2`` of a design file.

    ``constant`` is the e of its return, None for ``e: least_acceleration``.
    """

    request: StrokeRequest
    inverse: bool
    constant: float | None
    law: StrokeLaw
    check: KinematicCheck

    def peak(self, peak: Peak) -> float:
        """Exact peak over the whole cycle in mm/s^2 or W."""
        check = self.check
        return (check.peak_acceleration_cycle if peak is Peak.ACCELERATION else check.peak_power_w).value


def best_of_family(family: Family, least: Peak, cap: float = inf, *, seed: int = 1, starts: int = 32) -> FamilyOptimum:
    """The law of the family with the least peak of one kind, the other kind's at most ``cap`` (W or mm/s^2).

    Raises NoSuchMechanism where no law of the family is found under the cap, with the least that was found.
    """
    for point in _local_optima(family, least, cap, seed, starts):
        optimum = _under_cap(family, least, cap, point)
        if optimum is not None:
            return optimum
    raise _out_of_reach(family, least, cap, seed, starts)


def _local_optima(family: Family, least: Peak, cap: float, seed: int, starts: int) -> list[Array]:
    """The ends of all descents, the best first; there are many optima, so neighbours of the best are tried as well."""

    def rank(point: Array) -> float:
        return float(_merit(family, least, cap * (1.0 + ALMOST), point[None])[0])

    random = np.random.default_rng(seed)
    points = [_descended(family, least, cap, start) for start in _starts(family, least, cap, random, starts)]
    for _ in range(HOPS * starts):
        points.sort(key=rank)
        near = np.clip(points[0] + random.normal(0.0, HOP, len(BOX)), 0.0, 1.0)
        if np.isfinite(_merit(family, least, cap, near[None])[0]):
            points.append(_descended(family, least, cap, near))
    return sorted(points, key=rank)


def _capped(least: Peak) -> Peak:
    return Peak.POWER if least is Peak.ACCELERATION else Peak.ACCELERATION


def _merit(family: Family, least: Peak, cap: float, points: Array) -> Array:
    """The peak, made larger where the other one exceeds the cap; shape (n,)."""
    found = sampled_laws(family, points)
    peak, other = (np.abs(found.of(kind)).max(axis=1) for kind in (least, _capped(least)))
    excess = np.maximum(other / cap - 1.0, 0.0) if isfinite(cap) else np.where(np.isfinite(other), 0.0, inf)
    merit: Array = peak * (1.0 + PENALTY * excess)
    return merit


def _starts(family: Family, least: Peak, cap: float, random: np.random.Generator, count: int) -> list[Array]:
    """The best points of the box that lie apart from each other."""
    points = qmc.Sobol(len(BOX), rng=random).random_base2(SOBOL_POWER)
    blocks = np.split(points, len(points) // AT_ONCE)
    merit = np.concatenate([_merit(family, least, cap, block) for block in blocks])
    chosen: list[Array] = []
    for point in points[np.argsort(merit)][: int(np.isfinite(merit).sum())]:
        if len(chosen) == count:
            break
        if all(float(np.linalg.norm(point - other)) > APART for other in chosen):
            chosen.append(point)
    return chosen


class _Descent:
    """The constraints of one descent, with their derivatives, at the last point asked for."""

    def __init__(self, family: Family, least: Peak, cap: float, start: Array) -> None:
        self._family, self._least, self._cap = family, least, cap
        # Without load there is no power to scale by.
        self._scale = float(np.abs(sampled_laws(family, start[None]).of(least)).max()) or 1.0
        self._at, self._values, self._slopes = np.full(start.size, np.nan), np.empty(0), np.empty((0, 0))
        self.start = np.append(start, 1.0)

    def values(self, variables: Array) -> Array:
        """What must not be negative: peak minus samples, and what is left under the cap."""
        self._see(variables[:-1])
        values: Array = self._values + variables[-1] * self._is_peak
        return values

    def slopes(self, variables: Array) -> Array:
        """Derivatives of ``values``, shape (constraints, variables)."""
        self._see(variables[:-1])
        return np.column_stack([self._slopes, self._is_peak])

    def _see(self, point: Array) -> None:
        if np.array_equal(point, self._at):
            return
        steps = np.where(point > 0.5, -STEP, STEP)
        rows = self._rows(np.vstack([point, point + np.diag(steps)]))
        self._at, self._values, self._slopes = point.copy(), rows[0], (rows[1:] - rows[0]).T / steps

    def _rows(self, points: Array) -> Array:
        found = sampled_laws(self._family, points)
        with np.errstate(invalid="ignore"):  # infinite over infinite, where there is neither law nor cap
            peak, other = found.of(self._least) / self._scale, found.of(_capped(self._least)) / self._cap
        self._is_peak = np.repeat([1.0, 0.0], [2 * peak.shape[1], 2 * other.shape[1]])
        rows = np.hstack([-peak, peak, 1.0 - other, 1.0 + other])
        return np.nan_to_num(rows, nan=-IMPOSSIBLE, posinf=-IMPOSSIBLE, neginf=-IMPOSSIBLE)


def _descended(family: Family, least: Peak, cap: float, start: Array) -> Array:
    """The local optimum that a start leads to, in the unit box."""
    descent = _Descent(family, least, cap, start)
    result = minimize(
        lambda variables: variables[-1],
        descent.start,
        jac=lambda variables: np.eye(variables.size)[-1],
        constraints={"type": "ineq", "fun": descent.values, "jac": descent.slopes},
        bounds=[(0.0, 1.0)] * len(BOX) + [(0.0, None)],
        method="SLSQP",
        options={"maxiter": 150, "ftol": 1e-8},
    )
    point: Array = np.clip(result.x[:-1], 0.0, 1.0)
    return point


def _under_cap(family: Family, least: Peak, cap: float, point: Array) -> FamilyOptimum | None:
    """The law of a point, moved until its exact peak keeps to the cap; None where it does not."""
    tightened = cap

    def over(optimum: FamilyOptimum) -> float:
        return optimum.peak(_capped(least)) / cap

    for _ in range(TIGHTENINGS):
        found = _made(family, point)
        if not found:
            return None
        if kept := [one for one in found if over(one) <= 1.0 + WITHIN]:
            return min(kept, key=lambda one: one.peak(least))
        tightened /= min(map(over, found))
        point = _descended(family, least, tightened, point)
    return None


def _made(family: Family, point: Array) -> list[FamilyOptimum]:
    """The laws of a point of the unit box as a design file makes them, with their exact peaks; none where it cannot.

    One has the return of least acceleration.  Where the return takes power, another has that of the point.
    """
    constants: list[float | None] = [None]
    if family.return_takes_power and isfinite(own := constant_at(family, point)):
        constants.append(own)
    made = []
    for constant in constants:
        try:
            made.append(_law_of(family, request_at(family, point), constant))
        except NoSuchMechanism:
            continue
    return made


def _law_of(family: Family, request: StrokeRequest, constant: float | None) -> FamilyOptimum:
    """One law; raises NoSuchMechanism where it cannot be made."""
    task = family.task
    stroke = solved_stroke(request)
    law = stroke_law(stroke, task.linkage, task.lobes, constant=constant, inverse_basis=family.inverse)
    machine = Machine(law.transmission, task.linkage, task.load, task.speed_rad_s)
    check = kinematic_check(machine)
    if task.masses is not None:
        check = counting_masses(check, DrivingShaft(task.loaded(machine)))
    return FamilyOptimum(request, family.inverse, constant, law, check)


def _out_of_reach(family: Family, least: Peak, cap: float, seed: int, starts: int) -> NoSuchMechanism:
    """The refusal of a cap, with the least that the family reaches where nothing else is asked of it."""
    capped = _capped(least)
    points = _local_optima(family, capped, inf, seed, starts)
    lowest = float(np.abs(sampled_laws(family, points[0][None]).of(capped)).max())
    return NoSuchMechanism(
        f"no law of the three-segment family was found with a {capped.value} of {cap:.6g} or less; the least found is "
        f"{shown_above(lowest)}"
    )
