"""Readings and weights as complex numbers: amplitude times exp(i phase), phases in degrees.

The stroke of a crank-slider by two terms of the rod's series, as two of the papers take it.
"""

from __future__ import annotations

from cmath import phase, rect
from math import degrees, radians

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


def polar(amplitude: float, phase_deg: float) -> complex:
    """The complex number."""
    return rect(amplitude, radians(phase_deg))


def phase_deg(number: complex) -> float:
    """Its phase in [0, 360)."""
    return degrees(phase(number)) % 360.0


def two_term_stroke(linkage: CrankSlider, angles_rad: Array, order: int) -> Jet:
    """r ((1 - cos t) + (r/l) (1 - cos 2t) / 4) in mm from the extended dead centre, with derivatives by the angle t."""
    angle = Jet.variable(angles_rad, order)
    ratio = linkage.crank_mm / linkage.rod_mm
    once, twice = (1.0 - jet.sin_cos(angle * turns)[1] for turns in (1.0, 2.0))
    return linkage.crank_mm * (once + (ratio / 4.0) * twice)
