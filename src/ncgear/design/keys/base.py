"""The base of all models of keys: strict types, no unknown keys, no changes, no nan or infinity; faults; rules; angles.

A fault that a model finds between its own fields has the key of the faulty value.  Fields are ``required`` or
``optional``.  An angle may be given in radians, in degrees or in multiples of pi, by keys that end in the unit: one
field marked ``angle`` makes all of them.  Rules between the keys of a model stand in its ``RULES``; methods that return
``Faults`` yield all other faults.  The types of values with their limits stand at the end.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, partial, reduce
from inspect import get_annotations, isfunction
from itertools import chain, pairwise
from math import pi, radians
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict, model_validator
from pydantic_core import PydanticCustomError

from ncgear.design.words import COUNTS, listed, spellings
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import label_and_unit


def required(meaning: str, **limits: Any) -> Any:
    """A field that a file must give."""
    return Field(description=meaning, **limits)


def optional(meaning: str, default: Any = None, **limits: Any) -> Any:
    """A field that a file may leave out; ``default`` is its value then, or a function that makes this value."""
    return Field(**{"default_factory" if callable(default) else "default": default}, description=meaning, **limits)


class _Angle(NamedTuple):
    """The mark of an angle; it stands in the place of the angle's field until the class is made."""

    meaning: str
    quantity: str
    type: Any
    rule: str
    absent: Any


def angle(meaning: str, quantity: str = "", *, needed: bool = False, of: Any = float, absent: Any = 0.0) -> Any:
    """An angle in rad, or a list of them, that a file gives by one of the keys ``quantity``_rad, _deg and _pi.

    ``quantity`` is by default the name of the field, ``of`` the type of the value in any unit, ``absent`` the angle if
    all keys are left out.  ``{unit}`` in the meaning stands for the unit in words, ``{turn}`` for a turn in it.
    """
    return _Angle(meaning, quantity, of, "one of" if needed else "at most one of", absent)


FULL_TURN = {"rad": 2.0 * pi, "deg": 360.0, "pi": 2.0}

_WORDS = {"rad": ("in rad", "2 pi"), "deg": ("in degrees", "360"), "pi": ("in multiples of pi", "2")}

_TO_RAD: dict[str, Callable[[float], float]] = {"rad": float, "deg": radians, "pi": lambda value: value * pi}


class Model(BaseModel):
    """Base of every model: the person's values, checked and unchangeable."""

    # pydantic makes the schema of a model when it checks a file by it: most models are only parts of others.
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)

    RULES: ClassVar[tuple[str, ...]] = ()
    """Rules between keys, besides the rules of the bases, in the words of ``unkept``."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Put the keys of all units in the place of each angle, before pydantic looks for fields."""
        super().__init_subclass__()
        found: dict[str, Any] = {}
        for name, annotation in get_annotations(cls).items():
            mark = vars(cls).get(name)
            if not isinstance(mark, _Angle):
                found[name] = annotation
                continue
            quantity = mark.quantity or name
            for key, (unit, turn) in zip(spellings(quantity), _WORDS.values(), strict=True):
                found[key] = mark.type | None
                setattr(cls, key, optional(mark.meaning.format(unit=unit, turn=turn)))
            found[name] = ClassVar[Any]
            setattr(cls, name, property(partial(_in_rad, quantity=quantity, absent=mark.absent)))
            cls.RULES = (" ".join((mark.rule, *spellings(quantity))), *vars(cls).get("RULES", ()))
        cls.__annotations__ = found

    @classmethod
    def __pydantic_init_subclass__(cls, first: bool = False, **kwargs: Any) -> None:
        """Put the keys of a class behind the keys of its base, or with ``first=True`` before them, as files have
        them."""
        own, base = cls.__annotations__, getattr(cls.__bases__[0], "model_fields", {})
        fields = cls.__pydantic_fields__
        order = (*own, *base) if first else (*base, *own)
        cls.__pydantic_fields__ = {name: fields[name] for name in order if name in fields}

    def _broken_rules(self) -> Faults:
        for rule in (rule for base in reversed(type(self).__mro__) for rule in vars(base).get("RULES", ())):
            yield from unkept(self, rule)

    @model_validator(mode="after")
    def _has_no_fault(self) -> Self:
        for found in chain.from_iterable(check(self) for check in _checks_of(type(self))):
            raise found
        return self


