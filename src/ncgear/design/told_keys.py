"""The keys of files in words, for ``ncgear explain`` and the shell, without the models of the keys.

``told_keys.json`` holds them; ``python -m made`` writes it from the models by ``design/reference.py``, and
``tests/test_explain.py`` compares the two.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

from ncgear.design.words import spellings
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.units import label_and_unit

FILE = Path(__file__).with_suffix(".json")


@dataclass(frozen=True)
class ToldKey:
    """A key in words; ``law`` is the motion law that has it, empty for a key of no single law.

    ``path`` is dotted, without the numbers of list items; ``kinds`` are the kinds of trains that have such a key.
    """

    path: str
    law: str
    meaning: str
    is_group: bool
    is_law_name: bool
    unit: str
    allowed: str
    default: str
    example: str
    kinds: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition(".")[2]


def told_keys(kind: str) -> list[ToldKey]:
    """All keys of a kind of file, ``design`` or ``balance``, a group before its keys."""
    return [ToldKey(**row) for row in json.loads(FILE.read_text(encoding="utf-8"))[kind]]


MOST_GUESSES = 3


def looked_up(keys: Sequence[ToldKey], asked: str) -> list[ToldKey]:
    """The keys that match best: by the whole path, else by its last parts, with their unit or without.

    A word that names no quantity finds the keys whose meaning has that word.  ``asked`` may have numbers of list items,
    as messages do.  Raises WrongInput for an unknown key; the message names the keys that a person may have meant.
    """
    wanted = ".".join(part for part in asked.strip().replace(" ", "_").split(".") if not part.isdigit())
    whole = [key for key in keys if key.path == wanted]
    named = _ending_in(keys, (wanted,)) or _ending_in(keys, spellings(wanted))
    without_unit = [key for key in keys if f".{_quantity(key.path)}".endswith(f".{wanted.lower()}")]
    found = whole or [key for key in keys if key in named or key in without_unit]
    found = found or _meaning(keys, wanted.replace("_", " "))
    if not found:
        raise WrongInput(_unknown(keys, wanted), key=asked)
    return found


def _ending_in(keys: Sequence[ToldKey], names: Sequence[str]) -> list[ToldKey]:
    return [key for key in keys if any(f".{key.path}".endswith(f".{name}") for name in names)]


def _quantity(path: str) -> str:
    """``motion.v2`` for ``motion.v2_mm_s``: a path without the unit at its end."""
    above, dot, name = path.rpartition(".")
    return f"{above}{dot}{label_and_unit(name)[0].replace(' ', '_')}"


LEAST_WORD = 3
"""Fewest letters of a word that is searched in the meanings of keys."""


def _meaning(keys: Sequence[ToldKey], words: str) -> list[ToldKey]:
    """The keys with these words in their meaning, in singular or plural."""
    if len(words) < LEAST_WORD:
        return []
    pattern = re.compile(rf"\b{re.escape(words)}s?\b", re.IGNORECASE)
    return [key for key in keys if pattern.search(key.meaning)]


def _unknown(keys: Sequence[ToldKey], wanted: str) -> str:
    """The message about an unknown key: another kind of file that has it, or keys with like beginning or spelling."""
    for kind, rows in json.loads(FILE.read_text(encoding="utf-8")).items():
        if any(f".{row['path']}".endswith(f".{wanted}") for row in rows):
            return f"unknown key here; `ncgear explain {wanted} --of {kind}` tells it"
    begun = [key.path for key in keys if key.name.startswith(f"{wanted.lower()}_")]
    by_name = {key.name: key.path for key in reversed(keys)}
    by_quantity = {_quantity(name): path for name, path in by_name.items() if label_and_unit(name)[1]}
    known = {**by_quantity, **by_name, **{key.path: key.path for key in keys}}
    from difflib import get_close_matches

    close = [known[word] for word in get_close_matches(wanted.lower(), known, n=MOST_GUESSES)]
    meant = list(dict.fromkeys([*begun, *close]))[:MOST_GUESSES]
    hint = f"did you mean {' or '.join(meant)}?" if meant else "`ncgear explain` lists all keys"
    return f"unknown key; {hint}"
