"""One unit for each quantity, in pictures, on the page and in texts, of small machines and of large ones."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import drives
import reports
from ncgear import plots
from ncgear.project.drive import Drive

Draw = Callable[[Drive, Axes], Axes]

DRAWN: dict[str, tuple[Draw, str]] = {
    "velocity": (plots.velocity, "velocity in mm/s"),
    "acceleration": (plots.acceleration, "acceleration in mm/s\u00b2"),
    "force": (plots.force, "force in N"),
    "power": (plots.power, "driving power in W"),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", DRAWN)
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
