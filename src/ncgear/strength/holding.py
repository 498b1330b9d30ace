"""Whether a pair holds: the weakest tooth of each gear for each kind of damage, and what size of teeth would do.

Sizes follow from how stresses scale while the load at the crank stays the same.  With the number of teeth the normal
force goes as 1/m, m being the module; the root stress as F/(b m), b being the face width, and the pressure between
flanks as the root of F/(b rho), rho being the radius of relative curvature, which goes as m.  So the safety against
breakage goes as b m^2, that against pitting as m sqrt(b).  Forces of the gears' own masses, load factors that depend
on the size, and sharing of loads between pairs are left out: what comes out is a guess to be computed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum

import numpy as np

from ncgear.frozen import dataclass
from ncgear.pitch.shape import Gear
from ncgear.strength.answer import Strength, ToothLife

NOTHING_MPA = 1e-9
"""Force over face width and module under which teeth of any size bear nothing but rounding errors: no material endures
less than a thousand million times as much."""


class Damage(StrEnum):
    """Kinds of damage to a tooth."""

    BENDING = "bending"
    CONTACT = "contact"

    @property
    def words(self) -> str:
        """What happens to the tooth."""
        return "breakage" if self is Damage.BENDING else "pitting"


@dataclass(frozen=True)
class WantedSafety:
    """The least safeties of a gear that a person wants against breakage and pitting."""

    bending: float
    contact: float

    def of(self, damage: Damage) -> float:
        """The one against a kind of damage."""
        return self.bending if damage is Damage.BENDING else self.contact


@dataclass(frozen=True)
class Weakest:
    """The weakest tooth of a gear for one kind of damage, and all teeth under the wanted safety.

    ``tooth`` counts from 1.  ``stress_mpa`` is the tooth's largest stress, at the driving angle ``phi1_rad``;
    ``endured_mpa`` is what that stress might be for the life asked for, all other stresses growing alike.  ``life_h``
    is infinite where the stress is endured for ever.  ``too_weak`` numbers the teeth under the safety ``wanted``, the
    weakest first.
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
        """Whether the safety is the wanted one or more."""
        return self.safety >= self.wanted

    @property
    def endured_mpa(self) -> float:
        """The largest stress that this tooth endures in its own spectrum of loads."""
        return self.stress_mpa * self.safety

    @property
    def share(self) -> float:
        """The safety as a share of the wanted one; under 1 the tooth does not hold."""
        return self.safety / self.wanted


def lives_of(strength: Strength, gear: Gear) -> dict[Damage, ToothLife]:
    """What each kind of damage leaves to a gear's teeth; kinds without figures of the material are not there."""
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


def _weakest(life: ToothLife, gear: Gear, damage: Damage, wanted: float) -> Weakest:
    row, order = life.weakest - 1, np.argsort(life.safety, kind="stable")
    too_weak = tuple(int(place) + 1 for place in order[life.safety[order] < wanted])
    stress, angle = float(life.stress_mpa[row]), float(life.phi1_rad[row])
    safety, hours = float(life.safety[row]), float(life.life_h[row])
    return Weakest(gear, damage, life.weakest, stress, angle, safety, hours, wanted, too_weak)


def worst(found: Sequence[Weakest]) -> Weakest:
    """The one whose safety is the least share of the wanted one."""
    return min(found, key=lambda one: one.share)


def face_width_factor(found: Sequence[Weakest]) -> float:
    """The factor of the face width with which all would just be safe enough; under 1 where less would do."""
    factor: float = max(float(1.0 / one.share) ** (1.0 if one.damage is Damage.BENDING else 2.0) for one in found)
    return factor


def module_factor(found: Sequence[Weakest]) -> float:
    """The factor of the module, with as many teeth of the same width, with which all would just be safe enough."""
    factor: float = max(float(1.0 / one.share) ** (0.5 if one.damage is Damage.BENDING else 1.0) for one in found)
    return factor
