"""The processes of a page that compute answers, seen from the server: started, asked, watched, ended."""

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
from ncgear.studio.faults import refusal
from ncgear.studio.worker import CHAINS
from ncgear.workers import ONE_THREAD

LONGEST_S = 60.0
"""Time for all answers of one text, after which the process is replaced: an ordinary design takes a second or two."""

LONGEST_ANSWER = 64 << 20
"""Bytes of one answer: outlines of gears with thousands of teeth have some megabytes."""

Told = Callable[[str], Awaitable[None]]


@dataclass
class Chain:
    """One process that computes answers; ``told`` gets each answer as a line of JSON."""

    name: str
    told: Told
    _process: asyncio.subprocess.Process | None = None
    _listening: asyncio.Task[None] | None = None
    _watching: asyncio.Task[None] | None = None
    _asked: int | None = None
    _text: str | None = None

    async def ask(self, number: int, text: str, changes: Mapping[str, Any], path: str) -> None:
        """Ask for the answers of a text with changes; it is sent once, and its changes as often as they come."""
        if self._process is None or self._process.returncode is not None:
            await self.start()
        request = {"n": number, "changes": changes, "path": path} | ({} if text is self._text else {"text": text})
        self._asked, self._text = number, text
        await self._send(json.dumps(request).encode() + b"\n")
        if self._watching is not None:
            self._watching.cancel()
        self._watching = asyncio.create_task(self._watch(number))

    async def start(self) -> None:
        """Start the process, which makes itself ready before it is asked."""
        environment = {**ONE_THREAD, **os.environ}
        self._text = None
        self._process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "ncgear.studio.worker",
            self.name,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            env=environment,
            limit=LONGEST_ANSWER,
            # Ctrl-C in the terminal is for the server, which closes the input of this process: a group of its own keeps
            # it away.  A session of its own would too, but Linux shares the processor evenly between sessions.
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
                if self._asked is not None and line.startswith(b'{"is":"done"') and self._is_newest(line):
                    self._asked = None
                await self.told(line.decode().rstrip())
        if process is self._process and self._asked is not None:
            # It has ended by itself, as when memory is short.
            number, self._asked = self._asked, None
            self.kill()
            await self.told(self._broken(number, "the computation ended without an answer"))

    def _is_newest(self, line: bytes) -> bool:
        return self._asked is not None and json.loads(line)["n"] == self._asked

    async def _watch(self, number: int) -> None:
        await asyncio.sleep(LONGEST_S)
        if self._asked == number:
            self._asked = None
            self.kill()
            await self.told(self._broken(number, f"stopped after {LONGEST_S:g} s without an answer"))

    def _broken(self, number: int, problem: str) -> str:
        content = refusal(DesignError(problem))
        return json.dumps({"is": "refused", "n": number, "from": self.name, "content": content})

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
    """All processes of a page."""

    told: Told | None = None
    chains: list[Chain] = field(default_factory=list)

    async def start(self) -> None:
        """Start the first before there is a question: the motion is what is seen first."""
        self.chains = [Chain(name, self._tell) for name in CHAINS]
        for first in self.chains[:1]:
            await first.start()

    async def _tell(self, line: str) -> None:
        if self.told is not None:
            await self.told(line)

    async def ask(self, number: int, text: str, changes: Mapping[str, Any], path: str) -> None:
        """Ask all for the answers of a text with changes."""
        if not self.chains:
            await self.start()
        await asyncio.gather(*(chain.ask(number, text, changes, path) for chain in self.chains))

    async def close(self) -> None:
        """End all."""
        await asyncio.gather(*(chain.close() for chain in self.chains))
        self.chains = []
