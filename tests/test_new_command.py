"""Beginning a design: by flags, by answers at a terminal, and never a file that gives no gears."""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Sequence
from difflib import ndiff
from pathlib import Path

import numpy as np
import pytest

import ncgear
from at_once import at_once
from commands import Run, fresh
from ncgear.design.beginning import ANSWERS, begun, fault_of, proportioned, usual_answers
from ncgear.design.laws.registry import LawName
from ncgear.design.rewritten import rewritten
from ncgear.design.template import SHAPES, MachineName, machine_template, shape_template, template
from ncgear.design.wishes.dwell import Dwell
from ncgear.design.wishes.registry import Wishes
from ncgear.design.wishes.time_ratio import TimeRatio
from ncgear.project.opened import load, loads
from tiers import long_but

SOURCE = str(Path(ncgear.__file__).parents[1])
PATIENCE_S = 60.0


def at_terminal(arguments: Sequence[str], answers: Sequence[str], folder: Path) -> tuple[int, str]:
    """Exit status and all that a terminal shows of a run of ``ncgear``, whose questions get ``answers`` in turn."""
    pty = pytest.importorskip("pty", reason="this system lends no terminals")
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        os.environ.update({"PYTHONPATH": SOURCE, "TERM": "dumb"})
        os.execv(sys.executable, [sys.executable, "-m", "ncgear", *arguments])
    left, shown, since = list(answers), "", ""
    while select.select([terminal], [], [], PATIENCE_S)[0]:
        try:
            since += os.read(terminal, 4096).decode()
        except OSError:  # Linux tells the end of a terminal so
            break
        if since.endswith("]: ") and left:
            # Nobody answers before the question is read: so soon, the interpreter would miss a Ctrl-C.
            time.sleep(0.05)
            os.write(terminal, left.pop(0).encode())
            shown, since = shown + since, ""
    else:
        os.kill(pid, 9)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), shown + since


SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="80mm" viewBox="-40 -40 80 80">{}</svg>'


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_gives_a_plain_pair_that_can_be_made(shape: str) -> None:
    """No machine is around the gears; teeth, contact and bodies are sound, and the mate closes."""
    drive = loads(shape_template("mine", shape))
    assert {"linkage", "resistance", "masses", "drivetrain"} & set(drive.design.model_fields_set) == set()
    assert drive.gears.driving.keyway is None
    drive.require_sound_teeth()
    assert drive.solids.driving.mesh.is_watertight
    assert drive.designed_contact.contact_ratio > 1.4
    assert 1.8 < drive.pitch.size.module_mm < 2.1
    assert 6.0 <= drive.gears.face_width_mm <= 8.0
    # Symmetric about the y axis: the points mirrored are the same points.
    points = [tuple(one) for one in np.column_stack([drive.design.motion.points.x_mm, drive.design.motion.points.y_mm])]
    assert {(-x + 0.0, y) for x, y in points} == set(points)


@pytest.mark.thorough
def test_a_drawing_is_named_and_a_refused_one_leads_to_the_fit(run: Run) -> None:
    """By its file's name; what is neither a shape nor a file leaves no design."""
    pytest.importorskip("svgelements")
    Path("round.svg").write_text(SVG.format('<ellipse cx="40" cy="-40" rx="30" ry="28"/>'), encoding="utf-8")
    Path("square.svg").write_text(SVG.format('<rect x="-30" y="-30" width="60" height="60"/>'), encoding="utf-8")
    assert run("new", "one", "--shape", "round.svg") == (0, "one.yaml\n", "")
    assert load("one.yaml").design.motion.svg.file == "round.svg"
    # The axis is in the middle of the drawing.
    assert load("one.yaml").design.motion.svg.axis_mm == (80.0, 80.0)
    status, out, err = run("new", "two", "--shape", "square.svg")
    assert (status, out) == (0, "two.yaml\n")
    assert err.startswith("As it is drawn, no teeth can be made: ")
    assert err.endswith("ncgear fit two.yaml\n")
    Path("open.svg").write_text(SVG.format('<path d="M 0 0 H 30 V 30"/>'), encoding="utf-8")
    status, out, err = run("new", "four", "--shape", "open.svg")
    assert "the contour is open" in err
    assert "ncgear fit" not in err
    for wrong, said in {"moon": "heart, square, star or a file that ends in", "none.svg": "cannot be read"}.items():
        status, out, err = run("new", "three", "--shape", wrong)
        assert (status, out) == (2, "")
        assert said in err
        assert not Path("three.yaml").exists()
    assert "--teeth: given with --shape heart" in run("new", "three", "--shape", "heart", "--teeth", "30")[2]


