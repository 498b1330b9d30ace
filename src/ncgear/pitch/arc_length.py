"""Arc length of pitch curves by the driving angle, and the driving angle by arc length.

Both curves of a law have the same length, given here at unit centre distance.  Both maps continue periodically over any
number of turns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field

import numpy as np

from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Transmission

NEWTON_STEPS = 20
"""Most steps to the inverse of arc length; convergence is quadratic."""


@dataclass(frozen=True, eq=False)
class ArcMaps:
    """Arc length sigma(phi1) of a curve and phi1(sigma), both zero at phi1 = 0 and increasing."""

    by_angle: PiecewiseChebyshev
    by_length: PiecewiseChebyshev

    @property
    def period(self) -> float:
        """Length of one period of the curve."""
        return self.by_angle.final

    @property
    def angle_period_rad(self) -> float:
        """Driving angle of one period of the curve."""
        return float(self.by_angle.breaks[-1])

    def length(self, phi1: Array) -> Array:
        """sigma at driving angles in rad, any shape."""
        cycles, local = np.divmod(phi1, self.angle_period_rad)
        return cycles * self.period + self.by_angle(local)

    def angle(self, sigma: Array) -> Array:
        """phi1 in rad at arc lengths, any shape."""
        cycles, local = np.divmod(sigma, self.period)
        return cycles * self.angle_period_rad + self.by_length(local)


FEW = 4
"""Most answers that wait for the other gear: callers ask for both gears soon after each other, and without a limit
answers would pile up where one gear alone is asked."""


@dataclass(frozen=True, eq=False)
class ArcLength(ArcMaps):
    """The arc length of both gears of a law."""

    transmission: Transmission
    _asked: dict[bytes, Jet] = field(default_factory=dict, repr=False)

    def driven_angle(self, phi1: Array) -> Jet:
        """The law with three derivatives, shape (n,); the last FEW answers are kept for the other gear."""
        key = phi1.tobytes()
        if (known := self._asked.pop(key, None)) is not None:
            return known
        self._asked[key] = found = self.transmission.driven_angle(phi1, 3)
        if len(self._asked) > FEW:
            del self._asked[next(iter(self._asked))]
        return found


def arc_length(transmission: Transmission, mesh: Mesh) -> ArcLength:
    """Both maps of a law; raises as ``arc_maps``."""
    maps = arc_maps(lambda phi1: _speed(transmission, phi1, Gear.DRIVING, mesh), transmission.joints_rad)
    return ArcLength(maps.by_angle, maps.by_length, transmission)


def arc_maps(speed_of: Callable[[Array], Array], joints_rad: Sequence[float] | Array) -> ArcMaps:
    """Both maps of a curve by its arc length per angle; raises NoSuchMechanism where it turns too sharply."""
    try:
        speed = chebyshev.fitted(speed_of, joints_rad)
    except NotSmooth as fault:
        raise too_sharp(fault.at) from fault
    by_angle = speed.integrated()
    panels = np.append(by_angle(speed.breaks[:-1]), by_angle.final)
    try:
        by_length = chebyshev.fitted(_inverse(by_angle, speed), panels)
    except NotSmooth as fault:
        raise too_sharp(float(np.interp(fault.at, panels, speed.breaks))) from fault
    return ArcMaps(by_angle, by_length)


def too_sharp(phi1_rad: float, remedy: str = "a smaller range of the ratio") -> NoSuchMechanism:
    """The error for a pitch curve that turns faster than numbers of 16 digits can follow."""
    return NoSuchMechanism(
        f"the pitch curves turn too sharply near phi1 = {in_words(phi1_rad)} to be computed; {remedy} is needed",
        key="motion",
    )


def period_length(transmission: Transmission, gear: Gear, mesh: Mesh) -> float:
    """Length of one period, integrated on the gear's own curve, to check one gear against the other."""
    speed = chebyshev.fitted(lambda phi1: _speed(transmission, phi1, gear, mesh), transmission.joints_rad)
    return speed.integrated().final


def _speed(transmission: Transmission, phi1: Array, gear: Gear, mesh: Mesh) -> Array:
    return shape.speed(transmission.driven_angle(phi1, 2).differentiated(), gear, mesh).value


def _inverse(by_angle: PiecewiseChebyshev, speed: PiecewiseChebyshev) -> Callable[[Array], Array]:
    """Driving angles at arc lengths, by Newton's method from a linear interpolation between the panels' own points."""
    inner = chebyshev.nodes(speed.breaks[:-1], speed.breaks[1:]).ravel(order="F")
    angles = np.concatenate([speed.breaks[:1], inner, speed.breaks[-1:]])
    lengths = np.concatenate([[0.0], by_angle(inner), [by_angle.final]])

    def angle(sigma: Array) -> Array:
        phi1: Array = np.interp(sigma, lengths, angles)
        for _ in range(NEWTON_STEPS):
            step = (by_angle(phi1) - sigma) / speed(phi1)
            phi1 = np.clip(phi1 - step, 0.0, by_angle.breaks[-1])
            if np.max(np.abs(step)) <= 1e-14 * by_angle.breaks[-1]:
                return phi1
        if np.max(np.abs(by_angle(phi1) - sigma)) > 1e-12 * by_angle.final:
            raise Unanswered("the arc length of the pitch curve could not be inverted")
        return phi1

    return angle
