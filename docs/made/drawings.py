"""Drawings that explain the method, each of a design of this repository, as PNG."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import degrees, pi, tan
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import ncgear
from ncgear.drawings.pictures import assembled_teeth, positions_at
from ncgear.drawings.plots.assembled_pair import draw_mesh
from ncgear.drawings.plots.canvas import (
    DRIVEN,
    DRIVING,
    HIGHLIGHT,
    INK,
    NORMAL,
    REFERENCE,
    Margins,
    dress,
    figure,
    png,
)
from ncgear.files.searched import outline_picture
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import turned
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.outline_fit import OutlineFit, fitted

DESIGNS = Path(__file__).parents[2] / "designs"

SHOWN_RAD = 0.75 * pi
"""The driving angle that the picture of inversion follows through."""

PLACE = 0.39
"""Share of the pitch curve's length at which the picture of the rack looks closely."""

WITHIN = 0.85
"""Share of the rack's flank on which its contacts are marked: beyond it, tip or fillet may have taken the tooth's."""

CORNER_RAD = 0.2
"""Turn of an outline beyond which the picture of its check marks a corner."""

CHAIN = (0, (8, 2, 1, 2))

DOTTED: dict[str, Any] = {"color": HIGHLIGHT, "linewidth": 1.4, "linestyle": (0, (2, 1.5))}


@cache
def pusher() -> ncgear.Drive:
    """The drive of the tutorial."""
    return ncgear.load(DESIGNS / "pusher.yaml")


def inversion() -> bytes:
    """From the displacement that is wished, through the linkage, to the angle that the driven gear must have."""
    size = 10.5, 3.9
    made = figure(*size, "Inversion: what the gears must do")
    shares = {**Margins(left=0.75).shares(*size), "wspace": 0.28}
    wished, linkage, found = made.subplots(1, 3, gridspec_kw=shares)
    motion = pusher().motion
    phi2 = np.linspace(0.0, 2.0 * pi, 361)
    through = pusher().linkage.displacement(Jet.variable(phi2, 0)).value
    wished.plot(np.degrees(motion.phi1_rad), motion.displacement, color=DRIVING, linewidth=1.8)
    linkage.plot(np.degrees(phi2), through, color=REFERENCE, linewidth=1.8)
    found.plot(np.degrees(motion.phi1_rad), np.degrees(motion.phi2_rad), color=DRIVEN, linewidth=1.8)
    dress(wished, "driving angle phi1 in deg", "displacement wished in mm")
    dress(linkage, "driven angle phi2 in deg", "displacement by the linkage in mm")
    dress(found, "driving angle phi1 in deg", "driven angle phi2 in deg")
    _follow(wished, linkage, found)
    for axes in (wished, linkage, found):
        axes.set_xticks(range(0, 361, 90))
        axes.set_xlim(0.0, 360.0)
        axes.set_ylim(bottom=0.0)
    return png(made)


def _follow(wished: Axes, linkage: Axes, found: Axes) -> None:
    """One driving angle, followed through all three."""
    motion = pusher().motion
    phi1, phi2, way = (
        float(np.interp(SHOWN_RAD, motion.phi1_rad, values))
        for values in (np.degrees(motion.phi1_rad), np.degrees(motion.phi2_rad), motion.displacement)
    )
    wished.plot([phi1, phi1, 360.0], [0.0, way, way], **DOTTED)
    linkage.plot([0.0, phi2, phi2], [way, way, 0.0], **DOTTED)
    found.plot([phi1, phi1, 0.0], [0.0, phi2, phi2], **DOTTED)


@dataclass(frozen=True)
class StrokeMarks:
    """The keys of a three-segment stroke on its speed curve: angles in rad, speeds in mm/s at the law speed.

    ``a1_mm_s_rad`` is the slope at theta4 in mm/s to a radian of the driving angle: a1 at the law speed, divided by it.
    """

    theta_rad: tuple[float, float, float, float]
    v1_mm_s: float
    v2_mm_s: float
    a1_mm_s_rad: float


