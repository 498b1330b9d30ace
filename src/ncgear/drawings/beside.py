"""Pictures drawn by a second process, which loads matplotlib while this one still computes what they show.

A drawing is a function named in text, ``module:function``, so that this process need not load it.  The second process
takes one request after the other from its standard input, ignores Ctrl-C, which its parent hears, and ends with its
parent.  Where it dies or cannot begin, and where what shall be drawn cannot be pickled (the scene of a law that is made
of functions), this process draws.
"""

from __future__ import annotations

import gc
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import Any, BinaryIO, Protocol

from ncgear.interrupts import deaf_processes
from ncgear.workers import core_count, one_thread_each

LIBRARY = "matplotlib"

PAIR_PICTURES = "ncgear.drawings.plots.pair_pictures:drawn"
PAGE_CHARTS = "ncgear.drawings.page.chart_svg:all_drawn"
MOVING_FRAMES = "ncgear.drawings.animation.moving_picture:frames_of"
"""The drawings: of the pictures of a pair of gears, of the charts of the report, and of the frames of an animation."""


class Drawer(Protocol):
    """What draws."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """Begin a drawing; the function that is returned waits for it, and raises what it raised."""

    def each(self, drawing: str, *given: Any) -> Iterator[Any]:
        """What a drawing that is a generator yields, as it comes."""


class Here:
    """Draws in this process."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        """The drawing is made when it is asked for."""
        return lambda: _function(drawing)(*given)

    def each(self, drawing: str, *given: Any) -> Iterator[Any]:
        """As the generator yields."""
        yield from _function(drawing)(*given)


HERE = Here()


def _function(drawing: str) -> Callable[..., Any]:
    module, _, name = drawing.partition(":")
    function: Callable[..., Any] = getattr(import_module(module), name)
    return function


class _Beside:
    """Draws in a second process; requests wait for each other."""

    def __init__(self, process: subprocess.Popen[bytes], requests: ThreadPoolExecutor) -> None:
        self._process, self._requests = process, requests

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        asked = self._requests.submit(lambda: list(self._answers(drawing, given, whole=True)))

        def wait() -> Any:
            try:
                return asked.result()[0]
            except _Unanswered:
                return HERE.begun(drawing, *given)()

        return wait

    def each(self, drawing: str, *given: Any) -> Iterator[Any]:
        count = 0
        try:
            for answer in self._answers(drawing, given, whole=False):
                yield answer
                count += 1
        except _Unanswered:
            for number, answer in enumerate(HERE.each(drawing, *given)):
                if number >= count:
                    yield answer

    def _answers(self, drawing: str, given: tuple[Any, ...], *, whole: bool) -> Iterator[Any]:
        """What the process answers to a request; raises what the drawing raised, and _Unanswered."""
        requests, answers = self._process.stdin, self._process.stdout
        assert requests is not None
        assert answers is not None
        try:
            asked = pickle.dumps((drawing, given, whole), pickle.HIGHEST_PROTOCOL)
        except (AttributeError, TypeError, pickle.PicklingError) as error:
            raise _Unanswered from error
        try:
            requests.write(asked)
            requests.flush()
            while True:
                kind, answer = pickle.load(answers)
                if kind == "end":
                    return
                if kind == "fault":
                    raise answer
                yield answer
        except (EOFError, BrokenPipeError, pickle.UnpicklingError) as error:
            raise _Unanswered from error


class _Unanswered(Exception):
    """The second process could not be asked, or answers no more."""


@contextmanager
def drawing_beside(*drawings: str) -> Iterator[Drawer]:
    """A context with a second process that draws, and first loads what ``drawings`` need; it ends with the context.

    With a single core, or where matplotlib is loaded anyway, a second process gains nothing, and this one draws.
    """
    if core_count() == 1 or LIBRARY in sys.modules:
        yield HERE
        return
    code = f"from ncgear.drawings.beside import serve; serve({drawings!r})"
    try:
        with deaf_processes(), one_thread_each():
            process = subprocess.Popen(
                [sys.executable, "-c", f"import sys; sys.path[:] = {sys.path!r}; {code}"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
    except OSError:
        yield HERE
        return
    requests = ThreadPoolExecutor(1, "drawing")
    try:
        yield _Beside(process, requests)
    finally:
        # Whatever it still draws nobody waits for.
        process.kill()
        requests.shutdown(cancel_futures=True)
        for stream in (process.stdin, process.stdout):
            with suppress(OSError):
                stream.close()  # type: ignore[union-attr]
        process.wait()


def serve(drawings: Sequence[str]) -> None:
    """Load what drawings need, and answer requests until there are no more: the second process."""
    gc.disable()
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # What a library says must not come between the answers.
    sys.stdout = sys.stderr
    for drawing in drawings:
        _function(drawing)
    with suppress(EOFError, BrokenPipeError):
        while True:
            drawing, given, whole = pickle.load(requests)
            _answer(drawing, given, answers, whole=whole)
    os._exit(0)


def _answer(drawing: str, given: tuple[Any, ...], answers: BinaryIO, *, whole: bool) -> None:
    def say(kind: str, answer: Any = None) -> None:
        pickle.dump((kind, answer), answers, pickle.HIGHEST_PROTOCOL)
        answers.flush()

    try:
        made = _function(drawing)(*given)
        for answer in [made] if whole else made:
            say("answer", answer)
        say("end")
    except BrokenPipeError:
        raise
    except Exception as error:
        say("fault", error)
