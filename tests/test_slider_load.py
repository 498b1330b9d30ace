"""Force on both strokes: against closed forms, quadrature, Newton's equations of all bodies, energies and mirrors."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpmath import mp
from numpy.polynomial import Polynomial
from scipy.integrate import quad

from at_once import at_once
from ncgear.design.reading.design_file import load
from ncgear.dynamics.crank_load import crank_load
from ncgear.dynamics.driving_shaft import DrivingShaft, fluctuation
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.errors import WrongInput
from ncgear.kinematics.check import kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import CrankPace
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import shares
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import least_acceleration, least_power
from ncgear.optimum.family import (
    RETURN_POINTS,
    LawFamily,
    sampled_laws,
)
from ncgear.optimum.task import Task
from ncgear.project.drive import Drive
from ncgear.ratio.sampled_strokes import BUMP_HEIGHT
from ncgear.screening.batch import kind_of
from ncgear.screening.designs import screened_block
from ncgear.screening.single import single_figures
from oracles import newton_euler
from published import BALER_LINKAGE, FIT, OFFSET, PRESS, RPM
from test_family import SHAPES, family_of, points_of
from test_family import made as made_law
from test_kinematics import law
from test_rigid import HEAVY, OUTSIDE, felt, scene, values

pytestmark = pytest.mark.judges("mechanisms")

STROKE = 760.0
SUCK = (900.0, -3.0, 2.0e-3)
"""Of the way back: 900 N at the retracted end, negative from 414 mm to the extended one."""
BOTH = SliderLoad(PolynomialResistance(FIT), PolynomialResistance(SUCK), 55.0)
LOADS = {
    "friction alone": SliderLoad(friction_n=55.0),
    "back alone": SliderLoad(returning=PolynomialResistance(SUCK)),
    "both and friction": BOTH,
    "both, kept negative": SliderLoad(
        PolynomialResistance(FIT, keep_negative=True), PolynomialResistance(SUCK, keep_negative=True), 55.0
    ),
    "table and formula": SliderLoad(
        TableResistance((0.0, 200.0, 210.0, 760.0), (0.0, 50.0, 3000.0, 20000.0)),
        FormulaResistance("300 + 4000*exp(-(x - 200)**2/900) - 350"),
        20.0,
    ),
}


def by_hand(resistance: Resistance, friction_n: float, x: float) -> float:
    """The force against the motion at one displacement, from the coefficients or the points."""
    match resistance:
        case PolynomialResistance(coefficients_n=coefficients, keep_negative=keep):
            curve = float(Polynomial(coefficients)(x))
            return (curve if keep else max(curve, 0.0)) + friction_n
        case _:
            return float(resistance.force_n(np.array([x]))[0]) + friction_n


# --- the value ----------------------------------------------------------------------------------------------------


@at_once("returning", [False, True])
@at_once("name", LOADS)
def test_force_is_that_of_its_stroke_and_friction(name: str, returning: bool) -> None:
    load, x = LOADS[name], np.linspace(0.0, STROKE, 77)
    resistance = load.returning if returning else load.working
    expected = [by_hand(resistance, load.friction_n, float(one)) for one in x]
    assert load.against_n(x, returning) == pytest.approx(expected, rel=1e-13)
    sense = -1.0 if returning else 1.0
    assert load.backwards_n(x, returning) == pytest.approx(sense * np.array(expected), rel=1e-13)


def test_strokes_may_be_mixed_and_shapes_kept() -> None:
    x, returning = np.array([[100.0, 100.0], [700.0, 700.0]]), np.array([False, True])
    mixed = BOTH.against_n(x, returning)
    assert mixed.shape == (2, 2)
    for column, way in enumerate((False, True)):
        assert (mixed[:, column] == BOTH.against_n(x[:, column], way)).all()
    assert np.abs(mixed[:, 0] - mixed[:, 1]).min() > 1.0  # control: the strokes differ


@at_once("returning", [False, True])
@at_once("name", LOADS)
def test_work_is_the_integral_along_the_way(name: str, returning: bool) -> None:
    """Quadrature between the corners, which is exact to its own tolerance of 1e-10."""
    load = LOADS[name]
    edges = np.concatenate([[0.0], load.corners_mm(STROKE, returning), [STROKE]])
    for end in (0.0, 13.0, 205.0, 500.0, STROKE):
        low, high = (end, STROKE) if returning else (0.0, end)
        inside = [low, *(edge for edge in edges if low < edge < high), high]
        work = sum(
            quad(lambda x: float(load.against_n(np.array([x]), returning)[0]), a, b, epsabs=1e-6, epsrel=1e-11)[0]
            for a, b in pairwise(inside)
        )
        found = load.work_n_mm(np.array([end]), STROKE, returning)[0]
        assert found == pytest.approx(work, rel=1e-9, abs=1e-4)


def test_work_of_a_cycle_by_hand() -> None:
    """40 N on 60 mm out, 10 N back, 3 N both ways: 60 (40 + 10 + 6) = 3360 N mm; kept negative forces give back."""
    out, back = PolynomialResistance((40.0,)), PolynomialResistance((10.0,))
    assert SliderLoad(out, back, 3.0).cycle_work_n_mm(60.0) == pytest.approx(3360.0, rel=1e-15)
    driven = PolynomialResistance((-10.0,), keep_negative=True)
    assert SliderLoad(out, driven, 3.0).cycle_work_n_mm(60.0) == pytest.approx(2160.0, rel=1e-15)
    assert SliderLoad(out, PolynomialResistance((-10.0,)), 3.0).cycle_work_n_mm(60.0) == pytest.approx(2760.0)
    assert SliderLoad().cycle_work_n_mm(60.0) == 0.0


@at_once("returning", [False, True])
@at_once("name", LOADS)
def test_the_largest_smooth_curve_is_the_force(name: str, returning: bool) -> None:
    """Above zero; the slopes are those of differences between corners."""
    load, x = LOADS[name], np.linspace(1.0, STROKE - 1.0, 301)
    curves = load.smooth_curves_n(returning)
    largest = np.max([0.0 * x, *(curve(Jet(x[None, :])).value for curve in curves)], axis=0)
    assert largest == pytest.approx(np.maximum(load.against_n(x, returning), 0.0), rel=1e-13, abs=1e-12)
    jet = load.backwards_jet_n(Jet.variable(x, 1), np.full(x.shape, returning))
    ahead, behind = (load.backwards_n(x + step, returning) for step in (1e-4, -1e-4))
    corners = load.corners_mm(STROKE, returning)
    smooth = np.abs(x[:, None] - corners).min(axis=1, initial=np.inf) > 1e-3
    assert jet.value == pytest.approx(load.backwards_n(x, returning), rel=1e-13)
    slope = jet.derivative(1)
    # Rounding 1e-12 N over 2e-4 mm, and a third derivative of at most 1e-2 N/mm^3 times 1e-9
    assert slope[smooth] == pytest.approx(((ahead - behind) / 2e-4)[smooth], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("friction_n", [-1.0, float("nan"), float("inf")])
def test_friction_that_is_none_is_refused(friction_n: float) -> None:
    with pytest.raises(WrongInput, match="positive force is right") as error:
        SliderLoad(friction_n=friction_n)
    assert error.value.key == "resistance.friction_n"


# --- power --------------------------------------------------------------------------------------------------------


LINKAGES = {"baler": BALER_LINKAGE, "offset": OFFSET}


@cache
def machine(load: str, name: str = "stroke, e = 0", linkage: str = "baler") -> Machine:
    return Machine(law(name), LINKAGES[linkage], LOADS[load], 5.0)


@pytest.mark.tiers(slow=["both and friction-baler"], rest="long")
@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("name", LOADS)
def test_peak_and_mean_power_are_those_of_dense_samples(name: str, linkage: str) -> None:
    """Samples 3e-5 rad apart: the trapezoid's error is some 1e-7 at jumps of the slope, a missed peak less."""
    made = machine(name, linkage=linkage)
    phi1 = np.linspace(0.0, 2.0 * pi, 200_001)
    motion, found = made.motion(phi1), kinematic_check(made)
    by_place = [LOADS[name].returning, LOADS[name].working]
    power = motion.power_w
    assert found.peak_power_w.value == pytest.approx(power.max(), rel=1e-6)
    assert found.mean_power_w == pytest.approx(np.trapezoid(power, phi1) / (2.0 * pi), rel=1e-6)
    sampled = int(np.argmax(power))
    forth = bool(made.working(motion.phi2_rad[sampled : sampled + 1])[0])
    at = float(motion.displacement[sampled])
    against = by_hand(by_place[forth], LOADS[name].friction_n, at)
    assert power[sampled] == pytest.approx(against * abs(motion.velocity[sampled]) / 1000.0, rel=1e-12)


