"""Torques of driving shafts from tables and samples: a slider on a crank in closed form, and a wave of torque."""

from __future__ import annotations

from math import cos, pi, sqrt

import numpy as np
import pytest

from ncgear.dynamics.sampled_shafts import crank_table, torque_figures
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.numerics.sampled import Functions, shares

pytestmark = pytest.mark.judges("dynamics")

CRANK, ROD, SLIDER_KG, CRANK_KG_MM2 = 60.0, 150.0, 4.0, 900.0


def masses(gravity: tuple[float, float] = (0.0, 0.0)) -> RodMasses:
    return RodMasses(
        slider_kg=SLIDER_KG,
        rod_kg=0.0,
        rod_center_mm=0.0,
        rod_inertia_kg_mm2=0.0,
        crank_kg=0.0,
        crank_center_mm=0.0,
        crank_inertia_kg_mm2=CRANK_KG_MM2,
        gravity_m_s2=gravity,
    )


def test_torque_of_a_slider_on_a_crank_that_a_law_drives() -> None:
    """s (w^2 s^2 (m x' x'' - M f') + U') with M = J + m x'^2 and, where the slider's weight acts, U' = m g x'."""
    phi = np.random.default_rng(5).uniform(-1.0, 9.0, 40)
    root = np.sqrt(ROD**2 - (CRANK * np.sin(phi)) ** 2)
    first = CRANK * np.sin(phi) * (1.0 - CRANK * np.cos(phi) / root)
    bend = np.cos(phi) - CRANK * (np.cos(2.0 * phi) / root + CRANK**2 * np.sin(2.0 * phi) ** 2 / (4.0 * root**3))
    inertia = CRANK_KG_MM2 + SLIDER_KG * first**2
    slope, rate = np.random.default_rng(6).uniform(0.5, 2.0, (2, 40))
    for gravity in (0.0, 9.81):
        table = crank_table(CrankSlider(CRANK, ROD), masses((gravity, 0.0)))
        found = table.torque_n_mm(phi, slope, rate, np.full(40, 7.0))
        moving = 1e-3 * 49.0 * slope**2 * (SLIDER_KG * first * CRANK * bend - inertia * rate)
        # The slider's way out is that in which x grows.
        wanted = slope * (moving - SLIDER_KG * gravity * first)
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-6)


def test_a_crank_nearly_as_long_as_its_rod_is_not_told() -> None:
    """Its reduced inertia has no Fourier series that dies away."""
    table = crank_table(CrankSlider(60.0, 60.2), masses())
    assert np.isnan(table.torque_n_mm(np.ones(1), np.ones(1), np.ones(1), np.ones(1))).all()


@pytest.mark.parametrize(("mean", "wave"), [(3.0, 5.0), (3.0, 2.0), (0.0, 2.0)])
def test_figures_of_a_wave_of_torque(mean: float, wave: float) -> None:
    """Mean and sine over a turn in two pieces, the second twice as fast; all figures are in closed form."""
    count = 33
    edges = np.array([0.0, 2.0, 2.0 * pi])
    angle = edges[:-1, None] + np.diff(edges)[:, None] * shares(count)
    torque = Functions((mean + wave * np.sin(angle))[..., None] * np.ones(2))
    turning = np.diff(edges)[:, None, None] * np.ones((2, count, 2))
    speed = np.array([4.0, 8.0])
    found = torque_figures(torque, turning, np.ones((2, 2), dtype=bool), speed)
    watts = 1e-3 * speed
    assert found["peak_power_w"] == pytest.approx((mean + wave) * watts)
    assert found["braking_power_w"] == pytest.approx(max(wave - mean, 0.0) * watts)
    assert found["rms_torque_n_m"] == pytest.approx(np.full(2, 1e-3 * sqrt(mean**2 + wave**2 / 2.0)))
    # What is stored swings with the cosine, by twice its height.
    assert found["energy_swing_j"] == pytest.approx(np.full(2, 1e-3 * wave * (1.0 - cos(pi))))
