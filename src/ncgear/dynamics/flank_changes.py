"""The torque of the teeth of a machine with masses: they swing, part, cross the play, knock, and settle.

At constant driving speed the driven side is a body of one degree of freedom.  With x its angle beyond the law's, T the
torque that the law asks of the teeth, J the inertia of the driven side reduced to its shaft and M the moment of the
pairs that touch,

    (J(phi2) x.). = M(phi1, x, x.) - T(phi1),   phi1 = w t

so that the driven side flies freely across the play where T reverses (M = 0), and swings where T jumps and where pairs
come and go.  This is Lagrange's equation of ``ncgear.dynamics.crank_load`` to the first order of x., without the
changes of J and of the load with x.  M is that of ``ncgear.dynamics.meshing``, with friction that slides as the law
does: teeth bear the moment of their normal forces, and friction takes a part of it or adds to it.  The driving shaft's
own inertia is left out: a shaft that yields softens knocks.

The equation is integrated for x and the momentum p = J x. by Verlet's method (Stoermer's rule; e.g. E. Hairer, C.
Lubich, G. Wanner, Acta Numerica 12 (2003), 399-450; ``ncgear.dynamics.driven_side``): from a reversal or jump of the
torque until the teeth have settled, and then over the rest of the cycle, or where that takes too many swings, not at
all; there they bear T.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field, replace
from functools import partial
from math import ceil, pi

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.driven_side import (
    IDLE,
    NORMAL,
    PER_SWING,
    PLACES,
    SETTLED,
    TURNING,
    DrivenSide,
    FollowedStretch,
    Knock,
    Ways,
)
from ncgear.dynamics.meshing import Meshing
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray

SAMPLES = 4096
"""Places of a cycle at which the torque is tested for reversals and jumps."""

EVERY = 8
"""Such places from one place to the next at which the speed of swings is computed."""

JUMP = 0.05
"""Change between two such places that is a jump, as a share of the largest torque; a smooth change takes a degree."""

CLOSER = 24
"""Parts of the space between two such places, and again of the part in which the torque changes most, by which a
reversal or jump is found."""

STEPS = 1 << 17
"""Steps that are computed together."""

PLAYS = 0.98, 1.015
"""Shares of the play in the runs that follow knocks again.  Knocks may differ from turn to turn, like a bouncing ball,
and then also with the play, which is hardly known better: the hardest knocks of all runs count."""

FEW, FEWEST = 4000, 300
"""Most and fewest swings in a cycle that is followed as a whole.  With fewer, as with a flywheel on the driven shaft,
swings are about as slow as the passing of teeth, a resonance that K_V covers.  Pairs that come and go swing the driven
side, less with slower passing: by 30 % of the torque with 17 swings to a pitch, by 20 % with 30 (a shaper)."""


MOST_SWINGS = 150_000
"""Most swings in a cycle of a driven side that is followed.  The worked designs have 20 to 3500, and a baler at 0.1
r/min, with 128 000, settles in a second of processor time; teeth that never settle take 5 s and 1.4 GB for so many."""


@dataclass(frozen=True, eq=False)
class BorneTorque:
    """The torque in N mm that the teeth bear in a cycle, with all its ``knocks``; None where these are not followed.

    ``asked`` is the torque of the law at driving angles, shape (n,).  From the first of ``phi1_rad`` (shape (m,),
    rising over two cycles at most) on there is ``torque_n_mm`` instead, shape (2, m): the moment of the normal forces,
    and the torque that turns the driven side, which friction makes smaller or larger; NaN stands between two stretches.
    Where a place is followed in two cycles, the later cycle counts.  ``slow_swings`` is the number of swings in a cycle
    of a driven side without knocks that swings too slowly to be followed: the torque may rouse them.  Else it is 0.
    ``fast_swings`` is their number where they are too many to be followed, else 0.
    """

    asked: Callable[[Array], Array]
    cycle_rad: float
    phi1_rad: Array = field(default_factory=lambda: np.empty(0))
    torque_n_mm: Array = field(default_factory=lambda: np.empty((2, 0)))
    knocks: tuple[Knock, ...] | None = None
    others: tuple[BorneTorque, ...] = ()
    slow_swings: float = 0.0
    fast_swings: float = 0.0

    def at(self, phi1_rad: Array) -> Array:
        """The torque of the normal forces at driving angles, shape (n,): the law's or the followed one, if larger.

        The moments at which flying teeth bear less than the law's torque are known less well than the force of their
        knocks.  ``others`` are runs with other steps; the largest torque of all runs counts at each place.
        """
        return self._larger(phi1_rad, self.asked(phi1_rad), NORMAL)

    def hardest(self, urge: float, phi1_rad: Array) -> Array:
        """The torque of the normal forces where it is hardest about rising driving angles, shape (n,) both.

        ``urge`` is +1 for the torque on pushing flanks, -1 for their backs; it is 0 where these bear none.  An angle's
        surroundings end half way to its neighbours: a knock may be shorter than the way between angles.
        """
        found = np.maximum(np.maximum(urge * self.at(phi1_rad), urge * self.asked(phi1_rad)), 0.0)
        places, torque = self.peaks(2.0 * float(phi1_rad[-1]) - float(phi1_rad[-2]))
        np.maximum.at(found, np.searchsorted((phi1_rad[1:] + phi1_rad[:-1]) / 2.0, places), urge * torque)
        return np.asarray(urge * found)

    def peaks(self, end_rad: float) -> tuple[Array, Array]:
        """The driving angles from 0 to ``end_rad`` at which a followed torque peaks, rising, and the torques there.

        The torques are as ``at``, of either sign; shape (m,) each.
        """
        own = np.unique(np.concatenate([torques.phi1_rad for torques in (self, *self.others)]) % self.cycle_rad)
        if not own.size:
            return own, own
        torque = self.at(own)
        size = np.abs(torque)
        top = (size >= np.roll(size, 1)) & (size > np.roll(size, -1))
        turns = np.arange(ceil(end_rad / self.cycle_rad))[:, None]
        places = (own[top] + self.cycle_rad * turns).ravel()
        return places[places <= end_rad], np.tile(torque[top], turns.size)[places <= end_rad]

    @property
    def turning_n_mm(self) -> Array:
        """The torque of this run that turns the driven side, shape (m,)."""
        return self.torque_n_mm[TURNING]

    def turning(self, phi1_rad: Array) -> Array:
        """As ``at``, the torque that turns the driven side."""
        return self._larger(phi1_rad, self.asked(phi1_rad), TURNING)

    def beyond(self, phi1_rad: Array) -> Array:
        """What turns the driven side beyond the torque of the law, shape (n,)."""
        asked = self.asked(phi1_rad)
        return self._larger(phi1_rad, asked, TURNING) - asked

    def _larger(self, phi1_rad: Array, asked: Array, row: int) -> Array:
        torque = asked
        for torques in (self, *self.others):
            again = torques._own(phi1_rad, asked, row)
            torque = np.where(np.abs(again) > np.abs(torque), again, torque)
        return torque

    def _own(self, phi1_rad: Array, asked: Array, row: int) -> Array:
        """The larger of the ``asked`` torque at driving angles and this run's own, shape (n,)."""
        if not self.phi1_rad.size:
            return asked
        torque, first = asked, self.phi1_rad[0] + (phi1_rad - self.phi1_rad[0]) % self.cycle_rad
        for place in (first, first + self.cycle_rad):
            followed = np.interp(place, self.phi1_rad, self.torque_n_mm[row], left=np.nan, right=np.nan)
            torque = np.where(np.isnan(followed), torque, followed)
        return np.where(np.abs(torque) > np.abs(asked), torque, asked)


