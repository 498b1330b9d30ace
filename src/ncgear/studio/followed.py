"""The design that is followed while its values change: its text is read once, and what a change leaves is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ncgear.design.reading.design_file import design_of
from ncgear.design.reading.places import Document, with_value
from ncgear.design.reading.yaml import read_yaml
from ncgear.project.drive import Drive
from ncgear.project.in_common import drive_like
from ncgear.studio.editing import in_its_place, values_of


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
        document = self._document
        for key, value in values_of(text, changes).items():
            with in_its_place(key):
                document = replace(document, data=with_value(document.data, key, value))
        loaded = design_of(document, text, path)
        before = self._drive
        self._drive = drive_like(before, loaded.design, loaded) if before else Drive(loaded.design, loaded=loaded)
        return self._drive
