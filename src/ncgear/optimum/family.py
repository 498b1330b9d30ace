"""The best law of the published three-segment family: least peak acceleration under a power cap, or conversely.

Seven numbers describe a law.  Only the stroke as a function of the driving angle matters: speeds scale, so the law
speed is redundant, and v1, v2 and a1 are per radian.  Six numbers remain, the shape,

    theta4 / period,  theta3 / theta4,  theta2 / theta3,  theta1 / theta2,  chi,  brake

and the skewness of the return.  The approach's velocity, a quartic with v' = 0 at theta1 and theta2, is given by the
factors of its derivative, v' ~ (1 - t)(rho - t)(cos chi + sin chi t), t = phi1/theta2, rho = theta1/theta2, which stays
regular where theta1 comes near theta2 and v1 near v2.  ``brake`` is -a1 (theta4 - theta3)/v2.

All Sobol points of their box are computed together.  From each of the best points that lie apart, sequential quadratic
programming (D. Kraft, DFVLR-FB 88-28, 1988) descends to a local optimum, with all samples of acceleration and power as
constraints and the peak as a separate variable; then it descends from random neighbours of the best.  The result
becomes a law as a design file would make it, and is judged by its exact peaks.  With masses, exact peaks and samples of
the power come from the same loaded machine (``ncgear.dynamics.loaded_machine``).  Where exact peaks exceed the cap
between samples, the cap is tightened by the excess.  The same seed gives the same law.  A local method proves no
optimum; the certified limits do.
"""

from __future__ import annotations

from enum import Enum
from functools import cached_property
from math import inf, isfinite, pi

import numpy as np
from scipy.optimize import minimize

from ncgear.dynamics.driving_shaft import DrivingShaft, counting_masses
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import shares
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.optimum.task import Task
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.sampled_strokes import (
    ReturnGrid,
    ReturnSamples,
    SampledMotion,
    return_samples,
    returns_with_skewness,
    working_angles,
    working_motions,
)
from ncgear.ratio.working_stroke import StrokeRequest, WorkingStrokes, shaped_strokes, solved_stroke

BOX = np.array([[0.2, 0.9], [0.3, 0.995], [0.3, 1.0], [0.05, 0.98], [-1.55, 1.55], [0.02, 12.0], [-6.0, 6.0]])
"""Bounds of each number, the skewness in heights of the bump.  They are so wide that no optimum on the baler's linkage
lies at a bound, except at theta2 = theta3."""

SEGMENT_POINTS = 65, 17, 33
"""Points on each segment of the stroke, ends included; the accelerations are of degree 3, 0 and 2."""

RETURN_POINTS = ReturnGrid(edges=(0.0, 1.0), count=97, steps=8)
"""Points on the return; four of Newton's steps give five digits."""

CLOSED = 1e-6
"""Miss of the cycle, relative to the return's driven angle, that the search may leave; laws are closed to rounding."""


class PeakGoal(Enum):
    """The peak that is minimized, or capped."""

    ACCELERATION = "peak acceleration"
    POWER = "peak power"


@dataclass(frozen=True)
class LawFamily:
    """The family on a machine; ``inverse`` is the return's basis, as in a design file."""

    task: Task
    inverse: bool = False

    @cached_property
    def loaded(self) -> RigidMachine:
        """The machine with all masses, its crank turning evenly: the loads of any other motion are asked of it."""
        task = self.task
        return task.loaded(Machine(uniform_law(task.lobes), task.linkage, task.load, task.speed_rad_s))


@dataclass(frozen=True, eq=False)
class SampledLaws:
    """Accelerations in mm/s^2 and powers in W (0 where power flows back), (n, points); infinite without a law."""

    acceleration: Array
    power: Array

    def of(self, peak: PeakGoal) -> Array:
        """The samples whose largest magnitude is ``peak``."""
        return self.acceleration if peak is PeakGoal.ACCELERATION else self.power


