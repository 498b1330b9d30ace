"""Six machines that are no balers, with what is asked of their best laws: judges of limit and search share them.

Rods from two to eight cranks, offsets to both sides, every kind of resistance, speeds from 20 to 300 r/min.  The capped
figure of each is well under what its best law takes without the cap, so that it binds.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Limits, Task

RPM = pi / 30.0


@dataclass(frozen=True)
class Asked:
    """A machine and what is asked of its law."""

    task: Task
    wishes: Wishes


def _task(linkage: CrankSlider, load: SliderLoad, rpm: float) -> Task:
    return Task(linkage, load, rpm * RPM)


CONSTANT = SliderLoad(PolynomialResistance((2000.0,)))
SPRING = SliderLoad(PolynomialResistance((100.0, 12.0)))
BLANKING = SliderLoad(TableResistance((0.0, 180.0, 200.0, 260.0, 290.0, 310.0), (0.0, 0.0, 4e3, 6e3, 9e3, 9e3)))
BOTH_STROKES = SliderLoad(PolynomialResistance((800.0,)), PolynomialResistance((100.0, 1.0)), friction_n=150.0)
STIFF_SPRING = SliderLoad(PolynomialResistance((0.0, 0.0, 0.4)))
RISING = SliderLoad(TableResistance((0.0, 200.0, 400.0, 610.0), (500.0, 600.0, 2e3, 8e3)))

FOREIGN: dict[str, Asked] = {
    "rod 2.2, offset, constant force": Asked(
        _task(CrankSlider(100.0, 220.0, 30.0), CONSTANT, 120.0), Wishes(Limits(0.2, 5.0, peak_power_w=1_260.0))
    ),
    "rod 8, spring": Asked(
        _task(CrankSlider(40.0, 320.0), SPRING, 300.0), Wishes(Limits(0.2, 5.0, peak_power_w=360.0))
    ),
    "rod 4, offset the other way, table": Asked(
        _task(CrankSlider(150.0, 600.0, -60.0), BLANKING, 45.0), Wishes(Limits(0.2, 5.0, peak_power_w=1_200.0))
    ),
    "rod 5, both strokes with friction": Asked(
        _task(CrankSlider(200.0, 1000.0, 50.0), BOTH_STROKES, 90.0), Wishes(Limits(0.2, 5.0, peak_power_w=1_000.0))
    ),
    "rod 3, offset the other way, stiff spring, least power": Asked(
        _task(CrankSlider(60.0, 180.0, -15.0), STIFF_SPRING, 200.0),
        Wishes(Limits(0.2, 5.0, peak_acceleration_mm_s2=70_000.0), goal=Goal.POWER),
    ),
    "rod 6, table, least power, pressure angle": Asked(
        _task(CrankSlider(300.0, 1800.0), RISING, 20.0),
        Wishes(Limits(0.25, 4.0, peak_acceleration_mm_s2=5_000.0, pressure_angle_rad=radians(35.0)), goal=Goal.POWER),
    ),
}
