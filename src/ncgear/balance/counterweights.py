"""The crank counterweight that leaves least of the shaking force: in the mean square, or at its peak.

With P at the pin and S at the slider the force is P c'' + S x'' times a constant, c'' and x'' by the driving angle of
the actual motion.  Least squares over the complex P is closed: P = -<conj(c'') S x''> / <|c''|^2>; evenly driven with a
long rod it is -S/2, the counterweight m_B + m_C/2.  The least peak is a convex problem: every direction of the force at
every angle is a plane below the peak, linear in P, so that a linear programme over such planes bounds the peak from
below, and its solution bounds it from above (J. E. Kelley, "The cutting-plane method for solving convex programs", J.
SIAM 8 (1960) 703-712).

Counterweights tried one after the other: the force on the crank's bearing and the track of the centre of mass.

The tables of C. Wei, L. Xu, J. Wang, Y. Li, Int. J. Agric. & Biol. Eng. 11 (2018) 129-137, without their program.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.optimize import linprog

from ncgear.balance.mechanism import (
    PIN_X,
    PIN_Y,
    WRIST,
    Accelerations,
    Carrier,
    Counterweight,
    DrivenCrank,
    accelerations,
    as_complex,
    require_arm,
)
from ncgear.balance.shaking import Track, shaking, track
from ncgear.balance.waveform import Statistics, Waveform, gauss_points, magnitude_statistics
from ncgear.mechanisms.forces import EvenPace
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.units import N_PER_KG_MM_S2

GAP = 1e-7
"""Share of the peak by which it may be above its certified bound: far below what a counterweight can be made to."""

FEASIBLE = 1e-10
"""Tolerance of the linear programme on planes, in forces of a slider mass at the pin: well below ``GAP``."""

BOX = 100.0
"""Slider masses within which the pin's is looked for: x'' would have to be a hundredfold of c'' for more."""

NOTHING = 1e-12
"""Share of all masses below which what the slider counts for is rounding: the rod is balanced, the crank can be."""

MOST_ROUNDS = 200

NEAR_PEAK = 0.9
"""Share of the peak above which a local maximum gets a plane of its own."""


@dataclass(frozen=True)
class BestCounterweight:
    """First moment of the counterweight in kg mm, along the direction to the pin and across it counter-clockwise.

    ``bound_n`` is what the shaking force's peak cannot fall below whatever the counterweight; None for least squares.
    """

    moment_kg_mm: complex
    bound_n: float | None = None

    def at(self, arm_mm: float) -> Counterweight:
        """The counterweight at an arm on the crank; raises WrongInput for an arm that is not positive."""
        require_arm(arm_mm, "arm_mm")
        return Counterweight(
            Carrier.CRANK, abs(self.moment_kg_mm) / arm_mm, arm_mm, phase(self.moment_kg_mm) % (2 * pi)
        )


def least_squares(mechanism: DrivenCrank, known: Accelerations | None = None) -> BestCounterweight:
    """The counterweight beside those there that makes the mean square of the shaking force least."""
    breaks, pin, slider = _parts(mechanism, known or accelerations(mechanism))
    weights = gauss_points(breaks)[1]
    best = -np.sum(weights * np.conj(pin) * slider) / np.sum(weights * np.abs(pin) ** 2)
    return BestCounterweight(complex(best - mechanism.pin_kg) * mechanism.linkage.crank_mm)


def minimax(mechanism: DrivenCrank, known: Accelerations | None = None) -> BestCounterweight:
    """The counterweight beside those there that makes the largest shaking force least.

    Raises ArithmeticError, a fault of ncgear, where peak and bound do not meet within ``GAP``.
    """
    of, size = known or accelerations(mechanism), abs(mechanism.wrist_kg)
    if size <= NOTHING * mechanism.total_kg:
        return BestCounterweight(least_squares(mechanism, of).moment_kg_mm, 0.0)
    scale = N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * mechanism.linkage.crank_mm * size
    _, pin, slider = _parts(mechanism, of)
    slider, planes = slider / size, _Planes(np.empty((0, 3)), np.empty(0))
    found = (least_squares(mechanism, of).moment_kg_mm / mechanism.linkage.crank_mm + mechanism.pin_kg) / size
    for _ in range(MOST_ROUNDS):
        planes = planes.joined(pin, slider, found)
        found, bound = planes.lowest()
        if float(np.abs(found * pin + slider).max()) > bound * (1.0 + GAP / 2.0):
            continue
        moment = (found * size - mechanism.pin_kg) * mechanism.linkage.crank_mm
        peak = shaking(_with_moment(mechanism, moment), of).peak
        if peak.value <= scale * bound * (1.0 + GAP):
            return BestCounterweight(moment, scale * bound)
        more = _at_angles(mechanism, of, np.array([peak.at]))
        pin, slider = np.append(pin, more[0]), np.append(slider, more[1] / size)
    raise ArithmeticError("the counterweight of least peak was not found")


