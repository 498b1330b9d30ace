"""Statistics and harmonics of piecewise forms: closed forms, and quadrature with 30 digits."""

from __future__ import annotations

from math import pi, sqrt

import mpmath
import numpy as np
import pytest

from ncgear.balance.waveform import magnitude_statistics, waveform
from ncgear.numerics.arrays import Array

TURN = np.array([0.0, 2.0 * pi])


def parabolas(angle: Array) -> Array:
    """A jump at 1, and a kink at 4."""
    first = np.where(angle < 1.0, angle**2, 3.0 - angle)
    return np.where(angle < 4.0, first, np.cos(angle))


BREAKS = np.array([0.0, 1.0, 4.0, 2.0 * pi])


def exact_harmonic(k: int) -> complex:
    parts = [(lambda t: t**2, 0, 1), (lambda t: 3 - t, 1, 4), (mpmath.cos, 4, 2 * mpmath.pi)]
    with mpmath.workdps(30):
        total = sum(
            mpmath.quad(lambda t, f=f: f(t) * mpmath.expj(-k * t), mpmath.linspace(a, b, k + 2)) for f, a, b in parts
        )
        return complex(total / (2 * mpmath.pi))


def test_harmonics_count_from_the_start() -> None:
    """3 cos(phi - 0.8) + 0.5 from 1.3 on: c_1 is half of 3 exp(i (1.3 - 0.8)), c_0 the mean, and no other is there."""
    form = waveform(lambda angle: 3.0 * np.cos(angle - 0.8) + 0.5, TURN + 1.3)
    found = form.harmonics(3)
    assert found == pytest.approx(np.array([0.5, 1.5 * np.exp(0.5j), 0.0, 0.0]), abs=1e-12)


@pytest.mark.slow
def test_harmonics_of_a_function_with_jumps() -> None:
    found = waveform(parabolas, BREAKS).harmonics(40)
    for k in (0, 1, 2, 7, 40):
        assert abs(found[k] - exact_harmonic(k)) <= 1e-14


@pytest.mark.slow
def test_even_samples_would_be_far_off() -> None:
    """What a fast Fourier transform of 256 samples makes of the jump: an error of a sample's share of it."""
    samples = np.fft.rfft(parabolas(np.arange(256) / 256 * 2.0 * pi)) / 256
    assert abs(samples[7] - exact_harmonic(7)) > 1e-4


def test_parseval() -> None:
    made = waveform(np.sin, TURN)
    assert made.rms == pytest.approx(1.0 / sqrt(2.0), rel=1e-15)
    assert np.abs(made.harmonics(3) - [0.0, -0.5j, 0.0, 0.0]).max() <= 1e-14


def test_extremes_at_a_joint_and_inside() -> None:
    lowest, highest = waveform(parabolas, BREAKS).extremes
    assert (highest.value, highest.at) == pytest.approx((2.0, 1.0), abs=1e-14)
    assert (lowest.value, lowest.at) == pytest.approx((-1.0, 4.0), abs=1e-14)
    lowest, highest = waveform(lambda t: np.sin(t) + t / 10.0, TURN).extremes
    assert highest.at == pytest.approx(np.arccos(-0.1), rel=1e-12)
    assert lowest.at == pytest.approx(2.0 * pi - np.arccos(-0.1), rel=1e-12)


def test_the_mean_length_of_a_vector_on_an_ellipse() -> None:
    """2/pi E of the eccentricity; and 2/pi where the ellipse is a line, whose length has a kink."""
    for short in (0.5, 1e-3, 0.0):
        along, across = waveform(np.cos, TURN), waveform(lambda t, b=short: b * np.sin(t), TURN)
        found = magnitude_statistics(along, across)
        exact = 2.0 / pi * float(mpmath.ellipe(1 - mpmath.mpf(short) ** 2))
        assert found.mean == pytest.approx(exact, rel=2e-12)
        assert found.rms == pytest.approx(sqrt((1.0 + short**2) / 2.0), rel=1e-14)
        # The root of a square that is off by a rounding error of one
        assert found.minimum == pytest.approx(short, abs=1e-7)
        assert found.peak_to_peak == pytest.approx(1.0 - short, abs=1e-7)


def test_a_constant_length_has_no_turns() -> None:
    found = magnitude_statistics(waveform(np.cos, TURN), waveform(np.sin, TURN))
    assert (found.mean, found.rms, found.maximum) == pytest.approx((1.0, 1.0, 1.0), rel=1e-13)


def test_nothing_stays_nothing() -> None:
    nothing = waveform(lambda t: 0.0 * t, TURN)
    found = magnitude_statistics(nothing, nothing)
    assert (found.mean, found.rms, found.minimum, found.maximum) == (0.0, 0.0, 0.0, 0.0)
