"""The helix along which teeth advance from section to section.

A non-circular section cannot be twisted rigidly: its teeth would leave the pitch curve.  The section at height z is
instead the gear whose teeth stand farther along the pitch curve, by the rolled length z tan(beta) on both gears, so
that every pair of sections at one height is conjugate at the same driving and driven angles.  Module and pressure angle
are measured in the sections: they are transverse.
"""

from __future__ import annotations

from enum import StrEnum
from math import tan

from ncgear.frozen import dataclass


class Hand(StrEnum):
    """Hand of a helix: a right-hand one turns counter-clockwise as it rises, seen from above."""

    RIGHT = "right"
    LEFT = "left"


@dataclass(frozen=True)
class Helix:
    """Helix of a pair of gears of one face width.

    ``angle_rad`` (0 < beta < pi/2) is the helix angle at the pitch curve: tan(beta) is the advance along the curve per
    unit of height.  ``hand`` is the driving gear's hand; the driven gear of an external pair has the opposite hand.
    Herringbone teeth advance up to half the face width and go back from there, so both ends are alike; ``hand`` then
    describes the half next to z = 0.
    """

    angle_rad: float
    face_width_mm: float
    hand: Hand
    herringbone: bool = False

    @property
    def rise_mm(self) -> float:
        """Height up to which the teeth advance in one direction."""
        return self.face_width_mm / 2.0 if self.herringbone else self.face_width_mm

    @property
    def largest_advance_mm(self) -> float:
        """Largest rolled length between the teeth of two sections; divided by the pitch, it is the overlap ratio.

        Both halves of herringbone teeth hold each contact at the same time, so the overlap is the overlap of one half.
        """
        return self.rise_mm * tan(self.angle_rad)

    @property
    def thrust_share(self) -> float:
        """Axial force per tangential force at the pitch point; zero for herringbone teeth, whose halves cancel."""
        return 0.0 if self.herringbone else tan(self.angle_rad)

    @property
    def thrust_sense(self) -> float:
        """+1 where the thrust on a driven gear that is pushed points towards growing z, -1 where it points back."""
        return -1.0 if self.hand is Hand.RIGHT else 1.0

    def advance_mm(self, height_mm: float) -> float:
        """Advance of both gears' teeth, in the direction of growing arc length, at a height from 0 to the face width.

        Arc length runs clockwise on the driving gear, opposite to the rise of a right-hand helix.
        """
        rolled = min(height_mm, 2.0 * self.rise_mm - height_mm) if self.herringbone else height_mm
        return self.thrust_sense * rolled * tan(self.angle_rad)
