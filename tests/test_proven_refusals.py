"""What is refused cannot be made, what is advised can be, and no search without an answer is a fault."""

from __future__ import annotations

import re
from collections import Counter
from math import cos, gcd, pi, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree
from shapely import Polygon

from at_once import at_once
from commands import Run
from deep_designs import deep_design
from drives import design_of
from ncgear.errors import DesignError, NoSuchMechanism, Unanswered, WrongInput, searched_for
from ncgear.figures.mended import refusal_with_help
from ncgear.pitch.shape import Gear
from ncgear.project import mending as search
from ncgear.project.drive import Drive
from ncgear.project.mending import MendingSubject, mending, require_made
from ncgear.teeth import tips
from ncgear.teeth.flank import Flanks
from ncgear.teeth.tool import HARMLESS, gouged_mm

Data = dict[str, Any]


def data_of(motion: Data, **gears: Any) -> Data:
    return {
        "name": "proven",
        "operation": {"speed_rpm": 30},
        "motion": motion,
        "gears": {"module_mm": 2.0, "face_width_mm": 8, **gears},
    }


def ellipse(eccentricity: float, lobes: tuple[int, int], teeth: int, **gears: Any) -> Data:
    of = {"driving": lobes[0], "driven": lobes[1]}
    return data_of({"law": "ellipse", "eccentricity": eccentricity}, teeth=teeth, lobes=of, **gears)


def drive_of(data: Data) -> Drive:
    return Drive(design_of(data))


def problem_of(data: Data) -> str | None:
    """Why a design's teeth are refused; None where they are made."""
    try:
        require_made(drive_of(data))
    except DesignError as error:
        return str(error)
    return None


# --- searches without an answer


def judged(number: int) -> str:
    """What becomes of a deep design: it is made or refused, with words; any other exception goes through."""
    try:
        require_made(drive_of(deep_design(number)))
    except DesignError as error:
        assert error.exit_status in (2, 3)
        assert len(error.problem) > 20
        assert "nan" not in error.problem
        if isinstance(error, Unanswered):
            assert "tooth" in error.problem
            assert "deg)" in error.problem
        return type(error).__name__
    return "made"


@pytest.mark.tiers(slow=["1001-1", "1002-4", "577-1"], rest="long")
@pytest.mark.parametrize(
    ("first", "count"), [(1001, 1), (1002, 4), (577, 1), (0, 1000)], ids=["1001-1", "1002-4", "577-1", "0-1000"]
)
def test_deep_designs_are_made_or_refused(first: int, count: int) -> None:
    found = Counter(judged(number) for number in range(first, first + count))
    assert found["made"] >= 0.2 * count, found
    assert found["Unanswered"] <= 0.005 * count, found


POINTED = ellipse(0.3, (1, 1), 17, rack={"pressure_angle_deg": 25.0, "addendum": 1.2}, undercut="allow")


def astray(*_: Any) -> np.ndarray:
    raise Unanswered("no zero was found between 1 and 2", rows=[0])


