"""The return period: end conditions, closure, the published polynomial against mpmath, and that least means least."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest
from mpmath import mp
from numpy.polynomial import Polynomial
from scipy.integrate import cumulative_simpson

from at_once import at_once
from commands import stated_angle
from ncgear.errors import NoSuchMechanism
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.return_stroke import ReturnEnds, ReturnLaw, return_of_least_acceleration, return_with_constant
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import StrokeRequest, solved_stroke
from oracles import stroke as oracle
from published import BALER_LINKAGE, OFFSET
from test_stroke import AT_LAW_SPEED, BALER

LINKAGES = {"baler": BALER_LINKAGE, "offset": OFFSET}
SPEED = 20.0 * pi / 30.0
"""The paper's 20 r/min, in rad/s."""


@cache
def exact_stroke(name: str) -> oracle.Stroke:
    """The oracle's working stroke on the same float64 angles."""
    linkage = LINKAGES[name]
    lengths = linkage.crank_mm, linkage.rod_mm, linkage.offset_mm
    return oracle.Stroke(
        oracle.StrokeParameters(0.4 * pi, 0.7 * pi, pi, 1.3 * pi, 1600.0, 1100.0, -1500.0, *lengths, SPEED)
    )


@cache
def ends_of(name: str) -> ReturnEnds:
    """What the return must join, from the oracle."""
    exact = exact_stroke(name)
    theta4 = 1.3 * pi
    return ReturnEnds(
        start_rad=theta4,
        end_rad=2.0 * pi,
        start_driven_rad=float(exact.linkage.working_angle()),
        end_driven_rad=2.0 * pi,
        start_ratio=float(exact.ratio(theta4)),
        start_ratio_slope=float(exact.ratio_slope_at_dead_centre(True)),
        end_ratio=float(exact.ratio(0)),
        end_ratio_slope=float(exact.ratio_slope_at_dead_centre(False)),
    )


@cache
def law_of(name: str, kind: str) -> ReturnLaw:
    """A return of each kind: the constant or least acceleration, as text, in one of the bases."""
    ends, linkage = ends_of(name), LINKAGES[name]
    if kind.startswith("least"):
        return return_of_least_acceleration(ends, linkage, inverse=kind == "least inverse")
    constant, _, basis = kind.partition(" ")
    return return_with_constant(ends, float(constant), inverse=basis == "inverse")


KINDS = ["0", "1", "-2", "least", "least inverse", "1.5 inverse"]
every_return = at_once(("name", "kind"), [(name, kind) for name in LINKAGES for kind in KINDS])


@pytest.mark.slow
@every_return
def test_value_and_slope_of_the_ratio_join_the_working_stroke(name: str, kind: str) -> None:
    ends = ends_of(name)
    series = law_of(name, kind).slope(np.array([ends.start_rad, ends.end_rad]), 1)
    ratio, ratio_slope = 1.0 / series.value, -series.derivative(1) / series.value**2
    # tau = (phi1 - start) / length and a quintic of coefficients up to some hundreds
    assert ratio == pytest.approx([ends.start_ratio, ends.end_ratio], rel=1e-12)
    assert ratio_slope == pytest.approx([ends.start_ratio_slope, ends.end_ratio_slope], abs=1e-10)


@pytest.mark.judges("ratio")
@pytest.mark.tiers(quick=["baler"], rest="slow")
@pytest.mark.parametrize("name", LINKAGES)
@at_once("kind", KINDS)
def test_the_driven_angle_closes_by_exact_quadrature(name: str, kind: str) -> None:
    law, ends = law_of(name, kind), ends_of(name)
    assert abs(law.closure_error_rad) <= 1e-12  # the closure promised
    with mp.workdps(30):
        descending = [mp.mpf(float(c)) for c in law.polynomial.coef[::-1]]
        integrand = (lambda t: mp.polyval(descending, t)) if law.inverse else (lambda t: 1 / mp.polyval(descending, t))
        covered = mp.quad(integrand, mp.linspace(0, 1, 9), method="gauss-legendre") * (
            mp.mpf(ends.end_rad) - mp.mpf(ends.start_rad)
        )
        assert abs(covered - (mp.mpf(ends.end_driven_rad) - mp.mpf(ends.start_driven_rad))) <= 1e-12


@every_return
def test_the_polynomial_has_degree_five_in_its_basis(name: str, kind: str) -> None:
    law = law_of(name, kind)
    assert law.polynomial.degree() <= 5
    assert law.inverse == kind.endswith("inverse")


