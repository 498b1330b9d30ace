"""The baler with all its masses: powers of known laws by energies sampled anew, and the table of docs/baler.md."""

from __future__ import annotations

import re
from functools import cache
from math import pi

import numpy as np
import pytest

from documented.installing import ROOT
from drives import drive, loaded
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.forces import RodMasses
from ncgear.numerics.arrays import Array
from ncgear.optimum.task import felt
from ncgear.project.best_law import BestLaw
from ncgear.project.law import law_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from published import BALER_LINKAGE, FIT, PRESS, RPM

LAWS = (
    "uniform crank",
    "designs/baler-66.yaml",
    "designs/baler-half.yaml",
    "designs/baler-smooth.yaml",
    "designs/baler-real.yaml",
)
"""Rows of the table."""

NONE = RodMasses()
PLUNGER = RodMasses(slider_kg=150.0)
ALL = RodMasses(150.0, 30.0, 430.0, 2.8e6, 40.0, 120.0, 1.6e6, 5.5e6, 5.5e6, 0.0, (0.0, -9.80665))
"""Masses of the three columns of the table, written down again."""

pytestmark = pytest.mark.slow


def law(name: str) -> Transmission:
    design = name.removeprefix("designs/").removesuffix(".yaml")
    return uniform_law(Lobes()) if name == "uniform crank" else law_of(loaded(design).design).train.whole


@cache
def powers(name: str, masses: RodMasses) -> tuple[float, float]:
    """Greatest driving and braking power in W of the driving shaft at 60 r/min."""
    found = felt(RigidMachine(Machine(law(name), BALER_LINKAGE, PRESS, 60.0 * RPM), masses), 0.05)
    return found["peak_power_w"], found["braking_power_w"]


def table() -> dict[str, list[str]]:
    """Cells of the table, by the names of its rows."""
    section = (ROOT / "docs" / "baler.md").read_text(encoding="utf-8").partition("## What the 66.4 %")[2]
    rows = [
        [cell.strip(" `") for cell in line.strip("|").split("|")] for line in section.splitlines() if line[:1] == "|"
    ]
    return {row[0]: row[1:4] for row in rows if row[0] in LAWS}


@pytest.mark.tiers(slow=["designs/baler-66.yaml", "designs/baler-smooth.yaml", "designs/baler-half.yaml"], rest="quick")
@pytest.mark.parametrize("name", LAWS)
def test_the_table_of_the_page_is_todays(name: str) -> None:
    printed = [tuple(float(re.sub(r"\s", "", one)) for one in cell.split("/")) for cell in table()[name]]
    computed = [tuple(float(round(one)) for one in powers(name, masses)) for masses in (NONE, PLUNGER, ALL)]
    # One unit of the last digit that is printed
    assert np.abs(np.array(printed) - np.array(computed)).max() <= 1.0


POINTS = 1 << 14
"""Even driving angles of a turn."""


def slope(values: Array) -> Array:
    """Derivative by the driving angle around a turn: five-point differences, exact to the fourth power of the step."""
    step = 2.0 * pi / POINTS
    near, far = (np.roll(values, -count) - np.roll(values, count) for count in (1, 2))
    return np.asarray((8.0 * near - far) / (12.0 * step))


