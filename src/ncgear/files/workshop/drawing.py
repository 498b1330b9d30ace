"""A flat drawing of gears in mm as a value: closed contours and marks on named layers, for DXF and SVG files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from enum import Enum
from math import ceil, log10

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import bow_middles

DECIMALS, FINER = 6, 8
"""Decimals of coordinates in mm: a millionth of a millimetre, or a hundred-millionth for drawings under 100 mm: far
below any chord tolerance."""

BULGE_DECIMALS = 9
"""Decimals of bulges: on a chord of a metre the arc stays within a millionth of a millimetre."""


def written(values: Array | float, decimals: int) -> Array:
    """Numbers as DXF and SVG files have them: rounded, and without a minus before a zero.

    Raises Unanswered for infinity and NaN.
    """
    if not np.isfinite(values).all():
        raise Unanswered("a drawing holds a coordinate that is no finite number")
    return np.asarray(np.round(values, decimals) + 0.0)


class Use(Enum):
    """The use of the lines of a layer in a workshop."""

    THROUGH = "cut through"
    PART_WAY = "not cut through"
    REFERENCE = "for reference, not cut"


class Layer(Enum):
    """The layers of a drawing, each with its content and its use; in files a layer has the member's name."""

    OUTLINE = "tooth outline", Use.THROUGH
    RIM = "outer circle of the ring", Use.THROUGH
    BORE = "bore with its keyway", Use.THROUGH
    CRANK_PIN = "hole for the crank pin, in the direction of the crank at phi1 = 0", Use.THROUGH
    INDEX_HOLE = "index hole; those of both gears face each other at phi1 = 0", Use.THROUGH
    END_STOP = "slot in which a pin of the frame stops the gear", Use.THROUGH
    LIGHTENING_HOLES = "lightening holes", Use.THROUGH
    POCKETS = "pockets from the upper face down to the web", Use.PART_WAY
    HUB = "hub on the upper face", Use.PART_WAY
    PITCH_CURVE = "pitch curve", Use.REFERENCE
    AXIS = "axis of the gear", Use.REFERENCE

    def __init__(self, content: str, use: Use) -> None:
        self.content, self.use = content, use

    @property
    def words(self) -> str:
        """The content and the use of the layer, in the words of the files."""
        return f"{self.content}; {self.use.value}"


@dataclass(frozen=True, eq=False)
class Polyline:
    """A closed chain of lines and arcs through points (n, 2), first point not repeated.

    ``bulges`` (n,) describe the piece after each point: 0 for a line, else the tangent of a quarter of the arc's angle,
    positive counter-clockwise (the bulge of the DXF reference).
    """

    points: Array
    bulges: Array

    @property
    def corners(self) -> Array:
        """Points whose box holds the contour, up to the height of arcs above the points at their middles."""
        return np.vstack([self.points, bow_middles(self.points, self.bulges)])


def polygon(points: Array) -> Polyline:
    """A contour of lines alone, through points (n, 2)."""
    return Polyline(points, np.zeros(len(points)))


@dataclass(frozen=True)
class Circle:
    """A whole circle."""

    x_mm: float
    y_mm: float
    radius_mm: float

    @property
    def corners(self) -> Array:
        """Two opposite corners of the square around it, shape (2, 2)."""
        center = np.array([self.x_mm, self.y_mm])
        return np.stack([center - self.radius_mm, center + self.radius_mm])


@dataclass(frozen=True)
class Cross:
    """The mark of an axis: two lines of the same length that cross each other."""

    x_mm: float
    y_mm: float
    length_mm: float

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


Shape = Polyline | Circle | Cross

Layers = Mapping[Layer, tuple[Shape, ...]]


@dataclass(frozen=True, eq=False)
class Drawing:
    """A gear in its own frame, in the pose of phi1 = 0; ``notes`` are sentences about it."""

    name: str
    layers: Layers
    notes: tuple[str, ...]

    @property
    def cut(self) -> Drawing:
        """Only the closed contours that a workshop cuts, through or part of the way."""
        cuts = {layer: shapes for layer, shapes in self.layers.items() if layer.use is not Use.REFERENCE}
        return replace(self, layers=cuts)

    def moved(self, x_mm: float) -> Drawing:
        """The drawing, farther along x."""
        layers = {layer: tuple(_moved(shape, x_mm) for shape in shapes) for layer, shapes in self.layers.items()}
        return replace(self, layers=layers)


def _moved(shape: Shape, x_mm: float) -> Shape:
    if isinstance(shape, Polyline):
        return replace(shape, points=shape.points + np.array([x_mm, 0.0]))
    return replace(shape, x_mm=shape.x_mm + x_mm)


@dataclass(frozen=True, eq=False)
class PairDrawings:
    """Both gears in their own frames, the distance of their axes in mm, and sentences about the pair."""

    driving: Drawing
    driven: Drawing
    center_distance_mm: float
    notes: tuple[str, ...]


def decimals_for(drawings: Iterable[Drawing]) -> int:
    """The decimals that coordinates of drawings have in a file."""
    low, high = box_around(drawings)
    return max(DECIMALS, FINER - ceil(log10(float(np.max(high - low)))))


def box_around(drawings: Iterable[Drawing]) -> tuple[Array, Array]:
    """Lower left and upper right corner of the box around all shapes."""
    shapes = (shape for drawing in drawings for layer in drawing.layers.values() for shape in layer)
    corners = np.vstack([shape.corners for shape in shapes])
    return corners.min(axis=0), corners.max(axis=0)
