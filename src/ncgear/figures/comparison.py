"""A design beside the uniform crank and published mechanisms: rows of plain values, and the tables of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ncgear.design.keys.machine import Published
from ncgear.figures.numbers import fixed, shown, to_digits
from ncgear.figures.quantities import name_of
from ncgear.figures.tables import Column, Table
from ncgear.kinematics.check import KinematicCheck
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.units import label_and_unit
from ncgear.project.drive import Drive

COMPARED = (
    "speed_rpm",
    "peak_power_w",
    "peak_power_resistance_w",
    "mean_power_w",
    "peak_acceleration_cycle_mm_s2",
    "peak_speed_mm_s",
    "peak_acceleration_cycle_rad_s2",
    "peak_speed_rad_s",
)
"""The figures of a comparison of mechanisms, by their keys."""

SAME_SPEED = "Comparison at equal driving speed"
MIXED_SPEEDS = "At other driving speeds: mixes speeds, so this proves nothing about equal productivity"


def comparison_rows(drive: Drive) -> list[dict[str, Any]]:
    """This design, the uniform crank, and published mechanisms scaled to the operating speed; then mixed speeds.

    Each row has ``name``, ``note``, ``same_speed`` (whether it holds at the operating speed) and figures in the units
    that its keys end in, None where one is not known.
    """
    speed, own, other = drive.design.operation.speed_rpm, drive.check, drive.uniform_check
    against_uniform = _saved("", own.peak_power_w.value, other.peak_power_w.value)
    published = drive.design.comparison.published if drive.design.comparison else ()
    return [
        _checked("this design", own, speed, ""),
        _checked(drive.linkage.UNIFORM, other, speed, against_uniform),
        *(_scaled(drive, mechanism) for mechanism in published),
        *(row for mechanism in published for row in _mixed(drive, mechanism)),
    ]


def _saved(what: str, own_w: float, other_w: float | None) -> str:
    """Words for a peak power of this design against the power of another machine; empty where the other has none."""
    if not other_w:
        return ""
    saving = 100.0 * (1.0 - own_w / other_w)
    return f"this design's peak power{what} is {fixed(abs(saving), 1)} % {'lower' if saving >= 0 else 'higher'}"


def _checked(name: str, check: KinematicCheck, speed: float, note: str) -> dict[str, Any]:
    acceleration, velocity = check.peak_acceleration_cycle.value, check.peak_speed.value
    row = _row(check.output, name, speed, check.peak_power_w.value, acceleration, velocity)
    alone = {"peak_power_resistance_w": check.peak_power_resistance_w.value} if check.with_masses else {}
    return {**row, **alone, "mean_power_w": check.mean_power_w, "same_speed": True, "note": note}


def _row(
    output: Output, name: str, speed: float, power: float | None, acceleration: float | None, velocity: float | None
) -> dict[str, Any]:
    return {
        "name": name,
        "speed_rpm": speed,
        "peak_power_w": power,
        "mean_power_w": None,
        f"peak_acceleration_cycle_{output.acceleration.ending}": acceleration,
        f"peak_speed_{output.speed.ending}": velocity,
    }


def _scaled(drive: Drive, published: Published) -> dict[str, Any]:
    found = published.at_speed(drive.design.operation.speed_rpm)
    power, pressing = found.peak_power_w, found.compression_speed_mm_s
    # A publication counts no masses of this machine
    alone = ", of the resistance alone," if drive.check.with_masses else ""
    saved = _saved(alone, drive.check.peak_power_resistance_w.value, power)
    notes = [saved, f"compression speed {to_digits(pressing, 4)} mm/s" if pressing else ""]
    output = drive.linkage.OUTPUT
    row = _row(output, found.name, found.speed_rpm, power, found.peak_acceleration_mm_s2, found.peak_speed_mm_s)
    return {**row, "same_speed": True, "note": "; ".join(note for note in notes if note)}


def _mixed(drive: Drive, published: Published) -> list[dict[str, Any]]:
    """The publication's own comparison, where it compares figures at different speeds."""
    if published.quoted_power_w is None or published.quoted_speed_rpm is None:
        return []
    acceleration, velocity = published.peak_acceleration_mm_s2, published.peak_speed_mm_s
    output = drive.linkage.OUTPUT
    theirs = _row(output, published.name, published.speed_rpm, published.peak_power_w, acceleration, velocity)
    quoted = _row(
        output, "set against it in the publication", published.quoted_speed_rpm, published.quoted_power_w, None, None
    )
    same = drive.check.peak_power_resistance_w.value * published.speed_rpm / drive.design.operation.speed_rpm
    alone = " for the resistance alone" if drive.check.with_masses else ""
    note = f"at {published.speed_rpm:g} r/min this design needs {shown(same)} W{alone}"
    if published.peak_power_w:
        saving = 100.0 * (1.0 - published.quoted_power_w / published.peak_power_w)
        note = f"the {fixed(saving, 1)} % between the two rows is a difference of speed; {note}"
    return [{**theirs, "same_speed": False, "note": ""}, {**quoted, "same_speed": False, "note": note}]


def comparison_tables(rows: Sequence[Mapping[str, Any]]) -> list[Table]:
    """A table of the mechanisms at equal speed, and one of the figures that were published at other speeds."""
    same, mixed = ([row for row in rows if row["same_speed"] is wanted] for wanted in (True, False))
    return [_table(title, chosen) for title, chosen in ((SAME_SPEED, same), (MIXED_SPEEDS, mixed)) if chosen]


def _table(title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    keys = [key for key in COMPARED if any(key in row for row in rows)]
    cells = (((str(row["name"]), *(shown(row.get(key)) for key in keys))) for row in rows)
    columns = Column("mechanism"), *(Column(name_of(key), label_and_unit(key)[1]) for key in keys)
    return Table(title, columns, tuple(cells), row_notes=tuple(row["note"] for row in rows))
