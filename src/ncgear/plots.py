"""What of a drive can be drawn onto axes of matplotlib, one function for each picture.

Each takes the drive and, if wanted, the axes; without these it makes a figure of its own.  It returns the axes, so that
labels and limits can be changed:

>>> import ncgear
>>> drive = ncgear.load("designs/ellipse.yaml")
>>> ncgear.plots.acceleration(drive).get_ylabel()
'acceleration in m/s\u00b2'

Drawing computes the stages that it shows, and raises as they do.
"""

from __future__ import annotations

from math import degrees

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.pictures import drawn_pitch_curves, drawn_teeth, motion_joints_rad, positions_at
from ncgear.drawings.plots import contact as mesh
from ncgear.drawings.plots import curves
from ncgear.drawings.plots import gears as pairs
from ncgear.drawings.plots.canvas import angle_scale
from ncgear.project.drive import Drive

__all__ = [
    "acceleration",
    "backlash",
    "displacement",
    "flanks_in_contact",
    "force",
    "mesh_at",
    "pair_at",
    "pitch_curves",
    "power",
    "pressure_angles",
    "sliding",
    "velocity",
]


def displacement(drive: Drive, axes: Axes | None = None) -> Axes:
    """The slider's displacement over the driving angle, beside the uniform crank."""
    return _over_angle(drive, axes, curves.DISPLACEMENT)


def velocity(drive: Drive, axes: Axes | None = None) -> Axes:
    """The slider's velocity over the driving angle, beside the uniform crank at the same speed."""
    return _over_angle(drive, axes, curves.VELOCITY)


def acceleration(drive: Drive, axes: Axes | None = None) -> Axes:
    """The slider's acceleration over the driving angle, beside the uniform crank at the same speed."""
    return _over_angle(drive, axes, curves.ACCELERATION)


def force(drive: Drive, axes: Axes | None = None) -> Axes:
    """The force against the slider over the driving angle, beside the uniform crank."""
    return _over_angle(drive, axes, curves.FORCE)


def power(drive: Drive, axes: Axes | None = None) -> Axes:
    """The driving power over the driving angle, beside the uniform crank at the same speed."""
    return _over_angle(drive, axes, curves.POWER)


def pitch_curves(drive: Drive, axes: Axes | None = None) -> Axes:
    """Both pitch curves assembled at phi1 = 0, concave stretches highlighted."""
    axes = axes or _own_axes()
    pairs.draw_pitch_curves(axes, *drawn_pitch_curves(drive))
    return axes


def pair_at(drive: Drive, phi1_rad: float = 0.0, axes: Axes | None = None) -> Axes:
    """Both toothed gears in mesh at a driving angle in rad."""
    axes = axes or _own_axes()
    pairs.draw_whole(axes, drawn_teeth(drive), *positions_at(drive, np.array([phi1_rad])))
    return axes


def mesh_at(drive: Drive, phi1_rad: float = 0.0, axes: Axes | None = None) -> Axes:
    """The teeth around the pitch point at a driving angle in rad."""
    axes = axes or _own_axes()
    half_mm = pairs.ZOOM_IN_MODULES * drive.pitch.size.module_mm
    pairs.draw_mesh(axes, drawn_teeth(drive), half_mm, *positions_at(drive, np.array([phi1_rad])))
    return axes


def backlash(drive: Drive, axes: Axes | None = None) -> Axes:
    """Play of the driven gear over the driving angle, as designed."""
    return _of_contact(drive, axes, mesh.backlash)


def flanks_in_contact(drive: Drive, axes: Axes | None = None) -> Axes:
    """How many pairs of flanks touch over the driving angle, as designed."""
    return _of_contact(drive, axes, mesh.flanks_in_contact)


def pressure_angles(drive: Drive, axes: Axes | None = None) -> Axes:
    """Pressure angle of the flanks that carry, over the driving angle, as designed."""
    return _of_contact(drive, axes, mesh.pressure_angles)


def sliding(drive: Drive, axes: Axes | None = None) -> Axes:
    """Speed of sliding of the flanks that carry per speed of the driving gear, over the driving angle, as designed."""
    return _of_contact(drive, axes, mesh.sliding)


def _own_axes() -> Axes:
    # A figure that nobody asked for by itself is pyplot's, so that notebooks and windows show it.
    from matplotlib import pyplot

    return pyplot.subplots()[1]


def _over_angle(drive: Drive, axes: Axes | None, quantity: curves.Quantity) -> Axes:
    axes = axes or _own_axes()
    curves.over_angle(axes, drive.motion, drive.uniform_motion, quantity, motion_joints_rad(drive))
    angle_scale([axes], degrees(drive.motion.phi1_rad[-1]))
    return axes


def _of_contact(drive: Drive, axes: Axes | None, draw: mesh.Drawing) -> Axes:
    axes, designed = axes or _own_axes(), drive.designed_contact
    draw(axes, designed)
    angle_scale([axes], degrees(designed.placement.cycle_rad))
    return axes
