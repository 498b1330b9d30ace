"""Why laws exist but no whole machine: the choices that must give way, each tested by making a machine."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ncgear.design.keys.optimize import Choices
from ncgear.design.reading.design_file import parsed
from ncgear.design.rewritten import design_copy
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.bounds import shown_above
from ncgear.project.strengthening import STRONGER
from ncgear.whole_machines.gears import GearJob, machine_of
from ncgear.whole_machines.machine import Unfit, WholeMachine
from ncgear.workers import finished

WIDEST = 30.0
"""Greatest face width in modules that is tried."""


class Easing(NamedTuple):
    """A demand that gives way: its keys without the demand, and words about the machine that was then made."""

    key: str
    values: tuple[tuple[str, object], ...]


def easings(choices: Choices, material: str) -> list[Easing]:
    """The choices that may give way, one at a time, then all together."""
    found = [
        Easing(f"choices.{name}", ((f"choices.{name}", None),))
        for name in ("center_distance_mm", "diameter_mm", "modules_mm", "motors")
        if getattr(choices, name) is not None
    ]
    if choices.face_width_modules.most < WIDEST:
        found.append(Easing("choices.face_width_modules.most", (("choices.face_width_modules.most", WIDEST),)))
    strongest = STRONGER[-1]
    if material != strongest:
        found.append(Easing("gears.material", (("choices.materials", None), ("gears.material", strongest))))
    together = tuple(value for easing in found for value in easing.values)
    return [*found, *([Easing("all", together)] if len(found) > 1 else [])]


def _tried(text: str, jobs: list[GearJob], easing: Easing) -> WholeMachine | None:
    """The first machine made from a few laws when a demand gives way."""
    loaded = parsed(text, Path("design.yaml"))
    values = dict(easing.values)
    given = loaded.design.choices
    if given is None or (set(values) & {"choices.materials"} and given.materials is None):
        values.pop("choices.materials", None)
    eased = design_copy(loaded, values)
    for job in jobs:
        made = machine_of(eased, job._replace(material=None) if "gears.material" in values else job)
        if isinstance(made, WholeMachine):
            return made
    return None


def _needs(easing: Easing, made: WholeMachine) -> str:
    has = made.figures
    told = {
        "choices.center_distance_mm": f"a centre distance of {shown_above(has.center_distance_mm)} mm",
        "choices.diameter_mm": f"a diameter of {shown_above(has.diameter_mm)} mm",
        "choices.modules_mm": f"a module of {has.module_mm:g} mm",
        "choices.motors": f"a motor of {shown_above(has.peak_power_w)} W and {shown_above(has.peak_torque_n_m)} N m",
        "choices.face_width_modules.most": f"a face width of {shown_above(has.face_width_mm / has.module_mm)} modules",
        "gears.material": f"gears of {made.material}",
    }
    return f"{told[easing.key]} ({easing.key})"


def refusal_of_gears(
    text: str,
    choices: Choices,
    material: str,
    jobs: list[GearJob],
    unfit: Sequence[Unfit],
    scheduler: str | None,
    processes: int | None,
) -> NoSuchMechanism:
    """The error of a search that found laws but no gears, with the demands that each gave a machine when they gave way.

    ``text`` is the design file, ``material`` the name of the first material, ``jobs`` are gears of a few laws, and
    ``unfit`` the gears that made no machine.
    """
    asked = easings(choices, material)
    found = dict(finished(partial(_tried, text, jobs), asked, scheduler, processes))
    alone = [(demand, made) for demand, made in found.items() if made is not None and demand.key != "all"]
    why = "; ".join(dict.fromkeys(why for gears in unfit for why in gears.why))
    said = f"laws keep all limits, and no gears of them make a machine: {why}"
    if alone:
        offers = ", ".join(_needs(demand, made) for demand, made in alone)
        return NoSuchMechanism(f"{said}; a machine was made with each of these: {offers}", key=alone[0][0].key)
    together = next((made for demand, made in found.items() if made is not None), None)
    if together is not None:
        offers = ", ".join(_needs(demand, together) for demand in asked if demand.key != "all")
        return NoSuchMechanism(f"{said}; a machine was made with all of these together: {offers}", key=asked[0].key)
    return NoSuchMechanism(f"{said}; none of the choices helped by giving way", key="choices")
