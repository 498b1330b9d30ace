"""Locks of open files, between processes and between threads; a lock ends with the process that holds it."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from tempfile import gettempdir


def locked(handle: int, *, wait: bool) -> bool:
    """Take the lock of an open file; False where another holds it and ``wait`` is false.

    Some file systems have no locks, mostly those of networks; there nobody holds one, and everybody gets it.
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
"""Byte of a file that is locked on Windows, where nobody else can read or write a byte that is locked: beyond all that
is ever written.  A lock there is of a place, whatever has been read or written before."""

HELD = (errno.EACCES, errno.EDEADLK, getattr(errno, "EDEADLOCK", errno.EDEADLK))
"""What Windows says of a byte that another holds: at once, and after the ten seconds that it waits."""


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
    """A context that one process or thread at a time can be in for a folder."""
    handle = _handle_of(folder)
    try:
        locked(handle, wait=True)
        yield
    finally:
        # Whatever its end says, it tells nothing of the files.
        with suppress(OSError):
            os.close(handle)


def _handle_of(folder: Path) -> int:
    """What stands for a folder in locks: the folder itself, or where folders cannot be opened a file of its own."""
    if os.name == "posix":
        return os.open(folder, os.O_RDONLY)
    name = sha256(os.path.realpath(folder).encode()).hexdigest()[:24]
    return os.open(Path(gettempdir()) / f"ncgear-{name}.lock", os.O_RDWR | os.O_CREAT)
