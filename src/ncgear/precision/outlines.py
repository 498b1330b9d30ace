"""Studies of tooth outlines: points per tooth against the distance of the outline from the exact curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ncgear.contact.placement import Placement, placed
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.play import outline_play
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
COUNTS = (4, 8, 16, 32)
ENOUGH_MM = TOLERANCE_MM
"""The default itself: the profiles of ground gears stray as far (ISO 1328, class 5, value from secondary sources)."""

CHORDS, BOTH_SIDES = "chords to a tolerance", "chords to both sides"
EVEN, EQUIVALENT = "even parameters", "equivalent gears"
TOLERANCE = "tolerance in mm"


@dataclass(frozen=True, eq=False)
class _Case:
    """A pair of gears, and how far points are from the exact driving gear."""

    key: str
    title: str
    reference: str
    pitch: PitchPair
    distance_mm: Callable[[Array], Array]

    @cached_property
    def _positions(self) -> tuple[Placement, float]:
        return placed(self.pitch), reach_mm(self.pitch, toothed_pair(self.pitch, teeth_pairs.form(), TOLERANCE_MM))

    def turned(self, outlines: tuple[Array, Array]) -> Array:
        """The driving outline, after both have been turned against each other, which no build goes without."""
        play = outline_play(*outlines, *self._positions)
        if not (np.isfinite(play.up_rad).all() and np.isfinite(play.down_rad).all()):
            raise ArithmeticError(f"{self.key}: the outlines do not reach each other")
        return outlines[0]


def circular_outlines() -> Study:
    """Of a circular gear, the whole outline."""
    gear = CircularGear(TEETH, teeth_pairs.rack())
    reference = "the involute, the trochoidal fillet and the arcs of a circular gear in closed form, whole outline"
    case = _Case("outlines-circle", "Outline of a circular gear", reference, teeth_pairs.circular(), gear.distance_mm)
    return _study(case, ())


def elliptical_outlines() -> Study:
    """Of an elliptical gear, the flanks."""
    gear = EllipticalGear(TEETH, teeth_pairs.ECCENTRICITY, teeth_pairs.rack())
    reference = "the flanks of an elliptical gear in closed form, by incomplete elliptic integrals"
    title = "Flanks of an elliptical gear"
    case = _Case("outlines-ellipse", title, reference, teeth_pairs.elliptical(), gear.distance_mm)
    return _study(case, (Method(EQUIVALENT, TOLERANCE, TOLERANCES_MM, _chords(case, equivalent=True), adaptive=True),))


def largest_distance_mm(outline_mm: Array, distance_mm: Callable[[Array], Array]) -> float:
    """Of an outline's chords, shape (n, 2), from the exact curve."""
    step = np.roll(outline_mm, -1, axis=0) - outline_mm
    return float(max(np.max(distance_mm(outline_mm + share * step)) for share in ALONG))


def _study(case: _Case, others: tuple[Method, ...]) -> Study:
    """Of what is exact on both gears, and others."""
    return Study(
        key=case.key,
        title=case.title,
        unit="mm",
        reference=case.reference,
        methods=(
            Method(CHORDS, TOLERANCE, TOLERANCES_MM, _chords(case), -1.0, adaptive=True),
            Method(BOTH_SIDES, TOLERANCE, TOLERANCES_MM, _chords(case, straddling=True), -1.0, adaptive=True),
            Method(EVEN, "chords per curve", COUNTS, _evenly(case), 2.0),
            *others,
        ),
        error=lambda outline: largest_distance_mm(outline, case.distance_mm),
        chosen=(CHORDS, TOLERANCE_MM),
        enough=ENOUGH_MM,
        because="an outline is made once and turned against its mate in every position, so that points cost more than "
        "placing them well; at this tolerance outlines stray no farther than the profiles of ground gears, and a finer "
        "one is a line in the design file. Chords to both sides are fewer by the square root of 2 at best, but let the "
        "flanks overlap",
        size=Size("points per tooth", lambda outline: len(outline) / TEETH),
    )


def _chords(case: _Case, *, straddling: bool = False, equivalent: bool = False) -> Callable[[float], Array]:
    """The driving outline as ncgear makes it; both gears' teeth and their play are in the time."""
    form = teeth_pairs.form(equivalent=equivalent)

    def run(tolerance: float) -> Array:
        teeth = toothed_pair(case.pitch, form, tolerance, straddling=straddling)
        return case.turned((teeth.driving.outline_mm, teeth.driven.outline_mm))

    return run


def _evenly(case: _Case) -> Callable[[int], Array]:
    """The same by even parameters."""
    return lambda count: case.turned(even_outlines(case.pitch, teeth_pairs.form(), count))
