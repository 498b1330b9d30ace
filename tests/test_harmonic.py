"""Laws by harmonics of ln i12, against 50-digit arithmetic, Bessel functions and their own symmetries."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf, log, nan, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf
from scipy.special import iv

from at_once import at_once
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.ratio.laws.harmonic import closed_harmonics, harmonic_law
from ncgear.ratio.laws.over_driven_angle import LogRatioLaw
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission

DIGITS = 50


def law(cosine: list[float], sine: list[float], lobes: Lobes | None = None) -> Transmission:
    """The law of coefficients, of one lobe each unless said otherwise."""
    return harmonic_law(np.array(cosine), np.array(sine), lobes or Lobes())


def log_constant(made: LogRatioLaw) -> float:
    """c0 of ln i12, which closes the cycle."""
    return log(made.lobes.driven / made.lobes.driving) - log(made.integral.mean)


@dataclass(frozen=True)
class Exact:
    """The same law in 50 digits: quadrature of exp(series), and roots of it."""

    cosine: tuple[float, ...]
    sine: tuple[float, ...]
    lobes: Lobes

    def series(self, phi2: mpf) -> mpf:
        terms = [mpf(a) * mp.cos(k * self.lobes.driven * phi2) for k, a in enumerate(self.cosine, start=1)]
        return mp.fsum(terms + [mpf(b) * mp.sin(k * self.lobes.driven * phi2) for k, b in enumerate(self.sine, 1)])

    @cache  # noqa: B019 - the few objects of this file live as long as it does
    def constant(self) -> mpf:
        period = 2 * mp.pi / self.lobes.driven
        return 2 * mp.pi / self.lobes.driving / self.quadrature(mpf(0), period)

    def quadrature(self, start: mpf, end: mpf) -> mpf:
        """Gauss-Legendre on parts short enough for 50 digits."""
        parts = 1 + int(mp.ceil(abs(end - start) * 6))
        return mp.quad(lambda phi2: mp.exp(self.series(phi2)), mp.linspace(start, end, parts + 1))

    def driving_angle(self, phi2: mpf) -> mpf:
        return self.constant() * self.quadrature(mpf(0), phi2)

    def driven_angle(self, phi1: mpf, guess: float) -> mpf:
        """Newton's method: each step doubles the digits, and needs the quadrature of a short stretch only."""
        phi2 = mpf(guess)
        missing = self.driving_angle(phi2) - phi1
        for _ in range(4):
            step = -missing * self.slope(phi2)
            missing += self.constant() * self.quadrature(phi2, phi2 + step)
            phi2 += step
        assert abs(missing) < mpf(10) ** (8 - DIGITS)
        return phi2

    def slope(self, phi2: mpf) -> mpf:
        return mp.exp(-self.series(phi2)) / self.constant()

    def derivatives(self, phi2: mpf) -> list[mpf]:
        """By phi1, one to three: from w(phi2) and its own derivatives."""
        w, w1, w2 = (mp.diff(self.slope, phi2, k) for k in range(3))
        return [w, w * w1, w * (w1 * w1 + w * w2)]


CASES = {
    "one": ((0.5,), (), Lobes()),
    "four": ((-0.4, 0.2, 0.0, 0.05), (0.3, -0.1), Lobes()),
    "lobes 2:3": ((0.1, 0.02), (0.05, 0.0, 0.1), Lobes(2, 3)),
    "range of 1:50": ((-1.7, 0.4), (0.6, 0.2, -0.1), Lobes()),
}


