"""Clearance as designed: distance of a gear's tips from the other gear's roots over the pitch point.

Tip and root lands are about parallel to the rolling pitch curves, so they share their normal over the pitch point.
There the corners of a tip are nearest to fillets; farther on they come into contact with flanks.

The ends of the teeth's sides give the end of the land at each flank, its width and its distance from the pitch curve.
So all this holds for tips of any height and roots of any depth.  A sloping land changes its height evenly from end to
end, so that a tip is nearest to a root at an end of their common part.
"""

from __future__ import annotations

import numpy as np

from ncgear.contact.designed.curves import SidePaths
from ncgear.contact.placement import BACK, PUSHING, Meetings
from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import across, as_complex, square
from ncgear.teeth.flank import flank_name
from ncgear.teeth.spaces import FOOT_IN_MODULES


@dataclass(frozen=True)
class TipClearance:
    """Least distances in mm of a gear's tips from the other's roots, negative where a tip is inside the other gear.

    ``over_root_mm`` is the distance of tips over root lands, infinite where no tip comes over a root land;
    ``from_fillet_mm`` is the distance of tips' corners from fillets.
    """

    over_root_mm: float
    from_fillet_mm: float


@dataclass(frozen=True, eq=False)
class _Facing:
    """Tips of one gear over roots of the other, at m pairs of flanks.

    ``flank`` (shape (m,)) numbers the flanks of the tips' gear, ``other`` (shape (m,)) the flanks of the roots' gear.
    ``lead_mm`` (shape (m,)) is the rolled length by which ``flank`` crosses the pitch point before ``other``, ``sense``
    (shape (m,)) the sense, +1 or -1 of the arc length, in which ``flank`` faces.
    """

    tips: SidePaths
    roots: SidePaths
    flank: IndexArray
    other: IndexArray
    lead_mm: Array
    sense: Array


def tip_clearances(
    driving: SidePaths, driven: SidePaths, met: Meetings
) -> tuple[tuple[TipClearance, TipClearance], tuple[TipClearance, TipClearance]]:
    """Clearance of the driving gear's tips and of the driven gear's, at pushing flanks, and the same at their backs."""
    lead = met.driven_ahead_mm[:, 0] - met.driving_ahead_mm[:, 0]
    both = (
        _Facing(driving, driven, met.driving, met.driven, lead, -met.urge),
        _Facing(driven, driving, met.driven, met.driving, -lead, met.urge),
    )
    of_driving, of_driven = (_tip_clearances(facing, met.side) for facing in both)
    return (of_driving[PUSHING], of_driven[PUSHING]), (of_driving[BACK], of_driven[BACK])


def _tip_clearances(facing: _Facing, side: IndexArray) -> tuple[TipClearance, TipClearance]:
    tips = _tip_lands(facing.tips)
    over_lands, over_fillets = _over_lands(facing, tips), _over_fillets(facing, tips)
    pushing, back = (
        TipClearance(float(over_lands[rows].min()), float(over_fillets[rows].min()))
        for rows in (side == PUSHING, side == BACK)
    )
    return pushing, back


def _over_lands(facing: _Facing, tips: _Lands) -> Array:
    """Distances of tip lands from root lands, infinite where the tip land does not come over the root land."""
    roots, back = _root_lands(facing.roots), -facing.sense
    tip, root = tips.of(facing.flank), roots.of(facing.other)
    tip_end = back * tip.from_crossing_mm
    root_end = back * (root.from_crossing_mm + facing.lead_mm)
    low, high = np.maximum(tip_end, root_end), np.minimum(tip_end + tip.width_mm, root_end + root.width_mm)
    nearest = [-root.height_at(place - root_end) - tip.height_at(place - tip_end) for place in (low, high)]
    return np.where(low <= high, np.minimum(*nearest), np.inf)


def _over_fillets(facing: _Facing, tips: _Lands) -> Array:
    """Distances of tip corners from fillets, infinite where there is no fillet."""
    flanks = facing.roots.flanks
    below = flanks.crossing_mm[facing.other] + tips.from_crossing_mm[facing.flank] - facing.lead_mm
    at = flanks.curve.at_length(below)
    corner = as_complex(at.position) - tips.height_mm[facing.flank] * as_complex(at.normal)
    standing = np.exp(1j * flanks.turn_rad[facing.other])
    return _from_fillets(facing.roots, facing.other, corner * standing, as_complex(at.position) * standing)


ZOOM = np.linspace(-1.0, 1.0, 9)

ZOOMS = 3
"""Places about a chord at which the nearest point of a fillet is searched, and rounds of the search, each a quarter as
wide as the round before.  The last width is a thousandth of a module, and the error of the distance is some millionths
of a module."""


