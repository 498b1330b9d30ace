"""How the studio keeps up with a hand: a value is dragged over its web socket at 60 moves a second.

    python benchmarks/studio.py [DESIGN ...]

The studio runs as a process of its own, as for a page.  A move has its picture when an answer comes that belongs to it
or to a newer move; each part of the answer (motion, gears, contact, strength) is timed by itself, over all moves of a
drag.  Beside the times stand the pictures a second, the processor time of the studio's processes for a second of
dragging, and what else ran on the computer, since a computer that is not free tells little.  Without designs it writes
benchmarks/studio.md; ``--json FILE`` keeps the numbers, ``--before FILE`` puts those of an earlier run beside them.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import sys
import threading
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests")]

from ncgear.studio.worker import CHAINS  # noqa: E402
from studios import Page, Studio, running  # noqa: E402

DRAGGED = {
    "baler-86": ("motion.theta2_pi", 0.7, 0.02),
    "pusher": ("motion.theta2_pi", 0.5, 0.02),
    "rocker-drive": ("linkage.coupler_mm", 130.0, 4.0),
    "baler-66-two-stage": ("linkage.rod_mm", 960.0, 40.0),
}
"""The key of each design that is dragged, from where, and how far in all."""

PARTS = {"motion": "motion", "scene": "gears", "teeth": "contact", "strength": "strength"}
"""The first answer of a kind, and the part of the picture that it brings."""

AIMS_MS = {"motion": 100, "gears": 300, "contact": 600, "strength": 1200, "opening": 2000}
"""What is asked for on two free cores: of 95 % of the moves, and from the command to the first motion."""

MOVES_A_SECOND = 60
SECONDS = 10
HEAD = re.compile(r'\{"is": ?"(\w+)", ?"n": ?(\d+)')
TICKS = os.sysconf("SC_CLK_TCK")


@dataclass
class Drag:
    """The moves of a drag and the answers to them; times in s of the monotonic clock."""

    key: str
    values: list[float]
    sent_s: list[float] = field(default_factory=list)
    moves: dict[int, int] = field(default_factory=dict)
    came: dict[str, list[tuple[float, int]]] = field(default_factory=lambda: {part: [] for part in PARTS})

    def send(self, page: Page) -> None:
        """Send all moves in time, as a browser does."""
        begun = time.monotonic()
        for number, value in enumerate(self.values):
            time.sleep(max(0.0, begun + number / MOVES_A_SECOND - time.monotonic()))
            self.sent_s.append(time.monotonic())
            page.send("change", changes={self.key: value})

    def hear(self, text: str) -> tuple[str, int]:
        """Note an answer; returns its kind and the number of its text."""
        found = HEAD.match(text)
        if found is None:
            return "", -1
        kind, number = found[1], int(found[2])
        if kind == "asked":
            value = json.loads(text)["content"][self.key]
            self.moves[number] = min(range(len(self.values)), key=lambda one: abs(self.values[one] - value))
        elif kind in PARTS and number in self.moves and self.moves[number] not in (move for _, move in self.came[kind]):
            # The gears come again with bore and holes.
            self.came[kind].append((time.monotonic(), self.moves[number]))
        return kind, number

    def waits_ms(self, kind: str) -> list[float]:
        """For each move the time until there was a picture of it or of a newer one."""
        waits, answers = [], iter(sorted(self.came[kind]))
        at_s, newest = 0.0, -1
        for move, sent_s in enumerate(self.sent_s):
            while newest < move:
                at_s, newest = next(answers)
            waits.append(1e3 * (at_s - sent_s))
        return waits

    def ages_ms(self, kind: str) -> list[float]:
        """For each picture the time since the move that it shows."""
        return [1e3 * (at_s - self.sent_s[move]) for at_s, move in self.came[kind]]

    def pictures_a_second(self, kind: str) -> float:
        """New pictures while the hand moves."""
        end = self.sent_s[-1]
        return len({move for at_s, move in self.came[kind] if at_s <= end}) / (end - self.sent_s[0])


def dragged(studio: Studio, page: Page, key: str, start: float, way: float) -> dict[str, Any]:
    """The figures of one drag."""
    moves = MOVES_A_SECOND * SECONDS
    drag = Drag(key, [start + way * (number + 1) / moves for number in range(moves)])
    used_s, others_s = processor_s(studio), busy_s()
    sending = threading.Thread(target=drag.send, args=(page,))
    sending.start()
    done: dict[int, int] = {}
    while not (drag.moves and drag.moves[newest := max(drag.moves)] == moves - 1 and done.get(newest) == ENDS):
        kind, number = drag.hear(page.socket.recv(90.0))
        if kind == "done":
            done[number] = done.get(number, 0) + 1
    sending.join()
    took_s = time.monotonic() - drag.sent_s[0]
    used_s, others_s = processor_s(studio) - used_s, busy_s() - others_s
    found: dict[str, Any] = {"processor": used_s / took_s, "others": (others_s - used_s) / took_s}
    for kind, part in PARTS.items():
        waits, ages = drag.waits_ms(kind), drag.ages_ms(kind)
        middle, most = statistics.median, partial(statistics.quantiles, n=20)
        found[part] = [
            middle(ages),
            most([*ages, *ages])[-1],
            middle(waits),
            most(waits)[-1],
            drag.pictures_a_second(kind),
        ]
    return found


ENDS = len(CHAINS)
"""Messages that tell the end of the answers to a text: one of each chain."""


def measured(name: str) -> dict[str, Any]:
    """Opens a design, and drags its value."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.yaml"
        copy(ROOT / "designs" / path.name, path)
        begun = time.monotonic()
        with running(path, Path(folder) / "export") as studio, studio.page() as page:
            page.until("motion")
            opening = [1e3 * (time.monotonic() - begun), processor_s(studio)]
            ends = 0
            while ends < ENDS:
                ends += page.hear()["is"] == "done"
            return {"opening": opening, **dragged(studio, page, *DRAGGED[name])}


