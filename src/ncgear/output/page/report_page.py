"""The report of a drive: what it shows, gathered from the stages."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

from markupsafe import Markup

from ncgear import __version__
from ncgear.contact.pair_contact import PairContact
from ncgear.design.load import LoadedDesign
from ncgear.drive import Drive
from ncgear.output.advice.collected import build_advice, check_advice
from ncgear.output.data_sheet.sheet import data_sheet
from ncgear.output.numbers import shown
from ncgear.output.page.data import page_data
from ncgear.output.page.facts import facts, gear_facts
from ncgear.output.page.figure import figure
from ncgear.output.page.gear_charts import gear_charts
from ncgear.output.page.motion_charts import motion_charts
from ncgear.output.page.paces import paces
from ncgear.output.page.render import rendered
from ncgear.output.page.scene_svg import scene_svg
from ncgear.output.page.tables import comparison_tables, contact_tables, sheet_tables, versions
from ncgear.scene.made import scene_of
from ncgear.scene.views import views


def report_page(drive: Drive, loaded: LoadedDesign, contacts: Sequence[PairContact]) -> bytes:
    """The whole page; ``contacts`` are those of the drive's pairs, none for a design without gears.

    The same design gives the same bytes.  Raises WrongInput or NoSuchMechanism as the drive's stages do.
    """
    pairs = list(zip(drive.by_stage, contacts, strict=True)) if contacts else []
    scene = scene_of(drive)
    charts = [*motion_charts(drive, scene.loop_rad), *chain.from_iterable(gear_charts(*pair) for pair in pairs)]
    figures = [figure(chart) for chart in charts]
    data = page_data(scene, charts, [one.drawing for one in figures])
    content = {
        "design": drive.design,
        "figures": figures,
        "data": data,
        "scene": Markup(scene_svg(scene)),
        "views": list(views(scene)),
        "cycle_deg": data["cycle_deg"],
        "facts": [*facts(drive), *chain.from_iterable(gear_facts(*pair) for pair in pairs)],
        "pairs": [_pair(*pair) for pair in pairs],
        "advices": [("", check_advice(drive)), *((stage_name(pair), build_advice(pair)) for pair, _ in pairs)],
    }
    return rendered({**content, **_about_design(drive, loaded)})


def _about_design(drive: Drive, loaded: LoadedDesign) -> dict[str, Any]:
    """What needs no tooth."""
    return {
        "has_gears": drive.design.gears is not None,
        "staged": drive.design.stages > 1,
        "speed": shown(drive.design.operation.speed_rpm),
        "paces": paces(drive.design.operation.speed_rpm),
        "comparison": comparison_tables(drive),
        "text": loaded.text,
        "file_name": loaded.path.name,
        "versions": versions(),
        "ncgear_version": __version__,
    }


def _pair(drive: Drive, contact: PairContact) -> dict[str, Any]:
    sheet = sheet_tables(data_sheet(drive))
    return {"title": stage_name(drive), "sheet": sheet, "contact": contact_tables(drive, contact)}


def stage_name(pair: Drive) -> str:
    """What the page calls one of two pairs; nothing where there is one."""
    return f"Stage {pair.stage}" if pair.stage else ""
