"""The files beside the table of a sweep: figures, pictures, the Pareto set, the effects of keys, designs as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import isnan
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.text import whole
from ncgear.design.rewritten import design_copy
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.canvas import Style
from ncgear.figures.numbers import json_text, name_of, to_digits
from ncgear.figures.sweep import effects_csv, front_csv, values_of
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.units import label_and_unit
from ncgear.screening.designs import Designs
from ncgear.screening.overview import Overview, rank_correlations

CELL_IN = 1.75
"""Width and height of a small picture among many."""

MOST_KEYS = 6
"""Most keys in a picture; it shows the keys that explain most of the first objective."""

TICKS = 4
TICKS_OF_A_CELL = 3
LABEL = 0.05
"""Designs nearer to each other than this share of the picture share a number, that of the first design."""

TITLE_IN = 0.62

ROUNDING = 1e-9
"""Relative differences of a figure between designs up to this are rounding."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A key or an objective: its heading with the unit, and its values of designs by lot and of the Pareto set."""

    head: str
    drawn: Array
    front: Array


def scatter_matrix(axes: Sequence[Axis], title: str) -> bytes:
    """PNG of every pair of keys and objectives below the diagonal; the diagonal shows the distribution of each."""
    count = len(axes)
    size = CELL_IN * count + 0.9
    width, height = max(size, 5.0), size + TITLE_IN
    made = canvas.figure(
        width,
        height,
        title,
        canvas.Margins(left=0.95, right=0.2, bottom=0.75, top=TITLE_IN + 0.15),
        hspace=0.12,
        wspace=0.12,
    )
    for row, up in enumerate(axes):
        for column, along in enumerate(axes[: row + 1]):
            cell = made.add_subplot(count, count, row * count + column + 1)
            if row == column:
                if len(up.drawn):
                    # Values that differ by rounding alone leave no room for bars.
                    differ = np.ptp(up.drawn) > ROUNDING * np.abs(up.drawn).max()
                    cell.hist(up.drawn, bins=24 if differ else 1, color=canvas.DRIVING, alpha=0.55)
                cell.set_yticks([])
            else:
                _points(cell, along, up)
            canvas.dress(
                cell, _broken(along.head) if row == count - 1 else "", _broken(up.head) if column == 0 and row else ""
            )
            for axis, values in ((cell.xaxis, along.drawn), (cell.yaxis, up.drawn)):
                axis.set_major_locator(_ticks(values, TICKS_OF_A_CELL))
                axis.get_major_formatter().set_useOffset(False)  # type: ignore[attr-defined]
            cell.tick_params(labelbottom=row == count - 1, labelleft=column == 0 and row > 0)
            _small_labels(cell)
    note: Style = {"size": canvas.SMALL, "ha": "right", "va": "top"}
    made.text(0.985, 1.0 - 0.40 / height, "blue: designs by lot", color=canvas.DRIVING, **note)
    made.text(0.985, 1.0 - 0.56 / height, "purple: best designs", color=canvas.HIGHLIGHT, **note)
    return canvas.png(made)


def _points(cell: Axes, along: Axis, up: Axis) -> None:
    cell.plot(along.drawn, up.drawn, color=canvas.DRIVING, marker=".", markersize=1.8, alpha=0.35, linestyle="none")
    cell.plot(along.front, up.front, color=canvas.HIGHLIGHT, marker="o", markersize=2.8, linestyle="none", zorder=3)


def _broken(head: str) -> str:
    """A heading in two lines, the unit in the second one."""
    return head.replace(", ", ",\n", 1)


def _ticks(values: Array, most: int = TICKS) -> MaxNLocator:
    """A few ticks, at whole numbers where all values are whole."""
    return MaxNLocator(most, integer=bool(np.all(values == np.round(values))))


def _small_labels(cell: Axes) -> None:
    cell.xaxis.label.set_fontsize(canvas.SMALL)
    cell.yaxis.label.set_fontsize(canvas.SMALL)


Named = tuple[str, float, float]
"""A design by its number, and its place in the picture."""


