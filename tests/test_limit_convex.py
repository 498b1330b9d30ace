"""The certified limit against the convex programme in q(phi2), written another way."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from ncgear.mechanisms.resistance import PolynomialResistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import least_acceleration
from ncgear.optimum.task import Task
from oracles import convex_limit
from published import BALER_LINKAGE, PRESS, RPM

PLACES = 321


@pytest.mark.tiers(slow=["60.0-12000.0-ratios2-load2"], rest="long")
@pytest.mark.parametrize(
    ("rpm", "power_w", "ratios", "load"),
    [
        (60.0, 9000.0, (0.2, 5.0), PRESS),
        (52.80854482726039, 6300.0, (0.2, 5.0), PRESS),
        (60.0, 12000.0, (0.5, 2.4), PRESS),
        (30.0, 1000.0, (0.3, 3.0), SliderLoad(PolynomialResistance((500.0,)))),
        (
            30.0,
            3000.0,
            (0.3, 3.0),
            SliderLoad(TableResistance((0.0, 300.0, 500.0, 760.0), (0.0, 100.0, 4000.0, 6000.0))),
        ),
    ],
)
def test_the_convex_programme_gives_the_same(
    rpm: float, power_w: float, ratios: tuple[float, float], load: SliderLoad
) -> None:
    """Its grid of 320 has chords where motions peak, and ours knows the roof alone between places: 0.6 % in all."""
    angle = np.linspace(0.0, 2.0 * pi, PLACES)
    position = convex_limit.displacement(380.0, 960.0, angle)
    force = np.where(angle <= pi, load.working.force_n(position), 0.0)
    convex = convex_limit.least_acceleration(380.0, 960.0, force, power_w, rpm * RPM, ratios)
    task = Task(BALER_LINKAGE, load, rpm * RPM)
    found = least_acceleration(task, Demands(*ratios, power_w=power_w))
    assert found.value == pytest.approx(convex, rel=6e-3)
