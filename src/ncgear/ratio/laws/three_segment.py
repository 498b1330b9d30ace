"""The published law: a three-segment working stroke, inverted by the mechanism, and a return that closes the cycle.

The inversion leads from the slider's displacement to the angle of the crank.  In the textbook form both dead centres
are zero divided by zero.  Here the double zeros of the displacement at phi1 = 0 and of the rest of the stroke at theta4
are divided out of the polynomials and of the mechanism's slope before anything is evaluated, so phi2 and all its
derivatives are regular up to and including both ends.
"""

from __future__ import annotations

from functools import partial
from math import degrees
from typing import Any, NamedTuple

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism, Mechanisms
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Number
from ncgear.numerics.jet import Jet
from ncgear.ratio.return_stroke import ReturnEnds, ReturnLaw, return_of_least_acceleration, return_with_constant
from ncgear.ratio.transmission import Lobes, Piece, Transmission
from ncgear.ratio.working_stroke import ClosedStroke, WorkingStrokes


def working_pieces(stroke: ClosedStroke, linkage: Mechanism) -> tuple[Piece, ...]:
    """The driven angle on the three segments (two, when the constant-speed part is empty)."""
    pieces = [
        Piece(0.0, stroke.theta2_rad, partial(approach_angle, stroke, linkage)),
        Piece(stroke.theta2_rad, stroke.theta3_rad, partial(pressing_angle, stroke, linkage)),
        Piece(stroke.theta3_rad, stroke.theta4_rad, partial(braking_angle, stroke, linkage)),
    ]
    return tuple(piece for piece in pieces if piece.end_rad > piece.start_rad)


class Advance(NamedTuple):
    """The displacement x in mm with derivatives, and (stroke - x), which is as accurate near its zero as x near its.

    ``root`` is the smooth root of x (stroke - x), ``rate`` the derivative of x over it, regular at both dead centres.
    """

    displacement: Jet
    remaining_mm: Array
    root: Jet
    rate: Jet

    def driven_slope(self, linkage: Mechanisms[Any]) -> Jet:
        """dphi2/dphi1, with derivatives."""
        return self.rate * linkage.regular_slope(self.displacement, self.root)

    def driven_angle(self, linkage: Mechanisms[Any], order: int) -> Jet:
        """phi2 in rad, with derivatives."""
        values = linkage.working_angle(self.displacement.value, self.remaining_mm)
        return self.driven_slope(linkage).truncated(order - 1).integrated(values) if order else Jet(values[None])


def approach(stroke: WorkingStrokes[Number], phi1: Array, order: int) -> Advance:
    """The advance on [0, theta2], of one stroke or of a stroke for each point."""
    angle = Jet.variable(phi1, order)
    quotient = jet.polynomial(stroke.approach_root, angle)
    displacement = angle * angle * quotient
    remaining = stroke.stroke_mm - displacement
    root = jet.sqrt(quotient * remaining)
    rate = jet.polynomial(stroke.approach_slope, angle) / root
    return Advance(displacement, remaining.value, angle * root, rate)


def pressing(stroke: WorkingStrokes[Number], phi1: Array, order: int) -> Advance:
    """The advance on [theta2, theta3], of one stroke or of a stroke for each point."""
    displacement = stroke.pressing_mm_rad * Jet.variable(phi1 - stroke.theta2_rad, order) + stroke.pressing_start_mm
    remaining = stroke.stroke_mm - displacement
    root = jet.sqrt(displacement * remaining)
    return Advance(displacement, remaining.value, root, stroke.pressing_mm_rad / root)


def braking(stroke: WorkingStrokes[Number], phi1: Array, order: int) -> Advance:
    """The advance on [theta3, theta4], of one stroke or of a stroke for each point."""
    before_end = -Jet.variable(phi1 - stroke.theta4_rad, order)
    quotient = jet.polynomial(stroke.braking_root, before_end)
    remaining = before_end * before_end * quotient
    displacement = stroke.stroke_mm - remaining
    root = jet.sqrt(displacement * quotient)
    rate = jet.polynomial(stroke.braking_slope, before_end) / root
    return Advance(displacement, remaining.value, before_end * root, rate)


def approach_angle(stroke: WorkingStrokes[Number], linkage: Mechanisms[Number], phi1: Array, order: int) -> Jet:
    """phi2 in rad on [0, theta2], with derivatives, of one stroke or of a stroke for each point."""
    return approach(stroke, phi1, max(order - 1, 0)).driven_angle(linkage, order)


def pressing_angle(stroke: WorkingStrokes[Number], linkage: Mechanisms[Number], phi1: Array, order: int) -> Jet:
    """phi2 in rad on [theta2, theta3], with derivatives, of one stroke or of a stroke for each point."""
    return pressing(stroke, phi1, max(order - 1, 0)).driven_angle(linkage, order)


def braking_angle(stroke: WorkingStrokes[Number], linkage: Mechanisms[Number], phi1: Array, order: int) -> Jet:
    """phi2 in rad on [theta3, theta4], with derivatives, of one stroke or of a stroke for each point."""
    return braking(stroke, phi1, max(order - 1, 0)).driven_angle(linkage, order)


@dataclass(frozen=True, eq=False)
class StrokeLaw:
    """The closed law with its parts, whose figures the summary shows."""

    transmission: Transmission
    stroke: ClosedStroke
    return_law: ReturnLaw


def stroke_law(
    stroke: ClosedStroke,
    linkage: Mechanism,
    lobes: Lobes,
    *,
    constant: float | None = None,
    inverse_basis: bool = False,
) -> StrokeLaw:
    """The law of a working stroke; ``constant`` is the paper's e, None chooses the return of least peak acceleration.

    Raises WrongInput when theta4 leaves no room for the return, NoSuchMechanism when no return closes the cycle.
    """
    lobes.require_one_cycle()
    require_return(stroke.theta4_rad, lobes)
    working = working_pieces(stroke, linkage)
    ends = _return_ends(working, lobes)
    if constant is None:
        return_law = return_of_least_acceleration(ends, linkage, inverse=inverse_basis)
    else:
        return_law = return_with_constant(ends, constant, inverse=inverse_basis)
    closing = Piece(ends.start_rad, ends.end_rad, return_law.driven_angle)
    return StrokeLaw(Transmission((*working, closing), lobes), stroke, return_law)


def require_return(theta4_rad: float, lobes: Lobes) -> None:
    """Refuse a theta4 that leaves no room for the return; raises WrongInput."""
    if not theta4_rad < lobes.driving_period_rad:
        raise WrongInput(
            f"theta4 is {degrees(theta4_rad):g} deg and one cycle takes {degrees(lobes.driving_period_rad):g} deg "
            "of the driving gear, so nothing is left for the return",
            key="motion",
        )


def _return_ends(working: tuple[Piece, ...], lobes: Lobes) -> ReturnEnds:
    first, last = working[0], working[-1]
    extended = last.driven_angle(np.array([last.end_rad]), 2)
    retracted = first.driven_angle(np.array([first.start_rad]), 2)
    start, end = 1.0 / extended.differentiated(), 1.0 / retracted.differentiated()
    return ReturnEnds(
        start_rad=last.end_rad,
        end_rad=lobes.driving_period_rad,
        start_driven_rad=float(extended.value[0]),
        end_driven_rad=lobes.driven_period_rad,
        start_ratio=float(start.value[0]),
        start_ratio_slope=float(start.derivative(1)[0]),
        end_ratio=float(end.value[0]),
        end_ratio_slope=float(end.derivative(1)[0]),
    )
