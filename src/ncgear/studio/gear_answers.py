"""The chains of the gears: one makes and shows the gears, the other judges their contact and strength."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ncgear.design.reading.design_file import LoadedTrain
from ncgear.drawings.charts.chart import Quantity
from ncgear.drawings.page.data import scene_data
from ncgear.drawings.page.motion_charts import cycle_angles_rad, motion_charts
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.scene.scene import Scene, scene_of, scene_of_teeth, scene_without_gears
from ncgear.errors import DesignError
from ncgear.project.drive import Drive
from ncgear.studio.drawing import require_or_fit
from ncgear.studio.messages import Answer, Asked
from ncgear.studio.motion_answers import live, power_needs_gears


def gear_answers(drive: Asked) -> Iterator[Answer]:
    """The machine and its teeth: ``power`` where it counts them, ``scene``, and again with bore and holes.

    Where the gears of the design cannot be made, ``bare`` is the mechanism without them.
    """
    if isinstance(drive, LoadedTrain):
        return
    try:
        scene = scene_of_teeth(drive)
    except DesignError:
        yield "bare", _shown(scene_without_gears(drive), gears=False)
        raise
    if power_needs_gears(drive):
        power = motion_charts(drive, scene.loop_rad, [Quantity.POWER], cycle_angles_rad(drive))
        yield "power", [live(chart) for chart in power]
    has_gears = drive.design.gears is not None
    yield "scene", _shown(scene, gears=has_gears)
    if has_gears:
        yield "scene", _shown(scene_of(drive), gears=True)


def contact_answers(drive: Asked) -> Iterator[Answer]:
    """Answers about the teeth: ``teeth``, ``strength``, each ``chart``, ``verdict``; for refused teeth ``fitted``."""
    from ncgear.drawings.page.page import stage_name
    from ncgear.drawings.page.page_charts import charts_of_pair
    from ncgear.drawings.page.tables import strength_tables, typeset
    from ncgear.figures.advice.verdict import KnownParts, judged
    from ncgear.figures.answers.machine import gear_facts
    from ncgear.studio.told import drawn_charts, safety_facts, table_data, verdict_data

    if isinstance(drive, LoadedTrain) or drive.design.gears is None:
        return
    pairs = [(stage_name(pair), pair) for pair in drive.by_stage]
    yield from require_or_fit(drive)
    yield (
        "teeth",
        {
            "facts": [fact for _, pair in pairs for fact in typeset(gear_facts(pair), pair.of)],
            "tables": [_contact_table(stage, pair) for stage, pair in pairs],
        },
    )
    strong = [table_data(table) for _, pair in pairs for table in strength_tables(pair)]
    yield "strength", {"facts": safety_facts(drive.by_stage), "tables": strong}
    for _, pair in pairs:
        yield from drawn_charts(charts_of_pair(pair, {}, pair.designed_contact.placement.cycle_rad))
    yield "verdict", verdict_data(judged(drive, KnownParts.TEETH, seconds=0.0))


def _shown(scene: Scene, *, gears: bool) -> dict[str, Any]:
    return {"svg": scene_svg(scene), "data": scene_data(scene), "gears": gears}


def _contact_table(stage: str, pair: Drive) -> dict[str, Any]:
    from ncgear.drawings.page.tables import beside
    from ncgear.figures.summary.build_summary import designed_contact
    from ncgear.studio.told import table_data

    found = designed_contact(pair.designed_contact, pair.contact_extremes)
    return table_data(beside(f"Contact of the teeth{f', {stage}' if stage else ''}", {"as designed": found}))
