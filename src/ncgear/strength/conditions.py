"""Running conditions of a pair of gears: size and speed, life, oil and surfaces, and the wanted safeties."""

from __future__ import annotations

from math import pi
from typing import Literal

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.strength.material import Material, MaterialFamily


@dataclass(frozen=True)
class Running:
    """Size and speed of a pair, as the factors of ISO 6336 need them.

    ``teeth`` are the numbers of teeth of the driving and the driven gear, ``speed_rad_s`` the mean speed of the driving
    gear.  ``overlap_ratio`` is the advance of helical teeth over the face width in pitches, 0 of straight teeth.  Gears
    that turn less than once have ``around``, the pitches of a whole turn of either gear at its mean radius, and
    ``stroke_rad``, the turn of the driving gear out and back; for other gears that is a whole turn.  The driving gear
    has ``mates`` alike, which its teeth meet one after the other.
    """

    module_mm: float
    teeth: tuple[int, int]
    face_width_mm: float
    speed_rad_s: float
    overlap_ratio: float = 0.0
    around: tuple[float, float] | None = None
    stroke_rad: float = 2.0 * pi
    mates: int = 1

    @property
    def whole(self) -> tuple[float, float]:
        """Pitches around the driving and the driven gear, as circular gears of the same mean radii have."""
        return self.around or self.teeth

    @property
    def pitch_speed_m_s(self) -> float:
        """Mean speed along the pitch curves in m/s."""
        return self.module_mm * self.whole[0] / 2.0 * self.speed_rad_s / 1000.0

    def meetings(self, life_h: float) -> Array:
        """Number of meetings of a flank of the driving and of the driven gear with a mate in ``life_h``, shape (2,)."""
        strokes = life_h * 3600.0 * self.speed_rad_s / self.stroke_rad
        return strokes * np.array([self.mates, 1.0 if self.around else self.teeth[0] / self.teeth[1]])


@dataclass(frozen=True)
class Overload:
    """A jam: the torque in N mm at the driving shaft of the machine, and the number of jams in the wanted life."""

    driving_n_mm: float
    times: float


@dataclass(frozen=True)
class Conditions:
    """The service conditions that a person gives.

    ``life_h`` is the wanted life.  ``dynamic_factor`` is None where it is estimated.  ``reliability`` is the share of
    gears that reach that life.  ``overload`` is None where no jam counts.  ``temperature_c`` is the temperature around
    plastics, ``duty_cycle`` the share of ten minutes in which the gears run, ``oil_temperature_c`` the temperature of
    the oil between metal flanks.  Roughnesses are mean peak-to-valley heights, Rz.  The viscosity at 100 degrees
    Celsius, the wear coefficient and the wanted safeties are None where they follow from the oil or the material.
    """

    life_h: float = 20_000.0
    application_factor: float = 1.0
    overload: Overload | None = None
    dynamic_factor: float | None = None
    reliability: float = 0.99
    lubrication: Literal["oil", "grease", "dry"] = "oil"
    oil_viscosity_mm2_s: float = 220.0
    oil_viscosity_100_mm2_s: float | None = None
    oil_fzg_stage: float = 12.0
    wear_coefficient_mm3_n_m: float | None = None
    flank_roughness_um: float = 6.0
    root_roughness_um: float = 16.0
    temperature_c: float = 20.0
    duty_cycle: float = 1.0
    oil_temperature_c: float = 40.0
    contact_safety: float | None = None
    bending_safety: float | None = None

    def wanted_contact_safety(self, material: Material) -> float:
        """The least safety wanted against pitting of a gear of this material."""
        if self.contact_safety is not None:
            return self.contact_safety
        return 1.4 if material.family is MaterialFamily.PLASTIC else 1.0

    def wanted_bending_safety(self, material: Material) -> float:
        """The least safety wanted against breakage of a gear of this material."""
        if self.bending_safety is not None:
            return self.bending_safety
        return 2.0 if material.family is MaterialFamily.PLASTIC else 1.4


def hours_of_strokes(strokes: float, stroke_rad: float, speed_rad_s: float) -> float:
    """Hours that a number of strokes takes; the driving gear turns by ``stroke_rad`` in one stroke, out and back."""
    return strokes * stroke_rad / speed_rad_s / 3600.0


GRADE = 8
"""Accuracy grade for factors where the design gives no grade: own choice, because usual hobbing keeps it."""

HEIGHT_MODULES = 2.25


def face_load_factor_of_roots(running: Running, face_load_factor: Array) -> Array:
    """The face load factors K_Fbeta for bending: K_Hbeta^N with N = 1 / (1 + h/b + (h/b)^2), b/h at least 3.

    h is the height of the teeth (ISO 6336-1, secondary source): at the roots, the load is spread along the width.
    """
    slender = min(HEIGHT_MODULES * running.module_mm / running.face_width_mm, 1.0 / 3.0)
    return np.asarray(face_load_factor ** (1.0 / (1.0 + slender + slender**2)))
