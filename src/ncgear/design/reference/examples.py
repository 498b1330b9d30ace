"""An example for every key: the template's value, or else one that is allowed there."""

from __future__ import annotations

from functools import cache
from typing import Any

from ncgear.design.fields import fields_of
from ncgear.design.positions import read_yaml
from ncgear.design.reference.keys import Key, law_of
from ncgear.design.reference.values import choices, is_list, plain, unit_of
from ncgear.design.schema import Design
from ncgear.design.template import Law, template

SAMPLES = {"mm": 40.0, "degrees": 30.0, "radians": 0.5, "multiples of pi": 0.5, "r/min": 60.0, "W": 5000.0, "kg": 12.0}
"""Values that are likely for a unit."""

ANY = (0.1, 1.0, 10.0, -10.0)
"""Values for other units, and for where the likely one is out of range."""

TEXTS = {"file": "points.csv", "design": "design.yaml", "expression_n": "200 + 3*exp(x/90)"}
"""Texts for keys whose text is no free one."""


def example(key: Key, root: type[Any]) -> str:
    """A line of a file with this key; ``root`` is the file's model."""
    return f"{key.name}: {_value(key, root)}"


def _value(key: Key, root: type[Any]) -> str:
    found = _in_template(key) if root is Design else None
    if found is not None and not isinstance(found, dict):
        return plain(found)
    if key.group:
        return _group(key, root)
    if not key.field.is_required() and key.default not in (None, (), ""):
        return plain(key.default)
    return _allowed(choices(key.rule)[0], key.name)


def _in_template(key: Key) -> Any:
    """What the template has at a key, None where it has nothing."""
    data = _template_data(Law(key.law) if key.law else Law.THREE_SEGMENT_STROKE)
    for part in key.path.split("."):
        data = data.get(part) if isinstance(data, dict) else None
    return data


@cache
def _template_data(law: Law) -> Any:
    return read_yaml(template("example", law), "template").data


def _group(key: Key, root: type[Any]) -> str:
    """A group of the keys that it must have, or of the first one; of several kinds, the one of fewest keys."""
    model = min(key.group, key=lambda one: len(fields_of(one)))
    law = law_of(model) if len(key.group) > 1 else key.law
    keys = [Key(f"{key.path}.{name}", law, model, field) for name, field in fields_of(model).items()]
    needed = [one for one in keys if one.field.is_required()] or keys[:1]
    text = "{" + ", ".join(example(one, root) for one in needed) + "}"
    if not is_list(key.rule):
        return text
    return f"[{', '.join([text] * max(choices(key.rule)[0].get('minItems', 1), 1))}]"


def _allowed(rule: dict[str, Any], name: str) -> str:
    """A value that a rule allows."""
    if "const" in rule or "enum" in rule:
        return plain(rule.get("enum", [rule.get("const")])[0])
    match rule["type"]:
        case "boolean":
            return "true"
        case "string":
            return plain(TEXTS.get(name, "baler"))
        case "array":
            count = max(rule.get("minItems", 1), 1)
            return f"[{', '.join([_allowed(rule['items'], name)] * count)}]"
    return _number(rule, name)


def _number(rule: dict[str, Any], name: str) -> str:
    likely = SAMPLES.get(unit_of(name))
    fitting = [value for value in ((likely,) if likely else ()) + ANY if _within(rule, value)]
    return plain(fitting[0])


def _within(rule: dict[str, Any], value: float) -> bool:
    return (
        rule.get("minimum", value) <= value <= rule.get("maximum", value)
        and value > rule.get("exclusiveMinimum", value - 1.0)
        and value < rule.get("exclusiveMaximum", value + 1.0)
        and (rule["type"] != "integer" or value.is_integer())
    )
