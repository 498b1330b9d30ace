"""The text that the studio edits, its form, its handles and its answers, without a server."""

from __future__ import annotations

import asyncio
import json
import queue
import signal
import sys
import threading
import time
import weakref
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from at_once import at_once
from drives import DESIGNS, MACHINES, drive, loaded
from ncgear.design.keys.base import FULL_TURN
from ncgear.design.laws.registry import LawName
from ncgear.design.mechanisms import MECHANISMS, entry_of
from ncgear.design.reading.design_file import parsed
from ncgear.design.reading.places import with_value
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.reference import keys_of
from ncgear.drawings.charts.chart import Quantity
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.interrupts import quiet_of_interrupts
from ncgear.project.drive import Drive
from ncgear.studio import editing, open_page, worker
from ncgear.studio.chains import Chains
from ncgear.studio.editing import ChangingText, TextHistory, difference, edited, lacking
from ncgear.studio.form import form
from ncgear.studio.gear_answers import contact_answers, gear_answers
from ncgear.studio.handles import handles
from ncgear.studio.jobs import Job
from ncgear.studio.messages import Answer, Answers, guarded
from ncgear.studio.motion_answers import motion_answers
from ncgear.studio.worker import GEARS, MOTION, PICTURES, answers_of

NAMES = [*MACHINES]
SOME = ["baler", "ellipse", "feeder-wishes", "scotch-yoke-pump"]


def driven(followed: ChangingText, text: str, changes: Mapping[str, Any], path: Path) -> Drive:
    made = followed.made(text, changes, path)
    assert isinstance(made, Drive)
    return made


def text_of(name: str) -> str:
    return (DESIGNS / f"{name}.yaml").read_text(encoding="utf-8")


def data_of(text: str) -> Any:
    return read_yaml(text, "d.yaml").data


# --- the text


@pytest.mark.judges("studio")
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.tiers(quick=SOME, rest="slow")
def test_a_changed_key_changes_its_own_line_alone(name: str) -> None:
    text = text_of(name)
    after = edited(text, {"operation.speed_rpm": 33.25})
    lines = [line for line in difference(text, after, "d").splitlines()[2:] if line[0] in "+-"]
    assert [line[0] for line in lines] == ["-", "+"]
    assert data_of(after) == with_value(data_of(text), "operation.speed_rpm", 33.25)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.tiers(quick=SOME, rest="slow")
def test_a_change_and_its_opposite_leave_the_text_as_it_was(name: str) -> None:
    text = text_of(name)
    speed = data_of(text)["operation"]["speed_rpm"]
    assert edited(edited(text, {"operation.speed_rpm": 33.25}), {"operation.speed_rpm": speed}) == text


def test_items_of_lists_are_changed_where_they_stand() -> None:
    text = "a: [1, 2, 3] # points\nb:\n    - {c: 1, d: 2}   # first\n    - {c: 3, d: 4}\n"
    assert edited(text, {"a.1": 7.5}) == text.replace("2, 3", "7.5, 3")
    assert data_of(edited(text, {"b.1.c": 5})) == {"a": [1, 2, 3], "b": [{"c": 1, "d": 2}, {"c": 5, "d": 4}]}
    assert data_of(edited(text, {"b.0": None})) == {"a": [1, 2, 3], "b": [{"c": 3, "d": 4}]}


@at_once("key", ["a.9.b", "a.x", "name.first", "b.0.c.d"])
def test_a_place_that_is_not_there_is_refused(key: str) -> None:
    with pytest.raises(WrongInput, match="no place"):
        edited("name: one\na: [1, 2]\nb: [{c: 1}]\n", {key: 1})


def test_text_that_is_no_yaml_is_refused() -> None:
    with pytest.raises(WrongInput):
        edited("name: [1, 2\n", {"name": "x"})


