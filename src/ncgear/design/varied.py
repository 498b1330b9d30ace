"""A design that differs from that of a file in the values of a few keys."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pydantic import ValidationError

from ncgear.design.keys.design import Design, design_model
from ncgear.design.reading.messages import problems
from ncgear.design.reading.places import with_value
from ncgear.design.reading.text import whole
from ncgear.errors import WrongInput


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
