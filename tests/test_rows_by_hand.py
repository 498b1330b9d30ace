"""Rows of sweeps, teeth of rows and sections, drawings and what papers print, on a few numbers by hand."""

from __future__ import annotations

from math import cos, pi, radians, tan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.contact.written.extremes as extremes
import ncgear.design.drawn as drawn
import ncgear.files.balance as balance_files
import ncgear.files.simulation as simulation_files
import ncgear.files.strength as strength_files
import ncgear.ratio.laws.curve_shapes as curve_shapes
import ncgear.screening.rows as rows
import ncgear.screening.samples as samples
import ncgear.solids.helical.patches as patches
import ncgear.trains.chain as chain
import ncgear.trains.loads as loads
from at_once import at_once
from ncgear.design.drawn import MANY_CHORDS, SMOOTHED_MM
from ncgear.design.trains import planetary
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.papers.entry import Below, Relation, computed, printed
from ncgear.pitch.pair import STRAIGHT
from ncgear.pitch.shape import Gear
from ncgear.strength.elements.teeth import Elements, _mixed
from ncgear.teeth.contour import SHORTEST_IN_MODULES, Line, _bridged
from ncgear.teeth.form import CutterKind
from ncgear.teeth.toothed_arc import _refuse

Made: Any = SimpleNamespace


@pytest.mark.judges("files")
def test_a_track_is_drawn_about_its_middle(monkeypatch: pytest.MonkeyPatch) -> None:
    points = np.array([[1.0, -2.0], [5.0, 0.0], [2.0, 6.0]])
    monkeypatch.setattr(balance_files, "track", lambda mechanism: Made(points_mm=points))
    found = balance_files._track(Made(with_counterweight=lambda added: None), None)  # type: ignore[arg-type]
    assert found == pytest.approx(np.array([[-2.0, -4.0], [2.0, -2.0], [-1.0, 4.0]]))


@pytest.mark.judges("files")
def test_each_tooth_is_painted_where_its_root_bears_most(monkeypatch: pytest.MonkeyPatch) -> None:
    """Contacts on teeth 1, 2, 1 and 2 of three: the worst of each, at the load of its stress over that of 1 N/mm."""
    roots = np.array([[10.0, 40.0, 30.0, 2.0], [50.0, 5.0, 5.0, 90.0]])
    tooth = np.array([1, 2, 1, 2])

    def places(at: Any) -> Any:
        return Made(tooth=tooth[at], at=at, kept=places)

    painted = dict[Any, Any]()
    methods = [Made(each=[object.__new__(Elements)]) for _ in Gear]
    monkeypatch.setattr(Elements, "root_stress", lambda self, chosen: Made(tension_mpa=np.full(chosen.at.size, 4.0)))
    monkeypatch.setattr(Elements, "painted", lambda self, chosen, load: (chosen.at.tolist(), load.tolist()))
    monkeypatch.setattr(strength_files, "positions_at", lambda drive, phi1: [phi1.tolist()])
    monkeypatch.setattr(strength_files, "_titled", lambda *_: "")
    monkeypatch.setattr(
        strength_files,
        "stress_field_png",
        lambda drive, fields, most, position, title: painted.update(fields, most=most, at=position),
    )
    contacts = Made(on=lambda gear: places(np.arange(4)), phi1_rad=np.array([0.1, 0.2, 0.3, 0.4]))
    judged = Made(strength=Made(contacts=contacts, stresses=Made(tension_mpa=roots)), methods=methods)
    drive: Any = Made(judged_teeth=lambda method: judged, teeth=Made(of=lambda gear: Made(teeth=3)))
    strength_files._field(drive)
    assert painted == {
        Gear.DRIVING: ([2, 1], [7.5, 10.0]), Gear.DRIVEN: ([0, 3], [12.5, 22.5]), "most": 90.0, "at": [0.4]
    }  # fmt: skip


