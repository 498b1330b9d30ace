"""A gear as a flat drawing in mm: closed contours and marks on named layers. DXF and SVG files are written from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from ncgear.numerics.arrays import Array


class Layer(StrEnum):
    """What a shape is for; those of the first three are cut through."""

    OUTLINE = "OUTLINE"
    BORE = "BORE"
    HOLES = "HOLES"
    POCKETS = "POCKETS"
    HUB = "HUB"
    PITCH_CURVE = "PITCH_CURVE"
    AXIS = "AXIS"


CUT_THROUGH = (Layer.OUTLINE, Layer.BORE, Layer.HOLES)


@dataclass(frozen=True, eq=False)
class Contour:
    """A closed chain of lines and arcs through points (n, 2), first point not repeated.

    ``bulges`` (n,) tells how the contour goes on from each point: 0 a line, else an arc, by the tangent of a quarter of
    the angle that it turns by, positive counter-clockwise (the DXF reference's bulge).
    """

    points: Array
    bulges: Array

    def moved(self, x_mm: float) -> Contour:
        """The contour, farther along x."""
        return replace(self, points=self.points + np.array([x_mm, 0.0]))


@dataclass(frozen=True)
class Circle:
    """A whole circle."""

    x_mm: float
    y_mm: float
    radius_mm: float

    def moved(self, x_mm: float) -> Circle:
        """The circle, farther along x."""
        return replace(self, x_mm=self.x_mm + x_mm)


@dataclass(frozen=True)
class Cross:
    """The mark of an axis: two lines of a length, across each other."""

    x_mm: float
    y_mm: float
    length_mm: float

    def moved(self, x_mm: float) -> Cross:
        """The mark, farther along x."""
        return replace(self, x_mm=self.x_mm + x_mm)

    @property
    def lines(self) -> Array:
        """Both lines, shape (2, 2, 2): line, end, coordinate."""
        half = self.length_mm / 2.0
        arms = np.array([[[-half, 0.0], [half, 0.0]], [[0.0, -half], [0.0, half]]])
        return np.asarray(arms + np.array([self.x_mm, self.y_mm]))


Shape = Contour | Circle | Cross
Layers = Mapping[Layer, tuple[Shape, ...]]


@dataclass(frozen=True, eq=False)
class Drawing:
    """A gear in its own frame, in the pose of phi1 = 0; ``notes`` are what to know of it."""

    name: str
    layers: Layers
    notes: tuple[str, ...]

    def moved(self, x_mm: float) -> Drawing:
        """The drawing, farther along x."""
        layers = {name: tuple(shape.moved(x_mm) for shape in shapes) for name, shapes in self.layers.items()}
        return replace(self, layers=layers)


def polygon(points: Array) -> Contour:
    """A contour of lines alone, through points (n, 2)."""
    return Contour(points, np.zeros(len(points)))
