"""Messages between page and studio: messages from a page, answers about a design, and faults in words."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from math import isfinite
from typing import Any

from ncgear.design.reading.design_file import LoadedTrain
from ncgear.errors import DesignError, WrongInput, fault_words, located
from ncgear.project.drive import Drive


def words_of(error: Exception) -> str:
    """The words of a fault of the design or of a file; any other fault is a fault of ncgear."""
    match error:
        case DesignError():
            return str(error)
        case OSError(strerror=str(reason), filename=name):
            return f"{name}: {reason}" if name else reason
    return fault_words(error)


def refusal(error: Exception, part: str = "") -> dict[str, Any]:
    """The reason why the parts after one do not exist; ``others`` has further faults of the same text."""
    design = error if isinstance(error, DesignError) else DesignError(words_of(error))
    others = [_fault(fault) for fault in design.others]
    return {"after": part, "wrong_input": isinstance(design, WrongInput), **_fault(design), "others": others}


def _fault(error: DesignError) -> dict[str, Any]:
    place = error.location.rpartition(":")[0].rpartition(":")[2]
    return {"problem": error.problem, "key": error.key, "line": int(place) if place.isdigit() else None}


def read_message(data: str | bytes) -> dict[str, Any]:
    """The message in a frame of a web socket; raises WrongInput for anything else."""
    try:
        if isinstance(data, bytes):
            raise ValueError("bytes")
        message = json.loads(data, parse_int=_number, parse_float=_number, parse_constant=_number)
        json.dumps(message, ensure_ascii=False).encode()
    except (ValueError, RecursionError) as error:
        said = "a frame of text with an object of JSON is right, its numbers finite and its text Unicode"
        raise WrongInput(f"a message that cannot be read; {said}") from error
    if not isinstance(message, dict):
        raise WrongInput("a message that is no object of JSON")
    return message


def _number(text: str) -> float:
    """A number of JSON, whole numbers as integers; raises ValueError for a number that no computation can use."""
    if not isfinite(float(text)):
        raise ValueError(text)
    return int(text) if text.lstrip("-").isdigit() else float(text)


Answer = tuple[str, Any]

Asked = Drive | LoadedTrain

Answers = Callable[[Asked], Iterator[Answer]]


def guarded(answers: Answers, asked: Callable[[], Asked]) -> Iterator[Answer]:
    """The answers about a drive or a train; where they cannot be given for any reason, a refusal."""
    part = "design"
    try:
        made = asked()
        with located(made.places):
            for name, content in answers(made):
                part = name
                yield name, content
    except Exception as error:
        yield "refused", refusal(error, part)
