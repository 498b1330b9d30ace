"""Several mechanisms on one frame, driven by one shaft: the sum of what they do to it, and the best phase of one.

Turned by the direction of its slider's line, mirrored where its crank turns the other way, and ahead by its phase, the
force of each is exact; so is the sum.

How much of the inertia forces of two cranks on one frame is left when they work against each other.

Forces of crank-sliders of equal speed, crank radius (else give masses times radius) and with long rods: the
reciprocating mass m_C gives m_C cos, the rotating one a vector that turns.  C. Wei, L. Xu, J. Wang, Y. Li, Int. J.
Agric. & Biol. Eng. 11 (2018) 129-137, eqs. 9 to 16; that paper's second share depends on the phase where the integral
it states does not.

Counterweight at the tail of a chassis on two supports, against a slider's inertia and against dead weight.

Moments about the supports: Z. Tang, Y. Li, Y. Zhou, H. Zhang, Shock and Vibration 2019, eqs. 16 to 20.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi, sin

import numpy as np
from scipy.special import ellipe

from ncgear.balance.mechanism import Counterweight, DrivenCrank, JointMasses
from ncgear.balance.shaking import TRACK_POINTS, Shaking, Track, shaking
from ncgear.balance.waveform import Waveform
from ncgear.errors import WrongInput
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum

HARMONICS = 128
"""Harmonics by which two forces are correlated over their phase: those of a law's acceleration jumps, which fall off
slowest, by the square of their number, leave a share of 1e-6 of the mean square beyond them."""


SAME = 1e-9
"""Share of a cycle within which two breaks, or two cycles, are one: rounding of phases, and less than any stretch of a
law that is looked at."""


@dataclass(frozen=True, eq=False)
class Mounted:
    """A mechanism in the frame.

    ``direction_rad`` is that of its slider's way out, ``place_mm`` that of its crank axis (x + i y); ``phase_rad`` is
    the driving angle by which it is ahead of the shaft.  A mirrored one has its crank turning counter-clockwise.
    """

    mechanism: DrivenCrank
    direction_rad: float = 0.0
    phase_rad: float = 0.0
    mirrored: bool = False
    place_mm: complex = 0j


def frame_shaking(mounted: Sequence[Mounted]) -> Shaking:
    """Force along the frame's x and y, and moment about its origin, over the longest cycle among the mechanisms.

    Raises WrongInput where the speeds differ or another cycle does not go into the longest a whole number of times.
    """
    cycle = _common_cycle(mounted)
    parts = [(one, shaking(one.mechanism)) for one in mounted]

    def total(angle: Array) -> Array:
        return np.asarray(np.sum([_in_frame(one, of, angle) for one, of in parts], axis=0))

    breaks = np.unique(np.concatenate([[0.0, cycle], *(_breaks(one, of, cycle) for one, of in parts)]))
    breaks = breaks[np.append(True, np.diff(breaks) > SAME * cycle)]
    form = chebyshev.fitted(total, np.append(breaks[:-1], cycle))
    return Shaking(*(Waveform(PiecewiseChebyshev(form.breaks, form.coefficients[:, :, k])) for k in range(3)))


def best_phase(mounted: Sequence[Mounted], moved: int) -> Extremum:
    """Phase of the mechanism number ``moved``, in [0, cycle), with the least force: its r.m.s. value in N.

    Over the phase the mean square is a trigonometric polynomial, the correlation of the force with that of the others.
    """
    others = frame_shaking([one for number, one in enumerate(mounted) if number != moved])
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
    """The way of the common centre of mass of all mechanisms over the longest cycle."""
    angle = np.linspace(0.0, _common_cycle(mounted), TRACK_POINTS)
    moment = sum(one.mechanism.total_kg * _center(one, angle) for one in mounted)
    center = moment / sum(one.mechanism.total_kg for one in mounted)
    return Track(np.column_stack([center.real, center.imag]))


def frame_sweep(
    mounted: Sequence[Mounted], moved: int, counterweight: Counterweight, masses_kg: Sequence[float]
) -> list[tuple[float, Shaking, Track]]:
    """A counterweight on the crank of the mechanism number ``moved`` with each of the masses: all forces, the track."""
    found = []
    for mass in masses_kg:
        mechanism = mounted[moved].mechanism
        added = (*mechanism.counterweights, replace(counterweight, mass_kg=mass))
        one = replace(mounted[moved], mechanism=replace(mechanism, counterweights=added))
        together = [one if number == moved else other for number, other in enumerate(mounted)]
        found.append((mass, frame_shaking(together), frame_track(together)))
    return found


def _center(one: Mounted, angle: Array) -> ComplexArray:
    """A mechanism's centre of mass in the frame."""
    center = one.mechanism.center_of_mass_mm(angle + one.phase_rad)
    own = np.conj(center) if one.mirrored else center
    return np.asarray(one.place_mm + own * exp(1j * one.direction_rad))


def _coefficients(of: Shaking) -> ComplexArray:
    """Of the force as a complex number, from the highest negative wave to the highest positive one."""
    along, across = of.along.harmonics(HARMONICS), of.across.harmonics(HARMONICS)
    positive, negative = along + 1j * across, np.conj(along) + 1j * np.conj(across)
    return np.concatenate([negative[:0:-1], positive])


def _common_cycle(mounted: Sequence[Mounted]) -> float:
    cycles = [one.mechanism.transmission.cycle_rad for one in mounted]
    for number, one in enumerate(mounted):
        if not np.isclose(one.mechanism.speed_rad_s, mounted[0].mechanism.speed_rad_s, rtol=SAME):
            raise WrongInput(
                "another driving speed than that of the first; one shaft drives all", key=f"mechanisms.{number}"
            )
        if abs(max(cycles) / cycles[number] - round(max(cycles) / cycles[number])) > SAME:
            raise WrongInput(
                "its cycle does not go into the longest a whole number of times", key=f"mechanisms.{number}"
            )
    return max(cycles)


