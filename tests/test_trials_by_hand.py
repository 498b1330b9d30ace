"""Trials of sizes and curves, sections over a face width, and motors made better, on a few numbers by hand."""

from __future__ import annotations

from math import cos, pi, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear.design.keys import pitch_shapes
from ncgear.dynamics import quasi_static
from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.numerics.chebyshev import Rising
from ncgear.numerics.extrema import Extremum
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project import (
    alternatives,
    forces,
    gear_solids,
    motor,
    outline_trial,
    workshop_measures,
)
from ncgear.project.geared import Geared
from ncgear.solids.helical import sections as helical
from ncgear.strength import sections as faces
from ncgear.trains import planetary

Made: Any = SimpleNamespace

# --- outlines


def circle(**changes: Any) -> Any:
    """A trial with a curve of 100 mm, a millimetre for each of a hundred places, 8 of whose points stand for one."""
    arc = np.arange(100.0)
    own, mate = np.full(100, 0.2), np.full(100, 0.3)
    own[7], mate[31] = -0.05, 0.02

    def apart_mm(at: Any) -> Any:
        away = np.abs(arc[:, None] - at)
        return np.minimum(away, 100.0 - away)

    points = np.column_stack([np.arange(100.0 * outline_trial.FINER), np.ones(100 * outline_trial.FINER)])
    curve = Made(
        arc_mm=arc, phi_rad=2.0 * pi * arc / 100.0, module_mm=2.0, curvature=(own / 2.0, mate / 2.0),
        apart_mm=apart_mm, points=lambda: (points, None),
    )  # fmt: skip
    return Made(**{"curve": curve, "motion": {}, "lacking": np.empty((0, 2)), **changes})


@pytest.mark.judges("project")
@at_once(
    ("lacking", "gear", "said", "place", "hollow"),
    [
        ([], "driving", "their sharpest place is", 7, ", where the driving gear is concave, -0.05 per module"),
        ([], "driven", "their sharpest place is", 7, ", where the driven gear is concave, -0.05 per module"),
        ([[96.4, 0.2], [31.2, 0.3], [5.0, 0.1]], "driving", "their contact fails", 31, ""),
    ],
)
def test_a_refused_pair_is_told_with_the_place_that_lacks_most(
    lacking: Any, gear: str, said: str, place: int, hollow: str
) -> None:
    made = circle(lacking=np.array(lacking).reshape(-1, 2), motion={"gear": gear})
    at = place * outline_trial.FINER
    assert outline_trial.most_lacking(made) == f": {said} at ({at:.4g}, 1) mm of the drawing{hollow}"


@pytest.mark.judges("project")
@at_once(("drives", "gaps"), [("one_way", 1), ("both_ways", 2)])
def test_contact_lacks_where_arcs_are_short_and_where_flanks_that_press_are_apart(drives: str, gaps: int) -> None:
    """Flanks cross at four angles of a turn; contact breaks off about the third, of the backs about the first."""
    turn = np.array([0.25, 0.5, 0.75, 0.9]) * 2.0 * pi
    point = Made(position=np.column_stack([np.cos(turn), np.sin(turn)]))
    curve = Made(at_length=lambda at: point, driving_angle=lambda at: turn, gear=Gear.DRIVING)

    def side(flanks: Any, arcs: Any, gap: Any) -> Any:
        return Made(meetings=Made(driving=np.array(flanks)), pairs=Made(arcs=np.array(arcs), gaps=np.array([gap])))

    pushing, back = side([0, 1], [1.3, 0.9], [28.0, 32.0]), side([2, 3], [1.1, 1.4], [9.0, 12.0])
    placement = Made(phi1_rad=2.0 * pi * np.arange(40) / 40.0, count=40, per_tooth=10)
    contact = Made(pushing=pushing, back=back, placement=placement)
    gear = Made(flanks=Made(curve=curve, crossing_mm=np.arange(4.0)))
    fields = {"motion": {}, "meetings_mm": None, "arcs": None, "lacking": None, "curve": circle().curve}
    drive = Made(teeth=Made(of=lambda gear_: gear), free_contact=contact)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outline_trial, "replace", lambda one, **changes: Made(**{**vars(one), **changes}))
        made = outline_trial._with_contact(Made(**fields, drive=drive), Made(least_contact_ratio=1.2, drives=drives))
    assert made.meetings_mm == pytest.approx([25.0, 50.0, 75.0, 90.0], abs=0.01)
    assert made.arcs.tolist() == [1.3, 0.9, 1.1, 1.4]
    expected = [[50.0, 0.3], [75.0, 0.1], [75.0, 0.4], [25.0, 0.3]]
    assert made.lacking == pytest.approx(np.array(expected[: 2 + gaps]), abs=0.01)


