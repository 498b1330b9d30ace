"""The studio in a browser: points are dragged, values turned, designs compared and saved, by pointer and keyboard."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest

from commands import fresh
from drives import DESIGNS, MACHINES
from ncgear.design.reading.design_file import parsed
from ncgear.drawings.charts.chart import Quantity
from ncgear.project.drive import Drive
from ncgear.studio.drafts import DRAFT
from scenes import in_a_browser
from studios import Studio, running

pytestmark = [pytest.mark.slow, in_a_browser]

WIDE, PHONE = {"width": 1440, "height": 900}, {"width": 390, "height": 844}
LONGEST_MS = 120_000


@contextmanager
def studio_of(name: str, folder: Path) -> Iterator[Studio]:
    path = folder / f"{name}.yaml"
    shutil.copy(DESIGNS / path.name, path)
    with running(path, folder / "export") as made:
        yield made


def as_begun(studio: Studio) -> Studio:
    """A studio that others have used, with its file as it was: a page that is opened then knows of no other one."""
    shutil.copy(DESIGNS / studio.path.name, studio.path)
    for draft in studio.path.parent.glob(f"*{DRAFT}*"):
        draft.unlink()
    shutil.rmtree(studio.out, ignore_errors=True)
    return studio


@pytest.fixture(scope="module")
def baler_86(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """To begin takes several seconds, which the tests of this file need not take each."""
    with studio_of("baler-86", tmp_path_factory.mktemp("baler-86")) as made:
        yield made


@pytest.fixture
def studio(baler_86: Studio) -> Studio:
    return as_begun(baler_86)


class Opened:
    """A page of a studio; it must never say a fault."""

    def __init__(self, browser: Any, studio: Studio, before: str = "", **context: Any) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.studio = studio
        self.page = browser.new_context(**{"viewport": WIDE, **context}).new_page()
        self.page.set_default_timeout(LONGEST_MS)
        self.page.add_init_script(before)
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("console", lambda message: self.errors.append(message.text) if message.type == "error" else None)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(studio.address)
        self.page.wait_for_selector("body[data-asked]")
        self.settled()

    def settled(self) -> None:
        """Wait until the text that is shown has all its answers."""
        asked = int(self.page.evaluate("document.body.dataset.asked"))
        self.page.wait_for_function(
            "n => ['Gears', 'Motion', 'Contact'].every((one) => Number(document.body.dataset[`done${one}`]) >= n)",
            arg=asked,
        )

    def step(self, act: Any) -> None:
        """Do what makes one step of the history, and wait for its answers."""
        before = int(self.page.evaluate("document.body.dataset.asked"))
        act()
        self.page.wait_for_function("n => Number(document.body.dataset.asked) > n", arg=before)
        self.settled()

    @property
    def text(self) -> str:
        return str(self.page.locator("#text").input_value())

    @property
    def drive(self) -> Drive:
        """The text as Python computes it."""
        return Drive(parsed(self.text, self.studio.path).design)

    def fact(self, name: str) -> str:
        return str(self.page.locator(f"#facts tr:has(th:text-is('{name}')) td").first.inner_text())

    def set(self, key: str, value: str) -> None:
        field = self.page.locator(f"#key-{key}".replace(".", "\\."))
        self.step(lambda: (field.fill(value), field.press("Enter")))


@pytest.fixture
def opened(browser: Any, studio: Studio) -> Iterator[Opened]:
    made = Opened(browser, studio)
    yield made
    assert made.errors == []
    outside = [url for url in made.requests if not url.startswith((f"http://127.0.0.1:{studio.port}/", "data:"))]
    assert outside == []
    made.page.context.close()


def lines_agree(opened: Opened) -> None:
    """The lines on the page are those that Python computes of the text on the page."""
    motion, drive = opened.page.evaluate("ncgear.motion()"), opened.drive
    for chart in motion["charts"]:
        own = next(line for line in chart["lines"] if line["role"] == "own")
        quantity = next(one for one in Quantity if one.key_of(drive.linkage.OUTPUT) == chart["key"])
        values = quantity.values(drive.machine.motion(np.radians(own["x"])), drive.linkage.OUTPUT)
        # Angles have four decimals of a degree, so beside a jump they may lie on its other side.
        assert (np.abs(np.array(own["y"]) - values) <= 1e-3 * np.abs(values).max()).mean() > 0.98, chart["key"]


def test_a_point_that_is_dragged_moves_the_law_as_python_computes_it(opened: Opened) -> None:
    page = opened.page
    dot = page.locator(".chart[data-key^=velocity] .handles circle").nth(1)
    assert dot.get_attribute("aria-label") == "theta2, v2"
    assert page.locator(".chart[data-key^=velocity] .handles .told").text_content() == ""
    dot.hover()
    assert page.locator(".chart[data-key^=velocity] .handles .told").text_content() == "theta2, v2: 0.7 pi, 1100 mm/s"
    before = float(parsed(opened.text, opened.studio.path).data["motion"]["theta2_pi"])
    chart = page.evaluate("ncgear.chart('velocity_mm_s')")
    dot.scroll_into_view_if_needed()
    box, svg = dot.bounding_box(), page.locator(".chart[data-key^=velocity] svg").bounding_box()
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0

    def drag() -> None:
        page.mouse.move(x, y)
        page.mouse.down()
        for step in range(1, 11):
            page.mouse.move(x + 0.8 * step, y)
            page.wait_for_timeout(20)
        page.mouse.up()

    opened.step(drag)
    after = float(parsed(opened.text, opened.studio.path).data["motion"]["theta2_pi"])
    assert after == float(f"{after:.3g}")
    # Eight pixels on the scale of the chart, whose unit is a 280th of its width.
    degrees = 8.0 * 280.0 / svg["width"] * 360.0 / (chart["x"][1] - chart["x"][0])
    assert after - before == pytest.approx(degrees / 180.0, abs=0.004)
    lines_agree(opened)
    assert opened.page.evaluate("ncgear.drivenAngle(2.0)") == pytest.approx(
        float(opened.drive.transmission.driven_angle(np.array([2.0])).value[0]), abs=1e-6
    )
    page.locator("#undo").click()
    page.wait_for_function("() => document.getElementById('saved').textContent === 'saved'")


def test_a_point_that_is_dragged_away_and_back_leaves_the_design_as_it_was(opened: Opened) -> None:
    page, before = opened.page, opened.text
    dot = page.locator(".chart[data-key^=velocity] .handles circle").nth(1)
    dot.scroll_into_view_if_needed()
    box, asked = dot.bounding_box(), int(page.evaluate("document.body.dataset.asked"))
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    page.mouse.move(x, y)
    page.mouse.down()
    # Over theta1, where there is no such stroke; what is told of that may take room above the chart.
    for step in (*range(0, -90, -10), *range(-90, 1, 10)):
        page.mouse.move(x + step, y)
        page.wait_for_timeout(40)
        if step == -90:
            page.locator(".refusal").wait_for()
    page.mouse.up()
    page.wait_for_function("n => Number(document.body.dataset.asked) > n", arg=asked)
    opened.settled()
    page.locator(".refusal").wait_for(state="detached")
    assert opened.text == before
    assert page.locator("#saved").inner_text() == "saved"


@pytest.mark.long
def test_five_hundred_quick_changes_leave_the_last_one_shown(browser: Any, tmp_path: Path) -> None:
    with studio_of("baler-86", tmp_path) as studio:
        hundreds_of_changes(browser, studio)


def hundreds_of_changes(browser: Any, studio: Studio) -> None:
    opened = Opened(browser, studio)
    page = opened.page
    processes = studio.workers
    assert len(processes) == 2
    turn = """async ([from, count]) => {
      for (let i = 0; i < count; i += 1) {
        ncgear.send({ do: "change", changes: { "operation.speed_rpm": from + i / 10 } });
        await new Promise((done) => setTimeout(done, 4));
      }
      ncgear.send({ do: "keep" });
    }"""
    opened.step(lambda: page.evaluate(turn, [15.0, 100]))
    before = sum(map(memory_kb, [studio.process.pid, *processes]))
    opened.step(lambda: page.evaluate(turn, [20.0, 501]))
    assert opened.fact("speed") == "70 r/min"
    assert "speed_rpm: 70" in opened.text
    lines_agree(opened)
    assert studio.workers == processes
    after = sum(map(memory_kb, [studio.process.pid, *processes]))
    assert after < before + 60_000
    assert opened.errors == []
    page.context.close()


def memory_kb(process: int) -> int:
    """Memory of a process that lies in the computer's."""
    done = subprocess.run(["ps", "-o", "rss=", "-p", str(process)], capture_output=True, text=True, check=True)
    return int(done.stdout)


