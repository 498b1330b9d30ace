"""What is told of a sweep: the best designs, the Pareto set, why others are refused, and which keys matter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.csv_text import rows_text
from ncgear.figures.numbers import known, shown
from ncgear.figures.quantities import name_of, told
from ncgear.screening.designs import Designs
from ncgear.screening.overview import Overview, rank_correlations
from ncgear.screening.rows import WITH_MASSES
from ncgear.screening.wanted import Constraint, Wanted

REFUSALS = 5
"""Problems that are told, the most frequent first."""


def head_of(name: str) -> str:
    """``peak power, W``: a figure's name and the unit in which its cells are."""
    unit = told(_last(name), 1.0)[2]
    return f"{_brief(name)}, {unit}" if unit else _brief(name)


def _last(name: str) -> str:
    return name.rpartition(".")[2]


def _brief(name: str) -> str:
    """The name of a figure without what is said of it behind a comma, with its pair of gears if there are two."""
    return _of_pair(name, name_of(_last(name)).partition(",")[0])


def _of_pair(name: str, said: str) -> str:
    """What is said of a figure, with its pair of gears if there are two: ``stage 2 contact_ratio_min``."""
    pair = name.partition(".")[0]
    return f"{pair.replace('_', ' ')} {said}" if pair.startswith("stage_") else said


def cells_of(designs: Designs, wanted: Wanted) -> list[list[str]]:
    """A row for each design: the values of its keys, and its objectives."""
    return [
        [
            *(shown(float(values[row])) for values in designs.values.values()),
            *(told(_last(one.name), float(designs.column(one.name)[row]))[1] for one in wanted.objectives),
        ]
        for row in range(len(designs.numbers))
    ]


def counts_of(screened: Overview, deeper: Overview | None, stage: str) -> list[str]:
    """How many designs there are, how many are left after each step, and how many are the best."""
    said = [f"{screened.count} designs, of which {screened.made} can be made"]
    constraints = screened.wanted.constraints
    if constraints:
        said.append(f"{screened.kept} keep {_said(constraints)}")
    if deeper is not None:
        said.append(f"{deeper.count} went on to {stage}, of which {deeper.made} can be made")
        later = [one for one in deeper.wanted.constraints if one not in constraints]
        if later:
            said.append(f"{deeper.kept} keep {_said(later)}")
    last = deeper or screened
    if len(last.wanted.objectives) > 1 and last.front is not None:
        said.append(f"{len(last.front.numbers)} in the Pareto set")
    return said


def _said(constraints: Sequence[Constraint]) -> str:
    return ", ".join(
        f"{_of_pair(one.name, _last(one.name))} {one.comparison} {shown(one.number)}" for one in constraints
    )


def sweep_figures(name: str, screened: Overview, deeper: Overview | None, stage: str) -> dict[str, Any]:
    """Everything that is told of a sweep as plain values; ``name`` is that of the design.

    Designs have their number, keys and figures by the names of the table's columns; what is not known is None.
    """
    last = deeper or screened
    wanted, front = last.wanted, last.front
    return {
        "design": {"name": name},
        "stage": stage,
        "keys": list(last.space.keys),
        "objectives": [
            {"name": one.name, "wanted": "greatest" if one.greatest else "least"} for one in wanted.objectives
        ],
        "constraints": [vars(one) for one in wanted.constraints],
        "screened": _counts(screened),
        **({} if deeper is None else {"deeper": _counts(deeper)}),
        "pareto_set_designs": 0 if front is None else len(front.numbers),
        "best": {
            objective.name: [
                {"number": int(best.numbers[row]), **values_of(best, row)}
                | {name: known(values[row]) for name, values in best.figures.items()}
                for row in range(len(best.numbers))
            ]
            for objective, best in zip(wanted.objectives, last.best, strict=False)
        },
        "effects": _effect_figures(last) if last.kept > 1 else {},
    }


