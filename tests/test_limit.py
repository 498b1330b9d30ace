"""The certified limit: references, closed forms, laws that must not beat it, and what is said where none fits."""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import cache
from math import pi, radians, sqrt

import numpy as np
import pytest

from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.kinematics.check import kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.limit import (
    Bound,
    Weights,
    fastest_motion,
    least_acceleration,
    least_power,
    least_weighted_sum,
)
from ncgear.optimum.certified.problem import PRESSING_SHARE, Problem
from ncgear.optimum.certified.refusals import turning_point
from ncgear.optimum.certified.road import Peaks
from ncgear.optimum.task import Limits, Task
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission
from published import AT_SIXTY, BALER_LINKAGE, FIT, OFFSET, PRESS, RPM, USUAL
from test_laws import law

LAW_RPM = 52.80854482726039
NONE = PolynomialResistance()
WIDE = Limits(1e-6, 1e6)


def baler(rpm: float, resistance: Resistance = PRESS) -> Task:
    return Task(BALER_LINKAGE, resistance, rpm * RPM)


@cache
def acceleration(rpm: float, power_w: float | None, cells: int = 1600) -> Bound:
    return least_acceleration(baler(rpm), replace(USUAL, peak_power_w=power_w), cells)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("power_w", "at_law_speed", "at_sixty"),
    [
        (18750.0, 9420.0, 12411.0),
        (16675.0, 9592.0, 12807.0),
        (12000.0, 10701.0, 14731.0),
        (9000.0, 12647.0, 18117.0),
        (7500.0, 14783.0, 22001.0),
        (6300.0, 18110.0, 28442.0),
    ],
)
def test_references_of_the_baler(power_w: float, at_law_speed: float, at_sixty: float) -> None:
    """Known from another solution of the same programme on grids of 200 to 800, to 0.3 %."""
    for rpm, known in ((LAW_RPM, at_law_speed), (60.0, at_sixty)):
        found = acceleration(rpm, power_w)
        assert found.value == pytest.approx(known, rel=3e-3)
        assert 0.0 < found.gap < 1e-3


@pytest.mark.parametrize("rpm", [LAW_RPM, 60.0])
def test_power_and_acceleration_are_each_other_s_inverse(rpm: float) -> None:
    found = least_power(baler(rpm), replace(USUAL, peak_acceleration_mm_s2=acceleration(rpm, 9000.0).value))
    assert found.value == pytest.approx(9000.0, rel=2e-6)  # two searches of 1e-7, steeper the one way than the other
    assert 0.0 < found.gap < 1e-3


def test_finer_grids_close_in_from_both_sides() -> None:
    """Second order: each halving of the cells quarters the gap, and no enclosure lies outside a coarser one."""
    found = [acceleration(60.0, 6300.0, cells) for cells in (400, 800, 1600, 3200)]
    gaps = [bound.gap for bound in found]
    assert all(3.0 < coarse / fine < 5.5 for coarse, fine in itertools.pairwise(gaps))
    assert all(one.value <= other.attained * (1 + 1e-7) for one in found for other in found)
    assert found[-1].gap < 1e-4


def test_nothing_but_acceleration_in_closed_form() -> None:
    """Both strokes evenly faster, then evenly slower: A = 16 H / T^2 in line, and with an offset too."""
    for linkage in (BALER_LINKAGE, OFFSET, CrankSlider(100.0, 120.0), CrankSlider(100.0, 1e6)):
        found = least_acceleration(Task(linkage, NONE, 2.0 * pi), WIDE)
        assert found.value == pytest.approx(16.0 * linkage.stroke_mm, rel=1e-6)
        assert found.value <= 16.0 * linkage.stroke_mm <= found.attained


