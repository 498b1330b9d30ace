"""Messages from a page: objects of JSON, whose numbers are finite and whose text is Unicode."""

from __future__ import annotations

import json
from math import isfinite
from typing import Any

from ncgear.errors import WrongInput


def read_message(data: str | bytes) -> dict[str, Any]:
    """The message in a frame of a web socket; raises WrongInput for what is none."""
    try:
        if isinstance(data, bytes):
            raise ValueError("bytes")
        message = json.loads(data, parse_int=_finite, parse_float=_finite, parse_constant=_finite)
        json.dumps(message, ensure_ascii=False).encode()
    except (ValueError, RecursionError) as error:
        said = "a frame of text with an object of JSON is right, its numbers finite and its text Unicode"
        raise WrongInput(f"a message that cannot be read; {said}") from error
    if not isinstance(message, dict):
        raise WrongInput("a message that is no object of JSON")
    return message


def _finite(text: str) -> float:
    """A number of JSON, whole ones as such; raises ValueError for one that no computation could take."""
    if not isfinite(float(text)):
        raise ValueError(text)
    return int(text) if text.lstrip("-").isdigit() else float(text)
