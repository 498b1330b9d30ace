"""Tolerances as given, and what of the measurements is defined."""

from __future__ import annotations

from ncgear.drive import Drive
from ncgear.metrology.span import Spans
from ncgear.output.data_sheet.measured import MeasuredGear
from ncgear.output.data_sheet.values import Group, Row, Value


def tolerances(drive: Drive) -> tuple[Group, ...]:
    """The group of the tolerances; none where the design gives none."""
    given = drive.gears.tolerances
    if given is None:
        return ()
    rows = (
        Row("standard", pair=given.standard or None),
        Row("accuracy grade", pair=given.grade or None),
        Row("upper deviation of tooth thickness", "mm", pair=given.tooth_thickness_upper_mm),
        Row("lower deviation of tooth thickness", "mm", pair=given.tooth_thickness_lower_mm),
        Row("note", pair=given.note or None),
    )
    return (Group("Tolerances, as given", tuple(row for row in rows if row.of_pair)),)


def measurements(drive: Drive, gears: tuple[MeasuredGear, MeasuredGear], spans: tuple[Spans, Spans]) -> Group:
    """What is measured with, and in how many places it can be."""
    driving, driven = gears
    rows = (
        *([Row("section that is measured, z", "mm", pair=drive.helix.rise_mm / 2.0)] if drive.helix else []),
        Row(_tool(driving), "mm", driving=driving.pins.diameter_mm, driven=driven.pins.diameter_mm),
        Row("spaces in which they measure", driving=_spaces(driving), driven=_spaces(driven)),
        Row("places of a span", driving=_places(driving, spans[0]), driven=_places(driven, spans[1])),
    )
    return Group("Measurements of the teeth", rows)


def _tool(gear: MeasuredGear) -> str:
    return "diameter of measuring pins" if gear.working.base_cosine == 1.0 else "diameter of measuring balls"


def _spaces(gear: MeasuredGear) -> Value:
    measured, teeth = gear.pins.space.size, gear.toothed.teeth
    return "all" if measured == teeth else f"{measured} of {teeth}"


def _places(gear: MeasuredGear, spans: Spans) -> Value:
    if gear.working.is_ring:
        return "not defined: plates do not reach the flanks of a ring"
    if gear.working.flanks.equivalent:
        return "not defined: flanks of equivalent gears do not follow the pitch curve"
    if spans.everywhere:
        return "everywhere alike"
    if not spans.first.size:
        return "not defined: nowhere do two plates touch flanks along one normal"
    return int(spans.first.size)
