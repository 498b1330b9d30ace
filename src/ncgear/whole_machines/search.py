"""The search for whole machines: laws first, then gears of the laws that may count, each rated from its file only.

A few machines that none beats are told, far apart, with the differences between them and the recommended one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from math import ceil, inf, pi, sin
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Choices, Optimize, Process
from ncgear.design.keys.strength import GearMaterial
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.extras import require
from ncgear.frozen import dataclass
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.law_task import refuse_guide_friction
from ncgear.project.sizing import FEWEST_TEETH
from ncgear.shown import Shown
from ncgear.strength.materials import TABLE, Plastic
from ncgear.whole_machines.conflict import refusal_of_gears
from ncgear.whole_machines.gears import GearJob, machine_of
from ncgear.whole_machines.laws import FoundLaw, LawJob, flywheel_sizes, law_design, laws_of, with_best_lengths
from ncgear.whole_machines.limits import MachineLimits, ProvenLimits, WishPrice, wish_prices
from ncgear.whole_machines.machine import MachineFigures, Unfit, WholeMachine, cost_of, guessed_figures, motor_for
from ncgear.workers import finished

Item = TypeVar("Item")

SAME = 1e-3
"""Relative difference of a figure below which machines count as equal."""


def objectives_of(design: Design) -> tuple[str, ...]:
    """The figures that count, by their names in the file."""
    choices = design.choices
    if choices is not None and choices.least is not None:
        return tuple(choices.least)
    free = ("driven_flywheel_kg_mm2",) if design.free_flywheel is not None else ()
    return ("peak_power_w", "gear_volume_mm3", *free)


def undominated(items: Sequence[Item], values: Callable[[Item], Sequence[float]]) -> list[Item]:
    """The items that no other item matches in every figure and beats in one, by SAME of the figure."""
    table = np.array([values(item) for item in items], dtype=float).reshape(len(items), -1)
    kept: list[int] = []
    for row in range(len(items)):
        others = np.delete(table, row, axis=0)
        room = SAME * np.abs(table[row])
        as_good = np.all(others <= table[row] + room, axis=1)
        better = np.any(others < table[row] - room, axis=1)
        twin = any(np.all(np.abs(table[chosen] - table[row]) <= room) for chosen in kept)
        if not np.any(as_good & better) and not twin:
            kept.append(row)
    return [items[row] for row in kept]


def far_apart(items: Sequence[Item], values: Callable[[Item], Sequence[float]], count: int) -> list[Item]:
    """At most ``count`` items: the best in each figure, the item nearest to all, then the farthest from them."""
    if len(items) <= count:
        return list(items)
    table = np.array([values(item) for item in items], dtype=float)
    span = np.ptp(table, axis=0)
    table = (table - table.min(axis=0)) / np.where(span > 0.0, span, 1.0)
    taken = [int(np.argmin(np.linalg.norm(table, axis=1))), *np.argmin(table, axis=0).tolist()]
    taken = list(dict.fromkeys(taken))[:count]
    while len(taken) < count:
        gap = np.min(np.linalg.norm(table[:, None, :] - table[None, taken, :], axis=2), axis=1)
        taken.append(int(np.argmax(gap)))
    return [items[row] for row in sorted(taken)]


def recommended(
    items: Sequence[Item], values: Callable[[Item], Sequence[float]], cost: Callable[[Item], float | None]
) -> int:
    """The index of the cheapest item; without costs, the item with the least product of all figures over zero.

    The product does not depend on the unit of a figure, nor on how bad the worst items are.  A figure does not count
    where it is zero for some item, for example a flywheel that is left out.
    """
    costs = [one for item in items if (one := cost(item)) is not None]
    if len(costs) == len(items):
        return int(np.argmin(costs))
    table = np.array([values(item) for item in items], dtype=float)
    positive = table[:, np.all(table > 0.0, axis=0)]
    return int(np.argmin(np.log(positive).sum(axis=1)))


MORE = 4
"""Number of machines made beyond the wanted number, since some turn out worse than others."""

FINER_LAWS = 1.1
"""The curvature is limited where laws need more teeth against undercut than breakage and pitting ask for, by this
ratio: fewer teeth of a larger module are then stronger."""

Kind = tuple[bool, int]
"""Whether the driving shaft brakes, so that teeth change flanks and knock, and the index of a material."""

BRAKING = 1e-3
"""Share of the peak power below which the driving shaft does not count as braking."""

OnStep = Callable[[str, int, int], None]
"""Called with the name of the current step, the number of finished jobs and the number of all jobs."""


class Candidate(NamedTuple):
    """A law and a material, with a guess of the gears' volume that they need, from the gears of another law, if any."""

    law: FoundLaw
    material: GearMaterial | None
    factor: float
    volume_mm3: float
    near: MachineFigures | None


