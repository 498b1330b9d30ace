"""Hard gears, judged by shapely over a meeting cycle: few and many teeth, sharp and hollow curves, jumps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi

import numpy as np
import pytest
from scipy.optimize import brentq
from shapely import Polygon

from ncgear.errors import NoSuchMechanism
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import mating_flanks
from ncgear.teeth.form import Backlash, BasicRack, Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from oracles import meshing
from pairs import baler_law, rack, sine_law

Array = np.ndarray

POSITIONS = 211
"""A prime, so that positions do not keep step with the teeth."""


@dataclass(frozen=True, eq=False)
class Case:
    """A pair to be made and judged; lengths in modules of its rack."""

    law: Callable[[], Transmission]
    teeth: int
    basic: BasicRack = field(default_factory=rack)
    avoid: bool = True
    cutter: Cutter = field(default_factory=Cutter)
    advance: float = 0.0
    backlash_mm: float = 0.0

    @property
    def tolerance_mm(self) -> float:
        return self.basic.module_mm / 400.0

    def made(self) -> tuple[PitchPair, ToothedPair]:
        module = self.basic.module_mm
        pitch = sized_pair(self.law(), self.teeth, module, None)
        limits, backlash = TipLimits(0.2 * module, self.avoid), Backlash(self.backlash_mm)
        wanted = ToothForm(self.basic, cutter=self.cutter, limits=limits, backlash=backlash)
        return pitch, toothed_pair(pitch, wanted, self.tolerance_mm, advance_mm=self.advance * module)


def judged(pitch: PitchPair, pair: ToothedPair) -> meshing.MeshingReport:
    """Overlap and gap of the outlines over a turn of the slower gear."""
    turns = max(pitch.driving.periods, pitch.driven.periods) / pitch.driving.periods
    phi1 = np.linspace(0.0, turns * pitch.driving.turn_rad, POSITIONS + 1)
    phi2 = pitch.transmission.driven_angle(phi1).value
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    return meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm).report(POSITIONS)


def handed_over(pair: ToothedPair) -> float:
    """Least rolled length, in pitches, over which pairs of either side's flanks touch before the next takes over.

    From where the one behind begins to where the one ahead ends: one and more is continuous contact.
    """
    rack = pair.driving.flanks.rack
    own, mate = mating_flanks(pair.driving.teeth, pair.driven.teeth)
    length = rack.slants[0].height_per_rolled * rack.pitch_mm
    driving, driven = (
        gear.tips.height_mm[flank].reshape(2, -1) / length for gear, flank in ((pair.driving, own), (pair.driven, mate))
    )
    # Front flanks touch from the driving tip to the driven one, back flanks the other way.
    front, back = driven[0] + np.roll(driving[0], -1), driving[1] + np.roll(driven[1], -1)
    return float(min(front.min(), back.min()))


CASES = {
    "8:8": Case(lambda: uniform_law(Lobes()), 8),
    "8:8, undercut": Case(lambda: uniform_law(Lobes()), 8, avoid=False),
    "8:40": Case(lambda: uniform_law(Lobes(1, 5)), 8),
    "8 teeth, sine": Case(lambda: sine_law(0.08), 8),
    "500 teeth": Case(lambda: uniform_law(Lobes()), 500),
    "module 0.3": Case(baler_law, 25, rack(module=0.3)),
    "module 20": Case(baler_law, 25, rack(module=20.0)),
    "14.5 degrees": Case(baler_law, 40, rack(14.5)),
    "25 degrees": Case(baler_law, 40, rack(25.0, root_radius=0.25)),
    "eccentricity 0.7": Case(lambda: elliptical_law(0.7, 0.0, Lobes()), 25),
    "eccentricity 0.7, undercut": Case(lambda: elliptical_law(0.7, 0.0, Lobes()), 25, avoid=False),
    "3:1": Case(lambda: elliptical_law(0.3, 0.0, Lobes(3, 1)), 60),
    "2:3": Case(lambda: elliptical_law(0.4, 0.0, Lobes(2, 3)), 48),
    "deep sine, 25": Case(lambda: sine_law(0.3), 25),
    "deep sine, 72": Case(lambda: sine_law(0.3), 72),
    "baler, 25": Case(baler_law, 25),
    "baler, 86": Case(baler_law, 86),
    "backlash": Case(baler_law, 25, backlash_mm=0.1),
    "no root radius": Case(baler_law, 40, rack(root_radius=0.0)),
}

SLOW = {
    **{f"deep sine, {teeth}": Case(lambda: sine_law(0.3), teeth) for teeth in (24, 37, 48, 144, 300)},
    **{f"baler, {teeth}": Case(baler_law, teeth) for teeth in (12, 16, 19, 31, 36, 50, 60, 100, 150, 300)},
    **{f"eccentricity 0.7, {teeth}": Case(lambda: elliptical_law(0.7, 0.0, Lobes()), teeth) for teeth in (13, 46, 100)},
    **{f"sine, {teeth}": Case(lambda: sine_law(0.08), teeth) for teeth in (6, 12, 22, 31, 100, 500)},
    **{f"uniform, {teeth}": Case(lambda: uniform_law(Lobes()), teeth) for teeth in (5, 6, 12, 17, 18)},
    "8:40, undercut": Case(lambda: uniform_law(Lobes(1, 5)), 8, avoid=False),
    "baler, pinion": Case(baler_law, 150, cutter=Cutter(CutterKind.PINION)),
}

PARTED = {"8:8, undercut", "8:40, undercut", "backlash"}
"""Pairs whose flanks stand apart: undercut takes more than tips tell, backlash is play."""


def judge(case: Case, *, parted: bool = False) -> None:
    """The teeth never overlap by more than chords explain, and where contact is handed over they touch."""
    pitch, pair = case.made()
    for gear in (pair.driving, pair.driven):
        assert Polygon(gear.outline_mm).is_valid
    report = judged(pitch, pair)
    assert report.overlap_depth.max() <= 1.2 * case.tolerance_mm
    if handed_over(pair) >= 1.0 and not parted:
        assert report.gap.max() <= 2.0 * case.tolerance_mm


@pytest.mark.tiers(slow=["eccentricity 0.7"], rest="long")
@pytest.mark.parametrize("name", CASES)
def test_hard_pairs_mesh(name: str) -> None:
    judge(CASES[name], parted=name in PARTED)


@pytest.mark.tiers(slow=["eccentricity 0.7, 13"], rest="long")
@pytest.mark.parametrize("name", SLOW)
def test_more_hard_pairs_mesh(name: str) -> None:
    judge(SLOW[name], parted=name in PARTED)


@pytest.mark.tiers(slow=["eccentricity 0.7-1.3"], rest="long")
@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("8:40", 1.0),
        ("500 teeth", 1.9),
        ("eccentricity 0.7", 1.3),
        ("3:1", 1.4),
        ("deep sine, 72", 1.1),
        ("baler, 25", 1.0),
    ],
)
def test_hard_pairs_that_hand_over_contact(name: str, least: float) -> None:
    assert handed_over(CASES[name].made()[1]) >= least


@pytest.mark.slow
def test_a_bowl_that_its_gear_nearly_fills_is_refused() -> None:
    """Radii of curvature of 8.6 and 7.9 mm with teeth of 2 mm: as 9 teeth in a ring, round which tips meet again."""
    case = Case(lambda: sine_law(0.4), 400, rack(module=2.0))
    with pytest.raises(NoSuchMechanism, match=r"back flank of tooth 1 of the driven gear .* free of its mate"):
        case.made()


# --- what stands on a tooth --------------------------------------------------------------------------------------


def jumps() -> Array:
    """Arc lengths, in modules, at which the curvature of the baler's 25 teeth jumps."""
    return sized_pair(baler_law(), 25, 1.0, None).driving.joints_mm


