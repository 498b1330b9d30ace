"""The explanation of every key of a file, from the models of its keys.

``keys_of`` lists the keys, and ``told_keys_of`` gives the words of ``ncgear explain`` for them.  A key's explanation
has its meaning and the laws that have it, its unit, the allowed values and the default in words, and an example.  The
example is the value of the template, or else an allowed value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from threading import Lock
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ncgear.design.keys.design import Design, design_models
from ncgear.design.laws.registry import DEFAULT_LAW, LawName, law_keys
from ncgear.design.reading.messages import fields_of, models_in
from ncgear.design.reading.places import Document
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.template import template
from ncgear.design.told_keys import ToldKey
from ncgear.design.trains.registry import TrainFile, train_models
from ncgear.design.words import NAME_PATTERN, NAME_RULE, listed
from ncgear.frozen import dataclass
from ncgear.numerics.units import label_and_unit


@dataclass(frozen=True, eq=False)
class Key:
    """A key of a model; ``law`` is the motion law that has it, empty for a key of no single law.

    ``path`` is dotted, without the numbers of list items.
    """

    path: str
    law: str
    model: type[BaseModel]
    field: FieldInfo

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition(".")[2]

    @property
    def meaning(self) -> str:
        """The meaning of the key, in the words of the schema."""
        return self.field.description or ""

    @property
    def rule(self) -> dict[str, Any]:
        """The JSON Schema of its value."""
        return _schema(self.model)["properties"][self.name]

    @property
    def group(self) -> list[type[BaseModel]]:
        """The models of its value: none for a plain value, several for ``motion``."""
        return models_in(self.field.annotation)

    @property
    def is_law_name(self) -> bool:
        """Whether the value is the name that tells laws apart."""
        return self.name == "law" and "const" in self.rule

    @property
    def default(self) -> Any:
        """The default of the key if the keys that give this default are also left out."""
        if self.field.default_factory is None:
            return self.field.default
        # The default may follow from the keys before it.
        defaults: dict[str, Any] = {}
        for name, field in self.model.model_fields.items():
            if field is self.field:
                break
            defaults[name] = field.get_default(call_default_factory=True, validated_data=defaults)
        return self.field.get_default(call_default_factory=True, validated_data=defaults)


def keys_of(root: type[BaseModel]) -> list[Key]:
    """All keys of a file whose model is ``root``, a group before its keys; for designs and
    trains, the keys of all mechanisms and kinds.

    If several mechanisms or kinds have a key, the first counts.
    """
    found: dict[tuple[str, str], Key] = {}
    kinds: dict[type[BaseModel], Callable[[], Mapping[str, type[BaseModel]]]]
    kinds = {Design: design_models, TrainFile: train_models}
    for model in kinds[root]().values() if root in kinds else [root]:
        for key in _keys(model, "", ""):
            found.setdefault((key.path, key.law), key)
    return list(found.values())


def told_keys_of(root: type[BaseModel]) -> list[ToldKey]:
    """The words for all keys of a file whose model is ``root``; a key whose meaning differs between kinds, for each."""
    if root is not TrainFile:
        return _told(root)
    kinds = {name: _told(model) for name, model in train_models().items()}
    alike: dict[str, dict[str, list[tuple[str, ToldKey]]]] = {}
    for name, keys in kinds.items():
        for key in keys:
            alike.setdefault(key.path, {}).setdefault(key.meaning, []).append((name, key))
    found = []
    for meanings in alike.values():
        for meaning, having in meanings.items():
            names = tuple(name for name, _ in having)
            said = f"of {listed(names, 'and')}: {meaning}" if len(meanings) > 1 else meaning
            found.append(replace(having[0][1], meaning=said, kinds=names))
    return found


def _told(root: type[BaseModel]) -> list[ToldKey]:
    return [
        ToldKey(
            path=key.path,
            law=key.law,
            meaning=key.meaning,
            is_group=bool(key.group),
            is_law_name=key.is_law_name,
            unit=unit_of(key.name),
            allowed=allowed(key),
            default=default_words(key),
            example=example(key, root),
        )
        for key in keys_of(root)
    ]


def _keys(model: type[BaseModel], above: str, law: str) -> Iterator[Key]:
    for name, field in fields_of(model).items():
        path = f"{above}.{name}" if above else name
        yield Key(path, law, model, field)
        inner = models_in(field.annotation)
        # The laws of pairs have the keys of ``motion``, where these are told
        for nested in inner if path != "motion.pairs" else ():
            yield from _keys(nested, path, law_of(nested) if len(inner) > 1 else law)


def law_of(model: type[BaseModel]) -> str:
    """The name of the law whose keys are in ``model``."""
    return _schema(model)["properties"]["law"]["const"]


BUILDING = Lock()
"""Pydantic builds a model at its first use, and fails if two threads build it at the same time."""


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    with BUILDING:
        return model.model_json_schema()


SPELT_OUT = {"deg": "degrees", "rad": "radians"}
"""Units that are written in full here; the map of all units is in ``numerics.units``."""

OTHER_UNITS = {"stiffness_n_mm": "N at a depth of 1 mm", "effect_per_g": "the readings' unit per g"}
"""Units of keys whose ending would give another unit."""


def unit_of(name: str) -> str:
    """The unit at the end of a key; empty if there is none."""
    unit = label_and_unit(name)[1]
    return OTHER_UNITS.get(name, SPELT_OUT.get(unit, unit))


def allowed(key: Key) -> str:
    """The allowed values of a key, in words."""
    rule = key.rule
    if key.group:
        names = [_words(choice) for choice in choices(rule) if "enum" in choice]
        return (
            f"a list{_count(choices(rule)[0])} of groups of keys"
            if is_list(rule)
            else " or ".join([*names, "a group of keys"])
        )
    return listed(_words(choice) for choice in choices(rule))


def choices(rule: dict[str, Any]) -> list[dict[str, Any]]:
    """The rules of each allowed kind of value, without the rule for a missing value."""
    return [choice for choice in rule.get("anyOf", [rule]) if choice.get("type") != "null"]


def is_list(rule: dict[str, Any]) -> bool:
    """Whether the value is a list."""
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
    """The default of a key, in words."""
    if key.field.is_required():
        # Another model replaces this model if the group is left out.
        return "may be left out" if "; left out:" in key.meaning else "none: it must be given"
    value = key.default
    if value is None or value == ():
        return "may be left out"
    if isinstance(value, BaseModel):
        return "may be left out; its keys have their own defaults"
    follows = key.field.default_factory_takes_validated_data
    return f"{plain(value)}{', where the other keys have their defaults' if follows else ''}"


def plain(value: Any) -> str:
    """A value in the form of the file."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(plain(item) for item in value)}]"
    return f'"{value}"' if not value or set(value) & set(" *+(){}[]:,#") else str(value)


