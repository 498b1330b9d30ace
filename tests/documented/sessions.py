"""Console blocks: commands behind ``$``, what they print below them; ``...`` stands for anything, as in doctest."""

from __future__ import annotations

import doctest
from dataclasses import dataclass

PROMPT = "$ "
CONTINUED = "> "

CHECKER = doctest.OutputChecker()


@dataclass(frozen=True, slots=True)
class Step:
    """One command and what the page says that it prints."""

    command: str
    shown: str


def steps_of(text: str) -> list[Step]:
    """The commands of a console block, each with the lines below it."""
    if not text.startswith(PROMPT):
        raise AssertionError(f"a console block begins with {PROMPT!r}, not with {text.splitlines()[0]!r}")
    return [_step(part.splitlines()) for part in f"\n{text}".split(f"\n{PROMPT}")[1:]]


def _step(lines: list[str]) -> Step:
    command = [lines[0]]
    rest = lines[1:]
    while rest and rest[0].startswith(CONTINUED):
        command.append(rest.pop(0).removeprefix(CONTINUED))
    return Step("\n".join(command), as_shown("\n".join(rest)))


def as_shown(text: str) -> str:
    """Text as a page can show it: without spaces at ends of lines and empty lines at its end."""
    return "\n".join(line.rstrip() for line in text.splitlines()).rstrip("\n")


def differs(shown: str, printed: str) -> bool:
    """Whether what was printed is not what is shown."""
    return not CHECKER.check_output(f"{shown}\n", f"{as_shown(printed)}\n", doctest.ELLIPSIS)
