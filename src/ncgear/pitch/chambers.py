"""Displacement of a pair of gears in a close housing, and of a motor with a lobed sun, round planets and a lobed ring.

A chamber lies between two neighbouring planets, the sun and the ring; pitch curves stand for the teeth: the seal is
where curves touch.  With the notation of ``lobed``, the trailing planet of a chamber is at the place g = phi + chi and
the leading one at g + 2 pi / N.  A pressure p in the chamber pushes the planet ahead with 2 rho cos(eta) p per width,
square to the line from the axis O through both contacts, which share the push; the sun also takes the pressure on its
own curve.  Together they turn the sun with p (r R / 2), ahead less behind, where r R = d^2 - rho^2, so the chamber's
area grows with the sun's angle alpha by

    dA/dalpha = (d_ahead^2 - d_behind^2) / 2.

Each chamber goes through n N / (n + N) cycles in a turn of the sun against the ring, all n + N chambers through n N
cycles, so the motor displaces n N (A_most - A_least) in a turn.  Chambers are of the least area where a lobe of the sun
meets a hump of the ring, and of the greatest where a hollow meets a lobe's top: these dead spaces stand still to the
ring, and ports lie between them.

A pair in a housing, as in oval-gear flow meters and pumps: the housing is a circle about each axis.  Liquid passes from
one side to the other between each gear and its circle, and none passes where the gears mesh.  With the greatest radii
R1 and R2 and the pitch radii r1 and r2 at the pitch point, a turn dphi1 of the driving gear displaces, per face width,

    dA = ((R1^2 - r1^2) dphi1 + (R2^2 - r2^2) dphi2) / 2

since a gear's side of the space between housing and pitch point sweeps (R^2 - r^2)/2 per angle (the same balance gives
the flow of circular gear pumps, e.g. J. Ivantysyn, M. Ivantysynova, "Hydrostatic Pumps and Motors", 2001, chapter 9).
With w = dphi2/dphi1, r1 = a w/(1 + w) and r2 = a/(1 + w) this is

    2 dA/dphi1 = R1^2 + R2^2 w - a^2 w/(1 + w)

The pitch point counts as the seal: real teeth move the seal along the line of action, which adds a ripple, and leaks
are not counted.  A tip of each gear must be at the housing between both ports all the time, as with two lobes or more.
"""

from __future__ import annotations

from functools import cached_property
from math import gcd, lcm, pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev, fitted
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each, range_of
from ncgear.numerics.jet import Jet
from ncgear.numerics.zeros import all_zeros
from ncgear.pitch.lobed import LobedCurves
from ncgear.ratio.transmission import Piece, Transmission

PLACES = 241
"""Places over a period at which flow and forces are first computed; both are smooth but for kinks and jumps."""


@dataclass(frozen=True)
class DeadSpace:
    """A chamber of the least or of the greatest area in mm^2, at the place ``place_rad`` of its trailing planet.

    ``middle_rad`` is its direction from a lobe's top of the ring; the planets beside it stand ``beside_rad`` to either
    side, seen from the axis by their contacts.
    """

    area_mm2: float
    place_rad: float
    middle_rad: float
    beside_rad: float


@dataclass(frozen=True)
class Port:
    """The greatest round port that planets cover at both dead spaces beside it; negative radius: none.

    ``direction_rad`` is the direction of its centre, counter-clockwise from a lobe's top of the ring.
    """

    direction_rad: float
    distance_mm: float
    radius_mm: float


