"""The crank counterweight that leaves the least shaking force, and counterweights of given masses tried one by one.

With P at the pin and S at the slider, the shaking force is P c'' + S x'' times a constant, where c'' and x'' are second
derivatives of the actual motion by the driving angle.

The least mean square has a closed form: P = -<conj(c'') S x''> / <|c''|^2>.  Driven evenly with a long rod this is
-S/2, so the counterweight balances m_B + m_C/2.

The least peak is a convex problem.  The force's component in any direction at any angle is linear in P and never above
the peak: a plane.  A linear programme over such planes bounds the least peak from below, and the peak of its solution
bounds it from above (J. E. Kelley, "The cutting-plane method for solving convex programs", J. SIAM 8 (1960) 703-712).

Counterweights tried one by one give the tables of C. Wei, L. Xu, J. Wang, Y. Li, Int. J. Agric. & Biol. Eng. 11 (2018)
129-137: the force on the crank's bearing, the shaking force, and the track of the centre of mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import linprog

from ncgear.balance.mechanism import (
    NOTHING,
    PIN_X,
    PIN_Y,
    WRIST,
    Accelerations,
    Carrier,
    Counterweight,
    DrivenCrank,
    accelerations,
    complex_derivative,
    require_arm,
)
from ncgear.balance.shaking import Track, shaking, track
from ncgear.balance.waveform import Statistics, Waveform, gauss_points, magnitude_statistics, waveforms
from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import EvenPace
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.units import N_PER_KG_MM_S2

GAP = 1e-7
"""Largest relative excess of the peak over its certified bound: far finer than a counterweight can be made."""

FEASIBLE = 1e-10
"""Tolerance of the linear programme on planes, in forces of a slider mass at the pin: well below ``GAP``."""

BOX = 100.0
"""Largest mass at the pin in the search, in slider masses: more would need an x'' a hundred times c''."""

MOST_ROUNDS = 200
"""Most linear programmes of a search; with more it ends as a fault."""

NEAR_PEAK = 0.9
"""Share of the peak above which a local maximum gets a plane of its own."""


@dataclass(frozen=True)
class BestCounterweight:
    """First moment of the counterweight in kg mm: its part towards the pin, and its part across, counter-clockwise.

    ``bound_n`` is a lower bound of the peak shaking force for all counterweights; None for least squares.
    """

    moment_kg_mm: complex
    bound_n: float | None = None

    def at(self, arm_mm: float) -> Counterweight:
        """The counterweight at an arm in mm on the crank; raises WrongInput for an arm that is not positive."""
        require_arm(arm_mm, "arm_mm")
        return Counterweight.of_moment(Carrier.CRANK, self.moment_kg_mm, arm_mm)


def least_squares(mechanism: DrivenCrank, known: Accelerations | None = None) -> BestCounterweight:
    """The counterweight of least mean square beside existing ones; ``known`` accelerations may be given."""
    known = known or accelerations(mechanism)
    angles, weights = gauss_points(known.form.breaks)
    pin, slider = _pin_and_slider(mechanism, known, angles)
    best = -np.sum(weights * np.conj(pin) * slider) / np.sum(weights * np.abs(pin) ** 2)
    return BestCounterweight(complex(best - mechanism.pin_kg) * mechanism.linkage.crank_mm)


def minimax(mechanism: DrivenCrank, known: Accelerations | None = None) -> BestCounterweight:
    """The counterweight of least peak beside those already there; raises Unanswered where more than ``GAP`` is left."""
    known, size, crank_mm = known or accelerations(mechanism), abs(mechanism.wrist_kg), mechanism.linkage.crank_mm
    if size <= NOTHING * mechanism.total_kg:  # the rod is balanced, and a crank mass balances the rest
        return BestCounterweight(least_squares(mechanism, known).moment_kg_mm, 0.0)
    scale = N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * crank_mm * size
    pin, slider = _pin_and_slider(mechanism, known, gauss_points(known.form.breaks)[0])
    slider, planes = slider / size, _Planes(np.empty((0, 3)), np.empty(0))
    found = (least_squares(mechanism, known).moment_kg_mm / crank_mm + mechanism.pin_kg) / size
    for _ in range(MOST_ROUNDS):
        planes = planes.joined(pin, slider, found)
        found, bound = planes.lowest()
        if float(np.abs(found * pin + slider).max()) > bound * (1.0 + GAP / 2.0):
            continue
        moment = (found * size - mechanism.pin_kg) * crank_mm
        added = Counterweight.of_moment(Carrier.CRANK, moment, crank_mm)
        peak = shaking(mechanism.with_counterweight(added), known).peak
        if peak.value <= scale * bound * (1.0 + GAP):
            return BestCounterweight(moment, scale * bound)
        more = _pin_and_slider(mechanism, known, np.array([peak.at]))
        pin, slider = np.append(pin, more[0]), np.append(slider, more[1] / size)
    raise Unanswered("the counterweight of least peak was not found")


@dataclass(frozen=True, eq=False)
class _Planes:
    """Planes below the peak t over the pin mass P, as linprog takes them: rows . (Re P, Im P, t) <= limits."""

    rows: Array
    limits: Array

    def joined(self, pin: ComplexArray, slider: ComplexArray, found: complex) -> _Planes:
        """These and the planes that touch the largest forces of the pin mass ``found``."""
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
        """The pin mass, in slider masses, where the highest of the planes is lowest, and its height there."""
        bounds, options = [(-BOX, BOX), (-BOX, BOX), (0.0, None)], {"primal_feasibility_tolerance": FEASIBLE}
        found = linprog([0.0, 0.0, 1.0], self.rows, self.limits, bounds=bounds, options=options)
        if not found.success:
            raise Unanswered(f"the linear programme of the counterweight failed: {found.message}")
        return complex(found.x[0], found.x[1]), float(found.x[2])


def _pin_and_slider(mechanism: DrivenCrank, known: Accelerations, angles: Array) -> tuple[ComplexArray, ComplexArray]:
    """c''/r and S x''/r at driving angles."""
    values = known.form(angles)
    pin: ComplexArray = values[:, PIN_X] + 1j * values[:, PIN_Y]
    slider: ComplexArray = np.asarray(mechanism.wrist_kg * values[:, WRIST], dtype=np.complex128)
    return pin, slider


@dataclass(frozen=True, eq=False)
class TriedCounterweight:
    """A counterweight with a tried mass: force on the crank's bearing and shaking force in N, and the track."""

    mass_kg: float
    bearing_n: Statistics
    shaking_n: Statistics
    track: Track


