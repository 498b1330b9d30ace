"""The spaces between teeth: their depth, their rounding, and the land at their bottom.

A space is as deep as the tool goes, or shallower where the tool would undercut the flanks.  The flank ends at a depth
f, where the tool's rounded tip begins.  A rack or a pinion cutter has a depth of its own; the mating gear as a tool is
rounded at the ends of its own flanks, so that it reaches as deep as its tips need.

The straight edge between the two roundings of a tool's tip leaves the root land at the bottom of a space.  The edge
runs along t, with the normal n towards the gear, one radius beyond the roundings' centres Q.  It touches at the foot of
the perpendicular from the pitch point P_t; a fillet passes into the land where the rounding's centre is that foot: (Q -
P_t) . t = 0.  On a tool of even height the centre stands right under the pitch point there; the edge slopes where the
tool is the mate and the mate's tip slopes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ncgear.errors import NoSuchMechanism, Unanswered, searched_for
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.plane import along, as_complex, as_points
from ncgear.numerics.zeros import zeros_by_slope
from ncgear.pitch.curve import ClosedPitchCurve, CurvePoints
from ncgear.teeth.flank import Flanks, SpaceTurn, flank_name
from ncgear.teeth.regular import CLEAR_OF_CUSPS, regular_depth
from ncgear.teeth.tool import AGREEMENT, PinionCircle, RackLine, rounding_of, rounding_rates

ByRadius = Callable[[Array, IndexArray], tuple[Array, Array]]
"""From radii and numbers of flanks or teeth to values and how fast they grow with the radius, shape (n,) each."""

ROUND_ENOUGH = 0.9
"""Largest radius of a rounding, as a share of f / sin(alpha), the way from the flank's end to the pitch point.  With
the whole way the rounding's centre would pass the pitch point, and the fillet would fold."""

LEAST_FLAT = 0.02
"""Least flat, in modules, between the two roundings of a tool's tooth, so that the root land has a length."""


def cut_spaces(flanks: Flanks, avoid_undercut: bool) -> tuple[Flanks, Mask]:
    """The flanks as deep as a rack or pinion cutter cuts them, and which of them it undercuts at full depth."""
    tool, rack = flanks.tool, flanks.rack
    assert not isinstance(tool, ClosedPitchCurve)
    full, slant = flanks.full_root_mm, flanks.slant
    depth = tool.flank_depth_mm(slant, full, flanks.root_radius_mm)
    # Searched a little deeper than the space is, so that spaces get shallower by degrees, without a jump between the
    # sections of helical teeth.
    regular = regular_depth(flanks, float(full.max()) / CLEAR_OF_CUSPS)
    undercut = regular < depth
    allowed = CLEAR_OF_CUSPS * regular if avoid_undercut else np.full(flanks.count, np.inf)
    every, sine = np.arange(flanks.count), np.broadcast_to(slant.sine, flanks.count)
    beside = np.where(flanks.side > 0.0, every + 1, every - 1) % flanks.count

    def bounded(radius: Array, flank: IndexArray) -> tuple[Array, Array]:
        # The tool's tip is level, though its rounding ends higher beside the flatter flank.
        other, own = beside[flank], flanks.slant.of(flank)
        depths = [
            allowed[flank],
            allowed[other] + radius * (sine[flank] - sine[other]),
            tool.flank_depth_mm(own, full[flank], radius),
        ]
        rates = [
            np.zeros_like(radius),
            sine[flank] - sine[other],
            tool.flank_depth_per_radius(own, full[flank], radius),
        ]
        return np.min(depths, axis=0), np.choose(np.argmin(depths, axis=0), rates)

    radii = _largest_radii(flanks, np.minimum(of_spaces(allowed), depth), rack.root_radius_mm)
    if flanks.is_turned or not isinstance(tool, RackLine):
        # Play leaves the driven gear's teeth thicker, and the rack's thinner, before its idle flanks are turned.
        radii = _fitted(flanks, radii, bounded)
    depth = bounded(radii, every)[0]
    return replace(flanks, flank_depth_mm=depth, root_radius_mm=radii), undercut


