"""What teeth bear where the load changes flanks, by the estimate of strength and by the motion in time.

Run as ``make bench`` or ``python benchmarks/knocks.py``.  Writes benchmarks/knocks.md.  The machines are those of the
designs with masses, at other speeds, with other masses and other backlash, drawn at random; the motion in time is
followed over three turns, of which the first does not count.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np
from ruamel.yaml import YAML

import ncgear
from ncgear.errors import DesignError
from ncgear.project.drive import Drive

ROOT = Path(__file__).parents[1]
DESIGNS = (
    "baler-holds",
    "baler-real",
    "baler-drivetrain",
    "baler-half-dynamics",
    "quick-return-shaper",
    "pump-both-ways",
    "scotch-yoke-pump",
    "rocker-drive",
)
MACHINES, SEED, TURNS = 40, 41, 3
SPEEDS, MASSES, BACKLASHES_MM = (0.5, 1.6), (0.5, 2.0), (0.03, 0.06, 0.1, 0.2, 0.3)

PAGE = """\
# Knocks

Written by `python benchmarks/knocks.py`: {count} machines of the designs with masses, at 0.5 to 1.6 times their speed,
with 0.5 to 2 times their slider's mass and backlash of 0.03 to 0.3 mm. The largest force of a pair of teeth in N on
pushing flanks and on their backs, by `ncgear strength` and by the motion in time over two turns; "K_V" is the
largest force with the vibration that strength adds over the largest without, and the motion in time holds vibration as
well.

| machine | r/min | backlash, mm | knocks a turn | strength, N | in time, N | share | with K_V | s of processors |
|---|---|---|---|---|---|---|---|---|
{rows}

Shares of the largest force of each machine, with K_V: {least:.2f} to {most:.2f}, half of them within {low:.2f} to
{high:.2f}; {under} of {count} are under 0.85.
"""


@dataclass(frozen=True)
class Compared:
    """The forces in N of both sides by the estimate and in time, and processor seconds of either."""

    name: str
    speed_rpm: float
    backlash_mm: float
    knocks: int
    estimated_n: tuple[float, float]
    in_time_n: tuple[float, float]
    dynamic_factor: float
    seconds: tuple[float, float]

    @property
    def share(self) -> float:
        """The largest estimated force over the largest one in time."""
        return max(self.estimated_n) / max(self.in_time_n)

    @property
    def row(self) -> str:
        """The row of the page."""
        estimated, in_time = (" / ".join(f"{one:.0f}" for one in pair) for pair in (self.estimated_n, self.in_time_n))
        cells = [
            self.name,
            f"{self.speed_rpm:.4g}",
            f"{self.backlash_mm:g}",
            str(self.knocks),
            estimated,
            in_time,
            f"{self.share:.2f}",
            f"{self.share * self.dynamic_factor:.2f}",
            f"{self.seconds[0]:.1f} / {self.seconds[1]:.1f}",
        ]
        return f"| {' | '.join(cells)} |"


def machines() -> Iterator[tuple[str, Drive]]:
    """The machines, some of which may be refused."""
    draw, yaml = random.Random(SEED), YAML(typ="safe")
    while True:
        name = draw.choice(DESIGNS)
        design = yaml.load(ROOT / "designs" / f"{name}.yaml")
        design["operation"]["speed_rpm"] *= draw.uniform(*SPEEDS)
        design["gears"]["backlash_mm"] = draw.choice(BACKLASHES_MM)
        mass = draw.uniform(*MASSES)
        if "slider_kg" in design["masses"]:
            design["masses"]["slider_kg"] *= mass
        design.setdefault("simulation", {})["turns"] = TURNS
        yield name, ncgear.load(design)


def compared(name: str, drive: Drive) -> Compared:
    """A machine both ways; raises DesignError where one of them is refused."""
    begun = process_time()
    contacts, loading = drive.strength.contacts, drive.loading_by(drive.design.strength.method)
    rated_s = process_time() - begun
    estimated = [float(contacts.force_n[contacts.side == side].max(initial=0.0)) for side in (0, 1)]
    shaken = float((contacts.force_n * drive.strength.stresses.dynamic_factor).max() / contacts.force_n.max())
    begun = process_time()
    course = drive.course
    states = course.at(course.fine_s)
    teeth = course.machine.answer(states).teeth
    followed_s = process_time() - begun
    later = (states[0] > 2.0 * np.pi)[:, None]
    in_time = [float((teeth.normal_n * later)[teeth.near.urge == urge].max(initial=0.0)) for urge in (1.0, -1.0)]
    return Compared(
        name,
        drive.design.operation.speed_rpm,
        drive.gears.backlash_mm or 0.0,
        len(loading.knocks or ()),
        (estimated[0], estimated[1]),
        (in_time[0], in_time[1]),
        shaken,
        (rated_s, followed_s),
    )


def main() -> None:
    """Compare and write the page."""
    found = list[Compared]()
    for name, drive in machines():
        try:
            found.append(compared(name, drive))
        except DesignError as refusal:
            print(f"{name}: {refusal.problem}", flush=True)
            continue
        print(found[-1].row, flush=True)
        if len(found) == MACHINES:
            break
    shares = np.array([one.share * one.dynamic_factor for one in found])
    low, high = np.quantile(shares, [0.25, 0.75])
    page = PAGE.format(
        count=len(found),
        rows="\n".join(one.row for one in found),
        least=shares.min(),
        most=shares.max(),
        low=low,
        high=high,
        under=int((shares < 0.85).sum()),
    )
    (ROOT / "benchmarks" / "knocks.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
