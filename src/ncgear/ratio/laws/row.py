"""The laws of pairs that share a law: in series, each with a part of it, or in a row of gears on fixed axes.

In series: with F(phi1) the driven angle of the whole and p_k the part of the first k pairs, shaft k, the k-th after the
driving shaft, turns by

    S_k = c_k integral of (dF/dphi1)^p_k,   c_k such that the shaft comes round with the crank.

So at each instant ln i12 of every pair is its part of the whole's, but for a constant.  S_0 = phi1 and S_n = F; pair k
turns shaft k + 1 by shaft k, with the law S_k+1 of the inverse of S_k.

In a row each gear meshes with the next, so an idler meshes with two mates.  Gear 0 drives; gear k turns by theta_k, in
the sense of the driving gear where k is even.  The law of the first mesh is given, and gives the curve of gear 1.  A
place of an idler that faces the axis before it faces the next axis after the idler has turned by beta = pi + bend or pi
- bend, where bend is the turn of the line of centres at the idler.  So the curve of gear 1, later by beta, is the curve
of the driving gear of the second mesh; the mate's curve and the centre distance at which it closes follow, and so on
along the row.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev, Rising
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.closed_curve import ClosedCurve, SmoothPart
from ncgear.ratio.laws.integrated import smooth_or_refused
from ncgear.ratio.laws.pitch_curve import GivenCurve, closed_law
from ncgear.ratio.transmission import Lobes, Pair, PairsInSeries, Piece, Transmission, on_driving_shaft, turned_after


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


def shared_out(whole: Transmission, parts: Sequence[float]) -> PairsInSeries:
    """The law of a whole, one lobe of each gear, shared out over pairs in series, in proportion to ``parts`` > 0."""

    def speed_to(share: float) -> SharedShaft:
        with smooth_or_refused("motion"):
            power = chebyshev.fitted(lambda phi1: whole.driven_angle(phi1, 1).derivative(1) ** share, whole.joints_rad)
        turned = power.integrated()
        factor = 2.0 * pi / turned.final
        return SharedShaft(share, factor, Rising(PiecewiseChebyshev(turned.breaks, turned.coefficients * factor)))

    shafts = [speed_to(sum(parts[:number]) / sum(parts)) for number in range(len(parts) + 1)]
    laws = [Transmission(tuple(_shared(piece, *both) for piece in whole.pieces), Lobes()) for both in pairwise(shafts)]
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


def beta_rad(directions_rad: Sequence[float], number: int) -> float:
    """beta of the idler ``number``, from 1 on, in a row whose lines of centres have these directions."""
    bend = directions_rad[number] - directions_rad[number - 1]
    return (pi + (bend if number % 2 == 0 else -bend)) % (2.0 * pi)


def row_laws(
    first: Transmission, lobes: Sequence[int], directions_rad: Sequence[float], key: str
) -> tuple[Transmission, ...]:
    """The laws of all meshes, from that of the first, the lobes of all gears and the directions of lines of centres.

    Raises NoSuchMechanism, with ``key``, where a mate does not close.
    """
    laws = [first]
    for number in range(1, len(lobes) - 1):
        given = GivenCurve(
            lambda _, before=laws[-1]: _driven_curve(before),  # type: ignore[misc]
            None,
            drawn=False,
            driven=False,
            phase_rad=beta_rad(directions_rad, number),
            key=key,
        )
        laws.append(closed_law(given, Lobes(lobes[number], lobes[number + 1]), None).transmission)
    return tuple(laws)


def _driven_curve(law: Transmission) -> ClosedCurve:
    """The driven gear's curve over a turn, at distance 1, by its turn at which a place faces the driving gear."""

    def part(piece: Piece, lobe: int) -> SmoothPart:
        def polar(phi: Array, order: int) -> tuple[Jet, Jet]:
            whole = piece.driven_angle(phi, order + 1)
            radius = 1.0 / (whole.differentiated() + 1.0)
            return whole.truncated(order) + lobe * law.lobes.driven_period_rad, radius

        return SmoothPart(piece.start_rad, piece.end_rad, polar, piece.knots_rad)

    return ClosedCurve(tuple(part(piece, lobe) for lobe in range(law.lobes.driven) for piece in law.pieces))


def row_angle(laws: Sequence[Transmission], phi1: Array, order: int) -> Jet:
    """The angle of the last gear of pairs with these laws, one after the other, by that of the driving gear, in rad."""
    return turned_after(laws, phi1, order)[-1]


def laws_in_series(laws: Sequence[Transmission]) -> PairsInSeries:
    """Pairs in series with these laws, each by the angle of its own driving gear.

    In a row an idler is both the driven gear of a pair and the driving gear of the next.
    """
    first, last = laws[0].lobes, laws[-1].lobes
    pairs, breaks = [on_driving_shaft(laws[0])], laws[0].joints_rad
    for number, law in enumerate(laws[1:], start=1):
        with smooth_or_refused("motion"):
            turned = Rising(chebyshev.fitted(lambda phi1, n=number: row_angle(laws[:n], phi1, 0).value, breaks))  # type: ignore[misc]
        pairs.append(behind(law, turned))
        breaks = np.union1d(breaks, turned.inverse(law.joints_rad[1:-1]))
    start, *knots, end = breaks.tolist()
    whole = Piece(start, end, partial(row_angle, laws), tuple(knots))
    return PairsInSeries(Transmission((whole,), Lobes(first.driving, last.driven)), tuple(pairs))
