"""The studies of tooth outlines: points per tooth against the distance of the outline from the exact curve.

The pairs of gears here are also those of contact and solids.  They have the size of the baler's: 25 teeth of 3 mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from math import radians

import numpy as np

from ncgear.contact.placement import Placement, placed
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.play import facing_outlines, outline_play
from ncgear.design.keys.machine import Output
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.flank import FILLET, FLANK
from ncgear.teeth.form import Backlash, BasicRack, Cutter, CutterKind, ToothForm
from ncgear.teeth.gear import pair_tips, toothed_pair
from ncgear.teeth.outline import simple_polygon, whole_curves
from ncgear.teeth.sides import Sides, refuse_folded_lands, regular_sides, swept
from ncgear.teeth.stretch import CurveStretch
from ncgear.teeth.tips import Tips
from speed_against_error.exact_gears import CircularGear, EllipticalGear
from speed_against_error.study import Method, Size, Study

# --- the pairs -------------------------------------------------------------------------------------------------------

TEETH = 25
MODULE_MM = 3.0
ECCENTRICITY = 0.3
"""The ellipse's teeth are those of circular gears of 23 to 27 teeth, so that nothing is undercut."""

TOLERANCE_MM = Output().chord_mm(MODULE_MM)
"""The default of design files."""


def rack() -> BasicRack:
    """ISO 53 profile A at the module (values from secondary sources)."""
    return BasicRack(MODULE_MM, radians(20.0), MODULE_MM, 1.25 * MODULE_MM, 0.38 * MODULE_MM)


def form(backlash_mm: float = 0.0, *, equivalent: bool = False) -> ToothForm:
    """Teeth cut by a rack, whose fillets have closed forms."""
    return ToothForm(rack(), cutter=Cutter(CutterKind.RACK), equivalent=equivalent, backlash=Backlash(backlash_mm))


@cache
def circular_pair() -> PitchPair:
    """Two equal circular gears."""
    return sized_pair(uniform_law(Lobes()), TEETH, MODULE_MM, None)


@cache
def elliptical_pair() -> PitchPair:
    """Two equal ellipses about their foci."""
    return sized_pair(elliptical_law(ECCENTRICITY, 0.0, Lobes()), TEETH, MODULE_MM, None)


def circular_gear() -> CircularGear:
    """Each gear of the circular pair in closed form."""
    return CircularGear(TEETH, rack())


def elliptical_gear() -> EllipticalGear:
    """The driving gear of the elliptical pair in closed form."""
    return EllipticalGear(TEETH, ECCENTRICITY, rack())


# --- studies ---------------------------------------------------------------------------------------------------------

ALONG = (0.0, 0.25, 0.5, 0.75)
"""Shares of a chord at which its distance is taken: a chord strays most in its middle, except from cubics."""

TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016, 5e-4, 1.6e-4, 5e-5)
COUNTS = (4, 8, 16, 32)
ENOUGH_MM = TOLERANCE_MM
"""The default: the profiles of ground gears stray as far (ISO 1328, class 5, value from secondary sources)."""

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
        return placed(self.pitch), reach_mm(self.pitch, toothed_pair(self.pitch, form(), TOLERANCE_MM))

    def turned(self, outlines: tuple[Array, Array]) -> Array:
        """The driving outline, after both are turned against each other, as every build does."""
        placement, reach = self._positions
        play = outline_play(facing_outlines(*outlines, placement), placement, reach)
        if not (np.isfinite(play.up_rad).all() and np.isfinite(play.down_rad).all()):
            raise ArithmeticError(f"{self.key}: the outlines do not reach each other")
        return outlines[0]

    def chords(self, *, straddling: bool = False, equivalent: bool = False) -> Callable[[float], Array]:
        """The driving outline by tolerance, as ncgear makes it; the time includes both gears' teeth and their play."""
        teeth_form = form(equivalent=equivalent)

        def run(tolerance: float) -> Array:
            teeth = toothed_pair(self.pitch, teeth_form, tolerance, straddling=straddling)
            return self.turned((teeth.driving.outline_mm, teeth.driven.outline_mm))

        return run

    def evenly(self, count: int) -> Array:
        """The driving outline by even parameters, with the same in the time."""
        return self.turned(even_outlines(self.pitch, form(), count))


def circular_outline_study() -> Study:
    """The whole outline of a circular gear."""
    reference = "the involute, the trochoidal fillet and the arcs of a circular gear in closed form, whole outline"
    title = "Outline of a circular gear"
    return _study(_Case("outlines-circle", title, reference, circular_pair(), circular_gear().distance_mm), ())