def test_a_fault_in_a_deep_design_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The negative control: the builtin error that numerics once raised goes through the judge."""

    def fault(*_: Any) -> np.ndarray:
        raise ArithmeticError("no zero was found")

    monkeypatch.setattr(tips, "_newton_crossing", fault)
    with pytest.raises(ArithmeticError):
        judged(next(number for number in range(40) if deep_design(number)["motion"]["law"] == "ellipse"))


def test_a_search_without_an_answer_names_what_it_was_about() -> None:
    with pytest.raises(Unanswered, match=r"^a\.b: thing 7: no zero") as refused, searched_for("thing {}".format, "a.b"):
        raise Unanswered("no zero", rows=[7, 9])
    assert refused.value.exit_status == 3
    with pytest.raises(Unanswered, match=r"^no zero") as refused, searched_for("thing {}".format, "a.b"):
        raise Unanswered("no zero")


def test_a_command_ends_with_tooth_and_angle(monkeypatch: pytest.MonkeyPatch, run: Run) -> None:
    """The search for the height of a land, made to find nothing: a refusal with its place, and no fault."""
    text = str(POINTED).replace("'", "").replace("True", "true")
    Path("d.yaml").write_text(text, encoding="utf-8")
    monkeypatch.setattr(tips, "_newton_lands", lambda edges, back, least: (np.zeros(back.size), (), back < 0))
    monkeypatch.setattr(tips, "zeros_between", astray)
    monkeypatch.setattr("ncgear.cli.mending._search", lambda drive, error: None)
    status, out, err = run("build", "d.yaml")
    assert (status, out) == (3, "")
    named = r"gears\.teeth: the back flank of tooth \d+ of the driv\w+ gear \(phi1 = [-\d.]+ rad \([-\d.]+ deg\)\)"
    assert re.match(rf"d\.yaml:1:\d+: {named}: no zero was found between", err)


def test_a_trial_without_an_answer_does_not_help(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every trial ends astray: the refusal stands, and the search ends as where nothing helps."""

    def unanswered(drive: Drive) -> None:
        raise Unanswered("no zero was found")

    drive = drive_of(ellipse(0.2, (1, 1), 9))
    monkeypatch.setattr(Drive, "require_sound_teeth", unanswered)
    found = mending(drive)
    assert found is not None
    assert isinstance(found.refusal, Unanswered)
    assert found.found is None
    assert found.failed


# --- tips beside notches


def reached(flanks: Flanks, flank: int, tip_mm: float, curve: cKDTree) -> float:
    """The first of many heights at which a flank is as far from the whole pitch curve as a tip; NaN after a cusp."""
    height = np.linspace(0.0, 8.0 * tip_mm, 1601)[1:]
    rows = np.full(height.size, flank)
    regular = np.logical_and.accumulate(flanks.regularity(rows, height) > 0.0)
    far = curve.query(flanks.flank(rows, height)[0])[0] >= tip_mm
    return float(height[np.argmax(far)]) if np.any(far & regular) and regular[np.argmax(far)] else np.nan


@pytest.mark.slow
@pytest.mark.parametrize("number", [42, 495])
def test_flanks_reach_their_tips_where_a_fine_polygon_says(number: int) -> None:
    """At the sharpest notches; of the second gears some flanks end in cusps before."""
    found = []
    for gear in Gear:
        flanks = drive_of(deep_design(number)).teeth.of(gear).flanks.unturned
        length = np.linspace(0.0, flanks.curve.length_mm, 60_001)
        curve = cKDTree(flanks.curve.at_length(length).position)
        sharpest = np.argsort(flanks.curve.at_length(flanks.crossing_mm).curvature)[:8]
        for share in (0.3, 0.7, 1.0):
            tipped = flanks.with_tips(flanks.full_tip_mm * share)
            top, _, met = tips.tip_crossing(tipped)
            for flank in sharpest:
                tip = float(tipped.tip_height_mm[flank])
                expected = reached(flanks, flank, tip, curve)
                assert met[flank] == np.isfinite(expected)
                if met[flank]:
                    assert expected - 8.0 * tip / 1600 - 1e-6 <= top[flank] <= expected + 1e-6
                found.append(bool(met[flank]))
    assert found.count(True) > 20
    assert number == 42 or False in found


# --- the least number of teeth


def fewest_of(data: Data) -> tuple[int, int]:
    """The number of teeth that the search names, alone, and the step between numbers that fit the lobes."""
    drive = drive_of(data)
    found = search._Trials(drive, lambda done, total: None, 99, np.inf).fewest()
    assert found is not None
    lobes = drive.transmission.lobes
    return found.drive.pitch.size.driving_teeth, lobes.driving // gcd(lobes.driving, lobes.driven)


