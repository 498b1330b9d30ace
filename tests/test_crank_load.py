"""The linkage as a load on its shaft, against the forces of Newton and Euler and against energy."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from loaded import LINKAGE, MASSES, slider_load
from ncgear.dynamics.crank_load import INTERVALS, CrankLoad, crank_angles_rad, crank_load
from ncgear.errors import WrongInput
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import CrankPace, RodMasses
from ncgear.mechanisms.resistance import PolynomialResistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.jet import Jet
from ncgear.numerics.periodic_table import PeriodicTable

WEIGHT = replace(MASSES, gravity_m_s2=(1.3, -9.81))
RESISTANCE = PolynomialResistance((-40.0, 3.0, 0.02))


@pytest.mark.parametrize("linkage", [LINKAGE, CrankSlider(60.0, 200.0, 25.0)])
def test_torque_of_any_motion_is_that_of_the_joint_forces(linkage: CrankSlider) -> None:
    random = np.random.default_rng(5)
    angle, speed, acceleration = random.uniform([0.0, -9.0, -50.0], [2.0 * pi, 9.0, 50.0], (500, 3)).T
    slide = linkage.displacement(Jet.variable(angle, 0)).value
    resisting = np.where(angle < linkage.working_angle_rad, RESISTANCE.force_n(slide), 0.0)
    pace = CrankPace(speed, acceleration)
    expected = linkage.joint_forces(Jet.variable(angle, 2), WEIGHT, pace, resisting).torque_n_mm
    found = crank_load(linkage, WEIGHT, SliderLoad(RESISTANCE)).torque_n_mm(angle, speed, acceleration)
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


def test_a_narrow_peak_of_the_resistance_is_in_the_table() -> None:
    """A thousandth of an even interval wide; a smooth resistance has no narrow stretch."""
    peak = TableResistance((0.0, 33.1, 33.1001, 33.1002, 120.0), (50.0, 50.0, 5e4, 50.0, 50.0))
    load = crank_load(LINKAGE, MASSES, SliderLoad(peak))
    (start, end, way), *others = load.narrow_rad
    assert not others
    angle = np.linspace(start, end, 1000)
    inside = np.linspace(*crank_angles_rad(LINKAGE, np.array([33.1, 33.1002]), returning=False), 400)
    assert start < inside[0] < inside[-1] < end
    assert way < (inside[-1] - inside[0])
    for places in (angle, inside):
        slide = LINKAGE.displacement(Jet.variable(places, 1))
        expected = peak.force_n(slide.value) * slide.derivative(1)
        still = np.zeros_like(places)
        np.testing.assert_allclose(load.torque_n_mm(places, still, still), expected, atol=1e-4 * expected.max())
    assert crank_load(LINKAGE, MASSES, SliderLoad(RESISTANCE)).narrow_rad.shape == (0, 3)


def test_a_resistance_that_begins_with_a_kink_takes_no_more_knots() -> None:
    """The baler's, negative below 33.7 mm: its table is the one of evenly spaced knots."""
    baler = PolynomialResistance((-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7))
    assert crank_load(CrankSlider(380.0, 960.0), MASSES, SliderLoad(baler)).table.breaks.size == INTERVALS + 1


def test_acceleration_undoes_torque() -> None:
    load = slider_load()
    angle, speed, acceleration = np.random.default_rng(6).uniform(-9.0, 9.0, (3, 200))
    torque = load.torque_n_mm(angle, speed, acceleration)
    np.testing.assert_allclose(load.acceleration_rad_s2(angle, speed, torque), acceleration, rtol=1e-11, atol=1e-11)


def test_a_turn_costs_the_work_of_the_resistance_and_no_work_of_the_weights() -> None:
    load = crank_load(LINKAGE, WEIGHT, SliderLoad(RESISTANCE))
    ends = load.energy_n_mm(np.array([0.0, 2.0 * pi, 8.0 * pi]), np.full(3, 3.0))
    work = float(RESISTANCE.work_n_mm(np.array([LINKAGE.stroke_mm]), LINKAGE.stroke_mm)[0])
    np.testing.assert_allclose(np.diff(ends), [work, 3.0 * work], rtol=1e-13)


def test_the_power_of_the_torque_is_the_change_of_energy() -> None:
    load, step = slider_load(), 1e-5
    angle, speed, acceleration = np.random.default_rng(8).uniform(0.1, 6.0, (3, 100))
    sides = [
        load.energy_n_mm(angle + way * speed + way**2 * acceleration / 2.0, speed + way * acceleration)
        for way in (step, -step)
    ]
    power = load.torque_n_mm(angle, speed, acceleration) * speed
    np.testing.assert_allclose((sides[0] - sides[1]) / (2.0 * step), power, rtol=1e-5, atol=1.0)


def test_a_shaft_without_inertia_is_refused() -> None:
    with pytest.raises(WrongInput, match="nothing that turns with the crank has inertia") as caught:
        slider_load(masses=RodMasses(slider_kg=5.0))
    assert caught.value.key == "masses"


def test_a_motion_stops_at_dead_centres_and_at_both_ends_of_narrow_stretches() -> None:
    """Also after whole turns, and with small steps within a stretch alone."""
    table = PeriodicTable(np.array([0.0, 2.0 * pi]), np.array([[1.0, 0.0]])[None])
    load = CrankLoad(table, (0.0, pi), np.array([[1.0, 1.2, 0.01]]))
    for turns in (0.0, 4.0 * pi):
        for at, stop, way in ((0.5, 1.0, np.inf), (1.1, 1.2, 0.01), (1.2, pi, np.inf), (4.0, 2.0 * pi, np.inf)):
            assert load.next_stop_rad(turns + at) == pytest.approx((turns + stop, way))
