"""The published baler's linkage and resistance, and what best laws are looked for on them."""

from __future__ import annotations

from math import pi

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.task import Limits, Task

RPM = pi / 30.0
BALER_LINKAGE = CrankSlider(380.0, 960.0)
OFFSET = CrankSlider(380.0, 960.0, 100.0)
FIT = (-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7)
PRESS = SliderLoad(PolynomialResistance(FIT))
AT_SIXTY = Task(BALER_LINKAGE, PRESS, 60.0 * RPM)
USUAL = Limits(0.2, 5.0)
