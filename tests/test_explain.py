"""What keys mean: everything said of them is what the models hold to."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import pytest
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from at_once import at_once
from commands import ROOT, Run
from drives import TRAINS
from ncgear.design.keys.balance import Balance
from ncgear.design.keys.base import FAULT_TYPE
from ncgear.design.keys.design import Design
from ncgear.design.laws.registry import LawName
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.reference import Key, allowed, example, keys_of, told_keys_of, unit_of
from ncgear.design.told_keys import told_keys
from ncgear.design.trains.registry import TrainFile
from ncgear.design.words import folded, listed, quantity
from ncgear.figures.explained import IDEAS, explained

FILES = [*ROOT.glob("designs/*.yaml"), *ROOT.glob("designs/balance/*.yaml")]


@cache
def keys(root: type[BaseModel]) -> list[Key]:
    return keys_of(root)


def every_key() -> Iterator[tuple[type[BaseModel], Key]]:
    return ((root, key) for root in (Design, Balance, TrainFile) for key in keys(root))


def test_every_key_says_what_it_means() -> None:
    assert [key.path for _, key in every_key() if not key.meaning] == []


def written(data: Any, above: str = "") -> set[str]:
    """Dotted keys of a file's values, without the numbers of list items."""
    if isinstance(data, list):
        return {path for item in data for path in written(item, above)}
    if not isinstance(data, dict):
        return set()
    inner = {path for name, value in data.items() for path in written(value, f"{above}.{name}")}
    return {f"{above}.{name}".strip(".") for name in data} | {path.strip(".") for path in inner}


@pytest.mark.tiers(quick=["baler-66-two-stage", "rocker-drive", "pusher", "threshing-drum"], rest="slow")
@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_every_key_of_a_worked_example_is_known(path: Path) -> None:
    of_train = TrainFile if path.stem in TRAINS else Design
    root = Balance if path.parent.name == "balance" else of_train
    found = written(read_yaml(path.read_text(encoding="utf-8"), path.name).data)
    assert len(found) > 3
    assert found <= {key.path for key in keys(root)}


def faults(root: type[BaseModel], key: Key) -> set[str]:
    """What is wrong with the example of a key by itself: a group's own rules may want more keys."""
    name, value = next(iter(read_yaml(example(key, root), "example").data.items()))
    if name != key.name:
        return {name}
    checked = TypeAdapter(
        Annotated[(key.field.annotation, *key.field.metadata)] if key.field.metadata else key.field.annotation,
        config=None if key.group else ConfigDict(strict=True, allow_inf_nan=False),
    )
    try:
        checked.validate_python(value)
    except ValidationError as error:
        found = {detail["type"] for detail in error.errors()}
        # A list is short, too, of items that are refused.
        return set() if key.group and found - {"too_short"} == {FAULT_TYPE} else found
    return set()


@pytest.mark.slow
def test_every_example_is_right() -> None:
    assert {key.path: found for root, key in every_key() if (found := faults(root, key))} == {}


WHOLE = ["linkage", "resistance.table", "comparison.published", "gears.driving.hub", "gears.driving.web"]


@at_once("path", WHOLE)
def test_examples_of_groups_with_rules_of_their_own_can_be_copied(path: str) -> None:
    key = next(key for key in keys(Design) if key.path == path)
    (value,) = read_yaml(example(key, Design), "example").data.values()
    TypeAdapter(key.field.annotation).validate_python(value)


SAID = {
    "in degrees": "degrees",
    "in multiples of pi": "multiples of pi",
    "in mm/s2": "mm/s2",
    "in mm/s,": "mm/s",
    "in r/min": "r/min",
    "in kg mm2": "kg mm2",
    "in mm;": "mm",
    "in GPa": "GPa",
}


def test_the_unit_told_is_the_one_in_the_description() -> None:
    """Two ways to the same thing: the end of the key, and what a person wrote of it."""
    described = {
        (key.name, unit)
        for _, key in every_key()
        for words, unit in SAID.items()
        if words in key.meaning and not key.group
    }
    assert len(described) > 50
    assert {name: unit_of(name) for name, unit in described if unit_of(name) != unit} == {}


