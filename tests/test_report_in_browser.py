"""The report in a browser that has no network: it loads, runs, stops, is scrubbed, read out, narrowed and printed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import degrees, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drives
import reports
from ncgear.drawings.charts.chart import LOAD, MOTION
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import OF_REPORT
from ncgear.drawings.page.page_charts import gear_charts
from scenes import in_a_browser

pytestmark = [pytest.mark.slow, in_a_browser]

WIDE, MIDDLE, NARROW = (1440, 900), (1024, 768), (390, 844)

FRAME_S = 0.017
"""Between two pictures of a browser; the clock begins with the first and ends with the last."""


@dataclass
class Opened:
    """A page and what it has said and asked for."""

    page: Any
    requests: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def show(self, phi1_deg: float) -> None:
        self.page.evaluate("phi1 => ncgear.show(phi1)", radians(phi1_deg))

    @property
    def angle_deg(self) -> float:
        return degrees(self.page.evaluate("ncgear.drivingAngle()"))

    def text(self, selector: str) -> str:
        return str(self.page.locator(selector).first.inner_text()).replace("\u2212", "-")


Open = Callable[..., Opened]


@pytest.fixture(scope="module")
def opening(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Open:
    """Open a page of some text in a browser without network, with a clock that only the test moves."""

    def opened(content: str, **context: Any) -> Opened:
        path = tmp_path_factory.mktemp("report") / "report.html"
        path.write_text(content, encoding="utf-8")
        made = Opened(browser.new_context(offline=True, **context).new_page())
        made.page.on("request", lambda request: made.requests.append(request.url))
        made.page.on("console", lambda message: made.errors.append(message.text) if message.type == "error" else None)
        made.page.on("pageerror", lambda error: made.errors.append(str(error)))
        made.page.on("dialog", lambda dialog: (made.errors.append("dialog"), dialog.dismiss()))
        made.page.clock.install()
        made.page.goto(path.as_uri())
        made.page.clock.pause_at(made.page.evaluate("Date.now()") + 1000)
        return made

    return opened


@pytest.fixture(scope="module")
def baler(opening: Open) -> Opened:
    return opening(reports.page("baler"), viewport=dict(zip(("width", "height"), WIDE, strict=True)))


def outside(opened: Opened) -> list[str]:
    """What was asked for beside the file itself."""
    return [url for url in opened.requests if not url.startswith("file:")] + opened.requests[1:]


# --- loading


def test_it_loads_without_an_error_or_a_request(baler: Opened) -> None:
    assert baler.errors == []
    assert len(baler.requests) == 1
    assert outside(baler) == []


@pytest.mark.slow
def test_it_begins_with_the_crank_in_sight(opening: Open) -> None:
    begun = opening(reports.page("baler"))
    crank = degrees(begun.page.evaluate("ncgear.drivenAngle(ncgear.drivingAngle())"))
    assert 55.0 < crank < 75.0


def test_requests_and_errors_are_seen(opening: Open) -> None:
    """The policy turns pictures into errors; without it they are requests; and the script's own faults are heard."""
    page = reports.page("baler")
    spoilt = page.replace("</main>", '<img src="https://example.org/a.png"><img src="b.png"></main>')
    kept = opening(spoilt)
    assert len([error for error in kept.errors if "Content Security Policy" in error]) == 2
    free = opening(spoilt.replace('http-equiv="Content-Security-Policy"', "name=none"))
    assert {"https://example.org/a.png", free.requests[0].replace("report.html", "b.png")} <= set(outside(free))
    assert opening(re.sub(r"'sha256-[^']*'", "'unsafe-inline'", page).replace("const data =", "missing();")).errors


# --- angles and values

ANGLES_DEG = (0.0, 12.345, 72.0, 126.0, 180.0, 234.0, 301.7, 359.999)


def test_the_driven_angle_is_the_laws(baler: Opened) -> None:
    phi1 = np.radians([*ANGLES_DEG, 725.0, -30.0])
    found = baler.page.evaluate("angles => angles.map(ncgear.drivenAngle)", phi1.tolist())
    law = drives.drive("baler").transmission.driven_angle(phi1).value
    np.testing.assert_allclose(found, law, rtol=0.0, atol=1e-6)
    for angle in ANGLES_DEG:
        baler.show(angle)
        expected = degrees(float(drives.drive("baler").transmission.driven_angle(np.radians([angle])).value[0]))
        assert float(baler.text("[data-angle=driven]")) == pytest.approx(expected, abs=0.00501)
        assert float(baler.text("[data-angle=driving]")) == pytest.approx(angle, abs=0.00501)


