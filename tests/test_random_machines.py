"""Machines at random: a law or a refusal that names why, limit <= law, and law <= the crank as it is.

Two hundred are crank-sliders, sixty Scotch yokes, crank-rockers and slotted levers.
"""

from __future__ import annotations

import re

import pytest

from ncgear.errors import NoSuchMechanism
from ncgear.optimum.certified.limit import least_acceleration_roughly, least_of, least_power, problem_of
from ncgear.optimum.makeable.demanded import certified_limit, demands_of, start_motion
from ncgear.optimum.makeable.law import makeable_law
from ncgear.optimum.makeable.wishes import Goal
from ncgear.optimum.task import Figures, figures
from random_machines import CRANK_SLIDERS, RandomMachine, random_machine

ROUNDING = 1.0 + 1e-7
QUICK, WHOLE, OTHERS = range(3), range(3, 23), range(23, CRANK_SLIDERS)
FEW_KINDS, WHOLE_KINDS = range(CRANK_SLIDERS, CRANK_SLIDERS + 3), range(CRANK_SLIDERS + 3, CRANK_SLIDERS + 9)
MORE_KINDS = range(CRANK_SLIDERS + 9, CRANK_SLIDERS + 60)

COARSE = 60
"""Places of a quick limit of power with masses."""


def law_of(machine: RandomMachine) -> Figures | None:
    """Exact figures of the best law; None where it is refused with a limit's key and a value that is enough."""
    task, wishes = machine.task, machine.wishes
    try:
        found = makeable_law(task, wishes, start_motion(task, wishes))
    except NoSuchMechanism as refused:
        assert not machine.uniform_keeps_the_limits, refused
        assert refused.key.startswith("optimize.limits."), refused
        assert re.search(r"(at least|at most|a peak power of|a peak acceleration of|ratio of) [\d.]", refused.problem)
        return None
    return figures(task, found.train(task.lobes))


def quick_limit(machine: RandomMachine) -> float:
    """A limit of the goal for a tenth of the time, which is lower than the certified one or equal."""
    task, asked = machine.task, demands_of(machine.task, machine.wishes)
    if machine.wishes.goal is Goal.ACCELERATION:
        return least_acceleration_roughly(problem_of(task, asked))
    if task.masses is None:
        return least_power(task, asked, proven=False).value
    return least_of(task, asked, "power_w", COARSE).value


def whole_limit(machine: RandomMachine) -> float:
    bound = certified_limit(machine.task, machine.wishes)
    assert bound is not None
    return bound.value


def judge(seed: int, *, whole: bool) -> None:
    machine = random_machine(seed)
    wishes, found = machine.wishes, law_of(machine)
    if found is None:
        return
    limits = wishes.limits
    assert found.peak_power_w <= (limits.peak_power_w or found.peak_power_w) * ROUNDING
    assert found.peak_acceleration_mm_s2 <= (limits.peak_acceleration_mm_s2 or found.peak_acceleration_mm_s2) * ROUNDING
    assert limits.ratio_min <= found.ratio_min * ROUNDING
    assert found.ratio_max <= limits.ratio_max * ROUNDING
    assert found.tangent_rad <= (limits.pressure_angle_rad or found.tangent_rad) * ROUNDING
    assert found.convex or not wishes.convex
    value = wishes.prices.of(found)
    least = quick_limit(machine)
    assert least <= value * ROUNDING
    if whole:
        certified = whole_limit(machine)
        assert least * (1.0 - 1e-3) <= certified <= value * ROUNDING
    if machine.uniform_keeps_the_limits:
        assert value <= wishes.prices.of(machine.uniform) * ROUNDING


@pytest.mark.judges("optimum")
@pytest.mark.slow
@pytest.mark.parametrize("seed", QUICK)
def test_a_few_machines(seed: int) -> None:
    judge(seed, whole=False)


@pytest.mark.tiers(slow=["200", "202"], rest="long")
@pytest.mark.parametrize("seed", FEW_KINDS)
def test_a_machine_of_each_other_mechanism(seed: int) -> None:
    judge(seed, whole=False)


@pytest.mark.tiers(slow=["15"], rest="long")
@pytest.mark.parametrize("seed", [*WHOLE, *WHOLE_KINDS])
def test_some_machines_with_their_certified_limit(seed: int) -> None:
    judge(seed, whole=True)


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("seed", [*OTHERS, *MORE_KINDS])
def test_all_other_machines(seed: int) -> None:
    judge(seed, whole=False)
