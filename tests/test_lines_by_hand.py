"""Lines of mathematics of many rooms, each on a few numbers that are done by hand."""

from __future__ import annotations

from math import asin, atan, cos, degrees, pi, radians, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear.contact.designed.curves import SidePaths
from ncgear.contact.written.extremes import _quantities
from ncgear.drawings.charts.drawer import angle_scale
from ncgear.drivetrain.bearings import BornePeaks, WantedLife, _life
from ncgear.drivetrain.losses import IDLE, Losses
from ncgear.drivetrain.motor import Stall
from ncgear.dynamics.flank_changes import closer
from ncgear.dynamics.gaps import ERROR, Gaps, _breaks
from ncgear.mechanisms.rack_pinion import BACK, TEETH, RackPinion
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.mechanisms.slotted_lever import BAR, SlottedLever
from ncgear.metrology import best_fit
from ncgear.metrology.best_fit import Pose
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.cycle import _nearest
from ncgear.optimum.outline.conditions import Subject
from ncgear.papers.threshing_drum.chain import second_case_residual
from ncgear.pitch.chambers import Chambers
from ncgear.project.alternatives import STEEPEST_HELIX_DEG, WIDER, bridging_helix
from ncgear.project.gear_solids import PROCESS
from ncgear.project.outline_fit import _binding
from ncgear.project.sizing import _Search
from ncgear.ratio.return_stroke import _even_panels
from ncgear.screening.samples import _slowest
from ncgear.teeth.toothed_arc import LEAST_WALL, _rounding
from ncgear.tolerances.estimate import _overlapping
from ncgear.tolerances.mesh import ContactPlaces
from ncgear.whole_machines.limits import FLYWHEELS, MachineLimits

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
def test_how_far_a_touch_is_from_the_designed_one_and_how_much_room_is_left() -> None:
    """Both flanks touch 1 and 2 mrad off at the first place, 4 and 1 at the second; room is the lesser play times r."""
    touch = np.array([[-0.003, -0.001], [0.002, 0.005]])
    designed = np.array([[-0.004, 0.003], [0.004, 0.006]])
    at = Made(driven_radius_mm=np.array([50.0, 40.0]))
    found = _quantities((at, touch, np.array([0.0, 0.1])), designed)
    assert found[-2] == pytest.approx([0.002, 0.004])
    assert found[-1] == pytest.approx([-0.1, 0.1 - 0.04])


@pytest.mark.judges("contact")
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_curve_stays_below_the_tangents_of_its_chord(sense: float) -> None:
    """On a circle of 10 mm, over an angle a: half the triangle's height, sin(a/2) tan(a/2) radii."""
    angle = sense * np.array([[0.0, 0.2, 0.6]])
    point = 10.0 * np.exp(1j * angle)
    runs = Made(start=np.array([0.0]), end=np.array([sense]))
    found = SidePaths.stray_mm.func(Made(point=point, slope=1j * point, runs=runs))  # type: ignore[attr-defined]
    width = np.array([[0.2, 0.4]])
    assert found == pytest.approx(10.0 * np.sin(width / 2.0) * np.tan(width / 2.0))
    assert (found > 10.0 * (1.0 - np.cos(width / 2.0))).all()


@pytest.mark.judges("drawings")
@pytest.mark.parametrize(("turns", "step"), [(1, 45.0), (3, 135.0), (0.5, 45.0)])
def test_marks_of_a_cycle_are_eighths_of_it(turns: float, step: float, monkeypatch: pytest.MonkeyPatch) -> None:
    marks: list[Any] = []
    monkeypatch.setattr("ncgear.drawings.charts.drawer.across_scale", lambda *_: None)
    axes: Any = Made(set_xticks=marks.append)
    angle_scale([axes], 360.0 * turns)
    assert np.diff(marks[0]) == pytest.approx(step)


