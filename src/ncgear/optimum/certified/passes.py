"""The fastest motion between ceilings: one pass forwards and one backwards for each limit that links places.

Every limit binds u and its slope at one place only, so the larger of two allowed motions is allowed at every place,
and there is a fastest one.  What a pass leaves at the places is never below it: each pass takes from u only what no
allowed motion reaches, whatever the motion does inside the cells.

The least times of both strokes under these upper bounds are themselves bounds, not quadratures.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asinh, inf, isinf, sinh, sqrt

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.road import Peaks, Road, ceiling, floor, turning_ceiling
from ncgear.optimum.task import Limits, Task

ROUNDS = 60
"""Most rounds of the passes of acceleration and of pressure angle; stopping early leaves bounds, only weaker ones."""

SETTLED = 1e-7
"""Relative change of u in a round that ends the rounds."""

ROUNDING = 1e-9
"""Relative slack of comparisons.  Cancellation in the travel and in the passes is below 1e-15 of A times two strokes.
It matters in the cells at the dead centres only: by 1e-9 of their u with 3000 cells, by 1e-12 of the cycle time."""


@dataclass(frozen=True, eq=False)
class Ceilings:
    """Upper bounds of every allowed motion.

    Of shape (n + 1,): ``energy_mm2_s2`` (u) and ``turning`` (s = dphi2/dphi1) at the places; of shape (n,):
    ``rising_mm_s2``, the largest slope of u in the sense of motion within each cell.
    """

    energy_mm2_s2: Array
    turning: Array
    rising_mm_s2: Array


def fastest(road: Road, task: Task, limits: Limits, peaks: Peaks) -> Ceilings | None:
    """Upper bounds of the fastest motion; None where they fall below what the largest ratio needs, so there is none."""
    highest = ceiling(road, task, limits, peaks)
    if isinf(limits.steepness):
        energy, rising = _swept(highest, road, limits, peaks)
        turning = np.full(energy.shape, 1.0 / limits.ratio_min)
    else:
        energy, turning, rising = _swept_steered(highest, road, task, limits, peaks)
    lowest = floor(road, task, limits)
    if np.any(energy * (1.0 + ROUNDING) < lowest) or np.any(turning * (1.0 + ROUNDING) < 1.0 / limits.ratio_max):
        return None
    return Ceilings(energy, turning, rising)


def _swept(highest: Array, road: Road, limits: Limits, peaks: Peaks) -> tuple[Array, Array]:
    """u at the places and its largest slope in the cells, from acceleration and, with a mass, power."""
    most = peaks.acceleration_mm_s2
    energy = highest if isinf(most) else sloped(highest, road.travel_mm, most)
    if limits.mass_kg and not isinf(peaks.power_w):
        return _pushed(energy, road, limits.mass_kg, peaks)
    return energy, np.full(road.length_mm.shape, most)


def _swept_steered(highest: Array, road: Road, task: Task, limits: Limits, peaks: Peaks) -> tuple[Array, Array, Array]:
    """u and s at the places, and the largest slope of u, when the pressure angle links the places as well.

    ln(1 + s) changes by no more than t per rad of the crank, across the dead centres too.
    """
    turning = turning_ceiling(road, task, limits, peaks)
    energy, rising = _swept(highest, road, limits, peaks)
    for _ in range(ROUNDS):
        before = energy
        turning = np.minimum(turning, _turning(energy, road, task))
        turning = np.expm1(_sloped_round(np.log1p(turning), road.crank_angle_rad, limits.steepness))
        energy = np.minimum(energy, (task.speed_rad_s * road.slope_mm_rad * turning) ** 2 / 2.0)
        energy, rising = _swept(energy, road, limits, peaks)
        if np.all(before - energy <= SETTLED * before):
            break
    return energy, turning, rising


def _turning(energy: Array, road: Road, task: Task) -> Array:
    """s from u; infinite at dead centres, where u says nothing about it."""
    turning = np.full(energy.shape, inf)
    driving = task.speed_rad_s * road.slope_mm_rad
    np.divide(np.sqrt(2.0 * energy), driving, out=turning, where=driving > 0.0)
    return turning


def sloped(highest: Array, places: Array, steepest: float) -> Array:
    """The largest function below ``highest`` whose slope is no steeper: min over y of highest(y) + steepest |x - y|."""
    line = steepest * places
    forwards = np.minimum.accumulate(highest - line) + line
    backwards = np.minimum.accumulate((forwards + line)[::-1])[::-1] - line
    return np.clip(backwards, 0.0, highest)


def _sloped_round(highest: Array, angles: Array, steepest: float) -> Array:
    """``sloped`` on a circle, whose last place is its first."""
    turn = angles[-1] - angles[0]
    around = np.concatenate([angles[:-1] - turn, angles, angles[1:] + turn])
    thrice = np.concatenate([highest[:-1], highest, highest[1:]])
    return sloped(thrice, around, steepest)[angles.size - 1 : 2 * angles.size - 1]


def _pushed(highest: Array, road: Road, mass_kg: float, peaks: Peaks) -> tuple[Array, Array]:
    """u at the places and its largest slope in the cells when power also moves a mass."""
    per_mass = 1000.0 * road.force_n / mass_kg
    cells = zip(
        road.length_mm.tolist(),
        per_mass[:-1].tolist(),
        per_mass[1:].tolist(),
        (1000.0 * road.work_n_mm / mass_kg).tolist(),
        strict=True,
    )
    power, most = 1e6 * peaks.power_w / mass_kg, peaks.acceleration_mm_s2
    energy, rising = [float(highest[0])], []
    for cell, top in zip(cells, highest[1:].tolist(), strict=True):
        slope, reached = _pushed_cell(energy[-1], cell, power, most)
        rising.append(slope)
        energy.append(min(top, reached))
    return np.array(energy), np.array(rising)


def _pushed_cell(
    start: float, cell: tuple[float, float, float, float], power: float, most: float
) -> tuple[float, float]:
    """Largest slope of u in a cell, and largest u at its end, of the fastest motion that begins with ``start``.

    ``cell`` is its length, the resistance at both ends and the work of it; resistance, work and power are per unit of
    mass.  With y = v^3 / 3 the motion has y' <= P - F v.  While power is left, P - F v is largest at the start's speed,
    and it does not help to slow down first.  So an explicit step bounds y, and also u, which is concave in y, by its
    slope there.
    """
    length, force, next_force, work = cell
    least, speed = min(force, next_force), sqrt(2.0 * start)
    spare = power - least * (speed if least >= 0.0 else sqrt(2.0 * (start + most * length)))
    if spare < 0.0:
        drag = work if next_force >= force else least * length
        return 0.0, min(start, _braked(speed**3 + 3.0 * power * length, drag) ** 2 / 2.0)
    slope = min(most, spare / speed) if speed > 0.0 else most
    reached = (speed**3 + 3.0 * length * spare) ** (2.0 / 3.0) / 2.0
    return slope, min(start + most * length, reached)


def _braked(cubed: float, drag: float) -> float:
    """The speed at which v^3 + 3 drag v = cubed, both positive; by the hyperbolic form of Cardano's solution.

    Where the resistance takes more than all power and does not fall, the speed falls throughout the cell, so its end
    value v is its least: y grows by P dx - W v at most.  This is an implicit step, and the tighter the stiffer the lack
    of power makes the equation.
    """
    root = sqrt(drag)
    return 2.0 * root * sinh(asinh(cubed / (2.0 * drag * root)) / 3.0)


def least_durations_s(road: Road, task: Task, limits: Limits, peaks: Peaks, ceilings: Ceilings) -> tuple[float, float]:
    """Times in s of the working stroke and of the return that no motion below the ceilings undercuts.

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
