"""The keys that a person may mean: a dotted key, its last parts, or a quantity without its unit."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches

from ncgear.design.angles import spellings
from ncgear.design.reference.keys import Key
from ncgear.errors import WrongInput

MOST_GUESSES = 3


def looked_up(keys: Sequence[Key], asked: str) -> list[Key]:
    """The keys of the most exact match: the whole path, else its last parts, else an angle in any of its units.

    ``asked`` may have the numbers of list items, as messages name them.  Raises WrongInput for an unknown key, with
    those that it may have been meant to be.
    """
    wanted = ".".join(part for part in asked.split(".") if not part.isdigit())
    whole = [key for key in keys if key.path == wanted]
    found = whole or _ending_in(keys, (wanted,)) or _ending_in(keys, spellings(wanted))
    if not found:
        raise WrongInput(_unknown(keys, wanted), key=asked)
    return found


def _ending_in(keys: Sequence[Key], names: Sequence[str]) -> list[Key]:
    return [key for key in keys if any(f".{key.path}".endswith(f".{name}") for name in names)]


def _unknown(keys: Sequence[Key], wanted: str) -> str:
    """Paths whose last part begins with the word asked for, then those of which a part, or the whole, is like it."""
    begun = [key.path for key in keys if key.name.startswith(f"{wanted.lower()}_")]
    by_name = {key.name: key.path for key in keys}
    by_quantity = {name.rpartition("_")[0]: path for name, path in by_name.items() if "_" in name}
    known = {**by_quantity, **by_name, **{key.path: key.path for key in keys}}
    close = [known[word] for word in get_close_matches(wanted, known, n=MOST_GUESSES)]
    meant = list(dict.fromkeys([*begun, *close]))[:MOST_GUESSES]
    hint = f"did you mean {' or '.join(meant)}?" if meant else "`ncgear explain` lists all keys"
    return f"unknown key; {hint}"