@dataclass(frozen=True, eq=False)
class WholeMachines(Shown):
    """Machines that no other machine found beats in every figure, in the order of the first such figure.

    ``recommended`` is the index of the recommended machine.  ``laws`` are all laws that were found, ``unfit`` the
    reasons why gears of some of them made no machine.  ``lengths`` are lengths of the mechanism that were free.
    """

    design: Design
    objectives: tuple[str, ...]
    machines: tuple[WholeMachine, ...]
    recommended: int
    laws: tuple[FoundLaw, ...]
    unfit: tuple[Unfit, ...]
    limits: ProvenLimits | None = None
    prices: tuple[WishPrice, ...] = ()
    lengths: Mapping[str, float] = field(default_factory=dict)


def require_offered(design: Design) -> Choices:
    """The choices of a design; raises WrongInput with the key of anything that the search does not offer."""
    require("casadi", "optimize", "ncgear design")
    gears = design.gears
    if gears is None:
        raise WrongInput("missing; give the keys that are not searched: bores, backlash, a first size", key="gears")
    if gears.mesh == "internal":
        raise WrongInput("internal given; the search for whole machines takes external pairs only", key="gears.mesh")
    if design.stages > 1 or (design.optimize or Optimize()).limits.stages > 1:
        key = design.stages_said[1] if design.stages > 1 else "optimize.limits.stages"
        raise WrongInput(
            "several pairs; the search for whole machines takes one pair: `ncgear sweep` tries other sizes of more",
            key=key,
        )
    if gears.helix is not None:
        raise WrongInput("given; the search for whole machines takes straight teeth, leave it out", key="gears.helix")
    if not design.loads_teeth:
        raise WrongInput("missing; the load of the teeth needs it, or masses", key="resistance")
    refuse_guide_friction(design, "the power that is capped")
    return design.choices or Choices()