@pytest.mark.judges("files")
@at_once(("pushing", "back"), [(30.0, 50.0), (60.0, 50.0)])
def test_what_a_motion_in_time_tells_of_a_pair_goes_by_its_last_moment(
    monkeypatch: pytest.MonkeyPatch, pushing: float, back: float
) -> None:
    monkeypatch.setattr(simulation_files, "parted_in_time", lambda *given: given)
    monkeypatch.setattr(simulation_files, "pressed_in_time", lambda pair, force_n: force_n)
    moved = {
        "partings_of_pushing_flanks": 2, "time_with_pushing_flanks_apart_s": 0.1,
        "peak_pushing_force_n": pushing, "peak_back_force_n": back,
    }  # fmt: skip
    pair: Any = Made(
        whole=Made(course=Made(time_s=np.array([1.5, 2.0, 4.0]))), rigid=Made(machine=Made(guide_friction=0.0))
    )
    assert simulation_files._found_in_time(pair, moved) == [(2, 0.1, 2.5), max(pushing, back)]


@pytest.mark.judges("solids")
@at_once(
    ("owner", "short_mm", "said"),
    [([0, 1], 0.02, ""), ([0, 2], 0.02, "undercut at one height"), ([0, 1], 0.005, "a land vanishes")],
)
def test_sections_of_a_helical_gear_have_the_same_curves(
    monkeypatch: pytest.MonkeyPatch, owner: list[int], short_mm: float, said: str
) -> None:
    """Two curves of 3 mm at the foot; of the upper section the second is shorter, and 0.01 mm are the least."""
    monkeypatch.setattr(patches, "_rows", lambda stretch, share: (stretch.points, None))
    start = np.array([[1.0, 1.0], [5.0, 1.0]])

    def stretch(owner: list[int], long_mm: float) -> Any:
        end = start + np.array([[3.0, 0.0], [0.0, long_mm]])
        return Made(owner=np.array(owner), points=np.stack([start, end], axis=1))

    curves = [[stretch([0, 1], 3.0)], [stretch(owner, short_mm)]]
    if not said:
        patches._require_alike(curves, Gear.DRIVEN, 0.01)
        return
    with pytest.raises(WrongInput, match=said):
        patches._require_alike(curves, Gear.DRIVEN, 0.01)


