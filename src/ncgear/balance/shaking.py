"""Shaking force and shaking moment of the moving masses of a crank-slider on its frame.

    F = -d/dt sum m v,   M = -d/dt (sum m p x v + sum J w)   about the crank axis

M contains the reaction of the crank's drive, which stands on the same frame.  At constant driving speed W the time
derivative is W d/dphi1.  J. J. Uicker, G. R. Pennock, J. E. Shigley, "Theory of Machines and Mechanisms", 4th edition,
2011, chapters 15 and 17.

The track of the common centre of mass shows the same: the less the centre moves, the less the frame is shaken.

Textbooks take two terms of the rod's series and a crank that turns evenly: the slider's acceleration is -w^2 r (cos t +
(r/l) cos 2t), t from the extended dead centre (Z. Tang, Y. Li, Y. Zhou, H. Zhang, Shock and Vibration 2019, eq. 8), and
the pin's is w^2 r towards the axis.  That leaves out terms of (r/l)^3, and everything that an uneven crank adds;
``two_term_formula`` computes the error.
"""

from __future__ import annotations

from enum import StrEnum
from functools import cached_property
from math import pi

import numpy as np

from ncgear.balance.mechanism import (
    ASIDE,
    CRANK,
    PIN_X,
    PIN_Y,
    ROD,
    TOGETHER,
    WRIST,
    Accelerations,
    Carrier,
    DrivenCrank,
    accelerations,
    functions_at,
)
from ncgear.balance.waveform import Statistics, Waveform, magnitude_statistics, squared_magnitude, waveforms
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.plane import signed_area
from ncgear.numerics.units import N_PER_KG_MM_S2


@dataclass(frozen=True, eq=False)
class Shaking:
    """Shaking force in N along the slider's line (x) and across it (y), and moment in N mm, over one cycle of phi1."""

    along: Waveform
    across: Waveform
    moment: Waveform

    @cached_property
    def force(self) -> Statistics:
        """Statistics of the size of the force."""
        return magnitude_statistics(self.along, self.across)

    @cached_property
    def peak(self) -> Extremum:
        """The largest size of the force, with the driving angle."""
        highest = squared_magnitude(self.along, self.across).extremes[1]
        return Extremum(float(np.sqrt(max(highest.value, 0.0))), highest.at)


def shaking(mechanism: DrivenCrank, known: Accelerations | None = None) -> Shaking:
    """Shaking force and moment; ``known`` may give the accelerations of the same linkage and law."""
    known = known or accelerations(mechanism)
    return Shaking(
        *waveforms(known.combined(np.column_stack([*_force_weights(mechanism), _moment_weights(mechanism)])))
    )


def _force_weights(mechanism: DrivenCrank) -> tuple[Array, Array]:
    """Weights of the functions in -(P c'' + S w'') W^2, real and imaginary part."""
    factor = -N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * mechanism.linkage.crank_mm
    pin, wrist = factor * mechanism.pin_kg, factor * mechanism.wrist_kg
    along, across = np.zeros(7), np.zeros(7)
    along[[PIN_X, PIN_Y, WRIST]] = pin.real, -pin.imag, wrist.real
    across[[PIN_X, PIN_Y, WRIST]] = pin.imag, pin.real, wrist.imag
    return along, across


def _moment_weights(mechanism: DrivenCrank) -> Array:
    """Weights of the functions in the moment about the crank axis."""
    linkage, masses = mechanism.linkage, mechanism.masses
    crank, rod, offset = linkage.crank_mm, linkage.rod_mm, linkage.offset_mm
    places = [(mass, place / rod) for mass, place in mechanism.on_rod]
    cross = sum((mass * (1.0 - share).conjugate() * share for mass, share in places), 0j)
    at_pin = sum(mass * abs(1.0 - share) ** 2 for mass, share in places)
    at_wrist = masses.slider_kg + sum(mass * abs(share) ** 2 for mass, share in places)
    extra = sum(w.mass_kg * w.arm_mm**2 for w in mechanism.counterweights if w.carrier is Carrier.CRANK)
    weights = np.zeros(7)
    # The crank turns clockwise: its angular momentum is opposite to the sense of the moment
    weights[CRANK] = -(masses.crank_shaft_kg_mm2 + extra + at_pin * crank**2)
    weights[ROD] = masses.rod_inertia_kg_mm2
    weights[WRIST] = -at_wrist * offset * crank
    weights[TOGETHER], weights[ASIDE] = cross.real * crank * rod, cross.imag * crank * rod
    return -N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * weights


