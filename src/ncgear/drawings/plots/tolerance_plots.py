"""Pictures of assemblies within tolerances: how figures are spread, and what they vary with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.plots.canvas import (
    DRIVEN,
    DRIVING,
    HIGHLIGHT,
    INK,
    REFERENCE,
    SMALL,
    Margins,
    Style,
    dress,
    figure,
    png,
)
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

BINS = 60

ROUNDING = 1e-9
"""Share of a figure that is rounding: bins that are no wider than that cannot be told apart."""

COLORS = DRIVING, DRIVEN, REFERENCE, HIGHLIGHT
"""Colours of the figures whose sources are shown."""


@dataclass(frozen=True, eq=False)
class Spread:
    """A figure of many assemblies (shape (n,)), with its value as designed and a limit, on one side of which is bad.

    ``below`` tells whether assemblies below the limit are bad, else those above; ``beyond`` says what they do.
    """

    label: str
    values: Array
    designed: float
    limit: float | None = None
    below: bool = True
    beyond: str = ""


def spreads(of: Sequence[Spread], title: str) -> bytes:
    """PNG of histograms, two in a row, with limits."""
    rows = -(-len(of) // 2)
    width, height = 8.6, 0.6 + 3.3 * rows
    made = figure(width, height, title)
    made.subplots_adjust(**Margins(top=0.95).shares(width, height), wspace=0.24, hspace=0.45)
    for place, one in enumerate(of):
        _histogram(made.add_subplot(rows, 2, place + 1), one)
    return png(made)


def _histogram(axes: Axes, one: Spread) -> None:
    low, high = one.values.min(), one.values.max()
    room = ROUNDING * max(abs(low), abs(high))
    edges = np.histogram_bin_edges(one.values, BINS, (low - room, high + room))
    counts, _ = np.histogram(one.values, edges)
    shares = 100.0 * counts / one.values.size
    middles = (edges[1:] + edges[:-1]) / 2.0
    bad = np.zeros(middles.size, dtype=bool)
    if one.limit is not None:
        bad = middles < one.limit if one.below else middles > one.limit
    colors = np.where(bad, HIGHLIGHT, DRIVING)
    axes.bar(middles, shares, width=np.diff(edges), color=colors, alpha=0.75, linewidth=0.0)
    axes.axvline(one.designed, color=INK, linewidth=1.2, linestyle="--")
    note: Style = {"size": SMALL, "color": INK, "va": "bottom", "xycoords": ("data", "axes fraction")}
    axes.annotate("as designed", (one.designed, 1.01), ha="center", **note)
    if one.limit is not None and edges[0] <= one.limit <= edges[-1]:
        axes.axvline(one.limit, color=HIGHLIGHT, linewidth=1.4)
        side = "right" if one.below else "left"
        axes.annotate(f" {one.beyond} ", (one.limit, 1.06), ha=side, **{**note, "color": HIGHLIGHT})
    dress(axes, one.label, "share of the assemblies in %")


def sources(of: Mapping[str, Mapping[str, tuple[float, float]]], title: str) -> bytes:
    """PNG of the shares of the variance of figures by their sources, with half the width of their 95 % range.

    ``of`` has, for each figure by its name, the total index and its error of each source by its name.
    """
    names = list(dict.fromkeys(name for one in of.values() for name in one))
    largest = {name: max(one.get(name, (0.0, 0.0))[0] for one in of.values()) for name in names}
    names.sort(key=lambda name: largest[name])
    width, height = 8.2, 1.5 + 0.42 * len(names)
    made = figure(width, height, title)
    made.subplots_adjust(**Margins(left=2.1, right=0.3, top=0.85).shares(width, height))
    axes = made.add_subplot()
    thick = 0.8 / len(of)
    for number, (figure_name, found) in enumerate(of.items()):
        places = np.arange(len(names)) + 0.4 - thick * (number + 0.5)
        values = np.array([found.get(name, (0.0, 0.0)) for name in names])
        bars: Style = {"ecolor": INK, "error_kw": {"linewidth": 0.8}, "color": COLORS[number % len(COLORS)]}
        shown = 100.0 * values
        # Errors do not reach below nothing.
        low = np.minimum(shown[:, 1], shown[:, 0])
        axes.barh(places, shown[:, 0], thick, xerr=np.stack([low, shown[:, 1]]), label=figure_name, **bars)
    axes.set_yticks(np.arange(len(names)), names)
    dress(axes, "share of the variance, with others together, in %", "")
    axes.set_xlim(left=0.0)
    axes.set_ylim(-0.7, len(names) - 0.3)
    axes.grid(False, axis="y")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(of), frameon=False, fontsize=SMALL)
    return png(made)
