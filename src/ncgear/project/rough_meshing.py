"""Teeth under load before any tooth is made: one pair on each side, with the mean stiffness of all pairs together."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos

import numpy as np

from ncgear.dynamics.gaps import LEVER, STIFFNESS, Gaps
from ncgear.dynamics.law_table import law_table
from ncgear.dynamics.meshing import Impact, Meshing
from ncgear.numerics.periodic_table import PeriodicTable
from ncgear.project.drive import Drive
from ncgear.project.forces import FULLY_DAMPED, friction_of
from ncgear.project.tooth_load import ToothLoad
from ncgear.strength.without_teeth import PUSHING_AND_BACK, SharedLoad

PLACES = 720
"""Places of a cycle between which levers and play are interpolated linearly."""


def rough_meshing(drive: Drive, load: ToothLoad, sides: Sequence[SharedLoad]) -> Meshing:
    """The teeth of a pair from its pitch curves, with the mean stiffness of the pairs that share a load."""
    transmission, play, gears = drive.pair.transmission, drive.play, drive.running
    phi1 = np.linspace(0.0, transmission.cycle_rad, PLACES + 1)
    levers = [1.0 / load.mesh_force(phi1, np.full(phi1.shape, urge)).size_n.value for urge in PUSHING_AND_BACK]
    thinner_mm = -2.0 * play.thicker_mm * cos(drive.rack.angles_rad[1])
    known = {float(side.load.urge[0]): _mean_stiffness(side) * gears.face_width_mm for side in sides}
    values = np.zeros((phi1.size, 2, STIFFNESS + 1))
    for slot, side in enumerate(PUSHING_AND_BACK):
        values[:, slot, LEVER] = levers[slot]
        values[:, slot, STIFFNESS] = known.get(side, max(known.values()))
    values[:, 1, 0] = play.driven_rad + thinner_mm / levers[1]
    rising = np.diff(values, axis=0) / np.diff(phi1)[:, None, None]
    urge = np.broadcast_to(PUSHING_AND_BACK, (PLACES, 2))
    none = np.zeros((PLACES, 2, 2), dtype=int)
    gaps = Gaps(
        PeriodicTable(phi1, np.stack([rising, values[:-1]])),
        urge,
        none,
        np.full(PLACES, np.inf),
        np.zeros(urge.shape[1], dtype=int),
    )
    given = drive.design.simulation.of_own_stiffness
    impact = Impact(1.0, given.damping_n_s_mm or 0.0, given.full_damping_depth_mm or gears.module_mm / FULLY_DAMPED)
    return Meshing(law_table(transmission), gaps, impact, friction_of(given))


def _mean_stiffness(side: SharedLoad) -> float:
    """The load of all pairs over their deflection, in N/mm per mm of width, weighted by the load."""
    line = side.line_n_mm.sum(axis=0)
    return float((line**2).sum() / (line**2 / side.stiffness_n_mm2).sum())
