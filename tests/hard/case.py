"""The hard cases: a design file each, and what cannot be said in one; some are to be refused, and say why."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import cos, pi
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from ruamel.yaml import YAML

from drives import design_of
from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import load
from ncgear.design.reading.messages import problems
from ncgear.errors import WrongInput
from ncgear.project.drive import Drive

FOLDER = Path(__file__).parents[1] / "cases"

REFUSED = {
    "a1-vanishing": r"the ratio is 4.824e\+04 where it begins .* an a1 farther from zero",
    "a1-too-large": "no law speed closes a stroke .* bring a1 nearer to zero",
    "theta1-vanishing": "the approach goes backwards altogether; theta1 lies too near 0",
    "v2-vanishing": "the slider stops or reverses",
    "stroke-off-by-1e-3": "760.76 mm is longer than the linkage's stroke of 760 mm",
    "table-coarse-noise": "the slider turns back after phi1",
    "table-two-points": "a list of 2 given; a list of at least 4 items",
    "table-100000-points": "100000 points a cycle; .* At most 2000 are right: keep every 50th",
    "pole": "zero, infinite or jumps near phi1 = 1 rad",
    "pole-changing-sign": "zero, infinite or jumps near phi1",
    "ratio-through-zero": "zero, infinite or jumps near phi1",
}
"""What is to be said of cases that no gears exist for; all others are to be made."""


@dataclass(frozen=True)
class Case:
    """Plain values of a design file; its description says what makes it hard."""

    name: str
    values: Callable[[], dict[str, Any]]

    @cached_property
    def data(self) -> dict[str, Any]:
        """The values, read or made once."""
        return self.values()

    @property
    def refusal(self) -> str | None:
        """Pattern of the message it is to be refused with; None for what is to be made."""
        return REFUSED.get(self.name)

    def drive(self) -> Drive:
        """The design's drive; raises WrongInput as a file would."""
        path = FOLDER / f"{self.name}.yaml"
        return Drive(load(path).design) if path.exists() else drive_of(self.data)


def drive_of(data: dict[str, Any]) -> Drive:
    """The drive of plain values; raises WrongInput for what no file may hold."""
    try:
        return Drive(design_of(data))
    except ValidationError as error:
        first = problems(error, Design, data)[0]
        raise WrongInput(first.text, key=first.key) from error


def cases() -> Iterator[Case]:
    """All cases, in the order of their names."""
    files = {path.stem: (lambda path=path: read(path)) for path in FOLDER.glob("*.yaml")}
    for name, values in sorted({**files, "table-100000-points": dense_table}.items()):
        yield Case(name, values)


def read(path: Path) -> dict[str, Any]:
    """A design file as plain dictionaries, lists, numbers and words."""
    values: dict[str, Any] = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
    return values


def dense_table() -> dict[str, Any]:
    """100 000 ratios of a smooth law, which no file of a sensible size holds."""
    angles = [2.0 * pi * k / 100_000 for k in range(100_000)]
    motion = {"law": "table", "phi1_rad": angles, "ratio": [1.0 + 0.1 * cos(at) for at in angles]}
    return {
        "name": "table-100000-points",
        "description": "100 000 points: the spline magnifies their rounding until no curvature is left",
        "linkage": {"crank_mm": 50.0, "rod_mm": 200.0},
        "operation": {"speed_rpm": 60.0},
        "motion": {**motion, "scale_to_close": True},
    }
