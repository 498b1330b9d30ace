"""`ncgear sweep` as a user meets it: the table, the best of it, the files, and what is said about wrong keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from commands import Outcome, Run, on_text
from ncgear.design.keys.design import Design
from ncgear.design.laws.registry import LawName
from ncgear.design.reading.design_file import load, parsed
from ncgear.design.reading.places import with_value
from ncgear.design.space import MOST_DESIGNS, MOST_VALUES
from ncgear.design.template import template
from ncgear.files import sweep as files
from ncgear.project.drive import Drive
from ncgear.screening.deeper import deepened, deeper_names
from ncgear.screening.designs import MADE, Designs
from ncgear.screening.single import single_figures

SPEEDS = "motion.v1_mm_s=1500:1700:3"


DRAWN = files.sweep_files


PUBLISHED = (
    template("press")
    .replace("solve_for: v1 ", "solve_for: law_speed ")
    .replace("# v1_mm_s: ", "v1_mm_s: 1600 ")
    .replace("v2_mm_s: 416.6", "v2_mm_s: 1100")
    .replace("# a1_speed_rpm: 20", "a1_speed_rpm: 20")
    .replace("law_speed_rpm: 20 ", "# law_speed_rpm: ")
)
"""The published law, whose speeds are those of a sweep."""


@pytest.fixture
def run(run: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Sweep over d.yaml, which holds the text; words that begin with a dash are options.  Nothing is drawn."""
    monkeypatch.setattr(files, "sweep_files", lambda *_: {})

    def run_once(*words: str, text: str = PUBLISHED) -> Outcome:
        options = [part for word in words for part in ([word] if word.startswith("-") else ["--vary", word])]
        return on_text(run, "sweep", "--verbose", "--processes=1")(text, *options)

    return run_once


def table(name: str = "sweep") -> list[dict[str, Any]]:
    from pyarrow import parquet

    rows: list[dict[str, Any]] = parquet.read_table(f"export/press-sweep/{name}.parquet").to_pylist()
    return rows


@pytest.mark.slow
def test_a_sweep_writes_a_row_for_every_combination(run: Run) -> None:
    status, out, err = run(SPEEDS, "operation.speed_rpm=20:40:2")
    assert (status, err) == (0, "")
    rows = [(row["motion.v1_mm_s"], row["operation.speed_rpm"]) for row in table()]
    assert rows == [(v1, rpm) for v1 in (1500, 1600, 1700) for rpm in (20, 40)]
    assert out.startswith("6 designs, of which 6 can be made\n")
    assert "export/press-sweep/sweep.parquet" in out
    assert [row["number"] for row in table()] == [*range(6)]


@pytest.mark.slow
def test_a_row_has_the_figures_of_its_design(run: Run) -> None:
    run(SPEEDS)
    row = table()[1]
    figures = single_figures(load(Path("d.yaml")).design)
    assert {name: row[name] for name in figures} == pytest.approx(figures, rel=1e-9, abs=1e-11)
    assert row["verdict"] == "made"


@pytest.mark.slow
def test_the_best_are_named_first(run: Run) -> None:
    _, out, _ = run("motion.a1_mm_s2=-3000:-1000:9")
    by_acceleration = min(table(), key=lambda row: float(row["check.peak_acceleration_cycle_mm_s2"]))
    first = out.partition("  least peak acceleration  ")[2].split()
    assert float(first[0]) == float(by_acceleration["motion.a1_mm_s2"])
    assert float(first[1]) == pytest.approx(float(by_acceleration["check.peak_acceleration_cycle_mm_s2"]), rel=1e-4)


@pytest.mark.slow
def test_of_designs_that_need_the_same_power_the_gentlest_is_named_first(run: Run) -> None:
    """The peak is that of the working stroke, which no choice of the return changes."""
    _, out, _ = run("motion.return.e=0.5:-0.5:5", text=PUBLISHED.replace("e: least_acceleration", "e: 0"))
    assert len({f"{row['check.peak_power_w']:.7g}" for row in table()}) == 1
    gentlest = min(table(), key=lambda row: float(row["check.peak_acceleration_cycle_mm_s2"]))
    first = out.partition("  least peak power  ")[2].split()
    assert float(first[0]) == gentlest["motion.return.e"] != 0.5


