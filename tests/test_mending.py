"""The search before teeth are refused: what it finds is made, what it says it tried is not, and --mend takes it."""

from __future__ import annotations

import json
from copy import deepcopy
from functools import cache
from math import pi, radians, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML
from shapely import Polygon
from shapely.affinity import rotate, translate

import ncgear
from commands import ROOT, Run
from drives import design_of
from ncgear.cli.arguments import _is_of_curve
from ncgear.cli.mending import _search
from ncgear.design.reading.design_file import parsed
from ncgear.design.rewritten import rewritten
from ncgear.design.words import LONGEST_DESCRIPTION, ending_in
from ncgear.errors import DesignError, NoSuchMechanism, Unanswered, WrongInput
from ncgear.figures.mended import SUFFIX, mended_design, mended_words, tried_words
from ncgear.project.drive import Drive
from ncgear.project.mending import Mend, Mending, MendingSubject, MendingWay, mending, refusal_of_teeth, ways
from ncgear.teeth.form import BasicRack

Data = dict[str, Any]

CRANK = {"linkage": {"crank_mm": 40, "rod_mm": 150}, "operation": {"speed_rpm": 60}}
EVEN = {"law": "uniform_crank"}


def sine(depth: float) -> Data:
    return {"law": "ratio_expression", "driven_angle": f"phi - {depth}*sin(2*phi)"}


def data_of(motion: Data, teeth: int, **gears: Any) -> Data:
    return {
        "name": "pair",
        **CRANK,
        "motion": motion,
        "gears": {"teeth": teeth, "module_mm": 5, "face_width_mm": 10, **gears},
    }


def drive_of(data: Data) -> Drive:
    return Drive(design_of(data))


def with_changes(data: Data, changes: dict[str, Any]) -> Data:
    """Plain values with other ones at dotted keys, by other code than the search's."""
    result = deepcopy(data)
    for key, value in changes.items():
        group, _, inner = key.removeprefix("gears.").rpartition(".")
        place = result["gears"].setdefault(group, {}) if group else result["gears"]
        place.pop(inner, None)
        place.update({} if value is None else {inner: value})
    return result


CASES: dict[str, Data] = {
    "sine, 12 teeth": data_of(sine(0.08), 12),
    "8 teeth": data_of(EVEN, 8),
    "5 teeth": data_of(EVEN, 5),
    "fitted radius": data_of(EVEN, 8, rack={"root_radius": 0.6}),
    "radius that fits at 20 deg only": data_of(EVEN, 8, rack={"root_radius": 0.4}),
    "more contact than any rack has": data_of(EVEN, 5, least_contact_ratio=1.9),
    "strongly concave": data_of(sine(0.28), 8),
}


@cache
def searched(name: str) -> Mending | None:
    return mending(drive_of(CASES[name]), seconds=np.inf)


def is_refused(data: Data) -> bool:
    try:
        drive_of(data).require_sound_teeth()
    except DesignError:
        return True
    return False


@pytest.mark.slow
def test_what_another_program_makes_is_made_or_mended() -> None:
    """phi - 0.08 sin 2 phi, 12 teeth of module 5; the pressure angle in closed form is that of a tangent and the rack.

    With s = phi2' = 1 - 0.16 cos 2 phi the driving radius is a s / (1 + s), so that tan mu = |s'| / (s (1 + s)).
    """
    search = searched("sine, 12 teeth")
    if search is not None:
        assert search.found is not None
        phi = np.linspace(0.0, pi, 200_001)
        slope, bend = 1.0 - 0.16 * np.cos(2.0 * phi), 0.32 * np.sin(2.0 * phi)
        steepest = np.degrees(np.arctan(np.abs(bend) / (slope * (1.0 + slope))).max())
        assert search.found.pressure_angle_deg == pytest.approx(20.0 + steepest, abs=1e-6)
        assert 1.0 < search.found.contact_ratio < 2.0


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [17, 30])
def test_a_pressure_angle_of_25_degrees_alone_builds(teeth: int) -> None:
    drive = drive_of(data_of(EVEN, teeth, rack={"pressure_angle_deg": 25.0}))
    drive.require_sound_teeth()
    assert drive.rack.root_radius_mm == pytest.approx(0.31 * 5)
    assert mending(drive) is None


