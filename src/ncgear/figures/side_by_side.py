"""Designs side by side: the figures of a check of each design, and how they differ from the first design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ncgear.errors import DesignError, WrongInput
from ncgear.figures.answers.answer import difference
from ncgear.figures.numbers import PLACE, figure, name_of
from ncgear.figures.summary.build_summary import pitch_summary
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.tables import aligned
from ncgear.frozen import dataclass
from ncgear.numerics.units import label_and_unit
from ncgear.project.drive import Drive
from ncgear.project.opened import load

SECTIONS = ("drive", "check", "motion", "ratio", "pitch")
"""Sections of a summary whose numbers are compared, in this order."""

MAIN = (
    "speed_rpm",
    "stroke",
    "peak_power_w",
    "mean_power_w",
    "peak_speed",
    "peak_acceleration_cycle",
    "time_ratio",
    "dwell_retracted_deg",
    "dwell_extended_deg",
    "ratio_min",
    "ratio_max",
    "center_distance_mm",
    "max_pressure_angle_deg",
)
"""What is told without ``every``: keys, or their words without the unit."""

MOST = 8
"""Designs that a table and a chart have room for."""


@dataclass(frozen=True, eq=False)
class SideBySide:
    """Drives and their figures by key, in the units in which keys end; a drive lacks the keys of what it has not."""

    drives: tuple[Drive, ...]
    figures: tuple[Mapping[str, float], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the designs; designs of the same name have their numbers behind it."""
        names = [drive.design.name for drive in self.drives]
        return tuple(f"{name} ({place})" if name in names[: place - 1] else name for place, name in enumerate(names, 1))

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of all figures that any design has."""
        return tuple(dict.fromkeys(key for own in self.figures for key in own))

    def percent(self, key: str) -> tuple[float | None, ...]:
        """By how many percent the figure of each other design is over the first; None where there is no share."""
        if key not in self.keys:
            raise WrongInput(f"{key!r} is no figure of these designs; {', '.join(self.keys)} are", key=key)
        first, *others = (own.get(key) for own in self.figures)
        return tuple(100.0 * (other / first - 1.0) if other is not None and first else None for other in others)

    def __repr__(self) -> str:
        return side_by_side_text(self)


def compare(*given: Drive | str | Path | Mapping[str, Any]) -> SideBySide:
    """Set designs side by side: drives, design files or mappings, two to eight; differences are from the first.

    Raises WrongInput and NoSuchMechanism as ``ncgear.load`` and the check of a drive do, WrongInput for another number.
    ``ncgear.plots.compared`` draws them.
    """
    if not 2 <= len(given) <= MOST:
        raise WrongInput(f"{len(given)} design{'s' * (len(given) != 1)} given; 2 to {MOST} are compared")
    drives = tuple(design if isinstance(design, Drive) else load(design) for design in given)
    return SideBySide(drives, tuple(map(design_figures, drives)))


def design_figures(drive: Drive) -> dict[str, float]:
    """The numbers of a check by key, and those of the pitch curves where there is one pair that can be made.

    A machine without a load has no power: none is told of it, as a check tells none.
    """
    summary = check_summary(drive)
    if drive.design.gears is not None and drive.design.stages == 1:
        with suppress(DesignError):
            summary = {**summary, "pitch": pitch_summary(drive)}
    loaded = drive.design.resistance is not None or drive.check.with_masses is not None
    return {
        f"ratio_{key}" if section == "ratio" else key: float(value)
        for section in SECTIONS
        for key, value in summary.get(section, {}).items()
        if isinstance(value, int | float) and not isinstance(value, bool) and not key.endswith(PLACE)
        if loaded or not ("power" in key and key.endswith("_w"))
    }


def side_by_side_figures(found: SideBySide) -> dict[str, Any]:
    """Plain values: each design's figures by keys that end in their unit, and by how many percent they differ."""
    designs = [
        {"name": name, "law": drive.design.motion.law, "figures": dict(own)}
        for name, drive, own in zip(found.names, found.drives, found.figures, strict=True)
    ]
    percent = {key: found.percent(key) for key in found.keys}
    for place, design in enumerate(designs[1:]):
        shares = {key: each[place] for key, each in percent.items() if each[place] is not None}
        design["percent_over_first"] = shares
    return {"designs": designs}


def side_by_side_text(found: SideBySide, *, every: bool = False) -> str:
    """The table: a figure in each row, and behind each design but the first how it differs from that."""
    first, *others = found.names
    heads = ["", first, *(head for name in others for head in (name, f"than {first}"))]
    rows = [_row(found, key) for key in found.keys if every or key in MAIN or label_and_unit(key)[0] in _WORDS]
    laws = [drive.design.motion.law for drive in found.drives]
    law = ["law", laws[0], *(text for law in laws[1:] for text in (law, ""))]
    return "\n".join(aligned([heads, law, *rows], left=1))


_WORDS = {key.replace("_", " ") for key in MAIN}


def _row(found: SideBySide, key: str) -> list[str]:
    values = [own.get(key) for own in found.figures]
    told = ["-" if value is None else figure(key, value) for value in values]
    cells = [name_of(key), told[0]]
    for value, text in zip(values[1:], told[1:], strict=True):
        known = value is not None and values[0] is not None
        cells += [text, difference(float(value or 0.0), float(values[0] or 0.0)) if known else ""]
    return cells


def side_by_side_columns(found: SideBySide) -> tuple[Sequence[str], list[list[object]]]:
    """Heads and rows of a table of numbers: the key, and the figure of each design."""
    return ("key", *found.names), [[key, *(own.get(key) for own in found.figures)] for key in found.keys]
