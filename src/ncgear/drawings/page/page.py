"""The scripts and the style sheet of the scene, as they stand in the package.

The page as one file of HTML, which asks for nothing outside itself.

The report of a drive: what it shows, gathered from the stages.
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
from ncgear.drawings.page.chart_svg import figure
from ncgear.drawings.page.charts import gear_charts, motion_charts
from ncgear.drawings.page.data import paces, page_data
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.page.tables import comparison_tables, contact_tables, facts, gear_facts, sheet_tables, versions
from ncgear.drawings.scene.scene import scene_of
from ncgear.drawings.scene.standing import views
from ncgear.figures.advice.collected import build_advice, check_advice
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.figures.numbers import shown
from ncgear.project.drive import Drive

SCENE_SCRIPTS = ("rising", "angles", "places", "gestures", "scene")
"""In the order in which they build on each other."""


def scene_script() -> str:
    """``createScene``, whose interface is told at the top of scene/scene.js, and what it is made of."""
    return "\n".join(_text(f"scene/{name}.js") for name in SCENE_SCRIPTS)


def scene_style() -> str:
    """The style sheet that colours the SVG by custom properties."""
    return _text("scene.css")


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


PACKAGE = "ncgear.drawings.page"

SCRIPTS = ("interpolation", "shafts", "clock", "charts", "readouts", "controls", "page")
"""In the order in which they build on each other."""

JSON_FORM = {"separators": (",", ":"), "sort_keys": False, "allow_nan": False}


def rendered(content: Mapping[str, Any]) -> bytes:
    """The page of some content; text in it is escaped, and only the page's own script may run."""
    code = script()
    page = (
        _environment()
        .get_template("template.html.j2")
        .render(**content, css=Markup(_asset("page.css") + scene_style()), script=Markup(code), policy=policy(code))
    )
    return page.encode()


def script() -> str:
    """The page's code, in a scope of its own."""
    parts = [scene_script(), *(_asset(f"script/{name}.js") for name in SCRIPTS)]
    return "\n".join(["(() => {", '"use strict";', *parts, "})();"])


def policy(code: str) -> str:
    """No request of any kind, and no code but this."""
    own = b64encode(sha256(code.encode()).digest()).decode()
    return (
        f"default-src 'none'; script-src 'sha256-{own}'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
    )


def _environment() -> Environment:
    made = Environment(loader=PackageLoader(PACKAGE, ""), autoescape=True, undefined=StrictUndefined, trim_blocks=False)
    made.policies["json.dumps_kwargs"] = JSON_FORM
    return made


def _asset(name: str) -> str:
    return (files(PACKAGE) / name).read_text(encoding="utf-8")


def report_page(drive: Drive, loaded: LoadedDesign, contacts: Sequence[PairContact]) -> bytes:
    """The whole page; ``contacts`` are those of the drive's pairs, none for a design without gears.

    The same design gives the same bytes.  Raises WrongInput or NoSuchMechanism as the drive does.
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
