"""The formulas of the search for best laws, place by place: by mpmath's differences, polynomials and trials."""

from __future__ import annotations

from functools import cache
from math import cos, inf, pi, radians, sin, tan
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from at_once import at_once
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.sweeps import Sweeps, SweptLimits
from ncgear.optimum.makeable import levels, quantities
from ncgear.optimum.makeable.places import cell_ends, places
from ncgear.optimum.makeable.quantities import RatioPlace, Slider
from ncgear.optimum.makeable.reached import over_turn, peaks, running
from ncgear.optimum.outline.nearest import best_phases
from ncgear.optimum.task import GearSize, Task
from ncgear.ratio.transmission import Lobes

pytestmark = pytest.mark.judges("optimum")

SPEED, AT = 7.0, 1.1

Fake: Any = SimpleNamespace

# --- quantities of a law ---------------------------------------------------------------------------------------------


def ratio(phi: Any) -> Any:
    """i12 = dphi1/dphi2."""
    return mp.exp(mp.mpf("0.3") * mp.sin(phi) + mp.mpf("0.1") * mp.cos(2 * phi))


def second_ratio(phi: Any) -> Any:
    """iB of a second pair, over the same crank."""
    return mp.exp(mp.mpf("0.2") * mp.cos(phi) - mp.mpf("0.05") * mp.sin(3 * phi))


def way(phi: Any) -> Any:
    """The slider's displacement in mm."""
    return 40 * (1 - mp.cos(phi)) + 3 * mp.sin(2 * phi)


def by_time(of: Any, speed: float = SPEED) -> Any:
    """d/dt = w (1/i) d/dphi2."""
    return lambda phi: speed / ratio(phi) * mp.diff(of, phi)


def place(of: Any) -> RatioPlace:
    log = [float(mp.diff(lambda phi: mp.log(of(phi)), AT, order)) for order in range(3)]
    return RatioPlace(log[0], float(of(AT)), 1.0 / float(of(AT)), log[1], log[2])


def slider(**more: float) -> Slider:
    first, second, third = (float(mp.diff(way, AT, order)) for order in (1, 2, 3))
    return Slider(first, second, third, 250.0, **more)._replace(log_first=float(np.log(abs(first))))


@cache
def exact() -> dict[str, float]:
    """Motion and pitch curves at the place, with 30 digits."""
    with mp.workdps(30):
        velocity = by_time(way)
        found = {"velocity": velocity, "acceleration": by_time(velocity), "jerk": by_time(by_time(velocity))}
        told = {name: float(one(AT)) for name, one in found.items()}
        # Polar curves of a unit centre distance: by the driving angle, and by the driven one.
        radii = (lambda phi: 1 / (1 + ratio(phi))), (lambda phi: ratio(phi) / (1 + ratio(phi)))
        bends = []
        for radius, speed in zip(radii, (ratio, lambda phi: mp.mpf(1)), strict=True):
            by_angle = lambda of, speed=speed: lambda phi: mp.diff(of, phi) / speed(phi)  # noqa: E731
            r, r1 = radius(AT), by_angle(radius)(AT)
            r2 = by_angle(by_angle(radius))(AT)
            bends.append((r**2 + 2 * r1**2 - r * r2) / mp.power(r**2 + r1**2, 1.5))
            told["length"] = float(mp.sqrt(r**2 + r1**2) * speed(AT))
            told.setdefault("tangent", float(-r1 / r))
        told["driving"], told["driven"] = map(float, bends)
    return told


def test_motion_is_that_of_derivatives_by_time() -> None:
    law, machine = place(ratio), slider()
    assert quantities.velocity(law, machine, SPEED) == pytest.approx(exact()["velocity"], rel=1e-12)
    assert quantities.log_speed(law, machine, SPEED) == pytest.approx(np.log(exact()["velocity"]), rel=1e-12)
    assert quantities.acceleration(law, machine, SPEED) == pytest.approx(exact()["acceleration"], rel=1e-12)
    assert quantities.jerk(law, machine, SPEED) == pytest.approx(exact()["jerk"], rel=1e-12)
    assert quantities.power(law, machine, SPEED) == pytest.approx(0.25 * exact()["velocity"], rel=1e-12)


