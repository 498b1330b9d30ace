"""The pair as written: contacts of the outlines read back from files, at the positions of the design.

Outlines are compared wherever they can touch: along the line of action, and in a ring where tips can foul.  In a ring
the tips overlap far beyond the line of action: halfway round on circular gears with nearly as many teeth as the ring.

The clearance of tips over roots is measured on the outlines, along the normals of the pitch curve.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import sin

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.contact.written.apart import Facing
from ncgear.contact.written.play import WrittenPlay, facing_outlines, outline_play
from ncgear.contact.written.polar import polar_outline
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, counted_up
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.plane import across, along, as_complex
from ncgear.pitch.internal import passed_mm
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.teeth.flank import Flanks
from ncgear.teeth.gear import ToothedGear, ToothedPair


@dataclass(frozen=True, eq=False)
class Outlines:
    """Both outlines as read from written files (mm, shape (n, 2), own frames), and the ``source`` they are from."""

    source: str
    driving_mm: Array
    driven_mm: Array


@lru_cache(maxsize=4)
def facing_in(placement: Placement, outlines: Outlines) -> Facing:
    """Outlines as they are compared, in a placement of theirs; kept, as extremes need the cells of even positions."""
    return facing_outlines(outlines.driving_mm, outlines.driven_mm, placement)


@dataclass(frozen=True, eq=False)
class AsWritten:
    """Contact of written outlines at n positions.

    ``pushing_rad`` and ``back_rad`` are the driven angles beyond the law's at which pushing flanks and their backs
    touch; ``overlap_mm`` is the depth of the outlines' overlap at the law's angle, shape (n,) each.
    ``driving_tips_mm`` and ``driven_tips_mm`` are the least clearances of these gears' tip lands over the other gear's
    root lands, infinite where no tip land stands over a root land.  After ``repeat`` positions, perhaps all, the
    outlines meet as at first: only these were compared.
    """

    source: str
    pushing_rad: Array
    back_rad: Array
    overlap_mm: Array
    driving_tips_mm: float
    driven_tips_mm: float
    repeat: int

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of the driven angle at which pushing flanks touch."""
        return float(np.ptp(self.pushing_rad))

    @property
    def backlash_rad(self) -> Array:
        """Play of the driven gear at each position, shape (n,); negative where the teeth have no room."""
        return self.back_rad - self.pushing_rad


def as_written(outlines: Outlines, teeth: ToothedPair, placement: Placement, reach_mm: float) -> AsWritten:
    """Contact of outlines up to ``reach_mm`` from the pitch point; raises NoSuchMechanism where they do not reach."""
    facing = facing_in(placement, outlines)
    first = placement.beginning(placement.repeat(facing.driving[::-1], facing.driven))
    play = outline_play(facing, first, reach_mm)
    tips = _tip_clearances(outlines, teeth, first)
    require_reached(outlines, play, *tips)
    bounds = placement.bounds_rad(play.up_rad, play.down_rad)
    pushing, back, overlap = (np.resize(values, placement.count) for values in (*bounds, play.overlap_mm))
    return AsWritten(outlines.source, pushing, back, overlap, *tips, first.count)


def require_reached(outlines: Outlines, play: WrittenPlay, *tips_mm: float) -> None:
    """Raise NoSuchMechanism where outlines do not touch, or a normal meets no outline (a clearance is NaN)."""
    if not (np.isfinite(play.up_rad).all() and np.isfinite(play.down_rad).all()) or np.isnan(tips_mm).any():
        raise NoSuchMechanism(
            f"the outlines written as {outlines.source} do not reach each other at some angles; less backlash_mm, "
            "taller teeth (rack), or a smaller chord_tolerance_mm are needed",
            key="gears.teeth",
        )


PER_CHORD = 2
"""Places of a land per chord, from which the nearest place is searched: between two vertices lands part or near each
other evenly, apart from the turning of a chord."""

INSET = 1e-9
"""Share of a land left out at its ends, so that no rounding error leads to a flank."""

