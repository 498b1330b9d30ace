"""What is told of trains and of wrong files: keys as the file has them, remedies that work, one limit for one size."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from commands import Run
from ncgear.design.beginning import wishes_told
from ncgear.design.mechanisms import MECHANISMS
from ncgear.design.reading.design_file import design_of, load, load_train
from ncgear.design.reading.places import with_value
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.told_keys import told_keys
from ncgear.errors import DesignError, WrongInput
from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import KnownParts, State, Verdict, judged
from ncgear.figures.answers.simulated import _compared
from ncgear.figures.explained import told
from ncgear.figures.numbers import json_text
from ncgear.figures.simulated import force_figures
from ncgear.figures.strong import holding_words
from ncgear.numerics import chebyshev
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.numerics.chebyshev import Rising
from ncgear.numerics.extrema import Extremum
from ncgear.project.drive import Drive
from ncgear.project.mending import mending
from ncgear.ratio.laws.curve_shapes import polar_points
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.transmission import Lobes

CHAIN = """\
name: row
train:
  kind: chain
  speed_rpm: 60
  lobes: [1, 1, 1]
  ratio: 1 + 0.2*cos(phi)
  gears: {teeth: 16, module_mm: 2, face_width_mm: 10, backlash_mm: 0.05}
"""

CARRIED = """\
name: carried
train:
  kind: planetary
  speed_rpm: 60
  arm_mm: 100
  ratio: [1.2, 1.0, 0.9, 1.0]
  gears: {teeth: 18, module_mm: 2, face_width_mm: 8}
"""

MASSES = "  masses: {density_kg_m3: 7850}\n"


def written(text: str, name: str = "mine") -> Path:
    path = Path(f"{name}.yaml")
    path.write_text(text, encoding="utf-8")
    return path


def verdict_of(text: str) -> Verdict:
    drive = Drive(load(written(text), for_loads=True).design)
    return judged(drive.by_stage[0], KnownParts.TEETH)


def keys_of(text: str) -> dict[str, str | None]:
    design = load(written(text), for_loads=True).design
    keys = ("gears.teeth", "gears.face_width_mm", "gears.rack.pressure_angle_deg", "gears.helix.kind", "gears.material")
    return {key: design.key_in_file(key) for key in keys}


@pytest.mark.usefixtures("run")
def test_a_file_of_a_train_has_its_own_keys_and_no_others() -> None:
    """Larger gears of a train with masses are another load, of which the machine's own keys know nothing."""
    every = {key: f"train.{key}" for key in ("gears.teeth", "gears.face_width_mm", "gears.rack.pressure_angle_deg")}
    every |= {"gears.material": "train.gears.material"}
    assert keys_of(CHAIN) == keys_of(CARRIED) == {**every, "gears.helix.kind": None}
    found = keys_of(CARRIED + MASSES)
    assert (found["gears.teeth"], found["gears.face_width_mm"]) == (None, None)
    assert found["gears.rack.pressure_angle_deg"] == "train.gears.rack.pressure_angle_deg"


@pytest.mark.usefixtures("run")
def test_every_remedy_of_a_train_works_when_it_is_written_into_its_file() -> None:
    before = verdict_of(CHAIN)
    broken = {row.kind: row for row in before.rows if row.state is State.BROKEN}
    assert Kind.UNDERCUT in broken
    remedies = [remedy for advice in broken[Kind.UNDERCUT].advices for remedy in advice.remedies if remedy.changes]
    assert len(remedies) >= 2
    for remedy in remedies:
        data = read_yaml(CHAIN, "mine.yaml").data
        for change in remedy.changes:
            assert change.key.startswith("train.gears.")
            data = with_value(data, change.key, change.value)
        after = verdict_of(json_text(data))
        assert Kind.UNDERCUT not in {row.kind for row in after.rows if row.state is State.BROKEN}, remedy


@pytest.mark.usefixtures("run")
def test_check_and_machine_refuse_the_same_bore_with_the_largest_for_all_gears() -> None:
    """The bore that is told is right for both, and a hundredth of a millimetre more for neither."""

    def refusal(text: str) -> tuple[str, str]:
        path, found = written(text), list[DesignError]()
        for opened in (lambda: load_train(path).file.train.train(), lambda: load(path, for_loads=True)):
            try:
                opened()
            except DesignError as error:
                found.append(error)
        assert len({(one.key, one.problem) for one in found}) <= 1
        assert len(found) in (0, 2)
        return (found[0].key, found[0].problem) if found else ("", "")

    for text in (CHAIN, CARRIED + MASSES):
        key, said = refusal(text.replace("teeth:", "bore_mm: 90, teeth:"))
        assert key == "train.gears.bore_mm"
        most = float(said.rpartition("the largest that fits is ")[2].removesuffix(" mm"))
        assert refusal(text.replace("teeth:", f"bore_mm: {most}, teeth:")) == ("", "")
        assert refusal(text.replace("teeth:", f"bore_mm: {most + 0.02:.2f}, teeth:"))[0] == key


