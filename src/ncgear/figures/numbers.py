"""Figures for people: the name of a quantity by its key, the digits and the unit of its figure; and results as JSON.

A figure is told by its key, whose end is the unit in which it is kept.  Terminal, report, data sheet and pictures ask
``told``, so that the same figure has the same name, digits and unit wherever it is read.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from math import degrees, floor, isfinite, log10, radians
from typing import Any

from ncgear.errors import Unanswered
from ncgear.numerics.units import label_and_unit, placed_rad


def finite(value: Any, name: str) -> Any:
    """The value, the same; Unanswered, which names it, where it or a part of it is no finite number.

    This is the check at the way out: everything that is told or written as text, table or JSON goes through it.
    """
    if isinstance(value, float):
        if not isfinite(value):
            raise Unanswered(f"{name} is {value}, which is no figure of a machine")
    elif isinstance(value, Mapping):
        for key, part in value.items():
            finite(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list | tuple):
        for place, part in enumerate(value):
            finite(part, f"{name}.{place}" if name else str(place))
    return value


def known(value: float) -> float | None:
    """The value as JSON can hold it, None for one without end and for one that is not known."""
    return float(value) if isfinite(value) else None


DRAWN_DECIMALS = {"mm": 4, "deg": 5, "": 5}
"""Decimals of a number on a drawing, by its unit: a tenth of a micrometre, and no more on a radius of half a metre."""

MICRORAD = "\u00b5rad"
"""Millionths of a radian: 0.1 micrometre on a radius of 100 mm."""

NOISE_DECIMALS = {MICRORAD: 3, "kg m2": 15, "W": 24}
NOISE = 9
"""Decimals beyond which a figure holds rounding errors only, by its unit, and of any other unit.

