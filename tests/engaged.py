"""Pairs of gears in mesh, as designed and as written, for the tests of contact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, as_designed
from ncgear.contact.placement import Placement, placed
from ncgear.contact.written.as_written import AsWritten, Outlines, as_written, reach_mm
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Mesh
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import Backlash, TipLimits, TipRelief, ToothForm
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
    "uniform 2:3": lambda: uniform_law(Lobes(2, 3)),
    "ellipse": lambda: elliptical_law(0.35, 0.0, Lobes()),
    "long ellipse": lambda: elliptical_law(0.7, 0.0, Lobes()),
    "sine": lambda: sine_law(0.08),
    "deep sine": lambda: sine_law(0.3),
    "baler": baler_law,
}


RINGS: dict[str, Callable[[], Transmission]] = {
    "ring 1:2": lambda: uniform_law(Lobes(1, 2)),
    "ring": lambda: ratio_expression_law("2 + 0.4*cos(phi)", Lobes(1, 2), scale_to_close=True),
}
"""Laws whose driven gear is a ring here."""


@cache
def made(
    name: str,
    teeth: int,
    tolerance: float = TOLERANCE,
    backlash_mm: float = 0.0,
    angle_deg: float = 20.0,
    *,
    undercut: bool = False,
    relief: TipRelief | None = None,
) -> Made:
    """Pitch curves and teeth."""
    law, mesh = (RINGS[name], Mesh.INTERNAL) if name in RINGS else (LAWS[name], Mesh.EXTERNAL)
    pitch = sized_pair(law(), teeth, MODULE, None, mesh)
    basic = replace(rack(angle_deg), relief=relief)
    limits = TipLimits(0.2 * basic.module_mm, avoid_undercut=not undercut)
    return pitch, toothed_pair(pitch, ToothForm(basic, limits=limits, backlash=Backlash(backlash_mm)), tolerance)


@cache
def designed(name: str, teeth: int, backlash_mm: float = 0.0, angle_deg: float = 20.0, **kinds: Any) -> AsDesigned:
    """Contact of the exact curves."""
    pitch, pair = made(name, teeth, TOLERANCE, backlash_mm, angle_deg, **kinds)
    return as_designed(pair, placed(pitch))


@cache
def written(name: str, teeth: int, tolerance: float = TOLERANCE, backlash_mm: float = 0.0, **kinds: Any) -> AsWritten:
    """Contact of the outlines, as if read from a file."""
    pitch, pair = made(name, teeth, tolerance, backlash_mm, **kinds)
    return read(outlines(pair), pitch, pair, placed(pitch))


def read(found: Outlines, pitch: PitchPair, pair: ToothedPair, at: Placement) -> AsWritten:
    """Contact of outlines in the place of a pair's own."""
    return as_written(found, pair, at, reach_mm(pitch, pair))


def outlines(pair: ToothedPair) -> Outlines:
    """The outlines of a pair as they are."""
    return Outlines("test", pair.driving.outline_mm, pair.driven.outline_mm)


def least_driven_radius(placement: Placement) -> float:
    """Smallest pitch radius of the driven gear."""
    return float(placement.driven_radius_mm.min())
