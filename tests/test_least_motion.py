"""Goals of least jerk, speed, pressure angle and tooth force, against closed forms and another search."""

from __future__ import annotations

from functools import cache
from math import atan, degrees, exp, log, pi, tan
from pathlib import Path

import numpy as np
import pytest
from mpmath import diff, mp, mpf
from scipy.integrate import quad
from scipy.optimize import brentq, fsolve, minimize

from ncgear.design.reading.design_file import parsed
from ncgear.errors import DesignError
from ncgear.kinematics.check import peak_jerk
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.demanded import _least_flank_load_n_mm
from ncgear.optimum.task import figures
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from ncgear.ratio.laws.spline import spline_ratio_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, single
from published import BALER_LINKAGE

HEAD = """\
name: a
linkage: {crank_mm: 60, rod_mm: 200}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 60, module_mm: 2, face_width_mm: 20}
resistance: {polynomial_n: [500]}
"""
"""A stroke of 120 mm in a second against 500 N on the way out."""

FREE = "limits: {ratio_min: 0.2, ratio_max: 5, convex: false}"
STROKE_MM, TURNING_RAD_S = 120.0, 2.0 * pi


@cache
def best(goal: str, more: str = "", limits: str = FREE) -> BestLaw:
    return BestLaw(parsed(f"{HEAD}{more}optimize: {{goal: {goal}, {limits}}}\n", Path("d.yaml")).design)


def slider_rate(crank_rad: float) -> float:
    """dx/dphi2 in mm/rad of the crank of 60 mm with a rod of 200 mm, over the half-turn out."""
    across = 60.0 * np.sin(crank_rad)
    return float(across - across * 60.0 * np.cos(crank_rad) / np.sqrt(200.0**2 - across**2))


def random_laws(count: int) -> list[Array]:
    """Ratios at even knots of laws with random harmonics."""
    random, angle = np.random.default_rng(5), np.linspace(0.0, 2.0 * pi, 24, endpoint=False)
    return [
        np.exp(sum(0.2 * (a * np.cos(n * angle) + b * np.sin(n * angle)) for n, (a, b) in enumerate(own, start=1)))
        for own in random.normal(size=(count, 3, 2))
    ]


# --- jerk --------------------------------------------------------------------------------------------------------


@pytest.mark.judges("kinematics")
def test_the_peak_jerk_of_a_uniform_crank_is_that_of_its_formula() -> None:
    """The third derivative of the published baler's stroke, by mpmath, at 1000 angles."""
    crank, rod = mpf(380), mpf(960)

    def place(angle: mpf) -> mpf:
        return crank - rod - crank * mp.cos(angle) + mp.sqrt(rod**2 - (crank * mp.sin(angle)) ** 2)

    found = peak_jerk(Machine(single(uniform_law(Lobes())).whole, BALER_LINKAGE, SliderLoad(), TURNING_RAD_S))
    assert found is not None
    jerks = [abs(diff(place, mpf(2.0 * pi * number / 1000), 3)) for number in range(1000)]
    assert found.value == pytest.approx(float(max(jerks)) * TURNING_RAD_S**3, rel=5e-5)
    assert found.value >= float(max(jerks)) * TURNING_RAD_S**3 * (1.0 - 1e-9)


@pytest.mark.judges("kinematics")
def test_a_law_whose_acceleration_jumps_has_no_peak_jerk() -> None:
    kinked = HEAD.replace(
        "law: uniform_crank", "law: ratio_expression, ratio: 1.2 + 0.2*abs(cos(phi)), scale_to_close: true"
    )
    assert peak_jerk(Drive(parsed(kinked, Path("d.yaml")).design).machine) is None
    smooth = kinked.replace("abs(cos(phi))", "cos(phi)")
    assert peak_jerk(Drive(parsed(smooth, Path("d.yaml")).design).machine) is not None


def test_no_law_has_less_jerk_than_the_limit() -> None:
    """96 h/T^3 by Favard's inequality; random laws have more, and a uniform crank nearly twice as much."""
    machine, limit = best("least_jerk").begun, best("least_jerk").begun.bound
    assert limit is not None
    assert limit.value == pytest.approx(96.0 * STROKE_MM, rel=1e-9)
    angle = np.linspace(0.0, 2.0 * pi, 24, endpoint=False)
    for ratio in random_laws(6):
        jerk = figures(machine.task, single(spline_ratio_law(angle, ratio, Lobes()))).peak_jerk_mm_s3
        assert jerk is not None
        assert jerk > limit.value