def test_a_key_in_full(run: Run) -> None:
    assert run("explain", "gears.rack.profile") == (
        0,
        "gears.rack.profile\n"
        "  basic rack profile of ISO 53: A, B, C or D\n"
        "\n"
        "  value      A, B, C or D\n"
        "  default    A\n"
        "  example    profile: A\n"
        "  beside it  pressure_angle_deg, idle_pressure_angle_deg, addendum, dedendum, root_radius and\n"
        "             tip_relief\n",
        "",
    )


@pytest.mark.parametrize("asked", ["theta2", "motion.theta2"])
def test_an_angle_is_told_once_with_its_units(run: Run, asked: str) -> None:
    status, out, err = run("explain", asked)
    assert (status, err) == (0, "")
    first, second = out.splitlines()[:2]
    assert first == "motion.theta2_rad, motion.theta2_deg or motion.theta2_pi"
    assert second == "  driving angle from which the slider's speed is v2; over theta1"
    assert "unit       radians, degrees or multiples of pi" in out
    assert "laws       three_segment_stroke" in out


def test_the_last_part_finds_every_key_of_that_name(run: Run) -> None:
    _, out, _ = run("explain", "teeth")
    assert [line for line in out.splitlines() if line.startswith("gears")] == ["gears.teeth", "gears.cutter.teeth"]
    assert "a whole number, 3 or over, up to 10000" in out


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "root"), [("design", Design), ("balance", Balance)])
def test_the_table_of_keys_is_that_of_the_models(kind: str, root: type[BaseModel]) -> None:
    """Otherwise `PYTHONPATH=docs:src python -m made` writes it anew."""
    assert told_keys(kind) == told_keys_of(root)


def test_many_keys_of_one_name_are_listed() -> None:
    keys = told_keys("balance")
    found = [key for key in keys if key.name in ("name", "speed_rpm", "mass_kg")]
    text = explained(keys, found)
    assert text.splitlines()[0] == f"{len(found)} keys; one of them by its whole name:"
    assert all(key.path in text for key in found)


def test_a_key_as_messages_name_it(run: Run) -> None:
    """With the number of an item of a list."""
    _, out, _ = run("explain", "comparison.published.0.speed_rpm")
    assert out.startswith("comparison.published.speed_rpm\n  driving speed in r/min that the figures belong to\n")


def test_the_names_of_all_laws(run: Run) -> None:
    _, out, _ = run("explain", "law")
    assert "how the slider moves, or how the ratio runs" in out
    assert listed(LawName) in " ".join(out.split())


@at_once(
    ("asked", "meant"),
    [
        ("thta2", "motion.theta2"),
        ("gears.rack.profil", "gears.rack.profile"),
        ("modul", "gears.module_mm"),
        ("centre_distanc", "gears.center_distance_mm"),
        ("Teethh", "gears.teeth"),
    ],
)
def test_an_unknown_key_is_refused_with_what_was_meant(run: Run, asked: str, meant: str) -> None:
    status, out, err = run("explain", asked)
    assert (status, out) == (2, "")
    assert re.match(rf"{re.escape(asked)}: unknown key; did you mean .*{re.escape(meant)}", err)


@at_once(("asked", "of"), [("train.path.tool", "train"), ("counterweights", "balance")])
def test_a_key_of_another_kind_of_file_is_told_with_the_kind(run: Run, asked: str, of: str) -> None:
    _, _, err = run("explain", asked)
    assert f"`ncgear explain {asked} --of {of}` tells it" in err
    assert run("explain", asked, "--of", of)[0] == 0


@at_once(
    ("asked", "first"),
    [
        ("v1", "motion.v1_mm_s"),
        ("motion.law_speed", "motion.law_speed_rpm"),
        ("Bore", "gears.driving.bore_mm"),
        ("speed", "operation.speed_rpm"),
        ("face width", "gears.face_width_mm"),
        ("slider", "masses.slider_kg"),
    ],
)
def test_a_key_without_its_unit(run: Run, asked: str, first: str) -> None:
    """As people write quantities; where several keys have it, they come in the order of the file."""
    status, out, _ = run("explain", asked)
    assert status == 0
    assert out.splitlines()[0] == first


