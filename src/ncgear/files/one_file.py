"""One file reaches its place whole: it is written beside it, down to the disk, and moved there in a single step.

A killed run leaves the earlier file or the new one.  Many files that belong together are exchanged by ``publish``.
Open files have locks, between processes and between threads; a lock ends with the process that holds it.
"""

from __future__ import annotations

import ctypes
import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import EEXIST, EINVAL, EIO, ENOSYS, EOPNOTSUPP, EPERM, EROFS
from hashlib import sha256
from itertools import count
from pathlib import Path
from stat import S_ISLNK
from tempfile import gettempdir

from ncgear.errors import WrongInput
from ncgear.interrupts import uninterrupted

REMEDY = "choose another folder with --out"

UNFINISHED = ".part"
"""End of the name of an unfinished file; after a killed run nobody needs it, and the next writer removes it."""

LONGEST_NAME = 200
"""Bytes of a file's name to which fifty more can be added: file systems have names of 255."""

WITHOUT_LINKS = {EPERM, ENOSYS, EOPNOTSUPP, EROFS}
"""Errors of file systems without links; shared folders of virtual machines answer EROFS."""

_HERE, _EXCHANGE = -100, 2
"""AT_FDCWD and RENAME_EXCHANGE of Linux's renameat2."""


def put_in_place(place: Path, content: bytes) -> None:
    """Write one file and move it to its place, where it replaces an earlier file.

    Raises WrongInput when that cannot be done.
    """
    with refused(place.parent), uninterrupted():
        replace_by(place, content)


def replace_by(place: Path, content: bytes) -> None:
    """Write one file and move it to its place; raises OSError, and then the earlier file stays."""
    written_beside(place, content).replace(place)
    sync_folder(place.parent)


def put_at_free_place(place: Path, content: bytes) -> None:
    """Write one file to a free place; raises FileExistsError where the place is taken, or another OSError."""
    beside = written_beside(place, content)
    try:
        os.link(beside, place)
        beside.unlink()
    except OSError as error:
        if error.errno not in WITHOUT_LINKS:
            beside.unlink()
            raise
        if is_there(place):
            beside.unlink()
            raise FileExistsError(EEXIST, os.strerror(EEXIST), str(place)) from error
        beside.replace(place)
    sync_folder(place.parent)


def written_beside(place: Path, content: bytes, mode: int = 0o666) -> Path:
    """A hidden file beside a place, written down to the disk; raises OSError, and then leaves no file."""
    beside = hidden(place, UNFINISHED)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        beside.unlink(missing_ok=True)
        write(beside, content, mode)
    except OSError as error:
        with suppress(OSError):
            beside.unlink()
        raise OSError(error.errno, error.strerror, str(place)) from error
    return beside


def hidden(place: Path, end: str) -> Path:
    """A hidden place beside a file, named after the file, or after the digest of a name that is too long."""
    name = place.name if len(place.name.encode()) <= LONGEST_NAME else sha256(place.name.encode()).hexdigest()[:24]
    return place.with_name(f".{name}{end}")


def swap(new: Path, place: Path) -> None:
    """Exchange the file ``new`` and the file at ``place``; raises OSError.

    On Linux this happens at one instant.  Elsewhere the old file gets its second name just before: a file that another
    program moves there in the microseconds between is lost.
    """
    if _exchanged(new, place):
        return
    former = new.with_name(f"{new.name}{UNFINISHED}")
    former.unlink(missing_ok=True)
    second(place, former)
    new.replace(place)
    former.replace(new)


