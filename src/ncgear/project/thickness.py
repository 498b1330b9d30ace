"""A pair over the band of tooth thickness that its file allows: play and contact at both ends and in the middle.

All other results are for the middle of the band: outlines, strength, simulation, the reference of measured gears, and
the assemblies of ``tolerance``, whose own deviations are added.  Only the backlash that assemblies need, and the share
of jamming assemblies in a build's estimate, are for the thickest teeth.
"""

from __future__ import annotations

from functools import partial

from ncgear.contact.designed.as_designed import AsDesigned, as_designed
from ncgear.contact.designed.extremes import ContactExtremes
from ncgear.contact.pair import refuse_overlap, sound_extremes
from ncgear.contact.placement import placed
from ncgear.frozen import dataclass
from ncgear.project.geared import Geared
from ncgear.project.tooth_form import thickness_limits_mm
from ncgear.teeth.backlash import Play, play_of
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import toothed_pair


@dataclass(frozen=True, eq=False)
class AtThickness:
    """A pair whose teeth all deviate by ``deviation_mm`` along the pitch curve: its play and its contact."""

    deviation_mm: float
    play: Play
    contact: AsDesigned
    extremes: ContactExtremes


def thickness_band(pair: Geared, contact: AsDesigned, extremes: ContactExtremes) -> tuple[AtThickness, ...]:
    """The pair with the thinnest teeth, with the outlines' teeth, and with the thickest teeth; empty without limits.

    ``contact`` and ``extremes`` belong to the outlines.  Raises NoSuchMechanism where the thickest teeth overlap.
    """
    limits = thickness_limits_mm(pair.gears)
    if limits is None:
        return ()
    middle = AtThickness(sum(limits) / 2.0, pair.play, contact, extremes)
    thinnest, thickest = map(partial(_at, pair), limits, pair.forms_at_limits)
    return thinnest, middle, thickest


def _at(pair: Geared, deviation_mm: float, form: ToothForm) -> AtThickness:
    pitch, tolerance_mm = pair.pitch, pair.chord_tolerance_mm
    with pair.telling_the_finest():
        teeth = toothed_pair(pitch, form, tolerance_mm)
    contact = as_designed(teeth, placed(pitch))
    refuse_overlap(contact, tolerance_mm)
    extremes = sound_extremes(pitch, teeth, contact, pair.pair_speed_rad_s, tolerance_mm)
    return AtThickness(deviation_mm, play_of(pitch, pair.rack, form.backlash), contact, extremes)
