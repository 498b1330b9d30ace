"""The mean of 1/s in each cell, its share of the driving angle, as rows of the conic programme."""

from __future__ import annotations

from math import inf, isinf

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.curve_rows import leaning
from ncgear.optimum.certified.demands import Demands, Ranges
from ncgear.optimum.certified.motion import ROUNDING, MotionProgramme
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import TimeWithin


def needs_times(task: Task, asked: Demands) -> bool:
    """Whether a time longer than the true time eases a row: a row of energies, of flanks or of stretches."""
    return (
        task.masses is not None
        or bool(asked.requirements(TimeWithin))
        or any(
            not isinf(one)
            for one in (asked.braking_w, asked.fluctuation_n_mm, asked.torque_n_mm, asked.flank_load_n_mm)
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
