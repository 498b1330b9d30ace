"""The torques of the teeth of two pairs in series: where their loads change flanks, both pairs part, knock and settle.

At constant driving speed there are two bodies: the shaft between the pairs, of inertia J1, and the driven side, of J2
reduced to the crank's shaft.  With x1 and x2 their angles beyond the law's, M1 and M2 the moments of the pairs that
touch on their driven gears, T1 and T2 the law's torques on these, and i2 the slope of the second pair's law,

    J1 x1.. = M1(phi1, x1, x1.) - T1 - (R2 - i2 T2)
    (J2 x2.). = M2(theta1, y, y.) - T2,   y = x2 - i2 x1

The teeth of the second pair depend only on y, the angle of its driven gear beyond the one for its own driving gear.
M1 and M2 count friction, and so does R2, the moment with which the second pair holds its driving gear: i2 M2 without
friction.  The teeth bear their normal forces.
A cycle of fewer than FEW swings is followed as a whole, since settled teeth are roused again where pairs come and go.
All is to the first order of x, by the method of ``ncgear.dynamics.flank_changes``: a single pair has infinite J1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
from ncgear.dynamics.meshing import Meshing, NearPairs, moments_n_mm, near_pairs
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
    """A pair of two: its damped teeth, and the law's torque on its driven gear at its own angles."""

    meshing: Meshing
    asked: Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class _Places:
    """Both pairs at n driving angles, shape (2, n) or (n,): own angles, torques asked, turning stiffness, inertias.

    ``slope`` is i2, and ``own`` the inertia that swings on each pair's teeth.
    """

    angle_rad: Array
    asked: Array
    stiffness: Array
    slope: Array
    driven: Array
    own: Array

    @property
    def swings_rad_s(self) -> Array:
        """How fast the body swings on the teeth of each pair, shape (2, n)."""
        return np.asarray(np.sqrt(self.stiffness / self.own))


