"""The working stroke against its defining conditions, solved here as plain linear equations, and against mpmath."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import permutations
from math import pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from at_once import at_once
from commands import stated_angle
from ncgear.design.laws.three_segment_stroke import ThreeSegmentStroke
from ncgear.errors import NoSuchMechanism
from ncgear.ratio.working_stroke import ClosedStroke, StrokeRequest, solved_stroke
from oracles import stroke as oracle
from published import RPM

BALER = StrokeRequest(0.4 * pi, 0.7 * pi, pi, 1.3 * pi, 1600.0, 1100.0, -1500.0, None, 760.0, 20.0 * RPM)
"""Table 1 of the baler paper, a1 at the 20 r/min of its simulation."""

AT_LAW_SPEED = replace(BALER, a1_speed_rad_s=None)
"""The other reading: a1 at the speed of v1 and v2."""

SHORT = StrokeRequest(0.3 * pi, 0.6 * pi, 0.75 * pi, 1.1 * pi, 700.0, 500.0, -9000.0, None, 130.0, None)
NO_PRESSING = replace(BALER, theta3_rad=0.7 * pi)
REQUESTS = {"baler": BALER, "at law speed": AT_LAW_SPEED, "short": SHORT, "no pressing": NO_PRESSING}

every_request = at_once("name", REQUESTS)

FIELDS = "law_speed_rad_s", "v1", "v2", "a1", "stroke_mm"


def displacements(stroke: ClosedStroke) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Displacement over the three segments as polynomials of phi1, from the divided-out forms."""
    phi, before_end = Polynomial([0.0, 1.0]), Polynomial([stroke.theta4_rad, -1.0])
    approach = phi**2 * Polynomial(stroke.approach_root)
    pressing = stroke.pressing_start_mm + stroke.pressing_mm_rad * (phi - stroke.theta2_rad)
    braking = stroke.stroke_mm - before_end**2 * Polynomial(stroke.braking_root)(before_end)
    return approach, pressing, braking


def conditions(request: StrokeRequest, stroke: ClosedStroke) -> list[tuple[str, float, float]]:
    """Name, value found and value wanted of eqs. (3.3) to (3.7) and the joints, in mm and rad."""
    first, second, third = displacements(stroke)
    t1, t2, t3, t4 = request.theta1_rad, request.theta2_rad, request.theta3_rad, request.theta4_rad
    omega = stroke.law_speed_rad_s
    braking = stroke.a1 / (request.a1_speed_rad_s or omega) ** 2
    return [
        ("start", first(0.0), 0.0),
        ("start velocity", first.deriv()(0.0), 0.0),
        ("v1", first.deriv()(t1), stroke.v1 / omega),
        ("a at theta1", first.deriv(2)(t1), 0.0),
        ("v2", first.deriv()(t2), stroke.v2 / omega),
        ("a at theta2", first.deriv(2)(t2), 0.0),
        ("joint at theta2", first(t2), second(t2)),
        ("pressing", second.deriv()(t2), stroke.v2 / omega),
        ("joint at theta3", second(t3), third(t3)),
        ("v2 at theta3", third.deriv()(t3), stroke.v2 / omega),
        ("a at theta3", third.deriv(2)(t3), 0.0),
        ("v at theta4", third.deriv()(t4), 0.0),
        ("a1", third.deriv(2)(t4), braking),
        ("stroke", third(t4), stroke.stroke_mm),
    ]


def assert_conditions(request: StrokeRequest, stroke: ClosedStroke) -> None:
    """Every condition, to the rounding of expanded powers of phi1: terms of 1000 stroke that cancel."""
    for name, found, wanted in conditions(request, stroke):
        assert found == pytest.approx(wanted, abs=1e-12 * stroke.stroke_mm), name


@every_request
def test_every_condition_of_the_paper_holds(name: str) -> None:
    assert_conditions(REQUESTS[name], solved_stroke(REQUESTS[name]))


def test_the_conditions_would_show_a_wrong_speed() -> None:
    stroke = solved_stroke(BALER)
    wrong = replace(stroke, law_speed_rad_s=stroke.law_speed_rad_s * (1.0 + 1e-9))
    misses = [abs(found - wanted) for _, found, wanted in conditions(BALER, wrong)]
    assert max(misses) > 1e-12 * stroke.stroke_mm


