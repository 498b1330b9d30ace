"""The largest round tool, a wire or an end mill, that follows a gear's outline from outside and makes its roots.

At a point p of the outline, with the normal n out of the material, a disc of radius r comes within t of p along n if
its centre is p + (r + t) n.  It clears another point q of the outline, with n . (q - p) > t, while r <= |q - p - t n|^2
/ (2 (n . (q - p) - t)).  The least of these radii over all pairs is the radius of the largest disc that leaves no more
than t anywhere, along the normals: one disc for the narrowest hollow and for the narrowest passage between two teeth,
wherever they are.  With t = 0 and q next to p it is the radius of curvature.  (The shrinking ball of J. Ma, S. W. Bae
and S. Choi, "3D medial axis point approximation using nearest neighbors and the normal field", The Visual Computer 28,
2012.)

Radii of curvature have closed forms.  Fillet: its normal turns by K - v / D^2 per unit of sigma, its speed is as in
teeth/flank.py, so R = rho + K D^3 / (K D^2 - v).  Flank on a concave stretch: R = -sin(alpha) / k - h / sin(alpha).
Tip land there: R = -1 / k - h.  Root lands are convex.
"""

from __future__ import annotations

from math import floor

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.curve import outside
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import whole_curves
from ncgear.teeth.stretch import CurveStretch

ALMOST = 1.0 - 1e-9
"""Share of a curve's way that counts as its end: there the next curve begins, in another direction at an edge."""

SHARES = {kind: np.linspace(0.0, ALMOST, points) for kind, points in enumerate((5, 13, 2, 5))}
"""Shares of every flank, fillet, tip land and root land at which discs are tried first."""

TIP_LAND, ROOT_LAND = 2, 3
"""The kinds of curves beside FLANK and FILLET, in the order of ``whole_curves``."""

MOST_MODULES = 20.0
"""Radius in modules at which discs begin to shrink: far more than any space is wide."""

ROUNDS = 50
"""Rounds of shrinking discs; a few are enough."""

SETTLED = 1e-9
"""Relative change of a radius that counts as rounding."""

WORST, NEAR = 8, 1.05
"""Most places that are refined, and the factor of the smallest disc's radius within which their discs are."""

ZOOMS, ZOOMED = 3, 17
"""Rounds of refinement, and points between the neighbours of a place in each: the last step is a 500th of the first,
and the disc, which is least there, is known to its square."""

PROBES = np.linspace(0.0, 1.0, 13)
"""Shares of a curve at which its radius of curvature is taken; the least radius is then refined."""


@dataclass(frozen=True)
class RoundTool:
    """The largest round tool of one gear; space i lies between teeth i and i + 1.

    ``diameter_mm`` is the diameter of a mill or, for a wire, of its cut, the spark gap included.  It leaves at most
    ``left_mm`` of material.  The space numbered ``space`` holds it: by both sides if ``passage``, else by the hollow of
    one side.  ``hollow_mm`` is the least concave radius of curvature of the outline, in the space numbered
    ``hollow_space``.
    """

    diameter_mm: float
    left_mm: float
    space: int
    passage: bool
    hollow_mm: float
    hollow_space: int


def round_tool(gear: ToothedGear, left_mm: float) -> RoundTool:
    """The largest tool that leaves no more than ``left_mm`` (over 0) anywhere on a gear's outline."""
    outline, count = _Outline(gear), gear.flanks.count
    radius, places = _smallest_disc(outline, MOST_MODULES * gear.flanks.rack.module_mm, left_mm)
    hollow, beside = least_hollow(gear)
    (_, own), *_ = curves = [outline.curve(place) for place in places]
    sides = {flank for kind, flank in curves if kind != ROOT_LAND}

    def space(flank: int) -> int:
        return (flank - 1) % count // 2 + 1

    return RoundTool(2.0 * radius, left_mm, space(own), len(sides) > 1, hollow, space(beside))


