"""Several files of a folder are exchanged for new ones at one instant, although a file system moves one at a time.

Every name first becomes a symbolic link through one pointer to a copy of its old file; then the pointer is turned to
the new files, in one move; then the files themselves take the places of the links.  At each moment every name leads to
the old file or every name to the new one, and whoever comes after a killed run can finish the last step.

    folder/a.csv -> .staging/current/a.csv        .staging/current -> old, then new
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

OLD, NEW = "old", "new"
_POINTER, _LINK = "current", "link"


def exchange(folder: Path, staging: Path, names: Iterable[str]) -> None:
    """Show the files of ``staging/new`` at their places in ``folder``, and none at the places of other ``names``.

    ``staging`` lies in ``folder``, with copies in ``staging/old`` of the files that are to go; ``names`` may have
    folders in them, which exist.  Raises OSError when something is in the way: then the old files are shown.  Either
    way ``settle`` must follow.  Where the file system has no symbolic links the files are moved one by one; a run that
    is killed in between, and only that, leaves some of both there.
    """
    try:
        _point(staging, OLD)
    except (OSError, NotImplementedError):
        _exchange_one_by_one(folder, staging, list(names))
    else:
        _exchange_linked(folder, staging, names)


def settle(folder: Path, staging: Path) -> None:
    """Put files into the places of all links that an exchange has left, or remove links to nothing."""
    for name in _names_in(staging):
        place = folder / name
        if not _leads_into(place, staging):
            continue
        if place.exists():
            place.resolve().replace(place)
        else:
            place.unlink()


def _exchange_linked(folder: Path, staging: Path, names: Iterable[str]) -> None:
    link = staging / _LINK
    for name in names:
        link.symlink_to(os.path.relpath(staging / _POINTER / name, (folder / name).parent))
        link.replace(folder / name)
    _point(staging, NEW)


def _point(staging: Path, side: str) -> None:
    """Turn the pointer to one side, in a single move."""
    link = staging / _LINK
    link.symlink_to(side, target_is_directory=True)
    link.replace(staging / _POINTER)


def _names_in(staging: Path) -> Iterator[str]:
    """Relative paths of all files on both sides."""
    for side in (staging / OLD, staging / NEW):
        # Listed before any is settled, for then they leave.
        yield from [str(place.relative_to(side)) for place in sorted(side.rglob("*")) if not place.is_dir()]


def _leads_into(place: Path, staging: Path) -> bool:
    return place.is_symlink() and staging.name in place.readlink().parts


def _exchange_one_by_one(folder: Path, staging: Path, names: list[str]) -> None:
    done: list[str] = []
    try:
        for name in names:
            _put(staging / NEW / name, folder / name)
            done.append(name)
    except BaseException:
        for name in done:
            _put(staging / OLD / name, folder / name)
        raise


def _put(file: Path, place: Path) -> None:
    """Move a file to a place; where there is no such file the place becomes empty."""
    if file.exists():
        file.replace(place)
    else:
        place.unlink(missing_ok=True)
