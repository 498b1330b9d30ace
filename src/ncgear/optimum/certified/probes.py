"""Points inside the cells at which a motion that is to be had is held against its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.road import Road
from ncgear.optimum.task import Task

SHARES = np.linspace(0.0, 1.0, 9)
"""Shares of each cell's crank angle."""


@dataclass(frozen=True, eq=False)
class Probes:
    """The linkage at points of the cells, all of shape (n, 9): ``share`` of the cell's length gone, slope and bend.

    ``bend_mm_rad2`` is the second derivative of the way by the crank angle, with its sign; ``force_n`` the resistance.
    """

    share: Array
    slope_mm_rad: Array
    bend_mm_rad2: Array
    force_n: Array


def probes(road: Road, task: Task) -> Probes:
    """The points of all cells of a road."""
    angles = road.crank_angle_rad[:-1, None] + road.turn_rad[:, None] * SHARES
    position = task.linkage.displacement(Jet.variable(angles.ravel(), 2))
    displacement = np.clip(position.value, 0.0, task.linkage.stroke_mm).reshape(angles.shape)
    out = (np.arange(road.turn_rad.size) < road.extended)[:, None]
    sense = np.where(out, 1.0, -1.0)
    slope = sense * position.derivative(1).reshape(angles.shape)
    slope[[0, road.extended], 0] = slope[[road.extended - 1, -1], -1] = 0.0
    gone = np.abs(displacement - displacement[:, :1])
    return Probes(
        share=gone / gone[:, -1:],
        slope_mm_rad=np.maximum(slope, 0.0),
        bend_mm_rad2=sense * position.derivative(2).reshape(angles.shape),
        force_n=np.where(out, task.resistance.force_n(displacement), 0.0),
    )
