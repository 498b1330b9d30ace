"""Drawing in a second process, which loads matplotlib while this process still computes the values to be drawn.

A drawing is any function of values, named by a text, ``module:function``, so that this process need not load it.  This
process draws if the second process dies, or if a value cannot be pickled (the scene of a law made of functions).
"""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Protocol

from ncgear.interrupts import end_processes
from ncgear.workers import Pool, free_cores, one_thread_each

LIBRARY = "matplotlib"

MOTION_PICTURE = "ncgear.drawings.plots.assembled_pair:motion_drawn"
GEAR_PICTURES = "ncgear.drawings.plots.assembled_pair:gears_drawn"
LOAD_PICTURES = "ncgear.drawings.plots.assembled_pair:load_drawn"
PAGE_CHARTS = "ncgear.drawings.page.chart_svg:all_drawn"
"""The drawings: of a build's pictures, and of the report's charts."""


class Drawer(Protocol):
    """An object that draws."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """Begin a drawing; the returned function waits for it, and raises its errors."""

    def offered(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """As ``begun``, for a drawing that this process can make too; it does if the other has not begun when asked."""


class Here:
    """Draws in this process."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """The drawing is made when it is asked for."""
        return lambda: function_of(drawing)(*given)

    offered = begun


HERE = Here()


class _Beside:
    """Draws in the only process of a pool; a thread gives that process one drawing after the other."""

    def __init__(self, pool: Pool, thread: ThreadPoolExecutor) -> None:
        self._pool, self._thread = pool, thread

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        return self._asked(False, drawing, given)

    def offered(self, drawing: str, *given: Any) -> Callable[[], Any]:
        return self._asked(True, drawing, given)

    def _asked(self, offered: bool, drawing: str, given: tuple[Any, ...]) -> Callable[[], Any]:
        here = HERE.begun(drawing, *given)
        try:
            packed = pickle.dumps(given, pickle.HIGHEST_PROTOCOL)
        except (AttributeError, TypeError, pickle.PicklingError):
            return here
        asked = self._thread.submit(lambda: self._pool.submit(_drawn, drawing, packed).result())

        def wait() -> Any:
            if offered and asked.cancel():
                return here()
            try:
                return asked.result()
            except BrokenProcessPool:
                return here()

        return wait


@contextmanager
def drawing_beside(*drawings: str) -> Iterator[Drawer]:
    """A context with a second process that draws, and first loads the modules of ``drawings``; it then ends.

    Where no second core is free, or matplotlib is loaded anyway, a second process gains nothing, and this process
    draws.
    """
    if free_cores() < 2 or LIBRARY in sys.modules:
        yield HERE
        return
    with ThreadPoolExecutor(1) as thread, Pool(1) as pool:
        try:
            with one_thread_each():
                pool.submit(_loaded, drawings)
            yield _Beside(pool, thread)
        finally:
            # Nobody waits for a drawing that is still in work.
            thread.shutdown(wait=False, cancel_futures=True)
            end_processes()


def function_of(drawing: str) -> Callable[..., Any]:
    """The function of a text ``module:function``; loads the module."""
    module, _, name = drawing.partition(":")
    return getattr(import_module(module), name)


def _loaded(drawings: tuple[str, ...]) -> None:
    for drawing in drawings:
        function_of(drawing)


def _drawn(drawing: str, packed: bytes) -> Any:
    return function_of(drawing)(*pickle.loads(packed))
