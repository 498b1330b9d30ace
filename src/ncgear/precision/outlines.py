"""Studies of tooth outlines: points per tooth against the distance of the outline from the exact curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.precision import teeth_pairs
from ncgear.precision.circular_gear import CircularGear
from ncgear.precision.elliptical_gear import EllipticalGear
from ncgear.precision.even_outline import even_outlines
from ncgear.precision.study import Method, Size, Study
from ncgear.precision.teeth_pairs import TEETH, TOLERANCE_MM
from ncgear.teeth.gear import toothed_pair

ALONG = (0.0, 0.25, 0.5, 0.75)
"""Shares of the chords at which their distance is taken: a chord strays most in its middle, but for cubics."""

TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016, 5e-4, 1.6e-4, 5e-5)
COUNTS = (2, 4, 8, 16, 32, 64)
ENOUGH_MM = TOLERANCE_MM
"""The default itself: the profiles of ground gears stray as far (ISO 1328, class 5, value from secondary sources)."""

CHORDS = "chords to a tolerance"


@dataclass(frozen=True)
class _Case:
    """A pair of gears, and how far points are from the exact driving gear."""

    key: str
    title: str
    reference: str
    pitch: PitchPair
    distance_mm: Callable[[Array], Array]


def circular_outlines() -> Study:
    """Of a circular gear, the whole outline."""
    gear = CircularGear(TEETH, teeth_pairs.rack())
    reference = "the involute, the trochoidal fillet and the arcs of a circular gear in closed form, whole outline"
    case = _Case("outlines-circle", "Outline of a circular gear", reference, teeth_pairs.circular(), gear.distance_mm)
    return _study(case)


def elliptical_outlines() -> Study:
    """Of an elliptical gear, the flanks."""
    gear = EllipticalGear(TEETH, teeth_pairs.ECCENTRICITY, teeth_pairs.rack())
    reference = "the flanks of an elliptical gear in closed form, by incomplete elliptic integrals"
    title = "Flanks of an elliptical gear"
    return _study(_Case("outlines-ellipse", title, reference, teeth_pairs.elliptical(), gear.distance_mm))


def largest_distance_mm(outline_mm: Array, distance_mm: Callable[[Array], Array]) -> float:
    """Of an outline's chords, shape (n, 2), from the exact curve."""
    step = np.roll(outline_mm, -1, axis=0) - outline_mm
    return float(max(np.max(distance_mm(outline_mm + share * step)) for share in ALONG))


def _study(case: _Case) -> Study:
    return Study(
        key=case.key,
        title=case.title,
        unit="mm",
        reference=case.reference,
        methods=(
            Method(CHORDS, "tolerance, mm", TOLERANCES_MM, _chords(case), -1.0),
            Method("the same to both sides", "tolerance, mm", TOLERANCES_MM, _chords(case, straddling=True), -1.0),
            Method("equivalent gears, to a tolerance", "tolerance, mm", TOLERANCES_MM, _chords(case, equivalent=True)),
            Method("even parameters", "chords per curve", COUNTS, _evenly(case), 2.0),
        ),
        error=lambda outline: largest_distance_mm(outline, case.distance_mm),
        chosen=(CHORDS, TOLERANCE_MM),
        enough=ENOUGH_MM,
        because="the time hardly depends on the tolerance, the size of files does, by its square root; at this one "
        "outlines stray no farther than the profiles of ground gears, and a finer one is a line in the design file. "
        "Chords to both sides take fewer points by the square root of 2, but let the flanks overlap",
        size=Size("points per tooth", lambda outline: len(outline) / TEETH),
    )


def _chords(case: _Case, *, straddling: bool = False, equivalent: bool = False) -> Callable[[float], Array]:
    """The driving outline as ncgear makes it, both gears' teeth included in the time."""
    form = teeth_pairs.form(equivalent=equivalent)
    return lambda tolerance: toothed_pair(case.pitch, form, tolerance, straddling=straddling).driving.outline_mm


def _evenly(case: _Case) -> Callable[[int], Array]:
    """The same by even parameters."""
    return lambda count: even_outlines(case.pitch, teeth_pairs.form(), count)[0]