def test_what_is_saved_is_what_a_check_reads(opened: Opened) -> None:
    opened.set("operation.speed_rpm", "31")
    assert opened.page.locator("#saved").inner_text() == "not saved"
    assert "+operation: {speed_rpm: 31}" in opened.page.locator("#difference").text_content()
    opened.page.keyboard.press("Control+s")
    opened.page.wait_for_function("() => document.getElementById('saved').textContent === 'saved'")
    saved = opened.studio.path.read_text(encoding="utf-8")
    original = (DESIGNS / "baler-86.yaml").read_text(encoding="utf-8")
    assert saved == re.sub(r"speed_rpm: [\d.]+}", "speed_rpm: 31}", original, count=1)
    done = fresh("check", str(opened.studio.path), "--json")
    power = json.loads(done.stdout)["check"]["peak_power_w"]
    assert float(opened.fact("peak power").split()[0]) == pytest.approx(power, rel=1e-4)


def test_a_file_that_another_program_has_changed_is_shown_before_it_is_saved_over(opened: Opened) -> None:
    page, path = opened.page, opened.studio.path
    question = page.locator("#question")
    opened.set("operation.speed_rpm", "31")
    theirs = re.sub(r"speed_rpm: [\d.]+}", "speed_rpm: 44}", path.read_text(encoding="utf-8"), count=1)
    path.write_text(theirs, encoding="utf-8")
    page.keyboard.press("Control+s")
    question.wait_for()
    assert "changed by another program" in question.inner_text()
    assert "-operation: {speed_rpm: 44}\n+operation: {speed_rpm: 31}" in question.inner_text()
    question.locator("button:text-is('Not now')").click()
    assert not question.is_visible()
    assert path.read_text(encoding="utf-8") == theirs
    page.keyboard.press("Control+s")
    question.locator("button:text-is('Save over it')").click()
    page.wait_for_function("() => document.getElementById('saved').textContent === 'saved'")
    assert not question.is_visible()
    assert "speed_rpm: 31}" in path.read_text(encoding="utf-8")