# --- bodies and measures


@pytest.mark.judges("project")
@at_once(
    ("mesh", "gear", "hub", "room_mm", "found"),
    [
        (Mesh.EXTERNAL, Gear.DRIVING, 20.0, 16.4, {"gears.driving.hub.diameter_mm": 16.0}),
        (Mesh.EXTERNAL, Gear.DRIVEN, None, 4.1, {"gears.driven.bore_mm": 4.0}),
        (Mesh.EXTERNAL, Gear.DRIVEN, None, 0.1, {}),
        (Mesh.INTERNAL, Gear.DRIVEN, None, 7.6, {"gears.driven.rim_mm": 8.0}),
    ],
)
def test_room_for_an_index_hole_is_the_nearest_size_that_leaves_it(
    mesh: Mesh, gear: Gear, hub: float | None, room_mm: float, found: Any
) -> None:
    """Bores and hubs down by twentieths, rims up by quarters of a module of 2 mm from 6 mm."""
    body = Made(hub=hub and Made(diameter_mm=hub), bore_mm=8.0)
    pitch = Made(mesh=mesh, size=Made(module_mm=2.0))
    drive: Any = Made(
        helix=None,
        gears=Made(driving=body, driven=body),
        pitch=pitch,
        teeth=None,
        chord_tolerance_mm=0.01,
        crank_pin=None,
    )

    def plans(changes: dict[str, float], *_: Any) -> Any:
        (size,) = changes.values()
        fits = size >= room_mm if mesh is Mesh.INTERNAL else size <= room_mm
        return tuple(Made(index_hole=fits and one is gear) for one in Gear)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(alternatives, "changed_part", lambda gears, changes: changes)
        patch.setattr(gear_solids, "finished_plans", plans)
        patch.setattr(gear_solids, "rim_mm_of", lambda gears, module_mm: 6.0)
        assert alternatives.room_for_index_hole(drive, gear) == pytest.approx(found, rel=1e-3)
        assert alternatives.room_for_index_hole(Made(helix=1.0), gear) == {}


@pytest.mark.judges("project")
@at_once(("most", "said"), [(4.2, "2.5 to 4 mm do"), (2.2, "leave it out")])
def test_pins_that_do_fit_the_spaces_of_both_gears(most: float, said: str) -> None:
    """The driving gear's spaces hold pins over 2.2 mm, the driven gear's up to a size."""
    gears = iter(
        Made(
            tool="pin", working=None, pins=Made(space=np.empty(0)),
            pins_of=lambda size, low=low, high=high: Made(space=np.empty(int(low < size <= high))),
        )
        for low, high in ((2.2, 9.0), (1.0, most))
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workshop_measures, "measured_section", lambda drive: Made(driving=None, driven=None))
        patch.setattr(workshop_measures, "_measured", lambda *_: next(gears))
        patch.setattr(workshop_measures, "_nominal_mm", lambda *_: 3.0)
        patch.setattr(workshop_measures, "pins_to_try", lambda nominal: [3.0])
        patch.setattr(workshop_measures, "SOLD_MM", (1.5, 2.5, 4.0, 5.0))
        with pytest.raises(WrongInput, match=said):
            workshop_measures.measured_gears(Made(gears=Made(measuring_pin_mm=20.0)))


