"""Checking plain values against the models; a fault gives key, value and place, and the right form."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, NamedTuple, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from ncgear.design.keys.base import FAULT_TYPE, Model
from ncgear.design.laws.registry import law_models
from ncgear.design.reading.places import Source
from ncgear.design.reading.text import plain_number, quoted
from ncgear.design.words import NAME_RULE, listed, quantity, spellings
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


def dotted_keys(model: type[BaseModel]) -> Iterator[str]:
    """The dotted keys that a file may have below a model."""
    for key, field in fields_of(model).items():
        yield key
        for below in models_in(field.annotation):
            yield from (f"{key}.{name}" for name in dotted_keys(below))


class Problem(NamedTuple):
    """The words for the fault of the value at a dotted key."""

    key: str
    text: str


def checked(root: type[Root], source: Source) -> Root:
    """The values of a file as its model ``root``; WrongInput says where and what is wrong, up to ten faults."""
    try:
        return root.model_validate(source.data)
    except ValidationError as error:
        raise _wrong_input(problems(error, root, source.data), source) from error


def _wrong_input(found: list[Problem], source: Source) -> WrongInput:
    """One error with all faults in the order of the file; faults in files that it names come last."""
    own_file = source.place("").file
    placed = [(source.place(problem.key), problem) for problem in found]
    placed.sort(key=lambda item: (item[0].file != own_file, item[0].line, item[0].column))
    first, *others = (
        WrongInput(problem.text, key=source.as_written(problem.key), location=str(place))
        for place, problem in placed[:MOST_PROBLEMS]
    )
    if len(placed) > MOST_PROBLEMS:
        others.append(WrongInput(f"and {len(placed) - MOST_PROBLEMS} more"))
    return WrongInput(first.problem, key=first.key, location=first.location, others=others)


def problems(error: ValidationError, root: type[BaseModel], data: Mapping[str, Any]) -> list[Problem]:
    """All faults of the values of a file whose model is ``root``, without faults that only follow from others."""
    details = [detail for detail in error.errors() if detail["type"] != "default_factory_not_called"]
    meant = _meant(details, root)
    parents = {detail["loc"][:i] for detail in details for i in range(len(detail["loc"]))}
    # A misspelt key counts as given: neither the key nor its group is missing or empty.  A list is not short because
    # its items are wrong, and the columns of a table are short together.
    given = {key[:i] for key in meant.values() for i in range(1, len(key) + 1)}
    follows = {"missing": given, "too_short": parents.union(*(short[1:] for short in _short(details).values()))}
    told = [
        detail
        for detail in details
        if detail["loc"] not in follows.get(detail["type"], given if detail["input"] is None else ())
    ]
    alike: dict[tuple[object, ...], list[ErrorDetails]] = {}
    for detail in told:
        alike.setdefault(_slip(detail), []).append(detail)
    return [_problem(first, root, data, meant.get(first["loc"]), more) for first, *more in alike.values()]


def _slip(detail: ErrorDetails) -> tuple[object, ...]:
    """Common part of all faults from one slip: items of a list, and keys of another law."""
    location = detail["loc"]
    if (detail["type"] in _NEEDED and isinstance(location[-1], int)) or _has_law(detail):
        return location[:-1], detail["type"]
    return (location,)


def _has_law(detail: ErrorDetails) -> list[str]:
    """The laws with a key that the law of the file lacks."""
    location = detail["loc"]
    if detail["type"] != "extra_forbidden" or len(location) != 3 or location[0] != "motion":
        return []
    return [law for law, model in LAWS.items() if location[2] in fields_of(model)]


def _short(details: Sequence[ErrorDetails]) -> dict[Location, list[Location]]:
    """The lists that are too short, by their groups."""
    found: dict[Location, list[Location]] = {}
    for detail in details:
        if detail["type"] == "too_short":
            found.setdefault(detail["loc"][:-1], []).append(detail["loc"])
    return found


def _problem(
    detail: ErrorDetails,
    root: type[BaseModel],
    data: Mapping[str, Any],
    meant: Location | None,
    more: Sequence[ErrorDetails],
) -> Problem:
    """The words for a fault; ``more`` come from the same slip."""
    kind, key = detail["type"], _key(detail["loc"])
    context: Mapping[str, Any] = detail.get("ctx") or {}
    if kind == FAULT_TYPE:
        return _of_what_is_emptied(Problem(".".join(filter(None, (key, context["key"]))), context["problem"]), data)
    if _has_law(detail):
        return Problem(key, _of_another_law([detail, *more]))
    if kind == "extra_forbidden":
        return Problem(key, _unknown_key(detail, root, data, meant))
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        known = [law for law in LAWS if law != "in_series" or detail["loc"] == ("motion",)]
        return Problem(_key((*detail["loc"], "law")), _wrong_law(detail["input"], known))
    alike = f"; {len(more)} more item{'s' * (len(more) > 1)} alike" if more else ""
    return Problem(key, f"{_wrong_value(detail, context, root)}{alike}")


def _of_another_law(details: Sequence[ErrorDetails]) -> str:
    """The laws that have the keys which the file's law lacks; laws with most of these keys come first."""
    left, own, said = [str(detail["loc"][-1]) for detail in details], details[0]["loc"][1], []
    them = "it" if len(left) == 1 else "them"
    while left:
        has = {law: [word for word in left if word in fields_of(model)] for law, model in LAWS.items()}
        most = max(has.values(), key=len)
        said.append(f"law: {listed(law for law, words in has.items() if words == most)} has {listed(most, 'and')}")
        left = [word for word in left if word not in most]
    return f"unknown key of law {own}; {', '.join(said)}: give that law, or leave {them} out"


