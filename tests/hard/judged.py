"""What became of a case: refused with a message, or made, and then how far from the reference."""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import mp

from hard.case import Case
from hard.figures import reference, reported
from ncgear.errors import DesignError
from oracles import laws

EPSILON = 2.220446049250313e-16

FACTOR = 32.0
"""Rounding errors, times the condition, that a figure may be off by: 18 to which panels of a Chebyshev form count as
resolved (ncgear.numerics.chebyshev.RESOLVED), the rest for the few dozen operations between an input and a figure."""

CANCELLING = {"theta1-small": 100.0, "a1-small": 100.0}
"""Cases that are held to more: the return's polynomial begins a hundred times and more above its smallest value, with
terms 1e4 times that value and more, and takes over their rounding error."""

LARGE = 1e6
"""Condition from which it is told in full."""


@dataclass(frozen=True)
class Made:
    """Of every figure the relative error, and the closure residual in rad."""

    errors: dict[str, float]
    closure_rad: float


@dataclass(frozen=True)
class Refused:
    """What the user reads, and the exit status."""

    message: str
    exit_status: int


def judged(case: Case) -> Made | Refused:
    """The case, made and compared, or its refusal."""
    try:
        drive = case.drive()
        found = reported(drive)
    except DesignError as error:
        return Refused(error.problem.splitlines()[0], error.exit_status)
    exact = reference(drive, case.data)
    with mp.workdps(laws.DIGITS):
        errors = {name: abs(float(mp.mpf(figure.value) / exact[name] - 1)) for name, figure in found.items()}
    return Made(errors, abs(drive.transmission.closure_error_rad))


def allowed(name: str) -> float:
    """Rounding errors times the condition that a case's figures may be off by."""
    return CANCELLING.get(name, FACTOR)


def in_roundings(made: Made, condition: dict[str, float]) -> dict[str, float]:
    """Every figure's error in rounding errors times its condition."""
    return {name: error / (condition[name] * EPSILON) for name, error in made.errors.items()}
