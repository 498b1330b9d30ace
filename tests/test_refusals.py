"""What a user sees when a design cannot be: status, place, key, remedy; what stays untouched.

Refusals are told in this process; what goes to the pipes and what a failed build leaves, by the real program.
"""

from __future__ import annotations

import json
import pickle
import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from commands import ROOT, Process, Run, changed, fresh
from ncgear import errors
from ncgear.design.laws.registry import LawName
from tiers import long_but

BALER = (ROOT / "designs" / "baler.yaml").read_text(encoding="utf-8")
MOTION = "motion: {law: ellipse, eccentricity: 0.35, phase_deg: 200}"
ELLIPSE = (ROOT / "designs" / "ellipse.yaml").read_text(encoding="utf-8")

Program = Callable[..., Process]


@pytest.fixture
def program(tmp_path: Path) -> Program:
    """Run the program in a process of its own, in an empty folder."""
    return partial(fresh, folder=tmp_path)


def line_of(text: str, word: str) -> int:
    return next(number for number, line in enumerate(text.splitlines(), 1) if word in line)


WRONG = {
    # name: (command, text, where it points, key, what it says)
    "rod shorter than crank": (
        "check",
        changed(BALER, "rod_mm: 960", "rod_mm: 300"),
        "rod_mm",
        "linkage.rod_mm",
        "a rod over 380 mm works",
    ),
    "offset beyond reach": (
        "check",
        changed(ELLIPSE, "offset_mm: 12", "offset_mm: 111"),
        "rod_mm",
        "linkage.rod_mm",
        "it must exceed the offset of 111 mm",
    ),
    "stroke longer than the linkage has": (
        "check",
        changed(BALER, "stroke_mm: 760", "stroke_mm: 761"),
        "stroke_mm",
        "motion.stroke_mm",
        "longer than the linkage's stroke of 760 mm",
    ),
    "three sizes that disagree": (
        "build",
        changed(BALER, "  module_mm: 3 ", "  center_distance_mm: 200\n  module_mm: 3 "),
        "center_distance_mm",
        "gears.center_distance_mm",
        "center_distance_mm: 74.88",
    ),
    "no whole number of teeth": (
        "build",
        changed(ELLIPSE, "teeth: 37", "center_distance_mm: 76"),
        "center_distance_mm",
        "gears.center_distance_mm",
        "with 37 teeth",
    ),
    "bore beyond the roots": (
        "build",
        changed(ELLIPSE, "  driving: {bore_mm: 10}", "  driving: {bore_mm: 60}"),
        "driving: {bore_mm",
        "gears.driving.bore_mm",
        "",
    ),
    "root radius too large": (
        "build",
        changed(BALER, "rack: {profile: A}", "rack: {profile: A, root_radius: 0.6}"),
        "rack:",
        "gears.rack.root_radius",
        "is the most",
    ),
    "helical teeth of equivalent gears": (
        "build",
        changed(
            ELLIPSE,
            "  driving: {bore_mm: 10}",
            "  helix: {angle_deg: 10, kind: helical, hand: right}\n  method: equivalent_gear",
        ),
        "method:",
        "gears.method",
        "helical teeth are made of exact sections",
    ),
    "points of a resistance beyond any machine": (
        "check",
        changed(
            BALER,
            "polynomial_n: [-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7]",
            "table: {displacement_mm: [0, 1.0e+300], force_n: [0, 1]}",
        ),
        "table:",
        "resistance.table.displacement_mm.1",
        "of 1e+07 or under",
    ),
    "name outside the whitelist": (
        "check",
        changed(
            ELLIPSE,
            MOTION,
            'motion: {law: ratio_expression, ratio: "x"}',
        ),
        "motion:",
        "motion.ratio",
        "unknown name 'x'",
    ),
    "call outside the whitelist": (
        "check",
        changed(
            ELLIPSE,
            MOTION,
            "motion: {law: ratio_expression, ratio: \"__import__('os').system('touch owned')\"}",
        ),
        "motion:",
        "motion.ratio",
        "unknown function",
    ),
}

IMPOSSIBLE = {
    "slider reverses": (
        "check",
        changed(BALER, "v2_mm_s: 1100", "v2_mm_s: 40"),
        "motion.",
        "reverses inside the working stroke at phi1 =",
    ),
    "a1 positive": (
        "check",
        changed(BALER, "a1_mm_s2: -1500", "a1_mm_s2: 1500"),
        "motion.a1_mm_s2",
        "phi1 = 4.08407 rad",
    ),
    "ratio does not close": (
        "check",
        changed(
            ELLIPSE,
            MOTION,
            'motion: {law: ratio_expression, ratio: "1 + 0.3*cos(phi)"}',
        ),
        "motion.ratio",
        "multiply the ratio by 1.0482848",
    ),
    "ratio through zero": (
        "check",
        changed(
            ELLIPSE,
            MOTION,
            'motion: {law: ratio_expression, ratio: "0.5 + cos(phi)", scale_to_close: true}',
        ),
        "motion.ratio",
        "near phi1 =",
    ),
    "rack on a concave pitch curve": (
        "build",
        changed(BALER, "rack: {profile: A}", "rack: {profile: A}\n  cutter: {kind: rack}"),
        "gears.cutter.kind",
        "what works: gears.cutter.kind: mate (contact ratio",
    ),
}


