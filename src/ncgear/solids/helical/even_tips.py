"""The form of helical teeth whose tips change evenly from section to section.

Sections are fitted at advances over the helix, up to one pitch, after which they repeat; all of them share out foulings
in one way.  Where tips still jump between sections, ceilings over the tips lead up to the jumps (teeth/ceilings.py).
All flanks stay exact: lower tips cost contact only.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.sections import said_of_section
from ncgear.teeth.ceilings import ceilings_over
from ncgear.teeth.fitting import least_overlap
from ncgear.teeth.form import WAYS, ToothForm, Way
from ncgear.teeth.gear import pair_tips
from ncgear.teeth.tips import Limit, Tips

FEWEST, PER_PITCH = 4, 48
"""Steps between fitted sections: at least, and in a pitch of advance."""

Fits = list[tuple[Tips, Tips]]
"""Both gears' tips in sections one step apart."""


def with_even_tips(pitch: PitchPair, form: ToothForm, helix: Helix) -> ToothForm:
    """The form with one way for all sections, and with ceilings over the tips of both gears.

    Raises NoSuchMechanism, naming the height, where no tooth can stand.
    """
    heights, step = heights_fitted(helix, form.rack.pitch_mm)
    way, fits = _best_fits(pitch, form, helix, heights)
    return replace(form, limits=replace(form.limits, way=way, ceilings=ceilings_over(fits, step)))


def heights_fitted(helix: Helix, pitch_mm: float) -> tuple[Array, float]:
    """Heights of the sections that are fitted, and the rolled length in mm from one to the next.

    Over the whole helix or, without its end, over the first pitch of advance.
    """
    share = min(1.0, pitch_mm / helix.largest_advance_mm)
    advance = share * helix.largest_advance_mm
    steps = max(FEWEST, ceil(PER_PITCH * advance / pitch_mm))
    heights = np.linspace(0.0, helix.rise_mm * share, steps + 1)
    return heights[: steps + (share == 1.0)], advance / steps


def _best_fits(pitch: PitchPair, form: ToothForm, helix: Helix, heights: Array) -> tuple[Way, Fits]:
    """The way that leaves most contact in the worst section, and the sections fitted so; the first if none fouls."""
    found: list[tuple[Way, Fits]] = []
    refusals: list[NoSuchMechanism] = []
    # Tips foul near concave stretches only; without any the ways do not differ.
    for way in WAYS[:1] if all(pitch.convex(gear) for gear in Gear) else WAYS:
        try:
            found.append((way, _fits(pitch, form, helix, heights, way)))
            if not any(np.any(tips.limit == Limit.FOULING) for fit in found[-1][1] for tips in fit):
                break
        except NoSuchMechanism as refusal:
            refusals.append(refusal)
    if not found:
        raise refusals[0]
    return max(found, key=lambda one: min(map(least_overlap, one[1])))


def _fits(pitch: PitchPair, form: ToothForm, helix: Helix, heights: Array, way: Way) -> Fits:
    """Tips in all sections, fitted in one way; raises NoSuchMechanism, naming the height, where no tooth can stand."""
    fits, one_way = [], replace(form, limits=replace(form.limits, way=way))
    for height in heights:
        with said_of_section(float(height)):
            fits.append(pair_tips(pitch, one_way, helix.advance_mm(float(height)))[1])
    return fits