@pytest.mark.parametrize("command", ["check", "strength", "tolerance"])
def test_a_wrong_count_of_bends_is_told_by_the_key_of_the_file(run: Run, command: str) -> None:
    status, _, err = run(command, str(written(CHAIN.replace("ratio:", "bends_deg: [10, 20]\n  ratio:"))))
    assert status == 2
    assert "train.bends_deg: 2 given for one idler of 3 gears; one for each is right" in err


@pytest.mark.usefixtures("run")
def test_a_row_that_overlaps_is_refused_without_changes_of_its_teeth() -> None:
    path = written(CHAIN.replace("ratio: 1 + 0.2*cos(phi)", "bends_deg: [140]"))
    with pytest.raises(DesignError, match="gears 1 and 3 of the row overlap at every angle") as refused:
        load_train(path).file.train.train()
    assert refused.value.key == "train.bends_deg"
    with pytest.raises(DesignError, match="overlap at every angle"):
        mending(Drive(load(path).design))


def test_a_rising_function_is_inverted_across_a_jump_by_rounding() -> None:
    form = chebyshev.fitted(lambda x: x + 0.2 * np.sin(x), [0.0, np.pi, 2.0 * np.pi])
    jumping = form.coefficients.copy()
    jumping[0, form.breaks[:-1] >= np.pi] += 2e-14
    jumped = Rising(replace(form, coefficients=jumping))
    values = np.array([1.0, np.pi + 1e-14, 5.0])
    assert jumped(jumped.inverse(values)) == pytest.approx(values, abs=3e-14)


@pytest.mark.parametrize("closed", [False, True])
def test_an_outline_that_is_given_twice_is_told_with_its_first_row(closed: bool) -> None:
    at = np.linspace(0.0, 2.0 * np.pi, 30, endpoint=closed)
    at[-1] = 0.0 if closed else at[-1]
    points = np.stack([30.0 * np.cos(at), 20.0 * np.sin(at)], axis=-1)
    with pytest.raises(WrongInput, match="given 2 times, and row 31 of the points is row 1 again; its first 30 rows"):
        polar_points(np.concatenate([points, points]), 0.01, "motion.points")


def test_a_ratio_beyond_all_numbers_is_not_called_negative() -> None:
    with pytest.raises(DesignError, match="too large to be computed"):
        ratio_expression_law("1e300*(1 + 0.1*sin(phi))", Lobes(), scale_to_close=True)
    with pytest.raises(DesignError, match="the ratio is negative"):
        ratio_expression_law("-1 - 0.1*sin(phi)", Lobes(), scale_to_close=True)


def test_large_bounds_are_plain_digits() -> None:
    assert (shown_above(650414.2, 4), shown_below(650414.2, 4)) == ("650500", "650400")
    assert (shown_above(2471147.0, 4), shown_above(0.00123456, 4), shown_above(1e15, 3)) == (
        "2472000",
        "0.001235",
        "1e+15",
    )


def test_a_key_of_several_kinds_of_train_is_told_for_each() -> None:
    said = " ".join(told(told_keys("train"), "train.ratio").split())
    for words in (
        "of planetary: speed of the carrier",
        "of chain: ratio of the first two",
        "of moving_axis: ratio i12",
    ):
        assert words in said
    assert said.count("a list (4 to 720)") == 1


def test_a_group_of_several_kinds_of_train_has_the_keys_of_each_kind_apart() -> None:
    planetary, chain = told(told_keys("train"), "train.masses").split("\n\ntrain.masses\n")
    assert "density_kg_m3, tool_kg and gravity_m_s2" in " ".join(planetary.split())
    assert "tool_kg" not in chain
    assert "driven_flywheel_kg_mm2" in chain


DRAWN = """\
name: drawn
operation: {speed_rpm: 30}
motion: {law: pitch_curve, svg: {file: drawn.svg}}
"""


@pytest.mark.usefixtures("run")
def test_a_drawing_that_ends_in_the_middle_is_told_so() -> None:
    pytest.importorskip("svgelements")
    whole = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0,0 10,0 10,10 z"/></svg>'
    for length in (len(whole) - 3, len(whole) - 20, 60):
        Path("drawn.svg").write_text(whole[:length], encoding="utf-8")
        with pytest.raises(WrongInput, match="ends in the middle; the whole file is right"):
            design_of(read_yaml(DRAWN, "mine.yaml"), DRAWN, Path("mine.yaml"))


RADIUS = CHAIN.replace("ratio: 1 + 0.2*cos(phi)", "idler_radius: 40 + 8*abs(cos(phi))**0.7")
OVERLAPPING = CHAIN.replace("ratio:", "bends_deg: [119]\n  ratio:")
SERIES = """\
name: series
operation: {speed_rpm: SPEED}
motion: {law: ratio_expression, ratio: 1 + 0.3*cos(phi), scale_to_close: true}
gears: {pairs: PAIRS, teeth: 36, module_mm: 2, face_width_mm: 12, backlash_mm: 0.1, material: 18CrNiMo7-6}
masses: {shaft_kg_mm2: 20000}
resistance: {polynomial_n_m: [12]}
"""