@pytest.mark.tiers(slow=["lobes 2:3"], rest="long")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == "lobes 2:3" else pytest.mark.slow) for name in CASES]
)
def test_against_fifty_digits(name: str) -> None:
    cosine, sine, lobes = CASES[name]
    exact, transmission = Exact(cosine, sine, lobes), law(list(cosine), list(sine), lobes)
    period = lobes.driving_period_rad
    phi1 = np.array([1e-9, 1e-4, 0.11, 0.37, 0.5, 0.83, 0.97, 1.0 - 1e-6]) * period
    series = transmission.driven_angle(phi1, 3)
    with mp.workdps(DIGITS):
        for i, angle in enumerate(phi1.tolist()):
            phi2 = exact.driven_angle(mpf(angle), float(series.value[i]))
            derivatives = exact.derivatives(phi2)
            # Rounding of the driving angle, 4e-16, and of the result, each on the slope's scale
            assert abs(series.value[i] - phi2) <= 2e-15 * (1 + derivatives[0])
            assert abs(series.value[i] - phi2) <= 1e-14 * phi2
            bound = 1e-14 * (1 + derivatives[0]) * max(abs(derivative) for derivative in derivatives)
            for k, derivative in enumerate(derivatives, start=1):
                assert abs(series.derivative(k)[i] - derivative) <= bound


@pytest.mark.slow
def test_the_oracle_sees_a_wrong_coefficient() -> None:
    """Negative control: a thousand-millionth more of one harmonic."""
    exact, transmission = Exact((0.5,), (), Lobes()), law([0.5 + 1e-9], [])
    found = float(transmission.driven_angle(np.array([2.0])).value[0])
    with mp.workdps(DIGITS):
        assert abs(found - exact.driven_angle(mpf(2), found)) > 1e-10


@at_once("lobes", [Lobes(), Lobes(2, 1), Lobes(1, 3), Lobes(3, 2)])
def test_no_harmonics_are_the_uniform_law(lobes: Lobes) -> None:
    phi1 = np.linspace(0.0, lobes.driving_period_rad, 57)[:-1]
    for coefficients in ([], [0.0, 0.0, 0.0]):
        found = law(coefficients, [], lobes).driven_angle(phi1, 3)
        exact = uniform_law(lobes).driven_angle(phi1, 3)
        assert np.max(np.abs(found.coefficients - exact.coefficients)) <= 2e-15


@at_once("size", [1e-9, 0.1, 1.0, 3.0, 6.0])
def test_the_mean_of_one_harmonic_is_a_bessel_function(size: float) -> None:
    """mean(exp(a cos t)) = I0(a), so i12 = exp(a cos t)/I0(a); phi1(t) = t + 2 sum I_k(a)/I0(a) sin(kt)/k."""
    transmission = law([size], [])
    low, high = transmission.ratio_range
    assert (low.value, high.value) == pytest.approx(
        (np.exp(-size) / iv(0, size), np.exp(size) / iv(0, size)), rel=1e-14
    )
    phi2 = np.linspace(0.0, 2.0 * pi, 41)[1:-1]
    orders = np.arange(1, 60)[:, None]
    phi1 = phi2 + 2.0 * np.sum(iv(orders, size) / iv(0, size) * np.sin(orders * phi2) / orders, axis=0)
    # The driving angle is known to some rounding errors of itself; the driven angle amplifies them by the slope
    assert np.all(np.abs(transmission.driven_angle(phi1).value - phi2) <= 2e-14 / low.value)


def test_the_constant_is_the_one_of_the_formula() -> None:
    made = closed_harmonics(np.array([0.7]), np.zeros(1), Lobes(2, 3))
    assert log_constant(made) == pytest.approx(log(1.5) - log(iv(0, 0.7)), abs=1e-15)
    at = made.driven_angle(np.array([1.0]), 1)
    log_ratio = log_constant(made) + made.series.at(3.0 * at.value, 0).value[0]
    assert -np.log(at.derivative(1)[0]) == pytest.approx(log_ratio, abs=1e-14)


def test_opposite_sines_mirror_the_law() -> None:
    cosine, sine = [-0.4, 0.2, 0.1], [0.3, -0.1]
    phi1 = np.linspace(0.01, 6.27, 60)
    there, back = law(cosine, sine), law(cosine, [-value for value in sine])
    forward, backward = there.driven_angle(phi1, 3), back.driven_angle(2.0 * pi - phi1, 3)
    assert np.max(np.abs(forward.value + backward.value - 2.0 * pi)) <= 1e-14
    for k in (1, 2, 3):
        assert np.max(np.abs(forward.derivative(k) + (-1.0) ** k * backward.derivative(k))) <= 1e-13


