"""Speed of the driving shaft over the cycle where a motor drives it against a flywheel; the flywheel's disc.

With the energy E = J w^2 / 2 of all that moves, and T_drive the motor's torque at the driving shaft,

    dE/dphi = T_drive(w) - A(phi),   w = sqrt(2 E / J(phi)),   E(0) = E(cycle)

(``ncgear.drivetrain.losses`` defines J and A).  The torque falls with the speed, so one solution is reached from any
start.  E is a polynomial on each of many panels and keeps the equation at their Radau nodes (collocation; E. Hairer, G.
Wanner, "Solving Ordinary Differential Equations II", 2nd edition 1996, section IV.5), which damp what stiff motors
would let ring; Newton's method solves the equations of all panels and the periodicity together.  Where the motor begins
to brake, or a clutch lets go, the torque has a kink: panels end there.  All panels are halved until the speed no longer
changes.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import inf, pi, sqrt

import numpy as np
from numpy.polynomial import chebyshev, legendre

from ncgear.drivetrain.cycle import apart, panels_between
from ncgear.drivetrain.losses import Demand
from ncgear.drivetrain.motor import Gearbox, StraightLine, stall_of
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import range_of
from ncgear.numerics.zeros import zeros_between

NODES = 6
"""Collocation points of a panel; the energies at ends of panels are of order 11."""

WIDEST_RAD = 2.0 * pi / 24.0
"""Widest panel of the first solution."""

SOLUTIONS = 4
"""Most solutions, each with panels half as wide as the one before."""

SETTLED = 1e-8
"""Largest relative difference of the energies of two solutions that count as equal."""

DOUBTFUL = 1e-3
"""Share above which a solution is refused; motors whose speed hardly yields leave up to 1e-5."""

MOST = 1500
"""Unknowns above which panels are not halved again: the equations of all are solved at once."""

STEPS = 60
"""Most steps of Newton's method; about 5 are usual."""

SOLVED = 1e-12
"""Largest share of the largest energy that the last step changes."""

ROUNDED = 1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 0.0
"""Torques that round the edge of a clutch, one after the other, as shares of the largest torque."""

TINY_N_MM = 1e-100
"""Least torque of a rounded edge, so that nothing is divided by zero."""

LEAST_SHARE = 0.1
"""Least share of every energy that a step leaves, so that energies stay positive."""


@dataclass(frozen=True)
class LineDrive:
    """A motor of straight line behind a gearbox; with an overrunning clutch it cannot brake the machine."""

    line: StraightLine
    gearbox: Gearbox
    overrunning_clutch: bool = False

    @property
    def free_rad_s(self) -> float:
        """Speed of the driving shaft beyond which the motor brakes or the clutch lets go."""
        return self.line.no_load_rad_s / self.gearbox.ratio

    def motor_n_mm(self, speed_rad_s: Array) -> Array:
        """Torque of the motor at speeds of the driving shaft; the motor runs without load while the clutch is open."""
        torque = self.line.torque_n_mm(speed_rad_s * self.gearbox.ratio)
        return np.maximum(torque, 0.0) if self.overrunning_clutch else torque

    def torque_n_mm(self, speed_rad_s: Array) -> Array:
        """Torque on the driving shaft."""
        return self.gearbox.shaft_n_mm(self.motor_n_mm(speed_rad_s))

    def rounded_n_mm(self, speed_rad_s: Array, round_n_mm: float) -> tuple[Array, Array]:
        """Torque on the driving shaft and its derivative by the speed, the edge of the clutch rounded by a torque."""
        line = self.line.torque_n_mm(speed_rad_s * self.gearbox.ratio)
        torque = self.gearbox.shaft_n_mm(line)
        factor = np.where(line > 0.0, self.gearbox.efficiency, 1.0 / self.gearbox.efficiency)
        slope: Array = -self.line.stall_n_mm / self.free_rad_s * self.gearbox.ratio * factor
        if not self.overrunning_clutch:
            return torque, slope
        edge = np.hypot(torque, max(round_n_mm, TINY_N_MM))
        return (torque + edge) / 2.0, slope * (1.0 + torque / edge) / 2.0


