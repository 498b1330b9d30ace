"""Drafts: an edited text that is not saved is kept in a hidden file beside the design until it is saved or undone.

A studio holds the locks of its drafts.  A draft with a free lock belongs to a studio that has ended in any way, and the
next page that opens the design continues with it.
"""

from __future__ import annotations

import json
import os
import secrets
from contextlib import suppress
from pathlib import Path

from ncgear.files.one_file import UNFINISHED, hidden, locked, write_all
from ncgear.studio.on_disk import DesignOnDisk

DRAFT = ".unsaved-"

HOLDS = os.name == "posix"
"""Whether an open file can be replaced; where it cannot, a draft is closed and its lock is free."""


class Draft:
    """The text of a page beside the file from which it was edited; ``place`` is its file if they differ."""

    def __init__(self, file: DesignOnDisk, text: str, place: Path | None = None, held: int | None = None) -> None:
        self.file, self.text = file, text
        self._place = place or hidden(file.path, f"{DRAFT}{secrets.token_hex(4)}")
        self._held = held

    def follow(self, file: DesignOnDisk, text: str) -> None:
        """Keep another text; raises OSError where it cannot be written."""
        if (file.content, text) == (self.file.content, self.text):
            return
        if text == file.text:
            self._place.unlink(missing_ok=True)
            self.let_go()
        else:
            self._write(file, text)
        self.file, self.text = file, text

    def _write(self, file: DesignOnDisk, text: str) -> None:
        """Replace the draft at one instant; its lock is never free in between."""
        beside = self._place.with_name(f"{self._place.name}{UNFINISHED}")
        beside.unlink(missing_ok=True)
        handle = os.open(beside, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600)
        try:
            locked(handle, wait=False)
            content = None if file.content is None else file.content.decode()
            write_all(handle, json.dumps({"file": content, "text": text}).encode())
            if HOLDS:
                beside.replace(self._place)
        except BaseException:
            os.close(handle)
            beside.unlink(missing_ok=True)
            raise
        self.let_go()
        self._held = handle
        if not HOLDS:
            self.let_go()
            beside.replace(self._place)

    def let_go(self) -> None:
        """Leave the draft to the next page that opens the design."""
        if self._held is not None:
            os.close(self._held)
        self._held = None


def draft_left(file: DesignOnDisk) -> Draft | None:
    """The newest draft of a design that no studio holds; this studio holds it afterwards."""
    found: list[tuple[float, Path]] = []
    with suppress(OSError):
        for place in file.path.parent.iterdir():
            if place.name.startswith(hidden(file.path, DRAFT).name):
                found.append((place.stat().st_mtime, place))
    drafts = (_taken(file, place) for _, place in sorted(found, reverse=True))
    return next((draft for draft in drafts if draft is not None), None)


def _taken(file: DesignOnDisk, place: Path) -> Draft | None:
    """A draft and its lock; None where another studio holds it, where it is no draft, or equals the design file."""
    try:
        handle = os.open(place, os.O_RDWR | getattr(os, "O_BINARY", 0))
    except OSError:
        return None
    held = None
    try:
        # Its owner may have replaced or removed it before it was locked here.
        if (HOLDS and not locked(handle, wait=False)) or not os.path.samestat(os.fstat(handle), place.stat()):
            return None
        if place.name.endswith(UNFINISHED):
            place.unlink()
            return None
        kept = json.loads(place.read_bytes())
        content, text = kept["file"], kept["text"]
        if file.content is not None and text == file.text:
            place.unlink()
            return None
        base = DesignOnDisk(file.path, None if content is None else content.encode())
        held = handle if HOLDS else None
        return Draft(base, text, place, held)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    finally:
        if held is None:
            os.close(handle)
