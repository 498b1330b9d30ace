"""Every form of the resistance keeps one contract: derivatives, zeros, turns, work; then power and messages."""

from __future__ import annotations

from collections.abc import Callable
from math import erf, exp, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from at_once import at_once
from ncgear.design.keys.machine import NEAREST_MM
from ncgear.design.reading.design_file import load
from ncgear.errors import WrongInput
from ncgear.kinematics.check import kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.jet import Jet
from ncgear.project.drive import Drive
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from published import BALER_LINKAGE, FIT
from test_design_file import HEAD, loaded, refusal

STROKE = 760.0
AS_TEXT = "-131.2779 + 3.447*x + 1.846e-2*x**2 - 1.575e-4*x**3 + 2.498e-7*x**4"
CURVE = Jet.variable(np.linspace(0.0, 759.0, 12), 1)

FORMS: dict[str, Resistance] = {
    "polynomial": PolynomialResistance(FIT),
    "none": PolynomialResistance(),
    "constant": PolynomialResistance((400.0,)),
    "table": TableResistance((0.0, 100.0, 300.0, 310.0, 760.0), (-50.0, 80.0, -20.0, 900.0, 30.0)),
    "short table": TableResistance((200.0, 500.0), (-10.0, 1000.0)),
    "table with gaps": TableResistance((-9.0, 100.0, 200.0, 300.0, 900.0), (5.0, 0.0, 0.0, 0.0, 77.0)),
    "expression": FormulaResistance(AS_TEXT),
    "waves": FormulaResistance("1000*sin(x/40)*exp(-x/300) - 20"),
    "expression of nothing": FormulaResistance("0"),
}


@at_once("name", FORMS)
def test_slope_is_the_derivative(name: str) -> None:
    inside = np.linspace(1.0, 759.0, 57)
    step = 1e-4
    slope = FORMS[name].fitted_n(Jet.variable(inside, 1)).derivative(1)
    ends = [FORMS[name].fitted_n(Jet((inside + side)[None, :])).value for side in (step, -step)]
    # A central difference: step^2 times the third derivative, and rounding of 1e4 N over the step.
    assert slope == pytest.approx((ends[0] - ends[1]) / (2.0 * step), abs=2e-4)


@at_once("keep", [False, True])
@at_once("name", FORMS)
def test_work_is_the_integral_of_the_force(name: str, keep: bool) -> None:
    resistance = kept(FORMS[name], keep)
    cuts = np.concatenate([[0.0], resistance.zeros_mm(STROKE), resistance.turns_mm(STROKE), [STROKE]])
    for end in (55.0, 305.0, STROKE):
        inner = np.unique(np.append(cuts[cuts < end], end))
        parts = [quad(lambda x: float(resistance.force_n(np.array([x]))[0]), *pair)[0] for pair in pairs(inner)]
        work = float(resistance.work_n_mm(np.array([end]), STROKE)[0])
        assert work == pytest.approx(sum(parts), rel=1e-9, abs=1e-6)
    assert SliderLoad(resistance).cycle_work_n_mm(STROKE) == pytest.approx(work, rel=1e-15)


def kept(resistance: Resistance, keep: bool) -> Resistance:
    match resistance:
        case PolynomialResistance(coefficients_n=coefficients):
            return PolynomialResistance(coefficients, keep)
        case TableResistance(displacement_mm=points, at_points_n=forces):
            return TableResistance(points, forces, keep)
        case FormulaResistance(text=text):
            return FormulaResistance(text, keep)
    raise AssertionError(resistance)


def pairs(edges: np.ndarray) -> list[tuple[float, float]]:
    return list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))


