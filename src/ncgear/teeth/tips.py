"""The greatest heights of tips, tooth by tooth, for exact, free and not pointed flanks.

A tip is shortened where its flank would end in a cusp (on a concave stretch), where it would reach below the regular
part of the mate's flank (it would undercut the mate) or below the depth of the mate's space (it would foul the fillet:
secondary interference), and where its land would be narrower than wanted.
"""

from __future__ import annotations

from dataclasses import replace
from enum import IntEnum
from math import degrees

import numpy as np

from ncgear.errors import NoSuchMechanism, RefusedAt, searched_for
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import refined_crossings
from ncgear.numerics.plane import across, along, as_complex, turned
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch.curve import LEAST_SHARE, nearest
from ncgear.teeth.flank import Flanks, flank_name
from ncgear.teeth.regular import CLEAR_OF_CUSPS, regular_height
from ncgear.teeth.tool import AGREEMENT

HALFWAY = 0.5
"""Share of the tip's height: the pitch curve's curvature on the way to it stands for the whole way."""

PROBES = 17
"""Points on the way to a crossing at which the flank must be regular, where bounds of the curvature do not prove it;
fitted tips are compared with the exact cusp."""

FAR, FARTHEST = 3.0, 8.0
"""Flanks are followed up to the first number of tip heights; flanks of low tips step by step up to the second number,
but no farther than flanks of full tips.  On a circle they lean so much that they reach the tip land within 2; where the
curvature changes on the way they may need more."""

LOWEST = 0.05
"""Start of the search for the height of the least land, as a share of a pointed tip's height."""

ROUNDING = 1e-14
"""Share of a height just above the rounding errors of its products."""

MOST_SLOPE = 0.25
"""Largest rise from edge to edge of a tip, in widths of its level land: beyond it the higher edge would be sharp."""


class Limit(IntEnum):
    """The limit of the height of a tooth's tip; where two apply, the greater number counts."""

    FULL = 0
    SLOPE = 1
    FILLET = 2
    UNDERCUT = 3
    CUSP = 4
    LAND = 5
    FOULING = 6
    HELIX = 7
    OTHER_MESH = 8


@dataclass(frozen=True, eq=False)
class Bounds:
    """The bounds of each flank by its mate, shape (2 z,).

    ``contact_mm`` is the greatest height of contact over the pitch line, ``tip_mm`` the height of the tip land, and
    ``regular_mm`` the height up to which the flank itself is regular, if it is less than the contact's; ``undercut``
    marks flanks whose bound comes from a mate that a tool of full depth would undercut.
    """

    contact_mm: Array
    tip_mm: Array
    regular_mm: Array
    undercut: Mask


@dataclass(frozen=True, eq=False)
class Tips:
    """The ends of the tips of all flanks, and their limits; shape (2 z,).

    ``height_mm`` is the contact's height over the pitch line at the end of the flank, ``at_mm`` the arc length under
    the tip's edge, and ``limit`` the ``Limit`` of the tip's height.  ``undercut`` marks flanks that a tool of full
    depth undercuts.  ``met_depth_mm`` is the depth below the pitch line to which the mates' tips touch each flank.
    """

    flanks: Flanks
    height_mm: Array
    at_mm: Array
    limit: IndexArray
    undercut: Mask
    met_depth_mm: Array


@dataclass(frozen=True, eq=False)
class _Edges:
    """Tip lands of all flanks, and the places where flanks reach them, from ``tip_crossing``; shape (2 z,)."""

    flanks: Flanks
    top_mm: Array
    at_mm: Array
    met: Mask

    def moved(self, height_mm: Array) -> _Edges:
        """The edges of tips of other heights; only changed edges are computed."""
        moved = np.nonzero(height_mm != self.flanks.tip_height_mm)[0]
        if not moved.size:
            return self
        return self.placed(height_mm, moved, tip_crossing(self.flanks.with_tips(height_mm), moved))

    def placed(self, height_mm: Array, rows: IndexArray, found: tuple[Array, Array, Mask]) -> _Edges:
        """The edges of tips of other heights; the edges of ``rows`` are as found."""
        known = self.top_mm.copy(), self.at_mm.copy(), self.met.copy()
        for values, new in zip(known, found, strict=True):
            values[rows] = new
        return _Edges(self.flanks.with_tips(height_mm), *known)


