"""All figures of a balance file by the names of its parts, and their text for the terminal."""

from __future__ import annotations

from typing import Any

from ncgear.errors import below
from ncgear.figures.balance.shaking import chassis_figures, excitation_figures, frame_figures, mechanism_figures
from ncgear.figures.balance.turning import chain_figures, gear_figures, rotor_figures
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
