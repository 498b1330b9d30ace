"""Steel teeth for the tests of load and stiffness, with compliances in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.material import EnduredStress, Material, MaterialFamily
from ncgear.strength.method import RootStress

Array = np.ndarray

STEEL = Material(
    "steel", MaterialFamily.STEEL, 206e3, 0.3, 7850.0, None, EnduredStress(np.array([1.0]), np.array([500.0])), "tests"
)


@dataclass(frozen=True, eq=False)
class Beams:
    """Teeth whose flanks give way by 1 / 28 000 mm per N/mm at the radius ``pitch_mm``, and more by ``slope`` a mm."""

    pitch_mm: float
    slope: float = 0.0
    name: str = "beams"

    def compliance(self, places: FlankPlaces, reach_mm: Array) -> Array:
        return (1.0 + self.slope * (np.abs(places.point) - self.pitch_mm)) / 28e3 + 0.0 * reach_mm

    def root_stress(self, places: FlankPlaces) -> RootStress:
        raise NotImplementedError