A nanometre of a metre is 1e-9 rad; the inertia of a small part is a few 1e-9 kg m2.  Powers are settled beside the
largest of their machine before they are told, and those of the smallest machines count in digits, too.
"""


NOTHING_MM = 1e-9
"""A length that no drawing shows: far below the smallest teeth, and above the rounding errors of a metre."""


def rounded(value: float, decimals: int) -> float:
    """The value to so many decimals; a zero has no sign.  Unanswered for no finite number."""
    return round(float(finite(value, "a figure")), decimals) + 0.0


def drawn(value: float, unit: str) -> str:
    """A size as a drawing gives it: to the decimals that its unit has there, without needless zeros.

    Lengths of less than a tenth of a millimetre have four digits.
    """
    decimals = DRAWN_DECIMALS.get(unit, NOISE)
    if unit == "mm" and abs(finite(value, "a size")) > NOTHING_MM:
        decimals = max(decimals, 3 - floor(log10(abs(value))))
    digits = f"{rounded(value, decimals):.{decimals}f}"
    return digits.rstrip("0").rstrip(".") if "." in digits else digits


SIZE_DIGITS = 8
"""Digits of lengths in files, of the largest of them: a micrometre of a kilometre, a nanometre of a metre."""


def to_size(value_mm: float, largest_mm: float) -> float:
    """A length as a file has it: to so many digits as the largest length in it has; rounding errors are 0."""
    return rounded(value_mm, SIZE_DIGITS - 1 - floor(log10(largest_mm)))


def fixed(value: float, decimals: int) -> str:
    """A figure with so many decimals; a zero has no minus.  Unanswered for no finite number."""
    return f"{rounded(value, decimals):.{decimals}f}"


def to_digits(value: float, digits: int) -> str:
    """A figure to so many significant digits, or to whole numbers; rounding errors about zero are 0.

    Raises Unanswered for no finite number.
    """
    settled = rounded(value, NOISE)
    return f"{settled:.0f}" if abs(settled) >= 10.0**digits else f"{settled:.{digits}g}"


def placed(angle_deg: float) -> str:
    """A driving angle at which something is, in degrees to four digits; what is not resolved beside a turn is 0."""
    return to_digits(degrees(placed_rad(radians(finite(angle_deg, "an angle")))), 4)


def micrometres(length_mm: float) -> str:
    """A length of the order of a tolerance, to three digits or to whole micrometres, with its unit."""
    micrometre = 1e3 * length_mm
    return f"{fixed(micrometre, 0) if micrometre >= 99.5 else to_digits(micrometre, 3)} \u00b5m"


LONG_LIST = 12
"""Items up to which a list is written out."""


def shown(value: Any, unit: str = "") -> str:
    """A value of a summary as text: numbers with five digits, yes or no, ``-`` for None; rounding errors are 0.

    Runs of whole numbers are shown as ``3-7``, pairs of numbers as ``0.1..0.2``.
    """
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return five_digits(rounded(value, NOISE_DECIMALS.get(unit, NOISE)))
    if isinstance(value, list | tuple):
        return _listed(list(value), unit)
    return str(value)


def five_digits(value: float) -> str:
    """A number, however small, with five significant digits, but never fewer than the digits before the point.

    This is for errors of a computation, which may be as small as rounding; Unanswered for no finite number.
    """
    finite(value, "a figure")
    return f"{value:.0f}" if 1e5 <= abs(value) < 1e12 else f"{value:.5g}"


def _listed(items: list[Any], unit: str) -> str:
    if not items:
        return "none"
    if all(isinstance(item, int) and not isinstance(item, bool) for item in items):
        return ", ".join(_runs(sorted(items)))
    if any(isinstance(item, Mapping) for item in items):
        # The file of the summary has the whole table; a terminal has no room for it.
        return str(len(items))
    texts = [
        "..".join(shown(end, unit) for end in item)
        if isinstance(item, list | tuple) and len(item) == 2
        else shown(item, unit)
        for item in items[:LONG_LIST]
    ]
    left = len(items) - len(texts)
    return ", ".join([*texts, f"and {left} more"] if left else texts)


def teeth_words(numbers: Sequence[int]) -> str:
    """``teeth 3-5, 8``."""
    return f"{'tooth' if len(numbers) == 1 else 'teeth'} {shown(sorted(numbers))}"


def _runs(numbers: list[int]) -> list[str]:
    """Consecutive numbers joined: 1, 2, 3, 5 -> ``1-3``, ``5``."""
    starts = [i for i, number in enumerate(numbers) if i == 0 or number > numbers[i - 1] + 1]
    ends = [*(start - 1 for start in starts[1:]), len(numbers) - 1]
    pairs = [(numbers[start], numbers[end]) for start, end in zip(starts, ends, strict=True)]
    return [f"{low}" if low == high else f"{low}-{high}" for low, high in pairs]


def json_text(content: Any) -> str:
    """Content as indented JSON with a final line break; raises Unanswered as ``finite`` does."""
    return json.dumps(finite(content, ""), indent=2, allow_nan=False) + "\n"


OF_GEAR = {"length": "length of pitch curve", "min radius": "least radius of curvature"}
"""Names of what each gear has one of; where both are told in one column, the gear's name follows."""

NAMES = {
    "bending safety min": "least safety against breakage",
    "bearing force": "force on crank's bearings, teeth apart",
    "bending tooth": "weakest tooth against breakage",
    "center distance": "centre distance",
    "contact ratio back mean": "contact ratio, idle flanks",
    "contact ratio back min": "contact ratio, idle flanks, shortest contact",
    "contact ratio mean": "contact ratio",
    "contact ratio min": "contact ratio, shortest contact",
    "contact ratio under load mean": "contact ratio, under load",
    "contact ratio under load min": "contact ratio, under load, shortest contact",
    "contact safety min": "least safety against pitting",
    "contact tooth": "weakest tooth against pitting",
    "length_percent": "length, share of the stroke",
    "max pressure angle": "greatest pressure angle",
    "peak acceleration cycle": "peak acceleration",
    "peak acceleration working": "peak acceleration, working stroke",
    "peak back force": "peak back force, one pair of teeth",
    "peak mesh force": "peak mesh force, all pairs together",
    "peak pushing force": "peak pushing force, one pair of teeth",
    "pto": "power take-off",
    "play max": "greatest play of the last driven gear",
    "safety of wanted min": "safety over wanted",
    "reversal play": "play where torque turns round",
    "peak power resistance": "peak power, resistance alone",
    "peak tooth force": "peak tooth force, one pair of teeth",
    "rms torque": "r.m.s. torque",
    "rms torque of rated": "r.m.s. torque of rated",
    "time without contact": "time without contact of any flanks",
    "driven_gear_kg_mm2": "moment of inertia of the driven gear",
    "backlash_mm": "least normal backlash",
    "backlash_max_mm": "greatest normal backlash",
    "play_rad": "play of the driven gear",
    "play_greatest_rad": "greatest play of the driven gear",
    **{f"{words} {gear}": f"{name}, {gear}" for words, name in OF_GEAR.items() for gear in ("driving", "driven")},
}
"""Names by key or, of all units, by the key's words without the unit, where those words are not the name already."""

