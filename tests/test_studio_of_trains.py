"""Train files in the studio: the picture moves as the poses, the page tells what ``check`` tells, faults are placed."""

from __future__ import annotations

import json
import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from commands import Run
from drives import DESIGNS, train_of
from ncgear.design.reading.design_file import load_train
from ncgear.studio.editing import ChangingText
from ncgear.studio.form import form
from ncgear.studio.messages import guarded
from ncgear.studio.worker import CHAINS, answers_of
from scenes import in_a_browser
from studios import running
from test_studio_in_browser import Opened

TRAINS = ["idler-chain", "lobed-motor", "moving-axis"]


def answers(text: str, changes: dict[str, Any] | None = None) -> dict[str, Any]:
    """All answers of all chains; a train has each once."""
    followed, path = ChangingText(), DESIGNS / "train.yaml"
    found = [
        answer
        for chain in CHAINS
        for answer in guarded(answers_of(chain), lambda: followed.made(text, changes or {}, path))
    ]
    assert len({name for name, _ in found} - {"refused"}) == sum(name != "refused" for name, _ in found)
    return json.loads(json.dumps(dict(found), allow_nan=False))  # type: ignore[no-any-return]


@cache
def told(name: str) -> dict[str, Any]:
    """All answers for a file of designs/."""
    return answers((DESIGNS / f"{name}.yaml").read_text())


def at(table: dict[str, Any], angle: float) -> float:
    """Hermite's cubic of a table as the page computes it."""
    places, values, slopes = (np.array(table[key]) for key in ("at", "value", "slope"))
    step = min(int(np.searchsorted(places, angle, side="right")) - 1, places.size - 2)
    width = places[step + 1] - places[step]
    share = (angle - places[step]) / width
    basis = [2 * share**3 - 3 * share**2 + 1, share**3 - 2 * share**2 + share, 3 * share**2 - 2 * share**3]
    first, second = values[step], values[step + 1]
    end = (share**3 - share**2) * width * slopes[step + 1]
    return float(basis[0] * first + basis[1] * width * slopes[step] + basis[2] * second + end)


@at_once("name", TRAINS)
def test_the_picture_moves_as_the_poses_of_the_train(name: str) -> None:
    train, scene = train_of(name), told(name)["scene"]
    data, size = scene["data"], max(scene["data"]["views"]["machine"][2:])
    assert data["loop"] == pytest.approx(train.cycle_rad)
    assert scene["svg"].count('<g id="scene-part-') == len(train.parts) == len(data["linkage"]["links"])
    for angle in np.array([0.0, 0.1234, 0.5678, 0.987]) * train.cycle_rad:
        poses = train.poses_at(np.array([angle]))
        for number in range(len(train.parts)):
            tables = data["linkage"]["links"][f"part-{number}"]
            assert at(tables["angle"], angle) == pytest.approx(poses.angle_rad[number, 0], abs=3e-5)
            for key, values in (("x", poses.x_mm), ("y", poses.y_mm)):
                assert at(tables[key], angle) == pytest.approx(values[number, 0], abs=3e-5 * size)
    # All parts stay within the picture.
    left, bottom, width, height = data["views"]["machine"]
    for angle in np.linspace(0.0, train.cycle_rad, 13):
        poses = train.poses_at(np.array([angle]))
        for number, part in enumerate(train.parts):
            (axis,), (turn,) = poses.places(number)
            placed = axis + turn * (part.outline_mm @ np.array([1.0, 1.0j]))
            assert left < placed.real.min() < placed.real.max() < left + width
            assert bottom < placed.imag.min() < placed.imag.max() < bottom + height


@at_once("name", TRAINS)
def test_the_page_tells_what_a_check_tells(name: str, run: Run) -> None:
    answered = told(name)
    said = "".join(run("check", str(DESIGNS / f"{name}.yaml"))[1].split())
    for row, text in answered["figures"]["facts"][1:]:
        assert "".join(f"{row}{text}".replace("\N{DEGREE SIGN}", " deg").replace("³", "3").split()) in said, row
    assert answered["verdict"]["good"] == "No warnings of what was judged."
    assert answered["motion"]["loop"] > 0.0
    assert "refused" not in answered


def test_a_value_that_is_not_right_is_refused_at_its_place() -> None:
    text = (DESIGNS / "idler-chain.yaml").read_text()
    line = next(number for number, one in enumerate(text.splitlines(), 1) if "teeth:" in one)
    refused = answers(text, {"train.gears.teeth": 5})["refused"]
    assert (refused["key"], refused["line"], refused["wrong_input"]) == ("train.gears.teeth", line, True)
    kind = answers(text, {"train.kind": "lobed"})["refused"]
    assert kind["key"] == "train.kind"
    wide = answers(text, {"train.gears.bore_mm": 90})["refused"]
    assert (wide["key"], wide["after"]) == ("train.gears.bore_mm", "design")


def test_the_form_has_the_keys_of_the_kind_that_is_named() -> None:
    def paths(kind: str) -> set[str]:
        train = form({"name": "x", "train": {"kind": kind}})[-1]
        return {row["path"] for row in train["rows"]}

    assert "train.lobes" in paths("chain") - paths("planetary")
    assert "train.arms" in paths("planetary") - paths("chain")
    assert paths("unknown") == paths("planetary")


@pytest.mark.slow
@in_a_browser
def test_a_train_is_seen_changed_refused_and_saved(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "idler-chain.yaml"
    shutil.copy(DESIGNS / path.name, path)
    with running(path, tmp_path / "export") as studio:
        opened = Opened(browser, studio)
        page = opened.page
        assert opened.fact("gears") == "36, 36, 36, 36 teeth, module 2 mm"
        assert page.locator("svg.scene g.body").count() == 4
        assert page.locator("input[name=view]:visible").count() <= 1
        assert [page.locator(f"[data-run={one}]").first.is_visible() for one in ("build", "report")] == [True, True]
        assert (
            not page.locator("#best, [data-run=design], [data-run=frontier], #curves > .hint")
            .locator("visible=true")
            .count()
        )
        page.evaluate("ncgear.show(1.234)")
        poses = load_train(path).file.train.train().poses_at(np.array([1.234]))
        for number in range(4):
            placed = (
                page.locator(f"#scene-part-{number}").get_attribute("transform").replace("(", " ").replace(")", " ")
            )
            x, y, angle = (float(placed.split()[place]) for place in (1, 2, 4))
            assert (x, y) == pytest.approx((poses.x_mm[number, 0], poses.y_mm[number, 0]), abs=1e-3)
            assert np.radians(angle) == pytest.approx(poses.angle_rad[number, 0], abs=1e-4)
        opened.set("train.gears.teeth", "40")
        assert opened.fact("gears") == "40, 40, 40, 40 teeth, module 2 mm"
        assert page.locator("#refusals .refusal").count() == 0
        opened.set("train.gears.bore_mm", "90")
        assert "train.gears.bore_mm: 90 mm leaves less than 2 mm, one module" in page.locator("#refusals").inner_text()
        opened.step(lambda: page.locator("#undo").click())
        assert page.locator("#refusals .refusal").count() == 0
        page.screenshot(path=tmp_path / "train.png")
        opened.step(lambda: page.locator("#save").click())
        saved = path.read_text()
        assert saved == (DESIGNS / path.name).read_text().replace("teeth: 36", "teeth: 40")
        page.locator("button[data-run=build]").click()
        page.wait_for_selector("#jobs a[href*='assembly.json']", state="attached")
        assert (tmp_path / "export" / "idler-chain" / "assembly.json").exists()
        assert opened.errors == []
        page.context.close()
