"""The progress of long work: a bar where stderr is a terminal, and a line now and then where it is not."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, Protocol

from ncgear.interrupts import uninterrupted

if TYPE_CHECKING:
    from pathlib import Path

    from rich.progress import Progress

SILENT_SECONDS = 1.0
"""Longest work that shows no bar."""

LINE_SECONDS = 5.0
"""Time from the beginning to the first line, and least time between two lines."""

TELLER = "progress"
"""The name of the thread that prints the progress."""

LATER = 0.25
"""Least pause before the next line, as a share of the time so far, so that the log of an hour stays short."""


class ProgressDisplay(Protocol):
    """A display of progress."""

    def update(self, what: str, done: int, total: int | None) -> None:
        """Show the current work, how many parts of it are done, and of how many, if that is known."""


@contextmanager
def counted(what: str, folder: Path | None = None) -> Iterator[Callable[[int, int], None]]:
    """A context with a function to call with the numbers done and in all; ``what`` is the text before the bar.

    Where the work is interrupted whose results ``folder`` keeps, a line on stderr tells how it goes on.
    """
    now = 0, 0

    def count(done: int, total: int) -> None:
        nonlocal now
        now = done, total
        shown.update(what, done, total)

    try:
        with _shown(what) as shown:
            yield count
    except KeyboardInterrupt:
        if folder is not None and now[0]:
            told = f"{now[0]} of {now[1]} {what} are kept in {folder}: the same command goes on from there"
            with uninterrupted(), suppress(OSError, ValueError):
                print(told, file=sys.stderr, flush=True)
        raise


class Steps:
    """Steps that follow each other: called with the name of each step as it begins."""

    def __init__(self, shown: ProgressDisplay, count: int) -> None:
        self._shown, self._count, self._begun, self._step = shown, count, -1, ""

    def __call__(self, step: str) -> None:
        """Begin a step."""
        self._begun, self._step = self._begun + 1, step
        self._shown.update(step, self._begun, self._count)

    def within(self, said: str) -> None:
        """Tell how far the step has come."""
        self._shown.update(f"{self._step}, {said}", self._begun, self._count)


@contextmanager
def steps_shown(count: int) -> Iterator[Steps]:
    """A context with a function to call with the name of each step; ``count`` is the number of steps."""
    with _shown("starting", count) as shown:
        yield Steps(shown, count)


@contextmanager
def _shown(what: str, count: int | None = None) -> Iterator[ProgressDisplay]:
    with _bar_shown(what, count) if sys.stderr.isatty() else _lines_shown(what, count) as shown:
        yield shown


class Lines:
    """Progress in lines of plain text; ``line`` makes the next line."""

    def __init__(self, what: str, total: int | None = None, clock: Callable[[], float] = monotonic) -> None:
        self.now = what, 0, total
        self.clock, self.began = clock, clock()

    def update(self, what: str, done: int, total: int | None) -> None:
        """Remember the current work for the next line."""
        self.now = what, done, total

    @property
    def seconds(self) -> float:
        """The time since the beginning."""
        return self.clock() - self.began

    @property
    def pause_s(self) -> float:
        """The time until the next line."""
        return max(LINE_SECONDS, LATER * self.seconds)

    @property
    def line(self) -> str:
        """``12 s: teeth (3 of 9 done)``; a single step has no count."""
        what, done, total = self.now
        count = f" ({done} of {total} done)" if total is not None and total > 1 else ""
        return f"{self.seconds:.0f} s: {what}{count}"


@contextmanager
def _lines_shown(what: str, count: int | None) -> Iterator[ProgressDisplay]:
    """Lines on stderr while the work takes long, from a thread of their own, since a single step may take long."""
    lines, ended = Lines(what, count), threading.Event()

    def say() -> None:
        while not ended.wait(lines.pause_s):
            try:
                print(lines.line, file=sys.stderr, flush=True)
            except (OSError, ValueError):
                # The reader has left, or the stream is full or closed: the work continues.
                return

    teller = threading.Thread(target=say, name=TELLER, daemon=True)
    teller.start()
    try:
        yield lines
    finally:
        ended.set()
        teller.join()


class Bar:
    """Progress in a bar on a terminal."""

    def __init__(self, bar: Progress) -> None:
        self.bar = bar

    def update(self, what: str, done: int, total: int | None) -> None:
        """Move the bar."""
        self.bar.update(self.bar.task_ids[0], description=what, completed=done, total=total)


@contextmanager
def _bar_shown(what: str, count: int | None) -> Iterator[ProgressDisplay]:
    """A bar that appears once the work takes over a second, and disappears at the end."""
    bar = _bar(what, count)
    timer = threading.Timer(SILENT_SECONDS, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield Bar(bar)
    finally:
        timer.cancel()
        # A start that has begun must end before the stop, or the bar would stay.
        timer.join()
        if bar.live.is_started:
            bar.stop()


def _bar(what: str, count: int | None) -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    name = TextColumn("{task.description}", markup=False)
    columns = SpinnerColumn(), name, BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    shown = columns if count != 1 else (SpinnerColumn(), name, TimeElapsedColumn())
    bar = Progress(*shown, console=Console(stderr=True), transient=True)
    bar.add_task(what, total=count)
    return bar
