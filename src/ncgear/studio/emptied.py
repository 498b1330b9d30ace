"""Keys that were emptied but must be given: what is wrong with the design without them, and the changes that remain.

Whether a key can be left out is what reading says of the design without it, so that one of several spellings, or one of
two keys in each other's place, is judged as a key that is always needed is.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ncgear.design.reading.design_file import design_of
from ncgear.design.reading.places import Document
from ncgear.design.reading.yaml import read_yaml
from ncgear.errors import WrongInput
from ncgear.studio.editing import values_of, with_values


def lacking(text: str, changes: Mapping[str, Any], path: Path) -> dict[str, str]:
    """Of the keys that ``changes`` leave out those without which the text has a fault that it has not with them.

    Each has the words of that fault.  Keys that can be left out together are; otherwise each is judged by itself.
    Raises WrongInput where the text cannot be read, or has no place for a change.
    """
    emptied = [key for key, value in changes.items() if value is None]
    if not emptied:
        return {}
    document = read_yaml(text, str(path))
    kept = {key: value for key, value in changes.items() if value is not None}
    before = with_values(document, values_of(text, kept))

    def fault_without(*keys: str) -> str:
        known = _faults(before, text, path)
        after = _faults(with_values(before, values_of(text, dict.fromkeys(keys))), text, path)
        return next((problem for key, problem in after.items() if known.get(key) != problem), "")

    if not fault_without(*emptied):
        return {}
    return {key: problem for key in emptied if (problem := fault_without(key))}


def _faults(document: Document, text: str, path: Path) -> dict[str, str]:
    """The faults of a design by their keys."""
    try:
        design_of(document, text, path)
    except WrongInput as error:
        return {one.key: one.problem for one in (error, *error.others)}
    return {}
