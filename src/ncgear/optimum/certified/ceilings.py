"""How fast the slider may be at each place, seen alone: half its speed squared, u, from above and from below."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.road import Road
from ncgear.optimum.task import Limits, Task


@dataclass(frozen=True)
class Peaks:
    """A wished pair of peaks: magnitude of the slider's acceleration in mm/s^2, power in W; infinite for free ones."""

    acceleration_mm_s2: float = inf
    power_w: float = inf


def energy(speed_mm_s: Array) -> Array:
    """u = v^2 / 2 in mm^2/s^2; its derivative by the way is the acceleration."""
    return speed_mm_s * speed_mm_s / 2.0


def ceiling(road: Road, task: Task, limits: Limits, peaks: Peaks) -> Array:
    """Largest u at each place, shape (n + 1,), in mm^2/s^2.

    From the least ratio, v = omega x'(phi2) / i12; from power, F v <= P, where F presses; with a mass, (F + m a) v <= P
    and a >= -A leave (F - m A) v <= P; from a limited pressure angle, see ``_steerable``.
    """
    turning, mass = turning_ceiling(road, task, limits, peaks), limits.mass_kg
    # In kg, mm and s: 1 N is 1000 kg mm/s^2, 1 W is 1e6 kg mm^2/s^3.
    pressing = 1000.0 * road.force_n - (mass * peaks.acceleration_mm_s2 if mass else 0.0)
    by_power = np.full(pressing.shape, inf)
    np.divide(1e6 * peaks.power_w, pressing, out=by_power, where=pressing > 0.0)
    return energy(np.minimum(task.speed_rad_s * road.slope_mm_rad * turning, by_power))


def floor(road: Road, task: Task, limits: Limits) -> Array:
    """Least u at each place, shape (n + 1,), in mm^2/s^2: from the largest ratio."""
    return energy(task.speed_rad_s * road.slope_mm_rad / limits.ratio_max)


def turning_ceiling(road: Road, task: Task, limits: Limits, peaks: Peaks) -> Array:
    """Largest s = dphi2/dphi1 at each place, shape (n + 1,), where the ratio is continuous."""
    return np.minimum(1.0 / limits.ratio_min, _steerable(road, task, limits, peaks))


def _steerable(road: Road, task: Task, limits: Limits, peaks: Peaks) -> Array:
    """Largest s at which some allowed change of s keeps the acceleration within its limit.

    The acceleration is omega^2 (x'' s^2 + x' s ds/dphi2), and |ds/dphi2| <= t (1 + s) from the pressure angle.  The
    least magnitude it can have is omega^2 ((|x''| - t |x'|) s^2 - t |x'| s); at a dead centre, omega^2 |x''| s^2.
    """
    if isinf(limits.steepness) or isinf(peaks.acceleration_mm_s2):
        return np.full(road.way_mm.shape, inf)
    rest = peaks.acceleration_mm_s2 / task.speed_rad_s**2
    linear = limits.steepness * road.slope_mm_rad
    square = road.bend_mm_rad2 - linear
    found = np.full(square.shape, inf)
    root = np.sqrt(linear**2 + 4.0 * np.maximum(square, 0.0) * rest)
    np.divide(linear + root, 2.0 * square, out=found, where=square > 0.0)
    return found
