"""The page of the studio as one file of HTML; everything that it shows comes over its web socket."""

from __future__ import annotations

from importlib.resources import files

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from ncgear import __version__
from ncgear.drawings.page.assets import PACKAGE, hash_of, in_own_scope, page_style, shared_script
from ncgear.studio.beginnings import GROUPS, beginnings
from ncgear.studio.jobs import COMMANDS

WEB = "ncgear.studio.web"

SCRIPTS = ("link", "machine", "lines", "handles", "drawing", "board", "form", "told", "making", "saving", "studio")
"""Files of web/script/; each may use those before it."""

VIEWS = ("machine", "gears", "mesh")


def page(file_name: str) -> tuple[str, str]:
    """The page, and its content security policy: it runs its own script only, and talks to its own server only."""
    loader = ChoiceLoader([PackageLoader(WEB, ""), PackageLoader(PACKAGE, "")])
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
    script = in_own_scope(shared_script(), *(_asset(f"script/{name}.js") for name in SCRIPTS))
    content = environment.get_template("studio.html.j2").render(
        file_name=file_name,
        ncgear_version=__version__,
        commands=COMMANDS,
        views=VIEWS,
        gears=(("driving", "driving", 1), ("driven", "driven", 1)),
        cycle_deg=360,
        paces=(),
        css=Markup(page_style() + _asset("studio.css")),
        script=Markup(script),
    )
    policy = (
        f"default-src 'none'; script-src {hash_of(script)}; style-src 'unsafe-inline'; connect-src 'self'; "
        "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    return content, policy


def start_page(folder: str, problem: str = "") -> tuple[str, str]:
    """The page of a studio without a file, which has no script, and its policy: its form goes to its own server."""
    environment = Environment(loader=PackageLoader(WEB, ""), autoescape=True, undefined=StrictUndefined)
    choices = beginnings()
    content = environment.get_template("start.html.j2").render(
        groups=[(group, [one for one in choices if one.group == group]) for group in GROUPS],
        folder=folder,
        problem=problem,
        ncgear_version=__version__,
        css=Markup(page_style() + _asset("studio.css")),
    )
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'self'"
    return content, f"{policy}; frame-ancestors 'none'"


def _asset(name: str) -> str:
    return (files(WEB) / name).read_text(encoding="utf-8")