@pytest.mark.slow
def test_designs_that_cannot_be_made_have_a_verdict_and_no_figures(run: Run) -> None:
    status, out, _ = run("motion.v1_mm_s=1600:6000:2")
    assert status == 0
    assert out.startswith("2 designs, of which 1 can be made\n")
    refused = table()[1]
    assert refused["verdict"].startswith("motion.v1_mm_s: the slider stops or reverses inside the working stroke")
    assert {refused[name] for name in refused if name.startswith(("ratio.", "check.", "pitch."))} == {None}
    said = " ".join(out.split())
    assert f"designs 1 verdict {refused['verdict']} first at motion.v1 6000 mm/s" in said


@pytest.mark.slow
def test_refusals_are_told_to_their_end_with_the_design_and_the_keys_of_the_file(run: Run) -> None:
    """Many designs share one refusal; the first of them is named, with every word of its own."""
    _, out, _ = run("motion.theta1_pi=0.3:0.68:3", "motion.v1_mm_s=1700:9000:3")
    refused = {row["verdict"]: row for row in reversed(table()) if row["verdict"] != "made"}
    said = " ".join(out.split())
    told = [verdict for verdict in refused if verdict in said]
    assert told
    assert "theta1_rad" not in said
    for verdict in told:
        angle, speed = (float(refused[verdict][key]) for key in ("motion.theta1_pi", "motion.v1_mm_s"))
        assert f"{verdict} first at motion.theta1 {angle:.5g} multiples of pi motion.v1 {speed:.5g} mm/s" in said


@pytest.mark.slow
def test_values_that_the_schema_refuses_are_verdicts_too(run: Run) -> None:
    """Teeth are whole, and angles rise."""
    run("gears.teeth=25:26:3", "motion.theta2_pi=0.7:1.1:2")
    verdicts = [row["verdict"] for row in table()]
    assert verdicts[0] == "made"
    assert verdicts[1].startswith("motion.theta3_pi: theta3 must be theta2 or over")
    assert verdicts[2].startswith("gears.teeth: 25.5 given; a whole number is needed")


def test_items_of_lists_can_be_varied(run: Run) -> None:
    status, _, _ = run("motion.cosine.1=-0.1:0.1:3", text=template("press", LawName.HARMONIC_RATIO))
    assert status == 0
    assert len({row["ratio.max"] for row in table()}) == 3


