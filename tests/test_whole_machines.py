"""Whole machines: what counts, what a file alone tells, refusals; sweeps beside a closed form and beside laws."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import inf, pi
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from at_once import at_once
from commands import Run
from drives import DESIGNS, loaded
from ncgear.design.keys.optimize import Choices
from ncgear.design.reading.design_file import parsed
from ncgear.design.rewritten import rewritten
from ncgear.errors import DesignError, WrongInput
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import least_mean_power_w
from ncgear.optimum.certified.sweeps import Sweeps, SweptLimits, least_power
from ncgear.optimum.makeable.demanded import demands_of
from ncgear.optimum.task import Task, figures
from ncgear.project.drive import Drive
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import single
from ncgear.whole_machines.gears import GearJob, machine_of
from ncgear.whole_machines.laws import LawJob, law_design, law_wishes, laws_of
from ncgear.whole_machines.machine import Unfit, WholeMachine, judged_machine
from ncgear.whole_machines.search import MachineSearch, far_apart, recommended, undominated

PUSHER = (DESIGNS / "pusher.yaml").read_text(encoding="utf-8")
TEMPLATE = DESIGNS.parent / "src" / "ncgear" / "design" / "templates" / "choices.yaml"


@cache
def machine(name: str) -> tuple[Task, Demands]:
    made = law_design(loaded(name).design)
    task = task_of(made, inertia_as_given(made))
    return task, demands_of(task, law_wishes(made, None))


def with_choices(choices: str) -> str:
    return f"{PUSHER}\nchoices: {choices}\n"


# Sweeps


@pytest.mark.judges("optimum")
@pytest.mark.slow
def test_least_power_without_masses_has_a_closed_form() -> None:
    """With the power and the ratio alone the fastest crank has s = min(1/i_min, P/(w F |x'|)) everywhere."""
    task, _ = machine("pusher")
    task = replace(task, masses=None)
    asked = Demands(ratio_min=0.5, ratio_max=5.0)
    load, speed, design = task.load, task.speed_rad_s, loaded("pusher").design
    crank, rod = design.linkage.crank_mm, design.linkage.rod_mm

    def pace(angle: float, power_w: float) -> float:
        across = np.sqrt(rod**2 - (crank * np.sin(angle)) ** 2)
        place = across - crank * np.cos(angle) - (rod - crank)
        slope = crank * np.sin(angle) * (1.0 - crank * np.cos(angle) / across)
        force = float(load.against_n(np.array([place]), np.array([angle > pi]))[0])
        return max(0.5, speed * force * abs(slope) / (1000.0 * power_w))

    def time(power_w: float) -> float:
        parts = np.linspace(0.0, 2.0 * pi, 81)
        return sum(quad(pace, a, b, args=(power_w,), limit=80)[0] for a, b in pairwise(parts))

    least = brentq(lambda power: time(power) - task.cycle_rad, 1.0, 20.0, xtol=1e-6)
    bound = least_power(Sweeps(task, asked, 360), np.zeros((2, 1)), np.array([2.0 * least]))[0]
    assert 0.98 * least < bound <= least * (1.0 + 1e-6)


@pytest.mark.judges("optimum")
@pytest.mark.parametrize("name", ["baler-flywheel", "pusher"])
@pytest.mark.slow
def test_a_law_is_possible(name: str) -> None:
    """The uniform crank keeps its own figures.

    Sweeps need not show that less than the mean power is too little: the mean power is a limit by itself.
    """
    task, asked = machine(name)
    free = replace(asked, acceleration_mm_s2=inf, wishes=())
    even = figures(task, single(uniform_law(task.lobes)))
    sweeps = Sweeps(task, free, 240)
    mean_w = task.work_n_mm / 1000.0 / task.cycle_s
    power = even.peak_power_w * np.linspace(1.0 + 1e-6, 2.0, 9)
    load = (even.flank_load_n_mm or 1.0) * np.linspace(1.0 + 1e-6, 2.0, 9)
    assert sweeps.possible(SweptLimits(load, power, np.zeros((2, 9)))).all()
    assert least_mean_power_w(task) == pytest.approx(mean_w, rel=1e-6)


# What counts


@pytest.mark.judges("whole_machines")
def test_machines_that_none_beats() -> None:
    points = [(1.0, 5.0), (2.0, 4.0), (3.0, 4.5), (5.0, 1.0), (5.0, 1.0000001), (4.0, 2.0)]
    assert undominated(points, list) == [(1.0, 5.0), (2.0, 4.0), (5.0, 1.0), (4.0, 2.0)]


def test_a_few_far_apart_hold_the_best_of_each_figure() -> None:
    points = [(float(x), 10.0 - x) for x in range(11)]
    few = far_apart(points, list, 3)
    assert (0.0, 10.0) in few
    assert (10.0, 0.0) in few
    assert len(few) == 3


def test_the_recommended_one_costs_least_or_has_the_least_product() -> None:
    points = [(100.0, 1.0), (10.0, 4.0), (1.0, 90.0)]
    assert recommended(points, list, lambda one: None) == 1
    assert recommended(points, list, lambda one: one[0]) == 2
    # A figure that is zero somewhere does not count
    assert recommended([(1.0, 5.0, 0.0), (1.0, 4.0, 9.0)], list, lambda one: None) == 1


# Keys


@at_once(
    ("choices", "said"),
    [
        ("{least: [cost]}", "choices.cost: missing"),
        ("{processes: [hobbed, hobbed]}", "choices.processes: the same is given twice"),
        ("{materials: [42CrM4]}", "42CrMo4"),
        ("{face_width_modules: {least: 9, most: 6}}", "choices.face_width_modules.least"),
        ("{cost: {}}", "nothing costs anything"),
    ],
)
def test_wrong_choices_are_refused_with_file_line_and_key(choices: str, said: str) -> None:
    with pytest.raises(WrongInput) as refused:
        parsed(with_choices(choices), Path("wish.yaml"))
    line = len(PUSHER.splitlines()) + 2
    assert f"wish.yaml:{line}:" in str(refused.value)
    assert said in str(refused.value)


def test_every_choice_that_a_new_file_offers_in_a_comment_can_be_taken() -> None:
    text = TEMPLATE.read_text(encoding="utf-8")
    offered = [line.strip().removeprefix("# ") for line in text.splitlines() if line.startswith("  # ")]
    assert len(offered) == 5
    for line in offered:
        assert parsed(f"{PUSHER}\nchoices:\n  {line}\n", Path("wish.yaml")).design.choices is not None


def test_what_is_not_offered_is_refused_by_its_key() -> None:
    bare = rewritten(PUSHER, {"gears": None})
    with pytest.raises(DesignError, match="gears: missing"):
        MachineSearch(parsed(bare, Path("wish.yaml")))
    with pytest.raises(DesignError, match=r"motion\.second_stage: several pairs; the search for whole"):
        MachineSearch(loaded("baler-66-two-stage"))


def test_a_way_of_making_that_suits_no_material_is_refused() -> None:
    with pytest.raises(DesignError, match="printed given, which makes teeth of no material"):
        MachineSearch(parsed(with_choices("{processes: [printed]}"), Path("wish.yaml")))
    MachineSearch(parsed(with_choices("{processes: [printed], materials: [POM]}"), Path("wish.yaml")))


# One machine


@cache
def shipped() -> WholeMachine:
    made = judged_machine((DESIGNS / "baler-flywheel.yaml").read_text(encoding="utf-8"), "hobbed", Choices())
    assert isinstance(made, WholeMachine)
    return made


@pytest.mark.judges("whole_machines")
@pytest.mark.slow
def test_a_shipped_design_is_a_whole_machine_with_its_own_figures() -> None:
    drive = Drive(loaded("baler-flywheel").design)
    found = shipped().figures
    assert found.peak_power_w == drive.check.peak_power_w.value
    assert found.gear_volume_mm3 == pytest.approx(130.0**2 * 20.0, rel=1e-3)
    assert found.driven_flywheel_kg_mm2 == 150e6


@pytest.mark.slow
@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"gears.face_width_mm": 8}, "strength"),
        ({"optimize.limits.peak_acceleration_mm_s2": 20000}, "peak_acceleration_mm_s2"),
        ({"gears.backlash_mm": 0.01}, "jams"),
    ],
)
def test_a_machine_that_breaks_a_condition_or_a_limit_is_unfit(values: dict[str, float], said: str) -> None:
    text = rewritten((DESIGNS / "baler-flywheel.yaml").read_text(encoding="utf-8"), values)
    made = judged_machine(text, "hobbed", Choices())
    assert isinstance(made, Unfit)
    assert said in " ".join(made.why)


