"""One machine: whatever two commands tell of it is the same, at its speed and at ten times its speed.

Every design and every machine of ``ncgear new`` is asked by check, simulate, sweep, optimize and the drivetrain, and
each figure is held against the one source that ``made.sources`` names. That these sources are right is
judged elsewhere: by energies and another program (test_felt, test_rigid), by Newton and Euler
(test_one_machine_judged).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from math import pi
from typing import Any

import numpy as np
import pytest

from drives import MACHINES, drive_of_text, loaded
from made.sources import SOURCES, LoadedMachine
from ncgear.design.keys.design import Design
from ncgear.design.space import Listed, Space
from ncgear.design.template import MachineName, machine_template
from ncgear.errors import DesignError
from ncgear.figures.simulated import rigid_figures
from ncgear.figures.summary.check_summary import check_summary, uniform_key
from ncgear.figures.tables import law_csv
from ncgear.files.sweep_run import Order, screening_of
from ncgear.numerics.units import KG_M2
from ncgear.optimum.task import Task, figures
from ncgear.project.drive import Drive
from ncgear.project.law_task import task_of
from ncgear.project.moving import disc_kg_mm2
from ncgear.project.opened import loads
from ncgear.project.service import densities_kg_m3
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import single
from ncgear.screening.designs import screened_part
from ncgear.screening.single import single_figures

Told = tuple[str, str, bool, float]
"""A command, the key of a figure, whether it is the uniform crank's, and the value that is told."""

SAME = 1e-6
"""Relative difference that counts as none, as peaks are located to far less by two searches."""

NAMES = [*MACHINES, *(f"new {machine.value}" for machine in MachineName)]
QUICK = ["scotch-yoke-pump", "uniform-crank"]
SOON = [f"{name}-10.0" for name in ("new baler", "pump-both-ways", "rocker-drive")]
"""Designs with masses, whose figures do not only grow with powers of the speed."""


@cache
def design_named(name: str) -> Design:
    if name.startswith("new "):
        return loads(machine_template("mine", MachineName(name.removeprefix("new ")))).design
    return loaded(name).design


@cache
def machine_of(name: str, faster: float) -> Drive:
    design = design_named(name)
    speed = design.operation.speed_rpm * faster
    return Drive(design.model_copy(update={"operation": design.operation.model_copy(update={"speed_rpm": speed})}))


def source_key(key: str) -> str | None:
    """The key of a figure in the list of sources; None for one that has no source there."""
    return next((one for one in SOURCES if key == one or key in (f"{one}_mm_s", f"{one}_rad_s")), None) or next(
        (one for one in SOURCES if key in (f"{one}_mm_s2", f"{one}_rad_s2")), None
    )


def by_key(command: str, section: Mapping[str, Any], uniform: bool) -> Iterator[Told]:
    for key, value in section.items():
        if (known := source_key(key)) is not None and isinstance(value, float):
            yield command, known, uniform, value


def told_by_check(drive: Drive) -> Iterator[Told]:
    summary = check_summary(drive)
    yield from by_key("check", summary["check"], False)
    yield from by_key("check", summary["check"][uniform_key(drive)], True)
    own, uniform, *_ = summary["comparison"]
    yield from by_key("comparison", own, False)
    yield from by_key("comparison", uniform, True)


def told_by_simulate(drive: Drive) -> Iterator[Told]:
    found = rigid_figures(drive)
    yield from by_key("simulate", found["this_design"], False)
    yield from by_key("simulate", found[uniform_key(drive)], True)


def told_by_sweep(drive: Drive) -> Iterator[Told]:
    found = single_figures(drive.design)
    yield from by_key("sweep", {key.removeprefix("check."): value for key, value in found.items()}, False)


def told_by_optimize(drive: Drive) -> Iterator[Told]:
    """Of the design's own law, as the command tells ``design as given``, on the machine with its own gears."""
    task = task_of(drive.design, drive.train_inertia)
    for uniform in (False, True):
        own = drive.law.train
        found = figures(task, single(uniform_law(task.lobes)), own) if uniform else figures(task, own)
        told = {
            "peak_power_w": found.peak_power_w,
            "peak_acceleration_cycle_mm_s2": found.peak_acceleration_mm_s2,
            "peak_speed_mm_s": found.peak_speed_mm_s,
            "braking_power_w": found.braking_power_w,
            "rms_torque_n_m": found.rms_torque_n_m,
            "peak_mesh_force_n": found.tooth_force_n,
        }
        if found.flywheel_kg_mm2 is not None:
            told["inertia_for_speed_fluctuation_kg_m2"] = KG_M2 * found.flywheel_kg_mm2
        yield from by_key("optimize", {key: value for key, value in told.items() if value is not None}, uniform)


