"""How far from the pitch point outlines can touch: along the line of action, and where a ring's tips can foul.

A driving gear nestles in its ring, so that the tips overlap far beyond the line of action: of circles with nearly as
many teeth, halfway round.
"""

from __future__ import annotations

from math import sin

import numpy as np

from ncgear.pitch.internal import PlanePoints, passed_mm, plane
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.teeth.gear import ToothedGear, ToothedPair

BEYOND = 1.1
"""How far beyond that outlines are compared: a tenth, for contact of edges."""

BOWL = 2.5
"""How many times as far tips can foul where a pitch curve is concave: teeth enter such a bowl two or three pitches from
the pitch point."""

POSITIONS = 64
"""Positions over a period of the law at which the tip curves are laid over each other; they differ smoothly."""

POINTS_PER_TOOTH = 8
"""Points of a tip curve: an eighth of a pitch is what the reach may miss, far less than the margin it is taken with."""


def reach_mm(pitch: PitchPair, teeth: ToothedPair) -> float:
    """Distance from the pitch point in mm within which outlines must be compared."""
    racks = teeth.driving.flanks.rack, teeth.driven.flanks.rack
    action = max(rack.dedendum_mm / sin(rack.pressure_angle_rad) for rack in racks)
    if pitch.mesh is Mesh.INTERNAL:
        return BEYOND * max(action, tips_overlap_mm(pitch, teeth))
    return BEYOND * action * (1.0 if all(pitch.convex(gear) for gear in Gear) else BOWL)


def tips_overlap_mm(pitch: PitchPair, teeth: ToothedPair) -> float:
    """Largest distance from the pitch point at which the driving tip curve of an internal pair passes the ring's."""
    phi1 = np.linspace(0.0, pitch.transmission.lobes.driving_period_rad, POSITIONS)
    tips = _tip_curve(teeth.driving)
    beyond = passed_mm(tips, _tip_curve(teeth.driven), pitch.driving, phi1) > 0.0
    from_pitch_point = np.abs(tips * np.exp(1j * phi1[:, None]) - pitch.pitch_point_mm(phi1)[:, None])
    return float(np.max(from_pitch_point, where=beyond, initial=0.0))


def _tip_curve(gear: ToothedGear) -> PlanePoints:
    """Where tips of full height end all around a gear, in mm in its own frame, shape (n,)."""
    sigma = np.linspace(0.0, gear.flanks.curve.length_mm, POINTS_PER_TOOTH * gear.teeth, endpoint=False)
    return plane(gear.flanks.offset(sigma, gear.flanks.rack.tip_height_mm)[0])
