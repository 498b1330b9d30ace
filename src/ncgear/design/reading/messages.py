"""Checking plain values against the models; a fault gives key, value and place, and what would be right."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, NamedTuple, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from ncgear.design.keys.base import FAULT_TYPE, Model, listed
from ncgear.design.laws.registry import law_models
from ncgear.design.reading.places import Source
from ncgear.design.reading.text import quoted
from ncgear.design.words import NAME_RULE
from ncgear.errors import WrongInput

MOST_PROBLEMS = 10
"""Number of faults of one file in one message."""

Root = TypeVar("Root", bound=Model)

LAWS = law_models()

Location = tuple[int | str, ...]
"""The place of a fault in pydantic: names of fields, numbers of list items, and after ``motion`` the law's name."""


def fields_of(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """A model's fields by their keys in the file's spelling."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """Every model that a field of this annotation can hold, by itself or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in models_in(part)]


class Problem(NamedTuple):
    """The words for the fault of the value at a dotted key."""

    key: str
    text: str


def checked(root: type[Root], source: Source) -> Root:
    """The values of a file as its model ``root``; WrongInput says where and what is wrong, up to ten faults."""
    try:
        return root.model_validate(source.data)
    except ValidationError as error:
        raise _wrong_input(problems(error, root), source) from error


def _wrong_input(found: list[Problem], source: Source) -> WrongInput:
    """One error with all faults in the order of the file; faults in files that it names come last."""
    own_file = source.place("").file
    placed = [(source.place(problem.key), problem) for problem in found]
    placed.sort(key=lambda item: (item[0].file != own_file, item[0].line, item[0].column))
    first, *others = (WrongInput(one.text, key=one.key, location=str(place)) for place, one in placed[:MOST_PROBLEMS])
    if len(placed) > MOST_PROBLEMS:
        others.append(WrongInput(f"and {len(placed) - MOST_PROBLEMS} more"))
    return WrongInput(first.problem, key=first.key, location=first.location, others=others)


def problems(error: ValidationError, root: type[BaseModel]) -> list[Problem]:
    """All faults of a file whose model is ``root``, without those that only follow from another."""
    details = [detail for detail in error.errors() if detail["type"] != "default_factory_not_called"]
    misspelt = {_suggestion(detail, root) for detail in details if detail["type"] == "extra_forbidden"}
    parents = {detail["loc"][:i] for detail in details for i in range(len(detail["loc"]))}
    # A key that is there but misspelt is not missing, and a list is not short because its items are wrong.
    follows = {"missing": misspelt, "too_short": parents}
    return [_problem(detail, root) for detail in details if detail["loc"] not in follows.get(detail["type"], ())]


def _problem(detail: ErrorDetails, root: type[BaseModel]) -> Problem:
    kind = detail["type"]
    context: Mapping[str, Any] = detail.get("ctx") or {}
    if kind == FAULT_TYPE:
        parts = [_key(detail["loc"]), context["key"]]
        return Problem(".".join(part for part in parts if part), context["problem"])
    if kind == "extra_forbidden":
        return Problem(_key(detail["loc"]), _unknown_key(detail, root))
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return Problem(_key((*detail["loc"], "law")), _wrong_law(detail["input"]))
    return Problem(_key(detail["loc"]), _wrong_value(detail, context, root))


def _key(location: Location) -> str:
    """The dotted key; pydantic's location of a key of a law has the name of the law, which the file does not have."""
    if len(location) > 1 and location[0] == "motion" and location[1] in LAWS:
        location = (location[0], *location[2:])
    return ".".join(str(part) for part in location)


