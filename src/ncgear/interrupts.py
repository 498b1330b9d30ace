"""The ends of a run: signals that wait while files are exchanged, processes that end with it, limits of time.

``ENDING`` has Ctrl-C, the signal of ``kill``, and the signal of a closed terminal, which Windows lacks.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf
from threading import Thread, current_thread, main_thread
from types import FrameType

ENDING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))

PR_SET_PDEATHSIG = 1
"""The operation of Linux's ``prctl`` that chooses the signal of the parent's death."""


@contextmanager
def uninterrupted() -> Iterator[None]:
    """A context that delays the signals of ``ENDING`` to its end, for short work that must not be interrupted."""
    if current_thread() is not main_thread():
        # Only the main thread receives signals.
        yield
        return
    heard: list[int] = []

    def remember(number: int, _: FrameType | None) -> None:
        heard.append(number)

    # A handler that was set outside Python cannot be restored.
    before = {number: handler for number in ENDING if (handler := signal.getsignal(number)) is not None}
    try:
        for number in before:
            signal.signal(number, remember)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    for number in heard[:1]:
        signal.raise_signal(number)


def quiet_of_interrupts(unraisable: sys.UnraisableHookArgs) -> None:
    """Ignore an interrupt that could not be raised, for example while an object is freed: it is repeated."""
    if not issubclass(unraisable.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


class TimeIsOver(Exception):
    """Work has used up its processor time."""


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """A context that raises TimeIsOver in its body after an amount of processor time, or at once if none is left.

    Outside the main thread, and on systems without such a clock, the body comes to its own end.
    """
    if seconds <= 0.0:
        raise TimeIsOver
    if not hasattr(signal, "ITIMER_PROF") or current_thread() is not main_thread() or seconds == inf:
        yield
        return

    def end(number: int, _: FrameType | None) -> None:
        raise TimeIsOver

    before = signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def deaf_processes() -> Iterator[None]:
    """A context in which new processes ignore a terminal's signals to all processes; their parent ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing.resource_tracker import ensure_running

    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        # The process that clears up after all others; starting it makes this process receive Ctrl-C again.
        ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_processes() -> None:
    """End the processes that this one has started, at once and without a message."""
    from multiprocessing import active_children

    for process in active_children():
        process.terminate()


def end_with_parent(its_end: Callable[[], object]) -> None:
    """Make this process end when its parent ends in any way; ``its_end`` returns at the parent's end or later.

    Linux kills this process together with the thread that started it, at any moment.  A thread that waits for
    ``its_end`` does so on other systems, and where the parent had ended before Linux was asked.
    """
    if sys.platform == "linux":
        # Loading it takes some milliseconds.
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)

    def end() -> None:
        its_end()
        os._exit(0)

    Thread(target=end, daemon=True).start()


def end_with_input() -> None:
    """Make this process end with its parent, which holds its standard input open and writes nothing there."""
    end_with_parent(lambda: os.read(0, 1))
