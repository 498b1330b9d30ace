"""Usual deviations of gears by the process that makes them: taken where a design gives no tolerances.

Sources, all for ordinary care, not for the best work of a process:

- hobbed or shaped: class 8 of ISO 1328-1, which these leave without finishing (classes 7 to 9 in gear handbooks, from
  secondary sources);
- wire-cut: class 7.  Small brass gears came to DIN 5 in experiments (K. Gupta, N. K. Jain, Manufacturing of high
  quality miniature gears by wire electric discharge machining, DAAAM International Scientific Book 2013, chapter 40);
  two classes more are taken for work without such care.  Bore and teeth are cut in one set-up;
- printed: service providers promise 0.2 mm either way for a whole part of calibrated machines that lay filament.  A
  quarter of it is taken for a flank against its neighbour, since all flanks swell alike, and for the bore.  No gears
  were measured for this: it is a rough guess.

Centre distance and keyways are for housings and shafts that are milled, or printed with the gears.
"""

from __future__ import annotations

from enum import StrEnum

from ncgear.design.keys.gears import Gears
from ncgear.design.keys.tolerances import AssemblyTolerances, GearTolerances
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.tolerances.iso286 import distance_deviation_mm


class Process(StrEnum):
    """How gears are made, in words that stand before "gears"."""

    GENERATED = "hobbed or shaped"
    CUT = "wire-cut"
    PRINTED = "printed"


_GENERATED = GearTolerances(eccentricity_mm=0.02, tilt_deg=0.02, index_deg=0.1)
_CUT = GearTolerances(eccentricity_mm=0.01, tilt_deg=0.02, index_deg=0.1)
_PRINTED = GearTolerances(single_pitch_mm=0.05, profile_mm=0.05, eccentricity_mm=0.05, tilt_deg=0.1, index_deg=0.5)

USUAL = {
    Process.GENERATED: AssemblyTolerances(grade=8, center_distance_mm=0.03, driving=_GENERATED, driven=_GENERATED),
    Process.CUT: AssemblyTolerances(grade=7, center_distance_mm=0.03, driving=_CUT, driven=_CUT),
    Process.PRINTED: AssemblyTolerances(center_distance_mm=0.1, driving=_PRINTED, driven=_PRINTED),
}
"""The tolerances of each process."""


def process_of(drive: Drive) -> Process:
    """The process that the file tells by a printed material, or by keys for prints, for kerfs or for a cutter.

    Where it tells none: hobbed or shaped, if a hob can cut every gear, else wire-cut.
    """
    gears = drive.gears
    if _is_printed(gears):
        return Process.PRINTED
    if gears.cutter.kind in ("rack", "pinion"):
        return Process.GENERATED
    if gears.process_clearance_mm < 0.0 or gears.cutter.kind == "mate":
        return Process.CUT
    hobbed = all(_is_convex(pair) for pair in drive.whole.by_stage)
    return Process.GENERATED if hobbed else Process.CUT


def _is_printed(gears: Gears) -> bool:
    materials = () if gears.material is None else [one.name for one in gears.material.each]
    return (
        any(name.endswith("-print") for name in materials)
        or gears.process_clearance_mm > 0.0
        or gears.first_layer_chamfer_mm > 0.0
    )


def _is_convex(pair: Drive) -> bool:
    return not pair.pitch.driven.is_ring and all(pair.pitch.least_concave_radius_mm(gear) is None for gear in Gear)


def tolerances_of(drive: Drive) -> tuple[AssemblyTolerances, Process | None]:
    """The tolerances of the assemblies of a design: as given, or as usual for its process, which is then told.

    Housings are made by the drawing.  So a deviation of the centre distance on the drawing counts before both, and
    where the drawing says JS7 by itself, the usual deviation is no smaller.
    """
    drawn_mm, given = drive.gears.tolerances.center_distance_mm, drive.design.tolerances
    process = process_of(drive) if given is None else None
    apart_mm = [pair.pitch.center_distance_mm for pair in drive.whole.by_stage]
    taken = given if process is None else _usual(process, min(apart_mm))
    assert taken is not None
    if drawn_mm is None and (process is not None or "center_distance_mm" not in taken.model_fields_set):
        drawn_mm = max(taken.center_distance_mm, *(distance_deviation_mm(one) or 0.0 for one in apart_mm))
    return taken if drawn_mm is None else taken.model_copy(update={"center_distance_mm": drawn_mm}), process


SMALLEST_MM = 10.0
"""Centre distance from which on the usual tolerances of the table hold.  The tolerances of smaller gears that are cut
are smaller in proportion, as watchmakers have to make them.  A printer does not become finer.
"""


def _usual(process: Process, distance_mm: float) -> AssemblyTolerances:
    """The tolerances of a process for gears at a centre distance in mm."""
    taken, share = USUAL[process], distance_mm / SMALLEST_MM
    if process is Process.PRINTED or share >= 1.0:
        return taken
    gears = {
        gear.value: (one := getattr(taken, gear.value)).model_copy(
            update={"eccentricity_mm": share * one.eccentricity_mm}
        )
        for gear in Gear
    }
    return taken.model_copy(update={"center_distance_mm": share * taken.center_distance_mm, **gears})