@cache
def _checks_of(model: type[Model]) -> list[Callable[[Model], Faults]]:
    """The methods of a model that return ``Faults``: first the refusal of unoffered keys, then the methods of its
    bases."""
    every = [pair for base in reversed(model.__mro__) for pair in vars(base).items()]
    checks = [pair for pair in every if isfunction(pair[1]) and pair[1].__annotations__.get("return") == "Faults"]
    return [check for _, check in sorted(checks, key=lambda pair: pair[0] != "_not_offered")]


def key_of(model: BaseModel, quantity: str) -> str:
    """The key by which an angle is given; empty if the angle is left out."""
    return next(iter(given(model, spellings(quantity))), "")


def _in_rad(model: BaseModel, quantity: str, absent: Any) -> Any:
    key = key_of(model, quantity)
    if not key:
        return absent
    value, to_rad = getattr(model, key), _TO_RAD[key.rpartition("_")[2]]
    return tuple(map(to_rad, value)) if isinstance(value, tuple) else to_rad(value)


FAULT_TYPE = "ncgear"
Faults = Iterator[PydanticCustomError]
"""Faults between the keys of a model, in the order in which they count: only the first fault is told."""


def fault(key: str, problem: str) -> PydanticCustomError:
    """The error that a validator raises for ``key`` (dotted, relative to its model; empty for the whole model).

    pydantic knows only the model of a validator; the key in the context leads to the line of the file.
    """
    # The text is a value of the template: in the template itself, its braces would be placeholders.
    return PydanticCustomError(FAULT_TYPE, "{problem}", {"problem": problem, "key": key})


def counts(key: str, given: int, needed: int, noun: str, place: str) -> Faults:
    """The fault of a list of ``given`` values, none if left out, that has not one for each of ``needed`` nouns."""
    if given and given != needed:
        nouns = f"{COUNTS[needed]} {noun}{'s' * (needed != 1)}"
        told = f"{given} given for {nouns} {place}; one for each is right"
        yield fault(key, told if needed else f"given, but there is {nouns.removesuffix('s')} {place}; leave it out")


def given(model: BaseModel, names: Iterable[str]) -> list[str]:
    """The ``names`` that have a value; a key without a value counts as left out."""
    return [name for name in names if getattr(model, name) is not None]


_RELATIONS: dict[str, tuple[Callable[[float, float], bool], str, str]] = {
    "<": (operator.lt, "under {}", "over {}"),
    "<=": (operator.le, "{} or less", "{} or over"),
    ">": (operator.gt, "over {}", "under {}"),
    ">=": (operator.ge, "{} or over", "{} or less"),
}
"""Relations of numbers: whether each holds, and the words for a right first number and a right second number."""


def unkept(model: BaseModel, rule: str) -> Faults:
    """The fault of a model that breaks a rule between dotted keys.

    The rules are ``one of A B``: exactly one is given; ``at most one of A B``; ``A with B``: both are given or neither;
    ``A needs B C``: A is given only with B or C; and, if both are given, ``A as many as B`` for lists and ``A < B``,
    also <=, > and >=, for numbers.
    """
    match rule.split():
        case ["one", "of", *names]:
            if all(_at(model, name) is None for name in names):
                yield fault("", f"one of {listed(names)} is missing; give exactly one of them")
            yield from unkept(model, f"at most {rule}")
        case ["at", "most", "one", "of", *names]:
            found = [name for name in names if _at(model, name) is not None]
            if len(found) > 1:
                yield fault(found[1], f"{listed(found, 'and')} are given, and only one of them can count; keep one")
        case [one, "with", other]:
            yield from unkept(model, f"{one} needs {other}")
            yield from unkept(model, f"{other} needs {one}")
        case [key, "needs", *others]:
            if _at(model, key) is not None and all(_at(model, other) is None for other in others):
                yield fault(key, f"given without {listed(others)}; give {listed(others)} as well, or leave {key} out")
        case [key, "as", "many", "as", other]:
            counts = [len(values) for name in (key, other) if (values := _at(model, name)) is not None]
            if len(counts) == 2 and counts[0] != counts[1]:
                yield fault(key, f"{counts[0]} values, but {other} has {counts[1]}; {counts[1]} values are right")
        case [key, relation, other]:
            (holds, *words), value, bound = _RELATIONS[relation], _at(model, key), _at(model, other)
            if value is not None and bound is not None and not holds(value, bound):
                sides = [(key, value), (other, bound)]
                if not _is_written(model, key):
                    sides.reverse()
                    words.reverse()
                (key, _), (other, _) = sides
                told, right = (f"{number:.10g} {label_and_unit(name)[1]}".strip() for name, number in sides)
                left_out = "" if _is_written(model, other) else " where it is left out"
                where = f" beside {key.partition('.')[0]}" if "." in key and "." not in other else ""
                yield fault(
                    key, f"{told} given, but {other}{where} is {right}{left_out}; {words[0].format(right)} is right"
                )


