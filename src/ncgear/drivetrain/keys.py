"""Whether the key of a gear holds: the pressure on its sides after DIN 6892:2012, method C.

    p = 2 T / (d h l),   p_allowed = 0.9 R_e

with the largest torque T, the diameter d of the shaft, the height h over which key and hub touch, and the length l of
the key's straight sides; R_e is the least yield strength of shaft, key and hub (secondary source: B. Schlecht,
"Maschinenelemente 1", Pearson 2007).  Method C takes the pressure as even along the key and leaves out the torque that
the fit passes on.  It is for torques of one sense: where the torque changes its sense under load the key works in its
way, and the standard's method B, or a fit without play, is needed.
"""

from __future__ import annotations

from math import inf

from ncgear.frozen import dataclass

ALLOWED_OF_YIELD = 0.9
"""Share of the yield strength that method C allows for ductile parts."""

FREE_HEIGHT_MM = 0.4
"""What a hub's keyway is deeper than key and hub touch: DIN 6885-1 gives 0.3 to 0.4 mm (secondary source)."""


@dataclass(frozen=True)
class Key:
    """A key in its way: diameter of the shaft, carrying height and length in mm, least yield strength in MPa."""

    diameter_mm: float
    height_mm: float
    length_mm: float
    yield_mpa: float


@dataclass(frozen=True)
class KeySafety:
    """Largest pressure on the key's sides in MPa, and the safety against what is allowed.

    ``both_senses`` tells that the torque changes its sense, for which method C does not hold.
    """

    key: Key
    pressure_mpa: float
    safety: float
    both_senses: bool


def key_safety(key: Key, most_n_mm: float, least_n_mm: float) -> KeySafety:
    """The safety under torques that range from the least to the most; infinite where both are 0."""
    largest = max(abs(most_n_mm), abs(least_n_mm))
    pressure = 2.0 * largest / (key.diameter_mm * key.height_mm * key.length_mm)
    safety = ALLOWED_OF_YIELD * key.yield_mpa / pressure if pressure else inf
    return KeySafety(key, pressure, safety, most_n_mm > 0.0 > least_n_mm)
