"""Shaking force and moment: momentum by 40-digit arithmetic, the joints' forces, balance that is complete."""

from __future__ import annotations

from cmath import exp
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from at_once import at_once
from mechanisms import AMPLITUDE, ASIDE, LINKAGE, MASSES, OFFSET, even, oracle, sampled, uneven
from ncgear.balance.mechanism import (
    Carrier,
    Counterweight,
    DrivenCrank,
    JointMasses,
    complete_balance,
    joint_masses,
    partial_counterweight,
    partial_counterweight_kg,
)
from ncgear.balance.shaking import Shaking, Speed, shaking, two_term_formula
from ncgear.errors import WrongInput
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import EvenPace, RodMasses
from pairs import baler_law
from published import BALER_LINKAGE, RPM

SLIDER = RodMasses(slider_kg=65.0)

MECHANISMS = {
    "even": (even(), 0.0),
    "uneven": (uneven(), AMPLITUDE),
    "uneven, offset, masses aside": (replace(uneven(OFFSET), counterweights=ASIDE), AMPLITUDE),
    "even, offset back": (even(CrankSlider(265.0, 560.0, -90.0)), 0.0),
}


@pytest.mark.judges("balance")
@at_once("name", MECHANISMS)
def test_force_and_moment_are_rates_of_momentum(name: str) -> None:
    mechanism, amplitude = MECHANISMS[name]
    found, peak = shaking(mechanism), shaking(mechanism).peak.value
    for phi1 in sampled(mechanism):
        force, moment = oracle(mechanism, amplitude, float(phi1))
        at = np.array([phi1])
        assert abs(found.along(at)[0] + 1j * found.across(at)[0] - force) <= 1e-12 * peak
        assert abs(found.moment(at)[0] - moment) <= 1e-12 * peak * 1000.0


@pytest.mark.parametrize("mechanism", [uneven(OFFSET), DrivenCrank(LINKAGE, baler_law(), 52.81 * RPM, MASSES)])
def test_the_frame_feels_what_the_joints_bear(mechanism: DrivenCrank) -> None:
    """Newton and Euler body by body: bearing, guide and the reaction of the drive."""
    phi1 = sampled(mechanism, 50)
    at, found = mechanism.linkage.rod(mechanism.transmission.driven_angle(phi1, 2)), shaking(mechanism)
    joints = mechanism.linkage.joint_forces(
        mechanism.transmission.driven_angle(phi1, 2), mechanism.masses, EvenPace(mechanism.speed_rad_s), 0.0
    )
    peak = found.peak.value
    assert np.allclose(found.along(phi1), -joints.crank_axis.x.value, rtol=0.0, atol=1e-11 * peak)
    assert np.allclose(found.across(phi1), -(joints.crank_axis.y + joints.guide_n).value, rtol=0.0, atol=1e-11 * peak)
    # The torque is asked for in the crank's sense, clockwise; what asks for it is turned the other way.
    moment = joints.torque_n_mm.value - at.wrist.x.value * joints.guide_n.value
    assert np.allclose(found.moment(phi1), moment, rtol=0.0, atol=1e-11 * np.abs(moment).max())


def completely_balanced(mechanism: DrivenCrank, more: float = 1.0) -> DrivenCrank:
    found = complete_balance(mechanism, 200.0, 250.0)
    added = replace(found.rod, mass_kg=more * found.rod.mass_kg), found.crank
    return replace(mechanism, counterweights=added)


def test_the_published_complete_balance() -> None:
    found = complete_balance(even(masses=SLIDER), 200.0, 250.0)
    assert found.rod.mass_kg == pytest.approx(182.0, rel=1e-15)
    assert found.pin_kg == pytest.approx(247.0, rel=1e-15)
    assert round(found.crank.mass_kg, 2) == 261.82


@pytest.mark.parametrize("mechanism", [even(), uneven(OFFSET), even(masses=SLIDER)])
def test_complete_balance_leaves_no_force_whatever_the_drive(mechanism: DrivenCrank) -> None:
    bare, balanced = shaking(mechanism), shaking(completely_balanced(mechanism))
    assert balanced.peak.value <= 1e-12 * bare.peak.value
    # One per cent of the rod's counterweight is felt
    assert shaking(completely_balanced(mechanism, 1.01)).peak.value > 1e-3 * bare.peak.value
    # The moment is not balanced: it grows
    assert balanced.moment.extremes[1].value > bare.moment.extremes[1].value


