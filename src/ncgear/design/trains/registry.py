"""The kinds of trains that a design file can name, one line each.

To add a kind ``<name>``:

1. ``trains/<name>.py``: its mathematics, which makes a ``Train`` (``trains/train.py``);
2. ``design/trains/<name>.py``: its keys and how they make the train (``design/trains/base.py``);
3. a line in ``KINDS`` below.

The group ``train`` of design files, its JSON Schema and its faults, checks and builds follow from these lines.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, Literal

from pydantic import create_model

from ncgear.design.keys.base import FILE_FORMAT, FileFormat, Model, optional, required
from ncgear.design.reading.messages import dotted_keys
from ncgear.design.reading.text import quoted
from ncgear.design.trains.base import RatedTrain, TrainKeys
from ncgear.design.trains.chain import Chain
from ncgear.design.trains.lobed_motor import LobedMotor
from ncgear.design.trains.moving_axis import MovingAxis
from ncgear.design.trains.planetary import Planetary
from ncgear.design.words import LONGEST_DESCRIPTION, NAME_PATTERN, listed
from ncgear.errors import WrongInput

KINDS: dict[str, type[TrainKeys]] = {kind.KIND: kind for kind in (Planetary, Chain, LobedMotor, MovingAxis)}


class TrainFile(Model):
    """A design file of a train of gears."""

    name: str = required("name of the design and of its output folder", pattern=NAME_PATTERN)
    description: str = optional("free text", "", max_length=LONGEST_DESCRIPTION)
    format: FileFormat = optional(FILE_FORMAT, 1)
    train: TrainKeys = required("the train of gears; `kind` says which it is")

    def machine(self) -> dict[str, Any] | None:
        """The keys of the file of the machine that the train is by itself; None where it is none."""
        return (keys := self.train.machine()) and {"name": self.name, "description": self.description, **keys}

    @property
    def alone(self) -> frozenset[str]:
        """The keys of the machine by which the file, which has them below ``train``, changes the same."""
        names = names_in_file(type(self.train))
        return frozenset(key for key in names if f"{key}.".startswith(self.train.alone))


@cache
def names_in_file(kind: type[TrainKeys]) -> dict[str, str]:
    """The keys of a train's file by those of the machine that it is, or by their own below ``train``."""
    names = {**{key: key for key in dotted_keys(kind)}, **kind.WRITTEN_AS}
    return {key: f"train.{name}" for key, name in names.items()}


def train_model(data: Mapping[str, Any]) -> type[TrainFile]:
    """The model of a train file's data, with the keys of the kind that ``train.kind`` names.

    Raises WrongInput for a train of no known kind.
    """
    given = data["train"]
    kind = given.get("kind") if isinstance(given, Mapping) else None
    if not isinstance(kind, str) or kind not in KINDS:
        said = "missing" if kind is None else f"{quoted(kind)} given"
        raise WrongInput(f"{said}; {listed(KINDS)} is needed", key="train.kind")
    known = KINDS[kind].model_fields
    for key in given if isinstance(given, Mapping) else ():
        if key not in known and (others := [name for name, kind in KINDS.items() if key in kind.model_fields]):
            raise WrongInput(f"unknown key of kind {kind}; kind: {listed(others)} has it", key=f"train.{key}")
    return _model_of(kind)


@cache
def _model_of(kind: str) -> type[TrainFile]:
    keys = KINDS[kind]
    named: Any = Literal[tuple(KINDS)]
    meanings = "; ".join(f"{name}, {kind.MEANING}" for name, kind in KINDS.items())
    kind_key: Any = named, required(f"which train it is: {meanings}")
    title, first = f"{keys.__name__}Train", {"first": True}
    named_keys: Any = create_model(title, __base__=keys, __doc__=keys.__doc__, __cls_kwargs__=first, kind=kind_key)
    words = TrainFile.model_fields["train"].description or ""
    return create_model(f"{keys.__name__}File", __base__=TrainFile, train=(named_keys, required(words)))


def commands_of(train: object) -> list[str]:
    """The commands that take a file with such a value of ``train``, whether it is right or not."""
    kind = train.get("kind") if isinstance(train, Mapping) else None
    keys = KINDS.get(kind) if isinstance(kind, str) else None
    rated = keys and issubclass(keys, RatedTrain) and isinstance(train, Mapping) and keys.is_machine(train)
    more = ["strength", "tolerance", "simulate", "compare", "sweep"] if rated else []
    # Gears on a carrier have the loads of a machine, and not its power
    return ["check", "build", "report", "animate", "studio", *(more if keys and keys.TURNS_ALONE else more[:2])]


def train_models() -> dict[str, type[TrainFile]]:
    """The model of train files of each kind, by its name."""
    return {kind: _model_of(kind) for kind in KINDS}
