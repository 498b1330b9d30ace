"""Units by the size of what is read: peaks from about 1 to 9999, of small machines and large ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import drives
import reports
from ncgear import plots
from ncgear.drawings.charts.chart import Chart, Line, Role
from ncgear.drawings.charts.drawer import LOAD_LOOK, TIME_LOOK, draw
from ncgear.drawings.charts.simulation_charts import simulated_chart
from ncgear.figures.numbers import THOUSANDS, readable
from ncgear.project.drive import Drive


@pytest.mark.parametrize(
    ("unit", "value", "factor", "name"),
    [
        ("W", 8.7, 1.0, "W"),
        ("W", 999.9, 1.0, "W"),
        ("W", 1000.0, 1e-3, "kW"),
        ("N", -27_350.0, 1e-3, "kN"),
        ("mm/s", 313.0, 1.0, "mm/s"),
        ("mm/s\u00b2", 1197.7, 1e-3, "m/s\u00b2"),
        ("mm", 5000.0, 1.0, "mm"),
        ("W", 0.0, 1.0, "W"),
    ],
)
def test_the_unit_goes_by_the_size(unit: str, value: float, factor: float, name: str) -> None:
    assert readable(unit, value) == (factor, name)


def test_the_largest_of_all_values_decides() -> None:
    assert readable("N", np.array([1.0, -1500.0]), 3.0) == (1e-3, "kN")


@pytest.mark.parametrize("unit", THOUSANDS)
@pytest.mark.parametrize("value", [1.0, 999.0, 1001.0, 9.99e6])
def test_peaks_read_between_one_and_ten_thousand(unit: str, value: float) -> None:
    assert 1.0 <= readable(unit, value)[0] * value < 1e4


Draw = Callable[[Drive, Axes], Axes]

DRAWN: dict[str, tuple[Draw, str, str, str]] = {
    "velocity": (plots.velocity, "velocity", "mm/s", "m/s"),
    "acceleration": (plots.acceleration, "acceleration", "m/s\u00b2", "m/s\u00b2"),
    "force": (plots.force, "force", "N", "kN"),
    "power": (plots.power, "driving power", "W", "kW"),
}
"""What is drawn, its name, and the units of the pusher, of 8.7 W, and of the baler, of 19 kW."""


@pytest.mark.parametrize("name", DRAWN)
def test_plots_have_the_unit_of_their_machine(name: str) -> None:
    draw, words, small, large = DRAWN[name]
    assert draw(drives.drive("pusher"), Figure().subplots()).get_ylabel() == f"{words} in {small}"
    assert draw(drives.drive("baler"), Figure().subplots()).get_ylabel() == f"{words} in {large}"


def test_the_drawn_values_are_in_the_unit_told() -> None:
    for name, factor in (("pusher", 1.0), ("baler", 1e-3)):
        drive = drives.drive(name)
        peak = max(plots.power(drive, Figure().subplots()).lines[0].get_ydata())
        assert peak == pytest.approx(factor * drive.check.peak_power_w.value, rel=1e-4)


def test_a_second_machine_on_the_same_axes_has_the_unit_of_the_first() -> None:
    axes = plots.power(drives.drive("baler"), Figure().subplots())
    lines = len(axes.lines)
    plots.power(drives.drive("pusher"), axes)
    assert axes.get_ylabel() == "driving power in kW"
    assert max(axes.lines[lines].get_ydata()) == pytest.approx(8.7023e-3, rel=1e-4)


def test_the_report_of_a_small_machine_is_in_watts() -> None:
    velocity, acceleration, force, power = (one.chart for one in reports.motion("pusher")[1:5])
    assert [chart.unit for chart in (velocity, acceleration, force, power)] == ["mm/s", "m/s\u00b2", "N", "W"]
    assert float(power.lines[0].values.max()) == pytest.approx(8.7023, rel=1e-4)


PHI1 = np.linspace(0.0, 2.0 * np.pi, 5)
SIZES = pytest.mark.parametrize(("most", "unit", "drawn"), [(900.0, "N", 900.0), (2.0e4, "kN", 20.0)])


def force_chart(name: str, most: float) -> Chart:
    """A force of this design and the same one to compare it with."""
    values = most * np.sin(PHI1)
    return simulated_chart(name, "N", PHI1, ("this design", values), ("other", values))


@SIZES
def test_simulated_forces_have_the_unit_of_their_size(most: float, unit: str, drawn: float) -> None:
    axes = Figure().subplots()
    draw(axes, force_chart("tooth force", most), TIME_LOOK)
    assert axes.get_ylabel() == f"tooth force\nin {unit}"
    assert [max(line.get_ydata()) for line in axes.lines[:2]] == pytest.approx([drawn, drawn])


@SIZES
def test_loads_have_the_unit_of_their_size(most: float, unit: str, drawn: float) -> None:
    axes, chart = Figure().subplots(), force_chart("guide", most)
    mean = Line(Role.MEAN, "mean", np.array([0.0, 360.0]), np.full(2, most / 2.0))
    draw(axes, replace(chart, lines=(*chart.lines, mean)), LOAD_LOOK)
    assert axes.get_ylabel() == f"guide\nin {unit}"
    assert [max(line.get_ydata()) for line in axes.lines[:3]] == pytest.approx([drawn, drawn, drawn / 2.0])