class MachineSearch:
    """The search for one design file; ``machines`` holds the best found so far at any moment."""

    def __init__(
        self,
        loaded: LoadedDesign,
        on_step: OnStep = lambda what, done, most: None,
        scheduler: str | None = None,
        processes: int | None = None,
    ) -> None:
        self.loaded, self.design = loaded, loaded.design
        self.choices = require_offered(loaded.design)
        self.objectives = objectives_of(loaded.design)
        self._on_step, self.where = on_step, (scheduler, processes)
        self.laws: list[FoundLaw] = []
        self.made: list[WholeMachine] = []
        self.unfit: list[Unfit] = []
        self.near: dict[Kind, MachineFigures] = {}
        self.lengths: Mapping[str, float] = {}
        if not any(self.processes_of(material) for material, _ in self.materials):
            problem = (
                f"{', '.join(self.choices.processes)} given, which makes teeth of no material that may be chosen: "
                "printed teeth are of plastics, and no wire cuts plastics"
            )
            raise WrongInput(problem, key="choices.processes")

    def run(self) -> WholeMachines:
        """The machines; raises NoSuchMechanism, with a remedy, where there is no law, or no gears of any law."""
        if self.design.free_lengths:
            self.loaded, self.lengths = with_best_lengths(self.loaded, lambda tried: self._on_step("lengths", tried, 0))
            self.design = self.loaded.design
        self._find_laws(None)
        if not self.laws:
            self._refuse_laws()
        constants = self._reference()
        # The machine of the reference has been made already
        picked = far_apart(self._candidates(constants), self._guessed, self.choices.machines + MORE)
        jobs = [
            GearJob(candidate.law, candidate.material, self.processes_of(candidate.material), candidate.near)
            for candidate in picked
        ]
        _ = list(self._numbered("machines", jobs))
        if not self.made:
            raise self._refused_gears()
        return self.proven(self.found)

    def proven(self, found: WholeMachines) -> WholeMachines:
        """The machines with their limits, and with the price of each wish for the recommended machine."""
        self._on_step("limits", 0, 1)
        limits = MachineLimits(self.design, found.machines, self.laws, *self.where).found()
        best = found.machines[found.recommended]
        prices = wish_prices(best, partial(self._on_step, "prices of wishes"), *self.where)
        return replace(found, limits=limits, prices=prices)

    @property
    def found(self) -> WholeMachines:
        """The machines found so far; there must be at least one."""
        best = undominated(self.made, self._values)
        best = far_apart(best, self._values, self.choices.machines)
        best = sorted(best, key=lambda machine: (machine.value(self.objectives[0]), *self._values(machine)))
        best = [machine.named(f"{self.design.name[:50]}-{number}") for number, machine in enumerate(best, start=1)]
        place = recommended(best, self._values, lambda machine: machine.cost)
        found = WholeMachines(self.design, self.objectives, tuple(best), place, tuple(self.laws), tuple(self.unfit))
        return replace(found, lengths=self.lengths)

    def _values(self, machine: WholeMachine) -> list[float]:
        return [machine.value(name) for name in self.objectives]

    # Laws

    def _find_laws(self, teeth: int | None) -> None:
        powers = tuple(sorted({motor.power_w for motor in self.choices.motors or ()}))
        jobs = [LawJob(size, teeth, powers) for size in flywheel_sizes(self.design)]
        for _, laws in self._done("laws", partial(laws_of, self.design), jobs):
            self.laws += laws

    def _refuse_laws(self) -> None:
        """Raise the error of ``ncgear optimize`` with a wish that works instead, checked by doing it."""
        from ncgear.project.best_law import BestLaw

        for size in reversed(flywheel_sizes(self.design)):
            _ = BestLaw(law_design(self.design, size)).law
        raise NoSuchMechanism("no law was found that keeps all limits", key="optimize.limits")

    # Gears

    def _reference(self) -> dict[Kind, float]:
        """For each kind of law and material the ratio of gears' volume to flank load, from the gears of one law."""
        materials, jobs = self.materials, dict[Kind, GearJob]()
        for brakes in (False, True):
            laws = sorted((law for law in self.laws if _brakes(law) is brakes), key=lambda law: law.flank_load_n_mm)
            for place, (material, _) in enumerate(materials if laws else ()):
                middle, processes = laws[len(laws) // 2], self.processes_of(material)
                jobs[brakes, place] = GearJob(middle, material, processes)
        constants: dict[Kind, float] = {}
        balanced: list[float] = []
        for number, made in self._numbered("materials", list(jobs.values())):
            if isinstance(made, WholeMachine):
                found = self.near[list(jobs)[number]] = made.figures
                pits = found.contact_share < inf
                spare = found.contact_share**2 if pits else found.bending_share
                constants[list(jobs)[number]] = found.gear_volume_mm3 / spare / found.flank_load_n_mm
                balanced.append(found.teeth * found.bending_share / found.contact_share**2)
        needed = min(map(self.fewest_teeth, self.laws))
        if balanced and needed > FINER_LAWS * max(balanced):
            # The geometric mean of this number and the balanced number
            teeth = max(max(balanced), FEWEST_TEETH)
            self._find_laws(ceil((teeth * needed) ** 0.5))
        usual = max(constants.values(), default=1.0)
        return {kind: constants.get(kind, usual) for kind in jobs}

    def fewest_teeth(self, law: FoundLaw) -> int:
        """The least number of driving teeth without undercut on the pitch curves of a law."""
        gears = self.design.gears
        assert gears is not None
        rack = gears.rack.in_mm(1.0)
        angle = min(rack.angles_rad)
        depth = rack.dedendum_mm - rack.root_radius_mm * (1.0 - sin(angle))
        return ceil(gears.lobes.driving * law.found.curvature_turns * depth / (pi * sin(angle) ** 2))

    @property
    def materials(self) -> list[tuple[GearMaterial | None, float]]:
        """The materials that may be chosen, with their cost factors; None stands for the file's material."""
        if self.choices.materials is None:
            return [(None, 1.0)]
        return [(material.material, material.cost_factor) for material in self.choices.materials]

    def processes_of(self, material: GearMaterial | None) -> tuple[Process, ...]:
        """The ways of making teeth in a material, the cheapest first."""
        gears = self.design.gears
        assert gears is not None
        own = gears.material.each[0] if material is None and gears.material is not None else material
        plastic = own is not None and isinstance(TABLE[own.name], Plastic)
        able = [process for process in self.choices.processes if process != ("wire_cut" if plastic else "printed")]
        if self.choices.cost is not None:
            making = self.choices.cost.making
            able.sort(key=lambda process: float(getattr(making, process)))
        return tuple(able)

    def _refused_gears(self) -> NoSuchMechanism:
        """Why no gears made a machine; tried with the laws of least power, of least flank load and between."""
        laws = sorted(self.laws, key=lambda law: law.found.peak_power_w)
        some = dict.fromkeys((laws[0], laws[-1], laws[len(laws) // 2]))
        material, _ = self.materials[0]
        jobs = [GearJob(law, material, self.processes_of(material)) for law in some]
        gears = self.design.gears
        own = gears.material.each[0].name if gears is not None and gears.material else ""
        name = material.name if material else own
        return refusal_of_gears(self.loaded.text, self.choices, name, jobs, self.unfit, *self.where)

    def _candidates(self, constants: dict[Kind, float]) -> list[Candidate]:
        """Laws with materials that may count: no other one is guessed to be better in every figure."""
        materials = self.materials
        every = [
            Candidate(law, *materials[place], constant * law.flank_load_n_mm, self.near.get((brakes, place)))
            for law in self.laws
            for (brakes, place), constant in constants.items()
            if brakes is _brakes(law)
        ]
        return undominated(every, self._guessed)

    def _guessed(self, candidate: Candidate) -> list[float]:
        law = candidate.law.found
        known = {
            "peak_power_w": law.peak_power_w,
            "gear_volume_mm3": candidate.volume_mm3,
            "driven_flywheel_kg_mm2": candidate.law.flywheel_kg_mm2,
            "center_distance_mm": candidate.volume_mm3 ** (1.0 / 3.0),
            "cost": self._guessed_cost(candidate),
        }
        own = [known[name] for name in self.objectives]
        has_cost = self.choices.cost is not None or any(motor.cost for motor in self.choices.motors or ())
        return own if "cost" in self.objectives or not has_cost else [*own, known["cost"]]

    def _guessed_cost(self, candidate: Candidate) -> float:
        law = candidate.law
        guess = guessed_figures(
            law.found, law.flywheel_kg_mm2, candidate.volume_mm3 * candidate.factor, self.speed_rad_s
        )
        process = next(iter(self.processes_of(candidate.material)), self.choices.processes[0])
        return cost_of(self.choices, guess, motor_for(self.choices, guess), "", process) or 0.0

    @property
    def speed_rad_s(self) -> float:
        """The speed of the driving shaft."""
        return self.design.operation.speed_rpm * RAD_S_PER_RPM

    def _numbered(self, what: str, jobs: Sequence[GearJob]) -> Iterator[tuple[int, WholeMachine | Unfit]]:
        """The machines of jobs with the numbers of the jobs, as they are finished; the machines are kept."""
        for number, made in self._done(what, partial(_numbered_machine, self.loaded.text, jobs), range(len(jobs))):
            if isinstance(made, WholeMachine):
                self.made.append(made)
            else:
                self.unfit.append(made)
            yield number, made

    def _done(self, what: str, function: Callable[[Any], Any], jobs: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
        """Jobs and the results of a function for them, as they are finished; each step is reported."""
        self._on_step(what, 0, len(jobs))
        for done, pair in enumerate(finished(function, list(jobs), *self.where), start=1):
            self._on_step(what, done, len(jobs))
            yield pair


def _brakes(law: FoundLaw) -> bool:
    return (law.found.braking_power_w or 0.0) > BRAKING * law.found.peak_power_w


def _numbered_machine(text: str, jobs: Sequence[GearJob], number: int) -> WholeMachine | Unfit:
    return machine_of(text, jobs[number])