@every_return
def test_driven_angle_is_the_integral_of_its_slope(name: str, kind: str) -> None:
    law, ends = law_of(name, kind), ends_of(name)
    phi1 = np.linspace(ends.start_rad, ends.end_rad, 4001)
    series = law.driven_angle(phi1, 1)
    integral = cumulative_simpson(series.derivative(1), x=phi1, initial=0.0)
    # Simpson's error: (steps of 5e-4)^4 times a fourth derivative of the slope up to some 1e4
    assert np.max(np.abs(series.value - ends.start_driven_rad - integral)) <= 1e-9
    assert np.array_equal(law.driven_angle(phi1, 0).value, series.value)


@at_once("constant", [0.0, 1.0, -2.0, 3.5])
def test_the_constant_is_the_polynomial_extrapolated_to_zero(constant: float) -> None:
    law = return_with_constant(ends_of("baler"), constant)
    in_tau = Polynomial(law.polynomial.coef)(Polynomial([-law.ends.start_rad, 1.0]) / law.ends.length_rad)
    # Extrapolated by twice the return's length: coefficients grow by 3^5 and cancel
    assert law.extrapolated_ratio == pytest.approx(constant, abs=1e-10)
    assert in_tau.coef[0] == pytest.approx(constant, abs=1e-10)


@pytest.mark.tiers(slow=["offset-0"], rest="long")
@pytest.mark.parametrize(("name", "constant"), [("baler", "0"), ("offset", "0"), ("baler", "1")])
def test_the_published_return_against_mpmath(name: str, constant: str) -> None:
    law, exact = law_of(name, constant), exact_stroke(name).return_polynomial(constant)
    phi1 = np.linspace(law.ends.start_rad, law.ends.end_rad, 13)
    series = law.driven_angle(phi1, 1)
    for at, driven, slope in zip(phi1.tolist(), series.value.tolist(), series.derivative(1).tolist(), strict=True):
        # Fifth-degree coefficients follow from closure: some orders above rounding error, well below 1e-10
        assert driven == pytest.approx(float(exact.driven_angle(at)), abs=1e-10)
        assert 1.0 / slope == pytest.approx(float(exact.ratio(at)), abs=1e-10)


# --- least acceleration --------------------------------------------------------------------------------------------


def slider_bend(linkage: CrankSlider, phi2: Array, slope: Array, slope2: Array) -> Array:
    """d2x/dphi1^2 from the vector loop's own derivatives, by the chain rule."""
    angle = pi + np.arcsin(linkage.offset_mm / (linkage.rod_mm - linkage.crank_mm)) - phi2
    across = linkage.crank_mm * np.sin(angle) - linkage.offset_mm
    rod = np.sqrt(linkage.rod_mm**2 - across**2)
    turn, turn2 = linkage.crank_mm * np.cos(angle), -linkage.crank_mm * np.sin(angle)
    first = -(turn2 - across * turn / rod)
    second = -turn - (turn**2 + across * turn2) / rod - (across * turn) ** 2 / rod**3
    return second * slope**2 + first * slope2


def dense_peak(law: ReturnLaw, linkage: CrankSlider, count: int = 4001) -> float:
    """Peak of |d2x/dphi1^2| over a dense sample, from the polynomial alone."""
    ends = law.ends
    tau = np.linspace(0.0, 1.0, count)
    value, bend = law.polynomial(tau), law.polynomial.deriv()(tau) / ends.length_rad
    slope, slope2 = (value, bend) if law.inverse else (1.0 / value, -bend / value**2)
    phi2 = ends.start_driven_rad + ends.length_rad * cumulative_simpson(slope, x=tau, initial=0.0)
    return float(np.max(np.abs(slider_bend(linkage, phi2, slope, slope2))))


def skewed(law: ReturnLaw, amount: float) -> ReturnLaw:
    """An inverse-basis return skewed further: tau^2 (1 - tau)^2 (2 tau - 1) is odd about the middle, so it closes."""
    bump = Polynomial([0.0, 1.0]) ** 2 * Polynomial([1.0, -1.0]) ** 2
    return replace(law, local=law.polynomial + amount * bump * Polynomial([-1.0, 2.0]))


def neighbours(law: ReturnLaw, step: float) -> list[ReturnLaw]:
    """The same family's members a step to both sides of a law."""
    if law.inverse:
        return [skewed(law, side * step) for side in (-1.0, 1.0)]
    return [return_with_constant(law.ends, law.extrapolated_ratio + side * step) for side in (-1.0, 1.0)]


# The minimum is sought on 129 Chebyshev points, 0.027 rad apart at most: the peak between two of them is missed by
# (0.027 / 2)^2 / 2 times the relative curvature, which is some tens here, and two neighbours may swap places by that.
ON_GRID = 1e-3

FARTHER = {"least": 100.0, "least inverse": 1.0}
"""Steps in e are large: it is extrapolated over twice the return's length."""


