"""The torque of the teeth where the load changes flanks, against closed forms and another solver."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drives import DESIGNS, drive_of_text
from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.driven_side import CHECKED, KEPT, PER_SWING, SETTLED, FollowedStretch, Knock, Ways
from ncgear.dynamics.flank_changes import BorneTorque, borne_torque, joined
from ncgear.dynamics.gaps import Gaps
from ncgear.dynamics.meshing import HARDEST, Friction, Impact, Meshing, moments_n_mm, near_pairs
from ncgear.figures.advice.strength_advice import unfollowed_motion
from ncgear.numerics.arrays import Array
from ncgear.numerics.periodic_table import PeriodicTable
from ncgear.project.strengthening import rating_of

TURN = 2.0 * pi
INERTIA, LEVER_MM, STIFFNESS, PLAY_RAD, SPEED = 40.0, 50.0, 4e4, 4e-4, 6.0
"""A driven side in N mm s^2 on one pair of teeth for each side, with play, at a speed in rad/s."""

TURNING = STIFFNESS * LEVER_MM**2
"""Its stiffness in N mm/rad."""


def even(*values: float) -> PeriodicTable:
    """Functions that do not change."""
    return PeriodicTable(np.array([0.0, TURN]), np.array([values])[None, :, :])


def teeth(play_rad: float = PLAY_RAD, damping: float = 0.0) -> Meshing:
    """One pair of teeth on each side, all alike, of gears that turn alike."""
    law = PeriodicTable(np.array([0.0, TURN]), np.array([[1.0], [0.0]]), TURN)
    sides = np.array([[0.0, LEVER_MM, 0.0, 0.0, STIFFNESS], [play_rad, LEVER_MM, 0.0, 0.0, STIFFNESS]])
    table = PeriodicTable(np.array([0.0, TURN]), sides[None, None])
    gaps = Gaps(
        table, np.array([[1.0, -1.0]]), np.zeros((1, 2, 2), dtype=int), np.array([np.inf]), np.zeros(2, dtype=int)
    )
    return Meshing(law, gaps, Impact(1.0, damping, 1e-6), Friction(0.0, 0.0, 1.0, 2.0))


def load(inertia: float = INERTIA) -> CrankLoad:
    """A driven side of even inertia, against which nothing acts but what is asked."""
    return CrankLoad(even(inertia, 0.0), (0.0, pi))


def saw(phi1_rad: np.ndarray, slope: float = 1e5) -> np.ndarray:
    """A torque that falls in a line through 0 at a turn's half, and rises again through 0 at its end."""
    return slope * np.interp(phi1_rad % TURN, [0.0, pi / 2.0, 1.5 * pi, TURN], [0.0, pi / 2.0, -pi / 2.0, 0.0])


def highest(found: BorneTorque, low: float, high: float, sign: float) -> float:
    """The largest torque of a sign between two angles."""
    return float((sign * found.at(np.linspace(low, high, 20001))).max())


def sides_of(pairs: np.ndarray, later: float) -> list[list[list[float]]]:
    """Rows of pairs by the sign of their arm, those first that touch first."""
    own = [[row for row in pairs.tolist() if row[0] * sign > 0.0] for sign in (1.0, -1.0)]
    return [sorted(rows, key=lambda row: -row[0] * (row[1] + later * row[3])) for rows in own]


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_pairs_press_by_the_law_of_impact(exponent: float) -> None:
    """F = k d^e + step(d, 0, 0, d_full, c) d', never below 0, by its arms: of plain numbers and of arrays."""
    rng, impact = np.random.default_rng(5), Impact(exponent, 40.0, 0.002)
    pairs = rng.uniform([49.0, -1e-4, 1e5, -0.1, 48.0], [50.0, 1e-4, 1e6, 0.1, 51.0], (40, 5))
    pairs[:, [0, 4]] *= rng.choice([-1.0, 1.0], (40, 1))
    for ahead, speed, later in ((2e-5, 0.03, 1e-4), (0.0, 0.0, 0.0), (-5e-5, -0.7, 1e-5)):
        normal, turning = 0.0, 0.0
        for arm, error, stiffness, rate, rubbed in pairs:
            depth, closing = arm * (error + later * rate - ahead), arm * (rate - speed)
            if depth > 0.0:
                part = min(depth / 0.002, 1.0)
                damping = 40.0 * (3.0 * part**2 - 2.0 * part**3)
                force = max(stiffness * depth**exponent + damping * closing, 0.0)
                normal, turning = normal + arm * force, turning + rubbed * force
        for form in (sides_of(pairs, later), pairs.T):
            assert moments_n_mm(impact, form, ahead, speed, later) == pytest.approx((normal, turning), rel=1e-12)


