"""The table of spans of one gear."""

from __future__ import annotations

import numpy as np

from ncgear.metrology.span import Spans, spans
from ncgear.numerics.arrays import Array
from ncgear.output.data_sheet.measured import MeasuredGear
from ncgear.output.data_sheet.values import Column, Table, Value

COLUMNS = (
    Column("from the back of tooth"),
    Column("to the front of tooth"),
    Column("teeth between the plates"),
    Column("phi1 at their middle", "deg"),
    Column("span", "mm"),
    Column("reading when the caliper is tilted"),
)

SETTLES, SWINGS, EVEN = "grows", "falls", "stays"


def span_table(gear: MeasuredGear, found: Spans) -> tuple[Table, ...]:
    """The spans of a gear; none of one on which no span is defined."""
    if not found.first.size:
        return ()
    limits = _limits(gear, found)
    columns = (*COLUMNS, Column("least", "mm"), Column("greatest", "mm")) if limits else COLUMNS
    rows = zip(*_cells(found), *limits, strict=True)
    return (Table(f"Span of the {gear.gear.value} gear", columns, tuple(rows)[: _shown(found)], _notes(found)),)


def _shown(found: Spans) -> int:
    """One row stands for all of a circular gear."""
    return 1 if found.everywhere else found.first.size


def _cells(found: Spans) -> list[list[Value]]:
    tilted = [EVEN if found.everywhere else SETTLES if least else SWINGS for least in found.least]
    return [
        found.first.tolist(),
        found.last.tolist(),
        found.teeth.tolist(),
        np.degrees(found.phi1_rad).tolist(),
        found.distance_mm.tolist(),
        tilted,
    ]


def _limits(gear: MeasuredGear, found: Spans) -> list[list[float]]:
    """Least and greatest spans: the thickness along the pitch curve adds its cos(alpha) share to every span."""
    if gear.limits_mm is None:
        return []
    share = np.cos(gear.working.flanks.rack.pressure_angle_rad) * gear.working.base_cosine
    moved: list[Array] = [found.distance_mm + limit * share for limit in gear.limits_mm]
    return [column.tolist() for column in moved]


def _notes(found: Spans) -> tuple[str, ...]:
    if found.everywhere:
        return ("a circular gear has the same span over as many teeth anywhere",)
    missed = f"; in {found.beyond} more they would touch beyond the flanks" if found.beyond else ""
    return (
        "only in these places do the plates of a caliper touch both flanks along one normal: elsewhere the reading "
        f"changes as it is tilted until a plate's edge or a tip is touched{missed}",
        "where the reading grows, the caliper settles at the span; where it falls, the span is the greatest reading",
    )


def spans_of(gear: MeasuredGear) -> Spans:
    """The gear's spans."""
    return spans(gear.working)
