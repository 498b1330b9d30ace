"""A resistance written as an expression in ``x``, the displacement in mm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from ncgear.errors import WrongInput
from ncgear.machine.resistance import Resistance, within
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.formula import composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.roots import all_zeros

KEY = "resistance.expression_n"


@dataclass(frozen=True)
class FormulaResistance(Resistance):
    """Force in N as an expression in ``x``.

    Raises WrongInput for what is no expression, or no smooth function over the stroke.
    """

    text: str
    keep_negative: bool = False

    @cached_property
    def _function(self) -> Callable[[Jet], Jet]:
        return composed(self.text, KEY, "x")

    def fitted_n(self, displacement: Jet) -> Jet:
        """The expression itself, with derivatives."""
        return self._function(displacement)

    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """The antiderivative of a piecewise Chebyshev form resolved to rounding error."""
        return _form(self, 0, stroke_mm).integrated()(displacement_mm)

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Zeros of the Chebyshev form."""
        return within(all_zeros(_form(self, 0, stroke_mm)), stroke_mm)

    def turns_mm(self, stroke_mm: float) -> Array:
        """Zeros of the Chebyshev form of the derivative."""
        return within(all_zeros(_form(self, 1, stroke_mm)), stroke_mm)


@lru_cache(maxsize=16)
def _form(resistance: FormulaResistance, derivative: int, stroke_mm: float) -> PiecewiseChebyshev:
    def values(displacement_mm: Array) -> Array:
        return resistance.fitted_n(Jet.variable(displacement_mm, derivative)).derivative(derivative)

    try:
        return chebyshev.fitted(values, np.array([0.0, stroke_mm]))
    except NotSmooth as fault:
        problem = f"{resistance.text!r} is no smooth function near x = {fault.at:.6g} mm; one over the whole stroke, "
        raise WrongInput(f"{problem}0 to {stroke_mm:g} mm, or a table, is right", key=KEY) from fault
