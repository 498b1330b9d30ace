"""Several mechanisms on one frame, driven by one shaft: the sum of what they do to it, and the best phase of one.

Turned by the direction of its slider's line, mirrored where its crank turns the other way, and ahead by its phase, the
force of each is exact; so is the sum.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from ncgear.balance.mechanism import Counterweight, Mechanism
from ncgear.balance.shaking import Shaking, shaking
from ncgear.balance.track import TRACK_POINTS, Track
from ncgear.balance.waveform import Waveform
from ncgear.errors import WrongInput
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

    mechanism: Mechanism
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
