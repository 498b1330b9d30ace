"""The unit in which a quantity is read, by its size."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array

THOUSANDS = {"W": "kW", "N": "kN", "N m": "kN m", "mm/s": "m/s", "mm/s\u00b2": "m/s\u00b2"}
"""Units, and what a thousand of each is."""


def readable(unit: str, *values: Array | float) -> tuple[float, str]:
    """Factor from a unit to the one in which values (of any shapes, not empty) are read, and its name.

    It is a thousand of the unit where one of them reaches that, so that peaks from 1 to 9 999 999 of the unit read as 1
    to 9999.
    """
    largest = max(float(np.max(np.abs(value))) for value in values)
    return (1e-3, THOUSANDS[unit]) if unit in THOUSANDS and largest >= 1000.0 else (1.0, unit)
