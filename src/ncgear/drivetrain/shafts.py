"""Safety of a shaft at the keyway of its gear, an estimate after DIN 743, and of the key (DIN 6892).

A fibre of the shaft's surface sees the bending moment turn against it, so its stress follows from the moment in the
frame of the machine and from the angle that the shaft has turned.  It is followed over all turns in which gears and
cycle come back to where they began.  The worst fibre is searched around the shaft, and its largest and least stress
over the cycle.  Torsion is the same at all fibres.

After DIN 743:2012, from secondary sources (B. Schlecht, "Maschinenelemente 1", Pearson 2007, chapter 10; the public
repository hanslhansl/din743), with stresses of the full section of diameter d, sigma_B the tensile and sigma_S the
yield strength in MPa:

    sigma_W = 0.5 sigma_B for bending, tau_W = 0.3 sigma_B for torsion, both alternating
    K_1 = 1 - s lg(d / d_0) beyond d_0, for the lower strength of a thick blank; each strength has its own (``Steel``)
    K_2 = 1 - 0.2 lg(d / 7.5 mm) / lg 20 from 7.5 to 150 mm, for bending and torsion of thick shafts
    beta_40 = 3.0 (K_1 sigma_B / 1000)^0.38 for bending, 0.56 of that and 0.1 more for torsion: a keyway at 40 mm
    K_3 = 1 - 0.2 lg(beta_40) lg(d / 7.5 mm) / lg 20,   beta = beta_40 K_3(40 mm) / K_3(d)
    sigma_WK = K_1 sigma_W K_2 / beta

The roughness is in the factor of a keyway already.  Amplitude and mean stress are taken to grow together; the mean then
lowers the endured amplitude to sigma_WK / (1 + psi sigma_mv / sigma_a), with the equivalent mean stress sigma_mv =
sqrt(sigma_m^2 + 3 tau_m^2), over sqrt(3) for torsion, and psi = sigma_WK / (2 K_1 sigma_B - sigma_WK). Safety against
fatigue is 1 / sqrt((sigma_a / sigma_AK)^2 + (tau_a / tau_AK)^2), and against yielding, with the largest stresses, K_1
sigma_S / sqrt(sigma^2 + 3 tau^2).

Left out, on the safe side: the factors for supported yielding (up to 1.2) and for hardened surfaces.  Shoulders,
grooves and press fits beside the keyway are not checked: this is an estimate.

The key is judged by the pressure on its sides after DIN 6892:2012, method C:

    p = 2 T / (d h l),   p_allowed = 0.9 R_e

with the largest torque T, the diameter d of the shaft, the height h over which key and hub touch, and the length l of
the key's straight sides; R_e is the least yield strength of shaft, key and hub (secondary source: B. Schlecht,
"Maschinenelemente 1", Pearson 2007).  Method C takes the pressure as even along the key and leaves out the torque that
the fit passes on.  It is for torques of one sense: where the torque changes its sense under load the key works in its
way, and the standard's method B, or a fit without play, is needed.  A torque of the other sense up to a hundredth of
the largest is no such load (SWELLING); the key bears both together here, T = T_max - T_min, on the safe side.
"""

from __future__ import annotations

from math import hypot, inf, log10, pi, sqrt

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.highest import largest_of_each

LEAST_SAFETY = 1.2
"""Least safety that DIN 743 demands, since its figures scatter."""

FIBRES = 72
"""Fibres around the shaft where the search for the worst fibre begins."""

KNOWN = 1e-6
"""Share of the largest bending moment to which a fibre's largest and least moment are known at least."""


@dataclass(frozen=True)
class Fall:
    """Fall of a strength with the diameter of the blank: d_0 in mm, the largest diameter of full strength, and s."""

    whole_to_mm: float
    per_decade: float

    def factor(self, blank_mm: float) -> float:
        """K_1, for diameters up to 300 mm; beyond them as at 300 mm."""
        return 1.0 - self.per_decade * log10(max(min(blank_mm, 300.0) / self.whole_to_mm, 1.0))


LASTING = Fall(1.0, 0.0)
"""No fall, for strengths that are known at the shaft's own diameter."""


