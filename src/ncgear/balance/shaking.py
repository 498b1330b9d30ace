"""Shaking force and shaking moment: what the moving masses of a crank-slider do to its frame.

    F = -d/dt sum m v,   M = -d/dt (sum m p x v + sum J w)   about the crank axis

M holds the reaction of whatever drives the crank, which stands on the same frame.  At constant driving speed W the time
derivative is W d/dphi1.  J. J. Uicker, G. R. Pennock, J. E. Shigley, "Theory of Machines and Mechanisms", 4th edition,
2011, chapters 15 and 17.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.balance.accelerations import (
    ASIDE,
    CRANK,
    PIN_X,
    PIN_Y,
    ROD,
    TOGETHER,
    WRIST,
    Accelerations,
    accelerations,
)
from ncgear.balance.mechanism import Mechanism
from ncgear.balance.waveform import Statistics, Waveform, magnitude_statistics, squared_magnitude
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum


@dataclass(frozen=True, eq=False)
class Shaking:
    """Shaking force in N along the slider's line (x) and across it (y), and moment in N mm, over one cycle of phi1."""

    along: Waveform
    across: Waveform
    moment: Waveform

    @cached_property
    def force(self) -> Statistics:
        """Of the force's size."""
        return magnitude_statistics(self.along, self.across)

    @cached_property
    def peak(self) -> Extremum:
        """The largest size, with the driving angle."""
        highest = squared_magnitude(self.along, self.across).extremes[1]
        return Extremum(float(np.sqrt(max(highest.value, 0.0))), highest.at)


def shaking(mechanism: Mechanism, of: Accelerations | None = None) -> Shaking:
    """Shaking force and moment; ``of`` are the accelerations of the same linkage and law, if they are known."""
    known = of or accelerations(mechanism)
    forms = known.combined(np.column_stack([*_force_weights(mechanism), _moment_weights(mechanism)]))
    parts = (PiecewiseChebyshev(forms.breaks, forms.coefficients[:, :, k]) for k in range(3))
    return Shaking(*map(Waveform, parts))


def _force_weights(mechanism: Mechanism) -> tuple[Array, Array]:
    """-(P c'' + S w'') W^2, real and imaginary part."""
    factor = -N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * mechanism.linkage.crank_mm
    pin, wrist = factor * mechanism.pin_kg, factor * mechanism.wrist_kg
    along, across = np.zeros(7), np.zeros(7)
    along[[PIN_X, PIN_Y, WRIST]] = pin.real, -pin.imag, wrist.real
    across[[PIN_X, PIN_Y, WRIST]] = pin.imag, pin.real, wrist.imag
    return along, across


def _moment_weights(mechanism: Mechanism) -> Array:
    linkage, masses = mechanism.linkage, mechanism.masses
    crank, rod, offset = linkage.crank_mm, linkage.rod_mm, linkage.offset_mm
    places = [(mass, place / rod) for mass, place in mechanism.on_rod]
    cross = sum((mass * (1.0 - share).conjugate() * share for mass, share in places), 0j)
    at_pin = sum(mass * abs(1.0 - share) ** 2 for mass, share in places)
    at_wrist = masses.slider_kg + sum(mass * abs(share) ** 2 for mass, share in places)
    extra = sum(w.mass_kg * w.arm_mm**2 for w in mechanism.counterweights if w.carrier == "crank")
    weights = np.zeros(7)
    # The crank turns clockwise: its angular momentum is against the sense of the moment
    weights[CRANK] = -(masses.crank_shaft_kg_mm2 + extra + at_pin * crank**2)
    weights[ROD] = masses.rod_inertia_kg_mm2
    weights[WRIST] = -at_wrist * offset * crank
    weights[TOGETHER], weights[ASIDE] = cross.real * crank * rod, cross.imag * crank * rod
    return -N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * weights