def test_given_working_stroke_in_closed_form() -> None:
    """Each stroke by itself: A = 4 H / t^2 of the quicker one."""
    for working in (2.5, 4.0):
        found = least_acceleration(Task(BALER_LINKAGE, NONE, 2.0 * pi), replace(WIDE, working_rad=working))
        quicker = min(working, 2.0 * pi - working) / (2.0 * pi)
        assert found.value == pytest.approx(4.0 * 760.0 / quicker**2, rel=1e-6)


def test_power_alone_in_closed_form() -> None:
    """A constant force, ratios and acceleration free: no time for the return, all power all the time."""
    task = Task(BALER_LINKAGE, PolynomialResistance((500.0,)), 2.0 * pi)
    # The least ratio still takes 1e-6 of the cycle or so.
    assert least_power(task, WIDE).value == pytest.approx(500.0 * 0.760, rel=1e-5)
    assert least_power(task, replace(WIDE, working_rad=pi)).value == pytest.approx(500.0 * 0.760 * 2.0, rel=1e-5)


@pytest.mark.thorough
def test_a_ratio_of_one_is_the_uniform_crank() -> None:
    uniform = kinematic_check(Machine(uniform_law(Lobes()), BALER_LINKAGE, PRESS, 60.0 * RPM))
    for room in (1e-7, 2e-9):
        near = Limits(1.0 - room, 1.0 + room)
        assert least_power(AT_SIXTY, near).value == pytest.approx(uniform.peak_power_w.value, rel=1e-5)
    steep = replace(USUAL, pressure_angle_rad=1e-4)
    assert least_acceleration(AT_SIXTY, steep).value == pytest.approx(
        uniform.peak_acceleration_cycle_mm_s2.value, rel=2e-3
    )


@pytest.mark.parametrize("room", [0.0, 5e-10, -5e-10])
def test_a_limit_at_the_mean_to_ten_digits_is_refused(room: float) -> None:
    for limits, key in (
        (Limits(1.0 - room, 5.0), "optimize.limits.ratio_min"),
        (Limits(0.2, 1.0 + room), "optimize.limits.ratio_max"),
    ):
        with pytest.raises(NoSuchMechanism, match="leaves nothing to choose") as refused:
            least_power(AT_SIXTY, limits)
        assert refused.value.key == key


def test_scaling_with_speed_and_size() -> None:
    """Half the speed: a quarter of the acceleration at half the power.  Twice the size at equal force: twice both."""
    base = acceleration(60.0, 9000.0)
    assert acceleration(30.0, 4500.0).value == pytest.approx(base.value / 4.0, rel=1e-6)
    longer = PolynomialResistance(tuple(c / 2.0**k for k, c in enumerate(FIT)))
    task = Task(CrankSlider(760.0, 1920.0), longer, 60.0 * RPM)
    assert least_acceleration(task, replace(USUAL, peak_power_w=18000.0)).value == pytest.approx(
        2.0 * base.value, rel=1e-6
    )


def test_two_lobes_are_twice_the_speed() -> None:
    """A driving gear of two lobes has half a turn for the cycle: as one at twice the speed, with twice the ratio."""
    two = Task(BALER_LINKAGE, PRESS, 30.0 * RPM, Lobes(2))
    found = least_acceleration(two, Limits(0.1, 2.5, peak_power_w=9000.0))
    assert found.value == pytest.approx(acceleration(60.0, 9000.0).value, rel=1e-6)
    with pytest.raises(WrongInput, match="2 lobes of the driven gear"):
        Task(BALER_LINKAGE, PRESS, 1.0, Lobes(1, 2))


@pytest.mark.slow
def test_more_freedom_never_costs() -> None:
    tight = Limits(0.4, 2.5, peak_power_w=15000.0, pressure_angle_rad=0.5, working_rad=3.6)
    freer = [
        replace(tight, ratio_min=0.3),
        replace(tight, ratio_max=3.0),
        replace(tight, peak_power_w=16000.0),
        replace(tight, pressure_angle_rad=0.8),
        replace(tight, working_rad=None),
    ]
    value = least_acceleration(AT_SIXTY, tight).value
    assert all(least_acceleration(AT_SIXTY, limits).value <= value * (1.0 + 1e-6) for limits in freer)
    assert least_acceleration(AT_SIXTY, freer[-1]).value < value


