"""The toothed machine at single states, as solvers need it: the formulas of ``Meshing`` for arrays, in plain numbers.

A solver needs some hundred thousand states, one by one.  With arrays, or with functions that serve both, most of the
time would go into making and calling them; so the formulas stand here once more, and only touching pairs are computed.
``tests/test_place_by_place.py`` compares both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.meshing import Friction, Meshing
from ncgear.numerics.arrays import Array
from ncgear.numerics.periodic_table import PlaceByPlace


class StateByState:
    """The rates of a machine's states; it remembers its last interval in each table.

    The drive ``answers`` as ``DriveLine.answer`` does.
    """

    def __init__(
        self, answers: Callable[[float, float], tuple[float, float]], meshing: Meshing, load: CrankLoad
    ) -> None:
        self._answers, self._impact, self._friction = answers, meshing.impact, meshing.friction
        self._law, self._gaps = PlaceByPlace(meshing.law), PlaceByPlace(meshing.gaps.table)
        self._load, self._rise = PlaceByPlace(load.table), float(meshing.law.rise)
        self._urge = meshing.gaps.urge
        self._slots, self._interval = list[tuple[float, list[list[float]]]](), -1

    def change(self, state: Array) -> Array:
        """Derivatives of a state (phi1, phi1', phi2, phi2', work, losses) by time, shape (6,) both."""
        phi1, speed1, phi2, speed2, _, _ = state.tolist()
        driving, driven, loss = self._teeth(phi1, speed1, phi2, speed2)
        acceleration1, torque = self._answers(speed1, driving)
        return np.array((speed1, acceleration1, speed2, self._crank(phi2, speed2, driven), torque * speed1, loss))

    def _crank(self, phi2: float, speed2: float, driven: float) -> float:
        """Acceleration of the crank under a moment of the teeth."""
        _, step = self._load.at(phi2)
        (m3, m2, m1, m0), (u3, u2, u1, _) = self._load.rows
        inertia, bend = ((m3 * step + m2) * step + m1) * step + m0, (3.0 * m3 * step + 2.0 * m2) * step + m1
        moment = (3.0 * u3 * step + 2.0 * u2) * step + u1
        return (driven - moment - 0.5 * bend * speed2 * speed2) / inertia

    def _teeth(self, phi1: float, speed1: float, phi2: float, speed2: float) -> tuple[float, float, float]:
        """Moments of all pairs that touch on the driving and on the driven gear, and the power that they take."""
        turns, x = self._law.at(phi1)
        a5, a4, a3, a2, a1, a0 = self._law.rows
        ahead = ((((a5 * x + a4) * x + a3) * x + a2) * x + a1) * x + a0 + turns * self._rise - phi2
        ratio = (((5.0 * a5 * x + 4.0 * a4) * x + 3.0 * a3) * x + 2.0 * a2) * x + a1
        _, x = self._gaps.at(phi1)
        if self._interval != self._gaps.index:
            self._interval = self._gaps.index
            urges = self._urge[self._interval].tolist()
            self._slots = [(urge, rows) for urge, rows in zip(urges, self._gaps.rows, strict=True) if urge]
        impact, driving, driven, loss = self._impact, 0.0, 0.0, 0.0
        full, exponent, deep = impact.damping_n_s_mm, impact.exponent, impact.full_damping_depth_mm
        for urge, (error, lever, along1, along2, stiff) in self._slots:
            e3, e2, e1, e0 = error
            behind = ((e3 * x + e2) * x + e1) * x + e0 + ahead
            if urge * behind <= 0.0:
                continue
            l3, l2, l1, l0 = lever
            arm = urge * (((l3 * x + l2) * x + l1) * x + l0)
            rate = ratio + (3.0 * e3 * x + 2.0 * e2) * x + e1
            by_driving = urge * ((3.0 * l3 * x + 2.0 * l2) * x + l1) * behind + arm * rate
            depth, closing = arm * behind, by_driving * speed1 - arm * speed2
            if depth <= 0.0:
                continue
            k3, k2, k1, k0 = stiff
            power, share = depth**exponent, depth / deep
            elastic = (((k3 * x + k2) * x + k1) * x + k0) * power
            ramped = full if share >= 1.0 else full * share * share * (3.0 - 2.0 * share)
            normal = elastic + ramped * closing
            if normal < 0.0:
                normal = 0.0
            p3, p2, p1, p0 = along1
            q3, q2, q1, q0 = along2
            passing1, passing2 = ((p3 * x + p2) * x + p1) * x + p0, ((q3 * x + q2) * x + q1) * x + q0
            sliding = passing1 * speed1 - passing2 * speed2
            rubbing = coefficient(self._friction, sliding) * normal
            stored = ((3.0 * k3 * x + 2.0 * k2) * x + k1) * power * depth / (exponent + 1.0)
            driving -= normal * by_driving + stored + rubbing * passing1
            driven += normal * arm + rubbing * passing2
            loss += (normal - elastic) * closing + rubbing * sliding
        return driving, driven, loss


class TrainByState(StateByState):
    """The same of pairs in series: ``meshing`` is the last of them, and shafts of inertias are between them."""

    def __init__(
        self,
        answers: Callable[[float, float], tuple[float, float]],
        meshing: Meshing,
        load: CrankLoad,
        before: Sequence[Meshing],
        between_n_mm_s2: Sequence[float],
    ) -> None:
        super().__init__(answers, meshing, load)
        self._pairs = [*(StateByState(answers, one, load) for one in before), self]
        self._between = between_n_mm_s2

    def change(self, state: Array) -> Array:
        """Derivatives of a state by time, shape (6 + 2 between,) both."""
        phi1, speed1, phi2, speed2, _, _, *between = state.tolist()
        shafts = [(phi1, speed1), *zip(between[::2], between[1::2], strict=True), (phi2, speed2)]
        ends = zip(self._pairs, shafts, shafts[1:], strict=False)
        moments = [pair._teeth(*driving, *driven) for pair, driving, driven in ends]
        acceleration1, torque = self._answers(speed1, moments[0][0])
        rates = [speed1, acceleration1, speed2, self._crank(phi2, speed2, moments[-1][1])]
        rates += [torque * speed1, sum(loss for *_, loss in moments)]
        for inertia, (_, speed), (_, turned, _), (held, _, _) in zip(
            self._between, shafts[1:], moments, moments[1:], strict=False
        ):
            rates += [speed, (turned + held) / inertia]
        return np.array(rates)


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