@pytest.mark.slow
def test_a_terminal_is_asked_and_told_what_is_wrong(tmp_path: Path) -> None:
    unknown = str(len(LawName) + len(MachineName) + 1)
    ellipse = str(list(LawName).index(LawName.ELLIPSE) + 1)
    answers = ["no name", "press", unknown, ellipse, "-3", "40", "x", "30", "", "60", "31", "~", " ", "2", "8"]
    answers += ["time ratio 2", "time_ratio: {at_least: 2}", "none"]
    status, shown = at_terminal(["new"], [f"{answer}\n" for answer in answers], tmp_path)
    assert (status, shown.splitlines()[-1]) == (0, "press.yaml")
    assert "--wish: 'time ratio 2' given; KEY: VALUE is right" in shown
    assert "letters, digits, - and _, at most 64 of them, are right" in shown
    assert "its number or its name is right" in shown
    assert "-3 given; a number over 0 is needed" in shown
    assert "'x' given; a number is needed (length of the connecting rod in mm)" in shown
    assert "the crank cannot turn fully" in shown
    assert shown.count("nothing given; a number is needed") == 2
    design = load(tmp_path / "press.yaml").design
    assert design.motion.law == "ellipse"
    assert (design.linkage.crank_mm, design.linkage.rod_mm, design.operation.speed_rpm) == (40, 101.1, 60)
    assert design.gears is not None
    assert (design.gears.teeth, design.gears.module_mm, design.gears.face_width_mm) == (31, 2, 8)
    assert design.wishes is not None
    assert design.wishes.time_ratio == TimeRatio(at_least=2)


@pytest.mark.slow
def test_a_machine_is_asked_for_its_stroke_its_speed_and_wishes(tmp_path: Path) -> None:
    answers = ["press-feeder", "200", "", "1.5", "dwell: {at: extended, within_mm: 1, for_deg: 15}", "none"]
    status, shown = at_terminal(["new", "mine"], [f"{answer}\n" for answer in answers], tmp_path)
    assert (status, shown.splitlines()[-1]) == (0, "mine.yaml")
    assert "stroke of the slider in mm [150]" in shown
    assert "speed of the driving gear in r/min [40]" in shown
    assert "teeth of" not in shown
    design = load(tmp_path / "mine.yaml").design
    assert design.strength.application_factor == 1.5
    assert (design.linkage.crank_mm, design.linkage.rod_mm, design.operation.speed_rpm) == (100, 346.7, 40)
    assert design.wishes is not None
    assert design.wishes.dwell == (Dwell(at="extended", within_mm=1, for_deg=15),)


@pytest.mark.slow
def test_what_flags_say_is_not_asked(tmp_path: Path) -> None:
    flags = ["--law", "uniform_crank", "--crank-mm", "20", "--speed-rpm", "9", "--teeth", "20", "--module-mm", "1"]
    status, shown = at_terminal(["new", "a", *flags], ["\n", "5\n", "\n"], tmp_path)
    assert status == 0
    assert [line.split(" [")[0] for line in shown.splitlines() if "[" in line] == [
        "length of the connecting rod in mm",
        "face width of the gears in mm",
        "a wish of the motion, as time_ratio: {at_least: 1.5}, or none",
    ]


@pytest.mark.slow
def test_answers_that_give_no_gears_are_asked_again(tmp_path: Path) -> None:
    """With the earlier ones as likely answers, of which only the wrong one need be changed."""
    flags = ["--stroke-mm", "300", "--rod-mm", "400", "--speed-rpm", "60", "--face-width-mm", "8"]
    answers = ["10\n", "1\n", "none\n", "60\n", "\n", "none\n"]
    status, shown = at_terminal(["new", "a", "--law", "three_segment_stroke", *flags], answers, tmp_path)
    assert status == 0
    assert "; other answers are needed" in shown
    assert "teeth of the driving gear [10]" in shown
    assert "module in mm [1]" in shown
    design = load(tmp_path / "a.yaml").design
    assert design.gears is not None
    assert design.gears.teeth == 60


@pytest.mark.slow
def test_ctrl_c_at_a_question_writes_nothing(tmp_path: Path) -> None:
    status, shown = at_terminal(["new"], ["a\n", "\x03"], tmp_path)
    assert status == 130
    assert "Traceback" not in shown
    assert os.listdir(tmp_path) == []


@pytest.mark.slow
def test_yes_asks_nothing(tmp_path: Path) -> None:
    status, shown = at_terminal(["new", "a", "--yes"], [], tmp_path)
    assert (status, shown) == (0, "a.yaml\r\n")
    assert (tmp_path / "a.yaml").read_text() == template("a")


