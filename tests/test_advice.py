"""Advices: every one appears where it should, says what to change by keys that exist, and following it helps."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from functools import cache
from math import radians, sin
from pathlib import Path
from typing import Any

import pytest

from at_once import at_once
from drives import MACHINES, design_of, loaded
from ncgear.design.beginning import begun, usual_answers
from ncgear.design.keys.design import json_schema
from ncgear.design.laws.registry import LawName
from ncgear.design.reading.design_file import parsed
from ncgear.design.template import MachineName
from ncgear.errors import NoSuchMechanism
from ncgear.figures.advice.law_advice import NO_BORE, crank_pin, stretches_in_words
from ncgear.figures.advice.values import Advice, Change, Kind, Remedy
from ncgear.figures.advice.verdict import KnownParts, judged
from ncgear.figures.numbers import teeth_words
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from verdicts import verdict_on

Data = dict[str, Any]

SMALL: Data = {
    "name": "small",
    "linkage": {"crank_mm": 40, "rod_mm": 150},
    "operation": {"speed_rpm": 90},
    "motion": {"law": "uniform_crank"},
    "gears": {"teeth": 40, "module_mm": 2, "face_width_mm": 12, "least_contact_ratio": 0.0},
}

SHARP = {"dedendum": 1.6, "root_radius": 0.1, "pressure_angle_deg": 24}

CASES: dict[str, Data] = {
    "undercut": {"gears": {"teeth": 12}},
    "undercut, size by centre distance": {"gears": {"teeth": 12, "module_mm": None, "center_distance_mm": 24}},
    "undercut, allowed and shifted": {
        "gears": {"teeth": 12, "undercut": "allow", "profile_shift": {"driving": 0.05}},
    },
    "rod that meets the shaft": {
        "fit": {"rod_width_mm": 10},
        "gears": {"driving_axis_deg": 0, "driving": {"bore_mm": 12}},
    },
    "pointed": {
        "gears": {
            "teeth": 20,
            "rack": {"addendum": 1.35, "dedendum": 1.6, "root_radius": 0.1, "pressure_angle_deg": 24},
        },
    },
    "steep rack": {
        "gears": {"rack": {"pressure_angle_deg": 25, "root_radius": 0.2}},
        "motion": {"law": "ellipse", "eccentricity": 0.6},
    },
    "steep harmonics": {"motion": {"law": "harmonic_ratio", "cosine": [-0.3], "sine": [0.2, 0.3]}},
    "concave": {"motion": {"law": "ratio_expression", "driven_angle": "phi - 0.2*sin(2*phi)"}, "gears": {"teeth": 80}},
    "wide ellipse": {"motion": {"law": "ellipse", "eccentricity": 0.72}},
    "wide expression": {
        "motion": {"law": "ratio_expression", "ratio": "exp(1.9*cos(phi))", "scale_to_close": True},
    },
    "negative resistance": {"resistance": {"expression_n": "x - 10"}},
    "missed wish": {"wishes": {"time_ratio": {"at_least": 3}, "working_stroke": {"angle_deg": 10, "hard": False}}},
    "helical": {"gears": {"helix": {"angle_deg": 12, "kind": "helical", "hand": "left"}}},
    "pin at the shaft": {
        "linkage": {"crank_mm": 72, "rod_mm": 250},
        "gears": {"driving": {"bore_mm": 10}, "driven": {"bore_mm": 10}},
    },
    "too weak": {"gears": {"least_contact_ratio": 1.0}, "resistance": {"polynomial_n": [800]}},
    "loses contact": {
        "gears": {"rack": {"addendum": 0.5}, "teeth": 20},
    },
}
"""Changes of the small design that ask for an advice each."""


def merged(data: Data, changes: Data) -> Data:
    result = deepcopy(data)
    for key, value in changes.items():
        if value is None:
            result.pop(key, None)
        elif isinstance(value, dict) and isinstance(result.get(key), dict) and "law" not in value:
            result[key] = merged(result[key], value)
        else:
            result[key] = value
    return result


def data_of(name: str) -> Data:
    return merged(SMALL, CASES[name]) if name in CASES else loaded(name).data


def drive_of(data: Data) -> Drive:
    return Drive(design_of(data))


@cache
def advices(name: str) -> tuple[Advice, ...]:
    drive = drive_of(data_of(name))
    return tuple(judged(drive, KnownParts.TEETH).advices)


def followed(data: Data, remedy: Remedy) -> Data:
    """The design with a remedy's changes, and with the law that its command finds."""
    for change in remedy.changes:
        data = merged(data, nested(change))
    if remedy.command:
        assert remedy.command == "ncgear optimize"
        # The law alone counts here: few knots, and nothing that the law's own goal needs beside it.
        wished = merged(data, {"optimize": {"knots": 36}})
        law = BestLaw(design_of(wished)).law
        motion = {"law": "spline_ratio", "ratio": law.ratio.tolist()}
        data = {**data, "motion": motion}
    return data


