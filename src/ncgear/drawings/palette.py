"""The colours of all drawings, each named after the thing that has it: the only source for pictures and page.

Pictures, animations and 3D files take the colours on light ground; the page has both, and its style sheet is written
from here.  They are near the colours of M. Okabe and K. Ito, which differ for any colour vision.  Text on either ground
keeps a contrast of 4.5, lines a contrast of 3 (tests/test_report.py computes them).
"""

from __future__ import annotations

import re
from collections.abc import Mapping

COLORS: Mapping[str, tuple[str, str]] = {
    "paper": ("#f5f6f8", "#14171b"),
    "panel": ("#ffffff", "#1c2026"),
    "ink": ("#1b1f24", "#e8ebef"),
    "muted": ("#535b67", "#a9b2bf"),
    "rule": ("#d3d8df", "#3a414b"),
    "grid": ("#e6e9ee", "#2b3139"),
    "joint": ("#868d98", "#7d8794"),
    "driving": ("#0064a0", "#63b5ee"),
    "driven": ("#b04a00", "#ff9d5c"),
    "uniform": ("#5f6773", "#a3adba"),
    "highlight": ("#a02c6a", "#e693c6"),
    "link": ("#b9c0c7", "#566070"),
    "slider": ("#d9dde1", "#39424d"),
    "material": ("#a8841a", "#cfa93a"),
    "load": ("#7f9bab", "#6d8ba0"),
    "warning": ("#7a4300", "#ffd08a"),
    "warning-ground": ("#fff4e0", "#33270f"),
}
LIGHT, DARK = ({name: both[ground] for name, both in COLORS.items()} for ground in (0, 1))


HOLDING = ("#7a2a00", "#e08a4a", "#f2ead8", "#6aa5cf", "#004a78")
"""Colours of a scale from far too weak to far stronger than wanted; teeth in the middle just hold.

Brown against blue differ for any colour vision, and both ends are dark on light ground."""

STRESS = ("#e9edf0", "#a6c8de", "#f0c98a", "#d5702a", "#7a2a00")
"""Colours of a scale of stress from none to the largest, from light to dark; they differ for any colour vision."""

EXCESS = ("#7a2a00", "#d5702a", "#c9ced4", "#3f8cc4", "#004a78")
"""Colours of a scale from missing metal to excess metal; they differ for any colour vision."""


def style_of_colors() -> str:
    """The colours as custom properties of CSS, for light and for dark ground."""
    lines = ("".join(f"  --{name}: {color};\n" for name, color in colors.items()) for colors in (LIGHT, DARK))
    light, dark = (f":root {{\n  color-scheme: light dark;\n{values}}}\n" for values in lines)
    return f"{light}@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n"


def with_fallbacks(css: str) -> str:
    """A style sheet with colours also for a page that sets none: the colours on light ground."""
    names = "|".join(LIGHT)
    return re.sub(rf"var\(--({names})\)", lambda found: f"var(--{found[1]}, {LIGHT[found[1]]})", css)
