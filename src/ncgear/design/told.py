"""Wishes of the motion in the words of the command line, each as under ``wishes`` in a design file: ``KEY: VALUE``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, get_origin

from pydantic import ValidationError

from ncgear.design.keys.base import listed
from ncgear.design.keys.wishes import Wishes
from ncgear.design.reading.messages import problems
from ncgear.design.reading.text import quoted
from ncgear.design.reading.yaml import read_yaml
from ncgear.errors import WrongInput

OPTION = "--wish"
EXAMPLE = "time_ratio: {at_least: 1.5}"

SEVERAL = tuple(name for name, field in Wishes.model_fields.items() if get_origin(field.annotation) is tuple)
"""Kinds of wishes of which a design can have several: lists in its file."""


def wishes_told(texts: Iterable[str]) -> dict[str, Any]:
    """The wishes of some texts by their kinds, in the form of a design file; a kind of several wishes is a list.

    Raises WrongInput for a text that is no ``KEY: VALUE``, for values that no design file can have, and for wishes that
    contradict each other.
    """
    found: dict[str, Any] = {}
    for text in texts:
        for kind, value in _pairs(text):
            if kind in SEVERAL:
                found.setdefault(kind, []).extend(value if isinstance(value, list) else [value])
            elif kind in found:
                raise WrongInput(f"{kind} is given twice; give it once", key=OPTION)
            else:
                found[kind] = value
    _require_right(found)
    return found


def _pairs(text: str) -> Iterable[tuple[str, Any]]:
    """Kinds and values of one text."""
    data = read_yaml(text, OPTION).data
    if not isinstance(data, dict) or not data:
        kinds = listed(Wishes.model_fields)
        raise WrongInput(f"{quoted(text)} given; KEY: VALUE is right, as {EXAMPLE}, where KEY is {kinds}", key=OPTION)
    return data.items()


def _require_right(found: dict[str, Any]) -> None:
    try:
        Wishes.model_validate(found)
    except ValidationError as error:
        first = problems(error, Wishes)[0]
        raise WrongInput(first.text, key=f"{OPTION}: {first.key}") from error
