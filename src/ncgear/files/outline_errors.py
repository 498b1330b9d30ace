"""How far tooth outlines in files are from the exact ones: measured on what is written, read back.

Points of the exact curves, that no chord and no arc knows of, are held against the outline of each file.  The faces of
STEP files are held against them when they are made, between the places that they go through.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from ncgear.metrology.chord_error import exact_points, farthest_mm
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.teeth.gear import ToothedPair

ExactOutlines = tuple[Array, Array]
"""Points of all exact curves of the driving and of the driven gear, shape (n, 2) each."""

ERRORS = f"{__name__}:outline_errors_mm"


def exact_outlines(teeth: ToothedPair) -> ExactOutlines:
    """The points against which outlines are measured."""
    return exact_points(teeth.of(Gear.DRIVING)), exact_points(teeth.of(Gear.DRIVEN))


def outline_errors_mm(exact_mm: ExactOutlines, outlines_mm: Mapping[str, tuple[Array, Array]]) -> dict[str, float]:
    """The largest distance of both gears' exact curves from the outlines of each kind of file, by its name."""
    return {kind: max(map(farthest_mm, exact_mm, both)) for kind, both in outlines_mm.items()}


def error_of_step_mm(data: bytes) -> float:
    """What the head of a STEP file says of its faces, which were held against the exact curves when they were made."""
    head = b" ".join(data.split(b"ENDSEC", 1)[0].split())
    (error,) = re.findall(rb"tooth faces within (\S+) mm", head)
    return float(error)