def with_teeth(data: Data, teeth: int) -> Data:
    """As many teeth at the same length of the pitch curve."""
    gears = data["gears"]
    return {**data, "gears": {**gears, "teeth": teeth, "module_mm": gears["module_mm"] * gears["teeth"] / teeth}}


@pytest.mark.tiers(long=["notches"], rest="slow")
@pytest.mark.parametrize(
    "data",
    [
        pytest.param(ellipse(0.28, (3, 1), 21), id="three lobes to one"),
        pytest.param(ellipse(0.61, (1, 1), 13), id="one lobe"),
        pytest.param(
            data_of({"law": "ratio_expression", "driven_angle": "phi - 0.31*sin(2*phi)"}, teeth=16), id="notches"
        ),
    ],
)
def test_the_least_number_of_teeth_is_bracketed_by_trials(data: Data) -> None:
    """It is made, one step fewer is not, and the number of the file is not."""
    count, each = fewest_of(data)
    assert problem_of(with_teeth(data, count)) is None
    assert problem_of(with_teeth(data, count - each)) is not None
    assert problem_of(data) is not None


def test_the_search_for_a_number_begins_where_notches_need_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A square of 100 mm with corners of 4 mm: 461 teeth, which are made, in place of three times the file's 60."""
    tried: list[tuple[Any, float]] = []

    def noted(trials: Any, equals: tuple[Any, ...], share: float = 1.0) -> None:
        tried.append((equals[0].changes.get("gears.teeth"), share))

    monkeypatch.setattr(search._Trials, "best", noted)
    shape = {"sides": 4, "side_mm": 100.0, "corner_radius_mm": 4.0}
    data = data_of({"law": "pitch_curve", "rounded_polygon": shape, "solve_for": "center_distance"}, teeth=60)
    drive = drive_of({**data, "gears": {key: one for key, one in data["gears"].items() if key != "module_mm"}})
    search.searched(drive, NoSuchMechanism("refused"))
    kept = [share for teeth, share in tried if teeth is None]
    assert next(teeth for teeth, _ in tried if teeth is not None) == 461
    assert max(kept) < search.BEFORE_FINER


NO_HELP = ellipse(0.3, (1, 1), 12, least_contact_ratio=2.9)


@pytest.mark.slow
def test_nothing_helps_where_ten_times_the_teeth_do_not() -> None:
    found = mending(drive_of(NO_HELP), seconds=np.inf)
    assert found is not None
    assert (found.found, found.is_whole) == (None, True)
    alone = [way.changes["gears.teeth"] for way in found.failed if way.kinds == (MendingSubject.FINER,)]
    assert max(alone) == 120
    assert problem_of(with_teeth(NO_HELP, 120)) is not None
    assert "not searched further" not in str(refusal_with_help(found))


@pytest.mark.thorough
def test_a_search_ends_when_its_time_is_over_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock on which each look takes a second."""
    ticks = iter(range(10**6))
    monkeypatch.setattr(search, "process_time", lambda: float(next(ticks)))
    found = mending(drive_of(NO_HELP))
    assert found is not None
    assert (found.found, found.is_whole) == (None, False)
    assert len(found.failed) <= 3
    assert "; not searched further" in str(refusal_with_help(found))


# --- open gears


@pytest.mark.slow
def test_few_pitches_do_not_keep_an_open_curve_from_going_on() -> None:
    """Each whole curve is a whole number of pitches long, by Gauss's rule on each piece; one takes a great wave."""
    rng = np.random.default_rng([6, 3])
    for _ in range(5):
        middle, order, teeth = rng.uniform(0.7, 1.7), rng.uniform(0.4, 2.5), int(rng.integers(7, 13))
        ratio = f"{middle:.4f} + {middle * rng.uniform(0.0, 0.3):.4f}*sin({order:.4f}*phi)"
        motion = {"law": "ratio_expression", "ratio": ratio, "range_deg": float(f"{rng.uniform(80.0, 300.0):.4f}")}
        pitch = drive_of(data_of(motion, teeth=teeth)).pitch
        assert curve_length(pitch.transmission) * pitch.center_distance_mm / (2.0 * pi) == pytest.approx(
            round(pitch.driving.length_mm / (2.0 * pi)), abs=1e-7
        )


