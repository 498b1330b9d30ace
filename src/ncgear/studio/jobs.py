"""Commands that the studio runs beside the page: they write files, show their progress, and can be cancelled.

Each is a command as a person would type it.  It runs on a copy of the edited text in the export folder, so it writes
the same files as the command line, whether the design file has been saved or not.
"""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import time
from typing import Any

from ncgear.design.reading.design_file import LoadedDesign, as_it_is
from ncgear.design.rewritten import design_copy
from ncgear.errors import WrongInput
from ncgear.files.one_file import put_in_place


@dataclass(frozen=True)
class Command:
    """A command of ncgear as the page offers it; ``out`` is added to the design's name to get its folder."""

    words: str
    arguments: tuple[str, ...]
    out: str = ""
    file: str = ""
    takes_trains: bool = False


COMMANDS: Mapping[str, Command] = {
    "build": Command("Build all files", ("build",), takes_trains=True),
    "report": Command("Report as one page", ("report",), takes_trains=True),
    "animate": Command("Animation", ("animate",), file="mechanism.gif", takes_trains=True),
    "simulate": Command("Forces of the masses", ("simulate",), out="-rigid", takes_trains=True),
    "optimize": Command("Best law", ("optimize",), out="-optimized"),
    "design": Command("Find the machine", ("design",), out="-machines"),
    "frontier": Command("Power against acceleration", ("frontier", "--points=8"), out="-frontier"),
}
"""The commands that a page can ask for; nothing else is ever run."""

RUN = "from ncgear.interrupts import end_with_input; end_with_input(); from ncgear.cli import main; main()"
"""The program ``ncgear``; it ends when the server ends."""

LONGEST_S = 3600.0
"""Time after which a command is cancelled."""

GRACE_S = 5.0
"""Time for a command to end after Ctrl-C before it is killed; its folder is complete in both cases."""

LAST_LINES = 60
"""Lines of a command's output that the page keeps."""


@dataclass
class Job:
    """A running or finished command; ``told`` is called at every change; ``begun_s`` is its start in system time."""

    number: int
    name: str
    text: str
    design: str
    folder: Path
    told: Callable[[Job], None]
    lines: list[str] = field(default_factory=list)
    progress: str = ""
    status: int | None = None
    cancelled: bool = False
    begun_s: float = field(default_factory=time)
    _process: asyncio.subprocess.Process | None = None

    @property
    def as_plain(self) -> dict[str, Any]:
        """The job for the page; ``alike`` are the commands that write into the same folder."""
        return {
            "job": self.number,
            "name": self.name,
            "words": COMMANDS[self.name].words,
            "alike": [name for name, command in COMMANDS.items() if command.out == COMMANDS[self.name].out],
            "progress": self.progress,
            "lines": self.lines[-LAST_LINES:],
            "running": self.status is None,
            "done": self.status == 0,
            "cancelled": self.cancelled,
        }

    async def run(self, out: Path, path: Path) -> None:
        """Run the command on the text to its end; its output is told as it comes."""
        command = COMMANDS[self.name]
        copy = await asyncio.to_thread(_copied, self.text, path, out / f"{self.design}-studio")
        target = self.folder / command.file if command.file else self.folder
        line = [sys.executable, "-c", RUN, *command.arguments[:1], str(copy), *command.arguments[1:]]
        self._process = await asyncio.create_subprocess_exec(
            *line,
            f"--out={target}",
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=os.name == "posix",
        )
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        if self.cancelled:
            # It was cancelled before there was a process.
            self._kill()
        try:
            async with asyncio.timeout(LONGEST_S):
                await asyncio.gather(self._heard(self._process.stdout, False), self._heard(self._process.stderr, True))
                status = await self._process.wait()
        except TimeoutError:
            self.lines.append(f"cancelled after {LONGEST_S:g} s")
            status = await self._stopped()
        except BaseException:
            self._kill()
            raise
        self.status = status
        self.told(self)

    async def _heard(self, stream: asyncio.StreamReader, is_error: bool) -> None:
        while line := await stream.readline():
            text = line.decode(errors="replace").rstrip()
            if is_error and text:
                self.progress = text
            self.lines.append(text)
            del self.lines[:-LAST_LINES]
            self.told(self)

    async def cancel(self) -> None:
        """End the command with Ctrl-C, and if that does not help, kill it."""
        self.cancelled = True
        await self._stopped()

    async def _stopped(self) -> int:
        if self._process is None or self._process.returncode is not None:
            return self.status or 0
        self._signal(signal.SIGINT if os.name == "posix" else signal.SIGTERM)
        try:
            async with asyncio.timeout(GRACE_S):
                return await self._process.wait()
        except TimeoutError:
            self._kill()
            return await self._process.wait()

    def _kill(self) -> None:
        if self._process is not None and self._process.returncode is None:
            self._signal(signal.SIGKILL if os.name == "posix" else signal.SIGTERM)

    def _signal(self, number: signal.Signals) -> None:
        """Send a signal to the command and to the processes that it has started."""
        assert self._process is not None
        try:
            if os.name == "posix":
                os.killpg(self._process.pid, number)
            else:
                self._process.send_signal(number)
        except ProcessLookupError:
            pass


def _copied(text: str, path: Path, folder: Path) -> Path:
    """A copy of the edited text that needs no other file, in a folder of its own; raises as reading the text does."""
    loaded = as_it_is(text, path)
    copy = design_copy(loaded, {}) if isinstance(loaded, LoadedDesign) and loaded.source.from_files else text
    place = folder / f"{loaded.source.data['name']}.yaml"
    put_in_place(place, copy.encode())
    return place


def require_command(name: Any) -> Command:
    """The command with a name; raises WrongInput for any other name."""
    if not isinstance(name, str) or name not in COMMANDS:
        raise WrongInput(f"{name!r} given; {', '.join(COMMANDS)} are right", key="command")
    return COMMANDS[name]
