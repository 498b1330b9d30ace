"""The closed outline of a gear, sampled from its exact curves to a chord tolerance.

The last check is whether the outline is a simple polygon: it sees what no single tooth's side can show.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, degrees, sqrt

import numpy as np
import shapely
from shapely import Polygon

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.plane import signed_area
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.teeth.chords import Stretch, parted, sampled, sampled_within, split, straddled
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.sides import Sides
from ncgear.teeth.tips import Tips


@dataclass(frozen=True)
class ChordTolerance:
    """How far chords may stray from the exact curve: on the working flanks, and on fillets and lands.

    With ``straddling`` the chords of flanks stray to both sides.  That takes fewer of them by the square root of 2, but
    touching flanks then overlap as much as they gape.
    """

    flanks_mm: float
    elsewhere_mm: float
    straddling: bool = False


def outline_points(tips: Tips, sides: Sides, chords: ChordTolerance) -> Array:
    """The outline in mm, shape (n, 2), counter-clockwise, first point not repeated.

    No chord strays farther from the exact curve than its tolerance.  The points are on the curve, but for those of
    hollow and of straddling flanks.
    """
    flanks = tips.flanks
    runs, fillets, *lands = whole_curves(tips, sides)
    # A flank works no deeper than its mate reaches.
    parts = parted(runs, -tips.met_depth_mm[runs.owner])
    works = (parts.start + parts.end) / 2.0 > -tips.met_depth_mm[parts.owner]
    working = _real(flanks, parts.kept(works))
    found = [straddled(working, chords.flanks_mm) if chords.straddling else _within(flanks, working, chords.flanks_mm)]
    near = _near_fillets(tips, chords.elsewhere_mm)[fillets.owner]
    found.append(_within(flanks, _real(flanks, parts.kept(~works)), chords.elsewhere_mm))
    found.append(_within(flanks, _real(flanks, fillets.kept(near)), chords.elsewhere_mm, hollow=True))
    found.append(sampled(_real(flanks, fillets.kept(~near)), chords.elsewhere_mm))
    found += [sampled(_real(flanks, land), chords.elsewhere_mm) for land in lands]
    points, keys = (np.concatenate(parts) for parts in zip(*found, strict=True))
    outline = points[np.argsort(keys, kind="stable")]
    return outline[::-1] if signed_area(outline) < 0.0 else outline


def _near_fillets(tips: Tips, tolerance_mm: float) -> Mask:
    """Beside which flanks the mate's tips come so near to the fillet that its chords must stay in the material.

    A tip leaves the flank along it, on a path whose radius of curvature beside the flank's is a module or less.  So it
    is a tolerance away where it is deeper by the root of twice the module times the tolerance, and a tenth of a module
    is enough for tolerances of use.
    """
    flanks = tips.flanks
    if _is_hollow(flanks):
        return np.ones(flanks.count, dtype=bool)
    module = flanks.rack.module_mm
    clear = min(sqrt(2.0 * module * tolerance_mm), module / 10.0)
    near: Mask = flanks.flank_depth_mm - tips.met_depth_mm < clear
    return near


def _is_hollow(flanks: Flanks) -> bool:
    """Whether flanks may be hollow, as on concave pitch curves, or the mate's own tips have cut the fillets."""
    return flanks.curve.curvature_bounds[0] < 0.0 or isinstance(flanks.tool, PitchCurve)


def _within(flanks: Flanks, curves: Stretch, tolerance: float, *, hollow: bool = False) -> tuple[Array, Array]:
    """Points of flanks and fillets whose chords stay in the material, so that written gears turn freely."""
    if not hollow and not _is_hollow(flanks):
        return sampled(curves, tolerance)
    # Arc length runs clockwise about the driving gear and round a ring's hole, against the clock about other gears.
    return sampled_within(curves, tolerance, -1.0 if flanks.curve.gear is Gear.DRIVING else 1.0)


def exact_curves(tips: Tips, sides: Sides) -> list[Stretch]:
    """All curves of the outline in the sense of growing arc length, each of them smooth.

    They are cut at the outline's corners, at the joints of the pitch curve and where a tip relief begins.
    """
    flanks = tips.flanks
    runs, *others = whole_curves(tips, sides)
    if flanks.rack.relief is not None:
        runs = parted(runs, np.full(runs.owner.size, flanks.rack.relief.start_mm))
    return [_real(flanks, stretch) for stretch in (runs, *others)]


