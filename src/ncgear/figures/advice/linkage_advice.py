"""The advice about a linkage whose transmission angle is so small that friction may lock it."""

from __future__ import annotations

from math import atan, degrees, pi, radians, sin

import numpy as np

from ncgear.figures.advice.values import Advice, Kind, Remedy, Where
from ncgear.figures.numbers import fixed, to_digits
from ncgear.kinematics.outcomes import driving_rad
from ncgear.project.drive import Drive

FRICTION = 0.25
"""Coefficient of friction of steel on steel at rest without grease, which is 0.15 to 0.3."""

FLATTEST_DEG = round(degrees(atan(FRICTION)))
"""Transmission angle in degrees, under which friction may lock: the angle of friction.

A rod at angle b to a slider's line pushes it by F cos(b), and its guide rubs by FRICTION F sin(b), which is as much
where tan(90 deg - b) = FRICTION.  The same holds of a lever's pin in the slot of its ram.  A rocker rubs at its axis,
on a shorter arm; there less than a quarter of the coupler's force turns it, and small errors of lengths lock it.
Textbooks recommend 40 deg and more (e.g. R. L. Norton, "Design of Machinery", 5th edition, 2012, section 3.3), for
quiet and light machines: between these angles friction costs power, but does not lock.
"""


def transmission_angle(drive: Drive) -> Advice | None:
    """A linkage whose output is hardly pushed along its way, of the crank angles that it turns through.

    The angle is least where the linkage says, or where an open law ends.
    """
    linkage, covered = drive.linkage, drive.transmission.lobes.range
    end = covered.driven_rad if covered else 2.0 * pi
    places = [0.0, linkage.working_angle_rad, *(place for place, _ in linkage.corners), *([end] if covered else [])]
    crank = np.array([place for place in places if place <= end])
    angles = linkage.transmission_rad(crank)
    least = int(np.argmin(angles))
    angle = degrees(angles[least])
    if angle >= FLATTEST_DEG:
        return None
    at, output = degrees(driving_rad(drive.machine, float(crank[least]))), linkage.OUTPUT.name
    share = fixed(100.0 * sin(radians(angle)), 0)
    return Advice(
        Kind.TRANSMISSION_ANGLE,
        (Where(angles_deg=((at, at),)),),
        f"the transmission angle falls to {to_digits(angle, 3)} deg at phi1 = {to_digits(at, 4)} deg",
        f"only {share} % of the force on the {output} moves it there; the rest bears on what guides it, and friction "
        "may lock the linkage",
        (Remedy("take a shorter crank, or make the other links longer", short="take a shorter crank"),),
        brief=f"transmission angle down to {to_digits(angle, 3)} deg (at phi1 = {to_digits(at, 4)} deg): friction may "
        "lock",
    )