def test_pitch_curves_are_those_of_their_polar_forms() -> None:
    law = place(ratio)
    assert quantities.tangent(law) == pytest.approx(exact()["tangent"], rel=1e-12)
    assert quantities.driving_curvature(law) == pytest.approx(exact()["driving"], rel=1e-12)
    assert quantities.driven_curvature(law) == pytest.approx(exact()["driven"], rel=1e-12)
    assert quantities.relative_curvature(law) == pytest.approx(exact()["driving"] + exact()["driven"], rel=1e-12)
    assert quantities.length_rate(law) == pytest.approx(exact()["length"], rel=1e-12)
    for bulge, bend in ((quantities.driving_bulge, "driving"), (quantities.driven_bulge, "driven")):
        assert np.sign(bulge(law)) == np.sign(exact()[bend])
    # r2 cos(alpha +- the angle of the curves), by plain trigonometry.
    radius, steep = law.ratio / (1.0 + law.ratio), np.arctan(exact()["tangent"])
    levers = [1.0 / one for one in quantities.inverse_levers(law, (0.3, 0.5))]
    assert levers == pytest.approx([radius * cos(0.3 + steep), radius * cos(0.5 - steep)], rel=1e-12)


def test_loads_go_with_the_square_of_the_speed_and_its_rate() -> None:
    """w^2 (A q + B q'/2) with q = (dphi2/dphi1)^2, from numerical derivatives."""
    with mp.workdps(30):
        square = lambda phi: 1 / ratio(phi) ** 2  # noqa: E731
        q, half = float(square(AT)), float(mp.diff(square, AT)) / 2.0
    law = place(ratio)
    names = [f"{load}{part}" for load in ("torque", "bearing_x", "bearing_y") for part in ("", "_by_q", "_by_rate")]
    names += [f"shaking_{axis}_{part}" for axis in "xy" for part in ("by_q", "by_rate")]
    given = {name: 1.5 + 0.7 * number for number, name in enumerate(names)}
    machine = slider(**given)

    def load(name: str) -> float:
        return given.get(name, 0.0) + SPEED**2 * (given[f"{name}_by_q"] * q + given[f"{name}_by_rate"] * half)

    assert quantities.driving_torque(law, machine, SPEED) == pytest.approx(load("torque") * law.slope, rel=1e-12)
    assert quantities.bearing_force(law, machine, SPEED) == pytest.approx((load("bearing_x"), load("bearing_y")))
    assert quantities.shaking_force(law, machine, SPEED) == pytest.approx((load("shaking_x"), load("shaking_y")))


def test_two_pairs_have_their_own_ratios_over_their_own_driven_angles() -> None:
    """iA = i12/iB, its derivatives by the angle of the shaft between, and that shaft's motion."""
    first, last = quantities.pairs([place(ratio), place(second_ratio)])
    with mp.workdps(30):
        own = lambda phi: mp.log(ratio(phi) / second_ratio(phi))  # noqa: E731
        by_shaft = lambda of: lambda phi: mp.diff(of, phi) / second_ratio(phi)  # noqa: E731
        wanted = [float(own(AT)), float(by_shaft(own)(AT)), float(by_shaft(by_shaft(own))(AT))]
        shaft = by_time(lambda phi: 0, 1.0)
        speed = lambda phi: second_ratio(phi) / ratio(phi)  # noqa: E731
        product = float(speed(AT) * by_time(speed, 1.0)(AT))
        assert shaft(AT) == 0
    assert (first.log, first.first, first.second) == pytest.approx(tuple(wanted), rel=1e-10)
    assert (first.ratio, first.slope) == pytest.approx((np.exp(wanted[0]), np.exp(-wanted[0])))
    assert last == place(second_ratio)
    both = [place(ratio), place(second_ratio)]
    found = quantities.with_shaft_between(slider(between=4.0), both)
    assert found.between == pytest.approx(4.0 * product, rel=1e-10)
    assert quantities.with_shaft_between(slider(between=4.0), both[:1]).between == 0.0
    rates = quantities.length_rates(both)
    assert rates == pytest.approx((quantities.length_rate(first) * both[1].ratio, quantities.length_rate(both[1])))
    assert quantities.length_rates(both[:1]) == (quantities.length_rate(both[0]),)
    told = quantities.driving_torque(both[0], found, SPEED)
    assert told == pytest.approx(SPEED**2 * found.between, rel=1e-12)


# --- the judge -------------------------------------------------------------------------------------------------------