def test_what_does_not_exist_is_told_and_the_last_machine_stays_behind_it(opened: Opened) -> None:
    page = opened.page
    opened.set("gears.teeth", "3")
    # Of teeth so large neither the contact nor the bore is right; each is told once.
    told = page.locator(".refusal").all_inner_texts()
    assert len(set(told)) == len(told) <= 2
    assert page.locator("#stage.pale svg.scene").count() == 1
    assert "gears." in told[0]
    page.locator(".refusal button").first.click()
    assert page.evaluate("document.activeElement.id").startswith("key-gears.")
    while page.locator("#undo").is_enabled():
        opened.step(page.locator("#undo").click)
    assert page.locator(".refusal").count() == 0
    assert page.locator("#stage.pale").count() == 0


def test_a_design_is_kept_and_compared(opened: Opened) -> None:
    page = opened.page
    before = opened.fact("peak acceleration")
    page.locator("#hold").click()
    opened.set("operation.speed_rpm", "40")
    assert page.locator("#held-stage svg.scene").is_visible()
    cells = page.locator("#facts tr:has(th:text-is('peak acceleration')) td").all_inner_texts()
    assert cells[1] == before
    # Speeds of 40 for 20 r/min: four times the acceleration.
    assert cells[2] == "+300 %"
    assert page.locator("#legend").inner_text().split("\n") == ["now", "kept", "uniform crank"]
    assert page.locator("g.held path").count() >= 4
    page.evaluate("ncgear.show(1.0)")
    poses = page.evaluate("[...document.querySelectorAll('g#scene-crank')].map((one) => one.getAttribute('transform'))")
    assert len(poses) == 2
    assert poses[0] == poses[1]
    page.locator("#hold").click()
    assert not page.locator("#held-stage").is_visible()


def test_all_is_done_by_keyboard(opened: Opened) -> None:
    page = opened.page
    reached: dict[str, str] = {}
    page.evaluate("document.body.focus()")
    for _ in range(400):
        page.keyboard.press("Tab")
        place = page.evaluate(
            "(() => { const one = document.activeElement;"
            "return [one.id || one.dataset.run || one.dataset.handle || one.className || one.tagName,"
            "getComputedStyle(one).outlineStyle + getComputedStyle(one).strokeWidth]; })()"
        )
        reached[str(place[0])] = place[1]
    wanted = {"hold", "play", "scrub", "angle", "pace", "find", "key-gears.teeth", "build", "frontier", "nearer"}
    assert wanted <= set(reached)
    assert any("theta1_pi" in one for one in reached)
    page.locator(".handles circle").first.focus()
    before = opened.text
    opened.step(lambda: page.keyboard.press("ArrowLeft"))
    assert opened.text != before
    assert "theta1" in page.evaluate("document.activeElement.dataset.handle")
    opened.step(lambda: page.keyboard.press("Control+z"))
    assert opened.text == before


def test_all_has_names_for_a_screen_reader(opened: Opened) -> None:
    nameless = opened.page.evaluate(
        """[...document.querySelectorAll("button, input, select, textarea, summary, [role], svg.scene")]
          .filter((one) => !["alert", "status", "toolbar"].includes(one.getAttribute("role")))
          .filter((one) => one.checkVisibility())
          .filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim() ||
                             (one.labels && [...one.labels].some((label) => label.textContent.trim()))))
          .map((one) => one.outerHTML.slice(0, 120))"""
    )
    assert nameless == []
    slider = opened.page.locator("[role=slider]").first
    assert re.match(r"[\d.]+ pi, [\d.]+ mm/s", slider.get_attribute("aria-valuetext"))
    assert opened.page.locator("[role=alert]").count() == 1


SMALLEST_TEXT = """Math.min(...[...document.querySelectorAll(".plot svg text")].filter((one) => one.textContent)
  .map((one) => parseFloat(getComputedStyle(one).fontSize) * one.getScreenCTM().a))"""
"""Size in pixels of the smallest text of a chart as it is seen."""

CLIPPED = """[...document.querySelectorAll(".value, .value :is(.unit, label, textarea), #facts :is(td, th)")]
  .concat([...document.querySelectorAll(".tools button")])
  .filter((one) => one.checkVisibility() && one.scrollWidth > one.clientWidth + 1)
  .filter((one) => getComputedStyle(one).display !== "inline")
  .map((one) => one.outerHTML.slice(0, 120))"""
"""Texts that do not fit into their places."""

CUT = """(() => {
  const pen = document.createElement("canvas").getContext("2d");
  const fields = [...document.querySelectorAll(".value :is(input:not([type=checkbox]), select)")];
  return fields.filter((one) => one.checkVisibility()).map((one) => {
    const [style, isChoice] = [getComputedStyle(one), one.tagName === "SELECT"];
    const [text, hint] = isChoice ? [one.selectedOptions[0].textContent] : [one.value, one.placeholder];
    pen.font = text ? style.font : style.font.replace(/[\\d.]+px/, (size) => `${0.8 * parseFloat(size)}px`);
    // A browser keeps the place of an arrow beside a choice.
    const room = one.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - (isChoice ? 17 : 0);
    return [one.closest("[data-path]").dataset.path, text || hint, pen.measureText(text || hint).width, room];
  }).filter(([, , wide, room]) => wide > room);
})()"""
"""Values that are wider than the room of their fields, in the font of the field."""