@dataclass(frozen=True, eq=False)
class _Planes:
    """Planes below the peak: rows (a, b) with t >= a . (Re P, Im P, 0) + b, as linprog has them."""

    rows: Array
    limits: Array

    def joined(self, pin: ComplexArray, slider: ComplexArray, found: complex) -> _Planes:
        """With the planes that touch at the largest forces of a pin mass."""
        force = found * pin + slider
        size = np.abs(force)
        crests = (
            (size >= np.roll(size, 1)) & (size >= np.roll(size, -1)) & (size >= NEAR_PEAK * size.max()) & (size > 0)
        )
        direction = np.conj(force[crests]) / size[crests]
        slope = direction * pin[crests]
        rows = np.column_stack([slope.real, -slope.imag, -np.ones(slope.size)])
        return _Planes(np.vstack([self.rows, rows]), np.concatenate([self.limits, -(direction * slider[crests]).real]))

    def lowest(self) -> tuple[complex, float]:
        """The pin mass with the lowest envelope, in slider masses, and that height."""
        bounds, options = [(-BOX, BOX), (-BOX, BOX), (0.0, None)], {"primal_feasibility_tolerance": FEASIBLE}
        found = linprog([0.0, 0.0, 1.0], self.rows, self.limits, bounds=bounds, options=options)
        if not found.success:
            raise ArithmeticError(f"the linear programme of the counterweight failed: {found.message}")
        return complex(found.x[0], found.x[1]), float(found.x[2])


def _parts(mechanism: DrivenCrank, known: Accelerations) -> tuple[Array, ComplexArray, ComplexArray]:
    """Breaks, and c''/r and S x''/r at their Gauss points."""
    breaks = known.form.breaks
    return breaks, *_at_angles(mechanism, known, gauss_points(breaks)[0])


def _at_angles(mechanism: DrivenCrank, known: Accelerations, angles: Array) -> tuple[ComplexArray, ComplexArray]:
    values = known.form(angles)
    pin: ComplexArray = values[:, PIN_X] + 1j * values[:, PIN_Y]
    slider: ComplexArray = np.asarray(mechanism.wrist_kg * values[:, WRIST], dtype=np.complex128)
    return pin, slider


def _with_moment(mechanism: DrivenCrank, moment_kg_mm: complex) -> DrivenCrank:
    """With a first moment added to the crank, at the crank's own length; of no use but for the force."""
    crank = mechanism.linkage.crank_mm
    added = Counterweight(Carrier.CRANK, abs(moment_kg_mm) / crank, crank, phase(moment_kg_mm))
    return replace(mechanism, counterweights=(*mechanism.counterweights, added))


@dataclass(frozen=True, eq=False)
class Tried:
    """One counterweight: statistics of the force on the bearing of the crank and of the shaking force, and the
    track."""

    mass_kg: float
    bearing_n: Statistics
    shaking_n: Statistics
    track: Track


def sweep(mechanism: DrivenCrank, counterweight: Counterweight, masses_kg: Sequence[float]) -> list[Tried]:
    """A counterweight on the crank with each of the masses, beside those there.

    The bearing carries the rod's pull and the crank's parts, with their weight where the masses have gravity.
    """
    known = accelerations(mechanism)
    return [
        _tried(replace(mechanism, counterweights=(*mechanism.counterweights, one)), one, known)
        for one in (replace(counterweight, mass_kg=mass) for mass in masses_kg)
    ]


def bearing_force(mechanism: DrivenCrank) -> tuple[Waveform, Waveform]:
    """Force in N on the crank at its bearing, along the slider's line and across it, without resistance."""

    def force(phi1: Array) -> Array:
        linkage, driven = mechanism.linkage, mechanism.transmission.driven_angle(phi1, 2)
        rod = linkage.joint_forces(driven, mechanism.masses, EvenPace(mechanism.speed_rad_s), 0.0).crank_axis
        gravity = complex(*mechanism.masses.gravity_m_s2)
        pin = N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * as_complex(linkage.rod(driven).pin, 2) / linkage.crank_mm
        added = sum((w.mass_kg * (w.arm * pin - gravity) for w in mechanism.counterweights), np.zeros(phi1.shape))
        return np.column_stack([rod.x.value + added.real, rod.y.value + added.imag])

    form = chebyshev.fitted(force, mechanism.breaks_rad)
    along, across = (Waveform(PiecewiseChebyshev(form.breaks, form.coefficients[:, :, k])) for k in (0, 1))
    return along, across


def _tried(mechanism: DrivenCrank, one: Counterweight, known: Accelerations) -> Tried:
    bearing = magnitude_statistics(*bearing_force(mechanism))
    return Tried(one.mass_kg, bearing, shaking(mechanism, known).force, track(mechanism))
