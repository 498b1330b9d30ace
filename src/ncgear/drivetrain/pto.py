"""A shaft of constant speed, such as a tractor's, before a torque limiter or an overrunning clutch.

A torque limiter passes no more than a set torque.  Where the machine at the shaft's speed w_0 asks for more, it slips:
the machine gets the set torque T_s, slows down and, once it asks for less, comes back to w_0.  An overrunning clutch
passes no braking torque: where the machine would drive the shaft, it gets T_s = 0 and runs ahead.  In either case the
work that the machine gets beyond its demand at w_0,

    D(phi) = integral of (T_s - T) dphi from where it lets go,

is in its masses: w^2 = w_0^2 + 2 D / J (T and J as in ``ncgear.drivetrain.losses``; both sides of the balance have the
same A).  The clutch catches again where D is 0 again.  So the speed follows without solving an equation in time.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.drivetrain.cycle import CLOSE_RAD, WIDEST_RAD, panels_between
from ncgear.drivetrain.losses import Demand
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.quadrature import gauss_points
from ncgear.numerics.zeros import all_zeros, zeros_between

NODES = 10
"""Gauss points of a panel for the heat of a limiter."""


@dataclass(frozen=True)
class Excursion:
    """A stretch of the cycle in which the coupling lets go.

    ``start_rad`` and ``end_rad`` are driving angles of the machine; the end may be in the next cycle, and is None where
    the machine does not come back to its speed within a cycle.  ``speed_rad_s`` is the speed farthest from the shaft's
    with its driving angle, 0 where the machine stops.  ``energy_n_mm`` is the most that its masses gain, or lose where
    it is below 0; ``heat_n_mm`` is the work that slipping turns into heat, None where the machine
    does not come back.
    """

    start_rad: float
    end_rad: float | None
    speed_rad_s: Extremum
    energy_n_mm: float
    heat_n_mm: float | None
    cycle_rad: float

    @property
    def last_rad(self) -> float:
        """The end or, without one, the end of a cycle."""
        return self.start_rad + self.cycle_rad if self.end_rad is None else self.end_rad


def slipping(demand: Demand, limit_n_mm: float) -> list[Excursion]:
    """Where a limiter set to a torque over 0 slips, in the order of the driving angle; empty where it holds."""
    return _excursions(demand, limit_n_mm, -1.0)


def running_ahead(demand: Demand) -> list[Excursion]:
    """Where an overrunning clutch lets the machine run ahead; empty where it never does."""
    return _excursions(demand, 0.0, 1.0)


def _excursions(demand: Demand, held_n_mm: float, sign: float) -> list[Excursion]:
    """Stretches in which ``sign`` times (held less asked torque) is over 0, until the coupling has caught again."""
    torque = demand.fluctuation.torque
    series = -sign * torque.coefficients
    series[0] += sign * held_n_mm
    excess = PiecewiseChebyshev(torque.breaks, series)
    cycle, start = float(np.ptp(torque.breaks)), float(torque.breaks[0])
    places = np.union1d(all_zeros(excess), torque.breaks)
    positive = (excess((places[1:] + places[:-1]) / 2.0) > 0.0) & (np.diff(places) > CLOSE_RAD)
    if positive.all():
        return [_lasting(demand, held_n_mm, sign)]
    work = excess.integrated()

    def gained(phi1: Array) -> Array:
        """The integral of the excess from the cycle's beginning on, in any cycle."""
        turns, local = np.divmod(phi1 - start, cycle)
        return np.asarray(turns * work.final + work(start + local))

    later = np.concatenate([places, places[1:] + cycle, places[1:] + 2.0 * cycle])
    begins = places[:-1][positive & ~np.roll(positive, 1)]
    found: list[Excursion] = []
    until = -np.inf
    # The excursions of a first cycle only show from where on the second cycle is free.
    for begin in [*begins, *(begins + cycle)]:
        if begin < until:
            continue
        end = _end_rad(gained, float(begin), later, cycle)
        until = begin + cycle if end is None else end
        if begin >= start + cycle:
            found.append(_excursion(demand, gained, held_n_mm, sign, float(begin) - cycle, end and end - cycle))
    return found


def _end_rad(gained: Callable[[Array], Array], begin: float, places: Array, cycle: float) -> float | None:
    """Place where the gained work is lost again: between two places the gain only grows or only falls."""
    later = np.append(places[(places > begin) & (places < begin + cycle)], begin + cycle)
    left = gained(later) - gained(np.array([begin]))
    back = np.nonzero(left < 0.0)[0]
    if not back.size:
        return None
    number = int(back[0])
    low = later[number - 1 : number] if number else np.array([begin])
    own = gained(np.array([begin]))
    return float(zeros_between(lambda phi1: gained(phi1) - own, low, later[number : number + 1])[0])


def _excursion(
    demand: Demand, gained: Callable[[Array], Array], held_n_mm: float, sign: float, begin: float, end: float | None
) -> Excursion:
    """The energies and speeds between the angles at which the coupling lets go and catches again."""
    cycle, speed = demand.cycle.cycle_rad, demand.speed_rad_s
    edges = panels_between(np.array([begin, begin + cycle if end is None else end]), WIDEST_RAD / 8.0)
    own = gained(np.array([begin]))

    def square(phi1: Array) -> Array:
        inertia = demand.inertia(np.mod(phi1, cycle))[0]
        return np.asarray(speed**2 + sign * 2.0 * (gained(phi1) - own) / inertia)

    farthest = largest_of_each(lambda phi1: np.stack([sign * square(phi1), gained(phi1) - own]), edges)
    most = sign * farthest[0].value
    points, weights = gauss_points(edges, NODES)
    heat = None
    if most > 0.0 and end is not None:
        turning = np.sqrt(square(points))
        heat = float(np.sum(weights * held_n_mm * (speed - turning) / turning))
    extreme = Extremum(float(np.sqrt(max(most, 0.0))), float(farthest[0].at % cycle))
    return Excursion(begin, end, extreme, sign * farthest[1].value, heat, cycle)


def _lasting(demand: Demand, held_n_mm: float, sign: float) -> Excursion:
    """A coupling that never catches: a limiter set below all torques, a clutch that is never asked for any."""
    begin = float(demand.fluctuation.torque.breaks[0])
    gained = abs(demand.fluctuation.work_n_mm - held_n_mm * demand.cycle.cycle_rad)
    speed = Extremum(0.0 if sign < 0.0 else demand.speed_rad_s, begin)
    return Excursion(begin, None, speed, sign * gained, None, demand.cycle.cycle_rad)