@pytest.mark.judges("drivetrain")
def test_a_bearing_is_within_iso_281_up_to_half_its_rating() -> None:
    """A ball bearing whose load is a tenth of its rating lasts a thousand million turns: 1e9/60 minutes at 60 r/min."""

    def life(load: float, rating: float | None = 10_000.0) -> Any:
        bearing: Any = Made(dynamic_rating_n=rating, static_rating_n=6000.0, kind="ball")
        most = Extremum(3000.0, 1.0)
        return _life(bearing, load, BornePeaks(most, most, Extremum(0.0, 1.0)), 2.0 * pi, WantedLife(1000.0, 90.0))

    assert [life(load).within_iso_281 for load in (4990.0, 5010.0)] == [True, False]
    assert life(1000.0).life_h == pytest.approx(1e9 / 3600.0)
    assert life(1000.0).static_safety == pytest.approx(2.0)
    assert (life(1000.0, None).within_iso_281, life(0.0).life_h, life(0.0).static_safety) == (None, None, None)
    # Of three times the load three times the rating, for the same life.
    assert life(3000.0).needed_rating_n == pytest.approx(3000.0 * (3.6e6 / 1e6) ** (1.0 / 3.0))


@pytest.mark.judges("drivetrain")
def test_an_efficiency_is_what_is_of_use_over_all_work() -> None:
    losses = Losses(800.0, 1000.0, (0.5,), 0.2, 0.1, 100.0)
    assert (losses.mesh_n_mm, losses.efficiency) == (pytest.approx(100.0), pytest.approx(0.8))
    little, least = (Losses(share * IDLE * 1000.0, 1000.0, (0.0,), 0.2, 0.1, 0.0) for share in (2.0, 0.5))
    assert (little.efficiency, least.efficiency) == (1.0, None)


@pytest.mark.judges("drivetrain")
def test_a_stop_is_told_in_newton_metres() -> None:
    said = str(Stall(0.1, 0.2, 123_000.0, Extremum(456_000.0, 1.0), 78_000.0))
    assert all(f"{value} N m" in said for value in (123, 456, 78))


@pytest.mark.judges("dynamics")
def test_slots_that_touch_first_do_so_on_their_own_side() -> None:
    """Teeth that push forwards touch where they are farthest ahead, others where they are farthest behind."""
    errors = np.array([[3.0, 5.0, 5.0, -2.0, 4.0], [1.0, 0.0, -1.0, 6.0, 6.0]])
    coefficients = np.zeros((4, 2, 5, ERROR + 1))
    coefficients[-1, ..., ERROR] = errors
    urge = np.array([[1.0, 1.0, 1.0, -1.0, -1.0]] * 2)
    found = Gaps._touching.fget(Made(table=Made(coefficients=coefficients), urge=urge))  # type: ignore[attr-defined]
    assert found.tolist() == [[False, True, True, True, False], [True, False, False, True, True]]


@pytest.mark.judges("dynamics")
def test_gears_that_turn_less_than_once_have_one_more_end_beyond_their_range() -> None:
    # The first angle is a rounding error beside 0, which no angle may lie before
    phi1 = np.array([3e-17, 0.4, 1.0])
    assert _breaks(Made(phi1_rad=phi1, cycle_rad=2.0, toothed=None)).tolist() == [0.0, 0.4, 1.0, 2.0]
    assert _breaks(Made(phi1_rad=phi1, cycle_rad=2.0, toothed=(0.0, 1.0))) == pytest.approx([0.0, 0.4, 1.0, 1.6])


@pytest.mark.judges("dynamics")
def test_a_place_where_a_torque_changes_its_sign_is_found_beside_steeper_ones() -> None:
    """A jump of the sign counts as much as the greatest torque: it is at 0.7 and the torque rises most at 0.2."""

    def torque(phi1: np.ndarray) -> np.ndarray:
        return np.where(phi1 < 0.7, 1.0, -1.0) * 0.01 + 0.5 * np.tanh((phi1 - 0.2) / 0.001) * (phi1 < 0.5)

    (start,), width, places, torques = closer(torque, 1.0, np.array([0.5]), 0.4, 1e-3)
    assert torques == pytest.approx(torque(places))
    assert start <= 0.7 <= start + width
    assert width <= 1e-3


