"""The turn of two outlines against each other before the search for a pair that follows both.

Each outline alone gives a ratio of the gears at every angle, as if its mate were free.  The search begins at the turn
where the logarithms of both ratios are most alike, with a ratio between them.
"""

from __future__ import annotations

from math import tau

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.rolled import closing_distance_mm


@dataclass(frozen=True, eq=False)
class Phased:
    """A start: the numbers of the radii of both gears, the radius between them, the turn of the mate, and its scale.

    ``radius_mm`` has shape (n,), at even angles of the curve.
    """

    own: int
    mate: int
    radius_mm: Array
    turned_rad: float
    scale: float


def best_phases(own: list[Array], mate: list[Array], share: float, fixed_size: bool, count: int) -> list[Phased]:
    """The ``count`` best starts among all radii of both gears, at even polar angles of shape (n,) each.

    ``share`` is the mate's, 0 to 1; ``fixed_size`` says that both drawings have the size of the pair.
    """
    found = list[tuple[float, int, int, int]]()
    asked, answers = [_log_ratio(radius) for radius in own], [_as_driven(radius) for radius in mate]
    for i, one in enumerate(asked):
        for j, (other, _) in enumerate(answers):
            alike = np.fft.irfft(np.fft.rfft(one) * np.conj(np.fft.rfft(other)), len(one))
            # Only turns that are better than their neighbours count.
            tops = np.flatnonzero((alike > np.roll(alike, 1)) & (alike >= np.roll(alike, -1)))
            apart = float(one @ one + other @ other) - 2.0 * alike[tops]
            found += [(float(cost), i, j, int(turn)) for cost, turn in zip(apart, tops, strict=True)]
    starts = list[Phased]()
    for _, i, j, turn in sorted(found)[:count]:
        other, angle = answers[j]
        ratio = np.exp((1.0 - share) * asked[i] + share * np.roll(other, turn))
        ratio /= np.mean(ratio)
        form, form_mate = ratio / (1.0 + ratio), 1.0 / (1.0 + ratio)
        by_own, by_mate = np.mean(own[i]) / np.mean(form), np.mean(mate[j]) / np.mean(form_mate * ratio)
        distance = float((1.0 - share) * by_own + share * by_mate if fixed_size else by_own)
        scale = 1.0 if fixed_size else float(by_own / by_mate)
        starts.append(Phased(i, j, distance * form, float(-np.roll(angle, turn)[0]), scale))
    return starts


def _log_ratio(radius: Array) -> Array:
    """Logarithm of how fast the mate of a radius turns."""
    found: Array = np.log(radius / (closing_distance_mm(radius) - radius))
    return found


def _as_driven(radius: Array) -> tuple[Array, Array]:
    """Of a mate by its radius at even angles: logarithm of the ratio it asks for, and its own angle, over even angles
    of the gear that drives it; both turn against each other."""
    count = len(radius)
    backwards = np.roll(radius[::-1], 1)
    turns = np.exp(_log_ratio(backwards))
    turns /= np.mean(turns)
    angle = np.arange(count + 1) * (tau / count)
    driving = np.concatenate([[0.0], np.cumsum((turns + np.roll(turns, -1)) / 2.0)]) * (tau / count)
    own = np.interp(angle[:-1], driving, angle)
    return -np.log(np.interp(own, angle, np.append(turns, turns[0]))), own