@at_once("name", FORMS)
def test_zeros_and_turns_are_all_there(name: str) -> None:
    """Between two zeros no sample changes its sign, between two turns the samples rise or fall throughout."""
    resistance = FORMS[name]
    samples = np.linspace(0.0, STROKE, 20001)
    force = resistance.fitted_n(Jet(samples[None, :])).value
    zeros, turns = resistance.zeros_mm(STROKE), resistance.turns_mm(STROKE)
    assert np.all(np.abs(resistance.fitted_n(Jet(zeros[None, :])).value) <= 1e-9 * (1.0 + np.abs(force).max()))
    for low, high in pairs(np.concatenate([[0.0], zeros, [STROKE]])):
        inside = force[(samples > low + 1e-6) & (samples < high - 1e-6)]
        assert not (inside.max(initial=0.0) > 0.0 > inside.min(initial=0.0))
    for low, high in pairs(np.concatenate([[0.0], turns, [STROKE]])):
        steps = np.diff(force[(samples >= low) & (samples <= high)])
        noise = 1e-11 * (1.0 + np.abs(force).max())
        assert np.all(steps >= -noise) or np.all(steps <= noise)


def test_the_same_curve_in_two_forms() -> None:
    """The published fit as a polynomial and as an expression: zeros, work and peaks of the uniform crank."""
    one, other = FORMS["polynomial"], FORMS["expression"]
    assert other.zeros_mm(STROKE) == pytest.approx(one.zeros_mm(STROKE), rel=1e-12)
    assert other.turns_mm(STROKE) == pytest.approx(one.turns_mm(STROKE), rel=1e-10)
    assert other.negative_stretches_mm(STROKE)[0] == pytest.approx(one.negative_stretches_mm(STROKE)[0], rel=1e-12)
    figures = [
        kinematic_check(Machine(uniform_law(Lobes()), BALER_LINKAGE, SliderLoad(form), 2.0 * pi))
        for form in (one, other)
    ]
    assert figures[1].peak_power_w.value == pytest.approx(figures[0].peak_power_w.value, rel=1e-13)
    assert figures[1].mean_power_w == pytest.approx(figures[0].mean_power_w, rel=1e-12)


def test_a_table_goes_through_its_points_and_nowhere_beyond() -> None:
    table = FORMS["table"]
    assert isinstance(table, TableResistance)
    at_points = table.fitted_n(Jet(np.array(table.displacement_mm)[None, :])).value
    assert at_points == pytest.approx(table.at_points_n, rel=1e-15)
    between = table.fitted_n(Jet(np.linspace(300.0, 310.0, 99)[None, :])).value
    assert np.all((between >= -20.0) & (between <= 900.0))
    short = FORMS["short table"]
    assert short.fitted_n(Jet(np.array([[0.0, 199.0, 501.0, 760.0]]))).value.tolist() == [-10.0, -10.0, 1000.0, 1000.0]


def test_a_straight_table_is_the_straight_line() -> None:
    table = TableResistance((0.0, 300.0, 760.0), (0.0, 600.0, 1520.0))
    line = PolynomialResistance((0.0, 2.0))
    assert table.fitted_n(CURVE).coefficients == pytest.approx(line.fitted_n(CURVE).coefficients)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["table", "waves", "table with gaps"])
def test_peak_of_power_against_dense_samples(name: str) -> None:
    machine = Machine(uniform_law(Lobes()), BALER_LINKAGE, SliderLoad(FORMS[name]), 2.0 * pi)
    dense = machine.motion(np.linspace(0.0, 2.0 * pi, 400001)).power_w.max()
    # Samples miss a smooth peak by the square of their step; a peak of a hundredth of a turn is the sharpest here.
    assert dense <= kinematic_check(machine).peak_power_w.value <= dense * (1.0 + 1e-6)


def test_narrow_peaks_between_the_samples_are_found() -> None:
    """A force that is there for 0.1 mm only, a hundredth of the spacing at which extremes are looked for."""
    table = TableResistance((0.0, 400.0, 400.05, 400.1, 760.0), (0.0, 0.0, 1e4, 0.0, 0.0))
    machine = Machine(uniform_law(Lobes()), BALER_LINKAGE, SliderLoad(table), 2.0 * pi)
    at = float(BALER_LINKAGE.crank_angle(np.array([400.05]), np.array([False]))[0])
    exact = 1e4 * float(machine.displacement(np.array([at]), 1).derivative(1)[0]) * 2.0 * pi / 1000.0
    assert kinematic_check(machine).peak_power_w.value == pytest.approx(exact, rel=1e-6)


