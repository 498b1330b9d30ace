"""Mechanisms that the tests of balance share, and where their masses are by 40-digit arithmetic."""

from __future__ import annotations

import mpmath
import numpy as np

from ncgear.balance.mechanism import Carrier, Counterweight, DrivenCrank
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from pairs import sine_law
from published import RPM

LINKAGE = CrankSlider(265.0, 560.0)
OFFSET = CrankSlider(265.0, 560.0, 90.0)
MASSES = RodMasses(65.0, 20.0, 300.0, 4e5, 30.0, 60.0, 5e5)
ASIDE = (
    Counterweight(Carrier.CRANK, 40.0, 200.0, 2.8),
    Counterweight(Carrier.ROD, 25.0, 150.0, -2.5),
)
AMPLITUDE = 0.3
"""Of the non-circular law phi2 = phi1 - 0.3 sin 2 phi1."""


def even(linkage: CrankSlider = LINKAGE, masses: RodMasses = MASSES, rpm: float = 96.5) -> DrivenCrank:
    return DrivenCrank(linkage, uniform_law(Lobes()), rpm * RPM, masses)


def uneven(linkage: CrankSlider = LINKAGE, masses: RodMasses = MASSES, rpm: float = 96.5) -> DrivenCrank:
    return DrivenCrank(linkage, uneven_law(), rpm * RPM, masses)


def uneven_law() -> Transmission:
    return sine_law(AMPLITUDE)


def oracle(mechanism: DrivenCrank, amplitude: float, phi1: float) -> tuple[complex, float]:
    """Shaking force in N and moment in N mm: time derivatives of momentum and angular momentum of every single mass.

    The law is phi2 = phi1 - amplitude sin 2 phi1; places are from the vector loop alone.
    """
    with mpmath.workdps(40):
        crank, rod, offset = (
            mpmath.mpf(x) for x in (mechanism.linkage.crank_mm, mechanism.linkage.rod_mm, mechanism.linkage.offset_mm)
        )
        retracted = mpmath.pi + mpmath.asin(offset / (rod - crank))

        def turned(t: mpmath.mpf) -> tuple[mpmath.mpc, mpmath.mpc]:
            """Directions of crank and rod."""
            heading = mpmath.expj(retracted - (t - amplitude * mpmath.sin(2 * t)))
            sine = (offset - crank * heading.imag) / rod
            return heading, mpmath.mpc(mpmath.sqrt(1 - sine**2), sine)

        masses = mechanism.masses
        places = [(masses.slider_kg, lambda t: crank * turned(t)[0] + rod * turned(t)[1])]
        places += [(m, lambda t, p=p: p * turned(t)[0]) for m, p in mechanism.on_crank]
        places += [(m, lambda t, p=p: crank * turned(t)[0] + p * turned(t)[1]) for m, p in mechanism.on_rod]
        own_crank = masses.crank_shaft_kg_mm2 - masses.crank_kg * masses.crank_center_mm**2
        spins = [
            (own_crank, lambda t: mpmath.arg(turned(t)[0])),
            (masses.rod_inertia_kg_mm2, lambda t: mpmath.arg(turned(t)[1])),
        ]
        force, moment = mpmath.mpc(0), mpmath.mpf(0)
        for mass, place in places:
            now, second = place(phi1), mpmath.diff(place, phi1, 2)
            force += mass * second
            moment += mass * mpmath.im(mpmath.conj(now) * second)
        moment += sum(inertia * mpmath.diff(angle, phi1, 2) for inertia, angle in spins)
        scale = -(mpmath.mpf(mechanism.speed_rad_s) ** 2) / 1000
        return complex(scale * force), float(scale * moment)


def sampled(mechanism: DrivenCrank, count: int = 7) -> np.ndarray:
    """Angles over a cycle that are nothing special."""
    return (np.arange(count) + 0.37) / count * mechanism.transmission.cycle_rad
