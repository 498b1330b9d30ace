"""The assemblies of a design within its tolerances: as JSON, as a table, and as text with every figure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.figures.csv_text import csv_text
from ncgear.figures.numbers import fixed, to_digits
from ncgear.figures.quantities import figure, name_of
from ncgear.figures.tables import aligned
from ncgear.figures.terminal import written_lines
from ncgear.numerics.arrays import Array
from ncgear.project.tolerance import TURNING, Tolerated
from ncgear.tolerances.assemblies import Assemblies
from ncgear.tolerances.drawn import MADE_C
from ncgear.tolerances.iso1328 import rounded_um
from ncgear.tolerances.study import Share

SOURCES = {
    "center_distance": "centre distance",
    "eccentricity_driving": "driving bore off",
    "eccentricity_driven": "driven bore off",
    "tilt_driving": "driving bore tilted",
    "tilt_driven": "driven bore tilted",
    "index_driving": "driving keyway",
    "index_driven": "driven keyway",
    "temperature": "temperature",
    "wear": "wear",
    "pitch": "pitch",
    "profile": "profile",
}
"""What may deviate, in words."""

PERCENT_HIGH, PERCENT_LOW = 99.0, 1.0


def figures_of(found: Assemblies, tolerated: Tolerated) -> dict[str, Array]:
    """The figures of assemblies by keys that end in their units, shape (N,) each.

    ``reversal_play_mm`` is left out where the torque never turns round, and where no load is known.
    """
    output = tolerated.drive.linkage.OUTPUT
    told = {
        "least_play_mm": found.least_play_mm,
        "largest_play_mm": found.largest_play_mm,
        "reversal_play_mm": found.reversal_play_mm,
        "transmission_error_mm": found.transmission_error_mm,
        "transmission_error_rad": found.transmission_error_rad,
        "contact_ratio_min": found.least_arc,
        f"motion_error_{output.place.ending}": output.place.factor * found.motion_error,
        f"peak_acceleration_{output.acceleration.ending}": found.peak_acceleration,
    }
    if tolerated.knock is None or not tolerated.loaded:
        del told["reversal_play_mm"]
    return told


def worst_is_least(key: str) -> bool:
    """Whether little of a figure is bad."""
    return key in ("least_play_mm", "contact_ratio_min")


def percentiles(tolerated: Tolerated) -> dict[str, dict[str, float]]:
    """Each figure as designed, its median, and what 99 of 100 assemblies keep, on the side that is bad."""
    nominal = figures_of(tolerated.nominal, tolerated)
    return {
        key: {
            "as_designed": float(nominal[key][0]),
            "median": float(np.median(values)),
            "of_99_percent": float(np.percentile(values, PERCENT_LOW if worst_is_least(key) else PERCENT_HIGH)),
            "least": float(values.min()),
            "largest": float(values.max()),
        }
        for key, values in figures_of(tolerated.assemblies, tolerated).items()
    }


def share_words(share: Share) -> str:
    """``1.2 % (0.9 to 1.6 %)``: the share, and where that of all assemblies lies with 95 % confidence."""
    value, least, largest = (to_digits(100.0 * one, 3) for one in (share.value, share.least, share.largest))
    return f"{value} % ({least} to {largest} % of all)"


def limit_words(tolerated: Tolerated) -> list[str]:
    """What deviates, by its largest value."""
    limits, given = tolerated.lot.limits, tolerated.tolerances
    driving, driven = given.driving, given.driven
    words = [
        f"centre distance \u00b1{limits.center_distance_mm:g} mm" if limits.center_distance_mm else "",
        _both("bores off by {} mm", driving.eccentricity_mm, driven.eccentricity_mm),
        _both("tilted by {} deg", driving.tilt_deg, driven.tilt_deg),
        _both("keyways \u00b1{} deg", driving.index_deg, driven.index_deg),
        _both("wear up to {} mm", driving.wear_mm, driven.wear_mm),
    ]
    if given.temperature is not None:
        low, high = limits.temperature_c
        words.append(f"{low:g} to {high:g} \u00b0C" if high > low or low != MADE_C else "")
    grades = {one.grade or given.grade for one in (driving, driven)} - {None}
    if grades:
        words.insert(0, f"grade {' and '.join(str(one) for one in sorted(g for g in grades if g))} of ISO 1328-1")
    return [word for word in words if word]


def _both(text: str, driving: float, driven: float) -> str:
    if not (driving or driven):
        return ""
    return text.format(f"{driving:g}" if driving == driven else f"{driving:g} and {driven:g}")


def tolerance_json(tolerated: Tolerated) -> dict[str, Any]:
    """Everything but the single assemblies."""
    lot, needed, first = tolerated.lot, tolerated.needed, tolerated.first_order
    knock = tolerated.knock
    return {
        "design": tolerated.drive.design.name,
        "assumed": tolerated.assumed,
        "tolerances": tolerated.tolerances.model_dump(exclude_none=True),
        "single_pitch_um": [rounded_um(float(one)) for one in (lot.limits.pitch_mm.min(), lot.limits.pitch_mm.max())],
        "total_profile_um": [
            rounded_um(float(one)) for one in (lot.limits.profile_mm.min(), lot.limits.profile_mm.max())
        ],
        "assemblies": tolerated.assemblies.count,
        "seed": tolerated.seed,
        "figures": percentiles(tolerated),
        "jam": vars(tolerated.jam),
        "knock": None if knock is None else {**vars(knock), "largest_play_mm": tolerated.knocking_mm},
        "loads_known": tolerated.loaded,
        "backlash_needed": None
        if needed is None
        else {
            "share": TURNING,
            "key": f"gears.{needed.key}",
            "value": needed.value,
            "given": needed.given,
            "jam_with_it": None if needed.jammed is None else vars(needed.jammed),
            "refused": needed.refused,
        },
        "indices": {name: [vars(one) for one in found] for name, found in tolerated.indices.items()},
        "index_samples": tolerated.index_samples,
        "first_order": {
            "play_deviation_mm": float(first.linear_mm.max()),
            "play_deviation_drawn_mm": float(first.drawn_mm.max()),
            "difference": first.difference,
            "by_source_mm": {source: float(one.max()) for source, one in first.by_source.items()},
        },
        "checked_by_outlines": [vars(one) for one in tolerated.errors],
    }


def assemblies_csv(tolerated: Tolerated) -> str:
    """One row for each assembly."""
    told = figures_of(tolerated.assemblies, tolerated)
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
            ", ".join(f"{SOURCES[one.source]} {fixed(100.0 * one.total, 0)} %" for one in found if one.total >= SMALL),
        )
        for name, found in tolerated.indices.items()
    ]


SMALL = 0.02
"""Share of the variance below which a source is not told."""


def _key(name: str, tolerated: Tolerated) -> str:
    """The key of a figure that is indexed, with the unit of the output."""
    output = tolerated.drive.linkage.OUTPUT
    return {
        "motion_error": f"motion_error_{output.place.ending}",
        "peak_acceleration": f"peak_acceleration_{output.acceleration.ending}",
    }.get(name, name)


def tolerance_text(tolerated: Tolerated, paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """All of it as text."""
    lot, first, needed = tolerated.lot, tolerated.first_order, tolerated.needed
    told = percentiles(tolerated)
    heads = ["", "as designed", "median", "99 % keep", "least", "largest"]
    rows = [[name_of(key), *(figure(key, value) for value in values.values())] for key, values in told.items()]
    blocks = [
        f"{tolerated.drive.design.name}: {tolerated.assemblies.count} assemblies, seed {tolerated.seed}\n"
        f"  {'assumed: ' if tolerated.assumed else ''}{', '.join(limit_words(tolerated))}\n"
        f"  single pitch {_um(lot.limits.pitch_mm)}, total profile {_um(lot.limits.profile_mm)} from tooth to tooth",
        "\n".join(aligned([heads, *rows], left=1)),
        f"Jam: {share_words(tolerated.jam)}\nKnock: {knock_words(tolerated)}\nBacklash: {needed_words(tolerated)}",
    ]
    for name, found in tolerated.indices.items():
        key = _key(name, tolerated)
        lines = [
            [
                SOURCES[one.source],
                fixed(one.first, 3),
                fixed(one.total, 3),
                f"\u00b1{fixed(one.error, 3)}",
            ]
            for one in found
        ]
        title = f"What {name_of(key)} varies with (indices of Sobol, {tolerated.index_samples} samples each)"
        blocks.append("\n".join([title, *aligned([["", "first", "total", "95 %"], *lines], left=1)]))
    checks = [
        f"Spread of the play (one sigma): {to_digits(1e3 * first.linear_mm.max(), 3)} \u00b5m by first order, "
        f"{to_digits(1e3 * first.drawn_mm.max(), 3)} \u00b5m of the assemblies; "
        f"up to {fixed(100.0 * first.difference, 0)} % apart",
        *(
            f"Outlines of {'the tightest assembly' if place == 0 else f'assembly {place}'}: the model is off by "
            f"{to_digits(1e3 * one.error_mm, 3)} \u00b5m where flanks are moved by up to "
            f"{to_digits(1e3 * one.displaced_mm, 3)} \u00b5m"
            for place, one in enumerate(tolerated.errors)
        ),
    ]
    if needed is not None and needed.refused:
        checks.append(f"With that backlash: {needed.refused}")
    return "\n\n".join([*blocks, "\n".join(checks), "\n".join(written_lines(paths, kept))])


def _um(limits_mm: Array) -> str:
    low, high = rounded_um(float(limits_mm.min())), rounded_um(float(limits_mm.max()))
    return f"{low:g} \u00b5m" if low == high else f"{low:g} to {high:g} \u00b5m"


def knock_words(tolerated: Tolerated) -> str:
    """The share that knocks, or why none does."""
    if tolerated.knock is None:
        return "none, since the torque never turns round"
    where = "where the torque turns round" if tolerated.loaded else "anywhere"
    return f"{share_words(tolerated.knock)}: play over {to_digits(tolerated.knocking_mm, 3)} mm {where}"


def needed_words(tolerated: Tolerated) -> str:
    """The backlash that is needed, and what fresh assemblies with it say."""
    needed = tolerated.needed
    if needed is None:
        return f"not told of so few; --samples {_power_of_two(tolerated.too_few)} or more is right"
    words = f"99.9 % turn with {needed.value:g} ({needed.given:g} given)"
    if needed.jammed is None:
        return f"{words}, but such gears cannot be made"
    return f"{words}; of fresh ones then {share_words(needed.jammed)} jam"


def _power_of_two(count: int) -> int:
    return 1 << (count - 1).bit_length()
