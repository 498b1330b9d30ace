"""Torque that reverses: written gears follow the law when pushed, and the law turned by the play when pulled.

Outlines are turned against each other as polygons at angles off any grid, or run as rigid bodies; driven angles come
from a quadrature of the law's formula (see oracles/reversing.py and oracles/rigid_body.py).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import ceil, pi, radians
from typing import Any

import numpy as np
import pytest
from mpmath import mp

import ncgear.teeth.gear
from drives import drive, loaded
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.backlash import play_of
from ncgear.teeth.flank import Flanks, flanks_of
from ncgear.teeth.form import Backlash, BasicRack, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from ncgear.teeth.tool import Tool
from oracles import laws, rigid_body
from oracles.reversing import Freedom, Outlines, Positions, golden, of_harmonics, of_ratio, of_spline
from pairs import pitch_pair, rack, sine_law

Array = np.ndarray

POSITIONS = 400

# --- cases -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """Pitch curves and form of a pair, and the law's positions by its formula."""

    pitch: PitchPair
    form: ToothForm
    at: Positions

    @property
    def ring(self) -> bool:
        """Whether the driven gear is a ring."""
        return self.pitch.mesh is Mesh.INTERNAL

    @property
    def play_rad(self) -> float:
        """The play that is asked for."""
        return play_of(self.pitch, self.form.rack, self.form.backlash).driven_rad

    def every(self, step: int) -> Positions:
        """Every so many-th of the positions."""
        return Positions(self.at.phi1[::step], self.at.phi2[::step], self.at.slope[::step], self.at.bend[::step])

    def outlines(self, tolerance: float) -> Outlines:
        """The outlines with chords of a tolerance in mm."""
        return self.outlines_of(toothed_pair(self.pitch, self.form, tolerance))

    def outlines_of(self, teeth: ToothedPair) -> Outlines:
        """The outlines of teeth at this centre distance."""
        distance = self.pitch.center_distance_mm
        return Outlines(teeth.driving.outline_mm, teeth.driven.outline_mm, distance, self.ring)


def form_of(backlash_mm: float, module: float = 2.0) -> ToothForm:
    return ToothForm(rack(module=module), limits=TipLimits(0.2 * module), backlash=Backlash(backlash_mm))


def baler_positions() -> Positions:
    """The three-segment stroke, inverted with many digits."""
    # A start from which the search for the return that closes comes to it.
    law = laws.law(loaded("baler").data, (-10.0, 0.0))
    phi1 = golden(POSITIONS, 2.0 * pi)
    phi2, slope, bend = np.array([[float(value) for value in law.motion(mp.mpf(phi))] for phi in phi1.tolist()]).T
    return Positions(phi1, phi2, slope, bend)


def optimised_positions(name: str) -> Positions:
    """Those of a law by splines or by harmonics."""
    motion, places = loaded(name).data["motion"], golden(POSITIONS, 2.0 * pi)
    if motion["law"] == "spline_ratio":
        return of_spline(motion["ratio"], places)
    return of_harmonics(motion["cosine"], motion["sine"], places)


def elliptical_positions(e: float, phase: float) -> Positions:
    """r1 = (1 - e^2) / (1 + e cos(phi1 - phase)) on axes 2 apart."""
    scale = 2.0 / (1.0 - e**2)
    return of_ratio(
        lambda phi: scale * (1.0 + e * np.cos(phi - phase)) - 1.0,
        lambda phi: -scale * e * np.sin(phi - phase),
        golden(POSITIONS, 2.0 * pi),
    )


def ring_positions(depth: float) -> Positions:
    phi1 = golden(POSITIONS, 4.0 * pi)
    return of_ratio(lambda phi: 2.0 + depth * np.cos(phi), lambda phi: -depth * np.sin(phi), phi1, (1, 2))


def sine_positions(depth: float) -> Positions:
    phi = golden(POSITIONS, 2.0 * pi)
    cosine, sine = np.cos(2.0 * phi), np.sin(2.0 * phi)
    return Positions(phi, phi - depth * sine, 1.0 - 2.0 * depth * cosine, 4.0 * depth * sine)


def deep_ring() -> PitchPair:
    """Its tips used to touch far from the line of centres when the gears took up their backlash."""
    law = ratio_expression_law("2 + 0.5*cos(phi)", Lobes(1, 2), scale_to_close=True)
    return sized_pair(law, 40, 2.0, None, Mesh.INTERNAL)


def worked(name: str, at: Callable[[], Positions], backlash_mm: float = 0.05) -> Case:
    """A worked design with another backlash; of helical teeth the section at z = 0."""
    pitch = drive(name).pitch
    form = drive(name).tooth_form if drive(name).helix is None else form_of(backlash_mm, pitch.size.module_mm)
    return Case(pitch, replace(form, backlash=Backlash(backlash_mm)), at())


