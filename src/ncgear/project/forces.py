"""From keys to values: the teeth and the drive of a simulation, and teeth under load before any tooth is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import pi, sqrt

import numpy as np

from ncgear.contact.placement import BOTH_SIDES
from ncgear.design.keys.masses import Simulation
from ncgear.dynamics.crank_load import CrankLoad, crank_load
from ncgear.dynamics.flank_changes import BorneTorque, borne_torque
from ncgear.dynamics.gaps import LEAST_IN_MODULES, PER_TOOTH, WITHIN_IN_MODULES, Gaps, gaps_of
from ncgear.dynamics.law_table import law_table
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.meshing import Friction, Impact, Meshing
from ncgear.dynamics.motion_in_time import DriveLine, EvenDrive, Motor, ToothedMachine
from ncgear.dynamics.pair_places import PairStiffness
from ncgear.dynamics.train_knocks import KnockingTrain, TrainPair
from ncgear.errors import WrongInput
from ncgear.kinematics.motion import Machine, stretches
from ncgear.mechanisms.forces import Masses
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.numerics.units import N_PER_KG_MM_S2, RAD_S_PER_RPM
from ncgear.pitch.pair import PitchPair
from ncgear.project.tooth_load import ToothLoad
from ncgear.ratio.transmission import Pair
from ncgear.strength.material import Material
from ncgear.strength.stiffness import ISO_N_MM_UM, STEEL_MPA
from ncgear.teeth.gear import ToothedPair

SAMPLES = 720
"""Number of angles of a turn over which inertias are averaged."""

STIFFEST, SOFTEST = 20.0, 1e-6
"""Limits of the stiffness of pairs of teeth, in units of the stiffness of ISO 6336-1 for steel.  Diamond has five times
the modulus of steel, and steel teeth are at most 1.8 times as stiff as in ISO; rubber has some 1e-5 of the modulus."""

DEPTHS_MM = (1e-3, 1.0)
"""Depths at which teeth carry loads: a law of impact is possible if its force is possible at any of these depths."""

STIFFNESS_KEY = "simulation.stiffness_n_mm"

FULLY_DAMPED = 1500.0
"""Depths in a module above which damping is full where the file gives none: 2 micrometres at a module of 3 mm, where
loaded teeth are pressed a few times deeper.  So gears of any size are damped alike."""


def require_possible_stiffness(given: Simulation, face_width_mm: float) -> None:
    """Refuse a given stiffness that no material gives teeth; raises WrongInput with a possible stiffness."""
    if (stiffness := given.stiffness_n_mm) is None:
        return
    steel = 1e3 * ISO_N_MM_UM * face_width_mm
    least, most = (depth ** (1.0 - given.exponent) for depth in reversed(DEPTHS_MM))
    least, most = SOFTEST * steel * least, STIFFEST * steel * most
    if least <= stiffness <= most:
        return
    never, right = (
        ("soft", f"{shown_above(least, 3)} or more")
        if stiffness < least
        else ("stiff", f"{shown_below(most, 3)} or less")
    )
    raise WrongInput(
        f"{stiffness:g} given, but no teeth of {face_width_mm:g} mm face width are so {never}, those of steel have "
        f"about {steel:.2g} N/mm; {right} is right",
        key=STIFFNESS_KEY,
    )


def meshing_of(
    given: Simulation,
    pitch: PitchPair,
    sections: Sequence[tuple[ToothedPair, PairStiffness]],
    sides: Sequence[int] = BOTH_SIDES,
    within_modules: float = WITHIN_IN_MODULES,
) -> Meshing:
    """The pair of gears under load, with the given stiffness or else with the teeth's own stiffness.

    ``sections`` of equal width are the teeth beside each other along the face width, a single one for straight teeth,
    each with its stiffness.  Only ``sides`` of the teeth can touch, and pairs that are ``within_modules`` of the first
    contact.
    """
    depth_mm = given.full_damping_depth_mm or pitch.size.module_mm / FULLY_DAMPED
    impact = Impact(given.exponent, (given.damping_n_s_mm or 0.0) / len(sections), depth_mm)
    per_tooth = PER_TOOTH if len(sections) == 1 else PER_TOOTH // 2
    followed = per_tooth, sides, within_modules
    parts = [gaps_of(teeth, pitch, stiffness_of(given, own, 1.0 / len(sections)), *followed) for teeth, own in sections]
    key = given.stiffness_n_mm and STIFFNESS_KEY
    return Meshing(law_table(pitch.transmission), Gaps.beside(parts), impact, friction_of(given), key or None)


DEEPER = 40.0
"""How many times as deep teeth are followed as their load would press a pair with the stiffness of ISO_N_MM_UM."""


def followed_modules(load: ToothLoad, face_width_mm: float, materials: Sequence[Material], module_mm: float) -> float:
    """Depth in modules to which teeth are followed under a load; with masses, which may knock, the greatest depth."""
    if load.load == "masses":
        return WITHIN_IN_MODULES
    modulus = min(material.youngs_modulus_mpa for material in materials)
    pressed_mm = load.peak_n / (1e3 * ISO_N_MM_UM * modulus / STEEL_MPA * face_width_mm)
    return min(max(DEEPER * pressed_mm / module_mm, LEAST_IN_MODULES), WITHIN_IN_MODULES)


def friction_of(given: Simulation) -> Friction:
    """The friction between the teeth."""
    rub = given.friction
    return Friction(rub.static, rub.dynamic, rub.static_speed_mm_s, rub.dynamic_speed_mm_s)


def stiffness_of(given: Simulation, own: PairStiffness, share: float) -> PairStiffness:
    """The ``own`` stiffness of pairs of teeth in a ``share`` of the face width, or else that share of the given one."""
    constant = given.stiffness_n_mm
    return own if constant is None else lambda places: np.full(places.flanks.shape, share * constant)


def damped(given: Simulation, meshing: Meshing, inertia_n_mm_s2: float) -> Meshing:
    """The pair of gears with the given damping, or else with the given ratio to the critical damping.

    The critical damping is 2 sqrt(k m) of one pair of teeth with the mean stiffness k and the inertia that swings on
    it, about the driven axis, as a mass at the end of the normal force's arm; for exponents other than 1, k is the
    slope of the force at the depth of full damping.  Each section of helical teeth has its part.
    """
    if given.damping_n_s_mm is not None:
        return meshing
    exponent, depth, sections = meshing.impact.exponent, meshing.impact.full_damping_depth_mm, meshing.gaps.sections
    mass = inertia_n_mm_s2 / float(np.mean(meshing.gaps.touching_levers_mm**2))
    stiffness = sections * float(np.mean(meshing.gaps.touching_stiffness)) * exponent * depth ** (exponent - 1.0)
    critical = 2.0 * sqrt(stiffness * mass) / sections
    return replace(meshing, impact=replace(meshing.impact, damping_n_s_mm=given.damping_ratio * critical))


def swinging_inertia(meshing: Meshing, driving_n_mm_s2: float, driven_n_mm_s2: float) -> float:
    """The inertia that swings on the teeth of two shafts, about the driven axis: 1/J = 1/J2 + i^2/J1, mean slope i.

    A driving shaft that turns evenly is given as 0, which here means an infinite inertia.
    """
    crank_rad = np.linspace(0.0, 2.0 * pi, SAMPLES, endpoint=False)
    ratio = float(np.mean(meshing.law.at(crank_rad)[1]))
    driving = ratio**2 / driving_n_mm_s2 if driving_n_mm_s2 else 0.0
    return 1.0 / (1.0 / driven_n_mm_s2 + driving)


def toothed_machine(
    given: Simulation, driving: DriveLine, meshings: Sequence[Meshing], masses: Masses, machine: Machine
) -> ToothedMachine:
    """A machine whose pairs of gears, from the driving shaft on, are damped as given.

    Raises WrongInput where a shaft between pairs in series has no inertia.
    """
    load = crank_load(machine.linkage, masses, machine.load)
    between = tuple(N_PER_KG_MM_S2 * inertia for inertia in masses.between_inertia_kg_mm2)
    if len(meshings) > 1 and not (len(between) == len(meshings) - 1 and all(between)):
        raise WrongInput(
            "a shaft between pairs of gears has no inertia, and no motion in time; give it above 0",
            key="masses.shaft_between_kg_mm2",
        )
    shafts = pairwise([driving.inertia_n_mm_s2, *between[: len(meshings) - 1], mean_inertia(load)])
    *before, last = (
        damped(given, meshing, swinging_inertia(meshing, *ends)) for meshing, ends in zip(meshings, shafts, strict=True)
    )
    return ToothedMachine(driving, last, load, tuple(before), between[: len(before)])


def mean_inertia(load: CrankLoad) -> float:
    """The mean inertia, over a turn, in N mm s^2 of everything that the crank turns."""
    crank_rad = np.linspace(0.0, 2.0 * pi, SAMPLES, endpoint=False)
    return float(np.mean(load.table.at(crank_rad)[0][..., 0]))


def borne_by(given: Simulation, load: ToothLoad, meshing: Meshing) -> BorneTorque:
    """The torque of a pair in ``meshing``, including changes of flanks where these are computed.

    Teeth with their own stiffness are damped as ``given``.  A machine without any inertia at some angle is not followed
    there; its teeth carry the torque that the law asks for.
    """
    machine = load.machine.machine
    still = BorneTorque(load.torque_n_mm, machine.transmission.cycle_rad)
    if not load.knocks_are_judged:
        return still
    try:
        driven = crank_load(machine.linkage, load.machine.masses, machine.load)
    except WrongInput:
        return still
    knocking = damped(given.of_own_stiffness, meshing, mean_inertia(driven))
    return borne_torque(knocking, driven, load.torque_n_mm, machine.speed_rad_s, still.cycle_rad)


def train_borne_by(
    given: Simulation, loads: Sequence[ToothLoad], meshings: Sequence[Meshing]
) -> tuple[BorneTorque, ...]:
    """The torques of pairs in series, as ``borne_by``; shafts between must have inertia."""
    rigid, machine = loads[0].machine, loads[0].machine.machine
    cycle = machine.transmission.cycle_rad
    still = tuple(BorneTorque(torque.torque_n_mm, cycle) for torque in loads)
    between = tuple(N_PER_KG_MM_S2 * inertia for inertia in rigid.masses.between_inertia_kg_mm2)
    if len(between) != len(loads) - 1 or not all(between):
        return still
    try:
        load = crank_load(machine.linkage, rigid.masses, machine.load)
    except WrongInput:
        return still
    shafts = pairwise([0.0, *between, mean_inertia(load)])
    pairs = [
        TrainPair(damped(given.of_own_stiffness, meshing, swinging_inertia(meshing, *ends)), asked.torque_n_mm)
        for meshing, ends, asked in zip(meshings, shafts, loads, strict=True)
    ]
    return KnockingTrain(tuple(pairs), between, load, machine.speed_rad_s).borne(cycle)


def loaded_places_rad(phi1_rad: Array, pair: Pair, meshing: Meshing, rigid: RigidMachine) -> Array:
    """Driving angles, rising and up to the last given angle, at which the peaks of a pair's loaded teeth are searched.

    They are the given angles of the driving shaft, the known angles of pairs of teeth, the joints of the law, and the
    turning points of the load.
    """
    breaks = [rigid.breaks(stretch) for stretch in stretches(rigid.machine)]
    places = distinct(np.concatenate([phi1_rad, pair.shaft_rad(meshing.gaps.table.breaks), *breaks]))
    return places[places <= phi1_rad[-1]]


def drive_line_of(given: Simulation, masses: Masses, speed_rad_s: float) -> DriveLine:
    """The drive of the driving gear; raises WrongInput where the shaft of a motor has no inertia."""
    motor = given.motor
    if motor is None:
        return EvenDrive(speed_rad_s)
    if not masses.driving_shaft_kg_mm2 > 0.0:
        raise WrongInput(
            "0 given, but a motor's shaft needs inertia; give driving_gear_kg_mm2 or a flywheel",
            key="masses.driving_gear_kg_mm2",
        )
    inertia = N_PER_KG_MM_S2 * masses.driving_shaft_kg_mm2
    return Motor(motor.no_load_speed_rpm * RAD_S_PER_RPM, 1000.0 * motor.stall_torque_n_m, inertia)
