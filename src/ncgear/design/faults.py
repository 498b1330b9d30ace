"""A fault that a model finds between its own fields, carrying the key it belongs to."""

from __future__ import annotations

from pydantic_core import PydanticCustomError

FAULT_TYPE = "ncgear"


def fault(key: str, problem: str) -> PydanticCustomError:
    """The error a validator raises for ``key`` (dotted, relative to its model; empty for the model as a whole).

    pydantic knows only which model a validator belongs to; the key in the context leads to the line of the file.
    """
    # The text goes in as a value: as a template its braces would be read as placeholders.
    return PydanticCustomError(FAULT_TYPE, "{problem}", {"problem": problem, "key": key})