def shifted(cosine: Array, sine: Array, by_rad: float) -> tuple[Array, Array]:
    """Coefficients of the same series of t + by_rad."""
    turn = np.exp(1j * np.arange(1, cosine.size + 1) * by_rad) * (cosine - 1j * sine)
    return turn.real, -turn.imag


def test_a_shifted_series_is_the_same_law_from_another_start() -> None:
    cosine, sine = np.array([-0.4, 0.2, 0.1]), np.array([0.3, -0.1, 0.0])
    original = harmonic_law(cosine, sine, Lobes())
    start_rad = 1.3
    start_driven = float(original.driven_angle(np.array([start_rad])).value[0])
    moved = harmonic_law(*shifted(cosine, sine, start_driven), Lobes())
    phi1 = np.linspace(0.0, 6.2, 50)
    found, exact = moved.driven_angle(phi1, 3), original.driven_angle(phi1 + start_rad, 3)
    assert np.max(np.abs(found.value + start_driven - exact.value)) <= 1e-14
    assert np.max(np.abs(found.coefficients[1:] - exact.coefficients[1:])) <= 3e-14


@pytest.mark.parametrize("lobes", [Lobes(2, 1), Lobes(1, 2), Lobes(3, 2)])
def test_lobes_repeat_the_law_of_one(lobes: Lobes) -> None:
    cosine, sine = [0.05, 0.02], [-0.03]
    once, often = law(cosine, sine), law(cosine, sine, lobes)
    phi1 = np.linspace(0.0, 2.0 * pi, 50)[:-1]
    found, exact = often.driven_angle(phi1 / lobes.driving, 2), once.driven_angle(phi1, 2)
    assert np.max(np.abs(found.value * lobes.driven - exact.value)) <= 3e-15
    scale = lobes.driving / lobes.driven
    assert np.max(np.abs(found.derivative(1) - scale * exact.derivative(1))) <= 1e-14


def test_lists_of_different_length_are_filled_with_zeros() -> None:
    phi1 = np.linspace(0.0, 6.0, 20)
    short, full = law([0.2], [0.1, 0.0, 0.05]), law([0.2, 0.0, 0.0], [0.1, 0.0, 0.05])
    assert np.array_equal(short.driven_angle(phi1, 2).coefficients, full.driven_angle(phi1, 2).coefficients)


@pytest.mark.slow
@pytest.mark.parametrize("harmonics", [60, 200])
def test_many_harmonics(harmonics: int) -> None:
    random = np.random.default_rng(harmonics)
    size = 0.5 / np.arange(1, harmonics + 1)
    cosine, sine = random.uniform(-1.0, 1.0, (2, harmonics)) * size
    transmission = harmonic_law(cosine, sine, Lobes())
    assert abs(transmission.closure_error_rad) <= 1e-13
    piece = transmission.pieces[0]
    phi1 = np.linspace(0.0, 2.0 * pi, 20001)
    low, high = transmission.slope_range
    slope = piece.slope(phi1, 0).value
    assert low.value * (1.0 - 1e-12) <= slope.min() <= low.value * (1.0 + 1e-3)
    assert high.value * (1.0 + 1e-12) >= slope.max() >= high.value * (1.0 - 1e-3)
    # Trapezoid sums of a periodic function over whole periods: dphi1 over dphi2 must come to 2 pi
    phi2 = np.arange(4096) * (2.0 * pi / 4096)
    made = closed_harmonics(cosine, sine, Lobes())
    assert np.mean(np.exp(log_constant(made) + made.series.at(phi2, 0).value)) == pytest.approx(1.0, abs=1e-13)