@at_once(
    ("varied", "said"),
    [
        (["motion.v1=1:2:3"], "d.yaml: --vary: the file has no number at 'motion.v1'; did you mean motion.v1_mm_s?"),
        (["motion.law=1:2:3"], "d.yaml: --vary: the file has no number at 'motion.law'"),
        (["motion=1:2:3"], "d.yaml: --vary: the file has no number at 'motion'"),
        (["motion.return.e.x=1:2:3"], "d.yaml: --vary: the file has no number at 'motion.return.e.x'"),
        ([SPEEDS, SPEEDS], "d.yaml: --vary: motion.v1_mm_s is given twice; keep one"),
        (["motion.v1_mm_s"], "--vary: 'motion.v1_mm_s' given; KEY=FROM:TO:COUNT, KEY=A,B,C or KEY=FROM:TO, as"),
        (["motion.v1_mm_s=1"], "--vary: 'motion.v1_mm_s=1' given; KEY=FROM:TO:COUNT"),
        (["motion.v1_mm_s=1:2:3:4"], "--vary: 'motion.v1_mm_s=1:2:3:4' given; KEY=FROM:TO:COUNT"),
        (["motion.v1_mm_s=1:x:3"], "--vary: 'motion.v1_mm_s=1:x:3' given; KEY=FROM:TO:COUNT"),
        (["motion.v1_mm_s=1,x"], "--vary: 'motion.v1_mm_s=1,x' given; KEY=FROM:TO:COUNT"),
        (["motion.v1_mm_s=1,2,1"], "--vary: motion.v1_mm_s is given 1 twice; keep one"),
        (["motion.v1_mm_s=2:1"], "--vary: 'motion.v1_mm_s=2:1' given; a range from a smaller to a greater value"),
        (["motion.v1_mm_s=1:1e999:3"], "--vary: 'motion.v1_mm_s=1:1e999:3' given; KEY=FROM:TO:COUNT"),
        ([f"motion.v1_mm_s=1:{'4' * 340}:3"], "--vary: 'motion.v1_mm_s=1:444"),
        ([f"motion.v1_mm_s=-{'1' * 309}:{'1' * 309}:3"], "--vary: 'motion.v1_mm_s=-111"),
        ([f"motion.v1_mm_s=1:2:{'8' * 320}"], "--vary: 'motion.v1_mm_s=1:2:888"),
        (["motion.v1_mm_s=1:2:1"], f"--vary: 1 values of motion.v1_mm_s asked for; 2 to {MOST_VALUES} are right"),
        (["motion.v1_mm_s=1:2:2.5"], "--vary: 2.5 values of motion.v1_mm_s asked for"),
        (
            ["motion.v1_mm_s=1:2:100000", "motion.v2_mm_s=1:2:100000"],
            f"d.yaml: --vary: 10000000000 designs asked for; {MOST_DESIGNS} or fewer are right",
        ),
        (["motion.v1_mm_s=1:2"], "d.yaml: --samples: missing; motion.v1_mm_s has a range; give a number of"),
        ([SPEEDS, "--samples=8"], "d.yaml: --samples: nothing is sampled, since every key has a grid or a list"),
        (
            ["gears.teeth=20:40", "--samples=8"],
            "d.yaml: --vary: gears.teeth takes whole numbers only, and a range is sampled between them too; "
            "gears.teeth=20:40:21 is right",
        ),
        (
            [SPEEDS, "--objective=check.peak_powe_w"],
            "d.yaml: --objective: no figure 'check.peak_powe_w'; did you mean check.peak",
        ),
        (
            [SPEEDS, "--objective=contact.contact_ratio_min"],
            "d.yaml: --objective: no figure 'contact.contact_ratio_min'; ",
        ),
        (
            [SPEEDS, "--objective=ratio.min", "--objective=max:ratio.min"],
            "d.yaml: --objective: a figure is given twice",
        ),
        (
            [SPEEDS, "--keep-if=ratio.min"],
            "d.yaml: --keep-if: 'ratio.min' given; a name, one of < <= > >= == != and a number",
        ),
        (
            [SPEEDS, "--keep-if=__import__('os') < 1"],
            "d.yaml: --keep-if: \"__import__('os') < 1\" given; a name, one of",
        ),
        ([SPEEDS, "--keep-if=ratio.min < 1e999"], "d.yaml: --keep-if: 'ratio.min < 1e999' given; a name, one of"),
        ([SPEEDS, "--keep-if=ratio.mean < 1"], "d.yaml: --keep-if: no figure 'ratio.mean'; did you mean ratio.m"),
    ],
)
def test_wrong_keys_and_values_are_refused_at_once(run: Run, varied: list[str], said: str) -> None:
    status, out, err = run(*varied)
    assert (status, out) == (2, "")
    assert err.startswith(said)
    assert not Path("export").exists()


def test_a_sweep_needs_a_key(run: Run) -> None:
    status, _, err = run()
    assert status == 2
    assert "--vary" in err


def test_a_wrong_file_is_refused_with_its_place(run: Run) -> None:
    status, _, err = run(SPEEDS, text=PUBLISHED.replace("rod_mm", "rod_m"))
    assert status == 2
    assert err.startswith("d.yaml:10:3: linkage.rod_m: unknown key; did you mean rod_mm?")


HARMONIC = template("press", LawName.HARMONIC_RATIO)


