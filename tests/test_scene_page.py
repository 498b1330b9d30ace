"""The scene in a page: its table of angles, its paths, its size, and what scene.js makes of them in a browser."""

from __future__ import annotations

import json
import re
import subprocess
from functools import cache
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from shapely import LinearRing
from svgelements import Path as SvgPath

from at_once import at_once
from drives import drive_of_text
from ncgear.drawings.page.assets import scene_script, scene_style
from ncgear.drawings.page.data import TABLE_ERROR_RAD, angle_table, scene_data
from ncgear.drawings.page.scene_svg import closed_path, gear_tolerance_mm, grid_mm, scene_svg
from ncgear.drawings.scene.scene import scene_of
from ncgear.numerics.arrays import Array
from scenes import CHROMIUM, FLAGS, TWO_STAGES, in_a_browser, scene

SCENES = ["baler", "ellipse", "internal-1-2", "pump-1-2", TWO_STAGES, "askew", "gearless", "both ways"]
every_scene = pytest.mark.parametrize("name", SCENES)
SVG = "{http://www.w3.org/2000/svg}"


def hermite(table: dict[str, Any], at: Array) -> Array:
    """What scene.js makes of a table, written once more."""
    turns, local = np.divmod(at, table["period"])
    nodes, value, slope = (np.array(table[key]) for key in ("at", "value", "slope"))
    i = np.minimum(np.searchsorted(nodes, local, side="right"), nodes.size - 1) - 1
    width = nodes[i + 1] - nodes[i]
    t = (local - nodes[i]) / width
    weights = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2, t**2 * (3 - 2 * t), t**2 * (t - 1)
    terms = value[i], slope[i] * width, value[i + 1], slope[i + 1] * width
    return turns * table["rise"] + sum(weight * term for weight, term in zip(weights, terms, strict=True))


@every_scene
def test_the_table_holds_the_law(name: str) -> None:
    """To twice what it is refined to in the middle of its steps, a fifth of the promised 1e-6 rad."""
    found = scene(name)
    for transmission in {pair.transmission for pair in found.train.pairs} | {found.train.whole}:
        table = angle_table(transmission)
        assert np.all(np.diff(table["at"]) >= 0.0)
        points = np.random.default_rng(1).uniform(-7.0, 20.0, 3_000)
        error = np.abs(hermite(table, points) - transmission.driven_angle(points).value)
        assert error.max() < 2.0 * TABLE_ERROR_RAD
        assert len(table["at"]) < 1000


def test_fewer_steps_would_not_do() -> None:
    transmission = scene(TWO_STAGES).train.whole
    table = angle_table(transmission)
    thinned = {key: entries[::2] if isinstance(entries, list) else entries for key, entries in table.items()}
    points = np.linspace(0.0, 6.28, 5000)
    assert np.abs(hermite(thinned, points) - transmission.driven_angle(points).value).max() > TABLE_ERROR_RAD


def groups(svg: str) -> dict[str, ElementTree.Element]:
    root = ElementTree.fromstring(svg)
    return {group.attrib["id"]: group for group in root.iter("g") if "id" in group.attrib}


def drawn_rings(group: ElementTree.Element) -> list[LinearRing]:
    """The closed contours of a body's outline in mm, as an independent reader of SVG has them."""
    (scaled,) = group
    grid = float(re.fullmatch(r"scale\((.*)\)", scaled.attrib["transform"])[1])
    outline = next(path for path in scaled if path.attrib["class"] == "outline")
    parts = SvgPath(outline.attrib["d"]).as_subpaths()
    return [LinearRing([(grid * step.end.x, grid * step.end.y) for step in part]) for part in parts]


@pytest.mark.tiers(slow=["baler"], rest="long")
@pytest.mark.parametrize("name", ["baler", "internal-1-2"])
def test_drawn_gears_stray_by_no_more_than_they_may(name: str) -> None:
    found = scene(name)
    made = groups(scene_svg(found))
    for pair in found.pairs:
        allowed = gear_tolerance_mm(pair) * (1.0 + 0.2)
        for gear in (pair.driving, pair.driven):
            rings = drawn_rings(made[f"scene-{gear.body.name}"])
            assert len(rings) == len(gear.body.contours_mm)
            for ring, contour in zip(rings, gear.body.contours_mm, strict=True):
                written = LinearRing(contour)
                assert shapely.distance(shapely.points(contour), ring).max() <= allowed
                assert shapely.distance(shapely.points(ring.coords), written).max() <= allowed


