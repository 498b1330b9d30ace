"""Files reach the output folder all together or not at all: a failed or killed run leaves the last good build.

The new files are first written into a staging folder beside their places, down to the disk.  Then all of them replace
the earlier files at one instant, although a file system moves one file at a time.  First, every name becomes a symbolic
link through one pointer to its old file.  Then one move turns the pointer to the new files.  Then the files themselves
replace the links.  So at each moment either all names lead to old files, or all names lead to new files.

    folder/a.csv -> .ncgear-xyz/current/a.csv        .ncgear-xyz/current -> old, then new

A killed run leaves a staging folder and links into it.  The next run finishes the exchange and clears up.  A staging
folder is recognized by its name, whose second half is computed from the first half: other folders are never touched.
"""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from stat import S_ISDIR, S_ISLNK

from ncgear.errors import WrongInput
from ncgear.files.one_file import (
    REMEDY,
    WITHOUT_LINKS,
    alone_in,
    is_there,
    refused,
    replace_by,
    second,
    sync_folder,
    write,
)
from ncgear.interrupts import uninterrupted

STAGING_PREFIX = ".ncgear-"

OLD, NEW = "old", "new"
_POINTER, _LINK = "current", "link"


def prepare(folder: Path) -> None:
    """Refuse an output folder that cannot be written, before anything is computed; creates nothing.

    Raises WrongInput, with the path at fault, when a file is in the way or the folder is not writable.
    """
    with refused(folder):
        existing = next(place for place in (folder, *folder.absolute().parents) if is_there(place))
        if not existing.is_dir():
            raise WrongInput(f"is no folder; {REMEDY}", location=str(existing))
        if not os.access(existing, os.W_OK | os.X_OK):
            raise WrongInput(f"cannot be written; {REMEDY}", location=str(existing))


def prepare_file(path: Path) -> None:
    """Refuse a file that cannot be written, as ``prepare`` refuses its folder, which is included."""
    if not is_inside(path.name):
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


def is_inside(name: str) -> bool:
    """Whether a name leads to a file in a folder or in a folder below it, but to no staging folder."""
    parts = name.split("/")
    wrong = any(part in ("", ".", "..") or "\\" in part or "\0" in part for part in parts)
    return not wrong and len(parts) <= 2 and not name.startswith(STAGING_PREFIX)


@contextmanager
def opened(folder: Path) -> Iterator[None]:
    """A context for one process at a time that changes files of ``folder``; the folder is created where missing.

    At its start the folder is as the last whole run left it.  Ctrl-C waits for its end.  Raises WrongInput, also for an
    OSError of its body, when the folder cannot be written; a folder created for nothing is removed.
    """
    prepare(folder)
    with refused(folder), uninterrupted():
        missing = [place for place in (folder, *folder.absolute().parents) if not is_there(place)]
        with _removed_if_failed(missing):
            folder.mkdir(parents=True, exist_ok=True)
            with alone_in(folder):
                _clear_up(folder)
                yield


@contextmanager
def _removed_if_failed(folders: Iterable[Path]) -> Iterator[None]:
    """A context that removes these folders, given from the inside out, if it fails and they are empty."""
    try:
        yield
    except BaseException:
        for place in folders:
            with suppress(OSError):
                place.rmdir()
        raise


def _new_staging(folder: Path) -> Path:
    token = secrets.token_hex(6)
    staging = folder / f"{STAGING_PREFIX}{token}-{_sign(token)}"
    staging.mkdir(mode=0o700)
    return staging


def _sign(token: str) -> str:
    return sha256(f"staging folder of ncgear {token}".encode()).hexdigest()[:12]


def _is_of_staging(name: str) -> bool:
    token, _, sign = name.removeprefix(STAGING_PREFIX).partition("-")
    return name.startswith(STAGING_PREFIX) and sign == _sign(token)


def real_place(path: Path) -> Path:
    """The place of a file behind a person's links; links that a killed run left are first replaced by their files.

    Raises WrongInput where that cannot be done: nobody means a file in a staging folder.
    """
    real = Path(os.path.realpath(path))
    if (left := _staging_in(real)) is not None and is_there(left):
        with opened(left.parent):
            # Opening the folder clears it up.
            real = Path(os.path.realpath(path))
    if _staging_in(real) is not None:
        raise WrongInput("leads into what a run has left, and to no file; give the file itself", location=str(path))
    return real


def _staging_in(real: Path) -> Path | None:
    """The staging folder that a path leads through."""
    return next((place for place in real.parents if _is_of_staging(place.name)), None)


