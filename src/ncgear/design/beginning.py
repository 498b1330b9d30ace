"""A new design from a few answers: the template of its law, with all other values in proportion to the answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from ncgear.design.keys.design import Design
from ncgear.design.laws.registry import LawName, design_law
from ncgear.design.mechanisms import usual_mechanism
from ncgear.design.reading.messages import problems
from ncgear.design.reading.places import Document, with_value
from ncgear.design.reading.text import whole
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.rewritten import rewritten
from ncgear.design.template import template
from ncgear.errors import WrongInput

ANSWERS = {
    "stroke_mm": "motion.stroke_mm",
    "crank_mm": "linkage.crank_mm",
    "rod_mm": "linkage.rod_mm",
    "speed_rpm": "operation.speed_rpm",
    "teeth": "gears.teeth",
    "module_mm": "gears.module_mm",
    "face_width_mm": "gears.face_width_mm",
}
"""The possible answers, each with the key of the design file whose rules it must keep."""

BORES = (
    "gears.driving.bore_mm",
    "gears.driving.keyway.width_mm",
    "gears.driving.keyway.depth_mm",
    "gears.driven.bore_mm",
)
"""Keys of the template that grow with the gears."""


def fault_of(answer: str, value: object) -> str | None:
    """The fault of one answer by itself, in the words of the design file; None where there is none."""
    if value is None:
        # A design file may leave some of these keys out, but the answer to a question is a number.
        return "nothing given; a number is needed"
    key = ANSWERS[answer]
    try:
        Design.model_validate(with_value(_template().data, key, value))
    except ValidationError as error:
        return next((problem.text for problem in problems(error, Design) if problem.key == key), None)
    return None


def fault_together(answers: Mapping[str, float]) -> str | None:
    """The fault of the linkage that some answers give together; None where there is none."""
    own = proportioned(answers)
    if "stroke_mm" in answers and own["stroke_mm"] != answers["stroke_mm"]:
        return f"a crank of {own['crank_mm']:g} mm has a stroke of {own['stroke_mm']:g} mm; give one of the two"
    try:
        usual_mechanism(crank_mm=own["crank_mm"], rod_mm=own["rod_mm"])
    except WrongInput as error:
        return error.problem
    return None


def begun(name: str, law: LawName, answers: Mapping[str, float]) -> str:
    """The text of a design file with some answers; all other values keep the template's proportions to them.

    The speeds and the acceleration of the slider grow with the stroke, and the resistance extends over the whole of it,
    so that the law keeps its form.  The bores grow with the gears.
    """
    text = template(name, law)
    return rewritten(text, dict(_values(read_yaml(text, "template"), answers))) if answers else text


def proportioned(answers: Mapping[str, float]) -> dict[str, float]:
    """All answers: the given ones, or else the template's; any one of stroke, crank and rod gives the other two."""
    usual = template_answers()
    crank = _crank_mm(answers, usual)
    rod = answers.get("rod_mm", _rounded(crank / usual["crank_mm"] * usual["rod_mm"]))
    return {
        **usual,
        **{one: whole(value) for one, value in answers.items()},
        "stroke_mm": whole(2.0 * crank),
        "crank_mm": whole(crank),
        "rod_mm": rod,
    }


def template_answers() -> dict[str, float]:
    """The answers that give the template itself."""
    usual = _template()
    return {answer: usual.at(key) for answer, key in ANSWERS.items()}


def _template() -> Document:
    return read_yaml(template("new"), "template")


def _crank_mm(answers: Mapping[str, float], usual: Mapping[str, float]) -> float:
    if "crank_mm" in answers:
        return answers["crank_mm"]
    if "stroke_mm" in answers:
        return answers["stroke_mm"] / 2.0
    if "rod_mm" in answers:
        return _rounded(answers["rod_mm"] / usual["rod_mm"] * usual["crank_mm"])
    return usual["crank_mm"]


def _values(of_law: Document, answers: Mapping[str, float]) -> Iterator[tuple[str, Any]]:
    """The values that differ from those of the law's template, by dotted key."""
    usual, own = template_answers(), proportioned(answers)
    keys = {answer: key for answer, key in ANSWERS.items() if answer != "stroke_mm" or of_law.at(key) is not None}
    yield from ((key, own[answer]) for answer, key in keys.items() if own[answer] != usual[answer])
    if own["crank_mm"] != usual["crank_mm"]:
        yield from _of_stroke(of_law.data, own["crank_mm"] / usual["crank_mm"])
    gears = own["teeth"] * own["module_mm"] / (usual["teeth"] * usual["module_mm"])
    if gears != 1.0:
        yield from ((key, _rounded(gears * of_law.at(key), 2)) for key in BORES)


def _of_stroke(data: Any, scale: float) -> Iterator[tuple[str, Any]]:
    """The values that change with the stroke: keys of the law, and the polynomial of the resistance.

    The polynomial has the same force at the same share of the stroke.
    """
    law = design_law(LawName(data["motion"]["law"]))
    yield from ((f"motion.{key}", _rounded(scale * data["motion"][key])) for key in law.grows_with_stroke)
    powers = enumerate(data["resistance"]["polynomial_n"])
    yield "resistance.polynomial_n", [_rounded(value / scale**power) for power, value in powers]


def _rounded(value: float, digits: int = 4) -> float:
    """The value rounded to a few digits, which are enough for values that nobody has given."""
    return whole(float(f"{value:.{digits}g}"))
