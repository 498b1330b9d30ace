"""Pitch curves of two gears whose centre distance changes with the driving angle.

The driving axis stands at 0 and the driven axis at A(phi) on the x axis; the driving gear turns by phi, the driven one
by -psi(phi) (external mesh).  Primes are by phi.  At the pitch point p = x + i y both bodies have one velocity, the
driven one's with the velocity A' of its axis:

    i p = A' - i psi' (p - A),    so that    p = (psi' A - i A') / (1 + psi').

The pitch point is off the line of centres by -A' / (1 + psi'), the effect of the moving axis; where the axis stands it
is at the usual place.  In the gears' own frames it draws the centrodes z1 = p exp(-i phi) and z2 = (p - A) exp(i psi).
With v = p' - i p, which equals (p - A)' + i psi' (p - A), both grow by v turned into their frame: they roll without
slip, and their curvatures add up to (1 + psi') / |v|.

A round driving gear of radius r has |p| = r, so that psi' (A^2 - r^2) = r^2 + sqrt(A^2 r^2 - A'^2 (A^2 - r^2)).

Sources: the instantaneous centre by relative velocities (any textbook of kinematics); gears of variable centre distance
are F. Zheng, L. Hua, X. Han, Mechanism and Machine Theory 101 (2016) 116-139, known by its abstract.
"""

from __future__ import annotations

from math import gcd, pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import gauss_points
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch.rolled import RolledCurve, rolled_curve
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.integrated import integrated_law, splined_slope
from ncgear.ratio.transmission import JetFunction, Lobes, Transmission


