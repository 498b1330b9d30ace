"""The published law: three-segment working stroke, inverted through the linkage, and a compensating return."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees

import numpy as np

from ncgear.errors import WrongInput
from ncgear.machine.linkage import CrankSlider
from ncgear.machine.stroke import WorkingStroke
from ncgear.ratio.compensation.ends import ReturnEnds
from ncgear.ratio.compensation.families import return_with_constant
from ncgear.ratio.compensation.law import ReturnLaw
from ncgear.ratio.compensation.least_acceleration import return_of_least_acceleration
from ncgear.ratio.inversion import working_pieces
from ncgear.ratio.transmission import Lobes, Piece, Transmission


@dataclass(frozen=True, eq=False)
class StrokeLaw:
    """The closed law with the parts it was made from, which reports name."""

    transmission: Transmission
    stroke: WorkingStroke
    return_law: ReturnLaw


def stroke_law(
    stroke: WorkingStroke,
    linkage: CrankSlider,
    lobes: Lobes,
    *,
    constant: float | None = None,
    inverse_basis: bool = False,
) -> StrokeLaw:
    """The law of a working stroke; ``constant`` is the paper's e, None the one of least peak acceleration.

    Raises WrongInput when theta4 leaves no room for the return, NoSuchMechanism when no return closes the cycle.
    """
    lobes.require_one_cycle()
    if not stroke.theta4_rad < lobes.driving_period_rad:
        raise WrongInput(
            f"theta4 is {degrees(stroke.theta4_rad):g} deg and one cycle takes "
            f"{degrees(lobes.driving_period_rad):g} deg "
            "of the driving gear, so nothing is left for the return",
            key="motion",
        )
    working = working_pieces(stroke, linkage)
    ends = _return_ends(working, lobes)
    if constant is None:
        return_law = return_of_least_acceleration(ends, linkage, inverse=inverse_basis)
    else:
        return_law = return_with_constant(ends, constant)
    closing = Piece(ends.start_rad, ends.end_rad, return_law.driven_angle)
    return StrokeLaw(Transmission((*working, closing), lobes), stroke, return_law)


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