class _Outline:
    """The exact outline, normals out of the material; a place is a curve's number plus a share of its way."""

    def __init__(self, gear: ToothedGear) -> None:
        self._curves: list[CurveStretch] = whole_curves(gear.tips, gear.sides)
        order = np.argsort(np.concatenate([curve.rank for curve in self._curves]), kind="stable")
        self.kind = np.concatenate([np.full(curve.owner.size, kind) for kind, curve in enumerate(self._curves)])[order]
        self._row = np.concatenate([np.arange(curve.owner.size) for curve in self._curves])[order]
        # Curves run in the sense of growing arc length, with the material always on the same side.
        self._side = outside(gear.flanks.curve.gear)

    def at(self, place: Array) -> tuple[Array, Array]:
        """Points and unit normals at places of any shape."""
        number = np.floor(place).astype(int)
        share, number = place - number, number % self.kind.size
        kind, row = self.kind[number], self._row[number]
        point, slope = np.empty((*place.shape, 2)), np.empty((*place.shape, 2))
        for own, curve in enumerate(self._curves):
            chosen = kind == own
            if chosen.any():
                point[chosen], slope[chosen] = curve.at(row[chosen], share[chosen])
        normal = self._side * np.stack([-slope[..., 1], slope[..., 0]], axis=-1)
        return point, normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-300)

    def everywhere(self) -> tuple[Array, Array]:
        """Places all around, shape (n,), and the distance of each from the next."""
        numbers = [np.nonzero(self.kind == kind)[0][:, None] + share for kind, share in SHARES.items()]
        steps = [np.full(number.size, SHARES[kind][1]) for kind, number in enumerate(numbers)]
        return np.concatenate([number.ravel() for number in numbers]), np.concatenate(steps)

    def curve(self, place: float) -> tuple[int, int]:
        """The kind of curve at a place, and its flank; a land belongs to the flank before it."""
        number = floor(place) % self.kind.size
        kind = int(self.kind[number])
        return kind, int(self._curves[kind].owner[self._row[number]])


def _free(point: Array, normal: Array, other: Array, left: float) -> Array:
    """Greatest radii of discs that come within ``left`` of points and clear other points; shapes broadcast."""
    arm = other - point
    ahead, square = np.sum(normal * arm, axis=-1), np.sum(arm * arm, axis=-1)
    free: Array = np.full(ahead.shape, np.inf)
    np.divide((square - left * (2.0 * ahead - left)) / 2.0, ahead - left, out=free, where=ahead > left)
    return np.maximum(free, 0.0)


def _smallest_disc(outline: _Outline, most: float, left: float) -> tuple[float, tuple[float, float]]:
    """Radius of the least of all discs, at most ``most``, and the places of its point and the point that it clears."""
    from scipy.spatial import KDTree

    place, step = outline.everywhere()
    point, normal = outline.at(place)
    tree = KDTree(point)

    def holding(rows: IndexArray, radius: float) -> tuple[IndexArray, IndexArray]:
        """The rows whose discs of a radius hold a point, and the points nearest to their centres."""
        center = point[rows] + (radius + left) * normal[rows]
        away, found = tree.query(center, distance_upper_bound=radius * (1.0 - SETTLED))
        held = np.isfinite(away)
        return rows[held], found[held]

    # The bottoms of spaces first: they leave little shrinking for the others.
    radius, bottoms = most, outline.kind[place.astype(int)] == ROOT_LAND
    for first in (np.nonzero(bottoms)[0], np.arange(len(point))):
        # As discs shrink, only discs that hold a point now can hold one later.
        rows = holding(first, NEAR * radius)[0]
        for _ in range(ROUNDS):
            own, other = holding(rows, radius)
            if not own.size:
                break
            # A disc that holds a point is larger than the disc that clears all points there.
            least = own[np.argmin(_free(point[own], normal[own], point[other], left))]
            radius = float(_free(point[least], normal[least], point, left).min())
    own, other = holding(rows, NEAR * radius)
    order = np.argsort(_free(point[own], normal[own], point[other], left))
    # The least disc of each curve, and the point that it clears by the least.
    worst = own[order[np.sort(np.unique(place[own[order]].astype(int), return_index=True)[1])][:WORST]]
    nearest = np.argmin(_free(point[worst, None], normal[worst, None], point, left), axis=1)
    return _zoomed(outline, [place[worst], place[nearest]], [step[worst], step[nearest]], left)