def mated_spaces(flanks: Flanks, depth_mm: Array, radius_mm: Array) -> Flanks:
    """The flanks as deep as their mates touch, with bottoms of ``radius_mm`` or the most that fits; all (2 z,)."""
    radii = _largest_radii(flanks, depth_mm, radius_mm)
    deep = replace(flanks, flank_depth_mm=depth_mm)
    rounded = replace(deep, root_radius_mm=_fitted(deep, radii, lambda r, i: (depth_mm[i], np.zeros_like(r))))
    lost = np.nonzero(np.isnan(rounded.root_depth_mm))[0]
    if lost.size:
        raise no_root(flanks, int(lost[0]), "no rounded tip fits the mate's tooth")
    return rounded


def of_spaces(values: Array) -> Array:
    """The lesser value of the two flanks of each space; a space lies between a front flank and the next back flank."""
    least = np.roll(values, -1).reshape(-1, 2).min(axis=1)
    return np.roll(np.repeat(least, 2), 1)


def _largest_radii(flanks: Flanks, depth: Array, wanted: Array | float) -> Array:
    """Radii up to the wanted one without folds; raises NoSuchMechanism without a flank below the pitch curve."""
    if not np.all(depth > 0.0):
        raise no_root(flanks, int(np.nonzero(~(depth > 0.0))[0][0]), "no flank below the pitch curve is regular")
    most = ROUND_ENOUGH * depth / flanks.slant.sine
    return of_spaces(np.minimum(wanted, most))


def _fitted(flanks: Flanks, radii: Array, depth_of: ByRadius) -> Array:
    """The radii, reduced where the tool's tooth is too narrow for them, or its tip would slope beyond 45 degrees."""
    front, back, turn = _sides_of_spaces(flanks)
    module = flanks.rack.module_mm

    def flats(radius: Array, number: IndexArray) -> tuple[Array, Array]:
        flank, radius = np.concatenate([front[number], back[number]]), np.tile(radius, 2)
        slant, crossing, side = flanks.slant.of(flank), flanks.crossing_mm[flank], flanks.side[flank]
        depth = depth_of(radius, flank)
        trial = rounding_of(flanks.tool, module, slant, crossing, side, depth[0], radius)
        rates = rounding_rates(flanks.tool, slant, crossing, side, depth, radius, trial)
        (first, last), rate = trial.lowest_mm.reshape(2, -1), np.subtract(*rates[0].reshape(2, -1)[::-1])
        slope, steeper = (np.subtract(*values.reshape(2, -1)[::-1]) for values in (trial.depth_mm, rates[1]))
        return last + turn[number] - first - np.abs(slope), rate - np.sign(slope) * steeper

    with searched_for(lambda number: flank_name(flanks, int(front[number])), "gears.teeth"):
        fitting = _largest_fitting(flats, radii[front], LEAST_FLAT * module, AGREEMENT * module)
    if np.isnan(fitting).any():
        raise _pointed(flanks, int(front[np.isnan(fitting)][0]))
    fitted = np.empty(flanks.count)
    fitted[front] = fitted[back] = fitting
    return fitted


def _sides_of_spaces(flanks: Flanks) -> tuple[IndexArray, IndexArray, Array]:
    """Front and back flank of each space, and the arc length by which the back flank stands beyond the seam."""
    front = np.arange(1, flanks.count, 2)
    back = (front + 1) % flanks.count
    return front, back, np.where(back == 0, flanks.curve.length_mm, 0.0)


def _largest_fitting(flats: ByRadius, most_mm: Array, least_mm: float, within_mm: float) -> Array:
    """Largest radii, at most ``most_mm`` (shape (n,)), that leave flats of ``least_mm`` between two roundings.

    The flats are at most twice ``within_mm`` longer.  ``flats`` gives them at radii for tooth numbers, NaN where a tip
    is too pointed for its radius.  The result is NaN where not even sharp corners leave a flat.
    """
    radii, every = most_mm.copy(), np.arange(most_mm.size)
    most = flats(radii, every)[0] - least_mm
    tight = every[~(most >= 0.0)]
    if not tight.size:
        return radii
    sharp = flats(np.zeros(tight.size), tight)[0] - least_mm
    pointed = ~(sharp >= 0.0)
    radii[tight[pointed]] = np.nan
    tight, sharp = tight[~pointed], sharp[~pointed]

    def excess(radius: Array, row: IndexArray) -> tuple[Array, Array]:
        flat, rate = flats(radius, tight[row])
        return flat - least_mm, rate

    ends = np.zeros(tight.size), most_mm[tight]
    try:
        radii[tight] = zeros_by_slope(excess, *ends, (sharp, most[tight]), within_mm)
    except Unanswered as error:
        raise Unanswered(error.problem, rows=tight[list(error.rows)].tolist()) from error
    return radii


