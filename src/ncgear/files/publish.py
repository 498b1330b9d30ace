"""Files reach the output folder all together or not at all: a failed or killed run leaves the last good build.

The new files are first written into a staging folder beside their places.  Then all of them replace the earlier files
at one instant, although a file system moves one file at a time.  First, every name becomes a symbolic link through one
pointer to a copy of its old file.  Then one move turns the pointer to the new files.  Then the files themselves replace
the links.  So at each moment either all names lead to old files, or all names lead to new files.

    folder/a.csv -> .ncgear-xyz/current/a.csv        .ncgear-xyz/current -> old, then new

A killed run leaves a staging folder and links into it.  The next run finishes the exchange and clears up.
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

STAGING_PREFIX = ".ncgear-"

OLD, NEW = "old", "new"
_POINTER, _LINK = "current", "link"

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


def prepare_file(path: Path) -> None:
    """Refuse a file that cannot be written, as ``prepare`` refuses its folder, which is included."""
    if not _is_inside(path.name):
        raise WrongInput(f"{path.name!r} names no file here; letters, digits, - and _ are right", location=str(path))
    prepare(path.parent)
    try:
        in_the_way = path.is_dir()
        path.lstat()
    except FileNotFoundError:
        return
    except OSError as error:
        raise WrongInput(f"cannot be written ({error.strerror}); choose another name", location=str(path)) from error
    if in_the_way:
        raise WrongInput("is a folder; choose another name", location=str(path))


def publish(folder: Path, files: Mapping[str, bytes], obsolete: Collection[str] = ()) -> list[Path]:
    """Write ``files`` (names to contents) into ``folder``, which is created if need be; returns their paths.

    A name is plain, or has one folder before it: ``stage-1/law.csv``.  Files with the names of ``obsolete``, which an
    earlier run may have left and which do not belong beside the new files, are removed at the same instant.  Raises
    WrongInput when the folder cannot be written, ValueError when a name has another form; in both cases the earlier
    files in the folder are untouched.
    """
    for name in (*files, *obsolete):
        if not _is_inside(name):
            raise ValueError(f"{name!r} is not a plain file name")
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


def _is_inside(name: str) -> bool:
    """Whether a name does not lead out of the folder, nor into a staging folder."""
    parts = name.split("/")
    wrong = any(part in ("", ".", "..") or "\\" in part or "\0" in part for part in parts)
    return not wrong and len(parts) <= 2 and not name.startswith(STAGING_PREFIX)


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """A context that one process at a time can enter for a folder, so that any other staging folder is a leftover.

    The lock ends with the process that holds it.  Where the system or the file system has no locks, there is none.
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
    """Finish the exchanges of killed runs, and remove their staging folders."""
    for leftover in folder.glob(f"{STAGING_PREFIX}*"):
        if leftover.is_dir() and not leftover.is_symlink():
            _settle(folder, leftover)
            shutil.rmtree(leftover)


def _write_and_exchange(folder: Path, files: Mapping[str, bytes], obsolete: Iterable[str]) -> None:
    """Write files to their places in the folder, and remove the obsolete ones."""
    gone = [name for name in obsolete if (folder / name).is_file()]
    staging = Path(tempfile.mkdtemp(prefix=STAGING_PREFIX, dir=folder))
    try:
        for name, content in files.items():
            for place in (folder / name, staging / NEW / name, staging / OLD / name):
                place.parent.mkdir(parents=True, exist_ok=True)
            (staging / NEW / name).write_bytes(content)
        for name in (*files, *gone):
            if (folder / name).exists():
                # The old file is copied, not moved, so that a killed run leaves a file at each place.
                (staging / OLD / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(folder / name, staging / OLD / name)
        _exchange(folder, staging, [*files, *gone])
    finally:
        # If this fails, the files that links lead to stay for the next run.
        _settle(folder, staging)
        shutil.rmtree(staging, ignore_errors=True)
    for place in {(folder / name).parent for name in gone} - {folder}:
        # A folder goes if it has lost its last file.
        with suppress(OSError):
            place.rmdir()


def _exchange(folder: Path, staging: Path, names: Iterable[str]) -> None:
    """Make the files of ``staging/new`` visible at their places in ``folder``, and no file at the other ``names``.

    ``staging`` is in ``folder``; ``staging/old`` has copies of the files that are replaced.  Folders in ``names`` exist
    already.  Raises OSError when something is in the way; the old files are then visible.  In both cases ``_settle``
    must follow.  Where the file system has no symbolic links, the files are moved one by one; only there can a killed
    run leave a mixture of old and new files.
    """
    try:
        _point(staging, OLD)
    except (OSError, NotImplementedError):
        _exchange_one_by_one(folder, staging, list(names))
        return
    link = staging / _LINK
    for name in names:
        link.symlink_to(os.path.relpath(staging / _POINTER / name, (folder / name).parent))
        link.replace(folder / name)
    _point(staging, NEW)


def _point(staging: Path, side: str) -> None:
    """Turn the pointer to one side, in a single move."""
    link = staging / _LINK
    link.symlink_to(side, target_is_directory=True)
    link.replace(staging / _POINTER)


def _exchange_one_by_one(folder: Path, staging: Path, names: list[str]) -> None:
    """Exchange without symbolic links; where a move fails, the moves before it are undone."""
    done: list[str] = []
    try:
        for name in names:
            _put(staging / NEW / name, folder / name)
            done.append(name)
    except BaseException:
        for name in done:
            _put(staging / OLD / name, folder / name)
        raise


def _put(file: Path, place: Path) -> None:
    """Move a file to a place; where there is no such file the place becomes empty."""
    if file.exists():
        file.replace(place)
    else:
        place.unlink(missing_ok=True)


def _settle(folder: Path, staging: Path) -> None:
    """Replace all links that an exchange has left by their files, and remove links that lead to no file."""
    for side in (staging / OLD, staging / NEW):
        # The list is made first, because files leave this folder in the loop.
        for file in [place for place in sorted(side.rglob("*")) if not place.is_dir()]:
            place = folder / file.relative_to(side)
            if not (place.is_symlink() and staging.name in place.readlink().parts):
                continue
            if place.exists():
                place.resolve().replace(place)
            else:
                place.unlink()