def _zoomed(
    outline: _Outline, places: list[Array], reach: list[Array], left: float
) -> tuple[float, tuple[float, float]]:
    """The least disc next to pairs of places, shape (n,) each, within their reach."""
    pairs, offsets = np.arange(places[0].size), np.linspace(-1.0, 1.0, ZOOMED)
    for _ in range(ZOOMS):
        tried = [at[:, None] + far[:, None] * offsets for at, far in zip(places, reach, strict=True)]
        (point, normal), (there, _) = (outline.at(at) for at in tried)
        free = _free(point[:, :, None], normal[:, :, None], there[:, None], left).reshape(pairs.size, -1)
        least = free.argmin(axis=1)
        places = [tried[0][pairs, least // ZOOMED], tried[1][pairs, least % ZOOMED]]
        reach = [far * 2.0 / (ZOOMED - 1) for far in reach]
    best = int(free.min(axis=1).argmin())
    return float(free[best].min()), (float(places[0][best]), float(places[1][best]))


def least_hollow(gear: ToothedGear) -> tuple[float, int]:
    """Least concave radius of curvature of the outline in mm, and the flank on whose side it is."""
    flanks, found = gear.flanks, []
    for kind, curve in enumerate(whole_curves(gear.tips, gear.sides)[:ROOT_LAND]):
        every = np.arange(curve.owner.size)
        radius = _hollow_mm(flanks, kind, curve, every[:, None], PROBES)
        row, place = np.unravel_index(int(np.argmin(radius)), radius.shape)
        share, reach = PROBES[place], PROBES[1]
        for _ in range(ZOOMS):
            tried = np.clip(share + reach * np.linspace(-1.0, 1.0, ZOOMED), 0.0, 1.0)
            closer = _hollow_mm(flanks, kind, curve, every[row : row + 1, None], tried)[0]
            share, reach = tried[int(np.argmin(closer))], reach * 2.0 / (ZOOMED - 1)
        found.append((float(closer.min()), int(curve.owner[row])))
    return min(found)


def _hollow_mm(flanks: Flanks, kind: int, curve: CurveStretch, rows: IndexArray, share: Array) -> Array:
    """Radii of curvature of one kind of curve at shares; infinite where not concave.  Tip relief is left out."""
    parameter, owner = curve.start[rows] + (curve.end - curve.start)[rows] * share, curve.owner[rows]
    radius = np.full(parameter.shape, np.inf)
    if kind == FILLET:
        at, tool = flanks.at_rolled(owner, parameter), flanks.tool.at_length(parameter)
        arm = flanks.rounding.center_mm[owner] - tool.position
        square, v = np.sum(arm * arm, axis=-1), -np.sum(arm * tool.normal, axis=-1)
        turning = at.curvature + tool.curvature
        turned = turning * square - v
        np.divide(turning * square**1.5, turned, out=radius, where=turned > 0.0)
        return radius + flanks.root_radius_mm[owner]
    sine = flanks.slant.of(owner).sine if kind == FLANK else 1.0
    if kind == FLANK:
        curvature, height = flanks.rolling_curvature(owner, parameter), parameter
    else:
        curvature, height = flanks.curve.at_length(parameter).curvature, flanks.tip_height_mm[owner]
    np.divide(-sine, curvature, out=radius, where=curvature < 0.0)
    return radius - height / sine