def nested(change: Change) -> Data:
    first, _, rest = change.key.partition(".")
    value = list(change.value) if isinstance(change.value, tuple) else change.value
    return {first: nested(Change(rest, change.value)) if rest else value}


def kinds(data: Data, *, matters: bool = False) -> set[Kind]:
    verdict = judged(drive_of(data), KnownParts.TEETH, seconds=0.0)
    return {advice.kind for advice in (verdict.warnings if matters else verdict.advices)}


def remedies(name: str, *, command: bool) -> Iterator[tuple[Kind, Remedy]]:
    """Every remedy of a case that says what to change, by a command or without one."""
    for advice in advices(name):
        for remedy in advice.remedies:
            if remedy.changes and bool(remedy.command) is command:
                yield advice.kind, remedy


NOT_REMOVED = {Kind.NEGATIVE_RESISTANCE}
"""Kinds that a remedy answers otherwise: the load is then what the file says, and stays so in the advice."""


@pytest.mark.tiers(quick=["undercut-*"], rest="slow")
@pytest.mark.parametrize(
    ("name", "kind", "gear", "said"),
    [
        ("undercut", Kind.UNDERCUT, "driving", "teeth 1-12 of the driving gear"),
        ("undercut, allowed and shifted", Kind.UNDERCUT, "driving", "flanks are cut away"),
        ("pointed", Kind.POINTED, "driving", "lands would be under 0.2 modules"),
        ("steep rack", Kind.PRESSURE_ANGLE, "", "only 47 %"),
        ("concave", Kind.CONCAVE, "driving", "no hob cuts it"),
        ("wide ellipse", Kind.RATIO_RANGE, "", "from 0.163"),
        ("negative resistance", Kind.NEGATIVE_RESISTANCE, "", "0..10 mm"),
        ("missed wish", Kind.MISSED_WISH, "", "wishes.time_ratio (by "),
        ("helical", Kind.THRUST, "", "0.213 of the tangential force"),
        ("loses contact", Kind.CONTACT_RATIO, "", "0.857 pitches"),
        ("too weak", Kind.STRENGTH, "driving", "1 wanted"),
        ("internal-1-2", Kind.RING, "driven", "no hob cuts it"),
        ("baler", Kind.SPEEDS, "", "v1 is 605.96 mm/s and v2 is 416.6 mm/s"),
        ("baler", Kind.SHORTENED, "driving", "would slope too much"),
    ],
)
def test_an_advice_says_what_there_is_and_where(name: str, kind: Kind, gear: str, said: str) -> None:
    advice = next(advice for advice in advices(name) if advice.kind is kind)
    assert gear in advice.line
    assert said in advice.line