def bounded(own: Flanks, contact_mm: Array, tip_mm: Array, undercut: Mask) -> Bounds:
    """The bounds of flanks, with their regular heights, which are computed here."""
    # A little higher, so that rounding does not end a fully regular flank in a cusp.
    limit = np.maximum(contact_mm, 0.0) * (1.0 + ROUNDING) / CLEAR_OF_CUSPS
    return Bounds(contact_mm, tip_mm, regular_height(own, limit), undercut)


def fitted_tips(flanks: Flanks, bounds: Bounds, undercut: Mask, least_land_mm: float) -> Tips:
    """Tips at the greatest heights that all bounds allow; raises NoSuchMechanism for a tooth without a tip."""
    height = np.minimum(flanks.tip_height_mm, bounds.tip_mm)
    reason = np.where(bounds.undercut, Limit.UNDERCUT, Limit.FILLET)
    limit = np.where(height < flanks.tip_height_mm, reason, Limit.FULL)
    regular = CLEAR_OF_CUSPS * bounds.regular_mm
    cusp = regular < bounds.contact_mm
    allowed = np.minimum(regular, bounds.contact_mm)
    flanks = flanks.with_tips(height)
    edges = _lowered(_Edges(flanks, *_newton_crossing(flanks.unturned, np.arange(flanks.count))), allowed)
    lowered = edges.flanks.tip_height_mm
    limit = np.where(lowered < height, np.where(cusp, Limit.CUSP, reason), limit)
    free = _within_play(edges)
    limit = np.where(free < lowered, np.maximum(limit, Limit.FILLET), limit)
    even = even_heights(flanks, free)
    limit = np.where(even < free, np.maximum(limit, Limit.SLOPE), limit)
    edges = edges.moved(even)
    edges, narrow = _with_lands(edges, least_land_mm)
    limit = np.where(narrow, Limit.LAND, limit)
    too_high = edges.top_mm > allowed + AGREEMENT * flanks.rack.module_mm
    lost = np.nonzero(~edges.met | (edges.flanks.tip_height_mm <= 0.0) | (edges.top_mm <= 0.0) | too_high)[0]
    if lost.size:
        raise no_tip(flanks, int(lost[0]))
    return Tips(edges.flanks, edges.top_mm, edges.at_mm, limit, undercut, np.full(flanks.count, np.inf))


def held_below(tips: Tips, ceiling_mm: Array, reason: Limit = Limit.OTHER_MESH) -> Tips:
    """The tips, lowered for a reason to a ceiling, (2 z,); raises NoSuchMechanism where no tip remains."""
    full = tips.flanks.tip_height_mm
    height = even_heights(tips.flanks, np.minimum(full, ceiling_mm))
    edges = _Edges(tips.flanks, tips.height_mm, tips.at_mm, np.ones(full.size, dtype=bool)).moved(height)
    if not edges.met.all():
        raise no_tip(edges.flanks, int(np.argmin(edges.met)))
    limit = np.where(height < full, reason, tips.limit)
    return replace(tips, flanks=edges.flanks, height_mm=edges.top_mm, at_mm=edges.at_mm, limit=limit)


def even_heights(flanks: Flanks, height: Array) -> Array:
    """Heights with the higher edge of each tip lowered where its land would slope too much."""
    low = np.repeat(height.reshape(-1, 2).min(axis=1), 2)
    if not np.any(height > low):
        return height
    level = _land(replace(flanks, tip_height_mm=low), np.arange(0, flanks.count, 2))
    return np.minimum(height, low + MOST_SLOPE * np.repeat(np.maximum(level, 0.0), 2))