@pytest.mark.tiers(thorough=["611.07-40.0"], rest="slow")
@pytest.mark.parametrize("width_mm", [40.0, 1.0, 0.05, 3e-3])
@pytest.mark.parametrize("at_mm", [123.456, 611.07])
def test_narrow_peaks_of_an_expression_are_found(at_mm: float, width_mm: float) -> None:
    """Peak power and work of a bell of any width, against the closed form and scipy's search on the bell alone."""
    resistance = FormulaResistance(f"150 + 4e3*exp(-((x - {at_mm})/{width_mm})**2)")
    machine = Machine(uniform_law(Lobes()), BALER_LINKAGE, SliderLoad(resistance), 2.0 * pi)
    middle, side = (
        float(BALER_LINKAGE.crank_angle(np.array([x]), np.array([False]))[0]) for x in (at_mm, at_mm + 3.0 * width_mm)
    )

    def power_w(angle: float) -> float:
        slider = machine.displacement(np.array([angle]), 1)
        force = 150.0 + 4e3 * exp(-(((float(slider.value[0]) - at_mm) / width_mm) ** 2))
        return force * float(slider.derivative(1)[0]) * 2.0 * pi / 1000.0

    reach = 2.0 * abs(side - middle)
    best = minimize_scalar(lambda t: -power_w(t), bounds=(middle - reach, middle + reach), options={"xatol": 1e-13})
    check = kinematic_check(machine)
    # A search by values alone stops where they differ by rounding errors, which is up to 1e-8 short of the peak.
    assert -best.fun * (1.0 - 1e-12) <= check.peak_power_w.value <= -best.fun * (1.0 + 1e-7)
    bell = 4e3 * width_mm * sqrt(pi) / 2.0 * (erf((STROKE - at_mm) / width_mm) + erf(at_mm / width_mm))
    assert check.mean_power_w == pytest.approx((150.0 * STROKE + bell) / 1000.0, rel=1e-12)


@pytest.mark.slow
def test_the_turns_of_narrow_waves_are_all_there() -> None:
    """Half a wave apart; the wave packet is 0.2 mm wide."""
    resistance = FormulaResistance("80 + 30*sin(900*x)*exp(-((x - 222.2)/0.1)**2)")
    turns = resistance.turns_mm(STROKE)
    apart = np.diff(turns[np.abs(turns - 222.2) < 0.1])
    assert apart.size > 50
    assert apart == pytest.approx(pi / 900.0, rel=0.02)


@pytest.mark.slow
def test_a_peak_too_narrow_for_sixteen_digits_is_refused_with_its_place() -> None:
    with pytest.raises(WrongInput, match=r"near x = 611\.07"):
        FormulaResistance("150 + 4e3*exp(-((x - 611.07)/1e-7)**2)").work_n_mm(np.array([STROKE]), STROKE)


UNIFORM = HEAD + "motion: {law: uniform_crank}\n"


def resistance_in(folder: Path, text: str) -> Resistance:
    path = folder / "d.yaml"
    path.write_text(f"{UNIFORM}resistance: {text}\n", encoding="utf-8")
    return Drive(load(path).design).machine.load.working