def whole_curves(tips: Tips, sides: Sides) -> list[Stretch]:
    """All curves of the outline, whole between its corners: flanks, fillets, tip lands, root lands, in this order."""
    flanks = tips.flanks
    sides_runs = [_side_runs(flanks, sides, kind) for kind in (FLANK, FILLET)]
    return [*sides_runs, _tip_lands(flanks, sides), _root_lands(flanks, sides)]


def _real(flanks: Flanks, stretch: Stretch) -> Stretch:
    """The stretch without empty curves, cut at the joints of the pitch curve."""
    real = stretch.kept(np.abs(stretch.end - stretch.start) > 1e-12 * flanks.rack.module_mm)
    return split(real, flanks.curve.joints_around_mm)


def _side_runs(flanks: Flanks, sides: Sides, kind: int) -> Stretch:
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
    return Stretch(curve, owner, start, end, rolled, 4.0 * rank, np.ones(rank.size))


def _tip_lands(flanks: Flanks, sides: Sides) -> Stretch:
    """From each tooth's back flank to its front flank, after the last run of the back flank.

    A land's height over the pitch curve changes evenly from one flank's end to the other's: the land is parallel to the
    curve where both are equal, and does not jump where they cease to be equal from section to section of helical teeth.
    """
    back = np.arange(0, flanks.count, 2)
    start, end = sides.tip_mm[back], sides.tip_mm[back + 1]
    low = flanks.tip_height_mm[back]
    rise, rate = (flanks.tip_height_mm[back + 1] - low) / (end - start), 1.0 / (end - start)

    def curve(flank: IndexArray, sigma: Array) -> tuple[Array, Array]:
        tooth = flank // 2
        along = sigma - start[tooth]
        point, slope = flanks.offset(sigma, low[tooth] + rise[tooth] * along)
        land = point, slope + rise[tooth][..., None] * flanks.curve.at_length(sigma).normal
        return flanks.over_tip(tooth, along * rate[tooth], rate[tooth], land)

    return _lands(curve, sides, back, start, end)


def _root_lands(flanks: Flanks, sides: Sides) -> Stretch:
    """From each tooth's front flank to the next tooth's back flank, after the last run of the front flank."""
    start, end = sides.roots.lands()
    return _lands(
        lambda flank, sigma: sides.roots.land(flank // 2, sigma), sides, np.arange(1, flanks.count, 2), start, end
    )


def _lands(
    curve: Callable[[IndexArray, Array], tuple[Array, Array]], sides: Sides, owner: IndexArray, start: Array, end: Array
) -> Stretch:
    """Lands that follow the last runs of their owners, which are every other flank."""
    last_run = np.searchsorted(sides.owner, owner, side="right") - 1
    rank, rolled = np.asarray(4.0 * last_run + 1.0, dtype=float), np.array([start, end])
    return Stretch(curve, owner, start, end, rolled, rank, np.ones(rank.size))


REMEDY = "more teeth, a smaller addendum or dedendum, or a less uneven ratio avoids that"


def simple_polygon(outline_mm: Array, key: str) -> Polygon:
    """The polygon of an outline in mm, shape (n, 2).

    Raises NoSuchMechanism for ``key``, naming the place, where the outline crosses itself: both sides of one space may
    meet where the pitch curve is deeply concave.
    """
    polygon = Polygon(outline_mm)
    if not polygon.is_valid:
        raise NoSuchMechanism(f"the tooth outline crosses itself{_place(polygon)}; {REMEDY}", key=key)
    return polygon


def _place(polygon: Polygon) -> str:
    """The place at which a polygon is invalid, if GEOS tells it: its reason reads ``Self-intersection[x y]``."""
    numbers = re.findall(r"-?\d[\d.e+-]*", shapely.is_valid_reason(polygon))
    if len(numbers) < 2:
        return ""
    x, y = float(numbers[0]), float(numbers[1])
    return f" at x = {x:.5g} mm, y = {y:.5g} mm (polar angle {degrees(atan2(y, x)):.4g} deg in the gear's frame)"