@pytest.mark.slow
def test_the_law_of_least_jerk_comes_to_the_limit() -> None:
    """Jerk of one size on either stroke, which changes its sign at the dead centres alone."""
    found = best("least_jerk")
    assert found.gap is not None
    assert 0.0 < found.gap < 5e-4
    machine = Machine(found.train.whole, found.task.linkage, found.task.load, TURNING_RAD_S)
    jerk = machine.displacement(np.linspace(0.3, pi - 0.3, 50), 3).derivative(3) * TURNING_RAD_S**3
    assert np.abs(jerk) == pytest.approx(96.0 * STROKE_MM, rel=2e-3)
    # A control: the law of least acceleration has much more
    other = best("least_acceleration").figures.peak_jerk_mm_s3
    assert other is not None
    assert other > 1.5 * found.goal


# --- speed -------------------------------------------------------------------------------------------------------


def least_speed_mm_s(ratio_min: float) -> float:
    """The speed at which both strokes take a turn of the driving gear: i = x' w/v, or the least ratio."""

    def taken(speed_mm_s: float) -> float:
        return 2.0 * quad(lambda phi: max(slider_rate(phi) * TURNING_RAD_S / speed_mm_s, ratio_min), 0.0, pi)[0]

    return float(brentq(lambda speed: taken(speed) - 2.0 * pi, 100.0, 1000.0))


@pytest.mark.slow
def test_the_least_speed_is_that_of_an_even_stroke() -> None:
    found, least = best("least_speed"), least_speed_mm_s(0.2)
    assert found.limit is not None
    assert least * 0.998 < found.limit.value <= least * (1.0 + 1e-6)
    assert least <= found.goal < 1.002 * least
    assert best("least_acceleration").figures.peak_speed_mm_s > 1.3 * least


@pytest.mark.slow
def test_a_limit_of_the_speed_is_kept_or_refused() -> None:
    limits = "limits: {ratio_min: 0.2, ratio_max: 5, convex: false, peak_speed_mm_s: 260}"
    kept = best("least_acceleration", limits=limits)
    assert 259.0 < kept.figures.peak_speed_mm_s <= 260.0
    assert kept.goal > best("least_acceleration").goal * 1.05
    with pytest.raises(DesignError, match=r"240 mm/s is too little; at least 242\.\d+ mm/s") as refused:
        _ = best("least_acceleration", limits=limits.replace("260", "240")).law
    assert refused.value.key == "optimize.limits.peak_speed_mm_s"


# --- pressure angle ----------------------------------------------------------------------------------------------


def ratio_of(u: float) -> float:
    """i from u = ln(i/(1 + i)), whose slope by phi2 is the tangent of the pitch curves' angle."""
    return exp(u) / (1.0 - exp(u))


def least_tangent(time_ratio: float) -> float:
    """The tangent with which u rises and falls evenly, its tops amid the strokes, which then take their times."""
    out = 2.0 * pi * time_ratio / (1.0 + time_ratio)

    def missed(unknown: Array) -> list[float]:
        ends, steep = unknown

        def taken(sign: float) -> float:
            return 2.0 * quad(lambda phi: ratio_of(ends + sign * steep * phi), 0.0, pi / 2.0)[0]

        return [taken(1.0) - out, taken(-1.0) - (2.0 * pi - out)]

    return float(fsolve(missed, [log(0.5), 0.1], xtol=1e-12)[1])


@pytest.mark.slow
def test_the_least_pressure_angle_of_a_time_ratio() -> None:
    found = best("least_pressure_angle", "wishes: {time_ratio: {at_least: 1.6}}\n")
    least = degrees(atan(least_tangent(1.6)))
    assert least == pytest.approx(8.5, abs=0.1)
    assert least <= found.goal < 1.005 * least
    # No limit is told where none is known
    assert found.limit is None
    assert degrees(best("least_acceleration").figures.tangent_rad) > 1.5 * least


def tangent_of_even_speed(ratio_min: float) -> float:
    """The least tangent of laws that move from 20 to 100 mm at one speed.

    On that stretch the ratio is x' w/v.  Its tangent is greatest at an end.  The rest of the turn must take what is
    left, with a ratio that falls as fast as this tangent allows, to the least ratio.
    """
    way = [float(brentq(lambda phi, mm=mm: quad(slider_rate, 0.0, phi)[0] - mm, 0.0, pi)) for mm in (20.0, 100.0)]
    step = 1e-6

    def bend(phi: float) -> float:
        return (slider_rate(phi + step) - slider_rate(phi - step)) / (2.0 * step)

    def steepest(per: float) -> float:
        return max(abs(bend(phi)) / slider_rate(phi) / (1.0 + slider_rate(phi) * per) for phi in way)

    def missed(per: float) -> float:
        """What the turn takes over a whole turn, where i = x' per."""
        steep, rest = steepest(per), 2.0 * pi - (way[1] - way[0])
        ends = [log(ratio / (1.0 + ratio)) for ratio in (slider_rate(phi) * per for phi in reversed(way))]
        floor = log(ratio_min / (1.0 + ratio_min))

        def least(phi: float) -> float:
            return ratio_of(max(ends[0] - steep * phi, ends[1] - steep * (rest - phi), floor))

        kinks = [(ends[0] - floor) / steep, rest - (ends[1] - floor) / steep]
        own = quad(slider_rate, *way)[0] * per
        return own + quad(least, 0.0, rest, points=[min(max(kink, 0.0), rest) for kink in kinks], limit=200)[0] - 2 * pi

    # A greater ratio on the stretch has less tangent and takes more time
    return steepest(float(brentq(missed, 1e-3, 0.1)))


