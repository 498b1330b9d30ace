"""The scripts and the style sheet of the scene, as they stand in the package."""

from __future__ import annotations

from importlib.resources import files

SCRIPTS = ("rising", "angles", "places", "gestures", "scene")
"""In the order in which they build on each other."""


def scene_script() -> str:
    """``createScene``, whose interface is told at the top of scene/scene.js, and what it is made of."""
    return "\n".join(_text(f"scene/{name}.js") for name in SCRIPTS)


def scene_style() -> str:
    """The style sheet that colours the SVG by custom properties."""
    return _text("scene.css")


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
