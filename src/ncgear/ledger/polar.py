"""Readings and weights as complex numbers: amplitude times exp(i phase), phases in degrees."""

from __future__ import annotations

from cmath import phase, rect
from math import degrees, radians


def polar(amplitude: float, phase_deg: float) -> complex:
    """The complex number."""
    return rect(amplitude, radians(phase_deg))


def phase_deg(number: complex) -> float:
    """Its phase in [0, 360)."""
    return degrees(phase(number)) % 360.0
