"""The frontier: points that are kept, taken up again, and written; power against acceleration falls."""

from __future__ import annotations

import csv
import os
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from PIL import Image

import ncgear.optimum.frontier as of_optimum
import ncgear.optimum.makeable.law as of_makeable
import ncgear.project.frontier_run as of_design
from commands import ROOT, Run
from disk import Disk, Fault, calls_of
from drives import loaded
from ncgear.design.keys.design import Design
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots import frontier_plot as picture
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.answers.best_law import frontier_answer
from ncgear.figures.best_law import frontier_csv, frontier_figures, other_mechanisms
from ncgear.figures.terminal import full_text
from ncgear.files.searched import frontier_files
from ncgear.optimum.family import (
    LawFamily,
    PeakGoal,
    best_of_family,
)
from ncgear.optimum.frontier import FamilyPoint, LawPoint, caps_w, law_point, motion_of
from ncgear.optimum.task import Figures
from ncgear.project.drive import Drive
from ncgear.project.frontier_run import POINTS_FILE, FinishedPoints, Frontier, frontier
from ncgear.project.law_task import GearsAsGiven, task_of, wishes_of
from ncgear.project.moving import TrainInertia
from published import FIT

RESISTANCE = {"polynomial_n": FIT}


def design(knots: int = 24) -> Design:
    """The baler with few knots, so that a point takes a fraction of a second."""
    whole = loaded("baler-frontier").design
    assert whole.optimize is not None
    return whole.model_copy(update={"optimize": whole.optimize.model_copy(update={"knots": knots})})


def figures(power: float, acceleration: float) -> Figures:
    return Figures(power, acceleration, 3000.0, 0.7, 2.0, 3.5, 0.5, True, 9.0)


def found() -> Frontier:
    """Two points by hand."""
    return Frontier(
        [
            LawPoint(6000.0, 30_000.0, figures(5999.0, 40_000.0)),
            LawPoint(12_000.0, 14_000.0, figures(11_999.0, 16_000.0)),
        ],
        [FamilyPoint(6000.0, None, None), FamilyPoint(12_000.0, 11_990.0, 18_500.0)],
    )


# --- points ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_caps_run_from_the_least_power_to_where_more_is_of_no_use() -> None:
    task, wishes = task_of(design(), TrainInertia()), wishes_of(design())
    caps = caps_w(task, wishes, 3)
    assert caps == sorted(caps)
    assert caps[1] ** 2 == pytest.approx(caps[0] * caps[2], rel=1e-12)
    points = [law_point(task, wishes, cap) for cap in (caps[0], caps[2], 1.5 * caps[2])]
    accelerations = [point.law.peak_acceleration_mm_s2 for point in points]
    assert accelerations[0] > accelerations[1]
    # Beyond the last cap nothing is gained.
    assert accelerations[2] == pytest.approx(accelerations[1], rel=1e-4)
    for point in points:
        assert point.law.peak_power_w <= point.cap_w
        assert point.law.peak_acceleration_mm_s2 > point.limit_mm_s2


