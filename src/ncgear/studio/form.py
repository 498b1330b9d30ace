"""The values of a design as the page shows them: every key with its name, unit, meaning, range and value.

Everything comes from the models that check design files; there is no other list of keys.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from ncgear.design.keys.design import design_model
from ncgear.design.laws.registry import LawName
from ncgear.design.reading.messages import fields_of
from ncgear.design.reading.text import whole
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.reference import Key, allowed, choices, default_words, example, is_list, law_of, unit_of
from ncgear.design.trains.registry import TrainFile, train_models
from ncgear.design.words import UNITS, quantity, spellings
from ncgear.numerics.units import label_and_unit

Row = dict[str, Any]

SHORT = {
    "multiples of pi": "\u03c0",
    "degrees": "\u00b0",
    "radians": "rad",
    "mm/s2": "mm/s\u00b2",
    "m/s2": "m/s\u00b2",
    "rad/s2": "rad/s\u00b2",
    "mm2/s": "mm\u00b2/s",
    "mm/s3": "mm/s\u00b3",
    "kg mm2": "kg mm\u00b2",
    "kg m2": "kg m\u00b2",
    "kg/m3": "kg/m\u00b3",
    "N at a depth of 1 mm": "N, 1 mm deep",
}
"""Units as they are written beside a number on the page."""

LEFT_OUT = {"may be left out": "left out", "none: it must be given": "needed"}
"""Text in the field of a key without a value, if it is not the default; the full text is below the field."""

MOST_ITEMS = 40
"""Most items of a list that have a row each; longer lists are points that are dragged, or are edited in the text."""


def form(data: Any) -> list[Row]:
    """The rows of a design's keys, given the plain values of its file, groups with their rows in ``rows``.

    A row has ``path``, ``label``, ``unit``, ``meaning``, ``allowed``, ``default`` in words, ``given`` and ``value``,
    and, depending on its ``kind`` (number, integer, choice, truth, text, numbers, group, groups, other): ``least`` and
    ``most`` where there are bounds, ``choices``, or ``rows``.  A group that is left out has ``begin``, a value for its
    start.
    """
    given = data if isinstance(data, dict) else {}
    return list(_rows(_model_of_file(given), given, "", ""))


def _model_of_file(given: Mapping[str, Any]) -> type[BaseModel]:
    """The model of a design, or of a train of the kind that is named; a train of no known kind has the first."""
    if "train" not in given:
        return design_model(given)
    kinds, train = train_models(), given["train"]
    return kinds.get(str(train.get("kind")) if isinstance(train, dict) else "", next(iter(kinds.values())))


def _rows(model: type[BaseModel], given: Mapping[str, Any], above: str, law: str) -> Iterator[Row]:
    root = TrainFile if above.startswith("train") or "train" in model.model_fields else design_model({})
    for name, field in fields_of(model).items():
        path = f"{above}.{name}" if above else name
        key = Key(path, law, model, field)
        if name not in given and _another_spelling_is_given(name, model, given):
            continue
        yield _group(key, given.get(name), root) if key.group else _plain(key, name in given, given.get(name), root)


def _another_spelling_is_given(name: str, model: type[BaseModel], given: Mapping[str, Any]) -> bool:
    """Whether the same quantity is given in another unit; for angles that are left out, only degrees are shown."""
    alike = [spelling for spelling in spellings(quantity(name)) if spelling in model.model_fields]
    if quantity(name) == name or len(alike) < len(UNITS):
        return False
    return any(spelling in given for spelling in alike) or not name.endswith("_deg")


def _group(key: Key, value: Any, root: type[BaseModel]) -> Row:
    row = _head(key, value is not None)
    if is_list(key.rule):
        items = value if isinstance(value, list) else []
        rows = [_item(key, items[place], place) for place in range(min(len(items), MOST_ITEMS))]
        return {**row, "kind": "groups", "rows": rows, "begin": _begin(key, root)}
    if value is not None and not isinstance(value, dict):
        return {**row, "kind": "text", "value": value}
    inner = value or {}
    model = _model_of(key, inner)
    law = str(inner.get("law", "")) if len(key.group) > 1 else key.law
    begin = None if value is not None else _begin(key, root)
    return {**row, "kind": "group", "rows": list(_rows(model, inner, key.path, law)) if inner else [], "begin": begin}


def _item(key: Key, value: Any, place: int) -> Row:
    path = f"{key.path}.{place}"
    inner = value if isinstance(value, dict) else {}
    rows = list(_rows(_model_of(key, inner), inner, path, key.law))
    return {**_head(key, True), "path": path, "label": f"{place + 1}", "meaning": "", "kind": "group", "rows": rows}


def _model_of(key: Key, given: Mapping[str, Any]) -> type[BaseModel]:
    """The model of a group; for ``motion`` the model of its law."""
    if len(key.group) == 1:
        return key.group[0]
    by_law = {law_of(model): model for model in key.group if "law" in model.model_fields}
    fewest = min(key.group, key=lambda model: len(fields_of(model)))
    return by_law.get(str(given.get("law", "")), fewest)


def _begin(key: Key, root: type[BaseModel]) -> Any:
    """A first value of a group: the example that ``ncgear explain`` gives for it."""
    name, _, text = example(key, root).partition(": ")
    return read_yaml(f"{name}: {text}", "example").at(name)


def _head(key: Key, given: bool) -> Row:
    return {
        "path": key.path,
        "label": label_and_unit(key.name)[0].replace("_", " "),
        "unit": SHORT.get(unit_of(key.name), unit_of(key.name)),
        "meaning": key.meaning,
        "given": given,
    }


def _plain(key: Key, given: bool, value: Any, root: type[BaseModel]) -> Row:
    rules = choices(key.rule)
    row = {**_head(key, given), "allowed": allowed(key), "default": default_words(key), "value": value}
    row["needed"] = key.field.is_required()
    row["hint"] = LEFT_OUT.get(row["default"], row["default"].partition(",")[0])
    if key.is_law_name:
        return {**row, "kind": "choice", "choices": [law.value for law in LawName]}
    words = [str(word) for rule in rules for word in rule.get("enum", [rule["const"]] if "const" in rule else [])]
    if len(rules) > 1 or (isinstance(value, str) and not words and rules[0].get("type") != "string"):
        return {**row, "kind": "other", "choices": words}
    rule = rules[0]
    if words:
        return {**row, "kind": "choice", "choices": rule.get("enum", [rule.get("const")])}
    match rule.get("type"):
        case "boolean":
            return {**row, "kind": "truth"}
        case "array":
            return {**row, "kind": "numbers"}
        case "number" | "integer":
            return {**row, "kind": rule["type"], **_bounds(rule), "step": _step(key, value, root)}
    return {**row, "kind": "text"}


def _bounds(rule: Mapping[str, Any]) -> dict[str, float]:
    low, high = rule.get("minimum", rule.get("exclusiveMinimum")), rule.get("maximum", rule.get("exclusiveMaximum"))
    return {name: bound for name, bound in (("least", low), ("most", high)) if bound is not None}


def _step(key: Key, value: Any, root: type[BaseModel]) -> float:
    """The step by which an arrow key changes a number: a hundredth of it, as a power of ten, or one."""
    if choices(key.rule)[0].get("type") == "integer":
        return 1
    number = abs(value) if isinstance(value, int | float) and value else 1.0
    digits = len(str(int(number))) if number >= 1.0 else 0
    return float(whole(float(10.0 ** (digits - 3))))
