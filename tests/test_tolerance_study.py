"""What many assemblies tell, in closed form: order statistics, Wilson's range, indices of a sum, turns of a torque."""

from __future__ import annotations

from math import sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

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
    from scipy.stats import qmc

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
