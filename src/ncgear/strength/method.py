"""The contract of a method of strength for the teeth of one gear: their compliance, and the stress of their roots."""

from __future__ import annotations

from typing import Protocol

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.strength.contacts import FlankPlaces


@dataclass(frozen=True, eq=False)
class RootStress:
    """Largest root stresses of n loaded places in MPa for a load of 1 N per mm of face width; shape (n,) each.

    ``tension_mpa`` is that at the root of the loaded flank, ``compression_mpa`` the size of that at the root of the
    other flank.  Local stresses: notches are counted.
    """

    tension_mpa: Array
    compression_mpa: Array


class ToothMethod(Protocol):
    """The teeth of one gear, by one method."""

    @property
    def name(self) -> str:
        """The method's word: estimate or elements."""

    def compliance(self, places: FlankPlaces, reach_mm: Array) -> Array:
        """Way by which flanks yield along the load at n places, in mm for 1 N per mm of face width, shape (n,).

        Bending, shear, the tooth's foundation, and the indentation between the contact and the tooth's middle count;
        ``reach_mm`` (shape (n,)) is the half-width of the contact for Hertz's part.
        """

    def root_stress(self, places: FlankPlaces) -> RootStress:
        """The stresses at the root."""
