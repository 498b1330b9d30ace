"""The report: what it holds and asks for, colours that can be read, curves that are those of the motion."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from math import degrees, pi
from pathlib import Path
from typing import Any

import lxml.html
import numpy as np
import pytest
import shapely
from lxml.html import HtmlElement
from mpmath import ellipe

import drives
import reports
from at_once import at_once
from commands import ROOT, Run, python
from ncgear.contact.written.as_written import Outlines
from ncgear.drawings import palette
from ncgear.drawings.charts.chart import LOAD, MOTION, decimals_of
from ncgear.drawings.page import REPORT_FILE
from ncgear.drawings.page.assets import scene_style
from ncgear.drawings.page.chart_figure import DIGITS, PageChart
from ncgear.drawings.page.chart_svg import drawn
from ncgear.drawings.page.motion_charts import SIDE_RAD, split_angles
from ncgear.drawings.page.page_charts import gear_charts
from ncgear.drawings.palette import style_of_colors
from ncgear.drawings.plots import canvas
from ncgear.files.manifest import MANIFEST
from ncgear.kinematics.motion import OutputMotion
from ncgear.mechanisms.mechanism import Output
from ncgear.pitch.shape import Gear

PAGE = ROOT / "src" / "ncgear" / "drawings" / "page"
CSS = style_of_colors() + (PAGE / "page.css").read_text(encoding="utf-8")

HOSTILE = (
    "</script></pre><script>document.title = 'taken'</script>"
    """<img src=x onerror="alert(1)">&amp; "quoted" 'so' {{ 7 * 7 }}"""
)

DESIGN = f"""# a comment: {HOSTILE}
name: hostile
description: |
  {HOSTILE}
