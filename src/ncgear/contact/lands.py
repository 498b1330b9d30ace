"""Tip and root lands: where they end at each flank, how wide they are, and how far from the pitch curve.

All is read off the ends of the teeth's sides, so it holds whatever height or depth a tooth or space has got.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.contact.side_paths import LAND, SidePaths
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import along, as_complex

FOOT_STEPS = 12
"""Steps of Newton's method to a foot on the pitch curve; two do where a tooth has a tip land."""

FOOT_IN_MODULES = 1e-9
"""Distance along the pitch curve at which a foot counts as found; the height is off by its square."""


@dataclass(frozen=True, eq=False)
class Lands:
    """The tip or root land at each of a gear's f flanks, shape (f,) each.

    ``from_crossing_mm`` is the arc length from the flank's crossing of the pitch curve to the land's end there,
    ``width_mm`` how far the land goes on from there, ``height_mm`` its height over the pitch curve, negative for roots.
    """

    from_crossing_mm: Array
    width_mm: Array
    height_mm: Array


def tip_lands(paths: SidePaths) -> Lands:
    """The tips of all teeth; a pointed one has no width.

    Raises ArithmeticError where the point of the pitch curve that a pointed tooth's tip stands over is not found.
    """
    foot = paths.sides.tip_mm
    for _ in range(FOOT_STEPS):
        at = paths.flanks.curve.at_length(foot)
        arm = paths.corner[:, 0] - as_complex(at.position)
        height = along(as_complex(at.normal), arm)
        step = along(as_complex(at.tangent), arm) / (1.0 + height * at.curvature)
        if np.all(np.abs(step) <= FOOT_IN_MODULES * paths.flanks.rack.module_mm):
            return Lands(foot - paths.flanks.crossing_mm, np.repeat(foot[1::2] - foot[0::2], 2), height)
        foot = foot + step
    raise ArithmeticError("the foot of a tooth's tip on the pitch curve was not found")


def root_lands(paths: SidePaths) -> Lands:
    """The roots of all spaces, which begin where the fillets end, right under the pitch curve's points."""
    land = np.nonzero(paths.runs.kind == LAND)[0]
    foot = paths.sides.roots.end_mm
    at = paths.flanks.curve.at_length(foot)
    height = along(as_complex(at.normal), as_complex(paths.curve(land, paths.runs.start[land])[0] - at.position))
    width = np.append(foot[2::2], foot[0] + paths.flanks.curve.length_mm) - foot[1::2]
    return Lands(foot - paths.flanks.crossing_mm, np.roll(np.repeat(width, 2), 1), height)
