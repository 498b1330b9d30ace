"""No feature of a formula hides between samples: forms, laws and resistances with narrow ones, and what is refused.

Judges are closed forms, and quadrature that is told where the feature is.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from math import atan, erf, exp, log, pi, sqrt, tanh

import numpy as np
import pytest
from mpmath import mp

from at_once import at_once
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.kinematics.check import kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import FormulaResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.discs import DISC_FUNCTIONS, Disc
from ncgear.numerics.formula import FUNCTIONS, composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.proven import proven
from ncgear.numerics.units import in_words
from ncgear.pitch.pair import refuse_corners
from ncgear.ratio.laws.expression import driven_angle_expression_law, ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission

TIMES = int(os.environ.get("NCGEAR_FUZZ", "1"))

PUMP = CrankSlider(40.0, 150.0)
EACH_TURN = 2.0 * pi


@dataclass(frozen=True)
class Shape:
    """A narrow feature by u = (x - at)/width: its text, and its integral from far left to u."""

    text: str
    integral: Callable[[float], float]


SHAPES = {
    "bell": Shape("exp(-({u})**2)", lambda u: sqrt(pi) / 2.0 * (1.0 + erf(u))),
    "pole": Shape("1/(1 + ({u})**2)", lambda u: pi / 2.0 + atan(u)),
    "hyperbolic": Shape("1/cosh({u})**2", lambda u: 1.0 + tanh(u)),
    "step": Shape("tanh({u})", lambda u: abs(u) + log1p_exp(-2.0 * abs(u))),
    "logistic": Shape("1/(1 + exp(-({u})))", lambda u: max(u, 0.0) + log1p_exp(-abs(u))),
}


def log1p_exp(u: float) -> float:
    return log(1.0 + exp(u))


def formula_of(shape: str, at: float, width: float) -> str:
    return f"1 + 0.3*{SHAPES[shape].text.format(u=f'(x - {at!r})/{width!r}')}"


def integral_of(shape: str, at: float, width: float, end: float) -> float:
    over = SHAPES[shape].integral
    return end + 0.3 * width * (over((end - at) / width) - over(-at / width))


def widths(count: int, number: int) -> list[tuple[str, float, float]]:
    """Shapes with random places and widths from 1e-5 to 1."""
    random = np.random.default_rng(number)
    shapes = random.choice(list(SHAPES), count).tolist()
    return list(
        zip(
            shapes,
            random.uniform(0.3, 6.0, count).tolist(),
            (10.0 ** random.uniform(-5, 0, count)).tolist(),
            strict=True,
        )
    )


def worst_integral(form_of: Callable[[str], PiecewiseChebyshev], cases: list[tuple[str, float, float]]) -> float:
    """Largest error of integrals over a turn, at five ends."""
    errors = []
    for shape, at, width in cases:
        integral = form_of(formula_of(shape, at, width)).integrated()
        for end in (0.5, 2.0, at, min(at + width, 6.2), EACH_TURN):
            errors.append(abs(float(integral(np.array([end]))[0]) - integral_of(shape, at, width, end)))
    return max(errors)


def resolved(text: str) -> PiecewiseChebyshev:
    return proven(composed(text, "k", "x"), 0.0, EACH_TURN)


@pytest.mark.slow
def test_narrow_features_are_integrated() -> None:
    # Closed forms lose digits as a whole turn over the width does, and the argument (x - at)/width as well.
    assert worst_integral(resolved, widths(10, 1)) <= 1e-12


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.attack
def test_many_narrow_features_are_integrated() -> None:
    assert worst_integral(resolved, widths(200 * TIMES, 2)) <= 1e-12


def test_a_fit_to_samples_alone_misses_them() -> None:
    """Without the proof the same forms fail the same judge."""

    def sampled(text: str) -> PiecewiseChebyshev:
        return chebyshev.fitted(composed(text, "k", "x").values, np.array([0.0, EACH_TURN]))

    assert worst_integral(sampled, widths(10, 1)) > 1e-4


def test_a_smooth_formula_gets_no_more_panels_than_its_samples_ask_for() -> None:
    for text in ("2 + 0.5*cos(x) + 0.1*sin(2*x)", "exp(2.3*cos(x))", "1 + 0.01/(1.001 - cos(x - 1))", "sqrt(1 + x)"):
        sampled = chebyshev.fitted(composed(text, "k", "x").values, np.array([0.0, EACH_TURN]))
        assert resolved(text).breaks.size <= sampled.breaks.size


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "near"),
    [
        ("1/(x - 1.25)", 1.25),
        ("1 + 0.1*sqrt(x**2 - 4*x + 4)", 2.0),
        ("1 + 0.01*sin(1/(x - 2.0001))", 2.0001),
        ("1 + 0.3*exp(-((x - 3.1)/1e-9)**2)", 3.1),
        ("1 + 0.1*sin(900000*x)", None),
    ],
)
def test_what_cannot_be_resolved_is_refused_where_it_is(text: str, near: float | None) -> None:
    with pytest.raises(NotSmooth) as caught:
        resolved(text)
    assert near is None or caught.value.at == pytest.approx(near, abs=1e-3)


# --- discs -----------------------------------------------------------------------------------------------------------

COMPLEX = {name: getattr(mp, name) for name in FUNCTIONS} | {"power": mp.power}


@pytest.mark.parametrize("name", COMPLEX)
def test_a_disc_holds_every_image(name: str) -> None:
    """Points of the complex disc and its rim, by mpmath; discs that hold a pole or a branch point tell nothing."""
    random = np.random.default_rng(3)
    center, radius = random.uniform(-4.0, 4.0, 60), 10.0 ** random.uniform(-3.0, 0.5, 60)
    exponents = [2.0, 3.0, -1.0, -2.0, 0.5, 1.5, -0.3] if name == "power" else [None]
    found = 0
    for exponent in exponents:
        given = () if exponent is None else (exponent,)
        with np.errstate(all="ignore"):
            image = DISC_FUNCTIONS[name](Disc.about(center, radius, real=False), *given)
        for k in np.nonzero(np.isfinite(image.radius))[0]:
            found += 1
            for angle in np.linspace(0.0, pi, 4):
                for share in (0.5, 1.0):
                    point = mp.mpc(center[k] + share * radius[k] * np.cos(angle), share * radius[k] * np.sin(angle))
                    away = abs(COMPLEX[name](point, *given) - mp.mpf(float(image.center[k])))
                    assert away <= image.radius[k] * (1.0 + 1e-9) + 1e-12 * (1.0 + abs(image.center[k]))
    assert found >= 15


def test_a_disc_about_a_pole_tells_nothing() -> None:
    for text in ("1/x", "log(x)", "sqrt(x)", "x**-2", "x**1.5", "tan(x + 1.5707963267948966)", "atan(1/x)"):
        assert np.isinf(composed(text, "k", "x").spread(np.array([0.1]), np.array([0.2]), real=False))[0], text


# --- laws ------------------------------------------------------------------------------------------------------------


DENTS = [(1.7321, 0.03), (4.4001, 0.004), (2.71828, 0.0007)]


def dented(at: float, width: float) -> str:
    return f"1 - 0.4*exp(-((phi - {at})/{width})**2)"


@pytest.mark.slow
@pytest.mark.parametrize(("at", "width"), DENTS)
def test_a_ratio_with_a_dent_is_integrated(at: float, width: float) -> None:
    """The driven angle by quadrature with its break points at the dent."""
    law = ratio_expression_law(dented(at, width), Lobes(), scale_to_close=True)
    ends = [0.5, at - width, at, at + 2.0 * width, 6.0, EACH_TURN]
    cuts = [0.0, *(at + k * width for k in (-30, -8, -4, -2, -1, 1, 2, 4, 8, 30))]

    def slope(x: mp.mpf) -> mp.mpf:
        return 1 / (1 - mp.mpf(0.4) * mp.exp(-(((x - mp.mpf(at)) / mp.mpf(width)) ** 2)))

    with mp.workdps(20):
        turned = [float(mp.quad(slope, [*(cut for cut in cuts if 0.0 <= cut < end), end])) for end in ends]
    exact = EACH_TURN * np.array(turned) / turned[-1]
    assert law.driven_angle(np.array(ends[:-1])).value == pytest.approx(exact[:-1], abs=1e-12)
    assert abs(law.closure_error_rad) <= 1e-12


@pytest.mark.slow
@pytest.mark.parametrize(("at", "width"), DENTS)
def test_the_peak_of_acceleration_is_in_the_dent(at: float, width: float) -> None:
    law = ratio_expression_law(dented(at, width), Lobes(), scale_to_close=True)
    check = kinematic_check(Machine(law, PUMP, SliderLoad(), EACH_TURN))
    u = np.linspace(-5.0, 5.0, 40001)
    bell = np.exp(-(u**2))
    ratio, bend = 1.0 - 0.4 * bell, 0.8 * u * bell / width
    factor = float(law.driven_angle(np.zeros(1), 1).derivative(1)[0])
    slide = PUMP.displacement(Jet.variable(law.driven_angle(at + width * u).value, 2))
    speed, slowing = factor / ratio, -factor * bend / ratio**2
    acceleration = slide.derivative(2) * speed**2 + slide.derivative(1) * slowing
    assert check.peak_acceleration_cycle.value == pytest.approx(EACH_TURN**2 * np.abs(acceleration).max(), rel=1e-6)


def test_a_driven_angle_with_a_narrow_step() -> None:
    """Its slope is known; the extremes of the ratio are at the middle of both steps."""
    step = "0.002*tanh((phi - 2.2)/0.005)"
    law = driven_angle_expression_law(f"phi + {step} - 0.002*tanh((phi - 4.1)/0.005)*1", Lobes())
    assert 1.0 / law.ratio_range[0].value == pytest.approx(1.4, rel=1e-6)
    assert 1.0 / law.ratio_range[1].value == pytest.approx(0.6, rel=1e-6)


def test_the_closure_is_measured_at_points_that_the_law_does_not_use() -> None:
    """A law whose form has missed a dent says that it does not close."""
    whole = ratio_expression_law("1 + 0*phi", Lobes(), scale_to_close=True)
    dent = composed(dented(2.2, 0.02), "k", "phi").reciprocal()
    piece = whole.pieces[0]

    def driven_angle(phi1: Array, order: int) -> Jet:
        values = piece.driven_angle(phi1, 0).value
        return dent(Jet.variable(phi1, order - 1)).integrated(values) if order else Jet(values[None, :])

    missed = Transmission((Piece(0.0, EACH_TURN, driven_angle, (2.0, 2.1, 2.2, 2.3, 2.4)),), Lobes())
    assert missed.closure_error_rad == pytest.approx(0.0193, rel=0.1)


SMOOTH_ENOUGH = {
    "2 + 0.3*sin(phi)*abs(sin(phi))": [0.0, pi, EACH_TURN],
    "1 + max(0, sin(phi) - 0.5)**2": [0.0, pi / 6.0, 5.0 * pi / 6.0, EACH_TURN],
    "2 + 0.2*(sin(phi)**6)**0.5*sign(phi - 1)*sign(phi - 1)": [0.0, 1.0, pi, EACH_TURN],
    "2 + 0.1*sin(phi)**3 if phi < pi else 2": [0.0, pi, EACH_TURN],
}


@at_once("text", SMOOTH_ENOUGH)
def test_a_law_of_several_expressions_has_joints_between_them(text: str) -> None:
    """Each piece goes smoothly on to its own ends, and the ratio is the formula's."""
    law = ratio_expression_law(text, Lobes(), scale_to_close=True)
    starts = [piece.start_rad for piece in law.pieces]
    assert set(SMOOTH_ENOUGH[text]) >= {float(f"{start:.12g}") for start in starts} or starts == pytest.approx(
        SMOOTH_ENOUGH[text][:-1], abs=1e-9
    )
    points = np.linspace(0.1, 6.2, 60)
    ratio = 1.0 / law.driven_angle(points, 1).derivative(1)
    plain = {"abs": abs, "max": max, "sign": np.sign, "sin": np.sin, "pi": pi}
    written = np.array([eval(text, plain | {"phi": float(point)}) for point in points])
    assert ratio / written == pytest.approx(np.full(60, ratio[0] / written[0]), rel=1e-13)