def processor_s(studio: Studio) -> float:
    """Processor time in s of the studio's processes so far."""
    found = 0
    for process in (studio.process.pid, *studio.workers):
        values = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        found += int(values[11]) + int(values[12])
    return found / TICKS


def busy_s() -> float:
    """Processor time in s of everything on the computer."""
    values = [int(value) for value in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]]
    return (sum(values) - values[3] - values[4]) / TICKS


def row(name: str, found: dict[str, Any]) -> str:
    """A row of the table."""
    cells = [f"{found['opening'][0]:.0f}, {found['opening'][1]:.1f}"]
    cells += ["{:.0f} / {:.0f}, {:.0f} / {:.0f}, {:.1f}".format(*found[part]) for part in PARTS.values()]
    return f"| {name} | {' | '.join(cells)} | {found['processor']:.2f} | {found['others']:.2f} |"


TABLE = """\
| design | opening: ms, s of processor | motion | gears | contact | strength | processor | others |
|---|---|---|---|---|---|---|---|"""

TEXT = """\
# How the studio keeps up with a hand

`python benchmarks/studio.py` drags a value of each design for {seconds} s at {moves} moves a second over the web
socket. *Opening*: from the command to the first motion by the clock in ms, and processor time of all processes in s.
Each part: median and 95th percentile in ms from a move to the picture that shows it; the same from every move to the
first picture that shows it or a newer one, which counts the wait for a picture to be begun; new pictures a second while
the hand moves. *Processor*: seconds of processor for a second of dragging, *others*: the same of everything else on
the computer (the client that measures takes part of it). Two cores; aims for the 95th percentile on two free ones:
{aims} ms.

{tables}
"""


def main() -> None:
    """Measure, print, and write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("designs", nargs="*", choices=[*DRAGGED, []])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--before", type=Path)
    asked = parser.parse_args()
    found = {}
    for name in asked.designs or DRAGGED:
        found[name] = measured(name)
        print(row(name, found[name]), flush=True)
    if asked.json:
        asked.json.write_text(json.dumps(found), encoding="utf-8")
    if asked.designs:
        return
    tables = "\n".join([TABLE, *(row(name, one) for name, one in found.items())])
    if asked.before:
        rows = [row(name, one) for name, one in json.loads(asked.before.read_text(encoding="utf-8")).items()]
        tables = "\n".join([tables, "", "Before, when each move had its text rewritten:", "", TABLE, *rows])
    aims = ", ".join(f"{part} {aim}" for part, aim in AIMS_MS.items())
    text = TEXT.format(seconds=SECONDS, moves=MOVES_A_SECOND, aims=aims, tables=tables)
    (ROOT / "benchmarks" / "studio.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
