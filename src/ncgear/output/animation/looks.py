"""Colours and lines of the moving picture, after those of all pictures."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.colors import to_rgb

from ncgear.output.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT, INK
from ncgear.scene.bodies import Kind

MATERIAL = "#C9A227"

PURE = (INK, DRIVING, DRIVEN, HIGHLIGHT, MATERIAL)
"""Colours of lines and dots, which a palette by areas would leave out."""

TINT = 0.24
"""Share of a gear's colour in its filling; the rest is paper."""

Style = dict[str, Any]


def tinted(color: str, share: float = TINT) -> tuple[float, float, float]:
    """A colour thinned with white."""
    red, green, blue = 1.0 - share * (1.0 - np.array(to_rgb(color)))
    return float(red), float(green), float(blue)


BODIES: dict[Kind, Style] = {
    Kind.DRIVING: {"facecolor": (*tinted(DRIVING), 0.88), "edgecolor": DRIVING, "linewidth": 0.7},
    Kind.DRIVEN: {"facecolor": (*tinted(DRIVEN), 0.88), "edgecolor": DRIVEN, "linewidth": 0.7},
    Kind.CRANK: {"facecolor": "#C3C9CF", "edgecolor": INK, "linewidth": 0.8},
    Kind.ROD: {"facecolor": "#C3C9CF", "edgecolor": INK, "linewidth": 0.8},
    Kind.SLIDER: {"facecolor": "#DDE1E5", "edgecolor": INK, "linewidth": 0.8},
}

PITCH_CURVES: dict[Kind, Style] = {
    kind: {"color": color, "linewidth": 0.6, "linestyle": (0, (7, 3, 1.5, 3))}
    for kind, color in ((Kind.DRIVING, DRIVING), (Kind.DRIVEN, DRIVEN))
}

EDGES: dict[Kind, Style] = {
    kind: {"color": color, "linewidth": 0.5, "alpha": 0.7}
    for kind, color in ((Kind.DRIVING, DRIVING), (Kind.DRIVEN, DRIVEN))
}

CHARGE: Style = {"facecolor": tinted(MATERIAL, 0.3), "edgecolor": "none"}
STRAW: Style = {"color": MATERIAL, "linewidth": 0.7}
WALL: Style = {"color": INK, "linewidth": 1.3}
HATCHING: Style = {"color": INK, "linewidth": 0.45, "alpha": 0.6}
ORBIT: Style = {"color": INK, "linewidth": 0.5, "linestyle": (0, (1.5, 4)), "alpha": 0.6}
CENTRES: Style = {"color": INK, "linewidth": 0.6, "linestyle": (0, (8, 2, 1, 2)), "alpha": 0.7}
SHAFT: Style = {"color": INK, "marker": "o", "markersize": 3.6, "linestyle": "none"}
PIN: Style = {"facecolor": "white", "edgecolor": INK, "linewidth": 0.9}
PITCH_POINT: Style = {"color": HIGHLIGHT, "marker": "o", "markersize": 4.2, "linestyle": "none"}
