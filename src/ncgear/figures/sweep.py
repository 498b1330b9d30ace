"""What is told of a sweep: the best designs, the Pareto set, why others are refused, and which keys matter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.numbers import known, name_of, shown, told
from ncgear.figures.tables import rows_text
from ncgear.numerics.arrays import Mask
from ncgear.screening.deeper import OF_WANTED, ROOM, is_row
from ncgear.screening.designs import Designs, joined
from ncgear.screening.overview import Overview, rank_correlations
from ncgear.screening.single import WITH_MASSES
from ncgear.screening.wanted import Constraint, Wanted


def head_of(name: str) -> str:
    """``peak power, W``: a figure's name and the unit in which its cells are."""
    unit = told(_last(name), 1.0)[2]
    return f"{_brief(name)}, {unit}" if unit else _brief(name)


def _last(name: str) -> str:
    """The last name of a key or figure, with its place if it is of a list: ``bends_deg.0``."""
    rest, _, last = name.rpartition(".")
    return f"{_last(rest)}.{last}" if last.isdigit() else last


def _brief(name: str) -> str:
    """The name of a figure without what is said of it behind a comma, with its pair of gears if there are two."""
    return _of_pair(name, name_of(_last(name)).partition(",")[0])


def _of_pair(name: str, said: str) -> str:
    """What is said of a figure, with its pair of gears if there are two: ``stage 2 contact_ratio_min``."""
    pair = name.partition(".")[0]
    return f"{pair.replace('_', ' ')} {said}" if pair.startswith("stage_") else said


def _cells(designs: Designs, row: int, figures: Sequence[str]) -> tuple[str, ...]:
    """The values of a design's keys, and some of its figures."""
    values = (shown(float(values[row])) for values in designs.values.values())
    found = ((name, float(designs.column(name)[row])) for name in figures)
    return (*values, *(told(_last(name), value)[1] if isfinite(value) else "-" for name, value in found))


def counts_of(screened: Overview, deeper: Overview | None, stage: str) -> list[str]:
    """How many designs there are, how many are left after each step, and how many are the best."""
    said = [f"{screened.count} designs, of which {screened.made} can be made"]
    constraints = screened.wanted.constraints
    if constraints:
        said.append(f"{screened.kept} keep {_said(constraints)}")
    if deeper is not None:
        said.append(f"{deeper.count} went on to {stage}, of which {deeper.made} can be made")
        later = [limit for limit in deeper.wanted.constraints if limit not in constraints]
        if later:
            said.append(f"{deeper.kept} keep {_said(later)}")
    last = deeper or screened
    if len(last.wanted.objectives) > 1 and last.front is not None:
        said.append(f"{len(last.front.numbers)} in the Pareto set")
    return said


def _said(constraints: Sequence[Constraint]) -> str:
    return ", ".join(
        f"{_of_pair(limit.name, _last(limit.name))} {limit.comparison} {shown(limit.number)}" for limit in constraints
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
            {"name": objective.name, "wanted": "greatest" if objective.greatest else "least"}
            for objective in wanted.objectives
        ],
        "constraints": [vars(limit) for limit in wanted.constraints],
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
        {"designs": refusal.count, "first_at": dict(refusal.values), "verdict": refusal.verdict}
        for refusal in overview.frequent_refusals
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
    first = [objective.name for objective in wanted.objectives if objective.name in front.figures]
    names = [*first, *(name for name in front.figures if name not in first)]
    order = np.lexsort(wanted.costs(front).T[::-1])
    columns = [front.numbers, *front.values.values(), *(front.figures[name] for name in names)]
    return rows_text(
        ["number", *front.values, *names],
        [[value if isfinite(value) else "" for value in (column[row].item() for column in columns)] for row in order],
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
    heads = ["key", "value", "designs", "refused_share", *(f"mean {objective.name}" for objective in objectives)]
    return rows_text(heads, rows)


def values_of(designs: Designs, row: int) -> Mapping[str, float]:
    """What the keys of one design are."""
    return {key: float(values[row]) for key, values in designs.values.items()}


BEST = 3
"""Designs that are told for each objective."""


def swept_answer(design: Design, screened: Overview, deeper: Overview | None, stage: str, then: str) -> Answer:
    """How many can be made, the best of them, and why the others cannot."""
    last = deeper or screened
    head, *more = counts_of(screened, deeper, stage)
    limits = [name for name in LIMITS if last.best and name in last.best[0].figures]
    figures = list(dict.fromkeys([*(objective.name for objective in last.wanted.objectives), *limits]))
    heads = [*map(_last, last.space.keys), *map(head_of, figures)]
    rows = [
        Row(
            "" if place else f"{'greatest' if objective.greatest else 'least'} {_brief(objective.name)}",
            _cells(best, place, figures),
        )
        for objective, best in zip(last.wanted.objectives, last.best, strict=False)
        for place in range(min(BEST, len(best.numbers)))
    ]
    if without_masses(last):
        given = "train.masses" if last.space.keys[0].startswith("train.") else "masses"
        rows.append(Row("masses", (f"not counted in power: give them as {given}",)))
    unknown = ROOM not in limits and is_row(design)
    warned = [_warned(last, name) for name in limits if not _keeps(last, name).all()]
    refused = [
        Fault(
            f"{refusal.count} designs, the first: {refusal.verdict}"
            if refusal.count > 1
            else f"1 design: {refusal.verdict}"
        )
        for refusal in last.frequent_refusals
    ]
    return Answer(
        head,
        tuple(rows),
        (*warned, *refused),
        about="; ".join(more),
        heads=tuple(heads),
        good="",
        wrong="" if warned else f"{last.count - last.made} are refused",
        not_judged="Not judged: whether gears that do not mesh meet (--stage teeth)" if unknown else "",
        then=then,
    )


LIMITS = {
    ROOM: (Constraint(ROOM, ">", 0.0), "gears that do not mesh meet"),
    OF_WANTED: (Constraint(OF_WANTED, ">=", 1.0), "a safety is under the wanted one"),
}
"""What figures of later stages have to keep, and the warning of ``check`` and ``strength`` where they do not."""


def _warned(overview: Overview, name: str) -> Fault:
    """How many of the told designs break a limit, and how to leave such designs out."""
    keeps, (limit, what) = _keeps(overview, name), LIMITS[name]
    cure = f"--keep-if '{_said([limit])}'"
    return Fault(f"{(~keeps).sum()} of the {keeps.size} designs above: {what}", (cure,))


def _keeps(overview: Overview, name: str) -> Mask:
    """Which of the told designs, each counted once, keep a limit or have no such figure."""
    told = joined([best.at(slice(BEST)) for best in overview.best])
    once = told.at(np.unique(told.numbers, return_index=True)[1])
    return LIMITS[name][0].kept(once) | np.isnan(once.column(name))


def without_masses(overview: Overview) -> bool:
    """Whether designs are ranked by a power that counts no masses."""
    by_power = any(objective.name.endswith("power_w") for objective in overview.wanted.objectives)
    return by_power and all(set(WITH_MASSES).isdisjoint(design.figures) for design in overview.best)
