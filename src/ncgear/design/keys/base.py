"""The base of all models of keys: strict types, no unknown keys, no changes, no nan or infinity; faults; angles.

A fault that a model finds between its own fields has the key to which it belongs.  An angle may be given in radians, in
degrees or in multiples of pi; its key ends in the unit.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import pi, radians
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, Strict
from pydantic_core import PydanticCustomError

from ncgear.design.words import UNITS as UNITS
from ncgear.design.words import folded as folded
from ncgear.design.words import listed as listed
from ncgear.design.words import quantity as quantity
from ncgear.design.words import spellings as spellings
from ncgear.numerics.bounds import shown_above

LONGEST_MM = 1e7
"""Ten kilometres: beyond any machine, and far below where the squares of lengths overflow."""

SLOWEST_RPM, FASTEST_RPM = 1e-6, 1e7
"""One turn in two years, and far above whatever a machine has: squares of speeds stay far from overflow and zero."""

Length = Annotated[float, Field(gt=0.0, le=LONGEST_MM)]
Speed = Annotated[float, Field(ge=SLOWEST_RPM, le=FASTEST_RPM)]
Positive = Annotated[float, Field(gt=0.0)]

LONGEST_EXPRESSION = 1000

Expression = Annotated[str, Field(min_length=1, max_length=LONGEST_EXPRESSION)]
"""A formula."""

FORMULA = (
    "made of numbers, pi, + - * / **, sin, cos, tan, exp, log, sqrt, atan, sinh, cosh, tanh, abs, sign, min, max "
    "and a if u < v else b"
)
"""What ``ncgear.numerics.formula`` reads."""

SMOOTH_LAW = (
    "it may not jump where such pieces meet or where the cycle begins again; where its slope jumps there, gears cannot "
    "be made"
)
"""What the pitch curves ask of a ratio and of dphi2/dphi1."""

# YAML has only lists, and strict models accept only tuples: so the container is not strict, but its numbers are.
Numbers = Annotated[tuple[float, ...], Strict(False)]


class Model(BaseModel):
    """Base of every model: what a person wrote, checked and unchangeable."""

    # The schema of a model is made when a file is checked by it: most models are only parts of others.
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)


FAULT_TYPE = "ncgear"


def fault(key: str, problem: str) -> PydanticCustomError:
    """The error that a validator raises for ``key`` (dotted, relative to its model; empty for the whole model).

    pydantic knows only the model of a validator; the key in the context leads to the line of the file.
    """
    # The text is a value of the template: in the template itself, its braces would be placeholders.
    return PydanticCustomError(FAULT_TYPE, "{problem}", {"problem": problem, "key": key})


FULL_TURN = {"rad": 2.0 * pi, "deg": 360.0, "pi": 2.0}


def given(model: BaseModel, names: Iterable[str]) -> list[str]:
    """The ``names`` that have a value; a key without a value counts as left out."""
    return [name for name in names if getattr(model, name) is not None]


def require_one(model: BaseModel, names: Iterable[str]) -> None:
    """Refuse a model that has none or more than one of ``names``."""
    names = list(names)
    if not given(model, names):
        raise fault("", f"one of {listed(names)} is missing; give exactly one of them")
    allow_one(model, names)


def allow_one(model: BaseModel, names: Iterable[str]) -> None:
    """Refuse a model that has more than one of ``names``."""
    found = given(model, names)
    if len(found) > 1:
        raise fault(found[1], f"{listed(found, 'and')} are given, in each other's place; keep one")


def require_rising(key: str, values: Sequence[float], least: float) -> None:
    """Refuse a list under ``key`` in which a value does not follow the one before by at least ``least``."""
    for i, (before, after) in enumerate(pairwise(values), start=1):
        if after <= before:
            raise fault(f"{key}.{i}", f"{after:g} follows {before:g}; the angles must rise strictly")
        if after - before < least:
            raise fault(f"{key}.{i}", f"{after!r} follows {before!r}; at least {shown_above(least, 2)} apart is right")


def in_rad(value: float, unit: str) -> float:
    """``value`` in radians; ``unit`` is rad, deg or pi."""
    if unit == "deg":
        return radians(value)
    return value * pi if unit == "pi" else value


def angle_rad(model: BaseModel, quantity: str) -> float:
    """The angle ``quantity`` of ``model`` in radians, from the key by which it was given; 0 where it was not given."""
    for unit in UNITS:
        value = getattr(model, f"{quantity}_{unit}")
        if value is not None:
            return in_rad(float(value), unit)
    return 0.0
