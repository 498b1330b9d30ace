"""Contact of a pair over the whole cycle: exact flanks and sampled outlines together."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from ncgear.contact.flank_contact import FlankContact, flank_contact
from ncgear.contact.outline_contact import OutlineContact, outline_contact, positions
from ncgear.contact.reach import tips_overlap_mm
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Mesh
from ncgear.teeth.gear import ToothedPair

BEYOND = 1.1
"""Share of the reach by which outlines are compared beyond it: a tenth, for tips that are cut by crowns."""

CHORDS_OVERLAP = 2.2
"""Overlap across, in chord tolerances, that two outlines may show: one for each, and a tenth for the search."""

CAUSES = {
    Mesh.EXTERNAL: "tips of a concave stretch foul the mating gear there; more teeth of a smaller module are needed, "
    "or a smaller range of the ratio",
    Mesh.INTERNAL: "tips foul the mating gear or, where a ring has too few teeth more than its driving gear, each "
    "other; a smaller addendum, more teeth of a smaller module, or more lobes of the driven gear are needed",
}
"""Why teeth overlap, and what helps."""


@dataclass(frozen=True, eq=False)
class PairContact:
    """What the flanks can do, and what the outlines do."""

    flanks: FlankContact
    outlines: OutlineContact


def pair_contact(pitch: PitchPair, teeth: ToothedPair) -> PairContact:
    """Contact at 20 positions or more per tooth over a meeting cycle of all teeth."""
    phi1 = positions(teeth.driving.teeth, teeth.driven.teeth)
    phi2 = pitch.transmission.driven_angle(phi1).value
    outlines = outline_contact(
        teeth.driving.outline_mm,
        teeth.driven.outline_mm,
        pitch.center_distance_mm,
        _reach_mm(pitch, teeth),
        phi1,
        phi2,
        pitch.pitch_point_mm(phi1),
        pitch.mesh,
    )
    return PairContact(flank_contact(teeth), outlines)


def _reach_mm(pitch: PitchPair, teeth: ToothedPair) -> float:
    """How far from the pitch point outlines are compared: the line of action, and where a ring's tips can foul."""
    rack = teeth.driving.flanks.rack
    action = rack.dedendum_mm / sin(rack.pressure_angle_rad)
    return BEYOND * (max(action, tips_overlap_mm(pitch, teeth)) if pitch.mesh is Mesh.INTERNAL else action)


def refuse_overlap(contact: PairContact, pitch: PitchPair, teeth: ToothedPair, tolerance_mm: float) -> None:
    """Refuse a pair whose outlines overlap by more than their chord tolerance explains.

    Overlaps are measured as arcs about the driven axis, which are longer than depths across by 1 / cos(pressure angle).
    Raises NoSuchMechanism with the worst angle and the teeth that meet there.
    """
    outlines, angle = contact.outlines, teeth.driving.flanks.rack.pressure_angle_rad
    allowed = CHORDS_OVERLAP * tolerance_mm / cos(angle + pitch.largest_tangent_angle_rad.value)
    worst = int(np.argmax(outlines.penetration_mm))
    if outlines.penetration_mm[worst] <= allowed:
        return
    phi1 = float(outlines.phi1_rad[worst])
    rolled = float(pitch.arc.length(np.array(phi1))) * pitch.center_distance_mm
    tooth = round(rolled / teeth.driving.flanks.rack.pitch_mm) % teeth.driving.teeth + 1
    raise NoSuchMechanism(
        f"the teeth run into each other by {outlines.penetration_mm[worst]:.3g} mm near tooth {tooth} of "
        f"the driving gear at phi1 = {in_words(phi1)}: {CAUSES[pitch.mesh]}",
        key="gears.teeth",
    )