@every_request
def test_velocity_forms_are_the_derivatives_of_the_displacement_forms(name: str) -> None:
    stroke = solved_stroke(REQUESTS[name])
    for slope, root in ((stroke.approach_slope, stroke.approach_root), (stroke.braking_slope, stroke.braking_root)):
        integral = (Polynomial([0.0, 1.0]) * Polynomial(slope)).integ()
        assert np.allclose(integral.coef[2:], root, rtol=1e-15, atol=0.0)


@every_request
def test_the_segments_add_up_to_the_stroke(name: str) -> None:
    stroke = solved_stroke(REQUESTS[name])
    # Three terms of about the stroke and their Horner sums of four terms: ten rounding errors
    assert abs(stroke.closing_error_mm) <= 3e-15 * stroke.stroke_mm
    assert replace(stroke, stroke_mm=stroke.stroke_mm + 1e-6).closing_error_mm < -0.5e-6


@pytest.mark.parametrize(("request_", "rpm"), [(BALER, 52.81), (AT_LAW_SPEED, 51.31)])
def test_both_readings_of_the_paper(request_: StrokeRequest, rpm: float) -> None:
    """Four written digits: half a unit of the last one."""
    assert solved_stroke(request_).law_speed_rad_s / RPM == pytest.approx(rpm, abs=0.005)


def exact_parameters(request: StrokeRequest) -> oracle.StrokeParameters:
    """The oracle's parameters for the in-line linkage of the request's stroke."""
    angles = request.theta1_rad, request.theta2_rad, request.theta3_rad, request.theta4_rad
    speeds = request.v1, request.v2, request.a1
    crank = (request.stroke_mm or 0.0) / 2.0
    return oracle.StrokeParameters(*angles, *speeds, crank, 3.0 * crank, 0.0, request.a1_speed_rad_s)


@pytest.mark.parametrize("name", ["baler", "at law speed", "short"])
def test_law_speed_and_displacements_against_mpmath(name: str) -> None:
    request = REQUESTS[name]
    stroke, exact = solved_stroke(request), oracle.Stroke(exact_parameters(request))
    assert abs(stroke.law_speed_rad_s / exact.omega - 1) < 1e-14  # some tens of rounding errors, nothing cancels
    edges = [0.0, request.theta2_rad, request.theta3_rad, request.theta4_rad]
    for form, low, high in zip(displacements(stroke), edges[:-1], edges[1:], strict=True):
        for phi in np.linspace(low, high, 7).tolist():
            assert form(phi) == pytest.approx(float(exact.displacement(phi)), abs=1e-12 * stroke.stroke_mm)
            assert form.deriv()(phi) == pytest.approx(float(exact.displacement(phi, 1)), abs=1e-12 * stroke.stroke_mm)


@at_once(("known", "free"), list(permutations(FIELDS, 2)))
@at_once("name", ["baler", "at law speed"])
def test_what_was_solved_for_gives_back_what_was_given(name: str, known: str, free: str) -> None:
    """Solve for one quantity, feed it back, solve for another: the other comes out as it was."""
    whole = solved_stroke(REQUESTS[name])
    complete = replace(REQUESTS[name], **{field: getattr(whole, field) for field in FIELDS})
    there = solved_stroke(replace(complete, **{known: None}))
    back = solved_stroke(replace(complete, **{known: getattr(there, known), free: None}))
    # a1 moves the stroke least, by a fourteenth of it: rounding errors of the stroke are 14 times larger in a1
    assert getattr(back, free) == pytest.approx(getattr(whole, free), rel=1e-13)


def test_a_different_stroke_gives_a_different_speed() -> None:
    """At a fixed a1 per radian the rest of the stroke is inversely proportional to the law speed."""
    brake = 1500.0 / (20.0 * RPM) ** 2 * (0.3 * pi) ** 2 / 12.0
    speeds = [solved_stroke(replace(BALER, stroke_mm=stroke)).law_speed_rad_s for stroke in (760.0, 500.0)]
    assert speeds[0] / speeds[1] == pytest.approx((500.0 - brake) / (760.0 - brake), rel=1e-14)


