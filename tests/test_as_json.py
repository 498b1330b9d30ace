"""``--json``: the same of every command that tells figures, exactly those of the JSON file that it writes."""

from __future__ import annotations

import inspect
import json
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

import pytest

from commands import ROOT, Run
from drives import drive_of_text
from ncgear.cli.app import COMMANDS
from ncgear.cli.arguments import AsJson, print_figures
from ncgear.errors import Unanswered
from ncgear.figures.tables import outline_csv
from ncgear.figures.terminal import kept_lines

WITHOUT = {"studio", "animate", "new", "examples", "explain", "schema", "freecad"}
"""Commands that tell no figure of a machine: they open, draw, begin, explain, or print JSON anyway."""

MACHINE = """\
name: press
linkage: {crank_mm: 45, rod_mm: 170}
operation: {speed_rpm: 55}
motion: {law: uniform_crank}
"""
GEARS = "gears: {teeth: 22, module_mm: 3, face_width_mm: 20, driving: {bore_mm: 12}, driven: {bore_mm: 12}}\n"
LOAD = "resistance: {expression_n: 150 + 2*x}\n"
MASSES = """\
masses:
  slider_kg: 4
  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
"""
KNOTS = "optimize: {knots: 12}\n"
DESIGN = MACHINE + GEARS + LOAD + MASSES
QUICKER = {
    # Without gears only the motion is measured.
    "bench": MACHINE,
    "design": DESIGN + "choices: {machines: 1}\n",
    "optimize": MACHINE + LOAD + KNOTS,
    "fit": "name: tile\noperation: {speed_rpm: 30}\noutline: {axis: fixed}\ngears: {teeth: 48, face_width_mm: 8}\n"
    "motion: {law: pitch_curve, ellipse: {semi_major_mm: 30, semi_minor_mm: 20}}\n",
    # The published family, whose search is long, is left out where masses are given.
    "frontier": MACHINE + LOAD + MASSES + KNOTS,
}
"""Designs of commands that would take long for the design above."""

TWO_STAGES = "{law: harmonic_ratio, cosine: [-0.2], second_stage: {sine: [0.1]}}"
TWO_PAIRS = MACHINE.replace("{law: uniform_crank}", TWO_STAGES) + GEARS + LOAD
SHAKING = "name: machine\nspeed_rpm: 55\nmechanisms: [{name: press, design: d.yaml}]\n"

CASES = {
    "check": ("check d.yaml", ""),
    "compare": ("compare d.yaml d.yaml --out out", "compare.json"),
    "formulas": ("formulas d.yaml", ""),
    "build": ("build d.yaml --format svg --out out", "summary.json"),
    "report": ("report d.yaml --out out", ""),
    "simulate": ("simulate d.yaml --out out", "simulation.json"),
    "strength": ("strength d.yaml --out out", "strength.json"),
    "tolerance": ("tolerance d.yaml --samples 64 --out out", "tolerance.json"),
    "size": ("size d.yaml --out out/sized.yaml", ""),
    "design": ("design d.yaml --processes 1 --out out", "machines.json"),
    "optimize": ("optimize d.yaml --out out", "certificate.json"),
    "fit": ("fit d.yaml --out out", "fit.json"),
    "frontier": ("frontier d.yaml --points 2 --out out", "frontier.json"),
    "sweep": ("sweep d.yaml --vary linkage.rod_mm=40,160,180 --processes 1 --out out", "sweep.json"),
    "measured": ("measured d.yaml --driving points.csv --out out", "measured.json"),
    "bench": ("bench d.yaml --out out", "bench.json"),
    "balance": ("balance machine.yaml --out out", "balance.json"),
    "reproduce": ("reproduce --out out", "reproduction.json"),
}
"""Each command, and the name of its JSON file where it writes one."""


@cache
def points() -> str:
    """The outline of the driving gear, as if it had been measured."""
    return outline_csv(drive_of_text(MACHINE + GEARS).teeth.driving.outline_mm)


def write_files(text: str) -> None:
    """What all commands read."""
    for name, content in {"d.yaml": text, "machine.yaml": SHAKING, "points.csv": points()}.items():
        Path(name).write_text(content)


def only_json(out: str) -> dict[str, Any]:
    """The one JSON object that a text is, without numbers that JSON does not know."""

    def no_number(token: str) -> NoReturn:
        raise AssertionError(token)

    found = json.loads(out, parse_constant=no_number)
    assert isinstance(found, dict)
    return found


