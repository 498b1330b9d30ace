"""Certified limits of light machines, and best laws of ratios that pairs share."""

from __future__ import annotations

from math import inf
from pathlib import Path

import numpy as np
import pytest

from ncgear.design.reading.design_file import parsed
from ncgear.errors import WrongInput
from ncgear.optimum.certified.sweeps import Sweeps, SweptLimits, least_flank_load, least_power
from ncgear.optimum.makeable.demanded import demands_of
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.whole_machines.laws import LawJob, law_design, law_wishes, laws_of
from ncgear.whole_machines.limits import without_flywheel

LIGHT = """\
name: light
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 50}
motion: {law: ellipse, eccentricity: 0.3, phase_deg: 180}
gears: {teeth: 36, module_mm: 2, face_width_mm: 16, backlash_mm: 0.09, driving: {bore_mm: 12}, driven: {bore_mm: 12}}
resistance: {polynomial_n: [300, 10]}
masses:
  slider_kg: 3
  rod: {mass_kg: 0.5, center_mm: 60, inertia_kg_mm2: 1500}
  crank: {mass_kg: 0.4, center_mm: 10, inertia_kg_mm2: 1500}
optimize: {goal: least_power, limits: {peak_acceleration_mm_s2: 4000, pressure_angle_deg: 45}}
"""


@pytest.mark.slow
@pytest.mark.judges("optimum")
def test_sweeps_of_a_light_machine_refuse_no_power_of_a_law() -> None:
    """A law of 71.42 W keeps all demands, by its own exact figures: from there on every power is possible."""
    bare = law_design(parsed(LIGHT, Path("light.yaml")).design, 0.0)
    task = task_of(bare, inertia_as_given(bare))
    sweeps = Sweeps(task, demands_of(task, law_wishes(bare, None)))
    flywheel = np.array([[432.0], [466.0]])
    powers = np.linspace(71.43, 100.0, 25)
    assert sweeps.possible(SweptLimits(np.full(25, inf), powers, np.repeat(flywheel, 25, axis=1))).all()
    assert least_power(sweeps, flywheel, np.array([100.0]))[0] < 71.42


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.judges("optimum", "whole_machines")
@pytest.mark.parametrize("masses", [0.05, 5.0])
def test_limits_are_near_laws_however_light_the_machine(masses: float) -> None:
    """No law that is found lies below a limit, neither with a twentieth of the masses nor with five times of them."""
    heavy = LIGHT
    for given in ("slider_kg: 3", "mass_kg: 0.5", "inertia_kg_mm2: 1500", "mass_kg: 0.4"):
        name, value = given.split()
        heavy = heavy.replace(given, f"{name} {float(value) * masses:g}")
    design = parsed(heavy, Path("light.yaml")).design
    laws = [one for one in laws_of(design, LawJob(0.0, None)) if one.found.peak_power_w > 80.0]
    sweeps, nothing = Sweeps(*without_flywheel(design)), np.zeros((2, len(laws)))
    power = np.array([one.found.peak_power_w for one in laws]) * (1.0 + 1e-6)
    load = np.array([one.flank_load_n_mm for one in laws])
    assert load.size >= 3
    share = least_flank_load(sweeps, power, nothing, 1.05 * load) / load
    assert np.all(share > 0.97)
    assert np.all(share <= 1.0)


def test_a_law_that_pairs_share_by_their_number_is_not_optimised() -> None:
    shared = parsed(LIGHT.replace("{teeth: 36", "{pairs: 2, teeth: 36").split("masses:")[0], Path("shared.yaml")).design
    with pytest.raises(WrongInput, match="2 given; a best law is for one pair") as refused:
        task_of(shared, inertia_as_given(shared))
    assert refused.value.key == "gears.pairs"
