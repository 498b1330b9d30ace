"""Places of the crank at which levels of laws are limited or judged, in cells with smooth functions.

Cells end at the knots of the spline, at both dead centres, where a load turns or is sharp, and where stretches
of levels begin and end.  Each cell has places at both its ends and evenly between them; neighbours share the place
between them, except at a dead centre, where forces may jump.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.optimum.loads import machine_loads
from ncgear.optimum.makeable.quantities import Slider
from ncgear.optimum.task import Task

A_TURN = 2.0 * pi

ORDER = 3
"""Derivatives of the slider's displacement by the crank angle: jerk needs the third."""

APART = 1e-7
"""Crank angle in rad below which two ends of cells count as one: displacements, exact to 1e-16 of the stroke, grow with
the square of the angle at a dead centre."""

INSIDE = 1e-9
"""Share of a cell by which places at dead centres are moved into it to read the forces of its side."""

STANDING = 1e-9
"""Share of the stroke that smooths ln |x'| where the slider stands; where |x'| is a millionth of the stroke, the error
of |x'| is below 1e-6 of it."""


@dataclass(frozen=True, eq=False)
class CellPlaces:
    """m places in n cells of p steps each: angles and slider, (m,) per column, and the numbers of each cell's places.

    ``ends_rad`` has shape (n + 1,), from 0 to a turn; ``number`` and ``weight`` have shape (n, p + 1).  The sum of
    weights times values is Simpson's integral over phi2 in each cell.
    """

    ends_rad: Array
    angle_rad: Array
    slider: Slider
    number: IndexArray
    weight: Array

    @property
    def count(self) -> int:
        """Number of places."""
        return self.angle_rad.size

    def cells(self, stretch: CrankStretch) -> IndexArray:
        """Numbers of the cells in a stretch whose ends are ends of cells."""
        middle = (self.ends_rad[1:] + self.ends_rad[:-1]) / 2.0
        return np.nonzero((middle - stretch.start_rad) % A_TURN < stretch.end_rad - stretch.start_rad)[0]

    def within(self, stretch: CrankStretch) -> IndexArray:
        """Numbers of the places in a stretch; without length, numbers of all places at its angle."""
        if stretch.end_rad > stretch.start_rad:
            return np.unique(self.number[self.cells(stretch)])
        apart = np.abs((self.angle_rad - stretch.start_rad + pi) % A_TURN - pi)
        return np.nonzero(apart <= apart.min() + APART)[0]

    def integral_weights(self, stretch: CrankStretch) -> Array:
        """Weights of all places in an integral over phi2 over a stretch, shape (m,)."""
        cells, weights = self.cells(stretch), np.zeros(self.count)
        np.add.at(weights, self.number[cells], self.weight[cells])
        return weights


def cell_ends(task: Task, knots_rad: Array, stretches: Iterable[CrankStretch]) -> Array:
    """Ends of the cells, from 0 to a turn; dead centres and ends of stretches stay exactly where they are."""
    sharp = {returning: task.load.knots_mm(task.linkage.stroke_mm, returning) for returning in (False, True)}
    crank = [task.linkage.crank_angle(at, np.full(at.size, back)) if at.size else at for back, at in sharp.items()]
    asked = np.array([end for stretch in stretches for end in (stretch.start_rad, stretch.end_rad)]) % A_TURN
    ends = np.array([0.0, task.linkage.working_angle_rad, A_TURN])
    for others in (asked, np.concatenate(crank), knots_rad):
        near = np.abs(others[:, None] - ends).min(axis=1, initial=np.inf) <= APART
        ends = np.unique(np.concatenate([ends, others[~near]]))
    return np.delete(ends, 1 + np.nonzero(np.diff(ends[1:-1]) <= APART)[0])


def places(task: Task, ends_rad: Array, steps: int) -> CellPlaces:
    """Places of cells with an even number of steps each."""
    cells, width = ends_rad.size - 1, np.diff(ends_rad)
    share = np.arange(steps + 1.0) / steps
    working = int(np.argmin(np.abs(ends_rad - task.linkage.working_angle_rad)))
    # The extended dead centre is a place of the cell before it and another place of the cell after it
    number = np.arange(cells)[:, None] * steps + np.arange(steps + 1)
    number[working:] += 1
    angle = np.empty(number[-1, -1] + 1)
    angle[number] = ends_rad[:-1, None] + width[:, None] * share
    angle[-1] = A_TURN
    beside = angle.copy()
    for cell, end, inwards in ((0, 0, 1.0), (working - 1, -1, -1.0), (working, 0, 1.0), (cells - 1, -1, -1.0)):
        beside[number[cell, end]] += inwards * INSIDE * width[cell]
    pattern = np.ones(steps + 1)
    pattern[1:-1:2], pattern[2:-1:2] = 4.0, 2.0
    weight = width[:, None] * pattern / (3.0 * steps)
    return CellPlaces(ends_rad, angle, slider_at(task, beside), number, weight)


def slider_at(task: Task, crank_angle_rad: Array) -> Slider:
    """The slider at crank angles in rad between 0 and a turn, shape (m,) per column."""
    variable = np.zeros((ORDER + 1, crank_angle_rad.size))
    variable[0], variable[1] = crank_angle_rad, 1.0
    displacement = task.linkage.displacement(Jet(variable))
    returning = crank_angle_rad >= task.linkage.working_angle_rad
    pressing = task.load.backwards_n(np.clip(displacement.value, 0.0, task.linkage.stroke_mm), returning)
    first, second, third = (displacement.derivative(order) for order in range(1, ORDER + 1))
    logarithm = np.log(np.hypot(first, STANDING * task.linkage.stroke_mm))
    between = N_PER_KG_MM_S2 * sum(task.moving.between_inertia_kg_mm2)
    return Slider(first, second, third, pressing, *_load_columns(task, crank_angle_rad, pressing))._replace(
        log_first=logarithm, between=np.full(crank_angle_rad.size, between)
    )


def _load_columns(task: Task, crank_angle_rad: Array, resistance_n: Array) -> list[Array]:
    """The columns of loads of ``Slider`` in their order, shape (m,) each; zero without masses."""
    if task.masses is None:
        return [np.zeros(crank_angle_rad.size)] * (len(Slider._fields) - 6)
    felt = machine_loads(task.linkage, task.masses, crank_angle_rad, resistance_n)
    bearing = [column for axis in (0, 1) for column in felt.bearing_n.component(axis)]
    shaking = [column for axis in (0, 1) for column in felt.shaking_n.component(axis)[1:]]
    return [*felt.torque_n_mm.columns, *bearing, *shaking]
