"""The slider's way over one cycle, cut into cells: out and back laid one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.machine.linkage import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.optimum.task import Task

APART = 1e-7
"""Crank angle in rad below which two places count as one: the displacement, exact to 1e-16 of the stroke, grows with
the square of the angle at a dead centre."""


@dataclass(frozen=True, eq=False)
class Road:
    """Places of one cycle and cells between them; both dead centres are places, and all arrays rise with the crank.

    Of shape (n + 1,): crank angle; way, the distance gone since the retracted end; slope and bend, the magnitudes of
    the displacement's derivatives by the crank angle; force, zero in the return.  Of shape (n,): the cells' lengths in
    mm and in rad, and the work of the resistance in them.  ``extended`` is the index of the extended dead centre.
    """

    crank_angle_rad: Array
    way_mm: Array
    slope_mm_rad: Array
    bend_mm_rad2: Array
    force_n: Array
    work_n_mm: Array
    extended: int

    @property
    def length_mm(self) -> Array:
        """Lengths of the cells along the slider's way."""
        return np.diff(self.way_mm)

    @property
    def turn_rad(self) -> Array:
        """Crank angles of the cells."""
        return np.diff(self.crank_angle_rad)


def road(task: Task, cells: int, working_share: float) -> Road:
    """The cycle in about ``cells`` cells, ``working_share`` of them out; cut also where the resistance turns.

    The cells of each stroke are even in the crank angle.
    """
    return road_at(task, *_angles(task, cells, working_share))


def road_at(task: Task, angles: Array, extended: int) -> Road:
    """The cycle cut at crank angles in rad, shape (n + 1,), from dead centre to dead centre, 0 to 2 pi.

    ``extended`` is the index of the extended dead centre among them.
    """
    linkage = task.linkage
    position = linkage.displacement(Jet.variable(angles, 2))
    stroke = linkage.stroke_mm
    out = np.clip(position.value, 0.0, stroke)
    out[[0, -1]], out[extended] = 0.0, stroke
    slope = np.abs(position.derivative(1))
    slope[[0, extended, -1]] = 0.0
    force = np.where(np.arange(angles.size) <= extended, task.resistance.force_n(out), 0.0)
    work = np.diff(task.resistance.work_n_mm(out[: extended + 1], stroke))
    return Road(
        crank_angle_rad=angles,
        way_mm=np.concatenate([out[: extended + 1], 2.0 * stroke - out[extended + 1 :]]),
        slope_mm_rad=slope,
        bend_mm_rad2=np.abs(position.derivative(2)),
        force_n=force,
        work_n_mm=np.concatenate([work, np.zeros(angles.size - 1 - extended)]),
        extended=extended,
    )


def _angles(task: Task, cells: int, working_share: float) -> tuple[Array, int]:
    """Crank angles of all places, and the index of the extended dead centre."""
    working = task.linkage.working_angle_rad
    outward = max(2, round(cells * working_share))
    even = np.linspace(0.0, working, outward + 1)
    turns = _turns_rad(task.linkage, task.resistance.turns_mm(task.linkage.stroke_mm))
    apart = turns[np.abs(turns[:, None] - even).min(axis=1, initial=np.inf) > APART]
    outgoing = np.unique(np.concatenate([even, apart]))
    homeward = np.linspace(working, 2.0 * pi, max(2, cells - outward) + 1)
    return np.concatenate([outgoing, homeward[1:]]), outgoing.size - 1


def _turns_rad(linkage: CrankSlider, turns_mm: Array) -> Array:
    """Crank angles of the working stroke at displacements, shape (n,) both."""
    if not turns_mm.size:
        return turns_mm
    return linkage.crank_angle(turns_mm, np.zeros(turns_mm.size, dtype=bool))
