"""The load of the slider: a force against its motion on each stroke, over the displacement, and friction on both.

One resistance acts on the way out, from the retracted to the extended dead centre (the working stroke), and another on
the way back.  Both are given over the displacement from the retracted end.  The friction is constant.  With F the
resistance of a stroke and R the friction, the force against the motion is max(F, 0) + R, or F + R where the negative
values of F are kept.

The stroke decides the direction of the load, not the sign of the slider's speed: a slider that trembles about its law,
as loaded teeth let it, meets no force that jumps.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.resistance import PolynomialResistance, Resistance
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet

NO_RESISTANCE = PolynomialResistance()


@dataclass(frozen=True)
class SliderLoad:
    """The load on the slider: ``working`` on its way out, ``returning`` on its way back, ``friction_n`` on both.

    ``returning`` in the arguments of methods names the stroke: true on the way back.  Displacements are in mm from the
    retracted end.  ``repeats_after`` is the distance after which the load begins again, for an output that never comes
    back; stretches of that distance are counted from 0.  Raises WrongInput for a friction that is negative or not
    finite.
    """

    working: Resistance = NO_RESISTANCE
    returning: Resistance = NO_RESISTANCE
    friction_n: float = 0.0
    repeats_after: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 <= self.friction_n < inf:
            problem = f"{self.friction_n:g} N given; 0 or a positive force is right"
            raise WrongInput(problem, key="resistance.friction_n")

    @property
    def loads_return(self) -> bool:
        """Whether any load acts on the slider on its way back."""
        return self.friction_n > 0.0 or self.returning != NO_RESISTANCE

    def on(self, returning: bool) -> Resistance:
        """The resistance of one stroke, without friction."""
        return self.returning if returning else self.working

    def against_n(self, displacement_mm: Array, returning: Mask | bool) -> Array:
        """Force in N against the motion; displacements and strokes have shapes that broadcast.

        It is negative only where a resistance keeps its negative values and drives the slider.
        """
        there = self._within(np.asarray(displacement_mm, dtype=float))
        return np.where(returning, self.returning.force_n(there), self.working.force_n(there)) + self.friction_n

    def _within(self, displacement: Array) -> Array:
        """The displacement within the distance after which the load repeats."""
        if self.repeats_after is None:
            return displacement
        return np.mod(displacement, self.repeats_after)

    def backwards_n(self, displacement_mm: Array, returning: Mask | bool) -> Array:
        """Force in N on the slider along -x, towards its retracted end; times the velocity it is the power.

        On the way out it is the force against the motion, on the way back the negative of this force.
        """
        against = self.against_n(displacement_mm, returning)
        return np.where(returning, 0.0 - against, against)

    def backwards_jet_n(self, displacement: Jet, returning: Mask) -> Jet:
        """``backwards_n`` with derivatives at n displacements; ``returning`` has shape (n,).

        One-sided at the corners of the resistance (``corners_mm``).
        """
        there = Jet(np.vstack([self._within(displacement.value)[None, :], displacement.coefficients[1:]]))
        out, back = (self.on(way).force_jet_n(there) + self.friction_n for way in (False, True))
        return Jet(np.where(returning, 0.0 - back.coefficients, out.coefficients))

    def smooth_curves_n(self, returning: bool) -> tuple[Callable[[Jet], Jet], ...]:
        """Functions of the displacement's jet; the largest of their values and 0 is the force against the motion.

        They have no corner where the resistance sets in.  A stroke without load has none.
        """
        resistance, friction = self.on(returning), self.friction_n
        curves: list[Callable[[Jet], Jet]] = []
        if resistance != NO_RESISTANCE:
            curves.append(lambda displacement: resistance.fitted_n(displacement) + friction)
        if friction > 0.0 and not (curves and resistance.keep_negative):
            curves.append(lambda displacement: 0.0 * displacement + friction)
        return tuple(curves)

    def work_n_mm(self, displacement_mm: Array, stroke_mm: float, returning: bool) -> Array:
        """Work in N mm against the load since the stroke began, to displacements in mm within it, shape (n,)."""
        if not returning:
            return self.working.work_n_mm(displacement_mm, stroke_mm) + self.friction_n * displacement_mm
        whole = self.returning.work_n_mm(np.array([stroke_mm]), stroke_mm)
        left = self.returning.work_n_mm(displacement_mm, stroke_mm)
        return whole - left + self.friction_n * (stroke_mm - displacement_mm)

    def cycle_work_n_mm(self, stroke_mm: float) -> float:
        """Work in N mm of one cycle, out and back; it does not depend on the law."""
        out = self.work_n_mm(np.array([stroke_mm]), stroke_mm, returning=False)
        back = self.work_n_mm(np.array([0.0]), stroke_mm, returning=True)
        return float(out[0]) + float(back[0])

    def turns_mm(self, stroke_mm: float, returning: bool) -> Array:
        """Displacements inside the stroke between which the curve of the force is smooth and monotone, rising."""
        return self.on(returning).turns_mm(stroke_mm)

    def zeros_mm(self, stroke_mm: float, returning: bool) -> Array:
        """Displacements inside the stroke at which the resistance without friction is zero, rising."""
        return self.on(returning).zeros_mm(stroke_mm)

    def knots_mm(self, stroke_mm: float, returning: bool) -> Array:
        """Displacements inside the stroke, in rising order; searches between neighbours miss nothing of the curve."""
        return self.on(returning).knots_mm(stroke_mm)

    def corners_mm(self, stroke_mm: float, returning: bool) -> Array:
        """Turns and zeros, rising: between them the acting force is smooth and monotone."""
        return np.union1d(self.turns_mm(stroke_mm, returning), self.zeros_mm(stroke_mm, returning))
