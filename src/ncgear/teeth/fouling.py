"""Tips that meet the other teeth away from the line of action.

On concave stretches teeth enter their spaces from above, as in a ring.  The edge of a tip is followed in the mate's
frame; where its path crosses a tooth of the mate above the pitch curve, the edge is too high, and is lowered until its
path just passes.  With play this is done at both ends of the play: where the pushing flanks touch and where the idle
flanks touch.  Edges turned by the play are also checked against the bottoms of the mate's spaces: they reach places
that no tip reaches without play.

The tip of a pinion cutter may cut teeth in the same way on its way out of a space.  There nothing can be lowered: the
cutter is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, pi, sqrt

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import boxes, chord_crossings
from ncgear.numerics.plane import as_complex
from ncgear.pitch.curve import CurvePoints
from ncgear.teeth.flank import Flanks, flank_name
from ncgear.teeth.tips import Limit, Tips, edge_over_curve, even_heights, no_tip, tip_crossing
from ncgear.teeth.tool import AGREEMENT, PinionCircle

Mates = tuple[IndexArray, IndexArray]
"""Numbers of a gear's own flanks and of the mate's flanks that they meet."""

CLEAR = 1.5
"""Distance, in heights of both tips together, at which points that met count as clear; it covers tips that are raised
against undercut."""

PLACES = 4
"""Steps per pitch in the search for the rolled length after which tips are clear; a finer step hardly matters."""

NEIGHBOURS, SPACES_BESIDE = 3, 1
"""Teeth on either side of the mating tooth, and spaces beside its space, that a tip's edge may run into on its way."""

STEPS, FLANK_POINTS = 32, 33
"""Points of a tip's path per pitch, and of a flank: chords stray by less than a five-thousandth of a module."""

ASIDE = 0.02
"""Share of a flank's height, next to the pitch curve, that is not tested: there flanks touch as they should."""

HALVINGS = 14
"""Bisections in the search for a tip's height: to a 16 000th of the first interval."""

FREE = 0.995
"""Used share of the greatest free height; the rest is for the error of chords."""


@dataclass(frozen=True, eq=False)
class TipPaths:
    """The paths of tip edges in the mate's frame.

    ``own`` numbers flanks and ``other`` the mate's flanks that they meet, shape (meetings,) each; ``at`` and ``there``
    are the points of the gear's and of the mate's pitch curve that touch as they roll, shape (meetings, points).
    """

    own: IndexArray
    other: IndexArray
    at: CurvePoints
    there: CurvePoints

    def kept(self, rows: Mask) -> TipPaths:
        """The paths of the chosen meetings."""
        return TipPaths(self.own[rows], self.other[rows], self.at.kept(rows), self.there.kept(rows))

    def in_mate(self, edge: Array) -> Array:
        """Paths of edges, given by points of shape (meetings, 2), in the mate's frame; shape (meetings, points, 2)."""
        arm = edge[:, None, :] - self.at.position
        along, outwards = (
            arm[..., 0] * way[..., 0] + arm[..., 1] * way[..., 1] for way in (self.at.tangent, self.at.normal)
        )
        there = self.there
        return there.position + along[..., None] * there.tangent - outwards[..., None] * there.normal


Fouling = Callable[[Flanks, Array, TipPaths], Mask]
"""A function from flanks, heights of tips and tested paths to whether tips run into the mate; shape (2 z,)."""


def paths_near_concave(gears: tuple[Flanks, Flanks], mates: tuple[Mates, Mates]) -> tuple[TipPaths, TipPaths]:
    """Both gears' paths within reach of a concave stretch of either curve; tips foul nowhere else."""
    reach = _reach_mm(*gears)
    return _paths_near_concave(*gears, mates[0], reach), _paths_near_concave(*gears[::-1], mates[1], reach)


def _paths_near_concave(own: Flanks, mate: Flanks, mates: Mates, reach: float) -> TipPaths:
    crossing = own.crossing_mm[mates[0]]
    ends = crossing - reach, crossing + reach
    # Most paths are convex for certain on both curves, and need not be followed.
    least = np.min([flanks.curve.curvature_between(*ends)[0] for flanks in (own, mate)], axis=0)
    doubtful = np.nonzero(~(least >= 0.0))[0]
    rolled = np.linspace(-reach, reach, 2 * ceil(STEPS * reach / own.rack.pitch_mm) + 1)
    sigma = crossing[doubtful, None] + rolled
    # Flanks that stand whole pitches apart roll over the same places, but for rounding.
    alike = np.round(sigma.ravel() / (AGREEMENT * own.rack.module_mm))
    _, first, number = np.unique(alike, return_index=True, return_inverse=True)
    at, there = (flanks.curve.at_length(sigma.ravel()[first]) for flanks in (own, mate))
    number = number.reshape(sigma.shape)
    concave = np.any(((at.curvature < 0.0) | (there.curvature < 0.0))[number], axis=1)
    doubtful, number = doubtful[concave], number[concave]
    return TipPaths(mates[0][doubtful], mates[1][doubtful], at.kept(number), there.kept(number))