def _clear_up(folder: Path) -> None:
    """Finish the exchanges of killed runs, and remove their staging folders."""
    for name in sorted(os.listdir(folder)):
        if _is_of_staging(name) and S_ISDIR((folder / name).lstat().st_mode):
            _settle(folder, folder / name)
            shutil.rmtree(folder / name)


def exchange(folder: Path, files: Mapping[str, bytes], gone: Collection[str] = ()) -> None:
    """Write files to their places in an opened folder, and remove the files ``gone``, at the same instant.

    Raises OSError when that cannot be done; the old files are then visible.  Raises WrongInput where the exchange is
    done but the staging folder could not be cleared up; the new files are then visible.
    """
    names = [*files, *(name for name in gone if name not in files)]
    if names == [*files] and len(names) == 1:
        # One file needs no exchange.
        replace_by(folder / names[0], files[names[0]])
        return
    places = {folder, *((folder / name).parent for name in names)}
    with _removed_if_failed([place for place in places if not is_there(place)]):
        staging = _new_staging(folder)
        try:
            _stage(folder, staging, files, names)
            _exchange(folder, staging, names)
        except BaseException:
            # Links to the old files may remain; the next run clears them up.
            with suppress(OSError):
                _settle(folder, staging)
                shutil.rmtree(staging)
            raise
    try:
        _settle(folder, staging)
        for place in places:
            sync_folder(place)
        shutil.rmtree(staging)
    except OSError as error:
        said = f"the new files are in place, but links into {staging.name} stay ({error.strerror or error})"
        raise WrongInput(f"{said}; the next run that can write here tidies up", location=str(folder)) from error
    for place in {(folder / name).parent for name in gone} - {folder}:
        # A folder goes if it has lost its last file.
        with suppress(OSError):
            place.rmdir()


def _stage(folder: Path, staging: Path, files: Mapping[str, bytes], names: Iterable[str]) -> None:
    """Fill ``staging/new`` and ``staging/old``, down to the disk."""
    folders = {(side / name).parent for name in names for side in (folder, staging / NEW, staging / OLD)}
    for place in sorted(folders):
        place.mkdir(parents=True, exist_ok=True)
    for name in names:
        if is_there(folder / name):
            # The old file is linked or copied, not moved, so that a killed run leaves a file at each place.
            second(folder / name, staging / OLD / name)
    for name, content in files.items():
        write(staging / NEW / name, content)
    for place in (*sorted(folders), staging, folder):
        sync_folder(place)


def _exchange(folder: Path, staging: Path, names: Iterable[str]) -> None:
    """Make the files of ``staging/new`` visible at their places in ``folder``, and no file at the other ``names``.

    ``staging`` is in ``folder``; ``staging/old`` has the replaced files.  Folders in ``names`` exist already.
    Raises OSError when something is in the way; the old files are then visible.  In both cases ``_settle`` must follow.
    Where the file system has no symbolic links, the files are moved one by one; only there can a killed run leave a
    mixture of old and new files.
    """
    try:
        _point(staging, OLD)
    except (NotImplementedError, OSError) as error:
        if isinstance(error, OSError) and error.errno not in WITHOUT_LINKS and os.name == "posix":
            raise
        _exchange_one_by_one(folder, staging, list(names))
        return
    link = staging / _LINK
    for name in names:
        link.symlink_to(os.path.relpath(staging / _POINTER / name, (folder / name).parent))
        link.replace(folder / name)
    for place in {folder, *((folder / name).parent for name in names)}:
        sync_folder(place)
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
    """Move a file to a place; where the file does not exist, the place becomes empty."""
    if is_there(file):
        file.replace(place)
    else:
        place.unlink(missing_ok=True)


def _settle(folder: Path, staging: Path) -> None:
    """Replace all remaining links of an exchange by their files, and remove links that lead to no file.

    Raises OSError where the disk gives no answer: a link is removed only where its file is surely missing.
    """
    try:
        shown = staging / os.readlink(staging / _POINTER)
    except FileNotFoundError:
        return  # Before there is a pointer, there are no links.
    names = {file.relative_to(side) for side in (staging / OLD, staging / NEW) for file in _files_below(side)}
    for name in sorted(names):
        place = folder / name
        if is_there(place) and S_ISLNK(place.lstat().st_mode) and staging.name in place.readlink().parts:
            _put(shown / name, place)


def _files_below(folder: Path) -> Iterator[Path]:
    """All files and links in and below a folder; empty where there is no folder."""
    if is_there(folder):
        for name in os.listdir(folder):
            if S_ISDIR((folder / name).lstat().st_mode):
                yield from _files_below(folder / name)
            else:
                yield folder / name
