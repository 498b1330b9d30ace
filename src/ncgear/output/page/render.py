"""The page as one file of HTML, which asks for nothing outside itself."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from ncgear.output.page.scene_files import scene_script, scene_style

PACKAGE = "ncgear.output.page"

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
