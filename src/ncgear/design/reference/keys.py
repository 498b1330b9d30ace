"""Every key of a file: where it stands, what it means, which laws have it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ncgear.design.fields import fields_of, models_in


@dataclass(frozen=True, eq=False)
class Key:
    """A key of a model; ``law`` is the motion law that has it, empty for a key that is not of one law.

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
        """What it is, in the words of the schema."""
        return self.field.description or ""

    @property
    def rule(self) -> dict[str, Any]:
        """What JSON Schema says of its value."""
        rule: dict[str, Any] = _schema(self.model)["properties"][self.name]
        return rule

    @property
    def group(self) -> list[type[BaseModel]]:
        """The models of its value: none of a plain value, several of motion."""
        return models_in(self.field.annotation)

    @property
    def told_apart(self) -> bool:
        """Whether the value is the name by which laws are told apart."""
        return "const" in self.rule

    @property
    def default(self) -> Any:
        """The value of a key that is left out; factories that look at other keys see their defaults."""
        if self.field.default_factory is None:
            return self.field.default
        return self.field.get_default(call_default_factory=True, validated_data=_defaults(self.model))


def keys_of(root: type[BaseModel]) -> list[Key]:
    """All keys of a file whose model is ``root``, groups before what is in them."""
    return list(_keys(root, "", ""))


def _keys(model: type[BaseModel], above: str, law: str) -> Iterator[Key]:
    for name, field in fields_of(model).items():
        path = f"{above}.{name}" if above else name
        yield Key(path, law, model, field)
        inner = models_in(field.annotation)
        for one in inner:
            yield from _keys(one, path, law_of(one) if len(inner) > 1 else law)


def law_of(model: type[BaseModel]) -> str:
    """The law that a model of motion is told by."""
    name: str = _schema(model)["properties"]["law"]["const"]
    return name


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    return model.model_json_schema()


def _defaults(model: type[BaseModel]) -> dict[str, Any]:
    """Plain defaults of a model, which a factory may look at."""
    return {name: field.default for name, field in model.model_fields.items() if field.default_factory is None}
