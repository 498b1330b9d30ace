"""A motor behind a gearbox: its torque at the driving shaft, its load over a cycle, and where it stops.

A gearbox of the ratio i and the efficiency e makes T i e from the motor's torque T where the motor drives, and T i / e
where it brakes: the gearbox helps to brake.  A motor's heat follows from the root mean square of its torque over time,
which must stay below its rated torque (e.g. R. L. Norton, "Design of Machinery", 5th edition 2012, section 2.19 for
motors and their speed-torque lines).  A motor with a straight line loses torque in proportion to its speed,

    T(w) = T_rated (n_0 - n) / (n_0 - n_rated)

as induction motors about their rated point and direct-current motors do.

With the energy K = J w^2 / 2 of all that moves, the motor's torque T at the driving shaft, and A as in
``ncgear.drivetrain.losses``,

    dK/dphi = T(w) - A(phi),   w = sqrt(2 K / J(phi))

and the motor stops where K comes down to 0: there A is more than T at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import ceil, degrees, sqrt

import numpy as np

from ncgear.drivetrain.cycle import panels_between
from ncgear.drivetrain.losses import Demand
from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import fitted
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.units import N_M_PER_N_MM, in_words


@dataclass(frozen=True)
class Gearbox:
    """Speed of the motor over the driving shaft's speed, and the efficiency, 1 without losses."""

    ratio: float = 1.0
    efficiency: float = 1.0

    def motor_n_mm(self, torque_n_mm: Array) -> Array:
        """Torque of the motor that gives a torque on the driving shaft; negative where it brakes."""
        driving = torque_n_mm / (self.ratio * self.efficiency)
        return np.where(torque_n_mm > 0.0, driving, torque_n_mm * self.efficiency / self.ratio)

    def shaft_n_mm(self, motor_n_mm: Array) -> Array:
        """The inverse of ``motor_n_mm``."""
        driving = motor_n_mm * self.ratio * self.efficiency
        return np.where(motor_n_mm > 0.0, driving, motor_n_mm * self.ratio / self.efficiency)


@dataclass(frozen=True)
class StraightLine:
    """Torque in N mm at rest and speed in rad/s without torque, of the motor's own shaft."""

    stall_n_mm: float
    no_load_rad_s: float

    def torque_n_mm(self, speed_rad_s: Array) -> Array:
        """Torque at speeds of the motor's shaft; negative beyond the speed without torque, where the motor brakes."""
        return self.stall_n_mm * (1.0 - speed_rad_s / self.no_load_rad_s)


@dataclass(frozen=True, eq=False)
class MotorLoad:
    """Load of a motor that turns evenly over a cycle; torques in N mm at the motor's shaft.

    ``braking_share`` is the share of the time in which it brakes, and ``braking_n_mm``, 0 or less, the mean torque over
    that time.
    """

    speed_rad_s: float
    rms_n_mm: float
    mean_n_mm: float
    most_n_mm: Extremum
    least_n_mm: Extremum
    braking_share: float
    braking_n_mm: float

    @property
    def rms_power_n_mm_s(self) -> float:
        """The power in N mm/s for which a motor must be rated to stay cool enough."""
        return self.rms_n_mm * self.speed_rad_s


def motor_load(demand: Demand, gearbox: Gearbox) -> MotorLoad:
    """The load of a motor that keeps the driving shaft at its speed."""
    cycle = demand.cycle
    torque = gearbox.motor_n_mm(demand.torque_n_mm(cycle.loads.phi1_rad))

    # The gearbox keeps the order of torques
    least, most = (
        Extremum(float(gearbox.motor_n_mm(np.array([end.value]))[0]), end.at) for end in demand.torque_range_n_mm
    )
    braking = float(np.sum(cycle.weight_rad[torque < 0.0]))
    return MotorLoad(
        speed_rad_s=gearbox.ratio * demand.speed_rad_s,
        rms_n_mm=sqrt(cycle.integral(torque**2) / cycle.cycle_rad),
        mean_n_mm=cycle.integral(torque) / cycle.cycle_rad,
        most_n_mm=most,
        least_n_mm=least,
        braking_share=braking / cycle.cycle_rad,
        braking_n_mm=cycle.integral(np.minimum(torque, 0.0)) / braking if braking else 0.0,
    )


