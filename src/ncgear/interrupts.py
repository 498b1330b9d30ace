"""Ctrl-C while files are exchanged, and while other processes compute; work that ends when its time is over."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from threading import current_thread, main_thread
from types import FrameType


@contextmanager
def uninterrupted() -> Iterator[None]:
    """A context that delays Ctrl-C to its end, for short work that must not be left half done."""
    if current_thread() is not main_thread():
        # Only the main thread hears signals.
        yield
        return
    heard: list[int] = []

    def remember(number: int, _: FrameType | None) -> None:
        heard.append(number)

    before = signal.signal(signal.SIGINT, remember)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if heard:
        signal.raise_signal(signal.SIGINT)


class TimeIsOver(Exception):
    """Work has taken the processor time that it was given."""


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """A context that raises TimeIsOver in its body after so much processor time, or at once where none is left.

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
    """A context in which new processes ignore Ctrl-C, which a terminal sends to all; their parent ends them instead."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_processes() -> None:
    """End the processes that this one has started, at once and without a message."""
    from multiprocessing import active_children

    for process in active_children():
        process.terminate()