linkage: {{crank_mm: 40, rod_mm: 160}}
operation: {{speed_rpm: 60}}
motion: {{law: ellipse, eccentricity: 0.3}}
resistance: {{polynomial_n: [100, 1]}}
"""


def parsed(page: str) -> HtmlElement:
    return lxml.html.document_fromstring(page)


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("hostile") / "hostile.yaml"
    path.write_text(DESIGN)
    return reports.page_of(path)


# --- nothing from outside, and no code but the page's own


def asked_for(page: str) -> list[str]:
    """What a page would load: addresses in attributes and in style sheets that lead out of it."""
    tree = parsed(page)
    names = ("src", "href", "srcset", "data", "action", "poster", "xlink:href", "background", "formaction", "ping")
    attributes = [
        value for name in names for value in tree.xpath(f'//@*[name()="{name}"]') if not value.startswith("#")
    ]
    styles = [*tree.xpath("//style/text()"), *tree.xpath("//@style")]
    return attributes + [found for style in styles for found in re.findall(r"@import.*|url\((?!#)[^)]*\)", style)]


@pytest.mark.slow
def test_the_page_asks_for_nothing() -> None:
    page = reports.page("baler")
    assert asked_for(page) == []
    assert re.findall(r"https?:|//[a-z]+\.", page) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "added",
    ['<img src="//example.org/a.png">', "<style>@import 'a.css'</style>", '<p style="background: url(a.png)"></p>'],
)
def test_what_a_page_would_ask_for_is_seen(added: str) -> None:
    assert len(asked_for(reports.page("baler").replace("</main>", f"{added}</main>"))) == 1


def foreign_elements(page: str) -> list[str]:
    """Elements that can only come from the text of a design: scripts beyond the two of the page, pictures, handlers."""
    tree = parsed(page)
    scripts = tree.xpath("//script")
    return [*map(str, scripts[2:]), *map(str, tree.xpath("//img")), *tree.xpath("//@*[starts-with(name(), 'on')]")]


@pytest.mark.slow
def test_the_text_of_a_design_is_text(hostile: str) -> None:
    assert foreign_elements(hostile) == []
    tree = parsed(hostile)
    assert tree.xpath("//pre")[0].text_content() == DESIGN
    assert tree.xpath("//p[@class='description']")[0].text_content() == HOSTILE + "\n"


@pytest.mark.slow
def test_text_that_is_not_escaped_is_seen(hostile: str) -> None:
    assert len(foreign_elements(hostile.replace("</main>", f"<p>{HOSTILE}</p></main>"))) == 3


@pytest.mark.slow
def test_no_key_of_the_data_ends_the_script() -> None:
    block = re.search(r'<script type="application/json" id="data">(.*?)</script>', reports.page("baler"), re.DOTALL)
    assert block
    assert set(json.loads(block[1])) == {"cycle_deg", "swings", "scene", "grids", "charts"}


@pytest.mark.slow
def test_names_within_the_page_are_its_own() -> None:
    names = parsed(reports.page("baler")).xpath("//@id")
    assert len(names) == len(set(names))


# --- bytes


@pytest.mark.slow
def test_the_same_design_gives_the_same_bytes(hostile: str, tmp_path: Path) -> None:
    path = tmp_path / "hostile.yaml"
    path.write_text(DESIGN)
    assert reports.page_of(path) == hostile


@pytest.mark.slow
def test_the_page_is_small() -> None:
    assert len(reports.page("baler").encode()) < 1e6


@pytest.mark.long
@pytest.mark.slow
def test_four_hundred_teeth_stay_under_five_megabytes(run: Run, tmp_path: Path) -> None:
    text = (ROOT / "designs" / "ellipse.yaml").read_text()
    path = tmp_path / "many.yaml"
    path.write_text(re.sub(r"teeth: \d+", "teeth: 400", text))
    assert "teeth: 400" in path.read_text()
    assert run("report", str(path), "--out", str(tmp_path / "out"))[0] == 0
    assert (tmp_path / "out" / REPORT_FILE).stat().st_size < 5e6


@pytest.mark.long
@pytest.mark.slow
def test_both_commands_and_any_order_of_hashing_give_the_same_bytes(run: Run, tmp_path: Path) -> None:
    design = str(ROOT / "designs" / "ellipse.yaml")
    python("-m", "ncgear", "report", design, "--out", str(tmp_path / "alone"), PYTHONHASHSEED="7")
    assert run("build", design, "--report", "--out", str(tmp_path / "built"))[0] == 0
    alone, built = (tmp_path / folder / REPORT_FILE for folder in ("alone", "built"))
    assert alone.read_bytes() == built.read_bytes()


# --- the commands


SMALL = """\
name: NAME
linkage: {crank_mm: 21, rod_mm: 77}
operation: {speed_rpm: 45}
motion: {law: uniform_crank}
gears: {teeth: 17, module_mm: 2.5, face_width_mm: 8}
output: {chord_tolerance_mm: 0.05}
"""


@pytest.mark.long
@pytest.mark.slow
def test_a_build_makes_the_report_of_an_earlier_design_anew(run: Run, tmp_path: Path) -> None:
    for name in ("first", "second"):
        (tmp_path / f"{name}.yaml").write_text(SMALL.replace("NAME", name))
    page = tmp_path / "made" / REPORT_FILE
    assert run("report", "first.yaml", "--out", "made")[0] == 0
    assert run("build", "second.yaml", "--out", "made", "--format", "svg")[0] == 0
    assert run("report", "second.yaml", "--out", "alone")[0] == 0
    assert page.read_bytes() == (tmp_path / "alone" / REPORT_FILE).read_bytes()
    # One that somebody changed is theirs: it stays, or is kept where a new one is asked for.
    page.write_text("notes on the second design")
    assert run("build", "first.yaml", "--out", "made", "--format", "svg")[0] == 0
    assert page.read_text() == "notes on the second design"
    status, out, _ = run("report", "first.yaml", "--out", "made")
    assert (status, "made/report-kept.html" in out) == (0, True)
    assert page.with_name("report-kept.html").read_text() == "notes on the second design"
    assert parsed(page.read_text()).xpath("//h1")[0].text == "first"


@pytest.mark.slow
def test_a_design_without_gears_has_a_report_of_its_motion(run: Run, tmp_path: Path) -> None:
    (tmp_path / "hostile.yaml").write_text(DESIGN)
    status, out, _ = run("report", "hostile.yaml", "--out", "made")
    assert (status, {path.name for path in (tmp_path / "made").iterdir()}) == (0, {REPORT_FILE, MANIFEST})
    assert f"made/{REPORT_FILE}" in out
    tree = parsed((tmp_path / "made" / REPORT_FILE).read_text())
    assert "no gears" in tree.text_content()
    assert tree.xpath("//figure/@data-key")[-1] == "ratio"


def test_a_design_that_makes_no_gears_is_refused_in_place(run: Run, tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text(DESIGN.replace("eccentricity: 0.3", "eccentricity: 1.3"))
    status, _, err = run("report", "bad.yaml")
    assert status == 2
    assert err.startswith("bad.yaml:")
    assert not (tmp_path / "export").exists()


# --- content


def test_the_page_says_what_the_design_is() -> None:
    tree = parsed(reports.page("ellipse"))
    text = tree.text_content()
    assert tree.xpath("//h1")[0].text == "ellipse"
    assert tree.xpath("//pre")[0].text_content() == (ROOT / "designs" / "ellipse.yaml").read_text()
    # Two axes of an ellipse whose perimeter is that of 37 teeth: 4 a E(0.35^2) = 37 pi 2 mm
    distance_mm = 37 * pi / float(ellipe(0.35**2))
    for words in ("Equal elliptical gears", "uniform crank", "undercut", f"{distance_mm:.4f}", "numpy", "python"):
        assert words in text, words


@pytest.mark.slow
def test_every_quantity_has_a_chart() -> None:
    of_teeth = ["pressure_angle", "transmission_error", "force_of_a_pair", "root_stress", "contact_pressure"]
    wanted = [*(q.key_of(Output("slider")) for q in (*MOTION, *LOAD)), "ratio", *of_teeth]
    assert parsed(reports.page("baler")).xpath("//figure/@data-key") == wanted


@pytest.mark.tiers(slow=["helical-ellipse"], rest="long")
@pytest.mark.parametrize("name", ["baler-66-two-stage", "helical-ellipse", "internal-1-2"])
def test_pairs_of_all_kinds_have_their_charts(name: str) -> None:
    stages = ["_1", "_2"] if "two-stage" in name else [""]
    keys = parsed(reports.page(name)).xpath("//figure/@data-key")
    assert {f"transmission_error{stage}" for stage in stages} <= set(keys)
    assert len(parsed(reports.page(name)).xpath("//figcaption[text()='Basic rack']")) == len(stages)


# --- curves


def error_of_straight_lines(of: PageChart, own: np.ndarray, angles_deg: np.ndarray) -> float:
    """How far straight lines between the samples are from the values of this design, in shown digits."""
    line = of.chart.lines[0]
    between = np.interp(np.mod(angles_deg, of.period_deg), line.x, line.values)
    return float(np.max(np.abs(between - own))) * 10.0**of.decimals


def motion_at(name: str, angles_deg: np.ndarray) -> OutputMotion:
    return drives.drive(name).machine.motion(np.radians(angles_deg))


@pytest.mark.parametrize("name", ["baler", "pump-1-2", "ellipse"])
def test_what_is_read_out_is_the_motion(name: str) -> None:
    charts = reports.motion(name)
    angles = np.random.default_rng(8).uniform(0.0, charts[0].chart.end, 3000)
    found = motion_at(name, angles)
    for chart, quantity in zip(charts[:3], MOTION, strict=True):
        assert error_of_straight_lines(chart, quantity.values(found, Output("slider")), angles) < 0.5, chart.key


def test_the_force_is_read_out_on_both_sides_of_its_jump() -> None:
    dead_centre = np.degrees(drives.drive("baler").machine.extended_rad)
    angles = dead_centre + np.array([-1e-3, 1e-3])
    force = reports.motion("baler")[3]
    wanted = LOAD[0].values(motion_at("baler", angles), Output("slider"))
    assert error_of_straight_lines(force, wanted, angles) < 0.5


def test_even_samples_would_miss_the_jump() -> None:
    """So the test above can fail."""
    machine = drives.drive("baler").machine
    even, dead_centre = np.linspace(0.0, 2.0 * np.pi, 2001), machine.extended_rad
    angles = dead_centre + np.array([-2e-5, 2e-5])
    missed = np.interp(angles, even, machine.motion(even).load) - machine.motion(angles).load
    assert np.max(np.abs(missed)) > 1000.0


def test_samples_stand_on_both_sides_of_jumps() -> None:
    angles = split_angles(6.0, [4.0, 0.0, 2.0, 2.0, 6.0])
    assert np.all(np.diff(angles) > 0.0)
    assert (angles[0], angles[-1]) == (0.0, 6.0)
    for jump in (2.0, 4.0):
        beside = angles[np.abs(angles - jump) < 1e-3 * SIDE_RAD + SIDE_RAD]
        np.testing.assert_allclose(beside - jump, [-SIDE_RAD, SIDE_RAD], rtol=1e-5)


def points_of_own_line(svg: str) -> np.ndarray:
    """Points of the path that is drawn in this design's colour, in SVG units."""
    path = re.search(r'<path d="([^"]*)"[^>]*stroke: var\(--driving\); stroke-width: 2', svg)
    assert path
    return np.array(re.findall(r"[ML] (\S+) (\S+)", path[1]), dtype=float)


