"""The load of a mechanism on its crank shaft in any motion: inertia that changes with the angle, resistance, weight.

With q the crank's angle and primes by it, the kinetic energy is M(q) q.^2 / 2 with the reduced inertia

    M = J_crank + sum over the other bodies of m (x_G'^2 + y_G'^2) + J beta'^2

With U the work against the load plus the potential of the weights, Lagrange's equation of one degree of freedom
(Eksergian's equation of motion; e.g. B. Paul, "Kinematics and Dynamics of Planar Machinery", Prentice-Hall 1979,
chapter 9) is

    M(q) q.. + M'(q) q.^2 / 2 + U'(q) = moment of the teeth

The load of the slider depends on the crank's angle alone, which gives the stroke and the place in it, as in the check
of power.  A slider that moves back a little within a stroke meets the same force there.  This holds for its friction
too, which then returns its work: a slider at rest, or in small oscillations about its law, meets no jump of force, and
over whole turns the work is that of friction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from functools import reduce
from math import ceil, pi
from operator import add

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism, MovingMass
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.numerics.periodic_table import PeriodicTable, cubics
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.numerics.zeros import zeros_between


def reduced_inertia(moving: Sequence[MovingMass], masses: Masses) -> tuple[Array, Array]:
    """M in kg mm^2 and dM/dq in kg mm^2/rad at n crank angles, shape (n,) each.

    ``moving`` are all masses that do not turn with the crank; their places need derivatives of order 2 by its angle.
    """
    each = [
        body.mass_kg * (_squared(body.center.x) + _squared(body.center.y)) + body.inertia_kg_mm2 * _squared(body.angle)
        for body in moving
    ]
    whole = reduce(add, each) + masses.crank_shaft_kg_mm2
    return whole.value, whole.derivative(1)


def _squared(place: Jet) -> Jet:
    slope = place.differentiated()
    return slope * slope


INTERVALS = 4096
"""Intervals of the table in a turn; torques of the shipped baler are then met to 1e-9 of the largest
(tests/test_crank_load.py)."""


NO_STRETCHES = np.empty((0, 3))

CLEAR_RAD = 1e-9
"""Angle within which a crank counts as being at a stop: rounding errors of the event that took it there."""


@dataclass(frozen=True, eq=False)
class CrankLoad:
    """M in N mm s^2 and U in N mm as one table over the crank's angle; U rises by the work of each turn.

    ``dead_centres_rad`` are the crank angles at which the working stroke begins and ends.  ``narrow_rad`` (shape (k,
    3)) has the start and the end of each stretch in which the load changes within an interval or two, and the least
    distance of knots there: a solver of the motion must not step over it.
    """

    table: PeriodicTable
    dead_centres_rad: tuple[float, float]
    narrow_rad: Array = field(default_factory=lambda: NO_STRETCHES)

    def next_stop_rad(self, crank_rad: float) -> tuple[float, float]:
        """The first dead centre or end of a narrow stretch beyond a crank angle, and the largest way to go at once."""
        turn, local = divmod(crank_rad + CLEAR_RAD, 2.0 * pi)
        stops = np.concatenate([self.dead_centres_rad, self.narrow_rad[:, :2].ravel(), [2.0 * pi]])
        within = (self.narrow_rad[:, 0] <= local) & (local < self.narrow_rad[:, 1])
        way = self.narrow_rad[within, 2].min(initial=np.inf)
        return turn * 2.0 * pi + float(stops[stops > local].min()), float(way)

    def acceleration_rad_s2(self, angle_rad: Array, speed_rad_s: Array, moment_n_mm: Array) -> Array:
        """Acceleration of the crank shaft under a moment of the teeth; any shape."""
        value, slope = self.table.at(angle_rad)
        moment = moment_n_mm - slope[..., 1] - 0.5 * slope[..., 0] * speed_rad_s**2
        return np.asarray(moment / value[..., 0])

    def torque_n_mm(self, angle_rad: Array, speed_rad_s: Array, acceleration_rad_s2: Array) -> Array:
        """Moment that the teeth have to bring for a motion; any shape."""
        value, slope = self.table.at(angle_rad)
        torque: Array = value[..., 0] * acceleration_rad_s2 + 0.5 * slope[..., 0] * speed_rad_s**2 + slope[..., 1]
        return torque

    def energy_n_mm(self, angle_rad: Array, speed_rad_s: Array) -> Array:
        """Kinetic energy plus the work put into load and weights since the angle 0; shapes broadcast."""
        values, _ = self.table.at(angle_rad)
        energy: Array = 0.5 * values[..., 0] * speed_rad_s**2 + values[..., 1]
        return energy


def crank_load(linkage: Mechanism, masses: Masses, load: SliderLoad) -> CrankLoad:
    """The load of a mechanism; raises WrongInput where nothing has inertia, as at a dead centre without a gear."""
    strokes = [_Stroke(linkage, load, returning) for returning in ((False, True) if linkage.RETURNS else (False,))]
    parts = [stroke.knots_rad() for stroke in strokes]
    narrow = np.concatenate([stroke.narrow_rad(knots) for stroke, knots in zip(strokes, parts, strict=True)])
    work = [stroke.work(knots) for stroke, knots in zip(strokes, parts, strict=True)]
    out = load.work_n_mm(np.array([linkage.stroke_mm]), linkage.stroke_mm, returning=False)
    work[1:] = [(out + value, slope) for value, slope in work[1:]]
    knots = np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
    inertia, change, weight = of_crank_angle(linkage, masses, knots)
    if not float(inertia.min()) > 0.0:
        raise WrongInput(
            "nothing that turns with the crank has inertia, and at the dead centres nothing else has: give "
            "driven_gear_kg_mm2 or the crank's inertia_kg_mm2",
            key="masses",
        )
    work_value, work_slope = (np.concatenate([work[0][row], *(back[row][1:] for back in work[1:])]) for row in (0, 1))
    values = np.column_stack([N_PER_KG_MM_S2 * inertia, work_value + weight.value])
    slopes = np.column_stack([N_PER_KG_MM_S2 * change, work_slope + weight.derivative(1)])
    table = cubics(np.diff(knots), (values[:-1], slopes[:-1]), (values[1:], slopes[1:]))
    whole = PeriodicTable(knots, table, np.array([0.0, float(work_value[-1])]))
    return CrankLoad(whole, (0.0, linkage.working_angle_rad), narrow)


def of_crank_angle(linkage: Mechanism, masses: Masses, angle_rad: Array) -> tuple[Array, Array, Jet]:
    """M and dM/dq as ``reduced_inertia`` gives them, and the potential of the weights in N mm, at n crank angles."""
    angle = Jet.variable(angle_rad, 2)
    moving = linkage.moving_masses(angle, masses)
    crank = MovingMass(masses.crank_kg, linkage.crank_body(angle, masses.crank_center_mm).center, angle)
    return *reduced_inertia(moving, masses), _potential([*moving, crank], masses)


def _knots(low: float, high: float) -> Array:
    return np.linspace(low, high, ceil((high - low) * INTERVALS / (2.0 * pi)) + 1)


MISSED = 1e-5
"""Largest error of the table between its knots, as a share of the largest moment of the resistance.  For a resistance
that begins with a kink, like the shipped baler's, evenly spaced knots have a smaller error."""