CLEARANCE_SHARE = 0.5
"""Share of the rack's clearance that tips may take where they are higher at an end of the play."""


def _within_play(edges: _Edges) -> Array:
    """Tip heights, lowered where an edge is higher over the pitch curve at the other end of the play."""
    flanks, height = edges.flanks, edges.flanks.tip_height_mm
    if not flanks.is_turned:
        return height
    if not edges.met.all():
        raise no_tip(flanks, int(np.argmin(edges.met)))
    turn = flanks.turn_rad - flanks.turn_rad.reshape(-1, 2)[:, ::-1].ravel()
    edge = turned(flanks.offset(edges.at_mm, height)[0], turn)
    over = nearest(flanks.curve, edge, edges.at_mm, AGREEMENT * flanks.rack.module_mm)[1] - height
    allowed = CLEARANCE_SHARE * (flanks.rack.dedendum_mm - flanks.rack.addendum_mm)
    return height - np.maximum(over - allowed, 0.0)


def _lowered(edges: _Edges, allowed: Array) -> _Edges:
    """The edges of tips that are lowered to the allowed heights of contact where they are above them.

    A lowered tip ends as high over the pitch curve as its flank at the allowed height.  Where that place is beside the
    flank and over the curve, the flank reaches the tip there, and no crossing is searched.
    """
    flanks, height = edges.flanks, edges.flanks.tip_height_mm
    chosen = np.nonzero(~edges.met | (edges.top_mm > allowed))[0]
    sigma, distance = edge_over_curve(flanks, chosen, allowed[chosen])
    beside = np.abs(sigma - flanks.crossing_mm[chosen]) < flanks.rack.pitch_mm / 2.0
    known = beside & (distance > 0.0) & (distance < height[chosen])
    lost = chosen[~known & ~edges.met[chosen]]
    if lost.size:
        edges = edges.placed(height, lost, tip_crossing(flanks, lost))
    above = ~edges.met[chosen] | (edges.top_mm[chosen] > allowed[chosen])
    if np.isnan(distance[above]).any():
        raise no_tip(flanks, int(chosen[above & np.isnan(distance)][0]))
    rows, reached, lowered = chosen[known], height.copy(), height.copy()
    reached[rows] = distance[known]
    lowered[chosen[above]] = np.minimum(height[chosen], distance)[above]
    edges = edges.placed(reached, rows, (allowed[rows], sigma[known], np.ones(rows.size, dtype=bool)))
    return edges.moved(lowered)


def edge_over_curve(flanks: Flanks, flank: IndexArray, height: Array) -> tuple[Array, Array]:
    """Arc length of the pitch curve's point nearest to the contact of flanks at heights, and its distance; (n,)."""
    start = flanks.rolled_mm(flank, height) + flanks.side[flank] * height / flanks.slant.of(flank).tangent
    return nearest(flanks.curve, flanks.unturned.flank(flank, height)[0], start, AGREEMENT * flanks.rack.module_mm)


def tip_crossing(flanks: Flanks, chosen: IndexArray | None = None) -> tuple[Array, Array, Mask]:
    """Heights at which (chosen) flanks reach their tip lands, arc lengths there, and whether before cusps; (n,)."""
    which, flanks = np.arange(flanks.count) if chosen is None else chosen, flanks.unturned
    height, sigma, met = _newton_crossing(flanks, which)
    lost = np.nonzero(~met)[0]
    if lost.size:
        height[lost], sigma[lost], met[lost] = _crossing_below_cusp(flanks, which[lost])
    return height, sigma, met


