"""What a person sees in the studio, as its page is told it: beginnings, handles, figures, units; without a browser."""

from __future__ import annotations

import re
from math import log, pi
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest

from drives import DESIGNS, drive, drive_of_text, loaded
from ncgear.design.laws.ratio_expression import numbers_of
from ncgear.design.reading.design_file import parsed
from ncgear.design.reading.yaml import read_yaml
from ncgear.drawings.page.chart_svg import TEXT_SIZE, drawn
from ncgear.drawings.page.motion_charts import motion_charts
from ncgear.drawings.scene.scene import scene_without_gears
from ncgear.drawings.scene.standing import hatches_mm, walls_mm
from ncgear.errors import WrongInput
from ncgear.figures.numbers import shown
from ncgear.project.drive import Drive
from ncgear.studio import told
from ncgear.studio.editing import edited
from ncgear.studio.form import form
from ncgear.studio.handles import MOST_TAKEN_ALONG, handles
from ncgear.studio.page import GROUPS, SHIPPED, begin, beginnings, start_page
from ncgear.studio.server import zipped
from ncgear.studio.told import CHART, facts, safety_facts

Handle = dict[str, Any]
README = (DESIGNS.parent / "README.md").read_text(encoding="utf-8")


# --- beginnings


def test_there_are_choices_of_all_five_kinds_and_each_is_one() -> None:
    found = beginnings()
    assert list(dict.fromkeys(one.group for one in found)) == list(GROUPS)
    assert len({one.key for one in found}) == len(found)
    content, policy = start_page("FOLDER <b>")
    assert all(f'value="{one.key}"' in content for one in found)
    assert "FOLDER &lt;b&gt;" in content
    assert "script-src" not in policy


OWN = [one for one in beginnings() if one.group != GROUPS[-1]]


@pytest.mark.tiers(quick=["a-wish/linger"], slow=["a-shape/ellipse", "a-machine/pusher"], rest="long")
@pytest.mark.parametrize("key", [one.key for one in OWN])
def test_every_choice_is_a_design_with_a_motion_and_gears(key: str) -> None:
    chosen = next(one for one in OWN if one.key == key)
    made = Drive(parsed(chosen.text("mine"), Path("mine.yaml")).design)
    assert made.design.name == "mine"
    alone = key.startswith("a-shape") or key.endswith(("expression", "generator", "harmonic-ratio"))
    assert ("linkage" in read_yaml(chosen.text("mine"), "mine").data) is not alone
    assert made.check.peak_speed.value > 0.0
    assert made.pitch.size.driving_teeth > 0


@pytest.mark.slow
def test_a_worked_design_is_copied_with_its_points_and_no_file_is_written_over(tmp_path: Path) -> None:
    assert SHIPPED == DESIGNS
    (tmp_path / "traced-egg.yaml").write_text("mine", encoding="utf-8")
    path = begin("a-worked-design/traced-egg", tmp_path)
    assert path.name == "traced-egg-2.yaml"
    made = Drive(parsed(path.read_text(encoding="utf-8"), path).design)
    assert made.design.name == "traced-egg-2"
    angles = np.linspace(0.0, 6.0, 9)
    assert np.array_equal(ratio_at(made, angles), ratio_at(drive("traced-egg"), angles))
    assert (tmp_path / "traced-egg.yaml").read_text(encoding="utf-8") == "mine"


