"""Extreme values of the contact of written outlines, between the positions of the table as well.

A vertex that comes to a chord, or leaves it, is a kink of the play; there are more of them than positions.  From the
even positions the search closes in on each extreme.  Between them outlines are compared in the middle of their play:
both sides are near, and where there is play nothing overlaps.  Where they overlap, the law's angle is compared, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ncgear.contact.designed.as_designed import ALIKE_RAD, AsDesigned, touch_at
from ncgear.contact.designed.extremes import ValueRange, at_angles, over_cycle, ranges_of
from ncgear.contact.placement import Placement, placed_at
from ncgear.contact.written.as_written import AsWritten, Outlines, facing_in, require_reached
from ncgear.contact.written.play import outline_play
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_from
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair

KNOWN = 1e-2
"""Largest error of an extreme as a share of its variation over the cycle: a fiftieth of a chord tolerance, since
outlines vary by about two tolerances."""


FINEST_MM = 1e-4
"""Largest error in mm at the pitch point of the extremes of measured outlines: no point is known better than to a tenth
of a micrometre, and the outlines through them have kinks of that size everywhere."""


@dataclass(frozen=True)
class PlayExtremes:
    """Extremes over a whole cycle, ``at`` driving angles in rad; quantities as in ``AsWritten``.

    ``tightest_teeth`` are the numbers of the driving and the driven tooth at the pitch point where the play is least.
    """

    pushing_rad: ValueRange
    back_rad: ValueRange
    backlash_rad: ValueRange
    tightest_teeth: tuple[int, int]

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of the driven angle at which pushing flanks touch."""
        return self.pushing_rad.width


@dataclass(frozen=True)
class WrittenExtremes(PlayExtremes):
    """Extremes of outlines beside the exact teeth, ``at`` driving angles in rad.

    ``from_design_rad`` is the largest angle between the contacts of the outlines and of the exact teeth, on either side
    of the teeth.  ``overlap_mm`` is 0 where outlines never overlap; ``overlap_teeth`` are the numbers of the driving
    and the driven tooth at the pitch point where they overlap most.
    """

    from_design_rad: Extremum
    overlap_mm: Extremum
    overlap_teeth: tuple[int, int]


Touched = tuple[Placement, Array, Array]
"""Positions, the driven angles beyond the law's at which pushing flanks and backs touch, shape (2, n), and overlaps."""


def play_extremes(
    outlines: Outlines, pitch: PitchPair, known: AsWritten, even: Placement, reach_mm: float
) -> PlayExtremes:
    """The extremes of measured outlines, contact ``known`` at ``even`` positions; raises as ``as_written``."""
    touched = _touched_at(outlines, pitch, known, even, reach_mm)
    finest_rad = FINEST_MM / float(even.driven_radius_mm.min())
    found = _largest(lambda rolled: _ranged(touched(rolled)[1]), even, _ranged(_both_sides(known)), finest_rad)
    return PlayExtremes(*_play_of(pitch, even, found))


def written_extremes(
    outlines: Outlines, pitch: PitchPair, teeth: ToothedPair, known: AsWritten, designed: AsDesigned, reach_mm: float
) -> WrittenExtremes:
    """The extremes of outlines, contact ``known`` at the positions of ``designed``; raises as ``as_written``."""
    even, errors_at = designed.placement, _errors_at(pitch, teeth, designed)
    touched = _touched_at(outlines, pitch, known, even, reach_mm)
    found = _largest(
        lambda rolled: _quantities(touched(rolled), errors_at(rolled)),
        even,
        _quantities((even, _both_sides(known), known.overlap_mm), errors_at(even.rolled_mm)),
    )
    astray, deepest = at_angles(pitch, even, found[-2:])
    overlap = replace(deepest, value=max(deepest.value, 0.0))
    return WrittenExtremes(*_play_of(pitch, even, found[:-2]), astray, overlap, _teeth_at(pitch, even, found[-1]))


def may_overlap(
    allowed_mm: float, outlines: Outlines, pitch: PitchPair, known: AsWritten, even: Placement, reach_mm: float
) -> bool:
    """Whether outlines, contact ``known`` at ``even`` positions, overlap by more than is allowed anywhere."""
    touched, at_even = _touched_at(outlines, pitch, known, even, reach_mm), (even, _both_sides(known), known.overlap_mm)
    (most,) = _largest(lambda rolled: _overlap(touched(rolled))[None], even, _overlap(at_even)[None], above=allowed_mm)
    return most.value > allowed_mm