@pytest.mark.slow
def test_every_kind_is_seen_in_a_test() -> None:
    names = [*CASES, "baler", "internal-1-2"]
    elsewhere = {
        Kind.MADE,
        Kind.DRAWING,
        Kind.INDEX_HOLES,
        Kind.WITHOUT_EFFECT,
        Kind.MOTOR,
        Kind.DRIVETRAIN,
        Kind.TRANSMISSION_ANGLE,
        Kind.VIBRATION,
        Kind.ROOM,
    }
    assert {advice.kind for name in names for advice in advices(name)} == set(Kind) - elsewhere


@pytest.mark.thorough
def test_a_sound_design_has_no_advice() -> None:
    assert advices("ellipse") == ()


def schema_at(key: str) -> list[Data]:
    """What the schema says of a dotted key; empty where it has none."""
    schema = json_schema()
    found = [schema]
    for part in key.split("."):
        found = [
            sub["properties"][part] for one in found for sub in plain(one, schema) if part in sub.get("properties", {})
        ]
    return found


def plain(one: Data, schema: Data) -> list[Data]:
    """The alternatives of a schema, references followed."""
    if "$ref" in one:
        return plain(schema["$defs"][one["$ref"].rpartition("/")[2]], schema)
    choices = [*one.get("anyOf", []), *one.get("oneOf", [])]
    return [found for choice in choices for found in plain(choice, schema)] if choices else [one]


@pytest.mark.long
@pytest.mark.slow
def test_every_advised_key_is_one_of_the_schema() -> None:
    advised = {
        change.key for name in CASES for advice in advices(name) for r in advice.remedies for change in r.changes
    }
    assert len(advised) > 12
    assert [key for key in advised if not schema_at(key)] == []
    assert not schema_at("gears.rack.height")


@pytest.mark.tiers(slow=["wide ellipse"], rest="long")
@pytest.mark.parametrize("name", CASES)
def test_following_an_advice_removes_it(name: str) -> None:
    for kind, remedy in remedies(name, command=False):
        stays = kind in NOT_REMOVED
        assert (kind in kinds(followed(data_of(name), remedy), matters=not stays)) is stays, remedy


LIMITED = [name for name in CASES if name.startswith(("steep", "concave", "wide"))]


@pytest.mark.slow
@pytest.mark.parametrize("name", LIMITED)
def test_the_law_that_is_found_within_the_advised_limit_removes_the_advice(name: str) -> None:
    found = list(remedies(name, command=True))
    assert found
    for kind, remedy in found:
        assert kind not in kinds(followed(data_of(name), remedy)), remedy


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "kind", "less"),
    [
        ("undercut", Kind.UNDERCUT, {"gears": {"teeth": 16, "module_mm": 1.5}}),
        ("pointed", Kind.POINTED, {"gears": {"rack": {"addendum": 1.29}}}),
        ("steep rack", Kind.PRESSURE_ANGLE, {"motion": {"law": "ellipse", "eccentricity": 0.59}}),
        ("concave", Kind.CONCAVE, {"motion": {**CASES["concave"]["motion"], "driven_angle": "phi - 0.155*sin(2*phi)"}}),
        ("wide ellipse", Kind.RATIO_RANGE, {"motion": {"law": "ellipse", "eccentricity": 0.67}}),
    ],
)
def test_less_than_what_is_advised_does_not_remove_the_advice(name: str, kind: Kind, less: Data) -> None:
    assert kind in kinds(merged(data_of(name), less))


def undercut_by(deeper_mm: float, undercut: str) -> Data:
    """24 teeth of 2 mm, cut by a sharp rack that goes so far below the cusp of their flanks, r sin^2(20 deg)."""
    dedendum = 12.0 * sin(radians(20.0)) ** 2 + deeper_mm / 2.0
    rack = {"dedendum": dedendum, "root_radius": 0}
    gears = {"teeth": 24, "undercut": undercut, "rack": rack, "cutter": {"kind": "rack"}, "backlash_mm": 0.07}
    return merged(SMALL, {"gears": gears})