UNMET_MM = 1e9
"""Nearness of no outline; finite, so that differences are numbers."""

BEYOND_TEETH = 1.5
"""Normals are followed to this many times the greatest height or depth of teeth."""


def _tip_clearances(outlines: Outlines, teeth: ToothedPair, placement: Placement) -> tuple[float, float]:
    """Least clearance in mm of the driving gear's tips and of the driven gear's, tooth over space.

    Driving tooth n stands in the driven space before driven tooth n, driven tooth n in the space after driving tooth n.
    """
    number = np.arange(round(placement.count / placement.per_tooth))
    if placement.toothed is not None:
        # Both teeth of a meeting, and of the meeting before, are made.
        number = np.arange(1, min(teeth.driving.teeth, teeth.driven.teeth))
    own, other = number % teeth.driving.teeth, number % teeth.driven.teeth
    before = (number - 1) % teeth.driven.teeth
    driving, driven = (outlines.driving_mm, teeth.driving), (outlines.driven_mm, teeth.driven)
    return _least_clearance(driving, own, driven, before), _least_clearance(driven, other, driving, own)


Written = tuple[Array, ToothedGear]
"""A gear's outline as written, and the gear."""


def _least_clearance(tips: Written, tooth: IndexArray, roots: Written, space: IndexArray) -> float:
    """Least distance of tip lands from root lands below them; inf without such lands, NaN where a land is not met."""
    (tip_mm, gear), (root_mm, mate) = tips, roots
    crossing, after = gear.flanks.crossing_mm.reshape(-1, 2), mate.flanks.crossing_mm
    following = np.append(after[2::2], after[0] + mate.flanks.curve.length_mm)
    ahead = ((after[1::2] + following) / 2.0)[space] - crossing.mean(axis=1)[tooth]
    first, last = gear.sides.tip_mm.reshape(-1, 2)[tooth].T
    begin, end = (mate.sides.roots.feet()[0][space] - ahead[:, None]).T
    low, high = np.maximum(first, begin), np.minimum(last, end)
    over = np.flatnonzero(high > low)
    if not over.size:
        return np.inf
    low, high, ahead = low[over], high[over], ahead[over]
    of_tip, of_root = _along_normals(tip_mm, gear.flanks, 1.0), _along_normals(root_mm, mate.flanks, -1.0)

    def nearness(land: IndexArray, share: Array) -> Array:
        """The negative clearance; UNMET_MM where an outline is not met."""
        at = low[land] + (high - low)[land] * np.clip(share, INSET, 1.0 - INSET)
        depth, height = of_root(at + ahead[land]), of_tip(at)
        met = np.isfinite(height) & np.isfinite(depth)
        return np.where(met, height - depth, UNMET_MM)

    each = np.arange(over.size)
    # Lands lie end to end, each as long as the straight bridge that leads from it to the next land.
    ends = np.stack([nearness(each, np.full(over.size, end)) for end in (0.0, 1.0)], axis=1).ravel()

    def chained(places: Array) -> Array:
        land = np.minimum(places // 2.0, over.size - 1).astype(int)
        found, on = np.interp(places, np.arange(ends.size), ends), places - 2.0 * land < 1.0
        found[on] = nearness(land[on], (places - 2.0 * land)[on])
        return found[None]

    chords = _chords(tip_mm, gear.flanks, low, high) + _chords(root_mm, mate.flanks, low + ahead, high + ahead)
    land, place = counted_up(np.zeros_like(chords), PER_CHORD * chords + 1)
    places = 2.0 * land + place / np.asarray(PER_CHORD * chords[land], dtype=float)
    (nearest,) = largest_of_each(chained, places)
    return -nearest.value if nearest.value < UNMET_MM else np.nan


def _chords(outline_mm: Array, flanks: Flanks, low_mm: Array, high_mm: Array) -> IndexArray:
    """Numbers of an outline's chords, and a few more, over stretches between two rolled lengths, shape (n,) each."""
    ends = np.stack([as_complex(flanks.curve.at_length(at).position) for at in (low_mm, high_mm)])
    half = np.angle(ends[1] / ends[0]) / 2.0
    return polar_outline(as_complex(outline_mm)).windows(np.angle(ends[0]) + half, np.abs(half))[1]


def _along_normals(outline_mm: Array, flanks: Flanks, sense: float) -> Callable[[Array], Array]:
    """Distances from the pitch curve at rolled lengths to the outline along ``sense`` (n,); inf where it is missed."""
    outline = as_complex(outline_mm)
    around = polar_outline(outline)
    reach = BEYOND_TEETH * max(float(np.max(flanks.tip_height_mm)), float(np.max(flanks.root_depth_mm)))

    def distance(sigma_mm: Array) -> Array:
        at = flanks.curve.at_length(sigma_mm)
        origin, direction = as_complex(at.position), sense * as_complex(at.normal)
        width = np.arcsin(np.minimum(reach / np.abs(origin), 1.0))
        first, count = around.windows(np.angle(origin), width)
        row, vertex = counted_up(first, count + 1)
        arm = outline[vertex % outline.size] - origin[row]
        side = across(direction[row], arm)
        before = np.flatnonzero(((side[:-1] < 0.0) != (side[1:] < 0.0)) & (row[:-1] == row[1:]))
        row, share = row[before], side[before] / (side[before] - side[before + 1])
        away = along(direction[row], arm[before] + share * (arm[before + 1] - arm[before]))
        least = np.full(sigma_mm.size, np.inf)
        np.minimum.at(least, row, np.where(away > 0.0, away, np.inf))
        return least

    return distance


BEYOND = 1.1
"""Outlines are compared by a tenth farther than flanks can touch, for contact of edges."""

BOWL = 2.5
"""Factor on the distance at which tips can foul where a pitch curve is concave: teeth enter such a bowl two or three
pitches away from the pitch point."""

POSITIONS = 64
"""Positions over a period of the law at which the tip curves are compared; they vary smoothly between them."""

POINTS_PER_TOOTH = 8
"""Points of a tip curve per tooth: the reach may miss an eighth of a pitch, far less than its margin."""


def reach_mm(pitch: PitchPair, teeth: ToothedPair) -> float:
    """Distance from the pitch point in mm within which outlines must be compared."""
    both = teeth.driving.flanks, teeth.driven.flanks
    highest = max(max(flanks.rack.dedendum_mm, float(flanks.full_tip_mm.max())) for flanks in both)
    action = highest / sin(min(both[0].rack.angles_rad))
    if pitch.mesh is Mesh.INTERNAL:
        return BEYOND * max(action, tips_overlap_mm(pitch, teeth))
    return BEYOND * action * (1.0 if all(pitch.convex(gear) for gear in Gear) else BOWL)


def tips_overlap_mm(pitch: PitchPair, teeth: ToothedPair) -> float:
    """Largest distance from the pitch point at which the driving tip curve of an internal pair passes the ring's."""
    phi1 = np.linspace(0.0, pitch.transmission.lobes.driving_period_rad, POSITIONS)
    tips = _tip_curve(teeth.driving)
    beyond = passed_mm(tips, _tip_curve(teeth.driven), pitch.driving, phi1) > 0.0
    from_pitch_point = np.abs(tips * np.exp(1j * phi1[:, None]) - pitch.pitch_point_mm(phi1)[:, None])
    return float(np.max(from_pitch_point, where=beyond, initial=0.0))


def _tip_curve(gear: ToothedGear) -> ComplexArray:
    """The curve of tips of full height all around a gear, in mm in its own frame, shape (n,)."""
    sigma = np.linspace(0.0, gear.flanks.curve.length_mm, POINTS_PER_TOOTH * gear.teeth, endpoint=False)
    return as_complex(gear.flanks.offset(sigma, float(gear.flanks.full_tip_mm.max()))[0])
