"""The existing teeth of gears that turn less than once, and the body behind the last tooth.

Teeth are made on the continued curves (ncgear.pitch.continued), and the range keeps all teeth whose flanks can touch
(ncgear.pitch.pair.ToothedArc): flanks of usual height touch over at most a pitch to either side of the pitch point, and
are a quarter of a pitch from the middle of their tooth.  Beside the first and the last tooth stands
the root land of the continued gear.  From there a wall leads towards the axis, and a round heel closes the outline.
Its radius is the radius of the lower end, or the radius to which the root land would fall within another pitch: there
the mate's last teeth pass by with the clearance of the roots.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import asin, cos, degrees, pi, sin

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, distinct
from ncgear.numerics.plane import as_points
from ncgear.numerics.units import in_words
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.teeth.flank import Flanks
from ncgear.teeth.stretch import CurveStretch

ComplexPair = tuple[ComplexArray, ComplexArray]
"""Points and their derivatives by the share of the way."""

LEAST_WALL = 0.25
"""Least height of a wall in modules; a lower step is evened out along the heel."""

LEAST_GAP_RAD = pi / 18.0
"""Least angle that must be left for the heel, so that its corners can be made."""


def kept_teeth(curves: list[CurveStretch], flanks: Flanks, made: int) -> list[CurveStretch]:
    """The first ``made`` teeth of ``whole_curves`` and the heel; raises NoSuchMechanism without room for it."""
    runs, fillets, tips, roots = curves
    last = 2 * made - 1
    sides = [stretch.kept(stretch.owner <= last) for stretch in (runs, fillets, tips)]
    before = roots.kept(roots.owner == flanks.count - 1)
    before = replace(before, rank=np.full(1, -8.0))  # before the ranks of tooth 1
    after = roots.kept(roots.owner == last)
    between = roots.kept(roots.owner <= last)
    return [*sides, between, before, _heel(flanks, after, before)]


def _heel(flanks: Flanks, after: CurveStretch, before: CurveStretch) -> CurveStretch:
    """From the end of the last root land around the axis to the beginning of the first root land."""
    only = np.zeros(1, dtype=int)
    end, start = (complex(*land.at(only, np.array([share]))[0][0]) for land, share in ((after, 1.0), (before, 0.0)))
    clockwise = flanks.curve.gear is Gear.DRIVING
    way = -1.0 if clockwise else 1.0
    left = 2.0 * pi - _covered_rad(flanks, after, before)
    if left < LEAST_GAP_RAD:
        _refuse(flanks, left, after)
    module, low = flanks.rack.module_mm, min(abs(end), abs(start), *_beyond_mm(flanks, after, before))
    # Where the step is low, the heel's radius goes from one end's radius to the other's.
    radii = [low if abs(point) - low > LEAST_WALL * module else abs(point) for point in (end, start)]
    rounding = [_rounding(abs(point), radius, module, left) for point, radius in zip((end, start), radii, strict=True)]
    used = [asin(rho / (radius + rho)) for rho, radius in zip(rounding, radii, strict=True)]
    outward = end / abs(end), start / abs(start)

    def wall(side: int, share: Array) -> ComplexPair:
        rho, radius = rounding[side], radii[side]
        foot = (radius + rho) * cos(used[side])
        near, far = (abs(end), foot) if side == 0 else (foot, abs(start))
        step: ComplexArray = np.full(share.shape, outward[side] * (far - near), dtype=complex)
        return outward[side] * near + step * share, step

    def corner(side: int, share: Array) -> ComplexPair:
        rho, radius = rounding[side], radii[side]
        inwards = 1.0 if side == 0 else -1.0
        center = outward[side] * np.exp(1j * way * inwards * used[side]) * (radius + rho)
        turned = pi / 2.0 - used[side]
        # From the wall's foot, with a direction across the wall, to the heel, with a direction towards the axis.
        along = turned * (share if side == 0 else 1.0 - share)
        arm = -outward[side] * 1j * way * inwards * np.exp(-1j * way * inwards * along) * rho
        speed = -1j * way * inwards * turned * (1.0 if side == 0 else -1.0)
        return center + arm, arm * speed

    def heel(share: Array) -> ComplexPair:
        turned = left - used[0] - used[1]
        angle = np.exp(1j * way * (used[0] + turned * share)) * outward[0]
        radius, rise = radii[0] + (radii[1] - radii[0]) * share, radii[1] - radii[0]
        return radius * angle, (rise + 1j * way * turned * radius) * angle

    parts: list[Callable[[Array], ComplexPair]] = [
        lambda share: wall(0, share),
        lambda share: corner(0, share),
        heel,
        lambda share: corner(1, share),
        lambda share: wall(1, share),
    ]
    walls = [abs(point) - radius > LEAST_WALL * module for point, radius in zip((end, start), radii, strict=True)]
    rows = np.array([number for number, there in enumerate([walls[0], walls[0], True, walls[1], walls[1]]) if there])

    def curve(owner: IndexArray, share: Array) -> tuple[Array, Array]:
        owner, share = np.broadcast_arrays(owner, share)
        points, slopes = np.empty((*share.shape, 2)), np.empty((*share.shape, 2))
        for number in distinct(owner):
            chosen = owner == number
            point, slope = parts[int(number)](share[chosen])
            points[chosen], slopes[chosen] = as_points(point), as_points(slope)
        return points, slopes

    ones = np.ones(rows.size)
    rank = float(after.rank[0]) + 1.0 + rows
    # It rolls over no curve; arc lengths beyond the turns beside the first turn have no joint of the pitch curve.
    rolled = 4.0 * flanks.curve.length_mm + np.array([rows, rows + 1.0])
    return CurveStretch(curve, rows, 0.0 * ones, ones, rolled, rank, ones, np.inf * ones, np.zeros_like(rows))


def _beyond_mm(flanks: Flanks, after: CurveStretch, before: CurveStretch) -> list[float]:
    """Distances from the axis that root lands would have half a pitch and a pitch beyond both ends of the arc."""
    ahead = flanks.rack.pitch_mm * np.array([0.5, 1.0])
    found: list[float] = []
    for land, sigma in ((after, after.rolled[1] + ahead), (before, before.rolled[0] - ahead)):
        at = flanks.curve.at_length(sigma)
        depth = flanks.root_depth_mm[land.owner]
        found += np.linalg.norm(at.position - depth * at.normal, axis=1).tolist()
    return found


def _rounding(end_mm: float, radius_mm: float, module_mm: float, left_rad: float) -> float:
    """Radius of the corner between a wall and the heel: a module, or the largest that wall and heel allow."""
    if end_mm - radius_mm <= LEAST_WALL * module_mm:
        return 0.0
    share = sin(min(left_rad / 4.0, pi / 4.0))
    return min(module_mm, (end_mm - radius_mm) / 2.0, radius_mm * share / (1.0 - share))


def _covered_rad(flanks: Flanks, after: CurveStretch, before: CurveStretch) -> float:
    """The angle about the gear's axis from the beginning of the first root land to the end of the last root land."""
    curve = flanks.curve
    assert isinstance(curve, PitchCurve)
    first, last = float(before.rolled[0, 0]) - curve.length_mm, float(after.rolled[1, 0])
    phi1 = curve.driving_angle(np.array([first, last]))
    own = phi1 if curve.gear is Gear.DRIVING else curve.transmission.driven_angle(phi1).value
    turned = float(own[1] - own[0])
    # The lands' ends are beside the pitch curve: their own directions give the rest.
    only = np.zeros(1, dtype=int)
    end, start = (complex(*land.at(only, np.array([share]))[0][0]) for land, share in ((after, 1.0), (before, 0.0)))
    seen = float(np.angle(end / start)) * (-1.0 if curve.gear is Gear.DRIVING else 1.0)
    return seen + 2.0 * pi * round((turned - seen) / (2.0 * pi))


def _refuse(flanks: Flanks, left_rad: float, after: CurveStretch) -> None:
    gear = flanks.curve.gear.value
    covered = 2.0 * pi - left_rad
    raise NoSuchMechanism(
        f"the teeth of the {gear} gear reach over {degrees(covered):.4g} deg, with a tooth beyond each end of the "
        f"range, and {degrees(LEAST_GAP_RAD):.3g} deg must be left of a turn (the last tooth is in mesh at phi1 = "
        f"{in_words(float(flanks.curve.driving_angle(after.rolled[0, :1])[0]))}); a smaller range or smaller teeth "
        "are right",
        key="motion",
    )
