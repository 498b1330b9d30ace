"""A folder that was made as one zip file."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile


def zipped(folder: Path) -> bytes:
    """The files of a folder as a zip, below the folder's own name and in order; hidden ones stay behind.

    Raises OSError where a file cannot be read.
    """
    content = BytesIO()
    with ZipFile(content, "w", ZIP_DEFLATED) as made:
        for place in sorted(folder.rglob("*")):
            inside = place.relative_to(folder.parent)
            if place.is_file() and not place.is_symlink() and not any(part.startswith(".") for part in inside.parts):
                made.write(place, inside.as_posix())
    return content.getvalue()
