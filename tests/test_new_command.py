"""Beginning a design: by flags, by answers at a terminal, and never a file that gives no gears."""

from __future__ import annotations

import os
import pty
import select
import sys
import time
from collections.abc import Sequence
from difflib import ndiff
from pathlib import Path

import pytest

import ncgear
from commands import Run, fresh
from ncgear.design.beginning import ANSWERS, begun, fault_of, proportioned, template_answers
from ncgear.design.laws.registry import LawName
from ncgear.design.rewritten import rewritten
from ncgear.design.template import template
from ncgear.project.drive import load, loads

SOURCE = str(Path(ncgear.__file__).parents[1])
PATIENCE_S = 60.0


def at_terminal(arguments: Sequence[str], answers: Sequence[str], folder: Path) -> tuple[int, str]:
    """Exit status and all that a terminal shows of a run of ``ncgear``, whose questions get ``answers`` in turn."""
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


@pytest.mark.slow
def test_a_terminal_is_asked_and_told_what_is_wrong(tmp_path: Path) -> None:
    unknown, ellipse = str(len(LawName) + 1), str(list(LawName).index(LawName.ELLIPSE) + 1)
    answers = ["no name", "press", unknown, ellipse, "-3", "40", "x", "30", "", "60", "31", "~", " ", "2", "8"]
    status, shown = at_terminal(["new"], [f"{answer}\n" for answer in answers], tmp_path)
    assert (status, shown.splitlines()[-1]) == (0, "press.yaml")
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


@pytest.mark.slow
def test_what_flags_say_is_not_asked(tmp_path: Path) -> None:
    flags = ["--law", "uniform_crank", "--crank-mm", "20", "--speed-rpm", "9", "--teeth", "20", "--module-mm", "1"]
    status, shown = at_terminal(["new", "a", *flags], ["\n", "5\n"], tmp_path)
    assert status == 0
    assert [line.split(" [")[0] for line in shown.splitlines() if "[" in line] == [
        "length of the connecting rod in mm",
        "face width of the gears in mm",
    ]


@pytest.mark.slow
def test_answers_that_give_no_gears_are_asked_again(tmp_path: Path) -> None:
    """With the earlier ones as likely answers, of which only the wrong one need be changed."""
    flags = ["--stroke-mm", "300", "--rod-mm", "400", "--speed-rpm", "60", "--face-width-mm", "8"]
    answers = ["10\n", "1\n", "60\n", "\n"]
    status, shown = at_terminal(["new", "a", "--law", "three_segment_stroke", *flags], answers, tmp_path)
    assert status == 0
    assert "; other answers are needed" in shown
    assert "teeth of the driving gear [10]" in shown
    assert "module in mm [1]" in shown
    design = load(tmp_path / "a.yaml").design
    assert design.gears is not None
    assert design.gears.teeth == 60


def test_ctrl_c_at_a_question_writes_nothing(tmp_path: Path) -> None:
    status, shown = at_terminal(["new"], ["a\n", "\x03"], tmp_path)
    assert status == 130
    assert "Traceback" not in shown
    assert os.listdir(tmp_path) == []


def test_yes_asks_nothing(tmp_path: Path) -> None:
    status, shown = at_terminal(["new", "a", "--yes"], [], tmp_path)
    assert (status, shown) == (0, "a.yaml\r\n")
    assert (tmp_path / "a.yaml").read_text() == template("a")


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


@pytest.mark.thorough
def test_gears_that_cannot_be_made_are_refused_before_the_file_is_written(run: Run, tmp_path: Path) -> None:
    status, out, err = run("new", "a", "--teeth", "5")
    assert (status, out) == (3, "")
    assert err.startswith("gears.teeth: the root of the space after tooth 5 of the driving gear folds")
    assert os.listdir(tmp_path) == []


NAMES = ["12", "1e3", "true", "null", "-", "--", "---", "_", "0x1", "a", "yes", "-1", "NULL"]


@pytest.mark.parametrize("name", NAMES)
def test_names_that_yaml_takes_for_something_else(name: str) -> None:
    assert loads(template(name)).design.name == name


@pytest.mark.parametrize("law", LawName)
def test_only_lines_of_other_values_differ_from_the_template(law: LawName) -> None:
    """Comments stay, also those of lines that change."""
    before, after = template("a", law), begun("a", law, {"teeth": 45, "face_width_mm": 7.5})
    changed = [line for line in ndiff(before.splitlines(), after.splitlines()) if line[0] in "+-"]
    keys = {line[1:].strip().partition(":")[0] for line in changed}
    assert keys == {"teeth", "face_width_mm", "bore_mm", "keyway", "driven"}
    assert before.count("#") == after.count("#")
    assert rewritten(before, {}) == before


@pytest.mark.thorough
def test_the_template_keeps_its_proportions() -> None:
    """Twice the machine: the same law, the same force at each share of the stroke."""
    usual, twice = loads(template("a")), loads(begun("a", LawName.THREE_SEGMENT_STROKE, {"crank_mm": 760}))
    assert twice.linkage.stroke_mm == pytest.approx(2.0 * usual.linkage.stroke_mm)
    assert twice.law_speed_rpm == pytest.approx(usual.law_speed_rpm, rel=1e-3)
    assert twice.check.peak_acceleration_cycle_mm_s2.value == pytest.approx(
        2.0 * usual.check.peak_acceleration_cycle_mm_s2.value, rel=1e-3
    )
    assert twice.check.peak_power_w.value == pytest.approx(2.0 * usual.check.peak_power_w.value, rel=1e-3)


@pytest.mark.parametrize("answer", ["stroke_mm", "crank_mm", "rod_mm"])
def test_each_length_gives_the_others(answer: str) -> None:
    usual = template_answers()
    found = proportioned({answer: 0.5 * usual[answer]})
    assert {one: found[one] / usual[one] for one in ("stroke_mm", "crank_mm", "rod_mm")} == pytest.approx(
        {"stroke_mm": 0.5, "crank_mm": 0.5, "rod_mm": 0.5}
    )


@pytest.mark.parametrize("answer", ANSWERS)
def test_nothing_is_no_answer(answer: str) -> None:
    """Not even of a key that a design file may leave out."""
    assert fault_of(answer, None) == "nothing given; a number is needed"


def test_the_templates_own_answers_have_no_fault() -> None:
    assert [fault_of(answer, value) for answer, value in template_answers().items()] == [None] * len(ANSWERS)


SIZES = (
    ["--stroke-mm", "120", "--speed-rpm", "90", "--teeth", "34"],
    ["--crank-mm", "1000", "--rod-mm", "2100", "--teeth", "150", "--module-mm", "8", "--face-width-mm", "90"],
    ["--teeth", "9", "--module-mm", "0.5"],
)


@pytest.mark.slow
@pytest.mark.parametrize("law", LawName)
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


@pytest.mark.thorough
def test_no_file_is_touched_that_appears_while_answers_are_given(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("precious")
    done = fresh("new", "a", "--teeth", "50", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "a.yaml: exists already; choose another name, or remove it\n"
    assert (tmp_path / "a.yaml").read_text() == "precious"
