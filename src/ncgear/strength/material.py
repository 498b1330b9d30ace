"""A material: elastic constants, and the stresses that it endures for a number of load cycles."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array


class MaterialFamily(StrEnum):
    """Kinds of material, whose strength follows different rules."""

    STEEL = "steel"
    CAST_IRON = "cast iron"
    BRONZE = "bronze"
    PLASTIC = "plastic"


@dataclass(frozen=True, eq=False)
class EnduredStress:
    """The stress in MPa that a material endures for a number of load cycles, its stress-number curve.

    ``cycles`` (rising) and ``stress_mpa`` (not rising), shape (k,) each, are joined by straight lines in logarithms.
    Below the first number of cycles the first stress holds, beyond the last the last.
    """

    cycles: Array
    stress_mpa: Array

    def at(self, cycles: Array) -> Array:
        """The stress in MPa endured for numbers of cycles above 0, any shape."""
        log = np.interp(np.log(cycles), np.log(self.cycles), np.log(self.stress_mpa))
        return np.asarray(np.exp(log))

    def cycles_to_failure(self, stress_mpa: Array) -> Array:
        """The number of cycles for which stresses of 0 MPa or more are endured, any shape.

        It is 0 above the first stress, and infinite up to the last one.
        """
        falling = np.log(self.stress_mpa[::-1]), np.log(self.cycles[::-1])
        log = np.interp(np.log(np.maximum(stress_mpa, self.stress_mpa[-1])), *falling)
        number = np.where(stress_mpa <= self.stress_mpa[-1], np.inf, np.exp(log))
        return np.asarray(np.where(stress_mpa > self.stress_mpa[0], 0.0, number))


@dataclass(frozen=True, eq=False)
class Material:
    """A material of one gear at the temperature it runs at.

    ``contact`` and ``bending`` are the stresses in MPa that flanks and roots endure, for the wanted reliability and
    with all the method's factors of the material and its surface; ``contact`` is None where no figures are known.
    ``source`` names the source of the figures.  ``too_hot_c`` is the temperature in degrees Celsius of teeth that run
    hotter than the figures reach, and then endure next to nothing; None for all other teeth.
    """

    name: str
    family: MaterialFamily
    youngs_modulus_mpa: float
    poisson: float
    density_kg_m3: float
    contact: EnduredStress | None
    bending: EnduredStress
    source: str
    too_hot_c: float | None = None

    @property
    def wears(self) -> bool:
        """Whether flanks wear as dry metal on metal: the endured stress of flanks is known for all other metals."""
        return self.contact is None and self.family is not MaterialFamily.PLASTIC
