"""Chords along many curves at once: as few as possible, each within a tolerance of its curve.

Where the curve turns by t along a chord of length d, their distance is d t / 8, so a curve needs the integral of
sqrt(ds dt / (8 tolerance)) chords.  They are placed at even shares of that integral, checked, and halved where they
stray too far.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ncgear.errors import Unanswered, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask, counted_up
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.plane import along, angle_between, as_complex, as_points
from ncgear.teeth.stretch import CurveStretch

PROBES = 33
"""Points per curve between which its turning is measured to place the chords."""

SHARES = np.linspace(0.0, 1.0, PROBES)
"""Places of these points as shares of the way along the curve."""

PLACED = 0.95
"""Share of the tolerance for placing chords: between probes the turning is known only to a few per cent."""

GENTLE_RAD = 1.0
"""Turning of a curve below which a single chord may be enough."""

SURELY_ONE = 1.0 - 1e-6
"""Bound of the number of chords up to which a curve is not probed: probes would add less than the rest to the count."""

MOST_CHORDS, MOST_OF_ONE = 30_000, 25
"""Most chords of all curves of a kind together, and of each where there are very many curves: they need 3 GB in later
steps, and many minutes of a build, which takes four times as long with twice as many.

Teeth of a usual module take some twenty points each; their number grows with the root of module over tolerance."""

HALVINGS = 12
"""Rounds of halving chords that stray too far: near a cusp the turning is not seen by the probes."""


@dataclass(frozen=True, eq=False)
class _Chords(Columns):
    """Chords along the rows of a stretch, in order.

    Chord i of m goes from share ``low`` to share ``high`` of row ``row``; ``start``, ``middle`` and ``end`` are its
    curve's points there and half the way between, ``start_slope`` and ``middle_slope`` the derivatives by the share.
    """

    row: IndexArray
    low: Array
    high: Array
    start: ComplexArray
    middle: ComplexArray
    end: ComplexArray
    start_slope: ComplexArray
    middle_slope: ComplexArray

    @cached_property
    def across(self) -> ComplexArray:
        """Unit vectors to the left of the chords."""
        return _left(self.end - self.start)

    @cached_property
    def off(self) -> Array:
        """Distances of the curves to the left of the chords' middles."""
        return along(self.across, self.middle - self.start)

    @cached_property
    def tilt(self) -> Array:
        """Slopes of the curves off the chords there; with more than twice ``off`` a cubic goes to both sides."""
        return along(self.across, self.middle_slope) * (self.high - self.low)

    @cached_property
    def strayed(self) -> Array:
        """Largest distances of curves from chords: a cubic over the chord strays by sqrt(d^2 + d'^2 / 8) or less."""
        return np.sqrt(self.off**2 + self.tilt**2 / 8.0)

    @cached_property
    def is_first(self) -> Mask:
        """Which chords are the first of their rows."""
        return np.diff(self.row, prepend=-1) != 0

    @cached_property
    def is_last(self) -> Mask:
        """Which chords are the last of their rows."""
        return np.diff(self.row, append=-1) != 0

    def halved(self, stretch: CurveStretch, cut: IndexArray) -> _Chords:
        """The chords; chords numbered ``cut`` are cut in two halves."""
        whole = self.kept(cut)
        half = (whole.low + whole.high) / 2.0
        middles = np.column_stack([(whole.low + half) / 2.0, (half + whole.high) / 2.0])
        (left, right), (left_slope, right_slope) = (as_complex(p).T for p in stretch.at(whole.row[:, None], middles))
        first = replace(whole, high=half, middle=left, end=whole.middle, middle_slope=left_slope)
        second = replace(
            whole, low=half, start=whole.middle, middle=right, start_slope=whole.middle_slope, middle_slope=right_slope
        )
        kept = np.delete(np.arange(self.row.size), cut)
        order = np.argsort(np.concatenate([kept, cut, cut]), kind="stable")
        return _Chords.joined([self.kept(kept), first, second]).kept(order)


def _chords(stretch: CurveStretch, row: IndexArray, share: Array) -> _Chords:
    """The chords that begin at shares of rows, in order; every row has at least one chord."""
    last = np.diff(row, append=-1) != 0
    high = np.where(last, 1.0, np.append(share[1:], 1.0))
    # Along each row: the beginning and the middle of every chord, and the end of the last chord.
    begin = 2 * np.arange(row.size) + row
    rows, shares = np.repeat(row, 2 + last), np.ones(2 * row.size + np.count_nonzero(last))
    shares[begin], shares[begin + 1] = share, (share + high) / 2.0
    points, slopes = (as_complex(array) for array in stretch.at(rows, shares))
    return _Chords(
        row, share, high, points[begin], points[begin + 1], points[begin + 2], slopes[begin], slopes[begin + 1]
    )