@pytest.mark.slow
def test_the_least_pressure_angle_of_an_even_speed() -> None:
    wish = "wishes: {constant_speed: [{from_mm: 20, to_mm: 100, tolerance: 0.0001}]}\n"
    found, least = best("least_pressure_angle", wish), degrees(atan(tangent_of_even_speed(0.2)))
    assert found.limit is not None
    assert 0.97 * least < found.limit.value <= found.goal < 1.005 * least
    assert found.goal < 1.02 * found.limit.value
    # A limit below it is refused, one above it is kept
    tight = f"limits: {{ratio_min: 0.2, convex: false, pressure_angle_deg: {20.0 + 0.95 * least}}}"
    with pytest.raises(DesignError, match="a pressure angle of"):
        _ = best("least_acceleration", wish, tight).law


# --- force between the teeth -------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_force_of_round_gears_is_over_the_limit() -> None:
    """The work of a stroke, 60 J, over the length of the pitch curves, 60 teeth of 2 mm; random laws have more."""
    machine, limit = best("least_tooth_force").begun, best("least_tooth_force").begun.bound
    assert limit is not None
    assert limit.value == pytest.approx(500.0 * 120.0 / (60.0 * pi * 2.0), rel=1e-9)
    angle = np.linspace(0.0, 2.0 * pi, 24, endpoint=False)
    for ratio in random_laws(4):
        force = figures(machine.task, single(spline_ratio_law(angle, ratio, Lobes()))).tooth_force_n
        assert force is not None
        assert force > limit.value


@pytest.mark.slow
def test_no_law_has_less_flank_load_than_the_limit() -> None:
    """Random laws, each with its own greatest tangent as the limit's; 4 W/(pi cos alpha) where none leans."""
    task, angle = best("least_flank_load").begun.task, np.linspace(0.0, 2.0 * pi, 24, endpoint=False)
    for ratio in [np.ones(24), *random_laws(6)]:
        own = figures(task, single(spline_ratio_law(angle, ratio, Lobes())))
        least = _least_flank_load_n_mm(task, tan(own.tangent_rad))
        assert own.flank_load_n_mm is not None
        assert 0.1 * own.flank_load_n_mm < least < own.flank_load_n_mm
    assert _least_flank_load_n_mm(task, 0.0) == pytest.approx(4.0 * 60_000.0 / (pi * np.cos(pi / 9.0)), rel=1e-12)


def test_a_centre_distance_rolls_no_more_than_round_gears() -> None:
    text = HEAD.replace("teeth: 60", "center_distance_mm: 120")
    design = parsed(f"{text}optimize: {{goal: least_tooth_force}}\n", Path("d.yaml")).design
    bound = BestLaw(design).begun.bound
    assert bound is not None
    assert bound.value == pytest.approx(500.0 * 120.0 / (60.0 * pi * 2.0), rel=1e-9)


def of_teeth(angle: Array, ratio: Array, tangent: Array) -> dict[str, Array]:
    """Force between the teeth in N and flank load in N mm at crank angles around the turn, by formulas of their own.

    F = |M2| (1 + s) sqrt(1 + t^2)/(a (cos alpha - t sin alpha)), and k1 + k2 = (1 + s)^2/(a s sqrt(1 + t^2)).
    """
    torque = 500.0 * np.where(angle < pi, [slider_rate(phi) for phi in angle], 0.0)
    rack, root = pi / 9.0, np.sqrt(1.0 + tangent**2)
    distance = 60.0 * pi * 2.0 / (2.0 * pi * np.mean(ratio / (1.0 + ratio) * root))
    force = torque * (1.0 + 1.0 / ratio) * root / (distance * (np.cos(rack) - tangent * np.sin(rack)))
    curved = (1.0 + 1.0 / ratio) ** 2 * ratio / root
    return {"tooth_force_n": force, "flank_load_n_mm": force * curved * distance}


