"""Span (base tangent length) over some teeth of a gear, in the places where two plates have a common normal.

The normal of a flank goes through its pitch point P at the pressure angle alpha to the tangent (teeth/flank.py).  Two
plates touch the back flank of one tooth and the front flank of another along one common normal only where that line is
a chord of the pitch curve, from P1 to P2, which leaves the curve inwards at alpha and comes out at alpha.  These chords
belong to the curve, whatever the flanks are: on a circle every chord of the central angle 2 alpha is one, on other
curves a few are.

With d the direction inwards at P1, the curve turns by 2 alpha from P1 to P2, and q = (P2 - P1) x d vanishes.  Plates
that are turned a little from the common normal are farther apart where both flanks' radii of curvature together exceed
their distance, that is where sin(alpha) (1/k1 + 1/k2) exceeds the chord; elsewhere they are nearer.

The back flanks of a gear whose teeth leave play stand turned about its axis, and P1 with them.

With sigma1 and sigma2 the arc lengths of the chord's ends, and c1, c2 the arc lengths at which the back flank of the
first tooth and the front flank of the last tooth cross the pitch curve, the span is

    W = |P2 - P1| + cos(alpha) ((c2 - c1) - (sigma2 - sigma1)).

On a circle of z teeth that is the usual W = m cos(alpha) (pi (k - 1/2) + z inv(alpha)) + 2 x m sin(alpha).
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from ncgear.frozen import dataclass
from ncgear.metrology.pins import WorkingFlanks
from ncgear.numerics.arrays import Array, Columns, IndexArray, Mask
from ncgear.numerics.plane import cross
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch.curve import ClosedPitchCurve, CurvePoints
from ncgear.pitch.shape import Gear


@dataclass(frozen=True, eq=False)
class MeasuredSpans:
    """Places where a gear's span can be measured; shape (n,).

    From the back of tooth ``first`` to the front of tooth ``last`` (numbers from 1), over ``teeth`` teeth, the plates
    are ``distance_mm`` apart along their common normal.  ``least`` says whether plates turned a little are farther
    apart (a caliper settles there) or nearer (a caliper is swung for its greatest reading); on a circle it does not
    matter.  ``phi1_rad`` is the driving angle at which the middle of the curve between both ends is the pitch point.
    ``everywhere`` says that the gear is circular.  ``beyond`` counts the places whose plates would touch above or below
    the flanks.
    """

    first: IndexArray
    last: IndexArray
    teeth: IndexArray
    distance_mm: Array
    least: Mask
    phi1_rad: Array
    everywhere: bool
    beyond: int


def spans(working: WorkingFlanks) -> MeasuredSpans:
    """All spans of a gear whose plates touch flanks, each over the teeth that they touch nearest to the pitch curve.

    A circular gear has a span from every tooth.  Equivalent gears and unequal pressure angles have none: their flanks
    have no common normal that is a chord.
    """
    flanks = working.flanks
    # Every back flank stands turned by as much, and so does the curve on which it rolls.
    turn, chords = float(flanks.turn_rad[0] - flanks.turn_rad[1]), NO_CHORDS
    pushing, idle = flanks.rack.angles_rad
    if not flanks.equivalent and pushing == idle:
        chords = _of_teeth(working, measuring_chords(flanks.curve, pushing, turn))
    if flanks.made is not None:
        # Chords from tooth to tooth of the made teeth; the first of these stands before the range.
        after = flanks.crossing_mm[2 * flanks.made - 1]
        chords = chords.kept((chords.start_mm >= 0.0) & (chords.end_mm <= after))
    first, low = _touching(working, chords.start_mm, -1.0)
    last, high = _touching(working, chords.end_mm, 1.0)
    good = np.isfinite(low) & np.isfinite(high)
    first, last = first[good], last[good]
    length = _offset(_Way(flanks.curve, pushing, turn), chords.start_mm, chords.end_mm)[1]
    distance = length[good] + (low + high)[good] / np.sin(pushing)
    middle = (chords.start_mm + chords.end_mm)[good] / 2.0
    return MeasuredSpans(
        flanks.tooth[first],
        flanks.tooth[last],
        (last - first) // 2 % (flanks.count // 2) + 1,
        working.base_cosine[first] * distance,
        chords.least[good],
        flanks.curve.driving_angle(middle),
        chords.everywhere,
        int(np.count_nonzero(~good)),
    )


def _of_teeth(working: WorkingFlanks, chords: MeasuringChords) -> MeasuringChords:
    """On a circle, one chord for every tooth, which lies evenly over as many teeth as it is long."""
    if not chords.everywhere:
        return chords
    flanks = working.flanks
    arc = float((chords.end_mm - chords.start_mm)[0])
    number = flanks.teeth
    over = max(1, round(arc / flanks.rack.pitch_mm + 0.5))
    back, front = flanks.crossing_mm[::2], flanks.crossing_mm[1::2]
    last = np.arange(number if flanks.made is None else number - over + 1) + over - 1
    ends = front[last % number] + last // number * flanks.curve.length_mm
    start = (back[: last.size] + ends - arc) / 2.0
    return MeasuringChords(start, start + arc, np.ones(last.size, dtype=bool), everywhere=True)


def _touching(working: WorkingFlanks, sigma_mm: Array, side: float) -> tuple[IndexArray, Array]:
    """For each arc length, the flank of one side that touches nearest to the pitch line, and its height there.

    Shapes (n,); heights are infinite where no flank touches within its ends.
    """
    flanks = working.flanks
    chosen = np.nonzero(flanks.side == side)[0]
    turn = flanks.curve.length_mm
    ahead = np.mod(flanks.crossing_mm[chosen] - sigma_mm[:, None] + turn / 2.0, turn) - turn / 2.0
    height = side * ahead * flanks.slant.of(chosen).height_per_rolled
    on_flank = (height >= working.low_mm[chosen]) & (height <= working.high_mm[chosen])
    height = np.where(on_flank, height, np.inf)
    nearest = np.argmin(np.abs(height), axis=1)
    return chosen[nearest], np.take_along_axis(height, nearest[:, None], axis=1)[:, 0]


STEPS = 1024
"""Steps of the arc length in the search for chords.  Two chords nearer than a thousandth of the curve, whose signs
cancel, do not matter, since the reading hardly changes between them."""

EVEN = 1e-9
"""Share of a chord below which the offset q counts as rounding: on a circle q is 1e-15 of the chord, on a curve whose
radius varies by a millionth it is 1e-7."""

NEIGHBOURS = 1.5
"""Starts fewer steps apart than this are neighbours on the grid; between starts two steps apart, one is left out."""

HAIR = 1e-6
"""Widening of brackets as a share of a step, so that rounding at their ends does no harm."""


@dataclass(frozen=True, eq=False)
class MeasuringChords(Columns):
    """Chords at which plates have a common normal; arc lengths in mm of both ends, shape (n,).

    ``least`` says whether plates turned from the common normal are farther apart.  ``everywhere`` says that the curve
    is a circle, on which one chord stands for all.
    """

    start_mm: Array
    end_mm: Array
    least: Mask
    everywhere: bool = False


NO_CHORDS = MeasuringChords(np.empty(0), np.empty(0), np.zeros(0, dtype=bool))


def measuring_chords(curve: ClosedPitchCurve, angle_rad: float, turn_rad: float = 0.0) -> MeasuringChords:
    """All measuring chords of one turn of a curve, from the curve turned by ``turn_rad`` to the curve; none on a ring.

    On a dented curve a chord begins only where the curve has turned farther than anywhere before.  An arc of a circle
    has one chord, in its middle, which stands for all others on it.
    """
    if curve.is_ring:
        return NO_CHORDS
    way = _Way(curve, angle_rad, turn_rad)
    start, end, leaps = _tried(way)
    offset, length = _offset(way, start, end)
    even = np.abs(offset) <= EVEN * length
    if even.all():
        return MeasuringChords(start[:1], end[:1], np.ones(1, dtype=bool), everywhere=True)
    neighbours = (np.diff(start) < NEIGHBOURS * curve.length_mm / STEPS) & (np.diff(leaps) == 0)
    signs = (offset[:-1] < 0.0) != (offset[1:] < 0.0)
    change = np.nonzero(signs & neighbours & ~even[:-1] & ~even[1:])[0]
    found = _closed_in(way, (start, end), change)
    # A dent flatter than a step lets the end leap unseen: there the offset changes sign and is nowhere zero
    offset, length = _offset(way, *found)
    first, last = (chords[np.abs(offset) <= EVEN * length] for chords in found)
    arcs = _middles(even, neighbours)
    begun, ended = way.start(first), way.curve.at_length(last)
    radii = 1.0 / begun.curvature + 1.0 / ended.curvature
    is_least = sin(angle_rad) * radii > np.linalg.norm(ended.position - begun.position, axis=1)
    least = np.concatenate([is_least, np.ones(arcs.size, dtype=bool)])
    return MeasuringChords(np.concatenate([first, start[arcs]]), np.concatenate([last, end[arcs]]), least)


@dataclass(frozen=True, eq=False)
class _Way:
    """Beginning and end of chords: from the ``curve`` turned by ``turn_rad`` to the curve, at ``angle_rad``."""

    curve: ClosedPitchCurve
    angle_rad: float
    turn_rad: float

    def start(self, sigma_mm: Array) -> CurvePoints:
        """The turned curve at arc lengths."""
        at = self.curve.at_length(sigma_mm)
        return at.turned(np.full(at.curvature.shape, self.turn_rad)) if self.turn_rad else at

    @property
    def sense(self) -> float:
        """+1 where the normal is to the left of the tangent, -1 to the right."""
        return 1.0 if self.curve.gear is Gear.DRIVING else -1.0

    def inwards(self, at: CurvePoints) -> Array:
        """Directions of chords that begin at points."""
        return cos(self.angle_rad) * at.tangent - sin(self.angle_rad) * at.normal


def _tried(way: _Way) -> tuple[Array, Array, IndexArray]:
    """Starts over one turn, ends after a turning of 2 alpha, and steps of dents that ends have leapt over, (n,)."""
    curve = way.curve
    step = curve.length_mm / STEPS
    grid = np.linspace(-curve.length_mm, 2.0 * curve.length_mm, 3 * STEPS + 1)
    # Turn of the curve, up to a constant; it grows where the curve is convex.
    tangent = curve.at_length(grid).tangent
    turned = -way.sense * np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    farthest = np.maximum.accumulate(turned)
    first = np.nonzero(turned[STEPS : 2 * STEPS + 1] >= farthest[STEPS : 2 * STEPS + 1])[0] + STEPS
    goal = turned[first] - way.sense * way.turn_rad + 2.0 * way.angle_rad
    after = np.searchsorted(farthest, goal)
    kept = (after < grid.size) & (turned[np.minimum(first + 1, grid.size - 1)] > turned[first])
    first, after = first[kept], after[kept]
    end = _end_of(way, grid[first], grid[after] - (1.0 + HAIR) * step, grid[after] + HAIR * step)
    dented: IndexArray = np.cumsum((turned < farthest).astype(np.intp))
    return grid[first], end, dented[after]


def _middles(even: Mask, neighbours: Mask) -> IndexArray:
    """The start in the middle of each stretch of even starts (n,) around a closed turn; ``neighbours`` join them."""
    among = np.nonzero(even)[0]
    stretches = np.split(among, np.nonzero(~neighbours[among[:-1]] | (np.diff(among) > 1))[0] + 1) if among.size else []
    if len(stretches) > 1 and even[0] and even[-1]:
        *others, last = stretches
        stretches = [np.concatenate([last[:-1], others[0]]), *others[1:]]
    return np.array([stretch[stretch.size // 2] for stretch in stretches], dtype=np.intp)


def _end_of(way: _Way, start: Array, low: Array, high: Array) -> Array:
    """Arc lengths between bounds at which the curve has turned by 2 alpha since the starts; shape (n,) each."""
    wanted, angle = way.inwards(way.start(start)), way.angle_rad

    def short(sigma: Array) -> Array:
        at = way.curve.at_length(sigma)
        outwards = cos(angle) * at.tangent + sin(angle) * at.normal
        return way.sense * cross(wanted, outwards)

    return zeros_between(short, low, high)


def _offset(way: _Way, start: Array, end: Array) -> tuple[Array, Array]:
    """q, and the length of the chord."""
    first, last = way.start(start), way.curve.at_length(end)
    chord = last.position - first.position
    return cross(chord, way.inwards(first)), np.linalg.norm(chord, axis=1)


def _closed_in(way: _Way, tried: tuple[Array, Array], change: IndexArray) -> tuple[Array, Array]:
    """Both ends of the chords between neighbours whose offsets differ in sign."""
    start, end = tried
    margin = HAIR * way.curve.length_mm / STEPS
    low, high = end[change] - margin, end[change + 1] + margin

    def offset(sigma: Array) -> Array:
        return _offset(way, sigma, _end_of(way, sigma, low, high))[0]

    found = zeros_between(offset, start[change], start[change + 1])
    return found, _end_of(way, found, low, high)
