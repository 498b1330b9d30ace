"""What machines cost, how far they are from limits, what is told of them: figures by hand, sums beside brute force."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import ceil, inf, log, pi, radians, sin
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from drives import DESIGNS, loaded
from ncgear.design.keys.optimize import Choices
from ncgear.design.reading.design_file import LoadedDesign, parsed
from ncgear.design.rewritten import rewritten
from ncgear.figures.advice.values import Advice, Kind, Remedy, RemedySearch
from ncgear.figures.advice.verdict import State
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import Bound, Motion
from ncgear.optimum.certified.sweeps import Sweeps
from ncgear.optimum.certified.tree import Budget
from ncgear.optimum.task import Figures, figures
from ncgear.project.drive import Drive
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.project.sizing import Sized
from ncgear.project.strengthening import rating_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import single
from ncgear.whole_machines import conflict, gears, limits
from ncgear.whole_machines import machine as machine_room
from ncgear.whole_machines.laws import (
    CAPS,
    FoundLaw,
    LawJob,
    _Search,
    flywheel_sizes,
    law_design,
    law_wishes,
)
from ncgear.whole_machines.machine import (
    KEPT,
    MachineFigures,
    Unfit,
    WholeMachine,
    cost_of,
    guessed_figures,
    limits_missed,
    motor_for,
)
from ncgear.whole_machines.search import Candidate, MachineSearch, far_apart, undominated
from ncgear.whole_machines.told import difference_words, machines_answer, machines_figures

pytestmark = pytest.mark.judges("whole_machines")

PUSHER = (DESIGNS / "pusher.yaml").read_text(encoding="utf-8")
WITH_FLYWHEEL = """
masses:
  slider_kg: 2.0
  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 300.0}
  driving_gear_kg_mm2: 100.0
  driven_gear_kg_mm2: 200.0
  driven_flywheel_kg_mm2: 1000.0