def test_friction_takes_from_the_moment_or_adds_to_it() -> None:
    """Of settled teeth N arm = T arm / (arm + mu v2), with v2 the driven point's speed along the tangent."""
    mu, along = 0.1, 12.0
    for driving, sign in ((20.0, 1.0), (4.0, -1.0)):
        sides = [[error, LEVER_MM, driving, along, STIFFNESS] for error in (0.0, PLAY_RAD, -1.0)]
        table = PeriodicTable(np.array([0.0, TURN]), np.array(sides)[None, None])
        # Where pairs come and go, as the last pair would if it were not so far behind, the whole cycle is followed.
        gaps = Gaps(
            table, np.array([[1.0, -1.0, 1.0]]), np.zeros((1, 3, 2), dtype=int), np.array([np.inf]), np.zeros(3, int)
        )
        mesh = replace(teeth(damping=DAMPED), gaps=gaps, friction=Friction(mu, mu, 1e-3, 2e-3))

        def asked(phi1_rad: np.ndarray) -> np.ndarray:
            return np.where(phi1_rad % TURN < pi, 1e5, 3e5)

        found = borne_torque(mesh, load(), asked, SPEED, TURN, plays=())
        pushed = 3e5 * LEVER_MM / (LEVER_MM + sign * mu * along)
        settled = found.phi1_rad[0] // TURN * TURN + TURN - 0.01
        last = found.torque_n_mm[:, np.searchsorted(found.phi1_rad, settled)]
        assert last == pytest.approx([pushed, 3e5], rel=2e-3)
        told = [float(one(np.array([settled]))[0]) for one in (found.at, found.turning)]
        assert told == pytest.approx([max(pushed, 3e5), 3e5], rel=2e-3)


DAMPING = 0.05
"""Share of critical damping: swings have died away before the next turn of the torque."""

DAMPED = 2.0 * DAMPING * sqrt(TURNING * INERTIA) / LEVER_MM**2
"""The same in N s/mm of a pair."""


def swinging(load_n_mm: tuple[float, float], at: tuple[float, float], time_s: np.ndarray) -> np.ndarray:
    """Torque k y + c y. of J y.. + c y. + k y = a + b t in closed form, from a place and a speed on."""
    (a, b), (place, speed) = load_n_mm, at
    swing, c = sqrt(TURNING / INERTIA), 2.0 * DAMPING * sqrt(TURNING * INERTIA)
    fade, damped = DAMPING * swing, swing * sqrt(1.0 - DAMPING**2)
    still = a / TURNING - b * c / TURNING**2
    first = place - still
    second = (speed - b / TURNING + fade * first) / damped
    wave, other = np.cos(damped * time_s), np.sin(damped * time_s)
    falling = np.exp(-fade * time_s)
    y = still + b / TURNING * time_s + falling * (first * wave + second * other)
    rate = b / TURNING + falling * ((second * damped - fade * first) * wave - (first * damped + fade * second) * other)
    return np.asarray(TURNING * y + c * rate)


def test_flanks_that_part_meet_again_and_swing_as_in_closed_form() -> None:
    """J x.. = s t from rest to the play, then J y.. + c y. + k y = s t from there on, at the speed of the knock."""
    found = borne_torque(teeth(damping=DAMPED), load(), saw, SPEED, TURN)
    slope = 1e5 * SPEED
    time_s = (6.0 * INERTIA * PLAY_RAD / slope) ** (1.0 / 3.0)
    speed = slope * time_s**2 / (2.0 * INERTIA)
    first = min((knock for knock in found.knocks if knock.phi1_rad > pi), key=lambda one: one.phi1_rad)
    assert first.phi1_rad == pytest.approx(pi + SPEED * time_s, abs=1.5e-3)
    assert first.speed_mm_s == pytest.approx(speed * LEVER_MM, rel=0.03)
    after = np.linspace(0.0, pi * sqrt(INERTIA / TURNING), 2001)
    peak = float(swinging((slope * time_s, slope), (0.0, speed), after).max())
    end = pi + SPEED * (time_s + float(after[-1]))
    assert highest(found, pi, end, -1.0) == pytest.approx(peak, rel=0.02)
    assert peak > 3.0 * float(-saw(np.array([end]))[0])
    # They are followed until nothing swings: over the last swings the teeth bear what is asked.
    last = slice(-CHECKED * PER_SWING, None)
    left = np.abs(found.torque_n_mm[0, last] - saw(found.phi1_rad[last]))
    assert left.max() < 1.01 * SETTLED * saw(np.linspace(0.0, TURN, 1001)).max()