@at_once("name", LOADS)
def test_friction_and_force_take_power_on_both_ways(name: str) -> None:
    """Where nothing is negative and kept, power is nowhere below zero; with a wrong sign of the return it would be."""
    motion = machine(name).motion(np.linspace(0.0, 2.0 * pi, 2001))
    signed = motion.load * motion.velocity
    if "kept" not in name:
        assert motion.power_w.min() >= -1e-12  # rounding of the end of the cycle
        assert signed.min() < 0.0  # control


# --- torques and forces --------------------------------------------------------------------------------------------


def suck(x: Any) -> Any:
    return max(mp.polyval(list(reversed(SUCK)), x), 0) + 55


def both_ways(rpm: float) -> tuple[RigidMachine, newton_euler.Scene]:
    """The machine of test_rigid with force on both strokes, and the oracle's, which has its own curves."""
    rigid = felt(rpm, 60.0)
    loaded = replace(rigid, machine=replace(rigid.machine, load=BOTH))
    alone = scene(rigid)
    return loaded, replace(alone, resistance=lambda x: alone.resistance(x) + 55, returning=suck)


@at_once("phi1", [0.1, 2.2, 3.5, 4.4, 5.9])
@at_once("rpm", [20.0, 200.0])
def test_all_forces_solve_one_linear_system(rpm: float, phi1: float) -> None:
    rigid, oracle = both_ways(rpm)
    angle = np.array([phi1])
    loads = rigid.at(angle)
    working = bool(rigid.machine.working(rigid.machine.transmission.driven_angle(angle).value)[0])
    pushing = bool(loads.driven_torque.value[0] > 0.0)
    exact = newton_euler.solved(oracle, phi1, working=working, pushing=pushing)
    scale = max(map(abs, exact.values()))
    for name, value in values(loads).items():
        assert value == pytest.approx(exact[name], rel=1e-11, abs=1e-13 * scale), name


