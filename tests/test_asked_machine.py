"""A file for ``ncgear design`` from ten answers: what each changes, the likely answers, and wrong answers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi
from pathlib import Path
from typing import Any

import pytest

from at_once import at_once
from commands import Run
from ncgear.cli import new
from ncgear.design.beginning import QUESTIONS, asked_text, fault_of_answer, likely_answers
from ncgear.design.template import MachineName, machine_template
from ncgear.project.drive import Drive
from ncgear.project.opened import load, loads
from test_new_command import at_terminal


@pytest.mark.tiers(thorough=["pump"], rest="slow")
@pytest.mark.parametrize("machine", MachineName)
def test_likely_answers_are_the_machine_of_that_kind(machine: MachineName) -> None:
    """The flywheel by the exact work or a disc by hand; the file asks for the same machine."""
    text = machine_template("mine", machine)
    likely, own = likely_answers(text), Drive(loads(text).design)
    work_j = own.check.mean_power_w * 60.0 / own.design.operation.speed_rpm
    stores = 2.0 * work_j / own.machine.speed_rad_s**2
    # A disc of 1.8 strokes, a twentieth as thick: m r^2/2
    wide_m = 1.8e-3 * own.linkage.stroke_mm
    disc = 7850.0 * pi / 4.0 * wide_m**2 * (wide_m / 20.0) * wide_m**2 / 8.0
    assert float(likely["flywheel"]) == pytest.approx(min(stores, disc), rel=0.06)
    made = loads(asked_text("mine", machine, {}, likely)).design
    assert made.resistance == own.design.resistance
    assert made.masses == own.design.masses
    assert made.wishes == own.design.wishes
    assert made.optimize is not None
    assert made.optimize.goal == "least_power"
    assert made.optimize.limits.peak_power_w is None
    assert made.choices is not None
    assert made.choices.processes == (("printed",) if machine is MachineName.DESK_TOY else ("hobbed",))
    assert all(fault_of_answer(one, text, likely[one]) is None for one in QUESTIONS)


@at_once(("rpm", "table"), [(600.0, False), (600.0, True), (20.0, False)])
def test_the_likely_flywheel_stores_the_work_of_a_turn_or_is_a_disc(rpm: float, table: bool) -> None:
    """100 N out and 20 N of friction both ways over 100 mm: 14 J, or 12 J where the force rises from half of it on."""
    force = "table: {displacement_mm: [0, 50, 100], force_n: [0, 100, 100]}" if table else "polynomial_n: [100]"
    text = (
        f"linkage: {{crank_mm: 50}}\noperation: {{speed_rpm: {rpm}}}\nresistance: {{{force}, friction_n: 20}}\n"
        "masses: {slider_kg: 2}\ngears: {material: 42CrMo4}\n"
    )
    work_j = 4.0 + (7.5 if table else 10.0)
    stores = 2.0 * work_j / (rpm * pi / 30.0) ** 2
    disc = 7850.0 * pi / 4.0 * 0.18**2 * (0.18 / 20.0) * 0.18**2 / 8.0
    likely = likely_answers(text)
    assert float(likely["flywheel"]) == pytest.approx(min(stores, disc), rel=0.02)
    assert (likely["force"], likely["mass"]) == ("120 x 1", "2")


def test_each_answer_changes_its_keys() -> None:
    text = machine_template("mine", MachineName.PUMP)
    answers = {
        "force": "830 x 1.75",
        "mass": "1.6",
        "materials": "42CrMo4, 18CrNiMo7-6",
        "processes": "wire_cut, hobbed",
        "space": "140",
        "flywheel": "0.002",
    }
    # Delivery at 400 N and 15 N of friction; valves that knock
    assert likely_answers(text)["force"] == "415 x 1.25"
    assert asked_text("mine", MachineName.PUMP, {}, {"force": "415"}) == asked_text("mine", MachineName.PUMP, {}, {})
    made = loads(asked_text("mine", MachineName.PUMP, {"stroke_mm": 60, "speed_rpm": 120}, answers)).design
    assert made.resistance is not None
    assert made.resistance.table.force_n == (0.0, 800.0, 800.0)
    assert made.resistance.returning.table.force_n == (120.0, 120.0, 0.0)
    assert made.resistance.friction_n == 30.0
    assert made.strength.application_factor == 1.75
    assert made.masses.slider_kg == 1.6
    assert [one.material.name for one in made.choices.materials] == ["42CrMo4", "18CrNiMo7-6"]
    assert made.choices.processes == ("wire_cut", "hobbed")
    assert made.choices.center_distance_mm == 140.0
    assert made.free_flywheel.most == 2000.0
    none = loads(asked_text("mine", MachineName.PUMP, {}, {"flywheel": "none", "space": "any"})).design
    assert (none.free_flywheel, none.choices.center_distance_mm) == (None, None)


@at_once(
    ("question", "answer", "said"),
    [
        ("force", "much", "much given; a number over 0 is right"),
        ("force", "415 x 0.5", "0.5 given; a number of 1 or over is needed"),
        ("force", "600 x hard", "hard given; a number over 0 is right"),
        ("force", "600 x", "600 x given; a force and a factor as 415 x 1.25 are right, or a force"),
        ("force", "600x1.5x2", "600x1.5x2 given; a force and a factor as 415 x 1.25 are right"),
        ("mass", "-2", "-2 given; a number over 0 is right"),
        ("materials", "butter", "butter"),
        ("processes", "milled", "milled"),
        ("processes", "hobbed, hobbed", "the same is given twice"),
        ("space", "0", "0 given; a number over 0 is right"),
        ("flywheel", "heavy", "heavy given"),
    ],
)
def test_wrong_answers(question: str, answer: str, said: str) -> None:
    assert said in (fault_of_answer(question, machine_template("mine", MachineName.PUMP), answer) or "")


@pytest.mark.slow
def test_ten_questions_at_a_terminal(tmp_path: Path) -> None:
    answers = ["mine", "pump", "80", "", "none", "600 x 1.5", "", "butter", "", "", "150", "none"]
    status, shown = at_terminal(["new", "--design"], [f"{answer}\n" for answer in answers], tmp_path)
    assert (status, shown.splitlines()[-1]) == (0, "mine.yaml")
    asked = [line for line in shown.splitlines() if "]: " in line]
    # The name, ten questions, and a question again for butter
    assert len(asked) == 12
    assert asked[-1].startswith("largest flywheel on the driven shaft in kg m2, or none [0.0024]")
    made = load(tmp_path / "mine.yaml").design
    assert made.linkage.crank_mm == 40.0
    assert made.strength.application_factor == 1.5
    assert made.resistance.table.force_n[1] == pytest.approx(400.0 * 600.0 / 415.0, rel=1e-4)
    assert made.choices.center_distance_mm == 150.0


@pytest.mark.slow
def test_options_with_design(run: Run) -> None:
    assert run("new", "a", "--design", "--machine", "baler", "--speed-rpm", "30") == (0, "a.yaml\n", "")
    made = load(Path("a.yaml")).design
    assert made.operation.speed_rpm == 30.0
    assert made.free_flywheel is not None
    status, _, err = run("new", "b", "--design", "--teeth", "30")
    assert (status, err) == (2, "--teeth: given with --design, which finds it; leave it out\n")
    assert run("new", "b", "--design", "--shape", "heart")[0] == 2


# --- questions of ``ncgear new`` --------------------------------------------------------------------------------------


@pytest.fixture
def answered(monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[Any, int]]:
    """What a question makes of answers, and how many of them it did not take."""

    def of(ask: Callable[..., Any], answers: Sequence[str], *given: Any) -> tuple[Any, int]:
        left, told = [*answers], list[str]()
        monkeypatch.setattr(new.typer, "prompt", lambda *_, **likely: left.pop(0) or likely["default"])
        monkeypatch.setattr(new.typer, "echo", lambda text, **_: told.append(text))
        found = ask(*given)
        assert not left
        return found, sum(not text[2:].lstrip()[:1].isdigit() for text in told)

    return of


@pytest.mark.judges("cli")
def test_wishes_are_asked_for_until_there_are_none(answered: Callable[..., tuple[Any, int]]) -> None:
    """A wrong one is asked for again; what is likely is that there are no more."""
    one, other = "time_ratio: {at_least: 1.5}", "dwell: {at: extended, for_deg: 20, within_mm: 1}"
    assert answered(new._asked_wishes, ["none"]) == ([], 0)
    assert answered(new._asked_wishes, [""]) == ([], 0)
    assert answered(new._asked_wishes, [one, ""]) == ([one], 0)
    assert answered(new._asked_wishes, ["nothing: 1", one, "time_ratio: 3: 4", other, "none"]) == ([one, other], 2)


@pytest.mark.judges("cli")
def test_names_and_choices_are_asked_for_again_where_they_are_wrong(answered: Callable[..., tuple[Any, int]]) -> None:
    machines = [*MachineName]
    assert answered(new._asked_name, ["my press/2", "press-2"]) == ("press-2", 1)
    assert answered(new._asked_machine, [""]) == (machines[0], 0)
    assert answered(new._asked_machine, ["0", f"{len(machines) + 1}", f"{len(machines)}"])[0] is machines[-1]
    assert answered(new._asked_machine, ["nothing", machines[1].value])[0] is machines[1]
