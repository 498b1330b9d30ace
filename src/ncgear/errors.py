"""The two ways in which a design can fail, each with its exit status, and how an error gets its place in a file.

Whoever finds a fault knows at most the key of the value at fault.  It raises ``WrongInput`` or ``NoSuchMechanism`` with
that key; code that works on one group of a file's keys does so inside ``below``.  Whoever has read the file calls it
inside ``located``, which adds file, line and column.  An error that has a place keeps it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol


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


class Places(Protocol):
    """Where the values of a file stand."""

    def place(self, key: str) -> object:
        """Where a dotted key stands, or its nearest parent that does; as text it is ``FILE:LINE:COLUMN``."""

    def as_written(self, key: str) -> str:
        """The key as the file spells it."""


@contextmanager
def located(places: Places | None) -> Iterator[None]:
    """A context in which errors that know only their key get its place; None, of no file, leaves them as they are."""
    try:
        yield
    except DesignError as error:
        if places is not None and not error.location:
            error.location = str(places.place(error.key))
            error.key = places.as_written(error.key)
        raise


@contextmanager
def below(group: str) -> Iterator[None]:
    """A context in which errors know their key below ``group`` (dotted) only; they leave it with the whole key."""
    try:
        yield
    except DesignError as error:
        if not error.location:
            error.key = f"{group}.{error.key}" if error.key else group
        raise
