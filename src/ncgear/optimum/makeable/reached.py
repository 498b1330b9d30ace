"""The levels that a trigonometric series reaches around a turn: the judge of the optimiser, in plain arrays.

``Basis`` holds the series and its derivatives at even places of a turn, as matrices on its coefficients.  ``Stations``
holds how the slider moves with the crank at these places, and what resists it there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, pi

import numpy as np

from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import Resistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.optimum.makeable.quantities import Place, Slider, length_rates
from ncgear.optimum.makeable.wishes import Level


@dataclass(frozen=True, eq=False)
class Basis:
    """Rows of values, first and second derivatives at n angles; columns cos 1.., sin 1.., shape (n, 2 harmonics)."""

    value: Array
    first: Array
    second: Array


def basis(angle_rad: Array, harmonics: int) -> Basis:
    """The matrices at angles in rad, shape (n,)."""
    waves = np.arange(1, harmonics + 1)
    cosine, sine = np.cos(np.outer(angle_rad, waves)), np.sin(np.outer(angle_rad, waves))
    value = np.hstack([cosine, sine])
    return Basis(value, np.hstack([-waves * sine, waves * cosine]), -value * np.tile(waves**2, 2))


ORDER = 3
"""Derivatives of the slider's displacement by the crank angle: jerk needs the third."""


@dataclass(frozen=True, eq=False)
class Stations:
    """n places of the crank: phi2, and the slider there, shape (n,) each."""

    phi2_rad: Array
    slider: Slider

    @property
    def count(self) -> int:
        """Number of places."""
        return self.phi2_rad.size


def stations(linkage: Mechanism, resistance: Resistance, count: int) -> Stations:
    """``count`` places evenly around one turn of the crank, from its retracted dead centre on."""
    phi2 = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
    variable = np.zeros((ORDER + 1, count))
    variable[0], variable[1] = phi2, 1.0
    displacement = linkage.displacement(Jet(variable))
    working = phi2 < linkage.working_angle_rad
    force = np.where(working, resistance.force_n(displacement.value), 0.0)
    first, second, third = (displacement.derivative(order) for order in range(1, ORDER + 1))
    return Stations(phi2, Slider(first, second, third, force))


NARROW = 0.01
"""Share of itself by which a top of the force may be over the places beside it and count as shown by them."""


def hidden_tops_mm(at: Stations, linkage: Mechanism, resistance: Resistance) -> Array:
    """Displacements in mm at which the force has tops that the even places do not show, shape (n,)."""
    turns = resistance.turns_mm(linkage.stroke_mm)
    if not turns.size:
        return turns
    angle = linkage.crank_angle(turns, np.zeros(turns.size, dtype=bool))
    nearest = np.round(angle / (2.0 * pi) * at.count).astype(int)
    shown = np.max([at.slider.force_n[(nearest + beside) % at.count] for beside in (-1, 0, 1)], axis=0)
    hidden: Array = turns[resistance.force_n(turns) * (1.0 - NARROW) > shown]
    return hidden


@dataclass(frozen=True, eq=False)
class Grid:
    """Places around a turn of the crank, and the series' matrices there."""

    stations: Stations
    basis: Basis


def grid(stations: Stations, harmonics: int) -> Grid:
    """Places with the matrices of so many harmonics."""
    return Grid(stations, basis(stations.phi2_rad, harmonics))


def closing_constant(series: Array, cycle_rad: float) -> float:
    """c0 that closes the cycle, from the series at even places of a turn: the mean of i12 is the cycle over 2 pi."""
    return log(cycle_rad / (2.0 * pi)) - log(float(np.mean(np.exp(series))))


def ratios(on: Grid, coefficients: Array, cycle_rad: float) -> tuple[Place, ...]:
    """i12 at all places of a grid, shape (n,) each, and iB where coefficients of a second stage follow."""
    size = on.basis.value.shape[1]
    cycles = cycle_rad, 2.0 * pi
    return tuple(_ratio(on, one, cycle) for one, cycle in zip(coefficients.reshape(-1, size), cycles, strict=False))


def _ratio(on: Grid, coefficients: Array, cycle_rad: float) -> Place:
    series = on.basis.value @ coefficients
    logarithm = series + closing_constant(series, cycle_rad)
    return Place(
        logarithm,
        np.exp(logarithm),
        np.exp(-logarithm),
        on.basis.first @ coefficients,
        on.basis.second @ coefficients,
    )


def lengths(at: Sequence[Place]) -> list[float]:
    """Length that every pair rolls in one cycle over its centre distance, from the ratios at even places of a turn."""
    return [2.0 * pi * float(np.mean(rate)) for rate in length_rates(at)]


def reached(levels: Sequence[Level], on: Grid, at: Sequence[Place]) -> Array:
    """The largest value of every level's terms around the turn, shape (levels,)."""
    return np.array([max(float(np.max(peaks(term))) for term in terms) for terms in _terms(levels, on, at)])


def beyond(levels: Sequence[Level], finer: Grid, at: Sequence[Place], places: int) -> Array:
    """By how much every term is larger around each of ``places`` places than at the place, shape (terms * places,).

    The finer grid has an even number of places for each of them, the first of them at the place itself.  "Around" means
    half a step to both sides.
    """
    return np.concatenate([_around(term, places) for terms in _terms(levels, finer, at) for term in terms])


def _terms(levels: Sequence[Level], on: Grid, at: Sequence[Place]) -> list[tuple[Array, ...]]:
    rolled = lengths(at)
    return [level.terms(at, on.stations.slider, rolled) for level in levels]


def _around(values: Array, places: int) -> Array:
    each = values.size // places
    near = np.roll(peaks(values), each // 2).reshape(places, each)
    # The last of each stretch is the first of the next
    last = np.roll(near[:, 0], -1)
    rise: Array = np.maximum(np.max(near, axis=1), last) - values[::each]
    return rise


def peaks(values: Array) -> Array:
    """Values of a function around a turn, with local maxima replaced by the peaks beside them.

    A peak is that of the parabola through a place and its neighbours, plus what the third derivative, from two more
    neighbours, adds there.  Peaks are then missed by the fourth power of the distance; places alone miss them by the
    second, parabolas alone by the third.
    """
    before, after = np.roll(values, 1), np.roll(values, -1)
    bend = before - 2.0 * values + after
    peak = (values >= before) & (values >= after) & (bend < 0.0)
    share = np.where(peak, (after - before) / np.where(peak, -2.0 * bend, 1.0), 0.0)
    third = (np.roll(values, -2) - 2.0 * after + 2.0 * before - np.roll(values, 2)) / 2.0
    rise = share * (after - before) / 4.0 + third * share * (share**2 - 1.0) / 6.0
    return np.asarray(values + rise)
