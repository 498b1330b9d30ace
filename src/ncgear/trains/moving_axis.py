"""A pair of gears whose driven axis moves to and fro while they turn: teeth, poses and figures.

Teeth stand on the curves of ``pitch.moving_axes`` by one rack, so flanks are exact as at a fixed distance.  A guide,
such as a swinging arm or a slide with a cam, has to move the axis; the figures tell its motion.
"""

from __future__ import annotations

from math import cos, degrees, pi

import numpy as np

from ncgear.errors import NoSuchMechanism, below
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM, placed_rad
from ncgear.pitch.moving_axes import MovingAxes
from ncgear.pitch.shape import Gear
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES
from ncgear.teeth.backlash import require_teeth
from ncgear.teeth.fitting import fitted_pair, least_contact_ratio
from ncgear.teeth.flank import flanks_of
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import ToothedGear, toothed_gear
from ncgear.teeth.outline import ChordTolerance
from ncgear.teeth.sides import refuse_sharp_curve
from ncgear.teeth.tool import RackLine, Tool
from ncgear.trains.train import GearMesh, Part, Poses, Train, TrainFigures, contact_condition


@dataclass(frozen=True, eq=False)
class MovingGears:
    """Both gears with teeth, and the least contact ratio."""

    driving: ToothedGear
    driven: ToothedGear
    contact_ratio: float


def module_mm(axes: MovingAxes, teeth: int) -> float:
    """The module for a number of driving teeth; raises NoSuchMechanism where the driven teeth would not be whole."""
    lobes = axes.lobes
    if teeth * lobes.driven % lobes.driving:
        raise NoSuchMechanism(
            f"{teeth} teeth on the driving gear make {teeth * lobes.driven / lobes.driving:.4g} on the driven one; a "
            f"multiple of {lobes.teeth_step} is needed",
            key="train.gears.teeth",
        )
    return axes.curve(Gear.DRIVING).length_mm / (pi * teeth)


def moving_gears(axes: MovingAxes, teeth: int, form: ToothForm, tolerance_mm: float) -> MovingGears:
    """The teeth of both gears, outlines sampled to a tolerance.

    A rack cuts two convex curves; if a curve has a concave stretch, each gear cuts the other.  Half of the play is
    taken off the idle flanks of each gear, along the pitch curves.  Raises NoSuchMechanism, naming gear and tooth,
    where no tooth can stand.
    """
    rack, lobes = form.rack, axes.lobes
    first, second = axes.curve(Gear.DRIVING), axes.curve(Gear.DRIVEN)
    for curve in (first, second):
        refuse_sharp_curve(curve, rack.module_mm, "gears.teeth")
    tools: tuple[Tool, Tool] = (RackLine(), RackLine())
    if first.is_dented or second.is_dented:
        tools = second, first
    quarter = rack.pitch_mm / 4.0
    taken = form.backlash.least_normal_mm / cos(rack.pressure_angle_rad) / 2.0
    require_teeth(form.backlash, taken, rack)
    thinner = quarter - taken
    tips = fitted_pair(
        flanks_of(first, rack, teeth, tools[0], 0.0, (quarter, thinner)),
        flanks_of(second, rack, teeth * lobes.driven // lobes.driving, tools[1], 2.0 * quarter, (thinner, quarter)),
        form.limits,
    )
    chords = ChordTolerance(tolerance_mm, tolerance_mm)
    driving, driven = (toothed_gear(tip, chords) for tip in tips)
    return MovingGears(driving, driven, least_contact_ratio(tips))


def moving_train(
    axes: MovingAxes,
    teeth: int,
    form: ToothForm,
    face_width_mm: float,
    bore_mm: float | None,
    speed_rpm: float,
    tolerance_mm: float,
    radius_mm: float | None,
) -> Train:
    """The pair as a train; ``radius_mm`` is the pitch radius of a round driving gear.  Raises as ``moving_gears``."""
    with below("train"):
        gears = moving_gears(axes, teeth, form, tolerance_mm)
    wall_mm = INNER_WALL_IN_MODULES * form.rack.module_mm
    parts = tuple(
        Part(name, gear.outline_mm, face_width_mm, gear.teeth, bore_mm=bore_mm, wall_mm=wall_mm)
        for name, gear in (("driving", gears.driving), ("driven", gears.driven))
    )

    def poses_at(driving_rad: Array) -> Poses:
        phi = np.asarray(driving_rad, dtype=float)
        none, distance = np.zeros(phi.size), axes.distance(phi, 0).value
        turned = axes.transmission.driven_angle(phi).value
        return Poses(np.stack([none, distance]), np.stack([none, none]), np.stack([phi, -turned]))

    told = _told(axes, gears, form.rack.module_mm, speed_rpm, radius_mm)
    mesh = (GearMesh("driving", "driven"),)
    return Train(parts, mesh, poses_at, "driving", axes.cycle_rad, speed_rpm, tolerance_mm, told)


def _told(
    axes: MovingAxes, gears: MovingGears, module: float, speed_rpm: float, radius_mm: float | None
) -> TrainFigures:
    near, far = axes.extremes(axes.distance)
    slow, fast = axes.extremes(lambda phi, order: axes.distance(phi, order + 1).differentiated())
    offset = max(abs(extremum.value) for extremum in axes.extremes(lambda phi, order: axes.pitch_point(phi, order)[1]))
    ratios = axes.transmission.ratio_range
    speed = max(abs(slow.value), abs(fast.value))
    undercut = {name: gear.undercut for name, gear in (("driving", gears.driving), ("driven", gears.driven))}
    rows = [
        ("gears", f"{gears.driving.teeth} and {gears.driven.teeth} teeth, module {module:.6g} mm"),
        (
            "axes",
            f"{near.value:.6g} mm apart at {degrees(placed_rad(near.at)):.4g} deg to {far.value:.6g} mm at "
            f"{degrees(placed_rad(far.at)):.4g} deg; the driven axis moves by up to {speed:.4g} mm per rad, "
            f"{speed * speed_rpm * RAD_S_PER_RPM:.4g} mm/s",
        ),
        ("pitch point", f"up to {offset:.4g} mm beside the line of centres"),
        ("ratio", f"{ratios[0].value:.5g} to {ratios[1].value:.5g}"),
        *([("driving gear", f"round, pitch radius {radius_mm:.6g} mm")] if radius_mm is not None else []),
    ]
    figures = {
        "module_mm": module,
        "driving_teeth": gears.driving.teeth,
        "driven_teeth": gears.driven.teeth,
        "center_distance_min_mm": near.value,
        "center_distance_max_mm": far.value,
        "axis_speed_max_mm_s": speed * speed_rpm * RAD_S_PER_RPM,
        "pitch_point_offset_max_mm": offset,
        "ratio_min": ratios[0].value,
        "ratio_max": ratios[1].value,
        "driving_radius_mm": radius_mm,
        "undercut": undercut,
        "contact_ratio_min": gears.contact_ratio,
    }
    contact = contact_condition(gears.contact_ratio, "more teeth (train.gears.teeth)", "a smaller range of distances")
    head = f"pair on a moving axis, {near.value:.5g} to {far.value:.5g} mm apart"
    return TrainFigures(head, tuple(rows), figures, (contact,))
