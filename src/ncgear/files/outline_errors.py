"""How far tooth outlines in files are from the exact ones: measured on what is written, read back.

Points of the exact curves, that no chord and no arc knows of, are held against the outline of each file.  The faces of
STEP files are held against them when they are made, between the places that they go through.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from ncgear.files.workshop.read_back import READERS, read_outlines
from ncgear.metrology.chord_error import exact_points, farthest_mm
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive


def outline_errors_mm(
    drive: Drive, files: Mapping[str, bytes], outlines: Mapping[str, tuple[Array, Array]]
) -> dict[str, float]:
    """The largest distance of both gears' exact curves from their outlines in the files of each kind, by its name.

    ``outlines``, by the kinds of files, are those that are read back already; those of the other ``files`` are read
    now.  Drawings of gears from which a process takes its clearance are left out: their outlines are parallels.
    """
    left = {name: content for name, content in files.items() if name.rsplit(".", 1)[-1] not in outlines}
    found = {**outlines, **read_outlines(left)}
    if drive.gears.process_clearance_mm != 0.0:
        found = {kind: both for kind, both in found.items() if kind not in READERS}
    exact = [exact_points(drive.teeth.of(gear)) for gear in Gear]
    errors = {kind: max(map(farthest_mm, exact, both)) for kind, both in found.items()}
    if "pair.step" in files:
        errors["step"] = error_of_step_mm(files["pair.step"])
    return errors


def error_of_step_mm(data: bytes) -> float:
    """What the head of a STEP file says of its faces, which were held against the exact curves when they were made."""
    head = b" ".join(data.split(b"ENDSEC", 1)[0].split())
    (error,) = re.findall(rb"tooth faces within (\S+) mm", head)
    return float(error)
