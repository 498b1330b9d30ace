"""Studies of the contact analysis on a circular pair, where involute gears tell what must come out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import pi, sin, sqrt

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, as_designed
from ncgear.contact.placement import PER_TOOTH, placed
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.play import outline_play
from ncgear.numerics.arrays import Array
from ncgear.precision import teeth_pairs
from ncgear.precision.circular_gear import CircularGear
from ncgear.precision.even_outline import even_outlines
from ncgear.precision.study import Method, Study
from ncgear.precision.teeth_pairs import MODULE_MM, TEETH, TOLERANCE_MM
from ncgear.teeth.gear import toothed_pair

BACKLASH_MM = 0.1
POSITIONS = (2, 4, 6, 10, PER_TOOTH, 40)
FEW_POSITIONS = POSITIONS[2:]
TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016, 5e-4)
COUNTS = (4, 8, 16)

ENOUGH_RATIO = 1e-3
"""Of a contact ratio, which standards ask for to a tenth."""

ENOUGH_RAD = 3e-5
"""Six seconds of arc: what dividing heads and indexing tables of the better sort are made to."""

ENDS, COUNTED = "ends of contact between positions", "contacts counted at positions"
CURVES, CHORDS, EVEN = "exact curves", "outlines to a tolerance", "outlines of even parameters"
PER_PITCH = "positions per pitch"


@dataclass(frozen=True, eq=False)
class Play:
    """Driven angles in rad beyond the law's at which pushing flanks and their backs touch, shape (n,) each."""

    pushing_rad: Array
    back_rad: Array


def ratio() -> Study:
    """Relative error of the contact ratio as designed."""
    return Study(
        key="contact-ratio",
        title="Contact ratio",
        unit="share",
        reference="two equal involute gears have (2 sqrt(ra^2 - rb^2) - a sin alpha) / (pi m cos alpha)",
        methods=(
            Method(ENDS, PER_PITCH, POSITIONS, lambda count: float(_designed(count).pushing.arcs.min())),
            Method(COUNTED, PER_PITCH, POSITIONS, lambda count: float(_designed(count).pushing.simultaneous.mean())),
        ),
        error=lambda found: abs(found / contact_ratio() - 1.0),
        chosen=(ENDS, PER_TOOTH),
        enough=ENOUGH_RATIO,
        because="heights of contact are linear in the rolled length, so that the ends of contact between positions are "
        "exact once each contact has a position; what outlines do between positions needs more, and twenty find it",
    )


def angle() -> Study:
    """Error of the driven angles at which teeth touch, their backlash included, as designed and as written."""
    return Study(
        key="contact-angle",
        title="Driven angle at contact",
        unit="rad",
        reference="involute gears, which have no transmission error, and a play of the normal backlash over rb",
        methods=(
            Method(CURVES, PER_PITCH, FEW_POSITIONS, by_curves),
            Method(CHORDS, "tolerance in mm", TOLERANCES_MM, by_chords, -1.0, adaptive=True),
            Method(EVEN, "chords per curve", COUNTS, _by_even_parameters, 2.0),
        ),
        error=angle_error_rad,
        chosen=(CURVES, PER_TOOTH),
        enough=ENOUGH_RAD,
        because="the exact curves' tangency is solved for at every position; outlines are turned against each other "
        "beside that, to be sure of what was written, and what they show is the error of their chords",
    )


def contact_ratio() -> float:
    """Of the circular pair, in closed form."""
    gear = CircularGear(TEETH, teeth_pairs.rack())
    sine = sin(gear.rack.pressure_angle_rad)
    action = 2.0 * (sqrt(gear.tip_radius_mm**2 - gear.base_radius_mm**2) - gear.pitch_radius_mm * sine)
    return action * gear.pitch_radius_mm / (pi * MODULE_MM * gear.base_radius_mm)


def angle_error_rad(play: Play) -> float:
    """Farthest that either side is from where involutes touch."""
    free = BACKLASH_MM / CircularGear(TEETH, teeth_pairs.rack()).base_radius_mm
    return float(max(np.max(np.abs(play.pushing_rad)), np.max(np.abs(play.back_rad - free))))


def by_curves(positions: int) -> Play:
    """As designed."""
    found = _designed(positions, BACKLASH_MM)
    return Play(found.pushing.error_rad, found.back.error_rad)


def by_chords(tolerance_mm: float, positions: int | None = None) -> Play:
    """As written, from ncgear's outlines to a tolerance."""
    teeth = toothed_pair(teeth_pairs.circular(), teeth_pairs.form(BACKLASH_MM), tolerance_mm)
    return by_outlines((teeth.driving.outline_mm, teeth.driven.outline_mm), positions)


def by_outlines(outlines: tuple[Array, Array], positions: int | None = None) -> Play:
    """As written, from any outlines; shape (n, 2) each."""
    placement = placed(teeth_pairs.circular(), positions)
    play = outline_play(*outlines, placement, _reach_mm())
    return Play(*placement.bounds_rad(play.up_rad, play.down_rad))


@cache
def _reach_mm() -> float:
    pitch = teeth_pairs.circular()
    return reach_mm(pitch, toothed_pair(pitch, teeth_pairs.form(), TOLERANCE_MM))


def _by_even_parameters(count: int) -> Play:
    return by_outlines(even_outlines(teeth_pairs.circular(), teeth_pairs.form(BACKLASH_MM), count))


def _designed(positions: int, backlash_mm: float = 0.0) -> AsDesigned:
    pitch = teeth_pairs.circular()
    return as_designed(toothed_pair(pitch, teeth_pairs.form(backlash_mm), TOLERANCE_MM), placed(pitch, positions))
