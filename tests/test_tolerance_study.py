"""What many assemblies tell, in closed form: order statistics, Wilson's range, indices, peaks, enough backlash."""

from __future__ import annotations

from math import pi, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import gamma, qmc

from ncgear.tolerances.assemblies import Assemblies, BetweenAngles, Follower, Waves, between, of_pair
from ncgear.tolerances.estimate import EstimatedBacklash, enough, needed
from ncgear.tolerances.study import (
    INDEXED,
    enough_samples,
    jammed,
    knocking,
    reversals,
    share_of,
    signs_of,
    sobol_indices_of,
    surpassed,
)

pytestmark = pytest.mark.judges("tolerances")

Made: Any = SimpleNamespace


def test_of_how_many_the_least_and_the_second_least_tell() -> None:
    """Wilks 1941: for 95 % with 95 % confidence the least of 59, the second least of 93, the third of 124."""
    for count, place in ((59, 0), (92, 0), (93, 1), (123, 1), (124, 2)):
        values = np.random.default_rng(count).permutation(count).astype(float)
        assert surpassed(values, 0.95) == place
    assert surpassed(np.arange(58.0), 0.95) is None
    assert (enough_samples(0.95), enough_samples(0.99)) == (59, 299)


def test_a_share_has_the_range_of_wilson() -> None:
    count, total, z = 7, 80, 1.959964
    share = count / total
    middle = (share + z**2 / (2.0 * total)) / (1.0 + z**2 / total)
    half = z * sqrt(share * (1.0 - share) / total + z**2 / (4.0 * total**2)) / (1.0 + z**2 / total)
    found = share_of(count, total)
    assert (found.value, found.least, found.largest) == pytest.approx((share, middle - half, middle + half), rel=1e-6)


def test_assemblies_jam_or_knock_where_one_pair_does() -> None:
    first = Made(least_play_rad=np.array([1e-4, -1e-3, 1e-4, -1e-3]), reversal_play_mm=np.array([0.1, 0.2, 0.3, 0.4]))
    other = Made(least_play_rad=np.array([1e-4, 1e-4, -1e-3, -1e-3]), reversal_play_mm=np.array([0.5, 0.1, 0.1, 0.1]))
    assert jammed([first]).value == 0.5
    assert jammed([first, other]).value == 0.75
    assert knocking([first, other], [0.35, 0.45]).value == 0.5


