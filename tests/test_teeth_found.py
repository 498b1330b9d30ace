"""Teeth that a report names: their places and numbers are those of the exact flanks, and a click turns them there.

The judge is the flanks' own curves: the middle between the points where both flanks of a tooth cross the rack's line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import reports
from at_once import at_once
from drives import drive
from ncgear.drawings.page.tables import ToothLinks
from ncgear.drawings.scene.geared_pairs import SceneGear
from ncgear.drawings.scene.scene import Scene
from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import KnownParts, judged
from ncgear.figures.tables import Column, Table
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating, known_rating
from ncgear.teeth.tips import Limit
from scenes import in_a_browser, scene

DESIGNS = ["pump-1-2", "internal-1-2", "spiral-pair", "helical-ellipse", "desk-toy", "baler-66-two-stage"]


def gears_of(name: str) -> Iterator[tuple[Drive, SceneGear]]:
    pairs = zip(drive(name).by_stage, scene(name).pairs, strict=True)
    return ((pair, gear) for pair, drawn in pairs for gear in (drawn.driving, drawn.driven))


def middles_mm(pair: Drive, gear: SceneGear) -> Array:
    """The middles of the teeth between their exact flanks, in the view of the scene, shape (z, 2)."""
    flanks = pair.teeth.of(gear.gear).flanks
    numbers = np.arange(2 * flanks.teeth)
    points, _ = flanks.flank(numbers, np.zeros(numbers.size))
    return gear.mounting.seen(points.reshape(-1, 2, 2).mean(axis=1))


def nearest(points: Array, others: Array) -> list[int]:
    apart = np.linalg.norm(points[:, None] - others[None], axis=-1)
    return np.argmin(apart, axis=1).tolist()


@pytest.mark.tiers(quick=["pump-1-2", "spiral-pair"], slow=["desk-toy"], rest="long")
@pytest.mark.parametrize("name", DESIGNS)
def test_teeth_are_where_their_exact_flanks_are(name: str) -> None:
    for pair, gear in gears_of(name):
        exact, module = middles_mm(pair, gear), pair.pitch.size.module_mm
        assert len(gear.teeth_mm) == pair.teeth.of(gear.gear).teeth
        assert np.linalg.norm(gear.teeth_mm - exact, axis=1).max() < 0.1 * module + pair.gears.backlash_mm
        numbers = list(range(len(exact)))
        assert nearest(gear.teeth_mm, exact) == numbers
        assert nearest(np.roll(gear.teeth_mm, 1, axis=0), exact) != numbers
        below = np.linalg.norm(gear.numbers_mm - exact, axis=1)
        assert np.all((below > 1.9 * module) & (below < 2.5 * module))


def links(markup: str) -> list[tuple[str, int]]:
    return [(gear, int(tooth)) for gear, tooth in re.findall(r'data-gear="([\w-]+)" data-tooth="(\d+)"', markup)]


def teeth_of(made: Drive, kind: Kind) -> set[tuple[str, int]]:
    """The teeth that an advice of a kind may name."""
    both = {gear.value: made.teeth.of(gear) for gear in Gear}
    if kind in (Kind.UNDERCUT, Kind.POINTED, Kind.SHORTENED):
        marked = {name: gear.tips.undercut | (gear.tips.limit != Limit.FULL) for name, gear in both.items()}
        return {(name, int(tooth)) for name, gear in both.items() for tooth in gear.flanks.tooth[marked[name]]}
    rating = known_rating(made)
    if kind is Kind.STRENGTH and isinstance(rating, Rating):
        return {(one.gear.value, one.tooth) for one in rating.weakest}
    if kind is Kind.FLANKS and isinstance(rating, Rating):
        wear = made.surfaces_by(rating.strength.method).wear
        return {(gear.value, depth.tooth(gear)) for gear, depth in zip(Gear, wear.depth_mm, strict=True)}
    return set()


@pytest.mark.tiers(quick=["internal-1-2"], slow=["rounded-square"], rest="long")
@pytest.mark.parametrize("name", ["pump-1-2", "internal-1-2", "baler-holds", "rounded-square", "baler-86"])
def test_links_of_a_warning_are_its_teeth(name: str) -> None:
    """By the teeth that the drive has as values; further ones are those that its words put in brackets."""
    made_of = drive(name)
    for advice in judged(made_of, KnownParts.TEETH).advices:
        known = teeth_of(made_of, advice.kind)
        said = f"{advice.what}; {advice.meaning}"
        made = ToothLinks().text(said)
        bracketed = {tooth for _, tooth in links(str(ToothLinks().text(re.sub(r"^[^(]*", "", said), "any")))}
        assert bool(known) == bool(links(made))
        assert all(one in known or one[1] in bracketed for one in links(made))
        assert re.sub(r"<[^>]*>", "", made).replace("&#39;", "'") == said


@at_once(
    ("words", "found"),
    [
        ("tooth 28 of the driven gear", [("driven", 28)]),
        ("teeth 1-3, 7 of the driving gear, by up to 2 mm (tooth 2)", [("driving", n) for n in (1, 3, 7, 2)]),
        (
            "tooth 4 of the driving gear bends (also driven gear, pitting: 0.8 at tooth 14)",
            [("driving", 4), ("driven", 14)],
        ),
        ("from 32 driving teeth on there is none; tooth thickness 3 mm", []),
        ("tooth 3, of no gear", []),
    ],
)
def test_words_that_name_teeth(words: str, found: list[tuple[str, int]]) -> None:
    assert links(ToothLinks().text(words)) == found


def test_words_of_a_stage_name_its_gears() -> None:
    made = ToothLinks(2).text("tooth 5 of the driving gear <b>")
    assert links(made) == [("driving-2", 5)]
    assert 'aria-label="show tooth 5 of the driving gear, stage 2"' in made
    assert "&lt;b&gt;" in made


def test_cells_that_hold_teeth() -> None:
    weak = Table("Weakest teeth", (Column(""), Column("safety"), Column("tooth")), (("driven", "0.8", "14"),))
    (row,) = ToothLinks().rows(weak)
    assert [links(cell) for cell in row.cells] == [[], [], [("driven", 14)]]
    heads = Column(""), Column("driving"), Column("driven"), Column("")
    rows = ("number of teeth", "24", "48", ""), ("teeth with shortened tips", "3-5, by up to 2 mm (tooth 4)", "-", "")
    count, tips = ToothLinks().rows(Table("Teeth", heads, rows))
    assert [links(cell) for cell in count.cells] == [[], [], [], []]
    assert [links(cell) for cell in tips.cells] == [[], [("driving", 3), ("driving", 5), ("driving", 4)], [], []]


def test_notes_of_a_gear_s_table_name_its_teeth() -> None:
    notes = "no pin in the space after tooth 16", "elsewhere"
    table = Table("The driven gear is cut by", (Column("tool"),), (("hob",),), notes, ("held beside tooth 7",))
    assert [links(note) for note in ToothLinks().notes(table)] == [[("driven", 16)], []]
    (row,) = ToothLinks().rows(table)
    assert links(row.note) == [("driven", 7)]


@pytest.fixture
def opened(browser: Any, request: pytest.FixtureRequest, tmp_path: Any) -> Iterator[Any]:
    """The report of a design in a browser without network."""
    path = tmp_path / "report.html"
    path.write_text(reports.page(request.param), encoding="utf-8")
    context = browser.new_context(offline=True, reduced_motion="reduce", viewport={"width": 1400, "height": 900})
    page = context.new_page()
    page.goto(path.as_uri())
    yield page
    context.close()


MARK = """() => {
  const mark = document.querySelector("svg.scene .mark");
  if (!mark) return null;
  const world = document.querySelector("svg.scene g.world");
  const at = new DOMPoint(mark.cx.baseVal.value, mark.cy.baseVal.value);
  const there = at.matrixTransform(world.getScreenCTM().inverse().multiply(mark.getScreenCTM()));
  return [there.x, there.y];
}"""
"""Where the mark is, in mm of the scene."""


def marked_tooth(found: Scene, pair: Drive, gear: SceneGear, place: list[float], phi1: float) -> int:
    """The number of the tooth whose exact flanks are nearest to a place, at a driving angle."""
    there = found.poses(np.array([phi1])).places[gear.body.name]
    turn, origin = float(there.angle_rad[0]), there.origin_mm[0]
    middles = middles_mm(pair, gear) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) + origin
    return int(np.argmin(np.linalg.norm(middles - np.array(place), axis=1))) + 1


@pytest.mark.tiers(slow=["internal-1-2"], rest="long")
@in_a_browser
@pytest.mark.parametrize("opened", ["pump-1-2", "internal-1-2", "spiral-pair"], indirect=True)
def test_a_tooth_is_turned_to_the_mesh_and_marked(opened: Any, request: pytest.FixtureRequest) -> None:
    name = request.node.callspec.params["opened"]
    found = scene(name)
    for pair, gear in gears_of(name):
        opened.select_option("#find-gear", gear.body.name)
        for number in (1, 2, len(gear.teeth_mm) // 2, len(gear.teeth_mm)):
            opened.fill("#find-tooth", str(number))
            opened.press("#find-tooth", "Enter")
            phi1, place = opened.evaluate("ncgear.drivingAngle()"), opened.evaluate(MARK)
            assert marked_tooth(found, pair, gear, place, phi1) == number
            at_the_mesh = found.poses(np.array([phi1])).pitch_points_mm[0][0].tolist()
            # A last tooth that stands half beyond the range of gears that turn less than once never comes there.
            if not found.swings or 0.0 < phi1 < 0.999 * found.loop_rad:
                assert place == pytest.approx(at_the_mesh, abs=1e-3 * pair.pitch.size.module_mm)
            assert f"tooth {number} of the {gear.gear.value} gear" in opened.inner_text("#found")
            assert opened.is_checked('input[name="view"][value="mesh"]')


@pytest.mark.slow
@in_a_browser
@pytest.mark.parametrize("opened", ["pump-1-2"], indirect=True)
def test_a_named_tooth_is_found_by_keyboard(opened: Any) -> None:
    link = opened.get_by_role("link", name="show tooth 15 of the driving gear").first
    link.focus()
    opened.keyboard.press("Enter")
    pair, gear = next(gears_of("pump-1-2"))
    phi1, place = opened.evaluate("ncgear.drivingAngle()"), opened.evaluate(MARK)
    assert marked_tooth(scene("pump-1-2"), pair, gear, place, phi1) == 15
    assert opened.evaluate("document.activeElement.dataset.tooth") == "15"
    box = opened.locator("svg.scene").bounding_box()
    mark = opened.locator("svg.scene .mark").bounding_box()
    assert box["y"] >= 0.0
    assert box["y"] < mark["y"] + mark["height"] / 2.0 < box["y"] + box["height"]
    assert opened.locator("svg.scene .number.named").text_content() == "15"


@pytest.mark.slow
@in_a_browser
@pytest.mark.parametrize("opened", ["pump-1-2"], indirect=True)
def test_numbers_are_shown_on_demand_and_wrong_ones_are_told(opened: Any) -> None:
    shown = opened.locator("svg.scene .number:visible")
    assert shown.count() == 0
    opened.check("#numbers")
    assert shown.all_text_contents() == [str(n) for z in (24, 48) for n in range(1, z + 1)]
    upright = opened.evaluate(
        "[...document.querySelectorAll('.number')].map(t => t.getScreenCTM()).map(m => [m.b / m.a, m.a, m.d])"
    )
    assert all(abs(slope) < 1e-4 and right > 0.0 and down > 0.0 for slope, right, down in upright)
    opened.uncheck("#numbers")
    assert shown.count() == 0
    opened.fill("#find-tooth", "25")
    opened.press("#find-tooth", "Enter")
    assert "teeth 1 to 24" in opened.inner_text("#found")
    assert opened.evaluate(MARK) is None
    opened.fill("#find-tooth", "24")
    opened.press("#find-tooth", "Enter")
    assert opened.evaluate(MARK) is not None
    opened.fill("#find-tooth", "")
    opened.press("#find-tooth", "Tab")
    assert opened.evaluate(MARK) is None
