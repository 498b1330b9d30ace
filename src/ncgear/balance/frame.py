"""Forces of mechanisms on the frame they stand on: several on one shaft, two cranks by formula, one on a chassis.

Several mechanisms on one shaft: the force of each is turned by the direction of its slider's line, mirrored where its
crank turns the other way, and shifted by its phase.  The sum is as exact as the parts, and so is the best phase.

Two cranks by formula: the rest of their inertia forces when they work against each other, for equal speeds, equal crank
radii (else give masses times radius) and long rods.  The reciprocating mass m_C then gives m_C cos, the rotating mass a
vector that turns.  C. Wei, L. Xu, J. Wang, Y. Li, Int. J. Agric. & Biol. Eng. 11 (2018) 129-137, eqs. 9 to 16. That
paper's second share depends on the phase, while the integral it states does not.

A chassis on two supports: the counterweight at its tail against the inertia of a slider and against dead weight, from
moments about the supports.  Z. Tang, Y. Li, Y. Zhou, H. Zhang, Shock and Vibration 2019, eqs. 16 to 20.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Sequence
from dataclasses import replace
from math import pi, sin

import numpy as np
from scipy.special import ellipe

from ncgear.balance.mechanism import Counterweight, DrivenCrank, JointMasses
from ncgear.balance.shaking import TRACK_POINTS, Shaking, Track, shaking
from ncgear.balance.waveform import Waveform, waveforms
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.units import STANDARD_GRAVITY_M_S2

HARMONICS = 128
"""Harmonics that correlate two forces over their phase. For a law with jumps of acceleration they fall slowest, with
the square of their number; harmonics beyond this one then hold 1e-6 of the mean square."""

SAME = 1e-9
"""Share of a cycle within which two breaks, or two cycles, count as one: above the rounding of phases, and below any
part of a law that matters."""

# --- several mechanisms on one shaft --------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Mounted:
    """A mechanism in the frame.

    ``direction_rad`` is the direction in which its slider moves out, ``place_mm`` the place x + i y of its crank axis,
    ``phase_rad`` the driving angle by which it is ahead of the shaft.  The crank of a mirrored mechanism turns
    counter-clockwise.
    """

    mechanism: DrivenCrank
    direction_rad: float = 0.0
    phase_rad: float = 0.0
    mirrored: bool = False
    place_mm: complex = 0j


def frame_shaking(mounted: Sequence[Mounted]) -> Shaking:
    """Force along x and y and moment over the longest cycle; raises WrongInput for other speeds or uneven cycles."""
    cycle = _common_cycle(mounted)
    parts = [(machine, shaking(machine.mechanism)) for machine in mounted]

    def total(angle: Array) -> Array:
        return np.asarray(np.sum([_in_frame(machine, own, angle) for machine, own in parts], axis=0))

    breaks = np.unique(np.concatenate([[0.0, cycle], *(_breaks(machine, own, cycle) for machine, own in parts)]))
    breaks = breaks[np.append(True, np.diff(breaks) > SAME * cycle)]
    return Shaking(*waveforms(chebyshev.fitted(total, np.append(breaks[:-1], cycle))))


def best_phase(mounted: Sequence[Mounted], moved: int) -> Extremum:
    """The least r.m.s. force in N, and the phase in [0, cycle) of the mechanism number ``moved`` at which it occurs.

    The mean square is a trigonometric polynomial of the phase.  Raises WrongInput as ``frame_shaking``, and for cycles
    of other lengths.
    """
    others = frame_shaking([other for number, other in enumerate(mounted) if number != moved])
    alone = frame_shaking([replace(mounted[moved], phase_rad=0.0)])
    cycle = _common_cycle(mounted)
    if abs(others.along.cycle_rad - alone.along.cycle_rad) > SAME * cycle:
        raise WrongInput("cycles of different lengths have no one best phase; give mechanisms of equal cycles")
    crossed = np.conj(_coefficients(others)) * _coefficients(alone)
    waves = np.arange(-HARMONICS, HARMONICS + 1) * 2.0 * pi / cycle
    own = others.force.rms**2 + alone.force.rms**2

    def mean_square(phase: Array) -> Array:
        return own + 2.0 * (np.exp(1j * np.outer(phase, waves)) @ crossed).real

    least = Waveform(chebyshev.fitted(mean_square, np.linspace(0.0, cycle, 17))).extremes[0]
    return Extremum(float(np.sqrt(max(least.value, 0.0))), least.at % cycle)


def frame_track(mounted: Sequence[Mounted]) -> Track:
    """Track of the common centre of mass of all mechanisms over the longest cycle."""
    angle = np.linspace(0.0, _common_cycle(mounted), TRACK_POINTS)
    moment = sum(machine.mechanism.total_kg * _center(machine, angle) for machine in mounted)
    center = moment / sum(machine.mechanism.total_kg for machine in mounted)
    return Track(np.column_stack([center.real, center.imag]))


def frame_sweep(
    mounted: Sequence[Mounted], moved: int, counterweight: Counterweight, masses_kg: Sequence[float]
) -> list[tuple[float, Shaking, Track]]:
    """Shaking and track with a counterweight of each mass in turn on the crank of the mechanism number ``moved``."""
    found = []
    for mass in masses_kg:
        mechanism = mounted[moved].mechanism.with_counterweight(replace(counterweight, mass_kg=mass))
        at_mass = replace(mounted[moved], mechanism=mechanism)
        together = [at_mass if number == moved else other for number, other in enumerate(mounted)]
        found.append((mass, frame_shaking(together), frame_track(together)))
    return found


def _center(machine: Mounted, angle: Array) -> ComplexArray:
    center = machine.mechanism.center_of_mass_mm(angle + machine.phase_rad)
    own = np.conj(center) if machine.mirrored else center
    return np.asarray(machine.place_mm + own * exp(1j * machine.direction_rad))


def _coefficients(shaken: Shaking) -> ComplexArray:
    """Fourier coefficients of the force as a complex number, from the highest negative to the highest positive one."""
    along, across = shaken.along.harmonics(HARMONICS), shaken.across.harmonics(HARMONICS)
    positive, negative = along + 1j * across, np.conj(along) + 1j * np.conj(across)
    return np.concatenate([negative[:0:-1], positive])


def _common_cycle(mounted: Sequence[Mounted]) -> float:
    """The longest cycle, as a driving angle; raises WrongInput as ``frame_shaking`` does."""
    cycles = [machine.mechanism.transmission.cycle_rad for machine in mounted]
    for number, machine in enumerate(mounted):
        if not np.isclose(machine.mechanism.speed_rad_s, mounted[0].mechanism.speed_rad_s, rtol=SAME):
            raise WrongInput(
                "its driving speed differs from the first one's; one shaft drives all", key=f"mechanisms.{number}"
            )
        if abs(max(cycles) / cycles[number] - round(max(cycles) / cycles[number])) > SAME:
            raise WrongInput(
                "its cycle does not go into the longest a whole number of times", key=f"mechanisms.{number}"
            )
    return max(cycles)


def _in_frame(machine: Mounted, own: Shaking, angle: Array) -> Array:
    phi1 = np.mod(angle + machine.phase_rad, own.along.cycle_rad)
    force, moment = own.along(phi1) + 1j * own.across(phi1), own.moment(phi1)
    if machine.mirrored:
        force, moment = np.conj(force), -moment
    turned = force * exp(1j * machine.direction_rad)
    return np.column_stack([turned.real, turned.imag, moment + (np.conj(machine.place_mm) * turned).imag])


def _breaks(machine: Mounted, own: Shaking, cycle: float) -> Array:
    """Places of the mechanism's own breaks in the common cycle."""
    times = round(cycle / own.along.cycle_rad)
    starts = np.arange(times)[:, None] * own.along.cycle_rad
    return np.mod((starts + machine.mechanism.breaks_rad - machine.phase_rad).ravel(), cycle)