@pytest.mark.judges("mechanisms")
def test_drawn_yokes_and_rams_stand_across_their_bars() -> None:
    """A yoke's slot is as long as its pin travels; a ram's reaches as far down as its lever's pin sinks."""
    (top, bottom), (near, far) = ScotchYoke(40.0).rod_lines_mm["slider"]
    assert top[0] == bottom[0] == near[0] < far[0] == 0.0
    assert sorted([top[1], bottom[1]]) == [-40.0, 40.0]
    lever = SlottedLever(crank_mm=30.0, pivot_mm=100.0, lever_mm=200.0)
    swing = asin(30.0 / 100.0)
    (low, high), (near, far) = lever.rod_lines_mm["ram"]
    assert low[0] == high[0] == near[0] < far[0] == 0.0
    assert near[0] == pytest.approx(-BAR * 2.0 * 200.0 * 30.0 / 100.0)
    assert (low[1], high[1]) == pytest.approx((-200.0 * (1.0 - cos(swing)), 0.0))


@pytest.mark.judges("mechanisms")
def test_teeth_and_spaces_of_a_drawn_rack_are_as_wide_on_its_pitch_line() -> None:
    """Flanks of 20 deg cross the line every half pitch, from 1.2 modules below to one module above, both ways."""
    radius = 40.0
    module = 2.0 * radius / TEETH
    *teeth, ahead, behind = RackPinion(radius)._rack()
    points = np.array(teeth)
    ends = points.reshape(-1, 2, 2)
    first, last = ends[:, 0], ends[:, 1]
    share = first[:, 1] / (first[:, 1] - last[:, 1])
    crossings = first[:, 0] + share * (last[:, 0] - first[:, 0])
    assert np.diff(crossings) == pytest.approx(pi * module / 2.0)
    assert np.abs((last - first)[:, 0] / (last - first)[:, 1]) == pytest.approx(tan(pi / 9.0))
    # A space in the middle, a turn and two teeth behind it, two and a half teeth ahead; a straight back.
    assert crossings + crossings[::-1] == pytest.approx(-(TEETH - 1.0) * pi * module + 0.0 * crossings)
    assert crossings[crossings > 0.0].size == 6
    assert (ahead[0], behind[0]) == (points[-1, 0], points[0, 0])
    assert ahead[1] == behind[1] == pytest.approx(BACK * module)
    assert sorted({round(float(height), 9) for height in points[:, 1]}) == pytest.approx([-module, 1.2 * module])


@pytest.mark.judges("numerics")
def test_the_power_of_nought_is_one_and_stays_so() -> None:
    found = Jet.variable(np.array([2.0, -3.0]), 2) ** 0
    assert (found.value.tolist(), found.derivative(1).tolist()) == ([1.0, 1.0], [0.0, 0.0])


@pytest.mark.judges("optimum")
@at_once(
    ("angle", "others", "apart"),
    [(0.1, [6.2], 2.0 * pi - 6.1), (3.0, [1.0, 3.5], 0.5), (6.2, [3.0], 2.0 * pi - 3.2)],
)
def test_angles_are_apart_the_shorter_way_round(angle: float, others: list[float], apart: float) -> None:
    assert _nearest(angle, others) == pytest.approx(apart)


@pytest.mark.judges("papers")
def test_the_second_case_is_off_by_thirty_degrees_of_the_weight() -> None:
    """The weight at 240 deg and the formula's vector are mirrored about 45 deg: 2 sin(15 deg) of the weight."""
    (told,) = second_case_residual().values
    assert told == pytest.approx(2.0 * sin(pi / 12.0))


@pytest.mark.judges("pitch")
def test_the_flow_is_least_and_greatest_within_a_common_period_of_sun_and_ring() -> None:
    """5 + cos(12 a - 5): least where 12 a - 5 is -pi, greatest where it is 0, for 4 and 6 lobes."""
    curves = Made(sun_lobes=4, ring_lobes=6)
    flow = Chambers.flow_range.func(  # type: ignore[attr-defined]
        Made(curves=curves, flow_mm3=lambda alpha: 5.0 + np.cos(12.0 * np.asarray(alpha) - 5.0))
    )
    assert [one.value for one in flow] == pytest.approx([4.0, 6.0])
    assert [one.at for one in flow] == pytest.approx([(5.0 - pi) / 12.0, 5.0 / 12.0], abs=1e-5)


@pytest.mark.judges("project")
def test_the_most_similar_gears_are_by_teeth_then_module_then_the_last() -> None:
    made = [(20, 4.0), (30, 2.0), (30, 3.0), (30, 3.0), (60, 3.0)]
    gears = [Made(teeth=teeth, module_mm=module, number=number) for number, (teeth, module) in enumerate(made)]
    sizing = Made(computed=gears)
    asked = [(29, 2.9), (29, 2.1), (21, 4.0), (300, 1.0), (43, 3.0)]
    assert [_Search.nearest(sizing, *one).number for one in asked] == [3, 1, 0, 4, 4]