def borne_torque(
    meshing: Meshing,
    load: CrankLoad,
    asked: Callable[[Array], Array],
    speed_rad_s: float,
    cycle_rad: float,
    plays: Sequence[float] = PLAYS,
) -> BorneTorque:
    """The torque that the teeth bear where the law demands ``asked`` at a constant driving speed.

    It is ``asked`` itself where this neither reverses nor jumps in a cycle of more than FEW swings.  Knocks are not
    known in a cycle of more than MOST_SWINGS.  Where teeth knock, they are followed, which gives the knocks, and once
    more for each share of the play in ``plays``.
    """
    phi1 = np.linspace(0.0, cycle_rad, SAMPLES, endpoint=False)
    torque = asked(phi1)
    most = float(np.abs(torque).max())
    driven = DrivenSide(meshing, load, asked, speed_rad_s, most)
    swings_rad_s = driven.swings_rad_s(phi1[::EVERY])

    def swings_at(phi1_rad: Array) -> Array:
        return np.interp(phi1_rad, phi1[::EVERY], swings_rad_s, period=cycle_rad)

    swing = swings_at(phi1)
    steps = cycle_rad / SAMPLES / speed_rad_s * swing
    rows, (flank,) = turns_of(torque[None], np.array([most]), steps[None])
    swings = float(steps.sum()) / (2.0 * pi)
    whole, slow = FEWEST < swings < FEW, swings if most and swings <= FEWEST else 0.0
    if not most or not (whole or rows.size):
        return BorneTorque(asked, cycle_rad, knocks=(), slow_swings=slow)
    if swings > MOST_SWINGS:
        return BorneTorque(asked, cycle_rad, fast_swings=swings)
    rows = rows if rows.size else np.zeros(1, dtype=int)
    rows, starts = begun(rows, phi1, cycle_rad)
    width_rad = cycle_rad / SAMPLES
    starts, width_rad, places, torques = closer(asked, most, starts, width_rad, speed_rad_s / swing[rows].max())
    own, order = np.unique(np.concatenate([phi1, places]) % cycle_rad, return_index=True)
    known = np.concatenate([torque, torques])[order]
    driven = replace(driven, asked=lambda at: np.interp(at, own, known, period=cycle_rad))
    parts = ceil(PER_SWING * swings / STEPS)
    ways = Ways(partial(driven.way, cycle_rad / PLACES, swings_at), float(starts[0]), cycle_rad / parts)
    end_rad = float(starts[0]) + 2.0 * cycle_rad

    def once(ways: Ways) -> list[FollowedStretch]:
        found = list[FollowedStretch]()
        for start_rad, on in zip(starts.tolist(), flank[rows].tolist(), strict=True):
            if not found or start_rad > found[-1].phi1_rad[-1]:
                found.append(ways.followed(start_rad, on, (start_rad + 2.0 * width_rad, end_rad)))
        return found

    found = once(ways)
    if whole and meshing.gaps.come_and_go:
        ends = [float(stretch.phi1_rad[-1]) for stretch in found]
        begins = [*(float(stretch.phi1_rad[0]) for stretch in found[1:]), float(starts[0]) + cycle_rad]
        settled = [ways.settled(end, begin) for end, begin in zip(ends, begins, strict=True)]
        found = [each for stretch, after in zip(found, settled, strict=True) for each in (stretch, *after)]
    followed = joined(found, asked, cycle_rad)
    if not followed.knocks:
        return followed if whole else BorneTorque(asked, cycle_rad, knocks=(), slow_swings=slow)
    return replace(followed, others=tuple(joined(once(ways.with_play(play)), asked, cycle_rad) for play in plays))


