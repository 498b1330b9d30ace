"""The torques of the teeth of pairs in series: where a pair's load changes flanks, all part, knock and settle.

At constant driving speed there is a body for each pair: the shaft that pair k turns, with inertia J_k and the angle x_k
beyond the law's; the last one is the driven side, reduced to the crank's shaft.  With M_k the moment of the teeth of
pair k on its driven gear, T_k the law's torque there and i_k the slope of the pair's law,

    (J_k x_k.). = M_k - T_k - (R_k+1 - i_k+1 T_k+1)

The teeth of a pair depend only on y_k = x_k - i_k x_k-1, the angle of its driven gear beyond the one for its own
driving gear; the driving shaft turns evenly, x_0 = 0.  M_k counts friction, and so does R_k, the moment with which a
pair holds its driving gear: i_k M_k without friction.  The teeth bear their normal forces.  The gears of a row are such
shafts, each with the driven gear of a mesh that is the driving gear of the next.
A cycle of fewer than FEW swings is followed as a whole, since settled teeth are roused again where pairs come and go.
All is to the first order of x, by the method of ``ncgear.dynamics.flank_changes``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import pi

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.driven_side import (
    CHECKED,
    IDLE,
    PER_SWING,
    TURNING,
    FollowedStretch,
    Knock,
    bears,
    knocks_at,
)
from ncgear.dynamics.flank_changes import FEW, FEWEST, SAMPLES, BorneTorque, begun, joined, turns_of
from ncgear.dynamics.meshing import Impact, Meshing, NearPairs, moments_n_mm, near_pairs
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear

HELD = 4
"""Steps for which arms, stiffness, loads and inertia keep their values of the middle: a sixth of a swing.  Gaps keep
changing: meeting teeth close gaps of many times the depth to which load presses them."""

SWINGS = 96
"""Swings with steps of the same length."""


@dataclass(frozen=True, eq=False)
class TrainPair:
    """A pair of several: its damped teeth, and the law's torque on its driven gear at its own angles."""

    meshing: Meshing
    asked: Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class _Places:
    """All q pairs at n driving angles, shape (q, n): own angles, torques asked, turning stiffness, slopes, inertias.

    ``inertia`` is that of the shaft of each driven gear, and ``own`` what swings on the teeth of each pair.
    """

    angle_rad: Array
    asked: Array
    stiffness: Array
    slope: Array
    inertia: Array

    @property
    def own(self) -> Array:
        """What swings on the teeth of each pair, between both its shafts; the driving shaft turns evenly."""
        eased = 1.0 / self.inertia
        eased[1:] += self.slope[1:] ** 2 / self.inertia[:-1]
        return np.asarray(1.0 / eased)

    @property
    def swings_rad_s(self) -> Array:
        """How fast the bodies swing on the teeth of each pair, shape (q, n)."""
        return np.asarray(np.sqrt(self.stiffness / self.own))


@dataclass(frozen=True, eq=False)
class _State:
    """Angles of all q bodies beyond the law's, and their momenta."""

    ahead_rad: list[float]
    momentum: list[float]


