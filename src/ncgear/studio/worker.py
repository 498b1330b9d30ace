"""A process that computes answers, each for the newest change that was there when the answer was begun.

A dragged value must move even if changes come faster than answers.  So an answer is finished up to its picture, the
part named in PICTURES, even if a newer change has come; the parts after the picture are then broken off at once.
Pictures that take longer than PATIENCE_S are broken off too, and so are pictures when the hand rests at a newer place,
but never two in a row: then the hand would see none.

Requests come as lines of JSON on the standard input, answers go as lines of JSON to the standard output.  A request has
the number ``n``, the ``path`` of the design, ``changes`` by key, and the ``text`` unless the request before had the
same text.  The process ends with its input, so it never outlives the server.  ``python -m ncgear.studio.worker motion``
follows the chain of the motion, with ``gears`` or ``contact`` one of the gears, with ``gears contact`` both, one after
the other.
"""

from __future__ import annotations

import _thread
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from functools import cache, partial
from math import inf
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, BinaryIO

from ncgear.interrupts import end_with_parent, quiet_of_interrupts

if TYPE_CHECKING:
    from ncgear.studio.messages import Answer, Answers

MOTION, GEARS, CONTACT = "motion", "gears", "contact"

PICTURES: Mapping[str, str] = {MOTION: "motion", GEARS: "scene", CONTACT: "strength"}
"""The part of each chain that completes its picture."""

CHAINS = tuple(PICTURES)

IMPORTING = "<frozen importlib._bootstrap>"
"""File name of Python's own code of imports: an import that is broken off cannot be repeated."""

PATIENCE_S = 5.0
"""Time that a picture may take while a newer change waits: several times the time of teeth and their strength."""

RESTING_S = 0.1
"""Time without a newer request after which the hand counts as resting: during a drag, moves come at half this time."""

DONE = "done", None
"""The last message about a request."""


NICENESS = 5
"""Lower priority of the gears: the motion follows the hand, teeth may come a little later."""


AGAIN_S = 0.05
"""Time after which a computation that has not stopped is broken off again: some libraries swallow the signal."""


class Superseded(KeyboardInterrupt):
    """A newer request has come; the optimiser turns this into a plain KeyboardInterrupt."""


class Requests:
    """The newest request; a thread reads them, so that the main thread can be interrupted while it computes."""

    def __init__(self, lines: BinaryIO) -> None:
        self._lines = lines
        self._come = threading.Condition()
        self._newest: dict[str, Any] | None = None
        self._text = ""
        self._patient_until_s = self._came_s = 0.0
        self._alarm: threading.Timer | None = None
        self._broken_off = False
        self.computing = False

    def read_all(self) -> None:
        """Read requests until the input ends."""
        for line in self._lines:
            request = json.loads(line)
            with self._come:
                self._text = request.setdefault("text", self._text)
                self._newest = request
                self._come.notify()
                self._came_s = time.monotonic()
                if self._alarm is not None:
                    self._alarm.cancel()
                if self._patient_until_s < inf:
                    self._wake(max(self._due_s - self._came_s, 0.0))

    @property
    def _due_s(self) -> float:
        """Time from which the newest request no longer waits for the answer that is being computed."""
        return min(self._patient_until_s, self._came_s + RESTING_S) if self._patient_until_s < inf else inf

    def _wake(self, wait_s: float) -> None:
        """Interrupt the main thread after a time."""
        self._alarm = threading.Timer(wait_s, _thread.interrupt_main)
        self._alarm.daemon = True
        self._alarm.start()

    def next(self) -> dict[str, Any]:
        """Wait for a request, and take it."""
        with self._come:
            while self._newest is None:
                self._come.wait()
            request, self._newest = self._newest, None
            self._be_patient(inf if self._broken_off else time.monotonic() + PATIENCE_S)
            self._broken_off = False
            return request

    def shown(self) -> None:
        """Remember that the request has all its pictures."""
        with self._come:
            self._be_patient(0.0)

    def _be_patient(self, until_s: float) -> None:
        self._patient_until_s = until_s
        if self._alarm is not None:
            self._alarm.cancel()
            self._alarm = None

    @property
    def newer(self) -> bool:
        """Whether a newer request waits."""
        return self._newest is not None

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Raise Superseded in the main thread while it computes for an older request, unless it imports a module.

        It is repeated until the main thread takes the newer request: in a callback of a weak reference, or in the
        optimiser, it may be lost.
        """
        self._alarm = None
        if self._newest is None or time.monotonic() < self._due_s:
            return
        self._wake(AGAIN_S)
        if not self.computing:
            return
        while frame is not None:
            if frame.f_code.co_filename == IMPORTING:
                return
            frame = frame.f_back
        self._broken_off = self._patient_until_s > 0.0
        raise Superseded


def main() -> None:
    """Compute until the input ends."""
    chains = tuple(sys.argv[1:])
    out = os.fdopen(os.dup(1), "wb")
    # Output of libraries must not come between the answers.
    os.dup2(2, 1)
    if MOTION not in chains and hasattr(os, "nice"):
        os.nice(NICENESS)
    requests = Requests(sys.stdin.buffer)
    signal.signal(signal.SIGINT, requests.interrupt)
    sys.unraisablehook = quiet_of_interrupts
    end_with_parent(requests.read_all)

    from ncgear.memory import begin_worker
    from ncgear.studio.editing import ChangingText
    from ncgear.studio.messages import guarded

    begin_worker()
    answers, followed = [(chain, answers_of(chain)) for chain in chains], ChangingText()
    while True:
        request = requests.next()
        made = cache(partial(followed.made, request["text"], request["changes"], Path(request["path"])))
        for chain, of_chain in answers:
            try:
                _answer(requests, out, (chain, request["n"], chain == chains[-1]), guarded(of_chain, made))
            except KeyboardInterrupt:
                break


def _answer(requests: Requests, out: BinaryIO, asked: tuple[str, int, bool], found: Iterator[Answer]) -> None:
    """Send the answers of a chain to the request with a number; ``asked`` says whether it is the last chain."""
    from ncgear.studio.messages import refusal

    chain, number, is_last = asked
    name, pictured = "", False
    while name != DONE[0] and not (pictured and requests.newer):
        requests.computing = True
        try:
            name, content = next(found, DONE)
            line = _line(name, number, chain, content)
        except ValueError as error:
            # A number that is not finite is not valid JSON.
            name, found = "refused", iter(())
            line = _line(name, number, chain, refusal(error))
        finally:
            requests.computing = False
        _send(out, line)
        if name == PICTURES[chain]:
            pictured = True
            if is_last:
                requests.shown()


def answers_of(chain: str) -> Answers:
    """The answers of a chain; none of them imports modules that only another chain needs."""
    if chain == MOTION:
        from ncgear.studio.motion_answers import motion_answers

        return motion_answers
    from ncgear.studio.gear_answers import contact_answers, gear_answers

    return gear_answers if chain == GEARS else contact_answers


def _line(name: str, number: int, chain: str, content: Any) -> bytes:
    message = {"is": name, "n": number, "from": chain, "content": content}
    return json.dumps(message, separators=(",", ":"), allow_nan=False).encode() + b"\n"


def _send(out: BinaryIO, line: bytes) -> None:
    try:
        out.write(line)
        out.flush()
    except BrokenPipeError:
        os._exit(0)


if __name__ == "__main__":
    main()