TRACK_POINTS = 361
"""Points of a track, the first point repeated: enough for its area, which the trapezoidal rule finds very exactly."""


@dataclass(frozen=True, eq=False)
class Track:
    """The closed track of the common centre of mass: points in mm (shape (n, 2)), extents in mm and area in mm^2."""

    points_mm: Array

    @property
    def extent_mm(self) -> tuple[float, float]:
        """Extents along the slider's line and across it."""
        along, across = np.ptp(self.points_mm, axis=0)
        return float(along), float(across)

    @property
    def area_mm2(self) -> float:
        """Area that the track encloses, by Green's theorem; valid where it does not cross itself."""
        return abs(float(signed_area(self.points_mm[:-1])))


def track(mechanism: DrivenCrank) -> Track:
    """Track of the common centre of mass over one cycle."""
    center = mechanism.center_of_mass_mm(np.linspace(0.0, mechanism.transmission.cycle_rad, TRACK_POINTS))
    return Track(np.column_stack([center.real, center.imag]))


BALANCED = 1e-12
"""Shaking forces below this share of the force of all masses at the pin are rounding error."""


class Speed(StrEnum):
    """The crank's speed in the textbook formula: its mean, or the momentary speed."""

    MEAN = "mean"
    MOMENTARY = "momentary"


@dataclass(frozen=True)
class TwoTermFormula:
    """The textbook formula's peak in N, and its largest error over the exact peak; 0 for a rounding error."""

    peak_n: float
    largest_error: float


def two_term_formula(mechanism: DrivenCrank, speed: Speed = Speed.MEAN) -> TwoTermFormula:
    """Error of the textbook formula for a mechanism in line; raises WrongInput for an offset."""
    if mechanism.linkage.offset_mm != 0.0:
        raise WrongInput("the two-term formula is for linkages in line; leave the offset out", key="linkage.offset_mm")
    # Both in one form, so that coefficients are subtracted: values of two forms would differ by noise
    both = chebyshev.fitted(
        lambda phi1: np.hstack([functions_at(mechanism, phi1), _formula(mechanism, speed, phi1)]), mechanism.breaks_rad
    )
    exact, formula = both.coefficients[:, :, :7], both.coefficients[:, :, 7:]
    true, given, error = (
        shaking(mechanism, Accelerations(PiecewiseChebyshev(both.breaks, part))).peak.value
        for part in (exact, formula, formula - exact)
    )
    unit = N_PER_KG_MM_S2 * mechanism.total_kg * mechanism.linkage.crank_mm * mechanism.speed_rad_s**2
    return TwoTermFormula(given, error / true if true > BALANCED * unit else 0.0)


def _formula(mechanism: DrivenCrank, speed: Speed, phi1: Array) -> Array:
    """The seven functions by the textbook formula, shape (n, 7); zero for functions that only the moment needs."""
    driven = mechanism.transmission.driven_angle(phi1, 1)
    mean = 2.0 * pi / mechanism.transmission.cycle_rad
    squared = (np.full(phi1.shape, mean) if speed is Speed.MEAN else driven.derivative(1)) ** 2
    beyond, ratio = driven.value - pi, mechanism.linkage.crank_mm / mechanism.linkage.rod_mm
    rows = np.zeros((phi1.size, 7))
    rows[:, PIN_X], rows[:, PIN_Y] = -squared * np.cos(beyond), squared * np.sin(beyond)
    rows[:, WRIST] = -squared * (np.cos(beyond) + ratio * np.cos(2.0 * beyond))
    return rows
