"""A gear as a flat drawing in mm: closed contours and marks on named layers. DXF and SVG files are written from it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from ncgear.numerics.arrays import Array


class Use(Enum):
    """What a workshop does along the lines of a layer."""

    THROUGH = "cut through"
    PART_WAY = "not cut through"
    REFERENCE = "for reference, not cut"


class Layer(Enum):
    """What lines show, and what they are for; a layer's name in files is that of the member."""

    OUTLINE = "tooth outline", Use.THROUGH
    RIM = "outer circle of the ring", Use.THROUGH
    BORE = "bore with its keyway", Use.THROUGH
    INDEX_HOLE = "index hole; those of both gears face each other at phi1 = 0", Use.THROUGH
    LIGHTENING_HOLES = "lightening holes", Use.THROUGH
    POCKETS = "pockets from the upper face down to the web", Use.PART_WAY
    HUB = "hub on the upper face", Use.PART_WAY
    PITCH_CURVE = "pitch curve", Use.REFERENCE
    AXIS = "axis of the gear", Use.REFERENCE

    def __init__(self, content: str, use: Use) -> None:
        self.content, self.use = content, use

    @property
    def words(self) -> str:
        """Both, for whoever looks at the file."""
        return f"{self.content}; {self.use.value}"


CUT_THROUGH = tuple(layer for layer in Layer if layer.use is Use.THROUGH)


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

    @property
    def corners(self) -> Array:
        """Points whose box holds the contour, arcs left out: they lie within other contours."""
        return self.points


@dataclass(frozen=True)
class Circle:
    """A whole circle."""

    x_mm: float
    y_mm: float
    radius_mm: float

    def moved(self, x_mm: float) -> Circle:
        """The circle, farther along x."""
        return replace(self, x_mm=self.x_mm + x_mm)

    @property
    def corners(self) -> Array:
        """Two opposite corners of the square around it, shape (2, 2)."""
        center = np.array([self.x_mm, self.y_mm])
        return np.stack([center - self.radius_mm, center + self.radius_mm])


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

    @property
    def corners(self) -> Array:
        """The ends of its lines, shape (4, 2)."""
        return self.lines.reshape(-1, 2)


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


def box_around(drawings: Iterable[Drawing]) -> tuple[Array, Array]:
    """Lower left and upper right corner of the box around all shapes."""
    shapes = (shape for drawing in drawings for layer in drawing.layers.values() for shape in layer)
    corners = np.vstack([shape.corners for shape in shapes])
    return corners.min(axis=0), corners.max(axis=0)