OVER_EACH_OTHER = """[...document.querySelectorAll("#facts tr")].filter((row) => {
  const boxes = [...row.cells].map((cell) => {
    const inside = document.createRange();
    inside.selectNodeContents(cell);
    return inside.getBoundingClientRect();
  }).filter((box) => box.width);
  return boxes.some((a, i) => boxes.slice(i + 1).some((b) =>
    a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1));
}).map((row) => row.textContent)"""
"""Rows of figures whose texts lie over each other."""


TOLD_CUT = """[...document.querySelectorAll(".handles circle")].map((dot) => {
  dot.dispatchEvent(new PointerEvent("pointerenter"));
  const told = dot.parentNode.querySelector("text");
  const [text, whole] = [told.getBoundingClientRect(), dot.ownerSVGElement.getBoundingClientRect()];
  const said = told.textContent;
  dot.dispatchEvent(new PointerEvent("pointerleave"));
  return text.width > 20 && text.left > whole.left - 1 && text.right < whole.right + 1 ? "" : said || "nothing";
}).filter(Boolean)"""
"""What handles tell of their values, where it is not whole."""


@pytest.mark.tiers(slow=["baler-drivetrain"], rest="long")
@pytest.mark.parametrize("some", ["baler-drivetrain", "*"])
def test_no_value_of_any_design_is_cut(browser: Any, studio: Studio, some: str) -> None:
    opened = Opened(browser, studio)
    page = opened.page
    for path in [MACHINES[some]] if some in MACHINES else MACHINES.values():
        before = int(page.evaluate("document.body.dataset.asked"))
        page.evaluate("text => ncgear.send({ do: 'text', text })", path.read_text(encoding="utf-8"))
        page.wait_for_function("n => Number(document.body.dataset.asked) > n", arg=before)
        page.evaluate("document.querySelectorAll('#form details').forEach((one) => (one.open = true))")
        for width in (1280, 390):
            page.set_viewport_size({"width": width, "height": 720})
            assert page.evaluate(CUT) == [], (path.name, width)
            assert page.evaluate(CLIPPED) == [], (path.name, width)
    narrow = "document.querySelectorAll('.value input').forEach((one) => (one.style.minWidth = '0'))"
    page.evaluate(narrow + "; document.querySelectorAll('.value').forEach((one) => (one.style.width = '9rem'))")
    assert page.evaluate(CUT) != []
    page.context.close()


