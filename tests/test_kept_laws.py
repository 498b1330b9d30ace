"""No limit of any kind is above a law that exists, whatever the law; and limits of less than the best laws have are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

import pytest

from kept_laws import FILES, KeptLaw, kept
from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import (
    least_acceleration,
    least_acceleration_roughly,
    least_of,
    least_power,
    problem_of,
)
from ncgear.optimum.certified.sums import PeakWeights, least_weighted_sum, raised
from ncgear.optimum.certified.tree import Budget
from ncgear.optimum.task import Figures, Task, figures
from tiers import long_but

Limit = Callable[[Task, Demands], float]


def shaped(asked: Demands) -> Demands:
    """Peaks, ratios, pressure angle and convexity: what a design asks without wishes of its motion."""
    return replace(asked, wishes=())


def loose(asked: Demands) -> Demands:
    """Peaks and convexity alone: the widest ranges of the driving curve's rates."""
    ratios = {"ratio_min": 0.5 * asked.ratio_min, "ratio_max": 2.0 * asked.ratio_max}
    return replace(shaped(asked), **ratios, steepness=inf)


def dented(asked: Demands) -> Demands:
    """No demand of convexity."""
    return replace(shaped(asked), convex=False)


def acceleration(task: Task, asked: Demands) -> float:
    return least_acceleration(task, asked).value


def power(task: Task, asked: Demands) -> float:
    return least_power(task, asked).value


def least_sum(task: Task, asked: Demands) -> float:
    """Both peaks in shares of the law's own."""
    return least_weighted_sum(task, asked, PeakWeights(1.0 / asked.acceleration_mm_s2, 1.0 / asked.power_w)).value


ASKED: dict[str, Callable[[Demands], Demands]] = {
    "all": lambda asked: asked,
    "shape": shaped,
    "loose": loose,
    "dents": dented,
}
"""What of a law's own figures is asked."""

OF_MOTION: dict[str, tuple[Limit, Callable[[Figures], float | None]]] = {
    "acceleration": (acceleration, lambda found: found.peak_acceleration_mm_s2),
    "roughly": (
        lambda task, asked: least_acceleration_roughly(problem_of(task, asked)),
        lambda found: found.peak_acceleration_mm_s2,
    ),
    "power": (power, lambda found: found.peak_power_w),
    "sum": (least_sum, lambda found: 2.0),
}
"""Limits of a motion, with masses or without, and the law's own figure."""

OF_LOADS: dict[str, tuple[Limit, Callable[[Figures], float | None]]] = {
    "acceleration": OF_MOTION["acceleration"],
    "power": OF_MOTION["power"],
    "braking": (lambda task, asked: least_of(task, asked, "braking_w").value, lambda found: found.braking_power_w),
    "torque": (
        lambda task, asked: least_of(task, asked, "torque_n_mm").value / 1000.0,
        lambda found: found.rms_torque_n_m,
    ),
    "flywheel": (
        lambda task, asked: (
            least_of(task, asked, "fluctuation_n_mm").value * 1000.0 / (task.speed_rad_s**2 * task.speed_fluctuation)
        ),
        lambda found: found.flywheel_kg_mm2,
    ),
}
"""Limits of a machine with masses, and the law's own figure."""


def above(law: KeptLaw, kind: str, asked: Demands) -> float:
    """By what share of the law's figure a limit is above it."""
    limit, own = (OF_MOTION if law.task.masses is None else OF_LOADS)[kind]
    figure = own(law.figures)
    assert figure is not None
    return limit(law.task, asked) / max(figure, 1e-9) - 1.0


NO_LAW = {
    "designs/asymmetric-ellipse",
    "designs/desk-toy",
    "designs/fish",
    "designs/heart",
    "designs/idler-chain",
    "designs/internal-1-2",
    "designs/lobed-motor",
    "designs/log-generator",
    "designs/logo",
    "designs/moving-axis",
    "designs/offset-ellipse",
    "designs/oval-flow-meter",
    "designs/pump-1-2",
    "designs/rack-feed",
    "designs/rounded-square",
    "designs/spiral-pair",
    "designs/traced-egg",
    "designs/transplanter",
    "tests/cases/a1-too-large",
    "tests/cases/a1-vanishing",
    "tests/cases/lobes-1-2",
    "tests/cases/lobes-2-3",
    "tests/cases/pole",
    "tests/cases/pole-changing-sign",
    "tests/cases/ratio-through-zero",
    "tests/cases/stroke-off-by-1e-3",
    "tests/cases/table-coarse-noise",
    "tests/cases/table-two-points",
    "tests/cases/theta1-vanishing",
    "tests/cases/v2-vanishing",
}
"""Files without a law, or without a cycle of a slider: gears by themselves or over a range, several driven lobes,
trains."""

LAWS = [name for name in FILES if name not in NO_LAW]
NEAR = [name for name in LAWS if not name.startswith("tests/")]
"""Laws of designs: the others are judged by the long tests."""

OF_ALL = [
    *(("acceleration", which) for which in ASKED),
    *(("power", which) for which in ("all", "shape", "dents")),
    ("roughly", "shape"),
    ("sum", "shape"),
]
WITH_MASSES = [
    ("acceleration", "all"),
    ("power", "shape"),
    *((kind, "all") for kind in ("braking", "torque", "flywheel")),
]


