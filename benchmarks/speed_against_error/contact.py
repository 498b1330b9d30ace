"""The studies of the contact analysis, on a circular pair: the theory of involute gears gives the exact results."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import pi, sin, sqrt

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, as_designed
from ncgear.contact.placement import PER_TOOTH, placed
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.play import facing_outlines, outline_play
from ncgear.numerics.arrays import Array
from ncgear.teeth.gear import toothed_pair
from speed_against_error.outlines import MODULE_MM, TOLERANCE_MM, circular_gear, circular_pair, even_outlines, form
from speed_against_error.study import Method, Study

BACKLASH_MM = 0.1
POSITIONS = (2, 4, 6, 10, PER_TOOTH, 40)
PER_PITCH = "positions per pitch"


# --- contact ratio ---------------------------------------------------------------------------------------------------

ENOUGH_RATIO = 1e-3
"""Standards ask for a contact ratio to a tenth."""

ENDS, COUNTED = "ends of contact between positions", "contacts counted at positions"


def contact_ratio_study() -> Study:
    """The contact ratio as designed."""
    return Study(
        key="contact-ratio",
        title="Contact ratio",
        unit="share",
        reference="two equal involute gears have (2 sqrt(ra^2 - rb^2) - a sin alpha) / (pi m cos alpha)",
        methods=(
            Method(ENDS, PER_PITCH, POSITIONS, lambda count: float(_designed(count).pushing.pairs.arcs.min())),
            Method(COUNTED, PER_PITCH, POSITIONS, lambda count: float(_designed(count).pushing.simultaneous.mean())),
        ),
        error=lambda found: abs(found / exact_contact_ratio() - 1.0),
        chosen=(ENDS, PER_TOOTH),
        enough=ENOUGH_RATIO,
        because="heights of contact are linear in the rolled length, so that the ends of contact between positions are "
        "exact once each contact has a position; what outlines do between positions needs more, and twenty find it",
    )


def exact_contact_ratio() -> float:
    """The contact ratio of the circular pair in closed form."""
    gear = circular_gear()
    sine = sin(gear.rack.pressure_angle_rad)
    action = 2.0 * (sqrt(gear.tip_radius_mm**2 - gear.base_radius_mm**2) - gear.pitch_radius_mm * sine)
    return action * gear.pitch_radius_mm / (pi * MODULE_MM * gear.base_radius_mm)


def _designed(positions: int, backlash_mm: float = 0.0) -> AsDesigned:
    pitch = circular_pair()
    return as_designed(toothed_pair(pitch, form(backlash_mm), TOLERANCE_MM), placed(pitch, positions))


# --- driven angle at contact -----------------------------------------------------------------------------------------

FEW_POSITIONS = POSITIONS[2:]
TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016, 5e-4)
COUNTS = (4, 8, 16)

ENOUGH_RAD = 3e-5
"""Six seconds of arc: good dividing heads and indexing tables are made to that."""

CURVES, CHORDS, EVEN = "exact curves", "outlines to a tolerance", "outlines of even parameters"


@dataclass(frozen=True, eq=False)
class Play:
    """Driven angles in rad beyond the law's at which pushing flanks and their backs touch, shape (n,) each."""

    pushing_rad: Array
    back_rad: Array


def contact_angle_study() -> Study:
    """The driven angles at which teeth touch, with backlash, as designed and as written."""
    return Study(
        key="contact-angle",
        title="Driven angle at contact",
        unit="rad",
        reference="involute gears, which have no transmission error, and a play of the normal backlash over rb",
        methods=(
            Method(CURVES, PER_PITCH, FEW_POSITIONS, play_of_curves),
            Method(CHORDS, "tolerance in mm", TOLERANCES_MM, play_to_tolerance, -1.0, adaptive=True),
            Method(EVEN, "chords per curve", COUNTS, _play_of_even_outlines, 2.0),
        ),
        error=play_error_rad,
        chosen=(CURVES, PER_TOOTH),
        enough=ENOUGH_RAD,
        because="the exact curves' tangency is solved for at every position; outlines are turned against each other "
        "beside that, to be sure of what was written, and what they show is the error of their chords",
    )


def play_error_rad(play: Play) -> float:
    """The largest distance of either side from where involutes touch."""
    free = BACKLASH_MM / circular_gear().base_radius_mm
    return float(max(np.max(np.abs(play.pushing_rad)), np.max(np.abs(play.back_rad - free))))


def play_of_curves(positions: int) -> Play:
    """The play as designed."""
    found = _designed(positions, BACKLASH_MM)
    return Play(found.pushing.error_rad, found.back.error_rad)


def play_to_tolerance(tolerance_mm: float, positions: int | None = None) -> Play:
    """The play as written, with ncgear's outlines to a tolerance."""
    teeth = toothed_pair(circular_pair(), form(BACKLASH_MM), tolerance_mm)
    return play_of_outlines((teeth.driving.outline_mm, teeth.driven.outline_mm), positions)


def _play_of_even_outlines(count: int) -> Play:
    return play_of_outlines(even_outlines(circular_pair(), form(BACKLASH_MM), count))


def play_of_outlines(outlines: tuple[Array, Array], positions: int | None = None) -> Play:
    """The play of any two outlines, shape (n, 2) each."""
    placement = placed(circular_pair(), positions)
    play = outline_play(facing_outlines(*outlines, placement), placement, _reach_mm())
    return Play(*placement.bounds_rad(play.up_rad, play.down_rad))


@cache
def _reach_mm() -> float:
    return reach_mm(circular_pair(), toothed_pair(circular_pair(), form(), TOLERANCE_MM))
