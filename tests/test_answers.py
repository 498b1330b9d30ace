"""Answers on one screen: every command on every design keeps to it, and says the same figures as every other place."""

from __future__ import annotations

import html
import json
import re
from math import degrees
from pathlib import Path

import pytest

import reports
from at_once import at_once
from commands import ROOT, Run
from drives import DESIGNS, MACHINES, designs_with, drive, loaded
from ncgear.figures.advice.values import Advice, Kind, Remedy
from ncgear.figures.advice.verdict import JudgedCondition, KnownParts, Verdict, judged, together
from ncgear.figures.answers.answer import (
    COLUMNS,
    LINES,
    VERBOSE,
    Answer,
    Fault,
    Row,
    answer_text,
    difference,
    faults_of,
    told_once,
)
from ncgear.figures.answers.machine import build_answer, check_answer, head_of
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.figures.numbers import NAMES, SIZES, name_of
from ncgear.figures.summary.build_summary import build_summary
from ncgear.figures.terminal import _table, figures_text
from ncgear.project.drive import Drive
from tiers import long_but

NAMED = [*MACHINES]
BALANCES = sorted(path.stem for path in (DESIGNS / "balance").glob("*.yaml"))
WITH_MASSES = designs_with("masses")
LOADED = designs_with("masses", "resistance")
GEARED = designs_with("gears")
QUICK = ["pusher", "baler", "desk-toy"]


def fits(text: str) -> bool:
    """Whether a text fits on one screen: here the limits are numbers of their own."""
    lines = text.rstrip("\n").split("\n")
    return len(lines) <= 24 and max(map(len, lines)) <= 100


def test_the_screen_is_the_one_that_is_meant() -> None:
    assert (LINES, COLUMNS) == (24, 100)
    assert fits("\n".join(["x" * 100] * 24))
    assert not fits("\n" * 24 + "x")
    assert not fits("x" * 101)


# --- every command on every design


def checked(name: str) -> str:
    made = drive(name)
    return answer_text(check_answer(made, judged(made, KnownParts.MOTION), f"designs/{name}.yaml"))


@pytest.mark.tiers(quick=QUICK, rest="slow")
@pytest.mark.parametrize("name", NAMED)
def test_a_check_is_a_screen(name: str) -> None:
    text = checked(name)
    assert fits(text), text
    assert text.startswith(f"{name}: ")
    assert "peak speed" in text
    assert ("Next: ncgear build" in text) == (loaded(name).design.gears is not None)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ellipse", "baler-66-two-stage"])
def test_a_check_makes_no_tooth(name: str) -> None:
    made = Drive(loaded(name).design)
    answer_text(check_answer(made, judged(made, KnownParts.MOTION), "d.yaml"))
    assert all("teeth" not in vars(pair) for pair in (made, *made.by_stage))


RUNS = {
    "build": GEARED,
    "strength": sorted({*LOADED} & {*GEARED}),
    "size": ["printed-pump", "pusher"],
    "optimize": ["baler", "baler-real", "feeder-wishes", "rocker-drive", "baler-66-two-stage"],
    "frontier --points 2": ["printed-pump"],
    "simulate": WITH_MASSES,
    "simulate --level quasi_static": WITH_MASSES,
    "simulate --level dynamic": ["baler-half-dynamics"],
}
"""Commands and the designs on which they are tried: those that take long on some of each kind, since a text of any
answer fits (below)."""

EVERY = [f"{command} {name}" for command, names in RUNS.items() for name in names]
FEW = ["build baler", "build printed-pump", "strength baler", "simulate baler-drivetrain", "optimize baler"]


@pytest.mark.tiers(slow=["strength baler"], rest="long")
@pytest.mark.parametrize("case", long_but(FEW, EVERY))
def test_every_command_answers_on_a_screen(case: str, run: Run) -> None:
    command, *options, name = case.split()
    status, text, err = run(command, str(DESIGNS / f"{name}.yaml"), *options)
    if status == 3 or "motion.second_stage" in err or "motion.law: open" in err:
        pytest.skip("refused")
    assert status == 0, err
    assert fits(text), text
    assert VERBOSE in text or "Next: " in text


