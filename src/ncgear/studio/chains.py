"""The processes of a page that compute answers; the server starts them, asks them, watches them and ends them."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from ncgear.errors import DesignError
from ncgear.studio.messages import refusal
from ncgear.studio.worker import CONTACT, GEARS, MOTION
from ncgear.workers import ONE_THREAD, core_count

LONGEST_S = 60.0
"""Time for all answers of one text, after which the process is replaced: an ordinary design takes a second or two."""

LONGEST_ANSWER = 64 << 20
"""Largest size of one answer in bytes: outlines of gears with thousands of teeth have some megabytes."""


def chains_by_process() -> tuple[tuple[str, ...], ...]:
    """The chains that each process follows.

    On two cores a third process would share the processor with the others, and make the gears a second time.
    """
    return ((MOTION,), (GEARS,), (CONTACT,)) if core_count() > 2 else ((MOTION,), (GEARS, CONTACT))


Told = Callable[[str], Awaitable[None]]


@dataclass
class AnswerProcess:
    """A process that computes the answers of some chains; ``told`` is called with each answer, a line of JSON."""

    chains: tuple[str, ...]
    told: Told
    _process: asyncio.subprocess.Process | None = None
    _listening: asyncio.Task[None] | None = None
    _watching: asyncio.Task[None] | None = None
    _asked: int | None = None
    _open: tuple[str, ...] = ()
    _text: str | None = None

    async def ask(self, number: int, text: str, changes: Mapping[str, Any], path: str) -> None:
        """Ask for the answers of a text with changes; a text is sent once, its changes with every question."""
        if self._process is None or self._process.returncode is not None:
            await self.start()
        request = {"n": number, "changes": changes, "path": path} | ({} if text is self._text else {"text": text})
        self._asked, self._open, self._text = number, self.chains, text
        if self._watching is not None:
            self._watching.cancel()
        # It watches the sending too: a process that does not read is replaced like one that does not answer.
        self._watching = asyncio.create_task(self._watch())
        await self._send(json.dumps(request).encode() + b"\n")

    async def start(self) -> None:
        """Start the process, which loads its modules before it is asked."""
        environment = {**ONE_THREAD, **os.environ}
        self._text = None
        self._process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "ncgear.studio.worker",
            *self.chains,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            env=environment,
            limit=LONGEST_ANSWER,
            # Ctrl-C in the terminal is for the server, which closes the input of this process; a process group keeps it
            # away from here.  A session would do so too, but Linux shares the processor evenly between sessions.
            process_group=0 if os.name == "posix" else None,
        )
        self._listening = asyncio.create_task(self._listen(self._process))

    async def _send(self, request: bytes) -> None:
        assert self._process is not None
        assert self._process.stdin is not None
        with suppress(ConnectionError):
            self._process.stdin.write(request)
            await self._process.stdin.drain()

    async def _listen(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None
        with suppress(asyncio.LimitOverrunError, ValueError):
            while line := await process.stdout.readline():
                if line.startswith(b'{"is":"done"') and (done := json.loads(line))["n"] == self._asked:
                    self._open = tuple(chain for chain in self._open if chain != done["from"])
                await self.told(line.decode().rstrip())
        if process is self._process:
            # It has ended by itself, for example because memory is short.
            await self._give_up("the computation ended without an answer")

    async def _watch(self) -> None:
        await asyncio.sleep(LONGEST_S)
        await self._give_up(f"stopped after {LONGEST_S:g} s without an answer")

    async def _give_up(self, problem: str) -> None:
        """End the process where it owes answers, and tell each chain whose answers are not complete."""
        missing, self._open = self._open, ()
        if missing:
            self.kill()
        for chain in missing:
            message = {"is": "refused", "n": self._asked, "from": chain, "content": refusal(DesignError(problem))}
            await self.told(json.dumps(message))

    def kill(self) -> None:
        """End the process now; the next question starts another."""
        process, self._process = self._process, None
        if process is not None and process.returncode is None:
            with suppress(ProcessLookupError):
                process.kill()

    async def close(self) -> None:
        """End the process and wait until it is gone."""
        process = self._process
        self.kill()
        for task in (self._watching, self._listening):
            if task is not None:
                task.cancel()
        if process is not None:
            await process.wait()


@dataclass
class Chains:
    """All chains of a page."""

    told: Told | None = None
    processes: list[AnswerProcess] = field(default_factory=list)

    async def start(self) -> None:
        """Start the first process before there is a question: the motion is seen first."""
        self.processes = [AnswerProcess(chains, self._tell) for chains in chains_by_process()]
        for first in self.processes[:1]:
            await first.start()

    async def _tell(self, line: str) -> None:
        if self.told is not None:
            await self.told(line)

    async def ask(self, number: int, text: str, changes: Mapping[str, Any], path: str) -> None:
        """Ask all processes for the answers of a text with changes."""
        if not self.processes:
            await self.start()
        await asyncio.gather(*(process.ask(number, text, changes, path) for process in self.processes))

    async def close(self) -> None:
        """End all processes."""
        await asyncio.gather(*(process.close() for process in self.processes))
        self.processes = []