@pytest.mark.judges("ratio")
def test_panels_of_a_return_are_even_angles_of_a_half_circle() -> None:
    edges = _even_panels()
    assert (edges.size, edges[0], edges[8], edges[-1]) == (17, 0.0, pytest.approx(0.5), 1.0)
    assert edges[4] == pytest.approx((1.0 - sqrt(0.5)) / 2.0)


@pytest.mark.judges("screening")
def test_a_stroke_is_slowest_where_its_slope_has_its_least_value() -> None:
    """Cubics with their least value at 0.3, 0.55 and beyond the end of a way of 2 rad."""
    least = np.array([0.6, 1.1, 2.5])
    # 3 (x - a)^2 + (x - a)^3, whose other extreme is at a - 2.
    slope = np.stack([3.0 * least**2 - least**3, -6.0 * least + 3.0 * least**2, 3.0 - 3.0 * least, np.ones(3)])
    found = _slowest(Made(approach_slope=slope, theta2_rad=np.full(3, 2.0)))
    assert found == pytest.approx([0.3, 0.55, 1.0], abs=1e-9)


@pytest.mark.judges("teeth")
def test_a_corner_at_a_wall_is_a_module_or_what_wall_and_heel_allow() -> None:
    """A wall of 20 mm; one of 2 mm has 1 mm; a heel of 10 mm and 24 deg holds 10 s/(1 - s), s the sine of 6 deg."""
    assert _rounding(30.0, 10.0, 3.0, 3.0) == 3.0
    assert _rounding(12.0, 10.0, 3.0, 3.0) == pytest.approx(1.0)
    share = sin(pi / 30.0)
    assert _rounding(30.0, 10.0, 3.0, 4.0 * pi / 30.0) == pytest.approx(10.0 * share / (1.0 - share))
    wall = 4.0 * LEAST_WALL
    assert _rounding(10.0 + 1.01 * wall, 10.0, 4.0, 3.0) == pytest.approx(0.505 * wall)
    assert _rounding(10.0 + 0.99 * wall, 10.0, 4.0, 3.0) == 0.0


@pytest.mark.judges("whole_machines")
def test_flywheels_are_looked_at_in_parts_with_the_inertia_of_the_gears() -> None:
    def parts(given: Any, free: Any) -> Any:
        masses = None if given is None else Made(driven_flywheel_kg_mm2=given)
        return MachineLimits._flywheel_parts(
            Made(design=Made(free_flywheel=free, masses=masses), own=[30.0, 10.0, 20.0])
        )

    assert parts(None, None) == pytest.approx(np.array([[10.0], [30.0]]))
    assert parts(100.0, None) == pytest.approx(np.array([[110.0], [130.0]]))
    free = parts(100.0, Made(least=50.0, most=400.0))
    assert (free.shape, free[0, 0], free[1, -1]) == ((2, FLYWHEELS), 60.0, 430.0)
    assert free[0, 1:] == pytest.approx(free[1, :-1])


@pytest.mark.judges("metrology")
def test_a_measured_gear_is_turned_by_teeth_as_long_as_it_fits_better(monkeypatch: pytest.MonkeyPatch) -> None:
    """Best four teeth of eleven back; the middle of its points stays where it is on the way."""
    pitch, middle = 2.0 * pi / 11.0, 2.0 + 1.0j
    outline: Any = Made(gear=Made(flanks=Made(count=22)), middle_mm=middle)

    def fitted(_: Any, points: Any, probe_mm: float, pose: Pose, *__: Any) -> Any:
        assert pose.shift_mm + middle * np.exp(1j * pose.angle_rad) == pytest.approx(middle)
        return Made(pose=pose, rms_mm=0.01 + abs(pose.angle_rad + 4.0 * pitch))

    monkeypatch.setattr(best_fit, "_fitted", fitted)
    begun = fitted(outline, None, 0.0, Pose(0.0))
    found = best_fit._by_teeth(outline, np.zeros(1), 0.0, begun)
    assert found.pose.angle_rad == pytest.approx(-4.0 * pitch)
    # One that is hardly better is not turned.
    monkeypatch.setattr(best_fit, "_fitted", lambda *given: Made(pose=given[3], rms_mm=0.99 * begun.rms_mm))
    assert best_fit._by_teeth(outline, np.zeros(1), 0.0, begun) is begun