@dataclass(frozen=True, eq=False)
class Chambers:
    """The chambers of a motor of a width in mm."""

    curves: LobedCurves
    width_mm: float

    @property
    def count(self) -> int:
        """Number of chambers, as many as planets."""
        return self.curves.planets

    @property
    def step_rad(self) -> float:
        """Distance from a planet's place to the next planet's place."""
        return 2.0 * pi / self.curves.ring_lobes

    @property
    def cycle_rad(self) -> float:
        """Turn of the sun during one cycle of a chamber."""
        return self.step_rad + self.curves.lobe_rad

    def contact_rad(self, place_rad: Array) -> Array:
        """phi, the polar angle on the sun at which a planet at a place touches, any shape."""
        return self.curves.places.angle(place_rad)

    @cached_property
    def _swept(self) -> tuple[PiecewiseChebyshev, PiecewiseChebyshev]:
        """Areas over a lobe of the sun that the rays to the contacts sweep, on the sun and on the ring."""

        def on_sun(phi: Array) -> Array:
            return self.curves.radius(phi, 0).value ** 2 / 2.0

        def on_ring(phi: Array) -> Array:
            whole, rate = self.curves.ring(phi, 0)
            return whole.value**2 * rate.value / 2.0

        sun, ring = (chebyshev.fitted(area, [0.0, self.curves.lobe_rad]).integrated() for area in (on_sun, on_ring))
        return sun, ring

    def area_mm2(self, place_rad: Array) -> Array:
        """Area of the chamber whose trailing planet is at a place, shape (n,)."""
        behind, ahead = (self.contact_rad(at) for at in (place_rad, place_rad + self.step_rad))
        area = np.full(place_rad.shape, self._swept[1].final)
        for form in self._swept:
            area -= _continued(form, ahead, self.curves.lobe_rad) - _continued(form, behind, self.curves.lobe_rad)
        for phi, side in ((behind, -1.0), (ahead, 1.0)):
            # The part of the planet on the chamber's side of the line through its contacts.
            lean = 2.0 * side * self.curves.lean_rad(phi)
            area -= self.curves.planet_radius_mm**2 / 2.0 * (pi + lean + np.sin(lean))
        return area

    def rate_mm2(self, place_rad: Array) -> Array:
        """dA/dalpha in mm^2 per rad of the chamber whose trailing planet is at a place, shape (n,)."""
        behind, ahead = (self._turned_by(self.contact_rad(at)) for at in (place_rad, place_rad + self.step_rad))
        return ahead - behind

    def _turned_by(self, phi: Array) -> Array:
        """r R / 2."""
        r, cosine, _ = (jet.value for jet in self.curves.sun(phi, 0))
        return np.asarray(r * (r + 2.0 * self.curves.planet_radius_mm * cosine) / 2.0)

    @cached_property
    def dead_spaces(self) -> tuple[DeadSpace, DeadSpace]:
        """The least and the greatest chamber."""
        zeros = all_zeros(chebyshev.fitted(self.rate_mm2, [0.0, self.cycle_rad]))
        areas = self.area_mm2(zeros)
        return self._dead_space(zeros, areas, int(np.argmin(areas))), self._dead_space(
            zeros, areas, int(areas.argmax())
        )

    def _dead_space(self, places: Array, areas: Array, row: int) -> DeadSpace:
        behind, ahead = self._directions(places[row])
        return DeadSpace(float(areas[row]), float(places[row]), (behind + ahead) / 2.0, (ahead - behind) / 2.0)

    def _directions(self, place_rad: float) -> tuple[float, float]:
        phi = self.contact_rad(np.array([place_rad, place_rad + self.step_rad]))
        behind, ahead = (-self.curves.chi_rad(phi)).tolist()
        return behind, ahead + self.step_rad

    @property
    def per_turn_mm3(self) -> float:
        """Volume that the motor displaces in a turn of the sun against the ring."""
        least, most = self.dead_spaces
        return self.curves.sun_lobes * self.curves.ring_lobes * (most.area_mm2 - least.area_mm2) * self.width_mm

    def places_rad(self, alpha_rad: Array) -> Array:
        """Places of all planets at angles of the sun, shape (planets, n)."""
        return np.arange(self.count)[:, None] * self.step_rad - alpha_rad

    def flow_mm3(self, alpha_rad: Array) -> Array:
        """Flow into growing chambers in mm^3 per rad of the sun, shape (n,): also the torque in N mm per N/mm^2."""
        rates = self.rate_mm2(self.places_rad(alpha_rad).ravel()).reshape(self.count, -1)
        return np.asarray(self.width_mm * np.maximum(rates, 0.0).sum(axis=0))

    @cached_property
    def flow_range(self) -> tuple[Extremum, Extremum]:
        """The least and the greatest flow in mm^3 per rad, with the sun's angle."""
        period = 2.0 * pi / lcm(self.curves.sun_lobes, self.curves.ring_lobes)
        return range_of(self.flow_mm3, np.linspace(0.0, period, PLACES))

    @property
    def pulsation(self) -> float:
        """Greatest less least flow over the mean flow, at an even speed."""
        least, most = self.flow_range
        return (most.value - least.value) * 2.0 * pi / self.per_turn_mm3

    @property
    def pulses(self) -> int:
        """Pulses of the flow in a turn of the sun: chambers in step pulse as one; an odd number of phases pulses
        twice."""
        lobes = self.curves.sun_lobes, self.curves.ring_lobes
        apart = self.count // gcd(*lobes)
        return lcm(*lobes) * (2 if apart % 2 else 1)

    def push_n(self, place_rad: Array, pressure_mpa: float) -> Array:
        """Force of the pressure in N on a planet at a place, ahead positive; pressure acts in growing chambers."""
        behind, ahead = self.rate_mm2(place_rad - self.step_rad) > 0.0, self.rate_mm2(place_rad) > 0.0
        _, cosine, _ = self.curves.sun(self.contact_rad(place_rad), 0)
        across = 2.0 * self.curves.planet_radius_mm * cosine.value * self.width_mm
        return np.asarray(pressure_mpa * across * (behind.astype(float) - ahead))

    def tooth_force_n(self, place_rad: Array, pressure_mpa: float, rack_angle_rad: float) -> Array:
        """Normal force in N of a planet's teeth on the sun's teeth, and on the ring's teeth alike.

        The push goes through the planet's centre and is square to the line of both contacts, so each takes half of it;
        flanks stand at the rack's angle to the pitch curves, which lean by eta from the push.
        """
        push = self.push_n(place_rad, pressure_mpa)
        lean = self.curves.lean_rad(self.contact_rad(place_rad))
        return np.abs(push) / 2.0 / np.cos(rack_angle_rad - np.sign(push) * lean)

    def most_tooth_force(self, pressure_mpa: float, rack_angle_rad: float) -> Extremum:
        """The greatest of these forces in N, with the planet's place."""
        places = np.linspace(0.0, self.cycle_rad, PLACES)
        return largest_of_each(lambda at: self.tooth_force_n(at, pressure_mpa, rack_angle_rad)[None], places)[0]

    def ports(self, covering_mm: float) -> tuple[Port, Port]:
        """The ports ahead of the least and of the greatest chamber that planets of a radius ``covering_mm`` cover.

        Growing chambers open to the first while the sun turns ahead, shrinking ones to the second.  The leading planet
        of the dead space behind a port covers it, and the trailing planet of the dead space ahead.
        """
        found = []
        for dead, next_one in (self.dead_spaces, self.dead_spaces[::-1]):
            leading = self._centre_mm(dead.place_rad + self.step_rad, dead, 1.0)
            trailing = self._centre_mm(next_one.place_rad, next_one, -1.0)
            # The next dead space is half a lobe of the ring ahead.
            turn = dead.middle_rad + self.step_rad / 2.0 - next_one.middle_rad
            trailing = trailing * np.exp(1j * turn)
            middle = (leading + trailing) / 2.0
            radius = covering_mm - abs(leading - trailing) / 2.0
            found.append(Port(float(np.angle(middle)) % self.step_rad, abs(middle), float(radius)))
        return found[0], found[1]

    def _centre_mm(self, place_rad: float, dead: DeadSpace, side: float) -> complex:
        phi = self.contact_rad(np.array([place_rad]))
        seen: ComplexArray = self.curves.centre_mm(phi) * np.exp(-1j * phi)
        return complex(seen[0] * np.exp(1j * (dead.middle_rad + side * dead.beside_rad)))