@pytest.mark.thorough
def test_without_a_terminal_nothing_is_asked(run: Run) -> None:
    assert run("new") == (2, "", "NAME: missing; `ncgear new NAME` is right\n")
    assert run("new", "a") == (0, "a.yaml\n", "")


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--crank-mm", "-5"], "--crank-mm: -5 given; a number over 0 is needed"),
        (["--module-mm", "nan"], "--module-mm: .nan given; a finite number is needed"),
        (["--teeth", "6" * 350], "--teeth: 6666666666666666666666666666666666666666... given; a number of 10000"),
        (["--teeth", "2"], "--teeth: 2 given; a number of 3 or over is needed"),
        (["--crank-mm", "50", "--rod-mm", "40"], "the crank cannot turn fully: rod - crank = -10 mm"),
        (["--crank-mm", "50", "--stroke-mm", "90"], "a crank of 50 mm has a stroke of 100 mm; give one of the two"),
    ],
)
def test_sizes_that_no_design_can_have(run: Run, tmp_path: Path, flags: list[str], said: str) -> None:
    status, out, err = run("new", "a", *flags)
    assert (status, out) == (2, "")
    assert err.startswith(said)
    assert os.listdir(tmp_path) == []


WISHES = (
    "constant_speed: {from_mm: 100, to_mm: 300}",
    "constant_speed: {from_mm: 350, to_mm: 500, tolerance: 0.01, stroke: return}",
    "time_ratio: {at_least: 1.2}",
    "dwell: {at: extended, within_mm: 2, for_deg: 20}",
    "dwell: [{at: retracted, within_mm: 2, for_pi: 0.1, hard: false, weight: 3}]",
    "speed_at: {at_mm: 600, make: slowest, hard: false}",
    "positions: {at_mm: 300, phi1_deg: 80, tolerance_mm: 1}",
    "{working_stroke: {angle_deg: 200, tolerance_deg: 1}}",
)
"""Every kind of wish, two of them twice, one in the form of the file's list and one in braces."""


LESS_THAN_ONCE = (LawName.SPIRAL, LawName.FUNCTION_GENERATOR)


@pytest.mark.parametrize("law", LESS_THAN_ONCE)
def test_gears_that_turn_less_than_once_have_no_wishes(run: Run, law: LawName) -> None:
    status, _, problem = run("new", "a", "--law", law.value, "--wish", "time_ratio: {at_least: 1.2}")
    assert status == 2
    assert "wishes: given, but it is not offered for gears that turn to and fro" in problem


@pytest.mark.tiers(thorough=["table"], rest="slow")
@pytest.mark.parametrize("law", [law for law in LawName if law not in LESS_THAN_ONCE])
def test_wishes_are_those_of_the_file(run: Run, tmp_path: Path, law: LawName) -> None:
    """As under ``wishes`` in a file that somebody writes by hand."""
    by_hand = """
wishes:
  constant_speed:
    - {from_mm: 100, to_mm: 300}
    - {from_mm: 350, to_mm: 500, tolerance: 0.01, stroke: return}
  time_ratio: {at_least: 1.2}
  dwell:
    - {at: extended, within_mm: 2, for_deg: 20}
    - {at: retracted, within_mm: 2, for_pi: 0.1, hard: false, weight: 3}
  speed_at:
    - {at_mm: 600, make: slowest, hard: false}
  positions:
    - {at_mm: 300, phi1_deg: 80, tolerance_mm: 1}
  working_stroke: {angle_deg: 200, tolerance_deg: 1}
"""
    flags = [part for wish in WISHES for part in ("--wish", wish)]
    assert run("new", "a", "--law", law.value, *flags) == (0, "a.yaml\n", "")
    assert load(Path("a.yaml")).design.wishes == loads(template("a", law) + by_hand).design.wishes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wish", "said"),
    [
        ("time ratio 1.8", "--wish: 'time ratio 1.8' given; KEY: VALUE is right, as time_ratio: {at_least: 1.5}"),
        ("", "--wish: '' given; KEY: VALUE is right"),
        ("time_ration: {at_least: 2}", "--wish: time_ration: unknown key; did you mean time_ratio?"),
        ("time_ratio: {at_least: -2}", "--wish: time_ratio.at_least: -2 given; a number of 0.01 or over is needed"),
        ("dwell: {at: end, within_mm: 1, for_deg: 9}", "--wish: dwell.0.at: 'end' given; retracted or extended"),
        ("dwell: {at: extended, within_mm: 1}", "--wish: dwell.0: one of for_rad, for_deg or for_pi is missing"),
        (
            "constant_speed: {from_mm: 40, to_mm: 20}",
            "--wish: constant_speed.0.to_mm: 20 mm given, but from_mm is 40 mm;",
        ),
        ("constant_speed: {from_mm: 40", "--wish: is not YAML: "),
        ("constant_speed: {from_mm: 40, to_mm: 900}", "wishes.constant_speed.0.to_mm: 900 given, but the stroke is "),
    ],
)
@pytest.mark.parametrize("beginning", [[], ["--machine", "pump"]])
def test_wishes_that_no_design_can_have(run: Run, tmp_path: Path, wish: str, said: str, beginning: list[str]) -> None:
    status, out, err = run("new", "a", *beginning, "--wish", wish)
    assert (status, out) == (2, "")
    assert err.startswith(said)
    assert os.listdir(tmp_path) == []