CORNERED_RATIOS = {
    "1 + 0.03*phi*(2*pi - phi)": 0.0,
    "2 + 0.1*abs(cos(phi))": pi / 2.0,
    "2 + 0.1*sqrt(sin(phi - 1)**2)": 1.0,
    "2 + (cos(phi)**4)**0.25": pi / 2.0,
    "max(2, 2 + sin(phi))": 0.0,
    "1.5 if 1 < phi else 1.5 + (phi - 1)*0.1*phi": 0.0,
}


@pytest.mark.slow
@at_once("text", CORNERED_RATIOS)
def test_a_ratio_may_have_corners_and_gears_may_not(text: str) -> None:
    """The driven angle by quadrature that is told of the corners; gears are refused at the first of them."""
    law = ratio_expression_law(text, Lobes(), scale_to_close=True)
    corners = {1.0, 1.0 + pi, pi / 2.0, pi, 1.5 * pi}
    names = {name: getattr(mp, name) for name in ("sin", "cos", "sqrt", "pi")} | {"abs": abs, "max": max}

    def slope(phi: mp.mpf) -> mp.mpf:
        return 1 / mp.mpf(eval(text, names | {"phi": phi}))

    def turned(end: float) -> float:
        return float(mp.quad(slope, sorted({0.0, end} | {corner for corner in corners if corner < end})))

    ends = [0.7, 2.0, 4.0, 6.0]
    exact = np.array([turned(end) for end in ends]) * EACH_TURN / turned(EACH_TURN)
    assert law.driven_angle(np.array(ends)).value == pytest.approx(exact, abs=1e-12)
    assert abs(law.closure_error_rad) <= 1e-12
    with pytest.raises(NoSuchMechanism, match="the pitch curves have a corner") as caught:
        refuse_corners(law)
    assert f"phi1 = {in_words(CORNERED_RATIOS[text])}" in caught.value.problem


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("2 + 0.1*sign(cos(phi))", "the ratio jumps at phi1 = 1.5708 rad"),
        ("2 + 0.1*sqrt(phi*(2*pi - phi))", "infinite slope"),
        ("2 + 0.1*abs(sin(700*phi))*sin(700*phi)", "near phi1"),
    ],
)
def test_ratios_that_jump_or_shake_are_refused(text: str, said: str) -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        ratio_expression_law(text, Lobes(), scale_to_close=True)
    assert said in caught.value.problem
    assert caught.value.key == "motion.ratio"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("phi + 0.1*abs(sin(phi))", "dphi2/dphi1 jumps"),
        ("phi if phi < 3 else phi + 0.01*(2*pi - phi)", "the driven angle jumps at phi1 = 3 rad"),
    ],
)
def test_driven_angles_that_jump_are_refused(text: str, said: str) -> None:
    with pytest.raises(NoSuchMechanism, match=re.escape(said)):
        driven_angle_expression_law(text, Lobes())


