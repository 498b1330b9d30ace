"""The form of helical teeth whose tips change evenly from section to section.

Sections are fitted at advances over the helix, one pitch at most since they repeat from there; where tips jump between
them, ceilings over the tips lead up to the jumps (teeth/ceilings.py).  All flanks stay exact: lower tips cost contact
only.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from ncgear.pitch.pair import PitchPair
from ncgear.solids.helix import Helix
from ncgear.solids.sections import said_of_section
from ncgear.teeth.ceilings import ceilings_over
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import pair_tips
from ncgear.teeth.tips import Tips

FEWEST, PER_PITCH = 4, 48
"""Steps between fitted sections, at least and in a pitch of advance."""


def with_even_tips(pitch: PitchPair, form: ToothForm, helix: Helix) -> ToothForm:
    """The form with ceilings over the tips of both gears.

    Raises NoSuchMechanism, naming the height, where no tooth can stand.
    """
    fits, step = fitted_sections(pitch, form, helix)
    return replace(form, limits=replace(form.limits, ceilings=ceilings_over(fits, step)))


def fitted_sections(pitch: PitchPair, form: ToothForm, helix: Helix) -> tuple[list[tuple[Tips, Tips]], float]:
    """Both gears' tips at advances over the helix, and the rolled length in mm from one to the next."""
    whole = form.rack.pitch_mm
    share = min(1.0, helix.largest_advance_mm / whole)
    count = max(FEWEST, ceil(share * PER_PITCH))
    heights = np.linspace(0.0, helix.rise_mm * share * whole / helix.largest_advance_mm, count + 1)
    fits = []
    for height in heights[: count + (share < 1.0)]:
        with said_of_section(float(height)):
            fits.append(pair_tips(pitch, form, helix.advance_mm(float(height)))[1])
    return fits, share * whole / count
