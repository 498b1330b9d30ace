"""The script and the style sheet of the scene, as they stand in the package."""

from __future__ import annotations

from importlib.resources import files


def scene_script() -> str:
    """``createScene`` of scene.js; its interface is told at its top."""
    return _text("scene.js")


def scene_style() -> str:
    """The style sheet that colours the SVG by custom properties."""
    return _text("scene.css")


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
