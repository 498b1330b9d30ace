"""The documentation is complete and today's: a page for every command, every key, every picture, every link."""

from __future__ import annotations

import re
from io import BytesIO
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image

import drives
import ncgear
from at_once import at_once
from documented.installing import ROOT
from documented.pages import PAGES
from made import command_heads, drawings, figures, gallery, key_pages, kinds_page, material_page
from ncgear.design.keys.base import FORMULA
from ncgear.design.keys.design import Design
from ncgear.design.mechanisms import MECHANISMS
from ncgear.design.reference import keys_of
from ncgear.errors import NoSuchMechanism
from ncgear.figures.summary.check_summary import check_summary
from ncgear.mechanisms.resistance import FormulaResistance
from ncgear.numerics.formula import CHOICES, FUNCTIONS, composed
from ncgear.pitch.pair import refuse_corners
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.transmission import Lobes
from speed_against_error.run import STUDIES

DOCS = ROOT / "docs"
PACKAGE = ROOT / "src" / "ncgear"
TEXTS = {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in PAGES}

LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```", flags=re.DOTALL | re.MULTILINE)


def links(text: str) -> list[str]:
    """Targets of a page's links and pictures that lead to a file."""
    return [link.partition("#")[0] for link in LINK.findall(FENCED.sub("", text)) if "://" not in link]


def anchors(text: str) -> set[str]:
    """The anchors that headings have, as GitHub makes them."""
    heads = re.findall(r"^#+ (.*)$", FENCED.sub("", text), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_every_command_has_a_page_and_every_page_a_command() -> None:
    assert {page.stem for page in (DOCS / "commands").glob("*.md")} == set(command_heads.NAMES)


@at_once("name", command_heads.NAMES)
def test_heads_are_todays(name: str) -> None:
    page = TEXTS[f"docs/commands/{name}.md"]
    assert command_heads.with_head(page, name) == page, "run `make docs`"


@at_once("name", command_heads.NAMES)
def test_every_command_is_shown_at_work(name: str) -> None:
    by_hand = TEXTS[f"docs/commands/{name}.md"].partition(command_heads.END)[2]
    assert re.search(rf"^\$ ncgear {name}\b", by_hand, flags=re.MULTILINE)


@pytest.mark.slow
def test_pages_of_keys_are_todays() -> None:
    pages = {f"docs/{place}": text for place, text in key_pages.key_pages().items()}
    assert {place for place in TEXTS if place.startswith(f"docs/{key_pages.FOLDER}/")} < set(pages)
    assert [place for place, text in pages.items() if TEXTS.get(place) != text] == [], "run `make docs`"


def test_the_page_of_materials_is_todays() -> None:
    assert material_page.material_page() == TEXTS[f"docs/{material_page.NAME}"], "run `make docs`"


@pytest.mark.slow
def test_the_gallery_is_todays_and_small() -> None:
    assert gallery.gallery_page() == TEXTS[f"docs/{gallery.NAME}"], "run `make docs`"
    assert set(gallery.KINDS) == set(MECHANISMS)
    designs = {path.name for path in (ROOT / "designs").rglob("*.yaml")}
    assert {Path(link).name for link in links(TEXTS[f"docs/{gallery.NAME}"]) if link.endswith(".yaml")} == designs
    assert sum(path.stat().st_size for path in figures.IMAGES.glob(f"{gallery.PREFIX}*")) < 1_000_000


def unknown_names(page: str) -> list[str]:
    """Names in code on a page that are no key of a design file, command, law or design."""
    keys = {key.path for key in keys_of(Design)}
    known = keys | {key.law for key in keys_of(Design)} | set(gallery.PATHS) | set(gallery.TRAINS) | {"drive.pitch"}
    commands = {f"ncgear {name}" for name in command_heads.NAMES}
    return [
        name
        for name in re.findall(r"`([^`]+)`", page)
        if name not in known and not any(name.startswith(command) for command in commands)
    ]


def test_the_words_that_people_search_for_lead_to_what_exists() -> None:
    page = TEXTS["docs/words.md"]
    assert unknown_names(page) == []
    assert unknown_names("`wishes.dwell` `wishes.dwel` `ncgear bake`") == ["wishes.dwel", "ncgear bake"]
    rows = [line for line in page.splitlines() if line.startswith("| ") and "](" in line]
    assert len(rows) > 30
    for word in (
        "quick return",
        "dwell",
        "time ratio",
        "oval gears",
        "elliptical gears",
        "function generator",
        "Geneva",
    ):
        assert any(word in row.split("|")[1] for row in rows), word


@pytest.mark.slow
@pytest.mark.parametrize("name", ["pusher", "oval-flow-meter", "baler-a1-at-law-speed"])
def test_a_picture_of_the_gallery_is_drawn_as_it_is_kept(name: str) -> None:
    """Of a machine, of gears by themselves, of a machine whose gears are refused; a few pixels may differ by fonts."""
    drawn, kept = (
        np.asarray(Image.open(data).convert("L"), dtype=float)
        for data in (BytesIO(gallery.thumbnail(name)), figures.IMAGES / f"{gallery.PREFIX}{name}.png")
    )
    assert drawn.shape == kept.shape
    assert np.mean(np.abs(drawn - kept) > 40.0) < 0.001
    assert np.mean(drawn < 200.0) > 0.01


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("kind", kinds_page.KINDS)
def test_what_a_kind_offers_is_what_its_page_says(kind: str) -> None:
    """Every cell is tried anew; `make docs` writes the page."""
    page = TEXTS[f"docs/{kinds_page.NAME}"]
    heads, *rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("|")]
    refusals = dict(re.findall(r"^(\d+)\. (.*)$", page, flags=re.MULTILINE))
    column = heads.index(kind) + 1
    told = {cells[0]: cells[column] for cells in rows[1:]}
    for words, found in kinds_page.row(kind).items():
        cell = told[words]
        number = re.fullmatch(r"\[(\d+)\]\(#refusals\)", cell)
        assert found == (refusals[number[1]] if number else cell), words