@pytest.mark.tiers(slow=["space-0"], rest="long")
@pytest.mark.parametrize("joint", range(4))
@pytest.mark.parametrize("at_tooth", [True, False], ids=["tooth", "space"])
def test_a_jump_of_the_curvature_in_the_middle_of_a_tooth_or_a_space(joint: int, at_tooth: bool) -> None:
    joints = jumps()
    assert joints.size == 4
    judge(Case(baler_law, 25, advance=float(joints[joint]) + (0.0 if at_tooth else pi / 2.0)))


@pytest.mark.tiers(slow=["0.25"], rest="long")
@pytest.mark.parametrize("share", [0.0, 0.25, 0.5])
def test_a_tooth_that_straddles_convex_and_hollow(share: float) -> None:
    """The inflection in the middle of a tooth, on its flank, in the middle of a space."""
    curve = sized_pair(sine_law(0.25), 48, 1.0, None).driving
    # The driving curve is hollow at phi1 = 0, convex an eighth of the turn on.
    inflection = brentq(
        lambda s: float(curve.at_length(np.array([s])).curvature[0]), 0.0, curve.length_mm / 8.0, xtol=1e-12
    )
    assert 0.0 < inflection < curve.length_mm / 8.0
    judge(Case(lambda: sine_law(0.25), 48, advance=float(inflection) + share * pi))


# --- negative controls -------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("closer", [0.05, -0.05])
def test_another_centre_distance_is_seen(closer: float) -> None:
    """A twentieth of a millimetre: the flanks overlap by it times sin(20 degrees), or gape as much."""
    pitch, pair = CASES["8:40"].made()
    phi1 = np.linspace(0.0, 2.0 * pi, 98)
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    phi2 = pitch.transmission.driven_angle(phi1).value
    report = meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm - closer).report(97)
    tolerance = CASES["8:40"].tolerance_mm
    assert (report.overlap_depth if closer > 0.0 else report.gap).max() > 2.0 * tolerance


@pytest.mark.slow
def test_another_law_is_seen() -> None:
    pitch, pair = CASES["3:1"].made()
    phi1 = np.linspace(0.0, pitch.driving.turn_rad, 98)
    phi2 = pitch.transmission.driven_angle(phi1).value + 1e-3 * np.sin(phi1)
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    report = meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm).report(97)
    assert report.overlap_depth.max() > 2.0 * CASES["3:1"].tolerance_mm
