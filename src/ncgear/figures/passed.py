"""What is told of the room beside the gears: how near crank pin and rods pass what stands there, and when."""

from __future__ import annotations

from math import degrees
from typing import Any

from ncgear.figures.data_sheet.entry import Entry
from ncgear.project.drive import Drive
from ncgear.project.passing import CRANK_PIN


def passed_summary(drive: Drive) -> dict[str, Any]:
    """The section ``fit`` of the summary: nothing for gears that turn no crank.

    The keys of each distance begin with the names of both, as ``rod_to_driving_shaft``.  ``width_max`` is the widest
    part that passes, less than 0 where none does; ``clearance`` is there where the width is given.
    """
    found: dict[str, Any] = {}
    for one in drive.passings:
        name = f"{one.part} to {one.standing.name}".replace("'s", "").replace(" ", "_")
        found[f"{name}_min_mm"] = one.distance_mm
        found[f"{name}_min_at_rad"] = one.phi1_rad
        if one.room_mm is not None:
            found[f"{name}_width_max_mm"] = one.room_mm
        if one.clearance_mm is not None:
            found[f"{name}_clearance_mm"] = one.clearance_mm
    return {"fit": found} if found else {}


def passed_rows(drive: Drive) -> tuple[Entry, ...]:
    """The same as rows of the data sheet: distances between middles, the angles, and the widest part that passes."""
    rows = []
    for one in drive.passings:
        name, room = f"{one.part} to {one.standing.name}", one.room_mm
        rows.append(Entry(f"{name}: least distance of their middles", "mm", pair=one.distance_mm))
        rows.append(Entry(f"{name}: driving angle there", "deg", pair=degrees(one.phi1_rad)))
        if room is not None:
            rows.append(Entry(f"{name}: widest {one.part} that passes", "mm", pair=room if room > 0.0 else "none"))
        if one.clearance_mm is not None:
            rows.append(Entry(f"{name}: clearance, under 0 where they meet", "mm", pair=one.clearance_mm))
    rows += [Entry(f"{shaft} beside the {part}", pair="must end below it") for part, shaft in shafts_below(drive)]
    return tuple(rows)


def shafts_below(drive: Drive) -> list[tuple[str, str]]:
    """Each rod that meets the driving gear's shaft or hub, and what must end below it."""
    return [
        (one.part, one.standing.name)
        for one in drive.passings
        if one.meets and one.part != CRANK_PIN and one.standing.about_driving_axis
    ]
