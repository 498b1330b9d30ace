"""Pitch curves of a lobed sun, round planets and a lobed ring around the same axis.

The sun's curve is r(phi), with outward normals that lean by eta = atan(r'/r) from the radius; kappa is its curvature.
A planet of pitch radius rho touches it at P.  By the theorem of three centres (Aronhold, Kennedy) the place Q where the
planet touches the ring lies on the line from the axis O through P, and on the planet's circle:

    R = |OQ| = r + 2 rho cos(eta),    r R = d^2 - rho^2,  where d is the distance of the planet's centre from O.

Chord and circle make equal angles at P and Q, so that both curves lean alike: dR/(R dchi) = -dr/(r dphi) in size, and

    dchi/dphi = (r (1 + 2 rho kappa) - 2 rho cos(eta)) / R,

where chi is the ring's own polar angle, which runs against phi.  The ring has N lobes where chi grows by 2 pi / N over
a lobe of the sun, 2 pi / n.  Where dchi/dphi vanishes the ring has a cusp; beyond, it crosses itself.  Where 1 + rho
kappa vanishes, the planet is as large as the hollow of the sun.

With the ring standing and the sun turned by alpha, the planet touches in the direction lambda = alpha + phi =
-chi + 2 pi k / N.  So phi + chi = -alpha + 2 pi k / N: one place for each k, n + N planets in all, each a lobe of the
ring behind the next.  Over a lobe both curves roll on the planet by equal arcs, since eta returns, and the arcs differ
by 2 rho eta.  So each lobe of either has the same number of teeth, which must be whole: the
next planet stands to the ring as the planet before it, a lobe of the ring on.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from math import pi

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.formula import composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import across
from ncgear.numerics.quadrature import gauss_points
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch.arc_length import ArcMaps, arc_maps
from ncgear.pitch.rolled import RolledCurve, rolled_curve
from ncgear.pitch.shape import Gear, Mesh

PolarRadius = Callable[[Array, int], Jet]
"""Function of polar angles in rad, shape (n,), and an order; it gives a radius in mm with derivatives."""


def high_order_ellipse(size_mm: float, eccentricity: float, lobes: int) -> PolarRadius:
    """r = a (1 - e^2) / (1 - e cos(n phi)), an ellipse about its focus whose angles are divided by n."""

    def radius(phi: Array, order: int) -> Jet:
        cosine = jet.sin_cos(Jet.variable(phi, order) * lobes)[1]
        return size_mm * (1.0 - eccentricity**2) / (1.0 - eccentricity * cosine)

    return radius


def cosine_curve(size_mm: float, eccentricity: float, lobes: int) -> PolarRadius:
    """r = a (1 + e cos(n phi))."""

    def radius(phi: Array, order: int) -> Jet:
        return size_mm * (1.0 + eccentricity * jet.sin_cos(Jet.variable(phi, order) * lobes)[1])

    return radius


Family = Callable[[float, float, int], PolarRadius]


def formula_family(text: str, lobes: int, key: str) -> Family:
    """Curves by a formula of phi and e in any unit; raises WrongInput for an unreadable or not periodic formula."""

    def family(size_mm: float, eccentricity: float, lobes: int) -> PolarRadius:
        formula = composed(ECCENTRICITY.sub(f"({eccentricity!r})", text), key, "phi")

        def radius(phi: Array, order: int) -> Jet:
            return formula(Jet.variable(phi % (2.0 * pi / lobes), order)) * size_mm

        return radius

    if not ECCENTRICITY.search(text):
        raise WrongInput(
            f"{text!r} has no e, which is found so that the ring closes; 1 + e*cos({lobes}*phi) is an example", key=key
        )
    plain = composed(ECCENTRICITY.sub(f"({TRIED!r})", text), key, "phi")
    least = extremes(lambda phi: plain(Jet.variable(phi, 1)), 0.0, 2.0 * pi / lobes)[0]
    if not least.value > 0.0:
        raise WrongInput(
            f"the radius is {least.value:.6g} at phi = {in_words(least.at)} (with e = {TRIED}); it must be over 0",
            key=key,
        )
    start, end = (plain(Jet.variable([at], 2)) for at in (0.0, 2.0 * pi / lobes))
    for order, name in enumerate(("radius", "slope of the radius", "second derivative of the radius")):
        before, after = float(end.derivative(order)[0]), float(start.derivative(order)[0])
        if not abs(before - after) <= REPEATED * abs(float(start.value[0])):
            raise WrongInput(
                f"the {name} goes from {after:.6g} to {before:.6g} over a lobe of 1/{lobes} turn (with e = {TRIED}); "
                "the curve must repeat with every lobe",
                key=key,
            )
    return family


ECCENTRICITY = re.compile(r"\be\b")
"""The name of the eccentricity in a formula."""

TRIED = 0.1
"""Eccentricity at which a formula is tested: it must repeat with every lobe."""

REPEATED = 1e-9
"""Relative difference after a lobe that counts as rounding."""

FAMILIES: dict[str, Family] = {"ellipse": high_order_ellipse, "cosine": cosine_curve}
"""Families of curves by a size in mm, an eccentricity (0 for a circle) and a number of lobes; a lobe's top is at 0."""


