"""Whether the best law depends on where its search starts.  Writes benchmarks/starts.md.

Run as ``make bench`` or ``python benchmarks/starts.py``.  Needs the extra ``optimize``.  The search for a makeable law
starts from the motion of the certified limit.  Here it starts from that motion as well as from others, with three
random harmonics added to ln i12.
"""

from __future__ import annotations

import platform
from pathlib import Path

import numpy as np

from ncgear.design.reading.design_file import load
from ncgear.errors import NoSuchMechanism
from ncgear.optimum.makeable.demanded import start_motion
from ncgear.optimum.makeable.law import law_of
from ncgear.optimum.makeable.search import kept, searched
from ncgear.project.best_law import BestLaw
from ncgear.workers import finished

ROOT = Path(__file__).parents[1]
DESIGNS = ("baler-66", "baler-smooth", "feeder-kept", "rocker-drive", "baler-real", "baler-66-two-stage")
STARTS = 4
SIZE = 0.3
"""Standard deviation of the first random harmonic of ln i12; that of the n-th is one n-th of it."""


def goal_from(task: tuple[str, int]) -> tuple[float, float]:
    """The goal that is reached from a start, and the largest factor of that start on a ratio; start 0 is the usual."""
    name, number = task
    best = BestLaw(load(ROOT / "designs" / f"{name}.yaml").design)
    search = searched(best.task, best.wishes)
    usual = search.begun(start_motion(best.task, best.wishes, best.bound))
    pairs, random = len(search.programme.cycles_rad), np.random.default_rng(number)
    angle = np.linspace(0.0, 2.0 * np.pi, usual.size // pairs, endpoint=False)
    added = np.zeros((pairs, angle.size))
    for wave in (1.0, 2.0, 3.0):
        for shape in (np.cos(wave * angle), np.sin(wave * angle)):
            added += random.normal(size=(pairs, 1)) * SIZE / wave * shape
    added *= number > 0
    found = kept(search, usual + added.ravel())
    if found is None:
        raise NoSuchMechanism(f"{name}: nothing is found from start {number}")
    return law_of(search, found).goal, float(np.exp(np.abs(added).max()))


def report() -> str:
    """The whole page."""
    tasks = [(name, number) for name in DESIGNS for number in range(STARTS)]
    found = dict(finished(goal_from, tasks))
    lines = [
        "# Where the search for a law starts",
        "",
        f"Written by `python benchmarks/starts.py`: Python {platform.python_version()}. The best law from the usual",
        f"start, the motion of the certified limit, and from {STARTS - 1} others, up to the given factor away.",
        "",
        "| design | goal from the usual start | others differ by at most, relative | factor of the starts |",
        "|---|---|---|---|",
    ]
    for name in DESIGNS:
        usual, *others = (found[name, number] for number in range(STARTS))
        apart = max(abs(goal / usual[0] - 1.0) for goal, _ in others)
        factor = max(factor for _, factor in others)
        lines.append(f"| {name} | {usual[0]:.8g} | {apart:.0e} | {factor:.1f} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    page = report()
    (ROOT / "benchmarks" / "starts.md").write_text(page, encoding="utf-8")
    print(page)
