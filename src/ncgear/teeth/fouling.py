"""Tips that meet away from the line of action: on concave stretches teeth enter their spaces from above, as in a ring.

The edge of a tip is followed in the mate's frame; where its path crosses a tooth of the mate above the pitch curve, the
edge is too high, and is lowered until its path just passes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import chord_crossings
from ncgear.teeth.flank import Flanks
from ncgear.teeth.tips import Limit, Tips, even_heights, no_tip, tip_crossing

Meeting = tuple[IndexArray, IndexArray]
"""Numbers of a gear's own flanks and of the mate's flanks that they meet."""

REACH = 6.0
"""Pitches rolled to either side within which tips are followed: the bowl of a concave stretch is a few teeth wide."""

NEIGHBOURS = 3
"""Teeth on either side of the mating one that an edge may run into on its way."""

PATH, FLANK_POINTS = 379, 33
"""Points of a tip's path and of a flank: chords stray from them by less than a five-thousandth of a module."""

ASIDE = 0.02
"""Share of a flank's height, from the pitch curve outwards, that is left out: there the flanks touch as they should."""

HALVINGS = 14
"""Halvings of the interval in which a tip's height is sought: to a 16 000th of it."""

FREE = 0.995
"""Share of the greatest free height that is used, for the chords' sake."""


def freed(own: Tips, mate: Tips, meeting: Meeting) -> Tips:
    """The gear with tips shortened that would run into the mate's on concave stretches; itself where none does.

    Raises NoSuchMechanism, naming the tooth, where none is left.
    """
    near = _beside_concave(own.flanks, mate.flanks, meeting)
    hit = _fouling(own.flanks, own.height_mm, mate, near)
    if not hit.any():
        return own
    flanks = _lowered(own, mate, near, hit)
    top, at, met = tip_crossing(flanks)
    if not met.all():
        raise no_tip(flanks, int(np.nonzero(~met)[0][0]))
    limit = np.where(flanks.tip_height_mm < own.flanks.tip_height_mm, Limit.FOULING, own.limit)
    return replace(own, flanks=flanks, height_mm=top, at_mm=at, limit=limit)


def _beside_concave(own: Flanks, mate: Flanks, meeting: Meeting) -> Meeting:
    """The meetings within reach of a concave stretch of either curve; there are no others where tips foul."""
    sigma = own.crossing_mm[meeting[0]][:, None] + own.rack.pitch_mm * np.linspace(-REACH, REACH, PATH // 8)
    concave = [np.any(flanks.curve.at_length(sigma).curvature < 0.0, axis=1) for flanks in (own, mate)]
    near = concave[0] | concave[1]
    return meeting[0][near], meeting[1][near]


def _lowered(own: Tips, mate: Tips, meeting: Meeting, hit: Mask) -> Flanks:
    """The flanks with the greatest tip heights, found by halving, at which none of those that hit does so."""
    full = own.flanks.tip_height_mm
    low, high = np.zeros_like(full), full.copy()
    rows = hit[meeting[0]]
    meeting = meeting[0][rows], meeting[1][rows]
    for _ in range(HALVINGS):
        trial = replace(own.flanks, tip_height_mm=np.where(hit, (low + high) / 2.0, full))
        fouls = _fouling(trial, tip_crossing(trial)[0], mate, meeting)
        low, high = np.where(fouls, low, trial.tip_height_mm), np.where(fouls, trial.tip_height_mm, high)
    return replace(own.flanks, tip_height_mm=even_heights(own.flanks, np.where(hit, FREE * low, full)))


def _fouling(flanks: Flanks, top: Array, mate: Tips, meeting: Meeting) -> Mask:
    """Which tip edges of a gear run into the mate's teeth at the meetings; shape (2 z,)."""
    own, other = meeting
    sigma = flanks.rolled_mm(own, top[own])[:, None] + flanks.rack.pitch_mm * np.linspace(-REACH, REACH, PATH)
    path = _in_mate(flanks, mate.flanks, flanks.flank(own, top[own])[0], sigma)
    hit, teeth = np.zeros(flanks.count, dtype=bool), _upper_teeth(mate)
    for neighbour in range(-NEIGHBOURS, NEIGHBOURS + 1):
        row, _, _ = chord_crossings(path, teeth[(other // 2 + neighbour) % len(teeth)])
        hit[own[row]] = True
    return hit


def _upper_teeth(gear: Tips) -> Array:
    """What stands of a gear's teeth above the pitch curve: back flank, land, front flank; shape (z, points, 2)."""
    share = np.linspace(ASIDE, 1.0, FLANK_POINTS)
    upper = gear.flanks.flank(np.arange(gear.flanks.count)[:, None], gear.height_mm[:, None] * share)[0]
    return np.concatenate([upper[::2], upper[1::2, ::-1]], axis=1)


def _in_mate(flanks: Flanks, mate: Flanks, point: Array, sigma: Array) -> Array:
    """Paths of points (shape (n, 2)) of a gear in its mate's frame at rolled lengths, shape (n, m, 2)."""
    at, there = flanks.curve.at_length(sigma), mate.curve.at_length(sigma)
    arm = point[:, None, :] - at.position
    along, outwards = np.sum(arm * at.tangent, axis=2), np.sum(arm * at.normal, axis=2)
    path: Array = there.position + along[..., None] * there.tangent - outwards[..., None] * there.normal
    return path