@dataclass(frozen=True, eq=False)
class LobedCurves:
    """The curves of sun and ring about one axis, and a planet's circle between them."""

    radius: PolarRadius
    sun_lobes: int
    ring_lobes: int
    planet_radius_mm: float

    @property
    def planets(self) -> int:
        """Number of planets that find a place: the sum of both gears' lobes."""
        return self.sun_lobes + self.ring_lobes

    @property
    def lobe_rad(self) -> float:
        """Polar angle of a lobe of the sun."""
        return 2.0 * pi / self.sun_lobes

    def sun(self, phi: Array, order: int) -> tuple[Jet, Jet, Jet]:
        """r in mm, cos(eta) and kappa in 1/mm by the sun's polar angle, shape (n,), with ``order`` derivatives."""
        whole = self.radius(phi, order + 2)
        first = whole.differentiated()
        second = first.differentiated()
        r, slope = whole.truncated(order), first.truncated(order)
        square = r * r + slope * slope
        length = jet.sqrt(square)
        return r, r / length, (square + slope * slope - r * second) / (square * length)

    def ring(self, phi: Array, order: int) -> tuple[Jet, Jet]:
        """R in mm and dchi/dphi by the sun's polar angle, with ``order`` derivatives."""
        r, cosine, bend = self.sun(phi, order)
        chord = 2.0 * self.planet_radius_mm * cosine
        whole = r + chord
        return whole, (r * (1.0 + 2.0 * self.planet_radius_mm * bend) - chord) / whole

    def lean_rad(self, phi: Array) -> Array:
        """eta: the angle by which the sun's normal leans back from the radius, shape (n,)."""
        r = self.radius(phi, 1)
        return np.arctan2(r.derivative(1), r.value)

    @cached_property
    def _turned(self) -> PiecewiseChebyshev:
        """chi over one lobe of the sun."""
        return chebyshev.fitted(lambda phi: self.ring(phi, 0)[1].value, [0.0, self.lobe_rad]).integrated()

    def chi_rad(self, phi: Array) -> Array:
        """The ring's polar angle, clockwise from a lobe's top, at which the planet touches, any shape."""
        lobes, local = np.divmod(phi, self.lobe_rad)
        return lobes * self._turned.final + self._turned(local)

    @cached_property
    def places(self) -> ArcMaps:
        """Maps from phi to phi + chi, a planet's place, and back: dchi/dphi + 1 = 2 r (1 + rho kappa) / R."""
        return arc_maps(lambda phi: 1.0 + self.ring(phi, 0)[1].value, [0.0, self.lobe_rad])

    def require_whole(self) -> None:
        """Refuse a crossing ring and planets too large for the sun; raises NoSuchMechanism with the angle."""
        rho = self.planet_radius_mm
        room = self._least(lambda phi: 1.0 + rho * self.sun(phi, 1)[2])
        if room.value <= 0.0:
            hollow = rho / (1.0 - room.value)
            raise NoSuchMechanism(
                f"the sun's pitch curve is hollow with a radius of {hollow:.4g} mm at its polar angle "
                f"{in_words(room.at)}, and planets of {rho:.4g} mm do not go into it; fewer teeth per lobe, or more "
                "planet teeth, are needed",
                key="train.teeth_per_lobe",
            )
        rate = self._least(lambda phi: self.ring(phi, 1)[1])
        if rate.value <= 0.0:
            at = np.array([rate.at])
            beside = float(self.chi_rad(at)[0])
            raise NoSuchMechanism(
                f"the ring's pitch curve crosses itself where the planet is at the sun's polar angle "
                f"{in_words(rate.at)}, {in_words(beside)} from a lobe's top of the ring (there dchi/dphi = "
                f"{rate.value:.4g}); fewer teeth per lobe, or more planet teeth, make both curves rounder",
                key="train.teeth_per_lobe",
            )

    def _least(self, function: Callable[[Array], Jet]) -> Extremum:
        return extremes(function, 0.0, self.lobe_rad)[0]

    def centre_mm(self, phi: Array) -> ComplexArray:
        """A planet's centre in the sun's frame, as complex numbers, at polar angles of the contact, shape (n,)."""
        r = self.radius(phi, 0).value
        return np.exp(1j * phi) * (r + self.planet_radius_mm * np.exp(-1j * self.lean_rad(phi)))

    @cached_property
    def sun_curve(self) -> RolledCurve:
        """The sun's pitch curve; its driving angle is minus the polar angle."""

        def path(angle: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
            r = self.radius(-angle, 2)
            # Derivatives by the angle: odd ones change their sign.
            polar = r.value, -r.derivative(1), r.derivative(2)
            return _polar_path(polar, -angle, np.full(angle.shape, -1.0), np.zeros(angle.shape))

        def turning(angle: Array) -> Array:
            return self.sun(-angle, 0)[2].value + 1.0 / self.planet_radius_mm

        return rolled_curve(Gear.DRIVING, Mesh.EXTERNAL, self.sun_lobes, np.array([0.0, self.lobe_rad]), path, turning)

    @cached_property
    def ring_curve(self) -> RolledCurve:
        """The ring's pitch curve, clockwise from a lobe's top; its driving angle is the sun's polar angle."""

        def path(angle: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
            whole, rate = self.ring(angle, 2)
            polar = whole.value, whole.derivative(1), whole.derivative(2)
            return _polar_path(polar, -self.chi_rad(angle), -rate.value, -rate.derivative(1))

        def turning(angle: Array) -> Array:
            _, slope, bend = path(angle)
            return np.asarray(1.0 / self.planet_radius_mm + across(slope, bend) / np.abs(slope) ** 3)

        return rolled_curve(Gear.DRIVEN, Mesh.INTERNAL, self.ring_lobes, np.array([0.0, self.lobe_rad]), path, turning)


def _polar_path(
    radius: tuple[Array, Array, Array], angle: Array, rate: Array, change: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Points of a polar curve and two derivatives, from radius and angle with their derivatives."""
    value, first, second = radius
    turn = np.exp(1j * angle)
    return (
        value * turn,
        (first + 1j * value * rate) * turn,
        (second - value * rate**2 + 1j * (2.0 * first * rate + value * change)) * turn,
    )


PANELS, NODES = 12, 16
"""Panels over a lobe, and Gauss points on each, of the integrals for size and eccentricity; the final curves are
resolved to rounding."""

MOST_ECCENTRIC = 0.9
"""Greatest eccentricity that is tried; rings cross themselves long before."""

STEPS = 46
"""Eccentricities from 0 to the greatest at which the length of a lobe is first computed."""


def lobed_curves(
    family: Family, lobes: tuple[int, int], planet_teeth: int, teeth_per_lobe: int, module_mm: float
) -> LobedCurves:
    """The curves of sun and ring with ``lobes``, with ``teeth_per_lobe`` teeth of the planets' module.

    Size and eccentricity are both found: the ring has to close, and a lobe has to be as long as its teeth.  At
    eccentricity 0 all gears are round, and planets have t (N - n) / 2 teeth.  Raises NoSuchMechanism where no
    eccentricity does, and as ``require_whole``.
    """
    sun_lobes, ring_lobes = lobes
    rho = planet_teeth * module_mm / 2.0
    wanted = teeth_per_lobe * pi * module_mm
    points, weights = gauss_points(np.linspace(0.0, 2.0 * pi / sun_lobes, PANELS + 1), NODES)

    def curves(size: float, eccentricity: float) -> LobedCurves:
        return LobedCurves(family(size, eccentricity, sun_lobes), sun_lobes, ring_lobes, rho)

    def missing(size: Array, eccentricity: float) -> Array:
        rates = [curves(size_of_ring, eccentricity).ring(points, 0)[1].value @ weights for size_of_ring in size]
        return np.array(rates) - 2.0 * pi / ring_lobes

    def size_of(eccentricity: float) -> float:
        """The size at which the ring closes; NaN where no size does."""
        round_mm = 2.0 * sun_lobes / (ring_lobes - sun_lobes) * rho
        ends = np.array([LEAST_SIZE, MOST_SIZE]) * round_mm
        low, high = missing(ends, eccentricity)
        if not low < 0.0 < high:
            return np.nan
        return float(zeros_between(lambda size: missing(size, eccentricity), ends[:1], ends[1:])[0])

    def excess(eccentricities: Array) -> Array:
        found = []
        for eccentricity in eccentricities:
            r, cosine, _ = curves(size_of(float(eccentricity)), float(eccentricity)).sun(points, 0)
            found.append((r / cosine).value @ weights - wanted)
        return np.array(found)

    before = float(excess(np.zeros(1))[0])
    if abs(before) <= ROUND * wanted:
        return curves(size_of(0.0), 0.0)
    for low, high in pairwise(np.linspace(0.0, MOST_ECCENTRIC, STEPS)):
        after = float(excess(np.array([high]))[0])
        if before <= 0.0 <= after:
            found = float(zeros_between(excess, np.array([low]), np.array([high]))[0])
            made = curves(size_of(found), found)
            made.require_whole()
            return made
        before = after
    most = teeth_per_lobe * (ring_lobes - sun_lobes) / 2.0
    raise NoSuchMechanism(
        f"no curve of {sun_lobes} lobes has {teeth_per_lobe} teeth per lobe that planets of {planet_teeth} teeth join "
        f"to a ring of {ring_lobes} lobes; round gears have planets of {most:g} teeth, and lobes a few teeth less",
        key="train.planet_teeth",
    )


LEAST_SIZE, MOST_SIZE = 0.5, 2.0
"""Tried sizes in multiples of the round sun's size."""

ROUND = 1e-12
"""Relative difference of a lobe's length from its teeth at which all gears count as round."""
