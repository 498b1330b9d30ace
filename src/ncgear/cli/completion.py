"""What the shell offers while a command is being typed."""

from __future__ import annotations

from pathlib import Path

import typer

SUFFIXES = (".yaml", ".yml")


def files_to_complete(incomplete: str) -> list[str]:
    """Design files and folders whose path begins with what is typed; hidden ones only once a dot is."""
    typed = Path(incomplete)
    folder, start = (typed, "") if incomplete.endswith("/") or not incomplete else (typed.parent, typed.name)
    if not folder.is_dir():
        return []
    found = [place for place in sorted(folder.iterdir()) if place.name.startswith(start or _not_hidden(place))]
    return [f"{place}/" if place.is_dir() else str(place) for place in found if _wanted(place)]


def _not_hidden(place: Path) -> str:
    """A start that no hidden file has."""
    return "\0" if place.name.startswith(".") else ""


def _wanted(place: Path) -> bool:
    return place.is_dir() or place.suffix in SUFFIXES


def keys_to_complete(context: typer.Context, incomplete: str) -> list[str]:
    """Keys of the kind of file that is asked about, by their whole path or their last part."""
    from ncgear.cli.schema import FileKind, model_of
    from ncgear.design.reference.keys import keys_of

    keys = keys_of(model_of(FileKind(context.params.get("of") or FileKind.DESIGN)))
    words = dict.fromkeys(word for key in keys for word in (key.path, key.name))
    return [word for word in words if word.startswith(incomplete)]