LIKELY = {"mm": 40.0, "degrees": 30.0, "radians": 0.5, "multiples of pi": 0.5, "r/min": 60.0, "W": 5000.0, "kg": 12.0}
"""Values for examples, by their unit."""

OTHERWISE = (0.1, 1.0, 10.0, -10.0)
"""Values for other units, and for keys whose range excludes the likely value."""

TEETH_OF_TRAIN = "{teeth: 28, module_mm: 2, face_width_mm: 10}"

KNOWN = {
    "train": f"{{kind: planetary, speed_rpm: 60, ratio: [1.3, 1, 0.8, 1], gears: {TEETH_OF_TRAIN}}}",
    "train.ratio": "[1.3, 1, 0.8, 1]",
    "ChainTrain.ratio": '"1 + 0.2*cos(phi)"',
    "MovingAxisTrain.ratio": '"1 + 0.2*cos(phi)"',
    "train.gears": TEETH_OF_TRAIN,
    "train.path": "{points_mm: [[0, 0], [-60, 70], [-95, 180], [-40, 225], [20, 180], [22, 75]]}",
    "path.points_mm": "[[0, 0], [-60, 70], [-95, 180], [-40, 225], [20, 180], [22, 75]]",
    "path.tolerances_mm": "[0.1, 0.1, 0.5, 0.5, 0.5, 0.1]",
    "train.carrier_ratio": "[1.2, 1, 0.8, 1]",
    "path.pace": "[{from_point: 6, to_point: 1, share: 0.3}]",
    "path.axis_mm": "[0, 250]",
    "path.axis_from_mm": "[-200, 190]",
    "path.axis_to_mm": "[200, 450]",
    "path.straight": "[1, 2]",
    "path.tool": "[{point: 1, angle_deg: -90}]",
    "file": "points.csv",
    "design": "design.yaml",
    "expression_n": '"200 + 3*exp(x/90)"',
    "expression_n_m": '"12 + 3*sin(2*x)"',
    "table.angle_deg": "[0, 180, 360]",
    "table.torque_n_m": "[12, 15, 12]",
    "tolerances.standard": "ISO 1328-1",
    "comparison.published": "[{name: author and year, speed_rpm: 60, peak_power_w: 18750}]",
    "published.name": "author and year",
    "linkage": "{crank_mm: 380, rod_mm: 960}",
    "resistance.table": "{displacement_mm: [0, 400, 760], force_n: [0, 2000, 30000]}",
    "train.resistance.table": "{angle_deg: [0, 180], torque_n_m: [5, 10]}",
    "resistance.table.displacement_mm": "[0, 400, 760]",
    "resistance.table.force_n": "[0, 2000, 30000]",
    "keyway.width_mm": "4",
    "keyway.depth_mm": "1.8",
    "hub.diameter_mm": "24",
    "hub.height_mm": "10",
    "set_screw.diameter_mm": "3.3",
    "set_screw.height_mm": "5",
    "hardness": "300",
    "material.driving": "42CrMo4",
    "material.driven": "POM",
    "driving.name": "42CrMo4",
    "driven.name": "POM",
    "web": "{thickness_mm: 6, rim_mm: 6, hub_mm: 30}",
    "web.thickness_mm": "6",
    "web.rim_mm": "6",
    "web.hub_mm": "20",
    "crank_pin.diameter_mm": "8",
    "end_stop.pin_mm": "5",
    "end_stop.radius_mm": "20",
    "lightening_holes.count": "5",
    "lightening_holes.least_wall_mm": "4",
    "lightening_holes.diameter_mm": "12",
}
"""Examples in the form of the file, by the endings of paths.

Some allowed values make no sense with the keys beside them: a table of equal points, a set screw as wide as the hub.
Their keys have an example here.
"""


