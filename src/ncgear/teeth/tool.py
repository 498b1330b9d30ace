"""The rounded tip of a tool, from where it leaves the tool's flank.

In the tool's frame, with the pitch point at sigma: the flank touches at depth f below the pitch curves' tangent when
sigma = c + s f / (sin(alpha) cos(alpha)); one radius along the flank's normal from there is the rounding's centre
Q = P_t + u T_t - v N_t,  u = s cos(alpha) (rho - f / sin(alpha)),  v = rho sin(alpha) - f.  It stands right under the
pitch point where Q is nearest to the tool's curve, and reaches one radius deeper than Q there.

The tools that leave the fillets: a rack, a pinion cutter, or the mating gear itself with a rounded tip.

A tool is known by the curve with which it rolls on the pitch curve, in the tool's own frame: a straight line, a circle,
or the mate's pitch curve.  Its teeth are conjugate to the gear's, so the working flanks are the same whatever the tool;
its rounded tip leaves the fillet.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from scipy.optimize import elementwise

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.curve import CurvePoints, PitchCurve, RollingCurve, nearest
from ncgear.teeth.rack import BasicRack

AGREEMENT = 1e-11
"""Distance in modules at which a place counts as found: about 1000 rounding errors of a gear of 20 modules."""

LEAST_FLAT = 0.02
"""Flat, in modules, that is left between the two roundings of a tool's tooth, so that the root land has a length."""


@dataclass(frozen=True, eq=False)
class Rounding:
    """Roundings of the tool's tip, one for each flank; shape (n,), and (n, 2) for the centres in the tool's frame.

    ``lowest_mm`` is the arc length at which the rounding stands right under the pitch point, ``depth_mm`` how far below
    the pitch curve it reaches there.  NaN where the tool's tooth is so pointed that it has no such rounding.
    """

    lowest_mm: Array
    depth_mm: Array
    center_mm: Array


def rounding_of(
    tool: RollingCurve, rack: BasicRack, crossing_mm: Array, side: Array, flank_depth_mm: Array, radius_mm: Array
) -> Rounding:
    """The roundings of flanks that cross at ``crossing_mm`` and end at ``flank_depth_mm``, all of shape (n,)."""
    angle = rack.pressure_angle_rad
    sigma = crossing_mm + side * flank_depth_mm / rack.height_per_rolled
    at = tool.at_length(sigma)
    u = side * cos(angle) * (radius_mm - flank_depth_mm / sin(angle))
    v = radius_mm * sin(angle) - flank_depth_mm
    center = at.position + u[:, None] * at.tangent - v[:, None] * at.normal
    lowest, outwards = nearest(tool, center, sigma + u, AGREEMENT * rack.module_mm)
    return Rounding(lowest, outwards + radius_mm, center)


def fitting_radii(flats: Callable[[Array, IndexArray], Array], most_mm: Array, least_mm: float) -> Array:
    """Radii of tool teeth, at most ``most_mm`` (shape (n,)), that leave flats of ``least_mm`` between two roundings.

    ``flats`` tells the flats at radii for tooth numbers, shape (m,) each.  NaN where not even sharp corners leave one.
    """
    radii, every = most_mm.copy(), np.arange(most_mm.size)
    tight = every[~(flats(radii, every) >= least_mm)]
    if not tight.size:
        return radii
    sharp = ~(flats(np.zeros(tight.size), tight) >= least_mm)
    radii[tight[sharp]] = np.nan
    tight = tight[~sharp]
    if tight.size:
        radii[tight] = _radii_between(flats, tight, most_mm[tight], least_mm)
    return radii


def _radii_between(flats: Callable[[Array, IndexArray], Array], tight: IndexArray, most: Array, least: float) -> Array:
    def excess(trial: Array, number: Array) -> Array:
        # A tip too pointed for its radius counts as having no flat at all.
        return np.nan_to_num(flats(trial, number.astype(int)), nan=-float(most.max())) - least

    found = elementwise.find_root(excess, (np.zeros(tight.size), most), args=(tight,))
    if not np.all(found.success):
        raise ArithmeticError("the rounding of a tool's tip was not found")
    # The side of the bracket on which the flat is wide enough.
    radii: Array = np.minimum(*found.bracket)
    return radii


@dataclass(frozen=True)
class RackLine:
    """The pitch line of a rack: the tool of a hob, and of every cutter that moves straight."""

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The x axis; the rack's material lies above it."""
        zero, one = np.zeros_like(sigma_mm), np.ones_like(sigma_mm)
        return CurvePoints(
            np.stack([sigma_mm, zero], axis=-1), np.stack([one, zero], axis=-1), np.stack([zero, -one], axis=-1), zero
        )

    def flank_depth_mm(self, rack: BasicRack, depth_mm: Array, radius_mm: Array) -> Array:
        """How deep the straight flank goes on a tool tooth of a depth and a tip radius."""
        return depth_mm - radius_mm * (1.0 - sin(rack.pressure_angle_rad))


@dataclass(frozen=True)
class PinionCircle:
    """The pitch circle of a pinion cutter (shaper) with whole ``teeth``."""

    teeth: int
    module_mm: float

    @property
    def radius_mm(self) -> float:
        """Pitch radius."""
        return self.teeth * self.module_mm / 2.0

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The circle about (0, 0), touched from below at sigma = 0 and run counter-clockwise."""
        angle = sigma_mm / self.radius_mm - pi / 2.0
        outward = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        tangent = np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
        return CurvePoints(
            self.radius_mm * outward, tangent, outward, np.full(np.shape(sigma_mm), 1.0 / self.radius_mm)
        )

    def flank_depth_mm(self, rack: BasicRack, depth_mm: Array, radius_mm: Array) -> Array:
        """How deep the involute goes on a tool tooth of a depth and a tip radius.

        The rounding's centre runs on an involute of the same base circle R cos(alpha); at the depth f of the contact
        its distance to the base circle's tangent point is R sin(alpha) + f / sin(alpha) - rho.
        """
        sine, base = sin(rack.pressure_angle_rad), self.radius_mm * cos(rack.pressure_angle_rad)
        tangent = np.sqrt((self.radius_mm + depth_mm - radius_mm) ** 2 - base**2)
        depth: Array = sine * (tangent - self.radius_mm * sine + radius_mm)
        return depth


Tool = RackLine | PinionCircle | PitchCurve
"""What may leave a gear's fillets; a pitch curve stands for the mating gear."""
