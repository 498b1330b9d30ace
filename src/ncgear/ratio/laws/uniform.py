"""The uniform crank: circular gears, with which every design is compared."""

from __future__ import annotations

from functools import partial

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Lobes, Piece, Transmission


def uniform_law(lobes: Lobes) -> Transmission:
    """The law of the constant ratio i12 = n2 / n1; for gears that turn less than once, the ratio of both ranges."""

    return Transmission((Piece(0.0, lobes.driving_period_rad, partial(even_angle, lobes.even_slope)),), lobes)


def even_angle(even_slope: float, phi1: Array, order: int) -> Jet:
    """phi2 in rad of a constant dphi2/dphi1, with derivatives."""
    return Jet.variable(phi1, order) * even_slope