def pareto(along: Axis, up: Axis, named: Sequence[Named], title: str) -> bytes:
    """PNG of two objectives: designs drawn at random, the Pareto set, and its designs that are written as files."""
    width, height = 8.2, 5.8
    made = canvas.figure(width, height, title, canvas.Margins(left=0.95, right=0.3, top=0.8))
    axes = made.add_subplot()
    axes.plot(along.drawn, up.drawn, color=canvas.REFERENCE, marker=".", markersize=2.5, alpha=0.4, linestyle="none")
    order = np.argsort(along.front)
    axes.plot(
        along.front[order], up.front[order], color=canvas.DRIVING, linewidth=1.0, marker="o", markersize=3.0, zorder=3
    )
    axes.ticklabel_format(useOffset=False)
    _near_the_front(axes, along, up)
    labelled: list[Array] = []
    for name, x, y in named:
        axes.plot([x], [y], color=canvas.HIGHLIGHT, marker="D", markersize=6.0, linestyle="none", zorder=4)
        place = axes.transAxes.inverted().transform(axes.transData.transform((x, y)))
        if all(np.abs(place - other).max() > LABEL for other in labelled):
            note: Style = {"size": canvas.SMALL, "color": canvas.INK, "zorder": 5}
            axes.annotate(name, (x, y), xytext=(5.0, 5.0), textcoords="offset points", **note)
            labelled.append(place)
    canvas.dress(axes, along.head, up.head)
    said: Style = {"size": canvas.SMALL, "ha": "right", "va": "bottom", "transform": axes.transAxes}
    axes.text(1.0, 1.04, "grey: designs by lot", color=canvas.REFERENCE, **said)
    axes.text(0.82, 1.04, "blue: Pareto set", color=canvas.DRIVING, **said)
    axes.text(0.68, 1.04, "purple: written as files, by number", color=canvas.HIGHLIGHT, **said)
    return canvas.png(made)


def _near_the_front(axes: Axes, along: Axis, up: Axis) -> None:
    """Limit the axes to twice the size of the front, or to the front and the nearest quarter of the other designs."""
    for axis, limits in ((along, axes.set_xlim), (up, axes.set_ylim)):
        low, high = axis.front.min(), axis.front.max()
        every = np.concatenate([axis.drawn, axis.front])
        away = np.maximum(low - every, every - high).clip(0.0)
        room = max(high - low, np.quantile(away, 0.25), 1e-9 * abs(high), 1e-300)
        limits(max(low - room, every.min() - 0.05 * room), min(high + room, every.max() + 0.05 * room))


def _effects_picture(name: str, overview: Overview) -> bytes:
    """PNG with a row for each key: the mean of each objective, and the share refused, over the key's values."""
    known, ranks = overview.effects, rank_correlations(overview)
    keys = _foremost(overview)
    places = [overview.space.keys.index(key) for key in keys]
    bins = [known.designs[place] > 0.0 for place in places]
    heads = [*(f"mean {_head(objective.name)}" for objective in overview.wanted.objectives), "refused, %"]
    columns = len(heads)
    width, height = 2.75 * columns + 0.9, 1.75 * len(keys) + TITLE_IN + 0.4
    made = canvas.figure(
        width,
        height,
        f"{name}: what each key does to {overview.count} designs",
        canvas.Margins(left=0.95, right=0.2, bottom=0.6, top=TITLE_IN + 0.35),
        hspace=0.85,
        wspace=0.42,
    )
    # All keys have the same scale for an objective, so that important keys look large.
    for row, (key, place, counted) in enumerate(zip(keys, places, bins, strict=True)):
        middles = known.places[place][counted]
        for column, head in enumerate(heads):
            cell = made.add_subplot(len(keys), columns, row * columns + column + 1)
            last = column == columns - 1
            values = (100.0 * known.refused_share[place] if last else known.means[place][:, column])[counted]
            color = canvas.DRIVEN if last else canvas.DRIVING
            finite = np.isfinite(values)
            cell.plot(middles[finite], values[finite], color=color, marker="o", markersize=3.0, linewidth=1.4)
            canvas.dress(cell, _head(key), "")
            _small_labels(cell)
            cell.xaxis.set_major_locator(_ticks(middles))
            cell.yaxis.set_major_locator(MaxNLocator(TICKS))
            if last:
                cell.set_ylim(-4.0, 104.0)
            else:
                of_all = zip(places, bins, strict=True)
                means = np.concatenate([known.means[other][some][:, column] for other, some in of_all])
                low, high = np.nanmin(means), np.nanmax(means)
                room = max(0.06 * (high - low), 1e-6 * abs(high), 1e-300)
                cell.set_ylim(low - room, high + room)
                said = _said(known.explained[place, column], ranks[place, column])
                cell.text(0.02, 1.03, said, transform=cell.transAxes, size=canvas.SMALL, color=canvas.INK)
            if row == 0:
                cell.set_title(head, size=canvas.SMALL + 1.0, color=color, pad=18.0, loc="left", weight="bold")
    return canvas.png(made)


