"""Six machines that are no balers, with what is asked of their best laws: judges of limit and search share them.

Rods from two to eight cranks, offsets to both sides, every kind of resistance, speeds from 20 to 300 r/min.  What caps
each of them binds: the acceleration is two to three times what it is without, as on the baler at 6300 W.  Each file of
``benchmarks/foreign/`` holds the best law known, of 720 knots.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ncgear.design.reading.design_file import load
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task
from ncgear.project.best_law import BestLaw

FOREIGN = {path.stem: path for path in sorted((Path(__file__).parent / "foreign").glob("*.yaml"))}


@dataclass(frozen=True)
class Asked:
    """A machine and what is asked of its law."""

    task: Task
    wishes: Wishes


def asked_by(path: Path) -> Asked:
    """What a design file asks, whatever law it holds."""
    best = BestLaw(load(path).design)
    return Asked(best.task, best.wishes)
