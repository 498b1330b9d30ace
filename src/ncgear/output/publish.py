"""Files reach the output folder all together or not at all: a failed or killed run leaves the last good build.

They are first written into a staging folder beside their places, then exchanged for the earlier ones at one instant.
What a killed run has left is cleared up by the next one.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ncgear.errors import WrongInput
from ncgear.interrupts import uninterrupted
from ncgear.output.exchange import NEW, OLD, exchange, settle

STAGING_PREFIX = ".ncgear-"

REMEDY = "choose another folder with --out"


def prepare(folder: Path) -> None:
    """Refuse an output folder that cannot be written, before anything is computed; creates nothing.

    Raises WrongInput, with the path at fault, when a file is in the way or the folder is not writable.
    """
    existing = next(place for place in (folder, *folder.absolute().parents) if os.path.lexists(place))
    if not existing.is_dir():
        raise WrongInput(f"is no folder; {REMEDY}", location=str(existing))
    if not os.access(existing, os.W_OK | os.X_OK):
        raise WrongInput(f"cannot be written; {REMEDY}", location=str(existing))


def publish(folder: Path, files: Mapping[str, bytes], obsolete: Collection[str] = ()) -> list[Path]:
    """Write ``files`` (names to contents) into ``folder``, which is created if need be; returns their paths.

    A name is plain, or has one folder before it: ``stage-1/law.csv``. Files by the names of ``obsolete``, which an
    earlier run may have left and which do not belong beside the new ones, go at the same instant. Raises WrongInput
    when the folder cannot be written, ValueError when a name is none of those; in both cases the folder's earlier
    files are untouched.
    """
    for name in (*files, *obsolete):
        _require_inside(name)
    prepare(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with uninterrupted(), _alone_in(folder):
            _clear_up(folder)
            _write_and_exchange(folder, files, set(obsolete) - set(files))
    except OSError as error:
        place = str(error.filename or folder)
        raise WrongInput(f"cannot be written ({error.strerror or error}); {REMEDY}", location=place) from error
    return [folder / name for name in files]


def _require_inside(name: str) -> None:
    """Refuse names that could lead out of the folder, or into a staging folder."""
    parts = name.split("/")
    wrong = any(part in ("", ".", "..") or "\\" in part or "\0" in part for part in parts)
    if wrong or len(parts) > 2 or name.startswith(STAGING_PREFIX):
        raise ValueError(f"{name!r} is not a plain file name")


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Let builds into one folder publish one after the other, so that any staging folder met is a leftover.

    The lock goes with the process that holds it. Where the system or the file system has none, builds go unlocked.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _clear_up(folder: Path) -> None:
    """Finish the exchanges of killed runs, and remove what they have left."""
    for leftover in folder.glob(f"{STAGING_PREFIX}*"):
        if leftover.is_dir() and not leftover.is_symlink():
            settle(folder, leftover)
            shutil.rmtree(leftover)


def _write_and_exchange(folder: Path, files: Mapping[str, bytes], obsolete: Iterable[str]) -> None:
    gone = [name for name in obsolete if (folder / name).is_file()]
    staging = Path(tempfile.mkdtemp(prefix=STAGING_PREFIX, dir=folder))
    try:
        for name, content in files.items():
            for place in (folder / name, staging / NEW / name, staging / OLD / name):
                place.parent.mkdir(parents=True, exist_ok=True)
            (staging / NEW / name).write_bytes(content)
        _keep_copies(folder, staging / OLD, [*files, *gone])
        exchange(folder, staging, [*files, *gone])
    finally:
        # If this fails, what is behind links stays for the next run.
        settle(folder, staging)
        shutil.rmtree(staging, ignore_errors=True)
    _remove_empty(folder, gone)


def _keep_copies(folder: Path, earlier: Path, names: Iterable[str]) -> None:
    """Copies, not moves: a run killed at any moment leaves a file at each place."""
    for name in names:
        if (folder / name).exists():
            (earlier / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(folder / name, earlier / name)


def _remove_empty(folder: Path, names: Iterable[str]) -> None:
    """Remove the folders that have lost their last file."""
    for place in {(folder / name).parent for name in names} - {folder}:
        with suppress(OSError):
            place.rmdir()
