"""A design file for ``ncgear design`` from ten answers: a machine's text with the given forces, masses and choices.

Kind, stroke, speed and wishes are answered as for any new machine (``design.beginning``).  The other answers are texts;
each kind of machine has likely answers to them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import pi
from typing import Any

from pydantic import ValidationError

from ncgear.design.beginning import begun
from ncgear.design.keys.design import Design
from ncgear.design.reading.messages import problems
from ncgear.design.reading.places import with_value
from ncgear.design.reading.text import plain_value, whole
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.rewritten import rewritten
from ncgear.design.template import MachineName, choices_template

FORCE, MASS, MATERIALS = "force", "mass", "materials"
PROCESSES, SPACE, FLYWHEEL = "processes", "space", "flywheel"

QUESTIONS = {
    FORCE: "greatest force against the slider in N x factor of shocks: 1 none, 1.25 light, 1.5 moderate, 1.75 heavy",
    MASS: "mass of the slider in kg, with all that moves with it",
    MATERIALS: "materials of the gears that may be chosen, between commas",
    PROCESSES: "ways of making the teeth: hobbed, shaped, wire_cut, printed, between commas",
    SPACE: "greatest centre distance of the gears in mm, or any",
    FLYWHEEL: "largest flywheel on the driven shaft in kg m2, or none",
}

ANY, NONE = "any", "none"

USUAL = ("hobbed",)
"""Ways of making the teeth if none is given."""

FORCES = ("force_n", "polynomial_n", "friction_n")
"""Keys of the resistance that hold forces, or values in proportion to forces."""

PLACES = 400
"""Number of steps of the stroke at which the resistance is computed."""

PRINTED = "PLA-print"

DISC = 7.85e-6 * pi / 640.0
"""Moment of inertia in kg mm2 of a solid steel disc, divided by the fifth power of its diameter in mm; its thickness is
a twentieth of its diameter."""

WIDE = 1.8
"""Diameter of the largest likely disc, in strokes."""

DIGITS = 2


def likely_answers(text: str) -> dict[str, str]:
    """The likely answers to all questions for a machine's text.

    The likely flywheel stores the work of a turn at the mean speed, if a disc of 1.8 strokes is enough.
    """
    data = read_yaml(text, "template").data
    stroke_mm, speed = 2.0 * data["linkage"]["crank_mm"], data["operation"]["speed_rpm"] * pi / 30.0
    forces = list(_forces(data["resistance"], stroke_mm))
    work_n_mm = sum((one + other) / 2.0 for stroke in forces for one, other in pairwise(stroke)) * stroke_mm / PLACES
    flywheel = min(2e3 * work_n_mm / speed**2, DISC * (WIDE * stroke_mm) ** 5) / 1e6
    material = data["gears"]["material"]
    return {
        FORCE: f"{max(map(max, forces)):.4g} x {data.get('strength', {}).get('application_factor', 1.0):g}",
        MASS: f"{data['masses']['slider_kg']:g}",
        MATERIALS: material,
        PROCESSES: "printed" if material == PRINTED else "hobbed",
        SPACE: ANY,
        FLYWHEEL: f"{flywheel:.{DIGITS}g}",
    }


def fault_of_answer(question: str, text: str, answer: str) -> str | None:
    """The fault of an answer, in the words of the design file; None for a right answer."""
    data = read_yaml(text + choices_template(_names(answer) if question == PROCESSES else USUAL), "template").data
    try:
        for key, value in _changed(data, text, {question: answer}):
            data = with_value(data, key, value)
        Design.model_validate(data)
    except ValidationError as error:
        return next(iter(problems(error, Design, data))).text
    except ValueError as error:
        return str(error)
    return None


def asked_text(
    name: str,
    machine: MachineName,
    sizes: Mapping[str, float],
    answers: Mapping[str, str],
    wishes: Mapping[str, Any] | None = None,
) -> str:
    """The text of a design file in which ``ncgear design`` finds the rest.

    ``sizes`` and ``wishes`` are as in ``design.beginning``.  The power is minimised, so a machine's own limit of power
    is left out.
    """
    text = begun(name, machine, sizes, wishes)
    build = f"ncgear build {name}.yaml    gears, into export/{name}"
    design = f"ncgear design {name}.yaml    whole machines, into export/{name}-machines"
    asked = text.replace(build, design) + choices_template(
        _names(answers[PROCESSES]) if PROCESSES in answers else USUAL
    )
    data = read_yaml(asked, "template").data
    values: dict[str, Any] = {"optimize.goal": "least_power"}
    if "peak_power_w" in data["optimize"]["limits"]:
        values["optimize.limits.peak_power_w"] = None
    return rewritten(asked, {**values, **dict(_changed(data, text, answers))})


def _changed(data: Mapping[str, Any], text: str, answers: Mapping[str, str]) -> Iterator[tuple[str, Any]]:
    """The values that answers other than the processes change, by dotted key; raises ValueError for an answer that is
    no number."""
    likely = likely_answers(text)
    for question, answer in answers.items():
        if question == FORCE:
            (force, *shocks), (likely_force, likely_shocks) = (one.split("x", 1) for one in (answer, likely[FORCE]))
            if _number(force) != float(likely_force):
                yield from _scaled(data["resistance"], "resistance", _number(force) / float(likely_force))
            if shocks and _number(shocks[0]) != float(likely_shocks):
                yield "strength.application_factor", _number(shocks[0])
        elif question == MASS:
            yield "masses.slider_kg", _number(answer)
        elif question == MATERIALS:
            names = _names(answer)
            yield "gears.material", names[0]
            if len(names) > 1:
                yield "choices.materials", names
        elif question == SPACE and answer != ANY:
            yield "choices.center_distance_mm", _number(answer)
        elif question == FLYWHEEL and answer != NONE:
            yield "optimize.driven_flywheel_kg_mm2", {"most": whole(float(f"{1e6 * _number(answer):.6g}"))}


def _number(answer: str) -> float:
    value = plain_value(answer.strip())
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not value > 0.0:
        raise ValueError(f"{answer.strip() or 'nothing'} given; a number over 0 is right")
    return value


def _names(answer: str) -> Sequence[str]:
    return [name for one in answer.split(",") if (name := one.strip())]


def _forces(resistance: Mapping[str, Any], stroke_mm: float) -> Iterator[list[float]]:
    """The force at even places of the stroke, on the way out and back, with friction."""
    for one in (resistance, resistance.get("returning", {"polynomial_n": [0.0]})):
        yield [
            resistance.get("friction_n", 0.0) + _force(one, place * stroke_mm / PLACES) for place in range(PLACES + 1)
        ]


def _force(stroke: Mapping[str, Any], place_mm: float) -> float:
    if "table" in stroke:
        table = stroke["table"]
        points = list(zip(table["displacement_mm"], table["force_n"], strict=True))
        for (start, first), (end, last) in pairwise(points):
            if place_mm <= end:
                return float(first + (last - first) * (place_mm - start) / (end - start))
        return float(points[-1][1])
    return float(sum(factor * place_mm**power for power, factor in enumerate(stroke.get("polynomial_n", [0.0]))))


def _scaled(group: Mapping[str, Any], path: str, factor: float) -> Iterator[tuple[str, Any]]:
    """All forces of the resistance times a factor, by dotted key."""
    for key, value in group.items():
        if isinstance(value, dict):
            yield from _scaled(value, f"{path}.{key}", factor)
        elif key in FORCES:
            each = [whole(float(f"{factor * one:.4g}")) for one in (value if isinstance(value, list) else [value])]
            yield f"{path}.{key}", each if isinstance(value, list) else each[0]