def test_forms_in_a_design_file(tmp_path: Path) -> None:
    (tmp_path / "f.csv").write_text("force_n,displacement_mm\n5,0\n7,100\n")
    table = TableResistance((0.0, 100.0), (5.0, 7.0))
    assert resistance_in(tmp_path, "{table: {displacement_mm: [0, 100], force_n: [5, 7]}}") == table
    assert resistance_in(tmp_path, "{table: {file: f.csv}}") == table
    assert resistance_in(tmp_path, '{expression_n: "3*x", where_negative: keep}') == FormulaResistance("3*x", True)
    assert resistance_in(tmp_path, "{polynomial_n: [1, 2]}") == PolynomialResistance((1.0, 2.0))
    assert loaded(tmp_path, UNIFORM).design.resistance is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{where_negative: keep}", "resistance: one of polynomial_n, table or expression_n is missing"),
        ('{polynomial_n: [1], expression_n: "x"}', "resistance.expression_n: polynomial_n and expression_n are given"),
        ("{table: {force_n: [1, 2]}}", "resistance.table.displacement_mm: missing; give it: a table needs"),
        (
            "{table: {displacement_mm: [1, 2], force_n: [1, 2, 3]}}",
            "resistance.table.force_n: 3 values, but displacement_mm has 2",
        ),
        (
            "{table: {displacement_mm: [0, 4.0e-311, 90], force_n: [0, 7, 50]}}",
            "resistance.table.displacement_mm.1: 4e-311 follows 0.0; at least 1e-09 apart is right",
        ),
        (
            "{table: {displacement_mm: [-2.0e-200, 0, 90], force_n: [3, 7, 50]}}",
            "resistance.table.displacement_mm.1: 0.0 follows -2e-200",
        ),
        ("{table: {displacement_mm: [1, 1], force_n: [1, 2]}}", "resistance.table.displacement_mm.1: 1 follows 1"),
        ("{table: {displacement_mm: [1], force_n: [1]}}", "resistance.table.displacement_mm: a list of 1 given"),
        ("{table: {file: f.csv, force_n: [1]}}", "resistance.table.force_n: given beside file; keep one"),
        ("{table: {file: no.csv}}", "resistance.table.file:"),
    ],
)
def test_wrong_resistances_are_refused(tmp_path: Path, text: str, said: str) -> None:
    error = refusal(tmp_path, f"{UNIFORM}resistance: {text}\n")
    assert str(error).startswith(f"{tmp_path}/d.yaml:")
    assert said in str(error)


def test_fault_in_a_file_of_forces_has_a_line_of_it(tmp_path: Path) -> None:
    (tmp_path / "f.csv").write_text("displacement_mm,force_n\n0,5\n10,6\n9,7\n")
    error = refusal(tmp_path, f"{UNIFORM}resistance: {{table: {{file: f.csv}}}}\n")
    assert str(error).startswith(f"{tmp_path}/f.csv:4:1: resistance.table.displacement_mm.2: 9 follows 10")
    (tmp_path / "f.csv").write_text("displacement_mm,ratio\n0,5\n")
    error = refusal(tmp_path, f"{UNIFORM}resistance: {{table: {{file: f.csv}}}}\n")
    said = "unknown column: 'ratio'; columns can be displacement_mm, angle_deg, force_n"
    assert str(error).startswith(f"{tmp_path}/f.csv:1:17: {said}")


@at_once(
    ("text", "said"),
    [
        ("3*y", "unknown name 'y'"),
        ("1/(x - 400)", "no smooth function near x = 400 mm"),
        ("3 +", "is not an expression: invalid syntax; example"),
        ("2*x^2", "'2*x^2' is not allowed: a power is written with **, not with ^"),
        ("1 + 0,2*x", "the decimal sign is a point, not a comma"),
        ("7*(30 < x < 50)", "'30 < x < 50' is not allowed: a condition stands as in a if u < v else b"),
        ("7 if 30 < x < 50 else 0", "and another condition can stand in a or b"),
    ],
)
def test_what_is_no_force_is_refused(text: str, said: str) -> None:
    with pytest.raises(WrongInput, match=r"resistance\.expression_n") as caught:
        FormulaResistance(text).zeros_mm(STROKE)
    assert said in caught.value.problem


