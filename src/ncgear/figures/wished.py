"""What a motion achieves of what a person may wish of it: in one line, as plain values, and wish by wish."""

from __future__ import annotations

from math import degrees, inf
from typing import Any, NamedTuple

from ncgear.figures.numbers import shown, to_digits
from ncgear.kinematics.outcomes import EVEN, Achieved, Outcome
from ncgear.kinematics.wishes import (
    ConstantSpeed,
    Dwell,
    End,
    ExtremeSpeed,
    GentleSpeed,
    GentleStop,
    GentleStretch,
    Position,
    SpeedAt,
    Stroke,
    TimeRatio,
    Wish,
    WorkingStroke,
)
from ncgear.mechanisms.mechanism import Mechanism

DIGITS = 4
"""Significant digits of what is achieved; what is missed has three."""


class Scale(NamedTuple):
    """How the figures of a kind of wish are told: a factor from the unit of its outcome, the unit, the end of keys."""

    factor: float
    unit: str
    ending: str

    def said(self, value: float, digits: int = DIGITS) -> str:
        """A value of the outcome in words."""
        return f"{to_digits(self.factor * value, digits)} {self.unit}".rstrip()


def scale_of(wish: Wish) -> Scale:
    """How the figures of a wish are told."""
    place, speed = wish.output.place, wish.output.speed
    match wish:
        case ConstantSpeed():
            return Scale(100.0, "%", "_percent")
        case SpeedAt() | ExtremeSpeed() | GentleSpeed():
            return Scale(speed.factor, speed.text, f"_{speed.ending}")
        case GentleStop():
            told = wish.output.acceleration
            return Scale(told.factor, told.text, f"_{told.ending}")
        case TimeRatio():
            return Scale(1.0, "", "")
        case Position():
            return Scale(place.factor, place.text, f"_{place.ending}")
    return Scale(degrees(1.0), "deg", "_deg")


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
    """The figures of ``motion_line`` and those of the return, by keys that end in their unit."""
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
    scale = scale_of(outcome.wish)
    return {
        "key": outcome.wish.key,
        "hard": outcome.wish.hard,
        "kept": outcome.kept,
        f"achieved{scale.ending}": scale.factor * outcome.achieved,
        f"missed_by{scale.ending}": 0.0 if outcome.kept else scale.factor * outcome.missed_by,
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
    scale = scale_of(outcome.wish)
    missed = "" if outcome.kept else f", missed by {missed_by(outcome)}"
    return f"{_wish(outcome.wish)}: {_achieved(outcome, scale)}, {_wanted(outcome, scale)} wished{missed}"


def missed_by(outcome: Outcome) -> str:
    """How far what is achieved lies beyond the bounds of the wish."""
    return scale_of(outcome.wish).said(outcome.missed_by, 3)


def _wish(wish: Wish) -> str:
    """A wish by its kind and its place."""
    unit = wish.output.place

    def at(place: float) -> str:
        return shown(unit.factor * place)

    match wish:
        case ConstantSpeed():
            return f"constant speed from {at(wish.from_mm)} to {at(wish.to_mm)} {unit.text}{_of(wish.stroke)}"
        case SpeedAt() | ExtremeSpeed():
            return f"speed at {at(wish.at_mm)} {unit.text}{_of(wish.stroke)}"
        case GentleStretch():
            what = "greatest speed" if isinstance(wish, GentleSpeed) else "greatest deceleration"
            if wish.driving is not None:
                start, end = (to_digits(degrees(angle), DIGITS) for angle in wish.driving[:2])
                return f"{what} from driving angle {start} to {end} deg"
            strokes = " of both strokes" if wish.stroke is None else _of(wish.stroke)
            return f"{what} from {at(wish.from_mm)} to {at(wish.to_mm)} {unit.text}{strokes}"
        case TimeRatio():
            return "time ratio of working stroke and return"
        case WorkingStroke():
            return "driving angle of the working stroke"
        case Dwell():
            return f"dwell within {at(wish.within_mm)} {unit.text} of the {wish.end.value} end"
        case Position():
            return f"place at {to_digits(degrees(wish.phi1_rad), DIGITS)} deg{_of(wish.stroke)}"
    raise TypeError(f"{type(wish).__name__} is no known kind of wish")


def _of(stroke: Stroke) -> str:
    return " of the return" if stroke is Stroke.RETURN else ""


def _achieved(outcome: Outcome, scale: Scale) -> str:
    said = scale.said(outcome.achieved)
    if outcome.speed_mm_s is not None:
        return f"within {said} of {to_digits(outcome.speed_mm_s, DIGITS)} {outcome.wish.output.speed.text}"
    return f"{said} in the other stroke" if outcome.other_stroke else said


def _wanted(outcome: Outcome, scale: Scale) -> str:
    """The bounds of a wish in words."""
    if isinstance(outcome.wish, ExtremeSpeed):
        return "as fast as may be" if outcome.wish.fastest else "as slow as may be"
    least, most = outcome.least, outcome.most
    if least == most:
        return scale.said(least)
    if most == inf:
        return f"at least {scale.said(least)}"
    return f"at most {scale.said(most)}" if least == 0.0 else f"{scale.said(least)} to {scale.said(most)}"
