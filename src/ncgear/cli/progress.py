"""How far long work has come, on a terminal; nothing where stderr is none."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SILENT_SECONDS = 1.0


@contextmanager
def points_counted(kind: str = "points") -> Iterator[Callable[[int, int], None]]:
    """A function to say how many of how many points, or whatever ``kind`` names, are done; a terminal shows a bar."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = TextColumn(kind), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), transient=True) as bar:
        task = bar.add_task(kind, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def stages_shown() -> Iterator[Callable[[str], None]]:
    """A function to name the stage at work with; a terminal shows it once the work takes over a second."""
    if not sys.stderr.isatty():
        yield lambda stage: None
        return
    from rich.console import Console
    from rich.markup import escape

    status = Console(stderr=True).status("starting")
    timer = threading.Timer(SILENT_SECONDS, status.start)
    timer.daemon = True
    timer.start()
    try:
        yield lambda stage: status.update(escape(stage))
    finally:
        timer.cancel()
        # A start already under way must end before the stop, or the spinner would stay.
        timer.join()
        status.stop()
