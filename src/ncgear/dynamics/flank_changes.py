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
Lubich, G. Wanner, Acta Numerica 12 (2003), 399-450): over the whole cycle, or where that takes too many swings, only
from a reversal or jump of the torque until the teeth have settled; elsewhere they bear T.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import field, replace
from math import pi

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.meshing import Meshing, NearPairs, moments_n_mm, near_pairs
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray

SAMPLES = 4096
"""Places of a cycle at which the torque is tested for reversals and jumps."""

IDLE = 1e-6
"""Share of the largest torque under which it presses no flank."""

JUMP = 0.05
"""Change between two such places that is a jump, as a share of the largest torque; a smooth change takes a degree."""

PER_SWING = 24
"""Steps in a swing of the driven side on two pairs of teeth: the error of its time is (2 pi / 24)^2 / 24, 0.3 %, and
four pairs are far from the 3.2 steps at which the method fails."""

PER_PITCH = 48
"""Least steps in a pitch: where the driven side swings more slowly than teeth pass, as with a flywheel."""

HELD = 4
"""Steps for which arms, stiffness, loads and inertia keep their values of the middle: a sixth of a swing.  Gaps keep
changing: meeting teeth close gaps of many times the depth to which load presses them."""

SWINGS, TOGETHER, CHECKED = 96, 16, 4
"""Swings with steps of the same length, swings whose pairs and loads are computed together where the teeth may settle
at any time, and swings between two tests whether they have settled."""

FINER = 1.0, 1.04, 1.08
"""Factors by which the steps are finer in the runs that follow knocks.  Knocks may differ from turn to turn, like a
bouncing ball, and then also with the steps: each run stands for another turn, and the hardest knocks count."""

FEW, FEWEST = 4000, 300
"""Most and fewest swings in a cycle that is followed as a whole.  With fewer, as with a flywheel on the driven shaft,
swings are about as slow as the passing of teeth, a resonance that K_V covers.  Pairs that come and go swing the driven
side, less with slower passing: by 30 % of the torque with 17 swings to a pitch, by 20 % with 30 (a shaper)."""

