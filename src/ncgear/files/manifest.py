"""The manifest of a folder: which files ncgear wrote there, and their contents by SHA-256.

A later run removes or replaces only files that the manifest names and that nobody has changed.  Where another file
has the place of a new file, somebody made or changed it: it is kept beside the new file, as ``law-kept.csv``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from stat import S_ISREG

from ncgear import __version__
from ncgear.errors import WrongInput
from ncgear.files.one_file import REMEDY, is_there, kept_names, refused
from ncgear.files.publish import exchange, is_inside, opened
from ncgear.frozen import dataclass

MANIFEST = "manifest.json"
KEYS = {"ncgear", "files"}
"""The keys of a manifest; other programs have files of this name, too."""


@dataclass(frozen=True)
class ManifestEntry:
    """The command that wrote a file, and the SHA-256 of the written content in hexadecimal digits."""

    command: str
    sha256: str


@dataclass(frozen=True)
class Run:
    """The paths of the files that a run wrote, and of other people's files that it kept beside them under new names."""

    paths: list[Path]
    kept: list[Path]


def publish_run(folder: Path, files: Mapping[str, bytes], command: str) -> Run:
    """Write the files of a command and a manifest into ``folder``; they replace the command's earlier files there.

    A name is plain, or has one folder before it: ``stage-1/law.csv``.  All files change at one instant.  Files that the
    same ``command`` wrote earlier and does not write now are removed.  Raises WrongInput when the folder cannot be
    written, ValueError when a name has another form; in both cases the folder is as it was.
    """
    for name in files:
        # It could lead out of the folder, or into a staging folder.
        if not is_inside(name):
            raise ValueError(f"{name!r} is not a plain file name")
    with opened(folder):
        earlier = entries_in(folder)
        still = {name: earlier[name] for name in _as_written(folder, earlier) if name not in files}
        gone = [name for name, entry in still.items() if entry.command == command]
        others = {name: entry for name, entry in still.items() if name not in gone}
        now = {name: ManifestEntry(command, _digest(content)) for name, content in files.items()}
        written = {**files, MANIFEST: _text({**others, **now})}
        kept = _kept(folder, written, earlier)
        exchange(folder, {**written, **kept}, gone)
    return Run([folder / name for name in written], [folder / name for name in kept])


def publish_named(path: Path, content: bytes, command: str, *, replaces: bool = False) -> Run:
    """Write a single file that a person has named, with an entry where its folder has a manifest of ncgear.

    Another folder gets no manifest.  A file that has the place already is kept there, as ``publish_run`` does,
    unless the new file ``replaces`` it.  Raises WrongInput when the file cannot be written.
    """
    folder, files = path.parent, {path.name: content}
    with refused(folder):
        owned = is_there(folder) and bool(entries_in(folder))
    if owned:
        return publish_run(folder, files, command)
    with opened(folder):
        kept = {} if replaces else _kept(folder, files, {})
        exchange(folder, {**files, **kept})
    return Run([path], [folder / name for name in kept])


def holds_as_written(folder: Path, name: str) -> bool:
    """Whether a folder has a file that ncgear wrote there and nobody has changed since, as far as can be read."""
    with suppress(OSError):
        return name in _as_written(folder, entries_in(folder))
    return False


def entries_in(folder: Path) -> dict[str, ManifestEntry]:
    """The entries of a folder's manifest by the names of files; empty where the manifest has another form.

    Raises OSError where it cannot be read.
    """
    try:
        found = json.loads(_content(folder / MANIFEST) or b"")
        entries = {name: ManifestEntry(**entry) for name, entry in found["files"].items()} if set(found) == KEYS else {}
    except (ValueError, TypeError, AttributeError, RecursionError):
        return {}
    return {name: entry for name, entry in entries.items() if is_inside(name)}


def _content(place: Path) -> bytes | None:
    """The content of a file, None where there is no file; raises OSError where it cannot be read."""
    try:
        return place.read_bytes() if S_ISREG(place.stat().st_mode) else None
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        return None


def _text(entries: Mapping[str, ManifestEntry]) -> bytes:
    files = {name: asdict(entry) for name, entry in sorted(entries.items())}
    return (json.dumps({"ncgear": __version__, "files": files}, indent=2, ensure_ascii=False) + "\n").encode()


def _digest(content: bytes) -> str:
    return sha256(content).hexdigest()


def _as_written(folder: Path, entries: Mapping[str, ManifestEntry]) -> Iterator[str]:
    """The names of files that are in the folder as their entries say."""
    for name, entry in entries.items():
        content = _content(folder / name)
        if content is not None and _digest(content) == entry.sha256:
            yield name


def _kept(folder: Path, files: Mapping[str, bytes], earlier: Mapping[str, ManifestEntry]) -> dict[str, bytes]:
    """Other people's files that have the places of new files, by new names that are free.

    Raises WrongInput where a folder or a link to nothing has such a place.
    """
    kept: dict[str, bytes] = {}
    for name, content in files.items():
        found = _content(folder / name)
        if found is None and is_there(folder / name):
            raise WrongInput(f"cannot be written, because it is no file; {REMEDY}", location=str(folder / name))
        # A manifest with entries is ncgear's own.
        if found is None or found == content or (name == MANIFEST and earlier):
            continue
        if name not in earlier or earlier[name].sha256 != _digest(found):
            names = (path.as_posix() for path in kept_names(Path(name)))
            taken = {*files, *kept}
            kept[next(new for new in names if new not in taken and not os.path.lexists(folder / new))] = found
    return kept