def over(law: KeptLaw, kinds: list[tuple[str, str]]) -> dict[tuple[str, str], float]:
    """The limits that are above the law, by what share of its figure.

    A refusal fails, since the law keeps what is asked.
    """
    asked = law.demands()
    found = {(kind, which): above(law, kind, ASKED[which](asked)) for kind, which in kinds}
    return {kind: share for kind, share in found.items() if share > EXACT}


EXACT = 1e-9
"""Figures are exact but for rounding."""


@pytest.mark.tiers(thorough=["designs/fish", "designs/rack-feed", "tests/cases/a1-*"], rest="slow")
@pytest.mark.parametrize("name", sorted(NO_LAW))
def test_files_without_a_law_are_refused(name: str) -> None:
    with pytest.raises(DesignError):
        kept(name)


@pytest.mark.tiers(slow=["tests/laws/baler-9375-w-30-deg"], rest="long")
@pytest.mark.parametrize("name", LAWS)
def test_no_quick_limit_is_above_a_law(name: str) -> None:
    assert over(kept(name).without_masses(), [("roughly", "all"), ("power", "dents")]) == {}


AT_ONCE = [f"designs/{name}" for name in ("baler-66", "baler-half", "baler-smooth", "baler", "pusher", "press")]


@pytest.mark.tiers(slow=["designs/pusher"], rest="long")
@pytest.mark.parametrize(
    "name", long_but([*AT_ONCE, *(name for name in LAWS if "foreign" in name and "blanking" not in name)], LAWS)
)
def test_no_limit_is_above_a_law(name: str) -> None:
    law = kept(name).without_masses()
    assert over(law, [kind for kind in OF_ALL if kind[0] != "sum" or law.figures.peak_power_w > 0.0]) == {}


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("name", [*NEAR, *(name for name in LAWS if "baler-masses" in name)])
def test_no_limit_of_a_machine_with_masses_is_above_a_law(name: str) -> None:
    assert over(kept(name).with_masses(), WITH_MASSES) == {}


RAISED = ({"acceleration_mm_s2": 1.0}, {"power_w": 1.0}, {"power_w": 1.0, "braking_w": 1.0}, {"torque_n_mm": 1.0})


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("prices", RAISED, ids=" and ".join)
@pytest.mark.parametrize(
    "name",
    [
        "designs/pump-both-ways",
        pytest.param("designs/baler-real", marks=pytest.mark.long),
        pytest.param("designs/feeder-kept", marks=pytest.mark.long),
    ],
)
def test_no_limit_is_raised_above_a_law(name: str, prices: dict[str, float]) -> None:
    """Towards a sum a fifth above the law's own, of which this limit must not know."""
    law = kept(name).with_masses()
    asked = law.demands()
    own = sum(price * getattr(asked, figure) for figure, price in prices.items())
    free = replace(asked, **dict.fromkeys(prices, inf))
    wanted = {figure: 1.2 * getattr(asked, figure) for figure in prices}
    assert raised(law.task, free, prices, wanted, law.motion, Budget(300))[0] <= own


@pytest.mark.long
@pytest.mark.slow
def test_a_limit_raised_for_less_than_the_law_feels_is_above_it() -> None:
    """Negative control: friction that the law does not have, 4 % of the force."""
    law = kept("designs/pump-both-ways")
    rubbing = replace(law.task, load=replace(law.task.load, friction_n=law.task.load.friction_n + 20.0))
    own, felt = law.demands(), {"power_w": figures(rubbing, law.train).peak_power_w}
    asked = Demands(own.ratio_min, own.ratio_max, convex=True, acceleration_mm_s2=own.acceleration_mm_s2)
    assert raised(law.task, asked, {"power_w": 1.0}, felt, law.motion, Budget(300))[0] <= own.power_w
    assert raised(rubbing, asked, {"power_w": 1.0}, felt, law.motion, Budget(300))[0] > own.power_w


def tighter(asked: Demands) -> Demands:
    """Both peaks and the pressure angle tighter by a fiftieth."""
    less = {name: 0.98 * getattr(asked, name) for name in ("acceleration_mm_s2", "power_w", "steepness")}
    return replace(asked, **less)


BEST = {
    "designs/baler-66": "acceleration",
    "designs/baler-half": "acceleration",
    "designs/baler-smooth": "acceleration",
    "benchmarks/foreign/short-rod": "acceleration",
    "benchmarks/foreign/long-rod": "acceleration",
    "benchmarks/foreign/blanking": "acceleration",
    "benchmarks/foreign/both-strokes": "acceleration",
    "benchmarks/foreign/stiff-spring": "power",
    "benchmarks/foreign/slow-press": "power",
}


@pytest.mark.tiers(slow=["benchmarks/foreign/long-rod"], rest="long")
@pytest.mark.parametrize("name", BEST)
def test_what_is_a_fiftieth_tighter_than_a_best_law_is_beyond_it(name: str) -> None:
    """Negative control: the limit is above the law, or nothing keeps these demands at all."""
    law = kept(name).without_masses()
    try:
        assert above(law, BEST[name], tighter(shaped(law.demands()))) > 1e-3
    except NoSuchMechanism as refused:
        assert "too little" in refused.problem or "too much" in refused.problem