@pytest.mark.tiers(slow=["threshing-drum", "baler", "track-chassis"], rest="long")
@pytest.mark.parametrize("name", BALANCES)
def test_a_balance_is_a_screen(name: str, run: Run) -> None:
    status, text, _ = run("balance", str(DESIGNS / "balance" / f"{name}.yaml"))
    assert status == 0
    assert fits(text), text


@pytest.mark.slow
def test_a_sweep_is_a_screen(run: Run) -> None:
    vary = "--vary", "motion.v1_mm_s=1400:1800:4", "--vary", "motion.v2_mm_s=900:1300:4"
    status, text, _ = run("sweep", str(DESIGNS / "baler.yaml"), *vary)
    assert status == 0
    assert fits(text), text


# --- the text of an answer

LONG = "word " * 30
CROWDED = Answer(
    f"name: {LONG}",
    tuple(Row(f"figure {number}", ("1 mm", "2 mm", "3 times")) for number in range(30)),
    tuple(Fault(f"fault {number}", (LONG, "short cure")) for number in range(30)),
    "words about it",
    (LONG, LONG),
    ("this design", "another"),
    then=LONG,
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("design", "changes", "rows"),
    [
        ("baler-drivetrain", "", ("face load  computed: ", "wear ", "film ", "scuffing ", "knocks ")),
        ("pusher", "material: POM", ("face load ", "wear ", "heat ", "creep ")),
    ],
)
def test_what_lowers_safeties_is_told_on_one_screen(run: Run, design: str, changes: str, rows: tuple[str, ...]) -> None:
    """Without --verbose; the angle of the greatest load along the width is that of the figures."""
    text = (DESIGNS / f"{design}.yaml").read_text(encoding="utf-8")
    Path("one.yaml").write_text(text.replace("\ngears:\n", f"\ngears:\n  {changes}\n"), encoding="utf-8")
    status, out, _ = run("strength", "one.yaml", "--out", "told")
    assert status == 0
    assert len(out.splitlines()) <= LINES
    assert [row for row in rows if f"\n  {row}" not in out] == []
    face_load = json.loads(Path("told/strength.json").read_text())["face_load"]
    if face_load:
        angle = degrees(face_load["decisive_factor_at_rad"])
        assert f"tooth {face_load['decisive_tooth']}, phi1 = {angle:.1f} deg" in out


def test_the_most_crowded_answer_is_a_screen() -> None:
    paths = [Path(f"export/x/file-{number}.csv") for number in range(90)]
    text = answer_text(CROWDED, paths, paths)
    assert fits(text)
    assert "figure 0 " in text
    assert "  fault 0 -> short cure" in text
    left = re.search(r"and (\d+) more: --verbose", text)
    assert left is not None
    assert int(left[1]) + text.count("  fault ") == 30
    assert re.search(r"^Written to export/x: file-0\.csv, .* and \d+ more$", text, re.MULTILINE)
    assert text.count("Kept under a new name") == 1


def test_no_word_of_a_reason_is_cut() -> None:
    said = ["what", "cure", "unknown", "next", "note", "head"]
    what, cure, unknown, then, note, head = (" ".join(f"{word}{number}" for number in range(20)) for word in said)
    rows = (Row("ratio", (what,)),)
    text = answer_text(Answer(head, rows, (Fault(what, (cure,)),), "", (note,), not_judged=unknown, then=then))
    assert max(map(len, text.splitlines())) <= 100
    assert " ".join(text.split()).count(what) == 2
    assert all(one in " ".join(text.split()) for one in (f"{what} -> {cure}", unknown, then, note, head))


def test_what_has_room_is_told_in_full() -> None:
    answer = Answer("name: a crank-slider", (Row("ratio", ("0.5 to 2",)),), (Fault("one"), Fault("two", ("this",))))
    assert answer_text(answer, [Path("a/b.csv"), Path("a/summary.json")]).splitlines() == [
        "name: a crank-slider",
        "",
        "  ratio  0.5 to 2",
        "",
        "2 warnings, the most serious first (-> what would help)",
        "  one",
        "  two -> this",
        "",
        "Written to a: summary.json, b.csv",
        "More: --verbose prints every figure",
    ]


