"""A motor behind a gearbox: its torque at the driving shaft, and its load over a cycle.

A gearbox of the ratio i and the efficiency e makes T i e from the motor's torque T where the motor drives, and T i / e
where it brakes: the gearbox helps to brake.  A motor's heat follows from the root mean square of its torque over time,
which must stay below its rated torque (e.g. R. L. Norton, "Design of Machinery", 5th edition 2012, section 2.19 for
motors and their speed-torque lines).  A motor with a straight line loses torque in proportion to its speed,

    T(w) = T_rated (n_0 - n) / (n_0 - n_rated)

as induction motors about their rated point and direct-current motors do.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ncgear.drivetrain.demand import Demand
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum


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