def test_between_stretches_that_are_followed_the_teeth_bear_what_is_asked() -> None:
    """Of two stretches, each by its own places; the knocks of the last cycle are told, within one."""
    first = FollowedStretch(np.array([1.0, 1.5, 2.0]), np.tile([5.0, 6.0, 7.0], (2, 1)), [Knock(1.2, 3.0)])
    second = FollowedStretch(np.array([2.2, 3.0]), np.tile([1.0, 2.0], (2, 1)), [Knock(2.5, 4.0)])
    found = joined([first, second], lambda phi1: np.full(phi1.shape, 0.1), TURN)
    assert found.at(np.array([1.25, 2.05, 2.15, 2.6, 3.5])) == pytest.approx([5.5, 0.1, 0.1, 1.5, 0.1])
    assert np.all(np.diff(found.phi1_rad) > 0.0)
    twice = joined([first, second], found.asked, 1.7)
    assert [[(knock.phi1_rad, knock.speed_mm_s) for knock in one.knocks or ()] for one in (found, twice)] == [
        [(1.2, 3.0), (2.5, 4.0)],
        [(pytest.approx(0.8), 4.0)],
    ]


def test_a_knock_between_two_angles_counts_at_the_nearer_one_in_every_turn() -> None:
    """A tip of 9 within 0.01 rad about 1.18 rad, and one of -4 about 1.14; the torque asked for is 1 all the time."""
    stretch = FollowedStretch(
        np.array([1.13, 1.14, 1.15, 1.17, 1.18, 1.19]), np.tile([1, -4, 1, 1, 9, 1.0], (2, 1)), []
    )
    found, angles = joined([stretch], np.ones_like, TURN), np.linspace(0.0, 2.0 * TURN, 40, endpoint=False)
    for urge, torque, at in ((1.0, 9.0, 1.18), (-1.0, -4.0, 1.14)):
        hardest = found.hardest(urge, angles)
        rows = [int(np.abs(angles - place).argmin()) for place in (at, at + TURN)]
        assert hardest[rows].tolist() == [torque, torque]
        assert np.delete(hardest, rows) == pytest.approx(max(urge, 0.0))
        assert np.abs(found.at(angles)).max() == 1.0
    assert [one.tolist() for one in found.peaks(1.5)] == [pytest.approx([1.14, 1.18]), [-4.0, 9.0]]


def test_where_nothing_knocks_the_torque_asked_for_is_the_hardest() -> None:
    """Laws give no angle for no place."""

    def asked(phi1_rad: Array) -> Array:
        assert phi1_rad.size
        return np.ones_like(phi1_rad)

    still, angles = BorneTorque(asked, TURN, knocks=()), np.linspace(0.0, TURN, 7)
    assert [still.hardest(urge, angles).tolist() for urge in (1.0, -1.0)] == [[1.0] * 7, [0.0] * 7]
    assert not still.peaks(TURN)[0].size


def test_pairs_count_that_the_hardest_load_presses() -> None:
    """Each against the first one on its own side: a second pushing pair that is too far behind is left out."""
    play, behind = 6e-4, 1e-3
    ends = [[0.0, LEVER_MM, 0.0, 0.0, STIFFNESS], [-behind, LEVER_MM, 0.0, 0.0, STIFFNESS]]
    table = PeriodicTable(np.array([0.0, TURN]), np.array([*ends, [play, LEVER_MM, 0.0, 0.0, STIFFNESS]])[None, None])
    gaps = Gaps(
        table, np.array([[1.0, 1.0, -1.0]]), np.zeros((1, 3, 2), dtype=int), np.array([np.inf]), np.zeros(3, dtype=int)
    )
    mesh = Meshing(teeth().law, gaps, Impact(1.0, 0.0, 1e-6), Friction(0.0, 0.0, 1.0, 2.0))
    for reach, errors in ((5e-4, [0.0, play]), (1.1e-3, [0.0, -behind, play])):
        (pairs,), levers = near_pairs(mesh, np.array([1.0]), SPEED, reach * TURNING / HARDEST)
        pairs = [one for side in pairs for one in side]
        assert [one[1] for one in pairs] == pytest.approx(errors)
        assert [one[0] for one in pairs] == pytest.approx([LEVER_MM] * (len(errors) - 1) + [-LEVER_MM])
        assert levers.tolist() == [LEVER_MM]