@pytest.fixture(scope="module")
def carton_pusher(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    with studio_of("pusher", tmp_path_factory.mktemp("pusher")) as made:
        yield made


@pytest.fixture
def pusher(carton_pusher: Studio) -> Studio:
    return as_begun(carton_pusher)


def field_of(opened: Opened, key: str) -> Any:
    return opened.page.locator(f"#key-{key}".replace(".", "\\."))


def test_an_emptied_key_that_must_be_given_says_so_and_nothing_else_changes(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher, viewport={"width": 1280, "height": 720})
    page, before = opened.page, opened.text
    needed = ["motion.theta2_pi", "motion.v2_mm_s", "linkage.crank_mm", "linkage.rod_mm", "gears.teeth", "name"]
    for key in needed:
        field_of(opened, key).fill("")
        field_of(opened, key).press("Tab")
        said = page.locator(f".value[data-path='{key}'] .fault")
        said.get_by_text("nothing given").wait_for()
        assert field_of(opened, key).is_visible()
        assert field_of(opened, key).input_value() == ""
    assert opened.text == before
    assert page.locator(".refusal").count() == 0
    assert page.locator("#undo").is_disabled()
    # A way back at the key, and another key in its place, which takes the empty one away.
    page.locator(".value[data-path='motion.theta2_pi'] .fault button").click()
    assert field_of(opened, "motion.theta2_pi").input_value() == "0.5"
    page.evaluate("document.querySelectorAll('#form details').forEach((one) => (one.open = true))")
    opened.set("gears.center_distance_mm", "75")
    assert "center_distance_mm: 75" in opened.text
    assert "teeth:" not in opened.text
    assert "crank_mm: 60" in opened.text
    assert "nothing given" in page.locator(".value[data-path='linkage.crank_mm'] .fault").inner_text()
    assert opened.errors == []
    page.context.close()


def test_a_number_with_a_comma_is_not_taken_for_another_one(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher)
    speed, before = field_of(opened, "operation.speed_rpm"), opened.text
    speed.fill("")
    speed.type("3,5")
    speed.press("Tab")
    opened.page.locator(".value[data-path='operation.speed_rpm'] .fault").get_by_text("not understood").wait_for()
    assert (speed.input_value(), opened.text) == ("3,5", before)
    speed.fill("31")
    opened.step(lambda: speed.press("ArrowUp"))
    assert "speed_rpm: 31.1}" in opened.text
    opened.page.context.close()


def test_what_is_shown_of_an_earlier_text_is_pale_while_a_text_is_refused(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher, viewport={"width": 1280, "height": 720})
    page = opened.page
    assert page.locator(".stale").count() == 0
    assert page.locator("#best-saves").inner_text() != ""
    text = opened.text
    refused = text.replace("theta2_pi: 0.5", "theta2_pi: 0.552").replace("v2_mm_s: 110", "v2_mm_s: 156")
    opened.step(lambda: page.evaluate("text => ncgear.send({ do: 'text', text })", refused))
    assert page.locator(".refusal").count() == 1
    charts = page.locator(".chart").count()
    assert charts > 3
    assert page.locator(".chart.stale").count() == charts
    for parts in ("#facts tbody tr", "#achieved li", "#tables .table-frame"):
        assert page.locator(f"{parts}.stale").count() == page.locator(parts).count() > 0, parts
    assert float(page.evaluate("getComputedStyle(document.querySelector('#facts .stale')).opacity")) < 0.6
    after = "one => getComputedStyle(one, '::after').content"
    assert [page.locator(one).first.evaluate(after) for one in (".chart .name", "#tables figcaption")] == 2 * [BEFORE]
    assert page.locator("#facts thead th").first.inner_text() == "before"
    assert page.locator("#facts tbody th").first.evaluate(after) == "none"
    legend = page.locator("#stage .legend")
    assert legend.inner_text() == "before"
    # Nothing lies over it.
    box = legend.bounding_box()
    top = page.evaluate("([x, y]) => document.elementFromPoint(x, y).className", [box["x"] + 2.0, box["y"] + 2.0])
    assert top == "legend"
    assert page.locator("#best-saves").inner_text() == ""
    picture, told = page.locator("#stage").bounding_box(), page.locator("#refusals").bounding_box()
    assert told["y"] > picture["y"] + 0.35 * picture["height"]
    opened.step(page.locator("#undo").click)
    assert page.locator(".stale").count() == 0
    assert not page.locator("#stage .legend").is_visible()
    assert page.locator("#facts thead th").first.inner_text() == "now"
    assert page.locator("#best-saves").inner_text() != ""
    page.context.close()


def shown_of(opened: Opened) -> dict[str, list[str]]:
    """The charts, figures and tables on the page, by their names, those of an earlier text with a star."""
    parts = {"charts": ".chart", "facts": "#facts tbody tr", "tables": "#tables .table-frame"}
    name = "(one.dataset.key ?? one.querySelector('th, figcaption').textContent)"
    each = f"ones => ones.map((one) => {name} + (one.classList.contains('stale') ? '*' : ''))"
    return {part: opened.page.locator(selector).evaluate_all(each) for part, selector in parts.items()}


BEFORE = '", before"'
"""What stands behind the name of what is of an earlier text."""

OF_TEETH = {
    "charts": ["pressure_angle", "force_of_a_pair", "root_stress", "contact_pressure"],
    "facts": ["teeth", "module", "safety against pitting, 1 wanted"],
    "tables": ["Weakest teeth", "Contact of the teeth"],
}


def test_what_a_design_has_no_longer_goes_from_the_page(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher)
    whole = shown_of(opened)
    assert all(set(OF_TEETH[part]) < set(whole[part]) for part in whole)

    def without(changes: str) -> dict[str, list[str]]:
        opened.step(lambda: opened.page.evaluate(f"ncgear.send({{ do: 'set', changes: {changes} }})"))
        found = shown_of(opened)
        assert opened.page.locator("#stage.pale").count() == 0
        opened.step(opened.page.locator("#undo").click)
        assert shown_of(opened) == whole
        return {part: [one for one in whole[part] if one not in found[part]] for part in whole}

    gone = without("{ gears: null }")
    assert all(set(OF_TEETH[part]) <= set(gone[part]) for part in whole)
    assert gone["charts"] == OF_TEETH["charts"]
    assert opened.page.locator("#points").is_visible()
    opened.step(
        lambda: opened.page.evaluate("ncgear.send({ do: 'set', changes: { motion: { law: 'uniform_crank' } } })")
    )
    assert not opened.page.locator("#points").is_visible()
    opened.step(opened.page.locator("#undo").click)
    of_load = ["power_w", "force_n", *OF_TEETH["charts"][1:]]
    assert sorted(without("{ resistance: null }")["charts"]) == sorted(of_load)
    # Of what is refused the last good design stays, and is told apart from the motion, which is not refused.
    opened.set("gears.teeth", "3")
    refused = shown_of(opened)
    assert [one for one in refused["charts"] if one.endswith("*")] == [f"{one}*" for one in OF_TEETH["charts"]]
    assert refused["facts"][0] == "peak power"
    assert f"{OF_TEETH['facts'][-1]}*" in refused["facts"]
    marked = opened.page.locator("#facts .stale th").first
    assert marked.evaluate("one => getComputedStyle(one, '::after').content") == BEFORE
    # A design without gears is not refused any more.
    opened.step(lambda: opened.page.evaluate("ncgear.send({ do: 'set', changes: { gears: null } })"))
    assert [one for part in shown_of(opened).values() for one in part if one.endswith("*")] == []
    assert "pressure_angle" not in shown_of(opened)["charts"]
    assert opened.errors == []
    opened.page.context.close()


SOCKETS = """window.sockets = [];
window.WebSocket = class extends WebSocket { constructor(...given) { super(...given); sockets.push(this); } };"""
"""Keeps the page's connections at hand, so that answers can be told to it in any order."""


def test_answers_that_come_out_of_order_take_nothing_from_the_page(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher, SOCKETS)
    page, whole = opened.page, shown_of(opened)
    newest = int(page.evaluate("document.body.dataset.asked"))

    def hear(kind: str, number: int, chain: str, content: Any = None) -> None:
        text = json.dumps({"is": kind, "n": number, "from": chain, "content": content})
        page.evaluate("data => sockets[0].dispatchEvent(new MessageEvent('message', { data }))", text)

    # Lines of the power of a text whose charts are drawn, as where gears have to be made for it.
    line = {"role": "own", "y": [0.0, 1.0]}
    hear("power", newest, "gears", [{"key": "power_w", "x": [0.0, 360.0], "lines": [line]}])
    assert page.locator(".chart.pale").count() == 0
    hear("power", newest + 1, "gears", [{"key": "power_w", "x": [0.0, 360.0], "lines": [line]}])
    assert page.locator(".chart.pale").count() == 1
    # A refusal that is older than what is asked, and the end of its answers: nothing was drawn in the stead of charts.
    hear("asked", newest + 3, "")
    hear(
        "refused",
        newest + 2,
        "contact",
        {"problem": "none", "key": "", "line": None, "wrong_input": True, "others": []},
    )
    hear("done", newest + 2, "contact")
    assert shown_of(opened) == whole
    hear("done", newest + 3, "contact")
    assert shown_of(opened)["charts"] == [one for one in whole["charts"] if one not in OF_TEETH["charts"]]
    page.context.close()


SIZES = {"wide": WIDE, "small": {"width": 1280, "height": 720}, "phone": PHONE}

CHART_TEXTS = """(() => {
  const bad = [];
  for (const svg of document.querySelectorAll(".plot svg")) {
    const whole = svg.getBoundingClientRect();
    const texts = [...svg.querySelectorAll("text")].filter((one) => one.textContent.trim());
    const boxes = texts.map((one) => one.getBoundingClientRect());
    boxes.forEach((a, i) => {
      const key = `${svg.closest("figure").dataset.key}: ${texts[i].textContent}`;
      if (a.left < whole.left - 0.5 || a.right > whole.right + 0.5) bad.push(`cut ${key}`);
      if (a.top < whole.top - 0.5 || a.bottom > whole.bottom + 0.5) bad.push(`cut ${key}`);
      // Boxes of text have room for ascenders and descenders, which numbers do not have.
      const over = (b) => a.left < b.right && b.left < a.right && a.top + 2 < b.bottom - 2 && b.top + 2 < a.bottom - 2;
      if (boxes.slice(i + 1).some(over)) bad.push(`over ${key}`);
    });
  }
  return bad;
})()"""
"""Texts of charts that are cut, or lie over another one."""

CUT_ACROSS = """[...document.querySelectorAll(".refusal, .refusal *, figcaption, p.note, tr.note span, .warnings *")]
  .filter((one) => one.checkVisibility() && one.getClientRects().length)
  .filter((one) => {
    const inside = document.createRange();
    inside.selectNodeContents(one);
    const [text, frame] = [inside.getBoundingClientRect(), one.closest(".refusal, figure, li").getBoundingClientRect()];
    return text.width && (text.left < frame.left || text.right > Math.min(frame.right, innerWidth));
  })
  .map((one) => one.textContent.slice(0, 60))"""
"""Words of refusals, headings, notes and warnings that go beyond their frames."""


@pytest.mark.parametrize("size", SIZES)
def test_numbers_notes_and_refusals_are_whole_and_the_machine_in_sight(browser: Any, pusher: Studio, size: str) -> None:
    opened = Opened(browser, pusher, viewport=SIZES[size])
    page = opened.page
    for name in ("baler-drivetrain", "baler-a1-at-law-speed"):
        text = (DESIGNS / f"{name}.yaml").read_text(encoding="utf-8")
        opened.step(lambda text=text: page.evaluate("text => ncgear.send({ do: 'text', text })", text))
        assert page.evaluate(CHART_TEXTS) == [], name
        assert page.evaluate(CUT_ACROSS) == [], name
    # Its gears are refused.
    told, machine = page.locator("#refusals").bounding_box(), page.locator("#stage svg.scene").bounding_box()
    assert machine["height"] > 100.0
    assert told["y"] >= machine["y"] + machine["height"]
    assert page.locator("#refusals").evaluate("one => one.scrollHeight - one.clientHeight") <= 1
    page.add_style_tag(content=".plot svg { margin-left: -30px; } .refusal p, .note { white-space: nowrap; }")
    page.evaluate("document.querySelectorAll('.plot svg text').forEach((one) => one.setAttribute('x', 0))")
    assert page.evaluate(CHART_TEXTS) != []
    assert page.evaluate(CUT_ACROSS) != []
    page.context.close()


def test_the_crank_is_in_sight_though_the_gears_are_refused(browser: Any, tmp_path: Path) -> None:
    with studio_of("baler-a1-at-law-speed", tmp_path) as studio:
        opened = Opened(browser, studio)
        angle = float(opened.page.locator("#angle").input_value())
        assert 55.0 < np.degrees(opened.page.evaluate(f"ncgear.drivenAngle({np.radians(angle)})")) < 75.0
        assert not opened.page.locator("#stage .legend").is_visible()
        opened.page.context.close()


def test_controls_of_gears_are_there_with_gears_alone(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher)
    page, views = opened.page, opened.page.locator('.views label:has(input[name="view"]):visible')
    find, chosen = page.locator(".views .find"), page.locator('input[name="view"]:checked')
    assert (views.all_inner_texts(), find.is_visible()) == (["machine", "gears", "mesh"], True)
    page.locator("#find-tooth").fill("5")
    page.locator("#find-tooth").press("Tab")
    assert page.locator("#found").inner_text().startswith("tooth 5 of the driving gear at")
    opened.set("gears.module_mm", "1.6")
    # The tooth that was found is one of another gear.
    assert (page.locator("#found").text_content(), page.locator("#find-tooth").input_value()) == ("", "")
    opened.step(page.locator("#undo").click)
    opened.step(lambda: page.evaluate("ncgear.send({ do: 'set', changes: { gears: null } })"))
    assert (views.all_inner_texts(), find.is_visible(), chosen.input_value()) == (["machine"], False, "machine")
    opened.step(page.locator("#undo").click)
    assert (views.all_inner_texts(), find.is_visible()) == (["machine", "gears", "mesh"], True)
    assert opened.errors == []
    page.context.close()


@pytest.mark.parametrize("width", [1280, 390])
def test_figures_side_by_side_do_not_lie_over_each_other(browser: Any, pusher: Studio, width: int) -> None:
    opened = Opened(browser, pusher, viewport={"width": width, "height": 844})
    page = opened.page
    page.locator("#hold").click()
    assert page.locator("#facts tr:has(th:text-is('masses')) td").count() == 3
    assert page.evaluate(OVER_EACH_OTHER) == []
    assert page.evaluate(CLIPPED) == []
    stages, kept = page.locator(".picture").bounding_box(), page.locator("#held-stage svg.scene").bounding_box()
    assert kept["y"] + kept["height"] <= stages["y"] + stages["height"] + 1.0
    page.add_style_tag(content="#facts td { white-space: nowrap; }")
    assert page.evaluate(OVER_EACH_OTHER) != []
    page.context.close()


def test_a_button_rests_while_its_command_runs(browser: Any, pusher: Studio) -> None:
    opened = Opened(browser, pusher)
    page = opened.page
    page.locator("[data-run=build]").first.dblclick()
    page.locator("#jobs strong").first.wait_for()
    assert page.locator("#jobs > li").count() == 1
    for button in ("[data-run=build]", "#zip", "[data-run=report]"):
        assert page.locator(button).first.is_disabled(), button
    assert page.locator("[data-run=simulate]").is_enabled()
    page.locator("#jobs button:text-is('cancel')").click()
    page.locator("#jobs").get_by_text("cancelled").wait_for()
    assert page.locator("#zip").is_enabled()
    page.context.close()


def test_all_is_in_sight_on_a_small_screen_and_nothing_is_cut(browser: Any, studio: Studio) -> None:
    opened = Opened(browser, studio, viewport={"width": 1280, "height": 720})
    page = opened.page
    for name in ("#best", ".tools [data-run=build]", "#zip", "#save"):
        box = page.locator(name).bounding_box()
        assert box["x"] + box["width"] <= 1280.0
        assert box["y"] + box["height"] <= 720.0
    assert re.fullmatch(r"Best law: acceleration up to 81\.5 % lower", page.locator("#best").inner_text())
    assert page.locator("#facts tr:has(th:text-is('peak power')) td").all_inner_texts()[2] == "27.3 % lower"
    assert opened.fact("safety against breakage, 1.4 wanted").startswith("0.4")
    assert page.locator("#tables table").first.is_visible()
    page.evaluate("document.querySelectorAll('#form details').forEach((one) => (one.open = true))")
    assert page.evaluate(CLIPPED) == []
    assert page.evaluate(SMALLEST_TEXT) >= 11.0
    handles = page.locator(".handles circle")
    assert min(box["width"] for box in (one.bounding_box() for one in handles.all())) >= 16.0
    assert page.evaluate(TOLD_CUT) == []
    # The crank is not hidden behind the rod.
    assert 55.0 < float(page.locator("#angle").input_value()) < 75.0
    field = page.locator("#key-gears\\.face_width_mm")
    field.fill("")
    field.press("Tab")
    said = page.locator(".value[data-path='gears.face_width_mm'] .fault")
    said.get_by_text("nothing given").wait_for()
    assert said.inner_text().startswith("nothing given; needed: a number")
    assert page.locator(".refusal").count() == 0
    assert page.locator("#stage.pale").count() == 0
    assert page.locator("#saved").inner_text() == "saved"
    opened.set("gears.face_width_mm", "21")
    assert said.text_content() == ""
    opened.set("gears.face_width_mm", "-1")
    assert "-1" in said.inner_text() or "0" in said.inner_text()
    page.keyboard.press("Control+s")
    page.wait_for_function("() => document.getElementById('said').textContent.startsWith('saved')")
    opened.set("gears.face_width_mm", "22")
    # What was said of the save is not said of what is not saved.
    assert page.locator("#said").text_content() == ""
    assert opened.errors == []
    page.context.close()


@pytest.mark.long
def test_everything_comes_as_one_zip(opened: Opened) -> None:
    with opened.page.expect_download() as waiting:
        opened.page.locator("#zip").click()
    assert waiting.value.suggested_filename == "baler-86.zip"
    with ZipFile(waiting.value.path()) as made:
        assert {"baler-86/summary.json", "baler-86/driving.stl"} <= set(made.namelist())
    assert "cannot" not in opened.page.locator("#said").inner_text()


def test_a_phone_shows_all_without_scrolling_sideways(browser: Any, studio: Studio) -> None:
    opened = Opened(browser, studio, viewport=PHONE)
    assert opened.page.evaluate("document.scrollingElement.scrollWidth") <= PHONE["width"]
    boxes = [opened.page.locator(one).bounding_box() for one in ("#machine", "#values", "#figures", "#curves", "#rest")]
    assert [box["y"] for box in boxes] == sorted(box["y"] for box in boxes)
    assert all(box["width"] > 300 for box in boxes)
    assert boxes[1]["y"] < 0.8 * opened.page.evaluate("document.scrollingElement.scrollHeight")
    assert opened.page.evaluate(SMALLEST_TEXT) >= 11.0
    assert opened.errors == []
    opened.page.context.close()


@pytest.mark.tiers(slow=["light"], rest="long")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_can_be_read_on_either_ground(browser: Any, studio: Studio, scheme: str) -> None:
    opened = Opened(browser, studio, color_scheme=scheme)
    faint = opened.page.evaluate(
        """(() => {
          const light = (text) => {
            const parts = text.match(/[\\d.]+/g).slice(0, 3).map((one) => Number(one) / 255);
            const [r, g, b] = parts.map((one) => (one <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4));
            return 0.2126 * r + 0.7152 * g + 0.0722 * b;
          };
          const ground = (one) => {
            for (; one; one = one.parentElement) {
              const color = getComputedStyle(one).backgroundColor;
              if (color !== "rgba(0, 0, 0, 0)") return color;
            }
            return "rgb(255, 255, 255)";
          };
          const texts = [...document.querySelectorAll("h1, h2, p, td, th, label, button, summary, li, span, code")];
          return texts.filter((one) => one.checkVisibility() && !one.disabled && one.textContent.trim()).map((one) => {
            const [a, b] = [light(getComputedStyle(one).color), light(ground(one))].sort((x, y) => y - x);
            return [(a + 0.05) / (b + 0.05), one.outerHTML.slice(0, 80)];
          }).filter(([contrast]) => contrast < 4.5);
        })()"""
    )
    assert faint == []
    opened.page.context.close()


def test_a_page_that_is_loaded_anew_goes_on_where_it_was(opened: Opened) -> None:
    opened.set("gears.teeth", "41")
    opened.page.reload()
    opened.page.wait_for_selector("body[data-asked]")
    opened.settled()
    assert "teeth: 41" in opened.text
    assert opened.page.locator("#undo").is_enabled()


@pytest.mark.long
def test_a_point_of_the_frontier_that_is_clicked_becomes_the_design(opened: Opened) -> None:
    pytest.importorskip("casadi", reason="the optimiser is not installed")
    page = opened.page
    page.set_default_timeout(10.0 * LONGEST_MS)
    page.locator("[data-run=frontier]").click()
    point = page.locator("svg.frontier circle").nth(3)
    point.wait_for()
    power = float(point.get_attribute("aria-label").split()[4])
    point.focus()
    page.keyboard.press("Enter")
    take = page.locator("#jobs button:text-is('take over')")
    take.wait_for()
    opened.step(take.click)
    assert "spline_ratio" in opened.text
    assert float(opened.fact("peak power").split()[0]) <= 1.001 * power


def test_the_best_law_is_found_and_taken_over(opened: Opened) -> None:
    pytest.importorskip("casadi", reason="the optimiser is not installed")
    page = opened.page
    coarse = f"{opened.text}\noptimize: {{knots: 16}}\n"
    opened.step(lambda: page.evaluate("text => ncgear.send({ do: 'text', text })", coarse))
    page.locator("[data-run=optimize]").click()
    page.locator("#jobs button:text-is('take over')").wait_for()
    before = opened.fact("peak power"), opened.fact("peak acceleration")
    opened.step(page.locator("#jobs button:text-is('take over')").click)
    assert (opened.fact("peak power"), opened.fact("peak acceleration")) != before
    assert "spline_ratio" in opened.text
    lines_agree(opened)


@pytest.mark.long
def test_whole_machines_are_found_and_shown_one_after_the_other(browser: Any, pusher: Studio) -> None:
    """Each machine that is clicked becomes the design, by its name in the list or by its point in the picture."""
    pytest.importorskip("casadi", reason="the optimiser is not installed")
    opened = Opened(browser, pusher)
    page = opened.page
    page.set_default_timeout(20.0 * LONGEST_MS)
    asked = f"{opened.text}\nchoices: {{machines: 3}}\n"
    opened.step(lambda: page.evaluate("text => ncgear.send({ do: 'text', text })", asked))
    page.locator("[data-run=design]").click()
    rows = page.locator("ul.machines li")
    rows.first.wait_for()
    names = rows.locator("button").all_text_contents()
    assert "; recommended" in " ".join(rows.all_text_contents())
    for number, name in enumerate(names):
        opened.step(rows.nth(number).locator("button").click)
        assert f"name: {name}" in opened.text
        power = float(rows.nth(number).text_content().split(name)[1].split()[0])
        assert float(opened.fact("peak power").split()[0]) == pytest.approx(power, rel=1e-3)
    opened.step(page.locator("svg.frontier circle").first.click)
    assert f"name: {names[0]}" in opened.text
