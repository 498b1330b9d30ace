"""Time spent in the named steps of a computation; a step does not count the time of steps inside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


class Stopwatch:
    """Adds up seconds by step; while an inner step runs, the time of the outer step does not count.

    ``within`` is called with the progress of a long step; a display of progress puts its own function there.
    """

    def __init__(self) -> None:
        self.within: Callable[[str], None] = lambda _said: None
        self.seconds: dict[str, float] = {}
        self._inner: list[float] = []

    @contextmanager
    def __call__(self, step: str) -> Iterator[None]:
        """Time the body as ``step``."""
        start = perf_counter()
        self._inner.append(0.0)
        try:
            yield
        finally:
            whole = perf_counter() - start
            self.seconds[step] = self.seconds.get(step, 0.0) + whole - self._inner.pop()
            if self._inner:
                self._inner[-1] += whole


def left_words(seconds: float, share: float) -> str:
    """How long a step takes that has done a share of its work in so many seconds; empty for less than a minute."""
    left_min = seconds * (1.0 / share - 1.0) / 60.0 if share > 0.0 else 0.0
    return f", about {left_min:.0f} min left" if left_min >= 1.0 else ""
