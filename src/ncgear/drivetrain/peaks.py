"""The largest loads of all shafts of a cycle, searched together: a look at the machine serves every part around it.

The bending that a fibre of a shaft sees follows from the moment in the frame of the shaft, over all turns in which
gears and cycle come back to where they began; its convex hull tells the largest and the least moment of any fibre.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice

import numpy as np

from ncgear.drivetrain.bearings import (
    BearingLife,
    Bend,
    BornePeaks,
    Seats,
    WantedLife,
    bearing_lives,
    bending_moment_n_mm,
    bending_places_mm,
    borne_sizes,
    gear_sides_mm,
    most_bent,
)
from ncgear.drivetrain.cycle import Cycle, LoadsAt
from ncgear.drivetrain.shafts import KNOWN, BentShaft
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.highest import hull_of_each, largest_from


@dataclass(frozen=True, eq=False)
class ShaftPeaks:
    """The largest loads of a shaft in a cycle: bending anywhere, the least and the largest torque at each gear, and the
    moments beside each gear."""

    bearings: tuple[BearingLife, BearingLife]
    bent: Bend
    torques_n_mm: list[tuple[float, float]]
    sections: list[BentShaft]


def shaft_peaks(cycle: Cycle, shafts: Mapping[int, Seats], wanted: WantedLife) -> dict[int, ShaftPeaks]:
    """The largest loads of shafts with these seats, by their numbers from the driving shaft on."""
    if not shafts:
        return {}
    places_mm = {number: bending_places_mm(cycle.loads.shafts[number], seats) for number, seats in shafts.items()}

    def sizes(loads: LoadsAt) -> Array:
        every = list[Array]()
        for number, seats in shafts.items():
            shaft = loads.shafts[number]
            every += borne_sizes(shaft, seats)
            every += (np.abs(bending_moment_n_mm(shaft, seats, at)) for at in places_mm[number])
            every += (sign * gear.torque_n_mm for gear in shaft.gears for sign in (-1.0, 1.0))
        return np.stack(every)

    values = sizes(cycle.loads)
    exactly = np.zeros(len(values))
    found = iter(largest_from(lambda at: sizes(cycle.loads_at(at)), cycle.loads.phi1_rad, values, exactly))
    hulls, peaks = iter(_hulls(cycle, shafts)), dict[int, ShaftPeaks]()
    for number, seats in shafts.items():
        borne = BornePeaks(*islice(found, 3)), BornePeaks(*islice(found, 3))
        moments = {at: next(found).value for at in places_mm[number]}
        torques = [(-next(found).value, next(found).value) for _ in seats.gears_mm]
        sections = [
            BentShaft(next(hulls), moments[side], torque)
            for at, torque in zip(seats.gears_mm, torques, strict=True)
            for side in gear_sides_mm(cycle.loads.shafts[number], at)
        ]
        lives = bearing_lives(cycle, number, seats, wanted, borne)
        peaks[number] = ShaftPeaks(lives, most_bent(moments, seats), torques, sections)
    return peaks


def _hulls(cycle: Cycle, shafts: Mapping[int, Seats]) -> list[ComplexArray]:
    """The corners of the hulls of the moments beside all gears in the frames of their shafts, over all turns."""
    sides = [
        (number, seats, side)
        for number, seats in shafts.items()
        for at in seats.gears_mm
        for side in gear_sides_mm(cycle.loads.shafts[number], at)
    ]

    def moments(loads: LoadsAt) -> ComplexArray:
        seen = ((loads.shafts[number], seats, side) for number, seats, side in sides)
        return np.stack([bending_moment_n_mm(*at) * np.exp(-1j * at[0].turned_rad) for at in seen])

    known = moments(cycle.loads)
    missed = KNOWN * np.abs(known).max(axis=1)
    once = hull_of_each(lambda at: moments(cycle.loads_at(at)), cycle.loads.phi1_rad, known, missed)
    return [(hull * turned_back(cycle, number)).ravel() for hull, (number, *_) in zip(once, sides, strict=True)]


def turned_back(cycle: Cycle, number: int) -> ComplexArray:
    """The frame of a shaft at the beginnings of the cycles after which it is in its first position again, (k, 1).

    A shaft between two pairs turns once in a cycle, like the crank, since these have one lobe each.
    """
    lobes, first = cycle.rigid.machine.transmission.lobes, cycle.rigid.places[0]
    turns = np.arange(lobes.driving if number == 0 else 1)[:, None]
    return np.asarray(np.exp(-1j * first.driven_sense * first.mesh.sense * cycle.cycle_rad * turns))
