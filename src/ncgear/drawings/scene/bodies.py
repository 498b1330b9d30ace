"""The moving bodies of the mechanism with their shapes, and the chamber in which the slider works.

A design file gives only lengths, and the force, so the picture adds shapes and the chamber, in proportion to crank and
stroke.  The crank lies along +x from its axis, a slider has its pin at the origin and its face in front of it in +x,
and the mechanism says where the bars, eyes and slots of the other links are.

Where a slider works against a force, its guide is a chamber with a load in it, called material: a plain block, or straw
if a design file says so.  It reaches from the place where the force first acts to the end of the chamber.  On its way
back the slider leaves the material pressed; the next stroke begins with new material.  Where a force acts on the way
back, there is material behind the slider then, up to the open end of the chamber.  A carton or a sheet is pushed along
a table instead: it stands where the force reaches half of its maximum, moves with the slider to the extended end, and
stays there until the next stroke begins with a new carton.  Friction is not drawn.
"""

from __future__ import annotations

from enum import Enum

import numpy as np
import shapely
from shapely import LineString, Point, Polygon

from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import LinkShape, Mechanism
from ncgear.mechanisms.resistance import Resistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array, Mask
from ncgear.solids.plan.areas import rings

Contours = tuple[Array, ...]
"""Contours in mm, shape (n, 2) each, first point not repeated: the outer one counter-clockwise, then the holes."""


class BodyKind(Enum):
    """The kinds of bodies, which set their colours."""

    DRIVING = "driving"
    DRIVEN = "driven"
    CRANK = "crank"
    ROD = "rod"
    SLIDER = "slider"


@dataclass(frozen=True, eq=False)
class Body:
    """A flat body in its own frame: contours in mm, shape (n, 2) each, first point not repeated.

    The first contour is the outer one, counter-clockwise; the others are holes.  ``edges_mm`` are closed lines on its
    face: pockets, a hub.
    """

    name: str
    kind: BodyKind
    contours_mm: Contours
    edges_mm: tuple[Array, ...] = ()

    @property
    def reach_mm(self) -> float:
        """Greatest distance of the body from its frame's origin."""
        return float(np.hypot(*self.contours_mm[0].T).max())


@dataclass(frozen=True, eq=False)
class BodyPlaces:
    """The places of a body's frame: origin in mm, shape (n, 2), and angle in rad counter-clockwise, shape (n,)."""

    origin_mm: Array
    angle_rad: Array


CRANK_EYE = 0.11
PIN_EYE = 0.075
ROD_WIDTH = 0.08
"""Radius of the crank at its axis, radius of eyes about pins, and width of bars, as shares of the crank's length."""

PIN = 0.036
"""Radius of the pins, as a share of the crank's length."""

QUARTER = 16
"""Chords of a quarter of a circle: no chord is farther from it than 1/800 of its radius."""


def pin_radius_mm(linkage: Mechanism) -> float:
    """Radius in mm of the drawn pins."""
    return PIN * linkage.crank_mm


def crank_shape(linkage: Mechanism) -> Contours:
    """The crank's contours in mm: a plain crank, or the mechanism's own shape."""
    if "crank" in linkage.shapes():
        return link_shape(linkage, "crank")
    length = linkage.crank_mm
    eyes = _disc(0.0, CRANK_EYE * length), _disc(length, PIN_EYE * length)
    return _contours(shapely.union_all(eyes).convex_hull)


def link_shape(linkage: Mechanism, name: str) -> Contours:
    """The contours of a link in mm; the widths of its bars are in proportion to the crank's length."""
    return _contours(_shaped(linkage, linkage.shapes()[name]))


def output_shape(linkage: Mechanism, chamber: Chamber | None) -> Contours:
    """The output's contours in mm: a piston in its chamber and the parts that the mechanism adds, or only these."""
    shape = linkage.shapes().get(linkage.OUTPUT.name, LinkShape())
    if chamber is None:
        return _contours(_shaped(linkage, shape))
    face, half = chamber.face_mm, chamber.height_mm / 2.0
    piston = np.array([[-face, -half], [face, -half], [face, half], [-face, half]])
    return (piston,) if shape == LinkShape() else _contours(_shaped(linkage, shape, Polygon(piston)))


def _shaped(linkage: Mechanism, shape: LinkShape, *more: Polygon) -> Polygon:
    """A link as one area: its bars, eyes, areas and walls of slots, and ``more``, without the room in its slots."""
    eye, half = PIN_EYE * linkage.crank_mm, ROD_WIDTH / 2.0 * linkage.crank_mm
    bars = [_bar(np.array(start), np.array(end), half) for start, end in shape.bars]
    eyes = [_disc(x, eye, y) for x, y in shape.eyes]
    walls = [LineString(slot).buffer(eye + half, quad_segs=QUARTER) for slot in shape.slots]
    free = [LineString(slot).buffer(eye, quad_segs=QUARTER) for slot in shape.slots]
    whole = shapely.union_all([*more, *bars, *eyes, *walls, *map(Polygon, shape.areas)])
    return whole if not free else whole.difference(shapely.union_all(free))


