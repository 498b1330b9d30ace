"""The flank load H of each cell as rows of the conic programme of motions.

With the crank's torque M, s = dphi2/dphi1, i = 1/s, q = s^2 and the flanks' angle alpha, a motion keeps
M (1 + s)^3 <= H (s cos(alpha) + q' sin(alpha)/(2 (1 + s))) where the front flanks bear, and the same with -M and -q'
for the others.  Divided by (1 + s)^3, every term has an integral over a cell: that of M is the energy which the crank
takes; that of q'/(2 (1 + s)^4) is the rise of g = 1/(3 (1 + s)^3) - 1/(2 (1 + s)^2), which is concave in q; and the
mean of f = i^2/(1 + i)^3 lies below any line above f, taken at the mean of i.

These relations were derived for ncgear.
"""

from __future__ import annotations

from math import cos, inf, sin, tan

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.demands import Ranges
from ncgear.optimum.certified.motion import ROUNDING, MotionProgramme
from ncgear.optimum.certified.proof import Linear

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