@pytest.mark.slow
@pytest.mark.long
def test_gears_that_are_to_be_shaped_are_made_for_a_shaper() -> None:
    """A hob's spaces are deeper than a shaper reaches, and on the profile A of ISO 53 a shaper's fillets meet tips."""
    text = with_choices("{processes: [shaped]}")
    law = laws_of(parsed(text, Path("wish.yaml")).design, LawJob(0.0, None))[0]
    made = machine_of(text, GearJob(law, None, ("shaped",)))
    assert isinstance(made, WholeMachine)
    assert made.cut == "a shaper cuts it"
    assert "profile: D" in made.text


@pytest.mark.slow
def test_no_motor_that_is_too_weak_is_taken() -> None:
    text = (DESIGNS / "baler-flywheel.yaml").read_text(encoding="utf-8")
    motors = [{"name": "small", "power_w": 3000.0, "cost": 1.0}, {"name": "large", "power_w": 4000.0, "cost": 2.0}]
    made = judged_machine(text, "hobbed", Choices.model_validate({"motors": motors}))
    assert isinstance(made, WholeMachine)
    assert (made.motor and made.motor.name, made.cost) == ("large", 2.0)
    assert isinstance(judged_machine(text, "hobbed", Choices.model_validate({"motors": motors[:1]})), Unfit)
    assert isinstance(judged_machine(text, "printed", Choices()), Unfit)