def test_what_would_help_goes_before_the_last_figures() -> None:
    """Of three warnings all of it, with figures for the rest of the screen."""
    rows = tuple(Row(f"figure {number}", (f"{number} mm",)) for number in range(20))
    faults = tuple(Fault(f"{of} " + 80 * "x", (f"mend {of}" + 50 * "y",)) for of in ("first", "second", "third"))
    text = answer_text(Answer("head", rows, faults))
    assert all(f"-> mend {of}" in text for of in ("first", "second", "third"))
    assert len(text.splitlines()) == 24
    assert "figure 8" in text


def test_columns_stand_below_their_heads() -> None:
    rows = Row("a", ("1 mm", "20 mm", "5 % lower")), Row("longer", ("1000 mm", "2 mm", "")), Row("alone", ("x",))
    lines = answer_text(Answer("h", rows, heads=("this", "other"))).splitlines()
    assert lines[2:6] == [
        "             this  other",
        "  a          1 mm  20 mm  5 % lower",
        "  longer  1000 mm   2 mm",
        "  alone  x",
    ]


def advice(kind: Kind, matters: bool = True) -> Advice:
    return Advice(kind, kind.value, "meaning", (Remedy("text"),), matters)


def test_the_most_serious_comes_first_and_remarks_are_left_out() -> None:
    rows = [
        JudgedCondition(Kind.RING, None, (advice(Kind.RING),)),
        JudgedCondition(Kind.STRENGTH, 2, (advice(Kind.STRENGTH),)),
        JudgedCondition(Kind.UNDERCUT, 1, (advice(Kind.UNDERCUT, matters=False),)),
    ]
    verdict = together(Verdict((row,)) for row in rows)
    assert [fault.what for fault in faults_of(verdict)] == ["stage 2: strength", "ring"]


def test_a_remedy_that_helps_several_faults_is_told_once() -> None:
    faults = [Fault("a", ("wide", "hard")), Fault("b", ("wide", "large")), Fault("c", ("hard",))]
    assert [one.cures for one in told_once(faults)] == [("wide", "hard"), ("large",), ()]


@pytest.mark.slow
@at_once("name", [*QUICK, "baler-66-two-stage", "feeder-wishes"])
def test_every_warning_of_a_check_is_a_fault(name: str) -> None:
    made = drive(name)
    verdict = judged(made, KnownParts.MOTION)
    assert len(faults_of(verdict)) == len(verdict.warnings)


@at_once(
    ("own", "other", "words"),
    [
        (6315.1, 8689.4, "27.3 % lower"),
        (1.5, 1.0, "50.0 % higher"),
        (2.0, 1.0, "100.0 % higher"),
        (7.0, 2.0, "3.5 times"),
        (1.0004, 1.0, "the same"),
        (1.0, 0.0, ""),
        (0.0, 0.0, ""),
        (0.46, 3.6e-15, ""),
        (-3.0, -2.0, "50.0 % higher"),
        (-1.0, -2.0, "50.0 % lower"),
    ],
)
def test_words_for_a_difference(own: float, other: float, words: str) -> None:
    assert difference(own, other) == words


# --- the same figures everywhere


def in_terminal(text: str) -> dict[str, str]:
    """Names and figures of lines ``  name   figure``; of places only the figure."""
    found = {}
    for line in text.split("\n"):
        if match := re.fullmatch(r"  (\S.*?) {2,}(\S.*)", line):
            found.setdefault(match[1], re.split(r" {2,}| at phi1", match[2])[0])
    return found


def in_report(name: str) -> dict[str, str]:
    """Names and figures at the top of the page, with units as they are typed."""
    pairs = re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", reports.page(name))
    typed = (("\u00b2", "2"), ("\u00b3", "3"), ("\u00b0", " deg"))
    found = {}
    for label, text in pairs:
        for set_, plain in typed:
            text = text.replace(set_, plain)
        found[html.unescape(label)] = html.unescape(text)
    return found


def in_sheet(name: str) -> dict[str, str]:
    """Names and figures of the pair on the data sheet."""
    entries = [entry for group in data_sheet(drive(name)).groups for entry in group.entries if entry.of_pair]
    return {entry.label: f"{entry.texts[0]} {entry.unit}".rstrip() for entry in entries}


