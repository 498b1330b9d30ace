"""The text of a design while it is edited: changes of keys, history, and the difference from the file.

The text is always the text of the design file, so its comments and their order stay, and ``ncgear check`` would read
exactly what the page shows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from difflib import SequenceMatcher, unified_diff
from itertools import accumulate
from pathlib import Path
from typing import Any

from ruamel.yaml.error import YAMLError

from ncgear.design.beginning import begun, fault_of
from ncgear.design.laws.registry import LawName
from ncgear.design.mechanisms import MECHANISMS, NO_LINKAGE
from ncgear.design.reading.design_file import LoadedTrain, as_it_is
from ncgear.design.reading.places import Document, with_value
from ncgear.design.reading.text import whole
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.rewritten import BREAK, document_of, rewritten
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.project.drive import Drive
from ncgear.project.opened import drive_like

MOST_STEPS = 500
"""Most steps that can be undone; with texts of some kilobytes they take a megabyte or two."""


MOST_PAIRS = 1_000_000
"""Most pairs of lines that are compared to find line ends: a thousand changed lines, half a second."""

MOST_CHARACTERS = 16_000_000
"""Most characters of all steps together; with texts of a megabyte, fewer steps can be undone."""
DIGITS = 7
"""Significant digits of the lengths of another mechanism, which scale with the length of the crank."""


@dataclass(frozen=True)
class TextHistory:
    """The text that is shown, the texts before it, and the texts that were undone."""

    now: str
    past: tuple[str, ...] = ()
    future: tuple[str, ...] = ()

    def kept(self, text: str) -> TextHistory:
        """The history with one more step; a text that is shown already adds no step."""
        if text == self.now:
            return self
        past = (*self.past, self.now)[-MOST_STEPS:]
        fitting = sum(total <= MOST_CHARACTERS for total in accumulate(len(text) for text in reversed(past)))
        return TextHistory(text, past[len(past) - fitting :])

    def undone(self) -> TextHistory:
        """The history one step back; the same history where there is no step."""
        if not self.past:
            return self
        return TextHistory(self.past[-1], self.past[:-1], (self.now, *self.future))

    def redone(self) -> TextHistory:
        """The history one step forward; the same history where there is no step."""
        if not self.future:
            return self
        return TextHistory(self.future[0], (*self.past, self.now), self.future[1:])


def difference(old: str, new: str, name: str, old_is: str = "saved") -> str:
    """The lines that differ, in the form of ``diff -u``; empty where no line differs."""
    names = f"{name} ({old_is})", f"{name} (edited)"
    return "\n".join(unified_diff(old.splitlines(), new.splitlines(), *names, lineterm="", n=2))


@contextmanager
def in_its_place(key: str) -> Iterator[None]:
    """A context that turns a value without a place into an error in words of the design file."""
    try:
        yield
    except WrongInput as error:
        raise WrongInput(f"the text {error.problem}; mend the text first", key=key) from error
    except (YAMLError, AttributeError, TypeError, ValueError, LookupError, RecursionError) as error:
        raise WrongInput("the text has no place for this value; mend the text first", key=key) from error


def edited(text: str, changes: Mapping[str, Any]) -> str:
    """The text with other values at some dotted keys; None leaves a key out.

    A number in a key is the index of an item in a list (``motion.ratio.3``).  Another law or mechanism replaces its
    whole group.  Raises WrongInput where the text has no such places.
    """
    with in_its_place(next(iter(changes), "")):
        return rewritten(text, values_of(text, changes))


def in_line_ends_of(before: str, text: str) -> str:
    """A text typed on the page, where lines end in one way, with the line ends of the text before it."""
    ends = BREAK.findall(before)
    if "\r" in text or set(ends) <= {"\n"}:
        return text
    lines, former = text.split("\n"), BREAK.split(before)
    own = _counterparts(former, lines)
    # A line without a counterpart in the file, or with the file's last line, ends as the first line does.
    last = len(ends)
    ended = [line + ends[own.get(place, last) % last] for place, line in enumerate(lines[:-1])]
    return "".join(ended) + lines[-1]


def _counterparts(former: list[str], lines: list[str]) -> dict[int, int]:
    """The numbers of lines in a former text; a changed part that is too long to compare quickly has none."""
    least = min(len(former), len(lines))
    same = next((place for place in range(least) if former[place] != lines[place]), least)
    left = least - same
    ending = next((back for back in range(left) if former[-1 - back] != lines[-1 - back]), left)
    kept = {place: place for place in range(same)}
    kept |= {len(lines) - 1 - back: len(former) - 1 - back for back in range(ending)}
    old, new = (text[same : len(text) - ending] for text in (former, lines))
    if len(old) * len(new) > MOST_PAIRS:
        return kept
    alike = SequenceMatcher(None, old, new, autojunk=False).get_matching_blocks()
    return kept | {same + block.b + step: same + block.a + step for block in alike for step in range(block.size)}


def values_of(text: str, changes: Mapping[str, Any]) -> dict[str, Any]:
    """The changes as values by dotted keys; another law or mechanism becomes the group of its keys."""
    values: dict[str, Any] = {}
    for key, value in changes.items():
        if key == "motion.law":
            values |= _another_law(text, value)
        elif key == "linkage.kind":
            values |= _another_mechanism(text, value)
        else:
            values[key] = _written(value)
    return values


def with_values(document: Document, values: Mapping[str, Any]) -> Document:
    """A document with other values by dotted keys; raises WrongInput where it has no place for a value."""
    for key, value in values.items():
        with in_its_place(key):
            document = replace(document, data=with_value(document.data, key, value))
    return document


def _written(value: Any) -> Any:
    """A value as a file writes it: whole numbers without a point."""
    if isinstance(value, float):
        return whole(value)
    return [_written(item) for item in value] if isinstance(value, list) else value


def _another_law(text: str, name: Any) -> dict[str, Any]:
    """The group ``motion`` of another law, scaled to the machine of the text."""
    if name not in tuple(LawName):
        raise WrongInput(f"{name!r} given; a law of ncgear is right", key="motion.law")
    document = document_of(text)
    crank = document.at("linkage.crank_mm")
    answers = {"crank_mm": crank} if fault_of("crank_mm", crank) is None else {}
    return {"motion": read_yaml(begun("new", LawName(name), answers), "template").at("motion")}


def _another_mechanism(text: str, name: Any) -> dict[str, Any]:
    """The group ``linkage`` of another mechanism with the same crank; groups of other keys are removed."""
    if name not in MECHANISMS:
        raise WrongInput(f"{name!r} given; a mechanism of ncgear is right", key="linkage.kind")
    if name == NO_LINKAGE:
        return {"linkage": None, "fit": None, "masses": None, "resistance": None, "wishes": None, "optimize": None}
    document = document_of(text)
    own = document.at("linkage.crank_mm") or document.at("linkage.radius_mm") or 40
    unit = float(own) if isinstance(own, int | float) else 40.0
    lengths = {key: whole(float(f"{share * unit:.{DIGITS}g}")) for key, share in MECHANISMS[name].proportions.items()}
    usual = name == next(iter(MECHANISMS))
    values: dict[str, Any] = {"linkage": lengths if usual else {"kind": name, **lengths}}
    old = document.at("linkage.kind") or next(iter(MECHANISMS))
    before, after = (MECHANISMS.get(mechanism) for mechanism in (old, name))
    for group in ("masses", "resistance", "wishes"):
        if before is None or after is None or getattr(before, group) is not getattr(after, group):
            values[group] = None
    return values


class ChangingText:
    """A text whose values change again and again."""

    def __init__(self) -> None:
        self._text: str | None = None
        self._document = Document(None, {})
        self._drive: Drive | None = None

    def made(self, text: str, changes: Mapping[str, Any], path: Path) -> Drive | LoadedTrain:
        """The drive, or the train, of a text with changes by key; a fault names the line of the text."""
        if text != self._text:
            self._document, self._text = read_yaml(text, str(path)), text
        loaded = as_it_is(text, path, with_values(self._document, values_of(text, changes)))
        if isinstance(loaded, LoadedTrain):
            return loaded
        before = self._drive
        self._drive = drive_like(before, loaded.design, loaded) if before else Drive(loaded.design, loaded=loaded)
        return self._drive


def lacking(text: str, changes: Mapping[str, Any], path: Path) -> dict[str, str]:
    """The keys that ``changes`` remove but that the text needs, each with the words of the fault without it.

    Only faults count that the text does not have with the keys.  If all keys can be removed together, none is returned;
    otherwise each key is tried by itself.  Raises WrongInput where the text cannot be read, or has no place for a
    change.
    """
    emptied = [key for key, value in changes.items() if value is None]
    if not emptied:
        return {}
    document = read_yaml(text, str(path))
    kept = {key: value for key, value in changes.items() if value is not None}
    before = with_values(document, values_of(text, kept))

    def fault_without(*keys: str) -> str:
        known = _faults(before, text, path)
        after = _faults(with_values(before, values_of(text, dict.fromkeys(keys))), text, path)
        return next((problem for key, problem in after.items() if known.get(key) != problem), "")

    if not fault_without(*emptied):
        return {}
    return {key: problem for key in emptied if (problem := fault_without(key))}


def _faults(document: Document, text: str, path: Path) -> dict[str, str]:
    """The faults of a design by their keys."""
    try:
        as_it_is(text, path, document)
    except WrongInput as error:
        return {fault.key: fault.problem for fault in (error, *error.others)}
    return {}
