"""Root lands: what the straight edge between the two roundings of a tool's tip leaves at the bottom of a space.

The edge runs along t, with the normal n towards the gear, one radius beyond the roundings' centres.  It touches at the
foot of the perpendicular from the pitch point; a fillet passes into the land where the rounding's centre is that foot:
(Q - P_t) . t = 0.  On a tool of even height that is where the centre stands right under the pitch point; the edge
slopes where the mate is the tool and its tip does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.curve import CurvePoints
from ncgear.teeth.flank import Flanks
from ncgear.teeth.rounding import AGREEMENT, rounding_of
from ncgear.teeth.spaces import no_root

STEPS = 20

LEAST_COSINE = 0.2
"""Least cosine of the edge's slope that a step is divided by; tips slope by 45 degrees at most."""


@dataclass(frozen=True, eq=False)
class Roots:
    """The edges that leave root lands, in the tool's frame, and where lands begin and end.

    ``center_mm`` (of the rounding beside each tooth's front flank) and ``normal`` have shape (z, 2); ``end_mm`` (shape
    (2 z,)) is the arc length at which each fillet passes into its land.
    """

    flanks: Flanks
    center_mm: Array
    normal: Array
    end_mm: Array

    def lands(self) -> tuple[Array, Array]:
        """Arc lengths at which the land after each tooth begins and ends, shape (z,) each."""
        return self.end_mm[1::2], np.append(self.end_mm[2::2], self.end_mm[0] + self.flanks.curve.length_mm)

    def land(self, tooth: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Points of the lands after teeth (numbered from 0) at arc lengths, and derivatives; shapes broadcast.

        The edge turns with K = k + k_t about the pitch point, while the foot of the perpendicular moves along it.
        """
        at, tool = self.flanks.curve.at_length(sigma_mm), self.flanks.tool.at_length(sigma_mm)
        distance, tilt, square = self._edge(tooth, tool)
        across = tilt[..., None] * at.tangent + square[..., None] * at.normal
        along = square[..., None] * at.tangent - tilt[..., None] * at.normal
        speed = (at.curvature + tool.curvature) * distance + square
        return at.position + distance[..., None] * across, speed[..., None] * along

    def folding(self, tooth: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Depth of the lands along the edges' normals, and the depth at which they would fold, infinite where none."""
        turning = self.flanks.curve.at_length(sigma_mm).curvature + self.flanks.tool.at_length(sigma_mm).curvature
        distance, _, square = self._edge(tooth, self.flanks.tool.at_length(sigma_mm))
        limit = np.full(turning.shape, np.inf)
        np.divide(-square, turning, out=limit, where=turning > 0.0)
        return distance, limit

    def _edge(self, tooth: IndexArray, tool: CurvePoints) -> tuple[Array, Array, Array]:
        """Distance of the edges from the pitch point along their normals, and the normals' parts along and outwards."""
        normal, radius = self.normal[tooth], self.flanks.root_radius_mm[2 * tooth + 1]
        distance = np.sum((self.center_mm[tooth] - tool.position) * normal, axis=-1) + radius
        return distance, np.sum(normal * tool.tangent, axis=-1), -np.sum(normal * tool.normal, axis=-1)


def roots_of(flanks: Flanks) -> Roots:
    """The root lands of all spaces.

    Raises NoSuchMechanism, naming the tooth, where a space has none.
    """
    front = np.arange(1, flanks.count, 2)
    back = (front + 1) % flanks.count
    turn = np.where(back == 0, flanks.curve.length_mm, 0.0)
    first = flanks.rounding.center_mm[front]
    # Beyond the seam the tool has turned on: its next tooth stands elsewhere in its own frame.
    last = rounding_of(
        flanks.tool,
        flanks.rack,
        flanks.crossing_mm[back] + turn,
        flanks.side[back],
        flanks.flank_depth_mm[back],
        flanks.root_radius_mm[back],
    )
    edge = (last.center_mm - first) / np.linalg.norm(last.center_mm - first, axis=1, keepdims=True)
    normal = np.column_stack([-edge[:, 1], edge[:, 0]])
    outwards = flanks.tool.at_length(flanks.rounding.lowest_mm[front]).normal
    normal *= np.sign(np.sum(normal * outwards, axis=1, keepdims=True))
    end = np.empty(flanks.count)
    end[front] = _feet(flanks, front, first, edge, flanks.rounding.lowest_mm[front])
    end[back] = _feet(flanks, back, last.center_mm, edge, last.lowest_mm) - turn
    return Roots(flanks, first, normal, end)


def _feet(flanks: Flanks, flank: IndexArray, center: Array, edge: Array, start: Array) -> Array:
    """Arc lengths at which the perpendicular from the pitch point to the edge goes through the centres, shape (n,).

    Raises NoSuchMechanism, naming the tooth, where there is none.
    """
    sigma, agreement = start, AGREEMENT * flanks.rack.module_mm
    for _ in range(STEPS):
        tool = flanks.tool.at_length(sigma)
        ahead = np.sum((center - tool.position) * edge, axis=1)
        if np.all(np.abs(ahead) <= agreement):
            return sigma
        sigma = sigma + ahead / np.maximum(np.sum(tool.tangent * edge, axis=1), LEAST_COSINE)
    lost = int(flank[~(np.abs(ahead) <= agreement)][0])
    raise no_root(flanks, lost, "the tool's tip slopes too much to leave a root land")
