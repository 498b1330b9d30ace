"""Where the crank, the rod and the slider are, with derivatives by the crank angle.

Frame and pose as in ``machine.linkage``: the crank axis at the origin, the slider along +x at y = offset, the crank
turning clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, pi

import numpy as np

from ncgear.machine.linkage import CrankSlider
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True, eq=False)
class Place:
    """A point in the plane, in mm, each coordinate with derivatives."""

    x: Jet
    y: Jet

    @property
    def value(self) -> Array:
        """The points themselves, shape (n, 2)."""
        return np.column_stack([self.x.value, self.y.value])

    def towards(self, other: Place, share: float) -> Place:
        """The point at a share of the way to another one."""
        return Place(self.x + share * (other.x - self.x), self.y + share * (other.y - self.y))


@dataclass(frozen=True, eq=False)
class Bodies:
    """The linkage at n crank angles, all with derivatives by the crank angle.

    ``pin`` and ``wrist`` are the ends of the rod on the crank and on the slider, ``rod_angle`` is in rad from +x
    counter-clockwise.
    """

    linkage: CrankSlider
    pin: Place
    wrist: Place
    rod_angle: Jet

    def on_crank(self, distance_mm: float) -> Place:
        """A point of the crank, so far from its axis towards the pin; beyond the axis where negative."""
        share = distance_mm / self.linkage.crank_mm
        return Place(share * self.pin.x, share * self.pin.y)

    def on_rod(self, distance_mm: float) -> Place:
        """A point of the rod, so far from the crank pin towards the slider."""
        return self.pin.towards(self.wrist, distance_mm / self.linkage.rod_mm)


def bodies(linkage: CrankSlider, crank_angle_rad: Array, order: int = 2) -> Bodies:
    """All bodies at crank angles in rad, shape (n,), with so many derivatives."""
    angle = Jet.variable(crank_angle_rad, order)
    tilt = asin(linkage.offset_mm / (linkage.rod_mm - linkage.crank_mm))
    sine, cosine = jet.sin_cos(pi + tilt - angle)
    pin = Place(linkage.crank_mm * cosine, linkage.crank_mm * sine)
    wrist = Place(linkage.displacement(angle) + linkage.nearest_mm, 0.0 * angle + linkage.offset_mm)
    across, along = wrist.y - pin.y, wrist.x - pin.x
    return Bodies(linkage, pin, wrist, jet.arctan(across / along))