optimize: {goal: least_power, driven_flywheel_kg_mm2: {least: 1000.0, most: 9000.0}}
"""
SPEED = 30.0 * pi / 30.0
MEAN = Figures(20.0, 700.0, 190.0, 0.8, 1.25, 3.0, 0.2, True, 7.0, flank_load_n_mm=5000.0)
HAS = MachineFigures(
    **dict.fromkeys(MachineFigures.__dataclass_fields__, 1.0)
    | {"peak_power_w": 20.0, "peak_torque_n_m": 20.0 / SPEED, "gear_volume_mm3": 2e6, "flank_load_n_mm": 5000.0}
    | {"contact_share": 1.25, "bending_share": 1.5, "teeth": 40, "driven_flywheel_kg_mm2": 3e6}
)
SIZED: Any = SimpleNamespace(drive=None, teeth=40)
CHOICES = Choices.model_validate(
    {
        "cost": {
            "motor_per_w": 2.0,
            "motor_per_n_m": 3.0,
            "gears_per_dm3": 10.0,
            "driven_flywheel_per_kg_m2": 7.0,
            "making": {"hobbed": 11.0, "shaped": 5.0},
        },
        "materials": [{"material": "C45", "cost_factor": 1.5}, {"material": "42CrMo4", "cost_factor": 2.0}],
        "processes": ["hobbed", "shaped"],
    }
)


def read(more: str = "") -> LoadedDesign:
    return parsed(PUSHER + more, Path("machine.yaml"))


def machine(text: str = PUSHER, cost: float | None = None, **has: Any) -> WholeMachine:
    return WholeMachine("pusher", text, replace(HAS, **has), "C45", "hobbed", "a hob cuts", None, cost)


def found_law(flank_load: float, **has: Any) -> FoundLaw:
    return FoundLaw((1.0,) * 8, 0.0, replace(MEAN, flank_load_n_mm=flank_load, **has))


def test_the_cost_is_the_sum_of_figures_times_prices() -> None:
    """20 W, 20/w N m, 2 dm3 of steel that costs twice as much, 3 kg m2, hobbing and the motor."""
    motor = Choices.model_validate({"motors": [{"name": "m", "power_w": 30.0, "cost": 13.0}]}).motors
    assert motor
    cost = 2.0 * 20.0 + 3.0 * 20.0 / SPEED + 10.0 * 2.0 * 2.0 + 7.0 * 3.0 + 11.0 + 13.0
    assert cost_of(CHOICES, HAS, motor[0], "42CrMo4", "hobbed") == pytest.approx(cost, rel=1e-12)
    assert cost_of(Choices(), HAS, None, "42CrMo4", "hobbed") is None


def test_the_cheapest_motor_that_does() -> None:
    """By its power and its torque, and of two of one cost the weaker."""
    sizes = [(19.0, 99.0, 1.0), (20.0, 6.0, 2.0), (50.0, 99.0, 4.0), (30.0, 99.0, 4.0), (60.0, None, 9.0)]
    rows = [
        {"name": str(row), "power_w": power, "cost": cost, **({} if torque is None else {"torque_n_m": torque})}
        for row, (power, torque, cost) in enumerate(sizes)
    ]
    chosen = motor_for(Choices.model_validate({"motors": rows}), HAS)
    assert chosen is not None
    assert chosen.name == "3"
    assert motor_for(Choices.model_validate({"motors": rows[:2]}), HAS) is None


@pytest.mark.parametrize(
    ("has", "cut", "motors", "said"),
    [
        ({"flank_share": 1.1}, "a hob cuts", [], None),
        ({"flank_share": 0.99}, "a hob cuts", [], "the teeth do not hold"),
        ({"bending_share": 0.99, "flank_share": 2.0}, "a hob cuts", [], "the teeth do not hold"),
        ({"flank_share": 1.1}, None, [], "gears of this kind cannot be hobbed (concave)"),
        ({"flank_share": 1.1}, "a hob cuts", [19.0], "no motor that can be had gives 20 W"),
        ({"flank_share": 1.1}, "a hob cuts", [21.0], None),
    ],
)
def test_a_machine_holds_is_cut_and_has_a_motor(
    monkeypatch: pytest.MonkeyPatch, has: dict[str, float], cut: str | None, motors: list[float], said: str | None
) -> None:
    """With a verdict that breaks nothing; what does not hold is told with the width that would do."""
    monkeypatch.setattr(machine_room, "judged", lambda drive, known, seconds: SimpleNamespace(rows=()))
    monkeypatch.setattr(machine_room, "machine_and_law_figures", lambda drive: (replace(HAS, **has), MEAN))
    monkeypatch.setattr(machine_room, "cut_words", lambda drive, process: (cut is not None, cut or "concave"))
    monkeypatch.setattr(machine_room, "_wider", lambda drive: 1.3)
    rows = [{"name": "m", "power_w": power, "cost": 2.0} for power in motors]
    choices = Choices.model_validate({"motors": rows}) if rows else Choices()
    found = machine_room.judged_machine(PUSHER, "hobbed", choices)
    if said is None:
        assert isinstance(found, WholeMachine)
        assert (found.material, found.cut, found.motor is None) == ("42CrMo4", "a hob cuts", not motors)
        assert found.cost == (2.0 if motors else None)
        return
    assert isinstance(found, Unfit)
    assert said in " ".join(found.why)
    assert found.wider == (1.3 if "hold" in said else None)


def test_a_machine_whose_verdict_breaks_a_condition_is_unfit(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the width that would do where one of them is of teeth or flanks, whatever the others are.

    More teeth may do where the first of them says so.
    """
    monkeypatch.setattr(machine_room, "_wider", lambda drive: 1.3)
    more = {Kind.CONTACT_RATIO: [Remedy("more teeth", search=RemedySearch.FINER)]}
    for kinds, wider in (((Kind.STRENGTH, Kind.CONTACT_RATIO), 1.3), ((Kind.CONTACT_RATIO,), None)):
        advices = [SimpleNamespace(what="no", remedies=more.get(kind, [])) for kind in kinds]
        rows = [
            SimpleNamespace(kind=kind, state=State.BROKEN, advices=[advice])
            for kind, advice in zip(kinds, advices, strict=True)
        ]
        verdict = SimpleNamespace(rows=[*rows, SimpleNamespace(kind=Kind.FLANKS, state=State.KEPT, advices=[])])
        monkeypatch.setattr(machine_room, "judged", lambda drive, known, seconds, verdict=verdict: verdict)
        found = machine_room.judged_machine(PUSHER, "hobbed", Choices())
        assert isinstance(found, Unfit)
        assert (found.why, found.wider) == (tuple(f"{kind}: no" for kind in kinds), wider)
        assert found.finer is (kinds[0] in more)


def test_faces_are_wider_by_what_teeth_and_flanks_need(monkeypatch: pytest.MonkeyPatch) -> None:
    """The share of their life that flanks have is lost in proportion; the larger factor of both counts."""
    monkeypatch.setattr(machine_room, "rating_of", lambda drive, method: SimpleNamespace(weakest=1.2))
    monkeypatch.setattr(machine_room, "face_width_factor", lambda weakest: weakest)
    for share, factor in ((0.5, 2.0), (0.9, 1.2)):
        drive: Any = SimpleNamespace(surfaces_by=lambda method, share=share: SimpleNamespace(share=share))
        assert machine_room._wider(drive) == pytest.approx(factor)