def test_peaks_of_parabolas_are_found_between_their_places() -> None:
    """In each step of cells of two and of four steps: a vertex inside, and the larger end where there is none."""
    x = np.linspace(0.0, 4.0, 5)
    for top, bend in ((0.3, -1.0), (1.7, -2.0), (2.0, -0.5), (3.9, -1.0), (1.0, 1.5), (9.0, -1.0), (-3.0, -1.0)):
        values = 5.0 + bend * (x - top) ** 2
        (found,) = peaks(values[None])
        fine = [5.0 + bend * (np.linspace(a, a + 1.0, 4001) - top) ** 2 for a in range(4)]
        assert found == pytest.approx([one.max() for one in fine], abs=1e-6)


def test_running_integrals_of_parabolas_are_exact() -> None:
    task = machine()
    at = places(task, cell_ends(task, np.linspace(0.0, 2.0 * pi, 9, endpoint=False), []), 4)
    angle = at.angle_rad[at.number]
    middle = at.ends_rad[:-1, None]
    # One parabola in each cell, whose integral goes on from the last one's.
    found = running(at, 1.0 + (angle - middle) - 2.0 * (angle - middle) ** 2)
    own = (angle - middle) + (angle - middle) ** 2 / 2.0 - 2.0 * (angle - middle) ** 3 / 3.0
    before = np.concatenate([[0.0], np.cumsum(own[:, -1])[:-1]])
    assert found == pytest.approx(before[:, None] + own, abs=1e-12)
    assert over_turn(at, np.cos(at.angle_rad) ** 2) == pytest.approx(pi, rel=1e-4)


# --- sweeps ----------------------------------------------------------------------------------------------------------

CRANK, ROD, MASS = 50.0, 180.0, 12.0


def machine(masses: bool = False) -> Task:
    linkage = CrankSlider(CRANK, ROD, 0.0)
    load = SliderLoad(PolynomialResistance((300.0, 4.0), keep_negative=False))
    moving = linkage.MASSES(slider_kg=MASS) if masses else None
    return Task(linkage, load, SPEED, masses=moving, gears=GearSize(30, 2.0, None, radians(20.0), radians(25.0)))


@at_once("masses", [True, False])
@at_once(("cell", "node"), [(3, 0), (9, 1), (14, 2), (21, 1)])
def test_slopes_of_sweeps_are_those_that_keep_every_limit(masses: bool, cell: int, node: int) -> None:
    """By trying slopes one by one: acceleration, power, braking, pressure angle and the load of both flanks."""
    task = machine(masses)
    limits: dict[str, Any] = {"acceleration_mm_s2": 4.4e3, "steepness": tan(0.9), "braking_w": 60.0}
    sweeps = Sweeps(task, Demands(0.3, 3.0, **limits), 24)
    known, at = sweeps.known, (cell, node)
    power_w, load_n_mm = (90.0, 2.5e5) if masses else (300.0, inf)
    asked = SweptLimits(np.full(3, load_n_mm), np.full(3, power_w), np.array([[0.0] * 3, [0.0] * 3]))
    q = np.array([0.5, 1.0, 1.3])
    with np.errstate(all="ignore"):
        least, most = sweeps.slopes(asked, at, q)
    step = known.ends_rad[cell + 1] - known.ends_rad[cell]
    phi = known.ends_rad[cell] + step * (1e-7, 0.5, 1.0 - 1e-7)[node]
    x = lambda a: CRANK * mp.cos(a) + mp.sqrt(ROD**2 - (CRANK * mp.sin(a)) ** 2)  # noqa: E731
    # The retracted end is where the crank points away from the slider.
    start = pi
    first, second = (float(mp.diff(x, start - phi, order)) * (-1.0) ** order for order in (1, 2))
    force = 300.0 + 4.0 * (float(x(start - phi)) - (ROD - CRANK)) if phi < pi else 0.0
    for number, square in enumerate(q):
        slopes = np.linspace(-8.0, 8.0, 32_001)
        s = np.sqrt(square)
        acceleration = SPEED**2 * (second * square + first * slopes / 2.0)
        torque = force * first + (MASS * 1e-3 * acceleration * first if masses else 0.0)
        watts = torque * SPEED * s / 1000.0
        kept = np.abs(acceleration) <= 4.4e3
        kept &= np.abs(slopes) <= 2.0 * tan(0.9) * (square + s)
        if masses:
            kept &= (watts <= power_w) & (watts >= -60.0)
            for sign, angle in ((1.0, radians(20.0)), (-1.0, radians(25.0))):
                room = load_n_mm * (s * cos(angle) + sign * slopes * sin(angle) / (2.0 * (1.0 + s)))
                kept &= sign * torque * (1.0 + s) ** 3 <= room
        if kept.any():
            assert (least[number], most[number]) == pytest.approx((slopes[kept].min(), slopes[kept].max()), abs=2e-3)
        else:
            assert least[number] > most[number]


