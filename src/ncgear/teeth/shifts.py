"""A profile shift for each tooth, and the places of flanks, tips and roots of both gears that follow.

Both gears are made by one imaginary rack between them, whose flanks cross its pitch line where the teeth's flanks cross
the pitch curves.  A driving tooth with the shift x has both flanks moved outwards by x: along the pitch line each moves
by x tan(alpha).  So the tooth is thicker on the pitch curve by x (tan(alpha) + tan(beta)), with the pressure angles
alpha and beta of its flanks, and its tip is higher by x.  The driven space that it meets is the same rack tooth: wider
and deeper by the same amounts, which is the shift -x.  A driving space lies between teeth of the shifts x and y.  The
rack's tooth in it keeps its form where its shift is the mean (x tan(beta) + y tan(alpha)) / (tan(alpha) + tan(beta)) of
both, each weighted with its own flank; the tooth also moves along the pitch line.  So a tooth of the same rack cutter
can cut every space of both gears, and all roots have the clearance of the rack.  With any shifts, flanks that meet
cross the pitch curves at equal arc lengths, and therefore keep the law.

A driven space that several driving teeth meet has the same shift for all of them.  Teeth of numbers z1 and z2 meet
every gcd(z1, z2)-th tooth of each other, so the shifts repeat after this number of teeth.

I. Zarebski and T. Salacinski, "Designing of non-circular gears", Archive of Mechanical Engineering 55 (2008) 275-292,
made such a gear, and another gear with unequal pressure angles.
"""

from __future__ import annotations

from math import gcd, pi, tan
from typing import NoReturn

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

LEAST_THICKNESS = 0.2
"""Share of half a pitch that shifts must leave of a tooth at the pitch curve, as play must (backlash.py)."""

KEY = "gears.profile_shift.per_tooth"


@dataclass(frozen=True, eq=False)
class ToothShifts:
    """The shifts of one gear's z teeth and spaces in mm, positive outwards.

    ``tooth_mm`` (shape (z,)) raises tips, ``space_mm`` (shape (z,)) raises the bottom of the space after each tooth,
    and ``outwards_mm`` (shape (2 z,)) is the additional distance of each flank from its tooth's middle along the pitch
    curve.
    """

    tooth_mm: Array
    space_mm: Array
    outwards_mm: Array

    @property
    def beside_flanks_mm(self) -> Array:
        """The shift of the space beside each flank, shape (2 z,): a back flank's space is before its tooth."""
        return np.roll(np.repeat(self.space_mm, 2), 1)


def thickness_mm(module_mm: float, shift_mm: Array, angles_rad: tuple[float, float]) -> Array:
    """Thickness in mm along the pitch curve of teeth with a profile shift, in the shape of ``shift_mm``.

    ``angles_rad`` are the pressure angles of both flanks.  It is pi m / 2 + x (tan(alpha) + tan(beta)); with equal
    angles and a pitch circle that is the usual pi m / 2 + 2 x tan(alpha).  Play is not counted.

    >>> [round(float(s), 3) for s in thickness_mm(4.71, 4.71 * np.array([-0.2, 0.0, 0.2]), (np.pi / 9, np.pi / 9))]
    [6.713, 7.398, 8.084]
    """
    one, other = angles_rad
    return pi * module_mm / 2.0 + shift_mm * (tan(one) + tan(other))


def tooth_shifts(
    shift_mm: Array, module_mm: float, angles_rad: tuple[float, float], teeth: tuple[int, int]
) -> tuple[ToothShifts, ToothShifts]:
    """The shifts of the driving and the driven gear, from the shifts of the driving teeth from tooth 1 on.

    ``angles_rad`` are the pressure angles of pushing and of idle flanks, ``teeth`` the numbers of both gears' teeth.
    Shifts of fewer teeth are repeated round the gear.  Raises WrongInput where their number does not divide the teeth,
    where teeth that meet the same spaces have different shifts, or where too little of a tooth remains.
    """
    driving, driven = teeth
    common = gcd(driving, driven)
    _refuse_unlike(shift_mm, driving, common, driven)
    own, facing = np.resize(shift_mm, driving), np.resize(np.resize(shift_mm, driving)[:common], driven)
    pushing, idle = map(tan, angles_rad)

    def between(shift: Array) -> Array:
        # A driving tooth's front flank is idle, the next tooth's back flank pushes.
        return (shift * idle + np.roll(shift, -1) * pushing) / (idle + pushing)

    # Driven tooth j stands in the driving space after tooth j: its back flank meets that tooth's front flank.
    after = np.roll(facing, -1)
    both = (
        ToothShifts(own, between(own), np.column_stack([own * pushing, own * idle]).ravel()),
        ToothShifts(-between(facing), -after, -np.column_stack([facing * idle, after * pushing]).ravel()),
    )
    for gear, shifts in zip(("driving", "driven"), both, strict=True):
        thinner = -shifts.outwards_mm.reshape(-1, 2).sum(axis=1)
        worst = int(np.argmax(thinner))
        if thinner[worst] > (1.0 - LEAST_THICKNESS) * pi * module_mm / 2.0:
            left = pi * module_mm / 2.0 - float(thinner[worst])
            raise WrongInput(
                f"the shifts leave {left:.4g} mm of tooth {worst + 1} of the {gear} gear at the pitch curve, less than "
                f"{LEAST_THICKNESS:.0%} of half a pitch; smaller shifts are right",
                key=KEY,
            )
    return both


def refuse_open() -> NoReturn:
    """Refuse shifts for gears that turn less than once, since their teeth are not counted round the gear."""
    raise WrongInput(
        "given, but gears that turn less than once have no shifts for each tooth; driving and driven are right", key=KEY
    )


def _refuse_unlike(shift_mm: Array, driving: int, common: int, driven: int) -> None:
    """Refuse shifts that do not go up in the driving teeth, and teeth that meet the same spaces and differ."""
    if driving % shift_mm.size:
        raise WrongInput(
            f"{shift_mm.size} shifts given, but the driving gear has {driving} teeth; {driving} are right, or a number "
            "that divides it, which are repeated",
            key=KEY,
        )
    every = np.resize(shift_mm, driving)
    unlike = np.flatnonzero(every != every[np.arange(driving) % common])
    if unlike.size:
        tooth = int(unlike[0])
        raise WrongInput(
            f"teeth {tooth % common + 1} and {tooth + 1} of the driving gear have different shifts, but meet the same "
            f"spaces of the driven gear ({driving} and {driven} teeth); shifts that repeat after {common} teeth are "
            "right",
            key=KEY,
        )
