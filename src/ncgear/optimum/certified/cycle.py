"""One cycle of the machine at places of the crank, with the cells between them: the grid of the certified limit.

The places are not samples of a smooth function.  Every relation of the limit between the values at the places holds for
any motion between them, so a grid that is too coarse gives a lower limit, never a wrong limit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, log2, pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.proof import DATA, UNIT
from ncgear.optimum.loads import machine_loads
from ncgear.optimum.task import Task

PLACES = 240
"""Places of a cycle: on the baler the limit is then within 0.1 % of the limit on a much finer grid."""

NEAREST = 0.15
"""Least distance of two places, in steps of the even grid: relations of nearer places lose digits, gain nothing."""

SAME = 1e-9
"""Largest distance in rad between the ends of a stretch and the places that were made for them."""

GAUSS = 12
"""Gauss-Legendre points in a part of a cell for its length and the work of weights: exact to rounding, both being
smooth there."""


@dataclass(frozen=True, eq=False)
class CrankCycle:
    """n places of one turn of the crank, the first at the retracted dead centre, and the n cells after them.

    Of shape (n,), at the places: the crank's angle; ``slope`` and ``bend``, the magnitudes of the displacement's
    derivatives by it; ``force_n``, the load, which takes no power at the dead centres; ``inertia_kg_mm2``, J of
    all masses, zero without masses.  Of shape (n,), of the cells: ``step_rad``, ``length_mm`` along the slider's way,
    and ``work_n_mm`` against resistance and weights.  ``extended`` is the number of the extended dead centre.
    ``error`` is the largest relative error of these numbers.
    """

    crank_angle_rad: Array
    slope_mm_rad: Array
    bend_mm_rad2: Array
    force_n: Array
    inertia_kg_mm2: Array
    step_rad: Array
    length_mm: Array
    work_n_mm: Array
    extended: int
    error: float

    @property
    def count(self) -> int:
        """Number of places."""
        return self.crank_angle_rad.size

    def within(self, start_rad: float, end_rad: float) -> IndexArray:
        """Numbers of the places in a stretch of crank angles, ends included, shape (k,); it may go on over a turn."""
        gone = (self.crank_angle_rad - start_rad + SAME) % (2.0 * pi)
        return np.nonzero(gone <= end_rad - start_rad + 2.0 * SAME)[0]

    def cells_within(self, start_rad: float, end_rad: float) -> IndexArray:
        """Numbers of the cells that lie wholly in a stretch of crank angles, shape (k,); it may go on over a turn."""
        gone = (self.crank_angle_rad - start_rad + SAME) % (2.0 * pi)
        return np.nonzero(gone + self.step_rad <= end_rad - start_rad + 2.0 * SAME)[0]


def cycle(task: Task, places: int = PLACES, at_rad: Sequence[float] = ()) -> CrankCycle:
    """The cycle of a task at about ``places`` even places, and at important crank angles, such as ends of stretches."""
    angles = _angles(task, places, at_rad)
    linkage = task.linkage
    working = linkage.working_angle_rad
    extended = int(np.argmin(np.abs(angles - working)))
    position = linkage.displacement(Jet.variable(angles, 2))
    stroke = linkage.stroke_mm
    out = np.clip(position.value, 0.0, stroke)
    out[0], out[extended] = 0.0, stroke
    slope = np.abs(position.derivative(1))
    slope[[0, extended]] = 0.0
    back = np.arange(angles.size) > extended
    step = np.diff(np.append(angles, 2.0 * pi))
    outward = task.load.work_n_mm(out[: extended + 1], stroke, returning=False)
    homeward = task.load.work_n_mm(np.append(out[extended:], 0.0), stroke, returning=True)
    work = np.concatenate([np.diff(outward), np.diff(homeward)])
    nothing = np.zeros(angles.size)
    loads = None if task.masses is None else machine_loads(linkage, task.masses, angles, nothing)
    # Differences of the way would lose digits at dead centres
    way = _over_cells(task, angles, step, lambda inner: linkage.displacement(Jet.variable(inner, 1)).derivative(1))
    return CrankCycle(
        angles,
        slope,
        np.abs(position.derivative(2)),
        task.load.against_n(out, back),
        nothing if loads is None else loads.inertia_kg_mm2,
        step,
        np.abs(way),
        work if loads is None else work + _work_of_weights(task, angles, step),
        extended,
        max([DATA, *(UNIT / width**2 for _, width in linkage.corners)]),
    )


def _angles(task: Task, places: int, at_rad: Sequence[float]) -> Array:
    """Crank angles of all places, rising: both dead centres, the angles that matter most, even angles between."""
    working = task.linkage.working_angle_rad
    step = 2.0 * pi / places
    kept = [0.0, working]
    for angle in [*(angle % (2.0 * pi) for angle in at_rad), *_turns_of_load(task)]:
        if _nearest(angle, kept) > NEAREST * step:
            kept.append(angle)
    outward = max(2, round(working / step))
    homeward = max(2, places - outward)
    even = [*np.linspace(0.0, working, outward + 1)[1:-1], *np.linspace(working, 2.0 * pi, homeward + 1)[1:-1]]
    kept += [angle for angle in even if _nearest(angle, kept) > 0.4 * step]
    return np.sort(np.array(kept))


def _turns_of_load(task: Task) -> list[float]:
    """Crank angles at which the load turns, the largest forces first: of close angles the first counts."""
    found: list[tuple[float, float]] = []
    for returning in (False, True):
        turns = task.load.turns_mm(task.linkage.stroke_mm, returning)
        if turns.size:
            angles = task.linkage.crank_angle(turns, np.full(turns.size, returning))
            found += zip((-task.load.against_n(turns, returning)).tolist(), angles.tolist(), strict=True)
    return [angle for _, angle in sorted(found)]


def _nearest(angle_rad: float, others_rad: Sequence[float]) -> float:
    apart = np.abs(np.array(others_rad) - angle_rad) % (2.0 * pi)
    return float(np.min(np.minimum(apart, 2.0 * pi - apart)))


def _work_of_weights(task: Task, angles: Array, step: Array) -> Array:
    """Work in N mm that lifts the masses in each cell, shape (n,): the integral of the torque at rest."""
    masses = task.masses
    assert masses is not None
    if masses.gravity_m_s2 == (0.0, 0.0):
        return np.zeros(angles.size)
    return _over_cells(
        task,
        angles,
        step,
        lambda inner: machine_loads(task.linkage, masses, inner, np.zeros(inner.size)).torque_n_mm.static,
    )


def _over_cells(task: Task, angles: Array, step: Array, integrand: Callable[[Array], Array]) -> Array:
    """Integrals over the cells, shape (n,), of a function of crank angles that is smooth except for sharp corners."""
    starts = np.union1d(angles, _cuts(task, float(np.max(step))))
    width = np.diff(np.append(starts, 2.0 * pi))
    unit, weight = np.polynomial.legendre.leggauss(GAUSS)
    inner = starts[:, None] + width[:, None] * (1.0 + unit) / 2.0
    parts = integrand(inner.ravel()).reshape(inner.shape) @ weight * (width / 2.0)
    return np.add.reduceat(parts, np.searchsorted(starts, angles))


def _cuts(task: Task, step_rad: float) -> Array:
    """Crank angles (k,) that cut cells about narrow corners, at distances that double with each angle."""
    cuts = [np.empty(0)]
    for angle, width in task.linkage.corners:
        if width < step_rad:
            distances = width * 2.0 ** np.arange(ceil(log2(step_rad / width)) + 2)
            cuts.append(angle + np.concatenate([-distances, [0.0], distances]))
    return np.concatenate(cuts) % (2.0 * pi)
