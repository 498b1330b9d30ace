"""What a motion achieves of what a person may wish of it: in one line, as plain values, and wish by wish."""

from __future__ import annotations

from math import degrees, inf
from typing import Any

from ncgear.figures.numbers import shown, to_digits
from ncgear.kinematics.crank_stretches import End, Stroke
from ncgear.mechanisms.mechanism import Mechanism, Unit
from ncgear.wishes.wish import EVEN, Achieved, Outcome

DIGITS = 4
"""Significant digits of what is achieved; what is missed has three."""


def motion_facts(found: Achieved, linkage: Mechanism) -> list[tuple[str, str]]:
    """What a motion achieves, as names and texts: constant speed and, of an output that returns, times and dwells."""
    even, place = found.even[Stroke.WORKING].length_mm, linkage.OUTPUT.place
    length = f"within {100.0 * EVEN:g} % over {to_digits(place.factor * even, 3)} {place.text}"
    if found.time_ratio is None:
        return [("constant speed", length)]
    share, near = to_digits(100.0 * even / linkage.stroke_mm, 3), to_digits(place.factor * found.near_mm, 4)
    dwells = ", ".join(f"{to_digits(degrees(found.dwell_rad[end]), 3)} deg {end.value}" for end in reversed(End))
    return [
        ("constant speed", f"{length}, {share} % of the stroke"),
        ("time ratio", to_digits(found.time_ratio, 3)),
        ("dwell", f"within {near} {place.text} for {dwells}"),
    ]


def motion_line(found: Achieved, linkage: Mechanism) -> str:
    """What a motion achieves, in one line."""
    (_, even), *others = motion_facts(found, linkage)
    way = "on its way from end to end " if found.time_ratio is None else ""
    return "; ".join([f"{way}constant {even}", *(f"{name} {text}" for name, text in others)])


def motion_summary(found: Achieved, linkage: Mechanism) -> dict[str, Any]:
    """The figures of ``motion_line`` and the figures of the return, by keys that end in their unit."""
    even, place = {f"even_{stroke.value}": _even(found, stroke, linkage) for stroke in found.even}, linkage.OUTPUT.place
    dwells = {f"dwell_{end.value}_deg": degrees(angle) for end, angle in found.dwell_rad.items()}
    return {
        "in_words": motion_line(found, linkage),
        "even_within_percent": 100.0 * EVEN,
        **even,
        "time_ratio": found.time_ratio,
        f"dwell_within_{place.ending}": place.factor * found.near_mm,
        **dwells,
    }


def _even(found: Achieved, stroke: Stroke, linkage: Mechanism) -> dict[str, float]:
    stretch, output = found.even[stroke], linkage.OUTPUT
    unit, factor = output.place.ending, output.place.factor
    return {
        f"length_{unit}": factor * stretch.length_mm,
        "length_percent": 100.0 * stretch.length_mm / linkage.stroke_mm,
        f"from_{unit}": factor * min(stretch.start_mm, stretch.end_mm),
        f"to_{unit}": factor * max(stretch.start_mm, stretch.end_mm),
        f"speed_{output.speed.ending}": stretch.speed_mm_s,
    }


def wish_rows(found: Achieved) -> list[dict[str, Any]]:
    """Every wish as plain values: its key, whether it is hard and kept, what is achieved, and all that in words."""
    return [_row(outcome) for outcome in found.outcomes]


def _row(outcome: Outcome) -> dict[str, Any]:
    unit = outcome.unit
    ending = f"_{unit.ending}" if unit.ending else ""
    return {
        "key": outcome.wish.key,
        "hard": outcome.wish.hard,
        "kept": outcome.kept,
        f"achieved{ending}": unit.factor * outcome.achieved,
        f"missed_by{ending}": 0.0 if outcome.kept else unit.factor * outcome.missed_by,
        "in_words": outcome_line(outcome),
    }


def wish_line(row: dict[str, Any]) -> str:
    """One of ``wish_rows`` for reading: whether it is kept, then its words."""
    return f"{'kept' if row['kept'] else 'missed'}: {row['in_words']}"


def achieved_lines(found: Achieved, linkage: Mechanism) -> list[str]:
    """What a motion achieves in one line, and then one line for each wish."""
    return [motion_line(found, linkage), *map(wish_line, wish_rows(found))]


def outcome_line(outcome: Outcome) -> str:
    """A wish, what the motion achieves of it, what is wished, and by how much that is missed."""
    wish = outcome.wish
    words = wish.words(
        lambda place: shown(wish.output.place.factor * place), lambda angle: to_digits(degrees(angle), DIGITS)
    )
    missed = "" if outcome.kept else f", missed by {missed_by(outcome)}"
    return f"{words}: {_achieved(outcome)}, {wish.aim or _bounds(outcome)} wished{missed}"


def missed_by(outcome: Outcome) -> str:
    """How far what is achieved lies beyond the bounds of the wish."""
    return _said(outcome.missed_by, outcome.unit, 3)


def _said(value: float, unit: Unit, digits: int = DIGITS) -> str:
    return f"{to_digits(unit.factor * value, digits)} {unit.text}".rstrip()


def _achieved(outcome: Outcome) -> str:
    said = _said(outcome.achieved, outcome.unit)
    if outcome.speed_mm_s is not None:
        return f"within {said} of {to_digits(outcome.speed_mm_s, DIGITS)} {outcome.wish.output.speed.text}"
    return f"{said} in the other stroke" if outcome.other_stroke else said


def _bounds(outcome: Outcome) -> str:
    unit, least, most = outcome.unit, outcome.least, outcome.most
    if least == most:
        return _said(least, unit)
    if most == inf:
        return f"at least {_said(least, unit)}"
    return f"at most {_said(most, unit)}" if least == 0.0 else f"{_said(least, unit)} to {_said(most, unit)}"