@pytest.mark.slow
def test_8_teeth_are_mended_by_25_degrees_and_the_mate_as_tool() -> None:
    search = searched("8 teeth")
    assert search is not None
    assert search.found is not None
    assert search.found.way.changes == {"gears.rack.pressure_angle_deg": 25.0, "gears.cutter.kind": "mate"}
    # All of what is exact of the line of action, base circle to base circle, in base pitches.
    longest = 8.0 * tan(radians(25.0)) / pi
    assert 0.97 * longest < search.found.contact_ratio <= longest
    assert search.found.pressure_angle_deg == pytest.approx(25.0)


@pytest.mark.slow
def test_6_teeth_are_mended_by_30_degrees_and_the_mate_as_tool() -> None:
    """At 25 degrees the line of action, base circle to base circle, is shorter than a base pitch."""
    assert 6.0 * tan(radians(25.0)) / pi < 1.0
    search = mending(drive_of(data_of(EVEN, 6)), seconds=np.inf)
    assert search is not None
    assert search.found is not None
    assert search.found.way.changes == {"gears.rack.pressure_angle_deg": 30.0, "gears.cutter.kind": "mate"}
    longest = 6.0 * tan(radians(30.0)) / pi
    assert 0.97 * longest < search.found.contact_ratio <= longest


@pytest.mark.slow
def test_8_teeth_at_20_degrees_cannot_hold_contact_whatever_cuts_them() -> None:
    """From base circle to base circle there is less than a base pitch: z tan(alpha) / pi = 0.927."""
    assert 8.0 * tan(radians(20.0)) / pi < 1.0
    search = searched("8 teeth")
    assert search is not None
    at_20 = [way for way in search.failed if MendingSubject.STEEPER not in way.kinds]
    assert {kind for way in at_20 for kind in way.kinds} == {
        MendingSubject.MATE,
        MendingSubject.SHIFTED,
        MendingSubject.UNDERCUT,
    }


@pytest.mark.slow
def test_the_mended_gears_do_not_overlap() -> None:
    """By polygons of shapely at 90 positions: the other teeth stay out of each other but for what chords take."""
    search = searched("8 teeth")
    assert search is not None
    assert search.found is not None
    teeth, distance = search.found.drive.teeth, search.found.drive.pitch.center_distance_mm
    driving, driven = Polygon(teeth.driving.outline_mm), Polygon(teeth.driven.outline_mm)
    for degrees in np.linspace(0.0, 90.0, 90):
        one = rotate(driving, degrees, origin=(0.0, 0.0))
        other = translate(rotate(driven, -degrees, origin=(0.0, 0.0)), distance)
        # Two flanks of 10 mm that overlap by the chord tolerance.
        assert one.intersection(other).area < 2.0 * 10.0 * 0.005
        assert one.distance(other) < 0.01


@pytest.mark.tiers(slow=["more contact than any rack has"], rest="long")
@pytest.mark.parametrize(
    "name",
    [
        "8 teeth",
        pytest.param("radius that fits at 20 deg only", marks=pytest.mark.thorough),
        pytest.param("5 teeth", marks=pytest.mark.slow),
        pytest.param("more contact than any rack has", marks=pytest.mark.slow),
        pytest.param("strongly concave", marks=pytest.mark.slow),
    ],
)
def test_each_way_that_does_not_work_was_tried(name: str) -> None:
    """Each is made anew from plain values, and refused; what is found is made."""
    search = searched(name)
    assert search is not None
    assert search.failed
    assert [way for way in search.failed if not is_refused(with_changes(CASES[name], way.changes))] == []
    if search.found is not None:
        assert not is_refused(with_changes(CASES[name], search.found.way.changes))


