"""Pictures of a drive on axes of matplotlib, one function for each picture.

Each function takes the drive and, if wanted, the axes; without axes it makes a figure of its own.  It returns the axes,
so that labels and limits can be changed:

>>> import ncgear
>>> drive = ncgear.load("designs/ellipse.yaml")
>>> ncgear.plots.acceleration(drive).get_ylabel()
'acceleration in mm/s\u00b2'

Drawing computes the attributes of the drive that it shows, and raises their errors.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.charts import teeth_charts
from ncgear.drawings.charts.chart import Chart, Quantity
from ncgear.drawings.charts.drawer import CONTACT_LOOK, MOTION_LOOK, Look, angle_scale, draw
from ncgear.drawings.pictures import assembled_pitch_curves, assembled_teeth, positions_at, slider_chart
from ncgear.drawings.plots.assembled_pair import ZOOM_IN_MODULES, draw_mesh, draw_pitch_curves, draw_whole
from ncgear.errors import WrongInput
from ncgear.figures.side_by_side import SideBySide
from ncgear.files.side_by_side import draw_side_by_side
from ncgear.project.drive import Drive

__all__ = [
    "acceleration",
    "backlash",
    "compared",
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
    """The output's displacement over the driving angle, beside the uniform crank."""
    return _drawn(slider_chart(drive, Quantity.DISPLACEMENT), MOTION_LOOK, axes)


def velocity(drive: Drive, axes: Axes | None = None) -> Axes:
    """The output's velocity over the driving angle, beside the uniform crank at the same speed."""
    return _drawn(slider_chart(drive, Quantity.VELOCITY), MOTION_LOOK, axes)


def acceleration(drive: Drive, axes: Axes | None = None) -> Axes:
    """The output's acceleration over the driving angle, beside the uniform crank at the same speed."""
    return _drawn(slider_chart(drive, Quantity.ACCELERATION), MOTION_LOOK, axes)


def force(drive: Drive, axes: Axes | None = None) -> Axes:
    """The force or torque against the output over the driving angle, beside the uniform crank."""
    return _drawn(slider_chart(drive, Quantity.LOAD), MOTION_LOOK, axes)


def power(drive: Drive, axes: Axes | None = None) -> Axes:
    """The driving power over the driving angle, beside the uniform crank at the same speed."""
    return _drawn(slider_chart(drive, Quantity.POWER), MOTION_LOOK, axes)


def compared(found: SideBySide, quantity: str = "acceleration", axes: Axes | None = None) -> Axes:
    """A quantity of designs side by side (``ncgear.compare``) over the driving angle, a line for each.

    The quantity is one of displacement, velocity, acceleration, load, power and ratio.
    """
    known = {quantity.name.lower(): quantity for quantity in Quantity}
    if quantity not in known:
        raise WrongInput(f"{quantity!r} given; {', '.join(known)} are right", key="quantity")
    axes = axes or _own_axes()
    angle_scale([axes], draw_side_by_side(axes, found, known[quantity]))
    return axes


def backlash(drive: Drive, axes: Axes | None = None) -> Axes:
    """Play of the driven gear over the driving angle, as designed."""
    return _drawn(teeth_charts.backlash(drive.designed_contact), CONTACT_LOOK, axes)


def flanks_in_contact(drive: Drive, axes: Axes | None = None) -> Axes:
    """Number of touching pairs of flanks over the driving angle, as designed."""
    return _drawn(teeth_charts.flanks_in_contact(drive.designed_contact), CONTACT_LOOK, axes)


def pressure_angles(drive: Drive, axes: Axes | None = None) -> Axes:
    """Pressure angle of the flanks that carry, over the driving angle, as designed."""
    return _drawn(teeth_charts.pressure_angle(drive.designed_contact), CONTACT_LOOK, axes)


def sliding(drive: Drive, axes: Axes | None = None) -> Axes:
    """Speed of sliding of the flanks that carry, divided by the driving gear's speed, over the driving angle."""
    return _drawn(teeth_charts.sliding(drive.designed_contact), CONTACT_LOOK, axes)


def pitch_curves(drive: Drive, axes: Axes | None = None) -> Axes:
    """Both pitch curves assembled at phi1 = 0, concave stretches highlighted."""
    axes = axes or _own_axes()
    draw_pitch_curves(axes, *assembled_pitch_curves(drive))
    return axes


def pair_at(drive: Drive, phi1_rad: float = 0.0, axes: Axes | None = None) -> Axes:
    """Both toothed gears in mesh at a driving angle in rad."""
    axes = axes or _own_axes()
    draw_whole(axes, assembled_teeth(drive), *positions_at(drive, np.array([phi1_rad])))
    return axes


def mesh_at(drive: Drive, phi1_rad: float = 0.0, axes: Axes | None = None) -> Axes:
    """The teeth around the pitch point at a driving angle in rad."""
    axes = axes or _own_axes()
    half_mm = ZOOM_IN_MODULES * drive.pitch.size.module_mm
    draw_mesh(axes, assembled_teeth(drive), half_mm, *positions_at(drive, np.array([phi1_rad])))
    return axes


def _drawn(chart: Chart, look: Look, axes: Axes | None) -> Axes:
    axes = axes or _own_axes()
    draw(axes, chart, look)
    angle_scale([axes], chart.end)
    return axes


def _own_axes() -> Axes:
    # The figure belongs to pyplot, so that notebooks and windows show it.
    from matplotlib import pyplot

    return pyplot.subplots()[1]
