"""All figures of a balance file by the names of its parts, and their text for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ncgear.errors import below
from ncgear.figures.balance.shaking import chassis_figures, excitation_figures, frame_figures, mechanism_figures
from ncgear.figures.balance.turning import chain_figures, gear_figures, rotor_figures
from ncgear.figures.quantities import told
from ncgear.figures.tables import aligned
from ncgear.figures.terminal import written_lines
from ncgear.numerics.units import label_and_unit
from ncgear.project.balancing import Balancing

PARTS = {
    "chassis": chassis_figures,
    "excitations": excitation_figures,
    "gears": gear_figures,
    "rotor": rotor_figures,
    "chain_drive": chain_figures,
}
"""Parts of the file beside its mechanisms, each with the function that computes its figures."""


def figures_of(balancing: Balancing) -> dict[str, Any]:
    """Every figure by the name of its part; keys end in their units."""
    balance = balancing.balance
    figures: dict[str, Any] = {"name": balance.name}
    if balance.mechanisms:
        figures["mechanisms"] = []
        for number, (given, mounted) in enumerate(zip(balance.mechanisms, balancing.mounted, strict=True)):
            with below(f"mechanisms.{number}"):
                figures["mechanisms"].append(mechanism_figures(given, mounted.mechanism))
    if len(balance.mechanisms) > 1:
        figures["frame"] = frame_figures(balancing)
    asked = {part: answer for part, answer in PARTS.items() if getattr(balance, part) is not None}
    return {**figures, **{part: answer(balancing) for part, answer in asked.items()}}


def balance_text(figures: Mapping[str, Any], paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """The figures as indented lines and tables, the files written, and those kept."""
    lines = [str(figures["name"])]
    for part, content in figures.items():
        if part == "mechanisms":
            for mechanism in content:
                lines += ["", mechanism["name"], *_lines({k: v for k, v in mechanism.items() if k != "name"})]
        elif part != "name":
            lines += ["", part.replace("_", " "), *_content(content)]
    return "\n".join([*lines, "", *written_lines(paths, kept)])


def _content(content: Any) -> list[str]:
    return _table(content) if isinstance(content, list) else _lines(content)


def _lines(figures: Mapping[str, Any]) -> list[str]:
    """One line for each figure; groups and tables are indented below their names."""
    plain = {key: value for key, value in figures.items() if not _is_group(value)}
    width = max((len(label_and_unit(key)[0]) for key in plain), default=0)
    lines = []
    for key, value in figures.items():
        if _is_group(value):
            lines += [f"  {key.replace('_', ' ')}", *(f"  {line}" for line in _content(value))]
        else:
            label, text, unit = told(key, value)
            lines.append(f"  {label:<{width}}  {text} {unit}".rstrip())
    return lines


def _is_group(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def _table(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The lines of a table, without the columns that have no value in any row."""
    keys = [key for key in rows[0] if any(row[key] is not None for row in rows)] if rows else []
    heads = [", ".join(part for part in label_and_unit(key) if part) for key in keys]
    return aligned([heads, *([told(key, row[key])[1] for key in keys] for row in rows)])
