"""The design file on the disk: opened, compared and saved, so that nobody's version is lost.

The lock of the folder makes saves of all pages and studios wait for each other.  Other programs do not know this lock.
So a save exchanges the file with its own in one instant; if the old file is not the compared one, the save exchanges
them back.
"""

from __future__ import annotations

import os
import re
from codecs import BOM_UTF8
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from errno import EBUSY
from hashlib import sha256
from pathlib import Path
from shutil import copystat
from stat import S_IMODE, S_ISREG
from time import sleep

from ncgear.design.reading.text import read_text
from ncgear.errors import WrongInput
from ncgear.files.one_file import (
    REMEDY,
    UNFINISHED,
    hidden,
    is_there,
    kept_names,
    put_at_free_place,
    swap,
    sync_folder,
    written_beside,
)
from ncgear.files.publish import opened, real_place
from ncgear.frozen import dataclass

LARGEST_MB = 1
"""Largest text that can be edited: a hundred times a long design, read in a few seconds."""

LATE_S = 0.05
"""Time in which a program that opened the file before a save finishes writing; it needs a thousandth of that."""

DIGITS = 12
"""Hexadecimal digits of a SHA-256 that tell the versions of a file from each other."""


class NotSaved(WrongInput):
    """A save that a person must decide on; ``there`` is the file on the disk that it would replace."""

    def __init__(self, problem: str, path: Path, found: bytes | None) -> None:
        super().__init__(problem, location=str(path))
        self.there = DesignOnDisk(path, found)


@dataclass(frozen=True)
class DesignOnDisk:
    """A design file and the bytes that it had when it was read or saved; None where there was no file.

    ``kept`` has the files beside it that hold versions of other programs.
    """

    path: Path
    content: bytes | None
    kept: tuple[Path, ...] = ()

    @property
    def text(self) -> str:
        """The text of the file."""
        return (self.content or b"").decode("utf-8-sig", errors="replace")

    def saved(self, text: str, *, protected_too: bool = False) -> DesignOnDisk:
        """The file with another text, written at one instant: a killed process leaves the old file or the new file.

        Raises NotSaved where another program has changed the file.  Raises NotSaved, unless ``protected_too``, where it
        is read-only or a hard link, which a new file separates from its other names; WrongInput where it cannot be
        written.
        """
        # Some editors begin a file with a byte order mark, and look for it.
        mark = BOM_UTF8 if (self.content or b"").startswith(BOM_UTF8) else b""
        content = mark + text.encode()
        with _clearing() as kept, _in_its_own_folder(), opened(self.path.parent):
            _clear_up(self.path, kept)
            # For a file that a killed run has just made, this is a second name
            hidden(self.path, UNFINISHED).unlink(missing_ok=True)
            if _content(self.path) != content:
                self._require_same()
                if self.content is None:
                    self._create(content)
                elif protected_too or not (why := self._protected()):
                    self._replace(self.content, content, kept)
                else:
                    raise NotSaved(why, self.path, self.content)
        return replace(self, content=content, kept=tuple(kept))

    def _require_same(self) -> None:
        found = _content(self.path)
        if found != self.content:
            raise self._changed(found)

    def _changed(self, found: bytes | None) -> NotSaved:
        what = "has been removed" if found is None else "has been changed by another program"
        why = "" if found is None else self._protected()
        return NotSaved(f"{what} since it was opened{why and f', and {why}'}", self.path, found)

    def _protected(self) -> str:
        """The reason to ask a person before the file is replaced; empty if there is none."""
        status = self.path.stat()
        writable = status.st_mode & 0o222 and os.access(self.path, os.W_OK)
        linked = "has another name, a hard link, which keeps the former text and is parted from it"
        return " and ".join(why for why, yes in (("is read-only", not writable), (linked, status.st_nlink > 1)) if yes)

    def _unmoved(self, error: OSError) -> OSError | WrongInput:
        """The error about a file that the disk cannot exchange for a new one."""
        if error.errno == EBUSY:
            problem = "is mounted by itself and cannot be exchanged for a new file; mount the folder that it is in"
            return WrongInput(problem, location=str(self.path))
        return OSError(error.errno, error.strerror, str(self.path))

    def _create(self, content: bytes) -> None:
        try:
            put_at_free_place(self.path, content)
        except FileExistsError as error:
            raise self._changed(_content(self.path)) from error

    def _replace(self, former: bytes, content: bytes, kept: list[Path]) -> None:
        """Exchange the file for a new one, and check that the old one is the former version; ``kept`` may grow."""
        try:
            mode = S_IMODE(self.path.stat().st_mode)
            written = written_beside(self.path, content, mode)
            _belong_as(written, self.path)
        except FileNotFoundError as error:
            hidden(self.path, UNFINISHED).unlink(missing_ok=True)
            raise self._changed(_content(self.path)) from error
        written.chmod(mode)
        new = hidden(self.path, f".{_digest(former)}-{_digest(content)}{SAVING}")
        written.replace(new)
        try:
            self._require_same()
            swap(new, self.path)
        except (NotSaved, FileNotFoundError) as error:
            new.unlink()
            raise self._changed(_content(self.path)) from error
        except OSError as error:
            for left in (new, new.with_name(f"{new.name}{UNFINISHED}")):
                left.unlink(missing_ok=True)
            raise self._unmoved(error) from error
        sleep(LATE_S)
        if new.read_bytes() != former:
            swap(new, self.path)
            _clear_up(self.path, kept)
            raise self._changed(_content(self.path))
        new.unlink()
        sync_folder(self.path.parent)
        if (found := _content(self.path)) != content:
            raise self._changed(found)