def test_a_wish_of_one_kind_twice(run: Run, tmp_path: Path) -> None:
    twice = [part for ratio in (2, 3) for part in ("--wish", f"time_ratio: {{at_least: {ratio}}}")]
    assert run("new", "a", *twice) == (2, "", "--wish: time_ratio is given twice; give it once\n")


def test_wishes_stand_in_place_of_those_of_a_machine(run: Run, tmp_path: Path) -> None:
    """Of the same kind; the others stay, in the sizes that the answers say, and the given ones as they are given."""
    text = begun("a", MachineName.PUSHER, {"stroke_mm": 500, "speed_rpm": 60}, {"time_ratio": {"at_least": 1.9}})
    wishes = loads(text).design.wishes
    assert wishes is not None
    assert wishes.time_ratio == TimeRatio(at_least=1.9)
    assert [(even.from_mm, even.to_mm, even.tolerance) for even in wishes.constant_speed] == [(200, 400, 0.005)]
    assert machine_template("a", MachineName.PUSHER).count("#") == text.count("#")


@pytest.mark.slow
def test_commented_rows_of_wishes_and_of_both_strokes_are_right_as_they_stand() -> None:
    rows, group = [], False
    for line in template("a").splitlines():
        group = line.startswith(("# wishes:", "# optimize:")) or (group and line.startswith("#   "))
        wanted = group or line.startswith(("  # returning:", "  # friction_n:"))
        rows.append(line.replace("# ", "", 1) if wanted else line)
    drive = loads("\n".join(rows))
    assert drive.design.wishes is not None
    assert drive.design.wishes.model_fields_set == set(Wishes.model_fields)
    assert len(drive.motion_wishes) == len(Wishes.model_fields)
    assert drive.design.optimize is not None
    assert drive.design.optimize.limits.peak_power_w == 5000
    # A force of 50 N on the way back and 20 N both ways, beside the work of the template's own force
    cycle_s = 60.0 / drive.design.operation.speed_rpm
    before_w = loads(template("a")).check.mean_power_w
    assert (drive.check.mean_power_w - before_w) * cycle_s == pytest.approx(0.76 * (50 + 2 * 20), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("machine", MachineName)
def test_a_larger_and_faster_machine_keeps_its_proportions(machine: MachineName) -> None:
    """Twice the stroke at half the speed: the same law, forces and power, and half the acceleration."""
    usual = loads(machine_template("a", machine))
    sizes = usual_answers(machine)
    answers = {"stroke_mm": 2.0 * sizes["stroke_mm"], "speed_rpm": 0.5 * sizes["speed_rpm"]}
    other = loads(begun("a", machine, answers))
    angle = np.linspace(0.0, 2.0 * np.pi, 41)
    assert other.transmission.driven_angle(angle).value == pytest.approx(
        usual.transmission.driven_angle(angle).value, abs=1e-9
    )
    # The gears' own inertia stays, since they do, and counts in the power with masses.
    own, former = other.massless_check, usual.massless_check
    assert own.peak_power_w.value == pytest.approx(former.peak_power_w.value, rel=1e-6)
    assert other.check.peak_acceleration_cycle.value == pytest.approx(
        0.5 * usual.check.peak_acceleration_cycle.value, rel=1e-6
    )
    assert [one.kept for one in other.achieved.outcomes] == [one.kept for one in usual.achieved.outcomes]
    masses, before = other.design.masses, usual.design.masses
    assert masses is not None
    assert before is not None
    assert masses.slider_kg == before.slider_kg
    assert masses.crank.inertia_kg_mm2 == pytest.approx(4.0 * before.crank.inertia_kg_mm2)
    assert other.design.optimize is not None
    assert usual.design.optimize is not None
    limits, limits_before = other.design.optimize.limits, usual.design.optimize.limits
    assert limits.peak_power_w == limits_before.peak_power_w
    if limits_before.peak_acceleration_mm_s2 is not None:
        assert limits.peak_acceleration_mm_s2 == pytest.approx(0.5 * limits_before.peak_acceleration_mm_s2)


@pytest.mark.slow
def test_gears_that_cannot_be_made_are_refused_before_the_file_is_written(run: Run, tmp_path: Path) -> None:
    status, out, err = run("new", "a", "--teeth", "5")
    assert (status, out) == (3, "")
    assert err.startswith("gears.teeth: the root of the space after tooth 5 of the driving gear folds")
    assert os.listdir(tmp_path) == []


NAMES = ["12", "1e3", "true", "null", "-", "--", "---", "_", "0x1", "a", "yes", "-1", "NULL"]


@at_once("name", NAMES)
def test_names_that_yaml_takes_for_something_else(name: str) -> None:
    assert loads(template(name)).design.name == name


@pytest.mark.tiers(quick=["ellipse", "table"], rest="slow")
@pytest.mark.parametrize("law", LawName)
def test_only_lines_of_other_values_differ_from_the_template(law: LawName) -> None:
    """Comments stay, also those of lines that change."""
    before, after = template("a", law), begun("a", law, {"teeth": 45, "face_width_mm": 7.5})
    changed = [line for line in ndiff(before.splitlines(), after.splitlines()) if line[0] in "+-"]
    keys = {line[1:].strip().partition(":")[0] for line in changed}
    assert keys == {"teeth", "face_width_mm", "bore_mm", "keyway", "driven"}
    assert before.count("#") == after.count("#")
    assert rewritten(before, {}) == before


@pytest.mark.slow
def test_the_template_keeps_its_proportions() -> None:
    """Twice the machine: the same law, the same force at each share of the stroke."""
    usual, twice = loads(template("a")), loads(begun("a", LawName.THREE_SEGMENT_STROKE, {"crank_mm": 760}))
    assert twice.linkage.stroke_mm == pytest.approx(2.0 * usual.linkage.stroke_mm)
    assert twice.law_speed_rpm == pytest.approx(usual.law_speed_rpm, rel=1e-3)
    assert twice.check.peak_acceleration_cycle.value == pytest.approx(
        2.0 * usual.check.peak_acceleration_cycle.value, rel=1e-3
    )
    assert twice.check.peak_power_w.value == pytest.approx(2.0 * usual.check.peak_power_w.value, rel=1e-3)


@pytest.mark.parametrize("answer", ["stroke_mm", "crank_mm", "rod_mm"])
def test_each_length_gives_the_others(answer: str) -> None:
    usual = usual_answers()
    found = proportioned({answer: 0.5 * usual[answer]})
    assert {one: found[one] / usual[one] for one in ("stroke_mm", "crank_mm", "rod_mm")} == pytest.approx(
        {"stroke_mm": 0.5, "crank_mm": 0.5, "rod_mm": 0.5}
    )


@at_once("answer", ANSWERS)
def test_nothing_is_no_answer(answer: str) -> None:
    """Not even of a key that a design file may leave out."""
    assert fault_of(answer, None) == "nothing given; a number is needed"


@pytest.mark.thorough
def test_the_templates_own_answers_have_no_fault() -> None:
    usual = usual_answers(MachineName.BALER)
    assert [fault_of(answer, value) for answer, value in usual.items()] == [None] * len(ANSWERS)


SIZES = (
    ["--stroke-mm", "120", "--speed-rpm", "90", "--teeth", "34"],
    ["--crank-mm", "1000", "--rod-mm", "2100", "--teeth", "150", "--module-mm", "8", "--face-width-mm", "90"],
    ["--teeth", "9", "--module-mm", "0.5"],
)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("law", long_but([LawName.TABLE, LawName.PITCH_CURVE, LawName.SPIRAL], LawName))
@pytest.mark.parametrize("flags", SIZES, ids=["small", "large", "few teeth"])
def test_what_is_written_builds_and_the_rest_is_refused_with_a_reason(run: Run, law: LawName, flags: list[str]) -> None:
    status, out, err = run("new", "a", "--law", law.value, *flags)
    if status == 0:
        assert out == "a.yaml\n"
        assert run("build", "a.yaml")[0] == 0
    else:
        assert status == 3
        assert err.startswith("gears")
        assert not Path("a.yaml").exists()


@pytest.mark.slow
def test_no_file_is_touched_that_appears_while_answers_are_given(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("precious")
    done = fresh("new", "a", "--teeth", "50", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "a.yaml: exists already; choose another name, or remove it\n"
    assert (tmp_path / "a.yaml").read_text() == "precious"
