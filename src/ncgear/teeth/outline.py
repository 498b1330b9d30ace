"""The closed outline of a gear, sampled from its exact curves to a chord tolerance.

The last check is whether the outline is a simple polygon: it finds faults that no single tooth's side can show.
"""

from __future__ import annotations

import re
from functools import partial
from math import atan2, degrees, sqrt

import numpy as np
import shapely
from shapely import Polygon

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.plane import signed_area
from ncgear.pitch.curve import ClosedPitchCurve
from ncgear.pitch.shape import Gear
from ncgear.teeth.chords import sampled, sampled_within, straddled
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.sides import Sides
from ncgear.teeth.stretch import Curve, CurveStretch, joined, parted, split
from ncgear.teeth.tips import Tips
from ncgear.teeth.tool import RackLine
from ncgear.teeth.toothed_arc import kept_teeth


@dataclass(frozen=True)
class ChordTolerance:
    """Largest distance of chords from the exact curve: on the working flanks, and on fillets and lands.

    With ``straddling`` the chords of flanks stray to both sides.  Their number is then less by the square root of 2,
    but touching flanks overlap as much as they gape.
    """

    flanks_mm: float
    elsewhere_mm: float
    straddling: bool = False


Toleranced = tuple[CurveStretch, float]
"""Curves and the tolerance of their chords."""


def outline_points(tips: Tips, sides: Sides, chords: ChordTolerance) -> Array:
    """The outline in mm, shape (n, 2), counter-clockwise, first point not repeated.

    No chord strays farther from the exact curve than its tolerance.  The points are on the curve, except points of
    hollow and of straddling flanks.
    """
    flanks, elsewhere = tips.flanks, chords.elsewhere_mm
    runs, fillets, *lands = whole_curves(tips, sides)
    # A flank works no deeper than its mate reaches.
    parts = parted(runs, -tips.met_depth_mm[runs.owner])
    works = (parts.start + parts.end) / 2.0 > -tips.met_depth_mm[parts.owner]
    near = _near_fillets(tips, elsewhere)[fillets.owner]
    on_curve: list[Toleranced] = [(fillets.kept(~near), elsewhere), *((land, elsewhere) for land in lands)]
    within: list[Toleranced] = [(fillets.kept(near), elsewhere)]
    both_sides: list[Toleranced] = []
    # Chords of hollow flanks stay in the material too, so that written gears turn freely.
    freely = within if _is_hollow(flanks) else on_curve
    freely.append((parts.kept(~works), elsewhere))
    (both_sides if chords.straddling else freely).append((parts.kept(works), chords.flanks_mm))
    # Arc length runs clockwise about the driving gear and round a ring's hole, against the clock about other gears.
    material = -1.0 if flanks.curve.gear is Gear.DRIVING else 1.0
    ways = (sampled, on_curve), (partial(sampled_within, material=material), within), (straddled, both_sides)
    found = [way(*_together(flanks, curves)) for way, curves in ways if any(curve.owner.size for curve, _ in curves)]
    points, keys = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
    outline = points[np.argsort(keys, kind="stable")]
    return outline[::-1] if signed_area(outline) < 0.0 else outline


def _together(flanks: Flanks, curves: list[Toleranced]) -> tuple[CurveStretch, Array]:
    """The real rows of all curves as rows of a single curve, and the tolerance of each row."""
    rows = _real(flanks, joined([curve for curve, _ in curves]))
    tolerance = np.repeat([tolerance for _, tolerance in curves], [curve.owner.size for curve, _ in curves])
    return rows, tolerance[rows.owner]


def _near_fillets(tips: Tips, tolerance_mm: float) -> Mask:
    """Whether the mate's tips come so near beside each flank that the fillet's chords must stay in the material.

    A tip leaves along the flank, with a radius of a module or less against the flank's; a tenth of a module is enough.
    """
    flanks = tips.flanks
    if _is_hollow(flanks):
        return np.ones(flanks.count, dtype=bool)
    module = flanks.rack.module_mm
    clear = min(sqrt(2.0 * module * tolerance_mm), module / 10.0)
    return flanks.flank_depth_mm - tips.met_depth_mm < clear


def _is_hollow(flanks: Flanks) -> bool:
    """Whether flanks may be hollow, as on concave pitch curves, or the mate's own tips have cut the fillets."""
    return flanks.curve.curvature_bounds[0] < 0.0 or isinstance(flanks.tool, ClosedPitchCurve)


def exact_curves(tips: Tips, sides: Sides) -> list[CurveStretch]:
    """All smooth curves of the outline by growing arc length, cut at corners, joints and tip reliefs."""
    flanks = tips.flanks
    runs, *others = whole_curves(tips, sides)
    if flanks.rack.relief is not None:
        runs = parted(runs, np.full(runs.owner.size, flanks.rack.relief.start_mm))
    return [_real(flanks, stretch) for stretch in (runs, *others)]


def whole_curves(tips: Tips, sides: Sides) -> list[CurveStretch]:
    """All curves of the outline, whole between its corners: flanks, fillets, tip lands, root lands, in this order.

    Gears that turn less than once have the first root land and the heel too, or raise NoSuchMechanism without room.
    """
    flanks = tips.flanks
    sides_runs = [_side_runs(flanks, sides, kind) for kind in (FLANK, FILLET)]
    curves = [*sides_runs, _tip_lands(flanks, sides), _root_lands(flanks, sides)]
    return curves if flanks.made is None else kept_teeth(curves, flanks, flanks.made)