def _of_what_is_emptied(problem: Problem, data: Mapping[str, Any]) -> Problem:
    """A fault of a key that is left out, at the key itself if it stands without a value."""
    there = _at(data, problem.key)
    if there is None and problem.text.startswith("missing; "):
        return Problem(problem.key, problem.text.replace("missing", "nothing given", 1))
    named = re.findall(r"\w+", problem.text)
    emptied = [name for name in named if name in there and there[name] is None] if isinstance(there, Mapping) else []
    if not emptied:
        return problem
    return Problem(".".join(filter(None, (problem.key, emptied[0]))), f"nothing given; {problem.text}")


def _at(data: Any, key: str) -> Any:
    """The value at a dotted key of plain values; an empty text if there is none."""
    for part in filter(None, key.split(".")):
        try:
            data = data[int(part)] if isinstance(data, list | tuple) else data[part]
        except (LookupError, TypeError, ValueError):
            return ""
    return data


def _key(location: Location) -> str:
    """The dotted key; pydantic's location of a law's key has the law's name, which the file lacks.

    It stands after ``motion``, and in ``motion.pairs`` after the number of the pair.
    """
    if location[:1] != ("motion",):
        return ".".join(str(part) for part in location)
    names = (1, 4) if location[1:3] == ("in_series", "pairs") else (1,)
    return ".".join(str(part) for place, part in enumerate(location) if place not in names or part not in LAWS)


def _wrong_value(detail: ErrorDetails, context: Mapping[str, Any], root: type[BaseModel]) -> str:
    field = _field_at(detail["loc"], root)
    meaning = f" ({field.description})" if field and field.description else ""
    if detail["type"] == "missing":
        return f"missing; give it{meaning}"
    model = _model_at(detail["loc"], root)
    if detail["type"] in ("model_type", "model_attributes_type") and model:
        return f"{quoted(detail['input'])} given; a group of keys is needed: {listed(fields_of(model))}{meaning}"
    needed = _NEEDED.get(detail["type"])
    if needed is None:
        # No field has another kind of error today; for a later field, pydantic's own words are better than none.
        return f"{quoted(detail['input'])} is wrong: {detail['msg']}{meaning}"
    count = f" of {context['actual_length']}" if "actual_length" in context else ""
    given, comma = detail["input"], ""
    if detail["type"] == "float_type" and isinstance(given, str) and plain_number(given.replace(",", ".")) is not None:
        comma = ", with a decimal point in place of the comma"
    return f"{quoted(given)}{count} given; {needed(context)} is needed{comma}{meaning}"


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
    "too_short": lambda context: f"a list of at least {context['min_length']} item{'s' * (context['min_length'] > 1)}",
    "too_long": lambda context: f"a list of at most {context['max_length']} items",
}