SETTLED, TOUCHING = 0.03, 0.5
"""Largest deviations of settled teeth from the torque of the law: as a share of the largest torque (K_V covers smaller
swings), and as a share of the torque there, so that they do not part again."""


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
class BorneTorque:
    """The torque in N mm that the teeth bear in a cycle, with all its ``knocks``; None where these are not followed.

    ``asked`` is the torque of the law at driving angles, shape (n,).  From the first of ``phi1_rad`` (shape (m,),
    rising over two cycles at most) on there is ``torque_n_mm`` instead, shape (2, m): the moment of the normal forces,
    and the torque that turns the driven side, which friction makes smaller or larger; NaN stands between two stretches.
    Where a place is followed in two cycles, the later cycle counts.  ``slow_swings`` is the number of swings in a cycle
    of a driven side without knocks that swings too slowly to be followed: the torque may rouse them.  Else it is 0.
    """

    asked: Callable[[Array], Array]
    cycle_rad: float
    phi1_rad: Array = field(default_factory=lambda: np.empty(0))
    torque_n_mm: Array = field(default_factory=lambda: np.empty((2, 0)))
    knocks: tuple[Knock, ...] | None = None
    others: tuple[BorneTorque, ...] = ()
    slow_swings: float = 0.0

    def at(self, phi1_rad: Array) -> Array:
        """The torque of the normal forces at driving angles, shape (n,): the law's or the followed one, if larger.

        The moments at which flying teeth bear less than the law's torque are known less well than the force of their
        knocks.  ``others`` are runs with other steps; the largest torque of all runs counts at each place.
        """
        return self._larger(phi1_rad, NORMAL)

    @property
    def turning_n_mm(self) -> Array:
        """The torque of this run that turns the driven side, shape (m,)."""
        return self.torque_n_mm[TURNING]

    def turning(self, phi1_rad: Array) -> Array:
        """As ``at``, the torque that turns the driven side."""
        return self._larger(phi1_rad, TURNING)

    def _larger(self, phi1_rad: Array, row: int) -> Array:
        torque = asked = self.asked(phi1_rad)
        for one in (self, *self.others):
            again = one._own(phi1_rad, asked, row)
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
    finer: Sequence[float] = FINER,
) -> BorneTorque:
    """The torque that the teeth bear where the law demands ``asked`` at a constant driving speed.

    It is ``asked`` itself where this neither reverses nor jumps in a cycle of more than FEW swings.  Where teeth knock,
    it is followed once for each of ``finer``; the first run gives the knocks and follows the whole cycle.
    """
    phi1 = np.linspace(0.0, cycle_rad, SAMPLES, endpoint=False)
    torque = asked(phi1)
    most = float(np.abs(torque).max())
    driven = _DrivenSide(meshing, load, asked, speed_rad_s, most)
    flank, jump = flanks_of(torque, IDLE * most), np.roll(torque, -1) - torque
    # With swings of w rad/s the driven side deviates from T by T'' / w^2, and swings by dT' / w after a kink.
    steps = cycle_rad / SAMPLES / speed_rad_s * driven.swings_rad_s(phi1)
    hurried = np.abs(np.roll(jump, -1) - jump) > SETTLED * most * np.minimum(steps, steps**2)
    rows = np.flatnonzero((flank != np.roll(flank, -1)) | (np.abs(jump) > JUMP * most) | hurried)
    swings = float(steps.sum()) / (2.0 * pi)
    whole, slow = FEWEST < swings < FEW, swings if most and swings <= FEWEST else 0.0
    if not most or not (whole or rows.size):
        return BorneTorque(asked, cycle_rad, knocks=(), slow_swings=slow)
    rows = rows if rows.size else np.zeros(1, dtype=int)
    # The longest stretch without a turn or a jump comes last: there the teeth have most time to settle.
    rows = np.roll(rows, -int(np.argmax(np.diff(rows, prepend=rows[-1] - SAMPLES))))
    starts, width_rad = driven.closer(phi1[rows] + cycle_rad * (rows < rows[0]), cycle_rad / SAMPLES)
    driven = replace(driven, asked=_between(asked, torque, rows, cycle_rad))
    end_rad = starts[0] + 2.0 * cycle_rad

    def once(driven: _DrivenSide, least_rad: float) -> BorneTorque:
        found = list[FollowedStretch]()
        for start_rad, on in zip(starts, flank[rows], strict=True):
            if not found or start_rad > found[-1].phi1_rad[-1]:
                found.append(driven.followed(float(start_rad), float(on), (start_rad + least_rad, end_rad)))
        return joined(found, asked, cycle_rad)

    first, *others = finer
    followed = once(replace(driven, finer=first), cycle_rad if whole else 2.0 * width_rad)
    if not followed.knocks:
        return followed if whole else BorneTorque(asked, cycle_rad, knocks=(), slow_swings=slow)
    return replace(followed, others=tuple(once(replace(driven, finer=one), 2.0 * width_rad) for one in others))


def _between(
    asked: Callable[[Array], Array], torque: Array, rows: IndexArray, cycle_rad: float
) -> Callable[[Array], Array]:
    """The demanded torque from its values at SAMPLES even places of a cycle, linear between them.

    In the spaces after ``rows``, where it turns or leaps, it is ``asked`` itself.
    """
    closed, exact = np.append(torque, torque[0]), np.isin(np.arange(SAMPLES), rows)

    def at(phi1_rad: Array) -> Array:
        place = phi1_rad % cycle_rad / cycle_rad * SAMPLES
        row = np.minimum(place.astype(int), SAMPLES - 1)
        found: Array = closed[row] + (place - row) * (closed[row + 1] - closed[row])
        if np.any(here := exact[row]):
            found[here] = asked(phi1_rad[here])
        return found

    return at


def flanks_of(torque: Array, idle: float) -> Array:
    """+1 where pushing flanks bear a torque, -1 where their backs do, shape (n,); idle teeth keep their side."""
    pressed = np.flatnonzero(np.abs(torque) > idle)
    if not pressed.size:
        return np.ones_like(torque)
    last: IndexArray = pressed[np.searchsorted(pressed, np.arange(torque.size), side="right") - 1]
    return np.sign(torque[last])


@dataclass(frozen=True, eq=False)
class FollowedStretch:
    """The followed motion after a reversal or a jump: driving angles (n,), torques (2, n), and the knocks."""

    phi1_rad: Array
    torque_n_mm: Array
    knocks: list[Knock]