@dataclass(frozen=True, eq=False)
class SpeedCourse:
    """The periodic motion: ``energy`` in N mm over a cycle; the last finer panels moved its share ``unsettled``."""

    demand: Demand
    drive: LineDrive
    energy: PiecewiseChebyshev
    unsettled: float = 0.0

    def speed_rad_s(self, phi1_rad: Array) -> Array:
        """Speed of the driving shaft at driving angles of the cycle in rad, shape (n,)."""
        return np.asarray(np.sqrt(2.0 * self.energy(phi1_rad) / self.demand.inertia(phi1_rad)[0]))

    @cached_property
    def _points(self) -> tuple[Array, Array, Array]:
        """Gauss points in driving angle, their weights in rad, and the speeds there."""
        unit, weights = legendre.leggauss(NODES)
        half = np.diff(self.energy.breaks)[:, None] / 2.0
        points = (self.energy.breaks[:-1, None] + half * (1.0 + unit)).ravel()
        return points, (half * weights).ravel(), self.speed_rad_s(points)

    @cached_property
    def range_rad_s(self) -> tuple[Extremum, Extremum]:
        """Slowest and fastest speed with their driving angles."""
        return range_of(self.speed_rad_s, np.union1d(self._points[0], self.energy.breaks))

    @property
    def period_s(self) -> float:
        """Time that a cycle takes."""
        _, weights, speed = self._points
        return float(np.sum(weights / speed))

    @property
    def mean_rad_s(self) -> float:
        """Mean speed in time."""
        return float(np.ptp(self.energy.breaks)) / self.period_s

    @property
    def fluctuation(self) -> float:
        """Coefficient of speed fluctuation: largest less smallest speed over the mean."""
        slow, fast = self.range_rad_s
        return (fast.value - slow.value) / self.mean_rad_s

    @property
    def rms_n_mm(self) -> float:
        """Root of the mean square in time of the motor's torque."""
        _, weights, speed = self._points
        return sqrt(float(np.sum(weights / speed * self.drive.motor_n_mm(speed) ** 2)) / self.period_s)

    @property
    def motor_range_n_mm(self) -> tuple[float, float]:
        """Least and largest torque of the motor; the least is below 0 where it brakes."""
        slow, fast = (self.drive.motor_n_mm(np.array([end.value]))[0] for end in self.range_rad_s)
        return float(fast), float(slow)

    @property
    def drive_work_n_mm(self) -> float:
        """Work of the motor on the driving shaft in a cycle."""
        _, weights, speed = self._points
        return float(np.sum(weights * self.drive.torque_n_mm(speed)))

    @property
    def energy_error(self) -> float:
        """Difference of the motor's work from the machine's demand, over the most that its masses store."""
        return abs(self.drive_work_n_mm - self.asked_work_n_mm) / float(self.energy(self._points[0]).max())

    @property
    def asked_work_n_mm(self) -> float:
        """Work that the machine asks for in a cycle."""
        points, weights, _ = self._points
        return float(np.sum(weights * self.demand.at_any_speed_n_mm(points)))


def speed_course(demand: Demand, drive: LineDrive) -> SpeedCourse:
    """The periodic motion with inertia; raises NoSuchMechanism if the motor stops, Unanswered if unsettled."""
    own = demand.cycle.breaks_rad
    places, breaks, before = demand.cycle.loads.phi1_rad, own, None
    moved, found = inf, None
    for number in range(SOLUTIONS):
        found = _solved(demand, drive, panels_between(breaks, WIDEST_RAD / 2.0**number), found)
        kinks = _free_rad(found)
        if kinks.size:
            breaks = apart(np.concatenate([own, kinks]), float(own[0]), float(own[-1]))
            found = _solved(demand, drive, panels_between(breaks, WIDEST_RAD / 2.0**number), found)
        energy = found.energy(places)
        if before is not None:
            moved = float(np.abs(energy - before).max() / energy.max())
        if moved <= SETTLED or (before is not None and NODES * found.energy.breaks.size > MOST):
            break
        before = energy
    if found is None or moved > DOUBTFUL:
        raise Unanswered(f"the speed over the cycle moves by {moved:.1e} of its energy with finer panels")
    return replace(found, unsettled=moved)


