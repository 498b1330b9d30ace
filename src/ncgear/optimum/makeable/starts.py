"""Where searches for a makeable law begin: at the fastest motion that the limits allow, and at random."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.profile import fastest_motion
from ncgear.optimum.task import Task
from ncgear.optimum.wishes import Wishes

SPREAD = 0.3
"""Standard deviation of the first harmonics of a start at random; higher ones fall off with their number."""

RESAMPLED = 16
"""Places per harmonic at which the fastest motion is read."""


def rough_start(task: Task, wishes: Wishes, peak_acceleration_mm_s2: float) -> Array:
    """Coefficients cos 1.., sin 1.. of the fastest motion under a peak of acceleration, its corners smoothed.

    Its ratio jumps; each harmonic is taken with Lanczos' factor, which takes the overshoot from jumps.
    """
    limits = replace(wishes.limits, peak_acceleration_mm_s2=peak_acceleration_mm_s2)
    motion = fastest_motion(task, limits)
    count = RESAMPLED * wishes.harmonics
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    lowest, highest = np.log(limits.ratio_min), np.log(limits.ratio_max)
    logarithm = np.clip(-np.log(np.interp(angle, motion.crank_angle_rad, motion.slope)), lowest, highest)
    spectrum = np.fft.rfft(logarithm)[1 : wishes.harmonics + 1] * (2.0 / count)
    smoothed = spectrum * np.sinc(np.arange(1, wishes.harmonics + 1) / (wishes.harmonics + 1))
    return np.concatenate([smoothed.real, -smoothed.imag])


def random_starts(harmonics: int, count: int, seed: int) -> Sequence[Array]:
    """So many starts; the same seed gives the same."""
    random = np.random.default_rng(seed)
    falling = SPREAD / np.tile(np.arange(1.0, harmonics + 1.0), 2)
    return [random.normal(size=2 * harmonics) * falling for _ in range(count)]
