"""The report of a drive as one file of HTML, which loads nothing from outside.

The values come from the drive and are put into ``template.html.j2``, together with the style sheets and the scripts of
this folder.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from ncgear import __version__
from ncgear.contact.pair import PairContact
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.drawings.beside import HERE, PAGE_CHARTS, Drawer
from ncgear.drawings.page.assets import PACKAGE, asset, hash_of, in_own_scope, page_style, shared_script
from ncgear.drawings.page.chart_figure import shaft_of
from ncgear.drawings.page.data import paces, page_data
from ncgear.drawings.page.motion_charts import motion_charts
from ncgear.drawings.page.page_charts import gear_charts
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.page.tables import ToothLinks, contact_tables, sheet_tables, strength_tables, typeset, versions
from ncgear.drawings.scene.scene import scene_of
from ncgear.drawings.scene.standing import views
from ncgear.drawings.solid_pair import solid_view
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.answers.machine import gear_facts, machine_facts
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.figures.numbers import shown
from ncgear.figures.summary.check_summary import comparison_rows, comparison_tables, names_between
from ncgear.figures.wished import achieved_lines
from ncgear.project.drive import Drive

JSON_FORM = {"separators": (",", ":"), "sort_keys": False, "allow_nan": False}


def report_page(
    drive: Drive, loaded: LoadedDesign, contacts: Sequence[PairContact], verdict: Verdict, drawer: Drawer = HERE
) -> bytes:
    """The whole page; ``contacts`` has the contact of each pair of gears, and is empty for a design without gears.

    ``verdict`` is the verdict on the machine, ``drawer`` draws the charts.  The same design gives the same bytes.
    Raises WrongInput or NoSuchMechanism as the drive does.
    """
    pairs = list(zip(drive.by_stage, contacts, strict=True)) if contacts else []
    scene = scene_of(drive)
    charts = [*motion_charts(drive, scene.loop_rad), *chain.from_iterable(gear_charts(*pair) for pair in pairs)]
    drawn = drawer.begun(PAGE_CHARTS, charts)
    about_pairs = {
        "facts": [
            *typeset(machine_facts(drive)),
            *chain.from_iterable(typeset(gear_facts(pair), pair.of) for pair, _ in pairs),
        ],
        "pairs": [
            {
                "title": stage_name(pair),
                "teeth": ToothLinks(pair.stage),
                "sheet": sheet_tables(data_sheet(pair)),
                "contact": contact_tables(pair, found),
                "strength": strength_tables(pair),
            }
            for pair, found in pairs
        ],
        "verdict": verdict,
        "advices": [(row.of, ToothLinks(row.stage), row.advices) for row in verdict.rows],
    }
    about_design = {
        "design": drive.design,
        "has_gears": drive.design.gears is not None,
        "shafts_between": [(name, shaft_of(number)) for number, name in enumerate(names_between(drive), start=2)],
        "speed": shown(drive.design.operation.speed_rpm),
        "achieved": achieved_lines(drive.achieved, drive.linkage) if drive.achieved else [],
        "comparison": comparison_tables(comparison_rows(drive)),
        "compared": "Comparison",
        "uniform": drive.linkage.UNIFORM,
        "load": drive.linkage.OUTPUT.load_name,
        "text": loaded.text,
        "file_name": loaded.path.name,
    }
    solids = [solid_view(pair.solids, pair.pitch.center_distance_mm, stage_name(pair)) for pair, _ in pairs]
    svg = Markup(scene_svg(scene))
    figures = drawn()
    data = page_data(scene, figures)
    moving = {
        "figures": figures,
        "data": data,
        "cycle_deg": data["cycle_deg"],
        "scene": svg,
        "views": list(views(scene)),
        "solids": solids,
        "gears": [
            (gear.body.name, gear.body.name.replace("-", " of stage "), len(gear.teeth_mm)) for gear in scene.gears
        ],
        "paces": paces(drive.design.operation.speed_rpm),
    }
    return rendered({**about_design, **about_pairs, **moving})


def stage_name(pair: Drive) -> str:
    """The name of a pair on the page; empty where there is a single pair."""
    return f"Stage {pair.stage}" if pair.stage else ""


def rendered(content: Mapping[str, Any]) -> bytes:
    """The page with the given content, whose text is escaped; only the page's own script may run."""
    environment = Environment(loader=PackageLoader(PACKAGE, ""), autoescape=True, undefined=StrictUndefined)
    environment.policies["json.dumps_kwargs"] = JSON_FORM
    template = environment.get_template("template.html.j2")
    css, script = page_style(), in_own_scope(shared_script(), asset("script/page.js"))
    policy = _policy([hash_of(script), *(view.script_hash for view in content["solids"])])
    made = {"versions": versions(), "plain": ToothLinks(), "ncgear_version": __version__}
    return template.render(**content, **made, css=Markup(css), script=Markup(script), policy=policy).encode()


def _policy(hashes: Sequence[str]) -> str:
    """The policy of the page: it makes no request to anywhere, and runs no code but the scripts with these hashes.

    The frames of gears in 3D have the same policy; they read their model from an address that holds the data itself.
    """
    connect = "connect-src data:; " if len(hashes) > 1 else ""
    return (
        f"default-src 'none'; script-src {' '.join(dict.fromkeys(hashes))}; {connect}style-src 'unsafe-inline'; "
        "base-uri 'none'; form-action 'none'"
    )