def turns_of(torques: Array, most_n_mm: Array, steps: Array) -> tuple[IndexArray, Array]:
    """Places of a cycle after which a torque reverses or jumps, and the loaded flanks of all n places, shape (q, n).

    ``torques`` (q, n) have the largest sizes ``most_n_mm`` (q,); ``steps`` (q, n) are the swings, in rad, to the next
    place.  With swings of w rad/s the driven side deviates from T by T'' / w^2, and swings by dT' / w after a kink.
    """
    most, jump = most_n_mm[:, None], np.roll(torques, -1, axis=1) - torques
    flanks = np.stack([flanks_of(torque, IDLE * float(top)) for torque, top in zip(torques, most_n_mm, strict=True)])
    hurried = np.abs(np.roll(jump, -1, axis=1) - jump) > SETTLED * most * np.minimum(steps, steps**2)
    turned = (flanks != np.roll(flanks, -1, axis=1)) | (np.abs(jump) > JUMP * most) | hurried
    return np.flatnonzero(turned.any(axis=0)), flanks


def begun(rows: IndexArray, phi1_rad: Array, cycle_rad: float) -> tuple[IndexArray, Array]:
    """The rows of turns in the order in which they are followed, and their driving angles, rising, shape (n,) both.

    The longest stretch without a turn or a jump comes last: there the teeth have most time to settle.
    """
    rows = np.roll(rows, -int(np.argmax(np.diff(rows, prepend=rows[-1] - SAMPLES))))
    return rows, phi1_rad[rows] + cycle_rad * (rows < rows[0])


def closer(
    asked: Callable[[Array], Array], most_n_mm: float, starts_rad: Array, width_rad: float, enough_rad: float
) -> tuple[Array, float, Array, Array]:
    """Places shape (n,), and a width of ``enough_rad`` at most, within which the torque changes most after each.

    Then the places on the way and the torques there, shape (m,) each.
    """
    every, torques = list[Array](), list[Array]()
    while not every or width_rad > enough_rad:
        places = starts_rad[:, None] + width_rad * np.linspace(0.0, 1.0, CLOSER + 1)
        torque = asked(places.ravel()).reshape(places.shape)
        changed = np.abs(np.diff(torque)) + most_n_mm * np.abs(np.diff(np.sign(torque)))
        starts_rad, width_rad = places[np.arange(starts_rad.size), changed.argmax(axis=1)], width_rad / CLOSER
        every.append(places.ravel())
        torques.append(torque.ravel())
    return starts_rad, width_rad, np.concatenate(every), np.concatenate(torques)


def flanks_of(torque: Array, idle: float) -> Array:
    """+1 where pushing flanks bear a torque, -1 where their backs do, shape (n,); idle teeth keep their side."""
    pressed = np.flatnonzero(np.abs(torque) > idle)
    if not pressed.size:
        return np.ones_like(torque)
    last: IndexArray = pressed[np.searchsorted(pressed, np.arange(torque.size), side="right") - 1]
    return np.sign(torque[last])


def joined(found: list[FollowedStretch], asked: Callable[[Array], Array], cycle_rad: float) -> BorneTorque:
    """Stretches one after the other, with the knocks of the last cycle."""
    end_rad, phi1, torque = float(found[-1].phi1_rad[-1]), list[Array](), list[Array]()
    for stretch in found:
        if phi1:
            phi1.append(np.array([(phi1[-1][-1] + stretch.phi1_rad[0]) / 2.0]))
            torque.append(np.full((2, 1), np.nan))
        phi1.append(stretch.phi1_rad)
        torque.append(stretch.torque_n_mm)
    every = [knock for stretch in found for knock in stretch.knocks if knock.phi1_rad > end_rad - cycle_rad]
    knocks = tuple(replace(knock, phi1_rad=knock.phi1_rad % cycle_rad) for knock in every)
    return BorneTorque(asked, cycle_rad, np.concatenate(phi1), np.concatenate(torque, axis=1), knocks)
