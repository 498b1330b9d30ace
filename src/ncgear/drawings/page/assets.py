"""Scripts and style sheets of pages, as they stand in files of the package."""

from __future__ import annotations

from base64 import b64encode
from hashlib import sha256
from importlib.resources import files

from ncgear.drawings.palette import style_of_colors, with_fallbacks

PACKAGE = "ncgear.drawings.page"

SCENE_SCRIPTS = ("places", "gestures", "teeth", "scene")
SHARED_SCRIPTS = ("clock", "charts", "find", "controls")
"""Files of scene/ and of script/; each may use the files before it.  The studio uses them too."""


def scene_script() -> str:
    """``createScene``, whose interface is at the top of scene/scene.js, and the functions that it uses."""
    return "\n".join(asset(f"scene/{name}.js") for name in SCENE_SCRIPTS)


def scene_style() -> str:
    """The style sheet that colours the SVG of the scene by custom properties."""
    return with_fallbacks(asset("scene.css"))


def page_style() -> str:
    """The style sheet of a page with charts, tables and a scene."""
    return style_of_colors() + asset("page.css") + scene_style()


def shared_script() -> str:
    """The scene, and all that shows and changes its angle: clock, charts, readouts, controls."""
    return "\n".join([scene_script(), *(asset(f"script/{name}.js") for name in SHARED_SCRIPTS)])


def in_own_scope(*scripts: str) -> str:
    """Scripts together in a scope of their own."""
    return "\n".join(["(() => {", '"use strict";', *scripts, "})();"])


def hash_of(script: str) -> str:
    """The hash of a script, as a policy names it."""
    return f"'sha256-{b64encode(sha256(script.encode()).digest()).decode()}'"


def asset(name: str) -> str:
    """The text of a file of the package."""
    return (files(PACKAGE) / name).read_text(encoding="utf-8")
