"""The driven side of a machine at constant driving speed: in flight between flanks, and in steps on its teeth.

With x its angle beyond the law's, T the torque that the law asks of the teeth, J the inertia reduced to its shaft and
M the moment of the pairs that touch, (J x.). = M - T.  Steps are Verlet's (``ncgear.dynamics.flank_changes``), along a
way whose angles, torques, inertias and pairs of teeth are computed once for all motions on it.

In flight (M = 0) the steps are sums over the way, known for all its places at once: with the impulse I of T up to a
place and A the sum of h / J, momentum p + I and x - (p + I) A + B keep their values, so that a flight costs no steps.
Settled teeth forget a swing in SOON of them; so parts of a way without knocks are followed side by side in arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, replace
from functools import cached_property
from math import pi

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.meshing import Meshing, NearPairs, in_numbers, moments_n_mm, moments_of_arrays, near_sides
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray

PER_SWING = 24
"""Steps in a swing of the driven side on two pairs of teeth: the error of its time is (2 pi / 24)^2 / 24, 0.3 %, and
four pairs are far from the 3.2 steps at which the method fails."""

PER_PITCH = 48
"""Least steps in a pitch: where the driven side swings more slowly than teeth pass, as with a flywheel."""

PLACES = 720
"""Least places of a cycle at which arms, stiffness and inertia are computed, and their least number in a swing; pairs
keep them from place to place.  Gaps keep changing: meeting teeth close gaps of many times the depth to which load
presses them."""

CHECKED = 4
"""Swings on the teeth between two tests whether they have settled."""

SETTLED, TOUCHING = 0.03, 0.5
"""Largest deviations of settled teeth from the torque of the law: as a share of the largest torque (K_V covers smaller
swings), and as a share of the torque there, so that they do not part again."""

IDLE = 1e-6
"""Share of the largest torque under which it presses no flank."""

SOON, LANES = 8, 256
"""Swings from rest that settled teeth do before they count, and least steps that count, where parts of a way are
followed side by side: with a twentieth of critical damping a twelfth is left of a deviation."""

KEPT = 8
"""Most ways that are kept for further runs.  Most machines have one way in a cycle."""

CLEAR = 1e-9
"""Share of a way within which an angle counts as its end: far above rounding errors."""

HALVINGS = 16
"""Halvings of the depth at which teeth rest."""

NORMAL, TURNING = 0, 1
"""Rows of torques: of the normal forces, and with friction."""


@dataclass(frozen=True)
class Knock:
    """Flanks that meet after a parting: the driving angle in rad, and their speed along the normal in mm/s.

    Meetings whose speed would press the teeth by less than SETTLED of the largest torque do not count.
    """

    phi1_rad: float
    speed_mm_s: float


@dataclass(frozen=True, eq=False)
class FollowedStretch:
    """The followed motion after a reversal or a jump: driving angles (n,), torques (2, n), and the knocks."""

    phi1_rad: Array
    torque_n_mm: Array
    knocks: list[Knock]


@dataclass(frozen=True, eq=False)
class DrivenState:
    """The driven side at a place of a way: its angle beyond the law's, its momentum, and the torques of its teeth."""

    place: int
    ahead_rad: float
    momentum: float
    torques: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Way:
    """A part of the cycle in n steps between n + 1 places, with their ``phi1_rad`` and the torque ``asked`` there.

    Each step, of ``step_s`` and with the ``inertia`` there, ends ``later_s`` after the time at which the pairs of its
    ``row`` are known: ``sides`` are those of pushing flanks and of backs, shape (rows, pairs, 5), ``levers_mm`` their
    largest levers.  ``swing_rad_s`` is the speed of swings on two pairs, shape (n,).
    """

    meshing: Meshing
    phi1_rad: Array
    asked: Array
    step_s: Array
    inertia: Array
    swing_rad_s: Array
    later_s: Array
    row: IndexArray
    sides: tuple[Array, Array]
    levers_mm: Array
    most_n_mm: float
    known: dict[int, NearPairs] = field(default_factory=dict)

    def with_play(self, share: float) -> Way:
        """The same way with ``share`` of the play, by other places of the backs."""
        pushing, back = self.sides[0], self.sides[1].copy()
        back[..., 1] += (share - 1.0) * (back[:, :1, 1] - pushing[:, :1, 1])
        return replace(self, sides=(pushing, back), known={})

    @cached_property
    def table(self) -> Array:
        """The pairs of both sides, shape (5, pairs, rows)."""
        return np.ascontiguousarray(np.concatenate(self.sides, axis=1).transpose(2, 1, 0))

    @property
    def last(self) -> int:
        """The number of its last place."""
        return self.row.size

    @cached_property
    def free(self) -> tuple[Array, Array]:
        """Angles at which flying teeth first touch pushing flanks and backs, at the end of each step, shape (n,)."""
        found = []
        for side, none in zip(self.sides, (-np.inf, np.inf), strict=True):
            arm, error, _, rate, _ = side[:, 0].T
            found.append(np.where(arm, error, none)[self.row] + rate[self.row] * self.later_s)
        return found[0], found[1]

    @cached_property
    def flights(self) -> tuple[Array, Array, Array]:
        """The sums I, A and B of flights up to each place, shape (n + 1,) each."""
        impulse = _summed(self.step_s * (self.asked[:-1] + self.asked[1:]) / 2.0)
        eased = self.step_s / self.inertia
        return impulse, _summed(eased), _summed(eased * (impulse[:-1] + self.step_s * self.asked[:-1] / 2.0))

    def flown(self, state: DrivenState) -> DrivenState:
        """The place before the first at which flying teeth touch, or the last place."""
        (low, high), (impulse, eased, fallen), start = self.free, self.flights, state.place
        kept, width, begin = state.momentum + impulse[start], 2 * PER_SWING, start
        while begin < self.last:
            steps, ends = slice(begin, begin + width), slice(begin + 1, begin + width + 1)
            ahead = state.ahead_rad + kept * (eased[ends] - eased[start]) - (fallen[ends] - fallen[start])
            touching = (ahead < low[steps]) | (ahead > high[steps])
            if touching[first := int(touching.argmax())]:
                place = begin + first
                break
            begin, width = begin + width, 2 * width
        else:
            place = self.last
        ahead_rad = state.ahead_rad + kept * (eased[place] - eased[start]) - (fallen[place] - fallen[start])
        return DrivenState(place, float(ahead_rad), float(kept - impulse[place]), (0.0, 0.0))

    def near(self, row: int) -> NearPairs:
        """The pairs of a row, kept for all motions."""
        if row not in self.known:
            self.known[row] = in_numbers((self.sides[0][row], self.sides[1][row]))
        return self.known[row]

    @cached_property
    def fastest_rad_s(self) -> float:
        """The fastest swing on it."""
        return float(self.swing_rad_s.max())

    def pressed(self, state: DrivenState) -> tuple[DrivenState, Array, float]:
        """Steps on the teeth until they part, CHECKED swings at most, with all torques, shape (2, steps).

        The last figure is the speed in rad/s after the first step, with which teeth that were apart meet.
        """
        impact, ahead_rad, momentum, (_, turning) = self.meshing.impact, state.ahead_rad, state.momentum, state.torques
        some = slice(state.place, state.place + CHECKED * PER_SWING)
        after = slice(some.start + 1, some.stop + 1)
        columns = self.step_s[some], self.inertia[some], self.row[some], self.later_s[some], self.asked[after]
        asked, last, every = float(self.asked[state.place]), -1, list[tuple[float, float]]()
        met_rad_s = 0.0
        for step_s, inertia, row, later_s, next_asked in zip(*(column.tolist() for column in columns), strict=True):
            if row != last:
                near, last = self.near(row), row
            momentum += 0.5 * step_s * (turning - asked)
            speed_rad_s = momentum / inertia
            ahead_rad += step_s * speed_rad_s
            torques = moments_n_mm(impact, near, ahead_rad, speed_rad_s, later_s)
            turning, asked = torques[TURNING], next_asked
            momentum += 0.5 * step_s * (turning - asked)
            met_rad_s = met_rad_s if every else speed_rad_s
            every.append(torques)
            if not torques[NORMAL]:
                break
        return DrivenState(state.place + len(every), ahead_rad, momentum, every[-1]), np.array(every).T, met_rad_s

    def side_by_side(self, begin: int, end: int) -> FollowedStretch:
        """The steps between two places, at which teeth are settled, in parts that begin at rest SOON swings before."""
        edges = np.linspace(begin, end, max(1, (end - begin) // LANES) + 1).astype(int)
        steps = min(int(np.diff(edges).max()) + SOON * PER_SWING, end - begin)
        own = np.maximum(edges[1:] - steps, begin) + np.arange(steps)[:, None]
        inertias, asked, later = self.inertia[own], self.asked[own + 1], self.later_s[own]
        kicks, drifts = 0.5 * self.step_s[own], self.step_s[own] / inertias
        ahead = self.resting(own[0], np.sign(self.asked[own[0]]))
        momentum, turning = np.zeros(ahead.size), self.asked[own[0]]
        due, speeds, torques = turning, np.empty(own.shape), np.empty((2, *own.shape))
        for step, rows in enumerate(self.row[own]):
            momentum = momentum + kicks[step] * (turning - due)
            ahead, speed = ahead + drifts[step] * momentum, momentum / inertias[step]
            normal, turning = moments_of_arrays(self.meshing.impact, self.table[:, :, rows], ahead, speed, later[step])
            due = asked[step]
            momentum = momentum + kicks[step] * (turning - due)
            torques[NORMAL, step], torques[TURNING, step], speeds[step] = normal, turning, speed
        counted = (own >= edges[:-1]) & (own < edges[1:])
        order = np.argsort(own[counted])
        torque, speed = torques[:, counted][:, order], np.abs(speeds[counted][order])
        met = begin + 1 + np.flatnonzero((torque[NORMAL, :-1] == 0.0) & (torque[NORMAL, 1:] > 0.0))
        knocks = [knock for number in met for knock in self.knocks(int(number), float(speed[number - begin]))]
        return FollowedStretch(self.phi1_rad[begin + 1 : end + 1], torque, knocks)

    def resting(self, places: IndexArray, flank: Array) -> Array:
        """Angles beyond the law's of teeth that rest at places on a flank, +1 or -1, shape (n,), found by halving."""
        steps = np.minimum(places, self.last - 1)
        rows, impact, pushed = self.row[steps], self.meshing.impact, flank >= 0.0
        first, side = np.where(pushed, self.free[0][steps], self.free[1][steps]), np.where(pushed, 1.0, -1.0)
        load, pairs = self.asked[places] * side, self.table[:, :, rows]
        arm, _, stiffness, *_ = np.where(pushed, *(side[rows, 0].T for side in self.sides))
        # The first pair alone bears the load at this depth; friction may take a part of it.
        alone = (np.maximum(load, 0.0) / (np.abs(arm) * stiffness)) ** (1.0 / impact.exponent) / np.abs(arm)
        shallow, deep = 0.0 * alone, 2.0 * alone
        for _ in range(HALVINGS):
            middle = 0.5 * (shallow + deep)
            moments = moments_of_arrays(impact, pairs, first - side * middle, 0.0, self.later_s[steps])
            enough = moments[TURNING] * side >= load
            shallow, deep = np.where(enough, shallow, middle), np.where(enough, middle, deep)
        return np.where(load > IDLE * self.most_n_mm, first - side * deep, first)

    def settled(self, places: slice, torques: Array, momentum: float) -> bool:
        """Whether teeth that bear ``torques`` at places bear those of the law, and swing little.

        CHECKED swings on the teeth tell it, or any flight without load.
        """
        # A swing of this momentum presses the teeth with its torque.
        swinging, enough = abs(momentum) * self.fastest_rad_s, SETTLED * self.most_n_mm
        if swinging > enough or (torques[NORMAL, 0] and torques.shape[1] < CHECKED * PER_SWING):
            return False
        asked = self.asked[places]
        return bears(asked, max(float(np.abs(torques[TURNING] - asked).max()), swinging), self.most_n_mm)

    def knocks(self, step: int, speed_rad_s: float) -> list[Knock]:
        """The knock of flanks that meet in a step with a speed, if it is one."""
        pressed = speed_rad_s * self.inertia[step] * self.swing_rad_s[step]
        return knocks_at(self.phi1_rad[step + 1], speed_rad_s * self.levers_mm[self.row[step]], pressed, self.most_n_mm)


def bears(asked: Array, swinging: float, most_n_mm: float) -> bool:
    """Whether teeth that deviate so far from the torques ``asked`` (n,) bear those, swing little and stay in touch."""
    idle = float(np.abs(asked).max()) <= IDLE * most_n_mm
    return swinging <= SETTLED * most_n_mm and (idle or swinging <= TOUCHING * float(np.abs(asked).min()))


def knocks_at(phi1_rad: float, speed_mm_s: float, pressed_n_mm: float, most_n_mm: float) -> list[Knock]:
    """The knock of flanks whose speed presses them with a torque, if it is one."""
    return [Knock(float(phi1_rad), float(speed_mm_s))] if pressed_n_mm > SETTLED * most_n_mm else []


def _summed(values: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(values)])


@dataclass(frozen=True, eq=False)
class DrivenSide:
    """The driven side on its teeth; ``most_n_mm`` is the largest of the torques ``asked`` at driving angles (n,)."""

    meshing: Meshing
    load: CrankLoad
    asked: Callable[[Array], Array]
    speed_rad_s: float
    most_n_mm: float

    def swings_rad_s(self, phi1_rad: Array) -> Array:
        """How fast the driven side swings on two pairs of teeth at driving angles, shape (n,), in rad/s."""
        near = self.meshing.gaps.at(phi1_rad)
        pair = self.meshing.gaps.of_sections(near.stiffness * near.lever_mm**2)
        return np.asarray(np.sqrt(2.0 * pair / self.inertia(phi1_rad)))

    def inertia(self, phi1_rad: Array) -> Array:
        """The inertia J in N mm s^2 at driving angles, shape (n,)."""
        inertia: Array = self.load.table.at(self.meshing.law.at(phi1_rad)[0])[0][..., 0]
        return inertia

    def way(self, widest_rad: float, swings: Callable[[Array], Array], begin_rad: float, end_rad: float) -> Way:
        """The way between two driving angles; pairs keep their arms and stiffness for ``widest_rad`` at most.

        ``swings`` gives the speed of swings at driving angles.
        """
        gaps = self.meshing.gaps
        breaks, period = gaps.table.breaks, gaps.table.breaks[-1]
        turns = np.arange(begin_rad // period, end_rad // period + 1.0) * period
        inner = (turns[:, None] + breaks[:-1]).ravel()
        ends = np.concatenate([[begin_rad], inner[(inner > begin_rad) & (inner < end_rad)], [end_rad]])
        middles, widths = _divided((ends[1:] + ends[:-1]) / 2.0, np.diff(ends), widest_rad)
        swing = swings(middles)
        per_turn = np.maximum(PER_SWING * swing / self.speed_rad_s, PER_PITCH * int(gaps.pair[..., 0].max()))
        count = np.ceil(widths / (2.0 * pi) * per_turn).astype(int)
        row = np.repeat(np.arange(count.size), count)
        step = (widths / count)[row]
        phi1 = begin_rad + _summed(step)
        sides, levers = near_sides(self.meshing, middles, self.speed_rad_s, self.most_n_mm)
        return Way(
            self.meshing,
            phi1,
            self.asked(phi1),
            step / self.speed_rad_s,
            self.inertia(middles)[row],
            swing[row],
            (phi1[1:] - middles[row]) / self.speed_rad_s,
            row,
            sides,
            levers,
            self.most_n_mm,
        )


@dataclass(frozen=True, eq=False)
class Ways:
    """The ways of a driven side from ``begin_rad`` on, of ``width_rad`` each; the last KEPT of them are ``known``.

    ``made`` makes the way between two driving angles.
    """

    made: Callable[[float, float], Way]
    begin_rad: float
    width_rad: float
    known: dict[int, Way] = field(default_factory=dict)

    def at(self, number: int) -> Way:
        """One of the ways, from 0."""
        if number not in self.known:
            if len(self.known) == KEPT:
                del self.known[next(iter(self.known))]
            begin, end = (self.begin_rad + place * self.width_rad for place in (number, number + 1))
            self.known[number] = self.made(begin, end)
        return self.known[number]

    def with_play(self, share: float) -> Ways:
        """The same ways with ``share`` of the play."""
        known = {number: way.with_play(share) for number, way in self.known.items()}
        return replace(self, made=lambda *ends_rad: self.made(*ends_rad).with_play(share), known=known)

    def place(self, phi1_rad: float) -> tuple[int, int]:
        """The number of the way at a driving angle, and its last place up to there."""
        number = int((phi1_rad - self.begin_rad) / self.width_rad)
        return number, max(int(np.searchsorted(self.at(number).phi1_rad, phi1_rad, side="right")) - 1, 0)

    def followed(self, start_rad: float, flank: float, ends_rad: tuple[float, float]) -> FollowedStretch:
        """The torque of the teeth from a place, where they rest on one flank, until they have settled again.

        They are followed at least to the first and at most to the second of ``ends_rad``.
        """
        number, place = self.place(start_rad)
        way, here = self.at(number), np.array([place])
        borne = float(way.asked[place]) if way.asked[place] * flank > IDLE * way.most_n_mm else 0.0
        state = DrivenState(place, float(way.resting(here, np.array([flank]))[0]), 0.0, (borne, borne))
        phi1, torque, knocks = [way.phi1_rad[here]], [np.full((2, 1), borne)], list[Knock]()
        settled = False
        while phi1[-1][-1] < ends_rad[1] and not (settled and phi1[-1][-1] >= ends_rad[0]):
            if state.place == way.last:
                number, state = number + 1, replace(state, place=0)
                way = self.at(number)
            before = state.place
            if apart := not state.torques[NORMAL]:
                state = way.flown(state)
                every = np.zeros((2, state.place - before))
            else:
                state, every, _ = way.pressed(state)
            some = slice(before + 1, state.place + 1)
            if every.size:
                phi1.append(way.phi1_rad[some])
                torque.append(every)
                settled = way.settled(some, every, state.momentum)
            if apart and state.place < way.last and not (settled and phi1[-1][-1] >= ends_rad[0]):
                met = state.place
                state, every, speed_rad_s = way.pressed(state)
                phi1.append(way.phi1_rad[met + 1 : state.place + 1])
                torque.append(every)
                settled = False
                if every[NORMAL, 0]:
                    knocks += way.knocks(met, abs(speed_rad_s))
        return FollowedStretch(np.concatenate(phi1), np.concatenate(torque, axis=1), knocks)

    def settled(self, begin_rad: float, end_rad: float) -> list[FollowedStretch]:
        """The torques of settled teeth between two driving angles."""
        found = list[FollowedStretch]()
        (number, begin), (last, end) = self.place(begin_rad), self.place(end_rad - CLEAR * self.width_rad)
        while (number, begin) < (last, end):
            way = self.at(number)
            until = end if number == last else way.last
            found += [way.side_by_side(begin, until)] if begin < until else []
            number, begin = number + 1, 0
        return found


def _divided(middles: Array, widths: Array, widest: float) -> tuple[Array, Array]:
    """Middles and widths of intervals that are divided into even parts of at most the ``widest``."""
    parts = np.ceil(widths / widest).astype(int)
    own = np.repeat(widths / parts, parts)
    within = np.arange(own.size) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.repeat(middles - widths / 2.0, parts) + (within + 0.5) * own, own
