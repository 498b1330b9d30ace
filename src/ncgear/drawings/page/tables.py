"""The tables of the page (comparison, contact, data sheet, versions), and the main figures that stand at its top."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from math import radians
from typing import Any

from ncgear import __version__
from ncgear.contact.pair import PairContact
from ncgear.figures.data_sheet.sheet import DataSheet, Group
from ncgear.figures.numbers import shown, to_digits
from ncgear.figures.strong import weakest_table
from ncgear.figures.summary.build_summary import contact_summary
from ncgear.figures.summary.check_summary import comparison_rows
from ncgear.figures.tables import Column, Table
from ncgear.figures.terminal import MIXED_SPEEDS, SAME_SPEED, compared_columns, labelled
from ncgear.numerics.units import CM3_PER_MM3
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Verdict, known_verdict

LIBRARIES = ("numpy", "scipy", "shapely", "trimesh", "mapbox-earcut", "matplotlib", "pydantic", "ruamel.yaml")
"""The libraries that compute the figures of the page, beside ncgear and Python."""


def comparison_tables(drive: Drive) -> list[Table]:
    """A table of the mechanisms at equal speed, and one of the figures that were published at other speeds."""
    rows = comparison_rows(drive)
    same, mixed = ([row for row in rows if row["same_speed"] is wanted] for wanted in (True, False))
    return [_comparison(title, chosen) for title, chosen in ((SAME_SPEED, same), (MIXED_SPEEDS, mixed)) if chosen]


def _comparison(title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    compared = compared_columns(rows)
    cells = [(str(row["name"]), *(shown(row[key]) for key in compared)) for row in rows]
    columns = (Column("mechanism"), *compared.values())
    return Table(title, columns, tuple(cells), row_notes=tuple(row["note"] for row in rows))


def contact_tables(drive: Drive, contact: PairContact) -> list[Table]:
    """The worst figures of the contact, and all figures as designed beside those of each form of written outlines."""
    found = contact_summary(contact, drive.contact_extremes)
    designed, written = found.pop("as_designed"), found.pop("as_written")
    forms = {f"as written to {source.upper()}": figures for source, figures in written.items()}
    return [
        Table("The worst of all", (), tuple(labelled(found))),
        _beside("In detail", {"as designed": designed, **forms}),
    ]


def strength_tables(drive: Drive) -> list[Table]:
    """The weakest teeth of both gears; empty where no strength is known."""
    verdict = known_verdict(drive)
    return [weakest_table(drive, verdict)] if isinstance(verdict, Verdict) else []


def _beside(title: str, sections: Mapping[str, Mapping[str, Any]]) -> Table:
    """The same figures of several sections side by side, without lists of teeth, which summary.json has."""
    plain = [{key: value for key, value in one.items() if not isinstance(value, list)} for one in sections.values()]
    columns = [dict(labelled(section)) for section in plain]
    labels = dict.fromkeys(label for column in columns for label in column)
    heads = (Column(""), *map(Column, sections))
    return Table(title, heads, tuple((label, *(column.get(label, "") for column in columns)) for label in labels))


def sheet_tables(sheet: DataSheet) -> list[Table]:
    """The groups of a data sheet as tables, and its tables."""
    return [*map(_group, sheet.groups), *sheet.tables]


def _group(group: Group) -> Table:
    """A group as a table; a value of the pair fills two columns, and a cell without a value is empty."""
    heads = Column(""), Column("driving"), Column("driven"), Column("")
    rows = [(one.label, *one.texts, one.unit) for one in group.entries]
    return Table(group.title, heads, tuple(rows))


def versions() -> Table:
    """The versions of ncgear, Python and the libraries that made the page."""
    made = (("ncgear", __version__), ("python", platform.python_version()), *((n, version(n)) for n in LIBRARIES))
    return Table("Made with", (), made)


def facts(drive: Drive) -> list[tuple[str, str]]:
    """Names and values of the machine's main figures; the peak power where the design has a resistance."""
    low, high = drive.transmission.ratio_range
    linkage, output = drive.linkage, drive.linkage.OUTPUT
    stroke = [("stroke", f"{shown(output.place.factor * linkage.stroke_mm)} {output.place.text}")]
    acceleration = output.acceleration.text.replace("s2", "s\u00b2")
    power = []
    if drive.design.resistance is not None:
        power = [("peak power", f"{shown(drive.check.peak_power_w.value)} W")]
    return [
        ("law", drive.design.motion.law.replace("_", " ")),
        ("speed", f"{shown(drive.design.operation.speed_rpm)} r/min"),
        *(stroke if linkage.RETURNS else []),
        ("ratio", f"{to_digits(low.value, 3)} to {to_digits(high.value, 3)}"),
        *power,
        ("peak acceleration", f"{shown(drive.check.peak_acceleration_cycle.value)} {acceleration}"),
    ]


def gear_facts(drive: Drive) -> list[tuple[str, str]]:
    """Names and values of the main figures of a pair of gears; the names begin with its stage where there are two."""
    designed = drive.designed_contact
    size, stage = drive.pitch.size, f"stage {drive.stage}: " if drive.stage else ""
    displaced = drive.pumped
    pumped = (
        []
        if displaced is None
        else [
            (f"{stage}displacement", f"{shown(CM3_PER_MM3 * displaced.per_turn_mm3)} cm\u00b3 a turn"),
            (f"{stage}pulsation", f"{to_digits(100.0 * displaced.pulsation, 3)} %"),
        ]
    )
    steepest = drive.pitch.largest_pressure_angle_deg(radians(drive.gears.carrying_angle_deg))
    return [
        (f"{stage}teeth", f"{size.driving_teeth} : {size.driven_teeth}"),
        (f"{stage}module", f"{shown(size.module_mm)} mm"),
        (f"{stage}centre distance", f"{shown(size.center_distance_mm)} mm"),
        (f"{stage}pressure angle", f"up to {to_digits(steepest, 3)}\u00b0"),
        (f"{stage}contact ratio", f"{to_digits(designed.contact_ratio, 3)}, least {to_digits(designed.least_arc, 3)}"),
        *pumped,
    ]