def charts(name: str) -> dict[str, PageChart]:
    drive = drives.drive(name)
    pairs = zip(drive.by_stage, reports.contacts(name), strict=True)
    return {one.key: one for one in (*reports.motion(name), *(one for pair in pairs for one in gear_charts(*pair)))}


@pytest.mark.parametrize("angle_deg", [12.345, 190.0, 301.7])
def test_readouts_are_the_motion_at_the_angle(baler: Opened, angle_deg: float) -> None:
    baler.show(angle_deg)
    drive, known = drives.drive("baler"), charts("baler")
    output = drive.linkage.OUTPUT
    for machine, line in ((drive.machine, 0), (drive.uniform_machine, 1)):
        motion = machine.motion(np.radians([angle_deg]))
        for quantity in (*MOTION, *LOAD):
            shown = baler.text(f"figure [data-now={quantity.key_of(output)}][data-line='{line}']")
            digit = 10.0 ** -known[quantity.key_of(output)].decimals
            wanted = float(quantity.values(motion, output)[0])
            assert float(shown) == pytest.approx(wanted, abs=0.51 * digit), quantity
    contact = reports.contacts("baler")[0].as_designed
    pressure = np.degrees(contact.pushing.first.pressure_angle_rad)
    at = np.interp(radians(angle_deg), contact.placement.phi1_rad, pressure)
    assert float(baler.text("figure [data-now=pressure_angle]")) == pytest.approx(at, abs=0.0051)


def test_dots_stand_at_their_values(baler: Opened) -> None:
    baler.show(90.0)
    # A third of a pixel on the screen: the drawn line, and the dot that is put on it, at the same angle.
    distance = """() => [...document.querySelectorAll("figure")].slice(0, 3).map((figure) => {
      const dot = figure.querySelector("circle.own");
      const path = [...figure.querySelectorAll("path")].find((one) => one.style.stroke === "var(--driving)");
      const [x, y] = ["cx", "cy"].map((name) => Number(dot.getAttribute(name)));
      const points = Array.from({ length: 4001 }, (_, k) => path.getPointAtLength((k / 4000) * path.getTotalLength()));
      return Math.min(...points.map((point) => Math.hypot(point.x - x, point.y - y)));
    })"""
    assert max(baler.page.evaluate(distance)) < 0.4


# --- running


def test_play_goes_on_at_the_pace_that_is_shown_and_pause_stops(baler: Opened) -> None:
    for option, deg_s in (("30", 30.0), ("120", 120.0)):
        baler.show(0.0)
        baler.page.select_option("#pace", option)
        baler.page.click("#play")
        assert baler.text("#play") == "Pause"
        baler.page.clock.run_for(2000)
        baler.page.click("#play")
        reached = baler.angle_deg
        assert reached == pytest.approx(2.0 * deg_s, abs=2.0 * FRAME_S * deg_s)
        baler.page.clock.run_for(1000)
        assert baler.angle_deg == reached
        assert baler.text("#play") == "Play"


def test_paces_are_those_of_the_machine(baler: Opened) -> None:
    texts = baler.page.locator("#pace option").all_inner_texts()
    assert texts[0].startswith("readable")
    assert "1\u00d7 (20 r/min)" in texts
    values = [
        float(value)
        for value in baler.page.evaluate("[...document.querySelectorAll('#pace option')].map(o => o.value)")
    ]
    assert values[1:] == pytest.approx([120.0 * times for times in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)])


def test_it_does_not_run_by_itself(baler: Opened) -> None:
    before = baler.angle_deg
    baler.page.clock.run_for(500)
    assert baler.angle_deg == before


@pytest.mark.parametrize(("typed", "shown"), [("365", "5.00"), ("-5", "355.00"), ("", "0.00")])
def test_an_angle_beyond_the_cycle_becomes_the_one_that_is_shown(baler: Opened, typed: str, shown: str) -> None:
    baler.page.fill("#angle", "0")
    baler.page.fill("#angle", typed)
    baler.page.press("#angle", "Enter")
    assert baler.page.input_value("#angle") == shown
    assert baler.angle_deg == pytest.approx(float(shown))