DRAWN_OFF = 0.2
"""Distance in SVG units by which a drawn point may miss its curve: matplotlib leaves out what is within 1/9."""


def farthest_from_curve(of: PageChart, angle_deg: tuple[float, float]) -> float:
    """Distance of drawn points from where the page's script would put the cursor's dot, in SVG units."""
    figure, line = drawn(of), of.chart.lines[0]
    x = np.interp(line.x, angle_deg, figure.x)
    y = np.interp(line.values, figure.values, figure.y)
    cursor = shapely.LineString(np.column_stack([x, y]))
    return float(max(shapely.distance(cursor, shapely.points(points_of_own_line(figure.drawing)))))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(8))
def test_the_cursor_runs_on_the_drawn_curve(number: int) -> None:
    pair = drives.drive("baler"), reports.contacts("baler")[0]
    chart = [*reports.motion("baler"), *gear_charts(*pair)][number]
    assert farthest_from_curve(chart, drawn(chart).angle_deg) < DRAWN_OFF


def test_a_cursor_that_is_off_is_seen() -> None:
    assert farthest_from_curve(reports.motion("baler")[0], (0.0, 361.0)) > DRAWN_OFF


@at_once(("largest", "decimals"), [(760.0, 1), (1.87, 3), (0.0187, 5), (12345.0, 0), (0.0, 0), (1000.0, 0)])
def test_four_digits_of_the_largest_value_are_shown(largest: float, decimals: int) -> None:
    assert decimals_of(largest, DIGITS) == decimals