@pytest.mark.judges("project")
def test_sections_of_a_rise_stand_in_the_middle_of_equal_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four sections of a rise of 20 mm stand at 2.5, 7.5, 12.5 and 17.5 mm."""
    heights: list[float] = []
    monkeypatch.setattr(faces, "count_of", lambda advance_mm, pitch_mm: 4)
    monkeypatch.setattr(faces, "FaceSection", lambda teeth, share: share)
    monkeypatch.setattr(faces, "FaceSections", lambda sections, angle: (sections, angle))
    monkeypatch.setattr(
        helical, "Sections", lambda *_: Made(at=lambda height: heights.append(height) or Made(teeth=None))
    )

    class Watch:
        def __enter__(self) -> None: ...
        def __exit__(self, *_: Any) -> None: ...

    drive = Made(
        teeth=None, helix=Made(largest_advance_mm=1.0, rise_mm=20.0, angle_rad=0.3), rack=Made(pitch_mm=6.0),
        chord_tolerance_mm=0.01, stopwatch=lambda step: Watch(), telling_the_finest=Watch, pitch=None, tooth_form=None,
        places={},
    )  # fmt: skip
    assert Geared.face_sections.func(drive) == ((0.25,) * 4, 0.3)  # type: ignore[attr-defined]
    assert heights == [2.5, 7.5, 12.5, 17.5]


# --- motors


def better(faults: set[str], line: Any, runs: Any, **given: Any) -> Any:
    """A motor of 10 N m at 1000 r/min behind a gearbox of 5 with an efficiency of 0.8, made better."""

    def model(**fields: Any) -> Any:
        return Made(**fields, model_copy=lambda update: model(**{**fields, **update}))

    fields = {
        "gearbox": model(ratio=5.0, efficiency=0.8), "rated_torque_n_m": 10.0, "peak_torque_n_m": None,
        "rated_speed_rpm": 1000.0, "no_load_speed_rpm": None,
    }  # fmt: skip
    return motor._bettered(model(**(fields | given)), line and model(**line), runs, faults)


def driven(mean_rpm: float = 200.0, **changes: Any) -> Any:
    """A run at 200 r/min of the driving gear, with a mean torque of 20 N m and at most 60 N m there."""
    demand = Made(
        speed_rad_s=200.0 * pi / 30.0,
        fluctuation=Made(mean_torque_n_mm=20e3),
        torque_range_n_mm=(Extremum(-5e3, 0.0), Extremum(60e3, 1.0)),
    )
    course = Made(mean_rad_s=mean_rpm * pi / 30.0)
    return Made(**{"demand": demand, "course": course, "rms_n_m": 9.0, "most_n_m": 25.0, "turns_rpm": 900.0, **changes})


@pytest.mark.judges("project")
def test_a_motor_that_is_fast_or_slow_gets_another_gearbox() -> None:
    slow, _ = better({"off speed"}, None, [driven(160.0), driven(200.0)])
    assert slow.gearbox.ratio == pytest.approx(5.0 * (0.8 + 1.0) / 2.0)
    fast, _ = better({"fast"}, None, [driven(turns_rpm=1250.0), driven()])
    assert (fast.gearbox.ratio, fast.rated_torque_n_m) == (4.0, 10.0)


@pytest.mark.judges("project")
def test_a_line_that_is_slow_runs_faster_without_load() -> None:
    _, line = better({"off speed"}, {"no_load_speed_rpm": 220.0, "stall_torque_n_m": 80.0}, [driven(160.0)])
    assert (line.no_load_speed_rpm, line.stall_torque_n_m) == (275.0, 80.0)


@pytest.mark.judges("project")
def test_a_motor_that_stops_gets_a_line_that_is_stronger_at_rest_and_as_fast_under_the_mean_torque() -> None:
    _, line = better({"stops"}, {"no_load_speed_rpm": 220.0, "stall_torque_n_m": 40.0}, [driven()])
    rest = motor.STRONGER * 60.0
    assert line.stall_torque_n_m == pytest.approx(rest, rel=1e-3)
    assert line.no_load_speed_rpm * (1.0 - 20.0 / rest) == pytest.approx(200.0, rel=1e-3)
    # Without a line of its own: 4 % slower than without load at the rated torque, 1000 N m at rest of the driving gear.
    own, _ = better({"stops"}, None, [driven()], no_load_speed_rpm=1040.0)
    assert own.rated_torque_n_m * own.gearbox.ratio == pytest.approx(motor.STRONGER * 50.0, rel=1e-3)
    rest = 10.0 / (1.0 - 1000.0 / 1040.0) * 5.0 * 0.8 * motor.STRONGER
    ratio = 5.0 * 208.0 / (200.0 / (1.0 - 20.0 / rest))
    assert own.gearbox.ratio == pytest.approx(ratio, rel=1e-3)


@pytest.mark.judges("project")
def test_a_hot_motor_bears_what_the_hottest_run_asks_and_a_weak_one_its_greatest_torque() -> None:
    runs = [driven(rms_n_m=11.0, course=None), driven(rms_n_m=12.5)]
    assert better({"hot"}, None, runs)[0].rated_torque_n_m == pytest.approx(12.5, rel=1e-3)
    stiff = better({"hot"}, None, [driven(rms_n_m=11.0)])[0].rated_torque_n_m
    assert stiff == pytest.approx(11.0 * motor.STIFFENED, rel=1e-3)
    runs = [driven(most_n_m=25.0), driven(most_n_m=31.0)]
    assert better({"weak"}, None, runs, peak_torque_n_m=20.0)[0].peak_torque_n_m == pytest.approx(31.0, rel=1e-3)
    assert better({"weak", "hot"}, None, runs, peak_torque_n_m=20.0)[0].peak_torque_n_m == 20.0


# --- shafts, distances, shapes


@pytest.mark.judges("project")
@at_once(("between", "fine"), [((2.0,), True), ((), False), ((0.0,), False), ((2.0, 3.0), False)])
def test_each_pair_swings_between_the_inertias_of_its_two_shafts(between: Any, fine: bool) -> None:
    asked: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(forces, "crank_load", lambda *_: "load")
        patch.setattr(forces, "mean_inertia", lambda load: 7.0)
        patch.setattr(forces, "swinging_inertia", lambda meshing, first, second: (first, second))
        patch.setattr(forces, "damped", lambda given, meshing, inertia: asked.append(inertia) or meshing)
        patch.setattr(forces, "ToothedMachine", lambda *parts: parts)
        masses, driving, machine = (
            Made(between_inertia_kg_mm2=between),
            Made(inertia_n_mm_s2=5.0),
            Made(linkage=0, load=0),
        )
        try:
            found: Any = forces.toothed_machine(Made(), driving, ["first", "last"], masses, machine)
            assert fine
            assert asked == [(5.0, pytest.approx(2e-3)), (pytest.approx(2e-3), 7.0)]
            assert found[1:] == ("last", "load", ("first",), (pytest.approx(2e-3),))
        except WrongInput:
            assert not fine
        assert forces.toothed_machine(Made(), driving, ["only"], Made(between_inertia_kg_mm2=()), machine)[1] == "only"
        assert asked[-1] == (5.0, 7.0)


@pytest.mark.judges("trains")
def test_pairs_of_one_module_share_a_straight_carrier_by_their_lengths(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pitch curves 3 and 5 times as long as the centre distance: 100 mm are 62.5 and 37.5 mm."""
    monkeypatch.setattr(planetary, "arc_length", lambda law, mesh: Made(period=law))
    laws: Any = (3.0, 5.0)
    assert planetary.straight_distances_mm(laws, 100.0) == pytest.approx((62.5, 37.5))