def _near(stretch: CurveStretch, chords: _Chords, allowed: Array, tolerance: Array) -> _Chords:
    """The chords, halved until all are near: a given chord to its ``allowed``, a half to its row's tolerance."""
    for _ in range(HALVINGS):
        cut = np.nonzero(chords.strayed > allowed)[0]
        if not cut.size:
            break
        within = tolerance[chords.row[cut]]
        chords, allowed = chords.halved(stretch, cut), np.insert(allowed, cut, within)
        allowed[cut + np.arange(1, cut.size + 1)] = within
    return chords


def _written(stretch: CurveStretch, chords: _Chords, off: ComplexArray | float) -> tuple[Array, Array]:
    """The beginnings of chords, ``off`` their curves, and keys that order them along the outline."""
    return as_points(chords.start + off), stretch.rank[chords.row] + stretch.span[chords.row] * chords.low


def sampled(stretch: CurveStretch, tolerance: Array) -> tuple[Array, Array]:
    """Points of a stretch without the last of each curve, within each row's tolerance (n,), and their keys."""
    chords = _placed(stretch, tolerance)
    return _written(stretch, _near(stretch, chords, tolerance[chords.row], tolerance), 0.0)


END_CHORD = 4.0
"""Distance of the inner end of the first or the last chord from its curve, in sagittas, so that the chord is tangent to
the curve at its other end."""


HOLLOW = 0.8
"""Share of the tolerance for placing chords of curves that may be hollow.  Where such a curve begins to bulge, a chord
strays by its sagitta and by the offset of its ends."""


def sampled_within(stretch: CurveStretch, tolerance: Array, material: float) -> tuple[Array, Array]:
    """As ``sampled``, with chords that stray only into the material, to the left (+1) or to the right (-1).

    Where a curve is hollow the points stand off it by the sagitta of the chords beside them, so that chords touch it in
    their middles.  The ends of the curves are on the curves: a first or last chord is tangent to the curve there, and
    so short that its other end is off the curve by at most the tolerance.
    """
    hollow = HOLLOW * tolerance
    chords = _placed(stretch, hollow)
    chords = _near(stretch, chords, hollow[chords.row], hollow)
    for _ in range(HALVINGS):
        first, last, most = chords.is_first, chords.is_last, PLACED * tolerance[chords.row]
        out, within = _both_sides(chords, material)
        raised = out * np.where(first | last, END_CHORD, 1.0)
        off = np.where(first, 0.0, np.maximum(np.roll(raised, 1), raised))
        # Distance of a chord's middle from a curve that bulges between two points off the curve.
        bulging = within + (off + np.where(last, 0.0, np.roll(off, -1))) / 2.0
        cut = np.nonzero((first & last & (out > 0.0)) | (raised > most) | ((within > 0.0) & (bulging > most)))[0]
        if not cut.size:
            break
        chords = chords.halved(stretch, cut)
    else:
        raise Unanswered("chords of a hollow curve were not found")
    return _written(stretch, chords, material * off * _left(chords.start_slope))


def _both_sides(chords: _Chords, material: float) -> tuple[Array, Array]:
    """Largest distances of chords outside the material and inside it; shape (m,) each."""
    off = material * chords.off
    both = np.where(np.abs(chords.tilt) > 2.0 * np.abs(off), chords.strayed, 0.0)
    return np.maximum(off, both), np.maximum(-off, both)


def straddled(stretch: CurveStretch, tolerance: Array) -> tuple[Array, Array]:
    """As ``sampled``, with chords that stray to both sides of the curves, by at most the tolerance, and so are longer.

    Points are off the curves by half of the chords' sagitta, except at ends of curves and where a curve bends the other
    way.
    """
    chords = _placed(stretch, 2.0 * tolerance)
    most = tolerance[chords.row]
    # A curve that goes to both sides of its chord has no sagitta.
    sagitta = np.where(np.abs(chords.tilt) <= 2.0 * np.abs(chords.off), chords.off, 0.0)
    shift = _standing_off(chords, sagitta, most) * _left(chords.start_slope)
    following = np.where(chords.is_last, 0.0, np.roll(shift, -1))
    # A whole chord stands off at least as far as the nearer of its ends, and strays that much less to the other side.
    taken = np.sign(sagitta) * [along(chords.across, shift), along(chords.across, following)]
    near = _near(stretch, chords, most + np.maximum(taken.min(axis=0), 0.0), tolerance)
    off = np.zeros_like(near.start)
    off[np.searchsorted(near.row + near.low, chords.row + chords.low)] = shift
    return _written(stretch, near, off)


