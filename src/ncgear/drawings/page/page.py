"""The report of a drive as one file of HTML, which loads nothing from outside.

The values come from the drive and are put into ``template.html.j2``, together with the style sheets and the scripts of
this folder.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from hashlib import sha256
from importlib.resources import files
from itertools import chain
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from ncgear import __version__
from ncgear.contact.pair import PairContact
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.drawings.page.chart_svg import drawn
from ncgear.drawings.page.data import paces, page_data
from ncgear.drawings.page.page_charts import gear_charts, motion_charts
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.page.tables import (
    comparison_tables,
    contact_tables,
    facts,
    gear_facts,
    sheet_tables,
    strength_tables,
    versions,
)
from ncgear.drawings.palette import style_of_colors, with_fallbacks
from ncgear.drawings.scene.scene import scene_of
from ncgear.drawings.scene.standing import views
from ncgear.figures.advice.collected import build_advice, check_advice
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.figures.numbers import shown
from ncgear.figures.wished import achieved_lines
from ncgear.project.drive import Drive

PACKAGE = "ncgear.drawings.page"

SCENE_SCRIPTS = ("angles", "places", "gestures", "scene")
PAGE_SCRIPTS = ("shafts", "clock", "charts", "readouts", "controls", "page")
"""Files of scene/ and of script/; each may use those before it."""

JSON_FORM = {"separators": (",", ":"), "sort_keys": False, "allow_nan": False}


def report_page(drive: Drive, loaded: LoadedDesign, contacts: Sequence[PairContact]) -> bytes:
    """The whole page; ``contacts`` are those of the drive's pairs, none for a design without gears.

    The same design gives the same bytes.  Raises WrongInput or NoSuchMechanism as the drive does.
    """
    pairs = list(zip(drive.by_stage, contacts, strict=True)) if contacts else []
    scene = scene_of(drive)
    charts = [*motion_charts(drive, scene.loop_rad), *chain.from_iterable(gear_charts(*pair) for pair in pairs)]
    figures = [drawn(chart) for chart in charts]
    data = page_data(scene, figures)
    about_pairs = {
        "facts": [*facts(drive), *chain.from_iterable(gear_facts(pair) for pair, _ in pairs)],
        "pairs": [
            {
                "title": _stage_name(pair),
                "sheet": sheet_tables(data_sheet(pair)),
                "contact": contact_tables(pair, found),
                "strength": strength_tables(pair),
            }
            for pair, found in pairs
        ],
        "advices": [("", check_advice(drive)), *((_stage_name(pair), build_advice(pair)) for pair, _ in pairs)],
    }
    about_design = {
        "design": drive.design,
        "has_gears": drive.design.gears is not None,
        "staged": drive.design.stages > 1,
        "speed": shown(drive.design.operation.speed_rpm),
        "achieved": achieved_lines(drive.achieved, drive.linkage) if drive.achieved else [],
        "comparison": comparison_tables(drive),
        "uniform": drive.linkage.UNIFORM,
        "load": drive.linkage.OUTPUT.load_name,
        "text": loaded.text,
        "file_name": loaded.path.name,
        "versions": versions(),
        "ncgear_version": __version__,
    }
    moving = {
        "figures": figures,
        "data": data,
        "cycle_deg": data["cycle_deg"],
        "scene": Markup(scene_svg(scene)),
        "views": list(views(scene)),
        "paces": paces(drive.design.operation.speed_rpm),
    }
    return _rendered({**about_design, **about_pairs, **moving})


def _stage_name(pair: Drive) -> str:
    """The name of one of two pairs on the page; empty where there is only one pair."""
    return f"Stage {pair.stage}" if pair.stage else ""


def _rendered(content: Mapping[str, Any]) -> bytes:
    """The page with the given content, whose text is escaped; only the page's own script may run."""
    environment = Environment(loader=PackageLoader(PACKAGE, ""), autoescape=True, undefined=StrictUndefined)
    environment.policies["json.dumps_kwargs"] = JSON_FORM
    template = environment.get_template("template.html.j2")
    css, script = style_of_colors() + _asset("page.css") + scene_style(), _page_script()
    return template.render(**content, css=Markup(css), script=Markup(script), policy=_policy(script)).encode()


def scene_script() -> str:
    """``createScene``, whose interface is at the top of scene/scene.js, and the functions that it uses."""
    return "\n".join(_asset(f"scene/{name}.js") for name in SCENE_SCRIPTS)


def scene_style() -> str:
    """The style sheet that colours the SVG of the scene by custom properties."""
    return with_fallbacks(_asset("scene.css"))


def _page_script() -> str:
    """The page's code, in a scope of its own."""
    parts = [scene_script(), *(_asset(f"script/{name}.js") for name in PAGE_SCRIPTS)]
    return "\n".join(["(() => {", '"use strict";', *parts, "})();"])


def _policy(script: str) -> str:
    """The policy of the page: it makes no request of any kind, and runs no code but this script."""
    own = b64encode(sha256(script.encode()).digest()).decode()
    return (
        f"default-src 'none'; script-src 'sha256-{own}'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
    )


def _asset(name: str) -> str:
    return (files(PACKAGE) / name).read_text(encoding="utf-8")