def test_indices_of_a_sum_are_shares_of_its_variance() -> None:
    """Of 3 x + y, x and y even between 0 and 1: 9/10 and 1/10, alone and in all; nothing acts together."""

    count = 256
    points = qmc.Sobol(4, seed=3).random(count).T
    one, other = points[:2], points[2:]

    def of(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 3.0 * x + y

    values = np.concatenate([of(*one), of(*other), of(other[0], one[1]), of(one[0], other[1])])
    shapes = {name: 1e-12 * values if name == "motion_error" else values for name in INDEXED}
    lot = Made(sources=("x", "y"), follower=Made(radius_mm=1.0, slope=1.0))
    found = sobol_indices_of(lot, Made(count=values.size, **shapes))
    assert "motion_error" not in found
    for first, second in (found[name] for name in found):
        assert (first.source, second.source) == ("x", "y")
        assert (first.first, first.total) == (pytest.approx(0.9, abs=0.03), pytest.approx(0.9, abs=0.03))
        assert (second.first, second.total) == (pytest.approx(0.1, abs=0.03), pytest.approx(0.1, abs=0.01))
        # Of x: the squares of 3 (x - x')^2 / 2 over the variance 10/12; E (x - x')^4 = 1/15, E (x - x')^2 = 1/6
        spread = 9.0 / (2.0 * 10.0 / 12.0) * sqrt(1.0 / 15.0 - 1.0 / 36.0)
        assert first.error == pytest.approx(1.96 * spread / sqrt(count), rel=0.1)
    alone = sobol_indices_of(
        Made(sources=("x",), follower=lot.follower),
        Made(
            count=3 * count, **{name: np.concatenate([of(*one), of(*other), of(other[0], one[1])]) for name in INDEXED}
        ),
    )
    assert (alone["least_play_mm"][0].first, alone["least_play_mm"][0].total) == (1.0, 1.0)


def test_places_beside_which_a_torque_turns_round() -> None:
    torque = np.array([0.0, 2.0, 1.0, 1e-12, -1.0, -2.0, 0.0, 3.0])
    assert signs_of(torque).tolist() == [1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0]
    assert reversals(torque, closed=True).tolist() == [3, 4, 6, 7]
    assert reversals(torque, closed=False).tolist() == [0, 3, 4, 6, 7]
    round_the_end = np.array([-1.0, 1.0, 1.0, 1.0])
    assert reversals(round_the_end, closed=True).tolist() == [0, 1, 3]
    assert reversals(round_the_end, closed=False).tolist() == [0, 1, 3]
    assert signs_of(np.zeros(3)).tolist() == [0.0, 0.0, 0.0]


# --- the output's motion -------------------------------------------------------------------------------------------

EVEN = 2.0 * pi * np.arange(512) / 512


def followed(errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Peak accelerations of x = 50 cos(t) + 7 sin(2 t) at t = phi + 0.2 sin(phi) + e, told and by the chain rule.

    The errors a sin(n phi) are given by a and n; the turn takes 2 pi / 3 s.
    """
    size, waves = errors[:, :, None]
    e, rate, change = (
        size * np.sin(waves * EVEN),
        size * waves * np.cos(waves * EVEN),
        -size * waves**2 * np.sin(waves * EVEN),
    )
    t, speed, bend = EVEN + 0.2 * np.sin(EVEN), 1.0 + 0.2 * np.cos(EVEN), -0.2 * np.sin(EVEN)

    def x(order: int, at: np.ndarray) -> np.ndarray:
        turn = order * pi / 2.0
        return 50.0 * np.cos(at + turn) + 7.0 * 2.0**order * np.sin(2.0 * at + turn)

    exact = x(2, t + e) * (speed + rate) ** 2 + x(1, t + e) * (bend + change)
    designed = 9.0 * float(np.abs(x(2, t) * speed**2 + x(1, t) * bend).max())
    one = Follower(
        radius_mm=np.ones(1),
        slope=np.ones(1),
        speed_rad_s=3.0,
        designed_peak=designed + 0.25,
        even=BetweenAngles(*(np.zeros(EVEN.size, dtype=int),) * 2, np.zeros(EVEN.size)),
        slowly=Waves(2.0 * pi, 8),
        driven=np.stack([speed, bend]),
        output=np.stack([x(order, t) for order in (1, 2, 3)]),
    )
    return one.peaks(np.stack([e.T, rate.T, change.T])), 9.0 * np.abs(exact).max(axis=1) + 0.25


def test_peaks_with_small_errors_are_those_of_the_chain_rule() -> None:
    """All terms of first order; what is left goes with the square, and the peak that angles miss is added."""
    errors = np.array([[0.0, 1e-2, -1e-2, 1e-2, 2e-3], [1.0, 1.0, 1.0, 2.0, 5.0]])
    told, exact = followed(errors)
    assert told[0] == pytest.approx(exact[0], rel=1e-12)
    off, tenth = np.abs(told - exact), np.abs(np.subtract(*followed(errors * [[0.1], [1.0]])))
    assert np.all(tenth[1:] < 0.02 * off[1:] + 1e-9)
    assert np.all(off[1:] < 0.05 * np.abs(exact - exact[0])[1:])


def test_slow_waves_are_left_with_their_derivatives_and_fast_ones_are_not() -> None:
    cycle = 4.0 * pi
    angle = cycle * np.arange(96) / 96
    slow, fast = 2.0 * pi / cycle * 5.0, 2.0 * pi / cycle * 6.0
    found = Waves(cycle, 5).of(np.stack([2.0 + np.sin(slow * angle), np.cos(fast * angle)], axis=1))
    assert found[0, :, 0] == pytest.approx(2.0 + np.sin(slow * angle))
    assert found[1, :, 0] == pytest.approx(slow * np.cos(slow * angle))
    assert found[2, :, 0] == pytest.approx(-(slow**2) * np.sin(slow * angle))
    assert np.abs(found[:, :, 1]).max() < 1e-12


def test_places_between_positions_are_straight_lines_round_the_turn() -> None:
    positions = np.array([0.0, 1.0, 3.0, 5.0])
    angles = np.array([0.0, 0.25, 1.5, 4.0, 5.5, 6.0])
    values = np.stack([positions**2, np.cos(positions)], axis=1)
    around = between(angles, positions, 6.5).of(values)
    wanted = [np.interp(angles, [*positions, 6.5], [*column, column[0]]) for column in values.T]
    assert around == pytest.approx(np.stack(wanted, axis=1))
    ended = between(angles[:4], positions, None).of(values)
    assert ended == pytest.approx(np.stack([np.interp(angles[:4], positions, column) for column in values.T], axis=1))
    assert between(np.array([5.0]), positions, None).of(values) == pytest.approx(values[-1:])


def test_a_pair_s_figures_are_those_of_its_leads() -> None:
    """Of made-up leads of both sides: spread and play, along the arm of the back flanks, and where a torque turns."""
    lead = np.random.default_rng(2).normal(size=(2, 6, 3))
    mesh = Made(
        arm_mm=np.stack([np.full(6, 1e9), np.arange(1.0, 7.0)]),
        radius_mm=np.arange(2.0, 8.0),
        least_arcs=lambda of: np.array([1.0, 2.0, 3.0]),
    )
    found = of_pair(Made(mesh=mesh, reversals=np.array([1, 4])), Made(), lead)
    for one in range(3):
        play = [-(lead[0, row, one] + lead[1, row, one]) for row in range(6)]
        play_mm = [(row + 1.0) * value for row, value in enumerate(play)]
        error = [lead[0, row, one] for row in range(6)]
        error_mm = [(row + 2.0) * value for row, value in enumerate(error)]
        assert found.transmission_error_rad[one] == pytest.approx(max(error) - min(error))
        assert found.transmission_error_mm[one] == pytest.approx(max(error_mm) - min(error_mm))
        assert (found.least_play_rad[one], found.least_play_mm[one]) == pytest.approx((min(play), min(play_mm)))
        assert found.largest_play_mm[one] == pytest.approx(max(play_mm))
        assert found.reversal_play_mm[one] == pytest.approx(max(play_mm[1], play_mm[4]))
        assert found.least_arc[one] == one + 1.0
    other = Made(**{name: value + 0.5 for name, value in vars(found).items()})
    both = Assemblies((found, other), *(np.zeros(3) for _ in range(5)))
    assert (both.least_play_mm == found.least_play_mm).all()
    assert (both.largest_play_mm == found.largest_play_mm + 0.5).all()
    assert (both.reversal_play_mm == found.reversal_play_mm + 0.5).all()
    assert (both.least_arc == found.least_arc).all()


# --- the estimate ----------------------------------------------------------------------------------------------------


def test_the_share_that_jams_is_that_of_a_gamma_distribution() -> None:
    """Mean and deviation as told, skewness 1/2, by scipy's own distribution."""
    spread_mm, means = 0.02, np.array([0.05, 0.08])
    law = gamma(16.0, scale=spread_mm / 4.0)
    for given in (0.03, 0.06, 0.1, 0.2):
        wanted = np.mean([law.sf(given - mean + 16.0 * spread_mm / 4.0) for mean in means])
        assert EstimatedBacklash(means, spread_mm).jammed(given) == pytest.approx(wanted, rel=1e-9)
    assert EstimatedBacklash(means, 0.0).jammed(0.06) == 0.5


def test_a_need_is_split_into_what_is_shared_and_what_is_not() -> None:
    """Linear in the shared numbers; what is left over has the deviation of the noise."""
    rng = np.random.default_rng(4)
    shared, noise = rng.uniform(size=(3, 4000)), 0.01 * rng.normal(size=4000)
    line = 0.2 + np.array([0.5, -0.3, 0.0]) @ shared
    found = needed(line + noise, shared)
    assert found.shared == pytest.approx(line, abs=2e-3)
    assert found.deviation == pytest.approx(0.01, rel=0.05)


def test_enough_backlash_is_a_quantile_and_its_own_uncertainty() -> None:
    """Of two pairs that jam independently; n assemblies tell mean and deviation to s sqrt((1 + k^2 / 2) / n)."""
    first, second = EstimatedBacklash(np.full(400, 0.05), 0.02), EstimatedBacklash(np.full(200, 0.0), 0.01)
    law = [gamma(16.0, loc=0.05 - 0.08, scale=0.005), gamma(16.0, loc=-0.04, scale=0.0025)]
    quantile = brentq(lambda given: law[0].cdf(given) * law[1].cdf(given) - 0.99, 0.0, 1.0)
    above = max((quantile - 0.05) / 0.02, quantile / 0.02)
    wanted = quantile + 1.645 * 0.02 * sqrt((1.0 + above**2 / 2.0) / 200.0)
    assert enough([first, second], 0.99) == pytest.approx(wanted, rel=2e-3)
    assert enough([EstimatedBacklash(np.full(9, -1.0), 0.01)], 0.99) == 0.0
    assert enough([EstimatedBacklash(np.array([0.1, 0.2, 0.3, 0.4]), 0.0)], 0.7) == pytest.approx(0.4, abs=0.35)
