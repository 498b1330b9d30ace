"""The names of quantities and the digits of their figures: one list for terminal, report, data sheet and pictures.

A figure is told by its key, whose end is the unit in which it is kept.  Whoever prints a figure asks ``told``, so that
the same figure has the same name, digits and unit wherever it is read.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees
from typing import Any

from ncgear.figures.numbers import MICRORAD, drawn, five_digits, placed, shown, to_digits
from ncgear.numerics.units import label_and_unit

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
