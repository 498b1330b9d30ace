"""The files of whole machines: a design file for each, and all figures."""

from __future__ import annotations

from ncgear.figures.numbers import json_text
from ncgear.whole_machines.search import WholeMachines
from ncgear.whole_machines.told import machines_figures

FIGURES = "machines.json"


def machine_files(found: WholeMachines) -> dict[str, bytes]:
    """The content of each file by its name."""
    texts = {f"{one.name}.yaml": one.text.encode() for one in found.machines}
    return {**texts, FIGURES: json_text(machines_figures(found)).encode()}
