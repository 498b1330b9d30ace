"""The drive of a design that differs from another design in some values: common values are computed once."""

from __future__ import annotations

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.project.drive import Drive
from ncgear.project.law import lobes_of
from ncgear.project.tooth_form import reach_in_pitches

BODY = ("face_width_mm", "material")
"""Keys that change nothing of straight teeth in the plane across the axes."""

SAME_TEETH = ("pitch", "rack", "play", "tooth_form", "teeth", "free_contact")
"""Attributes of a drive that do not change with these keys, nor with lengths of the mechanism that the law does not
use."""


def drive_like(drive: Drive, design: Design, loaded: LoadedDesign | None = None) -> Drive:
    """The drive of another design; it takes law, pitch curves and teeth from ``drive`` where they are the same."""
    kept = _in_common(drive.design, design)

    def like(one: Drive, whole: Drive | None = None) -> Drive:
        other = Drive(design, one.stage, loaded, whole)
        vars(other).update({name: value for name, value in vars(one).items() if name in kept})
        return other

    whole = like(drive)
    if kept and design.stages > 1 and drive.stage is None:
        vars(whole)["by_stage"] = tuple(like(one, whole) for one in drive.by_stage)
    return whole


def _in_common(one: Design, other: Design) -> tuple[str, ...]:
    """The attributes that drives of two designs have in common."""
    same_linkage = one.linkage == other.linkage
    laws = [(design.motion, lobes_of(design), *_series(design)) for design in (one, other)]
    if laws[0] != laws[1] or (not same_linkage and one.motion.gives_slider):
        return ()
    law = ("law",) if same_linkage else ()
    before, after = one.gears, other.gears
    if before is None or after is None:
        return law
    same_body = {name: getattr(before, name) for name in BODY}
    if before.helix is None and one.output == other.output and after.model_copy(update=same_body) == before:
        return *law, *SAME_TEETH, *(("_free_extremes",) if one.operation == other.operation else ())
    sizes = [[getattr(gears, name) for name in (*SIZES, "mesh")] for gears in (before, after)]
    if sizes[0] == sizes[1] and reach_in_pitches(before) == reach_in_pitches(after):
        return *law, "pitch"
    return law


def _series(design: Design) -> tuple[object, ...]:
    """The keys that make pairs in series of a law."""
    return (design.gears.pairs, design.gears.idlers) if design.gears else (1, None)
