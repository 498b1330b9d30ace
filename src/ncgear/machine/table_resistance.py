"""A resistance given point by point.

Between the points runs the monotone cubic of F. N. Fritsch and J. Butland, "A method for constructing local monotone
piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5 (1984): its slope is continuous, and the force never leaves
the range of the two points beside it, so a table that is nowhere negative stays so.  Beyond the table's ends the force
keeps its end value.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator, PPoly

from ncgear.errors import WrongInput
from ncgear.machine.resistance import Resistance, within
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True)
class TableResistance(Resistance):
    """Forces in N at strictly rising displacements in mm, two points or more.

    Raises WrongInput for displacements that do not rise, and for unequal numbers of both.
    """

    displacement_mm: tuple[float, ...]
    at_points_n: tuple[float, ...]
    keep_negative: bool = False

    def __post_init__(self) -> None:
        points, forces = len(self.displacement_mm), len(self.at_points_n)
        if points != forces or points < 2:
            problem = f"{forces} forces for {points} displacements; one for each of two or more is right"
            raise WrongInput(problem, key="resistance.table.force_n")
        if not np.all(np.diff(self.displacement_mm) > 0.0):
            raise WrongInput("the displacements must rise strictly", key="resistance.table.displacement_mm")

    @cached_property
    def _cubics(self) -> PPoly:
        """The cubics between the points, and a constant on either side as long as the table itself or a stroke."""
        inner = PchipInterpolator(self.displacement_mm, self.at_points_n)
        first, last = self.displacement_mm[0], self.displacement_mm[-1]
        before, after = np.zeros((4, 1)), np.zeros((4, 1))
        before[3], after[3] = self.at_points_n[0], self.at_points_n[-1]
        breaks = np.concatenate([[min(first, 0.0) - 1.0], inner.x, [last + 1.0]])
        return PPoly(np.hstack([before, inner.c, after]), breaks)

    def fitted_n(self, displacement: Jet) -> Jet:
        """The cubic at each displacement, by Horner's rule on its own coefficients."""
        cubics = self._cubics
        place = np.searchsorted(cubics.x, displacement.value, side="right") - 1
        piece = np.clip(place, 0, cubics.c.shape[1] - 1)
        local = displacement + Jet(_padded(-cubics.x[piece], displacement.order))
        result = displacement * 0.0
        for row in cubics.c:
            result = result * local + Jet(_padded(row[piece], displacement.order))
        return result

    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """The antiderivative of the cubics, which the last of them continues beyond the table."""
        antiderivative = self._cubics.antiderivative()
        work: Array = antiderivative(displacement_mm) - antiderivative(0.0)
        return work

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Zeros of the cubics, and both ends of stretches without force."""
        forces, points = np.array(self.at_points_n), np.array(self.displacement_mm)
        crossings = self._cubics.roots(extrapolate=False)
        return within(np.concatenate([crossings[np.isfinite(crossings)], points[forces == 0.0]]), stroke_mm)

    def turns_mm(self, stroke_mm: float) -> Array:
        """The points of the table: the cubic between two of them is monotone."""
        return within(np.array(self.displacement_mm), stroke_mm)


def _padded(values: Array, order: int) -> Array:
    """Coefficients of a jet that is constant at each point."""
    coefficients = np.zeros((order + 1, values.size))
    coefficients[0] = values
    return coefficients