@pytest.mark.slow
@pytest.mark.parametrize("undercut", ["avoid", "allow"])
@pytest.mark.parametrize(("deeper_mm", "matters"), [(0.0005, False), (0.05, True)])
def test_an_undercut_of_half_a_micrometre_is_a_remark(undercut: str, deeper_mm: float, matters: bool) -> None:
    """By building both: what does not matter costs less than 2 % of the contact ratio, what matters costs more.

    Where undercut is allowed these mates do not reach down to the notch, so no contact is lost, but the roots are cut.
    """
    drive, free = (drive_of(undercut_by(deeper, undercut)) for deeper in (deeper_mm, -0.1))
    # That nothing is undercut makes a key idle that allows it.
    idle = [Kind.WITHOUT_EFFECT] if undercut == "allow" else []
    assert [advice.kind for advice in judged(free, KnownParts.TEETH).advices] == idle
    (advice,) = judged(drive, KnownParts.TEETH).advices
    assert (advice.kind, advice.matters, bool(advice.remedies)) == (Kind.UNDERCUT, matters, matters)
    assert ("does not matter" in advice.line) is not matters
    lost = 1.0 - drive.designed_contact.contact_ratio / free.designed_contact.contact_ratio
    if undercut == "avoid":
        assert f"by up to {1e3 * deeper_mm:.3g} \u00b5m (tooth 1)" in advice.line
        assert (lost > 0.02) is matters
    else:
        assert lost == pytest.approx(0.0, abs=1e-9)


def test_two_given_sizes_stay_two() -> None:
    data = merged(SMALL, {"gears": {"teeth": None, "module_mm": 4, "center_distance_mm": 48}})
    drive = drive_of(data)
    advice = next(iter(verdict_on(Kind.UNDERCUT, drive, KnownParts.TEETH).advices))
    remedy = next(remedy for remedy in advice.remedies if Change("gears.teeth", 18) in remedy.changes)
    assert remedy.changes == (Change("gears.teeth", 18), Change("gears.module_mm", None))
    assert "leave gears.module_mm out" in str(remedy)
    assert drive_of(followed(data, remedy)).pitch.center_distance_mm == pytest.approx(48.0)


@pytest.mark.slow
def test_a_shift_is_advised_where_it_is_enough_in_place_of_the_given_one() -> None:
    data = merged(
        SMALL, {"gears": {"teeth": 12, "lobes": {"driving": 1, "driven": 4}, "profile_shift": {"driving": 0.1}}}
    )
    advice = next(a for a in judged(drive_of(data), KnownParts.TEETH).advices if a.kind is Kind.UNDERCUT)
    remedy = next(r for r in advice.remedies if Change("gears.profile_shift.against_undercut", True) in r.changes)
    assert Change("gears.profile_shift.driving", None) in remedy.changes
    assert Kind.UNDERCUT not in kinds(followed(data, remedy))


def test_values_read_as_text() -> None:
    assert (teeth_words([7, 1, 2, 3]), teeth_words([5])) == ("teeth 1-3, 7", "tooth 5")
    assert str(Change("motion.sine", (0.5, 0.25, 0.1, 0.05))) == "motion.sine: [0.5, 0.25, 0.1, and 1 more]"
    assert str(Remedy("do it", (Change("a.b", True),), "ncgear optimize")) == "do it (a.b: true, then ncgear optimize)"