def test_rounding_to_the_grid_does_not_add_up() -> None:
    """Steps from point to point, of whole numbers: the last point is as exact as the first."""
    angle = np.linspace(0.0, 2.0 * pi, 5000, endpoint=False)
    circle = 100.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    grid = grid_mm(0.005)
    assert grid == pytest.approx(0.001)
    steps = [int(number) for number in re.findall(r"-?\d+", closed_path([circle], grid))]
    places = np.cumsum(np.array(steps).reshape(-1, 2), axis=0) * grid
    assert np.abs(places - circle).max() <= grid / 2.0 + 1e-12


LARGE = """
name: large
linkage: {crank_mm: 380, rod_mm: 960}
operation: {speed_rpm: 60}
motion: {law: ellipse, eccentricity: 0.3}
gears: {teeth: 400, module_mm: MODULE, face_width_mm: 40, driving: {bore_mm: 30}, driven: {bore_mm: 30}}
resistance: {polynomial_n: [400]}
"""
LARGEST_BYTES = 1.5e6


@pytest.mark.slow
@pytest.mark.parametrize("module", [1.0, 20.0])
def test_four_hundred_teeth_stay_small(module: float) -> None:
    found = scene_of(drive_of_text(LARGE.replace("MODULE", str(module))))
    assert len(scene_svg(found)) + len(json.dumps(scene_data(found))) < LARGEST_BYTES


@pytest.mark.slow
def test_pockets_and_hubs_are_drawn() -> None:
    made = groups(scene_svg(scene("webbed")))
    edges = [path for path in made["scene-driving"].iter("path") if path.attrib["class"] == "edge"]
    (path,) = edges
    assert path.attrib["d"].count("z") == len(scene("webbed").pairs[0].driving.body.edges_mm)
    assert not [path for path in made["scene-driven"].iter("path") if path.attrib["class"] == "edge"]


@every_scene
def test_svg_and_data_name_the_same_bodies(name: str) -> None:
    found = scene(name)
    made, data = groups(scene_svg(found)), scene_data(found)
    bodies = {f"scene-{body.name}" for body in (*found.links, *(gear.body for gear in found.gears))}
    assert bodies <= set(made)
    assert {f"scene-{gear['name']}" for gear in data["gears"]} <= bodies
    assert ("scene-material" in made) == (data["chamber"]["begins"] is not None)
    assert ("scene-material-behind" in made) == (data["chamber"]["behind"] is not None) == (name == "both ways")
    assert ("straw" in scene_svg(found)) == (found.chamber is not None and found.chamber.straw)
    assert set(data["views"]) == ({"machine", "gears", "mesh"} if found.pairs else {"machine"})
    assert json.loads(json.dumps(data, allow_nan=False)) == data


@pytest.mark.thorough
def test_every_class_that_is_drawn_has_a_colour() -> None:
    classes = {word for text in map(scene_svg, map(scene, SCENES)) for word in re.findall(r'class="([^"]*)"', text)}
    style = scene_style()
    lines = {"outline", "edge", "pitch-curve", "charge", "straw", "load", "wall", "hatching", "orbit", "centres", "pin"}
    lines |= {"shaft", "pitch-point"}
    assert classes & lines <= set(re.findall(r"\.([a-z-]+)", style))
    assert classes >= lines - {"edge"}
    assert {"--ink", "--paper", "--driving", "--driven", "--material", "--load"} <= set(
        re.findall(r"var\((--[a-z]+)", style)
    )


OPTIONS = [
    *FLAGS,
    "--headless",
    "--no-first-run",
    "--disable-sync",
    "--dump-dom",
]

PAGE = """<!doctype html><style>svg {{ height: 400px }} {style}</style>{bodies}
<script>{script}
const found = {{}};
window.onerror = (message) => {{ found.error = message; }};
{calls}
</script><script>document.body.innerHTML = ""; document.body.textContent = JSON.stringify(found);</script>"""