def test_a_law_allowed_under_one_cap_is_allowed_under_every_higher_one() -> None:
    points = [FamilyPoint(1.0, None, None), FamilyPoint(2.0, 1.9, 50.0), FamilyPoint(3.0, 2.9, 60.0)]
    best = of_design._best_so_far([*points, FamilyPoint(4.0, None, None), FamilyPoint(5.0, 4.9, 20.0)])
    assert [point.peak_acceleration_mm_s2 for point in best] == [None, 50.0, 50.0, 50.0, 20.0]
    assert [point.cap_w for point in best] == [1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.slow
def test_the_familys_motion_makes_the_law_it_says() -> None:
    """As the motion of a design file, by way of the schema; cheap starts, for any law will do."""
    task = task_of(design(), TrainInertia())
    best = best_of_family(LawFamily(task), PeakGoal.ACCELERATION, 15_000.0, starts=1)
    said = {"motion": motion_of(best), "name": "again", "linkage": {"crank_mm": 380.0, "rod_mm": 960.0}}
    again = Design.model_validate({**said, "operation": {"speed_rpm": 60.0}, "resistance": RESISTANCE})
    found = GearsAsGiven(again).given_figures
    assert found is not None
    assert found.peak_acceleration_mm_s2 == pytest.approx(best.peak(PeakGoal.ACCELERATION), rel=1e-9)
    assert found.peak_power_w == pytest.approx(best.peak(PeakGoal.POWER), rel=1e-9)


def heavy(knots: int = 16) -> Design:
    """The same baler with the masses of baler-holds, which has gears of its own."""
    holds = loaded("baler-holds").design.masses
    assert holds is not None
    return design(knots).model_copy(update={"masses": holds})


@pytest.mark.long
@pytest.mark.slow
def test_the_family_of_a_machine_with_masses_is_what_check_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each law of the family, written into the design file, has the frontier's peaks; cheap starts, as above."""
    monkeypatch.setattr(of_optimum, "FAMILY_STARTS", 2)
    keys = heavy().model_dump(mode="json", by_alias=True, exclude_unset=True)
    for cap in (20_000.0, 13_000.0, 9500.0):
        point = FamilyPoint(**of_design._point(heavy(), ("family", cap)))
        assert point.motion is not None
        check = Drive(Design.model_validate({**keys, "motion": point.motion})).check
        power, acceleration = check.peak_power_w.value, check.peak_acceleration_cycle.value
        assert power <= cap * (1.0 + 1e-6)
        assert (power, acceleration) == pytest.approx((point.peak_power_w, point.peak_acceleration_mm_s2), rel=1e-6)
        # Negative control: the resistance alone takes another power
        assert check.peak_power_resistance_w.value != pytest.approx(power, rel=1e-3)


@pytest.mark.slow
def test_other_mechanisms_have_the_same_masses(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are those of check, and no law is searched for to tell them."""
    monkeypatch.setattr(of_makeable, "makeable_law", None)
    rows = {one.name: one for one in other_mechanisms(GearsAsGiven(heavy()))}
    drive = Drive(heavy())
    for name, check in (("design as given", drive.check), ("uniform crank", drive.uniform_check)):
        assert rows[name].peak_power_w == pytest.approx(check.peak_power_w.value, rel=1e-9)
        assert rows[name].peak_acceleration_mm_s2 == pytest.approx(check.peak_acceleration_cycle.value, rel=1e-9)
        # Negative control: the resistance alone takes another power
        assert rows[name].peak_power_w != pytest.approx(check.peak_power_resistance_w.value, rel=1e-3)


def test_friction_in_the_guide_is_refused(tmp_path: Path) -> None:
    """The search for a law does not know it, and the power is capped."""
    around = loaded("baler-drivetrain").design
    assert around.drivetrain is not None
    rubbing = around.drivetrain.model_copy(update={"guide_friction": 0.07})
    with pytest.raises(WrongInput, match="does not know friction in the guide, which changes the power") as told:
        frontier(around.model_copy(update={"drivetrain": rubbing}), 2, tmp_path, lambda done, total: None)
    assert told.value.key == "drivetrain.guide_friction"
    assert not (tmp_path / POINTS_FILE).exists()


# --- what is kept ----------------------------------------------------------------------------------------------------


def test_kept_points_are_those_of_the_same_design(tmp_path: Path) -> None:
    kept, other = (
        FinishedPoints(tmp_path / "new" / POINTS_FILE, design()),
        FinishedPoints(tmp_path / "new" / POINTS_FILE, design(25)),
    )
    assert kept.found() == {}
    kept.add("family", 6000.0, {"cap_w": 6000.0})
    other.add("family", 7000.0, {"cap_w": 7000.0})
    assert kept.found() == {("family", 6000.0): {"cap_w": 6000.0}}
    assert other.found() == {("family", 7000.0): {"cap_w": 7000.0}}


def test_a_line_cut_off_by_a_kill_is_passed_over(tmp_path: Path) -> None:
    kept = FinishedPoints(tmp_path / POINTS_FILE, design())
    kept.add("law", 6000.0, {"a": 1})
    with kept.path.open("a", encoding="utf-8") as file:
        file.write('{"key": "' + kept.key)
    assert kept.found() == {("law", 6000.0): {"a": 1}}
    kept.add("law", 7000.0, {"a": 2})
    assert kept.found() == {("law", 6000.0): {"a": 1}, ("law", 7000.0): {"a": 2}}


def test_what_is_no_entry_is_passed_over(tmp_path: Path) -> None:
    kept = FinishedPoints(tmp_path / POINTS_FILE, design())
    kept.add("law", 6000.0, {"a": 1})
    with kept.path.open("ab") as file:
        file.write(b'12\n[]\n{}\n\xff\n"key"\nnull\n')
    assert kept.found() == {("law", 6000.0): {"a": 1}}


def test_a_file_of_others_gets_no_points(tmp_path: Path) -> None:
    path = tmp_path / POINTS_FILE
    for content in (b"x,y\n1,2\n", b'{"mine": 1}\n', b"\xff" * 40):
        path.write_bytes(content)
        with pytest.raises(WrongInput, match="is no file of finished points") as caught:
            frontier(design(), 2, tmp_path, lambda done, total: None)
        assert (caught.value.location, path.read_bytes()) == (str(path), content)
    path.unlink()
    path.symlink_to(tmp_path / "nowhere")
    with pytest.raises(WrongInput, match="is no file of finished points"):
        frontier(design(), 2, tmp_path, lambda done, total: None)
    assert os.listdir(tmp_path) == [POINTS_FILE]


def test_a_run_that_was_killed_at_its_first_point_goes_on(tmp_path: Path) -> None:
    whole = FinishedPoints(tmp_path / POINTS_FILE, design())
    whole.add("law", 6000.0, {"a": 1})
    text = whole.path.read_bytes()
    for length in range(len(text)):
        whole.path.write_bytes(text[:length])
        assert whole.found() == ({} if length < len(text) - 1 else {("law", 6000.0): {"a": 1}})


@pytest.mark.parametrize("fault", [Fault.NO_SPACE, Fault.BROKEN, Fault.BROKEN_FOR_GOOD, Fault.DEATH])
def test_a_fault_of_the_disk_loses_no_finished_point(tmp_path: Path, fault: Fault) -> None:
    kept = FinishedPoints(tmp_path / POINTS_FILE, design())
    kept.add("law", 6000.0, {"a": 1})
    for at in range(1, len(calls_of(kept.add, "law", 7000.0, {})) + 2):
        before, said = kept.found(), ""
        with Disk(fault, at).used() as disk:
            try:
                kept.add("law", 7000.0 + at, {"a": at})
            except WrongInput as refusal:
                said = refusal.problem
        whole = not (said or disk.dead)
        assert not said or "cannot be read or written" in said
        assert kept.found() == {**before, **({("law", 7000.0 + at): {"a": at}} if whole else {})}


def test_an_interrupted_run_goes_on_from_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that is on file is computed again, and an interruption loses nothing that is."""
    asked: list[tuple[str, float]] = []

    def point(kind: str, cap: float) -> dict[str, object]:
        if kind == "family":
            return vars(FamilyPoint(cap, cap, 20_000.0))
        law = figures(cap, 20_000.0)
        return {"cap_w": cap, "limit_mm_s2": 10_000.0, "law": vars(law)}

    def computed(of: object, jobs: list[tuple[str, float]], *where: object) -> object:
        for job in jobs:
            if len(asked) == 3:
                raise KeyboardInterrupt
            asked.append(job)
            yield job, point(*job)

    monkeypatch.setattr(of_design, "caps_w", lambda task, wishes, count: [6000.0, 8000.0, 12_000.0])
    monkeypatch.setattr(of_design, "finished", computed)
    heard: list[tuple[int, int]] = []
    with pytest.raises(KeyboardInterrupt):
        frontier(design(), 3, tmp_path, lambda done, total: heard.append((done, total)))
    assert heard == [(0, 6), (1, 6), (2, 6), (3, 6)]
    first = list(asked)
    monkeypatch.setattr(of_design, "caps_w", None)
    asked.clear()
    asked.extend([("none", 0.0)] * 4)  # past the interruption
    whole = frontier(design(), 3, tmp_path, lambda done, total: None)
    assert set(asked[4:]).isdisjoint(first)
    assert [point.cap_w for point in whole.laws] == [6000.0, 8000.0, 12_000.0]


def test_without_resistance_there_is_no_frontier(tmp_path: Path) -> None:
    nothing = design().model_copy(update={"resistance": None})
    with pytest.raises(WrongInput, match="no power to set against acceleration"):
        frontier(nothing, 2, tmp_path, lambda done, total: None)


def test_points_that_were_all_refused_say_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    results = {"law": {"refused": "no law was found"}, "family": vars(FamilyPoint(1.0, None, None))}
    monkeypatch.setattr(of_design, "caps_w", lambda task, wishes, count: [6000.0])
    monkeypatch.setattr(of_design, "finished", lambda of, jobs, *where: [(job, results[job[0]]) for job in jobs])
    with pytest.raises(NoSuchMechanism, match="no law was found"):
        frontier(design(), 1, tmp_path, lambda done, total: None)


# --- what is written -------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_tables_hold_the_points() -> None:
    rows = list(csv.DictReader(StringIO(frontier_csv(found(), GearsAsGiven(design())))))
    assert [float(row["limit_acceleration_mm_s2"]) for row in rows] == [30_000.0, 14_000.0]
    assert [row["family_acceleration_mm_s2"] for row in rows] == ["", "18500.0"]
    content = frontier_figures(found(), GearsAsGiven(design()))
    assert content["points"][1]["gap"] == pytest.approx(1.0 / 7.0, rel=1e-12)
    assert content["speed_rpm"] == 60.0


@pytest.mark.slow
def test_mechanisms_are_at_one_speed() -> None:
    """The earlier mechanism's figures at 30 r/min: half the power, a quarter of the acceleration."""
    slow = design().model_copy(update={"operation": design().operation.model_copy(update={"speed_rpm": 30.0})})
    at_60, at_30 = ({one.name: one for one in other_mechanisms(GearsAsGiven(of))} for of in (design(), slow))
    assert set(at_60) == {"design as given", "uniform crank", "Lei et al. 2012"}
    assert at_60["Lei et al. 2012"].peak_power_w == 18_750.0
    for name, one in at_60.items():
        assert at_30[name].peak_power_w == pytest.approx(one.peak_power_w / 2.0, rel=1e-9)
        assert at_30[name].peak_acceleration_mm_s2 == pytest.approx(one.peak_acceleration_mm_s2 / 4.0, rel=1e-9)


def in_full(points: Frontier) -> str:
    beside = GearsAsGiven(design())
    return full_text(frontier_answer(points, beside, ""), [frontier_figures(points, beside)], [])


@pytest.mark.slow
def test_the_picture_and_the_text() -> None:
    files = frontier_files(found(), GearsAsGiven(design()))
    assert set(files) == {"frontier.csv", "frontier.json", "frontier.png"}
    pixels = np.asarray(Image.open(BytesIO(files["frontier.png"])).convert("RGB")).reshape(-1, 3)
    for colour in ((0x00, 0x64, 0xA0), (0xB0, 0x4A, 0x00), (0xA0, 0x2C, 0x6A)):
        assert np.any(np.all(pixels == colour, axis=1))
    text = in_full(found())
    assert "33.3 %" in text
    assert "uniform crank" in text
    assert "not kept of the design as given: the constant speed v2" in text


def test_small_powers_keep_their_digits_in_the_text() -> None:
    """A packaging machine's 8.7023 W is not 9 W, and its limit of 635.52 mm/s2 not 636."""
    small = Frontier([LawPoint(8.7023, 635.52, figures(8.7, 656.51))], [FamilyPoint(8.7023, 8.69, 702.18)])
    row = next(line for line in in_full(small).splitlines() if "under 8.7023 W" in line)
    assert row.split() == ["under", "8.7023", "W", "635.52", "mm/s2", "656.51", "mm/s2", "3.3", "%", "702.18", "mm/s2"]


def test_nothing_is_called_impossible_that_the_points_do_not_prove(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a limit that falls and is hollow, each point holds for smaller powers; chords between points lie above it."""
    drawn: list[Axes] = []
    monkeypatch.setattr(canvas, "legend_above", drawn.append)
    powers = np.array([3000.0, 6000.0, 12_000.0])
    picture.frontier(np.column_stack([powers, 9e7 / powers]), picture.rows([(9000.0, 2e4)]), picture.rows([]), [], "x")
    area = drawn[0].collections[0].get_paths()[0]
    for power in np.geomspace(2000.0, 11_900.0, 40):
        assert not area.contains_point((power, 1.0001 * 9e7 / power))
    for power in powers:
        assert area.contains_point((0.999 * power, 0.999 * 9e7 / power))


@pytest.mark.thorough
@pytest.mark.parametrize("times", [1.0, 1e-3])
def test_the_picture_has_one_unit_whatever_the_size(times: float, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Axes] = []
    monkeypatch.setattr(canvas, "legend_above", drawn.append)
    points = times * np.array([[6000.0, 30_000.0], [12_000.0, 14_000.0]])
    picture.frontier(points, points, picture.rows([]), [("crank", times * 9000.0, times * 20_000.0)], "both")
    (axes,) = drawn
    assert axes.get_xlabel() == "peak power in W"
    assert axes.get_ylabel() == "peak acceleration in mm/s\u00b2"
    low, high = axes.get_xlim()
    assert low < 6000.0 * times < 12_000.0 * times < high < 20_000.0 * times
    assert axes.lines[0].get_ydata() == pytest.approx([30_000.0 * times, 14_000.0 * times])


@pytest.mark.slow
@pytest.mark.long
def test_points_come_from_processes_and_are_those_of_one(tmp_path: Path) -> None:
    whole = frontier(design(16), 2, tmp_path, lambda done, total: None)
    task, wishes = task_of(design(16), TrainInertia()), wishes_of(design(16))
    alone = law_point(task, wishes, whole.laws[0].cap_w)
    assert whole.laws[0].law.peak_acceleration_mm_s2 == pytest.approx(alone.law.peak_acceleration_mm_s2, rel=1e-9)
    assert sum(bool(line) for line in (tmp_path / POINTS_FILE).read_text(encoding="utf-8").splitlines()) == 5


@pytest.mark.slow
def test_the_command_keeps_files_of_others(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    points = found()
    monkeypatch.setattr(of_design, "frontier", lambda *_: points)
    others = dict.fromkeys(("frontier.csv", "frontier.json", "frontier.png"), b"of others")
    (tmp_path / "out").mkdir()
    for name, content in others.items():
        (tmp_path / "out" / name).write_bytes(content)
    for kept in (others, {}):
        status, said, _ = run("frontier", str(ROOT / "designs" / "baler-frontier.yaml"), "--out", "out")
        assert status == 0
        assert ("frontier-kept.csv and 2 more" in said) is bool(kept)
    assert {(tmp_path / "out" / name.replace(".", "-kept.")).read_bytes() for name in others} == {b"of others"}