RESISTANCES: dict[str, Resistance] = {
    "none": NONE,
    "fit": PRESS,
    "fit, kept": PolynomialResistance(FIT, keep_negative=True),
    "table": TableResistance((0.0, 200.0, 210.0, 600.0, 760.0), (0.0, 50.0, 3000.0, 3000.0, 20000.0)),
    "expression": FormulaResistance("300 + 20000*exp(-(x - 500)**2/2000)"),
}

LINKAGES = {
    "in line": BALER_LINKAGE,
    "offset": OFFSET,
    "offset the other way": CrankSlider(380.0, 960.0, -300.0),
    "short rod": CrankSlider(380.0, 456.0),
    "very long rod": CrankSlider(380.0, 1e6),
}


def harmonic_law(seed: int) -> Transmission:
    """phi2 = phi1 + harmonics, its slope well over zero."""
    random = np.random.default_rng(seed)
    order = np.arange(1, 5)
    size = random.normal(size=4) / order**2
    size *= random.uniform(0.2, 0.9) / np.abs(size * order).sum()
    phase = random.uniform(0.0, 2.0 * pi, 4)

    def driven_angle(phi1: Array, degree: int) -> Jet:
        variable = Jet.variable(phi1, degree)
        total = variable
        for k, a, p in zip(order.tolist(), size.tolist(), phase.tolist(), strict=True):
            total = total + a * (jet.sin_cos(variable * float(k) + p)[0] - float(np.sin(p)))
        return total

    return Transmission((Piece(0.0, 2.0 * pi, driven_angle),), Lobes())


def figures(machine: Machine, mass_kg: float) -> tuple[Peaks, Limits]:
    """Peaks of a law, and the limits it keeps: its ratios, its pressure angle, its working stroke."""
    phi1 = np.concatenate([np.linspace(0.0, 2.0 * pi, 20001), [machine.extended_rad]])
    driven = machine.transmission.driven_angle(phi1, 2)
    motion = machine.motion(phi1)
    power = motion.force_n * motion.velocity_mm_s * 1e-3 * np.where(motion.velocity_mm_s > 0.0, 1.0, 0.0)
    power += mass_kg * motion.acceleration_mm_s2 * motion.velocity_mm_s * 1e-6
    steer = driven.derivative(2) / driven.derivative(1) / (1.0 + driven.derivative(1))
    found = kinematic_check(machine)
    between = 1.0 + 1e-6  # samples of smooth curves, 3e-4 rad apart
    low, high = machine.transmission.ratio_range
    limits = Limits(
        low.value / between,
        high.value * between,
        working_rad=machine.extended_rad,
        pressure_angle_rad=max(float(np.arctan(np.abs(steer).max() * between)), 1e-6),
        mass_kg=mass_kg,
    )
    return Peaks(found.peak_acceleration_cycle_mm_s2.value, max(float(power.max()) * between, 1e-9)), limits


def assert_not_beaten(machine: Machine, mass_kg: float) -> None:
    """Its own peaks are open to a law that keeps its own limits; each limit alone, and all together."""
    task = Task(machine.linkage, machine.resistance, machine.speed_rad_s)
    peaks, limits = figures(machine, mass_kg)
    for kept in (limits, replace(limits, working_rad=None), replace(limits, pressure_angle_rad=None)):
        for cells in (60, 401):
            assert Problem(task, kept, cells).is_open(peaks)


