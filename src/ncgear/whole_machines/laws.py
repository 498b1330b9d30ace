"""Laws of least flank load under caps of the peak power, for each size of the flywheel on the driven shaft.

To resist pitting, flanks need a face width times centre distance squared in proportion to the flank load, which depends
on the law only.  So the law comes first.  Under each cap it is searched from the law under the next lower cap and from
the law under the next higher cap, since two optima can lie side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.design.laws.base import LawKeys
from ncgear.design.laws.registry import found_motion
from ncgear.design.reading.design_file import LoadedDesign, parsed
from ncgear.design.rewritten import design_copy
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.flywheels import LEAST_SHARE, mean_inertia_kg_mm2
from ncgear.optimum.makeable.demanded import start_motion
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project.law_task import inertia_as_given, task_of, wishes_of, with_driven_flywheel

KNOTS = 60
"""Knots of the laws; a law takes half a second.  180 knots are better by 1 %."""

CAPS = 4
"""Caps of the power for each flywheel, from the least power to the power of the least flank load."""

SIZES = 5
"""Number of sizes of the flywheel, from the least to the greatest."""

ABOVE = 1.003
"""Ratio of the lowest cap to the least power: at the least power itself there is nothing left to choose."""

SAME_POWER = 1.02
"""Ratio of two powers below which a law under a cap between them is not worth its time."""

STEEPEST_DEG = 60.0
"""The greatest pressure angle where the file sets no limit: beyond it a verdict warns."""


@dataclass(frozen=True, eq=False)
class FoundLaw:
    """The ratios of a law at even knots, the flywheel on the driven shaft in kg mm2, and the law's figures.

    ``teeth`` is the number of driving teeth for which its curvature was limited; None where it was not.
    """

    ratio: tuple[float, ...]
    flywheel_kg_mm2: float
    found: Figures
    teeth: int | None = None

    @property
    def flank_load_n_mm(self) -> float:
        """The figure of the law that makes gears large against pitting."""
        assert self.found.flank_load_n_mm is not None
        return self.found.flank_load_n_mm

    @property
    def motion(self) -> Motion:
        """Motion of the crank at the knots."""
        angle = np.linspace(0.0, 2.0 * np.pi, len(self.ratio), endpoint=False)
        return Motion(angle, 1.0 / np.array(self.ratio))


class LawJob(NamedTuple):
    """A flywheel and a number of teeth for which laws are searched together, and the powers to look at, if given."""

    flywheel_kg_mm2: float
    teeth: int | None
    powers_w: tuple[float, ...] = ()


def law_design(design: Design, flywheel_kg_mm2: float | None = None) -> Design:
    """The design for which laws are found: least flank load, with a given flywheel and any number of teeth."""
    asked = design.optimize or Optimize()
    steepest = asked.limits.pressure_angle_deg or STEEPEST_DEG
    limits = asked.limits.model_copy(update={"free_of_undercut": False, "pressure_angle_deg": steepest})
    free = {"driven_flywheel_kg_mm2": None, "lengths": None}
    sought = {"goal": str(Goal.FLANK_LOAD.value), "weights": None, "knots": KNOTS, **free}
    made = design.model_copy(update={"optimize": asked.model_copy(update={"limits": limits, **sought})})
    return made if flywheel_kg_mm2 is None or made.masses is None else with_driven_flywheel(made, flywheel_kg_mm2)


def law_wishes(design: Design, teeth: int | None) -> Wishes:
    """The wishes of such a design, with the curvature that a number of driving teeth allows."""
    assert design.optimize is not None
    assert design.gears is not None
    if teeth is None:
        return wishes_of(design)
    limits = design.optimize.limits.model_copy(update={"free_of_undercut": True})
    gears = design.gears.model_copy(update={"teeth": teeth})
    return wishes_of(
        design.model_copy(update={"gears": gears, "optimize": design.optimize.model_copy(update={"limits": limits})})
    )


def flywheel_sizes(design: Design) -> tuple[float, ...]:
    """The sizes of the flywheel to look at, in even ratios of the whole inertia; the given size where none is free."""
    asked = design.free_flywheel
    if asked is None:
        return (design.masses.driven_flywheel_kg_mm2 if design.masses else 0.0,)
    bare = law_design(design, 0.0)
    own = max(mean_inertia_kg_mm2(task_of(bare, inertia_as_given(bare))), LEAST_SHARE * asked.most)
    sizes = np.geomspace(own + asked.least, own + asked.most, SIZES) - own
    # Three digits are enough for a workshop
    middle = [float(f"{size:.3g}") for size in sizes[1:-1]]
    return (asked.least, *middle, asked.most)


def with_best_lengths(loaded: LoadedDesign, tell: Callable[[int], None]) -> tuple[LoadedDesign, Mapping[str, float]]:
    """The design with the best lengths for the flank load with a middle flywheel, and the lengths by their keys.

    ``tell`` takes the number of mechanisms tried so far.  Raises NoSuchMechanism where no lengths in the ranges have a
    law.
    """
    from ncgear.project.free_lengths import best_lengths, changed_keys

    design = loaded.design
    assert design.optimize is not None
    sizes = flywheel_sizes(design)
    sought = law_design(design, sizes[len(sizes) // 2])
    assert sought.optimize is not None
    free = sought.optimize.model_copy(update={"lengths": design.optimize.lengths})
    found = best_lengths(sought.model_copy(update={"optimize": free}), None, tell)
    text = design_copy(loaded, changed_keys(design, found.design))
    return parsed(text, Path("machine.yaml")), found.values


def laws_of(design: Design, job: LawJob) -> list[FoundLaw]:
    """The laws of one flywheel, the law of least power first; empty where none is found."""
    made = law_design(design, job.flywheel_kg_mm2)
    search = _Search(task_of(made, inertia_as_given(made)), law_wishes(made, job.teeth), job)
    return search.laws()


class _Search:
    """The search for the laws of one flywheel."""

    def __init__(self, task: Task, wishes: Wishes, job: LawJob) -> None:
        self.task, self.wishes, self.job = task, wishes, job

    def laws(self) -> list[FoundLaw]:
        """All laws, by their caps."""
        try:
            start = start_motion(self.task, self.wishes)
        except NoSuchMechanism:
            return []
        least = self.least_power(start)
        if least is None:
            return []
        most = self.capped(None, [start, least.motion]) or least
        caps = self.caps_w(least.found.peak_power_w, most.found.peak_power_w)
        under: dict[float, list[FoundLaw]] = {cap: [] for cap in caps}
        for near, way in ((least, caps), (most, caps[::-1])):
            for cap in way:
                near = self.capped(cap, [near.motion]) or near
                under[cap] += [near] if near.found.peak_power_w <= cap * (1.0 + 1e-6) else []
        best = [min(laws, key=lambda law: law.flank_load_n_mm) for laws in under.values() if laws]
        # Keep each law that has less flank load than every law of less power
        found: list[FoundLaw] = []
        for law in sorted((least, *best, most), key=lambda law: (law.found.peak_power_w, law.flank_load_n_mm)):
            if not found or law.flank_load_n_mm < found[-1].flank_load_n_mm:
                found.append(law)
        return found

    def caps_w(self, least_w: float, most_w: float) -> list[float]:
        """The caps of the power: the powers of available motors, or powers in even ratios."""
        if self.job.powers_w:
            return [power for power in sorted(self.job.powers_w) if ABOVE * least_w < power < most_w]
        if not most_w > SAME_POWER * least_w:
            return []
        return [float(power) for power in np.geomspace(ABOVE * least_w, most_w, CAPS + 1)[:-1]]

    def least_power(self, start: Motion) -> FoundLaw | None:
        """The law of least power."""
        return self._found(replace(self.wishes, goal=Goal.POWER), [start])

    def capped(self, cap_w: float | None, starts: list[Motion]) -> FoundLaw | None:
        """The law of least flank load under a cap of the power, the best of the searches from several motions."""
        given = self.wishes.limits.peak_power_w
        cap = min((cap for cap in (cap_w, given) if cap is not None), default=None)
        return self._found(replace(self.wishes, limits=replace(self.wishes.limits, peak_power_w=cap)), starts)

    def _found(self, wishes: Wishes, starts: list[Motion]) -> FoundLaw | None:
        from ncgear.optimum.makeable.law import kept_law

        laws = [law for start in starts if (law := kept_law(self.task, wishes, start)) is not None]
        if not laws:
            return None
        law = min(laws, key=lambda law: law.goal)
        told = figures(self.task, law.train(self.task.lobes))
        return FoundLaw(tuple(law.ratio.tolist()), self.job.flywheel_kg_mm2, told, self.job.teeth)


def settled_law(design: Design, teeth: int | None, near: Motion, cap_w: float | None) -> FoundLaw | None:
    """The law of least flank load for a machine with the gears of the design, searched from a motion near it."""
    flywheel = design.masses.driven_flywheel_kg_mm2 if design.masses else 0.0
    made = law_design(design)
    job = LawJob(flywheel, teeth)
    return _Search(task_of(made, inertia_as_given(made)), law_wishes(made, teeth), job).capped(cap_w, [near])


def law_keys(law: FoundLaw) -> LawKeys:
    """The law as the motion of a design."""
    return found_motion(law.ratio, None)