@at_once("name", CASES)
def test_all_derivatives_run_on_over_the_seam(name: str) -> None:
    cosine, sine, lobes = CASES[name]
    piece = law(list(cosine), list(sine), lobes).pieces[0]
    start, end = (piece.driven_angle(np.array([at]), 6) for at in (piece.start_rad, piece.end_rad))
    assert start.value[0] == 0.0
    assert end.value[0] == pytest.approx(lobes.driven_period_rad, abs=1e-15)
    for k in range(1, 7):
        scale = np.max(np.abs(piece.driven_angle(np.linspace(0.0, piece.end_rad, 101), k).derivative(k)))
        assert abs(end.derivative(k)[0] - start.derivative(k)[0]) <= 1e-12 * scale


coefficients = st.lists(st.floats(-0.4, 0.4), max_size=8)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(coefficients, coefficients, st.sampled_from([Lobes(), Lobes(2, 1), Lobes(1, 2), Lobes(3, 2)]))
def test_any_coefficients_close_and_invert(cosine: list[float], sine: list[float], lobes: Lobes) -> None:
    """Laws are closed, and phi1(phi2(phi1)) is where it began, by sums that no part of the law takes."""
    transmission = law(cosine, sine, lobes)
    assert abs(transmission.closure_error_rad) <= 1e-13
    phi1 = np.linspace(0.0, lobes.driving_period_rad, 9)[1:-1]
    turned = transmission.driven_angle(phi1).value * lobes.driven
    made = closed_harmonics(np.array(cosine), np.array(sine), lobes)
    whole, half = np.polynomial.legendre.leggauss(100)  # of more nodes numpy's own rules miss 1e-13
    unit, weights = np.concatenate([whole - 1.0, whole + 1.0]) / 2.0, np.tile(half / 2.0, 2)
    angles = (turned[:, None] / 2.0 * (unit + 1.0)).ravel()
    rate = np.exp(log_constant(made) + made.series.at(angles, 0).value).reshape(turned.size, -1)
    back = rate @ weights * turned / 2.0 / lobes.driven
    assert np.max(np.abs(back - phi1)) <= 1e-13


@pytest.mark.parametrize(
    ("cosine", "sine", "key", "said"),
    [
        ([0.1, nan], [], "motion.cosine.1", "nan given; a finite number"),
        ([0.1], [0.0, 0.0, inf], "motion.sine.2", "inf given; a finite number"),
    ],
)
def test_what_is_no_number_is_wrong_input(cosine: list[float], sine: list[float], key: str, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        law(cosine, sine)
    assert caught.value.key == key
    assert said in caught.value.problem


@at_once(
    ("cosine", "sine", "key", "value"),
    [
        ([7.0], [], "motion.cosine.0", "7 is the largest"),
        ([1.0], [1.0, -9.0], "motion.sine.1", "-9 is the largest"),
        ([1e300, 1e308], [1e308], "motion.cosine.1", "1e+308 is the largest"),
        ([2.0] * 200, [], "motion.cosine.0", "2 is the largest"),
    ],
)
def test_ratios_beyond_sense_are_refused(cosine: list[float], sine: list[float], key: str, value: str) -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        law(cosine, sine)
    assert caught.value.key == key
    assert value in caught.value.problem
    assert "1:1e" in caught.value.problem


def residual_rad(transmission: Transmission) -> float:
    """What rounding leaves: the last digit of a driving angle, times the fastest the driven gear turns."""
    return 1e-12 + 2.0 * np.pi * np.finfo(float).eps * transmission.slope_range[1].value


def test_just_below_the_largest_range_is_a_law() -> None:
    transmission = law([6.9], [])
    assert abs(transmission.closure_error_rad) <= residual_rad(transmission)
    assert transmission.ratio_range[1].value / transmission.ratio_range[0].value == pytest.approx(
        np.exp(13.8), rel=1e-9
    )


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-10.0, 10.0), max_size=30), st.lists(st.floats(-10.0, 10.0), max_size=30))
def test_every_list_gives_a_law_or_a_refusal(cosine: list[float], sine: list[float]) -> None:
    try:
        transmission = law(cosine, sine)
    except DesignError:
        return
    assert abs(transmission.closure_error_rad) <= residual_rad(transmission)
