"""The toothed machine at single states, as solvers need it: the formulas of arrays, in plain numbers.

A solver needs some hundred thousand states, one by one.  With arrays most of the time would go into making them; here
the tables' intervals are read once, and only touching pairs are computed.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad, accelerated
from ncgear.dynamics.meshing import Meshing, PairAt
from ncgear.numerics.arrays import Array, Number
from ncgear.numerics.periodic_table import PlaceByPlace, cubic, with_slope


class DrivingSide(Protocol):
    """Answers a moment of the teeth in N mm at a driving speed in rad/s."""

    def answer(self, speed_rad_s: Number, moment_n_mm: Number) -> tuple[Number, Number]:
        """Acceleration of the driving shaft in rad/s^2, and torque of the drive in N mm."""
        ...


class StateByState:
    """The rates of a machine's states; it remembers its last interval in each table."""

    def __init__(self, drive: DrivingSide, meshing: Meshing, load: CrankLoad) -> None:
        self._drive, self._meshing = drive, meshing
        self._law, self._gaps = PlaceByPlace(meshing.law), PlaceByPlace(meshing.gaps.table)
        self._load, self._rise = PlaceByPlace(load.table), float(meshing.law.rise)
        self._slots, self._interval = list[tuple[float, list[list[float]]]](), -1

    def change(self, state: Array) -> Array:
        """Derivatives of a state (phi1, phi1', phi2, phi2', work, losses) by time, shape (6,) both."""
        phi1, speed1, phi2, speed2 = state[:4].tolist()
        driving, driven, loss = self._teeth(phi1, speed1, phi2, speed2)
        acceleration1, torque = self._drive.answer(speed1, driving)
        _, step = self._load.at(phi2)
        (inertia, change), (_, moment) = cubic(self._load.rows[0], step), cubic(self._load.rows[1], step)
        acceleration2 = accelerated(inertia, change, driven - moment, speed2)
        return np.array([speed1, acceleration1, speed2, acceleration2, torque * speed1, loss])

    def _teeth(self, phi1: float, speed1: float, phi2: float, speed2: float) -> tuple[float, float, float]:
        """Moments of all pairs that touch on the driving and on the driven gear, and the power that they take."""
        turns, step = self._law.at(phi1)
        angle, ratio = with_slope(self._law.rows, step)
        ahead = angle + turns * self._rise - phi2
        _, step = self._gaps.at(phi1)
        driving = driven = loss = 0.0
        for urge, rows in self._pairs():
            third, second, first, error = rows[0]
            behind = ((third * step + second) * step + first) * step + error + ahead
            if urge * behind <= 0.0:
                continue
            _, drift = cubic(rows[0], step)
            lever, lever_slope = cubic(rows[1], step)
            stiffness, stiffening = cubic(rows[4], step)
            (along1, _), (along2, _) = cubic(rows[2], step), cubic(rows[3], step)
            pair = PairAt(urge, behind, ratio + drift, lever, lever_slope, along1, along2, stiffness, stiffening)
            *_, on_driving, on_driven, lost = self._meshing.borne(pair, speed1, speed2)
            driving, driven, loss = driving + on_driving, driven + on_driven, loss + lost
        return driving, driven, loss

    def _pairs(self) -> list[tuple[float, list[list[float]]]]:
        """The side and the cubics of each pair of the last requested interval."""
        if self._interval != self._gaps.index:
            self._interval = self._gaps.index
            urges = self._meshing.gaps.urge[self._interval].tolist()
            self._slots = [(urge, rows) for urge, rows in zip(urges, self._gaps.rows, strict=True) if urge]
        return self._slots