def told_by_drivetrain(drive: Drive) -> Iterator[Told]:
    losses, cycle_s = drive.drivetrain.demand.losses, drive.transmission.cycle_rad / drive.machine.speed_rad_s
    whole = 1e-3 * (losses.useful_n_mm + losses.guide_n_mm) / cycle_s
    yield "drivetrain", "mean_power_w", False, whole


def everything_told(drive: Drive) -> Iterator[Told]:
    """What all commands tell; what a command refuses to compute of this design it does not tell."""
    yield from told_by_check(drive)
    yield from told_by_sweep(drive)
    design = drive.design
    counted = drive.masses_left_out is None
    if counted and design.stages == 1:
        yield from told_by_simulate(drive)
    searched = drive.linkage.RETURNS and not design.motion.is_open and design.stages == 1
    if searched and drive.transmission.lobes.driven == 1 and not (design.gears and design.gears.mesh == "internal"):
        try:
            yield from told_by_optimize(drive)
        except DesignError as refusal:
            assert refusal.key == "drivetrain.guide_friction"
    if design.drivetrain is not None:
        yield from told_by_drivetrain(drive)


def disagreements(drive: Drive, told: Callable[[Drive], Iterator[Told]] = everything_told) -> list[str]:
    found = []
    for command, key, uniform, value in told(drive):
        source = SOURCES[key].of(LoadedMachine(drive, uniform))
        if abs(value - source) > SAME * max(abs(source), 1e-9):
            whose = "the uniform crank" if uniform else "it"
            found.append(f"{command} tells {key} {value!r} of {whose}, not {source!r}")
    return found


@pytest.mark.judges("figures", "project")
@pytest.mark.tiers(
    quick=[f"{name}-1.0" for name in QUICK], slow=[*(f"{name}-1.0" for name in NAMES[::4]), *SOON], rest="long"
)
@pytest.mark.parametrize("faster", [1.0, 10.0])
@pytest.mark.parametrize("name", NAMES)
def test_all_commands_tell_one_machine(name: str, faster: float) -> None:
    try:
        drive = machine_of(name, faster)
        _ = drive.check
    except DesignError:
        pytest.skip("refused, by every command alike")
    try:
        assert disagreements(drive) == []
    except DesignError as refusal:
        # Teeth that cannot hold or pass on the torque: forces and pitch curves are refused, the powers are not.
        assert "cannot" in refusal.problem or "pressure angle" in refusal.problem
        assert [one for one in told_by_check(drive) if one[1] == "peak_power_w"]


@pytest.mark.tiers(quick=["crank-*"], rest="slow")
@pytest.mark.parametrize(
    ("what", "changed"),
    [
        ("driven gear", {"driven_inertia_kg_mm2": 0.0}),
        ("crank", {"crank_inertia_kg_mm2": 0.0}),
        ("slider", {"slider_kg": 0.0}),
    ],
)
def test_a_command_that_leaves_one_inertia_out_is_found(
    monkeypatch: pytest.MonkeyPatch, what: str, changed: dict[str, float]
) -> None:
    """Negative control: optimize with another machine than the rest."""
    right = task_of

    def other(design: Design, gears: Any) -> Task:
        task = right(design, gears)
        assert task.masses is not None
        return replace(task, masses=replace(task.masses, **changed))

    monkeypatch.setitem(globals(), "task_of", other)
    found = disagreements(machine_of("scotch-yoke-pump", 1.0), told_by_optimize)
    assert any("optimize tells peak_power_w" in one for one in found), what


def test_the_table_of_a_build_has_the_power_that_the_check_tells() -> None:
    """Its greatest row comes near to the peak, from below; without masses there are no such columns."""
    drive = machine_of("scotch-yoke-pump", 1.0)
    header, *rows = law_csv(drive.motion, drive.linkage.OUTPUT).splitlines()
    table = dict(zip(header.split(","), np.array([line.split(",") for line in rows], dtype=float).T, strict=True))
    power, speed = table["power_with_masses_w"], drive.machine.speed_rad_s
    np.testing.assert_allclose(power, table["driving_torque_with_masses_n_m"] * speed, rtol=1e-12)
    peak = drive.check.peak_power_w.value
    assert peak * (1.0 - 1e-5) <= power.max() <= peak * (1.0 + 1e-12)
    assert table["power_w"].max() == pytest.approx(drive.check.peak_power_resistance_w.value, rel=1e-5)
    plain = law_csv(machine_of("uniform-crank", 1.0).motion, drive.linkage.OUTPUT).splitlines()[0]
    assert plain.endswith("force_n,power_w")