def stroke_marks(drive: ncgear.Drive) -> StrokeMarks:
    """What the design file of a drive says of its stroke."""
    motion: Any = drive.design.motion
    omega, stated = drive.law_speed_rpm * RAD_S_PER_RPM, motion.a1_speed_rpm * RAD_S_PER_RPM
    first, second, third, fourth = (pi * getattr(motion, f"theta{number}_pi") for number in (1, 2, 3, 4))
    slope = motion.a1_mm_s2 * (omega / stated) ** 2 / omega
    return StrokeMarks((first, second, third, fourth), motion.v1_mm_s, motion.v2_mm_s, slope)


ARROW = {"arrowstyle": "<->", "color": REFERENCE}

SEGMENTS = ("approach", "constant speed", "braking", "return stroke: found by ncgear")
"""What the stretches between the dead centres, theta2, theta3 and theta4 are called."""


def stroke() -> bytes:
    """The keys theta1 to theta4, v1, v2, a1 and the stroke on the speed curve of the baler."""
    drive = ncgear.load(DESIGNS / "baler.yaml")
    marks, scale = stroke_marks(drive), drive.law_speed_rpm / drive.design.operation.speed_rpm
    size = 9.2, 4.6
    made = figure(
        *size, f"The keys of a three-segment stroke, on the speed of the baler at {drive.law_speed_rpm:.2f} r/min"
    )
    axes = made.subplots(gridspec_kw=Margins(left=0.95, top=0.95).shares(*size))
    angle, speed = np.degrees(drive.motion.phi1_rad), scale * drive.motion.velocity
    axes.plot(angle, speed, color=DRIVING, linewidth=2.2)
    axes.axhline(0.0, color=REFERENCE, linewidth=0.9)
    theta = [degrees(place) for place in marks.theta_rad]
    # The return goes far below what is explained here.
    high, low = marks.v1_mm_s, -1.05 * marks.v1_mm_s
    working = angle <= theta[3]
    axes.fill_between(angle[working], speed[working], color=DRIVING, alpha=0.1, linewidth=0.0)
    axes.text(theta[0] + 6.0, 0.3 * high, "area, over time: stroke_mm", color=INK, size=NORMAL)
    for number, place in enumerate(theta, start=1):
        axes.plot([place, place], [low, 1.16 * high], **DOTTED)
        text = f"theta{number}\n{place / 180.0:g} pi"
        axes.text(place, 1.18 * high, text, color=HIGHLIGHT, size=NORMAL, ha="center", va="bottom", weight="bold")
    for value, place in ((marks.v1_mm_s, theta[0]), (marks.v2_mm_s, theta[1])):
        axes.plot([0.0, place], [value, value], **DOTTED)
    of_v2 = (theta[1] + theta[2]) / 2.0, marks.v2_mm_s - 160.0
    for (x, y), text in (((3.0, high + 40.0), f"v1 = {high:g} mm/s"), (of_v2, f"v2 = {marks.v2_mm_s:g} mm/s")):
        axes.text(x, y, text, color=HIGHLIGHT, size=NORMAL, weight="bold", ha="left" if x == 3.0 else "center")
    slope = marks.a1_mm_s_rad * pi / 180.0
    reach = np.array([-38.0, 30.0])
    axes.plot(theta[3] + reach, slope * reach, color=DRIVEN, linewidth=1.6)
    axes.annotate(
        "slope: the acceleration a1",
        (theta[3] - 30.0, -30.0 * slope),
        xytext=(theta[3] + 10.0, 0.75 * high),
        color=DRIVEN,
        size=NORMAL,
        weight="bold",
        arrowprops={"arrowstyle": "-", "color": DRIVEN},
    )
    for name, start, end in zip(SEGMENTS, (0.0, *theta[1:]), (*theta[1:], 360.0), strict=True):
        axes.annotate("", (start, 0.93 * low), xytext=(end, 0.93 * low), arrowprops=ARROW)
        axes.text((start + end) / 2.0, 0.9 * low, name, color=INK, size=NORMAL, ha="center", va="bottom")
    for place, name in ((0.0, "retracted"), (theta[3], "extended"), (360.0, "retracted")):
        axes.plot(place, 0.0, "o", color=INK, markersize=6.0, clip_on=False)
        aside, side = (4.0, "left") if place == 0.0 else (-4.0, "right")
        axes.text(place + aside, 0.05 * low, name, color=INK, size=NORMAL, va="top", ha=side)
    dress(axes, "driving angle phi1 in deg", "speed of the slider in mm/s")
    axes.set_xlim(0.0, 360.0)
    axes.set_ylim(low, 1.16 * high)
    axes.set_xticks(range(0, 361, 60))
    return png(made)