# --- two cranks by formula ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Crank:
    """One crank: masses at its joints, its angle in rad at time zero from the slider's line, its sense of turning."""

    masses: JointMasses
    phase_rad: float
    sense: int = 1


def reciprocating_share(one: Crank, other: Crank) -> float:
    """eta1: mean size of the sum of both reciprocating forces, divided by the sum of their mean sizes.

    With sense s, cos(s w t + phase) is the real part of exp(i (w t + s phase)): both forces oscillate at one frequency,
    and so does their sum.
    """
    first, second = (crank.masses.reciprocating_kg * exp(1j * crank.sense * crank.phase_rad) for crank in (one, other))
    return abs(first + second) / (abs(first) + abs(second))


def rotating_share(one: Crank, other: Crank) -> float:
    """eta2: mean size of the sum of both rotating forces, divided by the sum of their sizes.

    Forces that turn in the same sense keep the angle between them.  Where they turn against each other, their sum moves
    on an ellipse whose half axes are the sum and the difference of the masses; its mean size is a complete elliptic
    integral, whatever the phases.
    """
    first, second = one.masses.rotating_kg, other.masses.rotating_kg
    if one.sense == other.sense:
        turned = exp(1j * (other.phase_rad - one.phase_rad))
        return abs(first + second * turned) / (abs(first) + abs(second))
    # 2/pi E(k^2) of an ellipse with half axes a = 1 and b = sqrt(1 - k^2)
    return 2.0 / pi * float(ellipe(4.0 * abs(first * second) / (abs(first) + abs(second)) ** 2))


