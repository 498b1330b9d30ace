"""Root lands: what the straight edge between the two roundings of a tool's tip leaves at the bottom of a space.

The edge runs along t, with the normal n towards the gear, one radius beyond the roundings' centres.  It touches at the
foot of the perpendicular from the pitch point; a fillet passes into the land where the rounding's centre is that foot:
(Q - P_t) . t = 0.  On a tool of even height that is where the centre stands right under the pitch point; the edge
slopes where the mate is the tool and its tip does.

The sides of all teeth as runs of exact curves, from the tip land down to the root land.

A regular flank starts on the tip land and passes into its fillet tangentially.  Where the tool undercuts the flank, or
its fillet folds, the side is trimmed: see trimming.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.units import in_words
from ncgear.pitch.curve import CurvePoints
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.regular import folded_fillets, regular_depth
from ncgear.teeth.spaces import no_root
from ncgear.teeth.tips import Tips
from ncgear.teeth.tool import AGREEMENT, rounding_of

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


REMEDY = "more teeth of a smaller module are needed, or a smaller range of the ratio"

PROBES = 17
"""Places on each land at which its folding is looked at; a land is a sixth of a pitch, the curvature changes slowly."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Runs of curves in the order of flanks and, within a flank, from the tip inwards.

    ``owner`` (the flank), ``kind`` (FLANK or FILLET), ``start`` and ``end`` (parameters) have shape (runs,); ``tip_mm``
    (shape (2 z,)) is the arc length of the tip land's end at each flank; ``roots`` tells where the fillets end.  A
    flank's parameter is the height over the rack's pitch line in mm, a fillet's the arc length in mm.
    """

    owner: IndexArray
    kind: IndexArray
    start: Array
    end: Array
    tip_mm: Array
    roots: Roots

    def flank_range(self) -> tuple[Array, Array]:
        """Greatest and least height of the working flank at each flank, shape (2 z,) each."""
        on_flank, count = self.kind == FLANK, len(self.tip_mm)
        top, bottom = np.full(count, -np.inf), np.full(count, np.inf)
        np.maximum.at(top, self.owner[on_flank], self.start[on_flank])
        np.minimum.at(bottom, self.owner[on_flank], self.end[on_flank])
        return top, bottom


def regular_sides(tips: Tips) -> tuple[Sides, Mask]:
    """All sides as if regular, and which flanks are not."""
    flanks = tips.flanks
    every, depth = np.arange(flanks.count), flanks.flank_depth_mm
    deepest = float(np.max(depth))
    undercut = regular_depth(flanks, deepest) < depth if deepest > 0.0 else np.zeros(flanks.count, dtype=bool)
    roots = roots_of(flanks)
    sides = Sides(
        owner=np.repeat(every, 2),
        kind=np.tile([FLANK, FILLET], flanks.count),
        start=np.column_stack([tips.height_mm, flanks.rolled_mm(every, -depth)]).ravel(),
        end=np.column_stack([-depth, roots.end_mm]).ravel(),
        tip_mm=tips.at_mm,
        roots=roots,
    )
    return sides, undercut | folded_fillets(flanks)


def refuse_folded_lands(flanks: Flanks, sides: Sides) -> None:
    """Refuse a pitch curve that is too sharply curved for its tip and root lands.

    A tip land, parallel to the pitch curve, folds where the curve's hollow radius is less than its height; a root land
    where it is deeper than the radius with which gear and tool turn about each other, their curvatures added.  Raises
    NoSuchMechanism with the radius, the tooth and the angle.
    """
    _refuse_folded_tips(flanks, sides)
    start, end = sides.roots.lands()
    sigma = _probes(start, end)
    depth, limit = sides.roots.folding(np.arange(start.size)[:, None], sigma)
    tooth, place = _worst(depth / limit)
    if depth[tooth, place] < limit[tooth, place]:
        return
    raise NoSuchMechanism(
        f"the root of the space after tooth {tooth + 1} of the {flanks.curve.gear.value} gear folds at phi1 = "
        f"{_angle(flanks, sigma[tooth, place])}: gear and tool turn about each other with a radius of "
        f"{limit[tooth, place]:.4g} mm there, less than its depth of {depth[tooth, place]:.4g} mm; {REMEDY}",
        key="gears.teeth",
    )


def _refuse_folded_tips(flanks: Flanks, sides: Sides) -> None:
    back, front = np.arange(0, flanks.count, 2), np.arange(1, flanks.count, 2)
    sigma = _probes(sides.tip_mm[back], sides.tip_mm[front])
    height = np.maximum(flanks.tip_height_mm[back], flanks.tip_height_mm[front])
    folding = -height[:, None] * flanks.curve.at_length(sigma).curvature
    tooth, place = _worst(folding)
    if folding[tooth, place] < 1.0:
        return
    raise NoSuchMechanism(
        f"the {flanks.curve.gear.value} pitch curve is hollow with a radius of "
        f"{height[tooth] / folding[tooth, place]:.4g} mm at phi1 = {_angle(flanks, sigma[tooth, place])}, less "
        f"than the height of {height[tooth]:.4g} mm of tooth {tooth + 1} there; {REMEDY}",
        key="gears.teeth",
    )


def _probes(start: Array, end: Array) -> Array:
    """Arc lengths along lands, shape (z, PROBES)."""
    probes: Array = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, PROBES)
    return probes


def _worst(values: Array) -> tuple[int, int]:
    """Row and column of the largest value."""
    row, column = np.unravel_index(int(np.argmax(values)), values.shape)
    return int(row), int(column)


def _angle(flanks: Flanks, sigma: float) -> str:
    return in_words(float(flanks.curve.driving_angle(np.array(sigma))))
