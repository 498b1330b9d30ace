"""Charts of the slider's motion, of force and power, and of the ratio, beside the uniform crank at the same speed."""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.drive import Drive
from ncgear.kinematics.slider import SliderMotion
from ncgear.output.joints import joints_up_to
from ncgear.output.page.chart import OWN, UNIFORM, Chart, Line
from ncgear.output.page.sampling import cycle_angles_rad
from ncgear.output.plots.curves import ACCELERATION, DISPLACEMENT, FORCE, POWER, VELOCITY, Quantity

MOTION, LOAD = (DISPLACEMENT, VELOCITY, ACCELERATION), (FORCE, POWER)

RATIO = Quantity("ratio", "ratio i\u2081\u2082", "", extreme=True)


def motion_charts(drive: Drive, end_rad: float) -> tuple[Chart, ...]:
    """Displacement to ratio from 0 to a driving angle; force and power where the design has a resistance."""
    phi1 = cycle_angles_rad(drive)
    tables = drive.machine.motion(phi1), drive.uniform_machine.motion(phi1)
    quantities = (*MOTION, *(LOAD if drive.design.resistance is not None else ()), RATIO)
    return tuple(_chart(drive, quantity.readable(*tables), *tables, end_rad) for quantity in quantities)


def _chart(drive: Drive, quantity: Quantity, own: SliderMotion, uniform: SliderMotion, end_rad: float) -> Chart:
    angle, period = np.degrees(own.phi1_rad), degrees(drive.transmission.cycle_rad)
    lines = (
        Line(OWN, "this design", angle, quantity.of(own), period),
        Line(UNIFORM, "uniform crank", angle, quantity.of(uniform), period),
    )
    joints = np.degrees(joints_up_to(drive.transmission, end_rad))
    return Chart(quantity.column, quantity.name, quantity.unit, lines, degrees(end_rad), joints)