def curve_length(law: Any) -> float:
    """Length of the driving curve at unit distance: sqrt(r^2 + r'^2), r = s / (1 + s), s = dphi2/dphi1."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    total = 0.0
    for piece in law.pieces:
        half = (piece.end_rad - piece.start_rad) / 2.0
        slope = piece.slope(piece.start_rad + half * (1.0 + nodes), 1)
        s, bend = slope.value, slope.derivative(1)
        total += half * float(weights @ np.hypot(s / (1.0 + s), bend / (1.0 + s) ** 2))
    return total


# --- consistent sizes

SIZES = [
    data_of({"law": "pitch_curve", "expression_mm": "31 + 3*cos(2*phi)", "solve_for": "center_distance"}, teeth=41),
    data_of({"law": "pitch_curve", "expression_mm": "18 + cos(phi)", "solve_for": "center_distance"}, teeth=12),
    ellipse(0.21, (1, 1), 23, center_distance_mm=51.7),
    ellipse(0.12, (3, 2), 21, center_distance_mm=60.1),
    {**(few := ellipse(0.12, (3, 1), 21, center_distance_mm=60.1)), "gears": {**few["gears"], "teeth": None}},
]


@at_once("data", SIZES)
def test_each_size_that_is_advised_is_consistent(data: Data) -> None:
    """Each is accepted in the place of what is given; a thousandth more is not."""
    gears = {key: value for key, value in data["gears"].items() if value is not None}
    with pytest.raises(WrongInput) as refused:
        _ = drive_of({**data, "gears": gears}).pitch
    _, _, advised = re.split(r"(consistent would be|; with)", refused.value.problem)
    ways = [
        {key: float(value) if "." in value else int(value) for key, value in re.findall(r"(\w+): ([\d.]+)", part)}
        for part in re.split(r",? or ", advised.replace(" either", ""))
    ]
    if (count := re.match(r" (\d+) teeth", advised)) is not None:
        ways = [{"teeth": int(count[1]), **way} for way in ways]
    assert ways
    by_law = "follows from the law" in refused.value.problem
    assert by_law == (data["motion"]["law"] == "pitch_curve")
    assert by_law == all("center_distance_mm" not in way for way in ways)
    for way in ways:
        assert drive_of({**data, "gears": {**gears, **way}}).pitch.size.driving_teeth
        key = next(key for key in way if key != "teeth") if len(way) > 1 or "teeth" not in way else None
        if key is not None:
            with pytest.raises(WrongInput):
                _ = drive_of({**data, "gears": {**gears, **way, key: way[key] * 1.001}}).pitch


# --- an axis near the rim


@pytest.mark.parametrize("inside", [0.4, 0.0007])
def test_an_axis_near_the_rim_of_an_ellipse_is_inside(inside: float) -> None:
    """The least radius is what the axis is away from the rim, by hand."""
    shape = {"semi_major_mm": 24.0, "semi_minor_mm": 21.0, "axis_x_mm": 24.0 - inside}
    drive = drive_of(data_of({"law": "pitch_curve", "ellipse": shape, "solve_for": "center_distance"}, teeth=20))
    low, high = drive.transmission.ratio_range
    distance = drive.law.center_distance_mm
    assert distance is not None
    assert distance / (1.0 + high.value) == pytest.approx(inside, rel=1e-6)
    # The far end of the axis is not the farthest point: a sharper look by the parameter.
    at = np.linspace(0.0, 2.0 * pi, 400_001)
    far = np.hypot(24.0 * np.cos(at) - 24.0 + inside, 21.0 * np.sin(at)).max()
    assert distance / (1.0 + low.value) == pytest.approx(far, rel=1e-8)


@pytest.mark.parametrize("beyond", [0.0, 0.0007])
def test_an_axis_on_the_rim_or_outside_is_refused(beyond: float) -> None:
    shape = {"semi_major_mm": 24.0, "semi_minor_mm": 21.0, "axis_x_mm": 24.0 + beyond}
    with pytest.raises(NoSuchMechanism, match="axis"):
        _ = drive_of(data_of({"law": "pitch_curve", "ellipse": shape, "solve_for": "center_distance"}, teeth=20)).law


# --- what a rack does to hollow flanks


def sine(depth: float, cutter: str, teeth: int = 44) -> Data:
    motion = {"law": "ratio_expression", "driven_angle": f"phi - {depth}*sin(2*phi)"}
    return data_of(motion, teeth=teeth, cutter={"kind": cutter})


def cut_by_polygons(data: Data) -> float:
    """How deep points of a rack's straight edges come into the gear that its mate leaves, while the rack rolls."""
    drive = drive_of(data)
    curve, gear, rack = drive.pitch.driving, drive.teeth.driving, drive.rack
    outline, flanks, slope, deepest = Polygon(gear.outline_mm), gear.flanks, tan(rack.pressure_angle_rad), 0.0
    hollow = curve.at_length(flanks.crossing_mm).curvature < 0.004
    for flank in np.flatnonzero(hollow):
        height = np.linspace(-flanks.flank_depth_mm[flank], flanks.tip_height_mm[flank], 80)
        reach = height.max() / (cos(rack.pressure_angle_rad) ** 2 * slope)
        for rolled in np.linspace(-reach, reach, 61):
            at = curve.at_length(flanks.crossing_mm[flank : flank + 1] + rolled)
            ahead = -rolled - flanks.side[flank] * height * slope
            point = at.position + ahead[:, None] * at.tangent + height[:, None] * at.normal
            inside = point[shapely.contains_xy(outline, *point.T)]
            if inside.size:
                deepest = max(deepest, float(shapely.distance(shapely.points(inside), outline.boundary).max()))
    return deepest


