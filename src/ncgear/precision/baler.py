"""The published baler, on which studies measure: the reading of designs/baler.yaml.

J. Wang, C. Wang, L. Miao, "Design of a non-circular gear-crank slider baler mechanism considering slider
acceleration", Table 1, with the law speed solved for, a1 stated at 20 r/min, and e = 0.
"""

from __future__ import annotations

from functools import cache
from math import pi

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import StrokeRequest, WorkingStroke, solved_stroke

CONSTANT = 0.0
"""The return's e."""


@cache
def linkage() -> CrankSlider:
    """Crank and rod, in line."""
    return CrankSlider(380.0, 960.0)


@cache
def stroke() -> WorkingStroke:
    """The working stroke."""
    return solved_stroke(
        StrokeRequest(
            theta1_rad=0.4 * pi,
            theta2_rad=0.7 * pi,
            theta3_rad=pi,
            theta4_rad=1.3 * pi,
            v1_mm_s=1600.0,
            v2_mm_s=1100.0,
            a1_mm_s2=-1500.0,
            law_speed_rad_s=None,
            stroke_mm=linkage().stroke_mm,
            a1_speed_rad_s=2.0 * pi / 3.0,
        )
    )


@cache
def law() -> StrokeLaw:
    """The closed law."""
    return stroke_law(stroke(), linkage(), Lobes(), constant=CONSTANT)