def _standing_off(chords: _Chords, sagitta: Array, most: Array) -> Array:
    """Offset to the left of its curve of each chord's beginning: half the smaller sagitta, or ``most``."""
    before = np.roll(sagitta, 1)
    inner = ~chords.is_first & (before * sagitta > 0.0)
    off = np.minimum(np.minimum(np.abs(before), np.abs(sagitta)) / 2.0, most)
    return np.where(inner, np.sign(sagitta) * off, 0.0)


def _placed(stretch: CurveStretch, tolerance: Array) -> _Chords:
    """As many chords as a tolerance needs on each row (shape (n,)), placed at even shares of the need."""
    placed_for = PLACED * tolerance
    total = _most_needed(stretch, placed_for)
    probed = np.nonzero(~(total <= SURELY_ONE))[0]
    needed = _chords_needed(stretch, probed, placed_for[probed])
    total[probed] = needed[:, -1]
    _refuse_too_many(np.bincount(stretch.kind, total).astype(float), np.bincount(stretch.kind))
    counts = np.maximum(np.ceil(total), 1).astype(int)
    row, place = counted_up(np.zeros_like(counts), counts)
    share, inner = np.zeros(row.size), np.nonzero(place)[0]
    fraction = place[inner] / counts[row[inner]]
    share[inner] = _inverse_rows(needed, np.searchsorted(probed, row[inner]), fraction)
    return _chords(stretch, row, share)


class TooManyChords(WrongInput):
    """A tolerance is out of proportion to the curves of a kind: they need ``times`` this tolerance, or more."""

    def __init__(self, needed: float, most: int) -> None:
        self.times = (needed / most) ** 2
        self.said = (
            f"the teeth are so large for it that flanks, fillets or lands need {needed:.3g} points; at most {most} are "
            "made"
        )
        super().__init__(
            f"{self.said}: at least {shown_above(self.times, 2)} times the tolerance is right",
            key="output.chord_tolerance_mm",
        )


def _refuse_too_many(needed: Array, rows: IndexArray) -> None:
    most = np.maximum(MOST_CHORDS, MOST_OF_ONE * rows)
    if np.any(needed > most):
        worst = int(np.argmax(needed / most))
        raise TooManyChords(float(needed[worst]), int(most[worst]))


def _left(direction: ComplexArray) -> ComplexArray:
    return 1j * direction / np.maximum(np.abs(direction), 1e-300)


def _most_needed(stretch: CurveStretch, tolerance: Array) -> Array:
    """Most chords that rows can need, shape (n,), infinite where the bound of a row's turning t is too large.

    Such a curve is at most as long as the line between its ends over cos(t / 2); the integral of sqrt(ds dt) is at most
    the root of its length times t.
    """
    most, turned = np.full(tolerance.size, np.inf), stretch.most_turning * np.abs(stretch.rolled[1] - stretch.rolled[0])
    gentle = np.nonzero(turned < GENTLE_RAD)[0]
    if gentle.size:
        turned = turned[gentle]
        first, last = as_complex(stretch.at(gentle[:, None], np.broadcast_to([0.0, 1.0], (gentle.size, 2)))[0]).T
        most[gentle] = np.sqrt(np.abs(last - first) / np.cos(turned / 2.0) * turned / (8.0 * tolerance[gentle]))
    return most


def _chords_needed(stretch: CurveStretch, rows: IndexArray, tolerance: Array) -> Array:
    """Number of chords needed from the start of each of m rows to each of its probes, shape (m, PROBES)."""
    needed = np.zeros((rows.size, PROBES))
    if rows.size:
        shares = np.broadcast_to(SHARES, needed.shape)
        points, slopes = (as_complex(array) for array in stretch.at(rows[:, None], shares))
        turn = angle_between(slopes[:, :-1], slopes[:, 1:])
        product = np.abs(np.diff(points, axis=1)) * np.abs(turn)
        np.cumsum(np.sqrt(product / (8.0 * tolerance[:, None])) + 1e-9, axis=1, out=needed[:, 1:])
    return needed


def _inverse_rows(needed: Array, row: IndexArray, fraction: Array) -> Array:
    """Shares of the parameter at which the number of chords reaches the given fractions of its total, row by row."""
    target = fraction * needed[row, -1]
    step = np.sum(needed[row, 1:-1] <= target[:, None], axis=1)
    low, high = needed[row, step], needed[row, step + 1]
    return SHARES[step] + (SHARES[step + 1] - SHARES[step]) * (target - low) / (high - low)