def test_force_and_flank_load_of_a_law_are_those_of_the_formulas() -> None:
    """ln i12 = c + 0.3 cos phi2 - 0.1 sin 2 phi2 at 7200 angles, with 90 knots; and 8 M2/cos(alpha) of round gears."""
    task, knots = best("least_flank_load").begun.task, np.linspace(0.0, 2.0 * pi, 90, endpoint=False)

    def log_ratio(phi: Array) -> Array:
        return 0.3 * np.cos(phi) - 0.1 * np.sin(2.0 * phi)

    angle = np.linspace(0.0, 2.0 * pi, 7200, endpoint=False)
    ratio = np.exp(log_ratio(angle))
    scale = ratio.mean()
    law = single(spline_ratio_law(knots, np.exp(log_ratio(knots)) / scale, Lobes()))
    slope = -0.3 * np.sin(angle) - 0.2 * np.cos(2.0 * angle)
    found, told = figures(task, law), of_teeth(angle, ratio / scale, slope / (1.0 + ratio / scale))
    for name, each in told.items():
        assert getattr(found, name) == pytest.approx(each.max(), rel=1e-4), name
    torque = 500.0 * max(slider_rate(phi) for phi in angle[:3600])
    round_gears = figures(task, single(uniform_law(Lobes()))).flank_load_n_mm
    assert round_gears == pytest.approx(8.0 * torque / np.cos(pi / 9.0), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("goal", "name"), [("tooth_force", "tooth_force_n"), ("flank_load", "flank_load_n_mm")])
def test_another_search_finds_no_less_load_of_the_teeth(goal: str, name: str) -> None:
    """Sequential quadratic programming over nine harmonics of ln i12, with formulas of its own at 360 angles."""
    limits = "limits: {ratio_min: 0.5, ratio_max: 2, convex: false, pressure_angle_deg: 50}"
    found = best(f"least_{goal}", limits=limits)
    angle = np.linspace(0.0, 2.0 * pi, 360, endpoint=False)
    waves = np.array([wave(n * angle) for n in range(1, 10) for wave in (np.cos, np.sin)])
    rates = np.array([n * turned for n in range(1, 10) for turned in (-np.sin(n * angle), np.cos(n * angle))])

    def shapes(unknown: Array) -> tuple[Array, Array]:
        ratio = np.exp(unknown[:-1] @ waves)
        ratio = ratio / ratio.mean()
        return ratio, unknown[:-1] @ rates / (1.0 + ratio)

    def load(unknown: Array) -> Array:
        return of_teeth(angle, *shapes(unknown))[name] / found.goal

    def kept(unknown: Array) -> Array:
        (ratio, tangent), steep = shapes(unknown), tan(pi / 6.0)
        room = [unknown[-1] - load(unknown), steep - tangent, steep + tangent, 2.0 - ratio, ratio - 0.5]
        return np.concatenate(room)

    start = np.append(np.zeros(18), 2.0)
    rule = {"type": "ineq", "fun": kept}
    other = minimize(lambda unknown: unknown[-1], start, method="SLSQP", constraints=rule, options={"maxiter": 200})
    assert 0.998 < other.fun < 1.05
    # A control: a uniform crank
    assert load(start).max() > 1.2
    assert found.begun.bound is not None
    assert 0.0 < found.begun.bound.value < found.goal


@pytest.mark.parametrize("goal", ["least_tooth_force", "least_flank_load"])
def test_a_goal_of_the_teeth_needs_gears(goal: str) -> None:
    text = HEAD.replace("gears: {teeth: 60, module_mm: 2, face_width_mm: 20}\n", "")
    with pytest.raises(DesignError, match="it needs the gears' size") as refused:
        _ = BestLaw(parsed(f"{text}optimize: {{goal: {goal}}}\n", Path("d.yaml")).design).begun
    assert refused.value.key == "optimize.goal"


@pytest.mark.slow
def test_a_weighted_sum_knows_the_jerk() -> None:
    """Between the laws of least acceleration and of least jerk, and at most a sum of their weights over the limit."""
    found = best("weighted", "", f"weights: {{acceleration_mm_s2: 2000, jerk_mm_s3: 12000}}, {FREE}")
    slow, smooth = best("least_acceleration"), best("least_jerk")
    jerk, least = found.figures.peak_jerk_mm_s3, found.limit
    assert jerk is not None
    assert least is not None
    assert slow.goal < found.figures.peak_acceleration_mm_s2 < smooth.figures.peak_acceleration_mm_s2
    assert smooth.goal < jerk
    assert least.value == pytest.approx(slow.begun.bound.value / 2000.0 + 96.0 * STROKE_MM / 12000.0, rel=0.02)
    assert found.goal > least.value