CALL = """{{
  const svg = document.querySelector("#{id} svg");
  const data = {data};
  const scene = createScene(svg, data);
  const transform = (name) => svg.querySelector("#scene-" + name).getAttribute("transform");
  const bodies = ["crank", "rod", "slider", ...data.gears.map((gear) => gear.name)];
  found["{name}"] = {angles}.map((phi1) => {{
    scene.show(phi1);
    const places = bodies.map((name) => [name, scene.place(name, phi1)]);
    const moved = bodies.map((name) => [name, transform(name)]);
    const points = data.pairs.map((_, i) => scene.place(`pitch-point-${{i + 1}}`, phi1));
    const boxes = scene.views.map((view) => {{ scene.view(view); return [view, svg.getAttribute("viewBox")]; }});
    return {{ phi1, driven: scene.driven_angle(phi1), places, moved, points, boxes,
      material: data.chamber.begins === null ? null : transform("material"),
      behind: data.chamber.behind === null ? null : transform("material-behind") }};
  }});
  scene.view("machine"); scene.zoom(4); found["{name} zoomed"] = svg.getAttribute("viewBox");
  scene.reset(); found["{name} reset"] = svg.getAttribute("viewBox");
  const box = svg.getBoundingClientRect();
  const at = new DOMPoint(Math.round(box.left + 0.7 * box.width), Math.round(box.top + 0.2 * box.height));
  const under = () => {{ const p = at.matrixTransform(svg.getScreenCTM().inverse()); return [p.x, p.y]; }};
  const width = () => Number(svg.getAttribute("viewBox").split(" ")[2]);
  const wheel = (ctrlKey) => svg.dispatchEvent(
    new WheelEvent("wheel", {{ ctrlKey, deltaY: -400, clientX: at.x, clientY: at.y, cancelable: true }}));
  const key = (key) => svg.dispatchEvent(new KeyboardEvent("keydown", {{ key }}));
  const told = {{ before: under(), widths: [width()], scrolls: wheel(false) }};
  told.held = !wheel(true); told.after = under(); told.widths.push(width());
  for (const one of ["+", "-", "0"]) {{ key(one); told.widths.push(width()); }}
  found["{name} hands"] = told;
  try {{ scene.view("moon"); }} catch (error) {{ found["{name} moon"] = error.message; }}
}}"""

ANGLES = [0.001, 0.5, 1.7, 3.0, 4.4, 6.0, 7.9, -2.2]


@cache
def in_browser() -> dict[str, Any]:
    """What the script says of every scene, all asked in one page."""
    bodies = "".join(f'<div id="at{i}">{scene_svg(scene(name))}</div>' for i, name in enumerate(SCENES))
    calls = "".join(
        CALL.format(id=f"at{i}", name=name, data=json.dumps(scene_data(scene(name))), angles=ANGLES)
        for i, name in enumerate(SCENES)
    )
    page = PAGE.format(style=scene_style(), bodies=bodies, script=scene_script(), calls=calls)
    return json.loads(text_of(page))


