"""Written gears turn freely: as polygons they overlap nowhere, from the law's angle on over the whole play.

The mate's teeth are moved through the whole mesh, at the law's angle and at parts of the play, against the whole of the
driven gear's outline.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from math import pi

import numpy as np
import pytest

import ncgear.teeth.fitting
import ncgear.teeth.gear
from drives import MACHINES, design_of, drive, loaded
from ncgear.errors import NoSuchMechanism
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Mesh
from ncgear.project.drive import Drive
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law, ratio_expression_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.backlash import play_of
from ncgear.teeth.flank import Flanks
from ncgear.teeth.form import Backlash, Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from oracles.reversing import Outlines, Positions, golden
from pairs import pitch_pair, rack, sine_law

Array = np.ndarray

OVERLAP = 0.1
"""Overlap that is let pass, in chord tolerances: chords stray into the material, but joints of curves are on them."""


def outlines_of(pitch: PitchPair, teeth: ToothedPair) -> Outlines:
    ring = pitch.mesh is Mesh.INTERNAL
    return Outlines(teeth.driving.outline_mm, teeth.driven.outline_mm, pitch.center_distance_mm, ring)


def positions(pitch: PitchPair, count: int) -> Positions:
    """Positions over the whole cycle by the law's own angles, which are judged elsewhere."""
    lobes = pitch.transmission.lobes
    phi1 = golden(count, 2.0 * pi * lobes.driven / np.gcd(lobes.driving, lobes.driven))
    driven = pitch.transmission.driven_angle(phi1, 2)
    return Positions(phi1, driven.value, driven.derivative(1), driven.derivative(2))


# --- without backlash --------------------------------------------------------------------------------------------

NO_GEARS = {"baler-frontier", "feeder-wishes", "feeder-kept", "jar-pusher", "baler-a1-at-law-speed"}
"""Designs without gears, and the one whose flanks could not turn their mates."""

WITH_GEARS = [name for name in MACHINES if name not in NO_GEARS]


def tight(name: str) -> tuple[Drive, ...]:
    """A worked design without backlash, its helical teeth straight: each section of them is such a pair."""
    data = deepcopy(loaded(name).data)
    data["gears"]["backlash_mm"] = 0.0
    data["gears"].pop("helix", None)
    return Drive(design_of(data)).by_stage


def test_designs_that_are_left_out_have_no_gears() -> None:
    assert loaded("baler-frontier").design.gears is None
    with pytest.raises(NoSuchMechanism, match="the pressure angle reaches"):
        _ = drive("baler-a1-at-law-speed").teeth


@pytest.mark.tiers(slow=["internal-1-2"], rest="long")
@pytest.mark.parametrize("name", WITH_GEARS)
def test_gears_without_backlash_overlap_nowhere_and_turn(name: str) -> None:
    for stage in tight(name):
        tolerance = stage.chord_tolerance_mm
        at, outlines = positions(stage.pitch, 200), outlines_of(stage.pitch, stage.teeth)
        assert outlines.overlap(at).max() <= OVERLAP * tolerance
        few = Positions(at.phi1[::4], at.phi2[::4], at.slope[::4], at.bend[::4])
        free = outlines.freedom(few, 0.0, 1e-3)
        there = ~np.isnan(free.on)
        # Where two chords touch with their ends on the curves there may be nothing left to turn.
        assert np.mean(there) >= 0.9
        assert np.mean((free.on + free.back)[there] > 1e-6) >= 0.9


@pytest.mark.slow
def test_chords_to_both_sides_overlap() -> None:
    """Negative control: with chords that straddle the flanks, as much of them stands out as stays within."""
    stage = tight("baler")[0]
    straddling = toothed_pair(stage.pitch, stage.tooth_form, 0.01, straddling=True)
    assert outlines_of(stage.pitch, straddling).overlap(positions(stage.pitch, 100)).max() > 5.0 * OVERLAP * 0.01


# --- over the whole play -----------------------------------------------------------------------------------------

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)

Case = tuple[PitchPair, ToothForm]


def baler(backlash_mm: float) -> Case:
    return drive("baler").pitch, replace(drive("baler").tooth_form, backlash=Backlash(backlash_mm))


