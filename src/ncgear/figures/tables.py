"""A table as a value, and the ways in which it is written: aligned text, Markdown, the cells of HTML, and CSV.

In CSV numbers have all their digits: read back, they are the same floats.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from io import StringIO
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ncgear.figures.numbers import drawn, finite
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import OutputMotion
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.units import N_M_PER_N_MM

if TYPE_CHECKING:
    from ncgear.contact.pair import PairContact
    from ncgear.dynamics.history import Slide


Value = float | int | str | bool | tuple[float, float] | None
"""The content of a cell: a value, or the least and the greatest one; None leaves it empty."""

Cells = tuple[Value, ...]

WIDTH = 110
"""Columns of a line of text."""

GAP = "  "
"""Between the columns of aligned text."""

MEANT = re.compile(r"[\\|<&`*_\[\]]")
"""Characters with a meaning in Markdown; a backslash before them takes the meaning away."""


class Column(NamedTuple):
    """Heading of a column; ``unit`` may be empty."""

    label: str
    unit: str = ""

    @property
    def heading(self) -> str:
        """``span in mm``."""
        return f"{self.label} in {self.unit}" if self.unit else self.label


def columns_of(*headings: str) -> tuple[Column, ...]:
    """Columns by their headings, each a label or, as in ``stress, MPa``, a label and a unit."""
    return tuple(Column(*heading.rsplit(", ", 1)) for heading in headings)


class HtmlRow(NamedTuple):
    """Cells of text; the first one names the row, and the second one is ``span`` columns wide."""

    cells: tuple[str, ...]
    span: int
    note: str


@dataclass(frozen=True)
class Table:
    """Rows of cells under a title; a row has as many cells as there are ``columns``, or fewer.

    In a shorter row the second cell also fills the missing columns.  A table without columns has no heads.  ``notes``
    are sentences about the whole table; ``row_notes`` has one note, perhaps empty, for each row.  A ``long`` table may
    be broken between rows in print.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Cells, ...]
    notes: tuple[str, ...] = ()
    row_notes: tuple[str, ...] = ()
    long: bool = False

    def texts(self, cells: Cells) -> list[str]:
        """The texts of a row, each to the decimals of its column's unit."""
        units = [column.unit for column in self.columns]
        return [cell_text(value, unit) for value, unit in zip_longest(cells, units[: len(cells)], fillvalue="")]

    @property
    def html_rows(self) -> list[HtmlRow]:
        """The rows for HTML, in text that is not escaped yet."""
        notes = self.row_notes or ("",) * len(self.rows)
        return [
            HtmlRow(tuple(self.texts(cells)), max(1 + len(self.columns) - len(cells), 1), note)
            for cells, note in zip(self.rows, notes, strict=True)
        ]


def cell_text(value: Value, unit: str = "") -> str:
    """A cell for reading: numbers as on a drawing (``numbers.drawn``), a range as ``10 to 12``, nothing for None."""
    if value is None:
        return ""
    if isinstance(value, tuple):
        return " to ".join(dict.fromkeys(drawn(end, unit) for end in value))
    return drawn(value, unit) if isinstance(value, float) else str(value)


def aligned(
    rows: Sequence[Sequence[str]], left: int = 0, least: Sequence[int] | int = 0, indent: str = GAP
) -> list[str]:
    """One line for each row of texts, all of one length, in columns as wide as their widest text.

    The first ``left`` columns are aligned to the left, the others to the right.  ``least`` is the least width of the
    columns, one for each or one for all.
    """
    count = len(rows[0]) if rows else 0
    narrowest = [least] * count if isinstance(least, int) else least
    widths = [max(low, *map(len, texts)) for low, texts in zip(narrowest, zip(*rows, strict=True), strict=True)]
    aligns = "<" * left + ">" * (count - left)
    lines = (
        GAP.join(f"{text:{align}{width}}" for text, align, width in zip(row, aligns, widths, strict=False))
        for row in rows
    )
    return [f"{indent}{line}".rstrip() for line in lines]


def markdown(heads: Sequence[str], rows: Iterable[Sequence[str]], rule: str = "---") -> list[str]:
    """The lines of a table in Markdown, the texts unchanged; ``rule`` is drawn below each head."""
    first, *others = (f"| {' | '.join(texts)} |" for texts in (heads, *rows))
    return [first, f"|{'|'.join([rule] * len(heads))}|", *others]


