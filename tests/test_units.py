"""One unit for each quantity, in pictures, on the page and in texts, of small machines and of large ones."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import drives
import reports
from at_once import at_once
from ncgear import plots
from ncgear.figures.advice.law_advice import rods
from ncgear.figures.advice.values import Advice
from ncgear.figures.numbers import placed
from ncgear.numerics.units import in_words
from ncgear.project.drive import Drive
from ncgear.project.passing import CRANK_PIN

Draw = Callable[[Drive, Axes], Axes]

DRAWN: dict[str, tuple[Draw, str]] = {
    "velocity": (plots.velocity, "velocity in mm/s"),
    "acceleration": (plots.acceleration, "acceleration in mm/s\u00b2"),
    "force": (plots.force, "force in N"),
    "power": (plots.power, "driving power in W"),
}


@pytest.mark.slow
@at_once("name", DRAWN)
def test_plots_of_small_and_large_machines_have_the_same_unit(name: str) -> None:
    """The pusher takes 8.7 W, the baler 19 kW."""
    draw, label = DRAWN[name]
    for machine in ("pusher", "baler"):
        assert draw(drives.drive(machine), Figure().subplots()).get_ylabel() == label


@pytest.mark.parametrize("name", ["pusher", "baler"])
def test_the_drawn_values_are_in_the_unit_told(name: str) -> None:
    drive = drives.drive(name)
    peak = max(plots.power(drive, Figure().subplots()).lines[0].get_ydata())
    assert peak == pytest.approx(drive.check.peak_power_w.value, rel=1e-4)


@pytest.mark.parametrize("name", ["pusher", "baler", "pump-1-2"])
def test_the_report_has_the_units_of_its_figures(name: str) -> None:
    velocity, acceleration, force, power = (one.chart for one in reports.motion(name)[1:5])
    assert [chart.unit for chart in (velocity, acceleration, force, power)] == ["mm/s", "mm/s\u00b2", "N", "W"]
    check = drives.drive(name).check
    assert float(power.lines[0].values.max()) == pytest.approx(check.peak_power_w.value, rel=1e-4)


# --- places, of which more digits are printed than are known


def test_a_place_that_is_not_resolved_beside_a_turn_is_zero() -> None:
    """The rocker is nearest to the driving shaft at its dead centre; a search finds that to 5e-7 rad."""
    linkage = {"kind": "crank_rocker", "crank_mm": 15, "coupler_mm": 60, "rocker_mm": 40, "ground_mm": 72.18}
    gears = {"teeth": 48, "module_mm": 1.5, "face_width_mm": 12, "driving": {"bore_mm": 10}, "driving_axis_deg": 0}
    motion = {"law": "harmonic_ratio", "cosine": [-0.2]}
    data = {"name": "a", "linkage": linkage, "operation": {"speed_rpm": 30}, "motion": motion, "gears": gears}
    made = Drive(drives.design_of(data))
    (met,) = (one for one in rods(made) if isinstance(one, Advice))
    (at,) = (degrees(one.phi1_rad) for one in made.passings if one.meets and one.part != CRANK_PIN)
    assert 0.0 < abs(at) < 1e-4
    assert met.what.endswith("at phi1 = 0 deg")
    assert "phi1 = 0 deg" in met.what


@at_once(("angle_deg", "text"), [(2.5e-5, "0"), (-2.5e-5, "0"), (0.01234, "0.01234"), (359.96, "360")])
def test_a_place_has_four_digits_where_they_are_known(angle_deg: float, text: str) -> None:
    assert placed(angle_deg) == text


def test_a_place_in_a_refusal_is_zero_as_well() -> None:
    assert in_words(1e-7) == in_words(-1e-7) == "0 rad (0 deg)"
    assert in_words(1e-4) == "0.0001 rad (0.00573 deg)"