def sweep(mechanism: DrivenCrank, counterweight: Counterweight, masses_kg: Sequence[float]) -> list[TriedCounterweight]:
    """A counterweight on the crank with each mass, added to existing ones; with gravity, bearings carry weights."""
    known, found = accelerations(mechanism), []
    for mass in masses_kg:
        swept = mechanism.with_counterweight(replace(counterweight, mass_kg=mass))
        bearing_n = magnitude_statistics(*bearing_force(swept))
        found.append(TriedCounterweight(mass, bearing_n, shaking(swept, known).force, track(swept)))
    return found


def bearing_force(mechanism: DrivenCrank) -> tuple[Waveform, Waveform]:
    """Force in N on the crank at its bearing, along the slider's line and across it, without resistance."""

    def force(phi1: Array) -> Array:
        linkage, driven = mechanism.linkage, mechanism.transmission.driven_angle(phi1, 2)
        rod = linkage.joint_forces(driven, mechanism.masses, EvenPace(mechanism.speed_rad_s), 0.0).crank_axis
        gravity = complex(*mechanism.masses.gravity_m_s2)
        bend = complex_derivative(linkage.rod(driven).pin, 2)
        pin = N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * bend / linkage.crank_mm
        added = sum((w.mass_kg * (w.arm * pin - gravity) for w in mechanism.counterweights), np.zeros(phi1.shape))
        return np.column_stack([rod.x.value + added.real, rod.y.value + added.imag])

    along, across = waveforms(chebyshev.fitted(force, mechanism.breaks_rad))
    return along, across
