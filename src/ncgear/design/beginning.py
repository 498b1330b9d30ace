"""A new design from a few answers, or from a drawing: the text of a law or a machine, all other values in proportion.

Wishes of the motion are words of the command line, each in the form ``KEY: VALUE`` of the group ``wishes`` of a file.
The ending of a drawing's file gives the keys that name it, and reading the file gives unit and tolerance.

For ``ncgear design`` the other answers are texts; each kind of machine has likely answers to them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import pi
from typing import Any, get_origin

from pydantic import ValidationError

from ncgear.design.keys.design import Design
from ncgear.design.laws.registry import DEFAULT_LAW, LawName, law_keys
from ncgear.design.mechanisms import usual_mechanism
from ncgear.design.reading.messages import problems
from ncgear.design.reading.places import Document, with_value
from ncgear.design.reading.text import plain_value, quoted, whole
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.rewritten import rewritten
from ncgear.design.template import MachineName, choices_template, machine_template, template
from ncgear.design.wishes.registry import Wishes
from ncgear.design.words import listed
from ncgear.errors import WrongInput

Beginning = LawName | MachineName
"""The beginning of a new design."""

ANSWERS = {
    "stroke_mm": "motion.stroke_mm",
    "crank_mm": "linkage.crank_mm",
    "rod_mm": "linkage.rod_mm",
    "speed_rpm": "operation.speed_rpm",
    "teeth": "gears.teeth",
    "module_mm": "gears.module_mm",
    "face_width_mm": "gears.face_width_mm",
    "application_factor": "strength.application_factor",
}
"""The possible answers, each with the key of the design file whose rules it must keep."""

BORES = tuple(
    f"gears.{gear}.{key}" for gear in ("driving", "driven") for key in ("bore_mm", "keyway.width_mm", "keyway.depth_mm")
)
"""Keys that grow with the gears, if a text has them."""

SIZED = ("resistance", "masses", "wishes", "optimize")
"""Groups whose values grow with the stroke and with the speed; the unit at the end of a key tells how."""

GROWTH = {
    "_kg_mm2": (2, 0),
    "_mm_s3": (1, 3),
    "_mm_s2": (1, 2),
    "_mm_s": (1, 1),
    "_rpm": (0, 1),
    "_mm": (1, 0),
    "_w": (1, 1),
}
"""Powers of the stroke and of the speed with which a value grows if the same forces and masses move, by its unit."""


def fault_of(answer: str, value: object) -> str | None:
    """The fault of one answer by itself, in the words of the design file; None for a right answer."""
    if value is None:
        # A design file may leave some of these keys out, but the answer to a question is a number.
        return "nothing given; a number is needed"
    key = ANSWERS[answer]
    data = with_value(_document(DEFAULT_LAW).data, key, value)
    try:
        Design.model_validate(data)
    except ValidationError as error:
        return next((problem.text for problem in problems(error, Design, data) if problem.key == key), None)
    return None


def fault_together(answers: Mapping[str, float], beginning: Beginning = DEFAULT_LAW) -> str | None:
    """The fault of the linkage that some answers give together; None for a right linkage."""
    own = proportioned(answers, beginning)
    if "stroke_mm" in answers and own["stroke_mm"] != answers["stroke_mm"]:
        return f"a crank of {own['crank_mm']:g} mm has a stroke of {own['stroke_mm']:g} mm; give one of the two"
    try:
        usual_mechanism(crank_mm=own["crank_mm"], rod_mm=own["rod_mm"])
    except WrongInput as error:
        return error.problem
    return None


def begun(
    name: str, beginning: Beginning, answers: Mapping[str, float], wishes: Mapping[str, Any] | None = None
) -> str:
    """The text of a design file with some answers; all other values keep the usual proportions to them.

    The slider's speeds and acceleration, and the driving speeds that they hold at, grow with the stroke and with the
    speed; the resistance extends over the whole stroke.  So the law keeps its form.  The places of a machine's masses,
    its limits and its wishes also follow its stroke and its speed.  The bores grow with the gears.  ``wishes`` by their
    kinds, in the form of a design file, stay unchanged; they replace the machine's wishes of the same kind.
    """
    values = dict(_values(_document(beginning), beginning, answers)) if answers else {}
    if isinstance(beginning, LawName):
        text = template(name, beginning, wishes)
    else:
        text = machine_template(name, beginning)
        values |= {f"wishes.{kind}": value for kind, value in (wishes or {}).items()}
    return rewritten(text, values) if values else text


def proportioned(answers: Mapping[str, float], beginning: Beginning = DEFAULT_LAW) -> dict[str, float]:
    """All answers: the given answers, or else the usual ones; stroke, crank or rod alone gives the other two."""
    usual = usual_answers(beginning)
    crank = _crank_mm(answers, usual)
    rod = answers.get("rod_mm", _rounded(crank / usual["crank_mm"] * usual["rod_mm"]))
    return {
        **usual,
        **{name: whole(value) for name, value in answers.items()},
        "stroke_mm": whole(2.0 * crank),
        "crank_mm": whole(crank),
        "rod_mm": rod,
    }


def usual_answers(beginning: Beginning = DEFAULT_LAW) -> dict[str, float]:
    """The answers that give the unchanged text of a law or a machine."""
    usual = _document(beginning)
    found = {answer: value for answer, key in ANSWERS.items() if (value := usual.at(key)) is not None}
    return {**found, "stroke_mm": whole(2.0 * found["crank_mm"])}


def _document(beginning: Beginning) -> Document:
    return read_yaml(begun("new", beginning, {}), "template")


def _crank_mm(answers: Mapping[str, float], usual: Mapping[str, float]) -> float:
    if "crank_mm" in answers:
        return answers["crank_mm"]
    if "stroke_mm" in answers:
        return answers["stroke_mm"] / 2.0
    if "rod_mm" in answers:
        return _rounded(answers["rod_mm"] / usual["rod_mm"] * usual["crank_mm"])
    return usual["crank_mm"]


def _values(document: Document, beginning: Beginning, answers: Mapping[str, float]) -> Iterator[tuple[str, Any]]:
    """The values that differ from the values of the text, by dotted key."""
    usual, own = usual_answers(beginning), proportioned(answers, beginning)
    keys = {answer: key for answer, key in ANSWERS.items() if document.at(key) is not None}
    if "application_factor" in answers:
        keys["application_factor"] = ANSWERS["application_factor"]
    yield from ((key, own[answer]) for answer, key in keys.items() if own[answer] != usual.get(answer))
    longer, faster = (own[name] / usual[name] for name in ("crank_mm", "speed_rpm"))
    if (longer, faster) != (1.0, 1.0):
        law = law_keys(LawName(document.at("motion.law")))
        moved = {key: value for key, value in document.data["motion"].items() if key in law.GROWS_WITH_MACHINE}
        yield from _grown({**{group: document.data.get(group) for group in SIZED}, "motion": moved}, longer, faster)
    gears = own["teeth"] * own["module_mm"] / (usual["teeth"] * usual["module_mm"])
    if gears != 1.0:
        yield from ((key, _rounded(gears * document.at(key), 2)) for key in BORES if document.at(key) is not None)


def _grown(data: Mapping[str, Any], longer: float, faster: float) -> Iterator[tuple[str, Any]]:
    """The values of a longer and faster machine with the same forces and masses, by dotted key.

    Lists count as one value.  A polynomial keeps its force at each share of the stroke.
    """

    def of_key(key: str, value: Any) -> Any:
        if isinstance(value, dict):
            return {name: of_key(name, inner) for name, inner in value.items()}
        if key == "polynomial_n":
            return [_rounded(coefficient / longer**power) for power, coefficient in enumerate(value)]
        if isinstance(value, list):
            return [of_key(key, item) for item in value]
        unit = next((unit for unit in GROWTH if key.endswith(unit)), None)
        if unit is None:
            return value
        # A person may have given the driving speed, with all its digits.
        digits = 12 if unit == "_rpm" else 4
        return _rounded(value * longer ** GROWTH[unit][0] * faster ** GROWTH[unit][1], digits)

    def changed(path: str, value: Any) -> Iterator[tuple[str, Any]]:
        if isinstance(value, dict):
            for name, inner in value.items():
                yield from changed(f"{path}.{name}", inner)
        elif (new := of_key(path.rpartition(".")[2], value)) != value:
            yield path, new

    for group, value in data.items():
        yield from changed(group, value)


def _rounded(value: float, digits: int = 4) -> float:
    """The value rounded to a few digits, which are enough for values that nobody has given."""
    return whole(float(f"{value:.{digits}g}"))


OPTION = "--wish"
EXAMPLE = "time_ratio: {at_least: 1.5}"

SEVERAL = tuple(name for name, field in Wishes.model_fields.items() if get_origin(field.annotation) is tuple)
"""Kinds of wishes that a design can have several times: lists in its file."""


def wishes_told(texts: Iterable[str]) -> dict[str, Any]:
    """The wishes of some texts by their kinds, in the form of a design file; several wishes of a kind are a list.

    Raises WrongInput for a text without the form ``KEY: VALUE``, for values that no design file can have, and for
    wishes that contradict each other.
    """
    found: dict[str, Any] = {}
    for text in texts:
        for kind, value in _pairs(text):
            if kind in SEVERAL:
                found.setdefault(kind, []).extend(value if isinstance(value, list) else [value])
            elif kind in found:
                raise WrongInput(f"{kind} is given twice; give it once", key=OPTION)
            else:
                found[kind] = value
    try:
        Wishes.model_validate(found)
    except ValidationError as error:
        first = problems(error, Wishes, found)[0]
        raise WrongInput(first.text, key=f"{OPTION}: {first.key}") from error
    return found


def _pairs(text: str) -> Iterable[tuple[str, Any]]:
    try:
        data = read_yaml(text, OPTION).data
    except WrongInput as error:
        raise WrongInput(error.problem, key=OPTION) from error
    if not isinstance(data, dict) or not data:
        kinds = listed(Wishes.model_fields)
        raise WrongInput(f"{quoted(text)} given; KEY: VALUE is right, as {EXAMPLE}, where KEY is {kinds}", key=OPTION)
    return data.items()


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
            force, *shocks = answer.split("x")
            likely_force, likely_shocks = likely[FORCE].split("x")
            if len(shocks) > 1 or not all(text.strip() for text in (force, *shocks)):
                raise ValueError(f"{answer} given; a force and a factor as {likely[FORCE]} are right, or a force")
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
        raise ValueError(f"{answer.strip()} given; a number over 0 is right")
    return value


def _names(answer: str) -> Sequence[str]:
    return [name for word in answer.split(",") if (name := word.strip())]


def _forces(resistance: Mapping[str, Any], stroke_mm: float) -> Iterator[list[float]]:
    """The force at even places of the stroke, on the way out and back, with friction."""
    for stroke in (resistance, resistance.get("returning", {"polynomial_n": [0.0]})):
        yield [
            resistance.get("friction_n", 0.0) + _force(stroke, place * stroke_mm / PLACES)
            for place in range(PLACES + 1)
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
            each = [whole(float(f"{factor * x:.4g}")) for x in (value if isinstance(value, list) else [value])]
            yield f"{path}.{key}", each if isinstance(value, list) else each[0]
