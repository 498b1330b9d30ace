"""The registry of laws: what a law needs to be one, and that nothing outside its modules knows which laws there are."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from at_once import at_once
from commands import ROOT
from ncgear.design.keys.design import Design
from ncgear.design.laws.registry import LawName, law_keys
from ncgear.design.laws.uniform_crank import UniformCrank
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.reference import law_of
from ncgear.design.template import motion_of, template
from ncgear.figures.summary.check_summary import check_summary
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import Law, Lobes, PrescribedStroke, single
from ncgear.screening.single import single_figures
from oracles.laws import REFERENCES

SOURCE = ROOT / "src" / "ncgear"


def test_every_law_has_a_reference_of_its_own() -> None:
    assert list(REFERENCES) == list(LawName)


@at_once("law", LawName)
def test_the_module_of_a_law_describes_the_law_of_its_name(law: LawName) -> None:
    found = law_keys(law)
    assert law_of(found) == law
    assert motion_of(law).startswith("motion: ")
    assert found.CHOICE


@at_once("law", LawName)
def test_what_a_law_says_of_its_template_is_there(law: LawName) -> None:
    found, motion = law_keys(law), read_yaml(template("a", law), "template").data["motion"]
    assert set(found.GROWS_WITH_MACHINE) <= set(motion)
    assert set(found.EXAMPLES) <= set(found.model_fields)
    assert (found.ASKED_LENGTH == "stroke_mm") == ("stroke_mm" in motion)


BY_LAW = ("design/laws/", "design/reading/", "screening/")
"""Rooms that may tell laws apart: what describes them, what reads the points of a table, and what computes many designs
of two of the laws at once."""


def knows_a_law(path: Path) -> bool:
    """Whether a module imports from the module of a law, or asks for one by its name."""
    modules = {f"ncgear.design.laws.{law}" for law in LawName}
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    imported = {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    asked = [node for node in nodes if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "LawName"]
    return bool(asked or imported & modules)


@pytest.mark.slow
def test_nothing_else_tells_laws_apart() -> None:
    found = [path.relative_to(SOURCE).as_posix() for path in SOURCE.rglob("*.py") if knows_a_law(path)]
    assert [name for name in found if not name.startswith(BY_LAW)] == []
    assert any(name.startswith("screening/") for name in found)


class Pressing(UniformCrank):
    """A law of the slider's stroke as anyone may add it: an even crank, called a stroke."""

    def law_on(self, linkage: CrankSlider, lobes: Lobes, *, ring: bool = False) -> Law:
        """With facts that no other law has."""
        facts = {"pressed_mm": 12.5, "return_form": "even"}
        return Law(linkage, single(self.transmission(linkage, lobes)), PrescribedStroke(10.0, -1e-13, facts))


@pytest.mark.thorough
def test_a_law_of_the_stroke_tells_its_own_facts() -> None:
    data = read_yaml(template("a", LawName.UNIFORM_CRANK), "template").data
    design = Design.model_validate(data).model_copy(update={"motion": Pressing(law="uniform_crank")})
    drive = Drive(design)
    summary = check_summary(drive)
    assert (summary["drive"]["pressed_mm"], summary["drive"]["return_form"]) == (12.5, "even")
    assert drive.law_speed_rpm == pytest.approx(95.49296585513721, rel=1e-15)
    assert summary["check"]["at_law_speed"]["speed_rpm"] == drive.law_speed_rpm
    assert summary["closure"]["stroke_residual_mm"] == 1e-13
    assert single_figures(design)["closure.stroke_residual_mm"] == 1e-13
