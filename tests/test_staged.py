"""A law shared over two pairs, against 30-digit arithmetic and against the pairs put in series again."""

from __future__ import annotations

from math import nan, pi

import numpy as np
import pytest
from mpmath import mp, mpf

from at_once import at_once
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.ratio.laws.harmonic import harmonic_law, staged_law
from ncgear.ratio.laws.over_driven_angle import StagedLaw
from ncgear.ratio.transmission import Lobes

DIGITS = 30

CASES = {
    "even": ((-0.8, 0.2), (0.4, 0.0, 0.1), (-0.4, 0.1), (0.2, 0.0, 0.05)),
    "own": ((0.5, 0.0, 0.05), (0.3,), (-0.2,), (0.1, 0.25, 0.0, 0.03)),
    "none": ((0.5,), (0.3, 0.1), (), ()),
    "wide": ((-1.6, 0.4), (0.6, 0.2), (-0.9, 0.1, 0.05), (0.3,)),
}


def law(name: str) -> StagedLaw:
    return staged_law(*(np.array(values) for values in CASES[name]))


class Exact:
    """ln of a ratio as a series in 30 digits, closed over a turn."""

    def __init__(self, cosine: tuple[float, ...], sine: tuple[float, ...]) -> None:
        self.cosine, self.sine = [*map(mpf, cosine)], [*map(mpf, sine)]
        self.constant = mpf(0)
        self.constant = -mp.log(self.angle(2 * mp.pi) / (2 * mp.pi))

    def log(self, phi2: mpf) -> mpf:
        terms = [a * mp.cos(k * phi2) for k, a in enumerate(self.cosine, 1)]
        return self.constant + mp.fsum(terms + [b * mp.sin(k * phi2) for k, b in enumerate(self.sine, 1)])

    def angle(self, phi2: mpf) -> mpf:
        """Integral of the ratio from 0."""
        parts = 2 + int(phi2 * 4)
        return mp.quad(lambda t: mp.exp(self.log(t)), mp.linspace(0, phi2, parts))


@pytest.mark.tiers(slow=["none"], rest="long")
@pytest.mark.parametrize("name", CASES)
def test_against_thirty_digits(name: str) -> None:
    cosine, sine, second_cosine, second_sine = CASES[name]
    made = law(name)
    with mp.workdps(DIGITS):
        whole, second = Exact(cosine, sine), Exact(second_cosine, second_sine)

        def rate(phi2: mpf) -> mpf:
            return mp.exp(second.log(phi2) - whole.log(phi2))

        def bend(phi2: mpf) -> mpf:
            return mp.exp(-whole.log(phi2)) * mp.diff(rate, phi2)

        for phi2 in (mpf("1e-9"), mpf("0.7"), mpf("2.9"), mpf("5.5")):
            phi1, phim = float(whole.angle(phi2)), second.angle(phi2)
            found = made.shaft_angle(np.array([phi1]), 3)
            third = mp.exp(-whole.log(phi2)) * mp.diff(bend, phi2)
            exact = [phim, rate(phi2), bend(phi2), third]
            largest = max(map(abs, exact))
            assert abs(found.value[0] - phim) <= 2e-15 * (1 + rate(phi2))
            assert abs(found.value[0] - phim) <= 2e-12 * phim
            for k in (1, 2, 3):
                assert abs(found.derivative(k)[0] - exact[k]) <= 3e-14 * largest
            speed = made.shaft_speed(found.value)[0]
            assert abs(speed - exact[1]) <= 3e-14 * largest


@at_once("name", CASES)
def test_the_pairs_in_series_are_the_whole(name: str) -> None:
    train = law(name).train
    first, second = (pair.transmission for pair in train.pairs)
    phi1 = np.linspace(-7.0, 20.0, 400)
    shaft, whole = first.driven_angle(phi1, 1), train.whole.driven_angle(phi1, 1)
    crank = second.driven_angle(shaft.value, 1)
    assert np.max(np.abs(crank.value - whole.value)) <= 1e-13
    slope = crank.derivative(1) * shaft.derivative(1)
    assert np.max(np.abs(slope - whole.derivative(1))) <= 1e-13 * np.max(slope) ** 2
    assert abs(first.closure_error_rad) <= 1e-14
    assert np.max(np.abs(train.pairs[1].speed(shaft.value) - shaft.derivative(1))) <= 1e-13 * np.max(slope) ** 2


def test_a_second_pair_without_harmonics_is_circular() -> None:
    made = law("none")
    phi1 = np.linspace(0.0, 2.0 * pi, 99)[:-1]
    whole = harmonic_law(np.array([0.5]), np.array([0.3, 0.1]), Lobes())
    exact = whole.driven_angle(phi1, 3).coefficients
    assert np.max(np.abs(made.first.driven_angle(phi1, 3).coefficients - exact)) <= 1e-14
    assert np.max(np.abs(made.second.driven_angle(phi1, 0).value - phi1)) <= 1e-15


def test_a_finer_second_series_is_looked_at_as_finely() -> None:
    sine = np.zeros(60)
    sine[59] = 0.3
    made = staged_law(np.array([0.1]), np.zeros(1), np.zeros(1), sine)
    phi1 = np.linspace(0.0, 2.0 * pi, 20001)
    slope = made.shaft_angle(phi1, 1).derivative(1)
    low, high = made.first.slope_range
    assert low.value == pytest.approx(slope.min(), rel=1e-5)
    assert high.value == pytest.approx(slope.max(), rel=1e-5)


def test_refusals_name_the_second_stage() -> None:
    one = np.array([0.1])
    with pytest.raises(WrongInput) as wrong:
        staged_law(one, one, np.array([nan]), one)
    assert wrong.value.key == "motion.second_stage.cosine.0"
    with pytest.raises(NoSuchMechanism) as none:
        staged_law(one, one, one, np.array([0.0, 9.0]))
    assert none.value.key == "motion.second_stage.sine.1"