def test_a_pair_rolls_no_more_than_its_pitch_curves_or_round_gears() -> None:
    assert GearSize(30, 2.0, None, 0.35).rolled_mm(Lobes(2, 1)) == pytest.approx(pi * 2.0 * 30 / 2)
    # Round gears of a distance of 90 mm, 1:2: the driven one turns once over radii of 60 mm.
    assert GearSize(None, None, 90.0, 0.35).rolled_mm(Lobes(1, 1)) == pytest.approx(2.0 * pi * 45.0)


# --- phases of two outlines ------------------------------------------------------------------------------------------


@at_once(("share", "fixed_size", "size"), [(0.0, False, 1.0), (0.5, False, 3.0), (1.0, True, 1.0), (0.5, True, 1.0)])
def test_two_ellipses_about_foci_are_turned_to_each_other(share: float, fixed_size: bool, size: float) -> None:
    """Equal ellipses roll on each other at the distance of their long axis, one's near end on the other's far one."""
    angle, long, eccentricity = 2.0 * pi * np.arange(360) / 360, 40.0, 0.3
    radius = long * (1.0 - eccentricity**2) / (1.0 + eccentricity * np.cos(angle))
    turned = np.roll(radius, 25)
    (best,) = best_phases([np.full(360, 30.0), radius], [np.full(360, 20.0), turned * size], share, fixed_size, 9)[:1]
    assert (best.own, best.mate) in ((1, 1), (0, 0))
    (pair,) = best_phases([radius], [turned * size], share, fixed_size, 1)
    assert pair.radius_mm == pytest.approx(radius, rel=3e-3)
    assert pair.scale == pytest.approx(1.0 / size, rel=1e-3)
    # The mate's far end is at 180 + 25 deg of its drawing, and meets the near end at 0.
    assert abs(np.angle(np.exp(1j * (pair.turned_rad - radians(205.0))))) < radians(1.5)


@pytest.mark.parametrize("stated", [True, False])
def test_the_load_of_teeth_is_the_torque_over_lever_and_distance(stated: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """With teeth and a module, the distance is that at which the pitch curve has their length."""
    monkeypatch.setattr(quantities, "driving_torque", lambda at, slider, speed: 3.0 * speed)
    monkeypatch.setattr(quantities, "inverse_levers", lambda at, angles: (10.0 * angles[0], 100.0 * angles[1]))
    monkeypatch.setattr(quantities, "relative_curvature", lambda at: 0.25)
    monkeypatch.setattr(levels, "of_figure", lambda *given: given)
    teeth, module = (30, 2.0) if stated else (None, None)
    gears = Fake(
        center_distance_mm=80.0,
        teeth=teeth,
        module_mm=module,
        rack_angle_rad=0.3,
        idle_angle_rad=0.4 if stated else None,
        rolled_mm=lambda lobes: 50.0 * lobes.driving,
    )
    task = Fake(gears=gears, cycle_rad=6.0, lobes=Fake(driving=3), speed_rad_s=7.0)
    scales = Fake(torque_n_mm=11.0)
    at, torque, back = Fake(ratio=0.5), 3.0 * 7.0 * 0.5, 0.4 if stated else 0.3
    distance = 30 * pi * 2.0 / (3 * 1.25) if stated else 80.0
    *_, unit, limit, price, sides = levels._tooth_force(task, scales, None, 0.5)
    assert (unit, limit, price) == (pytest.approx(11.0 * 6.0 / 150.0), None, 0.5)
    loads = np.array([torque * 3.0, -torque * 100.0 * back])
    assert sides(at, Fake(), 1.25) == pytest.approx(loads / distance / unit)
    *_, unit, limit, price, sides = levels._flank_load(task, scales, None, 0.5)
    assert (unit, limit, price) == (8.0 * 11.0, None, 0.5)
    assert sides(at, Fake(), 1.25) == pytest.approx(loads * 0.25 / unit)
    for load in (levels._tooth_force, levels._flank_load):
        *_, unit, limit, _, _ = load(task, scales, 40.0, 0.0)
        assert (unit, limit) == (40.0, 40.0)