def _free_rad(course: SpeedCourse) -> Array:
    """Driving angles at which the speed passes the speed without torque, shape (k,), between points."""
    points, free = course.demand.cycle.loads.phi1_rad, course.drive.free_rad_s
    beyond = course.speed_rad_s(points) > free
    change = np.nonzero(beyond[:-1] != beyond[1:])[0]
    if not change.size:
        return np.empty(0)
    return zeros_between(lambda phi1: course.speed_rad_s(phi1) - free, points[change], points[change + 1])


def _solved(demand: Demand, drive: LineDrive, ends: Array, known: SpeedCourse | None) -> SpeedCourse:
    """Newton's method for the energies at the nodes of panels and at the beginning, from a known course.

    Without a known course the edge at which a clutch opens is rounded at first, and then less and less.
    """
    unit, weights, inside = _radau()
    half = np.diff(ends)[:, None] / 2.0
    points = (ends[:-1, None] + half * (1.0 + unit)).ravel()
    whole = (half * weights).ravel()
    within = half[:, :, None] * inside
    inertia, asked = demand.inertia(points)[0], demand.at_any_speed_n_mm(points)
    mean, strongest = float(np.sum(whole * asked)) / float(np.ptp(ends)), float(drive.torque_n_mm(np.zeros(1))[0])
    if mean >= strongest:
        raise _stops(demand, drive, "is stopped by it")
    if mean <= 0.0 and drive.overrunning_clutch:
        raise _stops(demand, drive, "is driven by it")
    # The speed at which the motor gives the mean torque
    energy = inertia * (drive.free_rad_s * (1.0 - mean / strongest)) ** 2 / 2.0
    rounded: tuple[float, ...] = ROUNDED if drive.overrunning_clutch else ROUNDED[-1:]
    if known is not None:
        # A polynomial of coarse panels may fall below 0 where energies are small
        energy, rounded = np.maximum(known.energy(points), LEAST_SHARE * energy), rounded[-3:]
    start = float(energy[0])
    for round_n_mm in float(np.abs(asked).max()) * np.array(rounded):
        for _ in range(STEPS):
            speed = np.sqrt(2.0 * energy / inertia)
            torque, change = drive.rounded_n_mm(speed, round_n_mm)
            given, slope = torque - asked, change / (inertia * speed)
            step, begins = _newton_step(energy - start, given, slope, within, whole)
            falling = step < 0.0
            room = (1.0 - LEAST_SHARE) * energy[falling] / -step[falling]
            share = float(np.min(room, initial=1.0))
            energy, start = energy + share * step, start + share * begins
            if max(np.abs(step).max(), abs(begins)) <= SOLVED * energy.max():
                break
        else:
            raise _stops(demand, drive, "is stopped by it, or no steady motion is found")
    given = drive.torque_n_mm(np.sqrt(2.0 * energy / inertia)) - asked
    return SpeedCourse(demand, drive, _form(ends, unit, given, start))