def power_w(name: str, crank_kg_mm2: float) -> Array:
    """Vector loop, kinetic energy, weights and the pressing force's work of all masses, written anew."""
    turned = law(name).driven_angle(np.arange(POINTS) * 2.0 * pi / POINTS, 0).value
    pin = -380.0 * np.exp(-1j * turned)
    rod = np.sqrt(1.0 - (pin.imag / 960.0) ** 2) - 1j * pin.imag / 960.0
    wrist = pin + 960.0 * rod
    around = np.unwrap(np.angle(np.exp(1j * turned)))
    turning = slope(around - np.arange(POINTS) * 2.0 * pi / POINTS) + 1.0
    places = [(150.0, wrist), (30.0, pin + 430.0 * rod), (40.0, 120.0 / 380.0 * pin)]
    speed = 60.0 * RPM
    energy = 150.0 * slope(wrist.real) ** 2 + 30.0 * np.abs(slope(places[1][1])) ** 2
    energy = energy + 2.8e6 * np.abs(slope(rod)) ** 2 + crank_kg_mm2 * turning**2
    energy = 0.5e-3 * speed**2 * energy + sum(mass * 9.80665 * place.imag for mass, place in places)
    slid = wrist.real - wrist.real.min()
    rising = slope(wrist.real)
    pressing = np.where(rising > 0.0, np.maximum(np.polyval(FIT[::-1], slid), 0.0), 0.0)
    return np.asarray((slope(energy) + pressing * rising) * speed / 1e3)


@pytest.mark.parametrize("name", LAWS)
def test_the_powers_are_rates_of_energy(name: str) -> None:
    power = power_w(name, 1.6e6 + 5.5e6)
    driving, braking = powers(name, ALL)
    # At a corner of the load, a peak is missed by the distance of two samples, 4e-4 rad, times a jump of the slope
    assert driving == pytest.approx(power.max(), rel=1e-4)
    assert braking == pytest.approx(-power.min(), rel=1e-4)
    # Another mass of the plunger would be seen
    assert driving != pytest.approx(powers(name, PLUNGER)[0], rel=1e-3)


def test_what_the_page_says_of_the_laws() -> None:
    crank, saving, real = (powers(name, ALL) for name in (LAWS[0], LAWS[1], LAWS[-1]))
    assert saving[0] / crank[0] == pytest.approx(1.384, abs=5e-4)
    assert real[0] / crank[0] == pytest.approx(1.0 - 0.578, abs=5e-4)
    assert powers(LAWS[1], PLUNGER)[0] / powers(LAWS[0], PLUNGER)[0] == pytest.approx(1.0 - 0.043, abs=5e-4)
    assert powers(LAWS[1], NONE)[0] / powers(LAWS[0], NONE)[0] == pytest.approx(1.0 - 0.758, abs=5e-4)
    assert real[1] < 0.5 * crank[1]


def test_a_flywheel_beside_the_crank_stores_what_the_plunger_gives_back() -> None:
    """Powers of the design as its file gives them, of which its driven gear has 0.003 kg m2."""
    check = drive("baler-flywheel").check
    power = power_w("baler-flywheel", 150e6 + 1.6e6 + 3e3)
    assert check.peak_power_w.value == pytest.approx(power.max(), rel=1e-4)
    assert power.min() > 0.0
    assert check.with_masses is not None
    assert check.with_masses.braking_power_w.value == 0.0
    # Without the flywheel the same law asks for a brake.
    assert power_w("baler-flywheel", 1.6e6).min() < -2000.0


def test_what_the_page_says_of_the_flywheel_beside_the_crank() -> None:
    crank, check = powers(LAWS[0], ALL)[0], drive("baler-flywheel").check
    said = (ROOT / "docs" / "baler.md").read_text(encoding="utf-8").partition("## A flywheel beside the crank")[2]
    said = " ".join(said.split())
    assert f"{check.peak_power_w.value:.0f}".replace("3", "3 ", 1) in said
    assert f"{100.0 * (1.0 - check.peak_power_w.value / crank):.0f} % less" in said


@pytest.mark.slow
def test_no_law_with_that_flywheel_needs_much_less() -> None:
    """The law is the best found, and the limit is over the mean power, below which no law goes at all."""
    best = BestLaw(loaded("baler-flywheel").design)
    assert best.limit is not None
    assert best.figures.peak_power_w == pytest.approx(drive("baler-flywheel").check.peak_power_w.value, rel=1e-4)
    mean_w = best.task.work_n_mm / best.task.cycle_s / 1000.0
    assert mean_w - 1e-6 <= best.limit.value <= best.figures.peak_power_w <= 1.005 * mean_w