def sampled_laws(family: LawFamily, points: Array) -> SampledLaws:
    """Samples of the laws at points of the unit box, shape (n, 7)."""
    strokes, skewness = strokes_at(family, points)
    task = family.task
    linkage, omega = task.linkage, task.speed_rad_s
    motions = working_motions(strokes, SEGMENT_POINTS)
    out = SampledMotion(*(np.hstack(parts) for parts in zip(*motions, strict=True)))
    advancing = (motions[0].velocity[:, 1:].min(axis=1) > 0.0) & (strokes.approach_slope[0] > 0.0)
    with np.errstate(all="ignore"):
        asked = strokes, linkage, task.cycle_rad, skewness, RETURN_POINTS
        back = return_samples(returns_with_skewness(*asked, inverse=family.inverse), linkage, RETURN_POINTS, 1)
        miss = np.abs(back.end_driven_rad - 2.0 * pi)
        power = _power_w(family, strokes, out, back)
    closed = (back.slopes[0][:, 0].min(axis=1) > 0.0) & (miss <= CLOSED * (2.0 * pi - linkage.working_angle_rad))
    possible = (advancing & (strokes.pressing_mm_rad > 0.0) & closed)[:, None]
    acceleration = np.hstack([out.acceleration, back.acceleration[:, 0]]) * omega**2
    return SampledLaws(np.where(possible, acceleration, inf), np.where(possible, np.maximum(power, 0.0), inf))


def _power_w(family: LawFamily, strokes: WorkingStrokes[Array], out: SampledMotion, back: ReturnSamples) -> Array:
    """The power of the driving shaft in W, shape (n, points); without masses in the return only where it is loaded."""
    task = family.task
    if task.masses is not None:
        return _power_with_masses_w(family, strokes, out, back)
    power = task.load.against_n(out.displacement, False) * out.velocity
    if task.load.loads_return:
        homeward = task.load.backwards_n(back.displacement[:, 0], True) * back.velocity[:, 0]
        power = np.hstack([power, homeward])
    return power * (task.speed_rad_s / 1000.0)


def _power_with_masses_w(
    family: LawFamily, strokes: WorkingStrokes[Array], out: SampledMotion, back: ReturnSamples
) -> Array:
    task = family.task
    phi1, driven = working_angles(strokes, task.linkage, SEGMENT_POINTS, 2)
    start = strokes.theta4_rad[:, None]
    phi1 = np.hstack([phi1, start + (task.cycle_rad - start) * shares(RETURN_POINTS.count)])
    homeward = back.driven_rad, *back.slopes
    turned, slope, change = (np.hstack([away, two[:, 0]]) for away, two in zip(driven, homeward, strict=True))
    returning = np.broadcast_to(np.arange(phi1.shape[1]) >= out.displacement.shape[1], phi1.shape)
    resistance = task.load.backwards_n(np.hstack([out.displacement, back.displacement[:, 0]]), returning)
    angle = Jet(np.stack([turned.ravel(), slope.ravel(), change.ravel() / 2.0]))
    loads = family.loaded.loads(phi1.ravel(), angle, Jet(resistance.reshape(1, -1)), returning.ravel())
    return loads.driving_torque.value.reshape(phi1.shape) * (N_M_PER_N_MM * task.speed_rad_s)


def strokes_at(family: LawFamily, points: Array) -> tuple[WorkingStrokes[Array], Array]:
    """The strokes of points of the unit box, shape (n, 7), at a law speed of 1 rad/s, and the returns' skewness."""
    *parts, chi, brake, skewness = (BOX[:, 0] + points * (BOX[:, 1] - BOX[:, 0])).T
    rho = parts[-1]
    theta = np.cumprod([parts[0] * family.task.cycle_rad, *parts[1:]], axis=0)[::-1]
    cosine, sine, both = np.cos(chi), np.sin(chi), 1.0 + rho
    rising = [rho * cosine, rho * sine - both * cosine, cosine - both * sine, sine]
    approach = np.stack(rising) / np.arange(1.0, 5.0)[:, None]
    return shaped_strokes(theta, approach / approach.sum(axis=0), brake, family.task.linkage.stroke_mm), skewness