def _exchanged(path: Path, other: Path) -> bool:
    """Whether two files have changed places at one instant; False where the system has no such call."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):
        return False
    if renameat2(_HERE, os.fsencode(path), _HERE, os.fsencode(other), _EXCHANGE) == 0:
        return True
    error = ctypes.get_errno()
    if error in {*WITHOUT_LINKS, EINVAL}:
        return False
    raise OSError(error, os.strerror(error), str(other))


def second(place: Path, other: Path) -> None:
    """Make another name for a file; a copy where the file system has no hard links, or the file is a link itself."""
    if not S_ISLNK(place.lstat().st_mode):
        try:
            os.link(place, other)
            return
        except OSError as error:
            if error.errno not in WITHOUT_LINKS:
                raise
    write(other, place.read_bytes())
    shutil.copystat(place, other)


def write(place: Path, content: bytes, mode: int = 0o666) -> None:
    """Write a new file, all of it, and wait until the disk has it; raises OSError."""
    handle = os.open(place, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), mode)
    try:
        write_all(handle, content)
        os.fsync(handle)
    except OSError as error:
        # An error while writing by a handle does not know the file's name.
        raise OSError(error.errno, error.strerror, str(place)) from error
    finally:
        os.close(handle)


def write_all(handle: int, content: bytes) -> None:
    """Write all of a content into an open file; raises OSError."""
    left = memoryview(content)
    while left:
        written = os.write(handle, left)
        if written == 0:
            raise OSError(EIO, os.strerror(EIO))
        left = left[written:]


def sync_folder(place: Path) -> None:
    """Wait until the disk has the names of a folder, where the system can tell."""
    if os.name != "posix":
        return
    handle = os.open(place, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno != EINVAL:
            raise
    finally:
        os.close(handle)


def is_there(place: Path) -> bool:
    """Whether something is at a path, even a link to nothing; raises OSError where the disk gives no answer.

    Python's own functions answer False for any fault of the disk, some of them since version 3.12 or 3.14.
    """
    try:
        place.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def kept_names(place: Path) -> Iterator[Path]:
    """Places beside a file for its kept version: ``law-kept.csv``, ``law-kept-2.csv`` and so on."""
    for number in count(1):
        yield place.with_name(f"{place.stem}-kept{f'-{number}' if number > 1 else ''}{place.suffix}")


@contextmanager
def refused(folder: Path) -> Iterator[None]:
    """A context that turns errors of the disk into WrongInput."""
    try:
        yield
    except OSError as error:
        place = str(error.filename or folder)
        raise WrongInput(f"cannot be written ({error.strerror or error}); {REMEDY}", location=place) from error


def locked(handle: int, *, wait: bool) -> bool:
    """Take the lock of an open file; False where another holds it and ``wait`` is false.

    Some file systems, mostly of networks, have no locks; there every process gets the lock.
    """
    try:
        import fcntl
    except ImportError:
        return _locked_on_windows(handle, wait=wait)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True


BEYOND = 1 << 30
"""Byte of a file that is locked on Windows: far beyond every written byte, since no other process can read or write a
locked byte.  A lock there belongs to a place in the file, and does not move as the file is read or written."""

HELD = (errno.EACCES, errno.EDEADLK, getattr(errno, "EDEADLOCK", errno.EDEADLK))
"""Errors of Windows for a byte that another process has locked: at once, and after a wait of ten seconds."""


def _locked_on_windows(handle: int, *, wait: bool) -> bool:
    import msvcrt

    here = os.lseek(handle, 0, os.SEEK_CUR)
    os.lseek(handle, BEYOND, os.SEEK_SET)
    try:
        while True:
            try:
                msvcrt.locking(handle, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
            except OSError as error:
                if error.errno not in HELD:
                    return True
                if not wait:
                    return False
            else:
                return True
    finally:
        os.lseek(handle, here, os.SEEK_SET)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """A context of a folder that one process or thread at a time can enter."""
    handle = _handle_of(folder)
    try:
        locked(handle, wait=True)
        yield
    finally:
        # An error at the end of the lock says nothing about the files.
        with suppress(OSError):
            os.close(handle)


def _handle_of(folder: Path) -> int:
    """Handle by which a folder is locked: of the folder, or of a separate file where folders cannot be opened."""
    if os.name == "posix":
        return os.open(folder, os.O_RDONLY)
    name = sha256(os.path.realpath(folder).encode()).hexdigest()[:24]
    return os.open(Path(gettempdir()) / f"ncgear-{name}.lock", os.O_RDWR | os.O_CREAT)