def test_the_center_of_mass_rests_when_balanced() -> None:
    mechanism = completely_balanced(uneven())
    assert np.abs(mechanism.center_of_mass_mm(sampled(mechanism))).max() <= 1e-12 * LINKAGE.rod_mm


@pytest.mark.parametrize(("rod", "crank", "key"), [(0.0, 1.0, "rod_arm_mm"), (1.0, -1.0, "crank_arm_mm")])
def test_arms_must_be_positive(rod: float, crank: float, key: str) -> None:
    with pytest.raises(WrongInput, match="cannot stand at an arm") as error:
        complete_balance(even(masses=SLIDER), rod, crank)
    assert error.value.key == key


def test_a_crank_too_heavy_behind_is_refused() -> None:
    heavy = RodMasses(slider_kg=1.0, crank_kg=100.0, crank_center_mm=-100.0)
    with pytest.raises(WrongInput, match="too heavy by 8993 kg mm"):
        complete_balance(even(masses=heavy), 200.0, 250.0)


# --- partial balance ----------------------------------------------------------------------------------------------

PAN = JointMasses(11.9, 12.86)
SIEVE = RodMasses(slider_kg=0.26, rod_kg=90.4, rod_center_mm=1378.0 - 448.0, crank_kg=1.0, crank_center_mm=12.3)


@pytest.mark.judges("balance")
def test_the_published_partial_balance() -> None:
    crank = CrankSlider(15.0, 1045.0)
    pan = [partial_counterweight_kg(crank, PAN, 45.0, k) for k in (1 / 3, 1 / 2)]
    assert [round(mass, 2) for mass in pan] == [5.40, 6.11]
    sieve = CrankSlider(15.0, 1378.0)
    printed = JointMasses(29.5, 61.26)
    given = joint_masses(sieve, SIEVE)
    for at, expected in ((printed, [16.64, 20.04]), (given, [16.88, 20.28])):
        assert [round(partial_counterweight_kg(sieve, at, 45.0, k), 2) for k in (1 / 3, 1 / 2)] == expected
    assert round(given.rotating_kg, 2) == 30.21


THERE = (
    Counterweight(Carrier.CRANK, 3.7, 38.0, pi),
    Counterweight(Carrier.CRANK, 0.9, 55.0, 2.2),  # aside
    Counterweight(Carrier.ROD, 1.3, 400.0, pi),
)
SHAKEN = replace(even(CrankSlider(15.0, 1378.0), SIEVE), counterweights=THERE)


@pytest.mark.judges("balance")
def test_all_balances_are_beside_the_counterweights_already_there() -> None:
    """Once the one that is asked for is there, nothing more is asked for; nor does it matter who brought it."""
    parts, bare = joint_masses(SHAKEN.linkage, SIEVE), replace(SHAKEN, counterweights=())
    for share in (0.0, 0.4, 1.0):
        whole = partial_counterweight(bare, parts, 45.0, share)
        assert whole.mass_kg == pytest.approx(partial_counterweight_kg(bare.linkage, parts, 45.0, share), rel=1e-14)
        added = partial_counterweight(SHAKEN, parts, 45.0, share)
        done = SHAKEN.with_counterweight(added)
        # The rule itself, on all that moves: the mass at the pin opposes the share of the mass at the slider
        assert done.pin_kg == pytest.approx(-share * done.wrist_kg, abs=1e-12)
        again = partial_counterweight(done, parts, 70.0, share)
        assert again.mass_kg == pytest.approx(0.0, abs=1e-12)
        assert again.angle_rad == pi
    complete = complete_balance(SHAKEN, 300.0, 60.0)
    still = replace(SHAKEN, counterweights=(*THERE, complete.rod, complete.crank))
    assert shaking(still).peak.value <= 1e-12 * shaking(SHAKEN).peak.value
    assert complete.rod.mass_kg == pytest.approx(complete_balance(bare, 300.0, 60.0).rod.mass_kg - 1.3 * 4.0 / 3.0)
    assert complete.pin_kg == pytest.approx(SIEVE.slider_kg + SIEVE.rod_kg + 1.3 + complete.rod.mass_kg)


