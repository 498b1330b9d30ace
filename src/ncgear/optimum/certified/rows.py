"""Relations of pitch curves, times and flank loads, as rows of the conic programme of motions.

- The driven curve, 1/r2 = (1 + s)/a, is convex where 1 + s + s'' >= 0.  So 1 + s lies at or below the sine curve
  through two places.  For three places in a row that is exact: s0 <= alpha + beta s- + gamma s+.  Squared, it bounds q0
  by a concave function of q- and q+.  In a cell, the curve through its ends bounds the mean of 1/s from below.
- The tangent, |s'| <= t (1 + s), lets 1 + s grow by at most exp(t h) in a cell of h rad.
- The driving curve, 1/r1 = (1 + 1/s)/a, is convex where y'' <= 2 exp(-y) + 2 exp(-y/2), with y = ln q.  For q within a
known range, the right side lies below its chord a - c y: so y lies at or above the solution of y'' + c y = a through
two places (the maximum principle), which is linear for three places in a row.  The variables y lie
  below the tangents of ln q and above its chord over the range.
- The mean of 1/s in each cell is its share of the driving angle.
- The flank load H of each cell: with the crank's torque M, s = dphi2/dphi1, i = 1/s, q = s^2 and the flanks' angle
  alpha, a motion keeps M (1 + s)^3 <= H (s cos(alpha) + q' sin(alpha)/(2 (1 + s))) where the front flanks bear, and the
  same with -M and -q' for the others.  Divided by (1 + s)^3, every term has an integral over a cell: that of M is the
  energy which the crank takes; that of q'/(2 (1 + s)^4) is the rise of g = 1/(3 (1 + s)^3) - 1/(2 (1 + s)^2), which is
  concave in q; and the mean of f = i^2/(1 + i)^3 lies below any line above f, taken at the mean of i.

These relations were derived for ncgear.
"""

from __future__ import annotations

from math import cos, inf, isinf, log, sin, tan

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.demands import Demands, NearMotion, Ranges
from ncgear.optimum.certified.motion import ROUNDING, MotionProgramme
from ncgear.optimum.certified.proof import Linear
from ncgear.optimum.certified.ranges import along, curved
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import TimeWithin


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


def needs_times(task: Task, asked: Demands) -> bool:
    """Whether a time longer than the true time eases a row: a row of energies, of flanks or of stretches."""
    return (
        task.masses is not None
        or bool(asked.requirements(TimeWithin))
        or any(
            not isinf(limit)
            for limit in (asked.braking_w, asked.fluctuation_n_mm, asked.torque_n_mm, asked.flank_load_n_mm)
        )
    )


def limit_times(of: MotionProgramme, known: Ranges) -> None:
    """Upper bounds of the mean of 1/s in cells: the mean of a bound for each end, which lies below its chord in q.

    A convex driving curve lets ln q bend up by 2 i + 2 i^2 at most, so 1/s lies below the mean of both ends but for
    the bend.  Else the tangent lets 1 + s fall by exp(-t d) at most over d rad from an end; on half a cell of h rad
    1/s has the mean -ln(1 - f/s) 2/(t h) then, with f = exp(t h/2) - 1.
    """
    cells = np.nonzero((known.least_in_cell > 0.0) & np.isfinite(known.most_in_cell))[0]
    if of.asked.convex:
        ratio = 1.0 / np.sqrt(known.least_in_cell[cells])
        bent = np.exp((2.0 * ratio + 2.0 * ratio**2) * of.after_h[cells] ** 2 / 16.0)

        def mean(s: Array) -> Array:
            return bent / s
    else:
        half = of.asked.steepness * of.after_h / 2.0
        slowest = np.sqrt(np.minimum(of.lowest, of.lowest[of.next]))
        cells = cells[np.expm1(half[cells]) < slowest[cells]]
        half = half[cells]

        def mean(s: Array) -> Array:
            return -np.log1p(-np.expm1(half) / s) / half * (1.0 + ROUNDING)

    for_ends = []
    for end in (cells, of.next[cells]):
        low, high = of.lowest[end], np.maximum(of.highest[end], of.lowest[end])
        longest, width = mean(np.sqrt(low)), high - low
        fall = np.where(width > ROUNDING * high, longest - mean(np.sqrt(high)), 0.0)
        for_ends.append((of.q[end] - low) * (-fall / np.maximum(width, ROUNDING * high)) + longest)
    of.programme.positive((for_ends[0] + for_ends[1]) * 0.5 - of.time[cells])
    # The times fill the cycle
    of.programme.positive(of.angle - 1.0)