def _reach_mm(own: Flanks, mate: Flanks) -> float:
    """Rolled length after which tips that met on a concave stretch are clear, half a turn of either gear at most."""
    pitch, most = own.rack.pitch_mm, min(own.curve.length_mm, mate.curve.length_mm) / 2.0
    sigma = np.arange(0.0, max(own.curve.length_mm, mate.curve.length_mm), pitch / PLACES)
    concave = [flanks.curve.curvature_at(sigma) < 0.0 for flanks in (own, mate)]
    met = sigma[np.any(concave, axis=0)]
    far = CLEAR * (float(np.max(own.tip_height_mm)) + float(np.max(mate.tip_height_mm)))
    rolled = pitch
    while rolled < most and np.any(_parted_mm(own, mate, met, np.array([-rolled, rolled])) < far):
        rolled += pitch / PLACES
    return min(rolled, most)


def _parted_mm(own: Flanks, mate: Flanks, met: Array, rolled: Array) -> Array:
    """Distance, after further rolling, of points of both pitch curves that met at arc lengths; shape (met, rolled)."""
    sigma, apart = met[:, None] + rolled, []
    for flanks in (own, mate):
        at, here = flanks.curve.at_length(sigma), as_complex(flanks.curve.at_length(met).position)
        apart.append((here[:, None] - as_complex(at.position)) * as_complex(at.tangent).conj())
    return np.abs(apart[0] - apart[1])


def freed(own: Tips, mate: Tips, paths: TipPaths) -> Tips:
    """The gear with tips that foul no tooth of the mate on concave stretches; raises NoSuchMechanism without one."""
    height = mate.height_mm[:, None] * np.linspace(ASIDE, 1.0, FLANK_POINTS)
    with_play = own.flanks.is_turned or mate.flanks.is_turned
    teeth = [_teeth(stand, height) for stand in _stands(mate.flanks)[: 1 + with_play]]
    return _free_of(own, paths, lambda flanks, top, near: _fouling(flanks, top, near, teeth))


def freed_of_bottoms(own: Tips, mate: Flanks, paths: TipPaths) -> Tips:
    """The gear with tips that play turns into no bottom of the mate; raises NoSuchMechanism if none remains."""
    if not own.flanks.is_turned:
        return own
    spaces = [_spaces(stand) for stand in _stands(mate)]
    return _free_of(own, paths, lambda flanks, top, near: _in_bottoms(flanks, top, near, spaces))


def _free_of(own: Tips, paths: TipPaths, fouling: Fouling) -> Tips:
    hit = fouling(own.flanks, own.height_mm, paths)
    if not hit.any():
        return own
    flanks = _lowered(own, paths.kept(hit[paths.own]), fouling, hit)
    top, at, met = tip_crossing(flanks)
    if not met.all():
        raise no_tip(flanks, int(np.nonzero(~met)[0][0]))
    limit = np.where(flanks.tip_height_mm < own.flanks.tip_height_mm, np.maximum(own.limit, Limit.SLOPE), own.limit)
    limit = np.where(hit, Limit.FOULING, limit)
    return replace(own, flanks=flanks, height_mm=top, at_mm=at, limit=limit)


def _stands(flanks: Flanks) -> tuple[Flanks, Flanks]:
    return flanks, flanks.pulling


def _lowered(own: Tips, paths: TipPaths, fouling: Fouling, hit: Mask) -> Flanks:
    """The flanks, with the tips that ``hit`` lowered to the greatest heights without fouling, by bisection of edges."""
    low, high = np.zeros_like(own.height_mm), own.height_mm
    for _ in range(HALVINGS):
        edge = (low + high) / 2.0
        fouls = fouling(own.flanks, edge, paths)
        low, high = np.where(fouls, low, edge), np.where(fouls, edge, high)
    chosen, height = np.nonzero(hit)[0], own.flanks.tip_height_mm.copy()
    height[chosen] = np.minimum(height[chosen], FREE * edge_over_curve(own.flanks, chosen, low[chosen])[1])
    return replace(own.flanks, tip_height_mm=even_heights(own.flanks, height))


