"""How long the studio takes to answer: a value is changed over its web socket, and each part is timed as it comes.

    python benchmarks/studio.py

The studio runs as a process of its own, as for a page; times count from the message to the answer, and are the medians
of changes that each wait for the one before, with the largest in brackets.  It writes benchmarks/studio.md.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections import defaultdict
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests")]

from studios import Page, running  # noqa: E402

CHANGED = {
    "baler": ("operation.speed_rpm", 20.0, 0.1),
    "baler-86": ("motion.theta2_pi", 0.7, 0.0005),
    "baler-66": ("gears.teeth", 50, 1),
    "pusher": ("operation.speed_rpm", 60.0, 0.1),
    "desk-toy": ("operation.speed_rpm", 60.0, 0.1),
    "scotch-yoke-pump": ("operation.speed_rpm", 120.0, 0.1),
}
"""A key of each design that is turned, from where, and by how much each time."""

AIMS_MS = {"motion": 100, "scene": 300, "teeth": 1000, "strength": 1000}
"""What was asked for: motion, ratio and power; pitch curves and teeth; contact; strength."""

TIMES = 5
WARM = 2


def measured(name: str) -> dict[str, list[float]]:
    """Milliseconds to each part for several changes of a design."""
    key, start, step = CHANGED[name]
    found: dict[str, list[float]] = defaultdict(list)
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.yaml"
        copy(ROOT / "designs" / path.name, path)
        with running(path, Path(folder) / "export") as studio, studio.page() as page:
            page.settled(page.until("state")["n"])
            for number in range(1, TIMES + WARM + 1):
                took = one_change(page, key, start + number * step)
                if number > WARM:
                    for part, milliseconds in took.items():
                        found[part].append(milliseconds)
    return found


def one_change(page: Page, key: str, value: float) -> dict[str, float]:
    """Milliseconds to the first answer of each kind after a change."""
    begun = time.perf_counter()
    took: dict[str, float] = {}
    done: set[str] = set()
    page.send("change", changes={key: value})
    number = None
    while done != {"motion", "gears"}:
        message = page.hear()
        if message["is"] == "asked":
            number = message["n"]
        elif message.get("n") == number and number is not None:
            took.setdefault(message["is"], 1e3 * (time.perf_counter() - begun))
            if message["is"] == "done":
                done.add(message["from"])
    return took


def _cell(milliseconds: list[float]) -> str:
    return f"{statistics.median(milliseconds):.0f} ({max(milliseconds):.0f})"


def main() -> None:
    """Measure all, and write the table."""
    parts = ("motion", "figures", "scene", "teeth", "strength")
    rows = []
    for name in CHANGED:
        found = measured(name)
        cells = [_cell(found[part]) if part in found else "-" for part in parts]
        rows.append(f"| {name} | {' | '.join(cells)} |")
        print(rows[-1], flush=True)
    aims = " | ".join(str(AIMS_MS.get(part, "")) for part in parts)
    text = [
        "# How fast the studio answers",
        "",
        "Milliseconds from a change to each part, over the web socket: the median of five changes that each wait for",
        "the one before, and the largest in brackets. `python benchmarks/studio.py` measures it anew.",
        "",
        "| design | motion, ratio, power | figures and wishes | pitch curves and teeth | contact | strength |",
        "|---|---|---|---|---|---|",
        *rows,
        f"| asked for | {aims} |",
        "",
    ]
    (ROOT / "benchmarks" / "studio.md").write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main()
