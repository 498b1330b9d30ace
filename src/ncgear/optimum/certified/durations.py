"""The least time of both strokes under upper bounds of the motion, as a bound and not as a quadrature."""

from __future__ import annotations

from math import isinf

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.ceilings import Peaks
from ncgear.optimum.certified.passes import Ceilings
from ncgear.optimum.certified.road import Road
from ncgear.optimum.task import Limits, Task


def least_durations_s(road: Road, task: Task, limits: Limits, peaks: Peaks, ceilings: Ceilings) -> tuple[float, float]:
    """Times in s that no motion below the ceilings can do with less, of the working stroke and of the return.

    Each cell takes the largest of four bounds, each exact for the limit that it comes from: the roof that acceleration
    leaves over the cell, the least ratio, the work at full power, and the roof that the pressure angle leaves.
    """
    bounds = [
        road.turn_rad * limits.ratio_min / task.speed_rad_s,
        _working_s(road, limits, peaks),
        _roofed_s(road, peaks, ceilings),
    ]
    if not isinf(limits.steepness):
        bounds.append(_steered_s(road, task, limits.steepness, ceilings.turning))
    seconds = np.max(bounds, axis=0)
    return float(seconds[: road.extended].sum()), float(seconds[road.extended :].sum())


def _working_s(road: Road, limits: Limits, peaks: Peaks) -> Array:
    """Work at full power: dt >= F dx / P, and with a mass, which gives back m A dx at most, (F - m A) dx / P."""
    if isinf(peaks.power_w):
        return np.zeros(road.work_n_mm.shape)
    given_back = limits.mass_kg * peaks.acceleration_mm_s2 * road.length_mm / 1000.0 if limits.mass_kg else 0.0
    lasting: Array = np.maximum(road.work_n_mm - given_back, 0.0) / (1000.0 * peaks.power_w)
    return lasting


def _roofed_s(road: Road, peaks: Peaks, ceilings: Ceilings) -> Array:
    """Time under a roof whose slopes are the largest rise and the acceleration limit; linear in u on each side."""
    start, end = ceilings.energy_mm2_s2[:-1], ceilings.energy_mm2_s2[1:]
    length, rise, fall = road.length_mm, ceilings.rising_mm_s2, peaks.acceleration_mm_s2
    if np.all(np.isinf(rise)):
        return np.zeros(length.shape)
    ridge = length
    if not isinf(fall):
        crossing = np.divide(end - start + fall * length, rise + fall, out=length.copy(), where=rise + fall > 0.0)
        ridge = np.clip(crossing, 0.0, length)
    peak = np.maximum(start + rise * ridge, 0.0)
    return linear_s(start, peak, ridge) + linear_s(peak, end, length - ridge)


def linear_s(start: Array, end: Array, length: Array) -> Array:
    """Integral of dx / sqrt(2 u) in s for u linear along lengths in mm; 0 for no length."""
    total = np.sqrt(2.0 * start) + np.sqrt(2.0 * end)
    seconds = np.zeros(length.shape)
    np.divide(2.0 * length, total, out=seconds, where=length > 0.0)
    return seconds


def _steered_s(road: Road, task: Task, steepest: float, turning: Array) -> Array:
    """Time under a roof of ln(1 + s) = w: the integral of dphi2 / (omega (exp(w) - 1)) has a closed form."""
    w = np.log1p(turning)
    peak = np.maximum((w[:-1] + w[1:] + steepest * road.turn_rad) / 2.0, np.maximum(w[:-1], w[1:]))
    integral = np.log(-np.expm1(-peak)) * 2.0 - np.log(-np.expm1(-w[:-1])) - np.log(-np.expm1(-w[1:]))
    seconds: Array = np.maximum(integral, 0.0) / (steepest * task.speed_rad_s)
    return seconds