def elliptical_outline_study() -> Study:
    """The flanks of an elliptical gear."""
    reference = "the flanks of an elliptical gear in closed form, by incomplete elliptic integrals"
    title = "Flanks of an elliptical gear"
    case = _Case("outlines-ellipse", title, reference, elliptical_pair(), elliptical_gear().distance_mm)
    return _study(case, (Method(EQUIVALENT, TOLERANCE, TOLERANCES_MM, case.chords(equivalent=True), adaptive=True),))


def _study(case: _Case, others: tuple[Method, ...]) -> Study:
    """The methods that are exact on both gears, and ``others``."""
    return Study(
        key=case.key,
        title=case.title,
        unit="mm",
        reference=case.reference,
        methods=(
            Method(CHORDS, TOLERANCE, TOLERANCES_MM, case.chords(), -1.0, adaptive=True),
            Method(BOTH_SIDES, TOLERANCE, TOLERANCES_MM, case.chords(straddling=True), -1.0, adaptive=True),
            Method(EVEN, "chords per curve", COUNTS, case.evenly, 2.0),
            *others,
        ),
        error=lambda outline: _largest_distance_mm(outline, case.distance_mm),
        chosen=(CHORDS, TOLERANCE_MM),
        enough=ENOUGH_MM,
        because="an outline is made once and turned against its mate in every position, so that points cost more than "
        "placing them well; at this tolerance outlines stray no farther than the profiles of ground gears, and a finer "
        "one is a line in the design file. Chords to both sides are fewer by the square root of 2 at best, but let the "
        "flanks overlap",
        size=Size("points per tooth", lambda outline: len(outline) / TEETH),
    )


def _largest_distance_mm(outline_mm: Array, distance_mm: Callable[[Array], Array]) -> float:
    """The largest distance of an outline's chords, shape (n, 2), from the exact curve."""
    step = np.roll(outline_mm, -1, axis=0) - outline_mm
    return float(max(np.max(distance_mm(outline_mm + share * step)) for share in ALONG))


# --- outlines by even parameters -------------------------------------------------------------------------------------


def even_outlines(pitch: PitchPair, teeth_form: ToothForm, count: int) -> tuple[Array, Array]:
    """Both outlines by ``count`` chords on every flank, fillet and land, evenly spaced in the curves' parameters.

    This is how other programs do it.  The outlines have the shape (6 z count, 2), run counter-clockwise and pass the
    checks of ncgear's own.  Raises ArithmeticError for undercut teeth, whose curves end elsewhere.
    """
    _, (driving, driven) = pair_tips(pitch, teeth_form, 0.0)
    share = np.linspace(0.0, 1.0, count + 1)
    return _even_outline(driving, share)[::-1], _even_outline(driven, share)


def _even_outline(tips: Tips, share: Array) -> Array:
    """One outline in the sense of growing arc length, which is clockwise on the driving gear.

    On each tooth it runs up the back, over the tip, down the front and along the root.
    """
    sides, irregular = regular_sides(tips)
    if irregular.any():
        raise ArithmeticError("only outlines of regular teeth are sampled evenly")
    refuse_folded_lands(tips.flanks, sides)
    tips, sides = swept(tips, sides)
    flank, fillet = (_runs(tips, sides, kind, share) for kind in (FLANK, FILLET))
    *_, tip_lands, root_lands = whole_curves(tips, sides)
    back, front = slice(0, None, 2), slice(1, None, 2)
    curves = [
        fillet[back, ::-1],
        flank[back, ::-1],
        _lands(tip_lands, share),
        flank[front],
        fillet[front],
        _lands(root_lands, share),
    ]
    outline = np.concatenate([curve[:, :-1] for curve in curves], axis=1).reshape(-1, 2)
    simple_polygon(outline, f"gears.{tips.flanks.curve.gear.value}")
    return outline


def _runs(tips: Tips, sides: Sides, kind: int, share: Array) -> Array:
    """Points of one kind of curve from the tip inwards, shape (2 z, n, 2)."""
    chosen = sides.kind == kind
    start, end = sides.start[chosen, None], sides.end[chosen, None]
    owner: IndexArray = sides.owner[chosen]
    return tips.flanks.curve_of(sides.kind[chosen], owner, start + (end - start) * share)[0]


def _lands(stretch: CurveStretch, share: Array) -> Array:
    """Points of tip or root lands, shape (z, n, 2)."""
    return stretch.at(np.arange(stretch.owner.size)[:, None], share)[0]