@dataclass(frozen=True, eq=False)
class KnockingTrain:
    """Pairs from the driving shaft on, the inertia in N mm s^2 of each shaft between, and the load of the crank."""

    pairs: tuple[TrainPair, ...]
    between: tuple[float, ...]
    load: CrankLoad
    speed_rad_s: float

    def borne(self, cycle_rad: float) -> tuple[BorneTorque, ...]:
        """The torques that the pairs bear, each by the angles of its own driving gear."""
        phi1 = np.linspace(0.0, cycle_rad, SAMPLES, endpoint=False)
        places, ends = self._at(phi1), self._angles(np.array([0.0, cycle_rad]))[0]
        most, cycles = np.abs(places.asked).max(axis=1), np.diff(ends, axis=1)[:, 0].tolist()
        width_rad = cycle_rad / SAMPLES
        steps = width_rad / self.speed_rad_s * places.swings_rad_s
        rows, flanks = turns_of(places.asked, most, steps)
        swings = steps.sum(axis=1) / (2.0 * pi)
        whole = FEWEST < swings.max() < FEW and any(pair.meshing.gaps.come_and_go for pair in self.pairs)
        if not most.all() or not (whole or rows.size):
            return tuple(BorneTorque(pair.asked, c, knocks=()) for pair, c in zip(self.pairs, cycles, strict=True))
        rows, starts = begun(rows if rows.size else np.zeros(1, dtype=int), phi1, cycle_rad)
        found, end_rad = list[list[FollowedStretch]](), float(starts[0]) + 2.0 * cycle_rad
        for start_rad, on in zip(starts, flanks[:, rows].T, strict=True):
            if not found or start_rad > found[-1][0].phi1_rad[-1]:
                until = float(start_rad) + (cycle_rad if whole else 2.0 * width_rad), end_rad
                found.append(self._followed(float(start_rad), on, most, until))
        of_pairs = zip(zip(*found, strict=True), self.pairs, cycles, strict=True)
        return tuple(joined(list(stretches), pair.asked, c) for stretches, pair, c in of_pairs)

    def _angles(self, phi1_rad: Array) -> tuple[Array, Array, Array]:
        """Angles of all driving gears and slopes of all laws, shape (q, n) each, and the crank's angle, shape (n,)."""
        angles, slopes = [phi1_rad], list[Array]()
        for pair in self.pairs:
            angle, slope = pair.meshing.law.at(angles[-1])
            angles.append(angle)
            slopes.append(slope)
        return np.stack(angles[:-1]), np.stack(slopes), angles[-1]

    def _at(self, phi1_rad: Array) -> _Places:
        angles, slopes, crank = self._angles(phi1_rad)
        stiffness, asked = np.empty(angles.shape), np.empty(angles.shape)
        for row, (pair, angle) in enumerate(zip(self.pairs, angles, strict=True)):
            near, asked[row] = pair.meshing.gaps.at(angle), pair.asked(angle)
            stiffness[row] = 2.0 * pair.meshing.gaps.of_sections(near.stiffness * near.lever_mm**2)
        between = [np.full(phi1_rad.shape, inertia) for inertia in self.between]
        inertia = np.stack([*between, self.load.table.at(crank)[0][..., 0]])
        return _Places(angles, asked, stiffness, slopes, inertia)

    def _followed(
        self, start_rad: float, flanks: Array, most: Array, ends_rad: tuple[float, float]
    ) -> list[FollowedStretch]:
        """The torques of all pairs from a place, where they are settled, until they have settled again."""
        state, asked = self._settled(start_rad, flanks, most)
        # Torques of the normal forces and with friction, of all pairs.
        phi1, torque, knocks = [np.array([start_rad])], [np.stack([asked] * 2)], [list[Knock]() for _ in self.pairs]
        while phi1[-1][-1] < ends_rad[1]:
            step_s = self._step_s(float(phi1[-1][-1]))
            step_rad = self.speed_rad_s * step_s
            middles = phi1[-1][-1] + HELD * step_rad * (np.arange(SWINGS * PER_SWING // HELD) + 0.5)
            along = self._at(middles)
            speeds = self.speed_rad_s * np.cumprod(np.vstack([np.ones(middles.size), along.slope[:-1]]), axis=0)
            turns, holds = (
                [
                    near_pairs(pair.meshing, along.angle_rad[k], speeds[k], float(most[k]), gear)
                    for k, pair in enumerate(self.pairs)
                    if k or gear is Gear.DRIVEN
                ]
                for gear in (Gear.DRIVEN, Gear.DRIVING)
            )
            done = False
            for first in range(0, middles.size, CHECKED * PER_SWING // HELD):
                part = slice(first, first + CHECKED * PER_SWING // HELD)
                near = [[rows[part] for rows, _ in each] for each in (turns, holds)]
                borne, state, met = self._stepped(state, near, along, part, step_s)
                phi1.append(phi1[-1][-1] + step_rad * np.arange(1.0, borne.shape[-1] + 1.0))
                torque.append(borne)
                swing, own = along.swings_rad_s[:, part], along.own[:, part]
                for k, row, speed in met:
                    speed_mm_s, pressed = speed * turns[k][1][part][row], speed * own[k, row] * swing[k, row]
                    knocks[k].extend(knocks_at(along.angle_rad[k, part][row], speed_mm_s, pressed, most[k]))
                asked = along.asked[:, part]
                missed = np.abs(borne[TURNING] - np.repeat(asked, HELD, axis=1)).max(axis=1)
                swinging = np.maximum(missed, np.abs(_momenta(state, along, part)) * swing.max(axis=1))
                done = phi1[-1][-1] >= ends_rad[0] and all(map(bears, asked, swinging, most))
                if done:
                    break
            if done:
                break
        angles, torques = np.concatenate(phi1), np.concatenate(torque, axis=-1)
        own_angles = self._angles(angles)[0]
        return [FollowedStretch(*each) for each in zip(own_angles, np.swapaxes(torques, 0, 1), knocks, strict=True)]

    def _settled(self, start_rad: float, flanks: Array, most: Array) -> tuple[_State, Array]:
        """The bodies where all pairs rest on their flanks, and the torques asked there, shape (q, 1)."""
        here, ahead = self._at(np.array([start_rad])), [0.0]
        for pair, angle, asked, slope, flank, top in zip(
            self.pairs, here.angle_rad[:, 0], here.asked[:, 0], here.slope[:, 0], flanks, most, strict=True
        ):
            own = settled_rad(pair.meshing, float(angle), float(asked), float(flank), IDLE * float(top))
            ahead.append(own + float(slope) * ahead[-1])
        return _State(ahead[1:], [0.0] * len(self.pairs)), here.asked

    def _step_s(self, phi1_rad: float) -> float:
        """The time between two steps from a place on: a part of the fastest swing of all bodies together.

        The sum of what holds each body by its inertia is above the square of that swing.
        """

        def fastest(places: _Places) -> float:
            held = places.stiffness.copy()
            held[:-1] += places.slope[1:] ** 2 * places.stiffness[1:]
            return float(np.sqrt((held / places.inertia).sum(axis=0)).max())

        way = 2.0 * pi * self.speed_rad_s * SWINGS / fastest(self._at(np.array([phi1_rad])))
        return 2.0 * pi / (PER_SWING * fastest(self._at(phi1_rad + way * np.linspace(0.0, 1.0, PER_SWING))))

    def _stepped(
        self, state: _State, near: Sequence[Sequence[Sequence[NearPairs]]], along: _Places, part: slice, step_s: float
    ) -> tuple[Array, _State, list[tuple[int, int, float]]]:
        """The torques borne after each of the HELD steps of n rows, shape (2, q, n HELD), and the last state.

        ``near`` are the teeth of all pairs by what they turn, and of all but the first by what they hold.  Then the
        flanks that meet: the number of their pair, their row and speed.
        """
        ahead, momentum, half = list(state.ahead_rad), list(state.momentum), 0.5 * step_s
        impacts, bodies = [pair.meshing.impact for pair in self.pairs], range(len(self.pairs))
        turns, holds = (list(zip(*rows, strict=True)) for rows in near)
        columns = (values[:, part].T.tolist() for values in (along.slope, along.inertia, along.asked))
        later_s = [step_s * (step + 1 - HELD / 2) for step in range(HELD)]
        met, every = list[tuple[int, int, float]](), list[tuple[list[float], list[float]]]()
        normal, turning, held_back = list[float](), list[float](), list[float]()
        for row, (turned, held, slope, inertia, asked) in enumerate(zip(turns, holds, *columns, strict=True)):
            pressing = partial(_pressing, impacts, turned, held, slope)
            # What the law's torques take from each body, all pairs together.
            due = [asked[k] - (slope[k + 1] * asked[k + 1] if k + 1 in bodies else 0.0) for k in bodies]
            if not normal:
                speeds = [momentum[k] / inertia[k] for k in bodies]
                normal, turning, held_back, _ = pressing(ahead, speeds, -step_s * HELD / 2)
            for later in later_s:
                for k in bodies:
                    momentum[k] += half * (turning[k] - held_back[k + 1] - due[k])
                speeds = [momentum[k] / inertia[k] for k in bodies]
                for k in bodies:
                    ahead[k] += step_s * speeds[k]
                before, (normal, turning, held_back, meeting) = normal, pressing(ahead, speeds, later)
                for k in bodies:
                    momentum[k] += half * (turning[k] - held_back[k + 1] - due[k])
                    if normal[k] and not before[k]:
                        met.append((k, row, abs(meeting[k])))
                every.append((normal, turning))
        return np.array(every).transpose(1, 2, 0), _State(ahead, momentum), met


def _pressing(
    impacts: list[Impact],
    turned: Sequence[NearPairs],
    held: Sequence[NearPairs],
    slope: list[float],
    ahead_rad: list[float],
    speed_rad_s: list[float],
    later_s: float,
) -> tuple[list[float], list[float], list[float], list[float]]:
    """Moments of all pairs by their normal forces and with friction, then those that hold their driving gears.

    The last of these is 0, as nothing holds the driven side.  Then the speeds of driven gears beyond their mates'.
    """
    normal, turning, held_back, speeds = list[float](), list[float](), list[float](), list[float]()
    x_before = v_before = 0.0
    for k, (x, v) in enumerate(zip(ahead_rad, speed_rad_s, strict=True)):
        beyond, speed = x - slope[k] * x_before, v - slope[k] * v_before
        pressed, turns = moments_n_mm(impacts[k], turned[k], beyond, speed, later_s)
        holds = moments_n_mm(impacts[k], held[k - 1], beyond, speed, later_s)[TURNING] if k and pressed else 0.0
        normal.append(pressed)
        turning.append(turns)
        held_back.append(holds)
        speeds.append(speed)
        x_before, v_before = x, v
    held_back.append(0.0)
    return normal, turning, held_back, speeds


def _momenta(state: _State, along: _Places, part: slice) -> Array:
    """The momenta of the bodies swinging on the teeth of each pair, shape (q,)."""
    slope, inertia, own = (values[:, part][:, -1] for values in (along.slope, along.inertia, along.own))
    speed = np.array(state.momentum) / inertia
    speed[1:] -= slope[1:] * speed[:-1].copy()
    return speed * own


def settled_rad(meshing: Meshing, phi1_rad: float, torque_n_mm: float, flank: float, idle: float) -> float:
    """The driven angle beyond the law's of settled teeth that bear a torque on their flank, or next to no torque."""
    here = np.array([phi1_rad])
    if torque_n_mm * flank <= idle:
        pushing, back = meshing.gaps.play_rad(here)
        return float(pushing[0] if flank > 0.0 else back[0])
    return float(loaded_contact(meshing, here, np.array([torque_n_mm]), 0.0).error_rad[0])
