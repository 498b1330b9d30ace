"""The drawing in the studio: what is dropped and dragged, and the nearest pair where its teeth are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="python -m pip install 'ncgear[studio]' installs the server")

from ncgear.design.reading.design_file import parsed
from ncgear.design.template import shape_template
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.project.drive import Drive
from ncgear.project.opened import loads
from ncgear.studio.drawing import drawing_of, nearest_pair, require_or_fit, with_dropped
from ncgear.studio.editing import edited
from scenes import in_a_browser
from studios import running

ROUND = b'<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="80mm"><circle cx="100" cy="-100" r="90"/></svg>'
CLEFT = (
    b'<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="80mm" viewBox="0 0 100 100"><path d="M50 30 '
    b'C50 10 10 10 10 40 C10 60 40 75 50 92 C60 75 90 60 90 40 C90 10 50 10 50 30 Z"/></svg>'
)
"""A heart with a cleft and a tip."""


def test_the_points_of_a_design_are_those_that_can_be_dragged() -> None:
    drive = loads(shape_template("mine", "heart"))
    ((name, content),) = drawing_of(drive)
    assert name == "drawing"
    assert content["axis"] == [0.0, 0.0]
    points = drive.design.motion.points
    assert content["points"] == np.column_stack([points.x_mm, points.y_mm]).tolist()
    moved = edited(shape_template("mine", "heart"), {"motion.points.x_mm.3": -20.5, "motion.points.y_mm.3": 53.25})
    ((_, after),) = drawing_of(loads(moved))
    assert after["points"][3] == [-20.5, 53.25]
    assert after["points"][:3] + after["points"][4:] == content["points"][:3] + content["points"][4:]


def test_points_of_a_file_come_into_the_design_when_one_is_dragged(tmp_path: Path) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    points = np.column_stack([30.0 * np.cos(turn), 20.0 * np.sin(turn)]).round(3)
    (tmp_path / "oval.csv").write_text("x_mm;y_mm\n" + "".join(f"{x};{y}\n" for x, y in points))
    head = "name: mine\noperation: {speed_rpm: 30}\nmotion:\n  law: pitch_curve\n"
    text = f"{head}  points: {{file: oval.csv, tolerance_mm: 0.1}}  # traced\n"
    ((_, content),) = drawing_of(Drive(parsed(text, tmp_path / "mine.yaml").design))
    assert content["of_file"]
    assert content["points"] == points.tolist()
    points[3] += 0.5
    lists = {f"motion.points.{name}": column.tolist() for name, column in zip(("x_mm", "y_mm"), points.T, strict=True)}
    moved = edited(text, {"motion.points.file": None, **lists})
    assert "# traced" in moved
    ((_, after),) = drawing_of(loads(moved))
    assert not after["of_file"]
    assert after["points"] == points.tolist()


@pytest.mark.thorough
def test_a_dropped_file_stands_beside_the_design_and_nothing_is_written_over(tmp_path: Path) -> None:
    pytest.importorskip("svgelements")
    text, design = shape_template("mine", "heart"), tmp_path / "mine.yaml"
    (tmp_path / "round.svg").write_text("another")
    changed, name = with_dropped(text, design, "C:\\drawings\\round.svg", ROUND)
    assert name == "round-2.svg"
    assert (tmp_path / "round.svg").read_text() == "another"
    assert (tmp_path / name).read_bytes() == ROUND
    # A circle about its own middle of 80 mm by 25.4/96 a pixel.
    ((_, content),) = drawing_of(Drive(parsed(changed, design).design))
    radii = np.hypot(*(np.array(content["outline"]) - np.mean(content["outline"], axis=0)).T)
    assert radii == pytest.approx(90.0 * 25.4 / 96.0, abs=0.05)
    # The same again is the same file.
    assert with_dropped(text, design, "round.svg", ROUND)[1] == name
    before = set(tmp_path.iterdir())
    for wrong in ("moon.exe", "../.hidden.svg", "bad.svg"):
        with pytest.raises(WrongInput):
            with_dropped(text, design, wrong, b"no drawing")
    assert set(tmp_path.iterdir()) == before


@pytest.mark.slow
def test_a_drawing_without_teeth_has_its_nearest_pair_which_can_be_made(tmp_path: Path) -> None:
    pytest.importorskip("svgelements")
    design = tmp_path / "mine.yaml"
    changed, _ = with_dropped(shape_template("mine", "heart"), design, "cleft.svg", CLEFT)
    drive = Drive(parsed(changed, design).design)
    answers = require_or_fit(drive)
    name, content = next(answers)
    assert name == "fitted"
    with pytest.raises(NoSuchMechanism):
        next(answers)
    taken = Drive(parsed(edited(changed, content["changes"]), design).design)
    taken.require_sound_teeth()
    assert list(nearest_pair(loads("name: c\noperation: {speed_rpm: 9}\nmotion: {law: uniform_crank}"))) == []


HEART = 48
"""Points of our heart."""


@pytest.mark.slow
@in_a_browser
def test_a_point_is_dragged_and_a_file_is_dropped_in_the_browser(browser: Any, tmp_path: Path) -> None:
    pytest.importorskip("svgelements")
    path = tmp_path / "heart.yaml"
    path.write_text(shape_template("heart", "heart"), encoding="utf-8")
    with running(path, tmp_path / "export") as studio:
        page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
        page.set_default_timeout(120_000)
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(studio.address)
        dots = page.locator("#drawing circle")
        dots.nth(HEART - 1).wait_for()
        before = parsed(page.locator("#text").input_value(), path).design.motion.points
        dot = dots.nth(3)
        dot.scroll_into_view_if_needed()
        box = dot.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        per_mm = page.evaluate("document.querySelector('#drawing svg').getScreenCTM().a")
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x - 10, y - 5, steps=4)
        page.mouse.up()
        page.wait_for_function("() => document.getElementById('saved').textContent === 'not saved'")
        after = parsed(page.locator("#text").input_value(), path).design.motion.points
        step = np.array([-10.0, 5.0]) / per_mm
        moved = np.column_stack([after.x_mm, after.y_mm]) - np.column_stack([before.x_mm, before.y_mm])
        assert moved[3] == pytest.approx(step, abs=0.02)
        assert moved[4] == pytest.approx(step * np.cos(np.pi / 8.0) ** 2, abs=0.02)
        assert np.count_nonzero(np.abs(moved).max(axis=1) > 0.02) == 7
        drop = """([name, text]) => {
          const data = new DataTransfer();
          data.items.add(new File([text], name));
          document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
        }"""
        page.evaluate(drop, ["cleft.svg", CLEFT.decode()])
        page.wait_for_function("() => document.getElementById('said').textContent.includes('cleft.svg stands')")
        assert "cleft.svg" in page.locator("#text").input_value()
        assert (tmp_path / "cleft.svg").read_bytes() == CLEFT
        # No tooth rolls in a cleft: the nearest pair is offered, and taken.
        # It is sought at a low priority, which waits for all else that the computer does
        page.locator("#nearest button").click(timeout=400_000)
        page.wait_for_function("() => document.getElementById('text').value.includes('b_spline')")
        page.evaluate(drop, ["moon.exe", "x"])
        page.wait_for_function("() => document.getElementById('said').textContent.includes('a file that ends in')")
        assert errors == []