def _newton_crossing(flanks: Flanks, which: IndexArray) -> tuple[Array, Array, Mask]:
    """Crossings by Newton's method; far away or beyond a cusp they do not count as met."""
    tip = flanks.tip_height_mm[which]
    height, sigma, met = refined_crossings(
        lambda h: flanks.flank(which, h),
        lambda s: flanks.offset(s, tip),
        *_crossing_on_circle(flanks, which),
        AGREEMENT * flanks.rack.module_mm,
    )
    return height, sigma, met & _before_cusps(flanks, which, height, sigma, tip)


def _before_cusps(flanks: Flanks, which: IndexArray, height: Array, sigma: Array, tip: Array) -> Mask:
    """Which flanks reach tips of heights ``tip`` near the flank, and at heights before any cusp; all of shape (n,)."""
    reach = flanks.rack.pitch_mm / 2.0
    before = (height > 0.0) & (height < FAR * tip) & (np.abs(sigma - flanks.crossing_mm[which]) < reach)
    near = np.nonzero(before)[0]
    doubtful = near[~flanks.surely_regular(which[near], height[near])]
    way = height[doubtful, None] * np.linspace(0.0, 1.0, PROBES)
    before[doubtful] = flanks.regularity(which[doubtful, None], way).min(axis=1) > 0.0
    return before


def _crossing_on_circle(flanks: Flanks, which: IndexArray) -> tuple[Array, Array]:
    """Approximate crossings of flanks and their tip lands: heights, and arc lengths of the tip lands.

    They are the crossings on circles with the pitch curve's curvature k on the way.  A circle's flank of height h is
    1 + h k radii up from the centre and h k cot(alpha) along, its tip land 1 + k tip radii off.  On a concave stretch a
    flank reaches the same height again beyond its cusp: the lower crossing is the right one.
    """
    slant, tip = flanks.slant.of(which), flanks.tip_height_mm[which]
    curvature = flanks.curve.curvature_at(flanks.rolled_mm(which, HALFWAY * tip))
    twice = tip * (2.0 + curvature * tip)
    height = twice / (1.0 + np.sqrt(np.maximum(1.0 + twice * curvature / slant.sine**2, 0.0)))
    along = height / slant.tangent / np.maximum(1.0 + height * curvature, LEAST_SHARE)
    # An arc with the tangent x is nearly x / (1 + x^2 / 3) of its radius.
    along /= 1.0 + (along * curvature) ** 2 / 3.0
    return height, flanks.rolled_mm(which, height) + flanks.side[which] * along


def _crossing_below_cusp(flanks: Flanks, which: IndexArray) -> tuple[Array, Array, Mask]:
    """The first crossings on the way from the pitch curve up to the cusps, by steps and then in brackets."""
    tip = flanks.tip_height_mm[which]
    far = np.clip(FAR * flanks.rack.tip_height_mm, FAR * tip, FARTHEST * tip)
    way = regular_height(flanks, np.maximum(far, 0.0), which)[:, None] * np.linspace(0.0, 1.0, PROBES)
    lost = np.zeros(which.size, dtype=bool)

    def excess(height: Array, row: IndexArray) -> Array:
        distance = edge_over_curve(flanks, which[row], height)[1] - tip[row]
        # Without a foot the search ends, and the flank does not count as met.
        lost[row] |= np.isnan(distance)
        return np.nan_to_num(distance)

    rows, height = np.nonzero(tip > 0.0)[0], np.full(which.size, np.nan)
    distance = edge_over_curve(flanks, np.repeat(which[rows], PROBES - 1), way[rows, 1:].ravel())[1].reshape(
        -1, PROBES - 1
    )
    # Without a foot on the way, the flank does not count as met.
    step = np.argmax(~(distance < tip[rows, None]), axis=1)
    met = distance[np.arange(rows.size), step] >= tip[rows]
    rows, step = rows[met], step[met]
    with searched_for(lambda row: flank_name(flanks, int(which[rows[row]])), "gears.teeth"):
        height[rows] = zeros_between(lambda trial: excess(trial, rows), way[rows, step], way[rows, step + 1])
    height[lost] = np.nan
    sigma = edge_over_curve(flanks, which, height)[0]
    return height, sigma, np.isfinite(height) & np.isfinite(sigma)


