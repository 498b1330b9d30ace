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

KNOWN = {
    "file": "points.csv",
    "design": "design.yaml",
    "expression_n": '"200 + 3*exp(x/90)"',
    "tolerances.standard": "ISO 1328-1",
    "comparison.published": "[{name: author and year, speed_rpm: 60, peak_power_w: 18750}]",
    "published.name": "author and year",
    "linkage": "{crank_mm: 380, rod_mm: 960}",
    "motion.phi1_rad": "[0, 1.5, 3, 4.5]",
    "motion.phi1_deg": "[0, 90, 180, 270]",
    "motion.phi1_pi": "[0, 0.5, 1, 1.5]",
    "motion.displacement_mm": "[0, 380, 760, 380]",
    "resistance.table": "{displacement_mm: [0, 400, 760], force_n: [0, 2000, 30000]}",
    "resistance.table.displacement_mm": "[0, 400, 760]",
    "resistance.table.force_n": "[0, 2000, 30000]",
    "keyway.width_mm": "4",
    "keyway.depth_mm": "1.8",
    "hub.diameter_mm": "24",
    "hub.height_mm": "10",
    "set_screw.diameter_mm": "3.3",
    "set_screw.height_mm": "5",
    "web.thickness_mm": "6",
    "web.rim_mm": "6",
    "web.hub_mm": "20",
    "lightening_holes.count": "5",
    "lightening_holes.least_wall_mm": "4",
    "lightening_holes.diameter_mm": "12",
}
"""Values, as a file has them, by the ends of paths where one that is only allowed would make no sense with the keys
beside it: a table whose points are all the same, a set screw as wide as the hub."""


def example(key: Key, root: type[Any]) -> str:
    """A line of a file with this key; ``root`` is the file's model."""
    return f"{key.name}: {_value(key, root)}"


def _value(key: Key, root: type[Any]) -> str:
    known = _known(key.path)
    if known:
        return known
    found = _in_template(key) if root is Design else None
    if found is not None and not isinstance(found, dict):
        return plain(found)
    if key.group:
        return _group(key, root)
    if not key.field.is_required() and key.default not in (None, (), ""):
        return plain(key.default)
    return _allowed(choices(key.rule)[0], key.name)


def _known(path: str) -> str:
    """The longest end of the path that is known; empty for none."""
    ends = [end for end in KNOWN if f".{path}".endswith(f".{end}")]
    return KNOWN[max(ends, key=len)] if ends else ""


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
            return "baler"
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
