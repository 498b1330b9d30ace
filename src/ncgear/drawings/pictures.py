"""The pictures of a build, and what of a drive is drawn in them."""

from __future__ import annotations

from math import pi

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.drawings.plots.canvas import joints_up_to
from ncgear.drawings.plots.contact import contact as contact_picture
from ncgear.drawings.plots.curves import motion, power
from ncgear.drawings.plots.gears import Assembled, Position, pitch_curves, tooth_pair
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.curve import CurvePoints, PitchCurve
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import rim_mm_of
from ncgear.solids.mesh.ring import outer_radius_mm

CURVE_POINTS = 1500
"""Points of a drawn pitch curve: 0.2 mm apart on a screen-wide gear of 300 mm."""

POSITIONS = 3
"""Positions of the pair in the picture of its teeth, evenly spread over a turn of the driving gear."""


def pictures(drive: Drive, contact: PairContact) -> dict[str, bytes]:
    """PNG pictures by their file names."""
    name, speed = drive.design.name, drive.design.operation.speed_rpm
    tables, joints = (drive.motion, drive.uniform_motion), motion_joints_rad(drive)
    all_joints = joints_up_to(drive.pair.transmission, contact.as_designed.placement.cycle_rad)
    module, positions = drive.pitch.size.module_mm, positions_at(drive, np.arange(POSITIONS) * 2.0 * pi / POSITIONS)
    curves, teeth, title = drawn_pitch_curves(drive), drawn_teeth(drive), _title(drive)
    return {
        "pitch_curves.png": pitch_curves(*curves, f"{title}: pitch curves at phi1 = 0"),
        "tooth_pair.png": tooth_pair(teeth, module, positions, f"{title}: tooth outlines in mesh"),
        "motion.png": motion(*tables, f"{name}: motion at {speed:.4g} r/min", joints),
        "contact.png": contact_picture(contact, f"{title}: contact of the teeth", all_joints),
        "power.png": power(*tables, f"{name}: force and power at {speed:.4g} r/min", joints),
    }


def drawn_pitch_curves(drive: Drive) -> tuple[Assembled, tuple[Mask, Mask]]:
    """Both pitch curves, and which of their points are on concave stretches (shape (n,))."""
    driving, driven = (_closed_curve(curve) for curve in (drive.pitch.driving, drive.pitch.driven))
    dented = driven.curvature > 0.0 if drive.pitch.driven.is_ring else driven.curvature < 0.0
    return _assembled(drive, driving.position, driven.position), (driving.curvature < 0.0, dented)


def drawn_teeth(drive: Drive) -> Assembled:
    """Both tooth outlines."""
    return _assembled(drive, drive.teeth.driving.outline_mm, drive.teeth.driven.outline_mm)


def positions_at(drive: Drive, phi1_rad: Array) -> list[Position]:
    """How the pair stands at driving angles in rad, shape (n,)."""
    phi2 = drive.pair.transmission.driven_angle(phi1_rad).value
    point = drive.pitch.pitch_point_mm(phi1_rad)
    return [Position(float(a), float(b), float(x)) for a, b, x in zip(phi1_rad, phi2, point, strict=True)]


def motion_joints_rad(drive: Drive) -> Array:
    """Joints of the law as far as the motion is sampled, shape (n,)."""
    return joints_up_to(drive.transmission, float(drive.motion.phi1_rad[-1]))


def _title(drive: Drive) -> str:
    """Of pictures that show one pair of gears."""
    return drive.design.name if drive.stage is None else f"{drive.design.name}, stage {drive.stage} by its own angles"


def _assembled(drive: Drive, driving_mm: Array, driven_mm: Array) -> Assembled:
    return Assembled(driving_mm, driven_mm, drive.pitch.center_distance_mm, _ring_radius_mm(drive))


def _ring_radius_mm(drive: Drive) -> float | None:
    """Outer radius of a driven ring; None for an external pair."""
    if not drive.pitch.driven.is_ring:
        return None
    return outer_radius_mm(drive.teeth.driven.outline_mm, rim_mm_of(drive.gears, drive.pitch.size.module_mm))


def _closed_curve(curve: PitchCurve) -> CurvePoints:
    return curve.at_angle(np.linspace(0.0, curve.turn_rad, CURVE_POINTS))