def test_masses_that_are_not_counted_are_told_once() -> None:
    summary = check_summary(machine_of("uniform-crank", 1.0))
    assert summary["check"]["masses"].startswith("not counted in power: give them as masses")
    assert "masses" not in check_summary(machine_of("scotch-yoke-pump", 1.0))["check"]


def test_each_figure_has_one_source_of_a_name() -> None:
    names = {key: source.name for key, source in SOURCES.items()}
    assert names["peak_power_w"] == "dynamics.driving_shaft.DrivingShaft.peak_power_w"
    assert all("<lambda>" not in name and name.count(".") >= 2 for name in names.values())


@pytest.mark.judges("project")
def test_gears_that_cannot_be_made_are_discs_and_the_answer_says_so() -> None:
    """Sixteen round teeth with a bore wider than their roots: discs of known moment, pi rho b (r^4 - bore^4) / 2."""
    text = (
        "name: stuck\nlinkage: {crank_mm: 20, rod_mm: 80}\noperation: {speed_rpm: 60}\nmotion: {law: uniform_crank}\n"
        "resistance: {polynomial_n: [100]}\n"
        "gears: {teeth: 16, module_mm: 2, face_width_mm: 10, driving: {bore_mm: 31}, driven: {bore_mm: 31}}\n"
        "masses:\n  slider_kg: 1\n  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}\n"
        "  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}\n"
    )
    drive = loads(text)
    assert drive.check.with_masses is not None
    exact = np.pi / 2.0 * 7850e-9 * 10.0 * (16.0**4 - 15.5**4)
    assert drive.masses.driven_inertia_kg_mm2 == pytest.approx(exact, rel=4e-4)
    assert "discs within the pitch curves" in check_summary(drive)["check"]["masses"]


@pytest.mark.parametrize("name", ["scotch-yoke-pump", "rocker-drive"])
def test_a_disc_stands_for_a_gear_within_what_is_said(name: str) -> None:
    """Teeth of addendum 1 and dedendum 1.25 take a ring 0.125 modules wide off the disc, four times that of its moment.

    Fillets and lands leave about as much as spaces take: half a module over the least radius bounds the rest.
    """
    drive = machine_of(name, 1.0)
    radii = np.hypot(*drive.pitch.driven.drawn(200).position.T)
    disc = disc_kg_mm2(drive.gears, drive.pitch.driven, drive.pitch.size.module_mm, _density(drive))
    share = disc / drive.gear_inertia.driven_kg_mm2 - 1.0
    assert abs(share) < 2.0 * drive.pitch.size.module_mm / radii.min()


def _density(drive: Drive) -> float:
    assert drive.design.masses is not None
    return densities_kg_m3(drive.design.masses.density_kg_m3, drive.gears)[1]


@pytest.mark.judges("screening")
@pytest.mark.parametrize(("name", "key"), [("scotch-yoke-pump", "operation.speed_rpm"), ("pusher", "gears.teeth")])
def test_a_sweep_without_pitch_curves_has_the_same_machine(name: str, key: str) -> None:
    """The stage check leaves gears out only where motion and power do not depend on them."""
    given = loaded(name)
    value = 60.0 if key == "gears.teeth" else given.design.operation.speed_rpm
    screening = screening_of(given.design, given.data, Order(Space((Listed(key, (value,)),)), "check"))
    found = screened_part(screening, 0, np.array([[value]]))
    assert found.made.all()
    assert found.figures["check.peak_power_w"] == pytest.approx(
        machine_of(name, 1.0).check.peak_power_w.value, rel=1e-9
    )


def test_a_disc_has_the_bore_and_the_hub_of_its_gear() -> None:
    """A circle of 20 mm radius with a bore of 10 and a hub of 24 by 6 mm, in closed form."""
    own = drive_of_text(
        "name: round\nlinkage: {crank_mm: 30, rod_mm: 120}\noperation: {speed_rpm: 60}\nmotion: {law: uniform_crank}\n"
        "gears: {teeth: 20, module_mm: 2, face_width_mm: 10,"
        " driven: {bore_mm: 10, hub: {diameter_mm: 24, height_mm: 6}}}"
    )
    disc = disc_kg_mm2(own.gears, own.pitch.driven, 2.0, 7850.0)
    expected = 7.85e-6 * pi / 2.0 * ((20.0**4 - 5.0**4) * 10.0 + (12.0**4 - 5.0**4) * 6.0)
    assert disc == pytest.approx(expected, rel=1e-4)
