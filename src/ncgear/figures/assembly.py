"""The pose of the two gears at phi1 = 0, for the person who puts them on their shafts."""

from __future__ import annotations

from dataclasses import asdict
from math import cos, pi, sin
from typing import Any

import numpy as np

from ncgear.figures.numbers import rounded, to_size
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import crank_direction_rad
from ncgear.solids.plan.body import RoundHole

FLANK_BAND_IN_MODULES = 0.1
"""Where the outline is this near to the pitch curve, the line of centres meets a flank, not a tooth or a space."""

RAD_DECIMALS = 7
"""Decimals of an angle in rad: 1e-5 deg, as on a drawing."""


@dataclass(frozen=True, eq=False)
class Placed:
    """One gear to be placed: outline (mm, shape (n, 2)), pitch radius on the line of centres, index hole.

    The material of a ring (``is_ring``) is outside the outline.
    """

    outline_mm: Array
    pitch_radius_mm: float
    index_hole: RoundHole | None
    is_ring: bool = False


def assembly_of(drive: Drive) -> dict[str, Any]:
    """The pose of a drive's gears at phi1 = 0, ready for JSON, and their end stops; raises as the drive's solids do."""
    pitch, teeth, solids = drive.pitch, drive.teeth, drive.solids
    driving_radius, driven_radius = _pitch_radius_mm(pitch.driving), _pitch_radius_mm(pitch.driven)
    pose = assembled_pose(
        Placed(teeth.driving.outline_mm, driving_radius, solids.driving.index_hole),
        Placed(teeth.driven.outline_mm, driven_radius, solids.driven.index_hole, pitch.driven.is_ring),
        pitch.center_distance_mm,
        pitch.size.module_mm,
        pitch.mesh,
    )
    return {**pose, **_crank(drive), **_end_stops(drive), **_in_row(drive)}


def _crank(drive: Drive) -> dict[str, Any]:
    """The crank at phi1 = 0, in the frame of the driven gear that turns it; nothing for other gears.

    The frame of a ring is seen from the other side, so that its crank is not told.
    """
    if not drive.turns_crank or drive.pitch.driven.is_ring:
        return {}
    largest = drive.pitch.center_distance_mm
    direction = crank_direction_rad(drive.linkage, drive.gears.driving_axis_deg) % (2.0 * pi)
    pin = drive.solids.driven.plan.crank_pin
    hole = {"hole": {key: to_size(size_mm, largest) for key, size_mm in asdict(pin).items()}} if pin else {}
    length_mm = to_size(drive.linkage.crank_mm, largest)
    return {"crank": {"direction_rad": rounded(direction, RAD_DECIMALS), "length_mm": length_mm, **hole}}


def _in_row(drive: Drive) -> dict[str, Any]:
    """Where the pair of a row with idlers stands: in the frame of the first pair, seen from behind if every other pair.

    A point p of the pair's frame is at ``axis + exp(i direction) p`` there, from behind with the conjugate of p.
    """
    if drive.gears.idlers is None:
        return {}
    row, number = drive.whole.row, (drive.stage or 1) - 1
    axes, direction = row.axes_mm, row.directions_rad[number]
    sizes = {
        f"{gear}_axis_mm": [to_size(part, row.pairs[0].center_distance_mm) for part in (axis.real, axis.imag)]
        for gear, axis in zip(("driving", "driven"), axes[number : number + 2], strict=True)
    }
    turned = {"direction_rad": rounded(direction, RAD_DECIMALS), "seen_from_behind": number % 2 == 1}
    return {"row": {**sizes, **turned}}


def _end_stops(drive: Drive) -> dict[str, Any]:
    """Where gears that turn less than once must stop: angles counter-clockwise from the pose; nothing for others.

    A pin is in the frame, from the axis of the gear that it stops.
    """
    pitch = drive.pitch
    covered = pitch.transmission.lobes.range
    if covered is None:
        return {}
    turned = {"driving": covered.driving_rad, "driven": pitch.mesh.sense * covered.driven_rad}
    angles = {f"{gear}_rad": [0.0, rounded(angle, RAD_DECIMALS)] for gear, angle in turned.items()}
    pins = {f"{gear.value}_pin": pin for gear in Gear if (pin := _pin(drive, gear))}
    return {"end_stops": {**angles, **pins}}


def _pin(drive: Drive, gear: Gear) -> dict[str, float]:
    bodies = {Gear.DRIVING: drive.gears.driving, Gear.DRIVEN: drive.gears.driven}
    asked, place = bodies[gear].end_stop, drive.solids.of(gear).plan.pin_mm
    if asked is None or place is None:
        return {}
    sizes = {"x_mm": place[0], "y_mm": place[1], "diameter_mm": asked.pin_mm}
    return {key: to_size(size_mm, drive.pitch.center_distance_mm) for key, size_mm in sizes.items()}


def _pitch_radius_mm(curve: PitchCurve) -> float:
    """The pitch radius on the line of centres at phi1 = 0."""
    return float(np.linalg.norm(curve.at_angle(np.zeros(1)).position))


def assembled_pose(
    driving: Placed, driven: Placed, center_distance_mm: float, module_mm: float, mesh: Mesh = Mesh.EXTERNAL
) -> dict[str, Any]:
    """The pose of two gears at phi1 = 0.

    For each gear it holds the polar angle of the pitch point on the line of centres, in the gear's own frame; whether a
    tooth, a space or a flank lies there; and the index hole (None where none was asked for or had room).  Sizes have
    as many decimals as the centre distance.
    """
    return {
        "mesh": mesh.value,
        "center_distance_mm": to_size(center_distance_mm, center_distance_mm),
        "driving": _gear(driving, meeting_direction_rad(Gear.DRIVING, mesh), module_mm, center_distance_mm),
        "driven": _gear(driven, meeting_direction_rad(Gear.DRIVEN, mesh), module_mm, center_distance_mm),
    }


def _gear(gear: Placed, direction: float, module: float, largest: float) -> dict[str, Any]:
    hole = asdict(gear.index_hole) if gear.index_hole else None
    return {
        "line_of_centers_rad": rounded(direction, RAD_DECIMALS),
        "pitch_radius_mm": to_size(gear.pitch_radius_mm, largest),
        "on_line_of_centers": met_at(gear, direction, module),
        "index_hole": hole and {key: to_size(size_mm, largest) for key, size_mm in hole.items()},
    }


def met_at(gear: Placed, direction_rad: float, module_mm: float) -> str:
    """``tooth``, ``space`` or ``flank``, whichever a ray from the axis meets at the pitch curve."""
    beyond = outline_radius_mm(gear.outline_mm, direction_rad) - gear.pitch_radius_mm
    if abs(beyond) < FLANK_BAND_IN_MODULES * module_mm:
        return "flank"
    return "tooth" if (beyond > 0.0) is not gear.is_ring else "space"


def outline_radius_mm(outline_mm: Array, direction_rad: float) -> float:
    """Distance in mm from the axis of the farthest point at which a ray meets the outline; NaN where it never does."""
    turned = outline_mm @ np.array(
        [[cos(direction_rad), -sin(direction_rad)], [sin(direction_rad), cos(direction_rad)]]
    )
    following = np.roll(turned, -1, axis=0)
    crossing = (turned[:, 1] >= 0.0) != (following[:, 1] >= 0.0)
    (x0, y0), (x1, y1) = turned[crossing].T, following[crossing].T
    x = x0 + (x1 - x0) * y0 / (y0 - y1)
    ahead = x[x > 0.0]
    return float(ahead.max()) if ahead.size else float("nan")
