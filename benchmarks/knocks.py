"""What teeth bear where the load changes flanks, by the estimate of strength and by the motion in time.

Run as ``make bench`` or ``python benchmarks/knocks.py``.  Writes benchmarks/knocks.md.  The machines are those of the
designs with masses, at other speeds, with other masses and other backlash, drawn at random; the motion in time is
followed over three turns, of which the first does not count.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from ruamel.yaml import YAML

import ncgear
from ncgear.errors import DesignError
from ncgear.project.vibration import mesh_stiffness
from ncgear.strength.conditions import GRADE

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
PLAYS, DIFFERENT = (0.99, 1.01), 0.1
"""Times the backlash with which the motion in time is followed again, and from what difference on."""
SPEEDS, MASSES, BACKLASHES_MM = (0.5, 1.6), (0.5, 2.0), (0.03, 0.06, 0.1, 0.2, 0.3)

PAGE = """\
# Knocks

Written by `python benchmarks/knocks.py`: {count} machines of the designs with masses, at 0.5 to 1.6 times their speed,
with 0.5 to 2 times their slider's mass and backlash of 0.03 to 0.3 mm. The largest force of a pair of teeth in N on
pushing flanks and on their backs, by the estimate of `ncgear strength` for flanks without deviations and by the motion
in time over two turns. Teeth that bounce to and fro are as sensitive as a ball: where both differ by more than 10 %,
the motion in time is the hardest of three, with the backlash and with 1 % less and more. It counts no friction of
guides, so that the machines have none; both count friction between the teeth. Deviations of grade {grade} press them
more, as K_V says: "told" is the share with them.

| machine | r/min | backlash, mm | knocks a turn | strength, N | in time, N | share | told | s of processors |
|---|---|---|---|---|---|---|---|---|
{rows}

Shares of the largest force of each machine: {least:.2f} to {most:.2f}, half of them within {low:.2f} to {high:.2f};
with deviations {told_least:.2f} to {told_most:.2f}. {within} of {count} are within 15 %; what is told is on the safe
side of {safe}.
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
    told_n: float
    seconds: tuple[float, float]

    @property
    def share(self) -> float:
        """The largest estimated force over the largest one in time."""
        return max(self.estimated_n) / max(self.in_time_n)

    @property
    def told(self) -> float:
        """The same with deviations."""
        return self.told_n / max(self.in_time_n)

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
            f"{self.told:.2f}",
            f"{self.seconds[0]:.1f} / {self.seconds[1]:.1f}",
        ]
        return f"| {' | '.join(cells)} |"


def machines() -> Iterator[tuple[str, dict[str, Any]]]:
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
        design.get("drivetrain", {}).pop("guide_friction", None)
        yield name, design


def in_time_n(design: dict[str, Any], play: float) -> list[float]:
    """The largest force of a pair on either side with so many times the backlash."""
    changed = deepcopy(design)
    changed["gears"]["backlash_mm"] *= play
    course = ncgear.load(changed).course
    states = course.at(course.fine_s)
    (teeth,) = course.machine.answer(states).teeth
    later = (states[0] > 2.0 * np.pi)[:, None]
    return [float((teeth.normal_n * later)[teeth.near.urge == urge].max(initial=0.0)) for urge in (1.0, -1.0)]


def compared(name: str, design: dict[str, Any]) -> Compared:
    """A machine both ways; raises DesignError where one of them is refused."""
    begun, drive = process_time(), ncgear.load(design)
    loading = drive.loading_by("estimate")
    rated_s = process_time() - begun
    estimated, told = [0.0, 0.0], 0.0
    exact = replace(drive.vibration, deviations_mm=(0.0, 0.0))
    for loads in filter(None, (loading, loading.still)):
        contacts, mesh, followed = loads.contacts, mesh_stiffness(loads, drive.running), loads.still is not None
        shaken = contacts.force_n * exact.of_contacts(contacts, mesh, drive.conditions, followed)
        estimated = [max(estimated[side], shaken[contacts.side == side].max(initial=0.0)) for side in (0, 1)]
        deviating = drive.vibration.of_contacts(contacts, mesh, drive.conditions, followed)
        told = max(told, float((contacts.force_n * deviating).max()))
    begun = process_time()
    each = [in_time_n(design, 1.0)]
    followed_s = process_time() - begun
    if min(each[0]) > 0.0 and abs(max(estimated) / max(each[0]) - 1.0) > DIFFERENT:
        each += [in_time_n(design, play) for play in PLAYS]
    return Compared(
        name,
        drive.design.operation.speed_rpm,
        drive.gears.backlash_mm or 0.0,
        len(loading.knocks or ()),
        (estimated[0], estimated[1]),
        (max(one[0] for one in each), max(one[1] for one in each)),
        told,
        (rated_s, followed_s),
    )


def main() -> None:
    """Compare and write the page."""
    found = list[Compared]()
    for name, design in machines():
        try:
            found.append(compared(name, design))
        except DesignError as refusal:
            print(f"{name}: {refusal.problem}", flush=True)
            continue
        print(found[-1].row, flush=True)
        if len(found) == MACHINES:
            break
    shares, told = np.array([[one.share, one.told] for one in found]).T
    low, high = np.quantile(shares, [0.25, 0.75])
    page = PAGE.format(
        count=len(found),
        rows="\n".join(one.row for one in found),
        least=shares.min(),
        most=shares.max(),
        low=low,
        high=high,
        told_least=told.min(),
        told_most=told.max(),
        within=int(((shares >= 0.85) & (shares <= 1.15)).sum()),
        safe=int((told >= 1.0).sum()),
        grade=GRADE,
    )
    (ROOT / "benchmarks" / "knocks.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
