"""Two flanks pressed together: the pressure between them and the width of contact.

Hertz's closed form for cylinders with parallel axes in plane strain (K. L. Johnson, "Contact Mechanics", Cambridge
1985, section 4.2).  It holds where the width of contact is small beside the radii of curvature and beside the tooth.
"""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.strength.material import Material


def contact_modulus_mpa(materials: tuple[Material, Material]) -> float:
    """E* of both bodies: 1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2."""
    return 1.0 / sum((1.0 - material.poisson**2) / material.youngs_modulus_mpa for material in materials)


def hertz_pressure_mpa(
    force_n_per_mm: Array, relative_curvature_per_mm: Array, materials: tuple[Material, Material]
) -> Array:
    """The largest pressure p = sqrt(w k E* / pi); shapes broadcast.

    ``force_n_per_mm`` is the normal force w for each mm of face width, 0 or more, ``relative_curvature_per_mm`` the sum
    k of both curvatures, above 0.  At an edge, k and so the pressure are infinite.
    """
    squared = force_n_per_mm * relative_curvature_per_mm * contact_modulus_mpa(materials) / np.pi
    return np.asarray(np.sqrt(squared))


def half_width_mm(
    force_n_per_mm: Array, relative_curvature_per_mm: Array, materials: tuple[Material, Material]
) -> Array:
    """Half the width of the contact, sqrt(4 w / (pi k E*)), for the arguments of ``hertz_pressure_mpa``."""
    squared = 4.0 * force_n_per_mm / (np.pi * relative_curvature_per_mm * contact_modulus_mpa(materials))
    return np.asarray(np.sqrt(squared))
