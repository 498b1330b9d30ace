"""The answer about tolerances: what assemblies do, how many jam, what matters, and which backlash is enough."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate

from ncgear.figures.answers.answer import COLUMNS, Answer, Fault, Row
from ncgear.figures.numbers import fixed, to_digits
from ncgear.figures.quantities import figure, name_of
from ncgear.figures.tolerance_words import assumed_words, limit_words
from ncgear.figures.toleranced import (
    index_rows,
    jam_words,
    knock_words,
    needed_words,
    pair_percentiles,
    percentiles,
)
from ncgear.project.tolerance import Tolerated
from ncgear.project.tolerance_limits import MOST_JAMMED

HEADS = "as designed", "median", "99 % keep"
SHOWN = "as_designed", "median", "of_99_percent"

MOST_OFF = 0.1
"""Error of the linear model, as a share of what flanks are displaced by, from which it is a warning."""

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
            _row(f"stage {pair.drive.stage}: ", "least_play_mm", own["least_play_mm"])
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
        _faults(tolerated),
        about=f"Tolerances: {limits}" if tolerated.process is None else "",
        notes=() if tolerated.process is None else (f"{ASSUMED}{limits}",),
        heads=HEADS,
        good=f"{_turning(tolerated).capitalize()} of the assemblies turn, and none knocks.",
        then="tolerance.json has every figure, assemblies.csv every assembly",
    )


def _turning(tolerated: Tolerated) -> str:
    jamming = round(tolerated.jam.value * tolerated.assemblies.count)
    return f"all but {jamming}" if jamming else "all"


def _row(of: str, key: str, values: Mapping[str, float]) -> Row:
    return Row(f"{of}{name_of(key)}", tuple(figure(key, values[name]) for name in SHOWN))


def _faults(tolerated: Tolerated) -> tuple[Fault, ...]:
    needed, faults = tolerated.needed, []
    if tolerated.jam.value > MOST_JAMMED:
        cures = () if needed is None or needed.jammed is None else (f"gears.{needed.key}: {needed.value:g}",)
        faults.append(Fault(f"{to_digits(100.0 * tolerated.jam.value, 3)} % of the assemblies jam", cures))
    if tolerated.knock is not None and tolerated.knock.value > 0.0:
        share = to_digits(100.0 * tolerated.knock.value, 3)
        faults.append(Fault(f"{share} % of the assemblies knock", ("less backlash, or finer tolerances",)))
    off = max(one.error_mm / max(one.displaced_mm, 1e-12) for pair in tolerated.pairs for one in pair.errors)
    if off > MOST_OFF:
        faults.append(
            Fault(
                f"the linear model is off by up to {fixed(100.0 * off, 0)} %: these tolerances are large for such teeth"
            )
        )
    return tuple(faults)