def _largest(
    quantities: Callable[[Array], Array],
    even: Placement,
    known: Array,
    finest: float = ALIKE_RAD,
    above: float = -np.inf,
) -> list[Extremum]:
    """The largest values of quantities at rolled lengths, from values at even positions, shape (q, n)."""
    rolled, values = over_cycle(even, known)
    return largest_from(quantities, rolled, values, np.maximum(KNOWN * np.ptp(values, axis=1), finest), above)


def _play_of(
    pitch: PitchPair, even: Placement, found: Sequence[Extremum]
) -> tuple[ValueRange, ValueRange, ValueRange, tuple[int, int]]:
    pushing, back, backlash = ranges_of(at_angles(pitch, even, found))
    return pushing, back, backlash, _teeth_at(pitch, even, found[-1])


def _teeth_at(pitch: PitchPair, even: Placement, found: Extremum) -> tuple[int, int]:
    return placed_at(pitch, even, np.array([found.at])).teeth_at(0)


def _both_sides(known: AsWritten) -> Array:
    return np.stack([known.pushing_rad, known.back_rad])


def _touched_at(
    outlines: Outlines, pitch: PitchPair, known: AsWritten, even: Placement, reach_mm: float
) -> Callable[[Array], Touched]:
    rolled, middle = over_cycle(even, _both_sides(known).mean(axis=0, keepdims=True))
    facing = facing_in(even, outlines)

    def touch_in(placement: Placement) -> tuple[Array, Array]:
        """Angles beyond a placement's at which pushing flanks and backs touch, shape (2, n), and overlaps in it."""
        play = outline_play(facing, placement, reach_mm)
        require_reached(outlines, play)
        return np.stack(placement.bounds_rad(play.up_rad, play.down_rad)), play.overlap_mm

    def touched(rolled_mm: Array) -> Touched:
        at = placed_at(pitch, even, rolled_mm)
        between_rad = np.interp(rolled_mm, rolled, middle[0])
        touch, overlap_mm = touch_in(replace(at, phi2_rad=at.phi2_rad + between_rad))
        touch += between_rad
        doubtful = np.flatnonzero((overlap_mm > 0.0) | (touch[0] > ALIKE_RAD) | (touch[1] < -ALIKE_RAD))
        overlap_mm[:] = 0.0
        if doubtful.size:
            law, overlap_mm[doubtful] = touch_in(placed_at(pitch, even, rolled_mm[doubtful]))
            # A corner that has passed its flank looks as if it touched; the wider play is free all along.
            touch[:, doubtful] = np.where(law[1] - law[0] > (touch[1] - touch[0])[doubtful], law, touch[:, doubtful])
        return at, touch, overlap_mm

    return touched


def _errors_at(pitch: PitchPair, teeth: ToothedPair, designed: AsDesigned) -> Callable[[Array], Array]:
    """The errors of the exact teeth on both sides at rolled lengths, (2, n); constant where only rounding varies."""
    sides = np.stack([designed.pushing.error_rad, designed.back.error_rad])
    if np.all(np.ptp(sides, axis=1) <= ALIKE_RAD):
        return lambda rolled_mm: np.broadcast_to(sides.mean(axis=1)[:, None], (2, rolled_mm.size))
    touch = touch_at(teeth)

    def errors(rolled_mm: Array) -> Array:
        found = touch(placed_at(pitch, designed.placement, rolled_mm))
        return np.stack([found.pushing.error_rad, found.back.error_rad])

    return errors


def _ranged(touch_rad: Array) -> Array:
    """The pushing flanks' angle, the backs' and the play, each with its negative, shape (6, n)."""
    pushing, back = touch_rad
    return np.stack([sign * values for values in (pushing, back, back - pushing) for sign in (1.0, -1.0)])


def _quantities(touched: Touched, errors_rad: Array) -> Array:
    """The quantities whose largest values are searched, shape (8, n); without overlap the remaining room counts."""
    astray = np.abs(touched[1] - errors_rad).max(axis=0)
    return np.vstack([_ranged(touched[1]), astray, _overlap(touched)])


def _overlap(touched: Touched) -> Array:
    """Overlaps in mm, shape (n,), below 0 by the remaining room."""
    at, touch_rad, overlap_mm = touched
    room: Array = np.maximum(np.minimum(-touch_rad[0], touch_rad[1]), 0.0) * at.driven_radius_mm
    return overlap_mm - room