@dataclass(frozen=True)
class Steel:
    """Strengths in MPa at the small diameters for which standards state them, and their falls."""

    tensile_mpa: float
    yield_mpa: float
    tensile_fall: Fall = LASTING
    yield_fall: Fall = LASTING


STRUCTURAL = Fall(100.0, 0.23), Fall(32.0, 0.26)
TEMPERED = Fall(16.0, 0.26), Fall(16.0, 0.34)

STEELS = {
    "S355": Steel(510.0, 355.0, *STRUCTURAL),
    "E335": Steel(590.0, 335.0, *STRUCTURAL),
    "C45": Steel(700.0, 490.0, *TEMPERED),
    "42CrMo4": Steel(1100.0, 900.0, *TEMPERED),
    "34CrNiMo6": Steel(1200.0, 1000.0, *TEMPERED),
}
"""Structural steels, and steels quenched and tempered; values of DIN 743-3, from secondary sources."""


@dataclass(frozen=True)
class ShaftSection:
    """A shaft at its keyway: its diameter in mm, its blank's diameter when it was treated in mm, and its steel."""

    diameter_mm: float
    blank_mm: float
    steel: Steel

    @property
    def tensile_mpa(self) -> float:
        """Tensile strength of the shaft."""
        return self.steel.tensile_mpa * self.steel.tensile_fall.factor(self.blank_mm)

    @property
    def yield_mpa(self) -> float:
        """Yield strength of the shaft."""
        return self.steel.yield_mpa * self.steel.yield_fall.factor(self.blank_mm)


@dataclass(frozen=True)
class ShaftStresses:
    """Stresses of the full section in MPa.

    ``bending_amplitude_mpa`` and ``bending_mean_mpa`` are the stresses of the fibre of least safety; torsion is the
    same at all fibres.
    """

    bending_amplitude_mpa: float
    bending_mean_mpa: float
    torsion_amplitude_mpa: float
    torsion_mean_mpa: float


@dataclass(frozen=True)
class ShaftSafety:
    """Estimated safeties of a shaft at its keyway; infinite where it bears nothing."""

    section: ShaftSection
    stresses: ShaftStresses
    fatigue: float
    yielding: float


@dataclass(frozen=True, eq=False)
class BentShaft:
    """The moments that a shaft bears beside a gear, whatever its diameter, in N mm.

    ``hull_n_mm`` (shape (c,)) has the bending moments in the frame of the shaft, as x + i y: the corners of their
    convex hull.  ``bending_n_mm`` is the largest bending moment, ``torque_n_mm`` the least and the largest torque.
    """

    hull_n_mm: ComplexArray
    bending_n_mm: float
    torque_n_mm: tuple[float, float]

    def alternating(self, fibre_rad: Array) -> tuple[Array, Array]:
        """Amplitude and mean of the moment that fibres at angles around the shaft see, shape (f,) each."""
        along = np.real(self.hull_n_mm * np.exp(1j * fibre_rad)[:, None])
        high, low = along.max(axis=1), along.min(axis=1)
        return (high - low) / 2.0, (high + low) / 2.0


def shaft_safety(section: ShaftSection, shaft: BentShaft) -> ShaftSafety:
    """The safety of a shaft of one section."""
    resistance_mm3 = pi * section.diameter_mm**3 / 32.0
    least, most = (torque / (2.0 * resistance_mm3) for torque in shaft.torque_n_mm)
    torsion_amplitude, torsion_mean = (most - least) / 2.0, (most + least) / 2.0

    def used(fibre_rad: Array) -> Array:
        amplitude, mean = (part / resistance_mm3 for part in shaft.alternating(fibre_rad))
        return _fatigue_used(section, amplitude, mean, torsion_amplitude, torsion_mean)[None]

    (worst,) = largest_of_each(used, np.linspace(0.0, 2.0 * pi, FIBRES + 1))
    amplitude, mean = (float(part[0]) / resistance_mm3 for part in shaft.alternating(np.array([worst.at])))
    stresses = ShaftStresses(amplitude, mean, torsion_amplitude, torsion_mean)
    strained = hypot(shaft.bending_n_mm / resistance_mm3, sqrt(3.0) * max(most, -least)) / section.yield_mpa
    return ShaftSafety(section, stresses, _inverse(worst.value), _inverse(strained))


