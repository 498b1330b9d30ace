"""What a person is told of a fault, whatever it is; the conversation goes on after it."""

from __future__ import annotations

from typing import Any

from ncgear.errors import DesignError, WrongInput, fault_words


def words_of(error: Exception) -> str:
    """A fault of the design or of a file in its own words; any other is one of ncgear."""
    match error:
        case DesignError():
            return str(error)
        case OSError(strerror=str(reason), filename=name):
            return f"{name}: {reason}" if name else reason
    return fault_words(error)


def refusal(error: Exception, part: str = "") -> dict[str, Any]:
    """Why the parts after one do not exist, and in ``others`` further faults of the same text."""
    design = error if isinstance(error, DesignError) else DesignError(words_of(error))
    others = [_fault(one) for one in design.others]
    return {"after": part, "wrong_input": isinstance(design, WrongInput), **_fault(design), "others": others}


def _fault(error: DesignError) -> dict[str, Any]:
    place = error.location.rpartition(":")[0].rpartition(":")[2]
    return {"problem": error.problem, "key": error.key, "line": int(place) if place.isdigit() else None}
