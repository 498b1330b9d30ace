"""Where the teeth of an internal pair can foul: how far from the pitch point the tips reach into each other.

A driving gear nestles in its ring, so that the tips overlap far beyond the line of action: of circles with nearly as
many teeth, halfway round.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedGear, ToothedPair

POSITIONS = 64
"""Positions over a period of the law at which the tip curves are laid over each other; they differ smoothly."""

POINTS_PER_TOOTH = 8
"""Points of a tip curve: an eighth of a pitch is what the reach may miss, far less than the margin it is taken with."""


def tips_overlap_mm(pitch: PitchPair, teeth: ToothedPair) -> float:
    """Largest distance from the pitch point at which the driving tip curve of an internal pair passes the ring's."""
    phi1 = np.linspace(0.0, pitch.transmission.lobes.driving_period_rad, POSITIONS)
    phi2 = pitch.transmission.driven_angle(phi1).value
    seen = _tip_curve(teeth.driving) * np.exp(1j * phi1[:, None])
    from_ring_axis = (seen - pitch.center_distance_mm) * np.exp(-1j * phi2[:, None])
    ring = _tip_curve(teeth.driven)
    tip_radius = np.interp(np.angle(from_ring_axis), np.angle(ring), np.abs(ring), period=2.0 * np.pi)
    beyond = np.abs(from_ring_axis) > tip_radius
    return float(np.max(np.abs(seen - pitch.pitch_point_mm(phi1)[:, None]), where=beyond, initial=0.0))


def _tip_curve(gear: ToothedGear) -> NDArray[np.complex128]:
    """Where tips of full height end all around a gear, x + i y in mm in its own frame, shape (n,)."""
    sigma = np.linspace(0.0, gear.flanks.curve.length_mm, POINTS_PER_TOOTH * gear.teeth, endpoint=False)
    points = gear.flanks.offset(sigma, gear.flanks.rack.addendum_mm)[0]
    curve: NDArray[np.complex128] = points[:, 0] + 1j * points[:, 1]
    return curve