@pytest.mark.slow
def test_a_refusal_that_remains_names_all_that_was_tried() -> None:
    name = "more contact than any rack has"
    search = searched(name)
    assert search is not None
    assert search.found is None
    alone = [way for way in search.failed if way.kinds == (MendingSubject.FINER,)]
    assert max(way.changes["gears.teeth"] for way in alone) == 10 * CASES[name]["gears"]["teeth"]
    others = tuple(way for way in search.failed if way not in alone)
    assert others == tuple(way for equals in ways(drive_of(CASES[name])) for way in equals)
    told = tried_words(search.failed).split("; ")
    assert len(told) == len(dict.fromkeys(way.kinds for way in search.failed))
    for words, kinds in zip(told, dict.fromkeys(way.kinds for way in search.failed), strict=True):
        alike = [way.changes for way in search.failed if way.kinds == kinds]
        numbers = {f"{value:g}" for changes in alike for key, value in changes.items() if _is_told(key, value)}
        assert all(number in words.replace(",", "").split() for number in numbers)


def _is_told(key: str, value: Any) -> bool:
    return not isinstance(value, bool | str | None) and key != "gears.module_mm"


def test_words_for_all_ways() -> None:
    alike = [
        MendingWay((MendingSubject.ROOT_RADIUS,), {"gears.rack.root_radius": 0.31}),
        MendingWay(
            (MendingSubject.STEEPER, MendingSubject.MATE),
            {"gears.rack.pressure_angle_deg": 25.0, "gears.cutter.kind": "mate"},
        ),
        MendingWay(
            (MendingSubject.SHIFTED,),
            {"gears.profile_shift.driven": None, "gears.profile_shift.against_undercut": True},
        ),
        MendingWay((MendingSubject.SHIFTED,), {"gears.profile_shift.driving": -0.3}),
        MendingWay(
            (MendingSubject.FINER, MendingSubject.UNDERCUT),
            {"gears.teeth": 12, "gears.module_mm": 2.5, "gears.undercut": "allow"},
        ),
        MendingWay(
            (MendingSubject.FINER, MendingSubject.UNDERCUT),
            {"gears.teeth": 24, "gears.module_mm": 1.25, "gears.undercut": "allow"},
        ),
    ]
    assert tried_words(alike) == (
        "a root radius of 0.31; a rack of 25 deg with the mate as tool; profile shift against undercut or -0.3; "
        "12 or 24 teeth of a smaller module with undercut allowed"
    )


def test_fewer_changes_come_first_and_more_teeth_last() -> None:
    kinds = [equals[0].kinds for equals in ways(drive_of(CASES["fitted radius"]))]
    assert kinds[0] == (MendingSubject.ROOT_RADIUS,)
    kept = [one for one in kinds if MendingSubject.FINER not in one]
    assert [len(one) for one in kept] == sorted(len(one) for one in kept)
    assert kinds == kept + [one for one in kinds if MendingSubject.FINER in one]


def test_every_way_has_a_root_radius_that_fits() -> None:
    """0.6 modules nowhere, 0.4 modules at 20 degrees only; what is left out fits by itself."""
    for name in ("fitted radius", "radius that fits at 20 deg only"):
        for equals in ways(drive_of(CASES[name])):
            for way in equals:
                rack = drive_of(with_changes(CASES[name], way.changes)).gears.rack
                angle, size = radians(rack.pressure_angle_deg), (rack.addendum, rack.dedendum, rack.root_radius)
                BasicRack(1.0, angle, *size)
    assert "gears.rack.root_radius" not in {
        key for equals in ways(drive_of(CASES["8 teeth"])) for way in equals for key in way.changes
    }


@pytest.mark.thorough
def test_more_teeth_keep_the_centre_distance_and_whole_numbers() -> None:
    """Of three lobes to two: driving teeth in threes."""
    data = data_of({"law": "ellipse", "eccentricity": 0.1}, 9, lobes={"driving": 3, "driven": 2})
    drive = drive_of(data)
    counts = []
    for equals in ways(drive):
        for way in equals:
            if MendingSubject.FINER in way.kinds:
                pitch = drive_of(with_changes(data, way.changes)).pitch
                assert pitch.center_distance_mm == pytest.approx(drive.pitch.center_distance_mm, rel=1e-12)
                counts.append(pitch.size.driving_teeth)
    assert set(counts) == {15, 27}