def rack() -> bytes:
    """The imaginary rack in three places on a pitch curve, and the teeth that it leaves; one place from near."""
    size = 10.5, 5.4
    made = figure(*size, "The rack rolls on the pitch curve and touches where normals go through the pitch point")
    whole, near = made.subplots(1, 2, gridspec_kw={**Margins().shares(*size), "wspace": 0.2})
    drive = ncgear.load(DESIGNS / "ellipse.yaml")
    for axes in (whole, near):
        _draw_gear(axes, drive)
        for share in (0.06, PLACE, 0.72):
            _lay_rack(axes, drive, share * drive.pitch.driving.length_mm)
        dress(axes, "x in mm", "y in mm")
        axes.set_aspect("equal", adjustable="datalim" if axes is whole else "box")
    _mark_contacts(near, drive, PLACE * drive.pitch.driving.length_mm)
    return png(made)


def _draw_gear(axes: Axes, drive: ncgear.Drive) -> None:
    curve = drive.pitch.driving
    axes.plot(*_closed(drive.teeth.driving.outline_mm).T, color=DRIVING, linewidth=1.2)
    around = curve.at_length(np.linspace(0.0, curve.length_mm, 721)).position
    axes.plot(*around.T, color=REFERENCE, linewidth=0.9, linestyle=CHAIN)
    axes.plot(0.0, 0.0, "+", color=INK, markersize=11)


def shaped_points(drive: ncgear.Drive, sigma_mm: float) -> Array:
    """Points that the rack shapes where it lies at an arc length, shape (n, 2), by the equation of docs/method.md."""
    point = drive.pitch.driving.at_length(np.array(sigma_mm))
    flanks, rack = drive.teeth.driving.flanks, drive.rack
    height = (flanks.crossing_mm - sigma_mm) * flanks.slant.height_per_rolled * flanks.side
    reached = (height > -WITHIN * rack.flank_depth_mm) & (height < WITHIN * rack.tip_height_mm)
    along = height[reached] * flanks.side[reached] / tan(rack.pressure_angle_rad)
    places: Array = point.position + along[:, None] * point.tangent + height[reached, None] * point.normal
    return places


def _mark_contacts(axes: Axes, drive: ncgear.Drive, sigma_mm: float) -> None:
    """The points that the rack shapes, and the view on them."""
    point = drive.pitch.driving.at_length(np.array(sigma_mm)).position
    for place in shaped_points(drive, sigma_mm):
        axes.plot(*np.array([point, place]).T, **DOTTED)
        axes.plot(*place, "o", color=HIGHLIGHT, markersize=5.0, zorder=5)
    half = 4.0 * drive.rack.module_mm
    axes.set_xlim(point[0] - half, point[0] + half)
    axes.set_ylim(point[1] - half, point[1] + half)


def _lay_rack(axes: Axes, drive: ncgear.Drive, sigma_mm: float) -> None:
    """Three teeth of the rack, rolled to an arc length: its pitch line is the tangent there."""
    point = drive.pitch.driving.at_length(np.array(sigma_mm))
    along, out = _rack_profile(drive, sigma_mm)
    profile = point.position + along[:, None] * point.tangent + out[:, None] * point.normal
    axes.plot(*profile.T, color=DRIVEN, linewidth=1.2)
    reach = np.array([along.min(), along.max()])
    line = point.position + reach[:, None] * point.tangent
    axes.plot(*line.T, color=DRIVEN, linewidth=0.7, linestyle=CHAIN)
    axes.plot(*point.position, "o", color=INK, markersize=4.0, zorder=5)


def _rack_profile(drive: ncgear.Drive, sigma_mm: float) -> tuple[Array, Array]:
    """Corners of the rack around the pitch point: places along the pitch line, heights over it."""
    rack = drive.rack
    lean, pitch = tan(rack.pressure_angle_rad), rack.pitch_mm
    crossing = drive.teeth.driving.flanks.crossing_mm[::2]
    nearest = crossing[np.argmin(np.abs(crossing - sigma_mm))] - sigma_mm
    corners = [
        (-pitch / 2.0 - rack.tip_height_mm * lean, rack.tip_height_mm),
        (-pitch / 2.0 + rack.dedendum_mm * lean, -rack.dedendum_mm),
        (-rack.dedendum_mm * lean, -rack.dedendum_mm),
        (rack.tip_height_mm * lean, rack.tip_height_mm),
    ]
    teeth = [(nearest + k * pitch + x, y) for k in (-1, 0, 1, 2) for x, y in corners]
    along, out = np.array(teeth).T
    return along, out


