"""Contact of a pair over the whole cycle: exact flanks and sampled outlines together."""

from __future__ import annotations

from dataclasses import dataclass
from math import sin

import numpy as np

from ncgear.contact.flank_contact import FlankContact, flank_contact
from ncgear.contact.outline_contact import OutlineContact, outline_contact, positions
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair

BEYOND = 1.1
"""How far beyond the end of the rack's line of action outlines are compared: a tenth, for tips that are cut by crowns.
How far beyond the end of the rack's line of action outlines are compared: a tenth, for tips that are cut by crowns."""


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
