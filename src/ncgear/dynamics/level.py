"""The levels of detail of a simulation, by the names a user gives."""

from __future__ import annotations

from enum import StrEnum


class Level(StrEnum):
    """How much of the machine gives way; each level uses the stages below it and no more."""

    RIGID = "rigid"
