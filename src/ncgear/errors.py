"""The ways in which a design can fail, each with its exit status, and how an error gets its place in a file.

Code that finds a fault knows at most the key of the wrong value.  It raises ``WrongInput`` or ``NoSuchMechanism`` with
that key, and ``Unanswered`` where a computation finds no answer.  Code that works on one group of keys runs inside
``below``, which completes the key.  Code that knows the file calls it inside ``located``, which adds file, line and
column.  An error that already has a place keeps it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from typing import Any, Protocol, Self


class DesignError(Exception):
    """A design from which no gears can be made; ``exit_status`` says what kind of error it is.

    ``key`` is the dotted path of the wrong value (``motion.v1_mm_s``), or empty where the whole file is wrong.
    ``location`` is ``FILE:LINE:COLUMN`` once ``located`` has added it.  ``others`` are further faults of the same file.
    """

    exit_status = 1

    def __init__(self, problem: str, *, key: str = "", location: str = "", others: Sequence[DesignError] = ()) -> None:
        super().__init__(problem)
        self.problem = problem
        self.key = key
        self.location = location
        self.others = tuple(others)

    def __reduce__(self) -> tuple[Any, ...]:
        """How pickle passes the error between processes, whatever arguments its class needs."""
        return type(self).__new__, (type(self), *self.args), self.__dict__

    def saying(self, problem: str, key: str | None = None) -> Self:
        """The same error in other words; with a new ``key``, its place in the file is not known yet."""
        said = copy(self)
        said.problem = problem
        if key is not None:
            said.key, said.location = key, ""
        return said

    def __str__(self) -> str:
        own = ": ".join(part for part in (self.location, self.key, self.problem) if part)
        return "\n".join([own, *map(str, self.others)])


class WrongInput(DesignError):
    """The design file itself is wrong; the message says which value was given and which would be right."""

    exit_status = 2


class NoSuchMechanism(DesignError):
    """The file is right, but the mechanism it asks for does not exist; the message says where, why, what to change."""

    exit_status = 3


class RefusedAt(NoSuchMechanism):
    """A pair of gears whose teeth are refused at one angle of the driving gear, ``phi1_rad``."""

    def __init__(self, problem: str, *, phi1_rad: float, key: str = "", location: str = "") -> None:
        super().__init__(problem, key=key, location=location)
        self.phi1_rad = phi1_rad


class Unanswered(NoSuchMechanism):
    """The file is right, but ncgear cannot tell whether its mechanism exists: a search found no answer.

    Code that tries changes of a design, or other ways to make it, continues with the next, as after any refusal.
    ``rows`` are the numbers of the failed searches among many at once; ``searched_for`` names them.
    """

    def __init__(self, problem: str, *, key: str = "", location: str = "", rows: Sequence[int] = ()) -> None:
        super().__init__(problem, key=key, location=location)
        self.rows = tuple(rows)


class Places(Protocol):
    """The places of the values of a file."""

    def place(self, key: str) -> object:
        """The place of a dotted key, or of its nearest parent in the file; as text it is ``FILE:LINE:COLUMN``."""

    def as_written(self, key: str) -> str:
        """The key as the file spells it."""


@contextmanager
def located(places: Places | None) -> Iterator[None]:
    """A context that adds the place of the key to errors without a place; None, for no file, adds nothing."""
    try:
        yield
    except DesignError as error:
        if places is not None and not error.location:
            error.location = str(places.place(error.key))
            error.key = places.as_written(error.key)
        raise


@contextmanager
def below(group: str) -> Iterator[None]:
    """A context that puts ``group`` (dotted) before the key of errors raised within it."""
    try:
        yield
    except DesignError as error:
        if not error.location:
            error.key = f"{group}.{error.key}" if error.key else group
        raise


@contextmanager
def renamed(old: str, new: str, helps: str = "") -> Iterator[None]:
    """A context in which keys of errors that begin with ``old`` begin with ``new``, for files that spell them so.

    ``helps`` is said in place of what would help by keys that such files do not have.
    """
    try:
        yield
    except DesignError as error:
        if not error.location and (error.key == old or error.key.startswith(f"{old}.")):
            error.key = new + error.key.removeprefix(old)
            if helps:
                error.problem = f"{error.problem.partition('; ')[0]}; {helps}"
        raise


@contextmanager
def going_on() -> Iterator[None]:
    """A context that adds to wrong input that results so far are kept, for example where a disk is full."""
    try:
        yield
    except WrongInput as error:
        error.problem += "; what is finished is kept: where it can be written again, the same command goes on"
        raise


@contextmanager
def searched_for(what: Callable[[int], str], key: str) -> Iterator[None]:
    """A context that adds to failed searches ``what`` the first of them was about, and the key of that value."""
    try:
        yield
    except Unanswered as error:
        if not error.rows:
            raise
        raise Unanswered(f"{what(error.rows[0])}: {error.problem}", key=key) from error


def fault_words(error: Exception) -> str:
    """The text for a fault of ncgear itself: where to report it, and with what; with its traceback if asked for."""
    if os.environ.get("NCGEAR_DEBUG"):
        import traceback

        traceback.print_exception(error)
    from importlib.metadata import PackageNotFoundError, metadata

    try:
        urls = dict(entry.split(", ", 1) for entry in metadata("ncgear").get_all("Project-URL") or ())
    except PackageNotFoundError:
        urls = {}
    place = f" at {urls['Issues']}" if "Issues" in urls else ""
    reason = " ".join(f"{type(error).__name__}: {error}".split())
    return (
        f"internal fault: {reason}; please report it{place} with what ncgear --version says; NCGEAR_DEBUG=1 shows "
        "where it arose"
    )