def test_scrubbing(baler: Opened) -> None:
    baler.page.fill("#scrub", "123.4")
    assert baler.angle_deg == pytest.approx(123.4)
    baler.page.fill("#angle", "250.25")
    assert baler.angle_deg == pytest.approx(250.25)
    box = baler.page.locator("figure[data-key=velocity_mm_s] svg").bounding_box()
    frame = next(
        drawn
        for drawn in baler.page.evaluate("JSON.parse(document.getElementById('data').textContent).charts")
        if drawn["key"] == "velocity_mm_s"
    )
    x = np.interp(90.0, frame["angle_deg"], frame["x"]) / OF_REPORT[0] * box["width"] + box["x"]
    baler.page.locator("figure[data-key=velocity_mm_s]").scroll_into_view_if_needed()
    box = baler.page.locator("figure[data-key=velocity_mm_s] svg").bounding_box()
    baler.page.mouse.move(x, box["y"] + box["height"] / 2)
    baler.page.mouse.down()
    assert baler.angle_deg == pytest.approx(90.0, abs=1.0)
    baler.page.mouse.move(x + 50.0, box["y"] + box["height"] / 2)
    baler.page.mouse.up()
    assert 120.0 < baler.angle_deg < 150.0
    baler.page.mouse.move(x, box["y"])
    assert baler.angle_deg > 120.0


def test_keys(baler: Opened) -> None:
    baler.page.evaluate("document.activeElement.blur()")
    press = baler.page.keyboard.press
    press("Home")
    assert baler.angle_deg == 0.0
    press("ArrowRight")
    press("Shift+ArrowRight")
    press("ArrowLeft")
    assert baler.angle_deg == pytest.approx(10.0)
    press("End")
    assert baler.angle_deg == pytest.approx(360.0)
    press("Space")
    assert baler.text("#play") == "Pause"
    press("Space")
    assert baler.text("#play") == "Play"
    baler.page.focus("#scrub")
    press("Home")
    press("ArrowUp")
    press("ArrowRight")
    assert baler.angle_deg == pytest.approx(2.0)


def test_all_controls_are_reached_by_tab_and_seen(baler: Opened) -> None:
    baler.page.focus("#play")
    reached = ["play"]
    for _ in range(8):
        baler.page.keyboard.press("Tab")
        reached.append(baler.page.evaluate("document.activeElement.id || document.activeElement.name"))
    assert {"play", "scrub", "angle", "pace", "view", "nearer", "farther", "whole"} <= set(reached)
    assert baler.page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_views(baler: Opened) -> None:
    def box() -> list[float]:
        return [float(part) for part in baler.page.get_attribute("svg.scene", "viewBox").split()]

    baler.page.check("input[value=mesh]")
    assert box()[2] == pytest.approx(27.0)
    baler.show(100.0)
    first = box()
    baler.show(200.0)
    # The mesh is followed on its way between the axes.
    assert abs(box()[0] - first[0]) > 1.0
    baler.page.click("#nearer")
    assert box()[2] < 27.0
    baler.page.check("input[value=machine]")
    assert box()[2] > 760.0


# --- sizes and print

OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


@pytest.mark.parametrize("size", [WIDE, MIDDLE, NARROW])
def test_no_window_needs_to_be_scrolled_sideways(baler: Opened, size: tuple[int, int]) -> None:
    baler.page.set_viewport_size({"width": size[0], "height": size[1]})
    assert baler.page.evaluate(OVERFLOW) == 0
    columns = baler.page.evaluate("getComputedStyle(document.querySelector('.charts')).gridTemplateColumns").split()
    assert len(columns) == {WIDE: 3, MIDDLE: 2, NARROW: 1}[size]
    baler.page.set_viewport_size({"width": WIDE[0], "height": WIDE[1]})


CUT = """[...document.querySelectorAll("figcaption, p.note, tr.note span, .columns td, .warnings *")]
  .filter((one) => one.checkVisibility())
  .filter((one) => {
    const inside = document.createRange();
    inside.selectNodeContents(one);
    const [text, frame] = [inside.getBoundingClientRect(), one.closest("figure, li").getBoundingClientRect()];
    return text.width && (text.left < frame.left || text.right > Math.min(frame.right, innerWidth));
  })
  .map((one) => one.textContent.slice(0, 60))"""
"""Words that go beyond their frames."""


