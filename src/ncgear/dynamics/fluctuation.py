"""Mean driving torque, what the torque swings about it, and the flywheel that keeps the speed even.

The driving shaft takes in the mean torque M evenly; what it stores over the cycle is E(phi1), the integral of M - T.  A
flywheel of inertia J keeps the coefficient of speed fluctuation C = (largest - smallest speed) / mean speed where
J C w^2 = E_max - E_min (e.g. R. L. Norton, "Design of Machinery", 5th edition, 2012, section 11.11).  That takes the
torque at constant speed, so it holds for small C.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ncgear.dynamics.inverse import RigidMachine
from ncgear.kinematics.stretches import stretches
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import DEGREE, PiecewiseChebyshev, fitted
from ncgear.numerics.extrema import Extremum, extremes_on
from ncgear.numerics.jet import Jet
from ncgear.numerics.roots import all_zeros

IDLE = 1e-9
"""Share of the largest torque below which nothing is carried: far over rounding errors, far below what is felt."""

KG_MM2 = 1e3
"""One N mm s^2 in kg mm^2."""


@dataclass(frozen=True, eq=False)
class Fluctuation:
    """The driving torque in N mm over the driving angle, as piecewise Chebyshev forms of one cycle."""

    torque: PiecewiseChebyshev
    speed_rad_s: float

    @cached_property
    def work(self) -> PiecewiseChebyshev:
        """Work of the driving torque from phi1 = 0 on, in N mm."""
        return self.torque.integrated()

    @property
    def work_n_mm(self) -> float:
        """Work of one cycle."""
        return self.work.final

    @property
    def mean_torque_n_mm(self) -> float:
        """Mean over the cycle."""
        return self.work_n_mm / float(np.ptp(self.torque.breaks))

    @cached_property
    def stored_range_n_mm(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest energy stored in the driving shaft, from that at phi1 = 0 on, in N mm."""
        breaks = self.torque.breaks
        shares = np.linspace(0.0, 1.0, DEGREE, endpoint=False)
        grid = (breaks[:-1, None] + np.diff(breaks)[:, None] * shares).ravel()
        return extremes_on(self._stored, np.append(grid, breaks[-1]))

    @property
    def swing_n_mm(self) -> float:
        """Largest less smallest energy stored."""
        low, high = self.stored_range_n_mm
        return high.value - low.value

    @cached_property
    def flank_changes_rad(self) -> Array:
        """Driving angles in the cycle at which the torque changes its sign, and the other flanks carry, shape (m,)."""
        places = np.union1d(all_zeros(self.torque), self.torque.breaks)
        middles = self.torque((places[1:] + places[:-1]) / 2.0)
        carried = np.abs(middles) > IDLE * np.abs(middles).max()
        starts, signs = places[:-1][carried], np.sign(middles[carried])
        changes: Array = starts[signs != np.roll(signs, 1)]
        return changes

    def flywheel_kg_mm2(self, coefficient: float) -> float:
        """Inertia on the driving shaft, its gear included, for a coefficient of speed fluctuation (0 to about 0.2)."""
        return KG_MM2 * self.swing_n_mm / (coefficient * self.speed_rad_s**2)

    def _stored(self, phi1: Array) -> Jet:
        mean = self.mean_torque_n_mm
        return Jet(np.stack([mean * (phi1 - self.torque.breaks[0]) - self.work(phi1), mean - self.torque(phi1)]))


def fluctuation(rigid: RigidMachine) -> Fluctuation:
    """The driving torque of one cycle."""
    breaks = [rigid.breaks(stretch) for stretch in stretches(rigid.machine)]
    edges = np.concatenate([*(part[:-1] for part in breaks), breaks[-1][-1:]])
    torque = fitted(lambda phi1: rigid.at(phi1).driving_torque.value, edges)
    return Fluctuation(torque, rigid.machine.speed_rad_s)