def test_a_driven_angle_with_a_kink_of_its_slope_has_no_gears() -> None:
    law = driven_angle_expression_law("phi + 0.01*max(0, (phi - 3)*(5 - phi))**2*(phi - 4)", Lobes())
    assert [piece.start_rad for piece in law.pieces] == pytest.approx([0.0, 3.0, 5.0])
    with pytest.raises(NoSuchMechanism, match=r"a corner of 2\.\d* deg at phi1 = 3 rad"):
        refuse_corners(law)


@pytest.mark.slow
def test_a_steep_step_gives_finite_numbers_everywhere() -> None:
    """exp(2u) of 800 overflows, its quotient does not."""
    for step in ("tanh((phi - {})/0.002)", "1/(1 + exp(-(phi - {})/0.001))", "-1/cosh((phi - {})/0.003)**2"):
        law = ratio_expression_law(f"2 + 0.1*{step.format(2)} - 0.1*{step.format(4)}", Lobes(), scale_to_close=True)
        assert np.isfinite(law.driven_angle(np.linspace(0.0, EACH_TURN, 1001), 4).coefficients).all()


# --- resistances -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("at", "width"), [(22.2, 0.02), (51.5, 0.003), (12.34, 0.4)])
def test_a_narrow_peak_of_resistance_counts(at: float, width: float) -> None:
    """Work by its closed form, the peak of power by samples in the peak."""
    force = FormulaResistance(f"150 + 900*exp(-((x - {at})/{width})**2)")
    stroke = PUMP.stroke_mm
    work = float(force.work_n_mm(np.array([stroke]), stroke)[0])
    exact = 150.0 * stroke + 900.0 * width * sqrt(pi) / 2.0 * (erf((stroke - at) / width) + erf(at / width))
    assert work == pytest.approx(exact, rel=1e-13)
    machine = Machine(uniform_law(Lobes()), PUMP, SliderLoad(force), EACH_TURN)
    crank = PUMP.crank_angle(at + width * np.linspace(-1.0, 1.0, 20001), np.zeros(20001, dtype=bool))
    assert kinematic_check(machine).peak_power_w.value == pytest.approx(machine.motion(crank).power_w.max(), rel=1e-7)


