"""Pairs of flanks that are to touch in given positions: their exact curves as the driven gear sees them."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import as_complex
from ncgear.teeth.gear import ToothedPair


@dataclass(frozen=True, eq=False)
class FacingFlanks:
    """n pairs of a driving and a driven flank, each in one position, shape (n,) each.

    ``driving_mm`` and ``driven_mm`` are the heights at which they touch by the closed form.  ``urge`` is +1 where that
    contact comes first for which the driving gear is seen turned the farthest up, -1 where it is the farthest down.
    """

    teeth: ToothedPair
    placement: Placement
    urge: float
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    driving_mm: Array
    driven_mm: Array

    @property
    def module_mm(self) -> float:
        """Module of the pair."""
        return self.teeth.driving.flanks.rack.module_mm

    def kept(self, rows: IndexArray | Mask) -> FacingFlanks:
        """The chosen pairs."""
        columns = [getattr(self, field.name)[rows] for field in fields(self)[3:]]
        return FacingFlanks(self.teeth, self.placement, self.urge, *columns)

    def driving_curve(self, height_mm: Array) -> tuple[ComplexArray, ComplexArray]:
        """Points of the driving flanks at heights (shape (n, ...)) and derivatives, at the law's driven angle."""
        flank, position = (_rows(numbers, height_mm) for numbers in (self.driving, self.position))
        point, slope = (as_complex(array) for array in self.teeth.driving.flanks.flank(flank, height_mm))
        return self.placement.driving_points(point, position), self.placement.driving_directions(slope, position)

    def driven_curve(self, height_mm: Array) -> tuple[ComplexArray, ComplexArray]:
        """Points of the driven flanks at heights (shape (n, ...)) and derivatives."""
        point, slope = self.teeth.driven.flanks.flank(_rows(self.driven, height_mm), height_mm)
        return as_complex(point), as_complex(slope)


@dataclass(frozen=True, eq=False)
class Touches:
    """Where n pairs of flanks touch: heights in mm, and the angle by which the driving gear is then seen turned.

    ``point`` and ``tangent`` (up the driving flank, of any length) are in the driven gear's frame as it then stands;
    where ``found`` is false the other figures mean nothing.  Shape (n,) each.
    """

    driving_mm: Array
    driven_mm: Array
    turn_rad: Array
    point: ComplexArray
    tangent: ComplexArray
    found: Mask

    def merged(self, rows: IndexArray, newer: Touches) -> Touches:
        """These with the chosen rows replaced."""
        columns = [getattr(self, field.name).copy() for field in fields(self)]
        for column, field in zip(columns, fields(self), strict=True):
            column[rows] = getattr(newer, field.name)
        return Touches(*columns)


def _rows(numbers: IndexArray, values: Array) -> IndexArray:
    """Numbers of shape (n,) in a shape that broadcasts with values of shape (n, ...)."""
    return np.reshape(numbers, (-1, *[1] * (values.ndim - 1)))
