"""The designs of a sweep, which differ from that of a file in the values of a few keys."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import product
from math import isfinite, prod
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from ncgear.design.keys.design import Design, design_model
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.messages import problems
from ncgear.design.reading.places import with_value
from ncgear.design.reading.text import plain_number, quoted, whole
from ncgear.errors import WrongInput

if TYPE_CHECKING:
    from ncgear.numerics.arrays import Array

OPTION = "--vary"
FORM = "KEY=FROM:TO:COUNT, as motion.v1_mm_s=1500:1700:21, is right"

MOST_DESIGNS = 100_000
"""Largest number of designs in a sweep; designs that can be computed together then take half a minute."""


@dataclass(frozen=True)
class Varied:
    """A dotted key of the design file, and its values in the sweep."""

    key: str
    values: tuple[float, ...]


def varied_of(text: str) -> Varied:
    """``KEY=FROM:TO:COUNT``: COUNT even values, both ends included; raises WrongInput for anything else."""
    key, _, numbers = text.partition("=")
    parts = [plain_number(part) for part in numbers.split(":")]
    if not key or len(parts) != 3 or not all(part is not None and isfinite(part) for part in parts):
        raise WrongInput(f"{text!r} given; {FORM}", key=OPTION)
    low, high, count = (part for part in parts if part is not None)
    if not isinstance(count, int) or not 2 <= count <= MOST_DESIGNS:
        raise WrongInput(f"{count} values of {key} asked for; 2 to {MOST_DESIGNS} are right", key=OPTION)
    if not isfinite(float(high) - float(low)):
        raise WrongInput(f"{text!r} given; values nearer to each other are right", key=OPTION)
    return Varied(key, tuple(float(low + (high - low) * step / (count - 1)) for step in range(count)))


def require_grid(loaded: LoadedDesign, varied: Sequence[Varied]) -> None:
    """Raise WrongInput for a key given twice, for a key at which the file has no number, and for too many designs."""
    keys = [one.key for one in varied]
    for key in keys:
        if keys.count(key) > 1:
            raise WrongInput(f"{key} is given twice; keep one", key=OPTION, location=str(loaded.path))
        _require_number(loaded, key)
    count = prod(len(one.values) for one in varied)
    if count > MOST_DESIGNS:
        raise WrongInput(
            f"{count} designs asked for; {MOST_DESIGNS} or fewer are right", key=OPTION, location=str(loaded.path)
        )


def grid_of(varied: Sequence[Varied]) -> Array:
    """Every combination of values, shape (n, keys); the last key varies fastest."""
    import numpy as np

    return np.array(list(product(*(one.values for one in varied))), dtype=float)


def _require_number(loaded: LoadedDesign, key: str) -> None:
    """Refuse a key at which the file has no number."""
    numbers = dict(_numbers(loaded.data, ""))
    if key in numbers:
        return
    close = get_close_matches(key, list(numbers), n=1)
    hint = f"; did you mean {close[0]}?" if close else "; a key that holds one in the file is right"
    raise WrongInput(f"the file has no number at {quoted(key)}{hint}", key=OPTION, location=str(loaded.path))


def _numbers(data: Any, key: str) -> Iterator[tuple[str, float]]:
    """Dotted keys that hold numbers, and the numbers."""
    if isinstance(data, dict | list):
        for name, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from _numbers(value, f"{key}.{name}" if key else str(name))
    elif isinstance(data, int | float) and not isinstance(data, bool):
        yield key, data


def checked_design(data: dict[str, Any], keys: Sequence[str], values: Iterable[float]) -> Design | WrongInput:
    """The design of a file's plain values with other numbers at some dotted keys, or its fault."""
    for key, value in zip(keys, values, strict=True):
        # Every key accepts a whole number as an integer, and some keys accept only integers.
        data = with_value(data, key, whole(value))
    model = design_model(data)
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first = problems(error, model)[0]
        return WrongInput(first.text, key=first.key)
