"""The pairs of gears on which teeth, contact and solids are measured: of the size of the baler's, 25 teeth of 3 mm."""

from __future__ import annotations

from functools import cache
from math import radians

from ncgear.design.keys.machine import Output
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.form import BasicRack, Cutter, CutterKind, ToothForm

TEETH = 25
MODULE_MM = 3.0
ECCENTRICITY = 0.3
"""Of the ellipse: its teeth are those of circular gears of 23 to 27 teeth, so that nothing is undercut."""

TOLERANCE_MM: float = Output.model_fields["chord_tolerance_mm"].default
"""What design files have where they say nothing."""


def rack(backlash_mm: float = 0.0) -> BasicRack:
    """ISO 53 profile A at the module (values from secondary sources)."""
    return BasicRack(MODULE_MM, radians(20.0), MODULE_MM, 1.25 * MODULE_MM, 0.38 * MODULE_MM, backlash_mm)


def form(backlash_mm: float = 0.0, *, equivalent: bool = False) -> ToothForm:
    """Cut by a rack, which leaves the fillets that closed forms are known of."""
    return ToothForm(rack(backlash_mm), cutter=Cutter(CutterKind.RACK), equivalent=equivalent)


@cache
def circular() -> PitchPair:
    """Two equal circular gears."""
    return sized_pair(uniform_law(Lobes()), TEETH, MODULE_MM, None)


@cache
def elliptical() -> PitchPair:
    """Two equal ellipses about their foci."""
    return sized_pair(elliptical_law(ECCENTRICITY, 0.0, Lobes()), TEETH, MODULE_MM, None)
