"""The slider's travel over one cycle, cut into cells: first the working stroke, then the return.

Each place by itself bounds the slider's speed there from above and below, as u, half the speed squared.
``Probes`` are points inside the cells at which a motion is compared with its limits.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf, pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.optimum.task import Limits, Task

APART = 1e-7
"""Crank angle in rad below which two places count as one: the displacement, exact to 1e-16 of the stroke, grows with
the square of the angle at a dead centre."""


@dataclass(frozen=True, eq=False)
class Road:
    """Places of one cycle and cells between them; both dead centres are places, and all arrays rise with the crank.

    Of shape (n + 1,): crank angle; travel, the distance gone since the retracted end; slope and bend, the magnitudes of
    the displacement's derivatives by the crank angle; force, zero in the return.  Of shape (n,): the cells' lengths in
    mm and in rad, and the work of the resistance in them.  ``extended`` is the index of the extended dead centre.
    """

    crank_angle_rad: Array
    travel_mm: Array
    slope_mm_rad: Array
    bend_mm_rad2: Array
    force_n: Array
    work_n_mm: Array
    extended: int

    @property
    def length_mm(self) -> Array:
        """Lengths of the cells along the slider's travel."""
        return np.diff(self.travel_mm)

    @property
    def turn_rad(self) -> Array:
        """Crank angles of the cells."""
        return np.diff(self.crank_angle_rad)


def road(task: Task, cells: int, working_share: float) -> Road:
    """The cycle in about ``cells`` cells, the share ``working_share`` of them in the working stroke.

    The cells of each stroke are even in the crank angle; they are also cut where the resistance turns.
    """
    return road_at(task, *_angles(task, cells, working_share))


def road_at(task: Task, angles: Array, extended: int) -> Road:
    """The cycle cut at crank angles in rad, shape (n + 1,), from dead centre to dead centre, 0 to 2 pi.

    ``extended`` is the index of the extended dead centre among them.
    """
    linkage = task.linkage
    position = linkage.displacement(Jet.variable(angles, 2))
    stroke = linkage.stroke_mm
    out = np.clip(position.value, 0.0, stroke)
    out[[0, -1]], out[extended] = 0.0, stroke
    slope = np.abs(position.derivative(1))
    slope[[0, extended, -1]] = 0.0
    force = np.where(np.arange(angles.size) <= extended, task.resistance.force_n(out), 0.0)
    work = np.diff(task.resistance.work_n_mm(out[: extended + 1], stroke))
    return Road(
        crank_angle_rad=angles,
        travel_mm=np.concatenate([out[: extended + 1], 2.0 * stroke - out[extended + 1 :]]),
        slope_mm_rad=slope,
        bend_mm_rad2=np.abs(position.derivative(2)),
        force_n=force,
        work_n_mm=np.concatenate([work, np.zeros(angles.size - 1 - extended)]),
        extended=extended,
    )


def _angles(task: Task, cells: int, working_share: float) -> tuple[Array, int]:
    """Crank angles of all places, and the index of the extended dead centre."""
    working = task.linkage.working_angle_rad
    outward = max(2, round(cells * working_share))
    even = np.linspace(0.0, working, outward + 1)
    turns = task.resistance.turns_mm(task.linkage.stroke_mm)
    if turns.size:
        turns = task.linkage.crank_angle(turns, np.zeros(turns.size, dtype=bool))
    apart = turns[np.abs(turns[:, None] - even).min(axis=1, initial=np.inf) > APART]
    outgoing = np.unique(np.concatenate([even, apart]))
    homeward = np.linspace(working, 2.0 * pi, max(2, cells - outward) + 1)
    return np.concatenate([outgoing, homeward[1:]]), outgoing.size - 1


@dataclass(frozen=True)
class Peaks:
    """Peaks asked for: the magnitude of the slider's acceleration in mm/s^2, and power in W; infinite for free ones."""

    acceleration_mm_s2: float = inf
    power_w: float = inf


def energy(speed_mm_s: Array) -> Array:
    """u = v^2 / 2 in mm^2/s^2; its derivative by the travel is the acceleration."""
    return speed_mm_s * speed_mm_s / 2.0


def ceiling(road: Road, task: Task, limits: Limits, peaks: Peaks) -> Array:
    """Largest u at each place, shape (n + 1,), in mm^2/s^2.

    The least ratio gives v = omega x'(phi2) / i12.  Power gives F v <= P, where F presses; with a mass, (F + m a) v <=
    P and a >= -A leave (F - m A) v <= P.  For a limited pressure angle see ``_steerable``.
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
        return np.full(road.travel_mm.shape, inf)
    rest = peaks.acceleration_mm_s2 / task.speed_rad_s**2
    linear = limits.steepness * road.slope_mm_rad
    square = road.bend_mm_rad2 - linear
    found = np.full(square.shape, inf)
    root = np.sqrt(linear**2 + 4.0 * np.maximum(square, 0.0) * rest)
    np.divide(linear + root, 2.0 * square, out=found, where=square > 0.0)
    return found


SHARES = np.linspace(0.0, 1.0, 9)
"""Where the probes of each cell are, as shares of its crank angle."""


@dataclass(frozen=True, eq=False)
class Probes:
    """The slider at points of the cells, all of shape (n, 9): ``share`` of the cell's length gone, slope and bend.

    ``bend_mm_rad2`` is the signed second derivative of the travel by the crank angle; ``force_n`` is the resistance.
    """

    share: Array
    slope_mm_rad: Array
    bend_mm_rad2: Array
    force_n: Array


def probes(road: Road, task: Task) -> Probes:
    """The points of all cells of a road."""
    angles = road.crank_angle_rad[:-1, None] + road.turn_rad[:, None] * SHARES
    position = task.linkage.displacement(Jet.variable(angles.ravel(), 2))
    displacement = np.clip(position.value, 0.0, task.linkage.stroke_mm).reshape(angles.shape)
    out = (np.arange(road.turn_rad.size) < road.extended)[:, None]
    sense = np.where(out, 1.0, -1.0)
    slope = sense * position.derivative(1).reshape(angles.shape)
    slope[[0, road.extended], 0] = slope[[road.extended - 1, -1], -1] = 0.0
    gone = np.abs(displacement - displacement[:, :1])
    return Probes(
        share=gone / gone[:, -1:],
        slope_mm_rad=np.maximum(slope, 0.0),
        bend_mm_rad2=sense * position.derivative(2).reshape(angles.shape),
        force_n=np.where(out, task.resistance.force_n(displacement), 0.0),
    )
