"""What a balance file says, as the values that balance computes with."""

from __future__ import annotations

from cmath import exp
from math import radians

from ncgear.balance.chain_drive import ChainPhases, WeightRun
from ncgear.balance.chassis import Chassis
from ncgear.balance.drilling import Drills
from ncgear.balance.excitation import Engine, Shaft
from ncgear.balance.frame import Mounted
from ncgear.balance.gear_correction import BossSize, Means
from ncgear.balance.influence import TrialRun
from ncgear.balance.joint_masses import JointMasses, joint_masses
from ncgear.balance.mechanism import Carrier, Counterweight, Mechanism
from ncgear.design import balance_excitation, balance_mechanism, balance_rotor
from ncgear.machine.linkage import CrankSlider
from ncgear.machine.masses import Masses
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.transmission import Transmission


def mechanism_of(
    given: balance_mechanism.Mechanism,
    drive: tuple[CrankSlider, Transmission],
    masses: Masses,
    speed_rpm: float,
) -> Mechanism:
    """The mechanism with the counterweights that are there."""
    added = tuple(
        Counterweight(Carrier(one.on), one.mass_kg, one.arm_mm, radians(one.angle_deg)) for one in given.counterweights
    )
    return Mechanism(*drive, speed_rpm * RAD_S_PER_RPM, masses, added)


def mounted_of(given: balance_mechanism.Mechanism, mechanism: Mechanism) -> Mounted:
    """The mechanism in its place."""
    place = complex(given.x_mm, given.y_mm)
    return Mounted(mechanism, radians(given.direction_deg), radians(given.phase_deg), given.mirrored, place)


def joint_masses_of(given: balance_mechanism.Partial, mechanism: Mechanism) -> JointMasses:
    """The masses at the joints: those given, else those of the parts."""
    parts = joint_masses(mechanism.linkage, mechanism.masses)
    return JointMasses(
        parts.rotating_kg if given.rotating_kg is None else given.rotating_kg,
        parts.reciprocating_kg if given.reciprocating_kg is None else given.reciprocating_kg,
    )


def crank_counterweight(given: balance_mechanism.Sweep) -> Counterweight:
    """The counterweight to try, without its mass."""
    return Counterweight(Carrier.CRANK, 0.0, given.arm_mm, radians(given.angle_deg))


def chassis_of(given: balance_mechanism.Chassis) -> Chassis:
    """The levers of a chassis."""
    return Chassis(given.support_mm, given.counterweight_mm, radians(given.tilt_deg))


def shafts_of(given: balance_excitation.Excitations) -> list[Shaft]:
    """Shafts that may shake the machine."""
    return [Shaft(one.name, one.speed_rpm, one.rollers, one.teeth, one.roller_ratio) for one in given.shafts]


def engines_of(given: balance_excitation.Excitations) -> list[Engine]:
    """Engines that may."""
    return [Engine(one.name, one.speed_rpm, one.cylinders, one.strokes, one.inertia_order) for one in given.engines]


def means_of(given: balance_rotor.Correction) -> Means:
    """What may be done to a gear."""
    holes, boss = given.holes, given.boss
    drills = Drills(holes.largest_mm, holes.smallest_mm, holes.wall_mm) if holes else None
    return Means(drills, BossSize(boss.height_mm, boss.wall_mm) if boss else None)


def readings_of(given: balance_rotor.Readings | None) -> tuple[complex, ...]:
    """Readings as complex numbers."""
    return tuple(polar(one.amplitude, one.phase_deg) for one in given or ())


def trial_runs_of(given: balance_rotor.Rotor) -> list[TrialRun]:
    """Runs with trial weights in g."""
    return [TrialRun(polar(one.mass_g, one.angle_deg), readings_of(one.readings)) for one in given.trials or ()]


def weight_runs_of(given: balance_rotor.ChainDrive) -> list[WeightRun]:
    """Runs with one weight at several phases."""
    return [WeightRun(radians(one.weight_deg), polar(one.amplitude, one.phase_deg)) for one in given.runs or ()]


def chain_phases_of(given: balance_rotor.ChainDrive) -> ChainPhases:
    """Phases of a chain drive."""
    return ChainPhases(radians(given.wrap_deg), radians(given.tight_deg), radians(given.slack_deg))


def polar(amplitude: float, phase_deg: float) -> complex:
    """A reading or a weight as a complex number."""
    return amplitude * exp(1j * radians(phase_deg))
