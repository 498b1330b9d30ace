"""The local replacement gear: the circular gear that has the flank's curvature where a contact is.

A flank that rolls on a pitch curve of curvature k bends as the involute of a circular gear of the radius 1 / k, where
it touches: by the equation of Euler and Savary for a straight rack flank of the angle alpha, at the height h over the
pitch point, its radius of curvature is sin(alpha) / k + h / sin(alpha), and k enters with no derivative.  Source:
F. L. Litvin and A. Fuentes, "Gear Geometry and Applied Theory", 2nd edition, Cambridge 2004, chapter 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sin

import numpy as np

from ncgear.numerics.arrays import Array, Columns
from ncgear.numerics.plane import across, as_complex
from ncgear.strength.contacts import FlankPlaces
from ncgear.teeth.flank import Flanks

STEPS = 20
"""Newton steps to a pitch point; five do as a rule."""

TRIALS = 13
"""Points on each flank from which the search may begin, a fifth of a module apart."""

CLOSE = 1e-9
"""Distance of the normal from the pitch point, in modules, at which it is found."""


@dataclass(frozen=True, eq=False)
class ReplacementGears(Columns):
    """The circular gears that stand for n places on flanks; shape (n,) each.

    ``height_mm`` is the place's height over the pitch point, ``radius_mm`` the pitch radius, which is that of the pitch
    curve's curvature, and ``teeth`` the number of teeth that fit on it, not whole as a rule.  Both are negative for an
    internal gear, where the pitch curve is concave, and infinite for a rack.  ``flank_radius_mm`` is the radius of
    curvature of the flank, negative where it is hollow.
    """

    height_mm: Array
    radius_mm: Array
    teeth: Array
    flank_radius_mm: Array


def replacement_gears(flanks: Flanks, places: FlankPlaces) -> ReplacementGears:
    """The replacement gears at places on flanks.  A tip relief is left out of account in the flank's radius."""
    height = flank_heights_mm(flanks, places)
    curvature = flanks.at_rolled(places.flank, flanks.rolled_mm(places.flank, height)).curvature
    radius = _inverse(curvature)
    sine = sin(flanks.rack.pressure_angle_rad)
    flank_radius = _inverse(curvature * sine / (sine**2 + height * curvature))
    return ReplacementGears(height, radius, 2.0 * radius / flanks.rack.module_mm, flank_radius)


def flank_heights_mm(flanks: Flanks, places: FlankPlaces) -> Array:
    """Heights over the pitch point of places on flanks, shape (n,): where their normals meet the pitch curve.

    Raises ArithmeticError where a normal does not meet it nearby.
    """
    crossing, side, rise = flanks.crossing_mm[places.flank], flanks.side[places.flank], flanks.rack.height_per_rolled
    # Where a pitch curve bends within less than a module a normal meets it twice: begin at the nearest of a few points.
    trial = np.linspace(-float(np.max(flanks.flank_depth_mm)), float(np.max(flanks.tip_height_mm)), TRIALS)
    away = np.abs(as_complex(flanks.flank(places.flank[:, None], trial)[0]) - places.point[:, None])
    sigma = flanks.rolled_mm(places.flank, trial[np.argmin(away, axis=1)])
    for _ in range(STEPS):
        at = flanks.standing(places.flank, sigma)
        missing = across(places.inwards, places.point - as_complex(at.position))
        if np.all(np.abs(missing) <= CLOSE * flanks.rack.module_mm):
            return np.asarray(side * (crossing - sigma) * rise)
        sigma = sigma + missing / across(places.inwards, as_complex(at.tangent))
    raise ArithmeticError("the pitch point of a contact was not found")


def _inverse(curvature: Array) -> Array:
    radius: Array = np.divide(1.0, curvature, out=np.full(curvature.shape, np.inf), where=curvature != 0.0)
    return radius