def request_at(family: LawFamily, point: Array) -> StrokeRequest:
    """The stroke of one point of the unit box for the solver of strokes, which finds v2."""
    strokes, _ = strokes_at(family, point[None])
    request = {name: float(values[0]) for name, values in vars(strokes).items() if values.ndim == 1}
    omega = family.task.speed_rad_s
    theta = (
        request["theta1_rad"],
        request["theta2_rad"],
        max(request["theta3_rad"], request["theta2_rad"]),
        request["theta4_rad"],
    )
    return StrokeRequest(*theta, request["v1"] * omega, None, request["a1"] * omega**2, omega, request["stroke_mm"])


def constant_at(family: LawFamily, point: Array) -> float:
    """The e of the return of a point: its polynomial's value at phi1 = 0; not finite where there is none."""
    strokes, skewness = strokes_at(family, point[None])
    asked = strokes, family.task.linkage, family.task.cycle_rad, skewness, RETURN_POINTS
    with np.errstate(all="ignore"):
        return float(returns_with_skewness(*asked, inverse=family.inverse).at(-strokes.theta4_rad)[0])


SOBOL_POWER = 12
"""2^12 points of the box are looked at."""

AT_ONCE = 512
"""Points that are sampled together: with masses this takes half the time of all points together."""

APART = 0.2
"""Distance, in the unit box, of a start from the other starts."""

PENALTY = 20.0
"""Price of a relative excess over the cap, in peaks, while starts are chosen."""

HOPS, HOP = 1, 0.1
"""Neighbours of the best point that are tried for each start, and their standard deviation in the unit box."""

ALMOST = 1e-3
"""Relative excess over the cap that does not count while local optima are ranked: constraints hold to rounding."""

STEP = 1e-6
"""Step of the difference quotients, in the unit box."""

TIGHTENINGS = 4
WITHIN = 1e-6
"""Relative excess of the exact peak over the cap that counts as none."""

IMPOSSIBLE = 1e6
"""Replacement for a sample that is not finite, in units of the objective and of the cap."""


@dataclass(frozen=True, eq=False)
class FamilyOptimum:
    """The best law: its stroke, as ``solve_for: v2``, and the e of its return, None for ``least_acceleration``."""

    request: StrokeRequest
    inverse: bool
    constant: float | None
    law: StrokeLaw
    check: KinematicCheck

    def peak(self, peak: PeakGoal) -> float:
        """Exact peak over the whole cycle in mm/s^2 or W."""
        check = self.check
        return (check.peak_acceleration_cycle if peak is PeakGoal.ACCELERATION else check.peak_power_w).value


def best_of_family(
    family: LawFamily, least: PeakGoal, cap: float = inf, *, seed: int = 1, starts: int = 32
) -> FamilyOptimum:
    """The law of the family with the least peak of a kind; the other kind's peak is at most ``cap`` (W or mm/s^2).

    Raises NoSuchMechanism where no law of the family is found under the cap, with the least that was found.
    """
    for point in _local_optima(family, least, cap, seed, starts):
        optimum = _under_cap(family, least, cap, point)
        if optimum is not None:
            return optimum
    capped = _capped(least)
    points = _local_optima(family, capped, inf, seed, starts)
    lowest = float(np.abs(sampled_laws(family, points[0][None]).of(capped)).max())
    raise NoSuchMechanism(
        f"no law of the three-segment family was found with a {capped.value} of {cap:.6g} or less; the least found is "
        f"{shown_above(lowest)}"
    )


def _local_optima(family: LawFamily, least: PeakGoal, cap: float, seed: int, starts: int) -> list[Array]:
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


def _capped(least: PeakGoal) -> PeakGoal:
    return PeakGoal.POWER if least is PeakGoal.ACCELERATION else PeakGoal.ACCELERATION


