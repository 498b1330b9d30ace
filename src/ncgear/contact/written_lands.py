"""How high the tips and how deep the roots of a written outline are, along the normals of the pitch curve."""

from __future__ import annotations

import numpy as np

from ncgear.contact.polar import polar_outline
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import across, along, as_complex
from ncgear.numerics.ragged import counted_up
from ncgear.teeth.flank import Flanks

SECTOR_IN_PITCHES = 1.0
"""Arc to either side of a pitch point within which its normal is followed: farther than any tooth is high."""


def tip_heights(outline_mm: Array, flanks: Flanks) -> Array:
    """Where in mm beyond the pitch curve the outline is left at each tooth's middle, shape (z,)."""
    crossing = flanks.crossing_mm
    return _along_normals(outline_mm, flanks, (crossing[0::2] + crossing[1::2]) / 2.0, 1.0)


def root_depths(outline_mm: Array, flanks: Flanks) -> Array:
    """Where in mm below the pitch curve the outline is met in the middle of the space after each tooth, shape (z,)."""
    crossing = flanks.crossing_mm
    following = np.append(crossing[2::2], crossing[0] + flanks.curve.length_mm)
    return _along_normals(outline_mm, flanks, (crossing[1::2] + following) / 2.0, -1.0)


def _along_normals(outline_mm: Array, flanks: Flanks, sigma_mm: Array, sense: float) -> Array:
    """Distances from points of the pitch curve to the outline, outwards (``sense`` +1) or inwards (-1).

    Infinite where the outline is not met.
    """
    at = flanks.curve.at_length(sigma_mm)
    origin, direction = as_complex(at.position), sense * as_complex(at.normal)
    outline = as_complex(outline_mm)
    width = SECTOR_IN_PITCHES * flanks.rack.pitch_mm / np.abs(origin)
    row, vertex = counted_up(*polar_outline(outline).windows(np.angle(origin), width))
    arms = [outline[number % outline.size] - origin[row] for number in (vertex, vertex + 1)]
    (before, after), (near, far) = ([product(direction[row], arm) for arm in arms] for product in (across, along))
    crossed = np.nonzero((before < 0.0) != (after < 0.0))[0]
    share = before[crossed] / (before[crossed] - after[crossed])
    distance = near[crossed] + share * (far[crossed] - near[crossed])
    least = np.full(sigma_mm.size, np.inf)
    np.minimum.at(least, row[crossed], np.where(distance > 0.0, distance, np.inf))
    return least