@pytest.mark.parametrize(
    ("typed", "written"), [(1.23456789012, "1.23456789012"), (60.00000001, "60.00000001"), (60.0, "60")]
)
def test_numbers_keep_the_digits_that_were_typed(typed: float, written: str) -> None:
    assert f"speed_rpm: {written}}}" in edited("operation: {speed_rpm: 20}\n", {"operation.speed_rpm": typed})


def test_lists_without_end_and_places_before_the_first_are_refused() -> None:
    deep: list[Any] = []
    for _ in range(5000):
        deep = [deep]
    for changes in ({"gears": deep}, {".".join("a" * 5000): 1}, {"motion.ratio.-1": 1.0}):
        with pytest.raises(WrongInput, match="no place"):
            edited("motion: {ratio: [1, 2]}\n", changes)


TEXTS = st.lists(st.one_of(st.sampled_from(["undo", "redo"]), st.text("ab", max_size=3)), max_size=30)


@pytest.mark.slow
@given(TEXTS)
@settings(max_examples=60, deadline=None)
def test_history_goes_back_and_forth_as_a_list_with_a_place(steps: list[str]) -> None:
    history, texts, place = TextHistory("start"), ["start"], 0
    for step in steps:
        if step == "undo":
            history, place = history.undone(), max(place - 1, 0)
        elif step == "redo":
            history, place = history.redone(), min(place + 1, len(texts) - 1)
        elif step != texts[place]:
            history, texts, place = history.kept(step), [*texts[: place + 1], step], place + 1
        assert history.now == texts[place]
        assert (len(history.past), len(history.future)) == (place, len(texts) - 1 - place)


def test_history_has_a_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(editing, "MOST_CHARACTERS", 10)
    history = TextHistory("aaaa").kept("bbbb").kept("cccc").kept("dddd")
    assert (history.past, history.now) == (("bbbb", "cccc"), "dddd")
    assert history.undone().undone().future == ("cccc", "dddd")
    assert TextHistory("a" * 11).kept("b").past == ()


# --- another law, another mechanism


@pytest.mark.slow
@pytest.mark.parametrize("law", list(LawName))
def test_every_law_can_be_chosen(law: LawName) -> None:
    """What follows may be refused by the machine, as a law over a range is by a slider, but the law is chosen."""
    text = edited(text_of("baler"), {"motion.law": law.value})
    assert data_of(text)["motion"]["law"] == law
    assert "# The baler of J. Wang" in text


@pytest.mark.slow
@at_once("kind", list(MECHANISMS))
def test_every_mechanism_can_be_chosen(kind: str) -> None:
    text = edited(text_of("scotch-yoke-pump"), {"linkage.kind": kind})
    law = {"law": "ellipse", "eccentricity": 0.2} if kind != "rack_pinion" else None
    made = parsed(text if law is None else edited(text, {"motion": law}), DESIGNS / "x.yaml").design
    assert entry_of(made.linkage) is MECHANISMS[kind]
    if law is not None:
        assert Drive(made).check.peak_speed.value > 0.0
    lengths = data_of(text).get("linkage", {})
    assert {key: lengths[key] for key in MECHANISMS[kind].proportions} == {
        key: pytest.approx(40.0 * share) for key, share in MECHANISMS[kind].proportions.items()
    }


@pytest.mark.parametrize("changes", [{"motion.law": "no_such"}, {"linkage.kind": "no_such"}])
def test_other_names_are_refused(changes: Mapping[str, Any]) -> None:
    with pytest.raises(WrongInput, match="no_such"):
        edited(text_of("baler"), changes)


# --- the form