@pytest.mark.slow
def test_the_pareto_set_is_written_as_files_that_give_its_figures(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """And pictures, which are drawn with constraints, samples, lists and a greatest objective."""
    monkeypatch.setattr(files, "sweep_files", DRAWN)
    status, out, err = run(
        "motion.cosine.1=-0.05:0.05",
        "operation.speed_rpm=20,22",
        "--samples=16",
        "--keep-if=operation.speed_rpm < 21",
        "--objective=check.peak_power_w",
        "--objective=max:ratio.min",
        text=HARMONIC,
    )
    assert (status, err) == (0, "")
    assert "16 keep speed_rpm < 21" in out
    folder = Path("export/press-sweep")
    assert {"effects.csv", "effects.png", "pareto.csv", "pareto.png", "scatter.png"} <= {
        p.name for p in folder.iterdir()
    }
    designs = sorted(folder.glob("best/*.yaml"))
    rows = {row["number"]: row for row in table()}
    costs = [(row["check.peak_power_w"], -row["ratio.min"]) for row in rows.values() if row["operation.speed_rpm"] < 21]
    for path in designs:
        row, design = rows[int(path.stem[-6:])], load(path).design
        assert design.name == path.stem
        found = single_figures(design)
        assert row["check.peak_power_w"] == pytest.approx(found["check.peak_power_w"], rel=1e-9)
        own = row["check.peak_power_w"], -row["ratio.min"]
        assert not any(power < own[0] and ratio < own[1] for power, ratio in costs)
    assert 1 <= len(designs) <= 8


@pytest.mark.slow
def test_the_best_go_on_to_teeth_and_contact(run: Run) -> None:
    """With the figures that a build of each would have; the others stay where they are."""
    status, out, err = run(
        "motion.cosine.1=-0.05:0.05:5", "--stage=contact", "--keep=2", "--objective=contact_ratio_min", text=HARMONIC
    )
    assert (status, err) == (0, "")
    assert "2 went on to contact, of which 2 can be made" in out
    followed = table("contact")
    assert [row["number"] for row in followed] == [0, 4]
    for row in followed:
        data = with_value(load(Path("d.yaml")).data, "motion.cosine.1", row["motion.cosine.1"])
        drive = Drive(Design.model_validate(data))
        assert row["contact.contact_ratio_min"] == pytest.approx(drive.designed_contact.least_arc, rel=1e-12)
        assert row["teeth.undercut_driven"] == len(drive.teeth.driven.undercut)
        assert row["teeth.driving"] == drive.gears.teeth


@pytest.mark.slow
def test_each_of_two_pairs_has_its_own_figures(run: Run) -> None:
    """Those of the pair by itself, in its own columns; an objective names the pair."""
    status, out, err = run(
        "motion.second_stage.cosine.0=0.02,0.06",
        "--stage=contact",
        "--objective=stage_2.contact.contact_ratio_min",
        "--keep-if=stage_2.contact.contact_ratio_min > 1",
        text=HARMONIC.replace("gears:", "  second_stage: {cosine: [0.04]}\ngears:"),
    )
    assert (status, err) == (0, "")
    assert "stage 2 contact ratio" in out
    assert "2 keep stage 2 contact_ratio_min > 1" in out
    for row in table("contact"):
        data = with_value(
            load(Path("d.yaml")).data, "motion.second_stage.cosine.0", row["motion.second_stage.cosine.0"]
        )
        ratios = [pair.designed_contact.least_arc for pair in Drive(Design.model_validate(data)).by_stage]
        found = [row[f"stage_{stage}.contact.contact_ratio_min"] for stage in (1, 2)]
        assert found == pytest.approx(ratios, rel=1e-12)
        assert ratios[0] != pytest.approx(ratios[1], rel=1e-3)


def test_a_stage_that_no_design_can_reach_is_refused(run: Run) -> None:
    text = HARMONIC[: HARMONIC.index("gears:")].replace("fit: {driving_shaft: ends}", "")
    status, _, err = run("motion.cosine.1=-0.05:0.05:5", "--stage=teeth", text=text)
    assert status == 2
    assert "gears: missing; without gears there is no stage teeth, and --stage check is right" in err


PUMP = """\
name: pump
linkage: {crank_mm: 20, rod_mm: 80}
operation: {speed_rpm: 30}
motion: {law: harmonic_ratio, cosine: [0.1]}
gears: {teeth: 17, module_mm: 2, face_width_mm: 12, driving: {bore_mm: 8}, profile_shift: {driving: 0.3}}
resistance: {polynomial_n: [200]}
"""


@pytest.mark.thorough
def test_designs_with_the_teeth_of_the_design_before_have_the_figures_that_they_have_alone() -> None:
    """To the last digit: a width keeps teeth, loads and rims, a bore teeth and loads, a speed teeth, a shift none."""
    keys = "gears.face_width_mm", "gears.driving.bore_mm", "operation.speed_rpm", "gears.profile_shift.driving"
    rows = np.array(
        [
            (12.0, 8.0, 30.0, 0.3),
            (15.0, 8.0, 30.0, 0.3),
            (15.0, 9.0, 30.0, 0.3),
            (15.0, 9.0, 60.0, 0.3),
            (15.0, 9.0, 60.0, 0.4),
        ]
    )
    data, count = parsed(PUMP, Path("pump")).data, len(rows)
    every = Designs(np.arange(count), dict(zip(keys, rows.T, strict=True)), {}, np.full(count, MADE, dtype=object))
    names = deeper_names(parsed(PUMP, Path("pump")).design, "strength")
    together = deepened(data, names, "strength", every)
    assert together.made.all()
    for number in range(count):
        alone = deepened(data, names, "strength", every.at(np.array([number]))).figures
        assert {name: column[number] for name, column in together.figures.items()} == {
            name: column[0] for name, column in alone.items()
        }
    assert np.unique(together.figures["strength.bending_safety_driving_min"]).size == count