ACCURACY = 1e-8
"""Relative error of a step: a place is then exact to some 1e-7 of a turn."""

WIDEST_RAD = 0.3
"""Longest way that is integrated at once."""


@dataclass(frozen=True)
class Stall:
    """Driving and crank angle at which a motor stops, counted from the start on, and torques at the driving shaft.

    ``needed_n_mm`` is the machine's demand there, ``most_n_mm`` its largest demand over the cycle, and ``given_n_mm``
    the motor's torque at rest.
    """

    phi1_rad: float
    crank_rad: float
    needed_n_mm: float
    most_n_mm: Extremum
    given_n_mm: float

    def __str__(self) -> str:
        return f"the motor stops at phi1 = {in_words(self.phi1_rad)}, {self.there}"

    @property
    def there(self) -> str:
        """The place of the crank, and all torques, in words."""
        needed, most, given = (
            N_M_PER_N_MM * torque for torque in (self.needed_n_mm, self.most_n_mm.value, self.given_n_mm)
        )
        return (
            f"crank at {in_words(self.crank_rad)}: the machine needs {needed:.4g} N m at the driving shaft there, and "
            f"{most:.4g} N m at phi1 = {in_words(self.most_n_mm.at)}; the motor gives {given:.4g} N m at rest"
        )

    @property
    def brief(self) -> str:
        """The same in less than a line."""
        given, most = N_M_PER_N_MM * self.given_n_mm, N_M_PER_N_MM * self.most_n_mm.value
        return f"the motor stops at phi1 = {degrees(self.phi1_rad):.4g} deg: it has {given:.3g} of {most:.3g} N m"


def stall_of(
    demand: Demand, torque_n_mm: Callable[[Array], Array], start_rad_s: float, turned_rad: float
) -> Stall | None:
    """Where a motor stops, from a start at phi1 = 0 with a speed, within a driving angle; None where it does not stop.

    ``torque_n_mm`` gives its torque on the driving shaft, in N mm, at speeds of that shaft in rad/s, shape (n,).
    Raises Unanswered where the solver fails.
    """
    from scipy.integrate import solve_ivp

    breaks = demand.cycle.breaks_rad
    asked, inertia = fitted(demand.at_any_speed_n_mm, breaks), fitted(lambda phi1: demand.inertia(phi1)[0], breaks)
    panels, cycle = panels_between(breaks, WIDEST_RAD), demand.cycle.cycle_rad

    def left(_phi1: float, energy: Array) -> float:
        return float(energy[0])

    left.terminal, left.direction = True, -1.0  # type: ignore[attr-defined]
    energy = float(inertia(np.zeros(1))[0]) * start_rad_s**2 / 2.0
    small = max(energy, float(np.abs(asked(panels)).max()) * WIDEST_RAD)
    for turn in range(ceil(turned_rad / cycle)):
        for start, end in pairwise(panels):

            def change(phi1: float, energy: Array, low: float = start, high: float = end) -> Array:
                at = np.clip(np.array([phi1]), low, high)
                speed = np.sqrt(2.0 * np.maximum(energy, 0.0) / inertia(at))
                return np.asarray(torque_n_mm(speed) - asked(at))

            leg = solve_ivp(change, (start, end), [energy], "LSODA", events=left, rtol=ACCURACY, atol=ACCURACY * small)
            if leg.status < 0:
                raise Unanswered(f"the motor's speed could not be followed: {leg.message}")
            if leg.t_events[0].size:
                place = leg.t_events[0][:1]
                standing = float(torque_n_mm(np.zeros(1))[0])
                (most,) = largest_of_each(lambda phi1: asked(phi1)[None], demand.cycle.loads.phi1_rad)
                phi1 = turn * cycle + place
                crank = demand.cycle.rigid.machine.transmission.driven_angle(phi1, 0).value
                return Stall(float(phi1[0]), float(crank[0]), float(asked(place)[0]), most, standing)
            energy = float(leg.y[0, -1])
    return None