CASES: dict[str, Callable[[], Case]] = {
    "baler": lambda: worked("baler", baler_positions),
    "baler-66": lambda: worked("baler-66", lambda: optimised_positions("baler-66")),
    "ellipse": lambda: worked("ellipse", lambda: elliptical_positions(0.35, radians(200.0)), 0.06),
    "helical-ellipse": lambda: worked("helical-ellipse", lambda: elliptical_positions(0.3, pi)),
    "internal-1-2": lambda: worked("internal-1-2", lambda: ring_positions(0.4)),
    "deep ring": lambda: Case(deep_ring(), form_of(0.05), ring_positions(0.5)),
    "deep sine": lambda: Case(pitch_pair(sine_law(0.3), 60), form_of(0.05), sine_positions(0.3)),
    "deep sine, 0.1 mm": lambda: Case(pitch_pair(sine_law(0.3), 60), form_of(0.1), sine_positions(0.3)),
    "sine": lambda: Case(pitch_pair(sine_law(0.1), 30), form_of(0.05), sine_positions(0.1)),
}


@cache
def case_of(name: str) -> Case:
    return CASES[name]()


# --- polygons ----------------------------------------------------------------------------------------------------

OVERLAP = 0.1
"""Overlap that is let pass, in chord tolerances: chords stray into the material, but joints of curves are on them."""


@dataclass(frozen=True)
class Strayed:
    """How far flanks as written are off where they should touch, along their normals in chord tolerances, (n,) each.

    Positive where there is room left.
    """

    pushing: Array
    idle: Array

    @property
    def within_chords(self) -> bool:
        """Whether chords explain all: each of two outlines is off by a tolerance at most, and into its own material."""
        both = np.concatenate([self.pushing, self.idle])
        return bool(both.min() >= -OVERLAP and both.max() <= 2.0)


def strayed(case: Case, outlines: Outlines, tolerance: float, step: int = 1) -> Strayed:
    """Pushing flanks are held against the law, and idle ones against the law turned by the play."""
    at, play = case.every(step), case.play_rad
    free: Freedom = outlines.freedom(at, play / 2.0, max(2.0 * play, 1e-3))
    pushing, idle = at.levers(case.pitch.center_distance_mm, case.form.rack.pressure_angle_rad, ring=case.ring)
    return Strayed(free.back * pushing / tolerance, (free.on - play) * idle / tolerance)


@pytest.mark.judges("ratio")
@pytest.mark.slow
def test_formulas_give_the_law() -> None:
    """Two computations that share nothing; the judge is as good as its angles."""
    for name in ("ellipse", "internal-1-2", "deep ring", "deep sine", "baler-66"):
        case = case_of(name)
        driven = case.pitch.transmission.driven_angle(case.at.phi1, 2)
        assert driven.value == pytest.approx(case.at.phi2, abs=1e-12)
        assert driven.derivative(1) == pytest.approx(case.at.slope, rel=1e-10)
        assert driven.derivative(2) == pytest.approx(case.at.bend, rel=1e-8, abs=1e-8)


@pytest.mark.tiers(slow=["internal-1-2"], rest="long")
@pytest.mark.parametrize("name", CASES)
def test_written_gears_follow_the_law_both_ways(name: str) -> None:
    case = case_of(name)
    step = 10 if name == "sine" else 1
    assert strayed(case, case.outlines(0.01), 0.01, step).within_chords


@pytest.mark.tiers(
    slow=[
        "baler-0.001",
        "ellipse-0.003",
        "helical-ellipse-0.003",
        "internal-1-2-0.001",
        "deep sine-0.003",
        "sine-0.003",
    ],
    rest="long",
)
@pytest.mark.parametrize("tolerance", [0.003, 0.001])
@pytest.mark.parametrize("name", [name for name in CASES if name != "deep sine, 0.1 mm"])
def test_finer_chords_leave_a_more_even_play(name: str, tolerance: float) -> None:
    """The same bounds, in the finer tolerance."""
    case = case_of(name)
    assert strayed(case, case.outlines(tolerance), tolerance, 13).within_chords


@pytest.mark.tiers(slow=["0.0"], rest="long")
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_written_gears_follow_the_law_whoever_takes_off_the_play(share: float) -> None:
    case = case_of("deep sine")
    form = replace(case.form, backlash=replace(case.form.backlash, driving_share=share))
    shared = replace(case, form=form)
    assert shared.play_rad == case.play_rad
    assert strayed(shared, shared.outlines(0.01), 0.01, 8).within_chords


def other_flanks(*, turned: bool) -> Callable[..., Flanks]:
    """Flanks of which the driven ones stand where those without play do, with or without the turning."""

    def made(
        curve: PitchCurve,
        rack: BasicRack,
        teeth: int,
        tool: Tool,
        start: float,
        widths: tuple[float, float],
        turn: float = 0.0,
        **more: Any,
    ) -> Flanks:
        if curve.gear is Gear.DRIVEN:
            widths, turn = (widths[1], widths[1]), turn if turned else 0.0
        return flanks_of(curve, rack, teeth, tool, start, widths, turn, **more)

    return made


