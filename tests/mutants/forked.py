"""Work in processes that are forked off this one: each begins with all tests collected."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import tempfile
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

Key = TypeVar("Key")

POLL_S = 0.01

WAITING = 10.0
"""Share of its processor time after which work that only waits is ended."""


@dataclass(frozen=True)
class Work(Generic[Key]):
    """What a process does, whose result is JSON and no text, and how much processor time it may take in s."""

    key: Key
    do: Callable[[], Any]
    longest_s: float


@dataclass
class _Running(Generic[Key]):
    key: Key
    folder: Path
    until: float


def results(works: deque[Work[Key]], processes: int) -> Iterator[tuple[Key, Any]]:
    """What each work returns, as it ends; None where it takes too long.  More works may be added meanwhile."""
    running: dict[int, _Running[Key]] = {}
    while works or running:
        while works and len(running) < processes:
            work, folder = works.popleft(), Path(tempfile.mkdtemp(prefix="ncgear-mutant-"))
            running[_begun(work, folder)] = _Running(work.key, folder, time.monotonic() + WAITING * work.longest_s)
        time.sleep(POLL_S)
        for process, one in list(running.items()):
            if time.monotonic() > one.until:
                os.killpg(process, signal.SIGKILL)
            if os.waitpid(process, os.WNOHANG)[0]:
                del running[process]
                said = one.folder / "result"
                result = json.loads(said.read_text()) if said.exists() else None
                shutil.rmtree(one.folder, ignore_errors=True)
                if isinstance(result, str):
                    raise RuntimeError(result)
                yield one.key, result


def _begun(work: Work[Key], folder: Path) -> int:
    """The number of a new process, a group of its own, which puts temporary files into a folder and says nothing."""
    process = os.fork()
    if process:
        return process
    try:
        os.setpgid(0, 0)
        resource.setrlimit(resource.RLIMIT_CPU, (int(work.longest_s) + 1, int(work.longest_s) + 2))
        os.environ["TMPDIR"] = os.environ["PYTEST_DEBUG_TEMPROOT"] = tempfile.tempdir = str(folder)
        try:
            result = work.do()
        except Exception:
            result = traceback.format_exc()
        (folder / "part").write_text(json.dumps(result))
        (folder / "part").rename(folder / "result")
    finally:
        os._exit(0)
