"""Conditions on a pitch curve and its mate for teeth of their module, with slopes by the curve.

A concave stretch and the convex stretch that rolls in it are, for some pitches, a ring and its pinion.  Their numbers
of teeth are 2 / (m |k|) and 2 / (m k') with the curvatures k and k' of both; where these differ by too few teeth, tips
collide like those of a ring with too large a pinion, though each flank alone would be regular.  With e = m (k + k') the
concave curve may have m |k| up to

    g(e) = (sqrt(e^2 + 8 e / N) - e) / 2,

at which the numbers differ by N.  A tip needs about a pitch to collide with another tip, so the condition applies to
the mean over a pitch to either side.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import StrEnum
from functools import partial
from math import radians, tan

import numpy as np
from scipy import sparse

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.rolled import Rolled, scaled

APART_TEETH = 4.5
"""Least difference of the numbers of teeth of a ring and its pinion."""

HOLLOW, ROUND = 0.3, 0.45
"""Greatest curvature times module of concave and of convex places: beyond, no flank is regular, no tip has a land."""

STEEPEST_RAD = radians(55.0)
"""Usual greatest angle between the pitch curve and the common perpendicular; the rack's 20 degrees add to it."""

NEAREST = 0.12
"""Usual least radius of the mate as a share of the centre distance."""


@dataclass(frozen=True, eq=False)
class CurveLimits:
    """Limits of each place: ``share`` is the usable part of the usual limits of curvature, shape (m,) or a number.

    ``steepest_rad`` is the greatest angle between the pitch curve and the common perpendicular of the radii,
    ``nearest`` the least radius of the mate as a share of the centre distance.
    """

    apart_teeth: float = APART_TEETH
    steepest_rad: float = STEEPEST_RAD
    nearest: float = NEAREST
    share: Array | float = 1.0

    def hollow(self, together: Array) -> tuple[Array, Array]:
        """Greatest m |k| of a concave place by e = m (k + k'), and its slope."""
        root = np.sqrt(together * together + 8.0 * together / self.apart_teeth)
        return (root - together) / 2.0, ((together + 4.0 / self.apart_teeth) / root - 1.0) / 2.0


class Subject(StrEnum):
    """The subject of a condition, on the given gear (own) or on its mate."""

    HOLLOW_OWN = "hollow_own"
    HOLLOW_MATE = "hollow_mate"
    HOLLOW_CORNER_OWN = "hollow_corner_own"
    HOLLOW_CORNER_MATE = "hollow_corner_mate"
    CORNER_OWN = "corner_own"
    CORNER_MATE = "corner_mate"
    STEEP = "pressure_angle"
    ROOM = "room"


@dataclass(frozen=True, eq=False)
class OutlineCondition:
    """A condition at all places: ``value`` is not over 0, shape (m,), and of the order of 1.

    ``slopes`` makes its slopes by the radius's coefficients, shape (m, n), by the centre distance and by the module,
    shape (m,) each.
    """

    kind: Subject
    value: Array
    slopes: Callable[[], tuple[sparse.csr_array, Array, Array]]


def conditions(curve: Rolled, limits: CurveLimits) -> Iterator[OutlineCondition]:
    """All conditions of a curve."""
    module, share = curve.module_mm, np.broadcast_to(limits.share, curve.speed_mm.shape)
    bound, slope = limits.hollow(module * curve.together)
    mean, none = curve.mean_over_window, np.zeros_like(curve.speed_mm)

    def of_curvature(curvature: Array, mate: bool, sign: float) -> tuple[sparse.csr_array, Array, Array]:
        rows = curve.together_rows - curve.curvature_rows if mate else curve.curvature_rows
        by_distance = curve.together_by_distance if mate else none
        return sign * module * rows, sign * module * by_distance, sign * curvature

    def of_stretch(curvature: Array, mate: bool) -> tuple[sparse.csr_array, Array, Array]:
        rows, by_distance, by_module = of_curvature(curvature, mate, -1.0)
        use = share * slope
        return (
            mean @ (rows - scaled(use * module, curve.together_rows)),
            mean @ (by_distance - use * module * curve.together_by_distance),
            mean @ (by_module - use * curve.together),
        )

    kinds = (
        (Subject.HOLLOW_OWN, Subject.HOLLOW_CORNER_OWN, Subject.CORNER_OWN),
        (Subject.HOLLOW_MATE, Subject.HOLLOW_CORNER_MATE, Subject.CORNER_MATE),
    )
    for mate, (curvature, (stretch, hollow, corner)) in enumerate(zip(curve.curvature, kinds, strict=True)):
        by = curvature, bool(mate)
        yield OutlineCondition(stretch, mean @ (-module * curvature - share * bound), partial(of_stretch, *by))
        yield OutlineCondition(hollow, -module * curvature - share * HOLLOW, partial(of_curvature, *by, -1.0))
        yield OutlineCondition(corner, module * curvature - share * ROUND, partial(of_curvature, *by, 1.0))
    b0, b1, _ = curve.basis.places
    r, r1, _ = curve.radius
    mean_mm, distance, steepest = float(np.mean(r)), curve.center_distance_mm, tan(limits.steepest_rad)
    for sign in (1.0, -1.0):
        slopes = partial(lambda sign: ((sign * b1 - steepest * b0) / mean_mm, none, none), sign)
        yield OutlineCondition(Subject.STEEP, (sign * r1 - steepest * r) / mean_mm, slopes)
    room = (1.0 - limits.nearest) / mean_mm
    yield OutlineCondition(Subject.ROOM, r / mean_mm - room * distance, lambda: (b0 / mean_mm, none - room, none))


def excess(curve: Rolled, limits: CurveLimits) -> float:
    """The largest violation of the conditions and of the mate's closing; below 0 where all hold."""
    worst = max(float(np.max(condition.value)) for condition in conditions(curve, limits))
    return max(worst, abs(float(np.mean(curve.turned)) - 1.0) - ROUNDING)


ROUNDING = 1e-9
"""Error of the mate's closing that counts as rounding."""