def _at(model: BaseModel, key: str) -> Any:
    """The value at a dotted key; None if it, or a group on the way, is left out."""
    return reduce(lambda group, name: None if group is None else getattr(group, name), key.split("."), model)


def _is_written(model: BaseModel, key: str) -> bool:
    """Whether a file gives a dotted key; otherwise its value is the default."""
    *way, name = key.split(".")
    group = _at(model, ".".join(way)) if way else model
    return name in group.model_fields_set


def not_rising(key: str, values: Sequence[float], least: float, what: str = "angles") -> Faults:
    """The faults of values of a list under ``key`` that do not exceed the value before by at least ``least``."""
    for i, (before, after) in enumerate(pairwise(values), start=1):
        if after <= before:
            yield fault(f"{key}.{i}", f"{after:g} follows {before:g}; the {what} must rise strictly")
        if after - before < least:
            yield fault(f"{key}.{i}", f"{after!r} follows {before!r}; at least {shown_above(least, 2)} apart is right")


LONGEST_MM = 1e7
"""Ten kilometres: beyond any machine, and far below lengths whose squares overflow."""

SLOWEST_RPM, FASTEST_RPM = 1e-6, 1e7
"""One turn in two years, and far above any machine: squares of speeds stay far from overflow and zero."""

SHORTEST_MM = 1e-12
"""A hundred-thousandth of an atom's diameter, and far above lengths whose powers vanish."""


def not_vanishing(length: float) -> float:
    """The length itself in mm; a fault if it is too short."""
    if length < SHORTEST_MM:
        raise fault("", f"{length!r} given; a length of {SHORTEST_MM:g} mm or over is needed")
    return length


Length = Annotated[float, Field(gt=0.0, le=LONGEST_MM), AfterValidator(not_vanishing)]
Place = Annotated[float, Field(ge=-LONGEST_MM, le=LONGEST_MM)]
Speed = Annotated[float, Field(ge=SLOWEST_RPM, le=FASTEST_RPM)]
Positive = Annotated[float, Field(gt=0.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Direction = Annotated[float, Field(ge=-360.0, le=360.0)]
"""An angle in degrees."""

LONGEST_EXPRESSION = 1000

Expression = Annotated[str, Field(min_length=1, max_length=LONGEST_EXPRESSION)]
"""A formula."""

FORMULA = (
    "made of numbers, pi, + - * / **, sin, cos, tan, exp, log, sqrt, atan, sinh, cosh, tanh, abs, sign, min, max "
    "and a if u < v else b"
)
"""The words for formulas that ``ncgear.numerics.formula`` reads."""

SMOOTH_LAW = (
    "it may not jump where such pieces meet or where the cycle begins again; where its slope jumps there, gears cannot "
    "be made"
)
"""The demand of pitch curves on a ratio and on dphi2/dphi1."""

Item = TypeVar("Item")

# YAML has only lists, and strict models accept only tuples: so the container is not strict, but its items are.
Several = Annotated[tuple[Item, ...], Strict(False)]
Numbers = Several[float]
FileName = Annotated[str, Field(min_length=1)]

CSV_FILE = (
    "table (CSV, XLSX, ODS) with {} columns instead, its header naming them; its path counts from the design file"
)

FileFormat = Literal[1]
FILE_FORMAT = "version of the file's format; a file of a later format needs a later ncgear; left out: 1"
"""The readable formats, and the words for their key; a change of the meaning of older files makes format 2."""
