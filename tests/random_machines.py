"""Machines at random, each with what is asked of its best law: linkage, force, speed, masses, goal and limits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from math import pi, radians

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.mechanisms.crank_rocker import CrankRocker
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.mechanisms.slotted_lever import SlottedLever
from ncgear.optimum.certified.limit import least_power
from ncgear.optimum.makeable.demanded import demands_of
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Figures, Limits, Task, figures
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, single

RPM = pi / 30.0
CRANK_SLIDERS = 200
"""Seeds below this are crank-sliders, the others Scotch yokes, crank-rockers and slotted levers."""

FORCES = ("constant", "spring", "hump", "table", "step", "both strokes")


@dataclass(frozen=True)
class RandomMachine:
    """A machine, what is asked of its law, and what a crank that turns evenly has."""

    task: Task
    wishes: Wishes
    uniform: Figures

    @property
    def uniform_keeps_the_limits(self) -> bool:
        """Whether the crank that turns evenly is comparable."""
        caps = {name: cap for name, cap in vars(self.wishes.limits).items() if name.startswith("peak_") and cap}
        return all(getattr(self.uniform, name) <= cap for name, cap in caps.items())


@cache
def random_machine(seed: int) -> RandomMachine:
    """The machine of a seed."""
    random = np.random.default_rng([2026, seed])
    linkage = _crank_slider(random) if seed < CRANK_SLIDERS else _other(random, seed % 3)
    lobes = Lobes(2) if random.random() < 0.15 else Lobes()
    load = _load(random, float(linkage.stroke_mm))
    task = Task(linkage, load, float(10.0 ** random.uniform(1.0, 2.6)) * RPM / lobes.driving, lobes)
    uniform = figures(task, single(uniform_law(lobes)))
    if random.random() < 0.3 and isinstance(linkage, CrankSlider):
        task = replace(task, masses=_masses(random, task, uniform))
        uniform = figures(task, single(uniform_law(lobes)))
    wishes = Wishes(_shape_limits(random, lobes), convex=bool(random.random() < 0.8), knots=96)
    return RandomMachine(task, _capped(random, task, wishes, uniform), uniform)


def _crank_slider(random: np.random.Generator) -> CrankSlider:
    crank = float(10.0 ** random.uniform(0.7, 2.8))
    rod = crank * float(2.0 * 4.0 ** random.random())
    offset = (rod - crank) * float(random.uniform(-0.6, 0.6)) if random.random() < 0.6 else 0.0
    return CrankSlider(crank, rod, offset)


def _other(random: np.random.Generator, kind: int) -> Mechanism:
    """A mechanism with dead centres, well inside of what can turn."""
    crank = float(10.0 ** random.uniform(0.7, 2.8))
    if kind == 0:
        return ScotchYoke(crank)
    if kind == 1:
        pivot = crank * float(random.uniform(1.5, 4.0))
        return SlottedLever(crank, pivot, (pivot + crank) * float(random.uniform(1.05, 1.5)))
    ground, rocker = (crank * float(random.uniform(2.0, 5.0)) for _ in range(2))
    low, high = abs(ground - rocker) + crank, ground + rocker - crank
    coupler = low + (high - low) * float(random.uniform(0.2, 0.8))
    return CrankRocker(crank, coupler, rocker, ground, 1 if random.random() < 0.5 else -1)


def _resistance(random: np.random.Generator, kind: str, stroke: float) -> Resistance:
    """Forces of the order of 1000 N over the stroke."""
    size = float(10.0 ** random.uniform(2.0, 4.0))
    match kind:
        case "spring":
            return PolynomialResistance((0.1 * size, size / stroke))
        case "hump":
            at, width = float(random.uniform(0.2, 0.9)) * stroke, float(random.uniform(0.05, 0.4)) * stroke
            return FormulaResistance(f"{0.2 * size!r} + {size!r}*exp(-((x - {at!r})/{width!r})**2)")
        case "table":
            places = np.sort(random.uniform(0.05, 0.95, 3)) * stroke
            forces = size * random.uniform(0.0, 1.0, 5)
            return TableResistance((0.0, *places.tolist(), 1.01 * stroke), tuple(forces.tolist()))
        case "step":
            at = float(random.uniform(0.2, 0.8)) * stroke
            places = (0.0, at, at + 0.02 * stroke, 1.01 * stroke)
            return TableResistance(places, (0.1 * size, 0.1 * size, size, size))
    return PolynomialResistance((size,))


def _load(random: np.random.Generator, stroke: float) -> SliderLoad:
    kind = FORCES[int(random.integers(len(FORCES)))]
    if kind != "both strokes":
        return SliderLoad(_resistance(random, kind, stroke))
    out, back = (_resistance(random, FORCES[int(random.integers(5))], stroke) for _ in range(2))
    return SliderLoad(out, back, friction_n=float(random.uniform(0.0, 200.0)))


def _masses(random: np.random.Generator, task: Task, uniform: Figures) -> RodMasses:
    """What moves takes from a twentieth of the load's power to all of it."""
    as_heavy = 1e6 * uniform.peak_power_w / (uniform.peak_acceleration_mm_s2 * uniform.peak_speed_mm_s)
    slider = as_heavy * float(random.uniform(0.05, 1.0))
    assert isinstance(task.linkage, CrankSlider)
    return RodMasses(
        slider_kg=slider,
        rod_kg=0.3 * slider,
        rod_center_mm=task.linkage.rod_mm / 2.0,
        rod_inertia_kg_mm2=0.025 * slider * task.linkage.rod_mm**2,
        driven_inertia_kg_mm2=slider * task.linkage.crank_mm**2 * float(random.uniform(0.0, 1.0)),
    )


def _shape_limits(random: np.random.Generator, lobes: Lobes) -> Limits:
    widest = float(random.choice([5.0, 5.0, 3.0, 2.0]))
    angle = radians(float(random.uniform(20.0, 45.0))) if random.random() < 0.25 else None
    return Limits(1.0 / widest / lobes.driving, widest / lobes.driving, pressure_angle_rad=angle)


def _capped(random: np.random.Generator, task: Task, wishes: Wishes, uniform: Figures) -> Wishes:
    """A goal, and a cap of the other peak: from under the least to well over that of the even crank."""
    share = float(random.uniform(-0.1, 1.3))
    if random.random() < 0.3:
        cap = uniform.peak_acceleration_mm_s2 * (0.7 + 1.5 * share)
        return replace(wishes, goal=Goal.POWER, limits=replace(wishes.limits, peak_acceleration_mm_s2=cap))
    least = 0.5 * uniform.peak_power_w
    if task.masses is None:
        try:
            least = least_power(task, demands_of(task, wishes), proven=False).value
        except NoSuchMechanism as refused:
            raise AssertionError(f"the crank that turns evenly keeps these demands: {refused}") from refused
    cap = least + share * (uniform.peak_power_w - least)
    return replace(wishes, limits=replace(wishes.limits, peak_power_w=cap))
