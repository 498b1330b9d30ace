"""How far laws are from the limit that no law goes below, and what both cost.  Writes benchmarks/law-to-limit.md.

Run as ``make bench`` or ``python benchmarks/law_to_limit.py``.  The three balers of designs/ and six foreign machines;
seconds are those of all processors, each of limit and search for itself.
"""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from math import radians
from pathlib import Path
from time import process_time

from foreign import FOREIGN, Asked, asked_by
from ncgear.optimum.makeable.demanded import certified_limit, raised_limit, start_motion
from ncgear.optimum.makeable.law import makeable_law
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Limits, figures
from speed_against_error.baler import TASK

ROOT = Path(__file__).parents[1]
BALERS = ("baler-66", "baler-half", "baler-smooth")
MACHINES = {**{name: ROOT / "designs" / f"{name}.yaml" for name in BALERS}, **FOREIGN}
HARDER = {
    name: ROOT / "designs" / f"{name}.yaml" for name in ("feeder-wishes", "feeder-kept", "pump-both-ways", "baler-real")
}
"""Designs with wishes for times, or with masses: their limits are raised towards the law."""


RACK_RAD = radians(20.0)
KNOTS = (180, 720)
ANGLES = ((6300.0, 60.0), (6300.0, 55.0), (6300.0, 50.0), (9375.0, 50.0), (9375.0, 45.0), (9375.0, 40.0))

UNITS = {Goal.ACCELERATION: "mm/s²", Goal.POWER: "W", Goal.WEIGHTED: ""}


@dataclass(frozen=True)
class Reached:
    """The goal that a law has and its limit, in the goal's unit, and processor seconds of limit and search."""

    law: float
    limit: float
    limit_s: float
    search_s: float

    @property
    def gap(self) -> float:
        """By what share of the limit the law is above it."""
        return self.law / self.limit - 1.0


def reached(asked: Asked) -> Reached:
    """Limit and law of a machine; raises NoSuchMechanism where no law keeps what is asked, ValueError without limit."""
    task, wishes = asked.task, asked.wishes
    start = process_time()
    bound = certified_limit(task, wishes)
    limit_s = process_time() - start
    if bound is None:
        raise ValueError(f"no limit of {wishes.goal} is known")
    start = process_time()
    law = makeable_law(task, wishes, start_motion(task, wishes, bound))
    search_s = process_time() - start
    found = figures(task, law.train(task.lobes))
    start = process_time()
    raised = raised_limit(task, wishes, bound, found, law.motion)
    return Reached(wishes.prices.of(found), raised.value, limit_s + process_time() - start, search_s)


def angle_row(power_w: float, angle_deg: float) -> str:
    """The limit and laws of few and many knots under a pressure angle, as a row."""
    own = radians(angle_deg) - RACK_RAD
    limits = Limits(0.2, 5.0, peak_power_w=power_w, pressure_angle_rad=own, rack_angle_rad=RACK_RAD)
    found = [reached(Asked(TASK, Wishes(limits, knots=knots))) for knots in KNOTS]
    laws = " | ".join(f"{one.law:.0f}" for one in found)
    return f"| {power_w:.0f} W | {angle_deg:.0f}° | {found[0].limit:.0f} | {laws} |"


def page() -> str:
    """The whole page."""
    rows = []
    for name, path in {**MACHINES, **HARDER}.items():
        asked = asked_by(path)
        found = reached(asked)
        unit = UNITS[asked.wishes.goal]
        rows.append(
            f"| {name} | {found.law:.5g} {unit} | {found.limit:.5g} {unit} | {100.0 * found.gap:.2f} "
            f"| {found.limit_s:.1f} | {found.search_s:.1f} |"
        )
    return "\n".join(
        [
            "# From a law to its limit",
            "",
            f"Written by `python benchmarks/law_to_limit.py`: {os.cpu_count()} cores, Python "
            f"{platform.python_version()}. Pitch curves are convex; "
            "the machines are in `designs` and `benchmarks/foreign`. The last four have wishes for times, or masses.",
            "",
            "| machine | law | no law is below | gap, % | limit, s | search, s |",
            "|---|---|---|---|---|---|",
            *rows,
            "",
            "The baler at 60 r/min under a greatest pressure angle, the rack's 20 degrees included, in mm/s². Near the",
            "least angle more knots pay.",
            "",
            f"| power | angle | no law is below | {' | '.join(f'law of {knots} knots' for knots in KNOTS)} |",
            "|" + "---|" * (3 + len(KNOTS)),
            *(angle_row(power_w, angle_deg) for power_w, angle_deg in ANGLES),
            "",
        ]
    )


if __name__ == "__main__":
    (ROOT / "benchmarks" / "law-to-limit.md").write_text(page(), encoding="utf-8")
