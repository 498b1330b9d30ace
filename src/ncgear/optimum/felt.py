"""What a law makes a machine with all its masses feel: the figures of forces, torque and power that a law is judged by.

All are taken from the loaded machine (``ncgear.dynamics.loaded_machine``) at constant driving speed, so peaks are
exact.  Motor power is the driving shaft's torque times its speed: positive where the motor drives, negative where it
brakes.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

from ncgear.dynamics.driving_shaft import DrivingShaft
from ncgear.dynamics.loaded_machine import IDLE, Loads, RigidMachine, broken_cycle, largest_over, range_over
from ncgear.frozen import dataclass
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.plane import Vector


@dataclass(frozen=True)
class Felt:
    """Figures over one cycle.

    ``braking_power_w`` is the largest power that flows back to the motor, 0 where none does.  ``rms_torque_n_m`` is the
    root of the driving torque's mean square over the driving angle.  ``flywheel_kg_mm2`` is the inertia on the driving
    shaft, its gear included, that keeps the wanted coefficient of speed fluctuation where the motor's torque is even:
    the motor then delivers the mean power alone.  ``bearing_force_n`` is the largest force on the crank's bearings, the
    teeth's apart; ``shaking_force_n`` the largest of the moving masses on the frame.
    """

    peak_power_w: float
    braking_power_w: float
    rms_torque_n_m: float
    flywheel_kg_mm2: float
    bearing_force_n: float
    shaking_force_n: float


def felt(rigid: RigidMachine, speed_fluctuation: float) -> Felt:
    """The figures of a machine; the coefficient of speed fluctuation is over 0 and at most about 0.2."""
    shaft, cycle = DrivingShaft(rigid), broken_cycle(rigid)
    free = replace(rigid.machine, load=SliderLoad())
    inert = RigidMachine(free, replace(rigid.masses, gravity_m_s2=(0.0, 0.0)))
    return Felt(
        peak_power_w=shaft.peak_power_w.value,
        braking_power_w=shaft.braking_power_w.value,
        rms_torque_n_m=shaft.rms_torque_n_m,
        flywheel_kg_mm2=shaft.fluctuation.flywheel_kg_mm2(speed_fluctuation),
        bearing_force_n=largest_over(rigid, cycle, lambda loads: loads.crank_bearing).value,
        shaking_force_n=largest_over(inert, broken_cycle(inert), _on_frame).value,
    )


def _on_frame(loads: Loads) -> Vector:
    """What the frame feels of a machine without weights and resistance: the reactions of bearings and guide."""
    return Vector(loads.crank_bearing.x, loads.crank_bearing.y + loads.guide)


def tooth_force_n(rigid: RigidMachine) -> float:
    """Largest force between the teeth along the flanks' normal; infinite where flanks carry at 90 degrees or more.

    All of it counts as carried at the pitch point, where the force of one pair of teeth or of several has the same arm.
    """
    cycle = broken_cycle(rigid)
    least, most = (end.value for end in range_over(rigid, cycle, lambda loads: loads.mesh_force.size_n))
    # Beyond 90 degrees the size is negative
    return inf if least < -IDLE * most else most
