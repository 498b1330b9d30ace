"""The progress of long work, on a terminal; nothing where stderr is not a terminal."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress

SILENT_SECONDS = 1.0
"""Work that takes no longer shows nothing."""


@contextmanager
def counted(what: str) -> Iterator[Callable[[int, int], None]]:
    """A context with a function to call with the numbers done and in all; ``what`` is the text before the bar."""
    with _shown(what) as bar:
        yield lambda done, total: bar.update(bar.task_ids[0], completed=done, total=total)


@contextmanager
def steps_shown(count: int) -> Iterator[Callable[[str], None]]:
    """A context with a function to call with the name of each step; ``count`` is the number of steps."""
    with _shown("starting", count) as bar:
        task = bar.task_ids[0]

        def on_step(step: str) -> None:
            done = 0 if bar.tasks[0].description == "starting" else 1
            bar.update(task, description=step, advance=done)

        yield on_step


@contextmanager
def _shown(what: str, count: int | None = None) -> Iterator[Progress]:
    """A bar that a terminal shows once the work takes over a second, and which disappears at the end."""
    bar = _bar(what, count)
    timer = threading.Timer(SILENT_SECONDS, bar.start)
    timer.daemon = True
    if sys.stderr.isatty():
        timer.start()
    try:
        yield bar
    finally:
        timer.cancel()
        # A start that has begun must end before the stop, or the bar would stay.
        if timer.ident is not None:
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
