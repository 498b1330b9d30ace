"""Locks of files: those of this system between processes, and those of Windows against a stand-in for its module."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from ncgear.files.one_file import _locked_on_windows, alone_in, locked


class Windows:
    """``msvcrt.locking``: a lock of a byte from where the file stands, told as the C library tells it."""

    LK_LOCK, LK_NBLCK = 1, 2

    def __init__(self) -> None:
        self.holders: dict[tuple[int, int], int] = {}
        self.waited = 0
        self.fault = 0

    def locking(self, handle: int, mode: int, count: int) -> None:
        assert count == 1
        if self.fault:
            raise OSError(self.fault, "no locks here")
        place = os.fstat(handle).st_ino, os.lseek(handle, 0, os.SEEK_CUR)
        if self.holders.get(place, handle) == handle:
            self.holders[place] = handle
            return
        if mode == self.LK_NBLCK:
            raise OSError(errno.EACCES, "locked")
        self.waited += 1
        if self.waited == 3:
            self.holders.clear()
        raise OSError(errno.EDEADLK, "ten tries")


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> Windows:
    module = Windows()
    functions = {name: getattr(module, name) for name in ("locking", "LK_LOCK", "LK_NBLCK")}
    monkeypatch.setitem(sys.modules, "msvcrt", SimpleNamespace(**functions))
    return module


@pytest.fixture
def two(tmp_path: Path) -> tuple[int, int]:
    path = tmp_path / "one"
    path.write_bytes(b"ten bytes.")
    return os.open(path, os.O_RDWR), os.open(path, os.O_RDWR)


def test_on_windows_one_holds_a_file_wherever_it_is_read(windows: Windows, two: tuple[int, int]) -> None:
    first, second = two
    assert os.read(first, 4) == b"ten "
    assert _locked_on_windows(first, wait=False)
    assert os.read(first, 5) == b"bytes"
    assert not _locked_on_windows(second, wait=False)
    assert all(place > 1 << 20 for _, place in windows.holders), "what is written there can be read by others"


def test_on_windows_a_lock_is_waited_for(windows: Windows, two: tuple[int, int]) -> None:
    first, second = two
    assert _locked_on_windows(first, wait=True)
    assert _locked_on_windows(second, wait=True)
    assert windows.waited == 3
    assert set(windows.holders.values()) == {second}


@pytest.mark.parametrize("wait", [False, True])
def test_on_windows_a_file_system_without_locks_keeps_nobody_waiting(
    windows: Windows, two: tuple[int, int], wait: bool
) -> None:
    windows.fault = errno.EINVAL
    assert all(_locked_on_windows(handle, wait=wait) for handle in two)


TAKES = "import os, sys; from ncgear.files.one_file import locked; print(locked(os.open(sys.argv[1], 2), wait=False))"


def test_here_another_process_has_no_lock_until_this_one_lets_it_go(two: tuple[int, int], tmp_path: Path) -> None:
    first, _ = two
    command = [sys.executable, "-c", TAKES, str(tmp_path / "one")]

    def other() -> str:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    assert locked(first, wait=False)
    assert other() == "False"
    os.close(first)
    assert other() == "True"


def test_a_folder_is_free_after_a_fault_in_it(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), alone_in(tmp_path):
        raise ZeroDivisionError
    with alone_in(tmp_path):
        pass
