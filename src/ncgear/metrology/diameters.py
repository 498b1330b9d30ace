"""Diameters of measuring pins and balls."""

from __future__ import annotations

from math import ceil

EXTERNAL, INTERNAL = 1.728, 1.68
"""Diameter in normal modules that touches flanks of 20 degrees near the pitch curve and stands out of the space
(Van Keuren's rule, values from secondary sources)."""

SOLD_MM = (
    *(0.17, 0.195, 0.22, 0.25, 0.29, 0.335, 0.39, 0.455, 0.53, 0.62, 0.725, 0.895, 1.1, 1.35, 1.5, 1.65, 1.75, 2.0),
    *(2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 5.0, 5.25, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0, 9.0, 10.0, 10.5),
    *(11.0, 12.0, 14.0, 15.0, 16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 30.0, 35.0, 40.0, 45.0, 50.0),
)
"""Diameters in mm that such pins are commonly sold in, after DIN 3977 and, below 1.5 mm, the wires of DIN 2269 (values
from secondary sources, not held against the standards)."""

NEAR = 1.3
"""Times the nominal diameter up to which larger pins are tried; beyond they touch near the tips."""


def nominal_pin_mm(normal_module_mm: float, *, internal: bool) -> float:
    """The diameter in mm that is aimed at."""
    return (INTERNAL if internal else EXTERNAL) * normal_module_mm


def pins_to_try(nominal_mm: float) -> tuple[float, ...]:
    """Sold diameters from the nominal one to ``NEAR`` times it, rising; whole mm where larger than any sold.

    Sizes stand so far apart below 1.5 mm that there may be none; then the next larger one.
    """
    if nominal_mm > SOLD_MM[-1]:
        return (float(ceil(nominal_mm)),)
    larger = [diameter for diameter in SOLD_MM if diameter >= nominal_mm]
    near = [diameter for diameter in larger if diameter <= NEAR * nominal_mm]
    return tuple(near or larger[:1])
