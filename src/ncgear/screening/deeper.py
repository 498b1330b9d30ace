"""The later stages of a sweep: teeth, contact and strength of single designs, each by its drive.

Only the parts for figures are made: no solids, no written outlines, no motion in time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.space import checked_design
from ncgear.errors import DesignError, WrongInput
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.figures import CONTACT, OF_PAIR
from ncgear.project.opened import drive_like
from ncgear.project.strengthening import Rating, known_rating
from ncgear.screening.designs import MADE, Designs, as_in_file


def _strength_of(gear: Gear) -> dict[str, Callable[[Drive], float]]:
    def contact(drive: Drive) -> float:
        found = drive.strength.of(gear).contact
        # Of some materials nothing is known of pitting.
        return found.safety_min if found else nan

    return {
        f"strength.bending_safety_{gear.value}_min": lambda drive: drive.strength.of(gear).bending.safety_min,
        f"strength.contact_safety_{gear.value}_min": contact,
    }


STAGES: dict[str, dict[str, Callable[[Drive], float]]] = {
    "teeth": {
        **{f"teeth.{key}": OF_PAIR[f"teeth_{key}"] for key in ("driving", "driven")},
        **{f"teeth.{key}": OF_PAIR[key] for key in ("module_mm", "backlash_mm")},
        "teeth.undercut_driving": lambda drive: len(drive.teeth.driving.undercut),
        "teeth.undercut_driven": lambda drive: len(drive.teeth.driven.undercut),
    },
    "contact": {f"contact.{key}": of for key, of in CONTACT.items()},
    "strength": {
        "strength.peak_tooth_force_n": OF_PAIR["peak_tooth_force_n"],
        **_strength_of(Gear.DRIVING),
        **_strength_of(Gear.DRIVEN),
    },
}
"""The later stages in their order: the names of their figures, as in summary.json, and the functions for them."""


ROOM, OF_WANTED = "teeth.room_mm", "strength.safety_of_wanted_min"
"""Figures of the whole machine: the least distance of gears of a row that do not mesh, the least share of a wanted
safety."""


def is_row(design: Design) -> bool:
    """Whether its gears are a row, with idlers."""
    return design.gears is not None and design.gears.idlers is not None


def _of_whole(design: Design, stage: str) -> dict[str, Callable[[Drive], float]]:
    """The functions for the figures of a stage that are of the whole machine, by their names."""
    if stage == "teeth" and is_row(design):
        return {ROOM: lambda drive: min((distance.least_distance_mm for distance in drive.row_room), default=inf)}
    return {OF_WANTED: _of_wanted} if stage == "strength" else {}


def _of_wanted(drive: Drive) -> float:
    ratings = [known_rating(pair) for pair in drive.by_stage]
    shares = [weakest.share for rating in ratings if isinstance(rating, Rating) for weakest in rating.weakest]
    return min(shares, default=nan)


def stages_up_to(stage: str) -> tuple[str, ...]:
    """The stages that a design goes through, up to this one."""
    return tuple(STAGES)[: list(STAGES).index(stage) + 1]


def deeper_names(design: Design, stage: str) -> tuple[str, ...]:
    """The names of all figures up to a stage of a design, and of designs with other numbers.

    Each of several pairs has its own figures, such as ``stage_1.teeth.driving``.
    """
    pairs = design.stages
    return tuple(
        name
        for reached in stages_up_to(stage)
        for name in (
            *(f"{_of_pair(number, pairs)}{key}" for number in range(1, pairs + 1) for key in STAGES[reached]),
            *_of_whole(design, reached),
        )
    )


def _of_pair(number: int, pairs: int) -> str:
    return "" if pairs == 1 else f"stage_{number}."


def require_stage(design: Design, stage: str) -> None:
    """Raise WrongInput where no design of a file can reach a stage."""
    if design.gears is None:
        raise WrongInput(f"missing; without gears there is no stage {stage}, and --stage check is right", key="gears")
    if stage == "strength" and not design.loads_teeth:
        raise WrongInput("missing, and so are masses; the load of the teeth follows from them", key="resistance")


def deepened(data: dict[str, Any], names: Sequence[str], stage: str, designs: Designs) -> Designs:
    """The same designs with the figures of the stages up to ``stage``, ``names``, that each design reaches.

    ``data`` is the file's content.
    """
    found: list[tuple[dict[str, float], str]] = []
    drive: Drive | None = None
    for place in range(len(designs.numbers)):
        values = [column[place] for column in designs.values.values()]
        design = checked_design(data, tuple(designs.values), map(float, values))
        if isinstance(design, WrongInput):
            found.append(({}, str(design)))
            continue
        # Law, teeth and contact of the design before are kept where they are the same.
        drive = Drive(design) if drive is None else drive_like(drive, design)
        found.append(_followed(drive, stage))
    more = {name: np.array([row.get(name, np.nan) for row, _ in found]) for name in names}
    told = np.array([as_in_file(data, verdict) for _, verdict in found], dtype=object)
    return replace(designs, figures={**designs.figures, **more}, verdicts=told)


def _followed(drive: Drive, stage: str) -> tuple[dict[str, float], str]:
    """The figures of a design up to its refusal, and its verdict."""
    found: dict[str, float] = {}
    try:
        for reached in stages_up_to(stage):
            for number, pair in enumerate(drive.by_stage, start=1):
                of = _of_pair(number, drive.design.stages)
                found |= {f"{of}{name}": float(figure(pair)) for name, figure in STAGES[reached].items()}
            found |= {name: figure(drive) for name, figure in _of_whole(drive.design, reached).items()}
    except DesignError as error:
        return found, str(error)
    return found, MADE
