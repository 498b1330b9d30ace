"""The assemblies of a design within its tolerances: as JSON, as a table, in words, and as an answer."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate
from typing import Any

import numpy as np

from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import CONDITIONS
from ncgear.figures.answers.answer import COLUMNS, Answer, Fault, Row
from ncgear.figures.data_sheet.entries import assumed_words, limit_words
from ncgear.figures.numbers import STATISTICS, figure, fixed, name_of, to_digits
from ncgear.figures.tables import csv_text
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.project.tolerance import Tolerated
from ncgear.project.tolerance_limits import MOST_JAMMED, TURNING
from ncgear.tolerances.assemblies import Assemblies, PairAssemblies
from ncgear.tolerances.drawn import DeviationSource
from ncgear.tolerances.iso1328 import rounded_um
from ncgear.tolerances.study import PairStudy, Share, enough_samples

OF_GEAR = {"eccentricity": "bore off", "tilt": "bore tilted", "index": "keyway"}
SOURCES = {
    "center_distance": name_of("center_distance_mm"),
    **{f"{key}_{gear}": f"{gear} {words}" for key, words in OF_GEAR.items() for gear in ("driving", "driven")},
    **{name: name for name in ("temperature", "wear", "pitch", "profile")},
}
"""What may deviate, in words."""

PERCENT_HIGH, PERCENT_LOW = 99.0, 1.0


def source_words(source: DeviationSource) -> str:
    """``stage 1 centre distance``, or without its stage where it is of a single pair or of both."""
    return SOURCES[source.name] if source.stage is None else f"{stage_words(source.stage)} {SOURCES[source.name]}"


def stage_words(stage: int | None) -> str:
    """``stage 1``; empty of a single pair."""
    return "" if stage is None else f"stage {stage}"


def assemblies_figures(found: Assemblies, tolerated: Tolerated) -> dict[str, Array]:
    """The figures of the machine in assemblies by keys that end in their units, shape (N,) each.

    Plays and contact ratio are those of the pair in which they are worst.  ``reversal_play_mm`` is left out where the
    torque never turns round, and where no load is known; ``play_max_rad`` of a single pair; ``contact_ratio_min`` where
    all flanks touch at an end of a range.
    """
    place, acceleration = (getattr(tolerated.drive.linkage.OUTPUT, of) for of in ("place", "acceleration"))
    reverses, two = tolerated.knock is not None and tolerated.loaded, len(tolerated.pairs) > 1
    told = _of_flanks(found, reverses, found.play_max_rad if two else None)
    if not np.isfinite(found.least_arc).all():
        del told["contact_ratio_min"]
    told[f"motion_error_{place.ending}"] = place.factor * found.motion_error
    return told | {f"peak_acceleration_{acceleration.ending}": found.peak_acceleration}


def _of_flanks(found: Assemblies | PairAssemblies, reverses: bool, turned_rad: Array | None = None) -> dict[str, Array]:
    """The figures that a machine and a pair have; ``reverses`` tells whether a known load turns the torque round.

    ``turned_rad`` is the play of the last driven gear, where it is told.
    """
    return {
        "least_play_mm": found.least_play_mm,
        "largest_play_mm": found.largest_play_mm,
        **({"reversal_play_mm": found.reversal_play_mm} if reverses else {}),
        **({} if turned_rad is None else {"play_max_rad": turned_rad}),
        "transmission_error_mm": found.transmission_error_mm,
        "transmission_error_rad": found.transmission_error_rad,
        "contact_ratio_min": found.least_arc,
    }


def pair_figures(found: PairAssemblies, of: PairStudy, *, loaded: bool) -> dict[str, Array]:
    """The same figures of one of two pairs, as far as a pair has them; ``loaded`` tells whether any load is known."""
    return _of_flanks(found, of.knock is not None and loaded)


WORST_IS_LEAST = "least_play_mm", "contact_ratio_min"
"""Figures of which little is bad."""


def percentiles(tolerated: Tolerated) -> dict[str, dict[str, float]]:
    """Each figure of the machine as designed, its median, and what 99 of 100 assemblies keep, on the bad side."""
    return _percentiles(*(assemblies_figures(draw, tolerated) for draw in (tolerated.assemblies, tolerated.nominal)))


def pair_percentiles(tolerated: Tolerated) -> list[dict[str, dict[str, float]]]:
    """The same of each pair."""
    loaded = tolerated.loaded
    return [
        _percentiles(*(pair_figures(draw, pair, loaded=loaded) for draw in (pair.assemblies, pair.nominal)))
        for pair in tolerated.pairs
    ]


def _percentiles(told: Mapping[str, Array], nominal: Mapping[str, Array]) -> dict[str, dict[str, float]]:
    return {
        key: {
            "as_designed": float(nominal[key][0]),
            "median": float(np.median(values)),
            "of_99_percent": float(np.percentile(values, PERCENT_LOW if key in WORST_IS_LEAST else PERCENT_HIGH)),
            "least": float(values.min()),
            "largest": float(values.max()),
        }
        for key, values in told.items()
    }


def share_words(share: Share) -> str:
    """``1.2 % (0.9 to 1.6 %)``: the share, and the range of the share of all assemblies with 95 % confidence."""
    value, least, largest = (to_digits(100.0 * end, 3) for end in (share.value, share.least, share.largest))
    return f"{value} % ({least} to {largest} % of all)"


MOST_OFF = 0.1
"""From this error on the linear model is a warning; the error is a share of the displacement of the flanks."""

NOT_JUDGED = "Not judged: all but assembly, knocking and the linear model (ncgear build)"
"""What the answer leaves to the verdict on the machine."""


@dataclass(frozen=True)
class AssembliesJudged:
    """A condition of assemblies: what is true where it is kept, what ``broken`` it, else empty, and what would help."""

    condition: str
    kept: str
    broken: str
    cures: tuple[str, ...] = ()


def judged_assemblies(tolerated: Tolerated) -> list[AssembliesJudged]:
    """The verdict on the assemblies, the most serious condition first."""
    needed, jam, knock = tolerated.needed, tolerated.jam.value, tolerated.knock.value if tolerated.knock else 0.0
    off = max(error.error_mm / max(error.displaced_mm, 1e-12) for pair in tolerated.pairs for error in pair.errors)
    enough = () if needed is None or needed.jammed is None else (f"gears.{needed.key}: {needed.value:g}",)
    jams = f"{to_digits(100.0 * jam, 3)} % of the assemblies jam" if jam > MOST_JAMMED else ""
    knocks = f"{to_digits(100.0 * knock, 3)} % of the assemblies knock" if knock > 0.0 else ""
    large = f"the linear model is off by up to {fixed(100.0 * off, 0)} %: these tolerances are large for such teeth"
    kept = f"the linear model is off by {100.0 * MOST_OFF:g} % at the most"
    return [
        AssembliesJudged(str(Kind.JAMS), CONDITIONS[Kind.JAMS].kept, jams, enough),
        AssembliesJudged("knock", "no assembly knocks", knocks, ("less backlash, or finer tolerances",)),
        AssembliesJudged("linear_model", kept, large if off > MOST_OFF else ""),
    ]


def _verdict(tolerated: Tolerated) -> dict[str, Any]:
    """The verdict in full, in the form of that on a machine."""
    judged = judged_assemblies(tolerated)
    rows = [
        {
            "condition": judgement.condition,
            "stage": None,
            "says": judgement.kept,
            "verdict": "broken" if judgement.broken else "kept",
        }
        | {"because": judgement.broken, "remark": ""}
        for judgement in judged
    ]
    to_change = [f". To change it: {'; or '.join(judgement.cures)}" if judgement.cures else "" for judgement in judged]
    warnings = [
        f"{judgement.broken}{cure}" for judgement, cure in zip(judged, to_change, strict=True) if judgement.broken
    ]
    return {"warnings": warnings, "remarks": [], "verdict": rows}


def tolerance_json(tolerated: Tolerated) -> dict[str, Any]:
    """Everything but the single assemblies; what a pair has by itself under ``stages`` where there are two."""
    needed, single = tolerated.needed, len(tolerated.pairs) == 1
    pair = tolerated.pairs[0]
    return {
        "design": tolerated.drive.design.name,
        "assumed": tolerated.process is not None,
        "process": tolerated.process,
        "tolerances": tolerated.tolerances.model_dump(exclude_none=True),
        **(_grades(pair) if single else {}),
        "assemblies": tolerated.assemblies.count,
        "seed": tolerated.seed,
        "figures": percentiles(tolerated),
        "jam": vars(tolerated.jam),
        "knock": _knock(pair) if single else None if tolerated.knock is None else vars(tolerated.knock),
        "loads_known": tolerated.loaded,
        "backlash_needed": needed
        and {
            "share": TURNING,
            "key": f"gears.{needed.key}",
            "value": needed.value,
            "given": needed.given,
            "jam_with_it": needed.jammed and vars(needed.jammed),
            "refused": needed.refused,
        },
        "indices": {
            name: [{**vars(index), "source": index.source.key} for index in found]
            for name, found in tolerated.indices.items()
        },
        "index_samples": tolerated.index_samples,
        **(_checks(pair) if single else {"stages": _stages(tolerated)}),
        **_verdict(tolerated),
    }


def _stages(tolerated: Tolerated) -> dict[str, Any]:
    """What each of two pairs has by itself."""
    needed = [None] * len(tolerated.pairs) if tolerated.needed is None else tolerated.needed.of_pairs
    return {
        f"stage_{pair.stage}": {
            **_grades(pair),
            "figures": told,
            "jam": vars(pair.jam),
            "knock": _knock(pair),
            "backlash_needed": value,
            **_checks(pair),
        }
        for pair, told, value in zip(tolerated.pairs, pair_percentiles(tolerated), needed, strict=True)
    }


def _grades(pair: PairStudy) -> dict[str, Any]:
    pitch, profile = pair.flank_limits_mm
    return {
        "single_pitch_um": [rounded_um(float(deviation)) for deviation in (pitch.min(), pitch.max())],
        "total_profile_um": [rounded_um(float(deviation)) for deviation in (profile.min(), profile.max())],
    }


def _knock(pair: PairStudy) -> dict[str, Any] | None:
    return None if pair.knock is None else {**vars(pair.knock), "largest_play_mm": pair.knocking_mm}


def _checks(pair: PairStudy) -> dict[str, Any]:
    first = pair.first_order
    return {
        "first_order": {
            "play_deviation_mm": float(first.linear_mm.max()),
            "play_deviation_drawn_mm": float(first.drawn_mm.max()),
            "difference": first.difference,
            "by_source_mm": {source: float(share.max()) for source, share in first.by_source.items()},
        },
        "checked_by_outlines": [vars(error) for error in pair.errors],
        "between_positions": vars(pair.between),
    }


def assemblies_csv(tolerated: Tolerated) -> str:
    """One row for each assembly; of two pairs, the figures of each pair follow the figures of the machine."""
    told = assemblies_figures(tolerated.assemblies, tolerated)
    if len(tolerated.pairs) > 1:
        for pair in tolerated.pairs:
            own = pair_figures(pair.assemblies, pair, loaded=tolerated.loaded)
            told.update({f"stage_{pair.stage}_{key}": values for key, values in own.items()})
    return csv_text(list(told), list(told.values()))


BRIEF = {
    "least_play_mm": "least play",
    "transmission_error_mm": "transm. error",
    "motion_error": "motion error",
    "peak_acceleration": "acceleration",
}
"""What varies, in front of a line."""


def index_rows(tolerated: Tolerated) -> list[tuple[str, str]]:
    """What each figure's variance comes from, the greatest first: the figure's name and a line."""
    return [
        (
            BRIEF[name],
            ", ".join(
                f"{source_words(index.source)} {fixed(100.0 * index.total, 0)} %"
                for index in found
                if index.total >= SMALL
            ),
        )
        for name, found in tolerated.indices.items()
    ]


SMALL = 0.02
"""Share of the variance below which a source is not told."""


def _of(pair: PairStudy) -> str:
    return "" if pair.stage is None else f"{stage_words(pair.stage)}: "


def jam_words(tolerated: Tolerated) -> str:
    """The share of assemblies that jams, and of two pairs the share of each pair."""
    words = share_words(tolerated.jam)
    if len(tolerated.pairs) == 1:
        return words
    parts = (f"{_of(pair)}{to_digits(100.0 * pair.jam.value, 3)} %" for pair in tolerated.pairs)
    return f"{words}; {', '.join(parts)}"


def knock_words(tolerated: Tolerated) -> str:
    """The share that knocks, or why none does."""
    if tolerated.knock is None:
        return "none, since the torque never turns round"
    where = "where the torque turns round" if tolerated.loaded else "anywhere"
    over = [f"{_of(pair)}{to_digits(pair.knocking_mm, 3)} mm" for pair in tolerated.pairs if pair.knock is not None]
    return f"{share_words(tolerated.knock)}: play over {', '.join(over)} {where}"


def needed_words(tolerated: Tolerated) -> str:
    """The backlash that is needed, and what fresh assemblies with it say."""
    needed = tolerated.needed
    if needed is None:
        return f"not told of so few; --samples {_power_of_two(enough_samples(TURNING))} or more is right"
    words = f"99.9 % turn with {needed.value:g} ({needed.given:g} given)"
    if len(tolerated.pairs) > 1:
        parts = zip(tolerated.pairs, needed.of_pairs, strict=True)
        words = f"{words}; {', '.join(f'{_of(pair)}{value:g}' for pair, value in parts)}"
    if needed.jammed is None:
        return f"{words}, but such gears cannot be made"
    return f"{words}; fresh ones: {share_words(needed.jammed)} jam"


def _power_of_two(count: int) -> int:
    return 1 << (count - 1).bit_length()


SHOWN = "as_designed", "median", "of_99_percent"

ASSUMED = "Assumed, as the file has no section tolerances: "

ROOM = COLUMNS - 30
"""Characters of a line that names, "varies with" and what is between them leave to what a figure varies with."""


def _first(words: str) -> str:
    """As many sources of variance, the greatest first, as a line has room for."""
    named = words.split(", ")
    ends = accumulate(len(name) + len(", ") for name in named)
    return ", ".join(name for name, end in zip(named, ends, strict=True) if end <= ROOM)


def tolerance_answer(tolerated: Tolerated) -> Answer:
    """What assemblies of a design do."""
    told = percentiles(tolerated)
    left_out = ["reversal_play_mm", "transmission_error_rad"]
    columns = []
    if len(tolerated.pairs) > 1:
        left_out += ["least_play_mm", "largest_play_mm"]
        columns = [
            _shown_row(f"stage {pair.stage}: ", "least_play_mm", own["least_play_mm"])
            for pair, own in zip(tolerated.pairs, pair_percentiles(tolerated), strict=True)
        ]
    columns += [_shown_row("", key, values) for key, values in told.items() if key not in left_out]
    errors = [error for pair in tolerated.pairs for error in pair.errors]
    worst = max(errors, key=lambda error: error.error_mm)
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
    jamming = round(tolerated.jam.value * tolerated.assemblies.count)
    turning = f"all but {jamming}" if jamming else "all"
    return Answer(
        f"{tolerated.drive.design.name}: {tolerated.assemblies.count} assemblies within their tolerances",
        (*columns, *rows),
        tuple(
            Fault(judgement.broken, judgement.cures) for judgement in judged_assemblies(tolerated) if judgement.broken
        ),
        about=f"Tolerances: {limits}" if tolerated.process is None else "",
        notes=() if tolerated.process is None else (f"{ASSUMED}{limits}",),
        heads=tuple(STATISTICS[key] for key in SHOWN),
        good=f"No warnings of what was judged: {turning} of the assemblies turn, with little play where the torque "
        "turns round.",
        not_judged=NOT_JUDGED,
        then="tolerance.json has every figure, assemblies.csv every assembly",
    )


def _shown_row(of: str, key: str, values: Mapping[str, float]) -> Row:
    return Row(f"{of}{name_of(key)}", tuple(figure(key, values[name]) for name in SHOWN))
