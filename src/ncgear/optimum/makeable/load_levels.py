"""Levels of what the machine feels with its masses: power, torque, flywheel, forces on bearings, frame and teeth.

Each is the figure of the same name of ``ncgear.optimum.felt``.  Units are of the order of what a crank that turns
evenly feels.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, sqrt

import numpy as np

from ncgear.dynamics.driving_shaft import KG_MM2
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.optimum.makeable import quantities
from ncgear.optimum.makeable.levels import Kind, Level, limit_offer
from ncgear.optimum.makeable.quantities import Place, Slider, Term
from ncgear.optimum.offers import Offer
from ncgear.optimum.task import Limits, Prices, Task

LEAST_N_MM, LEAST_N = 1.0, 1e-3
"""Least units of torque and force, for a machine that feels next to nothing."""

ROUND = 1e-4
"""Force, in its unit, by which the size of a force is rounded where it is zero; at a peak of one unit it adds 5e-9."""


@dataclass(frozen=True)
class MachineScales:
    """A machine with masses, and units of its driving torque in N mm and of forces in N on bearings and frame."""

    task: Task
    torque_n_mm: float
    bearing_n: float
    shaking_n: float


def machine_scales(task: Task, slider: Slider) -> MachineScales:
    """What a crank that turns evenly feels; the columns of ``slider`` are at places around the turn, (n,) each."""
    even, turning_rad_s = Place(0.0, 1.0, 1.0, 0.0, 0.0), task.speed_rad_s * 2.0 * pi / task.cycle_rad

    def largest(term: Term) -> float:
        return float(np.max(np.abs(term)))

    def size(force: tuple[Array, Array]) -> float:
        return max(largest(np.hypot(*force)), LEAST_N)

    return MachineScales(
        task,
        max(largest(quantities.driving_torque(even, slider, turning_rad_s)), LEAST_N_MM),
        size(quantities.bearing_force(even, slider, turning_rad_s)),
        size(quantities.shaking_force(even, slider, turning_rad_s)),
    )


def of_loads(units: MachineScales, limits: Limits, prices: Prices) -> Iterator[Level]:
    """The levels of all limits and prices on loads, the peak power among them."""
    task, speed, torque = units.task, units.task.speed_rad_s, units.torque_n_mm

    def driving(at: Place, slider: Slider) -> Term:
        return quantities.driving_torque(at, slider, speed) / torque

    per_power = torque * speed * N_M_PER_N_MM
    yield from _level(
        ("peak_power_w", limits, prices, per_power),
        lambda at, slider, length: (driving(at, slider),),
        lambda value: limit_offer("peak_power_w", "a peak power of {} W", shown_above(value)),
    )
    # Nothing is gained by a shaft that never brakes
    yield from _level(
        ("braking_power_w", limits, prices, per_power),
        lambda at, slider, length: (-driving(at, slider), 0.0),
        lambda value: limit_offer("braking_power_w", "a braking power of {} W", shown_above(value)),
    )
    yield from _mean_square(task, limits, prices, torque, driving)
    yield from _level(
        ("flywheel_kg_mm2", limits, prices, KG_MM2 * torque / (task.speed_fluctuation * speed**2)),
        lambda at, slider, length: (driving(at, slider),),
        lambda value: limit_offer("flywheel_kg_mm2", "a flywheel of {} kg mm^2", shown_above(value)),
        Kind.SWING,
    )
    for name, unit, words, force in (
        ("bearing_force_n", units.bearing_n, "crank's bearings", quantities.bearing_force),
        ("shaking_force_n", units.shaking_n, "frame", quantities.shaking_force),
    ):
        yield from _force((name, limits, prices, unit), words, speed, force)
    if limits.tooth_force_n is not None:
        yield _tooth_force(task, limits.tooth_force_n)


Asked = tuple[str, Limits, Prices, float]
"""The name of a figure, all limits and prices, and what one unit of its level is in the unit of the figure."""


def _level(
    asked: Asked,
    sides: Callable[[Place, Slider, Term], tuple[Term, ...]],
    shown: Callable[[float], Offer],
    kind: Kind = Kind.PEAK,
) -> Iterator[Level]:
    """The level of a figure that has a limit or a price; ``shown`` says a limit in words."""
    name, limits, prices, unit = asked
    limit, price = getattr(limits, name), getattr(prices, name, 0.0)
    if limit is not None or price:
        cap = None if limit is None else limit / unit
        yield Level(name, cap, price * unit, sides, lambda level: shown(level * unit), kind=kind)


def _mean_square(
    task: Task, limits: Limits, prices: Prices, torque: float, driving: Callable[[Place, Slider], Term]
) -> Iterator[Level]:
    """The mean of the squared driving torque; a price on it alone makes the root least too."""
    limit, price, unit = limits.rms_torque_n_m, prices.rms_torque_n_m, torque * N_M_PER_N_MM
    if limit is not None or price:
        yield Level(
            "rms_torque_n_m",
            None if limit is None else (limit / unit) ** 2,
            price,
            lambda at, slider, length: (driving(at, slider) ** 2 / task.cycle_rad,),
            lambda level: limit_offer(
                "rms_torque_n_m", "an r.m.s. torque of {} N m", shown_above(sqrt(max(level, 0.0)) * unit)
            ),
            kind=Kind.INTEGRAL,
        )


def _force(
    asked: Asked, words: str, speed: float, force: Callable[[Place, Slider, Term], tuple[Term, Term]]
) -> Iterator[Level]:
    unit = asked[-1]

    def sides(at: Place, slider: Slider, length: Term) -> tuple[Term, ...]:
        along, across = force(at, slider, speed)
        return (((along / unit) ** 2 + (across / unit) ** 2 + ROUND**2) ** 0.5,)

    said = f"a force of {{}} N on the {words}"
    yield from _level(asked, sides, lambda value: limit_offer(asked[0], said, shown_above(value)))


def _tooth_force(task: Task, limit: float) -> Level:
    """The force of the flanks that carry: of those that do not, the other sign is far under the limit."""
    size = task.gears
    assert size is not None
    lobes, idle = task.lobes.driving, size.idle_angle_rad
    angles = size.rack_angle_rad, size.rack_angle_rad if idle is None else idle

    def sides(at: Place, slider: Slider, length: Term) -> tuple[Term, ...]:
        distance = size.center_distance_mm
        if size.teeth is not None and size.module_mm is not None:
            distance = size.teeth * pi * size.module_mm / (lobes * length)
        # Of the driven gear
        torque = quantities.driving_torque(at, slider, task.speed_rad_s) * at.ratio
        pushing, back = quantities.inverse_levers(at, angles)
        return torque * pushing / distance / limit, -torque * back / distance / limit

    return Level(
        "tooth_force_n",
        1.0,
        0.0,
        sides,
        lambda level: limit_offer("tooth_force_n", "a force of {} N between the teeth", shown_above(level * limit)),
    )