CORNERED = {
    "abs(x - 30) + 20": [30.0],
    "max(0, 12*(x - 33.3))": [33.3],
    "min(500, 20*x) if x < 70 else 500": [25.0, 70.0],
    "max(min(900, 30*x), 5*x)": [30.0],
    "100 if x < 40 else 100 + 3*(x - 40)": [40.0],
    "sqrt((x - 44)**2)": [44.0],
    "sign(x - 41)*(x - 41)**3": [41.0],
}


@at_once("text", CORNERED)
def test_a_resistance_may_have_corners(text: str) -> None:
    force = FormulaResistance(text)
    stroke = PUMP.stroke_mm
    for corner in CORNERED[text]:
        assert np.abs(force.turns_mm(stroke) - corner).min(initial=np.inf) <= 1e-9 or "70" in text
    edges = np.array([0.0, *CORNERED[text], stroke])
    x, weight = np.polynomial.legendre.leggauss(8)
    points = (edges[:-1, None] + edges[1:, None]) / 2.0 + np.diff(edges)[:, None] / 2.0 * x
    plain = {"abs": abs, "max": max, "min": min, "sign": np.sign, "sqrt": sqrt}
    values = np.array([eval(text, plain | {"x": float(place)}) for place in points.ravel()])
    exact = float(np.sum(values.reshape(points.shape) * weight * np.diff(edges)[:, None] / 2.0))
    assert float(force.work_from_retracted_n_mm(np.array([stroke]), stroke)[0]) == pytest.approx(exact, rel=1e-12)


@at_once(
    ("text", "said"),
    [
        ("100 if x < 41 else 130", "jumps from 100 to 130 N at x = 41 mm"),
        ("100 + 20*sign(x - 12)", "jumps from 80 to 120 N at x = 12 mm"),
        ("300 + 40*sin(450*x)", "faster than can be followed"),
        ("300 + 40*sin(25*x)", "turns up or down 637 times over the stroke of 80 mm"),
        ("abs(sin(300*x))", "faster than can be followed"),
        ("200/(x - 20)", "no smooth function near x = 20 mm"),
    ],
)
def test_resistances_that_jump_or_shake_are_refused(text: str, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        FormulaResistance(text).turns_mm(PUMP.stroke_mm)
    assert said in caught.value.problem
    assert caught.value.key == "resistance.expression_n"
