"""The answer of all methods: stress, safety and life of every tooth."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.shown import Shown
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.material import Material

LoadBy = Literal["masses", "resistance", "jam"]
"""The cause of a load: the machine with its masses, the resistance alone, or a jam alone."""


@dataclass(frozen=True, eq=False)
class ContactStresses:
    """Stresses of n loaded contacts in MPa, all factors of load included.

    ``pressure_mpa`` (shape (n,)) is the pressure between the flanks, NaN at edges.  ``tension_mpa`` and
    ``compression_mpa`` (shape (2, n)) are the stresses at the roots of the driving and the driven tooth.
    ``face_load_factor`` (shape (n,)) is K_Hbeta, ``dynamic_factor`` K_V.
    """

    pressure_mpa: Array
    tension_mpa: Array
    compression_mpa: Array
    face_load_factor: Array
    dynamic_factor: Array

    def decisive_face_load(self, contacts: LoadedContacts) -> float:
        """K_Hbeta of the contact with the largest load for each mm of width; 1 without load."""
        load = self.face_load_factor * self.dynamic_factor * contacts.over_width_n
        return float(self.face_load_factor[load.argmax()]) if load.size else 1.0


@dataclass(frozen=True, eq=False)
class ToothLife:
    """Safety and life of the z teeth of a gear against one kind of damage; shape (z,) each, from tooth 1 on.

    ``stress_mpa`` is the largest stress of each tooth and ``phi1_rad`` its driving angle.  ``safety`` is the endured
    stress over the equivalent stress: with all stresses times this factor, the wanted life is just reached.  ``life_h``
    are the hours until failure by Miner's rule, infinite where the stress is endured for ever.  Teeth without load have
    a stress of 0 and an infinite safety.
    """

    stress_mpa: Array
    phi1_rad: Array
    safety: Array
    life_h: Array

    def __repr__(self) -> str:
        return f"ToothLife(least safety {self.safety_min:.3g} at tooth {self.weakest} of {self.safety.size})"

    @property
    def weakest(self) -> int:
        """Number of the tooth of least safety, from 1."""
        return int(np.argmin(self.safety)) + 1

    @property
    def safety_min(self) -> float:
        """Least safety of any tooth."""
        return float(self.safety.min())


@dataclass(frozen=True, eq=False)
class GearStrength:
    """One gear: its material, breakage of teeth, and pitting of flanks (None where the material has no figures)."""

    gear: Gear
    material: Material
    bending: ToothLife
    contact: ToothLife | None

    def __repr__(self) -> str:
        kinds = {"breakage": self.bending, "pitting": self.contact}
        told = [f"{kind} {life.safety_min:.3g} at tooth {life.weakest}" for kind, life in kinds.items() if life]
        return f"GearStrength({self.gear.value}, {self.material.name}: least safeties {', '.join(told)})"


@dataclass(frozen=True, eq=False)
class Strength(Shown):
    """Both gears by one method.

    ``load`` is the cause of the load.  ``end_rad`` is the driving angle at which the same teeth meet again, or the end
    of the range of gears that turn less than once.
    """

    method: Literal["estimate", "elements"]
    load: LoadBy
    contacts: LoadedContacts
    stresses: ContactStresses
    driving: GearStrength
    driven: GearStrength
    end_rad: float

    @property
    def peak_pair_n(self) -> float:
        """Largest normal force on a pair of teeth over its whole width; 0 without load."""
        return float(self.contacts.of_pairs().force_n.max(initial=0.0))

    @property
    def wears(self) -> bool:
        """Whether flanks wear; wear is not judged here."""
        return self.driving.material.wears or self.driven.material.wears

    def __repr__(self) -> str:
        return f"Strength({self.method}, load by {self.load},\n  {self.driving!r},\n  {self.driven!r})"

    def of(self, gear: Gear) -> GearStrength:
        """The driving or the driven gear."""
        return self.driving if gear is Gear.DRIVING else self.driven