def _real(flanks: Flanks, stretch: CurveStretch) -> CurveStretch:
    """The stretch without empty curves, cut at the joints of the pitch curve."""
    real = stretch.kept(np.abs(stretch.end - stretch.start) > 1e-12 * flanks.rack.module_mm)
    return split(real, flanks.curve.joints_around_mm)


def _side_runs(flanks: Flanks, sides: Sides, kind: int) -> CurveStretch:
    """Runs of one kind in the sense of growing arc length: inwards on front flanks and outwards on back flanks."""
    curve = (flanks.flank, flanks.fillet)[kind]
    chosen = sides.kind == kind
    owner, start, end = sides.owner[chosen], sides.start[chosen], sides.end[chosen]
    outwards = flanks.side[owner] < 0.0
    step = np.arange(sides.owner.size)[chosen]
    first, last = np.searchsorted(sides.owner, owner), np.searchsorted(sides.owner, owner, side="right") - 1
    rank = np.where(outwards, first + last - step, step)
    start, end = np.where(outwards, end, start), np.where(outwards, start, end)
    rolled = np.array([start, end] if kind != FLANK else [flanks.rolled_mm(owner, start), flanks.rolled_mm(owner, end)])
    # A flank turns with the pitch curve, but for its tip relief.
    bounded = kind == FLANK and flanks.rack.relief is None
    turning = np.full(rank.size, _most_turning(flanks) if bounded else np.inf)
    return CurveStretch(curve, owner, start, end, rolled, 4.0 * rank, np.ones(rank.size), turning, np.zeros_like(owner))


def _most_turning(flanks: Flanks) -> float:
    return max(map(abs, flanks.curve.curvature_bounds))


def _tip_lands(flanks: Flanks, sides: Sides) -> CurveStretch:
    """From each tooth's back flank to its front flank, after the last run of the back flank.

    A land's height over the pitch curve changes evenly from one flank's end to the other's.  The land is parallel to
    the curve where both heights are equal, and does not jump where they become unequal from section to section of
    helical teeth.
    """
    back = np.arange(0, flanks.count, 2)
    start, end = sides.tip_mm[back], sides.tip_mm[back + 1]
    low = flanks.tip_height_mm[back]
    # A pointed tooth has a land of a single point.
    width = np.where(end > start, end - start, np.inf)
    rise, rate = (flanks.tip_height_mm[back + 1] - low) / width, 1.0 / width

    def curve(flank: IndexArray, sigma: Array) -> tuple[Array, Array]:
        tooth = flank // 2
        along = sigma - start[tooth]
        land = flanks.offset(sigma, low[tooth] + rise[tooth] * along, rise[tooth])
        return flanks.over_tip(tooth, along * rate[tooth], rate[tooth], land)

    # A level land that play does not turn is parallel to the pitch curve.
    parallel = (rise == 0.0) & (not flanks.is_turned)
    return _lands(curve, sides, back, np.array([start, end]), parallel)


def _root_lands(flanks: Flanks, sides: Sides) -> CurveStretch:
    """From each tooth's front flank to the next tooth's back flank, after the last run of the front flank."""
    front, rolled = np.arange(1, flanks.count, 2), np.array(sides.roots.lands())
    # A rack's edge keeps its angle to the pitch curve's tangent, but for the turning of bottoms.
    parallel = np.full(front.size, isinstance(flanks.tool, RackLine) and flanks.sweep is None)
    return _lands(lambda flank, sigma: sides.roots.land(flank // 2, sigma), sides, front, rolled, parallel)


def _lands(curve: Curve, sides: Sides, owner: IndexArray, rolled: Array, parallel: Mask) -> CurveStretch:
    """Lands that follow the last runs of their owners, every other flank; those ``parallel`` to the curve turn with it.

    ``rolled`` (shape (2, z)) are the arc lengths of their beginnings and ends.
    """
    rank = np.asarray(4.0 * (np.searchsorted(sides.owner, owner, side="right") - 1) + 1.0, dtype=float)
    turning = np.where(parallel, _most_turning(sides.roots.flanks), np.inf)
    return CurveStretch(
        curve, owner, rolled[0], rolled[1], rolled, rank, np.ones(rank.size), turning, np.zeros_like(owner)
    )


REMEDY = "more teeth, a smaller addendum or dedendum, or a less uneven ratio avoids that"


def simple_polygon(outline_mm: Array, key: str) -> Polygon:
    """The polygon of an outline in mm, (n, 2); raises NoSuchMechanism for ``key`` where it crosses itself."""
    polygon = Polygon(outline_mm)
    if not polygon.is_valid:
        raise NoSuchMechanism(f"the tooth outline crosses itself{_place(polygon)}; {REMEDY}", key=key)
    return polygon


def _place(polygon: Polygon) -> str:
    """The place at which a polygon is invalid, if GEOS gives it: its reason is ``Self-intersection[x y]``."""
    numbers = re.findall(r"-?\d[\d.e+-]*", shapely.is_valid_reason(polygon))
    if len(numbers) < 2:
        return ""
    x, y = float(numbers[0]), float(numbers[1])
    return f" at x = {x:.5g} mm, y = {y:.5g} mm (polar angle {degrees(atan2(y, x)):.4g} deg in the gear's frame)"