def _inverse(used: float) -> float:
    return 1.0 / used if used else np.inf


NOTCH_MM = 40.0
"""Diameter for which the factor of a keyway is known."""


def fatigue_strengths_mpa(section: ShaftSection) -> tuple[float, float]:
    """sigma_WK and tau_WK, the alternating stresses of bending and torsion that the keyway endures."""
    tensile, thick = section.tensile_mpa, _thickness(section.diameter_mm)
    in_bending = 3.0 * (tensile / 1000.0) ** 0.38
    bending, torsion = (
        share * tensile * (1.0 - 0.2 * thick) / _notch(at_40_mm, thick)
        for share, at_40_mm in ((0.5, in_bending), (0.3, 0.56 * in_bending + 0.1))
    )
    return bending, torsion


def _thickness(diameter_mm: float) -> float:
    """lg(d / 7.5 mm) / lg 20 within its range, 0 to 1."""
    return log10(min(max(diameter_mm / 7.5, 1.0), 20.0)) / log10(20.0)


def _notch(at_40_mm: float, thick: float) -> float:
    """beta from its value at 40 mm."""
    fall = 0.2 * log10(at_40_mm)
    return at_40_mm * (1.0 - fall * _thickness(NOTCH_MM)) / (1.0 - fall * thick)


def _fatigue_used(
    section: ShaftSection, amplitude: Array, mean: Array, torsion_amplitude: float, torsion_mean: float
) -> Array:
    """1/S of fibres, shape (n,)."""
    equivalent = np.sqrt(mean**2 + 3.0 * torsion_mean**2)
    bending, torsion = fatigue_strengths_mpa(section)
    used = [
        # sigma_a / sigma_AK, without dividing by an amplitude of 0, where the standard takes the term as 0
        np.where(alternating > 0.0, alternating + strength / (2.0 * section.tensile_mpa - strength) * lasting, 0.0)
        / strength
        for strength, alternating, lasting in (
            (bending, amplitude, equivalent),
            (torsion, np.full(amplitude.shape, torsion_amplitude), equivalent / sqrt(3.0)),
        )
    ]
    return np.hypot(*used)


ALLOWED_OF_YIELD = 0.9
"""Share of the yield strength that method C allows for ductile parts."""

FREE_HEIGHT_MM = 0.4
"""Depth of a hub's keyway beyond the contact of key and hub: DIN 6885-1 gives 0.3 to 0.4 mm (secondary source)."""


@dataclass(frozen=True)
class ShaftKey:
    """A key in its way: diameter of the shaft, carrying height and length in mm, least yield strength in MPa.

    ``longest_mm`` is the length of the gear with its hub.
    """

    diameter_mm: float
    height_mm: float
    length_mm: float
    yield_mpa: float
    longest_mm: float


SWELLING = 0.01
"""Share of the largest torque up to which a torque of the other sense counts as swelling: about what a good pair of
gears loses by friction (0.5 to 1.5 %), and less than loads and masses are known to."""


@dataclass(frozen=True)
class KeySafety:
    """Largest pressure on the key's sides in MPa and its safety; method C does not hold in ``both_senses``."""

    key: ShaftKey
    pressure_mpa: float
    safety: float
    both_senses: bool


def key_safety(key: ShaftKey, most_n_mm: float, least_n_mm: float) -> KeySafety:
    """The safety under torques that range from the least to the most; infinite where both are 0."""
    largest, against = max(most_n_mm, -least_n_mm), max(min(most_n_mm, -least_n_mm), 0.0)
    swells = against <= SWELLING * largest
    pressure = 2.0 * (largest + swells * against) / (key.diameter_mm * key.height_mm * key.length_mm)
    safety = ALLOWED_OF_YIELD * key.yield_mpa / pressure if pressure else inf
    return KeySafety(key, pressure, safety, not swells)
