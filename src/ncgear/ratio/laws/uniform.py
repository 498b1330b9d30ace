"""The uniform crank: circular gears, with which every design is compared."""

from __future__ import annotations

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Lobes, Piece, Transmission


def uniform_law(lobes: Lobes) -> Transmission:
    """The law of the constant ratio i12 = n2 / n1, or that of both ranges of gears that turn less than once."""

    def driven_angle(phi1: Array, order: int) -> Jet:
        return Jet.variable(phi1, order) * lobes.even_slope

    return Transmission((Piece(0.0, lobes.driving_period_rad, driven_angle),), lobes)
