"""The pictures of a build as values: contents and headings; ``plots/assembled_pair.py`` draws them."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.drawings.assembled import Assembled, AssembledPosition
from ncgear.drawings.charts import teeth_charts
from ncgear.drawings.charts.chart import (
    EMPTY,
    LOAD,
    MOTION,
    Chart,
    ChartLine,
    Quantity,
    Role,
    joints_up_to,
    motion_chart,
    over_displacement,
)
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

POSITIONS = 3
"""Positions of the pair in the picture of its teeth, evenly spread over a turn or from end to end."""

NO_BACKLASH_RAD = 1e-9
"""Play in rad below which there is no chart of play: some nanometres at the flanks."""

CURVE_POINTS = 1500
"""Points of a drawn pitch curve; on a gear of 300 mm that fills a screen they are 0.2 mm apart on the screen."""


def slider_chart(drive: Drive, quantity: Quantity) -> Chart:
    """A quantity of a drive's motion, beside the uniform law's, with the joints of the law."""
    own, uniform = drive.drawn_motions
    joints = np.degrees(joints_up_to(drive.transmission, float(own.phi1_rad[-1])))
    return motion_chart(quantity, drive.linkage, own, uniform, joints)


def motion_picture(drive: Drive) -> tuple[list[Chart], str]:
    """The content of the picture of the machine's motion: its charts and its heading."""
    return [slider_chart(drive, quantity) for quantity in MOTION], titled(drive, "motion")


def gear_pictures(
    drive: Drive,
) -> tuple[str, tuple[Assembled, tuple[Mask, Mask]], Assembled, float, list[AssembledPosition]]:
    """The content of the pictures of the gears: the pair's name, pitch curves, teeth, module in mm, positions.

    Pitch curves come with masks of their concave points.  The contact of the gears is not known yet.
    """
    covered = drive.pair.transmission.lobes.range
    turn = np.arange(POSITIONS) * 2.0 * pi / POSITIONS
    positions = positions_at(drive, np.linspace(0.0, covered.driving_rad, POSITIONS) if covered else turn)
    shown = assembled_pitch_curves(drive), assembled_teeth(drive), drive.pitch.size.module_mm, positions
    return _name_of_pair(drive), *shown


def load_pictures(drive: Drive, contact: PairContact) -> tuple[str, list[Chart], list[tuple[Chart, Chart]], str]:
    """The content of the pictures of contact and load: the pair's name, charts of both, and the heading of the load.

    Each chart of the load over the driving angle has a chart over displacement beside it.
    """
    load = [slider_chart(drive, quantity) for quantity in LOAD]
    pairs = [(chart, over_displacement(chart, drive.linkage.OUTPUT, drive.drawn_motions)) for chart in load]
    title = titled(drive, f"{drive.linkage.OUTPUT.load_name} and power")
    return _name_of_pair(drive), _contact_charts(drive, contact), pairs, title


def _name_of_pair(drive: Drive) -> str:
    return drive.title if drive.stage is None else f"{drive.title} by its own angles"


def titled(drive: Drive, what: str) -> str:
    """The heading of a picture of the machine: design, content and speed."""
    return f"{drive.design.name}: {what} at {drive.design.operation.speed_rpm:.4g} r/min"


def assembled_pitch_curves(drive: Drive) -> tuple[Assembled, tuple[Mask, Mask]]:
    """Both pitch curves of a drive, and masks (shape (n,)) of their points on concave stretches."""
    driving, driven = (curve.drawn(CURVE_POINTS) for curve in (drive.pitch.driving, drive.pitch.driven))
    dented = driven.curvature > 0.0 if drive.pitch.driven.is_ring else driven.curvature < 0.0
    places, masks = [driving.position, driven.position], [driving.curvature < 0.0, dented]
    if drive.pitch.toothed is not None:
        # The straight sides from both ends to the axis lie on the line of centres at the end stops.
        places = [np.vstack([curve, np.zeros((1, 2))]) for curve in places]
        masks = [np.append(mask, False) for mask in masks]
    return _assembled(drive, *places), (masks[0], masks[1])


def assembled_teeth(drive: Drive) -> Assembled:
    """Both tooth outlines of a drive."""
    return _assembled(drive, drive.teeth.driving.outline_mm, drive.teeth.driven.outline_mm)


def positions_at(drive: Drive, phi1_rad: Array) -> list[AssembledPosition]:
    """The positions of the pair at driving angles in rad, shape (n,)."""
    phi2 = drive.pair.transmission.driven_angle(phi1_rad).value
    point = drive.pitch.pitch_point_mm(phi1_rad)
    return [AssembledPosition(float(a), float(b), float(x)) for a, b, x in zip(phi1_rad, phi2, point, strict=True)]


def _assembled(drive: Drive, driving_mm: Array, driven_mm: Array) -> Assembled:
    ring_radius = drive.outer_radii_mm[Gear.DRIVEN] if drive.pitch.driven.is_ring else None
    return Assembled(driving_mm, driven_mm, drive.pitch.center_distance_mm, ring_radius)


def _contact_charts(drive: Drive, contact: PairContact) -> list[Chart]:
    """All charts of the contact, with the joints of the law; the chart of backlash only if there is backlash."""
    designed = contact.as_designed
    kinds = [teeth_charts.flanks_in_contact, teeth_charts.pressure_angle, teeth_charts.sliding]
    if np.max(np.abs(designed.backlash_rad)) >= NO_BACKLASH_RAD:
        kinds.insert(0, teeth_charts.backlash)
    errors = teeth_charts.transmission_error(contact)
    # The legend is above the first row, which has no line of the back flanks: an empty line there names them.
    pushing, written = errors.lines
    errors = replace(errors, lines=(pushing, ChartLine(Role.OTHER, teeth_charts.BACKS, EMPTY, EMPTY), written))
    joints = np.degrees(joints_up_to(drive.pair.transmission, designed.placement.cycle_rad))
    return [replace(chart, joints_deg=joints) for chart in (errors, *(kind(designed) for kind in kinds))]