def test_v1_is_the_speed_at_theta1_even_where_v2_is_over_it() -> None:
    """As its key says: solved for, v1 need not be the largest speed; at theta1 there is no acceleration."""
    stroke = solved_stroke(replace(BALER, v1=None, law_speed_rad_s=5.53, v2=1300.0))
    speed = displacements(stroke)[0].deriv() * stroke.law_speed_rad_s
    assert stroke.v1 < stroke.v2
    assert speed(BALER.theta1_rad) == pytest.approx(stroke.v1, rel=1e-12)
    assert speed.deriv()(BALER.theta1_rad) == pytest.approx(0.0, abs=1e-9 * stroke.v1)
    described = ThreeSegmentStroke.model_fields["v1_mm_s"].description or ""
    assert "slider speed v1 at theta1" in described
    assert "largest" not in described


# --- refusals ------------------------------------------------------------------------------------------------------


def refusal(request: StrokeRequest) -> NoSuchMechanism:
    """The error that solving raises."""
    with pytest.raises(NoSuchMechanism) as caught:
        solved_stroke(request)
    return caught.value


def approach_velocity(t1: float, t2: float, v1: float, v2: float) -> Polynomial:
    """The approach's velocity from its five conditions, as linear equations in powers of phi1 / theta2."""
    u = t1 / t2
    powers = np.arange(5)

    def row(at: float, order: int) -> np.ndarray:
        return at**powers if order == 0 else powers * at ** np.maximum(powers - 1, 0)

    rows = np.array([row(0.0, 0), row(u, 0), row(u, 1), row(1.0, 0), row(1.0, 1)])
    return Polynomial(np.linalg.solve(rows, [0.0, v1, 0.0, v2, 0.0]))(Polynomial([0.0, 1.0 / t2]))


def reverses(t1: float, t2: float, v1: float, v2: float) -> float:
    """Least of velocity / angle over the approach, sampled: negative where the slider runs backwards."""
    phi = np.linspace(t2 / 4000.0, t2, 4000)
    velocity = approach_velocity(t1, t2, v1, v2)
    return float(min((velocity(phi) / phi).min(), velocity.deriv()(0.0)))


OPEN = replace(BALER, law_speed_rad_s=5.0, stroke_mm=None)
"""The stroke is what comes out, so that every law closes."""


def test_v2_just_too_small_against_v1() -> None:
    """Early theta1: the velocity starts backwards unless v2 exceeds a share of v1, found here by bisection."""
    t1, t2, v1 = 0.55 * pi, 0.7 * pi, 1600.0
    low, high = 1e-3 * v1, v1
    assert reverses(t1, t2, v1, low) < 0.0 < reverses(t1, t2, v1, high)
    for _ in range(40):
        middle = (low + high) / 2.0
        low, high = (low, middle) if reverses(t1, t2, v1, middle) > 0.0 else (middle, high)
    solved_stroke(replace(OPEN, theta1_rad=t1, v2=high * (1.0 + 1e-6)))
    fault = refusal(replace(OPEN, theta1_rad=t1, v2=low * (1.0 - 1e-4)))
    assert fault.key == "motion.v1_mm_s"
    phi = np.linspace(1e-4, t2, 4001)
    backwards = phi[approach_velocity(t1, t2, v1, low * (1.0 - 1e-2))(phi) <= 0.0]
    assert backwards.min() - 0.05 <= stated_angle(fault) <= backwards.max() + 0.05


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(st.floats(0.05, 0.9), st.floats(0.5, 3.0), st.floats(0.02, 3.0))
def test_refused_exactly_where_the_velocity_turns_negative(share: float, t2: float, against: float) -> None:
    t1, v1 = share * t2, 1000.0
    least = reverses(t1, t2, v1, against * v1)
    request = replace(
        OPEN, theta1_rad=t1, theta2_rad=t2, theta3_rad=t2 + 0.3, theta4_rad=t2 + 1.0, v1=v1, v2=against * v1
    )
    if abs(least) < 1e-3 * v1:
        return  # sampling cannot decide
    if least > 0.0:
        assert_conditions(request, solved_stroke(request))
        return
    fault = refusal(request)
    phi = np.linspace(0.0, t2, 4001)[1:]
    backwards = phi[approach_velocity(t1, t2, v1, against * v1)(phi) < 0.0]
    # The message gives the first zero to six digits; the samples are a 4000th of theta2 apart
    first = 0.0 if backwards[0] == phi[0] else float(backwards[0])
    assert stated_angle(fault) == pytest.approx(first, abs=2.0 * t2 / 4000.0)
    assert fault.key == "motion.v1_mm_s"
    assert fault.exit_status == 3


