"""Contact of two outlines as written: how far the driven gear can be turned each way before they touch.

At each position every vertex of one outline near the mesh is followed along its circle about the driven axis to the
chords of the other outline.  In polar coordinates about that axis the next chord met on either side tells whether the
vertex is outside the other gear (and how far away in angle) or inside it (and how deep).  Vertices against chords both
ways round give the exact play of two polygons.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import lcm, pi

import numpy as np
from scipy.spatial import cKDTree

from ncgear.contact.slopes import Chords, Slopes, product, slopes_of
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.pitch.shape import Mesh

FAR = 1.0
"""Angle in rad that stands for "no chord in reach"; play is never so large."""

BLOCK = 8192
"""Vertices treated at once, so that the table of slopes that they may meet stays in the processor's cache."""


@dataclass(frozen=True, eq=False)
class OutlineContact:
    """Play of the driven gear at each position, in rad, negative where the outlines overlap; shape (n,) each.

    ``forward_rad`` is how far it can turn on in its sense of turning, ``backward_rad`` back onto the driving flank;
    ``penetration_mm`` is the arc of the deepest vertex inside the other gear.
    """

    phi1_rad: Array
    forward_rad: Array
    backward_rad: Array
    penetration_mm: Array

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of the angle at which the driven gear rests on the driving flank."""
        return float(np.ptp(self.backward_rad))

    @property
    def largest_penetration_mm(self) -> float:
        """Deepest overlap at any position, as an arc about the driven axis."""
        return float(np.max(self.penetration_mm))


def positions(driving_teeth: int, driven_teeth: int, per_tooth: int = 20, least: int = 400) -> Array:
    """Driving angles over which every tooth meets each of its mates once, shape (n,)."""
    meetings = lcm(driving_teeth, driven_teeth)
    count = max(per_tooth * meetings, least)
    return np.linspace(0.0, 2.0 * pi * meetings / driving_teeth, count, endpoint=False)


def outline_contact(
    driving_mm: Array,
    driven_mm: Array,
    center_distance_mm: float,
    reach_mm: float,
    phi1: Array,
    phi2: Array,
    pitch_point_mm: Array,
    mesh: Mesh = Mesh.EXTERNAL,
) -> OutlineContact:
    """Play at driving angles ``phi1`` and driven angles ``phi2``, the pitch point at x = ``pitch_point_mm``; all (n,).

    Outlines are looked at within ``reach_mm`` of the pitch point, which must cover the line of action.
    """
    axis = np.array([center_distance_mm, 0.0])
    pitch_point = np.column_stack([pitch_point_mm, np.zeros_like(pitch_point_mm)])
    # Chords keep their gear's material on their left; a ring's outline runs counter-clockwise, with the hole there.
    boundary_mm = driven_mm[::-1] if mesh is Mesh.INTERNAL else driven_mm
    driving = _near(driving_mm, phi1, np.zeros(2), pitch_point, reach_mm)
    driven = _near(boundary_mm, mesh.sense * phi2, axis, pitch_point, reach_mm)
    driving, driven = _about(driving, axis), _about(driven, axis)
    own, other = (_play_of_vertices(*both, len(phi1)) for both in ((driving, driven), (driven, driving)))
    # A vertex of the driving gear that may move by +g lets the driven gear turn by -g, and the other way round.
    falling, rising = np.minimum(own[0], other[1]), np.minimum(own[1], other[0])
    forward, backward = (rising, falling) if mesh is Mesh.INTERNAL else (falling, rising)
    return OutlineContact(phi1, forward, backward, np.maximum(own[2], other[2]))


def _turned(points: Array, angle: Array) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([x * cosine - y * sine, x * sine + y * cosine], axis=-1)


def _near(outline: Array, angle: Array, axis: Array, center: Array, reach: float) -> Chords:
    """The chords of which an end lies within reach of the centre, position by position.

    The outline stands at ``axis`` turned by ``angle`` (shape (positions,)); ``center`` has shape (positions, 2).
    """
    position, number = _chord_numbers(outline, _turned(center - axis, -angle), reach)
    turn = angle[position]
    following = (number + 1) % len(outline)
    return Chords(position, _turned(outline[number], turn) + axis, _turned(outline[following], turn) + axis)


def _chord_numbers(outline: Array, center: Array, reach: float) -> tuple[IndexArray, IndexArray]:
    """Positions and numbers of the chords near each centre in the outline's own frame, in that order."""
    found = cKDTree(outline).query_ball_point(center, reach, return_sorted=True)
    position = np.repeat(np.arange(len(center)), [len(near) for near in found])
    vertex = np.concatenate([np.asarray(near, dtype=int) for near in found])
    # Each vertex begins a chord; the first of consecutive ones also ends one.
    first = np.append(True, (np.diff(vertex) != 1) | (np.diff(position) != 0))[: vertex.size]
    chord = np.insert(vertex, np.nonzero(first)[0], vertex[first] - 1) % len(outline)
    return np.insert(position, np.nonzero(first)[0], position[first]), chord