def convex(backlash_mm: float) -> Case:
    """A pair that a rack cuts."""
    form = ToothForm(rack(), cutter=Cutter(CutterKind.RACK), limits=TipLimits(0.4), backlash=Backlash(backlash_mm))
    return pitch_pair(elliptical_law(0.35, 0.0, Lobes()), 37), form


def reaching(backlash_mm: float) -> Case:
    """Rack-cut, and the tips of the driving gear are as high as the driven flanks allow: they end at the fillets."""
    law = driven_angle_expression_law("phi - 0.112*sin(2*phi) + 0.11*sin(phi) - 0.026*(cos(2*phi)-1)", Lobes())
    backlash = Backlash(backlash_mm, driving_share=0.0)
    return pitch_pair(law, 23), ToothForm(rack(), limits=TipLimits(0.4), backlash=backlash)


def deep(backlash_mm: float) -> Case:
    form = ToothForm(rack(), limits=TipLimits(0.4), backlash=Backlash(backlash_mm))
    return pitch_pair(sine_law(0.3), 60), form


def deep_ring(backlash_mm: float) -> Case:
    """Its tips used to touch 37 mm off the line of centres when the gears took up their backlash."""
    law = ratio_expression_law("2 + 0.5*cos(phi)", Lobes(1, 2), scale_to_close=True)
    form = ToothForm(rack(), limits=TipLimits(0.4), backlash=Backlash(backlash_mm))
    return sized_pair(law, 40, 2.0, None, Mesh.INTERNAL), form


CASES: dict[str, Callable[[], Case]] = {
    "baler, 0.05 mm": lambda: baler(0.05),
    "baler, 0.3 mm": lambda: baler(0.3),
    "rack, 0.3 mm": lambda: convex(0.3),
    "tips at fillets, 0.2 mm": lambda: reaching(0.2),
    "deep sine, 0.1 mm": lambda: deep(0.1),
    "deep sine, 0.3 mm": lambda: deep(0.3),
    "deep ring, 0.05 mm": lambda: deep_ring(0.05),
}

TOLERANCE = 0.005


def deepest(pitch: PitchPair, form: ToothForm, count: int = 200) -> float:
    """Deepest overlap in mm at any of the positions, at parts of the play."""
    at, outlines = positions(pitch, count), outlines_of(pitch, toothed_pair(pitch, form, TOLERANCE))
    play = play_of(pitch, form.rack, form.backlash).driven_rad
    return max(float(outlines.overlap(at, share * play).max()) for share in SHARES)


@pytest.mark.tiers(slow=["tips at fillets, 0.2 mm"], rest="long")
@pytest.mark.parametrize("name", CASES)
def test_nothing_is_in_the_mates_way_over_the_whole_play(name: str) -> None:
    assert deepest(*CASES[name]()) <= OVERLAP * TOLERANCE


@pytest.mark.slow
def test_bottoms_that_stand_like_one_flank_each_are_in_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: without the sweep the two halves of a bottom stand as their flanks do."""
    monkeypatch.setattr(ncgear.teeth.gear, "swept", lambda tips, sides: (tips, sides))
    assert deepest(*baler(0.3), 60) > 0.05


@pytest.mark.slow
def test_turned_tips_get_into_bottoms_that_nobody_holds_them_against(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ncgear.teeth.fitting, "freed_of_bottoms", lambda own, mate, paths: own)
    assert deepest(*deep(0.3), 60) > 0.1


@pytest.mark.tiers(slow=["baler"], rest="long")
@pytest.mark.parametrize("made", [baler, convex])
def test_lands_that_are_not_turned_are_in_the_way(
    monkeypatch: pytest.MonkeyPatch, made: Callable[[float], Case]
) -> None:
    """Negative control: tip lands and bottoms as they would be without play, between turned flanks."""
    monkeypatch.setattr(ncgear.teeth.gear, "swept", lambda tips, sides: (tips, sides))
    monkeypatch.setattr(Flanks, "over_tip", lambda self, tooth, share, rate, land: land)
    assert deepest(*made(0.3), 60) > 0.3
