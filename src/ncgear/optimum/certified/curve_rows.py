"""Relations of neighbouring places from the shape of the pitch curves, as rows of the conic programme of motions.

- The driven curve, 1/r2 = (1 + s)/a, is convex where 1 + s + s'' >= 0.  So 1 + s lies at or below the sine curve
  through two places.  For three places in a row that is exact: s0 <= alpha + beta s- + gamma s+.  Squared, it bounds q0
  by a concave function of q- and q+.  In a cell, the curve through its ends bounds the mean of 1/s from below.
- The tangent, |s'| <= t (1 + s), lets 1 + s grow by at most exp(t h) in a cell of h rad.
- The driving curve, 1/r1 = (1 + 1/s)/a, is convex where y'' <= 2 exp(-y) + 2 exp(-y/2), with y = ln q.  For q within a
known range, the right side lies below its chord a - c y: so y lies at or above the solution of y'' + c y = a through
two places (the maximum principle), which is linear for three places in a row.  The variables y lie
  below the tangents of ln q and above its chord over the range.

These relations were derived for ncgear.
"""

from __future__ import annotations

from math import log

import numpy as np

from ncgear.numerics.arrays import IndexArray
from ncgear.optimum.certified.demands import NearMotion, Ranges
from ncgear.optimum.certified.motion import ROUNDING, MotionProgramme
from ncgear.optimum.certified.ranges import along, curved


def limit_bulge(of: MotionProgramme) -> None:
    """Three places in a row of a convex driven curve, over alpha, which is of the square of their distance."""
    near, far = of.before_h, of.after_h
    whole = np.sin(near + far)
    beta, gamma = np.sin(far) / whole, np.sin(near) / whole
    alpha = 2.0 * np.sin(near / 2.0) * np.sin(far / 2.0) / np.cos((near + far) / 2.0)
    # The geometric mean of the values on both sides
    low, high = (np.sqrt(ends[of.before] * ends[of.next]) for ends in (of.lowest, of.highest))
    between = of.programme.variable(low * (1.0 - ROUNDING), high * (1.0 + ROUNDING))
    of.programme.cone(of.q[of.before] + of.q[of.next], 2.0 * between, of.q[of.before] - of.q[of.next])
    roots = 2.0 * (beta * of.turning[of.before] + gamma * of.turning[of.next])
    squares = (beta**2 / alpha) * of.q[of.before] + (gamma**2 / alpha) * of.q[of.next]
    mixed = (2.0 * beta * gamma / alpha) * between
    of.programme.positive(roots + squares + mixed + alpha - of.q * (1.0 / alpha))


def limit_lean(of: MotionProgramme) -> None:
    """1 + s grows by at most exp(t h) from place to place, either way."""
    cells = leaning(of)
    here, there = cells, of.next[cells]
    growth = np.exp(of.asked.steepness * of.after_h[cells])
    more = np.expm1(of.asked.steepness * of.after_h[cells])
    for start, end in ((here, there), (there, here)):
        reach = 2.0 * growth * of.turning[start] + (growth**2 / more) * of.q[start] + more
        of.programme.positive(reach - of.q[end] * (1.0 / more))


def leaning(of: MotionProgramme) -> IndexArray:
    """Cells in which the tangent limits 1 + s more than the ratios do."""
    widest = log((1.0 + 1.0 / of.asked.ratio_min) / (1.0 + 1.0 / of.asked.ratio_max))
    return np.nonzero(of.asked.steepness * of.after_h < widest)[0]


def limit_driving_curve(of: MotionProgramme, known: Ranges) -> None:
    """y = ln q within the range of q, and three places in a row of a convex driving curve."""
    cells = np.nonzero((known.least_in_cell > 0.0) & np.isfinite(known.most_in_cell))[0]
    places = np.unique(np.concatenate([cells, of.next[cells]]))
    low, high = of.lowest[places], np.maximum(of.highest[places], of.lowest[places])
    y = of.programme.variable(np.log(low), np.log(high))
    q = of.q[places]
    for at in (low, np.sqrt(low * high), high):
        of.programme.positive(q * (1.0 / at) + (np.log(at) - 1.0) - y)
    # The chord of ln q over the range; a tangent where the range has no width
    width = high / low - 1.0
    rise = np.where(width > 0.0, np.log1p(width) / np.where(width > 0.0, width, 1.0), 1.0)
    of.programme.positive(y - np.log(low) - (q * (1.0 / low) - 1.0) * rise)
    inner = np.nonzero(np.isin(of.before[places], cells) & np.isin(places, cells))[0]
    here = places[inner]
    number = np.zeros(of.on.count, dtype=int)
    number[places] = np.arange(places.size)
    near, far = of.before_h[here], of.after_h[here]
    least = np.minimum(known.least_in_cell[here], known.least_in_cell[of.before[here]])
    most = np.maximum(known.most_in_cell[here], known.most_in_cell[of.before[here]])
    first, second, rest, good = curved(np.log(least), np.log(most), near, far)
    lowest = first * y[number[of.before[here]]] + second * y[number[of.next[here]]] + rest
    of.programme.positive((y[inner[good]] - lowest[good]) * (1.0 / (near * far)[good]))


def follow_driving_curve(of: MotionProgramme, motion: NearMotion) -> None:
    """Three places in a row of a driving curve that stays convex by the tangents at a motion."""
    rate = (motion.rate + motion.rate[of.before]) / 2.0
    first, second, rest = along(rate, motion.q, of.before_h, of.after_h)
    lowest = first * of.q[of.before] + second * of.q[of.next] + rest
    of.programme.positive((of.q - lowest) * (1.0 / (of.before_h * of.after_h)))