@pytest.mark.thorough
def test_what_formulas_are_made_of_is_what_is_read() -> None:
    assert [name for name in [*FUNCTIONS, *CHOICES] if not re.search(rf"\b{name}\b", FORMULA)] == []
    section = TEXTS[f"docs/{key_pages.FORMULAS_PAGE}"]
    examples = [
        one
        for row in re.findall(r"^\|.*\| (`.*) \|$", section, flags=re.MULTILINE)
        for one in re.findall(r"`([^`]+)`", row)
    ]
    assert len(examples) >= 7
    for example in examples:
        composed(example, "", "x" if "x" in example.replace("exp", "").replace("max", "") else "phi")
    turn = Lobes(1, 1)
    for sound in ("1 if sin(phi) < 0 else 1 + sin(phi)**2", "1 + 0.2*max(0, sin(phi))**2", "1 + 0.2*abs(sin(phi))**3"):
        ratio_expression_law(sound, turn, scale_to_close=True)
    cornered = ratio_expression_law("1 + 0.2*max(0, sin(phi))", turn, scale_to_close=True)
    with pytest.raises(NoSuchMechanism, match="corner"):
        refuse_corners(cornered)
    with pytest.raises(NoSuchMechanism, match="infinite"):
        ratio_expression_law("1 + 0.2*abs(sin(phi))**1.5", turn, scale_to_close=True)
    ratio_expression_law("1 + 0.2*sqrt(sin(phi)**2 + 0.01)", turn, scale_to_close=True)
    steep = FormulaResistance("100*tanh((x - 20)/0.5) + 100")
    assert steep.work_n_mm(np.array([80.0]), 80.0) == pytest.approx(12_000.0, rel=1e-9)


@at_once("page", TEXTS)
def test_links_lead_somewhere(page: str) -> None:
    folder = (ROOT / page).parent
    assert [link for link in links(TEXTS[page]) if link and not (folder / link).exists()] == []


@at_once("page", TEXTS)
def test_anchors_exist(page: str) -> None:
    for link in LINK.findall(FENCED.sub("", TEXTS[page])):
        target, _, anchor = link.partition("#")
        if anchor and "://" not in link:
            text = ((ROOT / page).parent / target).read_text(encoding="utf-8") if target else TEXTS[page]
            assert anchor in anchors(text), link


def shown_pictures() -> set[Path]:
    """All pictures that a page shows."""
    return {
        ((ROOT / page).parent / link).resolve()
        for page, text in TEXTS.items()
        for link in links(text)
        if Path(link).suffix in {".png", ".gif", ".svg"}
    }


def test_every_picture_is_made_by_a_command_and_shown() -> None:
    ours = {path.name for path in shown_pictures() if path.parent == figures.IMAGES.resolve()}
    assert ours == figures.pictures() == {path.name for path in figures.IMAGES.iterdir()}


def test_the_other_pictures_are_those_of_the_studies() -> None:
    others = {path.stem for path in shown_pictures() if path.parent != figures.IMAGES.resolve()}
    assert others <= set(STUDIES)