NARROW = 1e-2
"""Error of evenly spaced knots, as such a share, from which a resistance is narrow: a solver might step over it."""

CLOSEST_RAD = 1e-9
"""Crank angle below which knots come no closer: rounding errors of the work would show in its slope."""

MOST_KNOTS = 1 << 16
"""Most knots of the refinement: sixteen times the knots of a smooth resistance."""

LEAST_WAY = 1e-3
"""Least way to go at once in a narrow stretch, as a share of the stretch."""

SHARES = np.array([[0.25], [0.6]])
"""Places of an interval at which the table is compared with the resistance.  They are not symmetric about its middle,
where a table that is exact at both ends may agree with a different curve by chance."""


@dataclass(frozen=True, eq=False)
class _Stroke:
    """One stroke of a mechanism with the load of its slider."""

    linkage: Mechanism
    load: SliderLoad
    returning: bool

    @property
    def ends_rad(self) -> tuple[float, float]:
        """Crank angles of the dead centres at the beginning and the end of the stroke."""
        working = self.linkage.working_angle_rad
        return (working, 2.0 * pi) if self.returning else (0.0, working)

    def work(self, angle: Array) -> tuple[Array, Array]:
        """Work against the load since the stroke began, and its slope by the crank's angle."""
        slide, stroke = self.linkage.displacement(Jet.variable(angle, 1)), self.linkage.stroke_mm
        place = np.clip(slide.value, 0.0, stroke)
        force = self.load.backwards_n(place, self.returning)
        return self.load.work_n_mm(place, stroke, self.returning), force * slide.derivative(1)

    def knots_rad(self) -> Array:
        """Crank angles of the stroke, closer together where the load changes fast.

        The table is also tested where the resistance turns or begins, so that no narrow peak is between two knots.
        """
        corners = self.load.corners_mm(self.linkage.stroke_mm, self.returning)
        turns = crank_angles_rad(self.linkage, corners, self.returning)
        knots = _knots(*self.ends_rad)
        while knots.size < MOST_KNOTS:
            width = np.diff(knots)
            tried = np.union1d((knots[:-1] + width * SHARES).ravel(), turns)
            missed = np.unique(self._missed_at(knots, tried, MISSED))
            missed = missed[width[missed] > CLOSEST_RAD]
            if not missed.size:
                break
            within = turns[np.isin(np.searchsorted(knots, turns, side="right") - 1, missed)]
            knots = np.unique(np.concatenate([knots, knots[missed] + width[missed] / 2.0, within]))
        return knots

    def narrow_rad(self, knots: Array) -> Array:
        """Start, end and least distance of knots of the stretches that evenly spaced knots would miss, shape (k, 3)."""
        even = _knots(*self.ends_rad)
        tried = np.union1d(knots[:-1], knots[:-1] + np.diff(knots) * SHARES)
        missed = np.unique(self._missed_at(even, tried, NARROW))
        if not missed.size:
            return NO_STRETCHES
        runs = np.split(missed, np.nonzero(np.diff(missed) > 1)[0] + 1)
        return np.array([_stretch(knots, float(even[run[0]]), float(even[run[-1] + 1])) for run in runs])

    def _missed_at(self, knots: Array, tried: Array, share: float) -> IndexArray:
        """The intervals of the tested places where the error of a table exceeds a share of the largest moment."""
        work, moment = self.work(knots)
        table = PeriodicTable(knots, cubics(np.diff(knots), (work[:-1], moment[:-1]), (work[1:], moment[1:])))
        exact = self.work(tried)[1]
        missed = np.abs(table.at(tried)[1] - exact) > share * max(np.abs(exact).max(), np.abs(moment).max())
        return table.place(tried[missed])[1]


def _stretch(knots: Array, low: float, high: float) -> tuple[float, float, float]:
    """A stretch between two angles, with the least distance of the knots in it."""
    least = float(np.diff(knots[(knots >= low) & (knots <= high)]).min())
    return low, high, max(least, LEAST_WAY * (high - low))


def crank_angles_rad(linkage: Mechanism, places_mm: Array, returning: bool) -> Array:
    """Crank angles of one stroke for places of the slider within its stroke, shape (n,)."""
    if not places_mm.size:
        return places_mm
    start, end = (linkage.working_angle_rad, 2.0 * pi) if returning else (0.0, linkage.working_angle_rad)
    ends = np.full(places_mm.shape, start), np.full(places_mm.shape, end)
    return zeros_between(lambda angle: linkage.displacement(Jet.variable(angle, 0)).value - places_mm, *ends)


def _potential(moving: Sequence[MovingMass], masses: Masses) -> Jet:
    """Potential energy of the weights in N mm."""
    along, across = masses.gravity_m_s2
    total = 0.0 * moving[0].angle
    for body in moving:
        total = total - body.mass_kg * (along * body.center.x + across * body.center.y)
    return total