def test_values_that_are_not_finite_are_refused() -> None:
    of = reports.motion("baler")[0]
    line = of.chart.lines[0]
    bad = replace(line, values=line.values * np.nan)
    with pytest.raises(ValueError, match="displacement"):
        replace(of, chart=replace(of.chart, lines=(bad,)))


# --- colours

TEXT = 4.5
LINES = 3.0
"""Least contrasts of the Web Content Accessibility Guidelines 2.2, 1.4.3 and 1.4.11."""

PAIRS: list[tuple[str, str, float]] = [
    *((ink, ground, TEXT) for ink in ("ink", "muted", "driving") for ground in ("paper", "panel")),
    ("warning", "warning-ground", TEXT),
    ("ink", "warning-ground", TEXT),
    ("panel", "driving", TEXT),
    *((line, "panel", LINES) for line in ("driving", "driven", "uniform", "highlight", "joint")),
]


def colors(css: str) -> dict[str, str]:
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", css))


DRAWINGS = PAGE.parent
HEX = re.compile(r"#[0-9a-fA-F]{3,8}\b")


def test_the_colours_of_all_drawings_are_in_one_place() -> None:
    """No other file of the drawings has a colour of its own, but for the stand-ins that the page's charts replace."""
    sources = {path for kind in ("*.py", "*.css", "*.js", "*.j2") for path in DRAWINGS.rglob(kind)}
    texts = {path.name: path.read_text(encoding="utf-8").replace('f"#a1000{number}"', "") for path in sources}
    with_colors = {name for name, text in texts.items() if HEX.search(text)}
    assert with_colors == {"palette.py"}


