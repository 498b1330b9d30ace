"""What may stand at a key, its unit, and what holds where it is left out, in words."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from ncgear.design.angles import listed
from ncgear.design.naming import NAME_PATTERN, NAME_RULE
from ncgear.design.reference.keys import Key

UNITS = {
    "mm_s3": "mm/s3",
    "mm_s2": "mm/s2",
    "m_s2": "m/s2",
    "n_s_mm": "N s/mm",
    "kg_mm2": "kg mm2",
    "kg_m3": "kg/m3",
    "stiffness_n_mm": "N at a depth of 1 mm",
    "n_m": "N m",
    "mm_s": "mm/s",
    "rpm": "r/min",
    "gpa": "GPa",
    "deg": "degrees",
    "rad": "radians",
    "pi": "multiples of pi",
    "per_g": "the readings' unit per g",
    "hz": "Hz",
    "kg": "kg",
    "mm": "mm",
    "g": "g",
    "n": "N",
    "w": "W",
}
"""Units by the end of a key, the longer ones first."""


def unit_of(name: str) -> str:
    """The unit that a key ends in, empty where it names none."""
    return next((unit for end, unit in UNITS.items() if f"_{name}".endswith(f"_{end}")), "")


def allowed(key: Key) -> str:
    """What may stand there."""
    rule = key.rule
    if key.group:
        return f"a list{_count(choices(rule)[0])} of groups of keys" if is_list(rule) else "a group of keys"
    return listed(_words(one) for one in choices(rule))


def choices(rule: dict[str, Any]) -> list[dict[str, Any]]:
    """The rules of a value that may be of several kinds; nothing at all is no choice of its own."""
    return [one for one in rule.get("anyOf", [rule]) if one.get("type") != "null"]


def is_list(rule: dict[str, Any]) -> bool:
    """Whether a list stands there."""
    return choices(rule)[0].get("type") == "array"


def _words(rule: dict[str, Any]) -> str:
    if "const" in rule or "enum" in rule:
        return listed(str(value) for value in rule.get("enum", [rule.get("const")]))
    match rule["type"]:
        case "array":
            return f"a list{_count(rule)} of: {_words(rule['items'])}" if "items" in rule else f"a list{_count(rule)}"
        case "boolean":
            return "true or false"
        case "string":
            return f"text of {NAME_RULE}" if rule.get("pattern") == NAME_PATTERN else "text"
        case kind:
            return f"a {'whole ' if kind == 'integer' else ''}number{_range(rule)}"


def _count(rule: dict[str, Any]) -> str:
    low, high = rule.get("minItems", 0), rule.get("maxItems")
    if high is None:
        return f" ({low} or more)" if low else ""
    return f" ({low} to {high})"


def _range(rule: dict[str, Any]) -> str:
    bounds = ("minimum", "{:g} or over"), ("exclusiveMinimum", "over {:g}")
    ends = ("maximum", "up to {:g}"), ("exclusiveMaximum", "under {:g}")
    said = [words.format(rule[name]) for name, words in (*bounds, *ends) if name in rule]
    return f", {', '.join(said)}" if said else ""


def default_words(key: Key) -> str:
    """What holds where the key is left out."""
    if key.field.is_required():
        return "none: it must be given"
    value = key.default
    if value is None or value == ():
        return "may be left out"
    if isinstance(value, BaseModel):
        return "may be left out; its keys have their own defaults"
    follows = key.field.default_factory_takes_validated_data
    return f"{plain(value)}{', where the other keys have their defaults' if follows else ''}"


def plain(value: Any) -> str:
    """A value as the file would write it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(plain(item) for item in value)}]"
    return f'"{value}"' if not value or set(value) & set(" *+(){}[]:,#") else str(value)
