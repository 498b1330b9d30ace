"""Pairs that bear load, for the tests of loaded contact and of motion in time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi
from typing import Any

import numpy as np

from engaged import LAWS, MODULE, RINGS, made
from ncgear.dynamics.crank_load import CrankLoad, crank_load
from ncgear.dynamics.gaps import Gaps, gaps_of
from ncgear.dynamics.law_table import law_table
from ncgear.dynamics.meshing import Friction, Impact, Meshing
from ncgear.dynamics.motion_in_time import DriveLine, EvenDrive, ToothedMachine
from ncgear.dynamics.pair_places import PairPlaces
from ncgear.dynamics.start import Start, started
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.periodic_table import PeriodicTable
from ncgear.ratio.transmission import Transmission

Array = np.ndarray

IMPACT = Impact(2.2, 100.0, 0.1)
LINEAR = Impact(1.0, 100.0, 0.01)
STIFFNESS = 5e5
"""Stiffness of all pairs in N/mm^exponent, where nothing is said."""

FRICTION = Friction(0.08, 0.05, 1.0, 10.0)
SMOOTH = Friction(0.0, 0.0, 1.0, 10.0)
MASSES = RodMasses(
    slider_kg=5.0,
    rod_kg=1.5,
    rod_center_mm=90.0,
    rod_inertia_kg_mm2=8e3,
    crank_kg=1.0,
    crank_center_mm=20.0,
    crank_inertia_kg_mm2=2e3,
    driven_inertia_kg_mm2=500.0,
)
LINKAGE = CrankSlider(60.0, 200.0)
SPEED = 2.0 * pi


class Giving(Impact):
    """Damping of the wrong sign."""

    def force_n(self, elastic_n: Array, damped_n: Array) -> Array:
        return super().force_n(elastic_n, -damped_n)


def alike(places: PairPlaces) -> Array:
    """Pairs that are all as stiff."""
    return np.full(places.flanks.shape, STIFFNESS)


def uneven(places: PairPlaces) -> Array:
    """Pairs of 0.4 to 1.6 times the stiffness, by the distance of the contact from the driving axis in modules."""
    return STIFFNESS * (1.0 + 0.6 * np.sin(3.0 * np.abs(places.driving_point) / MODULE))


@cache
def gaps(name: str, teeth: int, per_tooth: int = 80, **kinds: Any) -> Gaps:
    """The pairs of a mesh of ``engaged.made``."""
    pitch, pair = made(name, teeth, **kinds)
    return gaps_of(pair, pitch, alike, per_tooth)


@cache
def meshing(name: str, teeth: int, **kinds: Any) -> Meshing:
    """The same with the usual law of impact and friction."""
    return Meshing(law_table((LAWS | RINGS)[name]()), gaps(name, teeth, **kinds), IMPACT, FRICTION)


@cache
def uneven_meshing(name: str, teeth: int) -> Meshing:
    """A mesh whose pairs are linear springs that get stiffer and softer on their way."""
    pitch, pair = made(name, teeth)
    return Meshing(law_table((LAWS | RINGS)[name]()), gaps_of(pair, pitch, uneven), LINEAR, FRICTION)


def frictionless(found: Meshing, stiffness: float = STIFFNESS, **changes: float) -> Meshing:
    """Without friction, with another stiffness of all pairs, and with other figures of the law of impact."""
    smooth = replace(found, friction=SMOOTH, impact=replace(found.impact, **changes))
    return smooth.stiffened(stiffness / STIFFNESS)


def even_load(inertia_kg_mm2: float, torque_n_mm: float) -> CrankLoad:
    """A shaft of constant inertia under a constant torque."""
    coefficients = np.zeros((4, 1, 2))
    coefficients[3, 0, 0] = 1e-3 * inertia_kg_mm2
    coefficients[2, 0, 1] = torque_n_mm
    table = PeriodicTable(np.array([0.0, 2.0 * pi]), coefficients, np.array([0.0, 2.0 * pi * torque_n_mm]))
    return CrankLoad(table, (0.0, pi))


def slider_load(force_n: tuple[float, ...] = (500.0,), masses: RodMasses = MASSES) -> CrankLoad:
    """A small crank-slider against a polynomial resistance."""
    return crank_load(LINKAGE, masses, SliderLoad(PolynomialResistance(force_n)))


def begun(found: ToothedMachine, law: Transmission, start: Start) -> Array:
    """The state in which a motion begins; a drive of constant speed strikes a driven gear that stands."""
    state = started(found, law, start, found.drive.speed_rad_s)
    if isinstance(found.drive, EvenDrive):
        state[1] = found.drive.speed_rad_s
    return state


def mechanism(found: Meshing, load: CrankLoad, drive: DriveLine | None = None) -> ToothedMachine:
    """Teeth and load, driven evenly at a turn a second if nothing is said."""
    return ToothedMachine(drive or EvenDrive(SPEED), found, load)
