"""What a pitch curve and its mate must keep so that teeth of their module roll on them, with slopes by the curve.

A concave stretch and the convex stretch that rolls in it are, for some pitches, a ring and its pinion.  Their numbers of
teeth are 2 / (m |k|) and 2 / (m k') with the curvatures k and k' of both; where these differ by too few teeth, tips run
into each other as those of a ring and too large a pinion do, though each flank by itself is regular down to m k = -0.3.
With e = m (k + k') the concave curve may have m |k| up to

    g(e) = (sqrt(e^2 + 8 e / N) - e) / 2,

at which the numbers differ by N.  A tip needs a pitch or so to run into another one, so the condition is held in the
mean over a pitch to either side.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from math import radians, tan

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.rolled import Rolled

APART_TEETH = 4.5
"""By how many teeth a ring and its pinion differ at least where conditions begin."""

HOLLOW, ROUND = 0.3, 0.45
"""Greatest curvature times module of concave and of convex places: beyond them no flank is regular, no tip has a land."""

STEEPEST_RAD = radians(55.0)
"""Greatest angle between the pitch curve and the common perpendicular of the radii; the rack's 20 degrees add to it."""

NEAREST = 0.12
"""Least radius of the mate as a share of the centre distance."""

WINDOW_PITCHES = 1.0
"""Over how many pitches to either side a concave stretch is taken in the mean, with weights that fall to the ends."""


@dataclass(frozen=True, eq=False)
class Limits:
    """How much of the usual limits each place may use: ``share`` has shape (m,), or is the same everywhere."""

    apart_teeth: float = APART_TEETH
    share: Array | float = 1.0

    def hollow(self, together: Array) -> tuple[Array, Array]:
        """Greatest m |k| of a concave place by e = m (k + k'), and its slope."""
        root = np.sqrt(together * together + 8.0 * together / self.apart_teeth)
        return (root - together) / 2.0, ((together + 4.0 / self.apart_teeth) / root - 1.0) / 2.0


@dataclass(frozen=True, eq=False)
class Condition:
    """A condition at all places: ``value`` is not over 0, shape (m,).

    ``rows`` (shape (m, n)) is its slope by the radius's coefficients, ``by_distance`` and ``by_module`` (shape (m,)) are
    those by the centre distance and the module.  Values are of the order of 1.
    """

    kind: Kind
    value: Array
    rows: Array
    by_distance: Array
    by_module: Array


class Kind(StrEnum):
    """What a condition is about, of the given gear (own) or of its mate."""

    HOLLOW_OWN = "hollow_own"
    HOLLOW_MATE = "hollow_mate"
    HOLLOW_CORNER_OWN = "hollow_corner_own"
    HOLLOW_CORNER_MATE = "hollow_corner_mate"
    CORNER_OWN = "corner_own"
    CORNER_MATE = "corner_mate"
    STEEP = "pressure_angle"
    ROOM = "room"


def conditions(curve: Rolled, limits: Limits) -> Iterator[Condition]:
    """All conditions of a curve."""
    module, share = curve.module_mm, np.broadcast_to(limits.share, curve.speed_mm.shape)
    together_rows, together_by_distance = curve.together_rows
    own_rows, none = curve.curvature_rows, np.zeros_like(curve.speed_mm)
    mate_rows = together_rows - own_rows
    both = module * curve.together
    bound, slope = limits.hollow(both)
    mean = _mean_over_window(curve)
    curvatures = zip(curve.curvature, (own_rows, mate_rows), (none, together_by_distance), strict=True)
    own = Kind.HOLLOW_OWN, Kind.HOLLOW_CORNER_OWN, Kind.CORNER_OWN
    mates = Kind.HOLLOW_MATE, Kind.HOLLOW_CORNER_MATE, Kind.CORNER_MATE
    for (curvature, rows, by_distance), (stretch, hollow, sharp) in zip(curvatures, (own, mates), strict=True):
        slack = -module * curvature - share * bound
        use = (share * slope * module)[:, None]
        yield Condition(
            stretch,
            mean @ slack,
            mean @ (-module * rows - use * together_rows),
            mean @ (-module * by_distance - use[:, 0] * together_by_distance),
            mean @ (-curvature - share * slope * curve.together),
        )
        yield Condition(hollow, -module * curvature - share * HOLLOW, -module * rows, -module * by_distance, -curvature)
        yield Condition(sharp, module * curvature - share * ROUND, module * rows, module * by_distance, curvature)
    b0, b1, _ = curve.basis.places
    r, r1, _ = curve.radius
    mean_mm, steepest = float(np.mean(r)), tan(STEEPEST_RAD)
    for sign in (1.0, -1.0):
        rows = (sign * b1 - steepest * b0) / mean_mm
        yield Condition(Kind.STEEP, (sign * r1 - steepest * r) / mean_mm, rows, none, none)
    room = (1.0 - NEAREST) / mean_mm
    distance = curve.center_distance_mm
    yield Condition(Kind.ROOM, r / mean_mm - room * distance, b0 / mean_mm, none - room, none)


def _mean_over_window(curve: Rolled) -> Array:
    """Weights of all places in the mean about each, shape (m, m)."""
    pitch = curve.length_mm / curve.teeth
    near = np.maximum(1.0 - curve.apart_mm(curve.arc_mm) / (WINDOW_PITCHES * pitch), 0.0) * curve.speed_mm
    weights: Array = near / near.sum(axis=1, keepdims=True)
    return weights


def excess(curve: Rolled, limits: Limits) -> float:
    """By how much the conditions are missed at most, and the mate's closing; below 0 where none is."""
    worst = max(float(np.max(one.value)) for one in conditions(curve, limits))
    return max(worst, abs(float(np.mean(curve.turned)) - 1.0) - ROUNDING)


ROUNDING = 1e-9
"""Error of the mate's closing that is rounding."""
