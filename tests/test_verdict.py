"""The verdict: one list of conditions for every command, what is judged when, and what was not judged."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from at_once import at_once
from commands import Run, on_text
from drives import MACHINES, design_of, drive, drive_of_text
from ncgear.figures.advice.law_advice import NO_BORE
from ncgear.figures.advice.values import ONLY_TEETH, Advice, Kind
from ncgear.figures.advice.verdict import CONDITIONS, JudgedCondition, KnownParts, State, Verdict, judged, together
from ncgear.files.workshop.sheets.sheet import Text
from ncgear.files.workshop.sheets.sheets import pair_sheet
from ncgear.project.drive import Drive
from verdicts import verdict_on

pytestmark = pytest.mark.judges("figures")

DESIGNS = [*MACHINES]

PLAIN: dict[str, Any] = {
    "name": "plain",
    "linkage": {"crank_mm": 34, "rod_mm": 130},
    "operation": {"speed_rpm": 45},
    "motion": {"law": "harmonic_ratio", "cosine": [0.1], "sine": [0.12]},
    "gears": {
        "teeth": 28,
        "module_mm": 3,
        "face_width_mm": 16,
        "backlash_mm": 0.15,
        "driving_axis_deg": 180,
        "driving": {"bore_mm": 12},
        "driven": {"bore_mm": 14},
    },
    "resistance": {"polynomial_n": [60]},
}


def text_of(**changed: Any) -> str:
    data = {**PLAIN, **changed}
    return yaml.safe_dump({key: value for key, value in data.items() if value is not None})


def verdict_of(known: KnownParts, only: Kind | None = None, **changed: Any) -> Verdict:
    one = drive_of_text(text_of(**changed))
    return judged(one, known) if only is None else verdict_on(only, one, known)


def states(verdict: Verdict) -> dict[Kind, State]:
    return {row.kind: row.state for row in verdict.rows}


def found(verdict: Verdict, kind: Kind) -> list[str]:
    return [advice.line for advice in verdict.advices if advice.kind is kind]


# --- the list --------------------------------------------------------------------------------------------------------


def test_every_kind_of_advice_is_a_condition_in_the_same_order() -> None:
    assert list(CONDITIONS) == list(Kind)
    assert len({condition.name for condition in CONDITIONS.values()}) == len(CONDITIONS)


@pytest.mark.tiers(quick=["ellipse", "feeder-wishes"], long=["baler-*"], rest="slow")
@pytest.mark.parametrize("name", DESIGNS)
def test_no_warnings_is_said_only_where_all_was_judged(name: str) -> None:
    one = drive(name)
    for known in KnownParts if one.design.gears else [KnownParts.MOTION]:
        if name == "baler-a1-at-law-speed" and known is KnownParts.TEETH:
            continue
        verdict = judged(one, known)
        open_rows = [row for row in verdict.rows if row.state is State.NOT_JUDGED]
        assert (verdict.good == "No warnings.") is not bool(open_rows)
        assert bool(verdict.not_judged) is bool(open_rows)
        for row in open_rows:
            assert CONDITIONS[row.kind].name in verdict.not_judged
            assert row.why in verdict.not_judged
        assert len(verdict.table) == len(verdict.rows)
        assert [*map(len, (verdict.lines(matter=True), verdict.lines(matter=False)))] == [
            sum(advice.matters is matters for advice in verdict.advices) for matters in (True, False)
        ]


@pytest.mark.slow
def test_a_check_names_what_only_teeth_can_tell() -> None:
    before, after = verdict_of(KnownParts.MOTION), verdict_of(KnownParts.TEETH)
    only_teeth = {row.kind for row in before.rows if row.why == ONLY_TEETH}
    assert only_teeth >= {Kind.MADE, Kind.CONTACT_RATIO, Kind.UNDERCUT, Kind.POINTED, Kind.SHORTENED}
    assert all(states(after)[kind] is not State.NOT_JUDGED for kind in only_teeth)
    assert set(states(before)) == set(states(after))


def test_without_gears_nothing_is_said_of_them() -> None:
    kinds = set(states(verdict_of(KnownParts.MOTION, gears=None)))
    assert kinds == {Kind.TRANSMISSION_ANGLE, Kind.NEGATIVE_RESISTANCE, Kind.WITHOUT_EFFECT, Kind.RATIO_RANGE}


def test_a_condition_is_broken_whatever_else_was_not_judged() -> None:
    wrong = found_advice(Kind.ROD)
    assert JudgedCondition(Kind.ROD, None, (wrong,), "of something").state is State.BROKEN
    assert JudgedCondition(Kind.ROD, None, (), "of something").state is State.NOT_JUDGED
    assert JudgedCondition(Kind.ROD, None, ()).state is State.KEPT


def found_advice(kind: Kind) -> Advice:
    return Advice(kind, "it is wrong", "it breaks")


def test_pairs_say_once_what_is_of_the_whole_machine() -> None:
    whole = JudgedCondition(Kind.MISSED_WISH, None, (found_advice(Kind.MISSED_WISH),))
    pairs = [Verdict((JudgedCondition(Kind.UNDERCUT, stage, (), ONLY_TEETH), whole)) for stage in (1, 2)]
    verdict = together(pairs)
    assert [(row.kind, row.stage) for row in verdict.rows] == [
        (Kind.MISSED_WISH, None),
        (Kind.UNDERCUT, 1),
        (Kind.UNDERCUT, 2),
    ]
    # What is so of both pairs is named once, else with its stage
    assert verdict.not_judged == f"Not judged: undercut ({ONLY_TEETH})"
    one = together([pairs[0], Verdict((JudgedCondition(Kind.UNDERCUT, 2, ()), whole))])
    assert one.not_judged == f"Not judged: stage 1: undercut ({ONLY_TEETH})"


# --- the commands ----------------------------------------------------------------------------------------------------


COMMANDS = {
    "check": ("check",),
    "build": ("build", "--format", "svg"),
    "strength": ("strength",),
    "rigid": ("simulate",),
    "quasi-static": ("simulate", "--level", "quasi_static"),
}
MASSES = {
    "slider_kg": 2,
    "rod": {"mass_kg": 0.4, "center_mm": 50, "inertia_kg_mm2": 800},
    "crank": {"mass_kg": 0.3, "center_mm": 8, "inertia_kg_mm2": 300},
}


@pytest.mark.tiers(slow=["check", "build"], rest="long")
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_ends_in_the_same_verdict(run: Run, command: str) -> None:
    """What a command prints and what its JSON has are the rows of one list."""
    name, *more = COMMANDS[command]
    text = text_of(masses=MASSES)
    known = KnownParts.MOTION if command in ("check", "rigid") else KnownParts.TEETH
    verdict = judged(drive_of_text(text), known)
    status, out, err = on_text(run, name)(text, *more)
    assert status == 0, err
    said = re.sub(r"\s+", " ", out)
    assert (verdict.not_judged or verdict.good) in said
    status, out, err = on_text(run, name)(text, *more, "--json")
    assert status == 0, err
    assert json.loads(out)["verdict"] == verdict.table
    status, out, err = on_text(run, name)(text, *more, "--verbose")
    assert status == 0, err
    for row in verdict.table:
        assert f"  {row['verdict']:10}  {row['says']}" in out


@pytest.mark.slow
def test_the_report_has_the_verdict(run: Run) -> None:
    text = text_of()
    assert on_text(run, "report")(text)[0] == 0
    page = Path("export/plain/report.html").read_text(encoding="utf-8")
    for row in judged(drive_of_text(text), KnownParts.TEETH).table:
        assert f"<li>{row['verdict']}: {row['says']}" in page


# --- gears that a build refuses --------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["motion1-*"], rest="quick")
@pytest.mark.parametrize(
    ("motion", "said"),
    [
        ({"law": "ratio_expression", "ratio": "1 + 0.2*max(0, cos(phi))", "scale_to_close": True}, "have a corner of"),
        ({"law": "harmonic_ratio", "cosine": [0.2, 0.2], "sine": [1.6, 1.0]}, "pressure angle reaches"),
    ],
)
def test_a_check_says_what_a_build_refuses(run: Run, motion: dict[str, Any], said: str) -> None:
    verdict = verdict_of(KnownParts.MOTION, motion=motion, resistance=None)
    assert states(verdict)[Kind.MADE] is State.BROKEN
    (line,) = found(verdict, Kind.MADE)
    assert line.startswith("a build refuses these gears")
    assert said in line
    status, _, err = on_text(run, "build")(text_of(motion=motion, resistance=None), "--format", "svg")
    assert status == 3
    assert said in err
    # Negative control: a smooth law that is built
    assert states(verdict_of(KnownParts.MOTION, Kind.MADE))[Kind.MADE] is State.NOT_JUDGED


# --- what stands in the plane of the rods ----------------------------------------------------------------------------


def test_a_rod_that_runs_through_the_shaft_is_told_without_any_fit() -> None:
    beside = {**PLAIN["gears"], "driving_axis_deg": 0}
    (advice,) = verdict_of(KnownParts.MOTION, Kind.ROD, gears=beside).advices
    assert "the rod meets the driving shaft" in advice.what
    assert {change.key: change.value for remedy in advice.remedies for change in remedy.changes} == {
        "fit.driving_shaft": "ends"
    }
    ends = verdict_of(KnownParts.MOTION, Kind.ROD, gears=beside, fit={"driving_shaft": "ends"})
    assert states(ends)[Kind.ROD] is State.KEPT
    # Negative control: on the other side nothing meets
    assert states(verdict_of(KnownParts.MOTION, Kind.ROD))[Kind.ROD] is State.KEPT
    # A shaft of unknown size is not judged
    unknown = verdict_of(KnownParts.MOTION, Kind.ROD, gears={**beside, "driving": {}})
    assert states(unknown)[Kind.ROD] is State.NOT_JUDGED
    assert NO_BORE.why in unknown.not_judged


@pytest.mark.slow
def test_the_sheet_of_the_assembly_says_where_the_shaft_ends() -> None:
    """Whether the file says so or not: the workshop needs it either way."""
    note = "The driving shaft must end below the rod."

    def texts(axis_deg: float, **fit: str) -> list[str]:
        gears = {**PLAIN["gears"], "driving_axis_deg": axis_deg}
        sheet = pair_sheet(drive_of_text(text_of(gears=gears, fit=fit or None)))
        return [item.words for item in sheet.items if isinstance(item, Text)]

    assert note in texts(0.0)
    assert note in texts(0.0, driving_shaft="ends")
    assert note not in texts(180.0)


# --- what changes nothing --------------------------------------------------------------------------------------------


STROKE_MM = 2.0 * PLAIN["linkage"]["crank_mm"]

SILENT: dict[str, dict[str, Any]] = {
    "formula": {"resistance": {"expression_n": "20*max(0, x - 90)"}},
    "table": {"resistance": {"table": {"displacement_mm": [0, 70, 90, 120], "force_n": [0, 0, 0, 500]}}},
    "returning": {"resistance": {"polynomial_n": [60], "returning": {"expression_n": "max(0, 5*x - 400)"}}},
    "zero": {"resistance": {"polynomial_n": [0, 0]}},
    "negative": {"resistance": {"expression_n": "-3 - x"}},
    "fast enough": {"wishes": {"speed_at": [{"at_mm": 30, "at_most_mm_s": 1e6}]}},
    "slow enough": {"wishes": {"speed_at": [{"at_mm": 30, "at_least_mm_s": 0.5}]}},
    "any time": {"wishes": {"working_stroke": {"angle_deg": 180, "tolerance_deg": 179}}},
    "no friction": {"resistance": {"friction_n": 0}},
    "any place": {"wishes": {"positions": [{"at_mm": 30, "phi1_deg": 80, "tolerance_mm": 110}]}},
    "so soon": {"wishes": {"positions": [{"at_mm": 2, "phi1_deg": 0.5, "tolerance_mm": 10}]}},
    "so late": {"wishes": {"positions": [{"at_mm": 1, "phi1_deg": 359.5, "tolerance_mm": 10, "stroke": "return"}]}},
    "no gears": {"gears": None, "tolerances": {"grade": 8}},
    "strength of nothing": {"resistance": None, "strength": {"life_h": 1000, "lubrication": "dry"}},
    "simulation of nothing": {"resistance": None, "simulation": {"turns": 3}},
}
ACTING: dict[str, dict[str, Any]] = {
    "formula": {"resistance": {"expression_n": "20*max(0, x - 60)"}},
    "table": {"resistance": {"table": {"displacement_mm": [0, 50, 90, 120], "force_n": [0, 0, 1, 500]}}},
    "returning": {"resistance": {"polynomial_n": [60], "returning": {"expression_n": "max(0, 5*x - 300)"}}},
    "friction": {"resistance": {"friction_n": 20}},
    "kept": {"resistance": {"expression_n": "-3 - x", "where_negative": "keep"}},
    "loaded": {"resistance": {"friction_n": 20}, "strength": {"life_h": 7}},
    "usual strength": {"resistance": None, "strength": {"reliability": 0.99}},
    "place": {"wishes": {"positions": [{"at_mm": 30, "phi1_deg": 80, "tolerance_mm": 20}]}},
    "place on the way out": {"wishes": {"positions": [{"at_mm": 30, "phi1_deg": 80, "tolerance_mm": 40}]}},
    "soon": {"wishes": {"positions": [{"at_mm": 2, "phi1_deg": 5, "tolerance_mm": 10}]}},
    "speed": {"wishes": {"speed_at": [{"at_mm": 30, "at_most_mm_s": 300}]}},
    "time": {"wishes": {"working_stroke": {"angle_deg": 180, "tolerance_deg": 60}}},
    "end": {"resistance": {"table": {"displacement_mm": [0, 30, 70, 90], "force_n": [9, 0, 0, 500]}}},
}


@pytest.mark.parametrize("name", SILENT)
def test_what_is_given_and_changes_nothing_is_told(name: str) -> None:
    verdict = verdict_of(KnownParts.MOTION, Kind.WITHOUT_EFFECT, **SILENT[name])
    assert states(verdict)[Kind.WITHOUT_EFFECT] is State.BROKEN


@pytest.mark.slow
@pytest.mark.parametrize("name", ACTING)
def test_what_changes_something_is_not(name: str) -> None:
    """Negative control."""
    verdict = verdict_of(KnownParts.MOTION, Kind.WITHOUT_EFFECT, **ACTING[name])
    assert states(verdict).get(Kind.WITHOUT_EFFECT, State.KEPT) is State.KEPT


def test_a_wide_position_is_missed_by_a_law_that_is_back_before() -> None:
    """68 mm of stroke and 30 mm give or take 40: no place of the way out is beyond, but the way back is."""
    motion = {"law": "harmonic_ratio", "cosine": [-0.69], "sine": [-0.69]}
    early = {"at_mm": 30, "phi1_deg": 150, "tolerance_mm": 40}
    (found,) = Drive(design_of({**PLAIN, "motion": motion, "gears": None, "wishes": {"positions": [early]}})).outcomes
    assert found.missed_by == pytest.approx(1.46, abs=0.01)


def test_a_silent_force_beside_friction_is_told_by_its_own_key() -> None:
    silent = {"friction_n": 20, "expression_n": "20*max(0, x - 90)", "returning": {"polynomial_n": [0]}}
    told = found(verdict_of(KnownParts.MOTION, Kind.WITHOUT_EFFECT, resistance=silent), Kind.WITHOUT_EFFECT)
    assert len(told) == 1
    assert told[0].startswith("resistance.expression_n and resistance.returning.polynomial_n never act: ")


def test_a_silent_force_leaves_the_power_as_it_is_without_it() -> None:
    """The judge of the judge: figures of the machine with and without what is told to change nothing."""
    for name, acts in (*((one, False) for one in ("formula", "table", "negative")), ("acting", True)):
        changed = ACTING["formula"] if acts else SILENT[name]
        power = drive_of_text(text_of(**changed)).check.peak_power_w.value
        assert (power > 0.0) is acts


@at_once(
    ("places", "idle"),
    [
        ([90, 130], "all 2"),
        ([-40, -20, -10], "all 3"),
        ([75, 85, 95, 105], "all 4"),
        ([-40, -20, 80], ""),
        ([-9, 80], ""),
        ([0, 34, 68], ""),
    ],
)
def test_a_table_beside_the_stroke_is_a_constant_force(places: list[float], idle: str) -> None:
    forces = [12.0, 48.0, 20.0, 31.0][: len(places)]
    table = {"displacement_mm": places, "force_n": forces}
    verdict = verdict_of(KnownParts.MOTION, Kind.WITHOUT_EFFECT, resistance={"table": table}, gears=None)
    told = found(verdict, Kind.WITHOUT_EFFECT)
    if not idle:
        assert told == []
        return
    assert f"{idle} points of resistance.table lie beyond" in told[0]
    assert states(verdict)[Kind.WITHOUT_EFFECT] is State.BROKEN


def test_points_beyond_the_stroke_are_a_remark() -> None:
    """The curve within the stroke is the same without them, and another without one more of them."""
    places, forces = (
        [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0],
        [10.0, 30.0, 35.0, 80.0, 90.0, 300.0, 310.0, 9.0],
    )
    verdict = verdict_of(
        KnownParts.MOTION, resistance={"table": {"displacement_mm": places, "force_n": forces}}, gears=None
    )
    (remark,) = (advice for advice in verdict.advices if not advice.matters)
    assert f"2 of 8 points of resistance.table lie beyond the stroke of {STROKE_MM:g} mm" in remark.what
    assert not verdict.warnings

    def work(count: int) -> float:
        table = {"displacement_mm": places[:count], "force_n": forces[:count]}
        return drive_of_text(text_of(resistance={"table": table}, gears=None)).check.mean_power_w

    assert work(6) == pytest.approx(work(8), rel=1e-14)
    assert work(5) != pytest.approx(work(8), rel=1e-9)


@pytest.mark.slow
def test_teeth_without_any_force_are_not_said_to_hold() -> None:
    for known in KnownParts:
        rows = states(verdict_of(known, resistance={"friction_n": 0}))
        assert rows[Kind.STRENGTH] is State.NOT_JUDGED
        assert rows[Kind.WITHOUT_EFFECT] is State.BROKEN


@pytest.mark.slow
def test_an_exact_pair_that_is_wanted_is_not_said_to_turn() -> None:
    exact = verdict_of(KnownParts.TEETH, gears={**PLAIN["gears"], "backlash_mm": 0})
    assert states(exact)[Kind.JAMS] is State.NOT_JUDGED
    assert "assemblies of the exact pair jam" in exact.not_judged
    # Left out, it is not wanted
    unsaid = {key: value for key, value in PLAIN["gears"].items() if key != "backlash_mm"}
    assert states(verdict_of(KnownParts.TEETH, gears=unsaid))[Kind.JAMS] is State.BROKEN
    assert states(verdict_of(KnownParts.TEETH))[Kind.JAMS] is State.KEPT


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("lightening_holes: {count: 6, least_wall_mm: 0.2}", "of the driven gear is thinner than ISO 6336-3 has"),
        ("web: {thickness_mm: 2, rim_mm: 9, hub_mm: 20}", "the web of the driven gear, of 2 mm under 12 mm"),
        ("web: {thickness_mm: 4, rim_mm: 9, hub_mm: 20}", ""),
    ],
)
def test_teeth_on_a_thin_wall_are_not_said_to_hold(body: str, said: str) -> None:
    text = (Path(__file__).parents[1] / "designs" / "pusher.yaml").read_text(encoding="utf-8")
    text = text.replace("  driven: {bore_mm: 10", f"  driven: {{{body}, bore_mm: 10")
    row = next(one for one in judged(drive_of_text(text), KnownParts.TEETH).rows if one.kind is Kind.STRENGTH)
    assert (row.state, said in row.why) == (State.NOT_JUDGED if said else State.KEPT, True)


TIGHT = """\
name: played
motion: {{law: ratio_expression, ratio: "1 + 0.45*cos(phi)", scale_to_close: true}}
operation: {{speed_rpm: 60}}
gears: {{teeth: {teeth}, module_mm: 2, face_width_mm: 12, backlash_mm: {backlash}}}
"""


@pytest.mark.parametrize(("teeth", "offered"), [(18, True), (17, False)])
def test_tips_shortened_by_backlash_are_cured_by_less_and_by_nothing_that_does_not_help(
    monkeypatch: pytest.MonkeyPatch, teeth: int, offered: bool
) -> None:
    """A tenth more backlash than is offered does not cure them; smaller teeth of the same backlash never do."""
    monkeypatch.setattr("ncgear.figures.advice.verdict.CONDITIONS", {Kind.SHORTENED: CONDITIONS[Kind.SHORTENED]})

    def matters(**changes: Any) -> list[Advice]:
        text = TIGHT.format(**{"teeth": teeth, "backlash": 0.8, **changes})
        return judged(drive_of_text(text), KnownParts.TEETH).warnings

    (advice,) = matters()
    assert [[change.key for change in one.changes] for one in advice.remedies] == [["gears.backlash_mm"]] * offered
    if offered:
        ((change,),) = (one.changes for one in advice.remedies)
        assert not matters(backlash=change.value)
        assert matters(backlash=float(str(change.value)) + 0.08)