def test_counterweights_that_are_too_heavy_are_answered_on_the_other_side_or_refused() -> None:
    heavy = replace(SHAKEN, counterweights=(Counterweight(Carrier.CRANK, 40.0, 45.0),))
    added = partial_counterweight(heavy, joint_masses(SHAKEN.linkage, SIEVE), 45.0, 1.0 / 3.0)
    assert abs(exp(1j * added.angle_rad) - 1.0) <= 1e-12
    assert added.mass_kg == pytest.approx(40.0 - 16.88, abs=0.005)
    on_rod = replace(SHAKEN, counterweights=(Counterweight(Carrier.ROD, 500.0, 400.0),))
    with pytest.raises(WrongInput, match="take counterweights off it") as error:
        complete_balance(on_rod, 300.0, 60.0)
    assert error.value.key == "rod_arm_mm"


def test_joint_masses_move_the_center_of_mass_as_the_parts_do() -> None:
    mechanism, at = uneven(OFFSET), joint_masses(OFFSET, MASSES)
    assert mechanism.pin_kg == pytest.approx(at.rotating_kg, rel=1e-15)
    assert mechanism.wrist_kg == pytest.approx(at.reciprocating_kg, rel=1e-15)


# --- two terms ----------------------------------------------------------------------------------------------------


def test_two_terms_are_off_by_4_3_per_cent_of_the_peak() -> None:
    """At r/l = 0.473 of the paper's own slider; the oracle is the closed form of the exact acceleration."""
    found = two_term_formula(even(masses=SLIDER))
    assert round(100.0 * found.largest_error, 1) == 4.3
    ratio, t = 265.0 / 560.0, np.linspace(0.0, 2.0 * pi, 100_001)
    root = np.sqrt(1.0 - (ratio * np.sin(t)) ** 2)
    exact = np.cos(t) + ratio * np.cos(2.0 * t) / root + ratio**3 * np.sin(2.0 * t) ** 2 / (4.0 * root**3)
    error = np.abs(exact - np.cos(t) - ratio * np.cos(2.0 * t)).max() / (1.0 + ratio)
    assert found.largest_error == pytest.approx(error, rel=1e-8)
    # Both ends are exact: 1 + r/l is the formula's peak as well
    assert found.peak_n == pytest.approx(shaking(even(masses=SLIDER)).peak.value, rel=1e-13)


def test_two_terms_become_exact_with_a_long_rod() -> None:
    """The first term left out is of the third order in r/l."""
    errors = [two_term_formula(even(CrankSlider(10.0, rod), SLIDER)).largest_error for rod in (100.0, 200.0, 400.0)]
    assert errors[0] / errors[1] == pytest.approx(8.0, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(8.0, rel=0.08)


def test_classical_formulas_fail_for_an_uneven_crank() -> None:
    """The baler: what a textbook's formula gives at the mean or the momentary speed, beside the truth."""
    mechanism = DrivenCrank(BALER_LINKAGE, baler_law(), 20.0 * RPM, SLIDER)
    mean, momentary = two_term_formula(mechanism, Speed.MEAN), two_term_formula(mechanism, Speed.MOMENTARY)
    true = shaking(mechanism).peak.value
    assert true == pytest.approx(65.0 * 7.3411, rel=1e-4)  # the slider's peak acceleration in m/s^2
    # The formula's peak in closed form, at the extended dead centre
    even_peak = 65.0 * 0.38 * (20.0 * RPM) ** 2 * (1.0 + 380.0 / 960.0)
    assert mean.peak_n == pytest.approx(even_peak, rel=1e-9)
    percents = [mean.peak_n / true, momentary.peak_n / true, mean.largest_error, momentary.largest_error]
    assert [round(100.0 * share) for share in percents] == [32, 66, 85, 54]  # docs/method.md


@pytest.mark.thorough
def test_the_formula_at_the_momentary_speed_is_exact_where_the_crank_keeps_it() -> None:
    for speed in Speed:
        assert two_term_formula(even(), speed) == two_term_formula(even())


def test_an_offset_has_no_two_term_formula() -> None:
    with pytest.raises(WrongInput, match="in line"):
        two_term_formula(even(OFFSET))


def test_force_goes_with_the_square_of_the_speed() -> None:
    def peaks(found: Shaking) -> np.ndarray:
        return np.array([found.peak.value, found.moment.extremes[1].value])

    assert peaks(shaking(uneven(rpm=60.0))) == pytest.approx(9.0 * peaks(shaking(uneven(rpm=20.0))), rel=1e-13)