@dataclass(frozen=True, eq=False)
class KnockingTrain:
    """Two pairs, the inertia in N mm s^2 of the shaft between them, and the load of the crank."""

    pairs: tuple[TrainPair, TrainPair]
    between: float
    load: CrankLoad
    speed_rad_s: float

    def borne(self, cycle_rad: float) -> tuple[BorneTorque, BorneTorque]:
        """The torques that both pairs bear, each by the angles of its own driving gear."""
        phi1 = np.linspace(0.0, cycle_rad, SAMPLES, endpoint=False)
        places, law = self._at(phi1), self.pairs[0].meshing.law
        most = np.abs(places.asked).max(axis=1)
        cycles = cycle_rad, float(law.at(np.array([cycle_rad]))[0][0] - law.at(np.array([0.0]))[0][0])
        width_rad = cycle_rad / SAMPLES
        steps = width_rad / self.speed_rad_s * places.swings_rad_s
        rows, flanks = turns_of(places.asked, most, steps)
        swings = steps.sum(axis=1) / (2.0 * pi)
        whole = FEWEST < swings.max() < FEW and any(one.meshing.gaps.come_and_go for one in self.pairs)
        if not most.all() or not (whole or rows.size):
            first, second = (BorneTorque(one.asked, c, knocks=()) for one, c in zip(self.pairs, cycles, strict=True))
            return first, second
        rows, starts = begun(rows if rows.size else np.zeros(1, dtype=int), phi1, cycle_rad)
        found, end_rad = list[tuple[FollowedStretch, FollowedStretch]](), float(starts[0]) + 2.0 * cycle_rad
        for start_rad, on in zip(starts, flanks[:, rows].T, strict=True):
            if not found or start_rad > found[-1][0].phi1_rad[-1]:
                ends = float(start_rad) + (cycle_rad if whole else 2.0 * width_rad), end_rad
                found.append(self._followed(float(start_rad), on, most, ends))
        first, second = (
            joined([one[place] for one in found], self.pairs[place].asked, cycles[place]) for place in (0, 1)
        )
        return first, second

    def _at(self, phi1_rad: Array) -> _Places:
        first, second = (one.meshing for one in self.pairs)
        between = first.law.at(phi1_rad)[0]
        crank, slope = second.law.at(between)
        driven = self.load.table.at(crank)[0][..., 0]
        angles = np.stack([phi1_rad, between])
        asked = np.stack([one.asked(angle) for one, angle in zip(self.pairs, angles, strict=True)])
        near = [one.meshing.gaps.at(angle) for one, angle in zip(self.pairs, angles, strict=True)]
        stiffness = np.stack(
            [
                2.0 * one.meshing.gaps.of_sections(at.stiffness * at.lever_mm**2)
                for one, at in zip(self.pairs, near, strict=True)
            ]
        )
        own = np.stack([np.full(phi1_rad.shape, self.between), 1.0 / (1.0 / driven + slope**2 / self.between)])
        return _Places(angles, asked, stiffness, slope, driven, own)

    def _followed(
        self, start_rad: float, flanks: Array, most: Array, ends_rad: tuple[float, float]
    ) -> tuple[FollowedStretch, FollowedStretch]:
        """The torques of both pairs from a place, where they are settled, until they have settled again."""
        here = self._at(np.array([start_rad]))
        settled = [
            settled_rad(one.meshing, float(here.angle_rad[i, 0]), float(here.asked[i, 0]), float(flanks[i]), IDLE * top)
            for i, (one, top) in enumerate(zip(self.pairs, most, strict=True))
        ]
        state = (settled[0], settled[1] + float(here.slope[0]) * settled[0], 0.0, 0.0)
        # Torques of the normal forces and with friction, of both pairs.
        phi1, torque, knocks = [np.array([start_rad])], [np.stack([here.asked] * 2)], (list[Knock](), list[Knock]())
        while phi1[-1][-1] < ends_rad[1]:
            step_s = self._step_s(float(phi1[-1][-1]))
            step_rad = self.speed_rad_s * step_s
            middles = phi1[-1][-1] + HELD * step_rad * (np.arange(SWINGS * PER_SWING // HELD) + 0.5)
            along = self._at(middles)
            slope = self.pairs[0].meshing.law.at(middles)[1]
            speeds = self.speed_rad_s * np.stack([np.ones_like(slope), slope])
            pairs = [
                near_pairs(self.pairs[i].meshing, along.angle_rad[i], speeds[i], float(most[i]), turned)
                for i, turned in ((0, Gear.DRIVEN), (1, Gear.DRIVEN), (1, Gear.DRIVING))
            ]
            done = False
            for first in range(0, middles.size, CHECKED * PER_SWING // HELD):
                part = slice(first, first + CHECKED * PER_SWING // HELD)
                borne, state, met = self._stepped(state, [one[0][part] for one in pairs], along, part, step_s)
                phi1.append(phi1[-1][-1] + step_rad * np.arange(1.0, borne.shape[-1] + 1.0))
                torque.append(borne)
                swing, own = along.swings_rad_s[:, part], along.own[:, part]
                for i in (0, 1):
                    for row, speed in met[i]:
                        speed_mm_s, pressed = speed * pairs[i][1][part][row], speed * own[i, row] * swing[i, row]
                        knocks[i].extend(knocks_at(along.angle_rad[i, part][row], speed_mm_s, pressed, most[i]))
                asked = along.asked[:, part]
                missed = np.abs(borne[TURNING] - np.repeat(asked, HELD, axis=1)).max(axis=1)
                swinging = np.maximum(missed, np.abs(self._momenta(state, along, part)) * swing.max(axis=1))
                done = phi1[-1][-1] >= ends_rad[0] and all(map(bears, asked, swinging, most))
                if done:
                    break
            if done:
                break
        angles, torques = np.concatenate(phi1), np.concatenate(torque, axis=-1)
        between = self.pairs[0].meshing.law.at(angles)[0]
        first, second = np.swapaxes(torques, 0, 1)
        return FollowedStretch(angles, first, knocks[0]), FollowedStretch(between, second, knocks[1])

    def _momenta(self, state: tuple[float, float, float, float], along: _Places, part: slice) -> Array:
        """The momenta of both bodies swinging on the teeth of each pair, shape (2,)."""
        slope, driven = float(along.slope[part][-1]), float(along.driven[part][-1])
        relative = state[3] / driven - slope * state[2] / self.between
        return np.array([state[2], relative * float(along.own[1, part][-1])])

    def _step_s(self, phi1_rad: float) -> float:
        """The time between two steps from a place on: a part of the fastest swing of both bodies together."""

        def fastest(places: _Places) -> float:
            first, second = places.stiffness
            together = (first + places.slope**2 * second) / self.between + second / places.driven
            return float(np.sqrt(together).max())

        way = 2.0 * pi * self.speed_rad_s * SWINGS / fastest(self._at(np.array([phi1_rad])))
        return 2.0 * pi / (PER_SWING * fastest(self._at(phi1_rad + way * np.linspace(0.0, 1.0, PER_SWING))))

    def _stepped(
        self,
        state: tuple[float, float, float, float],
        pairs: list[Sequence[NearPairs]],
        along: _Places,
        part: slice,
        step_s: float,
    ) -> tuple[Array, tuple[float, float, float, float], tuple[list[tuple[int, float]], list[tuple[int, float]]]]:
        """The torques borne after each of the HELD steps of n rows, shape (2, 2, n HELD), and the last state.

        A state is x1, x2 and the momenta of both bodies.  Then the rows and speeds of flanks that meet, of each pair.
        """
        x1, x2, p1, p2 = state
        inertia, half, impacts = self.between, 0.5 * step_s, [one.meshing.impact for one in self.pairs]
        met, every = (list[tuple[int, float]](), list[tuple[int, float]]()), list[tuple[float, float, float, float]]()
        rows = zip(
            *pairs, along.slope[part].tolist(), along.driven[part].tolist(), *along.asked[:, part].tolist(), strict=True
        )
        later_s = [step_s * (step + 1 - HELD / 2) for step in range(HELD)]
        n1 = n2 = m1 = m2 = r2 = None
        for row, (near1, near2, held2, slope, driven, asked1, asked2) in enumerate(rows):
            v1, v2 = p1 / inertia, p2 / driven
            if m1 is None or m2 is None or r2 is None:
                n1, m1 = moments_n_mm(impacts[0], near1, x1, v1, -step_s * HELD / 2)
                beyond = x2 - slope * x1, v2 - slope * v1, -step_s * HELD / 2
                n2, m2 = moments_n_mm(impacts[1], near2, *beyond)
                r2 = moments_n_mm(impacts[1], held2, *beyond)[TURNING]
            for later in later_s:
                p1 += half * (m1 - asked1 - r2 + slope * asked2)
                p2 += half * (m2 - asked2)
                v1, v2 = p1 / inertia, p2 / driven
                x1, x2 = x1 + step_s * v1, x2 + step_s * v2
                before = n1, n2
                n1, m1 = moments_n_mm(impacts[0], near1, x1, v1, later)
                beyond = x2 - slope * x1, v2 - slope * v1, later
                n2, m2 = moments_n_mm(impacts[1], near2, *beyond)
                r2 = moments_n_mm(impacts[1], held2, *beyond)[TURNING] if n2 else 0.0
                p1 += half * (m1 - asked1 - r2 + slope * asked2)
                p2 += half * (m2 - asked2)
                if n1 and not before[0]:
                    met[0].append((row, abs(v1)))
                if n2 and not before[1]:
                    met[1].append((row, abs(v2 - slope * v1)))
                every.append((n1, n2, m1, m2))
        return np.array(every).T.reshape(2, 2, -1), (x1, x2, p1, p2), met


def settled_rad(meshing: Meshing, phi1_rad: float, torque_n_mm: float, flank: float, idle: float) -> float:
    """The driven angle beyond the law's of settled teeth that bear a torque on their flank, or next to no torque."""
    here = np.array([phi1_rad])
    if torque_n_mm * flank <= idle:
        pushing, back = meshing.gaps.play_rad(here)
        return float(pushing[0] if flank > 0.0 else back[0])
    return float(loaded_contact(meshing, here, np.array([torque_n_mm]), 0.0).error_rad[0])
