"""Profile shift: given for each gear, or chosen against undercut."""

from __future__ import annotations

from math import ceil, sin

import numpy as np

from ncgear.errors import WrongInput
from ncgear.machine.rack import BasicRack
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import ToothForm

MOST_SHIFT = 0.7
"""Largest shift, in addenda, that is chosen by itself: three tenths of the mate's addendum are left."""

ROUNDING = 1e-9
"""Share by which chosen shifts stay clear of the limit, where rounding would decide whether flanks are undercut."""


def shifted_racks(pitch: PitchPair, form: ToothForm) -> tuple[BasicRack, BasicRack]:
    """The driving and the driven gear's rack.

    Raises WrongInput when the shifts thicken the teeth by more than the backlash, so that they would not go together.
    """
    driving, driven = form.driving_shift_mm, form.driven_shift_mm
    if form.shift_for_undercut:
        driving = shift_against_undercut(pitch, form.rack)
        driven = -driving
    spare = form.rack.backlash_mm - 2.0 * (driving + driven) * sin(form.rack.pressure_angle_rad)
    if spare < -1e-12 * form.rack.module_mm:
        raise WrongInput(
            f"shifts of {driving:g} and {driven:g} mm thicken the teeth by {form.rack.backlash_mm - spare:.4g} mm "
            f"along the normal, more than the backlash of {form.rack.backlash_mm:g} mm; equal and opposite shifts, or "
            "more backlash_mm, are right",
            key="gears.profile_shift",
        )
    return form.rack.shifted(driving), form.rack.shifted(driven)


def shift_against_undercut(pitch: PitchPair, rack: BasicRack) -> float:
    """The driving gear's shift in mm, the driven gear's being its opposite, that leaves least undercut.

    Where k is a gear's largest curvature its flank of depth f - x is regular while (f - x) k < sin^2(alpha); between
    both gears' bounds the least shift is taken, and where there is none between them the mean of both.
    """
    square, depth = sin(rack.pressure_angle_rad) ** 2 * (1.0 - ROUNDING), rack.flank_depth_mm
    least = depth - square / pitch.curvature_range[Gear.DRIVING][1].value
    most = square / pitch.curvature_range[Gear.DRIVEN][1].value - depth
    wanted = float(np.clip(0.0, least, most)) if least <= most else (least + most) / 2.0
    reach = MOST_SHIFT * rack.addendum_mm
    return float(np.clip(wanted, -reach, reach))


def teeth_free_of_undercut(pitch: PitchPair, driving: BasicRack, driven: BasicRack) -> int:
    """Number of driving teeth from which no tooth can be undercut, wherever it stands on the curves.

    A flank is regular where k h_F < sin^2(alpha); curvature in modules falls as teeth are added at a fixed shape.
    """
    square = sin(driving.pressure_angle_rad) ** 2
    depths = {Gear.DRIVING: driving, Gear.DRIVEN: driven}
    worst = max(
        pitch.curvature_range[gear][1].value * (rack.flank_depth_mm - rack.shift_mm) for gear, rack in depths.items()
    )
    lobes = pitch.transmission.lobes.driving
    return lobes * ceil(pitch.size.driving_teeth * worst / square / lobes)