def _wrong_value(detail: ErrorDetails, context: Mapping[str, Any], root: type[BaseModel]) -> str:
    field = _field_at(detail["loc"], root)
    meaning = f" ({field.description})" if field and field.description else ""
    if detail["type"] == "missing":
        return f"missing; give it{meaning}"
    model = _model_at(detail["loc"], root)
    if detail["type"] in ("model_type", "model_attributes_type") and model:
        return f"{quoted(detail['input'])} given; a group of keys is needed: {listed(fields_of(model))}"
    needed = _NEEDED.get(detail["type"])
    if needed is None:
        # No field of today can have another kind of error; if one has, pydantic's own words are better than none.
        return f"{quoted(detail['input'])} is wrong: {detail['msg']}{meaning}"
    return f"{quoted(detail['input'])} given; {needed(context)} is needed{meaning}"


_NEEDED: dict[str, Callable[[Mapping[str, Any]], str]] = {
    "float_type": lambda _: "a number",
    "finite_number": lambda _: "a finite number",
    "int_type": lambda _: "a whole number",
    "bool_type": lambda _: "true or false",
    "string_type": lambda _: "text (in quotes, if it looks like a number)",
    "tuple_type": lambda _: "a list in [ ]",
    "model_type": lambda _: "a group of keys",
    "model_attributes_type": lambda _: f"a group of keys with law, one of {listed(LAWS)},",
    "greater_than": lambda context: f"a number over {context['gt']:g}",
    "greater_than_equal": lambda context: f"a number of {context['ge']:g} or over",
    "less_than": lambda context: f"a number under {context['lt']:g}",
    "less_than_equal": lambda context: f"a number of {context['le']:g} or under",
    "literal_error": lambda context: context["expected"].replace("'", ""),
    "string_pattern_mismatch": lambda _: f"a name of {NAME_RULE},",
    "string_too_short": lambda context: f"text of at least {context['min_length']} characters",
    "string_too_long": lambda context: f"text of at most {context['max_length']} characters",
    "too_short": lambda context: f"a list of at least {context['min_length']}, not {context['actual_length']}, items",
    "too_long": lambda context: f"a list of at most {context['max_length']} items",
}


def _wrong_law(motion: Mapping[str, Any]) -> str:
    law = motion.get("law")
    if law is None:
        return f"missing; give one of {listed(LAWS)}"
    return f"{quoted(law)} is no known law; one of {listed(LAWS)} is right{_did_you_mean(str(law), LAWS)}"


def _unknown_key(detail: ErrorDetails, root: type[BaseModel]) -> str:
    allowed = _keys_at(detail["loc"][:-1], root)
    hint = _did_you_mean(str(detail["loc"][-1]), allowed)
    return f"unknown key{hint}" if hint else f"unknown key; known are {listed(allowed, 'and')}"


def _did_you_mean(word: str, known: Sequence[str] | Mapping[str, Any]) -> str:
    close = get_close_matches(word, list(known), n=1)
    return f"; did you mean {close[0]}?" if close else ""


def _suggestion(detail: ErrorDetails, root: type[BaseModel]) -> Location:
    """The location of the key that a person probably meant by an unknown one."""
    *parent, word = detail["loc"]
    return (*parent, *get_close_matches(str(word), _keys_at(tuple(parent), root), n=1))


def _keys_at(location: Location, root: type[BaseModel]) -> list[str]:
    """The known keys of the group at ``location``; none where there is no group."""
    model = _model_at(location, root)
    return list(fields_of(model)) if model else []


def _field_at(location: Location, root: type[BaseModel]) -> FieldInfo | None:
    names = [part for part in location if isinstance(part, str)]
    model = _model_at(tuple(names[:-1]), root)
    return fields_of(model).get(names[-1]) if model and names else None


def _model_at(location: Location, root: type[BaseModel]) -> type[BaseModel] | None:
    """The model that holds the keys at ``location``, in which pydantic puts the name of the law after ``motion``."""
    model: type[BaseModel] | None = root
    for part in location:
        if isinstance(part, str):
            field = fields_of(model).get(part) if model else None
            # A part that is no field is the name of a law, which leads to the model of that law.
            model = _model_in(field.annotation) if field else LAWS.get(part)
    return model


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """The only model that a field can hold; None for a number, and for motion, which can hold several."""
    models = models_in(annotation)
    return models[0] if len(models) == 1 else None