def test_every_page_can_be_reached_from_the_readme() -> None:
    reached, left = set(), {ROOT / "README.md"}
    while left:
        page = left.pop().resolve()
        reached.add(page)
        found = {(page.parent / link).resolve() for link in links(page.read_text(encoding="utf-8")) if link}
        left |= {path for path in found if path.suffix == ".md"} - reached
    assert {page.resolve() for page in PAGES} <= reached


@pytest.mark.parametrize("share", [0.06, 0.39, 0.72])
def test_the_points_of_the_racks_picture_lie_on_the_teeth(share: float) -> None:
    """The equation of docs/method.md against the written outline, whose chords stray by their tolerance."""
    drive = ncgear.load(ROOT / "designs" / "ellipse.yaml")
    outline = shapely.LinearRing(drive.teeth.driving.outline_mm)
    points = drawings.shaped_points(drive, share * drive.pitch.driving.length_mm)
    off = shapely.distance(outline, shapely.points(points))
    assert off.size >= 3
    assert off.max() <= drive.chord_tolerance_mm


def test_the_keys_of_the_strokes_picture_are_those_of_the_motion() -> None:
    """Angles, speeds and slope that are marked against the speed that is drawn, from the law's own derivatives."""
    drive = ncgear.load(ROOT / "designs" / "baler.yaml")
    marks, omega = drawings.stroke_marks(drive), drive.law_speed_rpm * np.pi / 30.0
    moved = drive.machine.displacement(np.array(marks.theta_rad) - 1e-9, 2)
    speed, slope = omega * moved.derivative(1), omega * moved.derivative(2)
    assert speed == pytest.approx([marks.v1_mm_s, marks.v2_mm_s, marks.v2_mm_s, 0.0], abs=1e-4)
    assert slope == pytest.approx([0.0, 0.0, 0.0, marks.a1_mm_s_rad], abs=1e-4)
    # a1 is stated at 20 r/min, where the published baler has 1500 mm/s2.
    assert marks.a1_mm_s_rad * omega * (20.0 / drive.law_speed_rpm) ** 2 == pytest.approx(-1500.0)


class TestFaults:
    """So that the tests above can fail."""

    def test_an_old_head(self) -> None:
        page = TEXTS["docs/commands/check.md"].replace("--json", "--jason", 1)
        assert command_heads.with_head(page, "check") != page

    def test_links_in_code_are_none(self) -> None:
        assert links("[a](b.md)\n```sh\n[c](d.md)\n```\n[e](https://f) [g](#h)") == ["b.md", ""]

    def test_anchors(self) -> None:
        assert anchors("# What is: 3.5?\n```sh\n# no\n```\n## `motion`, law\n") == {"what-is-35", "motion-law"}


NAMED = re.compile(r"`((?:\w+/)+|(?:\w+/)*\w+\.py)`")
"""A file or folder that a page names, by its path from the package or from the repository."""


def named_and_missing(text: str) -> list[str]:
    return [name for name in NAMED.findall(text) if not any((root / name).exists() for root in (PACKAGE, ROOT))]


@at_once("page", [page for page in TEXTS if page != "docs/history.md"])
def test_files_that_pages_name_are_there(page: str) -> None:
    """But for the history, which names files that have gone."""
    assert named_and_missing(TEXTS[page]) == []


def test_a_file_that_is_gone_is_seen() -> None:
    text = "`teeth/flank.py`, `teeth/flunk.py`, `teeth/` and `flank.py`"
    assert named_and_missing(text) == ["teeth/flunk.py", "flank.py"]


JUDGES = TEXTS["docs/how-it-is-tested.md"]


def groups_without_a_judge(page: str) -> set[str]:
    """Groups of what ``ncgear build`` and ``ncgear check`` write of some designs that no row of the page names."""
    summaries = [drives.built("ellipse").summary, check_summary(drives.drive("baler-66-two-stage"))]
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `")]
    return set(chain.from_iterable(summaries)) - set(re.findall(r"`(\w+)`", " ".join(rows)))


@pytest.mark.slow
def test_every_group_of_the_summary_has_a_judge() -> None:
    assert groups_without_a_judge(JUDGES) == set()
    assert groups_without_a_judge(JUDGES.replace("| `bodies` |", "| bodies |")) == {"bodies"}


def test_every_row_of_judges_names_a_test() -> None:
    """But for the clock's, which no test asserts; files that are named exist, as on every page."""
    rows = [line for line in JUDGES.splitlines() if line.startswith("|") and not line.startswith("|---")]
    heads = [line for line in rows if line.endswith("| where |")]
    assert len(heads) == 10
    without = [line.split("|")[1].strip() for line in rows if line not in heads and "`tests/" not in line]
    assert without == ["`timing_s`"]