@pytest.mark.slow
def test_the_harm_of_a_rack_is_that_of_its_polygon() -> None:
    """Chords of an outline are a thousandth of the depth off; a convex curve suffers none."""
    data = {**sine(0.155, "mate", 60), "output": {"chord_tolerance_mm": 0.0005}}
    drive = drive_of(data)
    told = gouged_mm(drive.pitch.driving, drive.rack)
    assert told > 10.0 * HARMLESS * 2.0
    # The height of a flank times the curvature, which is left out, is a tenth of sin^2(alpha) here; it leaves less.
    assert 0.85 * told < cut_by_polygons(data) < told
    convex = {**sine(0.1, "mate"), "output": {"chord_tolerance_mm": 0.0005}}
    assert gouged_mm(drive_of(convex).pitch.driving, drive.rack) == 0.0
    assert cut_by_polygons(convex) < 0.001


@pytest.mark.slow
def test_a_rack_is_refused_for_harm_and_not_for_a_sign() -> None:
    """A concave radius of metres is cut; one of decimetres is not, and the message says how deep the rack would cut."""
    flat = drive_of(sine(0.1505, "rack"))
    assert 0.0 < gouged_mm(flat.pitch.driving, flat.rack) < HARMLESS * 2.0
    assert (radius := flat.pitch.least_concave_radius_mm(Gear.DRIVING)) is not None
    assert radius > 2000.0
    require_made(flat)
    hollow = drive_of(sine(0.17, "rack"))
    with pytest.raises(NoSuchMechanism, match="it would cut 0") as refused:
        _ = hollow.teeth
    said = float(re.findall(r"would cut ([\d.]+) mm", str(refused.value))[0])
    assert said == pytest.approx(gouged_mm(hollow.pitch.driving, hollow.rack), rel=0.01)
    assert said > HARMLESS * 2.0