def test_every_command_that_tells_figures_has_the_same_option() -> None:
    asked = {one.__name__: inspect.signature(one, eval_str=True).parameters.get("as_json") for one in COMMANDS}
    assert {name for name, option in asked.items() if option is None} == WITHOUT
    assert all(option.annotation == AsJson for option in asked.values() if option is not None)
    assert set(CASES) == set(asked) - WITHOUT


@pytest.mark.tiers(
    quick=["check"], long=["fit", "frontier", "size", "design", "optimize", "tolerance", "simulate"], rest="slow"
)
@pytest.mark.parametrize("name", CASES)
def test_json_is_what_the_file_holds_and_all_that_is_printed(name: str, run: Run) -> None:
    """A file of others in the place of the JSON file is told of on stderr."""
    words, file = CASES[name]
    write_files(QUICKER.get(name, DESIGN))
    others = Path("out", file)
    if file:
        others.parent.mkdir()
        others.write_bytes(b"of others")
    status, out, err = run(*words.split(), "--json")
    kept = [others.with_name(f"{others.stem}-kept.json")] if file else []
    assert (status, err) == (0, "".join(f"{line}\n" for line in kept_lines(kept)))
    found = only_json(out)
    if file:
        assert out == others.read_text()
    status, said, _ = run(*words.split())
    assert status == 0
    with pytest.raises(json.JSONDecodeError):
        json.loads(said)
    if file and name != "bench":
        assert without_times(only_json(others.read_text())) == without_times(found)


def without_times(found: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in found.items() if key != "timing_s"}


@pytest.mark.long
@pytest.mark.slow
def test_a_report_tells_what_a_build_tells(run: Run) -> None:
    write_files(DESIGN)
    report, build = (only_json(run(name, "d.yaml", "--json")[1]) for name in ("report", "build"))
    own = "timing_s", "files"
    assert {key: value for key, value in report.items() if key not in own} == {
        key: value for key, value in build.items() if key not in own
    }
    assert report["files"] == {}
    assert report["timing_s"]["contact"] > 0.0


@pytest.mark.slow
def test_a_report_without_gears_tells_what_a_check_tells(run: Run) -> None:
    write_files(MACHINE + LOAD)
    report, check = (run(name, "d.yaml", "--json")[1] for name in ("report", "check"))
    assert report == check


@pytest.mark.long
@pytest.mark.slow
def test_sizes_are_those_of_the_design_that_is_written(run: Run) -> None:
    write_files(DESIGN)
    status, out, err = run("size", "d.yaml", "--out", "small.yaml", "--json")
    assert (status, err) == (0, "")
    first = only_json(out)["smallest"][0]
    strong = only_json(run("strength", "small.yaml", "--method", "estimate", "--json")[1])
    assert first["strength"] == strong["strength"]
    assert first["module_mm"] == strong["gears"]["module_mm"] == first["keys"]["gears.module_mm"]
    built = only_json(run("build", "small.yaml", "--format", "svg", "--json")[1])
    assert first["center_distance_mm"] == built["pitch"]["center_distance_mm"]
    assert (first["teeth_driving"], first["teeth_driven"]) == (built["teeth"]["driving"], built["teeth"]["driven"])


@pytest.mark.slow
def test_a_sweep_tells_the_best_as_a_check_does_and_why_others_are_refused(run: Run) -> None:
    """A rod of 40 mm is shorter than the crank."""
    write_files(DESIGN)
    found = only_json(run(*CASES["sweep"][0].split(), "--json")[1])
    screened = found["screened"]
    assert (screened["designs"], screened["made"], screened["kept"]) == (3, 2, 2)
    assert [(one["designs"], one["first_at"]) for one in screened["refused"]] == [(1, {"linkage.rod_mm": 40.0})]
    best = found["best"]["check.peak_acceleration_cycle_mm_s2"]
    assert [one["linkage.rod_mm"] for one in best] == [180.0, 160.0]
    Path("d.yaml").write_text(DESIGN.replace("rod_mm: 170", "rod_mm: 180"))
    check = only_json(run("check", "d.yaml", "--json")[1])["check"]
    for key in ("peak_power_w", "peak_acceleration_cycle_mm_s2"):
        assert best[0][f"check.{key}"] == pytest.approx(check[key], rel=1e-9)


