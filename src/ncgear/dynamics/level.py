"""The levels of detail of a simulation, by their names for users."""

from __future__ import annotations

from enum import StrEnum


class Level(StrEnum):
    """The elastic parts: none, the teeth under a load at rest, or the teeth in a motion of masses in time."""

    RIGID = "rigid"
    QUASI_STATIC = "quasi_static"
    DYNAMIC = "dynamic"
