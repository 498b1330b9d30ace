"""Contact of a pair over the whole cycle: exact flanks and sampled outlines together."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from ncgear.contact.flank_contact import FlankContact, flank_contact
from ncgear.contact.outline_contact import OutlineContact, outline_contact, positions
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair

BEYOND = 1.1
"""How far beyond the end of the rack's line of action outlines are compared: a tenth, for tips that are cut by crowns.
How far beyond the end of the rack's line of action outlines are compared: a tenth, for tips that are cut by crowns."""


CHORDS_OVERLAP = 2.2
"""Overlap across, in chord tolerances, that two outlines may show: one for each, and a tenth for the search."""


@dataclass(frozen=True, eq=False)
class PairContact:
    """What the flanks can do, and what the outlines do."""

    flanks: FlankContact
    outlines: OutlineContact


def pair_contact(pitch: PitchPair, teeth: ToothedPair) -> PairContact:
    """Contact at 20 positions or more per tooth over a meeting cycle of all teeth."""
    rack = teeth.driving.flanks.rack
    phi1 = positions(teeth.driving.teeth, teeth.driven.teeth)
    phi2 = pitch.transmission.driven_angle(phi1).value
    radius = np.linalg.norm(pitch.driving.at_angle(phi1).position, axis=1)
    outlines = outline_contact(
        teeth.driving.outline_mm,
        teeth.driven.outline_mm,
        pitch.center_distance_mm,
        BEYOND * rack.dedendum_mm / sin(rack.pressure_angle_rad),
        phi1,
        phi2,
        radius,
    )
    return PairContact(flank_contact(teeth), outlines)


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
        f"the driving gear at phi1 = {in_words(phi1)}: tips of a concave stretch foul the mating gear "
        "there; more teeth of a smaller module are needed, or a smaller range of the ratio",
        key="gears.teeth",
    )
