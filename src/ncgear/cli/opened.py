"""A design file in use by a command."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ncgear.design.load import LoadedDesign


@contextmanager
def opened(path: Path) -> Iterator[LoadedDesign]:
    """The design of a file; errors raised while it is in use get the place of their key in that file."""
    from ncgear.design.load import load

    loaded = load(path)
    with loaded.locating():
        yield loaded
