"""Windows for a process and its children: with this folder in PYTHONPATH, Python begins with it.

What ncgear and its tests see of the standard library is then as on Windows; libraries keep the system that there is.
"""

from __future__ import annotations

import builtins
import errno
import fcntl
import os
import re
import signal
import stat
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

ROOT = Path(__file__).parents[2]

NO_MODULES = {"fcntl", "grp", "posix", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty"}

OF_UNIX = """
    chown chroot fchdir fchmod fchown fork forkpty geteuid getegid getgid getgroups getloadavg getpgid getpgrp
    getpriority getresuid getsid getuid getxattr initgroups killpg lchown listxattr lockf major mkfifo mknod nice
    openpty pathconf pipe2 posix_spawn posix_spawnp pread pwrite register_at_fork removexattr sched_getaffinity
    sched_setaffinity sched_yield sendfile setegid seteuid setgid setgroups setpgid setpriority setsid setuid setxattr
    statvfs sync sysconf tcgetpgrp ttyname uname wait wait3 wait4 waitid
    O_CLOEXEC O_DIRECTORY O_DSYNC O_NOCTTY O_NOFOLLOW O_NONBLOCK O_SYNC WEXITSTATUS WIFSIGNALED WNOHANG WTERMSIG
"""
"""Names of ``os`` that Windows has not."""

SIGNALS = {"SIGABRT", "SIGFPE", "SIGILL", "SIGINT", "SIGSEGV", "SIGTERM"}
NOT_OF_SIGNAL = {name for name in dir(signal) if re.match("SIG[A-Z]|ITIMER|.*(itimer|sig[mptw]|alarm|pause)", name)}
NOT_OF_SIGNAL -= SIGNALS


class Elsewhere(ModuleType):
    """A module as another system has it; what is set is set in the module itself."""

    def __init__(self, module: ModuleType, lacks: set[str], **has: Any) -> None:
        self.__dict__.update(real=module, lacks=lacks, __name__=module.__name__, **has)

    def __getattr__(self, name: str) -> Any:
        if name in self.lacks:
            raise AttributeError(f"this system's {self.real.__name__} has no {name}")
        return getattr(self.real, name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self.real, name, value)


def _open(path: Any, flags: int, mode: int = 0o777, **more: Any) -> int:
    """``os.open``, which opens no folder there."""
    handle = os.open(path, flags, mode, **more)
    if stat.S_ISDIR(os.fstat(handle).st_mode):
        os.close(handle)
        raise PermissionError(errno.EACCES, "Permission denied", os.fspath(path))
    return handle


def _rename(source: Any, target: Any) -> None:
    """``os.rename``, which replaces nothing there."""
    if os.path.lexists(target):
        raise FileExistsError(errno.EEXIST, "Cannot create a file when that file already exists", source, None, target)
    os.rename(source, target)


def _signal(number: int, handler: Any) -> Any:
    """``signal.signal``, which knows six signals there."""
    if number not in {getattr(signal, name) for name in SIGNALS}:
        raise ValueError("invalid signal value")
    return signal.signal(number, handler)


def _no_link(*_: Any, **__: Any) -> NoReturn:
    """``os.symlink`` of a user without the right to make links."""
    raise OSError(errno.EINVAL, "A required privilege is not held by the client")


def _locking(handle: int, mode: int, _: int) -> None:
    """``msvcrt.locking``; a lock of the whole file stands for that of a byte."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (fcntl.LOCK_NB if mode == 2 else 0))
    except BlockingIOError as error:
        raise OSError(errno.EACCES, "Permission denied") from error


MSVCRT = ModuleType("msvcrt")
MSVCRT.__dict__.update(locking=_locking, LK_LOCK=1, LK_NBLCK=2)

MODULES: dict[str, ModuleType] = {
    "msvcrt": MSVCRT,
    "os": Elsewhere(os, set(OF_UNIX.split()), name="nt", open=_open, rename=_rename, O_BINARY=0),
    "signal": Elsewhere(signal, NOT_OF_SIGNAL, signal=_signal),
    "sys": Elsewhere(sys, {"getdlopenflags", "setdlopenflags"}, platform="win32"),
}

_import = builtins.__import__


def _imported(name: str, globals: Any = None, locals: Any = None, fromlist: Any = (), level: int = 0) -> Any:
    """A module as the one that imports it sees it."""
    place = str((globals or {}).get("__file__") or "")
    if level == 0 and place.startswith((f"{ROOT}/src/", f"{ROOT}/tests/", f"{ROOT}/benchmarks/")):
        if name in NO_MODULES:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        if name in MODULES:
            return MODULES[name]
    return _import(name, globals, locals, fromlist, level)


builtins.__import__ = _imported
os.symlink = _no_link