def series(speed_rpm: int, pairs: int) -> str:
    return SERIES.replace("SPEED", str(speed_rpm)).replace("PAIRS", str(pairs))


@pytest.mark.usefixtures("run")
@at_once(
    ("text", "key"),
    [
        (RADIUS, "train.idler_radius"),
        (CHAIN.replace("1 + 0.2*cos(phi)", "1 + 0.2*abs(cos(phi))**0.7"), "train.ratio"),
        (
            CARRIED.replace("module_mm: 2", "module_mm: 2, bore_mm: 12").replace(
                "arm_mm", "bar_width_mm: 15\n  arm_mm"
            ),
            "train.gears.bore_mm",
        ),
    ],
)
def test_a_fault_of_a_train_is_told_where_it_is_given(text: str, key: str) -> None:
    with pytest.raises(DesignError) as refused:
        load_train(written(text)).file.train.train()
    assert refused.value.key == key


@pytest.mark.usefixtures("run")
def test_a_pair_has_no_shaft_between_and_series_have_one_less_than_pairs() -> None:
    for pairs, given, said in ((1, "7", "given, but there is no shaft between one pair of gears"), (3, "[7, 7]", "")):
        text = series(60, pairs).replace("20000", f"20000, shaft_between_kg_mm2: {given}")
        if said:
            with pytest.raises(WrongInput, match=said):
                load(written(text))
        else:
            load(written(text))


def test_a_check_judges_the_room_between_parts(run: Run) -> None:
    """Round gears of 24 teeth at a bend of 140 deg overlap everywhere; the row of the file at some angles only."""
    assert "room: gear_1 and gear_3 meet at" in run("check", str(written(OVERLAPPING)))[1]
    row = "gears: {teeth: 24, module_mm: 2, face_width_mm: 12, idlers: {lobes: [1], bends_deg: [140]}}\n"
    machine = f"name: row\noperation: {{speed_rpm: 60}}\nmotion: {{law: uniform_crank}}\n{row}"
    assert "gears 1 and 3 of the row overlap at every angle" in run("check", str(written(machine)))[1]


@pytest.mark.usefixtures("run")
def test_loads_of_rows_have_the_keys_of_their_file() -> None:
    assert Drive(load(written(CHAIN)).design).masses_left_out == "give them as train.masses"
    assert Drive(
        load(written(series(60, 1).replace("masses: {shaft_kg_mm2: 20000}\n", ""))).design
    ).masses_left_out == ("give them as masses")


def test_a_check_leaves_knocks_of_pairs_in_series_to_the_teeth() -> None:
    """At ten times the speed the load of four pairs changes flanks."""
    for speed, knocks in ((60, False), (600, True)):
        drive = Drive(load(written(series(speed, 4))).design)
        states = {row.why for row in judged(drive.by_stage[0], KnownParts.MOTION).rows if row.kind is Kind.STRENGTH}
        assert ("it needs the teeth to tell how hard pairs in series knock" in states) is knocks
    assert holding_words(wears=False, judged=True) == "The teeth hold: no safety is under the wanted one."
    assert "hold" not in holding_words(wears=False, judged=False)


def test_forces_of_many_pairs_are_told_in_their_order() -> None:
    """A key for each mesh and shaft: the last mesh has no number, the driving shaft's bearing bears the first mesh."""
    keys = "mesh", "first_mesh", "second_mesh", "driving_bearing", "first_shaft_between_bearing", "driven_shaft_bearing"
    own = {f"peak_{key}_force_n": float(value) for value, key in enumerate(keys, start=1)}
    rows = {row.name: row.texts for row in _compared(own, own, 3)}
    assert rows == {
        "mesh forces": ("at most 2 N, 3 N, 1 N, from the driving shaft on",),
        "bearing forces": ("at most 4 N, 5 N, 6 N, from the driving shaft on",),
    }
    assert len(_compared(own, own, 2)) == len(own) - 1


def test_keys_of_forces_have_letters_only() -> None:
    for entry in MECHANISMS.values():
        force: Any = Extremum(1.0, 0.0)
        mechanism = entry.load()
        peaks: Any = SimpleNamespace(
            joints_n=dict.fromkeys(mechanism.JOINTS, force), mesh=None, crank_bearing_n=force, guide_n=force
        )
        assert all(re.fullmatch(r"[a-z_]+", key) for key in force_figures(mechanism, peaks))


def test_an_open_bracket_of_a_wish_has_no_line_of_a_file() -> None:
    with pytest.raises(WrongInput, match="a bracket is not closed") as refused:
        wishes_told(["time_ratio: {at_least: 1.5"])
    assert (refused.value.key, refused.value.location) == ("--wish", "")


def test_keys_beside_a_key_are_those_of_its_kind_of_train() -> None:
    text = told(told_keys("train"), "train.lobes")
    assert "bends_deg" in text
    assert "planet_teeth" not in text
