"""The design that is followed while its values change: its text is read once, and what a change leaves is kept."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ncgear.design.reading.design_file import design_of
from ncgear.design.reading.places import Document
from ncgear.design.reading.yaml import read_yaml
from ncgear.project.drive import Drive
from ncgear.project.in_common import drive_like
from ncgear.studio.editing import values_of, with_values


class Followed:
    """A text with values that change again and again."""

    def __init__(self) -> None:
        self._text: str | None = None
        self._document = Document(None, {})
        self._drive: Drive | None = None

    def drive(self, text: str, changes: Mapping[str, Any], path: Path) -> Drive:
        """The drive of a text with changes by key; a fault has the line of the text.

        Raises WrongInput where the text cannot be read, or has no place for a change.
        """
        if text != self._text:
            self._document, self._text = read_yaml(text, str(path)), text
        loaded = design_of(with_values(self._document, values_of(text, changes)), text, path)
        before = self._drive
        self._drive = drive_like(before, loaded.design, loaded) if before else Drive(loaded.design, loaded=loaded)
        return self._drive
