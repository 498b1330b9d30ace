"""Whether the best law depends on where its search starts.  Writes benchmarks/starts.md.

Run as ``make bench`` or ``python benchmarks/starts.py``.  Needs the extra ``optimize``.
"""

from __future__ import annotations

import platform
from pathlib import Path

from ncgear.design.reading.design_file import load
from ncgear.project.best_law import BestLaw

ROOT = Path(__file__).parents[1]
DESIGNS = ("baler-66", "baler-smooth", "feeder-kept", "rocker-drive", "baler-real", "baler-66-two-stage")
STARTS = 8


def report() -> str:
    """The whole page."""
    lines = [
        "# Where the search for a law starts",
        "",
        f"Written by `python benchmarks/starts.py`: Python {platform.python_version()}. What `ncgear optimize --starts",
        f"{STARTS}` finds from the usual start, the motion of the certified limit, and from {STARTS - 1} others, whose",
        "ratios are up to about three times as large or as small.",
        "",
        "| design | goal of the best law | below the worst, relative | starts without a law |",
        "|---|---|---|---|",
    ]
    for name in DESIGNS:
        best = BestLaw(load(ROOT / "designs" / f"{name}.yaml").design, STARTS)
        lines.append(f"| {name} | {best.law.goal:.8g} | {best.starts.apart:.0e} | {best.starts.without_law} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    page = report()
    (ROOT / "benchmarks" / "starts.md").write_text(page, encoding="utf-8")
    print(page)
