"""Drawing by a second process, which loads matplotlib and more while this one still computes what is to be drawn.

A drawing is any function of values, named in text, ``module:function``, so that this process need not load it.  Where
the second process dies, and where what shall be drawn cannot be pickled (the scene of a law that is made of functions),
this process draws.
"""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.synchronize import Semaphore
from typing import Any, Protocol

from ncgear.interrupts import deaf_processes, end_processes
from ncgear.memory import begin_worker
from ncgear.workers import core_count, one_thread_each

OFFERS = 16
"""Most offers of a command: those of two stages are 10.  Further ones are drawn by the second process."""

LIBRARY = "matplotlib"

MOTION_PICTURE = "ncgear.drawings.plots.pair_pictures:motion_drawn"
GEAR_PICTURES = "ncgear.drawings.plots.pair_pictures:gears_drawn"
LOAD_PICTURES = "ncgear.drawings.plots.pair_pictures:load_drawn"
PAGE_CHARTS = "ncgear.drawings.page.chart_svg:all_drawn"
FIRST_FRAMES = "ncgear.drawings.animation.images:first_block_drawn"
FRAMES = "ncgear.drawings.animation.images:block_drawn"
"""The drawings: of a build's pictures, of the report's charts, and of the colours and frames of a moving picture."""


class Drawer(Protocol):
    """What draws."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """Begin a drawing; the function that is returned waits for it, and raises what it raised."""

    def offered(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """As ``begun``, of what this process can draw as well: it does where the drawing waits when it is asked for."""


class Here:
    """Draws in this process."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """The drawing is made when it is asked for."""
        return lambda: function_of(drawing)(*given)

    offered = begun


HERE = Here()


class _Beside:
    """Draws in the one process of a pool; requests wait for each other.

    Both processes have the same ``tokens``, one for each offer: who takes it first draws.
    """

    def __init__(self, pool: ProcessPoolExecutor, tokens: Sequence[Semaphore]) -> None:
        self._pool, self._tokens = pool, tokens
        self._numbers = iter(range(len(tokens)))

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        return self._asked(None, drawing, given)

    def offered(self, drawing: str, *given: Any) -> Callable[[], Any]:
        return self._asked(next(self._numbers, None), drawing, given)

    def _asked(self, number: int | None, drawing: str, given: tuple[Any, ...]) -> Callable[[], Any]:
        here = HERE.begun(drawing, *given)
        try:
            packed = pickle.dumps(given, pickle.HIGHEST_PROTOCOL)
            asked = self._pool.submit(_drawn, number, drawing, packed)
        except (AttributeError, TypeError, pickle.PicklingError, BrokenProcessPool):
            return here

        @cache
        def is_taken_back() -> bool:
            return number is not None and self._tokens[number].acquire(block=False)

        def wait() -> Any:
            if is_taken_back():
                return here()
            try:
                return asked.result()
            except BrokenProcessPool:
                return here()

        return wait


@contextmanager
def drawing_beside(*drawings: str) -> Iterator[Drawer]:
    """A context with a second process that draws, and first loads what ``drawings`` need; it ends with the context.

    With a single core, or where matplotlib is loaded anyway, a second process gains nothing, and this one draws.
    """
    if core_count() == 1 or LIBRARY in sys.modules:
        yield HERE
        return
    context = get_context("spawn")
    tokens = [context.Semaphore() for _ in range(OFFERS)]
    pool = ProcessPoolExecutor(1, context, _begin, (tokens,))
    try:
        with deaf_processes(), one_thread_each():
            pool.submit(_loaded, drawings)
        yield _Beside(pool, tokens)
    finally:
        # Whatever it still draws nobody waits for.  The pool's own thread is waited for: at the interpreter's end it
        # would close what the end writes to.
        end_processes()
        pool.shutdown(cancel_futures=True)


def function_of(drawing: str) -> Callable[..., Any]:
    """The function of a text ``module:function``; loads the module."""
    module, _, name = drawing.partition(":")
    function: Callable[..., Any] = getattr(import_module(module), name)
    return function


def _loaded(drawings: tuple[str, ...]) -> None:
    for drawing in drawings:
        function_of(drawing)


_tokens: Sequence[Semaphore] = ()
"""Those of the second process."""


def _begin(tokens: Sequence[Semaphore]) -> None:
    global _tokens
    _tokens = tokens
    begin_worker()


def _drawn(number: int | None, drawing: str, packed: bytes) -> Any:
    """What is drawn; None where the first process has taken back its offer of this number."""
    if number is not None and not _tokens[number].acquire(block=False):
        return None
    return function_of(drawing)(*pickle.loads(packed))