def contact() -> bytes:
    """Teeth in mesh: the flanks touch where their normals go through the pitch point."""
    size = 6.4, 6.2
    made = figure(*size, "Contact: normals go through the pitch point")
    axes = made.subplots(gridspec_kw=Margins().shares(*size))
    drive = pusher()
    touching = drive.designed_contact.pushing.touching
    position = int(np.argmax(np.bincount(touching.position)))
    placement = drive.designed_contact.placement
    stands = positions_at(drive, placement.phi1_rad[position : position + 1])[0]
    draw_mesh(axes, assembled_teeth(drive), 3.2 * drive.rack.module_mm, stands)
    here = touching.kept((touching.position == position) & touching.flanks)
    points = np.column_stack([here.point.real, here.point.imag])
    points = turned(points, np.asarray(-stands.phi2_rad)) + np.array([drive.pitch.center_distance_mm, 0.0])
    for point in points:
        axes.plot([stands.pitch_point_mm, point[0]], [0.0, point[1]], **DOTTED)
        axes.plot(*point, "o", color=HIGHLIGHT, markersize=6.0, zorder=5)
    return png(made)


def _closed(points: Array) -> Array:
    return np.vstack([points, points[:1]])


HEART = {
    "name": "heart",
    "operation": {"speed_rpm": 30},
    "motion": {"law": "pitch_curve", "svg": {"file": str(DESIGNS / "heart.svg"), "axis_x_mm": 32, "axis_y_mm": 27}},
    "gears": {"teeth": 64, "face_width_mm": 8, "drives": "both_ways", "backlash_mm": 0.05},
    "outline": {"pressure_angle_deg": 65},
}
"""The design of the page about drawings."""


@cache
def _heart() -> OutlineFit:
    return fitted(ncgear.load(HEART).design)


def heart_drawing() -> bytes:
    """The outline alone."""
    made = figure(4.0, 3.9, "designs/heart.svg", Margins(left=0.6, right=0.2, top=0.5))
    axes = made.add_subplot()
    axes.fill(*_heart().outline.corners.T, color=HIGHLIGHT, alpha=0.6)
    axes.set_aspect("equal")
    dress(axes, "x in mm", "y in mm")
    return png(made)


def heart_check() -> bytes:
    """The outline with its axis and the corners on which no teeth stand."""
    outline, axis_mm, _ = ncgear.load(HEART).design.motion.outline_mm()
    way = np.diff(outline, axis=0, append=outline[:1])
    heading = np.arctan2(way[:, 1], way[:, 0])
    turn = (heading - np.roll(heading, 1) + pi) % (2.0 * pi) - pi
    made = figure(4.0, 3.9, "What the check finds", Margins(left=0.6, right=0.2, top=0.5))
    axes = made.add_subplot()
    axes.plot(*np.append(outline, outline[:1], axis=0).T, color=DRIVING)
    axes.plot(*axis_mm, "+", color=INK, markersize=10)
    axes.annotate("axis", tuple(axis_mm.tolist()), xytext=(6, 6), textcoords="offset points")
    for place in np.flatnonzero(np.abs(turn) > CORNER_RAD):
        axes.plot(*outline[place], "o", color=HIGHLIGHT)
        told = f"{abs(degrees(turn[place])):.0f}°"
        axes.annotate(told, tuple(outline[place].tolist()), xytext=(9, -4), textcoords="offset points", color=HIGHLIGHT)
    axes.set_aspect("equal")
    dress(axes, "x in mm", "y in mm")
    return png(made)


def heart_fit() -> bytes:
    """The outline, the fitted curve and its mate."""
    return outline_picture(_heart(), "heart")


def heart_gears() -> bytes:
    """Both gears in mesh."""
    made = figure(8.2, 5.2, "heart-fitted: both gears", Margins(left=0.6, right=0.2, top=0.5))
    ncgear.plots.pair_at(_heart().drive, 0.0, made.add_subplot())
    return png(made)
