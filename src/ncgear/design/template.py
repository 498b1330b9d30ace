"""The texts that come with the program: commented design files of ``ncgear new``, and the worked designs as examples.

A new file has a law on the same machine and gears, a whole machine, or a plain pair.  Their texts are
``templates/*.yaml``, apart from the models of the keys, so that ncgear writes a file without loading pydantic.  The
laws of the machines are simple ones whose gears build at once; ``ncgear optimize`` looks for the best law for the same
wishes.

A wheel holds the folder ``designs`` of the repository; from a checkout it is that folder itself.  An example is named
by its path in it without ``.yaml``: ``pusher``, ``balance/threshing-drum``.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from string import Template
from typing import Any

from ncgear.design.laws.registry import DEFAULT_LAW, LawName
from ncgear.design.reading.text import plain_value
from ncgear.errors import WrongInput

TEXTS = Path(__file__).with_name("templates")


class MachineName(StrEnum):
    """The machines, by the names of the command line."""

    PUMP = "pump"
    PUSHER = "pusher"
    PRESS_FEEDER = "press-feeder"
    BALER = "baler"
    DESK_TOY = "desk-toy"


CHOICES = {
    MachineName.PUMP: "a plunger pump: force both ways, a quick return, least power",
    MachineName.PUSHER: "a packaging pusher: even speed, a quick return",
    MachineName.PRESS_FEEDER: "a press feeder: it lingers at its far end",
    MachineName.BALER: "a baler: a steep load, half of a plain crank's power",
    MachineName.DESK_TOY: "a desk toy to print: it lingers at its far end",
}
"""A few words on each machine."""


SHAPES = ("heart", "square", "star")
"""Drawings that come with the program."""


def template(name: str, law: LawName = DEFAULT_LAW, wishes: Mapping[str, Any] | None = None) -> str:
    """A complete design file called ``name``, with a comment on every value.

    ``wishes`` of the motion by their kinds, in the form of a design file; with wishes, the file also has limits for the
    law that keeps them.
    """
    wished = _text("wishes", wishes=_lines(wishes)) if wishes else _text("no_wishes")
    return _head(name) + _text("design", motion=motion_of(law), wishes=wished)


def machine_template(name: str, machine: MachineName) -> str:
    """A complete design file for a machine, called ``name``, with comments: sizes, loads, masses, gears, wishes."""
    return f"{_head(name)}\n{_text(f'machines/{machine}')}"


def choices_template(processes: Sequence[str]) -> str:
    """The group ``choices`` of a design file for the search of whole machines, with comments."""
    return _text("choices", processes=", ".join(processes))


def shape_template(name: str, shape: str) -> str:
    """A complete design file called ``name`` for a printed pair of gears, from a shape or from the file of a drawing.

    Raises WrongInput for any other shape.
    """
    if shape in SHAPES:
        return f"{_head(name)}{_text('shape', drawn=_text(f'shapes/{shape}'), backlash='0.15')}"
    # These modules load the YAML library.
    from ncgear.design.drawn import shape_of_file
    from ncgear.design.rewritten import flow_text

    kind, keys = shape_of_file(shape, "--shape")
    drawn = f"  {kind}: {flow_text(keys)}\n"
    return f"{_head(name)}{_text('shape', drawn=drawn, backlash='0.05')}"


def motion_of(law: LawName) -> str:
    """The group ``motion`` of a new design file, with a comment on every value."""
    return _text(f"laws/{law}")


def _head(name: str) -> str:
    # Names such as 12 or true must not be read as a number or a truth value, and a name of dashes not as a list.
    quoted = name if name[0].isalpha() and isinstance(plain_value(name), str) else f'"{name}"'
    return _text("head", name=name, quoted=quoted)


def _lines(wishes: Mapping[str, Any]) -> str:
    from ncgear.design.rewritten import flow_text

    return "\n".join(f"  {kind}: {flow_text(value)}" for kind, value in wishes.items())


def _text(file: str, **values: str) -> str:
    return Template((TEXTS / f"{file}.yaml").read_text(encoding="utf-8")).substitute(values)


INSTALLED, CHECKOUT = (Path(__file__).parents[number] / "designs" for number in (1, 3))

DESCRIPTION = re.compile(r"^description: *(.+)$", re.MULTILINE)
NAMED_FILE = re.compile(r"\b(?:file|design): *([\w./-]+\.(?:csv|yaml))\b")
OWN_NAME = re.compile(r"^name:.*$", re.MULTILINE)


def examples() -> dict[str, Path]:
    """The files of all examples by their names, in alphabetical order; none if the folder is missing."""
    folder = INSTALLED if INSTALLED.is_dir() else CHECKOUT
    found = {path.relative_to(folder).with_suffix("").as_posix(): path for path in folder.rglob("*.yaml")}
    return dict(sorted(found.items()))


def description_of(path: Path) -> str:
    """An example in its own words: its description, or the comment at its head."""
    text = path.read_text(encoding="utf-8")
    found = DESCRIPTION.search(text)
    if found is not None:
        return found[1].strip().strip('"')
    return " ".join(
        line.removeprefix("#").strip() for line in text[: text.index("\n\n")].splitlines() if line[0] == "#"
    )


def example_files(example: str, name: str | None = None) -> dict[str, bytes]:
    """The files of an example by their paths: the design first, then the files that it names.

    A ``name`` becomes the name of the design.  Raises WrongInput if there is no such example.
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