@at_once("kind", FARTHER)
@at_once("name", LINKAGES)
@at_once("step", [0.05, 0.2, 1.0, 3.0])
def test_no_neighbour_has_less_acceleration(name: str, kind: str, step: float) -> None:
    law, linkage = law_of(name, kind), LINKAGES[name]
    peak = dense_peak(law, linkage)
    others = [dense_peak(other, linkage) for other in neighbours(law, step * FARTHER[kind])]
    assert min(others) >= peak * (1.0 - ON_GRID)
    if step == 3.0:
        assert min(others) > peak * (1.0 + ON_GRID)  # the comparison does tell a worse law


@pytest.mark.slow
@pytest.mark.parametrize("kind", FARTHER)
@pytest.mark.parametrize("name", LINKAGES)
def test_the_best_of_a_scan_of_the_family_is_not_better(name: str, kind: str) -> None:
    law, linkage = law_of(name, kind), LINKAGES[name]
    peaks = []
    for step in np.linspace(0.0, 6.0, 25).tolist():
        try:
            peaks += [dense_peak(other, linkage, 2001) for other in neighbours(law, step * FARTHER[kind])]
        except NoSuchMechanism:
            continue
    assert len(peaks) > 10
    assert min(peaks) >= dense_peak(law, linkage) * (1.0 - ON_GRID)


@at_once("kind", ["least", "least inverse"])
@at_once("name", LINKAGES)
def test_least_acceleration_and_its_own_e_are_the_same_law(name: str, kind: str) -> None:
    law = law_of(name, kind)
    again = return_with_constant(law.ends, law.extrapolated_ratio, inverse=law.inverse)
    tau = np.linspace(0.0, 1.0, 101)
    # e is an extrapolation whose rounding, 1e-12, comes back damped
    assert np.max(np.abs(again.polynomial(tau) - law.polynomial(tau))) <= 1e-10


@at_once("kind", ["least", "least inverse"])
@at_once("name", LINKAGES)
def test_least_is_less_than_the_published_choice(name: str, kind: str) -> None:
    linkage = LINKAGES[name]
    assert dense_peak(law_of(name, kind), linkage) < (1.0 - ON_GRID) * dense_peak(law_of(name, "0"), linkage)


def test_headline_peak_over_the_cycle_with_e_zero() -> None:
    """About 7340 mm/s^2 at 20 r/min: three digits known independently."""
    assert dense_peak(law_of("baler", "0"), LINKAGES["baler"]) * SPEED**2 == pytest.approx(7340.0, rel=2e-3)


# --- the two readings, through the law ------------------------------------------------------------------------------


@cache
def reading(request: StrokeRequest) -> StrokeLaw:
    """The law with e = 0."""
    return stroke_law(solved_stroke(request), LINKAGES["baler"], Lobes(), constant=0.0)


@pytest.mark.tiers(slow=["a1 at 20 r/min"], rest="long")
@pytest.mark.parametrize(
    ("request_", "reference", "low", "high"),
    [(BALER, SPEED, (0.44, 0.005), (2.05, 0.005)), (AT_LAW_SPEED, None, (0.12, 0.005), (7.5, 0.2))],
    ids=["a1 at 20 r/min", "a1 at law speed"],
)
def test_ratio_range_of_both_readings(
    request_: StrokeRequest, reference: float | None, low: tuple[float, float], high: tuple[float, float]
) -> None:
    """Figures of two or three digits; the exact law at the extremes found, and on both sides of the turn."""
    least, most = reading(request_).transmission.ratio_range
    assert least.value == pytest.approx(low[0], abs=low[1])
    assert most.value == pytest.approx(high[0], abs=high[1])  # 7.65 in mpmath as well: 7.5 was read off a coarse sample
    exact = oracle.cycle(replace(exact_stroke("baler").parameters, a1_reference_speed=reference), "0")
    for extremum in (least, most):
        assert float(exact.ratio(extremum.at)) == pytest.approx(extremum.value, rel=1e-10)  # the return's coefficients
    ratios = [float(exact.ratio(at)) for at in np.linspace(0.0, 2.0 * pi - 1e-9, 101).tolist()]
    assert least.value * (1.0 - 1e-10) <= min(ratios)
    assert max(ratios) <= most.value * (1.0 + 1e-10)


def test_the_law_hands_over_the_ends_that_the_oracle_has() -> None:
    ours, exact = reading(BALER).return_law.ends, ends_of("baler")
    for field in ("start_rad", "end_rad", "start_driven_rad", "start_ratio", "start_ratio_slope", "end_ratio"):
        assert getattr(ours, field) == pytest.approx(getattr(exact, field), rel=1e-12, abs=1e-12), field