@pytest.mark.judges("optimum")
@pytest.mark.tiers(quick=["0-*", "1-*"], rest="thorough")
@pytest.mark.parametrize("mass_kg", [0.0, 80.0])
@pytest.mark.parametrize("seed", range(12))
def test_random_laws_do_not_beat_the_limit(seed: int, mass_kg: float) -> None:
    linkage = list(LINKAGES.values())[seed % len(LINKAGES)]
    resistance = list(RESISTANCES.values())[seed // 2 % len(RESISTANCES)]
    assert_not_beaten(Machine(harmonic_law(seed), linkage, resistance, 5.0), mass_kg)


@pytest.mark.tiers(quick=["*-uniform"], rest="thorough")
@pytest.mark.parametrize("name", ["uniform", "stroke, e = 0"])
@pytest.mark.parametrize("resistance", RESISTANCES)
def test_known_laws_do_not_beat_the_limit(name: str, resistance: str) -> None:
    assert_not_beaten(Machine(law(name), BALER_LINKAGE, RESISTANCES[resistance], 5.0), 0.0)
    assert_not_beaten(Machine(law(name), BALER_LINKAGE, RESISTANCES[resistance], 5.0), 50.0)


def test_the_uniform_crank_is_on_its_own_limit() -> None:
    """Control of the test above: with its own ratio, one hundredth less of either peak is certainly too little."""
    machine = Machine(uniform_law(Lobes()), BALER_LINKAGE, PRESS, 5.0)
    peaks, limits = figures(machine, 0.0)
    problem = Problem(Task(BALER_LINKAGE, PRESS, 5.0), limits, 401)
    assert not problem.is_open(Peaks(peaks.acceleration_mm_s2, 0.99 * peaks.power_w))
    assert not problem.is_open(Peaks(0.99 * peaks.acceleration_mm_s2, peaks.power_w))


def test_a_bound_pushed_up_is_beaten_by_a_motion() -> None:
    """Negative control: the fastest motion 0.9 % over the bound, held against all limits here, closes the cycle."""
    bound = acceleration(60.0, 9000.0)
    most = 1.009 * bound.value
    motion = fastest_motion(AT_SIXTY, replace(USUAL, peak_power_w=9000.0, peak_acceleration_mm_s2=most), 6400)
    energy = motion.speed_mm_s**2 / 2.0
    assert np.abs(np.diff(energy) / np.diff(motion.travel_mm)).max() <= most * (1.0 + 1e-6)
    out = motion.crank_angle_rad <= pi + 1e-12
    power = PRESS.force_n(np.where(out, motion.travel_mm, 0.0)) * motion.speed_mm_s / 1000.0
    assert power.max() <= 9000.0 * (1.0 + 1e-9)
    assert motion.slope.max() <= 5.0
    assert motion.slope.min() >= 0.2
    seconds = (2.0 * np.diff(motion.travel_mm) / (motion.speed_mm_s[1:] + motion.speed_mm_s[:-1])).sum()
    assert seconds < 1.0
    assert seconds == pytest.approx(motion.driving_rad / (2.0 * pi), rel=1e-4)
    low = replace(USUAL, peak_power_w=9000.0, peak_acceleration_mm_s2=0.999 * bound.value)
    with pytest.raises(NoSuchMechanism):
        fastest_motion(AT_SIXTY, low)


@pytest.mark.parametrize("mass_kg", [5.0, 100.0])
def test_moving_a_mass_against_an_integrated_motion(mass_kg: float) -> None:
    """A backwards, then v dv/dx = min(A, (P/v - F)/m) forwards: its time is the limit's, at the same peaks."""
    peaks = Peaks(26000.0, 6300.0)
    limits = replace(WIDE, mass_kg=mass_kg)
    exact = pushed_seconds(peaks, mass_kg)
    for cells, rel in ((3200, 2e-2), (12800, 5e-3)):
        problem = Problem(AT_SIXTY, limits, cells)
        ceilings = problem.ceilings(peaks)
        assert ceilings is not None
        found = problem.least_durations_s(peaks, ceilings)[0]
        assert found <= exact
        assert found == pytest.approx(exact, rel=rel)


@pytest.mark.slow
def test_a_mass_on_the_cells_taken_then_costs_0_2_per_cent() -> None:
    """docs/method.md; the limit from two finer grids, the error being of first order in the cell."""
    limits = replace(USUAL, peak_power_w=6300.0, mass_kg=100.0)
    coarse, fine, finer = (least_acceleration(AT_SIXTY, limits, cells).value for cells in (6400, 12800, 25600))
    limit = 2.0 * finer - fine
    assert (finer - fine) / (fine - coarse) == pytest.approx(0.5, abs=0.1)
    assert round(100.0 * (limit - coarse) / limit, 1) == 0.2
    assert PRESSING_SHARE == 0.8  # four cells in five


def pushed_seconds(peaks: Peaks, mass_kg: float) -> float:
    """Time of the working stroke by 200 000 plain steps."""
    stroke, most, power = 760.0, peaks.acceleration_mm_s2, 1e6 * peaks.power_w
    x = np.sin(np.linspace(0.0, pi / 2.0, 200001)) ** 2 * stroke
    force = 1e3 * PRESS.force_n(x)
    lacking = np.maximum(force - mass_kg * most, 1e-3)
    ceiling = np.minimum((power / lacking) ** 2 / 2.0, most * (stroke - x))
    braked = np.minimum.accumulate((ceiling + most * x)[::-1])[::-1] - most * x
    u = [0.0]
    for step, against, top in zip(np.diff(x).tolist(), force.tolist(), braked[1:].tolist(), strict=False):
        speed = sqrt(2.0 * u[-1])
        slope = min(most, (power / speed - against) / mass_kg) if speed else most
        u.append(max(min(u[-1] + step * slope, top), 0.0))
    speeds = np.sqrt(2.0 * np.array(u))
    return float((2.0 * np.diff(x) / (speeds[1:] + speeds[:-1])).sum())


@pytest.mark.thorough
def test_a_mass_alone_needs_its_kinetic_power() -> None:
    """No resistance, acceleration and ratios free: at constant power P over a stroke in t, 8/9 P t^3 = m H^2, at once
    stopped; half the cycle each."""
    task = Task(BALER_LINKAGE, NONE, 2.0 * pi)
    found = least_power(task, replace(WIDE, mass_kg=10.0))
    exact = 9.0 / 8.0 * 10.0 * 0.76**2 / 0.5**3
    assert found.value <= exact
    assert found.value == pytest.approx(exact, rel=1e-2)


def test_no_resistance_needs_no_power() -> None:
    assert least_power(Task(BALER_LINKAGE, NONE, 2.0 * pi), USUAL).value == 0.0


@pytest.mark.tiers(quick=["expression-short rod", "fit-offset"], thorough=["expression-*", "fit-*"], rest="slow")
@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("resistance", RESISTANCES)
def test_other_machines_are_enclosed(linkage: str, resistance: str) -> None:
    task = Task(LINKAGES[linkage], RESISTANCES[resistance], 2.0 * pi)
    least = least_acceleration(task, USUAL).value
    found = least_power(task, replace(USUAL, peak_acceleration_mm_s2=1.5 * least))
    assert found.gap < 5e-3 or found.attained < 1e-9
    for cells in (100, 350):
        coarse = least_power(task, replace(USUAL, peak_acceleration_mm_s2=1.5 * least), cells)
        assert coarse.value <= found.attained
        assert found.value <= coarse.attained


@pytest.mark.slow
def test_pressure_angle_links_the_strokes() -> None:
    free = acceleration(60.0, 12000.0).value
    found = [
        least_acceleration(AT_SIXTY, replace(USUAL, peak_power_w=12000.0, pressure_angle_rad=radians(angle)))
        for angle in (20.0, 30.0, 40.0, 60.0, 89.9)
    ]
    values = [bound.value for bound in found]
    assert values == sorted(values, reverse=True)
    assert values[-1] == pytest.approx(free, rel=1e-3)
    assert values[0] > 1.15 * free
    assert all(bound.gap < 0.02 for bound in found)


@pytest.mark.slow
def test_weighted_sum_against_a_scan_of_powers() -> None:
    weights = Weights(1.0 / 20000.0, 1.0 / 9000.0)
    found = least_weighted_sum(AT_SIXTY, USUAL, weights)
    assert found.gap <= 5e-3
    scan = [weights.of(acceleration(60.0, power, 400).attained, power) for power in np.linspace(7000.0, 11000.0, 17)]
    assert found.value <= min(scan)
    assert found.attained <= min(scan) * 1.005


@pytest.mark.slow
def test_weighted_sum_on_a_grid_too_coarse_for_its_tolerance() -> None:
    """Ends all the same, with an honest enclosure that holds the finer one's."""
    weights = Weights(1.0 / 20000.0, 1.0 / 9000.0)
    coarse = least_weighted_sum(AT_SIXTY, USUAL, weights, cells=100, tolerance=1e-2)
    fine = least_weighted_sum(AT_SIXTY, USUAL, weights)
    assert coarse.gap > 1e-2
    assert coarse.value <= fine.attained
    assert fine.value <= coarse.attained


@pytest.mark.thorough
def test_weighted_sum_where_one_peak_is_all() -> None:
    dear_power = least_weighted_sum(AT_SIXTY, USUAL, Weights(1e-9, 1.0))
    assert dear_power.value == pytest.approx(least_power(AT_SIXTY, USUAL).value, rel=6e-3)
    dear_acceleration = least_weighted_sum(AT_SIXTY, USUAL, Weights(1.0, 1e-9))
    assert dear_acceleration.value == pytest.approx(acceleration(60.0, None).value, rel=6e-3)
    alone = least_weighted_sum(Task(BALER_LINKAGE, NONE, 2.0 * pi), USUAL, Weights(1.0, 1.0))
    assert alone.value == pytest.approx(acceleration(60.0, None).value, rel=6e-3)


def test_no_weight_is_refused() -> None:
    with pytest.raises(WrongInput, match=r"optimize\.weights\.power_w: 1/0 given"):
        Weights(1.0, 0.0)


REFUSED = {
    "ratio too high": (Limits(1.2, 5.0), "optimize.limits.ratio_min", "at most 1 is right"),
    "ratio too low": (Limits(0.2, 0.9), "optimize.limits.ratio_max", "at least 1 is right"),
    "working stroke too quick": (Limits(0.2, 5.0, working_rad=0.5), "optimize.limits.ratio_min", "at most 0.15915"),
    "return too quick": (Limits(0.2, 5.0, working_rad=6.0), "optimize.limits.ratio_min", "at most 0.09014"),
    "working stroke of a cycle": (
        Limits(0.2, 5.0, working_rad=6.3),
        "optimize.limits.working_angle_rad",
        "less than a cycle",
    ),
    "little power": (Limits(0.2, 5.0, peak_power_w=3000.0), "optimize.limits.peak_power_w", "at least 5213.6 W"),
}


@pytest.mark.parametrize(("limits", "key", "said"), REFUSED.values(), ids=REFUSED)
def test_what_no_law_can_do_is_refused(limits: Limits, key: str, said: str) -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        least_acceleration(AT_SIXTY, limits)
    assert caught.value.key == key
    assert said in caught.value.problem


def nearest(error: DesignError) -> float:
    """The first number after "at least"."""
    return float(error.problem.split("at least ")[1].split()[0])


def test_the_nearest_values_are_enough_and_no_more() -> None:
    for key, limits in (
        ("peak_power_w", Limits(0.2, 5.0, peak_power_w=3000.0)),
        ("peak_acceleration_mm_s2", Limits(0.2, 5.0, peak_acceleration_mm_s2=12000.0)),
        ("peak_acceleration_mm_s2", Limits(0.2, 5.0, peak_acceleration_mm_s2=15000.0, peak_power_w=9000.0)),
    ):
        with pytest.raises(NoSuchMechanism) as caught:
            fastest_motion(AT_SIXTY, limits)
        assert caught.value.key == f"optimize.limits.{key}"
        enough = nearest(caught.value)
        assert fastest_motion(AT_SIXTY, replace(limits, **{key: enough})).driving_rad <= 2.0 * pi * (1.0 + 1e-8)
        with pytest.raises(NoSuchMechanism):
            fastest_motion(AT_SIXTY, replace(limits, **{key: 0.999 * enough}))


@pytest.mark.thorough
def test_a_pressure_angle_too_small_is_refused_with_what_would_do() -> None:
    narrow = Limits(0.2, 5.0, pressure_angle_rad=radians(20.0), peak_power_w=9000.0)
    with pytest.raises(NoSuchMechanism, match="or a pressure angle of") as caught:
        least_acceleration(AT_SIXTY, narrow, 800)
    assert caught.value.key == "optimize.limits.peak_power_w"
    least_acceleration(AT_SIXTY, replace(narrow, peak_power_w=nearest(caught.value)), 800)
    angle = float(caught.value.problem.split("angle of ")[1].split()[0])
    assert 20.0 < angle < 25.0
    assert least_acceleration(AT_SIXTY, replace(narrow, pressure_angle_rad=radians(angle)), 800).value > 0.0
    with pytest.raises(NoSuchMechanism):
        least_acceleration(AT_SIXTY, replace(narrow, pressure_angle_rad=radians(angle - 0.01)), 800)


@pytest.mark.thorough
def test_the_pressure_angle_of_a_refusal_includes_the_rack() -> None:
    """As the key of design files counts it, so that the number can be copied there; with a steep rack there is none."""
    narrow = Limits(0.2, 5.0, pressure_angle_rad=radians(18.0), peak_power_w=8500.0)
    said = []
    for rack in (0.0, 14.5, 25.0, 69.0):
        with pytest.raises(NoSuchMechanism) as caught:
            least_acceleration(AT_SIXTY, replace(narrow, rack_angle_rad=radians(rack)), 800)
        said.append(caught.value.problem)
    angles = [float(text.split("angle of ")[1].split()[0]) for text in said[:3]]
    assert np.diff(angles) == pytest.approx([14.5, 10.5], abs=2e-3)
    assert "of which the rack has 14.5" in said[1]
    assert "pressure angle" not in said[3]


@pytest.mark.parametrize(
    ("wrong", "key"),
    [
        ({"ratio_min": 0.0}, "limits.ratio_min"),
        ({"ratio_max": 0.1}, "limits.ratio_max"),
        ({"peak_power_w": -1.0}, "limits.peak_power_w"),
        ({"peak_acceleration_mm_s2": float("nan")}, "limits.peak_acceleration_mm_s2"),
        ({"working_rad": 0.0}, "limits.working_angle_rad"),
        ({"pressure_angle_rad": pi / 2.0}, "limits.pressure_angle_deg"),
        ({"mass_kg": -1.0}, "masses.slider_kg"),
    ],
)
def test_limits_that_bound_nothing_are_refused(wrong: dict[str, float], key: str) -> None:
    with pytest.raises(WrongInput) as caught:
        replace(USUAL, **wrong)
    assert caught.value.key.removeprefix("optimize.") == key


@pytest.mark.parametrize("at", [1e-6, 0.3, 1.0, 2.0, 1e6])
def test_turning_point(at: float) -> None:
    found = turning_point(lambda value: value >= at, 1.0)
    assert found is not None
    assert found[0] < at <= found[1] <= found[0] * (1.0 + 1e-7)


def test_turning_point_that_is_not_there() -> None:
    assert turning_point(lambda value: False, 1.0) is None
    assert turning_point(lambda value: True, 1.0) == (0.0, 2.0**-60)
