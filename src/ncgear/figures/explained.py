"""The meaning of the keys of a file, as text for people."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from textwrap import fill, wrap

from ncgear.design.told_keys import ToldKey, looked_up
from ncgear.design.words import folded, listed, quantity

WIDTH = 100
PATH_WIDTH, NAME_WIDTH = 36, 13
"""Widths of the first column: in a list of keys by their whole names, and in the explanation of one key."""

MOST_EXPLAINED = 4
"""If a name stands for at most so many different keys, each is explained; otherwise they are listed."""


IDEAS = {
    "standstill": "An exact dwell, in which the slider stands still while the driving gear turns, needs an infinite "
    "ratio, and no gears have one. A near-dwell about an end (wishes.dwell) comes near, where the ratio is large. "
    "Gears follow ratios up to 5 or so well.",
    "closure": "The cycle closes where the driven gear has turned by whole lobes when the driving gear has; otherwise "
    "the gears would not fit at the next turn. For ratio_expression and table, scale_to_close: true multiplies the "
    "ratio by the constant that closes it; three_segment_stroke closes it with its return.",
    "contact_ratio": "How many pairs of flanks touch on average over the cycle (contact_ratio_mean); under 1 the teeth "
    "lose each other. contact_ratio_min is the least contact of any pair of flanks, in pitches. Both count flanks that "
    "touch: tip relief, shortened tips and sloped lands count as they are. They are of the pushing or of the back side "
    "of the teeth, whichever is worse. They are computed, not given: a greater addendum or a smaller pressure angle of "
    "the rack (gears.rack), less tip relief, or more teeth of a smaller module raise them.",
    "transmission_error": "By how much the driven gear's angle departs from the law. It is computed, not given: "
    "contact.transmission_error_rad in summary.json.",
    "dead_centre": "The two ends of the slider's way: retracted at phi1 = 0, extended at theta4 of the law "
    "three_segment_stroke, or wherever else the ratio leads. Displacements count from the retracted one.",
    "mass": "What moves, and how heavy it is, stands in the section masses: slider_kg, rod and crank with "
    "mass_kg, center_mm and inertia_kg_mm2, a flywheel, gravity; `ncgear explain masses` tells of it. The gears' "
    "own masses follow from their bodies and masses.density_kg_m3.",
    "quick_return": "A way back that takes less time than the way out. wishes.time_ratio asks for the time of the"
    " working stroke over that of the return, wishes.working_stroke for the driving angle of the working stroke; "
    "`ncgear optimize` finds the law. The law three_segment_stroke has its return in motion.return; the linkage "
    "slotted_lever returns quickly by itself.",
}
"""Ideas that people look for, and which no key has by name."""


def told(keys: Sequence[ToldKey], asked: str) -> str:
    """The explanation of a key or an idea; raises WrongInput for a word that is neither."""
    words = re.sub(r"[\s-]+", "_", asked.strip().lower()).replace("center", "centre")
    idea = IDEAS.get(words) or IDEAS.get(words.removesuffix("s"))
    if idea is not None:
        return f"{asked} (no key)\n{fill(idea, WIDTH, initial_indent='  ', subsequent_indent='  ')}"
    names, singular = {key.name for key in keys}, words.removesuffix("s")
    return explained(keys, looked_up(keys, singular if singular in names and words not in names else asked))


def explained(keys: Sequence[ToldKey], found: Sequence[ToldKey]) -> str:
    """The explanation of the keys ``found`` in the order of the file, or a list of them where they are many.

    ``keys`` are all keys of the file.
    """
    ordered = sorted(found, key=_same)
    alike = [list(group) for _, group in groupby(ordered, _same)]
    alike.sort(key=lambda group: keys.index(group[0]))
    if len(alike) > MOST_EXPLAINED:
        lines = [_entry(group[0].path, group[0].meaning, PATH_WIDTH) for group in alike]
        return "\n".join([f"{len(alike)} keys; one of them by its whole name:", *lines])
    return "\n\n".join(_one(keys, group) for group in alike)


def tree(keys: Sequence[ToldKey]) -> str:
    """All groups with their meanings, and the keys in each."""
    return "\n".join(_level(keys, "", 0))


def _same(key: ToldKey) -> tuple[str, str, str]:
    """A key to sort by; equal for one key of several laws, one angle in all its units, and the names of laws."""
    path = key.path.removesuffix(key.name)
    return path, quantity(key.name), "" if key.is_law_name or quantity(key.name) != key.name else key.meaning


def _one(keys: Sequence[ToldKey], alike: Sequence[ToldKey]) -> str:
    first, names = alike[0], list(dict.fromkeys(key.path for key in alike))
    rows = {
        "unit": "" if first.is_group else listed(dict.fromkeys(key.unit for key in alike)),
        "value": listed(dict.fromkeys(key.allowed for key in alike)),
        "default": "only one of them can be given" if _is_angle(alike) else first.default,
        "laws": listed(dict.fromkeys(key.law for key in alike if key.law), "and"),
        "keys": listed(folded(key.name for key in keys if _is_in(key, first)), "and"),
        "example": alike[-1].example,
        "beside it": listed(folded(key.name for key in _beside(keys, alike)), "and"),
    }
    meaning = fill(_meaning(keys, alike), WIDTH, initial_indent="  ", subsequent_indent="  ")
    return "\n".join(
        [listed(names), meaning, "", *(_entry(name, text, NAME_WIDTH) for name, text in rows.items() if text)]
    )


def _meaning(keys: Sequence[ToldKey], alike: Sequence[ToldKey]) -> str:
    """The meaning of the keys: for an angle, without its unit; for the key ``law``, the meaning of its group."""
    first = alike[0]
    if not first.is_law_name:
        return first.meaning.replace(", in rad", "").replace(" in rad", "") if _is_angle(alike) else first.meaning
    return next(key.meaning for key in keys if key.path == _above(first))


def _is_angle(alike: Sequence[ToldKey]) -> bool:
    return len({key.name for key in alike}) > 1


def _above(key: ToldKey) -> str:
    return key.path.rpartition(".")[0]


def _is_in(key: ToldKey, group: ToldKey) -> bool:
    """Whether a key is in a group; of trains, in the group of a kind that has both."""
    return _above(key) == group.path and (not group.kinds or not set(group.kinds).isdisjoint(key.kinds))


def _beside(keys: Sequence[ToldKey], alike: Sequence[ToldKey]) -> list[ToldKey]:
    above, law, names = _above(alike[0]), alike[0].law, {key.name for key in alike}
    within = [key for key in keys if _above(key) == above and key.law == law]
    having = {key.path: {kind for other in within if other.path == key.path for kind in other.kinds} for key in within}
    within = [key for key in within if having[key.path].issuperset(alike[0].kinds)]
    return [] if alike[0].is_law_name else [key for key in within if key.name not in names]


def _entry(name: str, text: str, column: int) -> str:
    first, *more = wrap(text, WIDTH - column, break_on_hyphens=False) or [""]
    return "\n".join([f"  {name:<{column - 3}} {first}".rstrip(), *(" " * column + line for line in more)])


def _level(keys: Sequence[ToldKey], above: str, depth: int) -> Iterator[str]:
    """The keys of a group, law by law where they belong to laws, and the groups in it."""
    own = [key for key in keys if _above(key) == above]
    for law, of_law in groupby(own, lambda key: key.law):
        members = list(of_law)
        plain = ", ".join(folded(key.name for key in members if not key.is_group and not key.is_law_name))
        title = law if any(key.is_law_name for key in members) else ""
        if plain or title:
            yield _indented(": ".join(part for part in (title, plain) if part), depth)
    for key in {key.path: key for key in own if key.is_group}.values():
        yield _indented(f"{key.name}: {key.meaning}", depth)
        yield from _level(keys, key.path, depth + 1)


def _indented(text: str, depth: int) -> str:
    space = "  " * depth
    return fill(text, WIDTH, initial_indent=space, subsequent_indent=space + "    ", break_on_hyphens=False)