def _pointed(flanks: Flanks, flank: int) -> NoSuchMechanism:
    if not isinstance(flanks.tool, PinionCircle):
        return no_root(flanks, flank, "the mate's tooth is pointed before its depth")
    return NoSuchMechanism(
        f"a pinion cutter of {flanks.tool.teeth} teeth is pointed before it is as deep as the space beside "
        f"{flank_name(flanks, flank)}; more cutter teeth, or kind: mate, are needed",
        key="gears.cutter.teeth",
    )


def no_root(flanks: Flanks, flank: int, problem: str) -> NoSuchMechanism:
    """The error for a space that cannot be cut, with the name of a flank beside it."""
    return NoSuchMechanism(
        f"the space beside {flank_name(flanks, flank)} cannot be cut: {problem}; more teeth of a smaller module are "
        "needed",
        key="gears.teeth",
    )


STEPS = 20
"""Steps of Newton's method to the end of a fillet; a few do."""

LEAST_COSINE = 0.2
"""Least cosine of the edge's slope that a step is divided by; tips slope by 45 degrees at most."""


FOOT_IN_MODULES = 1e-9
"""Error along the pitch curve at which a foot counts as found; the height's error is its square."""


@dataclass(frozen=True, eq=False)
class Roots:
    """The edges that leave root lands, in the tool's frame, and the beginnings and ends of lands.

    ``center_mm`` (shape (z, 2)) is the centre of the rounding beside each tooth's front flank, ``normal`` (shape
    (z, 2)) the edge's normal, and ``end_mm`` (shape (2 z,)) the arc length at which each fillet passes into its land.
    """

    flanks: Flanks
    center_mm: Array
    normal: Array
    end_mm: Array

    @property
    def unturned(self) -> Roots:
        """The lands as the tool leaves them, without play."""
        return replace(self, flanks=self.flanks.unturned)

    def lands(self) -> tuple[Array, Array]:
        """Arc lengths of the beginning and the end of the land after each tooth, shape (z,) each."""
        return self.end_mm[1::2], np.append(self.end_mm[2::2], self.end_mm[0] + self.flanks.curve.length_mm)

    def feet(self) -> tuple[Array, Array]:
        """Arc lengths of both ends of the lands without play, and their heights, (z, 2); NaN for none."""
        ends, tooth = np.stack(self.lands(), axis=1), np.arange(len(self.center_mm))
        points = as_complex(self.unturned.land(tooth[:, None], ends)[0]).ravel()
        within = FOOT_IN_MODULES * self.flanks.rack.module_mm
        foot, height = self.flanks.curve.feet(points, ends.ravel(), within)
        return foot.reshape(ends.shape), height.reshape(ends.shape)

    def land(self, tooth: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Points of the lands after teeth (numbered from 0) at arc lengths, and derivatives; shapes broadcast."""
        at, tool = self.flanks.curve.at_length(sigma_mm), self.flanks.tool.at_length(sigma_mm)
        distance, tilt, square = self._edge(tooth, tool)
        tangent, normal = as_complex(at.tangent), as_complex(at.normal)
        speed = (at.curvature + tool.curvature) * distance + square
        point = as_complex(at.position) + distance * (tilt * tangent + square * normal)
        land = as_points(point), as_points(speed * (square * tangent - tilt * normal))
        return self.flanks.bottom(tooth, sigma_mm, 1.0, land)

    def height(self, tooth: IndexArray, sigma_mm: Array) -> Array:
        """Heights over the pitch curve, negative, of the lands after teeth without play; shapes broadcast."""
        distance, _, square = self._edge(tooth, self.flanks.tool.at_length(sigma_mm))
        return distance * square

    def folding(self, tooth: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Depth of the lands along the edges' normals, and the depth (or infinity) at which they would fold."""
        tool = self.flanks.tool.at_length(sigma_mm)
        turning = self.flanks.curve.curvature_at(sigma_mm) + tool.curvature
        distance, _, square = self._edge(tooth, tool)
        limit = np.full(turning.shape, np.inf)
        np.divide(-square, turning, out=limit, where=turning > 0.0)
        return distance, limit

    def _edge(self, tooth: IndexArray, tool: CurvePoints) -> tuple[Array, Array, Array]:
        """Distance of the edges from the pitch point along their normals, and the normals' parts along and outwards."""
        normal, radius = as_complex(self.normal)[tooth], self.flanks.root_radius_mm[2 * tooth + 1]
        distance = along(normal, as_complex(self.center_mm)[tooth] - as_complex(tool.position)) + radius
        return distance, along(normal, as_complex(tool.tangent)), -along(normal, as_complex(tool.normal))


def roots_of(flanks: Flanks) -> Roots:
    """The root lands of all spaces; raises NoSuchMechanism for a space without a land, and names the tooth."""
    front, back, turn = _sides_of_spaces(flanks)
    first = flanks.rounding.center_mm[front]
    # Beyond the seam the tool has turned on: its next tooth stands elsewhere in its own frame.
    last = rounding_of(
        flanks.tool,
        flanks.rack.module_mm,
        flanks.slant.of(back),
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


PLACES = 33
"""Places on each fillet and land for comparing the depth of a space, which varies smoothly."""

AS_DEEP = 0.02
"""Difference of depth in modules over which the weight of places as the deepest fades: so the turn of the bottom
changes in the middle of a land of even depth, and does not jump from section to section of helical teeth."""


def sweep_of(roots: Roots, start_mm: Array) -> SpaceTurn:
    """The places where the turn of spaces' bottoms changes, so that the mate's tips stay free over the whole play.

    Over the play the tool sweeps each space, and its deepest point, nearest to the axis or in a ring farthest from it,
    runs along an arc about the axis.  ``start_mm`` (shape (2 z,)) are the arc lengths at which fillets begin.
    """
    flanks, (first, last) = roots.flanks.unturned, roots.lands()
    front, back, turn = _sides_of_spaces(flanks)
    share, tooth = np.linspace(0.0, 1.0, PLACES), np.arange(first.size)
    plain = roots.unturned
    lands = [plain.land(tooth, end)[1] for end in (first, last)]
    pace = np.empty(flanks.count)
    for side, land in zip((front, back), lands, strict=True):
        fillet = flanks.fillet(side, roots.end_mm[side])[1]
        pace[side] = np.linalg.norm(fillet, axis=1) / np.linalg.norm(land, axis=1)
    touched = roots.end_mm[:, None] + (start_mm - roots.end_mm)[:, None] * share
    fillets = flanks.fillet(np.arange(flanks.count)[:, None], touched)[0]
    place = roots.end_mm[:, None] - pace[:, None] * (touched - roots.end_mm[:, None])
    rolled = first[:, None] + (last - first)[:, None] * share
    points = fillets[front, ::-1], plain.land(tooth[:, None], rolled)[0], fillets[back]
    places = np.concatenate([place[front, ::-1], rolled, place[back] + turn[:, None]], axis=1)
    radius = np.linalg.norm(np.concatenate(points, axis=1), axis=2) * (-1.0 if flanks.curve.is_ring else 1.0)
    over = (radius - radius.min(axis=1, keepdims=True)) / (AS_DEEP * flanks.rack.module_mm)
    weight = np.exp(-over) * _widths(places)
    at = np.sum(weight * places, axis=1) / np.sum(weight, axis=1)
    begin, end = places[:, 0], places[:, -1]
    return SpaceTurn(roots.end_mm, pace, at, (at - begin) * (end - at) / (end - begin) / 2.0)


def _widths(places: Array) -> Array:
    """The part of its row that each place stands for, shape (n, m)."""
    steps = np.diff(places, axis=1, prepend=places[:, :1], append=places[:, -1:])
    return (steps[:, :-1] + steps[:, 1:]) / 2.0


def _feet(flanks: Flanks, flank: IndexArray, center: Array, edge: Array, start: Array) -> Array:
    """Arc lengths at which perpendiculars from the pitch point to the edge meet centres, (n,); or NoSuchMechanism."""
    sigma, agreement = start, AGREEMENT * flanks.rack.module_mm
    for _ in range(STEPS):
        tool = flanks.tool.at_length(sigma)
        ahead = np.sum((center - tool.position) * edge, axis=1)
        if np.all(np.abs(ahead) <= agreement):
            return sigma
        sigma = sigma + ahead / np.maximum(np.sum(tool.tangent * edge, axis=1), LEAST_COSINE)
    lost = int(flank[~(np.abs(ahead) <= agreement)][0])
    raise no_root(flanks, lost, "the tool's tip slopes too much to leave a root land")
