"""Files reach the output folder all together or not at all: a failed run leaves the last good build.

They are first written into a staging folder beside their places, then moved into place one by one; the files they
replace are kept in the staging folder until all have moved, and put back if one does not.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ncgear.errors import WrongInput

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


def publish(folder: Path, files: Mapping[str, bytes]) -> list[Path]:
    """Write ``files`` (plain names to contents) into ``folder``, which is created if need be; returns their paths.

    They are moved into place in the order of the mapping. Raises WrongInput when the folder cannot be written,
    ValueError when a name is not a plain one; in both cases the folder's earlier files are untouched.
    """
    for name in files:
        _require_plain(name)
    prepare(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _alone_in(folder):
            _remove_leftovers(folder)
            _write_and_move(folder, files)
    except OSError as error:
        place = str(error.filename or folder)
        raise WrongInput(f"cannot be written ({error.strerror or error}); {REMEDY}", location=place) from error
    return [folder / name for name in files]


def _require_plain(name: str) -> None:
    if name in ("", ".", "..") or any(mark in name for mark in "/\\\0") or name.startswith(STAGING_PREFIX):
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


def _remove_leftovers(folder: Path) -> None:
    """Remove what killed runs have left."""
    for leftover in folder.glob(f"{STAGING_PREFIX}*"):
        if leftover.is_dir() and not leftover.is_symlink():
            shutil.rmtree(leftover)


def _write_and_move(folder: Path, files: Mapping[str, bytes]) -> None:
    staging = Path(tempfile.mkdtemp(prefix=STAGING_PREFIX, dir=folder))
    try:
        fresh, earlier = staging / "fresh", staging / "earlier"
        fresh.mkdir()
        earlier.mkdir()
        for name, content in files.items():
            (fresh / name).write_bytes(content)
        _keep_copies(folder, earlier, files)
        _move_all(folder, fresh, earlier, files)
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _keep_copies(folder: Path, earlier: Path, names: Iterable[str]) -> None:
    """Copies, not moves: a run killed at any moment leaves a file at each place."""
    for name in names:
        if (folder / name).exists():
            shutil.copy2(folder / name, earlier / name)


def _move_all(folder: Path, fresh: Path, earlier: Path, names: Iterable[str]) -> None:
    moved: list[str] = []
    try:
        for name in names:
            (fresh / name).replace(folder / name)
            moved.append(name)
    except BaseException:
        _restore(folder, earlier, moved)
        raise


def _restore(folder: Path, earlier: Path, names: Iterable[str]) -> None:
    for name in names:
        if (earlier / name).exists():
            (earlier / name).replace(folder / name)
        else:
            (folder / name).unlink()