def test_what_is_no_choice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WrongInput, match="one of the choices"):
        begin("../baler", tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_zip_has_the_files_of_a_folder_and_no_hidden_ones(tmp_path: Path) -> None:
    folder = tmp_path / "made"
    (folder / "in").mkdir(parents=True)
    (folder / "in" / "a.txt").write_text("a", encoding="utf-8")
    (folder / ".hidden").write_text("secret", encoding="utf-8")
    (folder / "link").symlink_to(tmp_path / "other")
    (tmp_path / "made.zip").write_bytes(zipped(folder))
    with ZipFile(tmp_path / "made.zip") as made:
        assert {name: made.read(name) for name in made.namelist()} == {"made/in/a.txt": b"a"}


# --- figures


def test_the_peaks_stand_beside_those_of_the_crank() -> None:
    made = drive("pusher")
    own, crank = made.check.peak_power_w.value, made.uniform_check.peak_power_w.value
    assert facts(made)[0] == [
        "peak power", f"{shown(own)} W", f"{shown(crank)} W", f"{100.0 * (1.0 - own / crank):.1f} % lower"
    ]  # fmt: skip
    names = [name for name, *_ in facts(made)]
    assert len(set(names)) == len(names)
    assert {"law", "stroke", "speed"} <= set(names)


@pytest.mark.slow
def test_the_safeties_are_those_of_the_readme() -> None:
    """README.md tells them of the same design, by another command."""
    told_there = re.search(r"safety +([\d.]+) against breakage .*, ([\d.]+) against pitting", README)
    assert told_there is not None
    assert safety_facts(drive("pusher").by_stage) == [
        ("safety against breakage, 1.4 wanted", told_there[1]),
        ("safety against pitting, 1 wanted", told_there[2]),
    ]
    assert safety_facts(drive("ellipse").by_stage) == []


@pytest.mark.slow
def test_the_best_law_says_what_it_would_save() -> None:
    """``ncgear optimize designs/pusher.yaml`` certifies 481.78 mm/s2; the design has 1197.7."""
    pytest.importorskip("clarabel", reason="the optimiser is not installed")
    found = told.saved(loaded("pusher").design)
    assert found == {
        "words": "acceleration up to 59.8 % lower",
        "in_full": "acceleration: 1198 now, no law below 481.8 mm/s2",
    }
    assert told.saved(loaded("oval-flow-meter").design) is None


# --- units, hints and text in full


def rows_of(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [one for row in rows for one in ([*rows_of(row["rows"])] if "rows" in row else [row])]


def test_units_and_hints_stand_whole_in_their_fields() -> None:
    rows = rows_of(form(read_yaml((DESIGNS / "baler-dynamics.yaml").read_text(encoding="utf-8"), "d").data))
    units = {row["path"]: row["unit"] for row in rows}
    assert units["masses.driving_gear_kg_mm2"] == "kg mm\u00b2"
    assert not [unit for unit in units.values() if re.search(r"[a-z][23]\b", unit)]
    plain = [row for row in rows if "hint" in row]
    # Five letters to 30 pixels: as much as the narrowest field holds, one of a word.
    assert max(len(row["hint"]) for row in plain) <= 18
    assert {row["hint"] for row in plain if row["needed"] and row["default"].startswith("none")} == {"needed"}
    css = Path(told.__file__).with_name("web").joinpath("studio.css").read_text(encoding="utf-8")
    assert "ellipsis" not in css


def test_text_of_charts_has_eleven_pixels_in_the_narrowest_column() -> None:
    made = drive("pusher")
    figure = drawn(motion_charts(made, made.transmission.cycle_rad)[0], CHART)
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', figure.drawing)
    assert size is not None
    assert (float(size[1]), float(size[2])) == CHART
    assert TEXT_SIZE >= 11.0
    css = Path(told.__file__).with_name("web").joinpath("studio.css").read_text(encoding="utf-8")
    least = re.search(r"\.studio \.charts \{[^}]*min\(100%, ([\d.]+)rem\)", css)
    padding = re.search(r"\.studio \.chart \{ padding: [\d.]+rem ([\d.]+)rem", css)
    assert least is not None
    assert padding is not None
    # A rem of 16 pixels, padding and a line of a pixel on both sides.
    assert 16.0 * float(least[1]) - 2.0 * (16.0 * float(padding[1]) + 1.0) >= CHART[0]


# --- handles


def dragged(handle: Handle, grown: float) -> dict[str, Any]:
    """The changes that the page makes where a handle's value grows by a factor, as handles.js does."""
    move = handle["moves"]["y"]
    value = move["base"] * grown
    changes = {}
    if move["key"]:
        changes[move["key"]] = f"{value:.12g}".join(move["text"]) if "text" in move else value
    for one in move.get("along", []):
        if "power" in one:
            changes[one["key"]] = one["base"] * grown ** one["power"]
        elif "log" in one:
            changes[one["key"]] = [b + by * log(grown) for b, by in zip(one["base"], one["log"], strict=True)]
        else:
            changes[one["key"]] = one["base"] + one["sum"] * (value - move["base"])
    return changes


def after(name: str, changes: dict[str, Any]) -> Drive:
    text = (DESIGNS / f"{name}.yaml").read_text(encoding="utf-8")
    return Drive(parsed(edited(text, changes), DESIGNS / f"{name}.yaml").design)


def ratio_at(made: Drive, phi1: np.ndarray) -> np.ndarray:
    values: np.ndarray = 1.0 / made.transmission.driven_angle(phi1, 1).derivative(1)
    return values


def test_handles_of_a_best_law_take_their_neighbours_along() -> None:
    """All dragged alike, every point goes alike; so no point is left behind."""
    found, count = handles(drive("baler-real")), len(loaded("baler-real").design.motion.ratio)
    assert count == 180
    own = [one["moves"]["y"]["key"] for one in found]
    shares = dict.fromkeys(own, 1.0)
    for one in found:
        along = one["moves"]["y"]["along"]
        assert len(along) <= MOST_TAKEN_ALONG
        assert not {other["key"] for other in along} & set(own)
        for other in along:
            shares[other["key"]] = shares.get(other["key"], 0.0) + other["power"]
    assert set(shares) == {f"motion.ratio.{place}" for place in range(count)}
    assert list(shares.values()) == pytest.approx([1.0] * count)
    apart = np.diff([one["x"] for one in found])
    assert apart.min() > 10.0


@pytest.mark.slow
def test_a_dragged_best_law_stays_smooth() -> None:
    before, number, grown = drive("baler-real"), 4, 1.05
    handle = handles(before)[number]
    made = after("baler-real", dragged(handle, grown))
    ratios = [np.log(one.design.motion.ratio) for one in (before, made)]
    change = ratios[1] - ratios[0]
    assert change.max() == pytest.approx(log(grown), rel=1e-4)
    place = int(handle["moves"]["y"]["key"].rpartition(".")[2])
    assert int(np.argmax(change)) == place
    # cos^2 over n steps has a second difference of at most (pi/n)^2/2 of its height.
    moved = np.nonzero(change)[0]
    steps = min(place - moved.min(), moved.max() - place) + 1
    assert np.abs(np.diff(change, 2)).max() <= 1.01 * log(grown) * (pi / steps) ** 2 / 2.0
    assert made.check.peak_speed.value > 0.0


@pytest.mark.parametrize("number", range(3))
def test_a_handle_of_harmonics_bends_the_series_where_it_stands(number: int) -> None:
    name = "printed-pump"
    before, grown = drive(name), 1.04
    found = handles(before)
    assert len(found) == 3
    assert found[number]["y"] == pytest.approx(ratio_at(before, np.radians([found[number]["x"]]))[0], rel=1e-9)
    made = after(name, dragged(found[number], grown))
    # The constant that closes the cycle moves the whole curve; against its mean the point goes as it was dragged.
    angles = 2.0 * pi * np.arange(720) / 720.0
    logs = [np.log(ratio_of_driven(one, angles)) for one in (before, made)]
    change = (logs[1] - logs[1].mean()) - (logs[0] - logs[0].mean())
    assert change[240 * number] == pytest.approx(log(grown), abs=1e-6)


def ratio_of_driven(made: Drive, phi2: np.ndarray) -> np.ndarray:
    """exp of the series, up to its constant: the definition in docs/design-file/motion-harmonic_ratio.md."""
    motion, total = made.design.motion, np.zeros_like(phi2)
    for k, value in enumerate(motion.cosine, 1):
        total += value * np.cos(k * phi2)
    for k, value in enumerate(motion.sine, 1):
        total += value * np.sin(k * phi2)
    return np.exp(total)


@pytest.mark.parametrize("name", ["desk-toy", "ellipse"])
def test_a_handle_of_a_number_moves_the_ratio_to_where_it_is_dragged(name: str) -> None:
    before = drive(name)
    (handle,) = handles(before)
    move, step = handle["moves"]["y"], 0.004
    grown = (move["base"] + move["factor"] * step) / move["base"]
    made = after(name, dragged(handle, grown))
    at = np.radians([handle["x"]])
    # To first order in the step.
    assert ratio_at(made, at)[0] - ratio_at(before, at)[0] == pytest.approx(step, rel=0.03)


def test_numbers_of_a_formula_are_those_that_can_be_turned() -> None:
    found = numbers_of("ratio", " 1.2 + 0.3*cos(2*phi - 0.5)**2/4 ")
    assert [one.value for one in found] == [1.2, 0.3, 0.5, 4.0]
    assert found[1].written(0.25) == "1.2 + 0.25*cos(2*phi - 0.5)**2/4"


# --- the machine as its own kind


CARTON = """
name: carton
linkage: {crank_mm: 50, rod_mm: 200}
operation: {speed_rpm: 30}
motion: {law: uniform_crank}
resistance: {table: {displacement_mm: [0, 30, 40, 100], force_n: [0, 0, 20, 20]}, shown_as: KIND}
"""


@pytest.mark.parametrize("kind", ["carton", "sheet"])
def test_what_is_pushed_goes_with_the_slider_along_a_table(kind: str) -> None:
    scene = scene_without_gears(drive_of_text(CARTON.replace("KIND", kind)))
    chamber, cycle = scene.chamber, scene.machine.transmission.cycle_rad
    assert chamber is not None
    assert chamber.begins_mm == pytest.approx(35.0, abs=0.1)
    poses = scene.poses(np.linspace(0.0, cycle, 200, endpoint=False))
    left, length = scene.strips_mm(poses)["material"]
    face = poses.places["slider"].origin_mm[:, 0] + chamber.face_mm
    assert np.ptp(length) == 0.0
    assert np.all(left >= face - 1e-9)
    pushing = (poses.motion.displacement > 35.1) & scene.machine.working(poses.motion.phi2_rad)
    assert left[pushing] == pytest.approx(face[pushing])
    assert left[poses.motion.displacement < 34.9].min() == pytest.approx(left.min(), abs=0.2)
    assert float((left + length).max()) == pytest.approx(chamber.end_mm)
    # A table below it, and no wall before it or over it.
    (table,) = walls_mm(scene)
    assert np.all(table[:, 1] == chamber.level_mm - chamber.material_height_mm / 2.0)
    assert hatches_mm(scene)[:, 0, 1].max() == table[0, 1]


def test_a_load_is_pressed_in_a_chamber_as_before() -> None:
    scene = scene_without_gears(drive_of_text(CARTON.replace("KIND", "load")))
    left, length = scene.strips_mm(scene.poses(np.linspace(0.0, 2.0, 9)))["material"]
    assert scene.chamber is not None
    assert left + length == pytest.approx(np.full(9, scene.chamber.end_mm))
    assert len(walls_mm(scene)[0]) == 4


def test_a_group_of_a_law_begins_with_the_example_that_the_law_has_of_it() -> None:
    (motion,) = (row for row in form({"motion": {"law": "pitch_curve"}}) if row["path"] == "motion")
    begun = {row["path"].partition(".")[2]: row.get("begin") for row in motion["rows"]}
    assert begun["dxf"] == {"file": "contour.dxf", "unit": "mm"}
    assert begun["rounded_polygon"] == {"sides": 4, "side_mm": 130, "corner_radius_mm": 25}
