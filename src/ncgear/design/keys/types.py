"""The types of the values of keys, with their limits, and what is said of them in more than one place."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, Field, Strict

from ncgear.design.keys.base import fault

LONGEST_MM = 1e7
"""Ten kilometres: beyond any machine, and far below where the squares of lengths overflow."""

SLOWEST_RPM, FASTEST_RPM = 1e-6, 1e7
"""One turn in two years, and far above whatever a machine has: squares of speeds stay far from overflow and zero."""

SHORTEST_MM = 1e-12
"""A hundred-thousandth of an atom's diameter, and far above where powers of lengths vanish."""


def not_vanishing(length: float) -> float:
    """The length itself in mm; a fault where it is too short."""
    if length < SHORTEST_MM:
        raise fault("", f"{length!r} given; a length of {SHORTEST_MM:g} mm or over is needed")
    return length


Length = Annotated[float, Field(gt=0.0, le=LONGEST_MM), AfterValidator(not_vanishing)]
Place = Annotated[float, Field(ge=-LONGEST_MM, le=LONGEST_MM)]
Speed = Annotated[float, Field(ge=SLOWEST_RPM, le=FASTEST_RPM)]
Positive = Annotated[float, Field(gt=0.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Direction = Annotated[float, Field(ge=-360.0, le=360.0)]
"""An angle in degrees."""

LONGEST_EXPRESSION = 1000

Expression = Annotated[str, Field(min_length=1, max_length=LONGEST_EXPRESSION)]
"""A formula."""

FORMULA = (
    "made of numbers, pi, + - * / **, sin, cos, tan, exp, log, sqrt, atan, sinh, cosh, tanh, abs, sign, min, max "
    "and a if u < v else b"
)
"""What ``ncgear.numerics.formula`` reads."""

SMOOTH_LAW = (
    "it may not jump where such pieces meet or where the cycle begins again; where its slope jumps there, gears cannot "
    "be made"
)
"""What the pitch curves ask of a ratio and of dphi2/dphi1."""

Item = TypeVar("Item")

# YAML has only lists, and strict models accept only tuples: so the container is not strict, but its items are.
Several = Annotated[tuple[Item, ...], Strict(False)]
Numbers = Several[float]
FileName = Annotated[str, Field(min_length=1)]

CSV_FILE = (
    "table (CSV, XLSX, ODS) with {} columns instead, its header naming them; its path counts from the design file"
)

FileFormat = Literal[1]
FILE_FORMAT = "version of the file's format; a file of a later format needs a later ncgear; left out: 1"
"""The formats that this program reads, and what is said of their key: a change that older files do not mean is 2."""
