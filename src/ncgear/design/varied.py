"""Designs that differ from that of a file in the numbers at a few keys, and which numbers a key accepts.

The limits of many numbers at once are read from the models, so they stand in one place.  Validators that look at
several keys are not among them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import AfterValidator, BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ncgear.design.keys.design import Design, design_model
from ncgear.design.keys.types import SHORTEST_MM, not_vanishing
from ncgear.design.laws.registry import law_models
from ncgear.design.reading.messages import fields_of, models_in, problems
from ncgear.design.reading.places import with_value
from ncgear.design.reading.text import whole
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array, Mask


def checked_design(data: dict[str, Any], keys: Sequence[str], values: Iterable[float]) -> Design | WrongInput:
    """The design of a file's plain values with other numbers at some dotted keys, or its fault."""
    for key, value in zip(keys, values, strict=True):
        # Every key accepts a whole number as an integer, and some keys accept only integers.
        data = with_value(data, key, whole(value))
    model = design_model(data)
    try:
        return model.model_validate(data)
    except ValidationError as error:
        first = problems(error, model, data)[0]
        return WrongInput(first.text, key=first.key)


def accepted(root: type[Design], data: Mapping[str, Any], key: str, values: Array) -> Mask:
    """Which values (shape (n,)) the model ``root`` accepts at a dotted key of plain data that has a number there."""
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
            annotation = next(get_args(one)[0] for one in _nested(annotation) if get_origin(one) is tuple)
            continue
        models = models_in(annotation)
        # The law of a file tells which of the models of ``motion`` its keys are of.
        model = law_models()[data["law"]] if len(models) > 1 and "law" in data else models[0]
        field, data = fields_of(model)[part], data[part]
        annotation = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    return annotation


def _nested(annotation: Any) -> Iterator[Any]:
    """An annotation and all that it is made of."""
    yield annotation
    for part in get_args(annotation):
        yield from _nested(part)


def _parts(annotation: Any) -> Iterator[Any]:
    """The types and the limits that an annotation is made of, those in a pydantic ``Field`` too."""
    for part in _nested(annotation):
        yield part
        if isinstance(part, FieldInfo):
            yield from part.metadata