SIZES = (
    "center_distance_mm",
    "module_mm",
    "face_width_mm",
    *(f"{words.replace(' ', '_')}_{gear}_mm" for words in OF_GEAR for gear in ("driving", "driven")),
    "backlash_mm",
    "backlash_max_mm",
    "play_rad",
    "play_greatest_rad",
    "thickness_deviation_mm",
)
"""Sizes of gears, which have the decimals of a drawing everywhere."""

ERRORS = ("residual", "energy_error")
"""Keys with these words hold errors of a computation: all their digits count, however small they are."""

SAFETY = "safety"
"""Keys with this word hold estimates, of which three digits say all."""

STATISTICS = {
    "as_designed": "as designed",
    "median": "median",
    "of_99_percent": "99 % keep",
    "least": "least",
    "largest": "largest",
}
"""What is known of one figure in many assemblies, by key, each in the unit of that figure, and its name."""

IN_DEGREES = ("concave_", "play_")
"""Keys in rad that begin so hold places on a gear and the play that a person wants, not errors or lag."""


def name_of(key: str) -> str:
    """``peak_acceleration_working_mm_s2`` -> ``peak acceleration, working stroke``."""
    label = label_and_unit(key)[0]
    return NAMES.get(key, NAMES.get(label, label))


def told(key: str, value: Any) -> tuple[str, str, str]:
    """Name, text and unit of a figure, whose key ends in the unit in which it is kept.

    People read angles in two units only: places and play in deg; errors and lag of the driven gear in millionths of a
    rad.  The unit is empty where the key has none, and where there is no value.
    """
    unit = label_and_unit(key)[1]
    if unit == "rad":
        factor, unit = (degrees(1.0), "deg") if key.startswith(IN_DEGREES) else (1e6, MICRORAD)
        value = _times(factor, value)
    if isinstance(value, float) and any(word in key for word in ERRORS):
        text = five_digits(value)
    elif isinstance(value, float) and key in SIZES:
        text = drawn(value, unit)
    elif isinstance(value, float) and SAFETY in key:
        text = to_digits(value, 3)
    else:
        text = shown(value, unit)
    nothing = value is None or (isinstance(value, list) and not value)
    return name_of(key), text, "" if nothing else unit


def figure(key: str, value: Any) -> str:
    """Text and unit of a figure: ``6315.1 W``."""
    _, text, unit = told(key, value)
    return f"{text} {unit}".rstrip()


def _times(factor: float, value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_times(factor, item) for item in value]
    return None if value is None else factor * value


PLACE = "_at_rad"
"""End of a key that holds the driving angle at which another key has its extreme value."""


def labelled(section: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Label and text of each entry of a section; the text has the value, its unit and its place."""
    return list(_flattened(section, ""))


def _flattened(section: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    """Label and text of each entry; the label of a nested entry begins with the names of the groups around it.

    ``min_at_rad`` is not an entry of its own: it follows the value of ``min``.
    """
    # Driving angles of extreme values, by the label of the value.
    labels = {label_and_unit(key)[0] for key in section}
    places = {_owner(key): angle for key, angle in section.items() if _owner(key) in labels}
    for key, value in section.items():
        label = label_and_unit(key)[0]
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{label}, ")
        elif _owner(key) not in places:
            yield _labelled_value(key, value, prefix, places.get(label))


def _owner(key: str) -> str:
    """Label of the value whose place this key holds; empty for any other key."""
    return key.removesuffix(PLACE).replace("_", " ") if key.endswith(PLACE) else ""


def _labelled_value(key: str, value: Any, prefix: str = "", place_rad: float | None = None) -> tuple[str, str]:
    label, text, unit = told(key, value)
    place = "" if place_rad is None else f" at phi1 = {placed(degrees(place_rad))} deg"
    return prefix + label, f"{text} {unit}".rstrip() + place
