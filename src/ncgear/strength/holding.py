"""Whether a pair holds: the weakest tooth of each gear for each kind of damage, and the size of teeth that would hold.

Sizes follow from the scaling of stresses with the load at the crank and the number of teeth constant.  Then the normal
force F goes as 1/m, m being the module; the root stress as F/(b m), b being the face width; and the pressure between
flanks as the root of F/(b rho), rho being the radius of relative curvature, which goes as m.  So the safety against
breakage goes as b m^2, the safety against pitting as m sqrt(b).  Forces of the gears' own masses, load factors that
depend on the size, and sharing of loads between pairs are left out: the result is a guess that must be checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum

import numpy as np

from ncgear.frozen import dataclass
from ncgear.pitch.shape import Gear
from ncgear.strength.answer import Strength, ToothLife
from ncgear.strength.conditions import Conditions

NOTHING_MPA = 1e-9
"""Force over face width and module that counts as rounding, and so as no load: every material endures a thousand
million times as much, or more."""


class Damage(StrEnum):
    """Kinds of damage to a tooth."""

    BENDING = "bending"
    CONTACT = "contact"

    @property
    def words(self) -> str:
        """The name of the damage."""
        return "breakage" if self is Damage.BENDING else "pitting"


@dataclass(frozen=True)
class WantedSafety:
    """The least safeties of a gear that a person wants against breakage and pitting."""

    bending: float
    contact: float

    def of(self, damage: Damage) -> float:
        """The safety against a kind of damage."""
        return self.bending if damage is Damage.BENDING else self.contact


@dataclass(frozen=True)
class Weakest:
    """The weakest tooth of a gear for one kind of damage, and all teeth under the wanted safety.

    ``tooth`` counts from 1.  ``stress_mpa`` is the tooth's largest stress, at the driving angle ``phi1_rad``;
    ``endured_mpa`` is the value of that stress, with all stresses scaled alike, that just gives the wanted life.
    ``life_h`` is infinite where the stress is endured for ever.  ``too_weak`` numbers the teeth under the safety
    ``wanted``, the weakest first.
    """

    gear: Gear
    damage: Damage
    tooth: int
    stress_mpa: float
    phi1_rad: float
    safety: float
    life_h: float
    wanted: float
    too_weak: tuple[int, ...]

    @property
    def holds(self) -> bool:
        """Whether the safety is at least the wanted safety."""
        return self.safety >= self.wanted

    @property
    def endured_mpa(self) -> float:
        """The largest stress that this tooth endures in its own spectrum of loads."""
        return self.stress_mpa * self.safety

    @property
    def share(self) -> float:
        """The safety over the wanted safety; under 1 the tooth does not hold."""
        return self.safety / self.wanted


def lives_of(strength: Strength, gear: Gear) -> dict[Damage, ToothLife]:
    """Safety and life of a gear's teeth by kind of damage, without kinds for which the material has no figures."""
    found = strength.of(gear)
    lives = {Damage.BENDING: found.bending}
    return lives if found.contact is None else {**lives, Damage.CONTACT: found.contact}


def weakest_teeth(strength: Strength, wanted: Mapping[Gear, WantedSafety]) -> list[Weakest]:
    """The weakest tooth of both gears for each kind of damage that has figures: driving gear, then driven gear."""
    return [
        _weakest(life, gear, damage, wanted[gear].of(damage))
        for gear in Gear
        for damage, life in lives_of(strength, gear).items()
    ]


def weakest_under(strength: Strength, conditions: Conditions) -> list[Weakest]:
    """The same under conditions: the wanted safeties that they give, or else the usual ones of each gear's material."""
    usual = conditions.wanted_bending_safety, conditions.wanted_contact_safety
    return weakest_teeth(
        strength, {gear: WantedSafety(*(of(strength.of(gear).material) for of in usual)) for gear in Gear}
    )


def _weakest(life: ToothLife, gear: Gear, damage: Damage, wanted: float) -> Weakest:
    row, order = life.weakest - 1, np.argsort(life.safety, kind="stable")
    too_weak = tuple(int(place) + 1 for place in order[life.safety[order] < wanted])
    stress, angle = float(life.stress_mpa[row]), float(life.phi1_rad[row])
    safety, hours = float(life.safety[row]), float(life.life_h[row])
    return Weakest(gear, damage, life.weakest, stress, angle, safety, hours, wanted, too_weak)


def worst(found: Sequence[Weakest]) -> Weakest:
    """The tooth with the least safety over its wanted safety."""
    return min(found, key=lambda weakest: weakest.share)


def face_width_factor(found: Sequence[Weakest]) -> float:
    """The factor on the face width with which all teeth would just be safe enough; under 1 where less suffices."""
    factor: float = max(
        float(1.0 / weakest.share) ** (1.0 if weakest.damage is Damage.BENDING else 2.0) for weakest in found
    )
    return factor


def module_factor(found: Sequence[Weakest]) -> float:
    """The factor on the module, for the same number and width of teeth, with which all would just be safe enough."""
    factor: float = max(
        float(1.0 / weakest.share) ** (0.5 if weakest.damage is Damage.BENDING else 1.0) for weakest in found
    )
    return factor
