"""Handles of the numbers that shape a law: those of a formula, or one alone under its key as an eccentricity.

Each stands on the curve of the ratio where its number moves it most, and moves the number by as much as that takes.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

import numpy as np

from ncgear.design.laws.base import LawNumber
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.project.law import law_of
from ncgear.ratio.transmission import Transmission

MOST_NUMBERS = 4
"""Numbers of a law that have a handle: each takes one law more, some hundredths of a second."""

STEP = 0.01
"""Share of a number by which it is changed to see what that does."""

LEAST_EFFECT = 1e-6
"""Relative change of the ratio that counts as none, as that of a factor which the closing of the cycle takes back."""

PLACES = 180
APART = 18
"""Places of a cycle where the ratio is looked at, and how many of them two handles are apart."""


@dataclass(frozen=True)
class Grip:
    """A number, the driving angle in deg of its handle, and the number's change per change of the ratio there."""

    number: LawNumber
    angle_deg: float
    factor: float


def grips(drive: Drive) -> Iterator[Grip]:
    """The numbers of a drive's law that move its ratio."""
    angle = np.linspace(0.0, drive.transmission.lobes.driving_period_rad, PLACES, endpoint=False)
    ratio, free = _ratio(drive.transmission, angle), np.ones(PLACES, dtype=bool)
    for number in drive.design.motion.law_numbers[:MOST_NUMBERS]:
        step = STEP * (abs(number.value) or 1.0)
        try:
            change = _ratio(_with(drive, number, number.value + step), angle) - ratio
        except DesignError:
            continue
        most = int(np.argmax(np.where(free, np.abs(change), 0.0)))
        if not abs(change[most]) > LEAST_EFFECT * ratio[most]:
            continue
        free[np.arange(most - APART, most + APART + 1) % PLACES] = False
        yield Grip(number, degrees(angle[most]), step / float(change[most]))


def _with(drive: Drive, number: LawNumber, value: float) -> Transmission:
    """The law with another value of a number; raises DesignError where there is none."""
    motion = drive.design.motion
    changed = motion.model_copy(update={number.key: number.written(value)})
    return law_of(drive.design.model_copy(update={"motion": changed})).transmission


def _ratio(law: Transmission, angle: Array) -> Array:
    ratio: Array = 1.0 / law.driven_angle(angle, 1).derivative(1)
    return ratio
