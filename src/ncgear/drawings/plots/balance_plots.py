"""Pictures of balance: shaking forces round a cycle, tracks of the centre of mass, and a Campbell plot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from ncgear.balance.excitation import Excitation
from ncgear.drawings.plots.canvas import (
    DRIVEN,
    DRIVING,
    HIGHLIGHT,
    INK,
    REFERENCE,
    SMALL,
    Margins,
    dress,
    figure,
    legend_above,
    png,
)
from ncgear.numerics.arrays import Array

COLORS = (DRIVING, DRIVEN, HIGHLIGHT, REFERENCE)
"""Colours of closed curves; further curves have the same colours, dashed."""

MOST_CURVES = 8
"""Most closed curves in one picture, evenly chosen: nobody could tell more of them apart."""

SLOWEST, FASTEST = 0.2, 1.25
"""The range of speeds of a Campbell plot, as shares of the given speed."""

SAMPLES = 61
"""Points of a line in a Campbell plot; the logarithmic scale bends lines."""

CAUSES = {"rotation": DRIVING, "rollers and teeth": REFERENCE, "engine": HIGHLIGHT, "slider": DRIVEN}
"""Colours of excitations in a Campbell plot, by their cause."""


def loops(curves: Mapping[str, Array], unit: str, title: str) -> bytes:
    """PNG of closed curves (shape (n, 2)) at equal scales, by their names; ``unit`` names both axes."""
    width, height = 7.2, 6.6
    made = figure(width, height, title)
    made.subplots_adjust(**Margins(top=0.9).shares(width, height))
    axes = made.add_subplot()
    names = list(curves)
    places = np.unique(np.linspace(0, len(names) - 1, min(len(names), MOST_CURVES)).round().astype(int))
    for number, name in enumerate(names[place] for place in places):
        color, style = COLORS[number % len(COLORS)], "-" if number < len(COLORS) else "--"
        axes.plot(*curves[name].T, color=color, linestyle=style, linewidth=1.5, label=name)
    axes.set_aspect("equal", adjustable="datalim")
    dress(axes, f"along the slider's line in {unit}", f"across it in {unit}")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False, fontsize=SMALL)
    return png(made)


def campbell(excitations: Sequence[Excitation], natural_hz: Sequence[float], band: float, title: str) -> bytes:
    """PNG of the frequencies of excitations over the machine's speed, with the natural frequencies across.

    ``band`` is a share of a natural frequency: an excitation that is nearer counts as meeting that frequency.  All
    shafts are assumed to speed up and slow down together.
    """
    width, height = 8.6, 6.2
    made = figure(width, height, title)
    made.subplots_adjust(**Margins(right=1.3, top=0.8).shares(width, height))
    axes = made.add_subplot()
    for natural in natural_hz:
        _draw_natural(axes, natural, band)
    share = np.linspace(SLOWEST, FASTEST, SAMPLES)
    for excitation in excitations:
        color = CAUSES[_cause(excitation)]
        axes.plot(100.0 * share, share * excitation.frequency_hz, color=color, linewidth=0.9)
        axes.plot(100.0, excitation.frequency_hz, "o", color=color, markersize=3.0)
    lowest = min(excitation.frequency_hz for excitation in excitations)
    axes.set_ylim(min(min(natural_hz) / 4.0, lowest / 2.0), 1.6 * max(natural_hz))
    axes.set_yscale("log")
    axes.set_xlim(100.0 * SLOWEST, 100.0 * FASTEST)
    axes.axvline(100.0, color=INK, linewidth=0.8, linestyle=":")
    for cause, color in CAUSES.items():
        axes.plot([], [], color=color, label=cause)
    dress(axes, "speed in % of the one given", "frequency in Hz")
    legend_above(axes)
    return png(made)


def _cause(excitation: Excitation) -> str:
    if excitation.kind.startswith("harmonic"):
        return "slider"
    if excitation.kind in ("combustion", "inertia"):
        return "engine"
    return "rotation" if excitation.kind == "rotation" else "rollers and teeth"


def _draw_natural(axes: Axes, natural_hz: float, band: float) -> None:
    """A natural frequency with its band, and its value at the right end."""
    axes.axhspan((1.0 - band) * natural_hz, (1.0 + band) * natural_hz, color=INK, alpha=0.06, linewidth=0.0)
    axes.axhline(natural_hz, color=INK, linewidth=1.0)
    axes.annotate(
        f"{natural_hz:.4g} Hz",
        (1.0, natural_hz),
        xycoords=("axes fraction", "data"),
        xytext=(4.0, 0.0),
        textcoords="offset points",
        size=SMALL,
        color=INK,
        va="center",
    )