@pytest.mark.parametrize("a1", [0.0, 1.0, 1500.0])
def test_an_end_that_does_not_brake_is_refused(a1: float) -> None:
    fault = refusal(replace(OPEN, a1=a1))
    assert fault.key == "motion.a1_mm_s2"
    assert stated_angle(fault) == pytest.approx(1.3 * pi, rel=1e-5)


def steepest_a1() -> float:
    """The braking term alone, -a1 delta^2 / (12 omega^2), covers the whole stroke of 760 mm."""
    return -760.0 * 12.0 * (20.0 * RPM) ** 2 / (0.3 * pi) ** 2


def test_a1_so_steep_that_nothing_is_left_of_the_stroke() -> None:
    assert solved_stroke(replace(BALER, a1=0.999 * steepest_a1())).law_speed_rad_s > 1000.0 * 5.53 * 0.9
    fault = refusal(replace(BALER, a1=1.001 * steepest_a1()))
    assert fault.key == "motion.solve_for"
    assert "no law speed closes" in fault.problem


@pytest.mark.parametrize("theta1", [1e-9, 1e-6 * pi, 0.05 * pi])
def test_an_approach_that_goes_backwards_is_refused_for_theta1(theta1: float) -> None:
    """Not for a1, which the missing law speed would suggest: v1 and v2 together cover less than nothing."""
    with pytest.raises(NoSuchMechanism, match="goes backwards altogether; theta1 lies too near 0") as caught:
        solved_stroke(replace(BALER, theta1_rad=theta1))
    assert caught.value.key == "motion.theta1_rad"


NO_V1 = StrokeRequest(0.25 * pi, 0.5 * pi, pi, 1.3 * pi, None, 140.0, -800.0, 30.0 * RPM, 120.0)
"""A pusher whose way at v2 and braking together are over its stroke."""

NO_V2 = replace(BALER, v2=None, law_speed_rad_s=5.0, a1=-30000.0)
"""A baler whose way up to v1 and braking together are over its stroke."""


@at_once(
    ("request_", "remedy", "eased"),
    [
        (NO_V1, "lower v2", {"v2": 130.0}),
        (NO_V1, "shorten the stretch at v2", {"theta3_rad": 0.9 * pi, "theta4_rad": 1.2 * pi}),
        (NO_V1, "bring a1 nearer to zero", {"a1": -500.0}),
        (NO_V1, "lengthen the stroke", {"stroke_mm": 130.0}),
        (
            replace(NO_V1, theta1_rad=0.4 * pi, v2=10.0),
            "theta1 lies too near 0 or theta2",
            {"theta1_rad": 0.2 * pi},
        ),
        (NO_V2, "lower v1", {"v1": 300.0}),
        (NO_V2, "bring a1 nearer to zero", {"a1": -1500.0}),
        (NO_V2, "lengthen the stroke", {"stroke_mm": 1600.0}),
    ],
)
def test_a_speed_that_would_be_negative_is_refused_with_what_helps(
    request_: StrokeRequest, remedy: str, eased: dict[str, float]
) -> None:
    """Each remedy that is named makes the same request close."""
    fault = refusal(request_)
    assert "closing the stroke needs v" in fault.problem
    assert remedy in fault.problem.partition(";")[2]
    solved_stroke(replace(request_, **eased))


def told(problem: str, words: str) -> float:
    return float(re.findall(rf"{words} (-?[\d.]+)", problem)[0])


STEEP = replace(BALER, v1=7000.0, v2=800.0)
NEAR_END = replace(BALER, theta1_rad=0.55 * pi, v1=2600.0)
NEAR_START = replace(BALER, theta1_rad=0.12 * pi, v1=1900.0)
SOLVED_V1 = replace(BALER, v1=None, v2=700.0, law_speed_rad_s=70.0 * RPM)


