"""Helical teeth as straight teeth in sections of the face width, which share the load.

The teeth of a section are straight teeth of their own form.  Each pair in it is a spring parallel to the pairs in all
other sections, since the driven gear turns as one body.

- **Sharing**.  All sections are conjugate at the same angles.  The lines of contact follow from that, and with them
Z_epsilon and f_epsilon of ISO 6336. - **Pressure**.  Pairs touch along straight lines in the plane of action, which
lean by the base helix angle beta_b,
  tan(beta_b) = tan(beta) cos(alpha).  For each mm of a line the normal force is the section's for each mm of width, and
  the curvature across the line is cos(beta_b) times the curvature in the section across the axis.
- **Roots** bend in the section across the tooth, where it is more slender by cos(beta) (``ncgear.strength.estimate``).

Neighbouring sections do not support each other, for which ISO 6336-3 has Y_beta.  On circular gears of 10 to 30 degrees
pressures are 0.99 to 1.06 of ISO 6336-2's, root stresses 0.93 to 1.17 of ISO 6336-3:2019's and 0.82 to 1.24 of those of
2006 (tests/test_helical_strength.py).
"""

from __future__ import annotations

from math import atan, ceil, cos, tan

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.method import RootStress, ToothMethod
from ncgear.teeth.gear import ToothedPair

PER_PITCH = 12
"""Sections for each pitch that teeth advance."""

FEWEST = 3
"""Sections of teeth that hardly advance."""


@dataclass(frozen=True, eq=False)
class FaceSection:
    """The teeth of one section, and its share of the face width."""

    teeth: ToothedPair
    share: float = 1.0


@dataclass(frozen=True, eq=False)
class FaceSections:
    """The sections of a pair: one of straight teeth, whose helix angle is 0."""

    each: tuple[FaceSection, ...]
    helix_rad: float = 0.0

    @classmethod
    def straight(cls, teeth: ToothedPair) -> FaceSections:
        """The single section of straight teeth."""
        return cls((FaceSection(teeth),))

    def across_lines(self, pressure_angle_rad: float) -> float:
        """Curvature across lines of contact over the curvature across the axis: the cosine of the base helix angle."""
        return cos(atan(tan(self.helix_rad) * cos(pressure_angle_rad)))


def count_of(advance_mm: float, pitch_mm: float) -> int:
    """Number of sections of equal width for teeth with this advance."""
    return max(FEWEST, ceil(PER_PITCH * advance_mm / pitch_mm))


@dataclass(frozen=True, eq=False)
class InSections:
    """The teeth of one gear with a method for each section, for places with known sections.

    ``rim_factor`` is Y_B of each tooth, shape (z,): the factor of a thin wall under it on the stress at its root.
    """

    each: tuple[ToothMethod, ...]
    rim_factor: Array | None = None

    @property
    def name(self) -> str:
        """The method's word."""
        return self.each[0].name

    def root_stress(self, places: FlankPlaces) -> RootStress:
        """The stresses at the root."""
        assert places.section is not None
        tension, compression = np.empty((2, places.flank.size))
        for number, method in enumerate(self.each):
            rows = np.flatnonzero(places.section == number)
            stress = method.root_stress(places.kept(rows))
            tension[rows], compression[rows] = stress.tension_mpa, stress.compression_mpa
        over = 1.0 if self.rim_factor is None else self.rim_factor[places.flank // 2]
        return RootStress(over * tension, over * compression)