def markdown_text(value: Value, unit: str = "") -> str:
    """A cell on one line of Markdown; no character of it ends the cell, begins HTML or has another meaning."""
    text = cell_text(value, unit)
    return MEANT.sub(r"\\\g<0>", " ".join(text.split())) if isinstance(value, str) else text


OUTLINE_COLUMNS = ("x_mm", "y_mm")


def law_csv(motion: OutputMotion, output: Output) -> str:
    """The motion law over one turn, one row per driving angle, columns named with their units.

    Places of an output that turns are in rad there, its torques in N m.  ``power_w`` is that of the resistance alone;
    where masses are counted, torque and power of the driving shaft with them have columns of their own.

    Raises ValueError when a column holds something other than finite numbers, or columns differ in length.
    """
    columns = {
        "phi1_rad": motion.phi1_rad,
        "phi2_rad": motion.phi2_rad,
        "ratio": motion.ratio,
        **motion_columns(motion, output),
        **load_column(motion, output),
        "power_w": motion.power_w,
    }
    if motion.torque_with_masses_n_mm is not None and motion.power_with_masses_w is not None:
        columns["driving_torque_with_masses_n_m"] = N_M_PER_N_MM * motion.torque_with_masses_n_mm
        columns["power_with_masses_w"] = motion.power_with_masses_w
    return csv_text(list(columns), list(columns.values()))


def motion_columns(motion: OutputMotion | Slide, output: Output) -> dict[str, Array]:
    """Places, velocities and accelerations by names that end in their units."""
    return {
        "displacement_rad" if output.angular else "displacement_mm": motion.displacement,
        f"velocity_{output.speed.ending}": motion.velocity,
        f"acceleration_{output.acceleration.ending}": motion.acceleration,
    }


def load_column(motion: OutputMotion, output: Output) -> dict[str, Array]:
    """The load by its name, which ends in its unit."""
    return {f"{output.load_name}_{output.load.ending}": motion.load * output.load.factor}


def outline_csv(outline_mm: Array) -> str:
    """A tooth outline in mm, shape (n, 2), one point a row; raises ValueError as ``law_csv`` does."""
    return csv_text(OUTLINE_COLUMNS, list(outline_mm.T))


def contact_csv(contact: PairContact) -> str:
    """The contact at each position, columns named with their units; raises ValueError as ``law_csv`` does.

    An error is the driven angle less that of the law.  Tooth numbers, place, pressure angle and sliding belong to the
    first contact on pushing flanks as designed; ``edge`` is 1 where this is not a contact of two flanks.
    """
    designed = contact.as_designed
    first, place = designed.pushing.first, designed.pushing.first.fixed_points(designed.placement)
    columns: dict[str, Array | IndexArray] = {
        "phi1_rad": designed.placement.phi1_rad,
        "phi2_rad": designed.placement.phi2_rad,
        "error_rad": designed.pushing.error_rad,
        "back_error_rad": designed.back.error_rad,
        "backlash_rad": designed.backlash_rad,
        "contacts": designed.pushing.simultaneous,
        "back_contacts": designed.back.simultaneous,
        "driving_tooth": first.driving_tooth,
        "driven_tooth": first.driven_tooth,
        "edge": (~first.flanks).astype(int),
        "x_mm": place.real,
        "y_mm": place.imag,
        "pressure_angle_rad": first.pressure_angle_rad,
        "sliding_mm_per_rad": first.sliding_mm(designed.placement),
    }
    for written in contact.as_written:
        columns[f"{written.source}_error_rad"] = written.pushing_rad
        columns[f"{written.source}_back_error_rad"] = written.back_rad
        columns[f"{written.source}_penetration_mm"] = written.overlap_mm
    return csv_text(list(columns), list(columns.values()))


def csv_text(names: Sequence[str], columns: Sequence[Array | IndexArray]) -> str:
    """Columns of shape (n,) under their names; raises ValueError as ``law_csv`` does."""
    for name, column in zip(names, columns, strict=True):
        if not np.isfinite(column).all():
            raise ValueError(f"{name} holds a value that is not finite")
    # As csv.writer writes numbers, in two thirds of its time.
    cells = (map(repr, column.tolist()) for column in columns)
    return "\n".join([",".join(names), *map(",".join, zip(*cells, strict=True)), ""])


def rows_text(names: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Rows of numbers, words and empty cells (None) under names; words with commas are put in quotes.

    Raises Unanswered for a number that is not finite.
    """
    text = StringIO()
    csv.writer(text, lineterminator="\n").writerows([names, *(finite(row, "a row") for row in rows)])
    return text.getvalue()