def test_a_scene_in_a_page_without_colours_falls_back_on_the_same_ones() -> None:
    fallbacks = re.findall(r"var\(--([\w-]+), (#[0-9a-f]{6})\)", scene_style())
    assert {name for name, _ in fallbacks} > {"driving", "driven", "ink"}
    assert all(palette.LIGHT[name] == color for name, color in fallbacks)
    assert dict(fallbacks)["driving"] == canvas.DRIVING


def luminance(color: str) -> float:
    channels = np.array([int(color[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(one: str, other: str) -> float:
    low, high = sorted(map(luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)


def too_faint(css: str) -> list[tuple[str, str]]:
    known = colors(css)
    return [(ink, ground) for ink, ground, least in PAIRS if contrast(known[ink], known[ground]) < least]


LIGHT, DARK = re.findall(r":root \{(.*?)\}", CSS, re.DOTALL)


@pytest.mark.parametrize("css", [LIGHT, DARK], ids=["light", "dark"])
def test_colours_can_be_read(css: str) -> None:
    assert too_faint(css) == []
    assert luminance(colors(LIGHT)["paper"]) > 0.8
    assert luminance(colors(DARK)["paper"]) < 0.1


def test_faint_text_is_seen() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)
    assert ("muted", "panel") in too_faint(re.sub("--muted: #[0-9a-f]{6}", "--muted: #a0a0a0", LIGHT))


@pytest.mark.slow
def test_every_colour_of_the_drawings_is_one_of_the_page() -> None:
    known = colors(LIGHT)
    used = set(re.findall(r"var\(--([\w-]+)[,)]", reports.page("baler")))
    assert used - set(known) - {"own"} == set()
    assert set(known) == set(colors(DARK))
    svg: Any = re.findall(r"<svg.*?</svg>", reports.page("baler"), re.DOTALL)
    assert [found for one in svg for found in re.findall(r"(?:fill|stroke): ?#\w+", one)] == []


@pytest.mark.slow
def test_charts_of_teeth_hold_the_extremes_that_are_searched() -> None:
    """What a caption names as least and greatest is what the summary has; between samples there is more."""
    made = drives.drive("pusher")
    contact = made.contact([Outlines("points", *(made.teeth.of(gear).outline_mm for gear in Gear))])
    charts = {one.key: one.chart for one in gear_charts(made, contact)}
    written, angle = (charts[key].lines[0] for key in ("transmission_error", "pressure_angle"))
    error, pressed = contact.extremes[0].pushing_rad, made.contact_extremes.pushing_pressure_angle_rad
    assert [written.values.min(), written.values.max()] == [1e6 * error.low.value, 1e6 * error.high.value]
    ends = [degrees(pressed.low.value), degrees(pressed.high.value)]
    assert [angle.values.min(), angle.values.max()] == pytest.approx(ends, rel=1e-15)
    assert np.ptp(written.values) > 1.001e6 * np.ptp(contact.as_written[0].pushing_rad)
    assert (np.diff(written.x) > 0.0).all()
