"""Demands on the driving shaft of a loaded machine over a cycle: torque, power, and the energy that it stores.

From the driving torque T follow its mean M, its swing about the mean, and the flywheel that keeps the speed even: the
driving shaft receives M evenly and stores the energy E(phi1), the integral of M - T.  A flywheel of inertia J keeps the
coefficient of speed fluctuation C = (largest - smallest speed) / mean speed where J C w^2 = E_max - E_min (e.g. R. L.
Norton, "Design of Machinery", 5th edition, 2012, section 11.11).  T is the torque at constant speed, so this holds for
small C.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import sqrt

import numpy as np

from ncgear.dynamics.loaded_machine import IDLE, RigidMachine, broken_cycle, range_over
from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.kinematics.check import KinematicCheck, WithMasses
from ncgear.kinematics.motion import stretches
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev, fitted
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import gauss_points, rms_above
from ncgear.numerics.units import N_M_PER_N_MM, in_words
from ncgear.numerics.zeros import all_zeros

NODES = 25
"""Gauss points of a panel: exact for the square of a form of degree 24, the degree of ``numerics.chebyshev``."""

KG_MM2 = 1e3
"""1 N mm s^2 in kg mm^2."""


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
        """Smallest and largest energy stored in the driving shaft, counted from phi1 = 0, in N mm."""
        breaks, mean = self.torque.breaks, self.mean_torque_n_mm

        def stored(phi1: Array) -> Jet:
            return Jet(np.stack([mean * (phi1 - breaks[0]) - self.work(phi1), mean - self.torque(phi1)]))

        return extremes(stored, float(breaks[0]), float(breaks[-1]), breaks)

    @property
    def swing_n_mm(self) -> float:
        """Largest less smallest energy stored; 0 where it is rounding only."""
        low, high = self.stored_range_n_mm
        return float(counted(high.value - low.value, -self.rms_n_mm, self.rms_n_mm))

    @property
    def rms_n_mm(self) -> float:
        """Root of the mean over the driving angle of the squared torque."""
        points, weights = gauss_points(self.torque.breaks, NODES)
        return sqrt(float(np.sum(weights * self.torque(points) ** 2)) / float(np.ptp(self.torque.breaks)))

    def rms_above_n_mm(self, order: int) -> float:
        """Root mean square over the driving angle of the torque's harmonics above an order."""
        points, weights = gauss_points(self.torque.breaks, NODES)
        return rms_above(points, weights, self.torque(points), order)

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


def fluctuation(rigid: RigidMachine) -> Fluctuation:
    """The driving torque of one cycle; raises Unanswered where it changes too fast for any series."""
    breaks = [rigid.breaks(stretch) for stretch in stretches(rigid.machine)]
    edges = np.concatenate([*(part[:-1] for part in breaks), breaks[-1][-1:]])
    try:
        torque = fitted(lambda phi1: rigid.at(phi1).driving_torque.value, edges)
    except NotSmooth as fault:
        raise Unanswered(
            f"the torque on the driving shaft changes near phi1 = {in_words(fault.at)} faster than can be followed; "
            "lengths further from those at which the mechanism locks, or a gentler law, are needed",
            key="linkage",
        ) from fault
    return Fluctuation(torque, rigid.machine.speed_rad_s)


@dataclass(frozen=True, eq=False)
class DrivingShaft:
    """Demands on the driving shaft of a machine over one cycle at constant speed, with all loads of the file.

    Every command takes torque and power of the driving shaft from here.  Power is torque times speed: positive where
    the motor drives, negative where it brakes.
    """

    machine: RigidMachine

    @cached_property
    def torque_range_n_mm(self) -> tuple[Extremum, Extremum]:
        """Least and largest torque, with their driving angles."""
        return range_over(self.machine, broken_cycle(self.machine), lambda loads: loads.driving_torque)

    @cached_property
    def fluctuation(self) -> Fluctuation:
        """The torque over the cycle, with its mean, its root mean square, its work and its swing."""
        return fluctuation(self.machine)

    @property
    def peak_power_w(self) -> Extremum:
        """Largest power that the motor delivers; 0 where it never drives."""
        most = self.torque_range_n_mm[1]
        return Extremum(max(0.0, most.value) * self._w_per_n_mm, most.at)

    @property
    def braking_power_w(self) -> Extremum:
        """Largest power that flows back to the motor, as a positive number; 0 where it is rounding only."""
        least, most = self.torque_range_n_mm
        braking = counted(max(-least.value, 0.0), least.value, most.value)
        return Extremum(float(braking) * self._w_per_n_mm, least.at)

    @property
    def mean_power_w(self) -> float:
        """Mean over the cycle; 0 where it is only the rounding error of a torque that changes its sign."""
        least, most = self.torque_range_n_mm
        return float(counted(self.fluctuation.mean_torque_n_mm, least.value, most.value)) * self._w_per_n_mm

    @property
    def rms_torque_n_m(self) -> float:
        """Root of the mean over the driving angle of the squared torque."""
        return N_M_PER_N_MM * self.fluctuation.rms_n_mm

    @property
    def energy_swing_j(self) -> float:
        """Energy that the driving shaft stores and returns in a cycle with an even motor torque."""
        return N_M_PER_N_MM * self.fluctuation.swing_n_mm

    @property
    def _w_per_n_mm(self) -> float:
        return N_M_PER_N_MM * self.machine.machine.speed_rad_s


def counted(torque: Array | float, least: Array | float, most: Array | float) -> Array:
    """A torque, or its work over radians; 0 where it is a rounding error of the least and the largest torque."""
    return np.where(np.abs(torque) > IDLE * np.maximum(-least, most), torque, 0.0)


def counting_masses(check: KinematicCheck, shaft: DrivingShaft) -> KinematicCheck:
    """A check of the same machine with the power that its masses, and friction in its guide, ask for as well.

    Over a cycle masses return all that they take, so that the mean is that of the resistance, however large they are.
    """
    rigid = shaft.machine
    returned = rigid.machine.transmission.lobes.repeats and not rigid.guide_friction
    return replace(
        check,
        peak_power_w=shaft.peak_power_w,
        mean_power_w=check.mean_power_w if returned else shaft.mean_power_w,
        extremes_rad=(*check.extremes_rad, *(end.at for end in shaft.torque_range_n_mm)),
        with_masses=WithMasses(
            peak_power_resistance_w=check.peak_power_w,
            braking_power_w=shaft.braking_power_w,
            rms_torque_n_m=shaft.rms_torque_n_m,
            energy_swing_j=shaft.energy_swing_j,
        ),
    )