@pytest.mark.parametrize("size", [WIDE, NARROW])
def test_headings_and_notes_are_whole_and_charts_can_be_read(opening: Open, size: tuple[int, int]) -> None:
    opened = opening(reports.page("baler"), viewport=dict(zip(("width", "height"), size, strict=True)))
    assert opened.page.evaluate(CUT) == []
    smallest = """Math.min(...[...document.querySelectorAll(".plot text")]
      .map((one) => parseFloat(getComputedStyle(one).fontSize) * one.getScreenCTM().a))"""
    assert opened.page.evaluate(smallest) >= 11.0
    opened.page.add_style_tag(content="td, .note { white-space: nowrap; }")
    assert opened.page.evaluate(CUT) != []


def test_what_is_too_wide_is_seen(baler: Opened) -> None:
    baler.page.evaluate("document.querySelector('h1').style.width = '2000px'")
    assert baler.page.evaluate(OVERFLOW) > 0
    baler.page.evaluate("document.querySelector('h1').style.width = ''")


VISIBLE_CONTROLS = """() => [...document.querySelectorAll("button, input, select, nav")]
    .filter((one) => one.checkVisibility()).length"""
GROUND = "getComputedStyle(document.documentElement).getPropertyValue('--paper')"


def test_it_prints_without_controls_and_in_light_colours(baler: Opened) -> None:
    assert baler.page.evaluate(VISIBLE_CONTROLS) > 8
    baler.page.emulate_media(media="screen", color_scheme="dark")
    dark = baler.page.evaluate(GROUND)
    baler.page.emulate_media(media="print", color_scheme="dark")
    assert baler.page.evaluate(VISIBLE_CONTROLS) == 0
    assert baler.page.evaluate(GROUND) != dark
    assert baler.page.locator("svg.scene").is_visible()
    assert baler.page.evaluate("getComputedStyle(document.querySelector('figure')).breakInside") == "avoid"
    pdf = baler.page.pdf()
    baler.page.emulate_media(media="screen", color_scheme="light")
    assert pdf.startswith(b"%PDF")
    assert pdf.count(b"/Type /Page\n") < 15


@pytest.mark.slow
def test_hostile_text_stays_text(opening: Open, tmp_path: Path) -> None:
    from test_report import DESIGN

    path = tmp_path / "hostile.yaml"
    path.write_text(DESIGN)
    opened = opening(reports.page_of(path))
    assert opened.errors == []
    assert opened.page.title().startswith("hostile")
    assert opened.page.locator("pre").inner_text().strip() == DESIGN.strip()
    opened.show(100.0)
    assert opened.angle_deg == pytest.approx(100.0)


@pytest.mark.long
@pytest.mark.slow
def test_two_stages_run_together(opening: Open) -> None:
    """The second stage's charts go by its own angle, and a click on one turns the whole machine."""
    opened, name = opening(reports.page("baler-66-two-stage")), "baler-66-two-stage"
    opened.show(100.0)
    first = drives.drive(name).by_stage[0].pair.transmission
    between = degrees(float(first.driven_angle(np.radians([100.0])).value[0]))
    assert float(opened.text("[data-angle=between]")) == pytest.approx(between, abs=0.00501)
    ratio = 1.0 / drives.drive(name).by_stage[1].pair.transmission.driven_angle(np.radians([between]), 1).derivative(1)
    digit = 10.0 ** -charts(name)["ratio_2"].decimals
    assert float(opened.text("figure [data-now=ratio_2]")) == pytest.approx(float(ratio[0]), abs=0.6 * digit)
    plot = opened.page.locator("figure[data-key=ratio_2] .plot")
    plot.click()
    shown = float(opened.text("[data-angle=between]"))
    assert 150.0 < shown < 200.0
    assert opened.errors == []


@pytest.mark.long
@pytest.mark.slow
def test_a_cycle_of_two_turns(opening: Open) -> None:
    opened = opening(reports.page("pump-1-2"))
    opened.show(700.0)
    law = drives.drive("pump-1-2").transmission.driven_angle(np.radians([700.0])).value
    assert opened.page.evaluate("ncgear.drivenAngle(ncgear.drivingAngle())") == pytest.approx(float(law[0]), abs=1e-6)
    assert float(opened.text("[data-angle=uniform]")) == pytest.approx(350.0)
    opened.page.keyboard.press("End")
    assert opened.angle_deg == pytest.approx(720.0)
    assert 4.0 * pi == pytest.approx(radians(opened.angle_deg))