@pytest.mark.tiers(long=["build-*"], rest="slow")
@pytest.mark.parametrize(("name", "file"), [("build", "summary.json"), ("strength", "strength.json"), ("report", "")])
def test_two_pairs_in_series_stand_below_stages(name: str, file: str, run: Run) -> None:
    write_files(TWO_PAIRS)
    status, out, err = run(name, "d.yaml", "--out", "out", "--json")
    assert (status, err) == (0, "")
    found = only_json(out)
    assert list(found) == ["stages"]
    assert [one["stage"]["number"] for one in found["stages"].values()] == [1, 2]
    if file:
        pairs = {f"stage_{n}": only_json(Path("out", f"stage-{n}", file).read_text()) for n in (1, 2)}
        assert found["stages"] == pairs


@pytest.mark.long
@pytest.mark.slow
def test_what_was_mended_is_said_on_stderr(run: Run) -> None:
    coarse = (ROOT / "designs" / "ellipse.yaml").read_text().replace("teeth: 37", "teeth: 7")
    write_files(coarse.replace("module_mm: 2", "module_mm: 10"))
    status, out, err = run("build", "d.yaml", "--format", "svg", "--mend", "--json")
    assert status == 0
    assert err.startswith("Mended: these are not the gears of the file")
    assert only_json(out)["teeth"]["driving"] == 13


STOPPING = """{
  law: three_segment_stroke, solve_for: v1, theta1_pi: 0.4, theta2_pi: 0.5, theta3_pi: 1.0, theta4_pi: 1.3,
  v2_mm_s: 150, a1_mm_s2: -800, law_speed_rpm: 30, return: {basis: inverse_ratio}}"""
IMPOSSIBLE = DESIGN.replace("{law: uniform_crank}", STOPPING) + "optimize: {limits: {driven_speed_rpm: 55}}\n"


REFUSED = {2: DESIGN.replace("rod_mm", "rod_mn"), 3: IMPOSSIBLE}
READING = [name for name in CASES if name != "reproduce"]


# A sweep only counts the designs that are impossible, and a law of the slider draws no outline to be followed.
@pytest.mark.tiers(quick=["2-*", "3-check", "3-build", "3-strength"], rest="slow")
@pytest.mark.parametrize(
    ("status", "name"),
    [*((2, name) for name in READING), *((3, name) for name in READING if name not in ("sweep", "fit"))],
)
def test_a_refusal_prints_nothing_to_stdout(status: int, name: str, run: Run) -> None:
    """With the same status and the same words as without the option."""
    write_files(REFUSED[status])
    words = CASES[name][0].split()
    found = run(*words, "--json")
    assert found[:2] == (status, "")
    assert found == run(*words)
    assert not Path("out").exists()


def test_figures_of_pairs_are_told_by_stage(capsys: pytest.CaptureFixture[str]) -> None:
    print_figures({"a_mm": 0.1}, {"a_mm": 1e-17})
    assert only_json(capsys.readouterr().out) == {"stages": {"stage_1": {"a_mm": 0.1}, "stage_2": {"a_mm": 1e-17}}}


@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
def test_what_is_no_number_is_not_printed(wrong: float, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(Unanswered, match=r"b\.a_mm"):
        print_figures({"b": {"a_mm": wrong}})
    assert capsys.readouterr().out == ""


@pytest.mark.slow
@pytest.mark.parametrize(("backlash_mm", "broken"), [(0.001, {"jams"}), (0.5, set())])
def test_assemblies_are_judged_in_json_as_at_the_terminal(backlash_mm: float, broken: set[str], run: Run) -> None:
    write_files(DESIGN.replace(GEARS, GEARS.replace("gears: {", f"gears: {{backlash_mm: {backlash_mm}, ")))
    words = "tolerance", "d.yaml", "--samples", "64", "--out", "out"
    found, (_, said, _) = only_json(run(*words, "--json")[1]), run(*words)
    rows = {row["condition"]: row for row in found["verdict"]}
    assert {name for name, row in rows.items() if row["verdict"] == "broken"} == broken
    assert [row["because"] for row in found["verdict"] if row["because"]] == [
        line.partition(". To change it")[0] for line in found["warnings"]
    ]
    assert all(f"  {rows[name]['because']}" in said for name in broken)
    assert (f"{len(broken)} warning" in said) == bool(broken)
    assert ("of the assemblies turn, with little play where the torque turns round." in " ".join(said.split())) == (
        not broken
    )