@pytest.mark.judges("design")
def test_a_quantity_of_a_shape_is_sought_from_the_curve_through_its_axis() -> None:
    """Just beyond the ellipse through its axis, the polygon about it; up to the centre distance."""
    inside = pitch_shapes.INSIDE
    found = pitch_shapes.OffsetEllipse(semi_major_mm=50.0, axis_x_mm=20.0, axis_y_mm=30.0).search("semi_minor", 90.0)
    assert (20.0 / 50.0) ** 2 + (30.0 * inside / found.low) ** 2 == pytest.approx(1.0)
    assert found.high == 90.0
    found = pitch_shapes.OffsetEllipse(semi_minor_mm=40.0, axis_x_mm=30.0, axis_y_mm=-10.0).search("semi_major", 90.0)
    assert (30.0 * inside / found.low) ** 2 + (10.0 / 40.0) ** 2 == pytest.approx(1.0)
    centred = pitch_shapes.OffsetEllipse(semi_major_mm=50.0).search("semi_minor", 90.0)
    assert centred.low == pytest.approx(50.0 * pitch_shapes.FLATTEST)
    with pytest.raises(NoSuchMechanism):
        pitch_shapes.OffsetEllipse(semi_major_mm=50.0, axis_x_mm=50.0).search("semi_minor", 90.0)
    found = pitch_shapes.ModifiedEllipse(semi_latus_rectum_mm=30.0).search("eccentricity", 75.0)
    assert 30.0 / (1.0 - found.high) == pytest.approx(75.0)
    # A square's side is twice its circle's radius.
    square = pitch_shapes.RoundedPolygon(sides=4, side_mm=60.0).search("corner_radius", 90.0)
    assert (square.low, square.high) == (0.0, pytest.approx(30.0))
    square = pitch_shapes.RoundedPolygon(sides=4, corner_radius_mm=12.0).search("side", 90.0)
    assert (square.low, square.high) == (pytest.approx(24.0), pytest.approx(180.0))
    off = pitch_shapes.RoundedPolygon(sides=4, corner_radius_mm=1.0, axis_x_mm=12.0, axis_y_mm=9.0).search("side", 90.0)
    assert off.low == pytest.approx(2.0 * inside * 15.0 * sqrt(2.0))


