"""What a new design begins with: a few answers, and the template in their proportions for all the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import StringIO
from typing import Any

from pydantic import ValidationError
from ruamel.yaml import YAML

from ncgear.design.keys.design import Design
from ncgear.design.mechanisms import usual_mechanism
from ncgear.design.reading.messages import problems
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.template import Law, template
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
"""What can be answered, and the key whose rules an answer must keep."""

LONGEST_LINE = 10_000
"""So that no line of the template is broken."""


def fault_of(answer: str, value: object) -> str | None:
    """What is wrong with the value of an answer by itself, in the words of the design file; None where nothing is."""
    if value is None:
        # A design file may leave some of these keys out, but the answer to a question is a number.
        return "nothing given; a number is needed"
    key = ANSWERS[answer]
    data = _with(read_yaml(template("new"), "template").data, key.split("."), value)
    try:
        Design.model_validate(data)
    except ValidationError as error:
        return next((problem.text for problem in problems(error, Design) if problem.key == key), None)
    return None


def fault_together(answers: Mapping[str, float]) -> str | None:
    """What is wrong with the linkage of some answers; None where nothing is."""
    own = proportioned(answers)
    if "stroke_mm" in answers and own["stroke_mm"] != answers["stroke_mm"]:
        return f"a crank of {own['crank_mm']:g} mm has a stroke of {own['stroke_mm']:g} mm; give one of the two"
    try:
        usual_mechanism(crank_mm=own["crank_mm"], rod_mm=own["rod_mm"])
    except WrongInput as error:
        return error.problem
    return None


def begun(name: str, law: Law, answers: Mapping[str, float]) -> str:
    """The design file of some answers; what is not answered keeps the template's proportions to what is.

    Speeds and acceleration of the slider, and the resistance, go with the stroke, so that laws keep their form; bores
    go with the gears.
    """
    text = template(name, law)
    return filled(text, dict(_values(read_yaml(text, "template").data, answers))) if answers else text


def filled(text: str, values: Mapping[str, Any]) -> str:
    """A design file with other values at some dotted keys; its comments stay."""
    yaml, made = YAML(), StringIO()
    yaml.width, yaml.preserve_quotes = LONGEST_LINE, True
    data = yaml.load(text)
    for key, value in values.items():
        _put(_at(data, groups) if (groups := key.rpartition(".")[0]) else data, key.rpartition(".")[2], value)
    yaml.dump(data, made)
    return made.getvalue()


def _put(group: Any, key: str, value: Any) -> None:
    """A list is filled anew item by item, so that it stays as it was written."""
    if isinstance(value, list):
        group[key][:] = value
    else:
        group[key] = value


def proportioned(answers: Mapping[str, float]) -> dict[str, float]:
    """Every answer: those given, and the template's; of stroke, crank and rod any one gives the others."""
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
    """The template's own values."""
    data = read_yaml(template("new"), "template").data
    return {answer: _at(data, key) for answer, key in ANSWERS.items()}


def _crank_mm(answers: Mapping[str, float], usual: Mapping[str, float]) -> float:
    if "crank_mm" in answers:
        return answers["crank_mm"]
    if "stroke_mm" in answers:
        return answers["stroke_mm"] / 2.0
    if "rod_mm" in answers:
        return _rounded(answers["rod_mm"] / usual["rod_mm"] * usual["crank_mm"])
    return usual["crank_mm"]


def _values(data: Any, answers: Mapping[str, float]) -> Iterator[tuple[str, Any]]:
    """Values by dotted key; those that keep the template's need no telling."""
    usual, own = template_answers(), proportioned(answers)
    keys = {answer: key for answer, key in ANSWERS.items() if answer != "stroke_mm" or "stroke_mm" in data["motion"]}
    yield from ((key, own[answer]) for answer, key in keys.items() if own[answer] != usual[answer])
    if own["crank_mm"] != usual["crank_mm"]:
        yield from _of_stroke(data, own["crank_mm"] / usual["crank_mm"])
    gears = own["teeth"] * own["module_mm"] / (usual["teeth"] * usual["module_mm"])
    if gears != 1.0:
        yield from ((key, _rounded(gears * _at(data, key), 2)) for key in BORES)


def _of_stroke(data: Any, scale: float) -> Iterator[tuple[str, Any]]:
    """What goes with the stroke: the slider's speeds, and the displacement that the resistance is a polynomial of."""
    if "v1_mm_s" in data["motion"]:
        yield from ((key, _rounded(scale * _at(data, key))) for key in SPEEDS)
    powers = enumerate(data["resistance"]["polynomial_n"])
    yield "resistance.polynomial_n", [_rounded(value / scale**power) for power, value in powers]


SPEEDS = ("motion.v1_mm_s", "motion.v2_mm_s", "motion.a1_mm_s2")
"""Of the slider, which go with the stroke."""

BORES = (
    "gears.driving.bore_mm",
    "gears.driving.keyway.width_mm",
    "gears.driving.keyway.depth_mm",
    "gears.driven.bore_mm",
)


def _rounded(value: float, digits: int = 4) -> float:
    """Few digits are enough for what nobody has given."""
    return whole(float(f"{value:.{digits}g}"))


def whole(value: float) -> float:
    """Whole numbers as such, which the file shows without a point."""
    return int(value) if float(value).is_integer() else value


def _at(data: Any, key: str) -> Any:
    for part in key.split("."):
        data = data[part]
    return data


def _with(data: Any, keys: list[str], value: object) -> Any:
    """The data with another value at a path."""
    return {**data, keys[0]: _with(data[keys[0]], keys[1:], value)} if keys else value
