"""The heights that undercut and shortened tips take away, and the contact that this costs.

A flank that loses the height d loses d / (sin(alpha) cos(alpha)) of rolled length.  Its contact is shorter by this
length if its mate would have touched it there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.pitch.curve import ClosedPitchCurve
from ncgear.teeth.flank import Flanks
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.regular import regular_depth
from ncgear.teeth.tips import tip_crossing
from ncgear.teeth.tool import RackLine

ROUNDING_IN_MODULES = 1e-9
"""Height that counts as 0, and difference of heights that count as equal: rounding errors of the flanks."""


@dataclass(frozen=True)
class Loss:
    """The largest loss of some flanks of a gear.

    ``amount_mm`` is the largest amount, ``tooth`` the number of its tooth, from 1, and ``contact_pitches`` the largest
    loss of contact of these flanks; infinite where the flank at full height has a cusp.
    """

    amount_mm: float
    tooth: int
    contact_pitches: float


def shortening(gear: ToothedGear, chosen: Mask) -> Loss:
    """Distance of the tips of the ``chosen`` flanks (shape (2 z,), one or more) below the rack's full height."""
    flanks, which = gear.flanks, np.nonzero(chosen)[0]
    full = np.maximum(flanks.tip_height_mm, flanks.full_tip_mm)
    amount = (full - flanks.tip_height_mm)[which]
    height, _, met = tip_crossing(replace(flanks, tip_height_mm=full), which)
    lost = np.where(met, height - gear.tips.height_mm[which], np.inf)
    return _largest(flanks, which, amount, np.where(amount > 0.0, lost, 0.0))


def undercutting(gear: ToothedGear) -> Loss:
    """Undercut of the gear's undercut flanks (at least one flank) by a tool of full depth.

    Where spaces are still cut to the full depth, a flank ends at the crossing of the notch: the amount is its lost
    height.  Elsewhere it is the distance of the full depth below the cusp at the flank's end, hF - r sin^2(alpha) on a
    pitch circle; such flanks lose no contact, since the mate's tips are shortened.
    """
    flanks, which = gear.flanks, np.nonzero(gear.tips.undercut)[0]
    radius = np.full(flanks.count, flanks.rack.root_radius_mm)
    tool = RackLine() if isinstance(flanks.tool, ClosedPitchCurve) else flanks.tool
    full = tool.flank_depth_mm(flanks.slant, flanks.full_root_mm, radius)[which]
    left, cut = -gear.sides.flank_range()[1][which], flanks.flank_depth_mm[which]
    notched = left < cut - ROUNDING_IN_MODULES * flanks.rack.module_mm
    amount = np.where(notched, cut - left, full - regular_depth(flanks, float(full.max()))[which])
    return _largest(flanks, which, amount, np.where(notched, amount, 0.0))


def _largest(flanks: Flanks, which: IndexArray, amount: Array, lost_mm: Array) -> Loss:
    """The loss of the chosen flanks from their amounts and from the heights of contact that they lose."""
    rack = flanks.rack
    # The first of equal teeth is named.
    worst = int(np.argmax(amount >= amount.max() - ROUNDING_IN_MODULES * rack.module_mm))
    pitches = float((lost_mm / flanks.slant.of(which).height_per_rolled).max()) / rack.pitch_mm
    return Loss(float(amount[worst]), int(flanks.tooth[which[worst]]), pitches)