def best_phase_rad(one: Crank, other: Crank) -> float:
    """Phase of ``one`` in [0, 2 pi) at which its reciprocating force opposes the force of ``other``: eta1 is least
    there."""
    opposed = pi + other.sense * other.phase_rad
    return one.sense * opposed % (2.0 * pi)


def combined_counterweight_kg(crank: JointMasses, shares: tuple[float, float], arm_ratio: float, share: float) -> float:
    """Counterweight of one of two cranks for both: (r/r') (eta2 m_B + k eta1 m_C); ``shares``: eta1, eta2."""
    reciprocating, rotating = shares
    return arm_ratio * (rotating * crank.rotating_kg + share * reciprocating * crank.reciprocating_kg)


# --- counterweight of a chassis -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Chassis:
    """Levers in mm from the centre of gravity to both supports and to the counterweight; slope of the slider's line."""

    support_mm: float
    counterweight_mm: float
    tilt_rad: float


def static_counterweight_kg(chassis: Chassis, slider_kg: float, weight_kg: float, weight_lever_mm: float) -> float:
    """M2 = (a m1 + d m2) / c: the weight that brings the centre of gravity back between the supports."""
    moment = chassis.support_mm * slider_kg + weight_lever_mm * weight_kg
    return moment / chassis.counterweight_mm


@dataclass(frozen=True)
class DynamicCounterweights:
    """M1 in kg: at both dead centres, and the largest over the driving angle, which is the safe value."""

    extended_kg: float
    retracted_kg: float
    worst_kg: Extremum


def dynamic_counterweights(chassis: Chassis, mechanism: DrivenCrank) -> DynamicCounterweights:
    """M1 = F a sin(tilt) / (c g): the weight that holds the vertical part of the exact inertia force F of the slider.

    The paper takes the weight of the retracted dead centre; driven evenly, the force is larger at the extended one. g
    is the gravity of the mechanism's masses or, if they have none, the standard value.
    """
    gravity = abs(complex(*mechanism.masses.gravity_m_s2)) or STANDARD_GRAVITY_M_S2
    along = shaking(mechanism).along
    machine = Machine(mechanism.transmission, mechanism.linkage, SliderLoad(), mechanism.speed_rad_s)
    at_ends = along(np.array([machine.extended_rad, 0.0]))
    largest = max(along.extremes, key=lambda extremum: abs(extremum.value))
    extended, retracted, worst = (
        abs(float(force)) * sin(chassis.tilt_rad) * chassis.support_mm / (chassis.counterweight_mm * gravity)
        for force in (*at_ends, largest.value)
    )
    return DynamicCounterweights(extended, retracted, Extremum(worst, largest.at))