def test_the_oracle_sees_a_force_of_the_wrong_sign() -> None:
    """Negative control on the way back, at 20 r/min."""
    rigid, oracle = both_ways(20.0)
    wrong = replace(oracle, returning=lambda x: -suck(x))
    loads = values(rigid.at(np.array([5.0])))
    exact = newton_euler.solved(wrong, 5.0, working=False, pushing=True)
    assert abs(exact["wrist_x"] / loads["wrist_x"] - 1.0) > 0.1


@at_once("law_name", ["uniform", "stroke, e = 0", "ellipse 1:2"])
@at_once("name", LOADS)
def test_work_of_the_motor_is_that_of_both_strokes(name: str, law_name: str) -> None:
    """Over a cycle masses and weights give back what they took; 1e-12 of the work that goes to and fro."""
    made = machine(name, law_name)
    work = sum(
        quad(lambda x, way=way: float(LOADS[name].against_n(np.array([x]), way)[0]), a, b, epsabs=1e-7, epsrel=1e-12)[0]
        for way in (False, True)
        for a, b in pieces(LOADS[name], way)
    )
    found = fluctuation(RigidMachine(made, HEAVY, OUTSIDE))
    assert found.work_n_mm == pytest.approx(work, rel=1e-9)
    assert made.load.cycle_work_n_mm(STROKE) == pytest.approx(work, rel=1e-10)
    one_way = fluctuation(RigidMachine(replace(made, load=SliderLoad(LOADS[name].working)), HEAVY, OUTSIDE))
    assert abs(one_way.work_n_mm / work - 1.0) > 1e-3  # control


def pieces(load: SliderLoad, returning: bool) -> list[tuple[float, float]]:
    edges = [0.0, *load.corners_mm(STROKE, returning).tolist(), STROKE]
    return list(pairwise(edges))


