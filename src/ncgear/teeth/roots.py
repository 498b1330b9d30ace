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
from ncgear.teeth.flank import Flanks
from ncgear.teeth.rounding import AGREEMENT, rounding_of

STEPS = 20


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
        flanks = self.flanks
        at, tool = flanks.curve.at_length(sigma_mm), flanks.tool.at_length(sigma_mm)
        normal, radius = self.normal[tooth], flanks.root_radius_mm[2 * tooth + 1]
        distance = np.sum((self.center_mm[tooth] - tool.position) * normal, axis=-1) + radius
        tilt, square = np.sum(normal * tool.tangent, axis=-1), -np.sum(normal * tool.normal, axis=-1)
        across = tilt[..., None] * at.tangent + square[..., None] * at.normal
        along = square[..., None] * at.tangent - tilt[..., None] * at.normal
        speed = (at.curvature + tool.curvature) * distance + square
        return at.position + distance[..., None] * across, speed[..., None] * along


def roots_of(flanks: Flanks) -> Roots:
    """The root lands of all spaces."""
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
    end[front] = _feet(flanks, first, edge, flanks.rounding.lowest_mm[front])
    end[back] = _feet(flanks, last.center_mm, edge, last.lowest_mm) - turn
    return Roots(flanks, first, normal, end)


def _feet(flanks: Flanks, center: Array, edge: Array, start: Array) -> Array:
    """Arc lengths at which the perpendicular from the pitch point to the edge goes through the centres, shape (n,)."""
    sigma = start
    for _ in range(STEPS):
        tool = flanks.tool.at_length(sigma)
        ahead = np.sum((center - tool.position) * edge, axis=1)
        if np.all(np.abs(ahead) <= AGREEMENT * flanks.rack.module_mm):
            return sigma
        sigma = sigma + ahead / np.sum(tool.tangent * edge, axis=1)
    raise ArithmeticError("the end of a fillet on its root land was not found")
