"""The process that computes answers: a newer request stops the older one.

What is dragged shall move even if requests come faster than answers, so the first answer to a request is finished
unless it takes longer than PATIENCE_S; all answers after it are broken off at once.

Requests come as lines of JSON on the standard input, answers go as lines of JSON to the standard output.  The process
ends with its input, so it never outlives the server.  ``python -m ncgear.studio.worker motion`` follows the chain of
the motion, with ``gears`` that of the gears.
"""

from __future__ import annotations

import _thread
import json
import os
import signal
import sys
import threading
import time
from pathlib import Path
from types import FrameType
from typing import Any, BinaryIO

from ncgear.interrupts import end_with_parent

MOTION, GEARS = "motion", "gears"
CHAINS = (MOTION, GEARS)

IMPORTING = "<frozen importlib._bootstrap>"
"""File name of Python's own code of imports: an import that is broken off could never be made again."""


PATIENCE_S = 1.0
"""Time that the first answer to a request may take while a newer one waits; the teeth of most gears take a third."""


class Superseded(BaseException):
    """A newer request has come; no ``except Exception`` on the way may take it for a fault."""


class _Requests:
    """The newest request; a thread reads them, so that the main thread can be interrupted while it computes."""

    def __init__(self, lines: BinaryIO) -> None:
        self._lines = lines
        self._come = threading.Condition()
        self._newest: dict[str, Any] | None = None
        self._begun_s = 0.0
        self._answered = False
        self.computing = False

    def read_all(self) -> None:
        """Take requests to the end of the input."""
        for line in self._lines:
            request = json.loads(line)
            with self._come:
                self._newest = request
                self._come.notify()
                patience = 0.0 if self._answered else self._begun_s + PATIENCE_S - time.monotonic()
            if self.computing:
                timer = threading.Timer(max(patience, 0.0), _thread.interrupt_main)
                timer.daemon = True
                timer.start()

    def next(self) -> dict[str, Any]:
        """Wait for a request, and take it."""
        with self._come:
            while self._newest is None:
                self._come.wait()
            request, self._newest = self._newest, None
            self._begun_s, self._answered = time.monotonic(), False
            return request

    def answered(self) -> None:
        """Remember that the request has its first answer."""
        self._answered = True

    @property
    def superseded(self) -> bool:
        """Whether a newer request waits."""
        return self._newest is not None

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Raise Superseded in the main thread while it computes for an older request, unless it imports a module."""
        patient = not self._answered and time.monotonic() < self._begun_s + PATIENCE_S
        if not (self.computing and self.superseded) or patient:
            return
        while frame is not None:
            if frame.f_code.co_filename == IMPORTING:
                return
            frame = frame.f_back
        raise Superseded


def main() -> None:
    """Compute until the input ends."""
    chain = sys.argv[1]
    out = os.fdopen(os.dup(1), "wb")
    # Whatever a library prints must not come between the answers.
    os.dup2(2, 1)
    if chain == GEARS and hasattr(os, "nice"):
        # The motion follows the hand; teeth may come a little later.
        os.nice(5)
    requests = _Requests(sys.stdin.buffer)
    signal.signal(signal.SIGINT, requests.interrupt)
    end_with_parent(requests.read_all)

    from ncgear.studio.answers import gear_answers, motion_answers

    answers = motion_answers if chain == MOTION else gear_answers
    while True:
        request = requests.next()
        found = answers(request["text"], Path(request["path"]))
        while True:
            try:
                requests.computing = True
                answer = next(found, None)
                requests.computing = False
            except Superseded:
                requests.computing = False
                break
            except Exception as error:
                requests.computing = False
                answer = "refused", {"problem": f"internal fault: {type(error).__name__}: {error}; please report"}
                found = iter(())
            name, content = answer or ("done", None)
            _send(out, {"is": name, "n": request["n"], "from": chain, "content": content})
            requests.answered()
            if answer is None or requests.superseded:
                break


def _send(out: BinaryIO, message: dict[str, Any]) -> None:
    text = json.dumps(message, separators=(",", ":"), allow_nan=False)
    try:
        out.write(text.encode() + b"\n")
        out.flush()
    except BrokenPipeError:
        os._exit(0)


if __name__ == "__main__":
    main()
