"""From keys to values: the basic rack, the form and the helix of a design's teeth, in mm for a given module."""

from __future__ import annotations

from math import cos, degrees, pi, radians, sin
from typing import TYPE_CHECKING

from ncgear.design.keys.gears import Gears, Rack
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.units import in_words
from ncgear.pitch.shape import Mesh
from ncgear.solids.helical.helix import Hand, Helix
from ncgear.teeth.form import MOST_SHIFT, Backlash, Cutter, CutterKind, TipLimits, ToothForm

if TYPE_CHECKING:
    from ncgear.pitch.pair import PitchPair

RIGHT_ANGLE_DEG = 90.0
"""Pressure angle from which on a force along the flank's normal does not turn the mate at all."""


def reach_in_pitches(gears: Gears) -> float:
    """Rolled length, in pitches, over which teeth of full height touch to each side of the pitch point."""
    rack, shift, angle = gears.rack, gears.profile_shift, radians(min(gears.rack.angles_deg))
    shifts = [abs(value) for value in (shift.driving, shift.driven) if value is not None]
    height = rack.addendum * (1.0 + (MOST_SHIFT if shift.against_undercut else 0.0)) + max(shifts, default=0.0)
    return height / (pi * sin(angle) * cos(angle))


def require_pushing_flanks(pitch: PitchPair, rack: Rack) -> None:
    """Raises NoSuchMechanism where the pressure angle reaches a right angle: a flank cannot turn its mate there.

    Idle flanks count too: where they cannot turn the mate, the play is unlimited.
    """
    tangent = pitch.largest_tangent_angle_rad
    require_pushing(tangent.value, tangent.at, rack)


def require_pushing(tangent_rad: float, at_rad: float, rack: Rack) -> None:
    """As ``require_pushing_flanks``, for the largest tangent angle of the pitch curves and its place, in rad."""
    steeper = max(rack.angles_deg)
    angle = degrees(tangent_rad + radians(steeper))
    if angle < RIGHT_ANGLE_DEG:
        return
    raise NoSuchMechanism(
        f"the pressure angle reaches {angle:.4g} deg at phi1 = {in_words(at_rad)} (of which the rack has "
        f"{steeper:g}), where a flank pushes along the shafts' line or back instead of turning its "
        f"mate; under {RIGHT_ANGLE_DEG:g} deg is needed: a law whose ratio changes more slowly there",
        key="motion",
    )


def tooth_form_of(gears: Gears, module_mm: float) -> ToothForm:
    """The form of the teeth in mm for a given module; where a single shift is given, the other is its opposite."""
    shift = gears.profile_shift
    driving = shift.driving if shift.driving is not None else 0.0 - (shift.driven or 0.0)
    driven = shift.driven if shift.driven is not None else 0.0 - driving
    return ToothForm(
        rack=gears.rack.in_mm(module_mm),
        backlash=backlash_of(gears),
        driving_shift_mm=driving * module_mm,
        driven_shift_mm=driven * module_mm,
        shift_for_undercut=shift.against_undercut,
        tooth_shifts_mm=tuple(per_module * module_mm for per_module in shift.per_tooth or ()),
        cutter=Cutter(CutterKind(gears.cutter.kind), gears.cutter.teeth),
        limits=TipLimits(gears.least_tip_land * module_mm, gears.undercut == "avoid"),
        equivalent=gears.method == "equivalent_gear",
    )


def backlash_of(gears: Gears) -> Backlash:
    """The play that the keys ask for; zero play without such keys."""
    driven_rad = radians(gears.backlash_deg or 0.0)
    return Backlash(gears.backlash_mm, driven_rad, gears.backlash_share, thickness_limits_mm(gears) or (0.0, 0.0))


def thickness_limits_mm(gears: Gears) -> tuple[float, float] | None:
    """Lower and upper deviation of the tooth thickness along the pitch curve; None where they are not given."""
    given = gears.tolerances
    if given.tooth_thickness_lower_mm is None or given.tooth_thickness_upper_mm is None:
        return None
    return given.tooth_thickness_lower_mm, given.tooth_thickness_upper_mm


def driving_axes_rad(gears: Gears, count: int) -> list[float]:
    """The directions to the driving axis of each pair; a row of an even number of pairs is seen from behind."""
    last = radians(gears.driving_axis_deg)
    if gears.idlers is None:
        return [last] * count
    turned, hand = gears.idlers.directions_rad, 1.0 if count % 2 else -1.0
    return [last + hand * (angle - turned[-1]) for angle in turned]


def mesh_place(gears: Gears, center_distance_mm: float) -> MeshPlace:
    """The relative place of gears and crank, which the force between the gears needs."""
    (pushing, idle), axis, helix = map(radians, gears.rack.angles_deg), radians(gears.driving_axis_deg), helix_of(gears)
    thrust = 0.0 if helix is None else helix.thrust_sense * helix.thrust_share
    return MeshPlace(center_distance_mm, pushing, Mesh(gears.mesh), axis, idle, thrust_share=thrust)


def helix_of(gears: Gears) -> Helix | None:
    """The helix of the teeth; None where they are straight."""
    helix = gears.helix
    if helix is None:
        return None
    return Helix(radians(helix.angle_deg), gears.face_width_mm, Hand(helix.hand), helix.kind == "herringbone")
