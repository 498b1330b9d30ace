"""A law shared out evenly: pairs in series that together make a given law, with one lobe of each gear.

With F(phi1) the driven angle of the whole and n pairs, shaft k, the k-th after the driving shaft, turns by

    S_k = c_k integral of (dF/dphi1)^(k/n),   c_k such that the shaft comes round with the crank.

So at each instant ln i12 of every pair is the n-th part of the whole's, but for a constant.  S_0 = phi1 and S_n = F;
pair k turns shaft k + 1 by shaft k, with the law S_k+1 of the inverse of S_k.
"""

from __future__ import annotations

from functools import cached_property, partial
from itertools import pairwise
from math import pi

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.integrated import smooth_or_refused
from ncgear.ratio.transmission import Lobes, Pair, Piece, Train, Transmission, on_driving_shaft

GUESSES = 16
"""Places in each panel of a shaft's angle from which Newton's method begins: nearer than a panel's details."""

NEWTON_STEPS = 20
"""Most steps to an inverse; convergence is quadratic."""

ROUNDING_RAD = 4e-15
"""Last step in rad that counts as rounding."""


@dataclass(frozen=True, eq=False)
class Shaft:
    """A shaft that turns with the whole law's speed to the power ``share``, times ``factor``.

    ``turned`` is the integral of that power over a turn of the driving shaft.
    """

    share: float
    turned: PiecewiseChebyshev

    @property
    def factor(self) -> float:
        """The constant that closes the turn."""
        return 2.0 * pi / self.turned.final

    def angle(self, phi1: Array) -> Array:
        """The shaft's angle in rad at driving angles of one turn in rad, shape (n,)."""
        return self.factor * self.turned(phi1)

    def rate(self, slope: Jet) -> Jet:
        """The shaft's speed over the driving shaft's, from the whole law's."""
        return slope**self.share * self.factor

    @cached_property
    def _guesses(self) -> tuple[Array, Array, PiecewiseChebyshev]:
        breaks = self.turned.breaks
        share = np.arange(GUESSES) / GUESSES
        phi1 = np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * share).ravel(), breaks[-1])
        return phi1, self.angle(phi1), self.turned.differentiated()

    def driving_rad(self, angle_rad: Array) -> Array:
        """Driving angles of one turn in rad at the shaft's angles of one turn in rad, shape (n,)."""
        places, angles, rate = self._guesses
        phi1 = np.interp(angle_rad, angles, places)
        for _ in range(NEWTON_STEPS):
            step = (self.angle(phi1) - angle_rad) / (self.factor * rate(phi1))
            phi1 = np.clip(phi1 - step, 0.0, 2.0 * pi)
            if np.max(np.abs(step), initial=0.0) <= ROUNDING_RAD:
                return phi1
        raise Unanswered("the angle of a shaft between two pairs could not be inverted")


def shared_angle(before: Shaft, after: Shaft, piece: Piece, angle_rad: Array, order: int) -> Jet:
    """The angle of the shaft ``after`` in rad by that of the shaft ``before``, on a piece of the whole law."""
    phi1 = np.clip(before.driving_rad(angle_rad), piece.start_rad, piece.end_rad)
    values = after.angle(phi1)
    if not order:
        return Jet(values[None, :])
    slope = piece.slope(phi1, order - 1)
    pace = before.rate(slope)
    return jet.by_other(values, after.rate(slope) / pace, 1.0 / pace)


def shared_out(whole: Transmission, count: int) -> Train:
    """The law of a whole, one lobe of each gear, shared out evenly over ``count`` pairs in series."""

    def speed_to(share: float) -> Shaft:
        with smooth_or_refused("motion"):
            power = chebyshev.fitted(lambda phi1: whole.driven_angle(phi1, 1).derivative(1) ** share, whole.joints_rad)
        return Shaft(share, power.integrated())

    shafts = [speed_to(number / count) for number in range(count + 1)]
    laws = [Transmission(tuple(_shared(one, *both) for one in whole.pieces), Lobes()) for both in pairwise(shafts)]
    driven = [Pair(law, *_turning(whole, shaft)) for law, shaft in zip(laws[1:], shafts[1:-1], strict=True)]
    return Train(whole, (on_driving_shaft(laws[0]), *driven))


def _shared(piece: Piece, before: Shaft, after: Shaft) -> Piece:
    """A pair's piece for a piece of the whole law."""
    start, *knots, end = before.angle(np.array([piece.start_rad, *piece.knots_rad, piece.end_rad])).tolist()
    return Piece(start, end, partial(shared_angle, before, after, piece), tuple(knots))


def _turning(whole: Transmission, shaft: Shaft) -> tuple[partial[Array], partial[Array]]:
    return partial(_speed, whole, shaft), partial(_driving_rad, shaft)


def _driving_rad(shaft: Shaft, angle_rad: Array) -> Array:
    """Driving angles in rad at a shaft's angles in rad, in any turn."""
    within = np.mod(angle_rad, 2.0 * pi)
    return shaft.driving_rad(within) + (angle_rad - within)


def _speed(whole: Transmission, shaft: Shaft, angle_rad: Array) -> Array:
    """A shaft's speed over the driving shaft's, at its own angles in rad."""
    return shaft.rate(whole.driven_angle(_driving_rad(shaft, angle_rad), 1).differentiated()).value