def least_times(of: MotionProgramme) -> None:
    """Upper bounds of the mean of s in a cell: its inverse is no more than the mean of 1/s."""
    one = of.constant(np.ones(of.on.count))
    ends = (of.turning + of.turning[of.next]) * 0.5
    if of.asked.convex:
        wide = np.tan(of.after_h / 2.0) / (of.after_h / 2.0)
        of.programme.product(of.time, wide * ends + (wide - 1.0), one)
        return
    if not isinf(of.asked.steepness):
        cells = leaning(of)
        lean = of.asked.steepness * of.after_h[cells] / 2.0
        wide = np.expm1(lean) / lean
        of.programme.product(of.time[cells], wide * ends[cells] + (wide - 1.0), one[cells])
    _keep_under_roofs(of)


def _keep_under_roofs(of: MotionProgramme) -> None:
    """Limit a cell's mean of half the squared speed by the roof of its accelerations, which limits its time.

    Over a way of length 1 from a to b it rises by at most A and falls by at most D, so at u it is at most the lower of
    a + A u and b + D (1 - u).  The mean of that is b + D/2 - (b - a + D)^2/(2 (A + D)).
    """
    cells = np.nonzero(np.isfinite(of.falls) | of.has_peak)[0]
    if not cells.size:
        return
    per, falls = 1.0 / of.length[cells], of.falls[cells]
    here, there = of.energy[cells] * per, of.energy[of.next[cells]] * per
    fastest = of.on.slope_mm_rad**2 * of.highest / (2.0 * of.crank**2)
    ends = fastest[cells] * per, fastest[of.next[cells]] * per
    rising = np.maximum(*ends) + (of.most_acceleration / 2.0 if of.has_peak else inf)
    top = 1.1 * np.minimum(float(np.max(fastest)) * per, np.minimum(rising, ends[1] + falls / 2.0))
    mean, root = (
        of.programme.variable(np.zeros(cells.size), top),
        of.programme.variable(np.zeros(cells.size), np.sqrt(top)),
    )
    peak, fallen = of.acceleration.repeated(cells.size), np.nonzero(np.isfinite(falls))[0]
    fall, room = falls[fallen], there[fallen] - mean[fallen]
    if of.has_peak:
        of.programme.product(peak, 2.0 * here + 2.0 * there + peak - 4.0 * mean, there - here)
        of.programme.product(peak[fallen] + fall, 2.0 * room + fall, (there - here)[fallen] + fall)
    else:
        of.programme.positive(room + fall / 2.0)
    of.programme.root(root, mean)
    # time * step >= length / (mean speed), over crank w
    least = np.sqrt(np.sqrt(of.length[cells] / 2.0) / of.after_h[cells])
    of.programme.product(of.time[cells], root, of.constant(least))


def take_time(of: MotionProgramme, closed: bool) -> None:
    """The driving angles that the cycle and its stretches have."""
    if closed:
        of.programme.positive(1.0 - of.angle)
    for limit in of.asked.requirements(TimeWithin):
        cells = of.on.cells_within(*limit.stretch)
        if cells.size:
            taken = (of.time[cells] * of.after_h[cells]).total()
            of.programme.positive((limit.most_rad - taken) * (1.0 / limit.most_rad))


SAMPLES = 32
"""Steps of the range of 1/s in which the greatest distance of f from a line is looked for."""

BENT = 0.21
"""f'' is never below -0.201: so the greatest distance over samples d apart misses at most d^2/8 of it."""