# --- searches


@pytest.mark.judges("numerics")
def test_an_inverse_is_refused_where_any_value_lies_in_a_jump(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rising line with a jump of 0.1 at 1, asked for a value below the jump and one within it."""

    def line(places: Any) -> Any:
        return places + 0.1 * (places >= 1.0)

    guesses = np.linspace(0.0, 2.0, 33)
    rising = Rising(Made(breaks=np.array([0.0, 2.0])))
    vars(rising)["_guesses"] = guesses, line(guesses), np.ones_like
    monkeypatch.setattr(Rising, "__call__", lambda self, places: line(places))
    assert rising.inverse(np.array([0.3, 1.6])) == pytest.approx([0.3, 1.5])
    with pytest.raises(Unanswered):
        rising.inverse(np.array([0.3, 1.03]))


@pytest.mark.judges("dynamics")
def test_a_pair_that_comes_between_the_angles_is_counted() -> None:
    """The third of three pairs bears load between the angles 0.3 and 0.4 rad only, both of which are taken."""

    def at(phi: Any) -> Any:
        depth = np.stack([np.full(phi.shape, 0.01), 0.01 * np.cos(phi), 0.005 * (1.0 - 4000.0 * (phi - 0.35) ** 2)], 1)
        near = Made(urge=np.ones(depth.shape), number=None, lever_mm=np.ones(1) * 20.0, stiffness=np.ones(1) * 1e4)
        force = 1e4 * np.maximum(depth, 0.0)
        return Made(
            forces=Made(depth_mm=depth, near=near), error_rad=-0.001 * np.cos(phi), tooth_force_n=force.max(axis=1),
            driving_torque_n_mm=20.0 * force.sum(axis=1),
        )  # fmt: skip

    found = quasi_static.loaded_peaks(at, np.linspace(0.0, 1.0, 11), 2)
    assert found.most_pairs == 3
    assert found.transmission_error_rad == pytest.approx(0.001 * (1.0 - cos(1.0)), rel=1e-6)
