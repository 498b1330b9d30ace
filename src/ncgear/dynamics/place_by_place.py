"""The toothed machine at single states, as steps in time need it: ``Meshing``'s formulas for arrays, in plain numbers.

A motion needs some ten thousand states, one by one.  With arrays, or with functions that serve both, most of the
time would go into making and calling them; so the formulas stand here once more, and only touching pairs are computed.
``tests/test_place_by_place.py`` compares both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.gaps import ERROR, Gaps
from ncgear.dynamics.meshing import Friction, Meshing
from ncgear.numerics.arrays import Array
from ncgear.numerics.oscillator_steps import Pull
from ncgear.numerics.periodic_table import PlaceByPlace

SIDES = (1.0, -1.0)

KEPT = 256
"""Number of pairs in intervals whose coefficients are kept: the stages of a step go to and fro between a few."""


def _ranked(gaps: Gaps, side: float) -> Iterator[tuple[list[float], list[int]]]:
    """For each interval the pairs of a side that may touch first: the most that each is ahead in it, and its number."""
    error, width = gaps.table.coefficients[..., ERROR], np.diff(gaps.table.breaks)[:, None]
    ahead = side * error[3] + width * (abs(error[2]) + width * (abs(error[1]) + width * abs(error[0])))
    ahead = np.where(gaps.urge == side, ahead, -np.inf)
    order = np.argsort(-ahead, axis=1)
    numbers = order + gaps.urge.shape[1] * np.arange(len(order))[:, None]
    return zip(np.take_along_axis(ahead, order, axis=1).tolist(), numbers.tolist(), strict=True)


class StateByState:
    """What accelerates the shafts of a machine; it remembers its last intervals in each table.

    The drive ``answers`` as ``DriveLine.answer`` does, and has an inertia in N mm s^2, 0 for a constant speed.
    """

    def __init__(
        self,
        answers: Callable[[float, float], tuple[float, float]],
        inertia_n_mm_s2: float,
        meshing: Meshing,
        load: CrankLoad,
    ) -> None:
        self._answers, self._impact, self._friction = answers, meshing.impact, meshing.friction
        self._easily = 1.0 / inertia_n_mm_s2 if inertia_n_mm_s2 else 0.0
        self._law, self._load = PlaceByPlace.of(meshing.law), PlaceByPlace.of(load.table)
        self._rise, table = float(meshing.law.rise), meshing.gaps.table
        self._gaps = PlaceByPlace(
            table.breaks, list(zip(*(_ranked(meshing.gaps, side) for side in SIDES), strict=True))
        )
        self._pairs = np.moveaxis(table.coefficients, 0, -1).reshape(-1, table.coefficients.shape[-1], 4)
        self._known = dict[int, list[list[float]]]()

    def _taken(self, number: int) -> list[list[float]]:
        """The coefficients of a pair in an interval."""
        if len(self._known) > KEPT:
            self._known.clear()
        found = self._known[number] = self._pairs[number].tolist()
        return found

    def pull(self, place: complex, speed: complex) -> Pull:
        """At angles and speeds of the driving shaft (real part) and the driven: the touching teeth are the spring."""
        phi2, speed2 = place.imag, speed.imag
        driving, driven, ratio, stiffness, damping = self._teeth(place.real, speed.real, phi2, speed2)
        acceleration2, inertia = self._crank(phi2, speed2, driven)
        backwards, ahead = -ratio * self._easily, 1.0 / inertia
        both = ahead - ratio * backwards
        return Pull(
            complex(self._answers(speed.real, driving)[0], acceleration2),
            stiffness * both,
            damping * both,
            ratio,
            complex(backwards, ahead) / both,
        )

    def _crank(self, phi2: float, speed2: float, driven: float) -> tuple[float, float]:
        """Acceleration of the crank under a moment of the teeth, and its inertia."""
        _, step = self._load.at(phi2)
        (m3, m2, m1, m0), (u3, u2, u1, _) = self._load.rows
        inertia, bend = ((m3 * step + m2) * step + m1) * step + m0, (3.0 * m3 * step + 2.0 * m2) * step + m1
        moment = (3.0 * u3 * step + 2.0 * u2) * step + u1
        return (driven - moment - 0.5 * bend * speed2 * speed2) / inertia, inertia

    def _teeth(self, phi1: float, speed1: float, phi2: float, speed2: float) -> tuple[float, ...]:
        """Moments of all touching pairs on the driving and on the driven gear, the law's slope, stiffness and damping.

        Stiffness and damping are those of a small turn of the driven gear, in N mm and N mm s.
        """
        turns, x = self._law.at(phi1)
        a5, a4, a3, a2, a1, a0 = self._law.rows
        ahead = ((((a5 * x + a4) * x + a3) * x + a2) * x + a1) * x + a0 + turns * self._rise - phi2
        ratio = (((5.0 * a5 * x + 4.0 * a4) * x + 3.0 * a3) * x + 2.0 * a2) * x + a1
        _, x = self._gaps.at(phi1)
        impact, driving, driven, stiffness, damping = self._impact, 0.0, 0.0, 0.0, 0.0
        for urge, pairs in zip(SIDES, self._gaps.rows, strict=True):
            least = -urge * ahead
            for most, number in zip(*pairs, strict=True):
                if most <= least:
                    break
                error, lever, along1, along2, stiff = self._known.get(number) or self._taken(number)
                e3, e2, e1, e0 = error
                behind = ((e3 * x + e2) * x + e1) * x + e0 + ahead
                l3, l2, l1, l0 = lever
                arm = urge * (((l3 * x + l2) * x + l1) * x + l0)
                depth = arm * behind
                if depth <= 0.0:
                    continue
                rate = ratio + (3.0 * e3 * x + 2.0 * e2) * x + e1
                by_driving = urge * ((3.0 * l3 * x + 2.0 * l2) * x + l1) * behind + arm * rate
                closing = by_driving * speed1 - arm * speed2
                k3, k2, k1, k0 = stiff
                power, share = depth**impact.exponent, depth / impact.full_damping_depth_mm
                elastic = (((k3 * x + k2) * x + k1) * x + k0) * power
                damped = impact.damping_n_s_mm * (share * share * (3.0 - 2.0 * share) if share < 1.0 else 1.0)
                normal = elastic + damped * closing
                if normal > 0.0:
                    stiffness += arm * arm * impact.exponent * elastic / depth
                    damping += arm * arm * damped
                else:
                    normal = 0.0
                p3, p2, p1, p0 = along1
                q3, q2, q1, q0 = along2
                passing1, passing2 = ((p3 * x + p2) * x + p1) * x + p0, ((q3 * x + q2) * x + q1) * x + q0
                rubbing = coefficient(self._friction, passing1 * speed1 - passing2 * speed2) * normal
                stored = ((3.0 * k3 * x + 2.0 * k2) * x + k1) * power * depth / (impact.exponent + 1.0)
                driving -= normal * by_driving + stored + rubbing * passing1
                driven += normal * arm + rubbing * passing2
        return driving, driven, ratio, stiffness, damping


class TrainByState(StateByState):
    """The rates of pairs in series: ``meshing`` is the last of them, and shafts of inertias are between them."""

    def __init__(
        self,
        answers: Callable[[float, float], tuple[float, float]],
        meshing: Meshing,
        load: CrankLoad,
        before: Sequence[Meshing],
        between_n_mm_s2: Sequence[float],
    ) -> None:
        super().__init__(answers, 0.0, meshing, load)
        self._meshes = [*(StateByState(answers, 0.0, mesh, load) for mesh in before), self]
        self._between = between_n_mm_s2

    def change(self, state: Array) -> Array:
        """Derivatives by time of the angle and the speed of each shaft, from the driving one on, shape (2 shafts,)."""
        shafts = list(zip(*[iter(state.tolist())] * 2, strict=True))
        moments = [mesh._teeth(*one, *two)[:2] for mesh, (one, two) in zip(self._meshes, pairwise(shafts), strict=True)]
        rates = [self._answers(shafts[0][1], moments[0][0])[0]]
        for inertia, ((_, turned), (held, _)) in zip(self._between, pairwise(moments), strict=True):
            rates.append((turned + held) / inertia)
        rates.append(self._crank(shafts[-1][0], shafts[-1][1], moments[-1][1])[0])
        return np.column_stack([state[1::2], rates]).ravel()


def coefficient(friction: Friction, sliding_mm_s: float) -> float:
    """As ``Friction.coefficient``."""
    speed, least = abs(sliding_mm_s), friction.static_mm_s
    if speed >= friction.dynamic_mm_s:
        size = friction.dynamic
    elif speed >= least:
        share = (speed - least) / (friction.dynamic_mm_s - least)
        size = friction.static - (friction.static - friction.dynamic) * share * share * (3.0 - 2.0 * share)
    else:
        share = speed / least
        size = friction.static * share * share * (3.0 - 2.0 * share)
    return size if sliding_mm_s > 0.0 else -size