def test_teeth_without_play_bear_what_is_asked() -> None:
    found, angles = borne_torque(teeth(0.0, DAMPED), load(), saw, SPEED, TURN), np.linspace(0.0, TURN, 5001)
    assert np.abs(found.at(angles) - saw(angles)).max() < 0.05 * saw(angles).max()


def test_a_torque_that_neither_turns_nor_jumps_is_borne_as_it_is() -> None:
    angles = np.linspace(0.0, TURN, 5001)
    for speed_rad_s in (SPEED, SPEED / 100.0):
        found = borne_torque(teeth(), load(), lambda phi1: 2e5 + 1e5 * np.sin(phi1), speed_rad_s, TURN)
        assert found.at(angles) == pytest.approx(found.asked(angles), rel=0.01)
        assert found.knocks == ()
        assert found.slow_swings == 0.0


def test_a_driven_side_that_swings_slowly_is_told_with_its_swings() -> None:
    """20 swings a turn on two pairs, as k r^2 and the inertia have them; a hundredth of the speed leaves 2000."""
    heavy = 2.0 * TURNING / (20.0 * SPEED) ** 2

    def even_torque(phi1: np.ndarray) -> np.ndarray:
        return np.full(phi1.shape, 2e5)

    assert borne_torque(teeth(), load(heavy), even_torque, SPEED, TURN).slow_swings == pytest.approx(20.0, rel=1e-6)
    assert borne_torque(teeth(), load(heavy), saw, SPEED, TURN).slow_swings == 0.0  # knocks are followed
    assert borne_torque(teeth(), load(heavy), even_torque, SPEED / 100.0, TURN).slow_swings == 0.0


@pytest.mark.slow
def test_a_pair_that_comes_and_goes_swings_the_driven_side_as_by_another_solver() -> None:
    """Radau follows J x.. = M - T with a second pair whose gap closes within a swing, and opens as fast."""
    comes, goes, fast, far = 2.0, 4.0, 0.02, 6e-3
    torque, breaks = 2e5, np.array([0.0, comes, comes + fast, goes, goes + fast, TURN])
    behind, slopes = np.array([-far, -far, 0.0, 0.0, -far]), np.array([0.0, far / fast, 0.0, -far / fast, 0.0])
    pair = np.broadcast_to([0.0, LEVER_MM, 0.0, 0.0, STIFFNESS], (2, 5, 2, 5)).copy()
    pair[0] = 0.0
    pair[0, :, 1, 0], pair[1, :, 1, 0] = slopes, behind
    gaps = Gaps(
        PeriodicTable(breaks, pair),
        np.ones((5, 2)),
        np.zeros((5, 2, 2), dtype=int),
        np.full(5, np.inf),
        np.zeros(2, dtype=int),
    )
    mesh = Meshing(teeth().law, gaps, Impact(1.0, DAMPED, 1e-6), Friction(0.0, 0.0, 1.0, 2.0))
    found = borne_torque(mesh, load(), lambda phi1: np.full(phi1.shape, torque), SPEED, TURN)

    def moment(time_s: float, x: float, v: float) -> float:
        row = min(int(np.searchsorted(breaks, SPEED * time_s, side="right")) - 1, 4)
        rate = slopes[row] * SPEED
        gap = behind[row] + slopes[row] * (SPEED * time_s - breaks[row])
        total = 0.0
        for error, closing in ((0.0, -v), (gap, rate - v)):
            depth = LEVER_MM * (error - x)
            if depth > 0.0:
                ramp = min(depth / 1e-6, 1.0)
                force = STIFFNESS * depth + DAMPED * ramp**2 * (3.0 - 2.0 * ramp) * LEVER_MM * closing
                total += LEVER_MM * max(force, 0.0)
        return total

    def change(time_s: float, state: np.ndarray) -> list[float]:
        return [state[1], (moment(time_s, *state) - torque) / INERTIA]

    solved = solve_ivp(
        change, (0.0, TURN / SPEED), [-torque / TURNING, 0.0], method="Radau", rtol=1e-5, atol=1e-9, max_step=2e-3
    )
    borne = np.array([moment(*one) for one in zip(solved.t, *solved.y, strict=True)])
    for low, high in ((comes, 3.0), (goes, 5.0)):
        inside = (SPEED * solved.t > low) & (SPEED * solved.t < high)
        most = float(borne[inside].max())
        assert most > 1.2 * torque
        assert highest(found, low, high, 1.0) == pytest.approx(most, rel=0.03)