def _bar(start: Array, end: Array, half: float) -> Polygon:
    along = (end - start) / np.hypot(*(end - start))
    aside = half * np.array([-along[1], along[0]])
    return Polygon([end - aside, end + aside, start + aside, start - aside])


def _disc(x: float, radius: float, y: float = 0.0) -> Polygon:
    return Point(x, y).buffer(radius, quad_segs=QUARTER)


def _contours(polygon: Polygon) -> Contours:
    return tuple(ring[:-1] for ring in rings(polygon))


SLIDER_LENGTH = 0.30
HEIGHT = 0.5
REST = 0.14
"""Length of the slider, height of the chamber and least depth of the material, as shares of the stroke."""

PUSHED = {"carton": (0.32, 0.4), "sheet": (0.6, 0.04)}
PUSHER_HEIGHT = 0.22
"""Length and height of the carton that is pushed along a table, and height of its slider, as shares of the stroke."""


@dataclass(frozen=True)
class Chamber:
    """A rectangle about the slider's line y = ``offset_mm``; places along it count from the crank's axis.

    ``begins_mm`` is the slider's displacement at which it meets the material.  ``behind_mm`` is the displacement at
    which it meets the material behind it on its way back; None without such material.  ``shown_as`` is the kind of
    material.
    """

    linkage: Mechanism
    begins_mm: float | None
    behind_mm: float | None
    shown_as: str = "load"

    @property
    def straw(self) -> bool:
        """Whether the material has a grain."""
        return self.shown_as == "straw"

    @property
    def pushed_mm(self) -> float | None:
        """Length of the carton that is pushed along a table; None where material is pressed in a chamber."""
        return PUSHED[self.shown_as][0] * self.linkage.stroke_mm if self.shown_as in PUSHED else None

    @property
    def material_height_mm(self) -> float:
        """Size of the material across the slider's line."""
        return PUSHED[self.shown_as][1] * self.linkage.stroke_mm if self.shown_as in PUSHED else self.height_mm

    @property
    def level_mm(self) -> float:
        """Level of the middle of the material: on the slider's line, or on the table."""
        return self.linkage.offset_mm + (self.material_height_mm - self.height_mm) / 2.0

    @property
    def face_mm(self) -> float:
        """Distance from the pin of the slider to its face."""
        return SLIDER_LENGTH / 2.0 * self.linkage.stroke_mm

    @property
    def height_mm(self) -> float:
        """Size across the slider's line; the slider is as high."""
        return (HEIGHT if self.pushed_mm is None else PUSHER_HEIGHT) * self.linkage.stroke_mm

    @property
    def start_mm(self) -> float:
        """Place of the rear end of the retracted slider."""
        return self.linkage.nearest_mm - self.face_mm

    @property
    def end_mm(self) -> float:
        """Place of the wall against which the slider presses the material, or of the end of the table."""
        rest = REST * self.linkage.stroke_mm if self.pushed_mm is None else self.pushed_mm
        return self.linkage.farthest_mm + self.face_mm + rest

    def material_mm(self, displacement_mm: Array, working: Mask) -> Array:
        """Depth of the material before the chamber's end, shape (n,); 0 in a guide without material."""
        if self.begins_mm is None:
            return np.zeros_like(displacement_mm)
        pressed = np.where(working, np.maximum(displacement_mm, self.begins_mm), self.linkage.stroke_mm)
        return self.end_mm - self.face_mm - self.linkage.nearest_mm - pressed

    def material_behind_mm(self, displacement_mm: Array, working: Mask) -> Array:
        """Depth of the material behind the slider, from the chamber's open end on, shape (n,); 0 on the way out."""
        if self.behind_mm is None:
            return np.zeros_like(displacement_mm)
        return np.where(working, 0.0, np.minimum(displacement_mm, self.behind_mm))


def chamber_of(linkage: Mechanism, load: SliderLoad, shown_as: str = "load") -> Chamber | None:
    """The chamber of a mechanism whose piston works against a load; an empty guide where only friction acts."""
    if not linkage.PISTON:
        return None
    out, back = (_acting_mm(force, linkage.stroke_mm) for force in (load.working, load.returning))
    if shown_as in PUSHED:
        return Chamber(linkage, out and _half_mm(load.working, linkage.stroke_mm), None, shown_as)
    return Chamber(linkage, out and out[0], back and back[1], shown_as)


def _half_mm(resistance: Resistance, stroke_mm: float) -> float:
    """The least displacement, out of a thousand, at which a force reaches half of its maximum."""
    at = np.linspace(0.0, stroke_mm, 1001)
    force = resistance.force_n(at)
    return float(at[np.argmax(force >= force.max() / 2.0)])


def _acting_mm(resistance: Resistance, stroke_mm: float) -> tuple[float, float] | None:
    """The least and the greatest displacement between which a force acts; None where no force acts."""
    edges = np.concatenate([[0.0], resistance.zeros_mm(stroke_mm), [stroke_mm]])
    acting = np.nonzero(resistance.force_n((edges[:-1] + edges[1:]) / 2.0) > 0.0)[0]
    return (float(edges[acting[0]]), float(edges[acting[-1] + 1])) if acting.size else None