def _content(path: Path) -> bytes | None:
    """The content of a file; None where there is no file.  Raises WrongInput before reading anything but a file."""
    try:
        _require_file(path)
        return path.read_bytes()
    except FileNotFoundError:
        return None


def _require_file(path: Path) -> None:
    """Raise WrongInput for a folder, a device or a pipe: a save would remove it, and reading a pipe would wait."""
    if not S_ISREG(path.stat().st_mode):
        raise WrongInput("is a folder, a device or a pipe, not a file; put a file there", location=str(path))


def _belong_as(new: Path, former: Path) -> None:
    """Give a file the owner, the group and the extended attributes of another file, as far as the system allows."""
    before, now = former.stat(), new.stat()
    with suppress(OSError, AttributeError):
        os.chown(new, before.st_uid, before.st_gid)
    with suppress(OSError):
        copystat(former, new)
        os.utime(new, ns=(now.st_atime_ns, now.st_mtime_ns))


@contextmanager
def _in_its_own_folder() -> Iterator[None]:
    """A context in which no other folder is proposed: a design is saved where it was opened."""
    try:
        yield
    except WrongInput as error:
        error.problem = error.problem.replace(REMEDY, "make room there or allow it, and save again")
        raise


SAVING = ".saving"
"""End of the name of a file that a save exchanges; before it are the digests of the old and the new version."""


def _digest(content: bytes) -> str:
    return sha256(content).hexdigest()[:DIGITS]


def _left(path: Path) -> list[Path]:
    """Files that killed saves have left beside a file."""
    digest = f"[0-9a-f]{{{DIGITS}}}"
    form = re.compile(f"{re.escape(hidden(path, '.').name)}{digest}-{digest}{SAVING}({UNFINISHED})?")
    with suppress(OSError):
        return [path.with_name(name) for name in sorted(os.listdir(path.parent)) if form.fullmatch(name)]
    return []


@contextmanager
def _clearing() -> Iterator[list[Path]]:
    """A context with the paths of versions that are kept in it; its errors tell them too."""
    kept: list[Path] = []
    try:
        yield kept
    except WrongInput as error:
        error.problem = ". ".join((error.problem, *kept_words(kept)))
        raise


def kept_words(kept: Sequence[Path]) -> tuple[str, ...]:
    """The text about versions of other programs that were kept beside the file."""
    names = ", ".join(place.name for place in kept)
    return (f"A version that another program wrote during a save is kept as {names}.",) if names else ()


def _clear_up(path: Path, kept: list[Path]) -> None:
    """Remove the files of killed saves; a version that they did not know is kept, and its path is added to ``kept``."""
    for left in _left(path):
        content = left.read_bytes()
        if _digest(content) in left.name or (is_there(path) and path.read_bytes() == content):
            left.unlink()
        else:
            place = next(place for place in kept_names(path) if not is_there(place))
            left.replace(place)
            kept.append(place)


def require_same_place(file: DesignOnDisk, opened_as: Path) -> None:
    """Raise NotSaved where the path with which a file was opened, perhaps a link, now leads to another file."""
    real = real_place(opened_as)
    if real != file.path:
        problem = f"stands for another file than when it was opened: {real}, not {file.path}"
        raise NotSaved(problem, real, _content(real))


def design_on_disk(path: Path) -> DesignOnDisk:
    """The design file at a path, with any text; raises WrongInput where it cannot be read as text."""
    real = real_place(path)
    if is_there(real):
        _require_file(real)
    with _clearing() as kept:
        if _left(real):
            with opened(real.parent):
                _clear_up(real, kept)
        read_text(path, limit_mb=LARGEST_MB)
    return DesignOnDisk(real, real.read_bytes(), tuple(kept))