@pytest.mark.judges("tolerances")
@pytest.mark.parametrize("closed", [True, False])
def test_positions_also_have_the_places_of_those_further_on(closed: bool) -> None:
    """Two places at the first of four positions, one at each other; closed gears begin again behind the last."""
    at = np.array([0, 0, 1, 2, 3, 4, 5, 6, 7])
    values = np.arange(10, 19)
    columns = dict.fromkeys(("lever_mm", "lead", "rigid", "tilt", "flank", "pitch_share", "profile_share"), values)
    places = ContactPlaces(place=at, **columns)
    found = _overlapping(places, Made(count=4, toothed=None if closed else (0.0, 1.0)), 1)
    told = sorted(zip(found.place.tolist(), found.flank.tolist(), strict=True))
    further = [(0, 12), (1, 13), (2, 14), (4, 16), (5, 17), (6, 18)]
    behind = [(3, 10), (3, 11), (7, 15)] if closed else [(3, 14), (7, 18)]
    assert told == sorted([*zip(at.tolist(), values.tolist(), strict=True), *further, *behind])
    assert _overlapping(places, Made(count=4, toothed=None), 0) is places


@pytest.mark.judges("project")
@at_once(("gap", "width", "angle_deg"), [(0.2, 20.0, None), (1.5, 20.0, None), (0.2, 1.0, {}), (0.2, 20.0, 0.0)])
def test_a_helix_bridges_a_gap_by_what_it_advances_over_the_face(gap: float, width: float, angle_deg: Any) -> None:
    """A little more than the gap in pitches of 2 pi mm over 20 mm; nothing where that is too steep, or given."""
    contact, rack = Made(longest_gap_pitches=gap), Made(pitch_mm=2.0 * pi)
    gears, pitch = (
        Made(idlers=None, method="exact", face_width_mm=width, **dict.fromkeys(PROCESS)),
        Made(driven=Made(is_ring=False)),
    )
    drive: Any = Made(
        helix=angle_deg,
        pitch=pitch,
        gears=gears,
        designed_contact=contact,
        rack=rack,
        design=Made(motion=Made(is_open=False), key_in_file=str),
    )
    advance = tan(radians(bridging_helix(drive).get("gears.helix.angle_deg", 0.0))) * width
    wanted = WIDER * gap * 2.0 * pi
    given = angle_deg is None and degrees(atan(wanted / width)) <= STEEPEST_HELIX_DEG
    assert advance == pytest.approx(wanted if given else 0.0)


@pytest.mark.judges("project")
def test_conditions_bind_within_one_and_a_half_pitches_of_a_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """A curve of 100 mm with 20 teeth, places every 5 mm: those at 45, 50 and 55 mm count at 50 mm."""
    arc_mm = np.arange(0.0, 100.0, 5.0)

    def apart(places: np.ndarray) -> np.ndarray:
        off = np.abs(arc_mm[:, None] - places)
        return np.minimum(off, 100.0 - off)

    curve: Any = Made(arc_mm=arc_mm, phi_rad=arc_mm * pi / 50.0, length_mm=100.0, teeth=20, apart_mm=apart)

    def at(kind: Subject, place: float, value: float) -> Any:
        return Made(kind=kind, value=np.where(arc_mm == place, value, -1.0))

    told = [at(Subject.STEEP, 55.0, 0.001), at(Subject.ROOM, 60.0, 0.5), at(Subject.HOLLOW_OWN, 50.0, 0.01)]
    told += [
        at(Subject.CORNER_OWN, 45.0, -0.019),
        at(Subject.CORNER_MATE, 45.0, -0.021),
        at(Subject.HOLLOW_OWN, 45.0, -0.5),
    ]
    monkeypatch.setattr("ncgear.project.outline_fit.conditions", lambda *_: told)
    made: Any = Made(curve=curve, limits=None)
    assert _binding(made, pi) == (Subject.HOLLOW_OWN, Subject.STEEP, Subject.CORNER_OWN)
    assert _binding(made, pi + 0.5) == (Subject.ROOM, Subject.STEEP)
