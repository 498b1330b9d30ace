"""Knocks of pairs in series against another solver, and against a single pair where both must agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drives import drive_of_text
from ncgear.dynamics.flank_changes import BorneTorque, borne_torque
from ncgear.dynamics.meshing import Friction, Impact, Meshing
from ncgear.dynamics.train_knocks import KnockingTrain, TrainPair
from test_flank_changes import INERTIA, LEVER_MM, PLAY_RAD, SPEED, TURN, TURNING, load, saw, teeth

Array = np.ndarray
SLOPES = 1.0, 0.8
"""How fast the driven gear of each pair turns over its driving gear; three pairs are quicker in the middle."""
OF_THREE = 0.8, 1.25, 0.9


def damping(share: float, inertia: float) -> float:
    return 2.0 * share * sqrt(TURNING * inertia) / LEVER_MM**2


def with_slope(meshing: Meshing, slope: float) -> Meshing:
    law = meshing.law
    return replace(meshing, law=replace(law, coefficients=slope * law.coefficients, rise=slope * law.rise))


def train(between: float, share: float = 0.1, rub: float = 0.0, slopes: tuple[float, ...] = SLOPES) -> KnockingTrain:
    """Pairs alike; the shafts between ask for nothing, since all laws are even."""
    one = rubbing(teeth(damping=damping(share, between)), rub)
    speeds = np.cumprod([1.0, *slopes]).tolist()

    def asked(speed: float, own: float) -> Callable[[Array], Array]:
        """The driven side's torque by the angle of a driving gear of this speed, on a driven gear of its ``own``."""
        return lambda angle: speeds[-1] / own * saw(angle / speed)

    pairs = [
        TrainPair(with_slope(one, slope), asked(speed, own))
        for slope, speed, own in zip(slopes, speeds, speeds[1:], strict=False)
    ]
    return KnockingTrain(tuple(pairs), (between,) * (len(slopes) - 1), load(), SPEED)


ALONG_MM = 12.0, 14.0
"""Speeds of driven and driving points along the tangent over those of their shafts: flanks slide in one sense."""


def rubbing(meshing: Meshing, rub: float) -> Meshing:
    """The same teeth with friction."""
    driven, driving = ALONG_MM
    values = meshing.gaps.table.coefficients.copy()
    values[..., 2], values[..., 3] = driving, driven
    gaps = replace(meshing.gaps, table=replace(meshing.gaps.table, coefficients=values))
    return replace(meshing, gaps=gaps, friction=Friction(rub, rub, 1e-3, 2e-3))


def solved(one: KnockingTrain, slopes: tuple[float, ...], end: float) -> tuple[Array, Array]:
    """Radau follows the actual angles of all shafts, each pair as two springs with damping about a gap.

    Friction presses on both gears of a pair, so that a shaft between also gives what the next pair's takes.
    """
    count, inertias = len(slopes), np.array([*one.between, INERTIA])

    def moment(impact: Impact, gap: float, rate: float) -> float:
        """Of a driven gear that is ``gap`` beyond its law, at the speed ``rate``: 0 within the play."""
        pressed = -gap if gap < 0.0 else gap - PLAY_RAD
        if pressed <= 0.0:
            return 0.0
        sign, depth = (1.0 if gap < 0.0 else -1.0), LEVER_MM * pressed
        damped = -impact.damping(depth) * sign * LEVER_MM * rate
        return sign * LEVER_MM * float(impact.force_n(LEVER_MM * pressed * TURNING / LEVER_MM**2, damped))

    def moments(t: float, state: Array) -> Array:
        angle, speed = [SPEED * t, *state[:count]], [SPEED, *state[count:]]
        return np.array(
            [
                moment(pair.meshing.impact, angle[k + 1] - slope * angle[k], speed[k + 1] - slope * speed[k])
                for k, (pair, slope) in enumerate(zip(one.pairs, slopes, strict=True))
            ]
        )

    def slope_at(t: float, state: Array) -> Array:
        borne, asked = moments(t, state), float(saw(np.array([SPEED * t]))[0])
        rubbed = np.array([pair.meshing.friction.dynamic for pair in one.pairs]) * np.abs(borne) / LEVER_MM
        turned = borne + rubbed * ALONG_MM[0]
        turned[:-1] -= np.array(slopes[1:]) * borne[1:] + rubbed[1:] * ALONG_MM[1]
        turned[-1] -= asked
        return np.concatenate([state[count:], turned / inertias])

    begin = 0.5 * pi
    angles, speeds = [begin], [SPEED]
    for pair, slope, own in zip(one.pairs, slopes, np.cumprod([1.0, *slopes]), strict=False):
        angles.append(slope * angles[-1] - float(pair.asked(np.array([own * begin]))[0]) / TURNING)
        speeds.append(slope * speeds[-1])
    q = [*angles[1:], *speeds[1:]]
    found = solve_ivp(slope_at, (begin / SPEED, end / SPEED), q, "Radau", rtol=1e-9, atol=1e-12, max_step=2e-5)
    assert found.success
    return SPEED * found.t, np.array([moments(t, state) for t, state in zip(found.t, found.y.T, strict=True)]).T