@pytest.mark.judges("whole_machines")
@pytest.mark.slow
def test_four_commands_tell_the_figures_of_a_machine_from_its_file_alone(run: Run) -> None:
    """Check, strength, simulate and tolerance compute them each by its own way through the program."""
    file = str(DESIGNS / "baler-flywheel.yaml")
    check = json.loads(run("check", file, "--json")[1])["check"]
    strength, simulated, tolerance = (
        json.loads(run(command, file, "--json", "--out", command)[1])
        for command in ("strength", "simulate", "tolerance")
    )
    moved, found = simulated["this_design"], shipped().figures

    def share(damage: str) -> float:
        gears = (strength[gear] for gear in ("driving", "driven"))
        return min(
            one[f"{damage}_endured_mpa"] / one[f"{damage}_stress_mpa"] / one[f"{damage}_safety_wanted"] for one in gears
        )

    told = [
        (check["peak_power_w"], found.peak_power_w),
        (moved["peak_power_w"], found.peak_power_w),
        (moved["peak_driving_torque_n_m"], found.peak_torque_n_m),
        (moved["braking_power_w"], found.braking_power_w),
        (tolerance["figures"]["peak_acceleration_mm_s2"]["as_designed"], found.peak_acceleration),
        (share("bending"), found.bending_share),
        (share("contact"), found.contact_share),
    ]
    for one, other in told:
        assert one == pytest.approx(other, rel=1e-6, abs=1e-9)


# The command


@pytest.mark.slow
@pytest.mark.long
def test_one_command_ends_in_files_that_are_rated_alike_anew(run: Run) -> None:
    Path("d.yaml").write_text(with_choices("{machines: 3}"), encoding="utf-8")
    status, out, _ = run("design", "d.yaml", "--processes", "1", "--out", "out", "--json")
    assert status == 0
    found = json.loads(out)
    assert 1 <= len(found["machines"]) <= 3
    for one in found["machines"]:
        text = Path("out", f"{one['name']}.yaml").read_text(encoding="utf-8")
        anew = judged_machine(text, one["process"], Choices())
        assert isinstance(anew, WholeMachine)
        assert anew.figures.peak_power_w == pytest.approx(one["peak_power_w"], rel=1e-6)
        assert anew.figures.bending_share == pytest.approx(one["bending_share"], rel=1e-6)
    limits = found["limits"]
    assert limits["peak_power_w"] <= min(one["peak_power_w"] for one in found["machines"])
    for one, limit in zip(found["machines"], limits["machines"], strict=True):
        assert limit["flank_load_n_mm"] <= one["flank_load_n_mm"]
