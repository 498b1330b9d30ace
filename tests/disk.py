"""A disk with faults, and runs that die: every call of the file system is counted, and one goes wrong.

All of them go through the functions of ``os``, and through ``io.open`` for reading, so these are replaced here.  A run
that dies makes no more calls at all, as a killed one; its files are closed, which gives back its lock.  The disk does
not wait for ``fsync``; it only remembers what a cut of the power would have lost, the contents of files, not names.
"""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import StrEnum
from pathlib import Path
from typing import Any

CALLS = (
    "open",
    "close",
    "write",
    "fsync",
    "mkdir",
    "rmdir",
    "link",
    "symlink",
    "readlink",
    "replace",
    "rename",
    "unlink",
    "remove",
    "stat",
    "lstat",
    "scandir",
    "listdir",
    "utime",
    "chmod",
    "sendfile",
)


class Fault(StrEnum):
    """What happens at a call, or from it on."""

    NO_SPACE = "no space"
    BROKEN = "input/output error"
    BROKEN_FOR_GOOD = "input/output error from then on"
    SHORT = "half of a write is written"
    DEATH = "death"
    DEATH_IN_WRITE = "death in the middle of a write"
    POWER_CUT = "death, and what was not waited for is lost"


ERRORS = {
    Fault.NO_SPACE: errno.ENOSPC,
    Fault.BROKEN: errno.EIO,
    Fault.BROKEN_FOR_GOOD: errno.EIO,
}

NEEDS_SPACE = {"open", "write", "fsync", "mkdir", "link", "symlink", "replace", "rename"}
"""Calls that a full disk can refuse."""


class Death(BaseException):
    """The end of a run, which it cannot catch in earnest: whatever it does then, no call is made."""


class Disk:
    """Counts calls, and makes the ``at``-th of them go wrong, if the fault is one of that call."""

    def __init__(self, fault: Fault | None = None, at: int = 0, act: Callable[[], None] | None = None) -> None:
        self.fault, self.at, self.act = fault, at, act
        self.calls: list[str] = []
        self.struck = self.dead = False
        self._handles: set[int] = set()
        self._copies: list[int] = []
        self._unsafe: dict[int, int] = {}
        self._lost: list[int] = []
        """Open files with contents that the disk may not have yet, each with another handle; and closed ones."""
        self._really = {name: getattr(os, name) for name in CALLS if hasattr(os, name)}
        self._really_open = io.open

    @contextmanager
    def used(self) -> Iterator[Disk]:
        """A context in which the calls of this process are those of the disk; death ends it without an exception."""
        for name in self._really:
            setattr(os, name, self._watched(name))
        io.open = self._opened
        try:
            with suppress(Death):
                yield self
        finally:
            for name, really in self._really.items():
                setattr(os, name, really)
            io.open = self._really_open
            if self.dead and self.fault is Fault.POWER_CUT:
                for copy in {*self._unsafe.values(), *self._lost}:
                    os.ftruncate(copy, 0)
            for handle in {*self._handles, *self._copies}:
                with suppress(OSError):
                    os.close(handle)

    def _opened(self, *arguments: Any, **named: Any) -> Any:
        self._strike("open")
        return self._really_open(*arguments, **named)

    def _watched(self, name: str) -> Callable[..., Any]:
        really = self._really[name]

        def call(*arguments: Any, **named: Any) -> Any:
            if name == "write" and self._is_next(Fault.SHORT, Fault.DEATH_IN_WRITE) and len(arguments[1]) > 1:
                return self._half(*arguments)
            self._strike(name)
            done = None if name == "fsync" else really(*arguments, **named)
            if name == "open":
                self._handles.add(done)
            elif name == "close":
                self._handles.discard(arguments[0])
                self._lost.extend(copy for copy in [self._unsafe.pop(arguments[0], None)] if copy is not None)
            elif name == "write":
                self._mark_unsafe(arguments[0])
            elif name == "fsync":
                self._unsafe.pop(arguments[0], None)
            return done

        return call

    def _mark_unsafe(self, handle: int) -> None:
        if handle not in self._unsafe:
            self._unsafe[handle] = os.dup(handle)
            self._copies.append(self._unsafe[handle])

    def _is_next(self, *faults: Fault) -> bool:
        return self.fault in faults and not self.dead and len(self.calls) + 1 == self.at

    def _half(self, handle: int, content: Any) -> int:
        self.calls.append("write")
        self.struck = True
        written: int = self._really["write"](handle, content[: len(content) // 2])
        self._mark_unsafe(handle)
        if self.fault is Fault.DEATH_IN_WRITE:
            self._die()
        return written

    def _strike(self, name: str) -> None:
        """Count a call, before it is made, and end it here if it is to go wrong."""
        if self.dead:
            raise Death
        self.calls.append(name)
        reached = len(self.calls)
        if self.fault is None or reached < self.at or (reached > self.at and self.fault is not Fault.BROKEN_FOR_GOOD):
            return
        if self.fault in (Fault.DEATH, Fault.POWER_CUT):
            self._die()
        if self.fault in ERRORS and (self.fault is not Fault.NO_SPACE or name in NEEDS_SPACE):
            self.struck = True
            code = ERRORS[self.fault]
            raise OSError(code, os.strerror(code))

    def _die(self) -> None:
        self.struck = self.dead = True
        if self.act is not None:
            self.act()
        raise Death


def calls_of(act: Callable[..., object], *arguments: Any) -> list[str]:
    """The calls that a run makes, in their order."""
    with Disk().used() as disk:
        act(*arguments)
    return disk.calls


def leftovers(folder: Path) -> list[str]:
    """What a run should not leave: links, and hidden places."""
    return [str(place) for place in folder.rglob("*") if place.is_symlink() or place.name.startswith(".")]
