"""Excitation frequencies: the published table, and harmonics against 30-digit quadrature."""

from __future__ import annotations

from math import pi

import mpmath
import numpy as np
import pytest

from at_once import at_once
from mechanisms import AMPLITUDE, LINKAGE, even, oracle, uneven
from ncgear.balance.excitation import (
    Engine,
    Excitation,
    Shaft,
    critical_speed_rpm,
    margins,
    of_engine,
    of_shaft,
    of_slider,
)
from ncgear.balance.mechanism import DrivenCrank
from ncgear.mechanisms.forces import RodMasses
from pairs import baler_law
from published import BALER_LINKAGE, RPM

TABLE_1 = (
    ("engine", 2400, 15, None, (40, 600, None)),
    ("engine drive shaft", 1354, 14, 32, (22.57, 315.98, 722.24)),
    ("knotted shaft", 96.5, 13, 32, (1.61, 20.93, 51.52)),
    ("transport bale shaft", 193, 13, 21, (3.22, 41.86, 67.62)),
    ("gear transmission", 391.7, 15, 73, (6.53, 97.95, 476.69)),
    ("feeding wheel I", 569.8, 13, 30, (9.50, 123.5, 285)),
    ("feeding wheel II", 341.8, 13, 21, (5.70, 74.1, 119.7)),
    ("feeding auger", 226, 14, None, (3.77, 52.78, None)),
    ("picking up device", 141, 13, 58, (2.35, 30.55, 136.3)),
)

NATURAL = (4.62, 17.26, 29.82, 63.85, 83.73, 141.58)


@at_once("row", TABLE_1)
def test_the_published_frequencies(row: tuple) -> None:
    """The table multiplies rounded fundamentals: 0.005 Hz of rounding times rollers or teeth is its own error."""
    name, speed, rollers, teeth, expected = row
    found = {one.kind: one.frequency_hz for one in of_shaft(Shaft(name, speed, rollers, teeth))}
    for kind, value, times in zip(("rotation", "rollers", "teeth"), expected, (1, rollers, teeth), strict=True):
        assert (value is None) == (kind not in found)
        if value is not None:
            assert found[kind] == pytest.approx(value, abs=0.0051 * times)


def test_the_published_engine() -> None:
    found = {one.kind: one.frequency_hz for one in of_engine(Engine("engine", 2400.0, cylinders=4, strokes=4))}
    assert found == {"rotation": 40.0, "combustion": 80.0, "inertia": 80.0}


def test_rollers_with_their_geometry() -> None:
    """Both races together see each roller once a turn of the shaft relative to the cage: z n/60 in all."""
    outer, inner = of_shaft(Shaft("s", 600.0, rollers=9, roller_ratio=0.2))[1:]
    assert (outer.frequency_hz, inner.frequency_hz) == pytest.approx((36.0, 54.0))


def test_the_auger_is_near_the_first_natural_frequency() -> None:
    found = margins(of_shaft(Shaft("auger", 226.0)), NATURAL, 0.2)[0]
    assert (found.nearest_natural_hz, round(found.ratio, 2), found.near) == (4.62, 0.82, True)
    assert not margins(of_shaft(Shaft("auger", 226.0)), NATURAL, 0.18)[0].near


def test_the_nearest_is_nearest_by_ratio() -> None:
    """15 Hz between 10 and 20: nearer to 20, three quarters, than to 10, three halves."""
    assert margins([Excitation("a", "b", 14.5)], [10.0, 20.0], 0.1)[0].nearest_natural_hz == 20.0


def test_critical_speeds_of_the_drum() -> None:
    for natural, critical in (
        (143.76, 8625.6),
        (143.77, 8626.2),
        (197.05, 11823.0),
        (293.1, 17586.0),
        (298.33, 17899.8),
    ):
        assert critical_speed_rpm(natural) == pytest.approx(critical, rel=1e-12)


# --- harmonics of the slider -------------------------------------------------------------------------------------

ONE = RodMasses(slider_kg=1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("mechanism", "amplitude"), [(even(masses=ONE), 0.0), (uneven(masses=ONE), AMPLITUDE)])
def test_harmonics_against_quadrature(mechanism: DrivenCrank, amplitude: float) -> None:
    """With 1 kg at the slider the shaking force of the oracle is minus the acceleration; trapezoidal, 240 points."""
    angles = np.arange(240) / 240 * 2.0 * pi
    acceleration = np.array([-oracle(mechanism, amplitude, float(angle))[0].real for angle in angles])
    for found in of_slider("slider", mechanism, 8):
        k = int(found.kind.removeprefix("harmonic "))
        exact = 2.0 * abs(np.mean(acceleration * np.exp(-1j * k * angles)))
        assert found.frequency_hz == pytest.approx(k * 96.5 / 60.0, rel=1e-12)
        assert found.amplitude_m_s2 == pytest.approx(exact, abs=1e-9)


def test_an_even_crank_has_two_strong_harmonics() -> None:
    """r w^2 and about r w^2 r/l; odd ones from the third on are forbidden by symmetry, and left out."""
    scale = 0.265 * even().speed_rad_s ** 2
    found = {one.kind: one.amplitude_m_s2 / scale for one in of_slider("slider", even(), 7)}
    assert list(found) == [f"harmonic {k}" for k in (1, 2, 4, 6)]
    assert found["harmonic 1"] == pytest.approx(1.0, rel=1e-12)
    turns_hz = even().speed_rad_s / (2.0 * pi)
    assert [one.frequency_hz / turns_hz for one in of_slider("slider", even(), 7)] == pytest.approx([1, 2, 4, 6])
    assert found["harmonic 2"] == pytest.approx(LINKAGE.crank_mm / LINKAGE.rod_mm, rel=0.1)


@pytest.mark.slow
def test_the_baler_shakes_at_high_harmonics() -> None:
    """Parseval: 400 harmonics hold all of the mean square, twenty leave a hundred-thousandth."""
    baler = DrivenCrank(BALER_LINKAGE, baler_law(), 20.0 * RPM, ONE)
    harmonics = np.array([one.amplitude_m_s2 for one in of_slider("slider", baler, 400)])
    phi1 = np.linspace(0.0, 2.0 * pi, 400_001)
    driven = baler.linkage.displacement(baler.transmission.driven_angle(phi1, 2)).derivative(2)
    square = float(np.trapezoid((driven * baler.speed_rad_s**2 / 1000.0) ** 2, phi1)) / (2.0 * pi)
    assert np.sum(harmonics**2) / 2.0 == pytest.approx(square, rel=1e-7)
    assert np.sum(harmonics[:20] ** 2) / 2.0 < square * (1.0 - 5e-6)
    assert harmonics[2] > 0.2 * harmonics[0]


def test_harmonics_of_a_pendulum_like_rod() -> None:
    """The second one of an even crank in closed form, by elliptic integrals through mpmath's quadrature."""
    with mpmath.workdps(30):
        ratio = mpmath.mpf(265) / 560
        place = lambda t: mpmath.cos(t) + mpmath.sqrt(1 - (ratio * mpmath.sin(t)) ** 2) / ratio  # noqa: E731
        second = mpmath.quad(lambda t: place(t) * mpmath.cos(2 * t), [0, mpmath.pi / 2, mpmath.pi]) * 2 / mpmath.pi
        exact = float(4 * second) * 0.265 * even().speed_rad_s ** 2
    assert of_slider("slider", even(), 2)[1].amplitude_m_s2 == pytest.approx(exact, rel=1e-13)