def test_a_machine_is_guessed_by_its_law() -> None:
    guess = guessed_figures(MEAN, 3e6, 2e6, SPEED)
    assert (guess.peak_torque_n_m, guess.gear_volume_mm3) == (20.0 / SPEED, 2e6)
    assert (guess.driven_flywheel_kg_mm2, guess.face_width_mm) == (3e6, 0.0)


def test_each_limit_is_missed_by_what_exceeds_it() -> None:
    """A figure a tenth over each limit is told with both numbers; a tenth under none is."""
    given = (
        "optimize: {goal: least_flank_load, limits: {peak_acceleration_mm_s2: 700, ratio_min: 0.8, ratio_max: 1.25}}\n"
    )
    design = read(given).design
    assert limits_missed(design, MEAN, 30.0) == []
    worse = replace(MEAN, peak_acceleration_mm_s2=770.0, ratio_max=1.375, ratio_min=0.72)
    told = ["peak_acceleration_mm_s2 770 over 700", "ratio_max 1.375 over 1.25", "ratio_min 0.72"]
    assert limits_missed(design, worse, 30.0) == told


def test_the_farthest_one_is_taken_next() -> None:
    """Of even places on a line: the middle, both ends, then those farthest from all, the first of two alike."""
    points = [(float(x), 10.0 - x) for x in range(11)]
    assert [x for x, _ in far_apart(points, list, 5)] == [0.0, 2.0, 5.0, 7.0, 10.0]
    assert undominated([(1.0, 1.0), (1.0015, 1.0), (0.9995, 1.0005)], list) == [(1.0, 1.0)]


def test_gears_go_with_the_flank_load_and_the_square_of_the_safety() -> None:
    """Hertz: the width times the centre distance squared is in proportion to the load over the squared stress."""
    limit = limits.machine_limit(machine(), 4000.0)
    assert limit.flank_load_gap == pytest.approx(0.25, rel=1e-12)
    assert limit.gear_volume_mm3 == pytest.approx(2e6 * (4.0 / 5.0) / 1.25**2, rel=1e-12)
    assert limit.gear_volume_gap == pytest.approx(1.25 * 1.25**2 - 1.0, rel=1e-12)
    without_pitting = limits.machine_limit(machine(contact_share=inf), 4000.0)
    assert (without_pitting.gear_volume_mm3, without_pitting.gear_volume_gap) == (0.0, inf)
    assert limits.machine_limit(machine(), 0.0).flank_load_n_mm == 0.0


LOADS = (230.0, 60_000.0), (210.0, 50_000.0)
"""Costs and flank loads of machines."""


def of_power(power_w: Any) -> Any:
    """A flank load that falls with the power, as if the two had a constant product."""
    return 1e5 / np.asarray(power_w)


