"""The worked designs that come with the program, as examples: their names, what they are, and their files.

A wheel holds the folder ``designs`` of the repository; from a checkout it is that folder itself.  An example is named
by its path in it without ``.yaml``: ``pusher``, ``balance/threshing-drum``.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from ncgear.errors import WrongInput

INSTALLED, CHECKOUT = (Path(__file__).parents[number] / "designs" for number in (1, 3))

DESCRIPTION = re.compile(r"^description: *(.+)$", re.MULTILINE)
NAMED_FILE = re.compile(r"\b(?:file|design): *([\w./-]+\.(?:csv|yaml))\b")
OWN_NAME = re.compile(r"^name:.*$", re.MULTILINE)


def examples() -> dict[str, Path]:
    """The files of all examples by their names, in alphabetical order; none where the folder is missing."""
    folder = INSTALLED if INSTALLED.is_dir() else CHECKOUT
    found = {path.relative_to(folder).with_suffix("").as_posix(): path for path in folder.rglob("*.yaml")}
    return dict(sorted(found.items()))


def description_of(path: Path) -> str:
    """What an example is, in its own words: its description, or the comment at its head."""
    text = path.read_text(encoding="utf-8")
    found = DESCRIPTION.search(text)
    if found is not None:
        return found[1].strip().strip('"')
    return " ".join(
        line.removeprefix("#").strip() for line in text[: text.index("\n\n")].splitlines() if line[0] == "#"
    )


def example_files(example: str, name: str | None = None) -> dict[str, bytes]:
    """The files of an example by their paths, that of the design first: it, and those that it names.

    With a ``name`` the design has that one.  Raises WrongInput for an example that there is not.
    """
    known = examples()
    if example not in known:
        raise WrongInput(f"{example!r} is no example{_meant(example, known)}", key="--example")
    text = known[example].read_text(encoding="utf-8")
    place = Path(f"{example}.yaml")
    if name is not None:
        place, text = place.with_name(f"{name}.yaml"), OWN_NAME.sub(f'name: "{name}"', text, count=1)
    files = {place.as_posix(): text.encode()}
    for named in dict.fromkeys(NAMED_FILE.findall(text)):
        files[os.path.normpath(place.parent / named)] = (known[example].parent / named).read_bytes()
    return files


def _meant(example: str, known: dict[str, Path]) -> str:
    from difflib import get_close_matches

    close = get_close_matches(example, known, n=1)
    return f"; did you mean {close[0]}?" if close else "; `ncgear examples` lists all"