@pytest.mark.slow
def test_of_equal_ways_the_one_of_most_contact_is_taken() -> None:
    """An addendum and a shift that cost contact at 20 degrees; at 22.5 and at 25 degrees all of it is exact."""
    data = data_of(EVEN, 9, undercut="allow")
    search = mending(drive_of(data))
    assert search is not None
    assert search.found is not None
    assert search.found.way.kinds == (MendingSubject.STEEPER,)
    rivals = [
        drive_of(with_changes(data, {"gears.rack.pressure_angle_deg": angle})).designed_contact.contact_ratio
        for angle in (22.5, 25.0)
        if not is_refused(with_changes(data, {"gears.rack.pressure_angle_deg": angle}))
    ]
    assert search.found.contact_ratio == pytest.approx(max(rivals), rel=1e-12)


def test_what_is_not_about_teeth_is_not_searched() -> None:
    """A law that does not close, and pressure angles of a right angle: no teeth help."""
    for motion, problem in (
        ({"law": "ratio_expression", "ratio": "1 + 0.3*cos(phi)"}, "multiply the ratio"),
        (sine(0.49), "pressure angle reaches"),
    ):
        with pytest.raises(NoSuchMechanism, match=problem):
            mending(drive_of(data_of(motion, 30)))


def test_attributes_only_raise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ncgear.project.mending.ways", pytest.fail)
    drive = drive_of(CASES["8 teeth"])
    with pytest.raises(NoSuchMechanism, match="no flanks touch"):
        drive.require_sound_teeth()
    assert isinstance(refusal_of_teeth(drive), NoSuchMechanism)


def test_help_is_sought_for_the_refusal_of_these_teeth_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not for another class or another key, and of wrong values only for those that a search mends."""
    monkeypatch.setattr("ncgear.project.mending.searched", lambda drive, error, on_trial: error)
    few = drive_of(CASES["8 teeth"])
    refusal = refusal_of_teeth(few)
    assert refusal is not None
    assert _search(few, refusal) is refusal
    assert _search(few, NoSuchMechanism("no flanks touch", key="motion")) is None
    assert _search(few, WrongInput("too wide", key="gears.face_width_mm")) is None


@pytest.mark.parametrize(
    ("key", "of_curve"),
    [("gears.teeth", True), ("motion", True), ("motion.points", True), ("gears.module_mm", False), ("masses", False)],
)
def test_another_curve_is_offered_where_the_curve_or_its_teeth_are_refused(key: str, of_curve: bool) -> None:
    assert _is_of_curve(NoSuchMechanism("no", key=key)) is of_curve
    assert not _is_of_curve(Unanswered("no answer"))


TEXT = """\
name: few   # eight teeth
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears:
  teeth: 8        # as few as that
  module_mm: 5
  rack: {profile: B}
  face_width_mm: 10