@pytest.mark.tiers(slow=["root radius too large"], rest="quick")
@pytest.mark.judges("cli")
@pytest.mark.parametrize("case", WRONG)
def test_wrong_input(case: str, run: Run, tmp_path: Path) -> None:
    command, text, place, key, says = WRONG[case]
    (tmp_path / "d.yaml").write_text(text, encoding="utf-8")
    status, out, err = run(command, "d.yaml")
    assert status == 2
    assert err.startswith(f"d.yaml:{line_of(text, place)}:")
    assert f" {key}: " in err
    assert says in err
    assert out == ""
    assert "Traceback" not in err
    assert {path.name for path in tmp_path.iterdir()} == {"d.yaml"}


@pytest.mark.slow
@pytest.mark.parametrize("case", IMPOSSIBLE)
def test_no_such_mechanism(case: str, run: Run, tmp_path: Path) -> None:
    command, text, key, says = IMPOSSIBLE[case]
    (tmp_path / "d.yaml").write_text(text, encoding="utf-8")
    status, out, err = run(command, "d.yaml")
    assert status == 3
    assert err.startswith("d.yaml:")
    assert key in err
    assert says in err
    assert out == ""
    assert "Traceback" not in err


@pytest.mark.long
@pytest.mark.slow
def test_a_failed_build_leaves_the_last_good_one(program: Program, tmp_path: Path) -> None:
    design = tmp_path / "d.yaml"
    design.write_text(ELLIPSE, encoding="utf-8")
    assert program("build", "d.yaml", "--out", "out").returncode == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    design.write_text(changed(ELLIPSE, "bore_mm: 10}\n  driven", "bore_mm: 60}\n  driven"), encoding="utf-8")
    assert program("build", "d.yaml", "--out", "out").returncode == 2
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


@pytest.mark.long
@pytest.mark.slow
def test_results_go_to_the_pipe_and_nothing_else(program: Program, tmp_path: Path) -> None:
    (tmp_path / "d.yaml").write_text(BALER, encoding="utf-8")
    done = program("check", "d.yaml", "--json")
    assert done.stderr == ""
    assert json.loads(done.stdout)["check"]["peak_power_w"] == pytest.approx(6315.1, abs=0.1)
    built = program("build", "d.yaml", "--out", "out", "--verbose")
    assert said_beside_progress(built.stderr) == ""
    assert "out/driving.stl" in built.stdout


def said_beside_progress(stderr: str) -> str:
    """What was said beside the lines of progress, which come where a computer needs more than five seconds."""
    return re.sub(r"^\d+ s: .*\n", "", stderr, flags=re.MULTILINE)


@pytest.mark.long
@pytest.mark.slow
def test_timing_is_reported_beside_the_results(program: Program, tmp_path: Path) -> None:
    (tmp_path / "d.yaml").write_text(ELLIPSE, encoding="utf-8")
    done = program("build", "d.yaml", "--out", "out", "--timing")
    assert "teeth" in done.stderr
    timing = json.loads((tmp_path / "out" / "summary.json").read_text())["timing_s"]
    assert {"law", "pitch curves", "teeth", "contact", "solids", "plots"} <= set(timing)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("law", long_but([LawName.THREE_SEGMENT_STROKE, LawName.FUNCTION_GENERATOR], LawName))
def test_a_new_design_builds(law: LawName, program: Program, tmp_path: Path) -> None:
    assert program("new", "mine", "--law", law).returncode == 0
    done = program("build", "mine.yaml")
    assert (done.returncode, said_beside_progress(done.stderr)) == (0, "")
    assert (tmp_path / "export" / "mine" / "summary.json").exists()


def test_errors_come_back_from_another_process_and_may_be_said_in_other_words() -> None:
    def kinds(of: type[errors.DesignError]) -> Iterator[type[errors.DesignError]]:
        yield of
        for one in of.__subclasses__():
            yield from kinds(one)

    def made(kind: type[errors.DesignError]) -> errors.DesignError:
        error = kind.__new__(kind, "no")
        errors.DesignError.__init__(error, "no", key="a.b")
        return error

    known = errors.RefusedAt("no", phi1_rad=0.7, key="a.b", location="f:1:2")
    for error in (*map(made, kinds(errors.DesignError)), known):
        back = pickle.loads(pickle.dumps(error))
        assert (type(back), str(back), vars(back)) == (type(error), str(error), vars(error))
        other = error.saying("yes")
        assert (type(other), vars(other)) == (type(error), vars(error) | {"problem": "yes"})
        assert vars(error.saying("yes", "c")) == vars(error) | {"problem": "yes", "key": "c", "location": ""}
