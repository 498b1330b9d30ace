"""Shapes of crank, rod and slider in their own frames: drawn parts, of which a design file tells the lengths only.

Crank and rod lie along +x from the origin, the crank from its axis and the rod from the crank pin; the slider has its
pin at the origin and its face ahead in +x.
"""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Point, Polygon
from shapely.geometry.polygon import orient

from ncgear.machine.linkage import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.scene.chamber import Chamber

CRANK_EYE = 0.11
PIN_EYE = 0.075
ROD_WIDTH = 0.08
"""Radius of the crank at its axis, of all eyes about pins, and width of the rod, as shares of the crank's length."""

PIN = 0.036
"""Radius of the pins, likewise."""

QUARTER = 16
"""Chords of a quarter of a circle: no chord is farther from it than 1/800 of its radius."""


def pin_radius_mm(linkage: CrankSlider) -> float:
    """Of the pins that are drawn."""
    return PIN * linkage.crank_mm


def crank_shape(linkage: CrankSlider) -> Array:
    """The crank's outline in mm, shape (n, 2), counter-clockwise."""
    length = linkage.crank_mm
    eyes = _disc(0.0, CRANK_EYE * length), _disc(length, PIN_EYE * length)
    return _outline(shapely.union_all(eyes).convex_hull)


def rod_shape(linkage: CrankSlider) -> Array:
    """The rod's outline in mm, shape (n, 2), counter-clockwise."""
    eye, half = PIN_EYE * linkage.crank_mm, ROD_WIDTH / 2.0 * linkage.crank_mm
    bar = shapely.box(0.0, -half, linkage.rod_mm, half)
    return _outline(shapely.union_all([bar, _disc(0.0, eye), _disc(linkage.rod_mm, eye)]))


def slider_shape(chamber: Chamber) -> Array:
    """The slider's outline in mm, shape (4, 2), counter-clockwise."""
    face, half = chamber.face_mm, chamber.height_mm / 2.0
    return np.array([[-face, -half], [face, -half], [face, half], [-face, half]])


def _disc(x: float, radius: float) -> Polygon:
    return Point(x, 0.0).buffer(radius, quad_segs=QUARTER)


def _outline(polygon: Polygon) -> Array:
    points: Array = shapely.get_coordinates(orient(polygon).exterior)[:-1]
    return points