def highest(found: BorneTorque, low: float, high: float) -> float:
    """The largest torque against the way between two angles."""
    return float((-found.at(np.linspace(low, high, 40001))).max())


@pytest.mark.tiers(slow=["0.5*"], rest="long")
@pytest.mark.judges("dynamics")
@pytest.mark.parametrize(
    ("share", "rub", "slopes"),
    [(0.5, 0.0, SLOPES), (0.5, 0.1, SLOPES), (0.1, 0.0, SLOPES), (0.5, 0.1, OF_THREE)],
    ids=["0.5", "0.5-rub", "0.1", "0.5-three"],
)
def test_knocks_of_all_pairs_are_those_of_another_solver(share: float, rub: float, slopes: tuple[float, ...]) -> None:
    """Peaks within 7 %: here x is of the first order, and pairs are held for four steps."""
    one = train(share * INERTIA, rub=rub, slopes=slopes)
    phi1, moments = solved(one, slopes, pi + 0.1)
    window = (phi1 > pi - 0.05) & (phi1 < pi + 0.1)
    for borne, moment, speed in zip(one.borne(TURN), moments, np.cumprod([1.0, *slopes]), strict=False):
        peak = float(-moment[window].min())
        assert highest(borne, speed * (pi - 0.05), speed * (pi + 0.1)) == pytest.approx(peak, rel=0.07)
        assert peak > 1.3e4
        assert borne.knocks


@pytest.mark.judges("dynamics")
def test_on_heavy_shafts_the_last_pair_knocks_as_a_single_one() -> None:
    """The shafts between then turn as evenly as a driving shaft; light ones make other knocks."""
    heavy, light = (train(share * INERTIA, slopes=(1.0, *SLOPES)).borne(TURN)[-1] for share in (1e5, 0.1))
    pair = train(1e5 * INERTIA).pairs[-1].meshing
    alone = borne_torque(pair, load(), saw, SPEED, TURN)
    peaks = [highest(one, pi, pi + 0.1) for one in (heavy, alone, light)]
    assert peaks[0] == pytest.approx(peaks[1], rel=0.02)
    assert abs(peaks[2] / peaks[1] - 1.0) > 0.05


@pytest.mark.judges("dynamics")
def test_friction_of_pairs_in_series() -> None:
    """Wherever teeth push, the moment of their normal forces over the turning one is arm / (arm + mu v2)."""
    for borne in train(INERTIA, share=0.3, rub=0.1).borne(TURN):
        normal, turning = borne.torque_n_mm[:, ~np.isnan(borne.torque_n_mm[0])]
        assert np.allclose(normal[1:][turning[1:] > 0.0], turning[1:][turning[1:] > 0.0] * 50.0 / 51.2, rtol=1e-9)


def test_torques_that_neither_turn_nor_jump_are_borne_as_they_are() -> None:
    one = train(INERTIA)
    steady: Callable[[Array], Array] = lambda phi1: 2e5 + 1e4 * np.sin(phi1)  # noqa: E731
    found = replace(one, pairs=tuple(replace(pair, asked=steady) for pair in one.pairs)).borne(TURN)
    assert [borne.knocks for borne in found] == [(), ()]
    assert found[1].cycle_rad == pytest.approx(TURN)


THREE = """\
name: three
operation: {speed_rpm: 200}
motion: {law: ratio_expression, ratio: 1 + 0.3*cos(phi), scale_to_close: true}
gears: {pairs: 3, teeth: 36, module_mm: 2, face_width_mm: 15, backlash_mm: 0.08, material: 18CrNiMo7-6}
masses: {shaft_kg_mm2: 60000, shaft_between_kg_mm2: [20000, 20000]}
resistance: {polynomial_n_m: [12]}
"""


@pytest.mark.slow
@pytest.mark.judges("dynamics")
def test_three_pairs_press_as_hard_as_in_time() -> None:
    """Knocks of every pair, against the whole nonlinear machine: 1.06, 1.05 and 1.08; without knocks under a half."""
    drive = drive_of_text(THREE)
    peaks = drive.peaks_of(drive.course).of_pairs
    for pair, (pushing, back) in zip(drive.by_stage, peaks, strict=True):
        in_time = max(pushing.value, back.value)
        assert pair.strength_by("estimate").peak_pair_n == pytest.approx(in_time, rel=0.15)
        still = pair.loading_by("estimate").still
        assert still is not None
        assert still.contacts.of_pairs().force_n.max() < 0.7 * in_time
