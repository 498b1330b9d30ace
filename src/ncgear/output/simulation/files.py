"""A simulation of any level: as files, and as text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from ncgear.drive import Drive
from ncgear.dynamics.level import Level
from ncgear.output.beside import MECHANISMS, beside_lines
from ncgear.output.json_text import json_text
from ncgear.output.report import summary_text
from ncgear.output.simulation.simulated import Simulated
from ncgear.output.tables import csv_text


def simulate(drive: Drive, level: Level) -> Simulated:
    """Simulate a machine at a level; raises WrongInput where the design lacks what the level needs."""
    return LEVELS[level](drive)


def _rigid(drive: Drive) -> Simulated:
    from ncgear.output.simulation.rigid import rigid_simulation

    return rigid_simulation(drive)


def _quasi_static(drive: Drive) -> Simulated:
    from ncgear.output.simulation.quasi_static import quasi_static_simulation

    return quasi_static_simulation(drive)


def _dynamic(drive: Drive) -> Simulated:
    from ncgear.output.simulation.dynamic import dynamic_simulation

    return dynamic_simulation(drive)


LEVELS: dict[Level, Callable[[Drive], Simulated]] = {
    Level.RIGID: _rigid,
    Level.QUASI_STATIC: _quasi_static,
    Level.DYNAMIC: _dynamic,
}
"""How each level is simulated; what one needs is imported when it is asked for."""


def simulation_files(found: Simulated) -> dict[str, bytes]:
    """Table, pictures and figures as files."""
    return {
        "simulation.csv": csv_text(list(found.table), list(found.table.values())).encode(),
        **found.pictures,
        "simulation.json": json_text(found.figures).encode(),
    }


def simulation_text(found: Simulated, paths: Sequence[Path]) -> str:
    """The figures for reading, those of both mechanisms side by side, and the files written."""
    compared = {key: found.figures[key] for key in MECHANISMS if key in found.figures}
    alone = {key: value for key, value in found.figures.items() if key not in compared}
    beside = [*beside_lines("Torques and forces", compared), ""] if compared else []
    return "\n".join([summary_text(alone), "", *beside, "Written", *(f"  {path}" for path in paths)])
