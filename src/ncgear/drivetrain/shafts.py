"""Whether a shaft holds at the keyway of its gear: an estimate after DIN 743.

A fibre of the shaft's surface sees the bending moment turn against it, so its stress follows from the moment in the
frame of the machine and from the angle that the shaft has turned.  It is followed over all turns in which gears and
cycle come back to where they began, at fibres all around; its amplitude and its mean are those of the fibre that is
worst.  Torsion is the same at all fibres.

After DIN 743:2012, from secondary sources (e.g. B. Schlecht, "Maschinenelemente 1", Pearson 2007, chapter 10), with
stresses of the full section of diameter d, sigma_B the tensile and sigma_S the yield strength in MPa:

    sigma_W = 0.5 sigma_B for bending, tau_W = 0.3 sigma_B for torsion, both alternating
    K_1 = 1 - s lg(d / d_0) beyond d_0 (``Steel``), for the strength that a thick shaft lacks
    K_2 = 1 - 0.2 lg(d / 7.5 mm) / lg 20 from 7.5 to 150 mm, for bending and torsion of thick shafts
    beta_sigma = 3.0 (K_1 sigma_B / 1000)^0.38, beta_tau = 0.56 beta_sigma + 0.1 at a keyway for one key
    K_F = 1 - 0.22 lg(Rz / um) (lg(K_1 sigma_B / 20) - 1) for bending, 0.575 K_F + 0.425 for torsion
    K = beta / K_2 + 1 / K_F - 1,   sigma_WK = K_1 sigma_W / K

The mean stress lowers the amplitude that is endured, where it stays as it is while the amplitude grows, by psi times
the equivalent mean stress sqrt(sigma_m^2 + 3 tau_m^2), for torsion by psi times this over sqrt(3), where
psi = sigma_WK / (2 K_1 sigma_B - sigma_WK).  Safety against fatigue is 1 / sqrt((sigma_a/sigma_AK)^2 +
(tau_a/tau_AK)^2), and against yielding, with the largest stresses, 1 / sqrt((sigma/sigma_S')^2 + (tau/tau_S')^2) where
sigma_S' = K_1 sigma_S and tau_S' = sigma_S' / sqrt(3).

Left out, each on the safe side or small: the factors for supported yielding in notches (1.2 and 1.05 to 1.15) and for
hardened surfaces.  The factor of a keyway is taken as it is at 40 mm, without its own dependence on size (some per
cent).  Shoulders, grooves and press fits beside the keyway are not looked at: an estimate, in place of no proof.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log10, pi, sqrt

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray

FIBRES = 72
"""Fibres around the shaft: the worst one is missed by 2.5 degrees at most, which changes its stress by 0.1 %."""


@dataclass(frozen=True)
class Steel:
    """Strengths in MPa at the small diameters for which standards state them, and how they fall with the diameter.

    ``whole_to_mm`` is d_0, up to which both hold; ``fall`` is s.  Values by name in ``STEELS`` are those of DIN 743-3,
    from secondary sources.
    """

    tensile_mpa: float
    yield_mpa: float
    whole_to_mm: float = 16.0
    fall: float = 0.26

    def size_factor(self, diameter_mm: float) -> float:
        """K_1, for diameters up to 300 mm; beyond them as at 300 mm."""
        return 1.0 - self.fall * log10(max(min(diameter_mm, 300.0) / self.whole_to_mm, 1.0))


STEELS = {
    "S355": Steel(510.0, 355.0, 32.0),
    "E335": Steel(590.0, 335.0, 32.0),
    "C45": Steel(700.0, 490.0),
    "42CrMo4": Steel(1100.0, 900.0),
    "34CrNiMo6": Steel(1200.0, 1000.0),
}
"""Structural steels, whose yield strength falls from 32 mm on (their tensile strength less: taken alike), and steels
quenched and tempered, which fall from 16 mm on."""


@dataclass(frozen=True)
class Section:
    """A shaft where it has a keyway: diameter in mm, steel, and the roughness Rz of its surface in micrometres."""

    diameter_mm: float
    steel: Steel
    roughness_um: float


@dataclass(frozen=True)
class ShaftStresses:
    """Stresses of the full section in MPa.

    ``bending_amplitude_mpa`` and ``bending_mean_mpa`` are those of the fibre of least safety, and torsion's likewise.
    The largest stresses are the sizes of the largest bending moment and torque.
    """

    bending_amplitude_mpa: float
    bending_mean_mpa: float
    torsion_amplitude_mpa: float
    torsion_mean_mpa: float
    bending_largest_mpa: float
    torsion_largest_mpa: float


@dataclass(frozen=True)
class ShaftSafety:
    """Estimated safeties of a shaft at its keyway; infinite where it bears nothing."""

    section: Section
    stresses: ShaftStresses
    fatigue: float
    yielding: float


def shaft_safety(
    section: Section,
    moment_n_mm: ComplexArray,
    torque_n_mm: Array,
    turned_rad: Array,
    cycles_rad: Array,
) -> ShaftSafety:
    """The safety of a shaft whose moments, torques and angles (shape (n,)) are those of one cycle.

    Moments are x + i y in the frame of the machine.  ``cycles_rad`` (shape (k,)) are the angles that the shaft has
    turned at the beginning of the cycles after which it stands as at first, k of them.  Peaks are those of the n
    angles.
    """
    resistance_mm3 = pi * section.diameter_mm**3 / 32.0
    bending, torsion = moment_n_mm / resistance_mm3, torque_n_mm / (2.0 * resistance_mm3)
    fibres = np.exp(2j * pi * np.arange(FIBRES) / FIBRES)
    turned = np.exp(-1j * (turned_rad + cycles_rad[:, None])).ravel()
    seen = np.real(np.tile(bending, cycles_rad.size) * turned * fibres[:, None])
    high, low = seen.max(axis=1), seen.min(axis=1)
    amplitude, mean = (high - low) / 2.0, (high + low) / 2.0
    torsion_amplitude, torsion_mean = float(np.ptp(torsion)) / 2.0, float(torsion.max() + torsion.min()) / 2.0
    used = _fatigue_used(section, amplitude, mean, torsion_amplitude, torsion_mean)
    worst = int(np.argmax(used))
    largest = float(np.abs(bending).max()), float(np.abs(torsion).max())
    stresses = ShaftStresses(float(amplitude[worst]), float(mean[worst]), torsion_amplitude, torsion_mean, *largest)
    yields = section.steel.size_factor(section.diameter_mm) * section.steel.yield_mpa
    strained = sqrt(largest[0] ** 2 + 3.0 * largest[1] ** 2) / yields
    return ShaftSafety(section, stresses, _inverse(float(used[worst])), _inverse(strained))


def _inverse(used: float) -> float:
    return 1.0 / used if used else np.inf


def fatigue_strengths_mpa(section: Section) -> tuple[float, float]:
    """sigma_WK and tau_WK, the alternating stresses of bending and torsion that the keyway endures."""
    size, diameter = section.steel.size_factor(section.diameter_mm), section.diameter_mm
    tensile = size * section.steel.tensile_mpa
    thick = 1.0 - 0.2 * log10(min(max(diameter / 7.5, 1.0), 20.0)) / log10(20.0)
    bending_notch = 3.0 * (tensile / 1000.0) ** 0.38
    rough = 1.0 - 0.22 * log10(max(section.roughness_um, 1.0)) * (log10(tensile / 20.0) - 1.0)
    in_bending = bending_notch / thick + 1.0 / rough - 1.0
    in_torsion = (0.56 * bending_notch + 0.1) / thick + 1.0 / (0.575 * rough + 0.425) - 1.0
    return 0.5 * tensile / in_bending, 0.3 * tensile / in_torsion


def _fatigue_used(
    section: Section, amplitude: Array, mean: Array, torsion_amplitude: float, torsion_mean: float
) -> Array:
    """1/S of fibres, shape (n,); infinite where the mean stress alone is too much."""
    tensile = section.steel.size_factor(section.diameter_mm) * section.steel.tensile_mpa
    equivalent = np.sqrt(mean**2 + 3.0 * torsion_mean**2)
    used = np.zeros(amplitude.shape)
    strengths = fatigue_strengths_mpa(section)
    for strength, alternating, lasting in zip(
        strengths, (amplitude, torsion_amplitude), (equivalent, equivalent / sqrt(3.0)), strict=True
    ):
        endured = strength - strength / (2.0 * tensile - strength) * lasting
        used += np.where(endured > 0.0, alternating / np.where(endured > 0.0, endured, 1.0), np.inf) ** 2
    return np.asarray(np.sqrt(used))