@pytest.mark.parametrize("request_", [STEEP, NEAR_END, NEAR_START])
def test_speeds_too_far_apart_are_refused_with_the_values_that_would_do(request_: StrokeRequest) -> None:
    """A hair inside what is named the slider advances; a hair outside it turns back."""
    fault = refusal(request_)
    assert fault.key in ("motion.v1_mm_s", "motion.theta1_rad")
    v1 = told(fault.problem, "v1 under")
    solved_stroke(replace(request_, v1=v1 * (1.0 - 1e-4)))
    refusal(replace(request_, v1=v1 * (1.0 + 1e-4)))
    if "v2 over" in fault.problem:
        v2 = told(fault.problem, "v2 over")
        solved_stroke(replace(request_, v2=v2 * (1.0 + 1e-4)))
        refusal(replace(request_, v2=v2 * (1.0 - 1e-4)))
    for words in ("theta1 from", "theta1 from [\\d.]+ to"):
        solved_stroke(replace(request_, theta1_rad=told(fault.problem, words) * pi))


def test_a_v1_that_is_solved_for_is_named_with_what_would_do() -> None:
    fault = refusal(SOLVED_V1)
    assert fault.key == "motion.v1_mm_s"
    needed, most = told(fault.problem, "closing the stroke needs v1 ="), told(fault.problem, "v1 under")
    given = replace(SOLVED_V1, law_speed_rad_s=None, v1=most * (1.0 - 1e-4))
    assert needed > most
    assert solved_stroke(given).v1 < most
    low, high = told(fault.problem, "law speed over"), told(fault.problem, "law speed over [\\d.]+ and under")
    for speed, stays in ((0.999 * low, False), (1.001 * low, True), (0.999 * high, True), (1.001 * high, False)):
        tried = replace(SOLVED_V1, law_speed_rad_s=speed * RPM)
        if stays:
            assert 0.0 < solved_stroke(tried).v1 < most
        else:
            refusal(tried)


def test_no_law_speed_is_named_between_two_that_are_shown_alike() -> None:
    """With a vanishing v2 there is one speed alone at which v1 is above zero and small enough."""
    angles, at_law_speed = (0.4 * pi, 0.5 * pi, pi, 1.3 * pi), None
    vanishing = StrokeRequest(*angles, None, 1e-300, -800.0, 30.0 * RPM, 120.0, at_law_speed)
    assert "law speed" not in refusal(vanishing).problem
    assert "law speed over" in refusal(SOLVED_V1).problem


def test_a_v2_that_is_solved_for_is_named_with_what_would_do() -> None:
    request = replace(BALER, v2=None, v1=2300.0, law_speed_rad_s=48.0 * RPM)
    fault = refusal(request)
    assert fault.key == "motion.v2_mm_s"
    assert 0.0 < told(fault.problem, "closing the stroke needs v2 =") < told(fault.problem, "; over")
    least = told(fault.problem, "law speed over")
    assert solved_stroke(replace(request, law_speed_rad_s=1.001 * least * RPM)).v2 > told(fault.problem, "; over")
    refusal(replace(request, law_speed_rad_s=0.999 * least * RPM))


def test_a1_that_accelerates_leaves_no_law_speed_in_the_other_reading() -> None:
    """The quadratic in 1/omega has no real root beyond some positive a1."""
    assert refusal(replace(AT_LAW_SPEED, a1=1e5)).key == "motion.solve_for"


@pytest.mark.slow
@settings(max_examples=50, deadline=None)
@given(st.floats(-1e6, -1e-3), st.floats(1.0, 5000.0), st.floats(0.05, 3.0))
def test_braking_alone_never_reverses_the_slider(a1: float, v2: float, delta: float) -> None:
    """v / delta = -a1 (1 - u)^2 + (v2 / delta) u (3 - 2 u) has no negative term: no a1 is too steep."""
    request = replace(OPEN, theta4_rad=pi + delta, v1=v2, v2=v2, a1=a1)
    stroke = solved_stroke(request)
    u = np.linspace(0.0, 1.0, 201)
    assert np.all(Polynomial(stroke.braking_slope)(u * delta) > 0.0)


@pytest.mark.parametrize(
    ("free", "changed", "key"),
    [
        ("v1", {"stroke_mm": 300.0}, "motion.v1_mm_s"),
        ("v2", {"stroke_mm": 100.0}, "motion.v2_mm_s"),
        ("a1", {"stroke_mm": 500.0}, "motion.a1_mm_s2"),
    ],
)
def test_closing_values_of_the_wrong_sign_are_refused(free: str, changed: dict[str, Any], key: str) -> None:
    fault = refusal(replace(BALER, law_speed_rad_s=5.53, **{**changed, free: None}))
    assert fault.key == key
    assert 0.0 < stated_angle(fault) <= 1.3 * pi + 1e-5