def test_a_word_that_names_no_key_finds_the_keys_that_speak_of_it(run: Run) -> None:
    status, out, _ = run("explain", "hob")
    assert status == 0
    assert out.startswith("gears.cutter.kind\n")
    assert "rack (hob)" in out


@pytest.mark.slow
@pytest.mark.parametrize("idea", IDEAS)
def test_ideas_without_a_key_are_told(run: Run, idea: str) -> None:
    """Each idea is no key of either file, and every key that it names is one."""
    for root in (Design, Balance):
        assert idea not in {quantity(key.name) for key in keys(root)} | {key.name for key in keys(root)}
    status, out, _ = run("explain", idea.replace("_", " "))
    assert (status, out.splitlines()[0]) == (0, f"{idea.replace('_', ' ')} (no key)")
    paths = re.findall(r"\b(?:gears|motion|optimize|wishes)\.[\w.]+\w", IDEAS[idea])
    assert set(paths) <= {key.path for key in keys(Design)}


@pytest.mark.parametrize("asked", ["contact ratio", "face width", "no such key"])
def test_words_need_no_quotes(run: Run, asked: str) -> None:
    assert run("explain", *asked.split()) == run("explain", asked)
    assert run("explain", *asked.split(), "--of", "balance") == run("explain", "--of", "balance", asked)


def test_a_key_like_no_other(run: Run) -> None:
    assert run("explain", "qqq") == (2, "", "qqq: unknown key; `ncgear explain` lists all keys\n")


@pytest.mark.parametrize(("kind", "root"), [("design", Design), ("balance", Balance)])
def test_without_a_key_all_are_listed(run: Run, kind: str, root: type[BaseModel]) -> None:
    status, out, err = run("explain", "--of", kind)
    assert (status, err) == (0, "")
    words = set(re.findall(r"[\w/]+", out))
    shown = folded(key.name for key in keys(root) if not key.is_law_name)
    assert [name for name in shown if name not in words and quantity(name) not in out] == []


@pytest.mark.thorough
def test_defaults_that_follow_from_others(run: Run) -> None:
    assert "default    0.38, where the other keys have their defaults" in run("explain", "root_radius")[1]
    assert "default    none: it must be given" in run("explain", "rod_mm")[1]
    assert "default    may be left out" in run("explain", "helix")[1]


def test_ranges_in_words() -> None:
    said = {
        "motion.eccentricity": "a number, 0 or over, under 1",
        "motion.return.e": "a number or least_acceleration",
        "gears.index_holes": "true or false",
        "name": "text of letters, digits, - and _, at most 64 of them",
        "comparison.published": "a list (1 to 100) of groups of keys",
        "resistance.table.force_n": "a list (2 to 1000) of: a number, -1e+15 or over, up to 1e+15",
    }
    assert {key.path: allowed(key) for key in keys(Design) if key.path in said} == said


@at_once(
    ("asked", "said"),
    [
        ("mass", "stands in the section masses"),
        ("gentle stop", "deceleration_at_most_mm_s2"),
        ("Gentle Stops", "greatest decelerations, or speeds, over stretches of the stroke"),
        ("quick-return", "wishes.time_ratio"),
    ],
)
def test_words_of_people_lead_to_keys(run: Run, asked: str, said: str) -> None:
    """And every dotted key that is named there is one."""
    status, out, _ = run("explain", asked)
    assert status == 0
    assert said in " ".join(out.split())
    paths = {key.path for key in told_keys("design")}
    named = set(re.findall(r"\b(?:masses|optimize|wishes|motion|gears)(?:\.[a-z_0-9]+)+", out))
    assert named
    assert named <= paths


@pytest.mark.parametrize(("asked", "found"), [("rod", "linkage.rod_mm"), ("flywheel", "masses.flywheel")])
def test_a_part_of_a_machine_is_told_with_its_size_and_its_mass(run: Run, asked: str, found: str) -> None:
    _, out, _ = run("explain", asked)
    heads = [line for line in out.splitlines() if line and not line.startswith(" ")]
    assert found in heads
    assert f"masses.{asked}" in heads


@pytest.mark.parametrize("key", ["resistance.table", "resistance.returning.table"])
def test_tables_say_how_their_points_are_joined(key: str, run: Run) -> None:
    assert "joined by monotone cubics" in " ".join(run("explain", key)[1].split())
