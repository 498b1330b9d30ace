"""Where the crank, the rod and the slider are, with derivatives.

Frame and pose as in ``machine.linkage``: the crank axis at the origin, the slider along +x at y = offset, the crank
turning clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, pi

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics import jet
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector


@dataclass(frozen=True, eq=False)
class Bodies:
    """The linkage at n crank angles; places in mm and angles in rad are jets by whatever the crank angle's is.

    ``pin`` and ``wrist`` are the ends of the rod on the crank and on the slider, ``rod_angle`` is counted from +x
    counter-clockwise, ``crank_angle`` as in ``machine.linkage``.
    """

    linkage: CrankSlider
    crank_angle: Jet
    pin: Vector
    wrist: Vector
    rod_angle: Jet

    def on_crank(self, distance_mm: float) -> Vector:
        """A point of the crank, so far from its axis towards the pin; beyond the axis where negative."""
        return self.pin * (distance_mm / self.linkage.crank_mm)

    def on_rod(self, distance_mm: float) -> Vector:
        """A point of the rod, so far from the crank pin towards the slider."""
        return self.pin + (self.wrist - self.pin) * (distance_mm / self.linkage.rod_mm)


def bodies(linkage: CrankSlider, crank_angle: Jet) -> Bodies:
    """All bodies at crank angles in rad, with as many derivatives."""
    tilt = asin(linkage.offset_mm / (linkage.rod_mm - linkage.crank_mm))
    sine, cosine = jet.sin_cos(pi + tilt - crank_angle)
    pin = Vector(linkage.crank_mm * cosine, linkage.crank_mm * sine)
    wrist = Vector(linkage.displacement(crank_angle) + linkage.nearest_mm, 0.0 * crank_angle + linkage.offset_mm)
    rod = wrist - pin
    # The rod never stands across the slider's line: it is longer than the crank and the offset together.
    return Bodies(linkage, crank_angle, pin, wrist, jet.arctan(rod.y / rod.x))