def even_distances(values_mm: Array, lobes: int) -> JetFunction:
    """The centre distance by the least trigonometric polynomial through values at even steps of a driving lobe."""
    count = values_mm.size
    waves = np.fft.rfft(values_mm) / count
    double = np.ones(waves.size)
    double[1 : (count + 1) // 2] = 2.0

    def distance(phi: Array, order: int) -> Jet:
        turned = Jet.variable(phi, order)
        total = turned * 0.0 + float(waves[0].real)
        for number, wave in enumerate(waves[1:] * double[1:], start=1):
            sine, cosine = jet.sin_cos(turned * (number * lobes))
            total = total + cosine * float(wave.real) - sine * float(wave.imag)
        return total

    return distance


def require_distances(distance: JetFunction, lobes: Lobes, key: str) -> JetFunction:
    """Refuse a distance that is not positive or not smooth to its second derivative; raises NoSuchMechanism."""
    phi = np.linspace(0.0, lobes.driving_period_rad, CHECKED)
    along = distance(phi, 2)
    least = int(np.argmin(along.value))
    if not (np.isfinite(along.coefficients).all() and along.value[least] > 0.0):
        raise NoSuchMechanism(
            f"the centre distance is {along.value[least]:.4g} mm at phi1 = {in_words(float(phi[least]))}; it must be "
            "positive and smooth everywhere",
            key=key,
        )
    size = float(along.value.max())
    for order, name in enumerate(("distance", "speed of the axis", "acceleration of the axis")):
        start, end = along.derivative(order)[[0, -1]]
        if abs(start - end) > SEAM * size:
            raise NoSuchMechanism(
                f"the {name} jumps from {end:.6g} to {start:.6g} where the lobe of the driving gear begins again; the "
                f"distance must repeat every {in_words(lobes.driving_period_rad)}",
                key=key,
            )
    return distance


CHECKED = 721
"""Driving angles at which a centre distance is checked; the extremes of the gears are searched later."""

SEAM = 1e-9
"""Relative jump at the seam that counts as rounding: a formula with ten digits has a jump of this size."""


@dataclass(frozen=True, eq=False)
class MovingAxes:
    """Two gears in external mesh: their law, and the distance of their axes in mm, which has the law's period."""

    transmission: Transmission
    distance: JetFunction

    @property
    def lobes(self) -> Lobes:
        """How often both curves repeat."""
        return self.transmission.lobes

    @property
    def cycle_rad(self) -> float:
        """Driving angle after which both gears stand as at first."""
        return 2.0 * pi * self.lobes.driven / gcd(self.lobes.driving, self.lobes.driven)

    def pitch_point(self, phi: Array, order: int) -> tuple[Jet, Jet]:
        """x and y of the pitch point in mm, the driving axis at 0 and the driven one at A, with derivatives."""
        distance = self.distance(phi, order + 1)
        slope = self.transmission.driven_angle(phi, order + 1).differentiated()
        across = slope + 1.0
        return slope * distance.truncated(order) / across, -distance.differentiated() / across

    def _velocity(self, phi: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray, Array]:
        """p, v and v' as complex numbers, and psi'."""
        x, y = self.pitch_point(phi, 2)
        p, first, second = (x.derivative(k) + 1j * y.derivative(k) for k in range(3))
        return p, first - 1j * p, second - 1j * first, self.transmission.driven_angle(phi, 1).derivative(1)

    def driving_path(self, phi: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Points of the driving curve in mm and two derivatives by the driving angle, shape (n,) each."""
        p, v, change, _ = self._velocity(phi)
        turn = np.exp(-1j * phi)
        return p * turn, v * turn, (change - 1j * v) * turn

    def driven_path(self, phi: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """As ``driving_path``, for the driven curve."""
        p, v, change, slope = self._velocity(phi)
        turn = np.exp(1j * self.transmission.driven_angle(phi).value)
        return (p - self.distance(phi, 0).value) * turn, v * turn, (change + 1j * slope * v) * turn

    def turning(self, phi: Array) -> Array:
        """The sum of both curvatures in 1/mm."""
        _, v, _, slope = self._velocity(phi)
        return (1.0 + slope) / np.abs(v)

    def curve(self, gear: Gear) -> RolledCurve:
        """The pitch curve of a gear."""
        of_driving = gear is Gear.DRIVING
        path, lobes = (self.driving_path, self.lobes.driving) if of_driving else (self.driven_path, self.lobes.driven)
        return rolled_curve(gear, Mesh.EXTERNAL, lobes, self.transmission.joints_rad, path, self.turning)

    def extremes(self, function: JetFunction) -> tuple[Extremum, Extremum]:
        """The least and the greatest value of a function of the driving angle over the period of the law."""
        joints = self.transmission.joints_rad
        return extremes(lambda phi: function(phi, 1), float(joints[0]), float(joints[-1]), joints[1:-1])


PANELS, NODES = 16, 16
"""Panels over a period, and Gauss points on each, of the integral that gives a round gear's radius."""


def round_driving_law(distance: JetFunction, lobes: Lobes, key: str) -> tuple[Transmission, float]:
    """A round driving gear's law on a moving axis and radius in mm; raises NoSuchMechanism for too fast an axis."""
    points, weights = gauss_points(np.linspace(0.0, lobes.driving_period_rad, PANELS + 1), NODES)
    moved = distance(points, 1)
    fastest, nearest = float(np.abs(moved.derivative(1)).max()), float(moved.value.min())
    at = float(points[np.argmax(np.abs(moved.derivative(1)))])

    def missing(radii: Array) -> Array:
        turned = [_round_slope(moved.truncated(0), moved.differentiated(), radius).value @ weights for radius in radii]
        return np.array(turned) - lobes.driven_period_rad

    low, high = np.array([fastest * (1.0 + MARGIN)]), np.array([nearest * (1.0 - MARGIN)])
    if not (low[0] < high[0] and float(missing(low)[0]) < 0.0 < float(missing(high)[0])):
        raise NoSuchMechanism(
            f"the axis moves by {fastest:.4g} mm per rad at phi1 = {in_words(at)}, too fast for a round driving gear "
            f"at axes {nearest:.4g} mm apart; a smaller range of distances, or a ratio in place of the round gear, is "
            "needed",
            key=key,
        )
    radius = float(zeros_between(missing, low, high)[0])

    def slope(phi: Array, order: int) -> Jet:
        whole = distance(phi, order + 1)
        return _round_slope(whole.truncated(order), whole.differentiated(), radius)

    return integrated_law([splined_slope(slope, np.empty(0), lobes, key)], lobes, scale_to_close=True, key=key), radius


MARGIN = 1e-6
"""Least relative distance of radii from their limits; there a gear would stand still or its mate turn without end."""


def _round_slope(distance: Jet, moving: Jet, radius_mm: float) -> Jet:
    """psi' of a round driving gear, from A and A'."""
    beyond, square = distance * distance - radius_mm**2, radius_mm**2
    return (jet.sqrt(distance * distance * square - moving * moving * beyond) + square) / beyond
