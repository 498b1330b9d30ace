"""Displacement of a pair of gears in a close housing, as in oval-gear flow meters and pumps.

The housing is a circle about each axis.  Liquid passes from one side to the other between each gear and its circle, and
none passes where the gears mesh.  With the greatest radii R1 and R2 and the pitch radii r1 and r2 at the pitch point, a
turn dphi1 of the driving gear displaces, per face width,

    dA = ((R1^2 - r1^2) dphi1 + (R2^2 - r2^2) dphi2) / 2

since a gear's side of the space between housing and pitch point sweeps (R^2 - r^2)/2 per angle (the same balance gives
the flow of circular gear pumps, e.g. J. Ivantysyn, M. Ivantysynova, "Hydrostatic Pumps and Motors", 2001, chapter 9).
With w = dphi2/dphi1, r1 = a w/(1 + w) and r2 = a/(1 + w) this is

    2 dA/dphi1 = R1^2 + R2^2 w - a^2 w/(1 + w)

The pitch point counts as the seal: real teeth move the seal along the line of action, which adds a ripple, and leaks
are not counted.  A tip of each gear must be at the housing between both ports all the time, as with two lobes or more.
"""

from __future__ import annotations

from math import pi

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import fitted
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Piece, Transmission


@dataclass(frozen=True)
class Pumped:
    """Displacement of a pair: ``per_turn_mm3`` in a turn of the driving gear, ``least`` and ``most`` in mm^3 per rad.

    ``least`` and ``most`` have the driving angles in rad at which they occur.
    """

    per_turn_mm3: float
    least: Extremum
    most: Extremum

    @property
    def pulsation(self) -> float:
        """Largest less smallest flow over the mean flow, at an even driving speed."""
        return (self.most.value - self.least.value) * 2.0 * pi / self.per_turn_mm3


def pumped(
    transmission: Transmission, center_distance_mm: float, radii_mm: tuple[float, float], face_width_mm: float
) -> Pumped:
    """Displacement of an external pair in a housing of the given radii about the driving and the driven axis."""
    first, second = radii_mm
    factor = 0.5 * face_width_mm

    def per_rad(slope: Jet) -> Jet:
        return factor * (slope * second**2 - center_distance_mm**2 * (slope / (slope + 1.0)) + first**2)

    def of(piece: Piece) -> float:
        def value(phi1: Array) -> Array:
            return per_rad(piece.slope(phi1, 0)).value

        return fitted(value, [piece.start_rad, *piece.knots_rad, piece.end_rad]).integrated().final

    periods = 2.0 * pi / transmission.lobes.driving_period_rad
    least, most = transmission.extremes(per_rad, 0)
    return Pumped(periods * sum(map(of, transmission.pieces)), least, most)
