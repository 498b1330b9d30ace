"""The resistance against the slider in its working stroke: what every form of it, from a curve of the force, gives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from itertools import pairwise

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


class Resistance(ABC):
    """Force in N over the displacement in mm; a form gives the curve, its antiderivative, its zeros and its turns.

    A curve may be negative where there is nothing to press, as the published baler's fit is below 33.7 mm; a
    resistance cannot push, so negative values count as zero unless ``keep_negative``.
    """

    keep_negative: bool

    @abstractmethod
    def fitted_n(self, displacement: Jet) -> Jet:
        """The curve itself, negative stretches included, with derivatives; one-sided where it has a corner."""

    @abstractmethod
    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """Integral of the curve itself from 0 to displacements within the stroke, shape (n,)."""

    @abstractmethod
    def zeros_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke at which the curve is zero, in rising order."""

    @abstractmethod
    def turns_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke between which the curve is smooth and monotone, in rising order."""

    def negative_stretches_mm(self, stroke_mm: float) -> list[tuple[float, float]]:
        """Stretches of the stroke on which the curve is negative."""
        edges = [0.0, *self.zeros_mm(stroke_mm).tolist(), stroke_mm]
        middles = np.array([(low + high) / 2.0 for low, high in pairwise(edges)])
        negative = self.fitted_n(Jet(middles[None, :])).value < 0.0
        return [stretch for stretch, below in zip(pairwise(edges), negative, strict=True) if below]

    def force_n(self, displacement_mm: Array) -> Array:
        """Force in N at displacements in mm, any shape."""
        force = self.fitted_n(Jet(displacement_mm.reshape(1, -1))).value.reshape(displacement_mm.shape)
        return force if self.keep_negative else np.maximum(force, 0.0)

    def work_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """Work in N mm from the retracted end to displacements in mm, shape (n,); the integral of ``force_n``."""
        if self.keep_negative:
            return self.work_from_retracted_n_mm(displacement_mm, stroke_mm)
        edges = np.concatenate([[0.0], self.zeros_mm(stroke_mm), [stroke_mm]])
        potential = self.work_from_retracted_n_mm(edges, stroke_mm)
        whole = np.concatenate([[0.0], np.cumsum(np.maximum(np.diff(potential), 0.0))])
        stretch = np.clip(np.searchsorted(edges, displacement_mm, side="right") - 1, 0, edges.size - 2)
        begun = self.work_from_retracted_n_mm(displacement_mm, stroke_mm) - potential[stretch]
        work: Array = whole[stretch] + np.maximum(begun, 0.0)
        return work


def within(displacements_mm: Array, stroke_mm: float) -> Array:
    """Those of the displacements that lie inside the stroke, in rising order."""
    return np.unique(displacements_mm[(displacements_mm > 0.0) & (displacements_mm < stroke_mm)])
