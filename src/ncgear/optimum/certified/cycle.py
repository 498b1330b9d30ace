"""One cycle of the machine at places of the crank, and what lies between them: the grid of the certified limit.

The places are not samples of a smooth function.  Every relation of the limit between the values at the places holds
for any motion, whatever it does between them, so a grid that is too coarse gives a lower limit, never a wrong one.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.optimum.loads import MachineLoads, machine_loads
from ncgear.optimum.task import Task

PLACES = 240
"""Places of a cycle: on the baler the limit is then within 0.1 % of what a much finer grid gives."""

NEAREST = 0.15
"""Least distance of two places, in steps of the even grid: the relations of nearer ones lose digits to no gain."""

SAME = 1e-9
"""Crank angle in rad by which the ends of a stretch may miss the places that were made for them."""

GAUSS = 12
"""Gauss-Legendre points in a cell for its length and the work of weights: exact to rounding, both being smooth."""


@dataclass(frozen=True, eq=False)
class Cycle:
    """n places of one turn of the crank, the first at the retracted dead centre, and the n cells that follow them.

    Of shape (n,), at the places: the crank's angle; ``slope`` and ``bend``, the magnitudes of the displacement's
    derivatives by it; ``force_n``, the larger of the loads on both sides of the place; ``inertia_kg_mm2``, J of
    all masses, zero without masses.  Of shape (n,), of the cells: ``step_rad``, ``length_mm`` along the slider's way,
    and ``work_n_mm`` against resistance and weights.  ``extended`` is the number of the extended dead centre.
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


def cycle(task: Task, places: int = PLACES, at_rad: Sequence[float] = ()) -> Cycle:
    """The cycle of a task at about so many even places, and at crank angles that matter, such as ends of stretches."""
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
    # At the extended dead centre the load of either stroke acts
    force = task.load.against_n(out, back)
    ends = [0, extended]
    force[ends] = np.maximum(*(task.load.against_n(out[ends], returning) for returning in (False, True)))
    step = np.diff(np.append(angles, 2.0 * pi))
    outward = task.load.work_n_mm(out[: extended + 1], stroke, returning=False)
    homeward = task.load.work_n_mm(np.append(out[extended:], 0.0), stroke, returning=True)
    work = np.concatenate([np.diff(outward), np.diff(homeward)])
    loads = _loads(task, angles)
    return Cycle(
        angles,
        slope,
        np.abs(position.derivative(2)),
        force,
        np.zeros(angles.size) if loads is None else loads.inertia_kg_mm2,
        step,
        _lengths(task, angles, step),
        work if loads is None else work + _work_of_weights(task, angles, step),
        extended,
    )


def _angles(task: Task, places: int, at_rad: Sequence[float]) -> Array:
    """Crank angles of all places, rising: both dead centres, then what matters most, then even ones between."""
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
    """Crank angles at which the load turns, the largest forces first: they count where several are near each other."""
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


def _loads(task: Task, angles: Array) -> MachineLoads | None:
    return None if task.masses is None else machine_loads(task.linkage, task.masses, angles, np.zeros(angles.size))


def _work_of_weights(task: Task, angles: Array, step: Array) -> Array:
    """Work in N mm that lifts the masses in each cell, shape (n,): the integral of the torque at rest."""
    assert task.masses is not None
    if task.masses.gravity_m_s2 == (0.0, 0.0):
        return np.zeros(angles.size)
    inner, weight = _inner(angles, step)
    at_rest = machine_loads(task.linkage, task.masses, inner.ravel(), np.zeros(inner.size)).torque_n_mm.static
    work: Array = np.sum(at_rest.reshape(inner.shape) * weight, axis=1)
    return work


def _lengths(task: Task, angles: Array, step: Array) -> Array:
    """Length of the slider's way in each cell, shape (n,): differences of the way would lose digits at dead centres."""
    inner, weight = _inner(angles, step)
    slope = task.linkage.displacement(Jet.variable(inner.ravel(), 1)).derivative(1)
    lengths: Array = np.abs(np.sum(slope.reshape(inner.shape) * weight, axis=1))
    return lengths


def _inner(angles: Array, step: Array) -> tuple[Array, Array]:
    """Crank angles inside each cell and their weights in an integral over it, shape (n, GAUSS) each."""
    unit, weight = np.polynomial.legendre.leggauss(GAUSS)
    return angles[:, None] + step[:, None] * (1.0 + unit) / 2.0, step[:, None] * weight / 2.0