@pytest.mark.judges("contact")
def test_extremes_of_play_are_told_to_a_length_on_the_smallest_radius(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = list[Any]()

    def largest(of: Any, even: Any, known: Any, finest_rad: float) -> str:
        asked.extend([of(3.0), known, finest_rad])
        return "found"

    monkeypatch.setattr(extremes, "_touched_at", lambda *_: lambda rolled: (None, rolled))
    monkeypatch.setattr(extremes, "_ranged", lambda sides: ("ranged", sides))
    monkeypatch.setattr(extremes, "_both_sides", lambda known: known)
    monkeypatch.setattr(extremes, "_largest", largest)
    monkeypatch.setattr(extremes, "_play_of", lambda pitch, even, found: (found,))
    monkeypatch.setattr(extremes, "PlayExtremes", lambda *given: given)
    even: Any = Made(driven_radius_mm=np.array([30.0, 20.0, 50.0]))
    told: Any = extremes.play_extremes(None, None, "known", even, 3.0)  # type: ignore[arg-type]
    assert told == ("found",)
    assert asked == [("ranged", 3.0), ("ranged", "known"), pytest.approx(extremes.FINEST_MM / 20.0)]


@pytest.mark.judges("design")
@at_once(
    ("chords", "given", "tolerance"),
    [(MANY_CHORDS + 1, None, SMOOTHED_MM), (MANY_CHORDS, None, None), (900, 0.2, None)],
)
@at_once("round_it", [True, False])
def test_a_drawing_of_many_chords_is_smoothed_and_has_its_axis_within(
    monkeypatch: pytest.MonkeyPatch, chords: int, given: float | None, tolerance: float | None, round_it: bool
) -> None:
    """Two lines of chords, a curve that counts for none; the unit is that of the drawing."""
    first = chords // 3
    curves = [
        Made(degree=1, x=range(first + 1)),
        Made(degree=1, x=range(chords - first + 1)),
        Made(degree=3, x=range(99)),
    ]
    shape: Any = Made(
        drawn_in="inch", curves=curves, tolerance_mm=given, axis_mm=(0.0, 0.0), model_copy=lambda update: shape
    )
    monkeypatch.setattr(drawn, "DrawnContour", SimpleNamespace)
    monkeypatch.setattr(drawn, "KINDS", {"a": ("outline", None)})
    monkeypatch.setattr(drawn, "parsed", lambda *_: Made(design=Made(motion=Made(outline=shape))))
    monkeypatch.setattr(drawn, "drawn_points", lambda *_: "points")
    monkeypatch.setattr(curve_shapes, "goes_round", lambda points, axis: round_it)
    monkeypatch.setattr(curve_shapes, "middle_mm", lambda points: (3.0, 4.0))
    monkeypatch.setattr(drawn, "rewritten", lambda text, changes: changes)
    changes = {"unit": "inch", "tolerance_mm": tolerance}
    changes |= {} if round_it else {"axis_x_mm": 3.0, "axis_y_mm": 4.0}
    expected = {f"motion.outline.{key}": value for key, value in changes.items() if value is not None}
    found: Any = drawn.as_read("text", Path("d.yaml"))
    assert found == expected


@pytest.mark.judges("design")
@at_once("idler", ["compound", "shared"])
@at_once("arms", [1, 2])
def test_an_idler_weighs_on_the_planet_by_its_speed(monkeypatch: pytest.MonkeyPatch, idler: str, arms: int) -> None:
    """Virtual work: the idler's torque counts by its rate over the planet's; a compound idler has its own inertia."""
    turned = np.linspace(0.0, 2.0 * pi, 5)
    end = "_1" if arms > 1 else ""
    parts = {
        "sun": Made(kg_mm2=1.0),
        f"idler{end}": Made(torque_n_m=np.full(5, 6.0), rate=np.full(5, 3.0), even_n_m=np.full(5, 4.0), kg_mm2=2.0),
        f"planet{end}": Made(
            torque_n_m=np.arange(5.0), rate=np.full(5, 2.0), even_n_m=np.full(5, 0.5), kg_mm2=3.0, turned_rad=turned
        ),
    }
    monkeypatch.setattr(loads, "turning_load", lambda made, name, *put: parts[name])
    asked: Any = Made(arms=arms, idler=idler, _tools=lambda *_: ())
    found = planetary.Planetary._turning(asked, None, Made(density_kg_m3=1.0, gravity=0j))  # type: ignore[arg-type]
    less = 0.5 + 4.0 * 1.5 if idler == "compound" else 0.0
    table = found["resistance"]["table"]
    assert table["torque_n_m"] == pytest.approx([each + 9.0 - less for each in (0.0, 2.0, 4.0)])
    assert table["angle_deg"] == pytest.approx([0.0, 180.0, 360.0])
    assert ("masses" in found) is (idler == "compound")


@pytest.mark.judges("design")
@at_once(
    ("given", "keys"),
    [
        ({}, []),
        ({"idler": "ring"}, ["idler"]),
        ({"center_distance_mm": 40.0}, ["gears.center_distance_mm"]),
        ({"sun_turns": 0.5}, ["sun_turns"]),
        ({"sun_turns": -0.5, "idler": "ring"}, ["idler", "sun_turns"]),
        ({"idler": "shared"}, []),
        ({"module_mm": 2.0}, []),
        ({"module_mm": 2.0, "idler": "shared"}, ["gears.module_mm"]),
        ({"path": None}, ["gears"]),
        ({"path": None, "module_mm": 2.0}, []),
        ({"path": None, "center_distance_mm": 2.0, "sun_turns": 1.0}, []),
    ],
)
def test_a_path_tells_the_size_of_its_train(given: dict[str, Any], keys: list[str]) -> None:
    told = {
        "path": object(),
        "idler": "compound",
        "sun_turns": 0.0,
        "module_mm": None,
        "center_distance_mm": None,
    } | given
    gears = Made(module_mm=told.pop("module_mm"), center_distance_mm=told.pop("center_distance_mm"))
    faults = planetary.Planetary._a_path_has_its_gears(Made(gears=gears, **told))
    assert [(fault.context or {})["key"] for fault in faults] == keys


@pytest.mark.judges("trains")
@at_once(
    ("hollow", "most", "kind", "teeth"),
    [(None, 9, CutterKind.RACK, None), (30.0, 9, CutterKind.PINION, 9), (30.0, 1, CutterKind.PINION, 3)],
)
def test_gears_of_a_row_have_half_of_the_play_off_their_idle_flanks(
    monkeypatch: pytest.MonkeyPatch, hollow: Any, most: int, kind: Any, teeth: Any
) -> None:
    """Across the normal 0.2 mm between two gears: each gives half, along the pitch curve by 1 / cos(30 deg) more."""
    monkeypatch.setattr(chain, "least_concave_radius_mm", lambda pair: hollow if pair == "dented" else None)
    monkeypatch.setattr(chain, "most_teeth", lambda pair, rack: most if pair == "dented" else 20)
    monkeypatch.setattr(chain, "require_teeth", lambda *_: None)
    monkeypatch.setattr(chain, "replace", lambda form, **changes: changes)
    form: Any = Made(rack=Made(angles_rad=(radians(20.0), radians(30.0))), backlash=Made(least_normal_mm=0.2))
    found: Any = chain.row_form(Made(pairs=["round", "dented"]), form)
    assert (found["cutter"].kind, found["cutter"].teeth) == (kind, teeth)
    assert found["backlash"].thickness_mm == pytest.approx((-0.1 / cos(radians(30.0)),) * 2)


@pytest.mark.judges("teeth")
@at_once(("gap", "count"), [(0.5, 2), (1.5, 3)])
def test_a_gap_between_curves_is_bridged_by_a_line(gap: float, count: int) -> None:
    """The gap is told in modules, of 2 mm here; the last curve leads to the first."""
    step = gap * SHORTEST_IN_MODULES * 2.0
    corner = np.array([10.0, 0.0])
    curves: Any = [Line(np.zeros(2), corner), Line(corner + np.array([0.0, step]), np.zeros(2))]
    found = _bridged(curves, 2.0)
    assert len(found) == count
    if count == 3:
        assert (found[1].start.tolist(), found[1].end.tolist()) == ([10.0, 0.0], [10.0, step])


@pytest.mark.judges("teeth")
def test_teeth_that_reach_round_are_told_by_the_angle_that_they_cover() -> None:
    """50 degrees are left of a turn."""
    curve = Made(gear=Gear.DRIVEN, driving_angle=lambda rolled: 2.0 * rolled)
    with pytest.raises(NoSuchMechanism, match=r"driven gear reach over 310 deg.* phi1 = 3 "):
        _refuse(Made(curve=curve), radians(50.0), Made(rolled=np.array([[1.5, 9.0], [8.0, 7.0]])))


@pytest.mark.judges("strength")
@at_once("share", [0.0, 0.25, 1.0])
def test_a_table_is_straight_between_its_places(share: float) -> None:
    table = np.array([[1.0, 3.0, 11.0], [2.0, 6.0, 5.0]])
    found = _mixed(table, np.array([0, 1]), np.array([1, 0]), np.full(2, share))
    assert found == pytest.approx([3.0 + 8.0 * share, 2.0 + 4.0 * share])


@pytest.mark.judges("papers")
@at_once(
    ("line", "values", "told"),
    [
        ("1.25 300 mm", (1.27, 302.0), "+0.0200"),
        ("1.25 300 mm", (1.26, 400.0), "+0.0100"),
        ("1.25 300 mm", (1.25, 180.0), "-120.00"),
        ("2.5", (2.5,), "0.000"),
    ],
)
def test_a_difference_is_that_of_the_number_that_is_off_by_most_steps(line: str, values: Any, told: str) -> None:
    """A step of 1.25 is 0.01, and of 300 it is 100."""
    assert printed(line).difference_text(computed(*values)) == told


@pytest.mark.judges("papers")
@at_once(
    ("claim", "values", "computed_text", "difference"),
    [
        (Relation(), (1e-12, -2e-10), "holds", "0"),
        (Relation(), (1e-12, -0.037), "off by 0.037 of the largest", "0.037"),
        (Below(""), (1.0, 2.0), "1 < 2", "0"),
        (Below(""), (9.0, 10.0, 100.0, 200.0), "9 < 10; holds for 2 of 2", "0"),
        (Below(""), (1.0, 2.0, 10.0, 9.0), "10 > 9; holds for 1 of 2", "-"),
        (Below(""), (3.0, 3.0), "3 = 3", "-"),
    ],
)
def test_claims_tell_what_supports_them_least(claim: Any, values: Any, computed_text: str, difference: str) -> None:
    found = computed(*values)
    assert (claim.computed_text(found), claim.difference_text(found)) == (computed_text, difference)


@pytest.mark.judges("screening")
def test_what_is_missed_is_the_largest_last_coefficient_over_its_size() -> None:
    """Two quantities on two pieces, of which the second law has one alone; a quantity of nothing misses nothing."""
    there = np.array([[True, True, True], [True, False, True]])
    first = Made(
        values=np.zeros(2), tails=np.array([[1.0, 2.0, 0.0], [3.0, 90.0, 0.0]]),
        size=np.array([[10.0, 40.0, 1.0], [30.0, 1.0, 1.0]]),
    )  # fmt: skip
    second = Made(
        values=np.zeros(2), tails=np.array([[1.0, 1.0, 0.0], [0.5, 9.0, 1.0]]),
        size=np.array([[5.0, 5.0, 1.0], [4.0, 9.0, np.nan]]),
    )  # fmt: skip
    assert rows._missed([first, second], there).tolist() == [0.2, 0.2, np.inf]


@pytest.mark.judges("screening")
@at_once(("given", "steeper", "at", "lowest", "blocked"), [
    (False, 20.0, 0.0, 9.0, True),
    (True, 20.0, 0.0, 9.0, False),
    (False, 9.0, 0.0, 9.0, False),
    (False, 20.0, 6.0, 9.0, False),
    (False, 20.0, 0.0, 1e-9, False),
])  # fmt: skip
def test_a_stroke_is_blocked_where_its_steepest_place_is_its_start(
    given: bool, steeper: float, at: float, lowest: float, blocked: bool
) -> None:
    """A slope of 4 at the start leans by 76 degrees, 14 from a right angle; elsewhere by as much, or hardly less."""
    slopes = np.array([[[4.0], [2.0], [4.0 if at else -2.0], [1.0]]]).repeat(2, axis=2)
    found: Any = Made(
        samples=Made(there=np.array([[True, True]])), closing_error_rad=np.full(2, 1e-4),
        driven_rad=np.array([[[0.0], [1.0], [3.0], [2.0 * pi]]]).repeat(2, axis=2),
    )  # fmt: skip
    ratio = Made(low=np.full((1, 2), lowest), high=np.full((1, 2), 9.0))
    curves: Any = Made(tangent=Made(values=slopes), ratio=ratio)
    batch: Any = Made(kind=Made(has_return=True), given=lambda key: np.zeros(1) if given else None)
    blocked_at = rows._blocked_at_start(found, curves, np.array([1e-6]), batch, np.array([steeper, 0.0]))
    assert blocked_at.tolist() == [blocked, False]


@pytest.mark.judges("screening")
@at_once(("off", "seen"), [(1.0, True), (1e-3, False)])
@at_once("doubt", ["missed", "closing"])
def test_a_start_is_steepest_by_more_than_the_law_may_err(off: float, seen: bool, doubt: str) -> None:
    """Twenty times an error of 1e-4 is 0.002 of the slope."""
    slopes = np.array([[[4.0], [4.0 - off]]])
    error = np.array([1e-4])
    found: Any = Made(
        samples=Made(there=np.array([[True]])), closing_error_rad=-error * (doubt == "closing"),
        driven_rad=np.array([[[0.0], [3.0]]]),
    )  # fmt: skip
    curves: Any = Made(tangent=Made(values=slopes), ratio=Made(low=np.array([[1.0]]), high=np.array([[1.0]])))
    batch: Any = Made(kind=Made(has_return=True), given=lambda key: None)
    blocked = rows._blocked_at_start(found, curves, error * (doubt == "missed"), batch, np.array([20.0]))
    assert blocked.tolist() == [seen]


@pytest.mark.judges("screening")
def test_figures_of_pitch_curves_in_their_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three turns of the driven gear to two of the driving one, 100 mm apart, with curves that are 5 long at 1 mm."""
    monkeypatch.setattr(rows, "_distance", lambda *_: (np.full(2, 100.0), None))
    lobes = Made(driving=3.0, driven=2.0)
    batch: Any = Made(
        kind=Made(lobes=lobes), follows=np.array([0, 1]),
        written=[Made(gears=None), *(Made(gears=Made(carrying_angle_deg=each)) for each in (20.0, 25.0))],
    )  # fmt: skip
    measured = {
        "length": np.full(2, 5.0), "tangent": np.full(2, tan(radians(30.0))), "driving": np.array([2.0, 4.0]),
        "driven": np.array([5.0, 8.0]), "hollow_driving": np.array([0.5, 2.0]) * STRAIGHT,
        "hollow_driven": np.array([2.0, 0.5]) * STRAIGHT,
    }  # fmt: skip
    found = rows._pitch_figures(batch, measured)
    told = {name.removeprefix("pitch."): values.tolist() for name, values in found.items()}
    assert told == {
        "center_distance_mm": [100.0] * 2, "length_driving_mm": [750.0] * 2, "length_driven_mm": [500.0] * 2,
        "driving_convex": [1.0, 0.0], "driven_convex": [0.0, 1.0], "min_radius_driving_mm": [50.0, 25.0],
        "min_radius_driven_mm": [20.0, 12.5], "max_tangent_angle_deg": pytest.approx([30.0] * 2),
        "max_pressure_angle_deg": pytest.approx([50.0, 55.0]),
    }  # fmt: skip


@pytest.mark.judges("screening")
@at_once("masses", [None, "given"])
def test_figures_of_a_motion_at_its_speed(masses: Any) -> None:
    """30 r/min are pi rad/s; a force of 8 N mm that works 6 J a cycle, in which the driving gear turns twice pi / 2."""
    kind = Made(
        masses=masses, lobes=Made(driven=2, driving_period_rad=pi / 2.0),
        resistance=Made(work_n_mm=lambda stroke, most: np.full(stroke.shape, 1000.0 * most)),
    )  # fmt: skip
    batch: Any = Made(kind=kind, column=lambda name: np.full(2, 30.0))
    measured = {
        "stroke_mm": np.array([5.0, 6.0]), "power": np.array([8.0, -1.0]), "velocity": np.full(2, 2.0),
        "working_acceleration": np.full(2, 3.0), "acceleration": np.full(2, 4.0), "check.peak_power_w": np.full(2, 7.0),
    }  # fmt: skip
    found = {
        name.removeprefix("check."): values.tolist() for name, values in rows._check_figures(batch, measured).items()
    }
    resisted = pytest.approx([8e-3 * pi, 0.0])
    of_masses = {"peak_power_w": [7.0] * 2, "peak_power_resistance_w": resisted}
    assert found == {
        **(of_masses if masses else {"peak_power_w": resisted}),
        "mean_power_w": pytest.approx([6.0] * 2),
        "peak_speed_mm_s": pytest.approx([2.0 * pi] * 2),
        "peak_acceleration_working_mm_s2": pytest.approx([3.0 * pi**2] * 2),
        "peak_acceleration_cycle_mm_s2": pytest.approx([4.0 * pi**2] * 2),
    }


@pytest.mark.judges("screening")
def test_every_panel_of_a_force_has_two_samples_of_a_law() -> None:
    """Panels up to 10, 20 and 40 mm; beyond a law's stroke panels do not count."""
    resistance: Any = Made(panels_mm=lambda most: np.array([0.0, 10.0, 20.0, most]))
    laws = np.array(
        [[1.0, 9.0, 12.0, 19.0, 25.0, 39.0], [1.0, 9.0, 12.0, 21.0, 25.0, 39.0], [1.0, 5.0, 7.0, 12.0, 13.0, 15.0]]
    )
    strokes = np.array([40.0, 30.0, 15.0])
    found = rows._force_is_seen(resistance, laws.T.reshape(2, 3, 3), strokes, np.array([True, True, False]))
    assert found.tolist() == [True, False, True]


@pytest.mark.judges("screening")
def test_the_driving_angle_before_a_place_is_passed() -> None:
    """A segment from 1 to 3 rad that moves by the square of the angle, from 1 to 9 mm."""

    def way(strokes: Any, phi1: Any, order: int) -> Any:
        return Made(displacement=Made(value=np.asarray(phi1) ** 2))

    ends = np.array([[1.0] * 1, [3.0] * 1])
    for place, passed in ((4.0, 1.0), (0.5, 0.0), (20.0, 2.0)):
        assert samples._passed_rad(None, way, ends, place) == pytest.approx([passed])  # type: ignore[arg-type]