@pytest.mark.tiers(slow=["False-0.00095-0.00268"], rest="long")
@pytest.mark.parametrize(("turned", "least", "largest"), [(False, 0.95e-3, 2.68e-3), (True, 3.1e-3, 3.94e-3)])
def test_flanks_set_back_along_the_curve_leave_an_uneven_play(
    monkeypatch: pytest.MonkeyPatch, *, turned: bool, least: float, largest: float
) -> None:
    """Negative controls on the baler: all of 0.05 mm set back instead of turned, or both."""
    monkeypatch.setattr(ncgear.teeth.gear, "flanks_of", other_flanks(turned=turned))
    share = 0.5 if turned else 1.0
    case = case_of("baler")
    case = replace(case, form=replace(case.form, backlash=Backlash(0.05, driving_share=share)))
    outlines, at = case.outlines(0.001), case.every(5)
    free = outlines.freedom(at, 2e-4, 8e-3)
    play = free.on + free.back
    assert (play.min(), play.max()) == pytest.approx((least, largest), rel=0.05)
    assert not strayed(case, outlines, 0.001, 5).within_chords


def test_gears_that_touch_nowhere_are_free_up_to_the_reach() -> None:
    """The search itself, on circles of 10 mm in 30 mm and beside each other."""
    circle = 10.0 * np.stack([np.cos(golden(60, 2.0 * pi)), np.sin(golden(60, 2.0 * pi))], axis=1)
    at = Positions(*np.ones((4, 3)))
    for outlines in (Outlines(circle, 3.0 * circle, 5.0, ring=True), Outlines(circle, circle, 25.0)):
        free = outlines.freedom(at, 0.0, 0.01)
        assert np.isinf(free.on).all()
        assert np.isinf(free.back).all()
        assert outlines.overlap(at).max() == 0.0
    for outlines in (Outlines(circle, 3.0 * circle, 21.0, ring=True), Outlines(circle, circle, 19.0)):
        assert np.isnan(outlines.freedom(at, 0.0, 0.01).on).all()
        assert outlines.overlap(at) == pytest.approx(1.0, rel=0.06)


# --- rigid bodies ------------------------------------------------------------------------------------------------

STEPS, DRAG, REVERSALS = 4000, 3.0, 4

SETTLED = 0.25
"""Driving angle in rad after a reversal from which the sides count as changed: a torque of 3 per rad/s and moment of
inertia takes the driven gear through a play of 3e-3 rad in 0.05 s, at 1 rad/s; it does not bounce."""


def turns_with_reversals(case: Case, outlines: Outlines) -> tuple[Array, Array]:
    """How far the driven body is ahead of the law where it is pushed, and where it is pulled."""
    pieces = rigid_body.convex_pieces(outlines.driving), rigid_body.convex_pieces(outlines.driven)
    part = 2.0 * pi / (2 * REVERSALS)
    transmission = case.pitch.transmission
    turning = rigid_body.turned(
        pieces,
        outlines.distance,
        float(transmission.driven_angle(np.zeros(1), 1).derivative(1)[0]),
        DRAG,
        STEPS,
        drag_share=lambda angle: -1.0 if ceil(angle / part) % 2 == 0 else 1.0,
    )
    ahead = -rigid_body.lag(turning, lambda phi1: transmission.driven_angle(phi1).value)
    settled = np.mod(turning.driving, part) > SETTLED
    pulled = np.ceil(turning.driving / part) % 2 == 0
    return ahead[settled & ~pulled], ahead[settled & pulled]


def room_of_bodies(case: Case, tolerance: float) -> float:
    """What chords, slop and steps explain, in rad (see test_rigid_body.py)."""
    pushing, idle = case.at.levers(case.pitch.center_distance_mm, case.form.rack.pressure_angle_rad, ring=case.ring)
    lever = min(pushing.min(), idle.min())
    return float((2.0 * tolerance + rigid_body.SLOP) / lever + 3.0 * (DRAG + 1.0) * (2.0 * pi / STEPS) ** 2)


@pytest.mark.tiers(slow=["sine"], rest="long")
@pytest.mark.parametrize("name", ["sine", "helical-ellipse"])
def test_driven_body_follows_the_law_pushed_and_pulled(name: str) -> None:
    tolerance, case = 0.003, case_of(name)
    pushed, pulled = turns_with_reversals(case, case.outlines(tolerance))
    room = room_of_bodies(case, tolerance)
    assert pushed.size > 1000
    assert pulled.size > 1000
    assert np.abs(pushed).max() <= room
    assert np.abs(pulled - case.play_rad).max() <= room
    # Neither side alone would do: the play is far more than what is let pass.
    assert case.play_rad > 3.0 * room


@pytest.mark.slow
def test_pulled_body_is_off_the_law_where_flanks_are_set_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: pushed it follows the law all the same."""
    tolerance, case = 0.003, case_of("helical-ellipse")
    case = replace(case, form=replace(case.form, backlash=Backlash(0.05, driving_share=1.0)))
    monkeypatch.setattr(ncgear.teeth.gear, "flanks_of", other_flanks(turned=False))
    pushed, pulled = turns_with_reversals(case, case.outlines(tolerance))
    room = room_of_bodies(case, tolerance)
    assert np.abs(pushed).max() <= room
    assert np.ptp(pulled) > 2.0 * room