def _fouling(flanks: Flanks, top: Array, paths: TipPaths, teeth: list[Array]) -> Mask:
    """Which tip edges at heights ``top`` run into the mate's teeth, by positions of ``_stands``; shape (2 z,)."""
    hit = np.zeros(flanks.count, dtype=bool)
    for stand, mating in zip(_stands(flanks)[: len(teeth)], teeth, strict=True):
        hit[_edges_in(stand, top, paths, mating, paths.other // 2, NEIGHBOURS)] = True
    return hit


def _in_bottoms(flanks: Flanks, top: Array, paths: TipPaths, spaces: list[Array]) -> Mask:
    """Which tip edges at heights ``top`` run into the mate's spaces, by positions of ``_stands``; shape (2 z,).

    Only turned edges are looked at: others touch the mate's flank and leave it along the fillet.
    """
    hit = np.zeros(flanks.count, dtype=bool)
    for stand, mating in zip(_stands(flanks), spaces, strict=True):
        moved = paths.kept(stand.turn_rad[paths.own] != 0.0)
        hit[_edges_in(stand, top, moved, mating, (moved.other - 1) // 2, SPACES_BESIDE)] = True
    return hit


def _edges_in(
    stand: Flanks, top: Array, paths: TipPaths, outlines: Array, number: IndexArray, beside: int
) -> IndexArray:
    """Whether tip edges, at heights ``top``, run into the outline with their path's number or into its neighbours."""
    path = paths.in_mate(stand.flank(paths.own, top[paths.own])[0])
    return paths.own[_running_into(path, outlines, number, beside)]


def _running_into(path: Array, teeth: Array, tooth: IndexArray, neighbours: int) -> Mask:
    """Which of n paths cross the tooth of their number (from 0) or a neighbour on either side of it; shape (n,)."""
    hit = np.zeros(len(path), dtype=bool)
    beside = (tooth[:, None] + np.arange(-neighbours, neighbours + 1)) % len(teeth)
    # Most teeth are out of reach: their boxes do not meet the path's.
    (low, high), (least, most) = boxes(path), boxes(teeth)
    near = np.all((high[:, None] >= least[beside]) & (low[:, None] <= most[beside]), axis=2)
    row, column = np.nonzero(near)
    hit[row[chord_crossings(path[row], teeth[beside[row, column]])[0]]] = True
    return hit


def _teeth(flanks: Flanks, height: Array) -> Array:
    """Outlines of teeth, up the back flank and down the front flank; shape (z, 2 m, 2) from heights (2 z, m)."""
    side = flanks.flank(np.arange(flanks.count)[:, None], height)[0]
    return np.concatenate([side[::2], side[1::2, ::-1]], axis=1)


def _spaces(flanks: Flanks) -> Array:
    """Outlines of spaces from the pitch curve down, after each tooth, shape (z, m, 2), as far as fillets are round."""
    every, share = np.arange(flanks.count)[:, None], np.linspace(0.0, 1.0, FLANK_POINTS)
    depth = flanks.flank_depth_mm[:, None]
    start = flanks.rolled_mm(every, -depth)
    fillet = start + (flanks.rounding.lowest_mm[:, None] - start) * share
    side = np.concatenate([flanks.flank(every, -depth * share)[0], flanks.fillet(every, fillet)[0]], axis=1)
    return np.concatenate([side[1::2], np.roll(side[::2, ::-1], -1, axis=0)], axis=1)


CUTTER_PROBES = 25
"""Points on a flank that a pinion cutter's tip might cut."""

CUTTER_STEPS = 12
"""Points per pitch of a cutter tip's path."""

TANGENT = 0.15
"""Pitches after the end of the flank in which the cutter's tip is not tested: there it is still tangent."""

BEYOND = 1.2
"""Way over which the cutter's tip is followed, as a share of its way out of the space in the sharpest hollow."""

CUTTER_NEIGHBOURS = 2
"""Teeth on either side of a space whose tips the cutter may cut on its way."""


def refuse_fouling_cutter(tips: Tips) -> None:
    """Refuse a pinion cutter whose tip cuts teeth on its way out; raises NoSuchMechanism for the first flank."""
    cut = np.nonzero(_cut_on_way_out(tips))[0]
    if cut.size:
        raise NoSuchMechanism(
            f"the pinion cutter's tip cuts {flank_name(tips.flanks, int(cut[0]))} on its way out of the space; fewer "
            "cutter teeth, or kind: mate, are needed",
            key="gears.cutter.teeth",
        )


def _cut_on_way_out(tips: Tips) -> Mask:
    """Whether the tip of a pinion cutter, beside each flank, cuts teeth on its way out of the space; shape (2 z,)."""
    flanks, every = tips.flanks.unturned, np.arange(tips.flanks.count)
    pitch, length = flanks.rack.pitch_mm, _way_out_mm(tips)
    start = flanks.rolled_mm(every, -flanks.flank_depth_mm)
    rolled = np.linspace(TANGENT * pitch, length, ceil(CUTTER_STEPS * length / pitch))
    path = flanks.fillet(every[:, None], start[:, None] + flanks.side[:, None] * rolled)[0]
    share = np.linspace(0.0, 1.0, CUTTER_PROBES)
    working = -flanks.flank_depth_mm[:, None] * (1.0 - share) + tips.height_mm[:, None] * share
    return _running_into(path, _teeth(flanks, working), every // 2, CUTTER_NEIGHBOURS)


def _way_out_mm(tips: Tips) -> float:
    """Rolled length until a cutter tooth is out of its space, rising by s^2 / 2 per difference of curvatures."""
    flanks, tool = tips.flanks, tips.flanks.tool
    assert isinstance(tool, PinionCircle)
    depth = float(np.max(flanks.root_depth_mm) + np.max(flanks.tip_height_mm))
    turning = 1.0 / tool.radius_mm + flanks.curve.curvature_bounds[0]
    half_turn = pi * tool.radius_mm
    return half_turn if turning <= 0.0 else min(half_turn, BEYOND * sqrt(2.0 * depth / turning))
