"""Charts of the slider's motion, of force and power, and of the ratio, beside the uniform crank at the same speed."""

from __future__ import annotations

from math import degrees, gcd

import numpy as np

from ncgear.drive import Drive
from ncgear.kinematics.slider import SliderMotion
from ncgear.output.joints import joints_up_to
from ncgear.output.page.chart import OWN, UNIFORM, Chart, Line
from ncgear.output.page.sampling import cycle_angles_rad
from ncgear.output.plots.curves import ACCELERATION, DISPLACEMENT, FORCE, POWER, VELOCITY, Quantity
from ncgear.ratio.transmission import Lobes

MOTION, LOAD = (DISPLACEMENT, VELOCITY, ACCELERATION), (FORCE, POWER)

RATIO = Quantity("ratio", "ratio i\u2081\u2082", "", 1.0, extreme=True)


def turns_of(lobes: Lobes) -> int:
    """Turns of the driving gear after which both gears stand as at the beginning."""
    return lobes.driven // gcd(lobes.driving, lobes.driven)


def motion_charts(drive: Drive) -> tuple[Chart, ...]:
    """Displacement to ratio over the driving angle; force and power where the design has a resistance."""
    phi1 = cycle_angles_rad(drive)
    tables = drive.machine.motion(phi1), drive.uniform_machine.motion(phi1)
    quantities = (*MOTION, *(LOAD if drive.design.resistance is not None else ()), RATIO)
    return tuple(_chart(drive, quantity, *tables) for quantity in quantities)


def _chart(drive: Drive, quantity: Quantity, own: SliderMotion, uniform: SliderMotion) -> Chart:
    end = 2.0 * np.pi * turns_of(drive.transmission.lobes)
    angle, period = np.degrees(own.phi1_rad), degrees(drive.transmission.cycle_rad)
    lines = (
        Line(OWN, "this design", angle, quantity.of(own), period),
        Line(UNIFORM, "uniform crank", angle, quantity.of(uniform), period),
    )
    joints = np.degrees(joints_up_to(drive.transmission, end))
    return Chart(quantity.column, quantity.name, quantity.unit, lines, degrees(end), joints)
