"""The price of each wish and limit: the law found again without it, at the same power and for the least power."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from ncgear.design.keys.optimize import Optimize
from ncgear.design.reading.design_file import parsed
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.optimum.makeable.demanded import start_motion
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import LOAD_LIMITS, figures
from ncgear.project.drive import Drive
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.whole_machines.laws import law_design, law_wishes
from ncgear.whole_machines.machine import WholeMachine
from ncgear.workers import finished

LIMITS = {
    "peak_acceleration_mm_s2": "peak_acceleration_mm_s2",
    "peak_acceleration_rad_s2": "peak_acceleration_mm_s2",
    "peak_speed_mm_s": "peak_speed_mm_s",
    "peak_speed_rad_s": "peak_speed_mm_s",
    "pressure_angle_deg": "pressure_angle_rad",
    **{name: name for name in LOAD_LIMITS},
}
"""Limits of a file that have a price, and their names in the wishes of a law."""

COUNTS = 5e-3
"""Least share of the motor or of the gears at which a price is told."""

CLOSE = 1.001
"""Ratio by which laws that are found again may miss the power of the machine."""


class WishPrice(NamedTuple):
    """Increase of motor and gears because of a wish or limit, as shares of the need without it."""

    key: str
    motor: float
    gears: float


@dataclass(frozen=True)
class NeededPower:
    """The least power in W, and the least flank load in N mm at the machine's power; infinite where none was found."""

    power_w: float
    flank_load_n_mm: float


def wish_keys(text: str) -> list[str]:
    """The keys of all hard wishes and limits of a design file that have a price."""
    design = parsed(text, Path("machine.yaml")).design
    given = (design.optimize or Optimize()).limits
    limits = [f"optimize.limits.{name}" for name in LIMITS if getattr(given, name) is not None]
    wishes = [wish.key for wish in law_wishes(law_design(design), None).motion if wish.hard]
    return [*dict.fromkeys(wishes), *limits, *(["optimize.limits.convex"] if given.convex else [])]


def _without(wishes: Wishes, key: str) -> Wishes:
    name = key.removeprefix("optimize.limits.")
    if name == "convex":
        return replace(wishes, convex=False)
    if name in LIMITS:
        free: dict[str, Any] = {LIMITS[name]: None}
        return replace(wishes, limits=replace(wishes.limits, **free))
    return replace(wishes, motion=tuple(wish for wish in wishes.motion if wish.key != key))


def needed_without(text: str, key: str) -> NeededPower:
    """The need of a machine without a wish; with an empty key, the need with all wishes."""
    from ncgear.optimum.makeable.law import kept_law

    design = parsed(text, Path("machine.yaml")).design
    made = law_design(design)
    task, wishes = task_of(made, inertia_as_given(made)), law_wishes(made, None)
    wishes = _without(wishes, key) if key else wishes
    cap = CLOSE * Drive(design).check.peak_power_w.value
    try:
        start = start_motion(task, wishes)
    except DesignError:
        return NeededPower(inf, inf)
    power = kept_law(task, replace(wishes, goal=Goal.POWER), start)
    starts = [start, *([power.motion] if power else [])]
    capped = replace(wishes, limits=replace(wishes.limits, peak_power_w=min(cap, wishes.limits.peak_power_w or cap)))
    flanks = [law for one in starts if (law := kept_law(task, capped, one)) is not None]
    load = min((figures(task, one.train(task.lobes)).flank_load_n_mm or inf for one in flanks), default=inf)
    watts = figures(task, power.train(task.lobes)).peak_power_w if power else inf
    return NeededPower(watts, load)


def wish_prices(
    one: WholeMachine,
    on_law: Callable[[int, int], None],
    scheduler: str | None = None,
    processes: int | None = None,
) -> tuple[WishPrice, ...]:
    """The price of each wish and limit of a machine, the highest first; ``on_law`` takes numbers done and in all."""
    keys = ["", *wish_keys(one.text)]
    found: dict[str, NeededPower] = {}
    for key, needed in finished(partial(needed_without, one.text), keys, scheduler, processes):
        found[key] = needed
        on_law(len(found), len(keys))
    base = found.pop("")
    prices = [
        WishPrice(key, base.power_w / has.power_w - 1.0, base.flank_load_n_mm / has.flank_load_n_mm - 1.0)
        for key, has in found.items()
        if max(has.power_w, has.flank_load_n_mm) < inf
    ]
    told = [price for price in prices if max(price.motor, price.gears) > COUNTS]
    return tuple(sorted(told, key=lambda price: -max(price.motor, price.gears)))