def test_no_machine_is_under_the_least_cost(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least cost over a fine line of powers lies over the limit by no more than a part of the powers is wide."""
    monkeypatch.setattr(limits, "least_flank_load", lambda sweeps, power, flywheel, most, share: of_power(power))
    monkeypatch.setattr(limits, "Sweeps", partial(Sweeps, cells=24))
    design = read().design.model_copy(update={"choices": CHOICES})
    some = [machine(cost=cost, gear_volume_mm3=400.0 * load, flank_load_n_mm=load) for cost, load in LOADS]
    of = limits.MachineLimits(design, some, [found_law(5000.0, peak_power_w=40.0)], processes=1)
    power = np.linspace(10.0, 80.0, 20_001)
    volume = 400.0 / 1.25**2 * of_power(power)
    cost = (2.0 + 3.0 / SPEED) * power + 10.0 * volume / 1e6 * 1.5 + 5.0
    assert cost.min() / 4.0 ** (1.0 / 12.0) < of.cost(10.0) < cost.min()
    # Where no law has so much power a hundredth more is looked at; beyond it no gears cost anything
    assert of.cost(60.0) == pytest.approx((2.0 + 3.0 / SPEED) * 60.6 + 5.0)

    monkeypatch.setattr(limits, "swept_power", lambda sweeps, parts, most: np.full(parts.shape[1], 15.0))
    monkeypatch.setattr(limits, "least_power", lambda task, asked: Bound(16.0, 0, None))
    powers = list[Any]()

    def least(sweeps: Any, power: Any, flywheel: Any, most: Any, share: float = 0.0) -> Any:
        powers.append(power)
        return np.resize([0.8, 0.99], most.size) * most

    def raised(task: Any, asked: Demands, prices: Any, law: Any, motion: Motion, budget: Budget) -> tuple[float, None]:
        powers.append([asked.power_w])
        assert budget.most == limits.PROGRAMMES
        assert prices == {"flank_load_n_mm": 1.0}
        assert motion.turning.min() > 0.0
        return 0.9 * law["flank_load_n_mm"], None

    monkeypatch.setattr(limits, "least_flank_load", least)
    monkeypatch.setattr(limits, "raised", raised)
    found = of.found()
    assert powers[0] == pytest.approx([one.figures.peak_power_w for one in some], rel=1e-5)
    assert (found.power_w, found.power_gap) == (16.0, pytest.approx(0.25))
    # Only the limit that is far from its machine is raised, under the power of this machine
    assert powers[1] == [powers[0][0]]
    gaps = [1.0 / (share * (1.0 + KEPT)) - 1.0 for share in (0.9, 0.99)]
    assert [one.flank_load_gap for one in found.each] == pytest.approx(gaps, rel=1e-9)
    assert found.cost is not None
    assert found.cost_gap == pytest.approx(210.0 / found.cost - 1.0)


def test_the_flywheel_s_range_in_parts_with_the_gears_inertia(monkeypatch: pytest.MonkeyPatch) -> None:
    """8 even parts from the least to the most; the least power is the mean power where sweeps tell less."""
    design = read(WITH_FLYWHEEL).design
    monkeypatch.setattr(limits, "Sweeps", partial(Sweeps, cells=24))
    some = [machine(PUSHER + WITH_FLYWHEEL, driven_flywheel_kg_mm2=2000.0)]
    of = limits.MachineLimits(design, some, [], processes=1)
    taken = list[np.ndarray]()
    boxes = list[Any]()

    def raised(task: Any, asked: Demands, prices: Any, law: Any, motion: Any, budget: Budget) -> tuple[float, None]:
        boxes.append((*asked.flywheel_kg_mm2, budget.most))
        return (2.0 if asked.flywheel_kg_mm2[0] > 1500.0 else 1.5) * mean, None

    monkeypatch.setattr(limits, "raised", lambda *given: (0.0, None))
    monkeypatch.setattr(
        limits, "swept_power", lambda sweeps, parts, most: taken.append(parts) or np.full(parts.shape[1], 0.1)
    )
    mean = of.task.work_n_mm / 1000.0 / of.task.cycle_s
    assert of.power_w() == pytest.approx(mean, rel=1e-9)
    assert taken[0][0] == pytest.approx(np.arange(1000.0, 9000.0, 1000.0))
    assert taken[0][1] == pytest.approx(np.arange(2000.0, 9001.0, 1000.0))
    # Branch and bound raises the limits of all parts that are far from the machine, and the least one counts
    monkeypatch.setattr(limits, "raised", raised)
    assert of.power_w() == pytest.approx(1.5 * mean, rel=1e-9)
    assert boxes == [(low, low + 1000.0, limits.PROGRAMMES // 8) for low in np.arange(1000.0, 9000.0, 1000.0)]
    # Where they tell more, the least of all parts.
    monkeypatch.setattr(limits, "swept_power", lambda sweeps, parts, most: mean * (2.0 + (np.arange(8.0) - 3.0) ** 2))
    assert of.power_w() == pytest.approx(2.0 * mean, rel=1e-9)


def test_sizes_of_the_flywheel_in_even_ratios_of_the_whole_inertia() -> None:
    """Between the ends each whole inertia is the geometric mean of its neighbours, to three digits."""
    design = read(WITH_FLYWHEEL).design
    sizes = np.array(flywheel_sizes(design))
    assert (sizes.size, sizes[0], sizes[-1]) == (5, 1000.0, 9000.0)
    # The one inertia beside the flywheel with which the middle size is the geometric mean
    own = (sizes[2] ** 2 - sizes[0] * sizes[4]) / (sizes[0] + sizes[4] - 2.0 * sizes[2])
    steps = np.diff(np.log(sizes + own))
    assert np.ptp(steps) < 0.02 * steps.mean()
    task = task_of(law_design(design, 0.0), inertia_as_given(law_design(design, 0.0)))
    angle = 2.0 * pi * np.arange(2000) / 2000
    slope = task.linkage.displacement(Jet.variable(angle, 1)).derivative(1)
    assert own == pytest.approx(500.0 + 2.0 * float(np.mean(slope**2)), rel=0.15)


def test_the_fewest_teeth_of_even_circular_gears() -> None:
    """2 h / sin^2 of the pressure angle, where h is the depth of the straight flank under the pitch line: 18."""
    search = MachineSearch(loaded("pusher"))
    design = law_design(search.design)
    task = task_of(design, inertia_as_given(design))
    even = FoundLaw((1.0,) * 8, 0.0, figures(task, single(uniform_law(task.lobes))))
    angle = radians(20.0)
    assert search.fewest_teeth(even) == ceil(2.0 * (1.25 - 0.38 * (1.0 - sin(angle))) / sin(angle) ** 2) == 18
    assert search.design.gears is not None
    deep = search.design.gears.rack.model_copy(update={"dedendum": 1.6, "root_radius": 0.1})
    search.design = search.design.model_copy(update={"gears": search.design.gears.model_copy(update={"rack": deep})})
    assert search.fewest_teeth(even) == ceil(2.0 * (1.6 - 0.1 * (1.0 - sin(angle))) / sin(angle) ** 2)
    motion = replace(even, ratio=(0.5, 2.0)).motion
    assert (motion.crank_angle_rad.tolist(), motion.turning.tolist()) == ([0.0, pi], [2.0, 0.5])
    assert search.speed_rad_s == pytest.approx(SPEED)


def test_candidates_are_guessed_by_their_law() -> None:
    """The gears' volume is the flank load times what gears of a law of the same kind need for each N mm of it."""
    design = read().design.model_copy(update={"choices": CHOICES})
    search = MachineSearch(replace(loaded("pusher"), design=design))
    assert search.processes_of(None) == ("shaped", "hobbed")
    search.laws = [
        found_law(5000.0, braking_power_w=0.0),
        found_law(4000.0, peak_power_w=30.0, braking_power_w=0.0301),
        found_law(3000.0, peak_power_w=40.0, braking_power_w=0.0399),
    ]
    steel, better = (material for material, _ in search.materials)
    search.near = {(False, 1): HAS}
    found = search._candidates({(False, 0): 400.0, (True, 0): 500.0, (False, 1): 300.0, (True, 1): 600.0})
    volumes = [(search.laws.index(one.law), one.material, one.volume_mm3) for one in found]
    assert volumes == [(0, better, 1.5e6), (2, better, 0.9e6)]
    assert [one.near for one in found] == [HAS, HAS]
    power, volume, cost = search._guessed(Candidate(search.laws[0], steel, 1.5, 2e6, None))
    assert (power, volume) == (20.0, 2e6)
    assert cost == pytest.approx(2.0 * 20.0 + 3.0 * 20.0 / SPEED + 10.0 * 2.0 * 1.5 + 5.0)


def test_reference_gears_give_the_volume_for_each_flank_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of pitting with the square of its safety, of a material without it with that of breakage, and the law in between.

    Where the law needs more teeth than balance breakage and pitting, laws of gentler curves are looked for, for the
    geometric mean of both.
    """
    search = MachineSearch(loaded("pusher"))
    search.laws = [found_law(load, curvature_turns=12.0) for load in (5000.0, 4000.0, 6000.0)]
    jobs, teeth = list[Any](), list[int]()
    made = machine(contact_share=2.0, teeth=20)

    def numbered(what: str, asked: list[Any]) -> list[tuple[int, WholeMachine]]:
        jobs.extend(asked)
        return [(number, made) for number in range(len(asked))]

    monkeypatch.setattr(search, "_numbered", numbered)
    monkeypatch.setattr(search, "_find_laws", teeth.append)
    assert search._reference() == {(False, 0): 2e6 / 4.0 / 5000.0}
    assert [job.law.flank_load_n_mm for job in jobs] == [5000.0]
    needed = search.fewest_teeth(search.laws[0])
    assert teeth == [ceil((max(20.0 * 1.5 / 4.0, gears.FEWEST_TEETH) * needed) ** 0.5)]
    made = machine(contact_share=inf, bending_share=1.6, teeth=20)
    assert search._reference() == {(False, 0): 2e6 / 1.6 / 5000.0}


def test_caps_of_the_power() -> None:
    """Even ratios from just over the least power on, or the motors that can be had between both."""
    design = law_design(loaded("pusher").design)
    task = task_of(design, inertia_as_given(design))

    def caps(least_w: float, most_w: float, *powers: float) -> list[float]:
        return _Search(task, law_wishes(design, None), LawJob(0.0, None, powers)).caps_w(least_w, most_w)

    found = caps(10.0, 20.0)
    assert len(found) == CAPS
    assert found[0] == pytest.approx(10.03)
    assert np.diff(np.log([*found, 20.0])) == pytest.approx(log(20.0 / 10.03) / CAPS)
    assert caps(10.0, 10.1) == []
    assert caps(10.0, 20.0, 25.0, 15.0, 10.02, 12.0, 20.0) == [12.0, 15.0]


@at_once(
    ("remedies", "then"),
    [
        ((Remedy("more teeth", search=RemedySearch.FINER),), gears.Accepted.WITH_MORE_TEETH),
        ((Remedy("less load"), Remedy("a larger module", search=RemedySearch.LARGER)), gears.Accepted.NO),
        ((), gears.Accepted.NO),
    ],
)
def test_more_teeth_are_tried_where_the_verdict_names_them(
    remedies: tuple[Remedy, ...], then: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    making = gears._Making(loaded("pusher"), gears.GearJob(found_law(5000.0), None, ("hobbed",)), "hobbed")
    advice = Advice(Kind.SHORTENED, "two tips", "less contact", remedies)
    row = SimpleNamespace(kind=Kind.SHORTENED, state=State.BROKEN, advices=(advice,))
    monkeypatch.setattr(gears, "judged", lambda drive, known, seconds: SimpleNamespace(rows=(row,)))
    assert making.is_clean(Sized({}, None, None)) is then  # type: ignore[arg-type]
    assert making.why == (f"{Kind.SHORTENED}: two tips",)
    monkeypatch.setattr(gears, "judged", lambda drive, known, seconds: SimpleNamespace(rows=()))
    monkeypatch.setattr(gears, "more_backlash", lambda drive: {})
    assert making.is_clean(Sized({}, None, None)) is gears.Accepted.YES  # type: ignore[arg-type]


def test_faces_are_widened_until_teeth_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the factor that is told, to whole mm and by one mm at least; gears that need no width end it."""
    making = gears._Making(loaded("pusher"), gears.GearJob(found_law(5000.0), None, ("hobbed",)), "hobbed")
    widths, answers = list[float](), [1.26, 1.01, 1.0, None]

    def judged(text: str, process: str, choices: Choices) -> Unfit:
        design = parsed(text, Path("machine.yaml")).design
        assert design.gears is not None
        assert design.gears.face_width_mm is not None
        widths.append(design.gears.face_width_mm)
        return Unfit(("weak",), answers[len(widths) - 1])

    monkeypatch.setattr(gears, "judged_machine", judged)
    monkeypatch.setattr(gears._Making, "values", lambda self, sized: {"gears.face_width_mm": 12})
    assert making.finished(Sized({}, None, None)).why == ("weak",)  # type: ignore[arg-type,union-attr]
    # 12 * 1.26 = 15.1, 16 * 1.01 = 16.2, and one more
    assert widths == [12.0, 16.0, 17.0, 18.0]


def making_with_masses(choices: str = "") -> gears._Making:
    text = f"{PUSHER}{WITH_FLYWHEEL}{choices}"
    return gears._Making(parsed(text, Path("d.yaml")), gears.GearJob(found_law(5000.0), None, ("hobbed",)), "hobbed")


def test_tips_that_the_law_with_own_inertia_shortens_get_the_law_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both are judged once, and where neither makes a machine no law is sought again for the same gears."""
    making, laws = making_with_masses(), list[tuple[float, ...]]()
    again = replace(making.job.law, ratio=(1.1, 0.9, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0))

    def judged(text: str, process: str, choices: Choices) -> Unfit:
        laws.append(tuple(parsed(text, Path("machine.yaml")).design.motion.model_dump()["ratio"]))
        return Unfit(("short",), finer=True)

    monkeypatch.setattr(gears, "settled_law", lambda *asked: again)
    monkeypatch.setattr(gears, "judged_machine", judged)
    monkeypatch.setattr(gears._Making, "values", lambda self, sized: {"gears.face_width_mm": 12})
    assert making.finished(SIZED).finer  # type: ignore[union-attr]
    assert laws == [again.ratio, making.job.law.ratio]


def test_gears_that_make_no_machine_for_want_of_teeth_are_sized_again_with_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By 15 % at least, or with a larger module, as gears that the verdict refuses."""
    making, sizes, answers = making_with_masses(), list[tuple[int, float]](), list[gears.Accepted]()
    offered = [(30, 2.0), (34, 2.0), (35, 2.0), (20, 2.5)]

    def smallest(drive: Any, room: Any, accepted: Any, most: int, tell: Any) -> Any:
        for teeth, module in offered:
            sized = SimpleNamespace(drive=None, teeth=teeth, module_mm=module)
            answers.append(accepted(sized))
            if answers[-1] is gears.Accepted.YES:
                return sized
        return None

    def finished(self: gears._Making, sized: Any) -> Unfit:
        sizes.append((sized.teeth, sized.module_mm))
        return Unfit(("short",), finer=len(sizes) < 3)

    monkeypatch.setattr(gears, "smallest_accepted", smallest)
    monkeypatch.setattr(gears, "judged", lambda drive, known, seconds: SimpleNamespace(rows=()))
    monkeypatch.setattr(gears, "more_backlash", lambda drive: {})
    monkeypatch.setattr(gears._Making, "finished", finished)
    assert making.made().why == ("short",)  # type: ignore[union-attr]
    assert sizes == [(30, 2.0), (35, 2.0), (20, 2.5)]
    more = gears.Accepted.WITH_MORE_TEETH
    yes = gears.Accepted.YES
    assert answers == [yes, more, more, yes, more, more, more, yes]


@at_once(
    ("has", "changes"),
    [
        ({}, {"gears.backlash_mm": 0.065}),
        ({"share": 9e-4}, {}),
        ({"given": 0.0}, {}),
        ({"fits": False}, {}),
    ],
)
def test_gears_get_backlash_until_surely_enough_assemblies_turn(
    has: dict[str, Any], changes: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """0.41 % of a baler's jam by the estimate, 1.12 % drawn one by one; an exact pair, or one without room, stays."""
    found = {"share": 4.1e-3, "key": "gears.backlash_mm", "given": 0.05, "enough": 0.065, "fits": True}
    monkeypatch.setattr(gears, "jamming_of", lambda drive: SimpleNamespace(**found | has))
    assert gears.more_backlash(SIZED.drive) == changes


def test_the_law_of_own_inertia_keeps_to_the_motor(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fifth of a percent more power is room, unless the weakest motor of the law has less."""
    caps = list[float]()
    monkeypatch.setattr(gears, "settled_law", lambda design, teeth, near, cap_w: caps.append(cap_w))
    monkeypatch.setattr(gears, "judged_machine", lambda text, process, choices: Unfit(("weak",)))
    monkeypatch.setattr(gears._Making, "values", lambda self, sized: {"gears.face_width_mm": 12})
    for motors in ("", "choices: {motors: [{name: a, power_w: 10}, {name: b, power_w: 20.01}]}"):
        making_with_masses(motors).finished(SIZED)
    assert caps == pytest.approx([1.002 * 20.0, 20.01], rel=1e-12)


@pytest.mark.slow
def test_a_shaft_under_the_rod_ends_below_it() -> None:
    """The baler's rod passes over the driving shaft: the remedy is of no gear, and the machine's file has it."""
    text = rewritten((DESIGNS / "baler-flywheel.yaml").read_text(encoding="utf-8"), {"fit": None})
    given = parsed(text, Path("d.yaml"))
    making = gears._Making(given, gears.GearJob(found_law(5000.0), None, ("hobbed",)), "hobbed")
    drive = Drive(given.design)
    sized = Sized({}, drive, rating_of(drive, "estimate"))
    assert making.is_clean(sized) is gears.Accepted.YES
    assert making.mended["fit.driving_shaft"] == "ends"
    assert making.values(sized)["fit.driving_shaft"] == "ends"


def test_the_search_begins_with_the_gears_of_another_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight times the flank load wants gears twice as large and as wide, with as many teeth."""
    begun = list[Any]()
    monkeypatch.setattr(gears, "smallest_accepted", lambda drive, *asked: begun.append(drive.gears))
    near = replace(HAS, teeth=47, module_mm=1.5, face_width_mm=11.0, flank_load_n_mm=625.0)
    gears._Making(loaded("pusher"), gears.GearJob(found_law(5000.0), None, ("hobbed",), near), "hobbed").made()
    assert [(one.teeth, one.module_mm, one.face_width_mm) for one in begun] == [(47, 3.0, 22.0)]


def test_the_price_of_a_wish_is_what_is_needed_more_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The dearest first; less than half a percent, and what no law was found for, is not told."""
    needed = {
        "": limits.NeededPower(12.0, 5000.0),
        "a": limits.NeededPower(10.0, 5000.0),
        "b": limits.NeededPower(12.0, 4000.0),
        "c": limits.NeededPower(11.95, 4990.0),
        "d": limits.NeededPower(6.0, inf),
    }
    monkeypatch.setattr(limits, "wish_keys", lambda text: list("abcd"))
    monkeypatch.setattr(limits, "finished", lambda function, keys, *where: needed.items())
    found = limits.wish_prices(machine(), lambda done, count: None)
    assert [(one.key, one.motor, one.gears) for one in found] == [
        ("b", 0.0, pytest.approx(0.25)),
        ("a", pytest.approx(0.2), 0.0),
    ]


def test_a_wish_is_left_out_by_its_key() -> None:
    """Of the motion, of the limits or convex curves; all others stay."""
    wishes = law_wishes(law_design(loaded("pusher").design), None)
    named: Any = [SimpleNamespace(key=key) for key in ("motion.dwells.0", "motion.time_ratio")]
    limits_of = replace(wishes.limits, peak_acceleration_mm_s2=3.0)
    wishes = replace(wishes, motion=tuple(named), convex=True, limits=limits_of)
    assert limits._without(wishes, "motion.time_ratio").motion == tuple(named[:1])
    assert limits._without(wishes, "optimize.limits.convex") == replace(wishes, convex=False)
    free = limits._without(wishes, "optimize.limits.peak_acceleration_rad_s2")
    assert (free.limits.peak_acceleration_mm_s2, free.motion, free.convex) == (None, tuple(named), True)


def test_what_is_told_of_a_machine_that_was_made_by_easing() -> None:
    choices = Choices.model_validate({"modules_mm": [2.0], "face_width_modules": {"least": 5, "most": 20}})
    keys = [one.key for one in conflict.easings(choices, "C45")]
    assert keys == ["choices.modules_mm", "choices.face_width_modules.most", "gears.material", "all"]
    wide = choices.model_copy(
        update={"face_width_modules": choices.face_width_modules.model_copy(update={"most": 30.0})}
    )
    assert [one.key for one in conflict.easings(wide, conflict.STRONGER[-1])] == ["choices.modules_mm"]
    easing = conflict.Easing("choices.face_width_modules.most", ())
    assert "of 6.25 modules" in conflict._needs(easing, machine(face_width_mm=12.5, module_mm=2.0))


def test_what_machines_gain_and_cost_beside_the_recommended_one() -> None:
    one = machine()
    names = ("peak_power_w", "gear_volume_mm3", "driven_flywheel_kg_mm2")
    assert difference_words(machine(peak_power_w=22.4, gear_volume_mm3=1.2e6), one, names) == (
        "40 % smaller gears for 12 % more motor"
    )
    assert difference_words(machine(peak_power_w=20.09), one, names) == "the same"
    assert difference_words(machine(peak_power_w=50.0, driven_flywheel_kg_mm2=0.0), one, names) == (
        "no flywheel for 2.5 times the motor"
    )
    assert difference_words(one, machine(driven_flywheel_kg_mm2=0.0), names) == "a flywheel"
    assert difference_words(machine(peak_power_w=44.0), one, names) == "2.2 times the motor"
    assert difference_words(machine(peak_power_w=39.8), one, names) == "99 % more motor"


def test_machines_are_told_in_their_own_units() -> None:
    search = MachineSearch(loaded("pusher"))
    search.made = [machine(cost=3.0), machine(cost=9.0, peak_power_w=15.0, gear_volume_mm3=4e6)]
    limit = limits.MachineLimit(4000.0, 0.25, 1e6, 0.6)
    price = limits.WishPrice("optimize.limits.ratio_max", 0.17, -0.2)
    found = replace(search.found, limits=limits.ProvenLimits(12.5, 0.6, (limit, limit)), prices=(price,))
    assert [one.figures.peak_power_w for one in found.machines] == [15.0, 20.0]
    assert found.recommended == 1
    told = {row.name: row.texts for row in machines_answer(found).rows}
    assert told["pusher-2 *"][:3] == ("20", "2", "3")
    assert told["least power"][0].startswith("12.5 W")
    assert told["flank load"][0].startswith("25.0 %")
    assert told["gears"][0].startswith("60.0 %")
    assert told["wishes"] == ("ratio_max costs 17 % of motor or 0 % of gears",)
    written = machines_figures(found)
    assert [one["beside_recommended"] for one in written["machines"]] == [
        "25 % less motor for 100 % larger gears and 3 times the cost",
        "",
    ]