# --- refusals ------------------------------------------------------------------------------------------------------

LEVEL = ReturnEnds(4.0, 6.0, 3.0, 5.0, 1.0, 0.0, 1.0, 0.0)
"""A return that is a straight line: 2 rad of both gears, ratio 1."""


@pytest.mark.slow
@pytest.mark.parametrize("inverse", [False, True])
def test_level_ends_give_the_level_return(inverse: bool) -> None:
    linkage = CrankSlider(100.0, 400.0)
    law = return_of_least_acceleration(LEVEL, linkage, inverse=inverse)
    assert dense_peak(law, linkage) <= 100.0 * 1.5  # the uniform crank's own peak is 100 (1 + 1/4) or more
    assert return_with_constant(LEVEL, 1.0).polynomial.coef == pytest.approx([1.0] + [0.0] * 5, abs=1e-9)


def test_inverse_basis_refuses_a_return_that_would_turn_back() -> None:
    """1/i12 is 1 at both ends but 0.2 on average.

    An even quartic is 1 - 24 tau^2 (1 - tau)^2 then, -0.5 in the middle; skewing it only deepens one side.
    """
    short = replace(LEVEL, end_driven_rad=3.4)
    with pytest.raises(NoSuchMechanism) as caught:
        return_of_least_acceleration(short, CrankSlider(100.0, 400.0), inverse=True)
    assert caught.value.key == "motion.return"
    assert "zero or infinity" in caught.value.problem
    assert 4.0 < stated_angle(caught.value) < 6.0


@pytest.mark.slow
def test_the_same_ends_are_fine_in_the_ratio_basis() -> None:
    law = return_of_least_acceleration(replace(LEVEL, end_driven_rad=3.4), CrankSlider(100.0, 400.0), inverse=False)
    assert law.polynomial(np.linspace(0.0, 1.0, 101)).min() > 0.0
    assert abs(law.closure_error_rad) <= 1e-12


@pytest.mark.slow
@pytest.mark.parametrize(("constant", "covered"), [(20.0, 0.1), (20.0, 15.0), (0.0, 5.0)])
def test_closure_holds_however_far_the_driven_gear_must_turn(covered: float, constant: float) -> None:
    """Ratios far below and above 1, whose reciprocals have poles next to the real axis."""
    ends = replace(LEVEL, end_driven_rad=3.0 + covered)
    law = return_with_constant(ends, constant)
    with mp.workdps(30):
        descending = [mp.mpf(float(c)) for c in law.polynomial.coef[::-1]]
        exact = 2 * mp.quad(lambda t: 1 / mp.polyval(descending, t), mp.linspace(0, 1, 33))
        assert abs(exact - mp.mpf(ends.driven_length_rad)) <= 1e-12  # the closure promised


@pytest.mark.parametrize(("start_ratio", "towards"), [(1e4, "farther from"), (-0.5, "nearer to")])
def test_refusals_say_which_way_a1_must_go(start_ratio: float, towards: str) -> None:
    """The ratio at theta4 goes with 1/sqrt(-a1): far above the mean it must come down, below it go up."""
    with pytest.raises(NoSuchMechanism, match=f"must be 1 in the mean: an a1 {towards} zero"):
        return_with_constant(replace(LEVEL, start_ratio=start_ratio), 0.0)


@at_once("start_ratio", [2.0, 70.0, 90.0])
@at_once("shift", np.linspace(0.0, 1e-6, 5))
def test_closure_holds_to_rounding_where_coefficients_dwarf_the_ratio(start_ratio: float, shift: float) -> None:
    """From 90 down to a fortieth and back: coefficients of thousands, whose last digit is more than what closes."""
    ends = replace(LEVEL, start_ratio=start_ratio * (1.0 + shift), start_ratio_slope=10.0 * start_ratio)
    law = return_with_constant(ends, 0.0)
    assert abs(law.closure_error_rad) <= 1e-13
    assert law.extrapolated_ratio == pytest.approx(0.0, abs=1e-12 * start_ratio)


@pytest.mark.parametrize("changed", [{"start_ratio": -0.5}, {"end_ratio": 0.0}])
def test_ends_that_are_not_positive_are_refused(changed: dict[str, float]) -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        return_with_constant(replace(LEVEL, **changed), 0.0)
    assert caught.value.key == "motion.return"
    assert 4.0 <= stated_angle(caught.value) <= 6.0


def test_a_return_that_must_race_is_refused() -> None:
    """A million radians in two: the ratio would have to come within 1e-11 of zero."""
    with pytest.raises(NoSuchMechanism) as caught:
        return_with_constant(replace(LEVEL, end_driven_rad=1e6), 0.0)
    assert caught.value.key == "motion.return"