"""


@pytest.mark.slow
def test_the_refusal_of_a_build_names_the_change(run: Run) -> None:
    Path("d.yaml").write_text(TEXT)
    status, out, err = run("build", "d.yaml")
    assert (status, out) == (3, "")
    assert err.startswith("d.yaml:5:1: gears.least_contact_ratio: no flanks touch")
    assert err.endswith(
        "; what works: gears.rack.pressure_angle_deg: 25 and gears.cutter.kind: mate (contact ratio 1.18, pressure "
        "angle 25 deg); --mend takes it\n"
    )
    assert [path.name for path in Path().iterdir()] == ["d.yaml"]


@pytest.mark.slow
def test_a_root_radius_that_does_not_fit_is_still_wrong_input(run: Run) -> None:
    Path("d.yaml").write_text(TEXT.replace("teeth: 8 ", "teeth: 30").replace("profile: B", "root_radius: 0.6"))
    status, _, err = run("build", "d.yaml")
    assert status == 2
    assert "gears.rack.root_radius: a root radius of 3 mm does not fit" in err
    assert "what works: gears.rack.root_radius: 0.47 (contact ratio" in err


@pytest.mark.slow
@pytest.mark.parametrize("command", ["report", "animate"])
def test_other_commands_name_the_build_that_mends(command: str, run: Run) -> None:
    Path("d.yaml").write_text(TEXT)
    status, _, err = run(command, "d.yaml")
    assert status == 3
    assert err.endswith("; ncgear build --mend takes it\n")


@pytest.mark.long
@pytest.mark.slow
def test_a_mended_build_says_so_and_keeps_its_design_file(run: Run) -> None:
    """The kept file builds the same files; a build in its own folder leaves it there."""
    Path("d.yaml").write_text(TEXT)
    status, out, _ = run("build", "d.yaml", "--mend", "--verbose", "--report", "--format", "svg")
    assert status == 0
    assert out.startswith("Mended: these are not the gears of the file, whose teeth are refused, but those with\n")
    folder = Path("export/few-mended")
    written = out.partition("Written\n")[2].split()
    assert sorted(written) == sorted(str(path) for path in folder.iterdir())
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["design"]["name"] == "few-mended"
    assert summary["design"]["description"].startswith("Mended: few with gears.rack.pressure_angle_deg: 25 and")
    assert b"Mended: few with" in (folder / "report.html").read_bytes()
    made = {path.name: path.read_bytes() for path in folder.iterdir()}
    status, out, _ = run("build", str(folder / "few-mended.yaml"), "--format", "svg")
    assert status == 0
    assert "Mended: these" not in out
    again = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert {name for name in made if made[name] != again[name]} <= {"summary.json", "manifest.json"}
    assert set(made) == set(again)
    assert {"few-mended.yaml", "driving.csv", "driving.stl"} <= set(again)


@pytest.mark.slow
def test_check_makes_the_teeth_only_when_asked(run: Run) -> None:
    Path("d.yaml").write_text(TEXT)
    assert run("check", "d.yaml")[0] == 0
    status, out, _ = run("check", "d.yaml", "--mend")
    assert status == 0
    assert "gears.cutter.kind: mate" in out.partition("\n\n")[0]
    status, out, err = run("check", "d.yaml", "--mend", "--json")
    assert json.loads(out)["design"]["name"] == "few-mended"
    assert err.startswith("Mended: ")
    assert [path.name for path in Path().iterdir()] == ["d.yaml"]


@pytest.mark.slow
def test_another_fault_of_a_mended_design_has_its_place_in_the_file(run: Run) -> None:
    """A bore beyond the roots: the mended build fails and writes nothing."""
    Path("d.yaml").write_text(TEXT + "  driving: {bore_mm: 60}\n")
    status, out, err = run("build", "d.yaml", "--mend")
    assert (status, out) == (2, "")
    assert err.startswith("d.yaml:10:13: gears.driving.bore_mm: ")
    assert [path.name for path in Path().iterdir()] == ["d.yaml"]


@pytest.mark.slow
def test_nothing_is_mended_that_holds(run: Run) -> None:
    Path("d.yaml").write_text(TEXT.replace("teeth: 8 ", "teeth: 30"))
    status, out, _ = run("check", "d.yaml", "--mend")
    assert status == 0
    assert out.startswith("Nothing to mend: the teeth can be made as the file has them.\n")
    assert "few-mended" not in out


@pytest.mark.slow
def test_a_mended_file_keeps_comments_and_makes_the_gears_that_were_found() -> None:
    loaded = parsed(TEXT, Path("few.yaml"))
    search = ncgear.mending(Drive(loaded.design))
    assert search is not None
    assert search.found is not None
    text = mended_design(loaded, search.found)
    assert "# as few as that" in text
    assert "# eight teeth" in text
    again = parsed(text, Path("few-mended.yaml")).design
    assert again.gears == search.found.drive.design.gears
    assert again.gears is not None
    assert again.gears.rack.profile == "B"
    assert (again.name, again.motion, again.linkage) == ("few-mended", loaded.design.motion, loaded.design.linkage)


def test_a_mended_file_has_its_points_in_itself(tmp_path: Path) -> None:
    """A file of points stays beside the old design file."""
    feeder = (ROOT / "designs" / "feeder-table.yaml").read_text()
    loaded = parsed(feeder, ROOT / "designs" / "feeder-table.yaml")
    way = MendingWay((MendingSubject.FINER,), {"gears.teeth": 60})
    again = parsed(mended_design(loaded, Mend(way, Drive(loaded.design))), tmp_path / "elsewhere.yaml").design
    assert again.gears is not None
    assert again.gears.teeth == 60
    assert Drive(again).transmission.ratio_range == Drive(loaded.design).transmission.ratio_range


@pytest.mark.slow
def test_names_and_descriptions_stay_within_bounds() -> None:
    assert ending_in(SUFFIX, "few-mended") == "few-mended"
    assert len(ending_in(SUFFIX, "a" * 64)) == 64
    long = parsed(TEXT + f"description: {'x' * LONGEST_DESCRIPTION}\n", Path("few.yaml"))
    search = searched("8 teeth")
    assert search is not None
    assert search.found is not None
    assert len(parsed(mended_design(long, search.found), Path("a.yaml")).design.description) == LONGEST_DESCRIPTION


def test_a_rewritten_file_has_the_values_and_its_comments() -> None:
    text = "a: 1   # one\nb:\n  c: [1, 2]  # two\n  d: 3\ne: {f: 4, g: 5}\n"
    made = rewritten(text, {"b.c": [6.0, 7.0], "b.d": None, "e.f": "six", "h.i.j": True, "b.k": [8.0]})
    assert made.index("# one") < made.index("# two")
    assert YAML(typ="safe").load(made) == {
        "a": 1,
        "b": {"c": [6.0, 7.0], "k": [8.0]},
        "e": {"f": "six", "g": 5},
        "h": {"i": {"j": True}},
    }
    assert rewritten(text, {}) == text


# --- too much backlash


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "given"), [("gears.backlash_mm", 3.3), ("gears.backlash_deg", 3.7), ("gears.backlash_mm", 4.0)]
)
def test_too_much_backlash_is_named_with_the_most_tenths_that_work(key: str, given: float) -> None:
    """Where teeth grow too thin to reach each other, and where play alone takes too much of them."""
    data = data_of({"law": "ellipse", "eccentricity": 0.2}, 26, **{key.removeprefix("gears."): given})
    search = mending(drive_of(data), seconds=np.inf)
    assert search is not None
    assert search.found is not None
    assert search.refusal.key == key
    assert search.refusal.problem.startswith(f"{given:g} {key[-2:] if key.endswith('mm') else 'deg'} ")
    assert list(search.found.way.changes) == [key]
    works = search.found.way.changes[key]
    assert isinstance(works, float)
    assert refusal_of_teeth(drive_of(with_changes(data, {key: works}))) is None
    assert refusal_of_teeth(drive_of(with_changes(data, {key: works + given / 10.0}))) is not None


@pytest.mark.slow
def test_backlash_that_is_not_the_cause_is_not_blamed() -> None:
    data = data_of({"law": "ellipse", "eccentricity": 0.2}, 8, backlash_mm=0.05)
    search = mending(drive_of(data))
    assert search is not None
    assert search.refusal.key != "gears.backlash_mm"
    assert [way.changes for way in search.failed if MendingSubject.BACKLASH in way.kinds] == [
        {"gears.backlash_mm": 0.005}
    ]


# --- a profile shift that makes teeth impossible


@pytest.mark.slow
def test_a_shift_that_is_the_cause_is_named() -> None:
    """Both gears' tips end at the mates' fillets; the same gears without a shift can be made."""
    shift = {"driving": 0.6, "driven": 0.6}
    data = data_of({"law": "ellipse", "eccentricity": 0.05}, 40, profile_shift=shift)
    search = mending(drive_of(data))
    assert search is not None
    assert search.found is not None
    assert search.found.way.changes == {"gears.profile_shift": None}
    assert search.refusal.key == "gears.profile_shift"
    assert search.refusal.problem.startswith("without this shift the teeth can be made: ")
    said, _ = mended_words(search, search.found)
    assert "refused, but those without gears.profile_shift (contact ratio" in said
    del data["gears"]["profile_shift"]
    assert refusal_of_teeth(drive_of(data)) is None


@pytest.mark.slow
def test_a_shift_that_is_not_the_cause_is_not_blamed() -> None:
    data = data_of({"law": "ellipse", "eccentricity": 0.2}, 8, profile_shift={"driving": 0.1})
    search = mending(drive_of(data))
    assert search is not None
    assert search.refusal.key != "gears.profile_shift"
    assert search.failed[0] == MendingWay((MendingSubject.UNSHIFTED,), {"gears.profile_shift": None})
