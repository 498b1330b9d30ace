"""Both gears as solids with exact faces, and their pitch curves as splines, for STEP files and CAD programs."""

from __future__ import annotations

import numpy as np
from OCP.TopoDS import TopoDS_Shape

from ncgear.errors import Unanswered, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import rim_mm_of
from ncgear.solids.brep.gear import gear_shape, helical_gear_shape, ring_shape
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.patches import patches_of
from ncgear.solids.helical.sections import Sections
from ncgear.solids.plan.plan import outer_radius_mm
from ncgear.teeth.contour import CURVES_SHARE, DEGREE, SPANS, Spline, contour_of

ONLY_MESHES = (
    "given, but solids with exact faces, as in STEP files, have no bevel and no clearance for a process; leave it out"
)

LEAST_MODULE_MM = 0.01
"""Least module of teeth with exact faces: the kernel and CAD programs take points within 1e-7 mm as one point."""

ExactSolid = tuple[TopoDS_Shape, float]
"""A gear's solid in its own frame, and the largest distance found between its tooth faces and the exact faces."""


def exact_solids(drive: Drive) -> dict[Gear, ExactSolid]:
    """The solids of both gears.

    Raises the errors of the teeth's contact, and WrongInput for shapes that only meshes have: a chamfer, a clearance,
    helical teeth that do not change smoothly with height, teeth of less than ``LEAST_MODULE_MM``.
    """
    if drive.pitch.size.module_mm < LEAST_MODULE_MM:
        raise WrongInput(
            f"the module of {drive.pitch.size.module_mm:.4g} mm is too small for exact faces, in which points within "
            f"1e-07 mm are one; {LEAST_MODULE_MM:g} mm or more, or other formats than step, are right",
            key="gears.module_mm",
        )
    if drive.gears.first_layer_chamfer_mm > 0.0:
        raise WrongInput(ONLY_MESHES, key="gears.first_layer_chamfer_mm")
    if drive.gears.process_clearance_mm != 0.0:
        raise WrongInput(ONLY_MESHES, key="gears.process_clearance_mm")
    drive.require_sound_teeth()
    if drive.helix is None:
        return {gear: _straight(drive, gear) for gear in Gear}
    sections = Sections(drive.pitch, drive.tooth_form, drive.helix, drive.chord_tolerance_mm)
    return {gear: _helical(drive, sections, drive.helix, gear) for gear in Gear}


def _straight(drive: Drive, gear: Gear) -> ExactSolid:
    own = drive.teeth.of(gear)
    contour = contour_of(own, CURVES_SHARE * drive.chord_tolerance_mm)
    plan = drive.solids.of(gear).plan
    if gear is Gear.DRIVING or not drive.pitch.driven.is_ring:
        return gear_shape(contour, plan), contour.deviation_mm
    radius = outer_radius_mm(own.outline_mm, rim_mm_of(drive.gears, drive.pitch.size.module_mm))
    return ring_shape(contour, plan, radius), contour.deviation_mm


def _helical(drive: Drive, sections: Sections, helix: Helix, gear: Gear) -> ExactSolid:
    patches = patches_of(sections, gear, CURVES_SHARE * drive.chord_tolerance_mm)
    shape = helical_gear_shape(patches, drive.solids.of(gear).plan, herringbone=helix.herringbone)
    return shape, patches.deviation_mm


PROBES = np.array([0.25, 0.5, 0.75])
"""Shares of each span at which a spline is compared with the curve; its error is largest near the middle."""


def pitch_spline(curve: PitchCurve, tolerance_mm: float) -> Spline:
    """A pitch curve as a cubic B-spline by arc length, with equal tangents on both sides of each knot.

    It passes through exact points along exact tangents.  No point at PROBES is further from the curve than the
    tolerance; joints of the law are knots.  For gears that turn less than once it covers the range of turning.  Raises
    Unanswered where even the largest number of spans does not follow the curve.
    """
    ends, covered = curve.panels_mm, curve.transmission.lobes.range
    if covered is not None:
        end = float(curve.arc.length(np.array([covered.driving_rad]))[0]) * curve.center_distance_mm
        ends = np.append(ends[ends < end], end)
    for spans in (1, *SPANS):
        share = np.arange(spans) / spans
        knots = np.append((ends[:-1, None] + np.diff(ends)[:, None] * share).ravel(), ends[-1])
        spline = _through(curve, knots)
        if _missed_mm(curve, knots, spline) <= tolerance_mm:
            return spline
    raise Unanswered(f"the pitch curve is not followed by {SPANS[-1]} spans of each of its parts")


def _through(curve: PitchCurve, knots: Array) -> Spline:
    """The spline through a curve's points at arc lengths, with its tangents there (cubic Hermite)."""
    # A closed curve ends exactly at its first point.
    at, third = curve.at_length(knots), np.diff(knots)[:, None] / 3.0
    after, before = at.position[:-1] + third * at.tangent[:-1], at.position[1:] - third * at.tangent[1:]
    inner = np.stack([after, before], axis=1).reshape(-1, 2)
    repeated = np.repeat(knots, 2)
    return Spline(
        np.concatenate([knots[:1], knots[:1], repeated, knots[-1:], knots[-1:]]),
        np.vstack([at.position[:1], inner, at.position[-1:]]),
    )


def _missed_mm(curve: PitchCurve, knots: Array, spline: Spline) -> float:
    from scipy.interpolate import BSpline

    between = (knots[:-1, None] + np.diff(knots)[:, None] * PROBES).ravel()
    apart = BSpline(spline.knots, spline.poles_mm, DEGREE)(between) - curve.at_length(between).position
    return float(np.linalg.norm(apart, axis=1).max())