@at_once(
    ("crank", "driving", "driven", "near"),
    [
        # The axes are 80 mm apart, and the pin is taken to be as thick as the driven shaft
        (72.0, {"bore_mm": 10}, {"bore_mm": 8}, ["driving"]),
        (70.9, {"bore_mm": 10}, {"bore_mm": 8}, []),
        (88.9, {"bore_mm": 10}, {"bore_mm": 8}, ["driving"]),
        (89.1, {"bore_mm": 10}, {"bore_mm": 8}, []),
        (48.0, {"bore_mm": 10, "hub": {"diameter_mm": 57, "height_mm": 9}}, {"bore_mm": 8}, ["driving"]),
        (38.0, {"bore_mm": 10}, {"bore_mm": 8, "hub": {"diameter_mm": 69, "height_mm": 9}}, ["driven"]),
        (80.0, {"bore_mm": 10}, {}, ["driving"]),
        (80.0, {}, {}, []),
    ],
)
def test_a_crank_pin_that_meets_a_shaft_or_hub_is_told(
    crank: float, driving: Data, driven: Data, near: list[str]
) -> None:
    data = merged(SMALL, {"linkage": {"crank_mm": crank, "rod_mm": 300}, "gears": {"driving": driving}})
    found = crank_pin(drive_of(merged(data, {"gears": {"driven": driven}})))
    told = [one for one in found if isinstance(one, Advice)]
    # Without a bore nothing is known of the shaft
    assert (NO_BORE in found) is not bool(driving and driven)
    assert [one.what.partition(" touches the ")[2].partition(" ")[0] for one in told] == near
    for advice in told:
        passed = abs(80.0 - crank) if near == ["driving"] else crank
        assert f"{passed:.3g} mm from the {near[0]} gear" in advice.meaning


def stands_in(data: Data, key: str) -> bool:
    group: Any = data
    for part in key.split("."):
        if not isinstance(group, dict) or part not in group:
            return False
        group = group[part]
    return True


def undone(data: Data, remedy: Remedy) -> list[str]:
    """What a remedy changes of what the file asks of the machine: all but the means, its law and its gears."""
    asked = [one.key for one in remedy.changes if not one.key.startswith(("motion.", "gears."))]
    return [key for key in asked if stands_in(data, key)]


def judged_advices(drive: Drive) -> list[Advice]:
    try:
        return judged(drive, KnownParts.TEETH if drive.design.gears else KnownParts.MOTION).advices
    except NoSuchMechanism:
        return judged(drive, KnownParts.MOTION).advices


def kept_wishes(drive: Drive) -> set[str]:
    return {one.wish.key for one in drive.achieved.outcomes if one.kept} if drive.achieved else set()


def undone_by_advices(data: Data) -> list[str]:
    """What is changed of a file by doing what any of its advices says, and the wishes that are kept no more."""
    drive, found = drive_of(data), []
    for advice in judged_advices(drive):
        for remedy in advice.remedies:
            found += undone(data, remedy)
            if not remedy.command and remedy.changes:
                found += kept_wishes(drive) - kept_wishes(drive_of(followed(data, remedy)))
    return found


@pytest.mark.tiers(slow=["desk-toy-0.55", "pu*-0.55", "press*-0.55"], rest="long")
@pytest.mark.parametrize("slower", [1.0, 0.55, 1.7])
@pytest.mark.parametrize("beginning", [*MachineName, LawName.THREE_SEGMENT_STROKE])
def test_a_new_machine_of_any_speed_is_not_advised_another_one(beginning: MachineName | LawName, slower: float) -> None:
    """The law of the file is stated at the speed that was asked for, and no advice undoes anything of the file."""
    speed = round(usual_answers(beginning)["speed_rpm"] * slower, 3)
    data = parsed(begun("a", beginning, {"speed_rpm": speed}), Path("a.yaml")).data
    assert data["operation"]["speed_rpm"] == speed
    assert data["motion"].get("law_speed_rpm", speed) == speed
    drive = drive_of(data)
    assert Kind.SPEEDS not in {advice.kind for advice in judged(drive, KnownParts.MOTION).advices}
    assert undone_by_advices(data) == []


@pytest.mark.tiers(long=["baler*", "rounded-square"], rest="slow")
@pytest.mark.parametrize("name", MACHINES)
def test_no_advice_undoes_what_a_design_asks_of_its_machine(name: str) -> None:
    assert undone_by_advices(loaded(name).data) == []


