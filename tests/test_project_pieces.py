"""Searches and choices of the project by themselves, on answers made by hand: motors, shafts, materials, rings."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from at_once import at_once
from drives import drive_of_text
from ncgear.drivetrain.speed import LineDrive
from ncgear.dynamics.motion_in_time import EvenDrive, Motor
from ncgear.errors import WrongInput
from ncgear.optimum.outline.rolled import Rolled, SplineBasis
from ncgear.pitch.shape import Gear
from ncgear.project import drivetrain, gear_solids, strengthening
from ncgear.project.alternatives import _least_addendum
from ncgear.project.best_law import BestLaw
from ncgear.project.compared import JAM_RAD, ComparedPair
from ncgear.project.forces import drive_line_of
from ncgear.project.gear_solids import rim_mm_of
from ncgear.project.motor import _line_drive
from ncgear.project.moving import disc_kg_mm2
from ncgear.project.outline_trial import control_points
from ncgear.teeth.tips import Limit

pytestmark = pytest.mark.judges("project")

Made: Any = SimpleNamespace

# --- motors ----------------------------------------------------------------------------------------------------------


def motor(**changes: Any) -> Any:
    values = {"rated_torque_n_m": 20.0, "rated_speed_rpm": 1425.0, "no_load_speed_rpm": 1500.0,
              "overrunning_clutch": False, "gearbox": Made(ratio=25.0, efficiency=0.9)}  # fmt: skip
    return Made(**values | changes)


def test_a_motor_s_line_goes_through_its_rated_point() -> None:
    """At 1425 r/min it gives its 20 N m, and at the driving gear 25 times 0.9 of it at a twenty-fifth of the speed."""
    found = _line_drive(Made(simulation=Made(motor=None)), motor())
    assert isinstance(found, LineDrive)
    rated = 1425.0 * pi / 30.0
    assert float(found.line.torque_n_mm(np.array(rated))) == pytest.approx(20e3)
    assert float(found.line.torque_n_mm(np.array(1500.0 * pi / 30.0))) == pytest.approx(0.0, abs=1e-6)
    assert float(found.torque_n_mm(np.array(rated / 25.0))) == pytest.approx(20e3 * 25.0 * 0.9)
    assert _line_drive(Made(simulation=Made(motor=None)), motor(no_load_speed_rpm=None)) is None


def test_the_simulation_s_line_is_at_the_driving_gear_behind_the_gearbox() -> None:
    simulated = Made(stall_torque_n_m=400.0, no_load_speed_rpm=60.0)
    found = _line_drive(Made(simulation=Made(motor=simulated)), motor(no_load_speed_rpm=None))
    assert found is not None
    for share in (0.0, 0.5, 0.9):
        speed = np.array(share * 2.0 * pi)
        assert float(found.torque_n_mm(speed)) == pytest.approx(400e3 * (1.0 - share))
    driving = Made(driving_shaft_kg_mm2=5e4)
    line = drive_line_of(Made(motor=simulated), driving, 3.0)
    assert isinstance(line, Motor)
    assert (line.speed_rad_s, line.stall_torque_n_mm) == pytest.approx((2.0 * pi, 400e3))
    assert drive_line_of(Made(motor=None), driving, 3.0) == EvenDrive(3.0)
    with pytest.raises(WrongInput, match="needs inertia"):
        drive_line_of(Made(motor=simulated), Made(driving_shaft_kg_mm2=0.0), 3.0)


# --- shafts ----------------------------------------------------------------------------------------------------------


def shaft(fatigue: float, yielding: float, key: float, moment: float, both: bool) -> Any:
    return ShaftResult(
        bearings=(None, None), most_bent=Made(moment_n_mm=moment), shaft=Safeties(fatigue, yielding),
        key=KeyOf(key, both), enough_mm=moment,
    )  # fmt: skip


def test_each_part_of_a_shaft_is_told_as_it_is_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drivetrain, "_worse_bearing", lambda one, other: "worse")
    found: Any = drivetrain._worse(shaft(5.0, 2.0, 3.0, 40.0, True), shaft(4.0, 2.5, 6.0, 30.0, False))
    assert found.bearings == ("worse", "worse")
    assert (found.shaft.fatigue, found.shaft.yielding) == (4.0, 2.0)
    # The diameter that is enough is that of the less safe case: of 2.0 against yielding.
    assert found.enough_mm == 40.0
    assert found.most_bent.moment_n_mm == 40.0
    assert (found.key.safety, found.key.both_senses) == (3.0, True)


@dataclass(frozen=True)
class Safeties:
    """Of a shaft."""

    fatigue: float
    yielding: float


@dataclass(frozen=True)
class KeyOf:
    """A key's safety, and whether its torque changes sense."""

    safety: float
    both_senses: bool


@dataclass(frozen=True)
class ShaftResult:
    """What is known of a shaft."""

    bearings: Any
    most_bent: Any
    shaft: Any
    key: Any
    enough_mm: float


# --- materials, rings, chords ----------------------------------------------------------------------------------------