def in_answer(name: str) -> dict[str, str]:
    """Names and figures of the screen, with those that stand behind others in one row."""
    made = drive(name)
    rows = build_answer(made, judged(made, KnownParts.TEETH), "").rows
    found = {row.name: row.texts[0] for row in rows}
    for row in rows:
        first, *others = row.texts[0].split(", ")
        if others and row.name in {"teeth", *NAMES.values()}:
            found[row.name] = first
            for other in others:
                if behind := re.fullmatch(r"(\D+) (\d.*)", other):
                    found[behind[1]] = behind[2]
    return found


def everywhere(name: str) -> dict[str, dict[str, str]]:
    made = drive(name)
    summary = build_summary(made, reports.contacts(name)[0], judged(made, KnownParts.TEETH))
    return {
        "screen": in_answer(name),
        "verbose": in_terminal(figures_text(summary)),
        "report": in_report(name),
        "sheet": in_sheet(name),
    }


def differing(places: dict[str, dict[str, str]]) -> list[str]:
    """Names that two places have, and whose figures differ."""
    names = {name for place in places.values() for name in place}
    return [name for name in names if len({place[name] for place in places.values() if name in place}) > 1]


TOLD = {
    "screen": {
        "peak_power_w",
        "peak_acceleration_cycle_mm_s2",
        "center_distance_mm",
        "module_mm",
        "contact_ratio_mean",
    },
    "verbose": {"peak_power_w", "peak_acceleration_cycle_mm_s2", *SIZES[:2], "backlash_mm", "contact_ratio_mean"},
    "report": {"peak_power_w", "peak_acceleration_cycle_mm_s2", *SIZES[:3], "contact_ratio_mean"},
    "sheet": {*SIZES[:3], "backlash_mm", "contact_ratio_mean", "play_rad"},
}
"""What each place tells for certain."""


@pytest.mark.tiers(slow=["baler"], rest="long")
@pytest.mark.parametrize("name", ["pusher", "baler", "printed-pump"])
def test_the_same_name_has_the_same_figure_everywhere(name: str) -> None:
    places = everywhere(name)
    for place, keys in TOLD.items():
        assert {name_of(key) for key in keys} <= set(places[place]), place
    ours = set(NAMES.values()) | {name_of(key) for keys in TOLD.values() for key in keys}
    assert [one for one in differing(places) if one in ours] == []


def test_a_figure_that_differs_is_seen() -> None:
    """Negative control, of a digit and of a unit."""
    places = {"screen": {"a": "1.25 mm", "b": "3 W", "c": "1"}, "sheet": {"a": "1.250 mm", "b": "3 kW", "c": "1"}}
    assert sorted(differing(places)) == ["a", "b"]


def test_the_names_are_in_no_other_list() -> None:
    """What has a name of its own is told by ``numbers`` alone."""
    source = ROOT / "src" / "ncgear"
    files = [path for path in source.rglob("*.py") if path.name != "numbers.py"]
    own = {"centre distance", "greatest pressure angle", "peak acceleration, working stroke", "play of the driven gear"}
    held = {str(path): [name for name in own if f'"{name}"' in path.read_text(encoding="utf-8")] for path in files}
    assert {name: found for name, found in held.items() if found} == {}


@pytest.mark.parametrize("name", ["baler-66", "baler-66-two-stage"])
def test_the_head_says_whether_gears_stand_in_two_stages(name: str) -> None:
    assert ("in two stages" in head_of(drive(name))) is name.endswith("two-stage")


def test_groups_that_stand_below_one_another_are_a_table_unless_they_hold_one() -> None:
    """Of two rows that differ in what they hold, none of it is lost."""
    plain = {"teeth": 20, "module_mm": 2.0}
    table = _table([plain, {"teeth": 30, "module_mm": 3.0}])
    assert [line.split() for line in table[1:]] == [["20", "2"], ["30", "3"]]
    assert _table([plain]) == []
    holds = {"teeth": 20, "gears": [{"teeth": 1}, {"teeth": 2}]}
    assert _table([plain, holds]) == []
