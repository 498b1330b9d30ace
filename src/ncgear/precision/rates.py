"""Rates of convergence that were found, beside the theory's."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.precision.measure import order
from ncgear.precision.study import Measured

ABOVE_ROUNDING = 30.0
"""An error of so many times the least of all methods is the method's own, not rounding."""

MOST_ROUNDING = 1e-10
"""Rounding errors are below, in every study's unit; where no method gets so far, all errors are the methods' own."""


@dataclass(frozen=True)
class Rate:
    """How fast a method's error falls with its level: fitted, and by theory."""

    method: str
    fitted: float
    theory: float


def rates(found: Measured) -> tuple[Rate, ...]:
    """One for each method whose rate theory tells; raises ValueError where a fit has fewer than two points."""
    floor = min(ABOVE_ROUNDING * least_error(found), MOST_ROUNDING)
    rows = zip(found.study.methods, found.points, strict=True)
    return tuple(Rate(one.name, order(row, floor), one.order) for one, row in rows if one.order is not None)


def least_error(found: Measured) -> float:
    """Smallest error of all points that have one; 0 where none has."""
    return min((point.error for _, point in found.of_all if point.error > 0.0), default=0.0)
