"""Runs that are killed: at a given step of their work on files, or after a time; each in a process of its own."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from multiprocessing import get_context
from pathlib import Path
from pkgutil import walk_packages
from typing import Any

import ncgear
import ncgear.cli
from ncgear.files import build as build_module

PROCESSES = get_context("forkserver")
MODULES = [module.name for module in walk_packages(ncgear.__path__, "ncgear.") if "__main__" not in module.name]
# Loaded once: a run that is killed while it imports tells nothing of how it writes.
PROCESSES.set_forkserver_preload(["killed_runs", "pytest", "mapbox_earcut", "shapely", *MODULES])

Files = Mapping[str, bytes]


def seen(folder: Path) -> dict[str, bytes]:
    """What a reader finds in ``folder`` and below: contents by relative path; hidden folders are not looked into."""
    places = [place for place in folder.rglob("*") if not place.relative_to(folder).parts[0].startswith(".")]
    return {str(place.relative_to(folder)): place.read_bytes() for place in places if place.is_file()}


def build(design: Path, folder: Path) -> None:
    """What the program does once it is loaded, but for its pictures: drawing takes most of the time, and no file."""
    build_module.pictures = lambda drive, _: {"tooth_pair.png": drive.design.name.encode()}
    sys.argv = ["ncgear", "build", str(design), "--out", str(folder)]
    with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere):
        ncgear.cli.main()


def killed_at_step(step: int, act: Callable[..., object], *arguments: Any) -> bool:
    """Whether ``act`` was killed before its ``step``-th call that touches a file; False where it ended before that."""
    return _ended(_started(_dying, step, act, arguments)) == -signal.SIGKILL


def killed_after(seconds: float, act: Callable[..., object], *arguments: Any) -> bool:
    """Whether ``act`` was killed after a time, counted from where it begins; False where it ended before that."""
    begun = PROCESSES.Event()
    process = _started(_announced, begun, act, arguments)
    begun.wait()
    process.join(seconds)
    process.kill()
    return _ended(process) == -signal.SIGKILL


def together(*acts: tuple[Any, ...]) -> None:
    """Each act, a function and its arguments, in a process of its own at the same time."""
    for process in [_started(act, *arguments) for act, *arguments in acts]:
        assert _ended(process) == 0


def _started(target: Callable[..., object], *arguments: Any) -> Any:
    process = PROCESSES.Process(target=target, args=arguments)
    process.start()
    return process


def _ended(process: Any) -> int:
    process.join()
    status: int = process.exitcode
    process.close()
    assert status in (0, -signal.SIGKILL), f"a run failed by itself: {status}"
    return status


def _announced(begun: Any, act: Callable[..., object], arguments: tuple[Any, ...]) -> None:
    begun.set()
    act(*arguments)


def _dying(step: int, act: Callable[..., object], arguments: tuple[Any, ...]) -> None:
    """Python tells an audit hook of every call that opens, makes, moves or removes files, before it is made."""
    left = step

    def watch(event: str, _: tuple[Any, ...]) -> None:
        nonlocal left
        if event == "open" or event.startswith(("os.", "shutil.")):
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(watch)
    act(*arguments)
    # What follows is the interpreter's own end, which touches files, too.
    os._exit(0)
