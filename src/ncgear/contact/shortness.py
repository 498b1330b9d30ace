"""The refusal of flanks that do not touch long enough: why, between which teeth, and what their tips are limited by."""

from __future__ import annotations

import numpy as np

from ncgear.contact.as_designed import AsDesigned, SideContact
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.teeth.gear import ToothedGear, ToothedPair
from ncgear.teeth.tips import Limit

ROUNDING = 1e-9
"""Share of a pitch that rounding may cost a contact."""

REASONS = {
    Limit.FULL: "its full height",
    Limit.SLOPE: "higher its land would slope too much, the tooth's other edge being lower",
    Limit.FILLET: "higher it would reach into the mate's fillet",
    Limit.UNDERCUT: "higher it would undercut the mate",
    Limit.CUSP: "its flank ends in a cusp there",
    Limit.LAND: "higher its land would be too narrow",
    Limit.FOULING: "higher it would foul the mate's tips",
    Limit.HELIX: "higher it would jump between sections of the helical teeth",
}

REMEDY = (
    "more teeth of a smaller module, a smaller range of the ratio or a smaller least_tip_land help, or a smaller "
    "least_contact_ratio to have the gears all the same"
)


def refuse_short_contact(designed: AsDesigned, teeth: ToothedPair, least: float) -> None:
    """Refuse a pair that loses contact, for a ``least`` of 1 or more, or has flanks that touch over fewer pitches.

    A pair of flanks may touch over less than one pitch while its neighbours bridge the rest: a ``least`` of exactly 1
    asks only that contact never ceases, one below 1 asks for nothing.  What limits each tip is a condition that no
    other tool can lift.  Raises NoSuchMechanism with both teeth.
    """
    for side in (designed.pushing, designed.back):
        shortest = int(np.argmin(side.arcs))
        if least > 1.0 and side.arcs[shortest] < least - ROUNDING:
            raise NoSuchMechanism(
                f"the flanks of {_pair(side, teeth, shortest)} touch over {side.arcs[shortest]:.3g} pitches only, less "
                f"than {least:.3g}: {_limits(side, teeth, shortest)}; {REMEDY}",
                key="gears.least_contact_ratio",
            )
        parted = int(np.argmin(side.simultaneous))
        if least >= 1.0 and side.simultaneous[parted] == 0:
            raise NoSuchMechanism(
                f"no flanks touch at phi1 = {in_words(float(designed.placement.phi1_rad[parted]))}: one pair parts "
                f"before the next one meets; the shortest contact is that of {_pair(side, teeth, shortest)}, "
                f"{side.arcs[shortest]:.3g} pitches: {_limits(side, teeth, shortest)}; {REMEDY}",
                key="gears.least_contact_ratio",
            )


def _pair(side: SideContact, teeth: ToothedPair, meeting: int) -> str:
    driving, driven = int(side.meetings.driving[meeting]), int(side.meetings.driven[meeting])
    flanks = teeth.driving.flanks
    phi1 = float(flanks.curve.driving_angle(flanks.crossing_mm[driving : driving + 1])[0])
    return f"driving tooth {driving // 2 + 1} and driven tooth {driven // 2 + 1} (phi1 = {in_words(phi1)})"


def _limits(side: SideContact, teeth: ToothedPair, meeting: int) -> str:
    driving = _limit(teeth.driving, int(side.meetings.driving[meeting]))
    driven = _limit(teeth.driven, int(side.meetings.driven[meeting]))
    return f"the driving tip ends {driving}, the driven one {driven}"


def _limit(gear: ToothedGear, flank: int) -> str:
    height = float(gear.flanks.tip_height_mm[flank])
    return f"{height:.3g} mm above the pitch curve ({REASONS[Limit(int(gear.tips.limit[flank]))]})"
