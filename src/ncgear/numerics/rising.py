"""Rising functions in piecewise Chebyshev form, with their inverses."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev

GUESSES = 16
"""Places in each panel from which Newton's method begins: nearer to each other than a panel's details."""

NEWTON_STEPS = 20
"""Most steps to an inverse; convergence is quadratic."""

ROUNDING = 4e-15
"""Last step that counts as rounding, for places of a few units."""

JUMP = 1e-12
"""Difference of the values of two panels at their common end, as a share of the whole rise, that rounding may leave."""


@dataclass(frozen=True, eq=False)
class Rising:
    """A function that rises from 0 at 0 to the end of its form."""

    form: PiecewiseChebyshev

    @property
    def end(self) -> float:
        """The place where the form ends."""
        return float(self.form.breaks[-1])

    def __call__(self, places: Array) -> Array:
        """Values at places, shape (n,)."""
        return self.form(places)

    @cached_property
    def _guesses(self) -> tuple[Array, Array, PiecewiseChebyshev]:
        breaks = self.form.breaks
        within = breaks[:-1, None] + np.diff(breaks)[:, None] * (np.arange(GUESSES) / GUESSES)
        places = np.append(within.ravel(), breaks[-1])
        return places, self(places), self.form.differentiated()

    def inverse(self, values: Array) -> Array:
        """Places with these values, shape (n,), within the form; raises Unanswered where Newton's method finds none."""
        guesses, known, rate = self._guesses
        places = np.interp(values, known, guesses)
        for _ in range(NEWTON_STEPS):
            step = (self(places) - values) / rate(places)
            places = np.clip(places - step, 0.0, self.end)
            if np.max(np.abs(step), initial=0.0) <= ROUNDING:
                return places
        if np.max(np.abs(self(places) - values)) <= JUMP * known[-1]:
            return places
        raise Unanswered("a rising function could not be inverted")