def test_a_law_stated_at_another_speed_than_the_given_one_is_a_remark() -> None:
    """By hand: v2 = 1100 mm/s at 52.81 r/min is 624.9 mm/s at 30 r/min."""
    data = merged(loaded("baler").data, {"operation": {"speed_rpm": 30}})
    (advice,) = verdict_on(Kind.SPEEDS, drive_of(data), KnownParts.MOTION).advices
    assert (advice.matters, advice.remedies) == (False, ())
    assert "v2 is 624.9 mm/s" in advice.line


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "given", "kind", "left"),
    [
        # A limit of the file that is wider than an advice's is wanted so, one that is tighter stays.
        ("concave", {"optimize": {"limits": {"convex": False}}}, Kind.CONCAVE, None),
        ("concave", {"optimize": {"limits": {"convex": True}}}, Kind.CONCAVE, []),
        ("wide ellipse", {"optimize": {"limits": {"ratio_max": 8}}}, Kind.RATIO_RANGE, None),
        ("wide ellipse", {"optimize": {"limits": {"ratio_max": 3.5}}}, Kind.RATIO_RANGE, ["ratio_min"]),
        ("wide ellipse", {"optimize": {"limits": {"ratio_min": 0.3, "ratio_max": 3.5}}}, Kind.RATIO_RANGE, []),
        ("steep rack", {"optimize": {"limits": {"pressure_angle_deg": 63}}}, Kind.PRESSURE_ANGLE, None),
        ("steep rack", {"optimize": {"limits": {"pressure_angle_deg": 52}}}, Kind.PRESSURE_ANGLE, []),
    ],
)
def test_a_limit_of_the_file_is_not_changed_by_an_advice(
    case: str, given: Data, kind: Kind, left: list[str] | None
) -> None:
    data = merged(data_of(case), given)
    (advice,) = (one for one in judged_advices(drive_of(data)) if one.kind is kind and "driven" not in one.what)
    searches = [one for one in advice.remedies if one.command]
    changed = [[change.key.rpartition(".")[2] for change in one.changes] for one in searches]
    assert changed == ([] if left is None else [left])
    assert [undone(data, one) for one in advice.remedies if undone(data, one)] == []


def test_a_resistance_that_is_said_to_be_negative_is_a_remark() -> None:
    for said in ("keep", "zero"):
        data = merged(data_of("negative resistance"), {"resistance": {"where_negative": said}})
        (advice,) = verdict_on(Kind.NEGATIVE_RESISTANCE, drive_of(data), KnownParts.MOTION).advices
        assert (advice.matters, advice.remedies) == (False, ())


@pytest.mark.slow
def test_a_gentler_law_is_not_advised_where_it_would_miss_a_wish_that_is_kept() -> None:
    """This law comes back several times as fast as it works, and a gentler one a little less so."""
    data = merged(SMALL, {"motion": {"law": "harmonic_ratio", "sine": [1.9]}})
    ratio = drive_of(data).achieved.time_ratio
    for least, count in ((0.3 * ratio, 1), (0.99 * ratio, 0)):
        wished = drive_of(merged(data, {"wishes": {"time_ratio": {"at_least": least}}}))
        (advice,) = (one for one in judged(wished, KnownParts.MOTION).advices if one.kind is Kind.RATIO_RANGE)
        assert len([one for one in advice.remedies if "swing" in one.text]) == count


@at_once(
    ("stretches", "said"),
    [
        ([(71.2, 110.4)], "71..110"),
        ([(0.0, 12.6), (100.0, 140.2), (351.0, 360.0)], "100..140, 351..13"),
        ([(359.72, 360.0)], "359.7..360.0"),
        ([(20.0, 45.0), (359.9999999999, 360.0)], "20..45"),
        ([(0.0, 0.004), (30.0, 80.0)], "0.000..0.004, 30..80"),
    ],
)
def test_stretches_are_told_by_ends_that_differ(stretches: list[tuple[float, float]], said: str) -> None:
    """Where one goes on over the end of the period it is one; slivers of rounding are none."""
    assert stretches_in_words(stretches, 360.0) == said