@at_once("name", LOADS)
def test_torque_is_that_of_virtual_work(name: str) -> None:
    """Without masses the torque on the driving gear is the force along x times dx/dphi1, from differences."""
    made = machine(name)
    phi1 = np.linspace(0.05, 6.2, 211)
    extended = made.extended_rad
    phi1 = phi1[np.abs(phi1 - extended) > 1e-2]
    step = 1e-5
    ahead, behind = (made.motion(phi1 + way).displacement for way in (step, -step))
    against = np.array(
        [
            by_hand(
                LOADS[name].working if angle < extended else LOADS[name].returning, LOADS[name].friction_n, float(x)
            )
            for angle, x in zip(phi1, made.motion(phi1).displacement, strict=True)
        ]
    )
    expected = against * np.abs(ahead - behind) / (2.0 * step)
    weightless = replace(HEAVY, slider_kg=1e-12, rod_kg=0.0, rod_inertia_kg_mm2=0.0, crank_kg=0.0)
    weightless = replace(weightless, crank_inertia_kg_mm2=0.0, driven_inertia_kg_mm2=0.0)
    torque = RigidMachine(made, weightless).at(phi1).driving_torque.value
    # Differences: 1e-10 relative from the third derivative, 1e-13 mm / 1e-5 rad from rounding
    np.testing.assert_allclose(torque, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


@pytest.mark.slow
def test_peaks_of_the_torque_are_those_of_samples() -> None:
    rigid = RigidMachine(machine("table and formula"), HEAVY, OUTSIDE)
    least, most = DrivingShaft(rigid).torque_range_n_mm
    torque = rigid.at(np.linspace(0.0, 2.0 * pi, 100_001)).driving_torque.value
    assert most.value == pytest.approx(torque.max(), rel=1e-6)
    assert least.value == pytest.approx(torque.min(), rel=1e-6)


# --- motion in time ------------------------------------------------------------------------------------------------


@at_once("linkage", LINKAGES.values())
@at_once("name", LOADS)
def test_torque_of_any_motion_is_that_of_the_joint_forces(name: str, linkage: CrankSlider) -> None:
    """As in test_crank_load, on both strokes; the table's own error is 1e-5 of the largest moment at most."""
    random = np.random.default_rng(5)
    angle, speed, acceleration = random.uniform([0.0, -9.0, -50.0], [2.0 * pi, 9.0, 50.0], (150, 3)).T
    slide = linkage.displacement(Jet.variable(angle, 0)).value
    out = angle < linkage.working_angle_rad
    along = [
        by_hand(LOADS[name].working, LOADS[name].friction_n, float(x))
        if forth
        else -by_hand(LOADS[name].returning, LOADS[name].friction_n, float(x))
        for x, forth in zip(slide, out, strict=True)
    ]
    pace = CrankPace(speed, acceleration)
    expected = linkage.joint_forces(Jet.variable(angle, 2), HEAVY, pace, np.array(along)).torque_n_mm
    found = crank_load(linkage, HEAVY, LOADS[name]).torque_n_mm(angle, speed, acceleration)
    assert np.abs(found - expected).max() < 2e-5 * np.abs(expected).max()


def test_a_turn_costs_the_work_of_both_strokes() -> None:
    load = crank_load(BALER_LINKAGE, HEAVY, BOTH)
    ends = load.energy_n_mm(np.array([0.0, 2.0 * pi, 8.0 * pi]), np.full(3, 3.0))
    work = BOTH.cycle_work_n_mm(STROKE)
    np.testing.assert_allclose(np.diff(ends), [work, 3.0 * work], rtol=1e-12)


def test_a_narrow_peak_on_the_way_back_is_in_the_table() -> None:
    peak = TableResistance((0.0, 300.0, 300.0005, 300.001, 760.0), (50.0, 50.0, 5e4, 50.0, 50.0))
    (start, end, _), *others = crank_load(BALER_LINKAGE, HEAVY, SliderLoad(returning=peak)).narrow_rad
    assert not others
    assert pi < start < end < 2.0 * pi
    place = BALER_LINKAGE.crank_angle(np.array([300.0005]), np.array([True]))[0]
    assert start < place < end


# --- best laws -----------------------------------------------------------------------------------------------------


def mirrored_task(returning: bool) -> Task:
    load = SliderLoad(returning=PRESS.working) if returning else PRESS
    return Task(BALER_LINKAGE, load, 60.0 * RPM)


@pytest.mark.slow
def test_the_limit_of_a_mirrored_load_is_the_same() -> None:
    """Without offset, time reversed swaps the strokes; places lie alike but for those where the force turns."""
    asked = Demands(0.2, 5.0, power_w=9000.0)
    forth, back = (least_acceleration(mirrored_task(way), asked).value for way in (False, True))
    assert back == pytest.approx(forth, rel=2e-3)
    unloaded = least_acceleration(replace(mirrored_task(True), load=SliderLoad()), Demands(0.2, 5.0))
    assert back > 1.05 * unloaded.value  # control: the load of the way back is felt


@pytest.mark.tiers(slow=["both and friction"], rest="long")
@pytest.mark.parametrize("name", LOADS)
def test_no_law_is_below_the_limit_of_its_load(name: str) -> None:
    made = machine(name)
    low, high = made.transmission.ratio_range
    check = kinematic_check(made)
    power, acceleration = check.peak_power_w.value, check.peak_acceleration_cycle.value
    asked = Demands(0.999 * low.value, 1.001 * high.value)
    task = Task(made.linkage, made.load, made.speed_rad_s)
    assert least_acceleration(task, replace(asked, power_w=1.0001 * power)).value <= acceleration
    assert least_power(task, replace(asked, acceleration_mm_s2=1.0001 * acceleration)).value <= power


def test_the_family_knows_the_power_of_the_way_back() -> None:
    """Samples of a law of the family, against the motion of that law; its skewness is as in test_family."""
    task = replace(family_of(BALER_LINKAGE).task, load=BOTH)
    family = LawFamily(task, inverse=True)
    of = made_law(SHAPES[0], family)
    ends = of.return_law.ends
    skewness = of.return_law.polynomial.coef[5] / 2.0 * BUMP_HEIGHT * ends.length_rad / ends.driven_length_rad
    point = points_of(SHAPES[:1], skewness)
    power = sampled_laws(family, point).power[0]
    one_way = sampled_laws(LawFamily(replace(task, load=SliderLoad(BOTH.working)), inverse=True), point).power[0]
    assert power.size == one_way.size + RETURN_POINTS.count
    phi1 = ends.start_rad + ends.length_rad * shares(RETURN_POINTS.count)
    motion = Machine(of.transmission, BALER_LINKAGE, BOTH, task.speed_rad_s).motion(phi1[1:-1])
    # Samples of a return are closed to 1e-6
    np.testing.assert_allclose(power[one_way.size + 1 : -1], motion.power_w, atol=1e-6 * motion.power_w.max())


# --- files ---------------------------------------------------------------------------------------------------------


FILE = """\
name: mine
linkage: {crank_mm: 30, rod_mm: 120, offset_mm: 4}
operation: {speed_rpm: 60}
motion: {law: harmonic_ratio, cosine: [-0.15]}
"""


def drive_in(folder: Path, text: str) -> Drive:
    path = folder / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return Drive(load(path).design)


def test_keys_of_both_ways(tmp_path: Path) -> None:
    (tmp_path / "back.csv").write_text("displacement_mm,force_n\n0,5\n60,7\n")
    text = FILE + "resistance:\n  expression_n: 3*x\n  friction_n: 2.5\n  returning: {table: {file: back.csv}}\n"
    load = drive_in(tmp_path, text).machine.load
    table = TableResistance((0.0, 60.0), (5.0, 7.0))
    assert load == SliderLoad(FormulaResistance("3*x"), table, 2.5)
    assert drive_in(tmp_path, FILE + "resistance: {friction_n: 2}\n").machine.load == SliderLoad(friction_n=2.0)
    back = "resistance: {returning: {polynomial_n: [-9, 1], where_negative: keep}}\n"
    expected = SliderLoad(returning=PolynomialResistance((-9.0, 1.0), keep_negative=True))
    assert drive_in(tmp_path, FILE + back).machine.load == expected


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "{returning: {where_negative: keep}}",
            "resistance.returning: one of polynomial_n, table or expression_n is mi",
        ),
        ("{friction_n: -1}", "resistance.friction_n"),
        ("{returning: {friction_n: 1}}", "resistance.returning.friction_n"),
        ('{returning: {polynomial_n: [1], expression_n: "x"}}', "resistance.returning.expression_n: polynomial_n and"),
        ('{friction_n: 1, polynomial_n: [1], expression_n: "x"}', "resistance.expression_n: polynomial_n and"),
        ('{returning: {expression_n: "1/(x - 20)"}}', "resistance.returning.expression_n"),
        ('{returning: {expression_n: "3*y"}}', "resistance.returning.expression_n"),
    ],
)
def test_wrong_loads_are_refused_with_their_place(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(WrongInput) as error:
        kinematic_check(drive_in(tmp_path, f"{FILE}resistance: {text}\n").machine)
    assert said in str(error.value)


@pytest.mark.thorough
def test_a_screening_has_the_figures_of_a_check(tmp_path: Path) -> None:
    """A batch that took the working stroke alone would give less: the force of the way back is the larger one."""
    text = FILE + "resistance: {polynomial_n: [5], returning: {polynomial_n: [80]}, friction_n: 2}\n"
    design = drive_in(tmp_path, text).design
    assert kind_of(design) is None
    data, speed = load(tmp_path / "mine.yaml").data, design.operation.speed_rpm
    found = screened_block(data, ["operation.speed_rpm"], np.array([[speed]])).figures
    alone = single_figures(design)
    assert {name: float(values[0]) for name, values in found.items()} == alone
    stroke = drive_in(tmp_path, text).linkage.stroke_mm
    assert alone["check.mean_power_w"] == pytest.approx((5.0 + 80.0 + 4.0) * stroke / 1000.0, rel=1e-12)