def _wrong_law(motion: Mapping[str, Any], known: Sequence[str]) -> str:
    law = motion.get("law")
    if law is None:
        close = get_close_matches("law", [key for key in motion if key != "law"], n=1)
        given = f"{close[0]} is no key; " if close else "nothing given; " if "law" in motion else "missing; "
        return f"{given}give law, one of {listed(known)}"
    return f"{quoted(law)} is no known law; one of {listed(known)} is right{_did_you_mean(str(law), known)}"


def _unknown_key(detail: ErrorDetails, root: type[BaseModel], data: Mapping[str, Any], meant: Location | None) -> str:
    group, word = detail["loc"][:-1], str(detail["loc"][-1])
    if meant is None:
        known = _keys_at(group, root)
        if word.isdigit():
            return (
                f"a number stands as a key; its decimals have a point, not a comma, and keys are {listed(known, 'and')}"
            )
        return f"unknown key; known {'are' if len(known) > 1 else 'is'} {listed(known, 'and')}"
    if meant[:-1] != group:
        return f"unknown key here; {meant[-1]} stands under {_key(meant[:-1])}"
    given = _at(data, _key(group))
    units = spellings(quantity(str(meant[-1])))
    there = next((key for key in (meant[-1], *units) if _at(given, str(key)) not in ("", None)), None)
    if there is None:
        return f"unknown key; did you mean {listed(units) if word == quantity(str(meant[-1])) else meant[-1]}?"
    return f"unknown key; {there}, which is like it, is given too: keep {there} and leave {word} out"


def _did_you_mean(word: str, known: Sequence[str] | Mapping[str, Any]) -> str:
    close = get_close_matches(word, list(known), n=1)
    return f"; did you mean {close[0]}?" if close else ""


def _meant(details: Sequence[ErrorDetails], root: type[BaseModel]) -> dict[Location, Location]:
    """The location of the key that a person probably meant by each unknown key, if there is a guess.

    The guesses, in this order: a known key of the group with a very similar name, the same key of another group, a
    similar key of an empty group, a known key with a similar name, or the only missing key of the group.
    """
    unknown = [detail["loc"] for detail in details if detail["type"] == "extra_forbidden" and not _has_law(detail)]
    emptied = [detail["loc"] for detail in details if detail["input"] is None]
    found: dict[Location, Location] = {}
    for *group, word in unknown:
        known, name = _keys_at(tuple(group), root), str(word)
        own, other = (
            [(*group, path) for path in ones] for ones in (_like(name, known), get_close_matches(name, known, 1))
        )
        elsewhere = [path for path in _elsewhere(name, root) if path[0] not in group[:1]]
        beside = [path for path in emptied if path[:-1] == tuple(group)]
        elsewhere += [(*path, key) for path in beside for key in _like(name, _keys_at(path, root))]
        if guesses := [*elsewhere, *own] if "." in name else [*own, *elsewhere, *other]:
            found[(*group, word)] = guesses[0]
    missing = {detail["loc"] for detail in details if detail["type"] == "missing"} - {*found.values()}
    for location in unknown:
        alike = [[path for path in ones if path[:-1] == location[:-1]] for ones in (missing, {*unknown} - found.keys())]
        if location not in found and [len(ones) for ones in alike] == [1, 1]:
            found[location] = alike[0][0]
    return found


def _like(name: str, known: Sequence[str]) -> list[str]:
    """The known keys with a very similar name, and the known keys that add a unit to the name."""
    return [*get_close_matches(name, known, 1, 0.7), *(key for key in known if key.startswith(f"{name}_"))]


def _elsewhere(word: str, root: type[BaseModel]) -> list[Location]:
    """Places of a key in the groups of the file; a key with a point has its group before the point."""
    *group, key = word.split(".")
    groups = [(name, model) for name, field in fields_of(root).items() for model in models_in(field.annotation)]
    return [(name, key) for name, model in groups if key in fields_of(model) and group in ([], [name])]


def _keys_at(location: Location, root: type[BaseModel]) -> list[str]:
    """The known keys of the group at ``location``; none if there is no group."""
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
            # A part that is no field is the name of a law; it leads to the model of that law.
            model = _model_in(field.annotation) if field else LAWS.get(part)
    return model


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """The only model that a field can hold; None for a number, and for ``motion``, which can hold several."""
    models = models_in(annotation)
    return models[0] if len(models) == 1 else None