def example(key: Key, root: type[Any]) -> str:
    """A line of a file with this key; ``root`` is the file's model."""
    return f"{key.name}: {_value(key, root)}"


def _value(key: Key, root: type[Any]) -> str:
    known = _known(key)
    if known:
        return known
    law = LawName(key.law) if key.law else DEFAULT_LAW
    found = _read_template(law).at(key.path) if root is Design else None
    if found is not None and not isinstance(found, dict):
        return plain(found)
    if key.group:
        return _group(key, root)
    if not key.field.is_required() and key.default not in (None, (), ""):
        return plain(key.default)
    return _allowed(choices(key.rule)[0], key.name)


def _known(key: Key) -> str:
    """The example of a key from its law, or from KNOWN by the longest end of its path; empty if there is none."""
    if key.law and key.name in (examples := law_keys(LawName(key.law)).EXAMPLES):
        return examples[key.name]
    if (of_kind := f"{key.model.__name__}.{key.name}") in KNOWN:
        return KNOWN[of_kind]
    ends = [end for end in KNOWN if f".{key.path}".endswith(f".{end}")]
    return KNOWN[max(ends, key=len)] if ends else ""


@cache
def _read_template(law: LawName) -> Document:
    return read_yaml(template("example", law), "template")


def _group(key: Key, root: type[Any]) -> str:
    """A group with its required keys, or else its first key; of several models, the model with the fewest keys."""
    model = min(key.group, key=lambda model: len(fields_of(model)))
    law = law_of(model) if len(key.group) > 1 else key.law
    keys = [Key(f"{key.path}.{name}", law, model, field) for name, field in fields_of(model).items()]
    needed = [key for key in keys if key.field.is_required()] or keys[:1]
    text = "{" + ", ".join(example(key, root) for key in needed) + "}"
    if not is_list(key.rule):
        return text
    return f"[{', '.join([text] * max(choices(key.rule)[0].get('minItems', 1), 1))}]"


def _allowed(rule: dict[str, Any], name: str) -> str:
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
    likely = LIKELY.get(unit_of(name))
    candidates = OTHERWISE if likely is None else (likely, *OTHERWISE)
    return plain(next(value for value in candidates if _within(rule, value)))


def _within(rule: dict[str, Any], value: float) -> bool:
    return (
        rule.get("minimum", value) <= value <= rule.get("maximum", value)
        and value > rule.get("exclusiveMinimum", value - 1.0)
        and value < rule.get("exclusiveMaximum", value + 1.0)
        and (rule["type"] != "integer" or value.is_integer())
    )