@pytest.mark.parametrize(
    ("points", "forces", "key"),
    [((0.0, 1.0), (1.0,), "force_n"), ((0.0,), (1.0,), "force_n"), ((0.0, 0.0), (1.0, 2.0), "displacement_mm")],
)
def test_what_is_no_table_is_refused(points: tuple[float, ...], forces: tuple[float, ...], key: str) -> None:
    with pytest.raises(WrongInput) as caught:
        TableResistance(points, forces)
    assert caught.value.key == f"resistance.table.{key}"


@pytest.mark.parametrize("start", [0.0, 0.4, -9e6])
def test_points_as_near_as_they_may_be_have_finite_forces_and_slopes(start: float) -> None:
    near = start + max(NEAREST_MM, 2.0 * np.spacing(abs(start)))
    table = TableResistance((start, near, near + 300.0), (-1e15, 1e15, 1e15))
    at = np.array([start, (start + near) / 2.0, near, 40.0])
    found = table.fitted_n(Jet.variable(at, 2))
    assert all(np.isfinite(found.derivative(order)).all() for order in range(3))
    assert np.isfinite(table.work_from_retracted_n_mm(at, 80.0)).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "work", "corner"),
    [
        ("2*x**1.5", lambda x: 0.8 * x**2.5, 0.0),
        ("max(0, x - 23.7)**1.5", lambda x: 0.4 * max(0.0, x - 23.7) ** 2.5, 23.7),
        ("((x - 51.3)**2)**0.6", lambda x: (51.3**2.2 + (x - 51.3) * abs(x - 51.3) ** 1.2) / 2.2, 51.3),
        ("(80 - x)**1.25", lambda x: (80.0**2.25 - (80.0 - x) ** 2.25) / 2.25, 80.0),
        ("(sin(x)**2 + cos(x)**2 + 3)*max(0, x - 9)**1.4", lambda x: max(0.0, x - 9.0) ** 2.4 / 0.6, 9.0),
    ],
)
def test_powers_over_one_begin_anywhere(text: str, work: Callable[[float], float], corner: float) -> None:
    """Their slope is like a root; the negative control is a force whose slope is infinite."""
    stroke, resistance = 80.0, FormulaResistance(text)
    points = np.linspace(0.0, stroke, 57)
    assert resistance.work_n_mm(points, stroke) == pytest.approx(
        [work(x) for x in points.tolist()], rel=1e-12, abs=1e-9
    )
    turns = resistance.turns_mm(stroke)
    assert np.abs(turns - corner).max(initial=0.0) < 1e-9
    with pytest.raises(WrongInput, match="no smooth function near x = 23"):
        FormulaResistance("max(0, x - 23)**0.5").turns_mm(stroke)
    with pytest.raises(WrongInput, match="no smooth function near x = 0"):
        FormulaResistance("x**0.95").turns_mm(stroke)


@pytest.mark.slow
def test_turns_between_powers_over_one_are_found() -> None:
    resistance = FormulaResistance("abs(sin(0.2*x))**1.5")
    turns = resistance.turns_mm(80.0)
    assert turns == pytest.approx(np.arange(1, 11) * pi * 2.5, abs=1e-7)
    with mp.workdps(20):
        edges = [mp.mpf(0), *(k * 5 * mp.pi for k in range(1, 6)), mp.mpf(80)]
        work = mp.quad(lambda x: abs(mp.sin(mp.mpf(0.2) * x)) ** mp.mpf(1.5), edges)
    assert resistance.work_n_mm(np.array([80.0]), 80.0) == pytest.approx([float(work)], rel=1e-12)


@pytest.mark.parametrize("text", ["2*x**1.5", "max(0, x - 130.5)**1.5", "(760 - x)**1.2"])
def test_peak_of_power_of_powers_over_one(text: str) -> None:
    machine = Machine(uniform_law(Lobes()), BALER_LINKAGE, SliderLoad(FormulaResistance(text)), 2.0 * pi)
    dense = machine.motion(np.linspace(0.0, 2.0 * pi, 40_001)).power_w.max()
    assert dense <= kinematic_check(machine).peak_power_w.value <= dense * (1.0 + 1e-6)
