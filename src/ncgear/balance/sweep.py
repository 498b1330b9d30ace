"""Counterweights tried one after the other: the force on the crank's bearing and the track of the centre of mass.

The tables of C. Wei, L. Xu, J. Wang, Y. Li, Int. J. Agric. & Biol. Eng. 11 (2018) 129-137, without their program.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.balance.accelerations import Accelerations, accelerations
from ncgear.balance.mechanism import Counterweight, Mechanism, as_complex
from ncgear.balance.shaking import shaking
from ncgear.balance.track import Track, track
from ncgear.balance.waveform import Statistics, Waveform, magnitude_statistics
from ncgear.dynamics.joints import joint_forces
from ncgear.dynamics.pace import EvenPace
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev


@dataclass(frozen=True, eq=False)
class Tried:
    """One counterweight: statistics of the force on the bearing of the crank and of the shaking force, and the
    track."""

    mass_kg: float
    bearing_n: Statistics
    shaking_n: Statistics
    track: Track


def sweep(mechanism: Mechanism, counterweight: Counterweight, masses_kg: Sequence[float]) -> list[Tried]:
    """A counterweight on the crank with each of the masses, beside those there.

    The bearing carries the rod's pull and the crank's parts, with their weight where the masses have gravity.
    """
    known = accelerations(mechanism)
    return [
        _tried(replace(mechanism, counterweights=(*mechanism.counterweights, one)), one, known)
        for one in (replace(counterweight, mass_kg=mass) for mass in masses_kg)
    ]


def bearing_force(mechanism: Mechanism) -> tuple[Waveform, Waveform]:
    """Force in N on the crank at its bearing, along the slider's line and across it, without resistance."""

    def force(phi1: Array) -> Array:
        at, pace = mechanism.bodies(phi1), EvenPace(mechanism.speed_rad_s)
        rod = joint_forces(at, mechanism.masses, pace, 0.0).crank_axis
        gravity = complex(*mechanism.masses.gravity_m_s2)
        pin = N_PER_KG_MM_S2 * mechanism.speed_rad_s**2 * as_complex(at.pin, 2) / mechanism.linkage.crank_mm
        added = sum((w.mass_kg * (w.arm * pin - gravity) for w in mechanism.counterweights), np.zeros(phi1.shape))
        return np.column_stack([rod.x.value + added.real, rod.y.value + added.imag])

    form = chebyshev.fitted(force, mechanism.breaks_rad)
    along, across = (Waveform(PiecewiseChebyshev(form.breaks, form.coefficients[:, :, k])) for k in (0, 1))
    return along, across


def _tried(mechanism: Mechanism, one: Counterweight, known: Accelerations) -> Tried:
    bearing = magnitude_statistics(*bearing_force(mechanism))
    return Tried(one.mass_kg, bearing, shaking(mechanism, known).force, track(mechanism))
