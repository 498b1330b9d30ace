"""Outlines as rigid bodies in a physics engine that knows nothing of gears: pymunk (Chipmunk).

The driving body turns at a constant speed, all others are free to turn about their axes, and the last one is held back
by a viscous drag.  The engine takes convex shapes only and makes the hull of anything else without a word, so outlines
are cut into convex pieces first: triangles (ear cutting), joined across every diagonal that leaves the union convex
(S. Hertel and K. Mehlhorn, "Fast triangulation of simple polygons", 1983).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi

import mapbox_earcut
import numpy as np
import pymunk
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Pieces = list[FloatArray]
Edge = tuple[int, int]

SLOP = 1e-5
"""Overlap in mm that the engine leaves alone; what is more it pushes apart at once, by the tiny bias below."""

LEFT_PER_SECOND = 1e-9
"""Share of an overlap beyond the slop that is left after a second: 2 % after a thousandth of the turn."""

HEAVY = 1e9
"""Mass of the driven body, so great that no blow moves its axis; its moment of inertia is 1."""

STRAIGHT = 1e-12
"""Cross product in mm^2 above which a corner counts as turning to the right."""


# --- convex pieces -----------------------------------------------------------------------------------------------


def convex_pieces(outline: FloatArray) -> Pieces:
    """Convex polygons that tile the inside of a simple counter-clockwise outline, shape (n, 2)."""
    rings = _triangles(outline)
    owner = {edge: number for number, ring in enumerate(rings) for edge in _edges(ring)}
    inner = [edge for edge in owner if edge[0] < edge[1] and edge[::-1] in owner]
    for edge in sorted(inner, key=lambda edge: float(np.linalg.norm(outline[edge[1]] - outline[edge[0]]))):
        joined = _joined(outline, rings[owner[edge]], rings[owner[edge[::-1]]], edge)
        if joined is not None:
            rings[owner[edge[::-1]]] = []
            rings[owner[edge]] = joined
            owner |= dict.fromkeys(_edges(joined), owner[edge])
    return [outline[ring] for ring in rings if ring]


def _triangles(outline: FloatArray) -> list[list[int]]:
    """Counter-clockwise triangles as vertex numbers."""
    found = mapbox_earcut.triangulate_float64(outline, np.array([len(outline)], dtype=np.uint32)).reshape(-1, 3)
    return [ring if _turn(outline, *ring) > 0.0 else ring[::-1] for ring in found.astype(int).tolist()]


def _edges(ring: list[int]) -> list[Edge]:
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


def _joined(outline: FloatArray, one: list[int], other: list[int], edge: Edge) -> list[int] | None:
    """The union of two rings that share an edge (the first one's, start to end), None unless it is convex."""
    start, end = edge
    after_end = one[one.index(end) :] + one[: one.index(end)]  # end .. start
    after_start = other[other.index(start) :] + other[: other.index(start)]  # start .. end
    joined = after_end + after_start[1:-1]
    corners = (after_end[-2], start, after_start[1]), (after_start[-2], end, after_end[1])
    return joined if all(_turn(outline, *corner) >= -STRAIGHT for corner in corners) else None


def _turn(outline: FloatArray, before: int, at: int, after: int) -> float:
    one, two = outline[at] - outline[before], outline[after] - outline[at]
    return float(one[0] * two[1] - one[1] * two[0])


# --- motion ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Turning:
    """Angles of both bodies after each step, in rad, each in its own sense of turning."""

    driving: FloatArray
    driven: FloatArray


@dataclass(frozen=True)
class Wheel:
    """A body with its axis at ``place`` in mm, its first angle and speed, and its pieces by their layer.

    Shapes of one layer meet, others pass each other.
    """

    place: complex
    angle: float
    speed: float
    pieces: dict[int, Pieces]


def turned(
    pieces: tuple[Pieces, Pieces],
    distance: float,
    speed: float,
    drag: float,
    steps: int,
    rest: float = 0.1,
    drag_share: Callable[[float], float] = lambda angle: 1.0,
) -> Turning:
    """A full turn of the driving body in ``steps`` steps, and a share ``rest`` of a turn before it to settle.

    The driving body turns by 1 rad/s, the driven one starts with ``speed`` rad/s; ``drag`` is the torque per speed and
    moment of inertia.  Both bodies start in the pose of their outlines.  ``drag_share`` multiplies the drag, by the
    driving angle: where it is negative the driven body is driven on.
    """
    wheels = Wheel(0j, 0.0, 1.0, {1: pieces[0]}), Wheel(complex(distance), 0.0, -speed, {1: pieces[1]})
    angles = train_turned(wheels, drag, steps, rest, drag_share)
    return Turning(angles[:, 0], -angles[:, 1])


def train_turned(
    wheels: Sequence[Wheel],
    drag: float,
    steps: int,
    rest: float = 0.1,
    drag_share: Callable[[float], float] = lambda angle: 1.0,
) -> FloatArray:
    """As ``turned``, with the first wheel driving at its own speed and the last one under drag: angles (steps, n)."""
    space = pymunk.Space()
    space.iterations, space.collision_slop, space.collision_bias = 20, SLOP, LEFT_PER_SECOND
    bodies = [pymunk.Body(body_type=pymunk.Body.KINEMATIC), *(pymunk.Body(HEAVY, 1.0) for _ in wheels[1:])]
    for body, wheel in zip(bodies, wheels, strict=True):
        body.position = wheel.place.real, wheel.place.imag
        body.angle, body.angular_velocity = wheel.angle, wheel.speed
        space.add(body, *(one for layer, pieces in wheel.pieces.items() for one in _shapes(body, pieces, layer)))
    count = int(steps * (1 + rest))
    angles = np.array([_stepped(space, bodies, drag, drag_share, 2.0 * pi / steps) for _ in range(count)])
    return angles[-steps:]


def _shapes(body: pymunk.Body, pieces: Pieces, layer: int) -> list[pymunk.Shape]:
    """Smooth shapes that do not bounce."""
    shapes = [pymunk.Poly(body, piece.tolist()) for piece in pieces]
    for shape in shapes:
        shape.friction = shape.elasticity = 0.0
        shape.filter = pymunk.ShapeFilter(categories=layer, mask=layer)
    return shapes


def _stepped(
    space: pymunk.Space,
    bodies: list[pymunk.Body],
    drag: float,
    drag_share: Callable[[float], float],
    seconds: float,
) -> list[float]:
    bodies[-1].torque = -drag * drag_share(bodies[0].angle) * bodies[-1].angular_velocity
    space.step(seconds)
    return [body.angle for body in bodies]


def lag(turning: Turning, law: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """How far the driven body is behind the law, in rad."""
    return law(turning.driving) - turning.driven
