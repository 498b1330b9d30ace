"""The files of a run of tolerances: figures, assemblies, pictures of the distributions of figures and their causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.canvas import Style
from ncgear.figures.numbers import json_text
from ncgear.figures.toleranced import assemblies_csv, source_words, tolerance_json
from ncgear.files.build import folder_of
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.project.tolerance import Tolerated
from ncgear.tolerances.study import PairStudy

BINS = 60

ROUNDING = 1e-9
"""Relative rounding error of a figure: narrower bins have no meaning."""

COLORS = canvas.DRIVING, canvas.DRIVEN, canvas.REFERENCE, canvas.HIGHLIGHT
"""Colours of the figures whose sources are shown."""


@dataclass(frozen=True, eq=False)
class FigureSpread:
    """A figure of many assemblies (shape (n,)), with its designed value and a limit; one side of the limit is bad.

    ``below`` is true where assemblies below the limit are bad, else assemblies above it; ``beyond`` names the failure.
    """

    label: str
    values: Array
    designed: float
    limit: float | None = None
    below: bool = True
    beyond: str = ""


def spreads(of: Sequence[FigureSpread], title: str) -> bytes:
    """PNG of histograms, two in a row, with limits."""
    rows = -(-len(of) // 2)
    width, height = 8.6, 0.6 + 3.3 * rows
    made = canvas.figure(width, height, title, canvas.Margins(top=0.95), wspace=0.24, hspace=0.45)
    for place, spread in enumerate(of):
        _histogram(made.add_subplot(rows, 2, place + 1), spread)
    return canvas.png(made)


def _histogram(axes: Axes, spread: FigureSpread) -> None:
    low, high = spread.values.min(), spread.values.max()
    room = ROUNDING * max(abs(low), abs(high))
    edges = np.histogram_bin_edges(spread.values, BINS, (low - room, high + room))
    counts, _ = np.histogram(spread.values, edges)
    shares = 100.0 * counts / spread.values.size
    middles = (edges[1:] + edges[:-1]) / 2.0
    bad = np.zeros(middles.size, dtype=bool)
    if spread.limit is not None:
        bad = middles < spread.limit if spread.below else middles > spread.limit
    colors = np.where(bad, canvas.HIGHLIGHT, canvas.DRIVING)
    axes.bar(middles, shares, width=np.diff(edges), color=colors, alpha=0.75, linewidth=0.0)
    axes.axvline(spread.designed, color=canvas.INK, linewidth=1.2, linestyle="--")
    note: Style = {"size": canvas.SMALL, "color": canvas.INK, "va": "bottom", "xycoords": ("data", "axes fraction")}
    axes.annotate("as designed", (spread.designed, 1.01), ha="center", **note)
    if spread.limit is not None and edges[0] <= spread.limit <= edges[-1]:
        axes.axvline(spread.limit, color=canvas.HIGHLIGHT, linewidth=1.4)
        side = "right" if spread.below else "left"
        axes.annotate(f" {spread.beyond} ", (spread.limit, 1.06), ha=side, **{**note, "color": canvas.HIGHLIGHT})
    canvas.dress(axes, spread.label, "share of the assemblies in %")


def sources(of: Mapping[str, Mapping[str, tuple[float, float]]], title: str) -> bytes:
    """PNG of the shares of the variance of figures by their sources, with half the width of their 95 % range.

    ``of`` has, for each figure by its name, the total index and its error of each source by its name.
    """
    names = list(dict.fromkeys(name for shares in of.values() for name in shares))
    largest = {name: max(shares.get(name, (0.0, 0.0))[0] for shares in of.values()) for name in names}
    names.sort(key=lambda name: largest[name])
    width, height = 8.2, 1.5 + 0.42 * len(names)
    made = canvas.figure(width, height, title, canvas.Margins(left=2.1, right=0.3, top=0.85))
    axes = made.add_subplot()
    thick = 0.8 / len(of)
    for number, (figure_name, found) in enumerate(of.items()):
        places = np.arange(len(names)) + 0.4 - thick * (number + 0.5)
        values = np.array([found.get(name, (0.0, 0.0)) for name in names])
        bars: Style = {"ecolor": canvas.INK, "error_kw": {"linewidth": 0.8}, "color": COLORS[number % len(COLORS)]}
        shown = 100.0 * values
        # Errors do not reach below nothing.
        low = np.minimum(shown[:, 1], shown[:, 0])
        axes.barh(places, shown[:, 0], thick, xerr=np.stack([low, shown[:, 1]]), label=figure_name, **bars)
    axes.set_yticks(np.arange(len(names)), names)
    canvas.dress(axes, "share of the variance, with others together, in %", "")
    axes.set_xlim(left=0.0)
    axes.set_ylim(-0.7, len(names) - 0.3)
    axes.grid(False, axis="y")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(of), frameon=False, fontsize=canvas.SMALL)
    return canvas.png(made)


SHOWN = {"least_play_mm": "least play", "transmission_error_mm": "transmission error", "motion_error": "motion error"}
"""The figures whose sources are drawn."""


def tolerance_files(tolerated: Tolerated) -> dict[str, bytes]:
    """JSON, CSV and pictures; a picture of causes where something varies; two pairs have their pictures in folders."""
    files = {
        "tolerance.json": json_text(tolerance_json(tolerated)).encode(),
        "assemblies.csv": assemblies_csv(tolerated).encode(),
        "spread.png": _spreads(tolerated),
    }
    if len(tolerated.pairs) > 1:
        for pair in tolerated.pairs:
            title = f"{tolerated.drive.design.name}, stage {pair.stage}: {tolerated.assemblies.count} assemblies"
            files[f"{folder_of(pair.stage)}spread.png"] = spreads(_of_pair(tolerated, pair), title)
    shown = {name: tolerated.indices[name] for name in SHOWN if name in tolerated.indices}
    if shown:
        of = {
            SHOWN[name]: {source_words(index.source): (max(index.total, 0.0), index.error) for index in found}
            for name, found in shown.items()
        }
        files["sources.png"] = sources(of, f"{tolerated.drive.design.name}: which tolerance matters")
    return files


def _spreads(tolerated: Tolerated) -> bytes:
    """The figures of the machine: of a single pair all plays, of two pairs the play of both together."""
    found, nominal, output = tolerated.assemblies, tolerated.nominal, tolerated.drive.linkage.OUTPUT
    place, pair = output.place, tolerated.pairs[0]

    def spread(label: str, key: str, factor: float = 1.0, *limit: Any) -> FigureSpread:
        return FigureSpread(label, factor * getattr(found, key), factor * float(getattr(nominal, key)[0]), *limit)

    shown = _of_pair(tolerated, pair)
    if len(tolerated.pairs) > 1:
        shown = [
            spread("least play of either pair in mm", "least_play_mm", 1.0, *JAMS),
            spread("play of the last driven gear in deg, at most", "play_max_rad", degrees(1.0)),
            spread("transmission error of both pairs in mm", "transmission_error_mm"),
        ]
    shown.append(spread(f"motion error of the {output.name} in {place.text}", "motion_error", place.factor))
    return spreads(shown, f"{tolerated.drive.design.name}: {found.count} assemblies")


JAMS = 0.0, True, "jams"
"""The limit of the least play, whether values below it are bad, and the name of the failure."""


def _of_pair(tolerated: Tolerated, pair: PairStudy) -> list[FigureSpread]:
    found, nominal = pair.assemblies, pair.nominal
    shown = [
        FigureSpread("least play in mm", found.least_play_mm, float(nominal.least_play_mm[0]), *JAMS),
        FigureSpread("transmission error in mm", found.transmission_error_mm, float(nominal.transmission_error_mm[0])),
    ]
    if pair.knock is not None:
        label = "play where the torque turns round in mm" if tolerated.loaded else "largest play in mm"
        designed = float(np.max(nominal.reversal_play_mm))
        shown.insert(1, FigureSpread(label, found.reversal_play_mm, designed, pair.knocking_mm, False, "knocks"))
    return shown
