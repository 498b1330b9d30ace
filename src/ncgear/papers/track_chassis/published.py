"""What the paper gives of its crank-slider and of its chassis."""

from __future__ import annotations

from functools import cache
from math import radians

from ncgear.balance.frame import Chassis, DynamicCounterweights, dynamic_counterweights
from ncgear.balance.mechanism import DrivenCrank
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.masses import RodMasses
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

LINKAGE = CrankSlider(265.0, 560.0)
SLIDER_KG = 65.0
SPEED_RAD_S = 96.5 * RAD_S_PER_RPM
ROD_ARM_MM, CRANK_ARM_MM = 200.0, 250.0
CHASSIS = Chassis(support_mm=370.0, counterweight_mm=1000.0, tilt_rad=radians(8.0))
WEIGHT_KG, WEIGHT_LEVER_MM = 500.0, 470.0
NATURAL_HZ = (4.62, 17.26, 29.82, 63.85, 83.73, 141.58)

MECHANISM = DrivenCrank(LINKAGE, uniform_law(Lobes()), SPEED_RAD_S, RodMasses(slider_kg=SLIDER_KG))
"""Massless rod and crank: the paper lumps what it weighed at the slider."""


@cache
def tail_weights() -> DynamicCounterweights:
    """Weights against the slider's inertia, at both dead centres and the largest over the turn."""
    return dynamic_counterweights(CHASSIS, MECHANISM)