def leaves(data: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys of plain values; a list of plain values is one of them."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from leaves(value, f"{path}.{key}" if path else key)
    elif isinstance(data, list) and data and isinstance(data[0], dict):
        for place, value in enumerate(data):
            yield from leaves(value, f"{path}.{place}")
    else:
        yield path, data


def rows_of(rows: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for row in rows:
        yield row
        yield from rows_of(row.get("rows", []))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.tiers(quick=SOME, rest="slow")
def test_every_value_of_a_file_has_a_row_and_no_other_row_is_given(name: str) -> None:
    data = data_of(text_of(name))
    rows = list(rows_of(form(data)))
    shown = {row["path"]: row.get("value") for row in rows if row["given"] and "rows" not in row}
    assert shown == dict(leaves(data))
    assert len({row["path"] for row in rows}) == len(rows)


def test_rows_say_what_the_models_say() -> None:
    known = {key.path: key for key in keys_of(type(loaded("baler").design)) if key.law in ("", "three_segment_stroke")}
    rows = [row for row in rows_of(form(data_of(text_of("baler")))) if row["path"] in known]
    assert len(rows) > 60
    for row in rows:
        assert row["meaning"] == known[row["path"]].meaning
    teeth = next(row for row in rows if row["path"] == "gears.teeth")
    assert (teeth["kind"], teeth["least"], teeth["most"], teeth["step"]) == ("integer", 3, 10000, 1)


@pytest.mark.slow
def test_a_group_that_is_left_out_begins_with_values_that_are_right() -> None:
    text = text_of("baler")
    for row in rows_of(form(data_of(text))):
        # Gears of two lobes or more pump, those that turn to and fro have end stops, those alone have idlers.
        needs_more = row["path"].endswith(("housing", "end_stop", "idlers"))
        if row.get("begin") is not None and row["path"].startswith("gears") and not needs_more:
            parsed(edited(text, {row["path"]: row["begin"]}), DESIGNS / "x.yaml")


# --- keys that were emptied


@pytest.mark.slow
def test_a_key_is_lacking_where_the_design_has_a_fault_without_it() -> None:
    text, path = text_of("pusher"), DESIGNS / "pusher.yaml"
    for key, _ in leaves(data_of(text)):
        if key == "motion.law" or "published" in key:
            continue
        try:
            parsed(edited(text, {key: None}), path)
        except WrongInput as error:
            assert lacking(text, {key: None}, path) == {key: error.problem}
        else:
            assert lacking(text, {key: None}, path) == {}


@at_once(
    ("changes", "lack"),
    [
        ({"motion.theta2_pi": None, "motion.theta2_deg": 90}, set()),
        ({"gears.teeth": None, "gears.center_distance_mm": 72}, set()),
        ({"gears.teeth": None, "gears.backlash_mm": None}, {"gears.teeth"}),
        ({"gears.teeth": None, "gears.module_mm": None}, {"gears.teeth", "gears.module_mm"}),
        ({"operation.speed_rpm": -1, "gears.backlash_mm": None}, set()),
        ({"operation.speed_rpm": -1, "linkage.rod_mm": None}, {"linkage.rod_mm"}),
        ({"gears": None}, set()),
    ],
)
def test_keys_are_lacking_by_what_else_is_changed(changes: Mapping[str, Any], lack: set[str]) -> None:
    assert set(lacking(text_of("pusher"), changes, DESIGNS / "pusher.yaml")) == lack


def test_each_fault_of_a_text_is_told_at_its_key() -> None:
    text = text_of("pusher").replace("speed_rpm: 30", "speed_rpm: -1", 1).replace("teeth: 48", "teeth: 47.5")
    content = answered(motion_answers, text, "pusher")[-1][1]
    told = [content, *content["others"]]
    assert [one["key"] for one in told] == ["operation.speed_rpm", "gears.teeth"]
    assert all("\n" not in one["problem"] and ".yaml" not in one["problem"] for one in told)
    assert [text.splitlines()[one["line"] - 1].strip()[:5] for one in told] == ["opera", "teeth"]


def test_a_fault_that_is_found_after_reading_has_its_line_too() -> None:
    text = text_of("pusher").partition("\nresistance:")[0] + "\nresistance: {expression_n: 3 +}\n"
    told = answered(motion_answers, text, "pusher")[-1][1]
    assert (told["key"], text.splitlines()[told["line"] - 1][:11]) == ("resistance.expression_n", "resistance:")


def test_another_law_comes_to_a_crank_of_no_length() -> None:
    text = text_of("pusher").replace("crank_mm: 60", "crank_mm: 1e-300", 1)
    assert "law: ellipse" in edited(text, {"motion.law": "ellipse"})


# --- handles: where a point is dragged to, there the law has it


def moved(name: str, number: int, axis: str, step: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """A handle of a design, and the same one after it was dragged by a step along an axis."""
    before = handles(drive(name))[number]
    move = before["moves"][axis]
    changes = {move["key"]: move["base"] + move["factor"] * step}
    return before, handles(driven(ChangingText(), text_of(name), changes, DESIGNS / f"{name}.yaml"))[number]


@at_once("number", range(4))
def test_angles_are_dragged_along_the_angle(number: int) -> None:
    before, after = moved("baler-a1-at-law-speed", number, "x", -0.36)
    assert after["x"] == pytest.approx(before["x"] - 0.36, abs=1e-4)
    key = before["moves"]["x"]["key"]
    assert before["moves"]["x"]["base"] * 360.0 / FULL_TURN[key.rpartition("_")[2]] == pytest.approx(before["x"])


@pytest.mark.thorough
def test_a_wish_is_dragged_along_its_axis() -> None:
    for number, before in enumerate(handles(drive("feeder-wishes"))):
        _, after = moved("feeder-wishes", number, "y", 0.5)
        assert after["y"] == pytest.approx(before["y"] + 0.5, abs=1e-6)


@pytest.mark.parametrize("name", ["baler", "baler-a1-at-law-speed", "feeder-wishes"])
def test_handles_lie_on_the_curves(name: str) -> None:
    made = drive(name)
    for one in handles(made):
        quantity = next(q for q in Quantity if q.key_of(made.linkage.OUTPUT) == one["chart"])
        motion = made.machine.motion(np.radians([one["x"]]))
        if "wishes" in str(one["moves"]):
            assert one["y"] == one["moves"]["y"]["base"]
        else:
            assert one["y"] == pytest.approx(quantity.values(motion, made.linkage.OUTPUT)[0], rel=1e-9, abs=1e-6)


# --- a design that is followed


CHANGED: list[dict[str, Any]] = [
    {"operation.speed_rpm": 33.25},
    {"linkage.rod_mm": 333},
    {"gears.face_width_mm": 11},
    {"output.chord_tolerance_mm": 0.01},
    {"gears.backlash_mm": 0.2},
    {"gears.rack": {"pressure_angle_deg": 21}},
    {"gears.teeth": 39},
    {"motion.eccentricity": 0.21},
    {"gears": None},
]
"""Changes that leave more or less of a drive as it is; each is followed by the one after it."""


@pytest.mark.slow
def test_what_a_change_leaves_is_kept_and_what_it_touches_is_made_anew() -> None:
    followed, text, path = ChangingText(), text_of("ellipse"), DESIGNS / "ellipse.yaml"
    for changes in CHANGED:
        kept, anew = driven(followed, text, changes, path), Drive(parsed(edited(text, changes), path).design)
        assert kept.design == anew.design
        assert kept.check.peak_speed == anew.check.peak_speed
        if anew.design.gears is not None:
            assert np.array_equal(kept.teeth.driving.outline_mm, anew.teeth.driving.outline_mm), changes
            assert np.array_equal(kept.teeth.driven.outline_mm, anew.teeth.driven.outline_mm), changes
    before = driven(followed, text, {}, path)
    teeth, law, sliding = before.teeth, before.law, before.contact_extremes.sliding_mm_s.value
    assert driven(followed, text, {"operation.speed_rpm": 20}, path).teeth is teeth
    assert driven(followed, text, {"gears.teeth": 39}, path).law is law
    _ = driven(followed, text, {}, path).contact_extremes
    assert driven(followed, text, {"linkage.rod_mm": 333}, path).contact_extremes.sliding_mm_s.value == sliding
    assert (
        driven(followed, text, {"operation.speed_rpm": 45}, path).contact_extremes.sliding_mm_s.value == sliding / 2.0
    )


SHAPED_BY_THE_SLIDER = {"three_segment_stroke", "table"}
"""Laws of designs that ask their mechanism for the ratio."""


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.tiers(quick=["baler", "ellipse"], rest="slow")
def test_a_length_of_the_mechanism_changes_gears_of_laws_that_ask_for_it_alone(name: str) -> None:
    """Pitch curves are kept where the law does not ask, and are those of the changed text either way."""
    text, path, followed = text_of(name), DESIGNS / f"{name}.yaml", ChangingText()
    before, rows = driven(followed, text, {}, path), leaves(data_of(text).get("linkage", {}), "linkage")
    changes = {key: 1.01 * value for key, value in rows if key.endswith("_mm")}
    if before.design.gears is None or not changes:
        return
    asks, pairs = before.design.motion.law in SHAPED_BY_THE_SLIDER, [pair.pitch for pair in before.by_stage]
    try:
        kept = [pair.pitch for pair in driven(followed, text, changes, path).by_stage]
    except (WrongInput, NoSuchMechanism):
        assert asks
        return
    anew = [pair.pitch for pair in Drive(parsed(edited(text, changes), path).design).by_stage]
    for was, same, own in zip(pairs, kept, anew, strict=True):
        assert (same is was) != asks
        angle = np.linspace(0.0, own.transmission.cycle_rad, 50)
        laws = [one.transmission.driven_angle(angle).value for one in (same, own)]
        assert np.array_equal(*laws)
        assert same.center_distance_mm == own.center_distance_mm


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.tiers(quick=SOME, rest="slow")
def test_changes_while_something_is_dragged_say_what_the_text_says_then(name: str) -> None:
    """The first number of the law, and the speed."""
    text = text_of(name)
    numbers = [(key, value) for key, value in leaves(data_of(text)["motion"], "motion") if isinstance(value, float)]
    changes = {"operation.speed_rpm": 33.25, **{key: 1.001 * value for key, value in numbers[:1]}}
    path = DESIGNS / f"{name}.yaml"
    assert driven(ChangingText(), text, changes, path).design == parsed(edited(text, changes), path).design


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.tiers(quick=["desk-toy"], slow=["traced-egg", "oval-flow-meter", "log-generator", "baler"], rest="long")
def test_every_design_opens_is_changed_refuses_and_is_mended(name: str) -> None:
    """By the answers that its page gets, up to the picture of each chain."""
    followed, text = ChangingText(), text_of(name)
    refused_as_shipped = name == "baler-a1-at-law-speed"

    def told(changes: Mapping[str, Any], chain: str) -> tuple[str, Any]:
        drive_of = partial(followed.made, text, changes, DESIGNS / f"{name}.yaml")
        found = guarded(answers_of(chain), drive_of)
        return next((kind, content) for kind, content in found if kind in ("refused", PICTURES[chain]))

    for changes in ({}, {"operation.speed_rpm": 33.25}):
        assert told(changes, MOTION)[0] == "motion"
        assert told(changes, GEARS)[0] == ("refused" if refused_as_shipped else "scene")
    for chain in (MOTION, GEARS):
        kind, content = told({"operation.speed_rpm": -1}, chain)
        assert (kind, content["key"], content["wrong_input"]) == ("refused", "operation.speed_rpm", True)
    if driven(followed, text, {}, DESIGNS / f"{name}.yaml").design.gears is not None:
        # Where gears stand by themselves nothing is left to be shown then, which is no fault.
        kind, content = told({"gears.rack": {"addendum": 2.5}}, GEARS)
        assert (kind, content["key"]) == ("refused", "gears.rack.addendum") or refused_as_shipped
    assert told({}, GEARS)[0] == ("refused" if refused_as_shipped else "scene")


# --- answers


def answered(answers: Answers, text: str, name: str, changes: Mapping[str, Any] | None = None) -> list[Answer]:
    """All answers of a chain to a text in the place of a design, with changes while something is dragged."""
    return list(begun_answers(answers, text, name, changes))


def begun_answers(answers: Answers, text: str, name: str, changes: Mapping[str, Any] | None = None) -> Iterator[Answer]:
    """The same one by one: later ones take longer."""
    return iter(guarded(answers, lambda: driven(ChangingText(), text, changes or {}, DESIGNS / f"{name}.yaml")))


def test_the_motion_is_that_of_the_drive() -> None:
    name, content = next(begun_answers(motion_answers, text_of("baler"), "baler"))
    assert name == "motion"
    made = drive("baler")
    for chart in content["charts"]:
        own = next(line for line in chart["lines"] if line["role"] == "own")
        quantity = next(q for q in Quantity if q.key_of(made.linkage.OUTPUT) == chart["key"])
        phi1 = np.radians(chart["x"])
        values = quantity.values(made.machine.motion(phi1), made.linkage.OUTPUT)
        # Angles have four decimals of a degree: beside a jump they may lie on its other side.
        near = np.abs(np.array(own["y"]) - values) <= 1e-3 * np.abs(values).max()
        assert near.mean() > 0.98


def test_what_cannot_be_read_has_its_line_and_key() -> None:
    text = text_of("baler").replace("teeth: 25", "teeth: many")
    for answers in (motion_answers, gear_answers, contact_answers):
        (name, content) = answered(answers, text, "baler")[-1]
        assert name == "refused"
        line = 1 + text.splitlines().index("  teeth: many")
        assert (content["key"], content["line"], content["wrong_input"]) == ("gears.teeth", line, True)


@pytest.mark.slow
def test_teeth_that_cannot_be_made_leave_the_motion() -> None:
    name = "baler-a1-at-law-speed"
    text = text_of(name)
    assert "figures" in dict(answered(motion_answers, text, name))
    found, judged = (dict(answered(answers, text, name)) for answers in (gear_answers, contact_answers))
    assert set(found) == {"bare", "refused"}
    assert found["refused"]["problem"] == judged["refused"]["problem"]


@pytest.mark.slow
def test_a_body_that_cannot_be_made_leaves_its_teeth() -> None:
    text = text_of("baler").replace("bore_mm: 16,", "bore_mm: 60,")
    assert [kind for kind, _ in answered(gear_answers, text, "baler")] == ["scene", "refused"]
    assert "teeth" in dict(answered(contact_answers, text, "baler"))


@pytest.mark.tiers(slow=["spiral-pair"], rest="long")
@pytest.mark.parametrize("name", ["ellipse", "uniform-crank", "spiral-pair", "baler-66-two-stage"])
def test_all_parts_come_for_every_kind_of_design(name: str) -> None:
    text = text_of(name)
    chains = (motion_answers, gear_answers, contact_answers)
    motion, gears, contact = ([kind for kind, _ in answered(one, text, name)] for one in chains)
    assert (motion[:2], set(motion[2:-2]), motion[-2:]) == (["motion", "figures"], {"chart"}, ["verdict", "best"])
    if drive(name).design.gears is None:
        assert (gears, contact) == (["scene"], [])
    else:
        assert gears == ["scene", "scene"]
        assert (contact[:2], set(contact[2:-1]), contact[-1]) == (["teeth", "strength"], {"chart"}, "verdict")


# --- dragging


class Asked(Chains):
    """Chains that remember what they were asked, and take no time."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[tuple[str, dict[str, Any]]] = []

    async def ask(self, number: int, text: str, changes: Mapping[str, Any], path: str) -> None:
        self.asked.append((text, dict(changes)))

    async def close(self) -> None:
        """Nothing to end."""


def test_while_the_hand_moves_its_newest_place_is_asked_for_and_the_text_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However fast moves come, one of them is always asked for; the last one is, and only its end writes the text."""
    path = tmp_path / "ellipse.yaml"
    path.write_text(text_of("ellipse"), encoding="utf-8")
    monkeypatch.setattr(open_page, "BETWEEN_S", 0.001)
    monkeypatch.setattr(open_page, "RESTS_S", 60.0)
    asked = Asked()

    async def drag() -> list[int]:
        page, counts = open_page.OpenPage(path, tmp_path, asked), []
        told: list[str] = []

        async def send(text: str) -> None:
            told.append(text)

        await page.connected(send)
        for number in range(300):
            message = {"do": "change", "changes": {"operation.speed_rpm": number}}
            await page.hear(json.dumps(message))
            await asyncio.sleep(0)
            counts.append(len(asked.asked))
        while asked.asked[-1][1] != {"operation.speed_rpm": 299}:
            await asyncio.sleep(0.001)
        assert page.history.now == text_of("ellipse")
        assert [place.name for place in tmp_path.iterdir()] == ["ellipse.yaml"], "no draft of a hand that moves"
        await page.hear('{"do": "keep"}')
        assert "speed_rpm: 299" in page.history.now
        await page.closed()
        return counts

    counts = asyncio.run(asyncio.wait_for(drag(), 30.0))
    dragged = [changes["operation.speed_rpm"] for text, changes in asked.asked if changes]
    assert dragged == sorted(set(dragged))
    assert counts[-1] > 2, "a move is asked for while others come"
    assert all(text == text_of("ellipse") for text, changes in asked.asked if changes)


async def _hears_nothing(_: str) -> None:
    """A browser that is told."""


@pytest.mark.tiers(quick=["0.1"], rest="slow")
@pytest.mark.parametrize("pause_s", [0.1, 0.25])
def test_a_page_that_is_loaded_anew_just_after_a_move_comes_back(tmp_path: Path, pause_s: float) -> None:
    """It is left in the same turn as the move is heard, and once more some turns later."""
    path = tmp_path / "ellipse.yaml"
    path.write_text(text_of("ellipse"), encoding="utf-8")

    async def load_anew() -> None:
        page = open_page.OpenPage(path, tmp_path, Asked())
        for turns in range(3):
            await page.connected(_hears_nothing)
            await page.change({"changes": {"operation.speed_rpm": 40.0}})
            await asyncio.sleep(pause_s)
            await page.change({"changes": {"operation.speed_rpm": 60.0}})
            for _ in range(turns):
                await asyncio.sleep(0)
            await page.disconnected(page._send)
            assert not page._tasks
        await page.connected(_hears_nothing)
        await page.undo({})
        await page.closed()

    asyncio.run(asyncio.wait_for(load_anew(), 10.0))


def test_work_that_loses_the_word_of_its_end_is_told_once_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(open_page, "AGAIN_S", 0.02)
    path, lost = tmp_path / "ellipse.yaml", []
    path.write_text(text_of("ellipse"), encoding="utf-8")

    async def deaf() -> None:
        while len(lost) < 2:
            try:
                await asyncio.sleep(60.0)
            except asyncio.CancelledError:
                lost.append(True)
        await asyncio.sleep(60.0)

    async def leave() -> None:
        page = open_page.OpenPage(path, tmp_path, Asked())
        await page.connected(_hears_nothing)
        page._spawn(deaf())
        await asyncio.sleep(0)
        await page.closed()

    asyncio.run(asyncio.wait_for(leave(), 10.0))
    assert len(lost) == 2


@pytest.mark.parametrize("deaf_s", [0.0, 0.3])
def test_what_swallows_a_break_is_broken_off_again_without_a_word(
    deaf_s: float, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The callback of a weak reference is deaf to exceptions, and Python prints what it has not heard."""

    class Freed:
        pass

    def deaf(_: object) -> None:
        end = time.monotonic() + deaf_s
        while time.monotonic() < end:
            time.sleep(0.001)

    lines: queue.Queue[bytes] = queue.Queue()
    requests = worker.Requests(iter(lines.get, None))  # type: ignore[arg-type]
    before = signal.signal(signal.SIGINT, requests.interrupt)
    monkeypatch.setattr(sys, "unraisablehook", quiet_of_interrupts)
    threading.Thread(target=requests.read_all, daemon=True).start()
    come(lines, 1)
    requests.next()
    requests.shown()

    def free_one_and_go_on() -> None:
        requests.computing = True
        freed = Freed()
        kept.append(weakref.ref(freed, deaf))
        come(lines, 2)
        del freed
        computed(requests, 20.0)

    kept: list[Any] = []
    try:
        with pytest.raises(worker.Superseded):
            free_one_and_go_on()
        assert requests.next()["n"] == 2
    finally:
        signal.signal(signal.SIGINT, before)
    assert capfd.readouterr().err == ""


def come(lines: queue.Queue[bytes], number: int) -> None:
    """A request comes to a worker."""
    lines.put(json.dumps({"n": number, "changes": {}, "path": "", "text": "x"}).encode())


def computed(requests: worker.Requests, seconds: float) -> None:
    """Compute for a time as a worker does."""
    requests.computing = True
    try:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            time.sleep(0.001)
    finally:
        requests.computing = False


@pytest.mark.slow
def test_a_picture_of_an_older_place_is_broken_off_where_the_hand_rests_and_not_while_it_moves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Where cores are busy, a moving hand lets a tenth of a second pass.
    monkeypatch.setattr(worker, "RESTING_S", 0.5)
    lines: queue.Queue[bytes] = queue.Queue()
    requests = worker.Requests(iter(lines.get, None))  # type: ignore[arg-type]
    before = signal.signal(signal.SIGINT, requests.interrupt)
    threading.Thread(target=requests.read_all, daemon=True).start()
    over = threading.Event()

    def move() -> None:
        number = 2
        while not over.is_set():
            come(lines, number)
            number += 1
            time.sleep(0.02)

    hand = threading.Thread(target=move)
    try:
        come(lines, 1)
        assert requests.next()["n"] == 1
        hand.start()
        computed(requests, 2.0 * worker.RESTING_S)
        over.set()
        hand.join()
        with pytest.raises(worker.Superseded):
            computed(requests, 20.0)
        assert requests.next()["n"] > 10
    finally:
        over.set()
        signal.signal(signal.SIGINT, before)


def test_a_picture_is_broken_off_by_a_newer_change_but_never_two_in_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "PATIENCE_S", 0.0)
    lines: queue.Queue[bytes] = queue.Queue()
    requests = worker.Requests(iter(lines.get, None))  # type: ignore[arg-type]
    before = signal.signal(signal.SIGINT, requests.interrupt)
    threading.Thread(target=requests.read_all, daemon=True).start()

    try:
        come(lines, 1)
        assert requests.next()["n"] == 1
        come(lines, 2)
        with pytest.raises(worker.Superseded):
            computed(requests, 20.0)
        assert requests.next()["n"] == 2
        come(lines, 3)
        computed(requests, 0.05)
        assert requests.newer
        requests.shown()
        assert requests.next()["n"] == 3
    finally:
        signal.signal(signal.SIGINT, before)


def test_machines_of_a_job_are_its_own(tmp_path: Path) -> None:
    """Of a run that is done, or cancelled after it wrote; not of one that failed, and not those of an earlier run."""
    job = Job(1, "design", "", "mine", tmp_path, lambda job: None)
    found = {"machines": [{"name": "mine-1"}], "recommended": "mine-1"}
    assert open_page._machines_of(job) == {}
    (tmp_path / "machines.json").write_text(json.dumps(found), encoding="utf-8")
    assert open_page._machines_of(job) == {}
    for job.status, job.cancelled, told in ((0, False, found), (130, True, found), (3, False, {})):
        assert open_page._machines_of(job) == told
    job.status, job.begun_s = 0, time.time() + 60.0
    assert open_page._machines_of(job) == {}
