"""The files beside the table of a sweep: figures, pictures, the Pareto set, what each key does, designs as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import isnan
from typing import Any

import numpy as np

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.text import whole
from ncgear.design.rewritten import design_copy
from ncgear.drawings.plots.sweep_plots import MOST_KEYS, Axis, Effect, Named, effects, pareto, scatter_matrix
from ncgear.figures.numbers import json_text, to_digits
from ncgear.figures.quantities import name_of
from ncgear.figures.sweep import effects_csv, front_csv, values_of
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.units import label_and_unit
from ncgear.screening.designs import Designs
from ncgear.screening.overview import Overview, rank_correlations

DESIGNS = 8
"""Designs of the Pareto set that are written as files: the ends of the set, and others between them."""

BEST = "best"
"""The folder of design files in the output folder."""


def sweep_files(
    loaded: LoadedDesign, overview: Overview, screened: Overview, figures: Mapping[str, Any]
) -> dict[str, bytes]:
    """Everything beside the tables: the best of the last stage, among all designs that were screened.

    Where no design is made and keeps the constraints, there is nothing to show but the figures and the table.
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
    files["scatter.png"] = _scatter(name, shown, front)
    for first, second in combinations(range(len(wanted.objectives)), 2):
        ending = "" if len(wanted.objectives) == 2 else f"-{first + 1}-{second + 1}"
        files[f"pareto{ending}.png"] = _pareto_picture(name, shown, overview, chosen, first, second)
    return files


def first_best(files: dict[str, bytes]) -> str | None:
    """The name of the file of the best design by the first objective; None where there is none."""
    return next((name for name in files if name.startswith(f"{BEST}/")), None)


def _chosen(front: Designs, costs: Array) -> IndexArray:
    """Rows of the front, evenly along it in the order of the first objective, with both ends."""
    order = np.lexsort((front.numbers, *costs.T[::-1]))
    places = np.linspace(0, len(order) - 1, min(DESIGNS, len(order))).round().astype(int)
    rows: IndexArray = order[np.unique(places)]
    return rows


def _head(name: str) -> str:
    """A key or figure with the unit in which it is kept, as a picture shows its values."""
    label, unit = label_and_unit(name.rpartition(".")[2])
    return f"{name_of(name.rpartition('.')[2]) if unit else label}{f', {unit}' if unit else ''}"


def _axis(name: str, shown: Overview, front: Designs) -> Axis:
    assert shown.drawn is not None
    return Axis(_head(name), shown.drawn.column(name), front.column(name))


def _foremost(overview: Overview) -> list[str]:
    """The keys that a picture has room for: those that explain most of the first objective."""
    keys = overview.space.keys
    explained = np.nan_to_num(overview.effects.explained[:, 0])
    first = np.argsort(-explained, kind="stable")[:MOST_KEYS]
    return [keys[place] for place in sorted(first.tolist())]


def _scatter(name: str, shown: Overview, front: Designs) -> bytes:
    names = dict.fromkeys([*_foremost(shown), *(one.name for one in shown.wanted.objectives)])
    return scatter_matrix([_axis(one, shown, front) for one in names], f"{name}: {shown.kept} designs")


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


def _effects_picture(name: str, overview: Overview) -> bytes:
    keys, explained, ranks = overview.space.keys, overview.effects.explained, rank_correlations(overview)
    rows = []
    for key in _foremost(overview):
        place = keys.index(key)
        known = overview.effects.designs[place] > 0.0
        rows.append(
            Effect(
                _head(key),
                overview.effects.places[place][known],
                overview.effects.refused_share[place][known],
                overview.effects.means[place][known],
                [_said(*one) for one in zip(explained[place], ranks[place], strict=True)],
            )
        )
    heads: Sequence[str] = [_head(one.name) for one in overview.wanted.objectives]
    return effects(rows, heads, f"{name}: what each key does to {overview.count} designs")


def _said(explained: float, rank: float) -> str:
    if isnan(explained):
        return "does not vary"
    return f"explains {to_digits(100.0 * explained, 2)} %, rank {rank:+.2f}"