@at_once("weakest", [0, 1, 3, 4, 99])
def test_the_weakest_material_that_holds_is_found(weakest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """As by trying all; none where the strongest does not hold."""
    names = tuple("abcde")
    monkeypatch.setattr(strengthening, "STRONGER", names)
    tried = []

    def holds(one: Any, rating: Any, changes: dict[str, Any]) -> bool:
        tried.append(changes["gears.material"])
        return names.index(tried[-1]) >= weakest

    monkeypatch.setattr(strengthening, "_holds", holds)
    for own, above in ((None, 0), ("b", 2), ("other", 0)):
        given = None if own is None else Made(each=(Made(name=own), Made(name="other")))
        monkeypatch.setattr(strengthening, "ASSUMED", "other")
        found = strengthening.strong_enough(Made(gears=Made(material=given)), None)  # type: ignore[arg-type]
        good = [name for place, name in enumerate(names) if place >= max(weakest, above)]
        assert found == ({"gears.material": good[0]} if good else {})
    assert len(tried) <= 11


def test_a_ring_stands_for_its_teeth_between_its_rim_and_its_pitch_curve() -> None:
    """Round, of 60 teeth of module 2: pi/2 (R^4 - 60^4) times width and density, R the rim's."""
    around = np.linspace(0.0, 2.0 * pi, 4000, endpoint=False)

    def curve(gear: Gear, radius_mm: float) -> Any:
        points = radius_mm * np.column_stack([np.cos(around), np.sin(around)])
        return Made(gear=gear, is_ring=gear is Gear.DRIVEN, drawn=lambda count: Made(position=points))

    gears = drive_of_text(
        "name: ring\noperation: {speed_rpm: 9}\nmotion: {law: uniform_crank}\n"
        "gears: {mesh: internal, lobes: {driven: 2}, teeth: 30, module_mm: 2, face_width_mm: 10}\n"
    ).gears
    found = disc_kg_mm2(gears, curve(Gear.DRIVEN, 60.0), 2.0, 7850.0)
    outer = 60.0 + rim_mm_of(gears, 2.0)
    assert found == pytest.approx(7850e-9 * 10.0 * pi / 2.0 * (outer**4 - 60.0**4), rel=1e-4)
    disc = disc_kg_mm2(gears, curve(Gear.DRIVING, 30.0), 2.0, 7850.0)
    assert disc == pytest.approx(7850e-9 * 10.0 * pi / 2.0 * 30.0**4, rel=1e-4)


def test_the_finest_chords_of_several_pairs_are_those_of_the_coarsest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points grow as the root of the fineness: twice as many as are soon made ask for four times the tolerance."""
    made = {"a": (0.001, 0.5 * gear_solids.SOON), "b": (0.003, 2.0 * gear_solids.SOON)}
    monkeypatch.setattr(gear_solids, "finest_tolerance_mm", lambda pitch, form, at: made[pitch])
    pairs: Any = [("a", None, None), ("b", None, None)]
    assert gear_solids.finest_chords_mm(pairs, 1e-4) == pytest.approx((0.003, 0.012))
    assert gear_solids.finest_chords_mm(pairs[:1], 1e-4) == pytest.approx((0.001, 0.001))


def test_an_addendum_is_just_under_the_lowest_tip_that_was_cut() -> None:
    """In modules, without the profile shift; tips that no land lowered do not count."""
    flanks = Made(full_tip_mm=np.full(4, 2.6), tip_height_mm=np.array([2.2, 1.0, 2.4, 2.6]),
                  rack=Made(tip_height_mm=2.6, shift_mm=0.6, module_mm=2.0))  # fmt: skip
    limits = np.array([Limit.LAND, -1, Limit.LAND, -1], dtype=object)
    found = _least_addendum(Made(flanks=flanks, tips=Made(limit=limits)))
    assert 0.79 < found < 0.8
    none = _least_addendum(Made(flanks=flanks, tips=Made(limit=np.full(4, -1))))
    assert none == np.inf


def test_a_gap_is_the_share_over_a_limit_that_counts_alone() -> None:
    gap = BestLaw.gap.func if hasattr(BestLaw.gap, "func") else BestLaw.gap.fget  # type: ignore[attr-defined]
    assert gap(Made(limit=Made(value=80.0), soft=False, goal=84.0)) == pytest.approx(0.05)
    assert gap(Made(limit=None, soft=False, goal=84.0)) is None
    assert gap(Made(limit=Made(value=0.0), soft=False, goal=84.0)) is None
    assert gap(Made(limit=Made(value=80.0), soft=True, goal=84.0)) is None


def test_jams_are_told_by_their_teeth_the_tightest_first() -> None:
    """The extreme between positions first; each pair of teeth once, and none that has room."""
    play = np.array([1.0, -2.0, -5.0, -3.0, 0.0]) * 10.0 * JAM_RAD
    jams = ComparedPair.jams.fget  # type: ignore[attr-defined]
    extremes = Made(backlash_rad=Made(low=Made(value=-9.0 * JAM_RAD)), tightest_teeth=(3, 7))
    placement = Made(teeth_at=lambda place: (place // 2, 7))
    one = Made(measured=Made(backlash_rad=play), placement=placement, measured_extremes=extremes)
    assert jams(one) == [(3, 7), (1, 7), (0, 7)]
    one.measured_extremes.backlash_rad.low.value = -0.5 * JAM_RAD
    assert jams(one) == [(1, 7), (0, 7)]


def test_control_points_draw_the_curve() -> None:
    """By scipy's own splines of degree five, around the axis: to a ten-thousandth of a millimetre."""
    basis = SplineBasis(24)
    phi = 2.0 * pi * np.arange(24) / 24
    curve = Rolled(basis, basis.through(30.0 + 4.0 * np.cos(phi) + np.sin(2.0 * phi)), np.array([5.0, -3.0]), 80.0, 40)
    points = control_points(curve)
    count = len(points)
    closed = np.vstack([points, points[:5]])
    spline = BSpline(np.arange(-5.0, count + 6.0), closed, 5)
    drawn = spline(np.linspace(0.0, count, 999)) - curve.axis_mm
    polar = np.mod(np.arctan2(drawn[:, 1], drawn[:, 0]), 2.0 * pi)
    radius = basis.at(polar) @ curve.coefficients
    assert np.hypot(*drawn.T) == pytest.approx(radius, abs=2e-3)