def joined(found: list[FollowedStretch], asked: Callable[[Array], Array], cycle_rad: float) -> BorneTorque:
    """Stretches one after the other, with the knocks of the last cycle."""
    end_rad, phi1, torque = float(found[-1].phi1_rad[-1]), list[Array](), list[Array]()
    for one in found:
        if phi1:
            phi1.append(np.array([(phi1[-1][-1] + one.phi1_rad[0]) / 2.0]))
            torque.append(np.full((2, 1), np.nan))
        phi1.append(one.phi1_rad)
        torque.append(one.torque_n_mm)
    every = [knock for one in found for knock in one.knocks if knock.phi1_rad > end_rad - cycle_rad]
    knocks = tuple(replace(knock, phi1_rad=knock.phi1_rad % cycle_rad) for knock in every)
    return BorneTorque(asked, cycle_rad, np.concatenate(phi1), np.concatenate(torque, axis=1), knocks)


@dataclass(frozen=True, eq=False)
class _DrivenSide:
    """The driven side on its teeth; ``most_n_mm`` is the largest demanded torque.

    There are ``finer`` times PER_SWING steps in a swing.
    """

    meshing: Meshing
    load: CrankLoad
    asked: Callable[[Array], Array]
    speed_rad_s: float
    most_n_mm: float
    finer: float = 1.0

    def closer(self, starts_rad: Array, width_rad: float) -> tuple[Array, float]:
        """Places shape (n,), and their width, less than a swing, within which the torque changes most after each."""
        swing = float(self.swings_rad_s(starts_rad).max())
        while width_rad / self.speed_rad_s * swing > 1.0:
            places = starts_rad[:, None] + width_rad * np.linspace(0.0, 1.0, PER_SWING + 1)
            torque = self.asked(places.ravel()).reshape(places.shape)
            changed = np.abs(np.diff(torque)) + self.most_n_mm * np.abs(np.diff(np.sign(torque)))
            starts_rad = places[np.arange(starts_rad.size), changed.argmax(axis=1)]
            width_rad /= PER_SWING
        return starts_rad, width_rad

    def followed(self, start_rad: float, flank: float, ends_rad: tuple[float, float]) -> FollowedStretch:
        """The torque of the teeth from a place, where they are settled on one flank, until they have settled again.

        They are followed at least to the first and at most to the second of ``ends_rad``.
        """
        torque = [np.tile(self.asked(np.array([start_rad])), (2, 1))]
        settled_at = settled_rad(self.meshing, start_rad, float(torque[0][0, 0]), flank, IDLE * self.most_n_mm)
        state, phi1, knocks = (settled_at, 0.0), [np.array([start_rad])], list[Knock]()
        for part in self._parts(start_rad, ends_rad):
            borne, state, met = self._stepped(state, part)
            phi1.append(part.phi1_rad)
            torque.append(borne)
            knocks += [
                Knock(float(part.middles_rad[row]), speed * float(part.levers_mm[row]))
                for row, speed in met
                if speed * float(part.inertia[row]) * part.swing_rad_s > SETTLED * self.most_n_mm
            ]
            # A swing of this momentum presses the teeth with its torque.
            missed = float(np.abs(borne[TURNING] - np.repeat(part.asked, HELD)).max())
            swinging = max(missed, abs(state[1]) * part.swing_rad_s)
            least, most = float(np.abs(part.asked).min()), float(np.abs(part.asked).max())
            touching = swinging <= TOUCHING * least or most <= IDLE * self.most_n_mm
            if touching and swinging <= SETTLED * self.most_n_mm and phi1[-1][-1] >= ends_rad[0]:
                break
        return FollowedStretch(np.concatenate(phi1), np.concatenate(torque, axis=1), knocks)

    def _parts(self, start_rad: float, ends_rad: tuple[float, float]) -> Iterator[_Part]:
        """The parts of the way from a place to the second of ``ends_rad``; up to the first all are needed."""
        place, rows = start_rad, CHECKED * PER_SWING // HELD
        while place < ends_rad[1]:
            step_s, swing = self._step(place)
            step_rad = self.speed_rad_s * step_s
            middles = np.array([place]) + HELD * step_rad * (np.arange(SWINGS * PER_SWING // HELD) + 0.5)
            together = middles.size if middles[-1] < ends_rad[0] else TOGETHER * PER_SWING // HELD
            for begin in range(0, middles.size, together):
                some = middles[begin : begin + together]
                pairs, levers = near_pairs(self.meshing, some, self.speed_rad_s, self.most_n_mm)
                columns = some, levers, self._inertia(some), self.asked(some)
                for first in range(0, some.size, rows):
                    part = slice(first, first + rows)
                    phi1 = place + step_rad * np.arange(1.0, HELD * rows + 1.0)
                    yield _Part(step_s, swing, phi1, pairs[part], *(column[part] for column in columns))
                    place = float(phi1[-1])

    def _stepped(
        self, state: tuple[float, float], part: _Part
    ) -> tuple[Array, tuple[float, float], list[tuple[int, float]]]:
        """The torques after each of the HELD steps of n rows, shape (2, n HELD), and the last state.

        A state is the driven angle beyond the law's and its momentum.  Then the row and the speed of meeting flanks.
        """
        (ahead_rad, momentum), met, every = state, list[tuple[int, float]](), list[tuple[float, float]]()
        impact, step_s, pairs = self.meshing.impact, part.step_s, part.pairs
        inertia, later_s = part.inertia.tolist(), [step_s * (step + 1 - HELD / 2) for step in range(HELD)]
        normal, turning = moments_n_mm(impact, pairs[0], ahead_rad, momentum / inertia[0], -step_s * HELD / 2)
        for row, (near, mass, load) in enumerate(zip(pairs, inertia, part.asked.tolist(), strict=True)):
            for later in later_s:
                momentum += 0.5 * step_s * (turning - load)
                speed_rad_s = momentum / mass
                ahead_rad += step_s * speed_rad_s
                apart = not normal
                normal, turning = torques = moments_n_mm(impact, near, ahead_rad, speed_rad_s, later)
                momentum += 0.5 * step_s * (turning - load)
                if apart and normal:
                    met.append((row, abs(speed_rad_s)))
                every.append(torques)
        return np.array(every).T, (ahead_rad, momentum), met

    def _step(self, phi1_rad: float) -> tuple[float, float]:
        """The time between two steps of the swings from a place on, and how fast these are in rad/s."""
        way = 2.0 * pi * self.speed_rad_s * SWINGS / self.swings_rad_s(np.array([phi1_rad]))
        swing = float(self.swings_rad_s(phi1_rad + way * np.linspace(0.0, 1.0, PER_SWING)).max())
        steps = max(PER_SWING * swing, PER_PITCH * self.speed_rad_s * int(self.meshing.gaps.pair[..., 0].max()))
        return 2.0 * pi / (steps * self.finer), swing

    def swings_rad_s(self, phi1_rad: Array) -> Array:
        """How fast the driven side swings on two pairs of teeth at driving angles, shape (n,), in rad/s."""
        near = self.meshing.gaps.at(phi1_rad)
        pair = self.meshing.gaps.of_sections(near.stiffness * near.lever_mm**2)
        return np.asarray(np.sqrt(2.0 * pair / self._inertia(phi1_rad)))

    def _inertia(self, phi1_rad: Array) -> Array:
        inertia: Array = self.load.table.at(self.meshing.law.at(phi1_rad)[0])[0][..., 0]
        return inertia


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of the followed way: n rows of HELD steps, with the values of the middles of the rows, shape (n,) each.

    The steps end at ``phi1_rad``, shape (n HELD,); ``levers_mm`` are the largest levers of ``pairs``.  The driven side,
    of ``inertia``, swings by ``swing_rad_s`` at most.
    """

    step_s: float
    swing_rad_s: float
    phi1_rad: Array
    pairs: Sequence[NearPairs]
    middles_rad: Array
    levers_mm: Array
    inertia: Array
    asked: Array


def settled_rad(meshing: Meshing, phi1_rad: float, torque_n_mm: float, flank: float, idle: float) -> float:
    """The driven angle beyond the law's of settled teeth that bear a torque on their flank, or next to no torque."""
    here = np.array([phi1_rad])
    if torque_n_mm * flank <= idle:
        pushing, back = meshing.gaps.play_rad(here)
        return float(pushing[0] if flank > 0.0 else back[0])
    return float(loaded_contact(meshing, here, np.array([torque_n_mm]), 0.0).error_rad[0])
