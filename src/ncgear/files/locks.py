"""Locks of open files, between processes and between threads; a lock ends with the process that holds it."""

from __future__ import annotations

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


def _locked_on_windows(handle: int, *, wait: bool) -> bool:
    import msvcrt

    while True:
        with suppress(OSError):
            # It tries ten times, once a second, before it fails.
            msvcrt.locking(handle, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
            return True
        if not wait:
            return False


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