def text_of(page: str) -> str:
    """What stands in a page's body once its scripts have run."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        path.write_text(page, encoding="utf-8")
        command = [str(CHROMIUM), *OPTIONS, f"--user-data-dir={folder}/profile", path.as_uri()]
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120.0)
    return re.search(r"<body>(.*)</body>", done.stdout, flags=re.DOTALL)[1].strip()


@pytest.mark.tiers(slow=["baler-66-two-stage"], rest="long")
@in_a_browser
@every_scene
def test_the_script_puts_bodies_where_the_law_does(name: str) -> None:
    """Angles to 1e-6 rad, and places to what that turns the linkage by."""
    assert "error" not in in_browser()
    found = scene(name)
    poses, size = found.poses(np.array(ANGLES)), found.machine.linkage.rod_mm
    for row, told in enumerate(in_browser()[name]):
        assert told["driven"] == pytest.approx(poses.motion.phi2_rad[row], abs=1e-6)
        for body, place in told["places"]:
            expected = poses.places[body]
            assert np.sin((place["angle"] - expected.angle_rad[row]) / 2.0) == pytest.approx(0.0, abs=5e-7)
            assert [place["x"], place["y"]] == pytest.approx(expected.origin_mm[row], abs=1e-6 * size)
        for point, exact in zip(told["points"], poses.pitch_points_mm, strict=True):
            # From the tables' slopes, which are less exact than their values.
            assert [point["x"], point["y"]] == pytest.approx(exact[row], abs=1e-4 * size)


@in_a_browser
@every_scene
@pytest.mark.slow
def test_the_script_moves_what_is_drawn(name: str) -> None:
    for told in in_browser()[name]:
        for (body, place), (_, transform) in zip(told["places"], told["moved"], strict=True):
            x, y, degrees = map(float, re.fullmatch(r"translate\((\S+) (\S+)\) rotate\((\S+)\)", transform).groups())
            assert (x, y, np.radians(degrees)) == pytest.approx((place["x"], place["y"], place["angle"])), body


@pytest.mark.slow
@in_a_browser
@at_once("name", ["baler", "pump-1-2", "askew", "both ways"])
def test_the_script_presses_the_material(name: str) -> None:
    found = scene(name)
    depths = found.poses(np.array(ANGLES)).material_mm
    for told, depth in zip(in_browser()[name], depths, strict=True):
        moved = re.fullmatch(r"translate\((\S+) (\S+)\) scale\((\S+) 1\)", told["material"])
        assert float(moved[3]) == pytest.approx(depth, abs=1e-6 * found.machine.linkage.rod_mm)
        assert float(moved[1]) + float(moved[3]) == pytest.approx(found.chamber.end_mm)


@pytest.mark.slow
@in_a_browser
def test_the_script_presses_the_material_behind_the_slider() -> None:
    found = scene("both ways")
    depths = found.poses(np.array(ANGLES)).material_behind_mm
    assert np.ptp(depths) > 0.0
    for told, depth in zip(in_browser()["both ways"], depths, strict=True):
        moved = re.fullmatch(r"translate\((\S+) (\S+)\) scale\((\S+) 1\)", told["behind"])
        assert float(moved[3]) == pytest.approx(depth, abs=1e-6 * found.machine.linkage.rod_mm)
        assert float(moved[1]) == pytest.approx(found.chamber.start_mm)
        assert float(moved[2]) == found.machine.linkage.offset_mm


def numbers(box: str) -> list[float]:
    return [float(part) for part in box.split()]


@pytest.mark.slow
@in_a_browser
@every_scene
def test_views_show_what_they_say(name: str) -> None:
    for told in in_browser()[name]:
        boxes = dict(told["boxes"])
        left, top, width, height = numbers(boxes["machine"])
        for _, place in told["places"]:
            assert left < place["x"] < left + width
            assert top < -place["y"] < top + height
        if "mesh" in boxes:
            left, top, width, height = numbers(boxes["mesh"])
            point = told["points"][-1]
            assert (left + width / 2.0, top + height / 2.0) == pytest.approx((point["x"], -point["y"]))


@pytest.mark.slow
@in_a_browser
def test_zooming_keeps_the_middle_and_is_undone() -> None:
    whole, zoomed = (numbers(in_browser()[f"baler {what}"]) for what in ("reset", "zoomed"))
    assert zoomed[2] == pytest.approx(whole[2] / 4.0)
    assert zoomed[0] + zoomed[2] / 2.0 == pytest.approx(whole[0] + whole[2] / 2.0)
    assert whole == pytest.approx(numbers(dict(in_browser()["baler"][0]["boxes"])["machine"]))


@pytest.mark.slow
@in_a_browser
def test_wheel_and_keys_zoom_and_what_is_under_the_pointer_stays() -> None:
    told = in_browser()["baler hands"]
    assert told["scrolls"], "a wheel without Ctrl is the page's"
    assert told["held"]
    assert told["after"] == pytest.approx(told["before"], abs=1e-3)
    whole, wheeled, nearer, back, undone = told["widths"]
    assert wheeled < 0.7 * whole
    assert nearer == pytest.approx(wheeled / 1.25)
    assert back == pytest.approx(wheeled)
    assert undone == whole


@pytest.mark.slow
@in_a_browser
def test_a_view_that_is_not_there_is_refused() -> None:
    assert in_browser()["baler moon"] == "no view moon; there are machine, gears, mesh"
    assert in_browser()["gearless moon"] == "no view moon; there are machine"