def flank_angles(of: MotionProgramme) -> tuple[float, float]:
    """The rack's angles of the flanks that a positive torque of the crank presses, and of the others, in rad."""
    gears = of.task.gears
    pushing = gears.rack_angle_rad if gears else of.asked.rack_angle_rad
    return pushing, (gears.idle_angle_rad if gears else None) or pushing


def limit_flank_load(of: MotionProgramme, known: Ranges | None) -> None:
    """The torque's mean in each cell against the flank load, for both sides of the teeth."""
    load = of.limited("flank_load_n_mm")
    if load is None:
        return
    levels, rises = _levels(of, known), _rises(of)
    for sign, angle in zip((1.0, -1.0), flank_angles(of), strict=True):
        if of.asked.steepness * tan(angle) >= 1.0:
            # Flanks on the side without load may stand at 90 degrees or more
            continue
        room = levels * (of.after_h * cos(angle)) + (rises[of.next] - rises) * (sign * sin(angle))
        most = np.maximum(_greatest(of, room), 0.0)
        torque = of.given * (sign / load.most)
        share = load.share.repeated(of.on.count)
        # The share times the room lies below both planes of McCormick
        of.programme.positive((room - torque) * (1.0 / of.after_h))
        of.programme.positive((room * load.least + share * most - most * load.least - torque) * (1.0 / of.after_h))


def _greatest(of: MotionProgramme, expression: Linear) -> Array:
    """An upper bound of expressions by the ranges of their variables, shape (n,)."""
    low, high = np.concatenate(of.programme.low), np.concatenate(of.programme.high)
    columns, factors = expression.columns, expression.coefficients
    ends = np.maximum(factors * low[columns], factors * high[columns])
    return np.asarray(expression.constant + ends.sum(axis=0)) * (1.0 + ROUNDING)


def _levels(of: MotionProgramme, known: Ranges | None) -> Linear:
    """Upper bounds of the mean of f in each cell, below three lines of 1/s."""
    least, most = (np.full(of.on.count, end) for end in (of.asked.ratio_min, of.asked.ratio_max))
    if known is not None:
        with np.errstate(divide="ignore"):
            least = np.maximum(least, np.where(known.most_in_cell < inf, 1.0 / np.sqrt(known.most_in_cell), 0.0))
            most = np.minimum(most, 1.0 / np.sqrt(known.least_in_cell))
        least = np.minimum(least, most) * (1.0 - ROUNDING)
        most = most * (1.0 + ROUNDING)
    step = (most - least) / SAMPLES
    samples = least + step * np.arange(SAMPLES + 1)[:, None]
    values = samples**2 / (1.0 + samples) ** 3
    top = values.max(axis=0) + BENT * step**2 / 8.0
    level = of.programme.variable(np.zeros(of.on.count), top)
    for at in (least, (least + most) / 2.0, most):
        slope = at * (2.0 - at) / (1.0 + at) ** 4
        above = (values - slope * samples).max(axis=0) + BENT * step**2 / 8.0
        of.programme.positive(of.time * slope + above - level)
    return level


def _rises(of: MotionProgramme) -> Linear:
    """g at each place, below three tangents in q and above the chord over the range of q."""
    low, high = of.lowest, np.maximum(of.highest, of.lowest)
    at_low, at_high = _rise(low), _rise(high)
    rise = of.programme.variable(at_low, at_high)
    for q in (low, np.sqrt(low * high), high):
        of.programme.positive((of.q - q) * (0.5 / (1.0 + np.sqrt(q)) ** 4) + _rise(q) - rise)
    width = high - low
    wide = width > ROUNDING * high
    slope = np.where(wide, (at_high - at_low) / np.where(wide, width, 1.0), 0.5 / (1.0 + np.sqrt(high)) ** 4)
    of.programme.positive(rise - at_low - (of.q - low) * slope)
    return rise


def _rise(q: Array) -> Array:
    turned = 1.0 + np.sqrt(q)
    return np.asarray(1.0 / (3.0 * turned**3) - 1.0 / (2.0 * turned**2))