def _newton_step(beyond: Array, given: Array, slope: Array, within: Array, whole: Array) -> tuple[Array, float]:
    """Steps of the energies at the nodes (shape (n,)) and at the beginning.

    ``beyond`` are the energies less the energy at the beginning, ``given`` the torque by which the energies grow, with
    its ``slope`` by them, ``within`` (shape (panels, NODES, NODES)) the integrals from a panel's start and ``whole``
    the weights of all nodes.  With the steps s at the beginning and a at a panel's start, the steps in the panel are a
    u + v: its own equations give u and v, and its addition to a; after all panels a equals s, which gives s.
    """
    shape = within.shape[:2]
    torque, rising, weight = (array.reshape(shape) for array in (given, slope, whole))
    before = np.concatenate([[0.0], np.cumsum((weight * torque).sum(axis=1))])
    missed = beyond.reshape(shape) - before[:-1, None] - (within @ torque[:, :, None])[:, :, 0]
    right = np.stack([np.ones(shape), -missed], axis=-1)
    u, v = np.moveaxis(np.linalg.solve(np.eye(NODES) - within * rising[:, None, :], right), -1, 0)
    grows, adds = ((weight * rising * term).sum(axis=1) for term in (u, v))
    # a after the panels, as a share of s and a rest.
    shares, rests = np.ones(shape[0] + 1), np.zeros(shape[0] + 1)
    for panel in range(shape[0]):
        shares[panel + 1] = shares[panel] * (1.0 + grows[panel])
        rests[panel + 1] = rests[panel] * (1.0 + grows[panel]) + adds[panel]
    begins = (before[-1] + rests[-1]) / (1.0 - shares[-1])
    starts = begins * shares[:-1] + rests[:-1]
    return (starts[:, None] * u + v).ravel(), float(begins)


def _radau() -> tuple[Array, Array, Array]:
    """Radau's nodes in [-1, 1], the right end included, their weights, and the matrix of integrals to each node.

    Integrals are those from -1 on of the polynomial through the values at the nodes.
    """
    unit = np.sort(np.real(legendre.legroots(np.eye(NODES + 1)[NODES] - np.eye(NODES + 1)[NODES - 1])))
    unit[-1] = 1.0
    integrals = legendre.legint(np.eye(NODES), lbnd=-1, axis=0)
    inside = legendre.legvander(unit, NODES) @ integrals @ np.linalg.inv(legendre.legvander(unit, NODES - 1))
    return unit, inside[-1], inside


FOLLOWED = 20.0
"""Cycles in which a motor without a steady motion is followed from the wanted speed to where it stops."""


def _stops(demand: Demand, drive: LineDrive, how: str) -> NoSuchMechanism:
    place = stall_of(demand, drive.torque_n_mm, demand.speed_rad_s, FOLLOWED * demand.cycle.cycle_rad)
    where = "" if place is None else f" ({place})"
    return NoSuchMechanism(
        f"the motor cannot keep the machine turning evenly from cycle to cycle: it {how}{where}; a stronger motor, "
        "another gearbox ratio or a larger flywheel is needed",
        key="drivetrain.motor",
    )


def _form(ends: Array, unit: Array, slope: Array, start: float) -> PiecewiseChebyshev:
    """The energy from its slope at the nodes and its value at the beginning."""
    values = slope.reshape(-1, unit.size).T
    series = np.linalg.solve(chebyshev.chebvander(unit, unit.size - 1), values)
    energy = PiecewiseChebyshev(ends, np.asarray(series, dtype=float)).integrated()
    energy.coefficients[0] += start
    return energy


STEEL_KG_MM3 = 7.85e-6


@dataclass(frozen=True)
class FlywheelDisc:
    """A full disc of steel as a flywheel: its width, its mass, and the speed of its rim."""

    diameter_mm: float
    width_mm: float
    mass_kg: float
    rim_speed_m_s: float


def disc(inertia_kg_mm2: float, diameter_mm: float, speed_rad_s: float) -> FlywheelDisc:
    """The disc with a moment of inertia m d^2 / 8."""
    mass = 8.0 * inertia_kg_mm2 / diameter_mm**2
    width = mass / (STEEL_KG_MM3 * pi * diameter_mm**2 / 4.0)
    return FlywheelDisc(diameter_mm, width, mass, speed_rad_s * diameter_mm / 2000.0)
