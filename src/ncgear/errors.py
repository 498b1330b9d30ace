"""The two ways a design can fail, each with its exit status and a message for the person who wrote the file."""

from __future__ import annotations


class DesignError(Exception):
    """A design that gives no gears; ``exit_status`` says of which kind.

    ``key`` is the dotted path of the value at fault (``motion.v1_mm_s``), or empty when the whole file is.
    ``location`` is ``FILE:LINE:COLUMN`` once whoever knows the file has added it.
    """

    exit_status = 1

    def __init__(self, problem: str, *, key: str = "", location: str = "") -> None:
        super().__init__(problem)
        self.problem = problem
        self.key = key
        self.location = location

    def __str__(self) -> str:
        return ": ".join(part for part in (self.location, self.key, self.problem) if part)


class WrongInput(DesignError):
    """The design file itself is wrong: what was given, and what would be right."""

    exit_status = 2


class NoSuchMechanism(DesignError):
    """The file is well formed, but the mechanism it asks for does not exist: where, why, and what to change."""

    exit_status = 3
