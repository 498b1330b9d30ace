"""What is told of teeth that knock where the load changes flanks, beside the motion in time."""

from __future__ import annotations

import json

import numpy as np
import pytest

from commands import ROOT, Run, on_text
from drives import drive_of_text
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.strength_advice import rough, strength
from ncgear.figures.advice.values import Advice, NotJudged
from ncgear.project.drive import Drive
from test_stage_loads import DRIVEN, SHARED, SLIDER

TEXT = """\
name: shaken
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 120}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 10, backlash_mm: PLAY, material: 42CrMo4}
masses:
  slider_kg: 4
  rod: {mass_kg: 0.2, center_mm: 60, inertia_kg_mm2: 400}
  crank: {mass_kg: 0.5, center_mm: 0, inertia_kg_mm2: 400}
"""


def shaken(play_mm: float, more: str = "") -> Drive:
    """Round gears that drive a heavy slider, whose torque turns round four times in a turn."""
    return drive_of_text(TEXT.replace("PLAY", f"{play_mm:g}") + more)


def peak_n(drive: Drive) -> float:
    """The largest force of a pair of teeth."""
    return float(drive.strength.contacts.force_n.max())


def test_teeth_knock_harder_with_more_play_and_not_at_all_without() -> None:
    """Over a small play the flight ends at x = s t^3 / (6 J) and s t^2 / (2 J), so as the play to 2/3."""
    exact, near, far = (shaken(play) for play in (0.0, 0.05, 0.1))
    speeds = [
        max((one.speed_mm_s for one in of.loading_by("estimate").knocks or ()), default=0.0)
        for of in (exact, near, far)
    ]
    assert speeds[0] == pytest.approx(0.0, abs=0.02 * speeds[1])
    assert speeds[2] / speeds[1] == pytest.approx(2.0 ** (2.0 / 3.0), rel=0.25)
    assert 3.0 * peak_n(exact) < peak_n(near) < peak_n(far)


def test_a_machine_without_masses_is_not_judged_for_knocks() -> None:
    text = TEXT.partition("masses")[0].replace("PLAY", "0.1") + "resistance: {polynomial_n: [100]}"
    assert drive_of_text(text).loading_by("estimate").knocks is None


def test_a_check_and_a_build_tell_of_teeth_that_only_knocks_break() -> None:
    holds, broken = (shaken(play, "strength: {bending_safety: 6}\n") for play in (0.0, 0.3))
    for judge in (rough, strength):
        assert judge(holds) is None
        assert isinstance(judge(broken), Advice)


def test_knocks_are_told_by_every_form(run: Run) -> None:
    holding = "strength: {contact_safety: 0.1}\n"
    _, told, _ = on_text(run, "strength")(TEXT.replace("PLAY", "0.1") + holding)
    assert "in a turn of the driven gear, at up to" in " ".join(told.split())
    figures = json.loads(on_text(run, "strength", "--json")(TEXT.replace("PLAY", "0.1") + holding)[1])
    assert figures["load"]["knocks"] > 4
    assert 0.0 <= figures["load"]["knock_max_at_rad"] < 2.0 * np.pi
    still = json.loads(on_text(run, "strength", "--json")(TEXT.replace("PLAY", "0") + holding)[1])
    assert still["load"].get("knock_max_mm_s", 0.0) < 0.02 * figures["load"]["knock_max_mm_s"]


def test_two_pairs_in_series_and_what_stands_around_are_not_judged_for_knocks() -> None:
    turning = drive_of_text(SHARED + SLIDER + DRIVEN + "strength: {bending_safety: 0.01, contact_safety: 0.01}\n")
    found = strength(turning.by_stage[1])
    assert isinstance(found, NotJudged)
    assert "knock" in found.why
    shafts = "drivetrain: {driving_shaft: {bearing_a: {at_mm: -40}, bearing_b: {at_mm: 40}}}\n"
    assert any(isinstance(one, NotJudged) and "knocks" in one.why for one in around(shaken(0.1, shafts)))
    assert not any(isinstance(one, NotJudged) for one in around(shaken(0.0, shafts)))


@pytest.mark.slow
@pytest.mark.parametrize("play_mm", [0.07, 0.15])
def test_the_motion_in_time_presses_teeth_as_hard(play_mm: float) -> None:
    text = (ROOT / "designs" / "baler-holds.yaml").read_text(encoding="utf-8")
    one = drive_of_text(text.replace("backlash_mm: 0.07", f"backlash_mm: {play_mm}"))
    states = one.course.at(one.course.fine_s)
    in_time = float(one.course.machine.answer(states).teeth.normal_n.max())
    assert 0.95 * in_time < peak_n(one) < 1.15 * in_time
