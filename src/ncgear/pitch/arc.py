"""Arc length along the pitch curves, which is the same for both, and its inverse.

Lengths are at unit centre distance.  Both maps continue periodically over any number of turns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics import chebyshev
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Transmission

NEWTON_STEPS = 20


@dataclass(frozen=True, eq=False)
class ArcLength:
    """Arc length sigma(phi1) and phi1(sigma), both zero at phi1 = 0 and increasing."""

    by_angle: PiecewiseChebyshev
    by_length: PiecewiseChebyshev

    @property
    def period(self) -> float:
        """Length of one period of the law."""
        return self.by_angle.final

    @property
    def angle_period_rad(self) -> float:
        """Driving angle of one period of the law."""
        return float(self.by_angle.breaks[-1])

    def length(self, phi1: Array) -> Array:
        """sigma at driving angles in rad, any shape."""
        cycles, local = np.divmod(phi1, self.angle_period_rad)
        return cycles * self.period + self.by_angle(local)

    def angle(self, sigma: Array) -> Array:
        """phi1 in rad at arc lengths, any shape."""
        cycles, local = np.divmod(sigma, self.period)
        return cycles * self.angle_period_rad + self.by_length(local)


def arc_length(transmission: Transmission, mesh: Mesh) -> ArcLength:
    """Both maps, each resolved to rounding error panel by panel.

    Raises NoSuchMechanism where the curves turn too sharply to be resolved.
    """
    joints = transmission.joints_rad
    try:
        by_angle = chebyshev.fitted(lambda phi1: _speed(transmission, phi1, Gear.DRIVING, mesh), joints).integrated()
    except NotSmooth as fault:
        raise too_sharp(fault.at) from fault
    joint_lengths = np.append(by_angle(joints[:-1]), by_angle.final)
    try:
        by_length = chebyshev.fitted(lambda sigma: _inverse(transmission, mesh, by_angle, sigma), joint_lengths)
    except NotSmooth as fault:
        raise too_sharp(float(np.interp(fault.at, joint_lengths, joints))) from fault
    return ArcLength(by_angle, by_length)


def too_sharp(phi1_rad: float) -> NoSuchMechanism:
    """The refusal of a pitch curve that turns faster than numbers of 16 digits can follow."""
    return NoSuchMechanism(
        f"the pitch curves turn too sharply near phi1 = {in_words(phi1_rad)} to be computed; a smaller "
        "range of the ratio is needed",
        key="motion",
    )


def period_length(transmission: Transmission, gear: Gear, mesh: Mesh) -> float:
    """Length of one period from the gear's own curve, to check one gear against the other."""
    speed = chebyshev.fitted(lambda phi1: _speed(transmission, phi1, gear, mesh), transmission.joints_rad)
    return speed.integrated().final


def _speed(transmission: Transmission, phi1: Array, gear: Gear, mesh: Mesh) -> Array:
    return shape.speed(transmission.driven_angle(phi1, 2).differentiated(), gear, mesh).value


def _inverse(transmission: Transmission, mesh: Mesh, by_angle: PiecewiseChebyshev, sigma: Array) -> Array:
    """Newton's method from a linear interpolation of the panel ends."""
    ends = np.append(by_angle(by_angle.breaks[:-1]), by_angle.final)
    phi1 = np.interp(sigma, ends, by_angle.breaks)
    for _ in range(NEWTON_STEPS):
        step = (by_angle(phi1) - sigma) / _speed(transmission, phi1, Gear.DRIVING, mesh)
        phi1 = np.clip(phi1 - step, 0.0, by_angle.breaks[-1])
        if np.max(np.abs(step)) <= 1e-14 * by_angle.breaks[-1]:
            return phi1
    if np.max(np.abs(by_angle(phi1) - sigma)) > 1e-12 * by_angle.final:
        raise ArithmeticError("the arc length of the pitch curve could not be inverted")
    return phi1
