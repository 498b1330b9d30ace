"""The space of a sweep: some keys of a design file, the values that they take together, and the values they accept.

A key has a grid, a list, or a range with sampled points.  All combinations of grids and lists are tried, each with all
the sampled points, which are the same for every combination.  The number of a design gives its values: the space
computes the values of any numbers without the values before them.

The limits of many numbers at once come from the models, so they stand in one place.  They do not cover faults between
several keys.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from math import isfinite, prod
from typing import Annotated, Any, Literal, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import AfterValidator, BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ncgear.design.keys.base import SHORTEST_MM, not_vanishing
from ncgear.design.keys.design import Design, design_model
from ncgear.design.laws.registry import law_models
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.messages import fields_of, models_in, problems
from ncgear.design.reading.places import with_value
from ncgear.design.reading.text import plain_number, quoted, whole
from ncgear.design.trains.registry import TrainFile, train_model
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask

OPTION = "--vary"
FORM = "KEY=FROM:TO:COUNT, KEY=A,B,C or KEY=FROM:TO, as motion.v1_mm_s=1500:1700:21, is right"

MOST_DESIGNS = 100_000_000
"""Largest number of designs in a sweep."""

MOST_VALUES = 1_000_000
"""Largest number of values of one key."""

Sampling = Literal["sobol", "latin-hypercube"]


@dataclass(frozen=True)
class Listed:
    """A dotted key of the design file, and its values in the sweep."""

    key: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Ranged:
    """A dotted key of the design file, and the ends of the range in which its values are sampled."""

    key: str
    low: float
    high: float


@dataclass(frozen=True)
class Space:
    """The varied keys of a sweep; ``samples`` points are drawn from all ranges together.

    Sobol points are scrambled after Owen by ``scipy.stats.qmc.Sobol``, whose first 2^m points are evenly spread for
    each m.  A Latin hypercube by ``scipy.stats.qmc.LatinHypercube`` has one point in each of ``samples`` layers of each
    range.  The same seed gives the same points.
    """

    varied: tuple[Listed | Ranged, ...]
    samples: int = 1
    sampling: Sampling = "sobol"
    seed: int = 1

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that vary."""
        return tuple(quantity.key for quantity in self.varied)

    @property
    def lists(self) -> tuple[Listed, ...]:
        """The keys with grids or lists; the last key varies fastest in their combinations."""
        return tuple(quantity for quantity in self.varied if isinstance(quantity, Listed))

    @property
    def ranges(self) -> tuple[Ranged, ...]:
        """The sampled keys, which vary faster than all lists."""
        return tuple(quantity for quantity in self.varied if isinstance(quantity, Ranged))

    @property
    def count(self) -> int:
        """The number of designs."""
        return prod(len(quantity.values) for quantity in self.lists) * self.samples

    def values(self, first: int, count: int) -> Array:
        """The values of all keys, shape (count, keys), for the designs from number ``first`` on."""
        numbers = np.arange(first, first + count)
        columns = dict(self._listed(numbers // self.samples))
        if self.ranges:
            shares = self._shares(numbers % self.samples)
            for quantity, share in zip(self.ranges, shares.T, strict=True):
                columns[quantity.key] = quantity.low + (quantity.high - quantity.low) * share
        return np.column_stack([columns[key] for key in self.keys])

    def _listed(self, combination: IndexArray) -> Iterator[tuple[str, Array]]:
        left = combination
        for quantity in reversed(self.lists):
            left, place = np.divmod(left, len(quantity.values))
            yield quantity.key, np.array(quantity.values)[place]

    def _shares(self, sample: IndexArray) -> Array:
        """Places in the ranges, 0 to 1, shape (n, ranges), of samples with running numbers, which may begin again at 0.

        Only the requested points of a Sobol sequence are computed; a Latin hypercube must be computed as a whole.
        """
        dimensions = len(self.ranges)
        if self.sampling == "latin-hypercube":
            return _latin_hypercube(dimensions, self.samples, self.seed)[sample]
        if len(sample) >= self.samples:
            return _sobol(dimensions, self.seed, 0, self.samples)[sample]
        begins = np.concatenate([[0], np.flatnonzero(np.diff(sample) < 0) + 1, [len(sample)]]).tolist()
        runs = [sample[begin:end] for begin, end in pairwise(begins)]
        return np.vstack([_sobol(dimensions, self.seed, int(run[0]), len(run)) for run in runs])


def _sobol(dimensions: int, seed: int, first: int, count: int) -> Array:
    """Points of a scrambled Sobol sequence from number ``first`` on."""
    from scipy.stats.qmc import Sobol

    sequence = Sobol(dimensions, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        # The warning says that only powers of two are balanced, which docs/commands/sweep.md says as well.
        warnings.simplefilter("ignore", UserWarning)
        points: Array = (sequence.fast_forward(first) if first else sequence).random(count)
    return points


@lru_cache(maxsize=1)
def _latin_hypercube(dimensions: int, count: int, seed: int) -> Array:
    """All points; each process computes them once."""
    from scipy.stats.qmc import LatinHypercube

    return LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(count)


def varied_of(text: str) -> Listed | Ranged:
    """A key and its values: ``KEY=FROM:TO:COUNT`` even values, both ends included; ``KEY=A,B,C``; ``KEY=FROM:TO``.

    Raises WrongInput for any other text.
    """
    key, _, given = text.partition("=")
    listed = "," in given
    found = [plain_number(part) for part in given.split("," if listed else ":")]
    parts = [part for part in found if part is not None and isfinite(part)]
    if not key or len(parts) != len(found) or not (listed or len(parts) in (2, 3)):
        raise WrongInput(f"{text!r} given; {FORM}", key=OPTION)
    if listed:
        return _list(key, parts)
    low, high, *count = parts
    if not isfinite(float(high) - float(low)):
        raise WrongInput(f"{text!r} given; values nearer to each other are right", key=OPTION)
    if not count:
        if not low < high:
            raise WrongInput(f"{text!r} given; a range from a smaller to a greater value is right", key=OPTION)
        return Ranged(key, float(low), float(high))
    if not isinstance(count[0], int) or not 2 <= count[0] <= MOST_VALUES:
        raise WrongInput(f"{count[0]} values of {key} asked for; 2 to {MOST_VALUES} are right", key=OPTION)
    # As written in decimals, so that the last value is the end itself and a value at zero is zero
    first, last = Fraction(str(low)), Fraction(str(high))
    return Listed(key, tuple(float(first + (last - first) * step / (count[0] - 1)) for step in range(count[0])))


def _list(key: str, values: Sequence[float]) -> Listed:
    for value in values:
        if values.count(value) > 1:
            raise WrongInput(f"{key} is given {value} twice; keep one", key=OPTION)
    return Listed(key, tuple(map(float, values)))


def space_of(
    loaded: LoadedDesign,
    varied: Sequence[Listed | Ranged],
    samples: int | None = None,
    sampling: Sampling = "sobol",
    seed: int = 1,
) -> Space:
    """The space of some keys of a file.

    Raises WrongInput for a key given twice, a key without a number in the file, ranges without a number of samples or
    the reverse, a range of a key that takes whole numbers only, and too many designs.
    """
    for quantity in varied:
        if sum(other.key == quantity.key for other in varied) > 1:
            raise WrongInput(f"{quantity.key} is given twice; keep one", key=OPTION)
        _require_number(loaded, quantity.key)
    ranges = [quantity for quantity in varied if isinstance(quantity, Ranged)]
    for quantity in ranges:
        _require_fractions(loaded, quantity)
    if ranges and samples is None:
        raise WrongInput(
            f"missing; {ranges[0].key} has a range; give a number of sampled points, as --samples 1024, or give "
            f"{ranges[0].key} a number of even values, as {ranges[0].low:g}:{ranges[0].high:g}:11",
            key="--samples",
        )
    if samples is not None and not ranges:
        problem = "nothing is sampled, since every key has a grid or a list; leave it out, or give a range, KEY=FROM:TO"
        raise WrongInput(problem, key="--samples")
    space = Space(tuple(varied), samples or 1, sampling, seed)
    if space.count > MOST_DESIGNS:
        problem = f"{space.count} designs asked for; {MOST_DESIGNS} or fewer are right"
        raise WrongInput(problem, key=OPTION)
    return space


def _require_number(loaded: LoadedDesign, key: str) -> None:
    numbers = dict(_numbers(loaded.data, ""))
    if key in numbers:
        return
    close = get_close_matches(key, list(numbers), n=1)
    hint = f"; did you mean {close[0]}?" if close else "; a key that holds one in the file is right"
    raise WrongInput(f"the file has no number at {quoted(key)}{hint}", key=OPTION)


def _require_fractions(loaded: LoadedDesign, ranged: Ranged) -> None:
    """Refuse the range of a key that takes whole numbers only: nearly no sample would be whole."""
    tried = checked_design(loaded.data, [ranged.key], [int(ranged.low) + 0.5])
    if isinstance(tried, WrongInput) and tried.key == ranged.key and "whole number" in tried.problem:
        low, high = round(ranged.low), round(ranged.high)
        raise WrongInput(
            f"{ranged.key} takes whole numbers only, and a range is sampled between them too; "
            f"{ranged.key}={low}:{high}:{high - low + 1} is right",
            key=OPTION,
        )


def _numbers(data: Any, key: str) -> Iterator[tuple[str, float]]:
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
    model: type[Design] | type[TrainFile] = train_model(data) if "train" in data else design_model(data)
    try:
        made = model.model_validate(data)
        if isinstance(made, Design):
            return made
        data = made.machine() or data
        model = design_model(data)
        return model.model_validate(data).of_train(made.alone)
    except ValidationError as error:
        first = problems(error, model, data)[0]
        return WrongInput(first.text, key=first.key)
    except WrongInput as error:
        return error


def accepted(root: type[Design], data: Mapping[str, Any], key: str, values: Array) -> Mask:
    """Mask, shape (n,), of values that the model ``root`` accepts at a dotted key of plain data with a number there."""
    parts = list(_parts(_annotation_at(root, data, key)))
    held = np.isfinite(values)
    if int in parts and float not in parts:
        held &= values == np.round(values)
    for part in parts:
        match part:
            case Ge(ge=limit):
                held &= values >= float(str(limit))
            case Gt(gt=limit):
                held &= values > float(str(limit))
            case Le(le=limit):
                held &= values <= float(str(limit))
            case Lt(lt=limit):
                held &= values < float(str(limit))
            case AfterValidator(func=check) if check is not_vanishing:
                held &= values >= SHORTEST_MM
    return held


def _annotation_at(root: type[BaseModel], data: Any, key: str) -> Any:
    """The annotation of the value at a dotted key, with the limits that its field adds."""
    annotation: Any = root
    for part in key.split("."):
        if isinstance(data, list):
            data = data[int(part)]
            annotation = next(get_args(nested)[0] for nested in _nested(annotation) if get_origin(nested) is tuple)
            continue
        models = models_in(annotation)
        # The law of the file tells which model of ``motion`` has its keys.
        model = law_models()[data["law"]] if len(models) > 1 and "law" in data else models[0]
        field, data = fields_of(model)[part], data[part]
        annotation = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    return annotation


def _nested(annotation: Any) -> Iterator[Any]:
    yield annotation
    for part in get_args(annotation):
        yield from _nested(part)


def _parts(annotation: Any) -> Iterator[Any]:
    """The types and limits in an annotation, with the parts of a pydantic ``Field``."""
    for part in _nested(annotation):
        yield part
        if isinstance(part, FieldInfo):
            yield from part.metadata