def _with_lands(edges: _Edges, least: float) -> tuple[_Edges, Mask]:
    """The edges of tips, lowered where their land is narrower than ``least``, and whether each tip was lowered."""
    flanks, height = edges.flanks, edges.flanks.tip_height_mm
    width = _width(flanks, np.arange(flanks.count), flanks.offset(edges.at_mm, height), edges.at_mm, edges.met)
    narrow = ~(width >= least)
    if not narrow.any():
        return edges, np.zeros(flanks.count, dtype=bool)
    back = 2 * np.nonzero(narrow)[0]
    most = np.full(flanks.count, np.inf)
    lands, found, met = _newton_lands(edges, back, least)
    lost = back[~met]
    if lost.size:
        lands[~met] = _height_of_land(flanks, lost, least, width[lost // 2])
    most[back] = most[back + 1] = lands
    wide, both = np.minimum(height, most), np.repeat(met, 2)
    chosen = np.column_stack([back, back + 1]).ravel()[both]
    known = np.where(np.isin(np.arange(flanks.count), chosen), wide, height)
    top, at = (values[both] for values in found)
    return edges.placed(known, chosen, (top, at, np.ones(chosen.size, dtype=bool))).moved(wide), most < height


STEPS = 12
"""Steps of Newton's method to the height of a land; five are usually enough."""


@np.errstate(all="ignore")
def _newton_lands(edges: _Edges, back: IndexArray, least: float) -> tuple[Array, tuple[Array, Array], Mask]:
    """As ``_height_of_land``, by Newton's method: heights, places of their edges, and whether each was found.

    They have shape (n,); the edges, which are heights of contact and arc lengths, have shape (2 n,).

    A tip's height and the crossings of both flanks with its land are unknowns together.  An edge as high as the tip
    moves by N for each mm of that height, N being the pitch curve's normal; a lower edge moves only along the land.
    The part of the play in a land's width hardly changes, and is left out of the slope.  Where no step succeeds,
    numbers diverge, and the height is not found.
    """
    flanks, both = edges.flanks, np.column_stack([back, back + 1]).ravel()
    own, plain, agreement = flanks.tip_height_mm[both], flanks.unturned, AGREEMENT * flanks.rack.module_mm
    high = own.reshape(-1, 2).max(axis=1)
    land, height, sigma = high, edges.top_mm[both], edges.at_mm[both]
    found = edges.met[both].reshape(-1, 2).all(axis=1)
    for _ in range(STEPS):
        tip = np.minimum(own, np.repeat(land, 2))
        over, (point, rise) = plain.offset(sigma, tip), map(as_complex, plain.flank(both, height))
        edge, ahead = map(as_complex, over)
        missing = _width(flanks, both, over, sigma, np.ones(both.size, dtype=bool)) - least
        gap, area = edge - point, across(rise, ahead)
        met = (np.abs(gap.reshape(-1, 2)) <= agreement).all(axis=1) & (np.abs(missing) <= agreement)
        if met[found].all():
            break
        outwards = np.where(own >= np.repeat(land, 2), as_complex(flanks.curve.at_length(sigma).normal), 0.0)
        # Newton's steps of both parameters: the step that closes the gap, and the step that follows the tip per mm of
        # its height.
        steps = [(across(way, ahead) / area, across(way, rise) / area) for way in (gap, outwards)]
        moved = steps[0][1] * ahead, steps[1][1] * ahead + outwards
        chord = np.repeat(np.diff(edge.reshape(-1, 2))[:, 0] * np.sign(np.diff(sigma.reshape(-1, 2))[:, 0]), 2)
        wider = [np.diff(along(chord / np.abs(chord), way).reshape(-1, 2))[:, 0] for way in moved]
        higher = np.clip(land - (missing + wider[0]) / wider[1], LOWEST * high, high) - land
        height, sigma = (
            here + at_once + each * np.repeat(higher, 2)
            for here, at_once, each in zip((height, sigma), *steps, strict=True)
        )
        land = land + higher
    found &= met & (land > LOWEST * high) & (land <= high)
    tip = np.minimum(own, np.repeat(land, 2))
    found &= _before_cusps(flanks, both, height, sigma, tip).reshape(-1, 2).all(axis=1)
    return land, (height, sigma), found


def _height_of_land(flanks: Flanks, back: IndexArray, least: float, known: Array) -> Array:
    """Greatest tip heights at which lands behind flanks ``back`` have the width ``least``; ``known`` at full height.

    Where an edge is hardly met, rounding may give another width next time: then the height is the least at which the
    edge is met.
    """

    def excess(height: Array) -> Array:
        most = np.full(flanks.count, np.inf)
        most[back] = most[back + 1] = height
        lower = replace(flanks, tip_height_mm=np.minimum(flanks.tip_height_mm, most))
        return _land(lower, back) - least

    high = np.maximum(flanks.tip_height_mm[back], flanks.tip_height_mm[back + 1])
    low = LOWEST * high
    thick = excess(low)
    if not np.all(thick > 0.0):
        raise no_tip(flanks, int(back[~(thick > 0.0)][0]))
    with searched_for(lambda row: flank_name(flanks, int(back[row])), "gears.teeth"):
        return zeros_between(excess, low, high, (thick, np.minimum(excess(high), known - least)))


def _land(flanks: Flanks, back: IndexArray) -> Array:
    both = np.column_stack([back, back + 1]).ravel()
    _, at, met = tip_crossing(flanks, both)
    return _width(flanks, both, flanks.offset(at, flanks.tip_height_mm[both]), at, met)


def _width(flanks: Flanks, both: IndexArray, land: tuple[Array, Array], at: Array, met: Mask) -> Array:
    """Width of tip lands in mm along the chord, negative where the flanks cross below the land.

    ``both`` are the back and the front flank of each of n lands in order, ``at`` the arc lengths where they reach the
    land, if they have ``met`` it, shape (2 n,), and ``land`` the points there and the land's derivatives.  Play moves
    the flanks along the curve, which makes the land narrower.
    """
    point, way = land
    edges = point.reshape(-1, 2, 2)
    width = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) * np.sign(np.diff(at.reshape(-1, 2), axis=1)[:, 0])
    if flanks.is_turned:
        moved = np.sum((turned(point, flanks.turn_rad[both]) - point) * way, axis=1) / np.linalg.norm(way, axis=1)
        width = width + np.diff(moved.reshape(-1, 2), axis=1)[:, 0]
    return np.where(met.reshape(-1, 2).all(axis=1), width, -np.inf)


def no_tip(flanks: Flanks, flank: int) -> NoSuchMechanism:
    """The error for a flank that cannot have a tip."""
    angle = flanks.rack.angles_rad[int(flanks.idle[flank])]
    crossing = float(flanks.crossing_mm[flank])
    k = float(flanks.curve.at_length(np.array(crossing)).curvature)
    mate = flanks.curve.mate_curvature(crossing)
    module = flanks.rack.module_mm
    hollow = f"; its mate is concave there, {mate * module:.3g} per module" if k >= 0.0 > mate else ""
    return RefusedAt(
        f"{flank_name(flanks, flank)} has no tip above the pitch curve that is regular and free of its mate (curvature "
        f"{k:.4g} 1/mm, {k * flanks.rack.module_mm:.3g} per module, pressure angle of "
        f"the rack {degrees(angle):g} deg){hollow}; more teeth of a smaller module are needed",
        phi1_rad=float(flanks.curve.driving_angle(flanks.crossing_mm[flank : flank + 1])[0]),
        key="gears.teeth",
    )