def _counts(overview: Overview) -> dict[str, Any]:
    """How many designs there are, are made and keep what is wanted, and why others are refused, most frequent first."""
    refused = [
        {"designs": one.count, "first_at": dict(one.values), "verdict": one.verdict}
        for one in overview.frequent_refusals
    ]
    return {"designs": overview.count, "made": overview.made, "kept": overview.kept, "refused": refused}


def _effect_figures(overview: Overview) -> dict[str, Any]:
    """By key and objective: the share of the variance that the key explains alone, and the rank correlation."""
    explained, ranks = overview.effects.explained, rank_correlations(overview)
    return {
        key: {
            objective.name: {"explained_share": known(share), "rank_correlation": known(rank)}
            for objective, share, rank in zip(overview.wanted.objectives, explained[row], ranks[row], strict=True)
        }
        for row, key in enumerate(overview.space.keys)
    }


def front_csv(front: Designs, wanted: Wanted) -> str:
    """The Pareto set in the order of the first objective: number, keys, objectives first, then all other figures."""
    first = [one.name for one in wanted.objectives if one.name in front.figures]
    names = [*first, *(name for name in front.figures if name not in first)]
    order = np.lexsort(wanted.costs(front).T[::-1])
    columns = [front.numbers, *front.values.values(), *(front.figures[name] for name in names)]
    return rows_text(
        ["number", *front.values, *names],
        [["" if value != value else value for value in (column[row].item() for column in columns)] for row in order],
    )


def effects_csv(overview: Overview) -> str:
    """A row for each part of each key's range: its middle, its designs, the share refused, means of the objectives."""
    effects, objectives = overview.effects, overview.wanted.objectives
    rows = []
    for key, name in enumerate(overview.space.keys):
        for place in np.flatnonzero(effects.designs[key]).tolist():
            means: list[float | str] = [""] * len(objectives)
            if effects.kept[key, place]:
                means = effects.means[key, place].tolist()
            value, refused = effects.places[key, place], effects.refused_share[key, place]
            rows.append([name, float(value), int(effects.designs[key, place]), float(refused), *means])
    heads = ["key", "value", "designs", "refused_share", *(f"mean {one.name}" for one in objectives)]
    return rows_text(heads, rows)


def values_of(designs: Designs, row: int) -> Mapping[str, float]:
    """What the keys of one design are."""
    return {key: float(values[row]) for key, values in designs.values.items()}


BEST = 3
"""Designs that are told for each objective."""


def swept_answer(screened: Overview, deeper: Overview | None, stage: str, then: str) -> Answer:
    """How many can be made, the best of them, and why the others cannot."""
    last = deeper or screened
    head, *more = counts_of(screened, deeper, stage)
    heads = [key.rpartition(".")[2] for key in last.space.keys] + [head_of(one.name) for one in last.wanted.objectives]
    rows = [
        Row("" if place else f"{'greatest' if objective.greatest else 'least'} {_brief(objective.name)}", tuple(cells))
        for objective, best in zip(last.wanted.objectives, last.best, strict=False)
        for place, cells in enumerate(cells_of(best, last.wanted)[:BEST])
    ]
    if without_masses(last):
        given = "train.masses" if last.space.keys[0].startswith("train.") else "masses"
        rows.append(Row("masses", (f"not counted in power: give them as {given}",)))
    refused = [
        Fault(f"{one.count} {'design' if one.count == 1 else 'designs'}: {one.verdict}")
        for one in last.frequent_refusals[:REFUSALS]
    ]
    return Answer(
        head,
        tuple(rows),
        tuple(refused),
        about="; ".join(more),
        heads=tuple(heads),
        good="",
        wrong=f"{last.count - last.made} are refused",
        then=then,
    )


def without_masses(overview: Overview) -> bool:
    """Whether designs are ranked by a power that counts no masses."""
    by_power = any(one.name.endswith("power_w") for one in overview.wanted.objectives)
    return by_power and all(set(WITH_MASSES).isdisjoint(one.figures) for one in overview.best)
