"""Designs at random whose gears are heavy and fast: wide, dense, of large modules; and laws within their limits."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np

from kept_laws import kept
from ncgear.errors import DesignError
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Figures, Task, figures
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, PairsInSeries, single

GOALS = ("least_power", "least_power", "least_braking_power", "least_acceleration", "least_rms_torque")
KNOTS = 60

KEPT = (
    "designs/baler-66",
    "designs/baler-half",
    "designs/pusher",
    "designs/pump-both-ways",
    "benchmarks/foreign/long-rod",
)
"""Laws of one pair that are tried on other machines."""


def heavy(seed: int, stages: int = 1, convex: bool = True) -> str:
    """A design file: what moves the gears takes from a tenth of the load's power to several times of it."""
    random = np.random.default_rng([35, seed])
    crank = float(random.uniform(15.0, 60.0))
    rod, offset = crank * float(random.uniform(2.5, 5.0)), crank * float(random.choice([0.0, 0.3]))
    module = float(random.choice([1.5, 2.0, 3.0]))
    teeth, width = int(random.integers(36, 60)), float(random.uniform(10.0, 80.0))
    density = float(random.choice([2700.0, 7850.0, 19000.0]))
    force = float(random.uniform(200.0, 3000.0))
    # At this speed the driven gear's energy is of the order of the work of a stroke
    inertia = density * 1e-9 * width * pi / 2.0 * (module * teeth / 2.0) ** 4
    even = np.sqrt(1e3 * force * 2.0 * crank / inertia)
    rpm = float(even * random.uniform(0.15, 1.0)) * 30.0 / pi
    slider = float(random.uniform(0.1, 1.0)) * inertia / crank**2
    goal = GOALS[seed % len(GOALS)]
    force *= 0.2 if goal == "least_braking_power" else 1.0
    # Nearly even laws must brake; others need not, and so there is no limit to judge
    widest = float(random.choice([1.25, 1.5, 2.5])) if goal != "least_braking_power" else 1.03
    limits = f"stages: {stages}, ratio_min: {1.0 / widest!r}, ratio_max: {widest}, pressure_angle_deg: 55"
    limits += "" if convex else ", convex: false"
    if goal == "least_acceleration":
        # Less than most laws take: the load on an even crank, and a share of what moves the slider
        turning = rpm * pi / 30.0
        limits += f", peak_power_w: {0.85e-3 * (force * crank + 1e-3 * slider * (crank * turning) ** 2) * turning!r}"
    return f"""\
name: heavy
linkage: {{crank_mm: {crank!r}, rod_mm: {rod!r}, offset_mm: {offset!r}}}
operation: {{speed_rpm: {rpm!r}}}
motion: {{law: harmonic_ratio, cosine: [0.05], sine: [0.1]}}
gears:
  {{teeth: {teeth}, module_mm: {module}, face_width_mm: {width!r}, driving: {{bore_mm: 10}}, driven: {{bore_mm: 10}}}}
resistance: {{polynomial_n: [{force!r}], returning: {{polynomial_n: [{0.3 * force!r}]}}}}
masses:
  slider_kg: {slider!r}
  rod: {{mass_kg: {0.3 * slider!r}, center_mm: {0.4 * rod!r}, inertia_kg_mm2: {0.02 * slider * rod**2!r}}}
  crank: {{mass_kg: {0.2 * slider!r}, center_mm: {0.3 * crank!r}, inertia_kg_mm2: {0.1 * slider * crank**2!r}}}
  density_kg_m3: {density}
optimize: {{goal: {goal}, knots: {KNOTS}, limits: {{{limits}}}}}
"""


def keeps(wishes: Wishes, found: Figures) -> bool:
    """Whether a law is within all that its wishes limit and a limit knows."""
    limits = wishes.limits
    caps = {name: cap for name, cap in vars(limits).items() if cap and name in vars(found) and name[:5] != "ratio"}
    return (
        limits.ratio_min <= found.ratio_min
        and found.ratio_max <= limits.ratio_max
        and np.tan(found.tangent_rad) <= limits.steepness
        and (found.convex or not wishes.convex)
        and all(getattr(found, name) <= cap for name, cap in caps.items())
    )


def laws_beside(task: Task, wishes: Wishes, seed: int, count: int) -> Iterator[tuple[str, Figures]]:
    """Laws of one pair within the limits, and their figures on a machine: the even one, kept ones, and random ones."""
    trains: list[tuple[str, PairsInSeries]] = [("even", single(uniform_law(Lobes())))]
    for name in KEPT:
        trains.append((name, kept(name).train))
    random = np.random.default_rng(seed)
    for number in range(count):
        # Around laws that turn the crank against what the slider feels, half of them of one harmonic
        size = random.uniform(0.02, 0.3) / np.arange(1, 1 + random.integers(1, 4)) ** 2.0
        cosine, sine = (size * random.uniform(-1.0, 1.0, size.size) for _ in range(2))
        trains.append((f"random {number}", single(harmonic_law(cosine, sine, Lobes()))))
    for name, train in trains:
        try:
            found = figures(task, train)
        except DesignError:
            continue
        if keeps(wishes, found):
            yield name, found
