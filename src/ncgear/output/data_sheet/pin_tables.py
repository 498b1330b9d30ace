"""The tables of pins in the spaces of one gear, and over two of them."""

from __future__ import annotations

from ncgear.metrology.pins import Misfit, Pins
from ncgear.metrology.two_pins import TwoPins, over_two_pins
from ncgear.output.data_sheet.measured import MeasuredGear
from ncgear.output.data_sheet.values import Column, Table, Value
from ncgear.output.numbers import shown

SINGLE = (
    Column("space after tooth"),
    Column("x of the pin's centre", "mm"),
    Column("y of the pin's centre", "mm"),
)

LIMITS = (Column("least", "mm"), Column("greatest", "mm"))

Place = tuple[int, ...]
"""The space of a pin, or those of two."""

Readings = dict[Place, float]


def pin_tables(gear: MeasuredGear) -> tuple[Table, ...]:
    """The distances from the axis over single pins, and over two nearly opposite ones.

    Tables without rows or notes are left out.
    """
    return tuple(table for table in (_single(gear), _double(gear)) if table.rows or table.notes)


def _single(gear: MeasuredGear) -> Table:
    ring, pins, name = gear.working.is_ring, gear.pins, gear.gear.value
    limits = [_over_one(pins_there) for _, pins_there in gear.at_limits]
    found = zip(pins.space.tolist(), pins.center_mm.tolist(), pins.over_mm.tolist(), strict=True)
    rows = [(space, *center, over, *_among(limits, (space,))) for space, center, over in found]
    far = Column("axis to the pin's near side" if ring else "axis to the pin's far side", "mm")
    columns = (*SINGLE, far, *(LIMITS if limits else ()))
    return Table(f"Pins of {pins.diameter_mm:g} mm in the {name} gear", columns, tuple(rows), _notes(pins))


def _double(gear: MeasuredGear) -> Table:
    word = "between" if gear.working.is_ring else "over"
    columns = (SINGLE[0], Column("and after tooth"), Column(f"{word} two pins", "mm"))
    limits = [_over_two(over_two_pins(working, pins)) for working, pins in gear.at_limits]
    nominal = _over_two(over_two_pins(gear.working, gear.pins))
    rows = tuple((*pair, distance, *_among(limits, pair)) for pair, distance in nominal.items())
    title = f"Measurement {word} two pins of {gear.pins.diameter_mm:g} mm, {gear.gear.value} gear"
    return Table(title, (*columns, *(LIMITS if limits else ())), rows)


def _over_one(pins: Pins) -> Readings:
    return {(space,): over for space, over in zip(pins.space.tolist(), pins.over_mm.tolist(), strict=True)}


def _over_two(found: TwoPins) -> Readings:
    places = zip(found.first.tolist(), found.second.tolist(), strict=True)
    return dict(zip(places, found.distance_mm.tolist(), strict=True))


def _among(limits: list[Readings], place: Place) -> tuple[Value, ...]:
    """The least and the greatest reading in a place at both limits; nothing where pins measure at one limit only."""
    found = [readings[place] for readings in limits if place in readings]
    return tuple(sorted(found)) if len(found) == len(limits) else (None,) * len(limits)


def _notes(pins: Pins) -> tuple[str, ...]:
    """In which spaces pins measure nothing, and why."""
    by_reason = {reason: [space for space, why in pins.misfits.items() if why is reason] for reason in Misfit}
    return tuple(
        f"not defined in the spaces after teeth {shown(spaces)}: {reason.value}"
        for reason, spaces in by_reason.items()
        if spaces
    )