def _merit(family: LawFamily, least: PeakGoal, cap: float, points: Array) -> Array:
    """The peak, made larger where the other peak exceeds the cap; shape (n,)."""
    found = sampled_laws(family, points)
    peak, other = (np.abs(found.of(kind)).max(axis=1) for kind in (least, _capped(least)))
    excess = np.maximum(other / cap - 1.0, 0.0) if isfinite(cap) else np.where(np.isfinite(other), 0.0, inf)
    return peak * (1.0 + PENALTY * excess)


def _starts(family: LawFamily, least: PeakGoal, cap: float, random: np.random.Generator, count: int) -> list[Array]:
    """The best points of the box that lie apart from each other."""
    from scipy.stats.qmc import Sobol

    points = Sobol(len(BOX), rng=random).random_base2(SOBOL_POWER)
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
    """The constraints of one descent, with their derivatives, at the last requested point."""

    def __init__(self, family: LawFamily, least: PeakGoal, cap: float, start: Array) -> None:
        self._family, self._least, self._cap = family, least, cap
        # Without load there is no power to scale by.
        self._scale = float(np.abs(sampled_laws(family, start[None]).of(least)).max()) or 1.0
        self._at, self._values, self._slopes = np.full(start.size, np.nan), np.empty(0), np.empty((0, 0))
        self.start = np.append(start, 1.0)

    def values(self, variables: Array) -> Array:
        """Values that must not be negative: peak minus samples, and cap minus samples."""
        self._see(variables[:-1])
        return self._values + variables[-1] * self._is_peak

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
        with np.errstate(invalid="ignore"):  # infinite over infinite, without law and cap
            peak, other = found.of(self._least) / self._scale, found.of(_capped(self._least)) / self._cap
        self._is_peak = np.repeat([1.0, 0.0], [2 * peak.shape[1], 2 * other.shape[1]])
        rows = np.hstack([-peak, peak, 1.0 - other, 1.0 + other])
        return np.nan_to_num(rows, nan=-IMPOSSIBLE, posinf=-IMPOSSIBLE, neginf=-IMPOSSIBLE)


def _descended(family: LawFamily, least: PeakGoal, cap: float, start: Array) -> Array:
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
    return np.clip(result.x[:-1], 0.0, 1.0)


def _under_cap(family: LawFamily, least: PeakGoal, cap: float, point: Array) -> FamilyOptimum | None:
    """The law of a point, moved until its exact peak keeps to the cap; None where it does not."""
    tightened = cap

    def over(optimum: FamilyOptimum) -> float:
        return optimum.peak(_capped(least)) / cap

    for _ in range(TIGHTENINGS):
        found = _made(family, point)
        if not found:
            return None
        if kept := [law for law in found if over(law) <= 1.0 + WITHIN]:
            return min(kept, key=lambda law: law.peak(least))
        tightened /= min(map(over, found))
        point = _descended(family, least, tightened, point)
    return None


def _made(family: LawFamily, point: Array) -> list[FamilyOptimum]:
    """The laws of a point of the unit box as a design file makes them, with their exact peaks; empty where it cannot.

    The first has the return of least acceleration; where the return takes power, the second has the point's own.
    """
    constants: list[float | None] = [None]
    takes_power = family.task.masses is not None or family.task.load.loads_return
    if takes_power and isfinite(own := constant_at(family, point)):
        constants.append(own)
    made = []
    for constant in constants:
        try:
            made.append(_law_of(family, request_at(family, point), constant))
        except NoSuchMechanism:
            continue
    return made


def _law_of(family: LawFamily, request: StrokeRequest, constant: float | None) -> FamilyOptimum:
    task = family.task
    stroke = solved_stroke(request)
    law = stroke_law(stroke, task.linkage, task.lobes, constant=constant, inverse_basis=family.inverse)
    machine = Machine(law.transmission, task.linkage, task.load, task.speed_rad_s)
    check = kinematic_check(machine)
    if task.masses is not None:
        check = counting_masses(check, DrivingShaft(task.loaded(machine)))
    return FamilyOptimum(request, family.inverse, constant, law, check)
