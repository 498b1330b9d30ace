"""How long flanks touch in the sections of helical teeth: their shapes, and so their contact, differ with height."""

from __future__ import annotations

import numpy as np

from ncgear.contact.flank_contacts import least_arc
from ncgear.contact.placement import placed
from ncgear.solids.sections import Sections

LOOKED_AT = 9
"""Sections looked at, both ends included: contact changes as slowly as the curvature."""


def least_section_contact(sections: Sections) -> float:
    """Least arc of contact, in pitches, of any pair of flanks in sections over the height."""
    placement, heights = placed(sections.pitch), np.linspace(0.0, sections.helix.rise_mm, LOOKED_AT)
    return min(least_arc(sections.at(float(height)).teeth, placement) for height in heights)