def _from_fillets(paths: SidePaths, flank: IndexArray, point: ComplexArray, free: ComplexArray) -> Array:
    """Distances of points from the fillets of flanks, (n,), infinite where a flank has none.

    A distance is negative where the fillet is between the point and its place in ``free``, which lies outside the
    teeth.
    """
    fillet, away = paths.own_fillet[flank], square(paths.places[flank, :-1] - point[:, None])
    nearest, there = np.argmin(np.where(fillet, away, np.inf), axis=1), fillet.any(axis=1)
    distance = np.full(flank.size, np.inf)
    flank, point, free = flank[there], point[there], free[there]
    found, heading = _nearest(paths, (flank, nearest[there]), point)
    same = across(heading, point - found) * across(heading, free - found) >= 0.0
    distance[there] = np.where(same, 1.0, -1.0) * np.abs(point - found)
    return distance


def _nearest(
    paths: SidePaths, chord: tuple[IndexArray, IndexArray], point: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """The points of fillets, about the starts of chords, that are nearest to given points, and the slopes there."""
    run, number = paths.chord(*chord)
    owner, middle = paths.runs.owner[run][:, None], paths.parameter[run, number]
    every, reach = np.arange(run.size), np.abs(paths.parameter[run, number + 1] - middle)
    ends = np.sort([paths.runs.start[run], paths.runs.end[run]], axis=0)
    for _ in range(ZOOMS):
        parameter = np.clip(middle[:, None] + reach[:, None] * ZOOM, *ends[..., None])
        found, slope = (as_complex(array) for array in paths.flanks.fillet(owner, parameter))
        nearest = every, np.argmin(square(found - point[:, None]), axis=1)
        middle, reach = parameter[nearest], reach * (ZOOM[1] - ZOOM[0])
    return found[nearest], slope[nearest]


@dataclass(frozen=True, eq=False)
class _Lands:
    """The tip or root land at each of a gear's f flanks, shape (f,) each.

    ``from_crossing_mm`` is the arc length from the flank's crossing of the pitch curve to the land's end at this flank,
    ``width_mm`` the land's length along the pitch curve, ``height_mm`` its height over the pitch curve at this end and
    ``far_mm`` at the other end; heights are negative for roots.  Values are NaN where they were not found.
    """

    from_crossing_mm: Array
    width_mm: Array
    height_mm: Array
    far_mm: Array

    @classmethod
    def ending(cls, from_crossing_mm: Array, feet_mm: Array, height_mm: Array, first: int) -> _Lands:
        """Lands by feet and heights of both their ends, shape (n, 2); flank ``first`` is at the first end."""
        far, width = height_mm[:, ::-1], np.repeat(feet_mm[:, 1] - feet_mm[:, 0], 2)
        columns = (np.roll(values.ravel(), first) for values in (width, height_mm, far))
        return cls(from_crossing_mm, *columns)

    def of(self, flank: IndexArray) -> _Lands:
        """The lands at the given flanks."""
        return _Lands(*(values[flank] for values in vars(self).values()))

    def height_at(self, along_mm: Array) -> Array:
        """Heights at arc lengths from the ends at their flanks."""
        share = along_mm / np.where(self.width_mm > 0.0, self.width_mm, 1.0)
        return self.height_mm + (self.far_mm - self.height_mm) * share


def _tip_lands(paths: SidePaths) -> _Lands:
    """The tips of all teeth, pointed tips with no width; raises Unanswered where a point stands over no known place."""
    flanks, unturned = paths.flanks, paths.corner[:, 0] * np.exp(-1j * paths.flanks.turn_rad)
    foot, height = flanks.curve.feet(unturned, paths.sides.tip_mm, FOOT_IN_MODULES * flanks.rack.module_mm)
    if np.isnan(foot).any():
        name = flank_name(flanks, int(np.argmax(np.isnan(foot))))
        raise Unanswered(f"{name}: the foot of its tip on the pitch curve was not found")
    return _Lands.ending(foot - flanks.crossing_mm, foot.reshape(-1, 2), height.reshape(-1, 2), 0)


def _root_lands(paths: SidePaths) -> _Lands:
    """The roots of all spaces, as they are without play."""
    (feet, height), crossing = paths.sides.roots.feet(), paths.flanks.crossing_mm
    # The back flank of a space belongs to the next tooth, which for the last space is beyond the seam.
    beside = np.append(crossing[1:], crossing[0] + paths.flanks.curve.length_mm)
    return _Lands.ending(np.roll(feet.ravel() - beside, 1), feet, height, 1)
