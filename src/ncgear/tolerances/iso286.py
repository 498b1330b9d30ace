"""Widths of tolerance of ISO 286-1:2010 for holes and distances, in mm (values from secondary sources).

A hole of the fit H7 is as large as its nominal size or larger, by the standard tolerance IT7 at most; a distance of JS7
is off by half of IT7 at most, either way.
"""

from __future__ import annotations

from bisect import bisect_left

UP_TO_MM = (
    *(3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 180.0, 250.0, 315.0, 400.0, 500.0),
    *(630.0, 800.0, 1000.0, 1250.0, 1600.0, 2000.0, 2500.0, 3150.0),
)
"""The upper ends of the ranges of nominal sizes."""

STANDARD_UM = {
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40, 44, 50, 56, 66, 78, 92, 110, 135),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63, 70, 80, 90, 105, 125, 150, 175, 210),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97, 110, 125, 140, 165, 195, 230, 280, 330),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155, 175, 200, 230, 260, 310, 370, 440, 540),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400, 440, 500, 560, 660, 780, 920, 1100, 1350),
}
"""The standard tolerances in micrometres by their grades, for each range of sizes."""

MM_PER_UM = 1e-3


LEAST_MM = 1.0
"""Size below which widths are smaller in proportion: the standard has hardly any fit there."""


def standard_tolerance_mm(grade: int, size_mm: float) -> float | None:
    """IT of a grade for a nominal size; None beyond the sizes of the standard."""
    place = bisect_left(UP_TO_MM, size_mm)
    if place == len(UP_TO_MM):
        return None
    return MM_PER_UM * STANDARD_UM[grade][place] * min(1.0, size_mm / LEAST_MM)


def distance_deviation_mm(size_mm: float) -> float | None:
    """The most that a distance of JS7 may be off, either way; None beyond the sizes of the standard."""
    width = standard_tolerance_mm(7, size_mm)
    return None if width is None else width / 2.0


def hole_text(fit: str, size_mm: float) -> str:
    """A fit with both its deviations: ``H7 (0 to +0.015)``; the fit alone beyond the sizes of the standard.

    >>> hole_text("H7", 10.0)
    'H7 (0 to +0.015)'
    """
    width = standard_tolerance_mm(int(fit.removeprefix("H")), size_mm)
    return fit if width is None else f"{fit} (0 to +{width:g})"