def _continued(form: PiecewiseChebyshev, phi: Array, period: float) -> Array:
    periods, local = np.divmod(phi, period)
    return periods * form.final + form(local)


@dataclass(frozen=True)
class Pumped:
    """Displacement of a pair: ``per_turn_mm3`` in a turn of the driving gear, ``least`` and ``most`` in mm^3 per rad.

    ``least`` and ``most`` have the driving angles in rad at which they occur.
    """

    per_turn_mm3: float
    least: Extremum
    most: Extremum

    @property
    def pulsation(self) -> float:
        """Largest less smallest flow over the mean flow, at an even driving speed."""
        return (self.most.value - self.least.value) * 2.0 * pi / self.per_turn_mm3


def pumped(
    transmission: Transmission, center_distance_mm: float, radii_mm: tuple[float, float], face_width_mm: float
) -> Pumped:
    """Displacement of an external pair in a housing of the given radii about the driving and the driven axis."""
    first, second = radii_mm
    factor = 0.5 * face_width_mm

    def per_rad(slope: Jet) -> Jet:
        return factor * (slope * second**2 - center_distance_mm**2 * (slope / (slope + 1.0)) + first**2)

    def of(piece: Piece) -> float:
        def value(phi1: Array) -> Array:
            return per_rad(piece.slope(phi1, 0)).value

        return fitted(value, [piece.start_rad, *piece.knots_rad, piece.end_rad]).integrated().final

    periods = 2.0 * pi / transmission.lobes.driving_period_rad
    least, most = transmission.extremes(per_rad, 0)
    return Pumped(periods * sum(map(of, transmission.pieces)), least, most)
