"""The largest loads of a cycle, located exactly: stationary points of the closed forms, both sides of every joint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import sqrt

import numpy as np

from ncgear.dynamics.inverse import Loads, RigidMachine
from ncgear.kinematics.stretches import Stretch, stretches
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, extremes_on
from ncgear.numerics.jet import Jet
from ncgear.numerics.vector import Vector

Gridded = tuple[Stretch, Array]
"""A stretch with the driving angles between which extreme values are looked for."""


@dataclass(frozen=True)
class MeshPeak:
    """Largest mesh force in N and the pressure angle in rad there."""

    force_n: Extremum
    pressure_angle_rad: float


@dataclass(frozen=True)
class LoadPeaks:
    """Extreme driving torques in N mm and largest sizes of forces in N, with the driving angles of each."""

    most_torque_n_mm: Extremum
    least_torque_n_mm: Extremum
    wrist_n: Extremum
    pin_n: Extremum
    crank_bearing_n: Extremum
    guide_n: Extremum
    mesh: MeshPeak | None


def load_peaks(rigid: RigidMachine) -> LoadPeaks:
    """Peaks over one cycle."""
    cycle = [(stretch, _grid(rigid, stretch)) for stretch in stretches(rigid.machine)]
    least, most = _range(rigid, cycle, lambda loads: loads.driving_torque)
    return LoadPeaks(
        most_torque_n_mm=most,
        least_torque_n_mm=least,
        wrist_n=_largest(rigid, cycle, lambda loads: loads.wrist),
        pin_n=_largest(rigid, cycle, lambda loads: loads.pin),
        crank_bearing_n=_largest(rigid, cycle, lambda loads: loads.crank_bearing),
        guide_n=_largest(rigid, cycle, lambda loads: Vector(loads.guide, loads.guide * 0.0)),
        mesh=None if rigid.place is None else _mesh_peak(rigid, cycle),
    )


def _mesh_peak(rigid: RigidMachine, cycle: Sequence[Gridded]) -> MeshPeak:
    found = [(part, _range(rigid, [part], lambda loads: loads.gripped.size_n)[1]) for part in cycle]
    (stretch, _), highest = max(found, key=lambda item: item[1].value)
    angle = rigid.on(stretch, np.array([highest.at])).gripped.pressure_angle_rad
    return MeshPeak(highest, float(angle.value[0]))


def _largest(rigid: RigidMachine, cycle: Sequence[Gridded], vector: Callable[[Loads], Vector]) -> Extremum:
    """Largest length of a vector."""
    highest = _range(rigid, cycle, lambda loads: vector(loads).dot(vector(loads)))[1]
    return Extremum(sqrt(highest.value), highest.at)


def _range(
    rigid: RigidMachine, cycle: Sequence[Gridded], quantity: Callable[[Loads], Jet]
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value over the stretches."""
    ranges = [extremes_on(partial(_along, rigid, stretch, quantity), grid) for stretch, grid in cycle]
    return min((low for low, _ in ranges), key=_value), max((high for _, high in ranges), key=_value)


def _grid(rigid: RigidMachine, stretch: Stretch) -> Array:
    """Even driving angles and those of the breaks, and the middles between: at a narrow peak of the resistance the
    slopes at both feet and at the top may have one sign, those between have both."""
    even = np.linspace(stretch.start_rad, stretch.end_rad, stretch.samples)
    edges = np.union1d(even, rigid.breaks(stretch))
    return np.union1d(edges, (edges[1:] + edges[:-1]) / 2.0)


def _along(rigid: RigidMachine, stretch: Stretch, quantity: Callable[[Loads], Jet], phi1: Array) -> Jet:
    return quantity(rigid.on(stretch, phi1))


def _value(extremum: Extremum) -> float:
    return extremum.value
