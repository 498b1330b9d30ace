"""What notebooks show of a drive and its stages: the report's figures, pictures, refusals, and no text unescaped."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import numpy as np
import pytest

import drives
import ncgear
from commands import ROOT, modules_after
from ncgear.design.reading.balance_file import load_balance
from ncgear.drawings.notebook.pieces import framed, made, refusal, running
from ncgear.drawings.page.tables import typeset
from ncgear.drawings.scene.scene import scene_of
from ncgear.figures.answers.machine import machine_facts
from ncgear.optimum.frontier import FamilyPoint, LawPoint
from ncgear.project.balancing import Balancing
from ncgear.project.best_law import BestLaw
from ncgear.project.frontier_run import Frontier
from ncgear.project.workshop_measures import cut_gears
from ncgear.shown import Shown

FAULT = "internal fault: "
MACHINE = "linkage: {crank_mm: 40, rod_mm: 90}\noperation: {speed_rpm: 30}\nmotion: {law: uniform_crank}"
FEW_TEETH = "gears: {teeth: 8, module_mm: 5, face_width_mm: 10}"


class Read(HTMLParser):
    """The text of some HTML, its elements, and the names that it gives and refers to; raises where it is not closed."""

    EMPTY = frozenset({"input", "img", "meta", "br"})

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []
        self.elements: list[str] = []
        self.styles = ""
        self.ids: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append(tag)
        self.ids += [str(value) for name, value in attrs if name == "id"]
        assert not any(name.startswith("on") for name, _ in attrs)
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in self.EMPTY:
            self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] == ["style"]:
            self.styles += data
        else:
            self.texts.append(data)

    @property
    def text(self) -> str:
        return " ".join("".join(self.texts).split())


def shown(value: Shown) -> Read:
    """What a notebook gets of a value: one well-formed piece that stands by itself."""
    html = value._repr_html_()
    read = Read(html)
    assert FAULT not in read.text
    assert not {"script", "iframe", "link", "object"} & set(read.elements)
    assert "http" not in html
    assert set(re.findall(r'(?:url\(|href=")#([\w-]+)', html)) <= set(read.ids)
    assert len(read.ids) == len(set(read.ids))
    return read


@pytest.mark.slow
def test_a_drive_shows_the_figures_of_its_report_and_the_machine() -> None:
    drive = drives.drive("pusher")
    read = shown(drive)
    for name, value in typeset(machine_facts(drive)):
        assert f"{name}{value}" in read.text
    assert "pusher" in read.text
    assert "crank slider" in read.text
    assert "this design's peak power is 39.9 % lower" in read.text
    assert read.elements.count("svg") == 6
    assert len(drive._repr_html_()) < 300_000


@pytest.mark.tiers(
    slow=[
        "law-crank slider",
        "machine-30 r/min",
        "motion-displacement",
        "check-8.7023 W at phi1 = 181.3 deg",
        "teeth-rack",
        "designed_contact-contact ratio",
        "strength-42CrMo4",
    ],
    rest="long",
)
@pytest.mark.parametrize(
    ("name", "words"),
    {
        "law": "crank slider",
        "transmission": "0.6033 to 1.776",
        "machine": "30 r/min",
        "motion": "displacement",
        "uniform_motion": "velocity",
        "check": "8.7023 W at phi1 = 181.3 deg",
        "pitch": "73.145 mm",
        "teeth": "rack",
        "designed_contact": "contact ratio",
        "solids": "index hole",
        "strength": "42CrMo4",
    }.items(),
)
def test_a_stage_shows_itself(name: str, words: str) -> None:
    value = getattr(drives.drive("pusher"), name)
    before = dict(vars(value))
    read = shown(value)
    assert type(value).__name__ in read.text
    assert words in read.text
    assert all(vars(value)[key] is held for key, held in before.items())


@pytest.mark.slow
def test_what_is_searched_for_shows_itself_and_searches_for_nothing() -> None:
    few = ncgear.loads(f"name: few\n{MACHINE}\n{FEW_TEETH}")
    search = ncgear.mending(few)
    assert search is not None
    assert "gears.cutter.kind" in shown(search).text
    assert search.found is not None
    assert "contact ratio 1.18" in shown(search.found).text
    best = BestLaw(drives.drive("baler-frontier").design)
    assert "searched for when" in shown(best).text
    assert "law" not in vars(best)
    law = LawPoint(6300.0, 28000.0, best.uniform_figures)
    text = shown(Frontier([law], [FamilyPoint(6300.0, None, None)])).text
    assert "28000" in text
    assert "hob" in shown(cut_gears(drives.drive("pusher"))[0]).text
    design = shown(drives.drive("pusher").design).text
    assert "motion.theta3_pi1" in design
    assert "gears.driving.bore_mm10" in design
    balance = Balancing(load_balance(ROOT / "designs" / "balance" / "sieve-and-pan.yaml"))
    assert "sieve-and-pan" in shown(balance).text


REFUSED = {
    "law": "linkage: {crank_mm: 40, rod_mm: 150}\noperation: {speed_rpm: 30}\n"
    "motion: {law: ratio_expression, ratio: '1 + 2*cos(phi)'}",
    "designed_contact": f"{MACHINE}\n{FEW_TEETH}",
}


@pytest.mark.slow
@pytest.mark.parametrize("part", REFUSED)
def test_what_does_not_exist_is_shown_as_its_refusal(part: str) -> None:
    drive = ncgear.loads(f"name: refused\n{REFUSED[part]}", "refused.yaml")
    with pytest.raises(ncgear.DesignError) as caught:
        getattr(drive, part)
    read = shown(drive)
    assert str(caught.value) in read.text
    # What can be made is shown; the same refusal stands once only.
    assert ("velocity" in read.text) is (part != "law")
    assert read.text.count(str(caught.value)) == 1


def test_a_fault_is_told_and_ends_nothing() -> None:
    def broken() -> None:
        raise ZeroDivisionError("no <b>")

    assert FAULT in made(broken)  # type: ignore[arg-type]
    assert "&lt;b&gt;" in made(broken)  # type: ignore[arg-type]

    class Unknown(Shown):
        pass

    assert FAULT in Unknown()._repr_html_()


EVIL = "</style><script>alert(1)</script><img src=x onerror=alert(1)>"


def test_nothing_that_a_design_says_becomes_html() -> None:
    named = {"name": EVIL, "description": f'"{EVIL}'}
    design = ncgear.loads(f"name: even\n{MACHINE}").design.model_copy(update=named)
    read = shown(ncgear.Drive(design))
    assert EVIL in read.text
    assert "img" not in read.elements
    assert EVIL in Read(framed(EVIL, refusal(EVIL), description=EVIL)).text
    # And a text that is not escaped is seen.
    with pytest.raises(AssertionError):
        Read(f"<p {EVIL}>")


@pytest.mark.parametrize("name", ["pusher", "spiral-pair", "uniform-crank"])
@pytest.mark.slow
def test_the_machine_runs_as_the_scene_says(name: str) -> None:
    """Every moving group has a way of its own, and frames are places of the scene."""
    scene = scene_of(drives.drive(name))
    html = running(scene)
    read = Read(html)
    moved = {one for one in read.ids if one.count("-") > 1}
    named = set(re.findall(r"animation-name: ([\w-]+);", read.styles))
    assert moved == named == set(re.findall(r"@keyframes ([\w-]+)\{", read.styles))
    poses = scene.poses(np.array([0.0]))
    for body, places in poses.places.items():
        (x, y), angle = places.origin_mm[0], places.angle_rad[0]
        first = re.search(rf"@keyframes [\w]+-[\w]+-{body}\{{0%\{{transform:(.*?)\}}", read.styles)
        assert first is not None
        numbers = [float(one) for one in re.findall(r"-?[\d.]+(?:e-?\d+)?", first[1])]
        assert numbers == pytest.approx([x, y, angle], rel=1e-5, abs=1e-5)


@pytest.mark.slow
def test_equal_charts_have_equal_names_and_others_do_not_share_any() -> None:
    chart = drives.drive("pusher").motion
    other = drives.drive("baler").motion
    ids = [set(shown(one).ids) for one in (chart, chart, other)]
    assert ids[0] == ids[1]
    assert not ids[0] & ids[2]


@pytest.mark.slow
def test_a_value_that_nobody_shows_loads_no_drawing() -> None:
    assert "matplotlib" not in modules_after("import ncgear.kinematics.motion, ncgear.shown")


def test_every_shown_value_has_a_picture() -> None:
    """Each class that says so has one; ``Unknown`` above has none."""
    from ncgear.drawings.notebook.values import _pieces

    def below(one: type[Shown]) -> set[type[Shown]]:
        return {one}.union(*map(below, one.__subclasses__()))

    ours = {one for one in below(Shown) - {Shown} if one.__module__.startswith("ncgear.")}
    assert len(ours) > 15
    bases = {one for one in ours if not any(issubclass(other, one) and other is not one for other in ours)}
    assert {one for one in bases if _pieces.dispatch(one) is _pieces.dispatch(object)} == set()
