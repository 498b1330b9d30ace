"""The colours of all that is drawn, each by the name of the thing that has it: the one source of pictures and page.

Pictures, animations and 3D files take the colours on light ground; the page has both, and its style sheet is written
from here.  They are near those of M. Okabe and K. Ito, which differ for any colour vision.  Text on either ground keeps
a contrast of 4.5, lines one of 3 (tests/test_report.py computes them).
"""

from __future__ import annotations

import re
from collections.abc import Mapping

LIGHT: Mapping[str, str] = {
    "paper": "#f5f6f8",
    "panel": "#ffffff",
    "ink": "#1b1f24",
    "muted": "#535b67",
    "rule": "#d3d8df",
    "grid": "#e6e9ee",
    "joint": "#868d98",
    "driving": "#0064a0",
    "driven": "#b04a00",
    "uniform": "#5f6773",
    "highlight": "#a02c6a",
    "link": "#b9c0c7",
    "slider": "#d9dde1",
    "material": "#a8841a",
    "load": "#7f9bab",
    "warning": "#7a4300",
    "warning-ground": "#fff4e0",
}

DARK: Mapping[str, str] = {
    "paper": "#14171b",
    "panel": "#1c2026",
    "ink": "#e8ebef",
    "muted": "#a9b2bf",
    "rule": "#3a414b",
    "grid": "#2b3139",
    "joint": "#7d8794",
    "driving": "#63b5ee",
    "driven": "#ff9d5c",
    "uniform": "#a3adba",
    "highlight": "#e693c6",
    "link": "#566070",
    "slider": "#39424d",
    "material": "#cfa93a",
    "load": "#6d8ba0",
    "warning": "#ffd08a",
    "warning-ground": "#33270f",
}


HOLDING = ("#7a2a00", "#e08a4a", "#f2ead8", "#6aa5cf", "#004a78")
"""Colours of a scale from far too weak to far stronger than wanted; the middle is what just holds.

Brown against blue differ for any colour vision, and both ends are dark on light ground.
"""

STRESS = ("#e9edf0", "#a6c8de", "#f0c98a", "#d5702a", "#7a2a00")
"""Colours of a scale of stress from none to the largest, from light to dark; they differ for any colour vision."""

EXCESS = ("#7a2a00", "#d5702a", "#c9ced4", "#3f8cc4", "#004a78")
"""Colours of a scale from metal that is missing to metal in excess; they differ for any colour vision."""


def style_of_colors() -> str:
    """The colours as custom properties of CSS, for light and for dark ground."""
    light, dark = (_root(colors) for colors in (LIGHT, DARK))
    return f"{light}@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n"


def _root(colors: Mapping[str, str]) -> str:
    lines = "".join(f"  --{name}: {color};\n" for name, color in colors.items())
    return f":root {{\n  color-scheme: light dark;\n{lines}}}\n"


def with_fallbacks(css: str) -> str:
    """A style sheet whose colours are also there in a page that sets none: those on light ground."""
    names = "|".join(LIGHT)
    return re.sub(rf"var\(--({names})\)", lambda found: f"var(--{found[1]}, {LIGHT[found[1]]})", css)