@pytest.mark.slow
def test_a_driven_side_that_swings_more_slowly_than_teeth_pass_follows_them() -> None:
    """17 swings a turn on 60 teeth, of which two bear for half of each pitch, as by DOP853 from pitch to pitch."""
    count, heavy, low, high = 60, 2.0 * TURNING / (17.0 * SPEED) ** 2, 1e5, 3e5
    breaks = np.linspace(0.0, TURN, 2 * count + 1)
    pair = np.zeros((5, 2 * count, 2, 5))[:1].repeat(2, axis=0)
    pair[1] = [0.0, LEVER_MM, 0.0, 0.0, STIFFNESS]
    pair[1, ::2, 1, 0] = -6e-2
    numbers = np.zeros((2 * count, 2, 2), dtype=int) + (np.arange(2 * count) // 2 + 1)[:, None, None]
    gaps = Gaps(
        PeriodicTable(breaks, pair),
        np.ones((2 * count, 2)),
        numbers,
        np.full(2 * count, np.inf),
        np.zeros(2, dtype=int),
    )
    damped = 20.0 * DAMPED
    mesh = Meshing(teeth().law, gaps, Impact(1.0, damped, 1e-6), Friction(0.0, 0.0, 1.0, 2.0))

    def asked(phi1_rad: np.ndarray) -> np.ndarray:
        return np.where(phi1_rad % TURN < pi, low, high)

    found = borne_torque(mesh, load(heavy), asked, SPEED, TURN)
    assert found.knocks

    def moment(pairs: int, x: float, v: float) -> float:
        return pairs * LEVER_MM * max(-LEVER_MM * (STIFFNESS * x + damped * v), 0.0) if x < 0.0 else 0.0

    state, most = (-high / TURNING, 0.0), 0.0
    for half in range(4 * count):
        pairs, torque = 1 + half % 2, low if half % (2 * count) < count else high
        solved = solve_ivp(
            lambda time_s, has, pairs=pairs, torque=torque: [has[1], (moment(pairs, *has) - torque) / heavy],
            (0.0, TURN / SPEED / (2 * count)),
            state,
            method="DOP853",
            rtol=1e-8,
            atol=1e-12,
            max_step=1e-3,
        )
        state = tuple(solved.y[:, -1])
        if half >= 2 * count:
            most = max(most, *(moment(pairs, *has) for has in solved.y.T))
    assert most > 1.2 * high
    assert highest(found, 0.0, TURN, 1.0) == pytest.approx(most, rel=0.01)


@pytest.mark.parametrize("speed_rad_s", [SPEED, SPEED / 100.0])
def test_a_jump_is_overshot_as_in_closed_form(speed_rad_s: float) -> None:
    """However slowly the machine turns."""

    def asked(phi1_rad: np.ndarray) -> np.ndarray:
        return np.where(phi1_rad % TURN < pi, 1e5, 3e5)

    found = borne_torque(teeth(damping=DAMPED), load(), asked, speed_rad_s, TURN)
    expected = swinging((3e5, 0.0), (1e5 / TURNING, 0.0), np.linspace(0.0, 0.01, 4001))
    assert highest(found, pi, pi + 0.01 * speed_rad_s, 1.0) == pytest.approx(float(expected.max()), rel=0.01)
    assert expected.max() > 4.6e5
    # Where the torque falls as far, the teeth swing back beyond no torque: they part, and knock.
    assert found.knocks
    assert all(knock.phi1_rad < 0.1 for knock in found.knocks)


@pytest.mark.slow
def test_knocks_of_an_uneven_driven_side_are_those_of_another_solver() -> None:
    """DOP853 follows M q.. + M' q.^2 / 2 + U' = moment with all of its terms, M and U changing with the angle."""

    def inertia(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return INERTIA * (1.0 + 0.6 * np.cos(2.0 * q)), -1.2 * INERTIA * np.sin(2.0 * q)

    def work_slope(q: np.ndarray) -> np.ndarray:
        return 4e4 * np.sin(q) + 1.5e4 * np.cos(3.0 * q)

    def asked(phi1_rad: np.ndarray) -> np.ndarray:
        return 0.5 * inertia(phi1_rad)[1] * SPEED**2 + work_slope(phi1_rad)

    knots = np.linspace(0.0, TURN, 721)
    values = np.column_stack([inertia(knots)[0], 0.0 * knots])
    lines = np.stack([np.diff(values, axis=0) / np.diff(knots)[:, None], values[:-1]])
    wide_rad, load = 10.0 * PLAY_RAD, CrankLoad(PeriodicTable(knots, lines), (0.0, pi))
    found = borne_torque(teeth(wide_rad, DAMPED), load, asked, SPEED, TURN, plays=())
    begin = float(found.phi1_rad[0])
    torque = float(asked(np.array([begin]))[0])
    ahead = -torque / TURNING if torque > 0.0 else wide_rad - torque / TURNING

    def moment(x: float, v: float) -> float:
        total = 0.0
        for urge, error in ((1.0, 0.0), (-1.0, wide_rad)):
            depth = urge * LEVER_MM * (error - x)
            if depth > 0.0:
                ramp = min(depth / 1e-6, 1.0)
                force = STIFFNESS * depth - DAMPED * ramp**2 * (3.0 - 2.0 * ramp) * urge * LEVER_MM * v
                total += urge * LEVER_MM * max(force, 0.0)
        return total

    def change(time_s: float, state: np.ndarray) -> list[float]:
        q, speed = state
        mass, slope = (float(one) for one in inertia(np.array(q)))
        held = moment(q - begin - SPEED * time_s, speed - SPEED)
        return [speed, (held - 0.5 * slope * speed**2 - float(work_slope(np.array(q)))) / mass]

    over_s, start = 0.8 * TURN / SPEED, [begin + ahead, SPEED]
    solved = solve_ivp(change, (0.0, over_s), start, method="DOP853", rtol=1e-10, atol=1e-13, max_step=2e-4)
    states = zip(solved.y[0] - begin - SPEED * solved.t, solved.y[1] - SPEED, strict=True)
    borne = np.array([moment(*state) for state in states])
    end = begin + SPEED * over_s
    for sign in (1.0, -1.0):
        most = max(float((sign * borne).max()), float((sign * asked(np.linspace(begin, end, 4001))).max()))
        assert highest(found, begin, end, sign) == pytest.approx(most, rel=0.03)
    places = begin + SPEED * solved.t
    knocks = np.abs(borne) > np.abs(asked(places)) + 3e4
    assert knocks.any()
    assert np.abs(found.at(places[knocks])).max() == pytest.approx(float(np.abs(borne[knocks]).max()), rel=0.03)


def test_so_many_swings_that_knocks_are_not_followed_are_told() -> None:
    """The knocking baler at 0.05 r/min for 60: its driven side swings 1200 times as often in a cycle."""
    text = (DESIGNS / "baler-holds.yaml").read_text(encoding="utf-8").replace("speed_rpm: 60", "speed_rpm: 0.05")
    slow = drive_of_text(text)
    borne = slow.loading_by("estimate").borne
    assert borne is not None
    assert borne.knocks is None
    assert borne.fast_swings == pytest.approx(1200.0 * 213.1, rel=0.01)
    assert "too often for knocks to be followed" in unfollowed_motion(rating_of(slow))


def test_ways_that_are_no_longer_asked_for_are_forgotten() -> None:
    ways = Ways(lambda begin, end: (begin, end), 1.0, 0.5)  # type: ignore[arg-type, return-value]
    assert [ways.at(number) for number in (0, 3, 0)] == [(1.0, 1.5), (2.5, 3.0), (1.0, 1.5)]
    for number in range(3 * KEPT):
        ways.at(number)
    assert len(ways.known) == KEPT
    assert min(ways.known) == 2 * KEPT
