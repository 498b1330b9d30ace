"""The answer about tolerances: what assemblies do, how many jam, what matters, and which backlash is enough."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate

from ncgear.figures.answers.answer import COLUMNS, Answer, Fault, Row
from ncgear.figures.numbers import to_digits
from ncgear.figures.quantities import figure, name_of
from ncgear.figures.tolerance_words import assumed_words, limit_words
from ncgear.figures.toleranced import (
    NOT_JUDGED,
    index_rows,
    jam_words,
    judged_assemblies,
    knock_words,
    needed_words,
    pair_percentiles,
    percentiles,
)
from ncgear.project.tolerance import Tolerated

HEADS = "as designed", "median", "99 % keep"
SHOWN = "as_designed", "median", "of_99_percent"

ASSUMED = "Assumed, as the file has no section tolerances: "


ROOM = COLUMNS - 30
"""Characters of a line that names, "varies with" and what is between them leave to what a figure varies with."""


def _first(words: str) -> str:
    """As many sources of variance, the greatest first, as a line has room for."""
    named = words.split(", ")
    ends = accumulate(len(one) + len(", ") for one in named)
    return ", ".join(one for one, end in zip(named, ends, strict=True) if end <= ROOM)


def tolerance_answer(tolerated: Tolerated) -> Answer:
    """What assemblies of a design do."""
    told = percentiles(tolerated)
    left_out = ["reversal_play_mm", "transmission_error_rad"]
    columns = []
    if len(tolerated.pairs) > 1:
        left_out += ["least_play_mm", "largest_play_mm"]
        columns = [
            _row(f"stage {pair.stage}: ", "least_play_mm", own["least_play_mm"])
            for pair, own in zip(tolerated.pairs, pair_percentiles(tolerated), strict=True)
        ]
    columns += [_row("", key, values) for key, values in told.items() if key not in left_out]
    errors = [one for pair in tolerated.pairs for one in pair.errors]
    worst = max(errors, key=lambda one: one.error_mm)
    checked = (
        f"linear model off the outlines of {len(errors)} assemblies by "
        f"{to_digits(1e3 * worst.error_mm, 3)} of {to_digits(1e3 * worst.displaced_mm, 3)} \u00b5m"
    )
    play, error = (
        to_digits(1e3 * max(getattr(pair.between, key) for pair in tolerated.pairs), 3)
        for key in ("least_play_mm", "transmission_error_mm")
    )
    between = f"up to {play} \u00b5m less play, {error} \u00b5m more transmission error than at the positions looked at"
    rows = [
        Row("jam", (jam_words(tolerated),)),
        Row("knock", (knock_words(tolerated),)),
        Row("backlash", (needed_words(tolerated),)),
        *(Row(name, (f"varies with {_first(words)}",)) for name, words in index_rows(tolerated)[:3] if words),
        Row("checked", (checked,)),
        Row("between", (between,)),
    ]
    limits = f"{assumed_words(tolerated.process)}{', '.join(limit_words(tolerated.tolerances))}"
    return Answer(
        f"{tolerated.drive.design.name}: {tolerated.assemblies.count} assemblies within their tolerances",
        (*columns, *rows),
        tuple(Fault(one.broken, one.cures) for one in judged_assemblies(tolerated) if one.broken),
        about=f"Tolerances: {limits}" if tolerated.process is None else "",
        notes=() if tolerated.process is None else (f"{ASSUMED}{limits}",),
        heads=HEADS,
        good=f"No warnings of what was judged: {_turning(tolerated)} of the assemblies turn, and none knocks.",
        not_judged=NOT_JUDGED,
        then="tolerance.json has every figure, assemblies.csv every assembly",
    )


def _turning(tolerated: Tolerated) -> str:
    jamming = round(tolerated.jam.value * tolerated.assemblies.count)
    return f"all but {jamming}" if jamming else "all"


def _row(of: str, key: str, values: Mapping[str, float]) -> Row:
    return Row(f"{of}{name_of(key)}", tuple(figure(key, values[name]) for name in SHOWN))