def _about(chords: Chords, axis: Array) -> Chords:
    return replace(chords, start=chords.start - axis, end=chords.end - axis)


def _play_of_vertices(moving: Chords, fixed: Chords, positions: int) -> tuple[Array, Array, Array]:
    """Least angles that vertices can move by +angle and by -angle about the origin, and the deepest arc.

    One of each per position.
    """
    upward, downward, depth = np.full(positions, FAR), np.full(positions, FAR), np.zeros(positions)
    slopes = slopes_of(fixed, positions)
    for begin in range(0, moving.position.size, BLOCK):
        row, points = moving.position[begin : begin + BLOCK], moving.start[begin : begin + BLOCK]
        up, down = _free_angles(points, slopes, row)
        np.minimum.at(upward, row, up)
        np.minimum.at(downward, row, down)
        np.maximum.at(depth, row, np.maximum(-np.minimum(up, down), 0.0) * np.hypot(*points.T))
    return upward, downward, depth


def _free_angles(points: Array, slopes: Slopes, row: IndexArray) -> tuple[Array, Array]:
    """Angles to the next chord upwards and downwards; negative for the nearer one when the point is inside.

    Chords with the material on their left rise from the axis where it is entered with growing angle, and fall where it
    is left.
    """
    vertex, chord = slopes.met(row, product(points, points))
    rising = slopes.rising[chord]
    angle = _crossing_angles(points[vertex], slopes.chords.start[chord], slopes.chords.end[chord], rising)
    entered_above, left_above, entered_below, left_below = (
        _least(vertex, np.abs(angle), (rising == entering) & ((angle >= 0.0) == upwards), len(points))
        for upwards in (True, False)
        for entering in (True, False)
    )
    inside = (left_above < entered_above) & (entered_below < left_below)
    through_above = inside & (left_above <= entered_below)
    through_below = inside & ~through_above
    up = np.where(inside, np.where(through_below, -entered_below, FAR), np.minimum(entered_above, left_above))
    down = np.where(inside, np.where(through_above, -left_above, FAR), np.minimum(entered_below, left_below))
    return up, down


def _least(group: IndexArray, values: Array, chosen: Mask, count: int) -> Array:
    """Smallest chosen value of each group, FAR for an empty one."""
    least = np.full(count, FAR)
    np.minimum.at(least, group[chosen], values[chosen])
    return least


def _crossing_angles(points: Array, start: Array, end: Array, rising: Mask) -> Array:
    """Signed angles from points (shape (n, 2)) to where chords, rising or falling, cross their circles."""
    step = end - start
    along, length = product(start, step), product(step, step)
    excess = product(start, start) - product(points, points)
    root = np.sqrt(np.maximum(along**2 - length * excess, 0.0))
    # A chord found a rounding error beyond its end meets the circle there, however flat it runs along the circle.
    share = np.clip(np.where(rising, root - along, -root - along) / length, 0.0, 1.0)
    at = start + share[:, None] * step
    cross = points[:, 0] * at[:, 1] - points[:, 1] * at[:, 0]
    angle: Array = np.arctan2(cross, product(points, at))
    return angle
