"""The finest chord tolerance with which the gears of a design are made, for refusals to tell."""

from __future__ import annotations

from collections.abc import Iterable

from ncgear.pitch.pair import PitchPair
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.sections import Sections
from ncgear.solids.helical.stack import OUTLINE, finest_in_steps_mm
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import finest_tolerance_mm

SPARE = 1.05
"""Sections of helical teeth: the told tolerance is 5 % more than z = 0 needs.  With the height the number of points
changes by a few per cent at most, and the tolerance by twice that."""


SOON = 6_000
"""Points of an outline with which a build takes half a minute of processor time at most; with 28 000 it took 76 s.
Their number is inversely proportional to the root of the tolerance."""


def finest_chords_mm(made: Iterable[tuple[PitchPair, ToothForm, Helix | None]], from_mm: float) -> tuple[float, float]:
    """The finest tolerance, from ``from_mm`` on, with which pairs can be made, and the finest that makes them soon.

    Each pair has a form and the helix of its teeth.
    """
    finest_mm = soon_mm = from_mm
    for pitch, form, helix in made:
        if helix is None:
            finest_mm, points = finest_tolerance_mm(pitch, form, finest_mm)
        else:
            within_mm, points = finest_tolerance_mm(pitch, form, SPARE * OUTLINE * finest_mm)
            in_steps_mm = finest_in_steps_mm(Sections(pitch, form, helix, within_mm))
            finest_mm = max(within_mm / OUTLINE, in_steps_mm)
        soon_mm = max(soon_mm, finest_mm * max(points / SOON, 1.0) ** 2)
    return finest_mm, soon_mm
