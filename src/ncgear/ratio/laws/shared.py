"""A law shared out evenly: pairs in series that together make a given law, with one lobe of each gear.

With F(phi1) the driven angle of the whole and n pairs, shaft k, the k-th after the driving shaft, turns by

    S_k = c_k integral of (dF/dphi1)^(k/n),   c_k such that the shaft comes round with the crank.

So at each instant ln i12 of every pair is the n-th part of the whole's, but for a constant.  S_0 = phi1 and S_n = F;
pair k turns shaft k + 1 by shaft k, with the law S_k+1 of the inverse of S_k.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.numerics.rising import Rising
from ncgear.ratio.laws.integrated import smooth_or_refused
from ncgear.ratio.transmission import Lobes, Pair, PairsInSeries, Piece, Transmission, on_driving_shaft


@dataclass(frozen=True, eq=False)
class SharedShaft:
    """A shaft that turns with the whole law's speed to the power ``share``, times ``factor``, and so by ``angle``."""

    share: float
    factor: float
    angle: Rising

    def rate(self, slope: Jet) -> Jet:
        """The shaft's speed over the driving shaft's, from the whole law's."""
        return slope**self.share * self.factor


def shared_angle(before: SharedShaft, after: SharedShaft, piece: Piece, angle_rad: Array, order: int) -> Jet:
    """The angle of the shaft ``after`` in rad by that of the shaft ``before``, on a piece of the whole law."""
    phi1 = np.clip(before.angle.inverse(angle_rad), piece.start_rad, piece.end_rad)
    values = after.angle(phi1)
    if not order:
        return Jet(values[None, :])
    slope = piece.slope(phi1, order - 1)
    pace = before.rate(slope)
    return jet.by_other(values, after.rate(slope) / pace, 1.0 / pace)


def shared_out(whole: Transmission, count: int) -> PairsInSeries:
    """The law of a whole, one lobe of each gear, shared out evenly over ``count`` pairs in series."""

    def speed_to(share: float) -> SharedShaft:
        with smooth_or_refused("motion"):
            power = chebyshev.fitted(lambda phi1: whole.driven_angle(phi1, 1).derivative(1) ** share, whole.joints_rad)
        turned = power.integrated()
        factor = 2.0 * pi / turned.final
        return SharedShaft(share, factor, Rising(PiecewiseChebyshev(turned.breaks, turned.coefficients * factor)))

    shafts = [speed_to(number / count) for number in range(count + 1)]
    laws = [Transmission(tuple(_shared(one, *both) for one in whole.pieces), Lobes()) for both in pairwise(shafts)]
    driven = [behind(law, shaft.angle) for law, shaft in zip(laws[1:], shafts[1:-1], strict=True)]
    return PairsInSeries(whole, (on_driving_shaft(laws[0]), *driven))


def _shared(piece: Piece, before: SharedShaft, after: SharedShaft) -> Piece:
    """A pair's piece for a piece of the whole law."""
    start, *knots, end = before.angle(np.array([piece.start_rad, *piece.knots_rad, piece.end_rad])).tolist()
    return Piece(start, end, partial(shared_angle, before, after, piece), tuple(knots))


def behind(law: Transmission, angle: Rising) -> Pair:
    """A pair whose driving gear turns by ``angle``, in rad over a period of the driving shaft, while that turns."""
    rate, rise = angle.form.differentiated(), law.lobes.driving_period_rad

    def place(angle_rad: Array) -> tuple[Array, Array]:
        periods, within = np.divmod(angle_rad, rise)
        return periods, angle.inverse(within)

    def shaft_rad(angle_rad: Array) -> Array:
        periods, phi1 = place(angle_rad)
        return phi1 + periods * angle.end

    return Pair(law, lambda angle_rad: rate(place(angle_rad)[1]), shaft_rad)
