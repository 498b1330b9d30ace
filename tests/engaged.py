"""Pairs of gears in mesh, as designed and as written, for the tests of contact."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ncgear.contact.as_designed import AsDesigned, as_designed
from ncgear.contact.as_written import AsWritten, Outlines, as_written
from ncgear.contact.placement import Placement, placed
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.gear import ToothedPair, toothed_pair
from pairs import baler_law, rack, sine_law

MODULE = 2.0
TOLERANCE = 0.005

Array = np.ndarray
Made = tuple[PitchPair, ToothedPair]

LAWS: dict[str, Callable[[], Transmission]] = {
    "uniform": lambda: uniform_law(Lobes()),
    "uniform 1:2": lambda: uniform_law(Lobes(1, 2)),
    "uniform 3:2": lambda: uniform_law(Lobes(3, 2)),
    "ellipse": lambda: elliptical_law(0.35, 0.0, Lobes()),
    "long ellipse": lambda: elliptical_law(0.7, 0.0, Lobes()),
    "sine": lambda: sine_law(0.08),
    "baler": baler_law,
}


@cache
def made(
    name: str, teeth: int, tolerance: float = TOLERANCE, backlash_mm: float = 0.0, angle_deg: float = 20.0
) -> Made:
    """Pitch curves and teeth."""
    pitch = sized_pair(LAWS[name](), teeth, MODULE, None)
    return pitch, toothed_pair(pitch, rack(angle_deg, backlash_mm=backlash_mm), tolerance)


@cache
def designed(name: str, teeth: int, backlash_mm: float = 0.0, angle_deg: float = 20.0) -> AsDesigned:
    """Contact of the exact curves."""
    pitch, pair = made(name, teeth, TOLERANCE, backlash_mm, angle_deg)
    return as_designed(pair, placed(pitch))


@cache
def written(name: str, teeth: int, tolerance: float = TOLERANCE, backlash_mm: float = 0.0) -> AsWritten:
    """Contact of the outlines, as if read from a file."""
    pitch, pair = made(name, teeth, tolerance, backlash_mm)
    return as_written(outlines(pair), pair, placed(pitch))


def outlines(pair: ToothedPair) -> Outlines:
    """The outlines of a pair as they are."""
    return Outlines("test", pair.driving.outline_mm, pair.driven.outline_mm)


def least_driven_radius(placement: Placement) -> float:
    """Smallest pitch radius of the driven gear."""
    return float(placement.driven_radius_mm.min())