def _in_frame(one: Mounted, of: Shaking, angle: Array) -> Array:
    """Force and moment at shaft angles, shape (n, 3)."""
    own = np.mod(angle + one.phase_rad, of.along.cycle_rad)
    force, moment = of.along(own) + 1j * of.across(own), of.moment(own)
    if one.mirrored:
        force, moment = np.conj(force), -moment
    turned = force * exp(1j * one.direction_rad)
    return np.column_stack([turned.real, turned.imag, moment + (np.conj(one.place_mm) * turned).imag])


def _breaks(one: Mounted, of: Shaking, cycle: float) -> Array:
    """Where the mechanism's own breaks fall in the common cycle."""
    times = round(cycle / of.along.cycle_rad)
    starts = np.arange(times)[:, None] * of.along.cycle_rad
    return np.mod((starts + one.mechanism.breaks_rad - one.phase_rad).ravel(), cycle)


@dataclass(frozen=True)
class Crank:
    """One crank: masses at its joints, the angle of its crank at time zero in rad, and its sense of turning.

    Angles count from the direction of the slider's line, positive in the positive sense.
    """

    masses: JointMasses
    phase_rad: float
    sense: int = 1


def reciprocating_share(one: Crank, other: Crank) -> float:
    """eta1: mean size of the sum of both reciprocating forces, by the sum of their mean sizes.

    cos(s w t + phase) is the real part of exp(i (w t + s phase)): both swing at one frequency, so their sum does.
    """
    first, second = _reciprocating(one), _reciprocating(other)
    return abs(first + second) / (abs(first) + abs(second))


def rotating_share(one: Crank, other: Crank) -> float:
    """eta2: mean size of the sum of both rotating forces, by the sum of their sizes.

    Turning alike, they keep their angle.  Turning against each other, the sum runs on an ellipse with half axes of the
    masses' sum and difference; its mean size is a complete elliptic integral, whatever the phases.
    """
    first, second = one.masses.rotating_kg, other.masses.rotating_kg
    if one.sense == other.sense:
        turned = exp(1j * (other.phase_rad - one.phase_rad))
        return abs(first + second * turned) / (abs(first) + abs(second))
    # 2/pi E(k^2) of an ellipse with half axes a = 1 and b = sqrt(1 - k^2)
    return 2.0 / pi * float(ellipe(4.0 * abs(first * second) / (abs(first) + abs(second)) ** 2))


def best_phase_rad(one: Crank, other: Crank) -> float:
    """Phase of ``one`` in [0, 2 pi) at which its reciprocating force is opposed to that of ``other``: least eta1."""
    opposed = pi + other.sense * other.phase_rad
    return one.sense * opposed % (2.0 * pi)


def combined_counterweight_kg(one: JointMasses, shares: tuple[float, float], arm_ratio: float, share: float) -> float:
    """Counterweight of one of two cranks that help each other: (r/r') (eta2 m_B + k eta1 m_C), shares (eta1, eta2)."""
    reciprocating, rotating = shares
    return arm_ratio * (rotating * one.rotating_kg + share * reciprocating * one.reciprocating_kg)


def _reciprocating(crank: Crank) -> complex:
    return crank.masses.reciprocating_kg * exp(1j * crank.sense * crank.phase_rad)


GRAVITY_M_S2 = 9.81
"""As the paper has it; it cancels out of the dead weight."""


@dataclass(frozen=True)
class Chassis:
    """Levers in mm from the centre of gravity: of the supports (both alike) and of the counterweight.

    ``tilt_rad`` is the slope of the slider's line against the ground.
    """

    support_mm: float
    counterweight_mm: float
    tilt_rad: float


def dynamic_counterweight_kg(chassis: Chassis, force_n: float) -> float:
    """M1 = F a sin(tilt) / (c g): weight that holds the vertical part of an inertia force along the slider's line."""
    return abs(force_n) * sin(chassis.tilt_rad) * chassis.support_mm / (chassis.counterweight_mm * GRAVITY_M_S2)


def static_counterweight_kg(chassis: Chassis, slider_kg: float, weight_kg: float, weight_lever_mm: float) -> float:
    """M2 = (a m1 + d m2) / c: weight that brings the centre of gravity back between the supports."""
    moment = chassis.support_mm * slider_kg + weight_lever_mm * weight_kg
    return moment / chassis.counterweight_mm


@dataclass(frozen=True)
class DynamicCounterweights:
    """M1 in kg: at both dead centres, and the largest over the driving angle, which it takes to be safe."""

    extended_kg: float
    retracted_kg: float
    worst_kg: Extremum


def dynamic_counterweights(chassis: Chassis, mechanism: DrivenCrank) -> DynamicCounterweights:
    """What the shaking force along the slider's line asks for, from the exact motion.

    The paper's weight is that of the retracted dead centre; evenly driven, the force is larger at the extended one.
    """
    along = shaking(mechanism).along
    machine = Machine(mechanism.transmission, mechanism.linkage, PolynomialResistance(), mechanism.speed_rad_s)
    at_ends = along(np.array([machine.extended_rad, 0.0]))
    largest = max(along.extremes, key=lambda extremum: abs(extremum.value))
    extended, retracted, worst = (
        dynamic_counterweight_kg(chassis, float(force)) for force in (*at_ends, largest.value)
    )
    return DynamicCounterweights(extended, retracted, Extremum(worst, largest.at))