DESIGNS = 8
"""Most designs of the Pareto set that are written as files: the ends of the set, and designs between them."""

BEST = "best"
"""The folder of design files in the output folder."""


def sweep_files(
    loaded: LoadedDesign, overview: Overview, screened: Overview, figures: Mapping[str, Any]
) -> dict[str, bytes]:
    """All files beside the tables: the best designs of the last stage, among all screened designs.

    Where no makeable design keeps the constraints, there are only the figures and the table.
    """
    files = {"sweep.json": json_text(figures).encode()}
    all_known = screened.wanted.objectives == overview.wanted.objectives
    shown = screened if all_known else overview
    if screened.count:
        files["effects.csv"] = effects_csv(shown).encode()
    front = overview.front
    if front is None:
        return files
    wanted = overview.wanted
    chosen = _chosen(front, wanted.costs(front))
    files["pareto.csv"] = front_csv(front, wanted).encode()
    name = loaded.design.name
    for row in chosen.tolist():
        copy = f"{name}-{int(front.numbers[row]):06d}"
        values = {key: whole(value) for key, value in values_of(front, row).items()}
        files[f"{BEST}/{copy}.yaml"] = design_copy(loaded, {"name": copy, **values}).encode()
    files["effects.png"] = _effects_picture(name, shown)
    names = dict.fromkeys([*_foremost(shown), *(objective.name for objective in shown.wanted.objectives)])
    files["scatter.png"] = scatter_matrix(
        [_axis(name, shown, front) for name in names], f"{name}: {shown.kept} designs"
    )
    for first, second in combinations(range(len(wanted.objectives)), 2):
        ending = "" if len(wanted.objectives) == 2 else f"-{first + 1}-{second + 1}"
        files[f"pareto{ending}.png"] = _pareto_picture(name, shown, overview, chosen, first, second)
    return files


def first_best(files: dict[str, bytes]) -> str | None:
    """The name of the file of the best design by the first objective; None where no design is written."""
    return next((name for name in files if name.startswith(f"{BEST}/")), None)


def _chosen(front: Designs, costs: Array) -> IndexArray:
    """Rows of the front, evenly along it in the order of the first objective, with both ends."""
    order = np.lexsort((front.numbers, *costs.T[::-1]))
    places = np.linspace(0, len(order) - 1, min(DESIGNS, len(order))).round().astype(int)
    return order[np.unique(places)]


def _head(name: str) -> str:
    """A key or figure with the unit in which a picture shows its values."""
    rest, _, last = name.rpartition(".")
    if last.isdigit():
        return f"{_head(rest)}, place {last}"
    label, unit = label_and_unit(last)
    return f"{name_of(last) if unit else label}{f', {unit}' if unit else ''}"


def _axis(name: str, shown: Overview, front: Designs) -> Axis:
    assert shown.drawn is not None
    return Axis(_head(name), shown.drawn.column(name), front.column(name))


def _foremost(overview: Overview) -> list[str]:
    """The keys that a picture shows: those that explain most of the first objective."""
    keys = overview.space.keys
    explained = np.nan_to_num(overview.effects.explained[:, 0])
    first = np.argsort(-explained, kind="stable")[:MOST_KEYS]
    return [keys[place] for place in sorted(first.tolist())]


def _pareto_picture(
    name: str, shown: Overview, overview: Overview, chosen: IndexArray, first: int, second: int
) -> bytes:
    front, objectives = overview.front, overview.wanted.objectives
    assert front is not None
    along, up = (_axis(objectives[place].name, shown, front) for place in (first, second))
    named: list[Named] = [(str(front.numbers[row]), along.front[row], up.front[row]) for row in chosen.tolist()]
    screened = f", out of {shown.kept} screened" if shown is not overview and shown.kept > overview.kept else ""
    title = f"{name}: Pareto set, {len(front.numbers)} of {overview.kept} designs{screened}"
    return pareto(along, up, named, title)


def _said(explained: float, rank: float) -> str:
    if isnan(explained):
        return "does not vary"
    return f"explains {to_digits(100.0 * explained, 2)} %, rank {rank:+.2f}"
