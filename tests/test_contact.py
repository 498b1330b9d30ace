"""Contact of flanks and of outlines: closed forms of circular pairs, shapely's judgement, and pairs that must fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import cos, floor, lcm, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from shapely import Polygon

from ncgear.contact.flank_contact import FlankContact, flank_contact
from ncgear.contact.outline_contact import OutlineContact, outline_contact, positions
from ncgear.contact.pair_contact import BEYOND, pair_contact
from ncgear.design.load import load
from ncgear.drive import Drive
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from oracles import meshing
from pairs import rack

MODULE = 2.0
TOLERANCE = 0.005
BALER = Path(__file__).parents[1] / "designs" / "baler.yaml"
ALPHA = radians(20.0)

Array = np.ndarray
Made = tuple[PitchPair, ToothedPair]

LAWS: dict[str, Callable[[], Transmission]] = {
    "uniform": lambda: uniform_law(Lobes()),
    "uniform 1:2": lambda: uniform_law(Lobes(1, 2)),
    "uniform 3:2": lambda: uniform_law(Lobes(3, 2)),
    "ellipse": lambda: elliptical_law(0.35, 0.0, Lobes()),
    "sine": lambda: driven_angle_expression_law("phi - 0.08*sin(2*phi)", Lobes()),
    "baler": lambda: Drive(load(BALER).design).transmission,
}


@cache
def made(
    name: str, teeth: int, tolerance: float = TOLERANCE, backlash_mm: float = 0.0, angle_deg: float = 20.0
) -> Made:
    """Pitch curves and teeth."""
    law = LAWS[name]()
    pitch = sized_pair(law, teeth, MODULE, None)
    return pitch, toothed_pair(pitch, ToothForm(rack(angle_deg, backlash_mm=backlash_mm)), tolerance)


def play(pair: Made, phi1: Array, ahead_rad: float = 0.0, apart_mm: float = 0.0) -> OutlineContact:
    """Contact of the outlines with the driven gear turned on, or the centre distance enlarged."""
    pitch, teeth = pair
    basic = teeth.driving.flanks.rack
    angle = pitch.transmission.driven_angle(phi1, 1)
    slope = angle.derivative(1)
    return outline_contact(
        teeth.driving.outline_mm,
        teeth.driven.outline_mm,
        pitch.center_distance_mm + apart_mm,
        BEYOND * basic.dedendum_mm / sin(basic.pressure_angle_rad),
        phi1,
        angle.value + ahead_rad,
        pitch.center_distance_mm * slope / (1.0 + slope),
    )


def turn(count: int = 401) -> Array:
    """Driving angles over a turn; the default is prime, so it does not keep step with the teeth."""
    return np.arange(count) * (2.0 * pi / count)


def least_driven_radius(pitch: PitchPair) -> float:
    """Smallest pitch radius of the driven gear."""
    return pitch.center_distance_mm / (1.0 + pitch.transmission.slope_range[1].value)


# --- outlines against shapely ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["uniform", "ellipse", "sine", "baler"])
@pytest.mark.parametrize("ahead_rad", [0.0, 0.0005])
def test_play_is_what_shapely_finds(name: str, ahead_rad: float) -> None:
    pair = made(name, 25, backlash_mm=0.05)
    phi1 = turn()
    outlines = [Polygon(gear.outline_mm) for gear in (pair[1].driving, pair[1].driven)]
    phi2 = pair[0].transmission.driven_angle(phi1).value + ahead_rad
    judge = meshing.Pair(*outlines, phi1, phi2, pair[0].center_distance_mm)
    own = play(pair, phi1, ahead_rad)
    for row in (0, 37, 150, 251, 333):
        expected = judge.driven_play(row, tolerance=1e-7)
        # The judge allows 1e-7 mm of overlap, 1e-8 rad at the smallest base radius with the bisection's 1e-9.
        assert (own.backward_rad[row], own.forward_rad[row]) == pytest.approx(expected, abs=2e-8)


def test_tips_that_stand_square_on_the_line_of_centres_are_no_play_at_all() -> None:
    """There a chord of the tip land runs along the circles on which vertices are followed."""
    pair = made("sine", 200)
    found = play(pair, positions(200, 200))
    worst = np.abs([found.forward_rad, found.backward_rad]).max()
    # Both outlines off by the tolerance along the normal, at the base radius of the driven gear's shortest radius.
    assert worst < 2.0 * TOLERANCE / (least_driven_radius(pair[0]) * cos(ALPHA))


@pytest.mark.parametrize("name", ["uniform", "sine", "baler"])
@pytest.mark.parametrize("ahead_rad", [0.01, -0.01])
def test_driven_gear_turned_too_far_overlaps(name: str, ahead_rad: float) -> None:
    pair, phi1 = made(name, 25), turn()
    free, forced = play(pair, phi1), play(pair, phi1, ahead_rad)
    pressed, before = (
        (forced.forward_rad, free.forward_rad) if ahead_rad > 0 else (forced.backward_rad, free.backward_rad)
    )
    assert pressed.max() < 0.0
    # The play that is missing is the angle turned, and the depth an arc no longer than that at the tip.
    assert np.median(before - pressed) == pytest.approx(0.01, rel=1e-6)
    radius = np.hypot(*pair[1].driven.outline_mm.T).max()
    assert forced.penetration_mm.min() > 0.0
    assert 0.2 * 0.01 * radius < forced.largest_penetration_mm < 1.05 * 0.01 * radius


@pytest.mark.parametrize("name", ["uniform", "ellipse", "sine", "baler"])
def test_centre_distance_too_small_overlaps(name: str) -> None:
    pair = made(name, 25)
    near = play(pair, turn(), apart_mm=-0.1)
    # A tenth nearer costs each flank 0.1 sin(alpha) along its normal, less what the chords leave free.
    assert near.penetration_mm.min() > 0.0
    assert near.largest_penetration_mm > 10.0 * max(play(pair, turn()).largest_penetration_mm, 1e-4)
    total = near.forward_rad + near.backward_rad
    assert total.max() < 0.0


def test_play_of_a_nearer_circular_pair_is_the_closed_form() -> None:
    """2 (r1 + r2) (inv(work) - inv(alpha)) / r2 at the working pressure angle of the other centre distance."""
    pair = made("uniform", 25, 2e-4)
    for apart in (-0.05, 0.05, 0.2):
        work = np.arccos(50.0 * cos(ALPHA) / (50.0 + apart))
        expected = 2.0 * 50.0 * ((np.tan(work) - work) - (np.tan(ALPHA) - ALPHA)) / 25.0
        found = play(pair, turn(97), apart_mm=apart)
        # Both outlines leave up to the tolerance free on either side: 4 x 2e-4 mm at the base radius.
        error = found.forward_rad + found.backward_rad - expected
        assert np.abs(error).max() < 4 * 2e-4 / (25.0 * cos(ALPHA))


# --- circular pairs in closed form -------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "teeth"), [("uniform", 25), ("uniform 1:2", 24), ("uniform 3:2", 30)])
def test_transmission_error_of_exact_flanks_vanishes_with_the_tolerance(name: str, teeth: int) -> None:
    tolerances = 1e-2 * 10.0 ** -np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    errors = []
    for tolerance in tolerances:
        pitch, pair = made(name, teeth, tolerance)
        found = play((pitch, pair), turn(199))
        base = least_driven_radius(pitch) * cos(ALPHA)
        assert found.transmission_error_rad <= 2.0 * tolerance / base
        assert found.largest_penetration_mm == 0.0  # chords of convex flanks lie inside the teeth
        errors.append(found.transmission_error_rad)
    # Linear, with the scatter of whole numbers of chords and of where the positions fall on them.
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.2)
    assert errors[-1] < errors[0] / 25.0


@pytest.mark.parametrize("name", ["ellipse", "sine", "baler"])
def test_transmission_error_of_non_circular_pairs_vanishes_too(name: str) -> None:
    tolerances = np.array([2e-2, 4e-3, 8e-4])
    errors = [play(made(name, 25, t), turn()).transmission_error_rad for t in tolerances]
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.25)


def straight_sided(name: str, teeth: int) -> Made:
    """A tolerance so coarse that every curve is one chord."""
    return made(name, teeth, 10.0)


@pytest.mark.parametrize("name", ["uniform", "ellipse", "sine", "baler"])
def test_straight_sided_teeth_do_not_pass_for_conjugate_ones(name: str) -> None:
    """Negative control: the bound that sampled exact flanks keep is missed by flanks replaced by their chords."""
    pitch, _ = made(name, 25)
    # Both outlines off by the tolerance along the normal, at the base radius of the driven gear's shortest radius.
    bound = 2.0 * TOLERANCE / (least_driven_radius(pitch) * cos(ALPHA))
    assert play(made(name, 25), turn()).transmission_error_rad < bound
    assert play(straight_sided(name, 25), turn()).transmission_error_rad > 20.0 * bound


@pytest.mark.parametrize("backlash", [0.02, 0.1, 0.2])
def test_play_of_a_circular_pair_is_its_backlash_angle(backlash: float) -> None:
    """jn / (r2 cos(alpha)), half of it to either side of the law's position."""
    tolerance = 2e-4
    pair = made("uniform 1:2", 24, tolerance, backlash)
    base = 48.0 * cos(ALPHA)
    found = play(pair, turn(199))
    for way in (found.forward_rad, found.backward_rad):
        assert way.min() >= backlash / 2.0 / base - 1e-12  # chords only ever leave more room
        assert way.max() <= (backlash / 2.0 + 2.0 * tolerance) / base


# --- exact flanks ------------------------------------------------------------------------------------------------


def transverse_contact_ratio(first: float, second: float, angle: float) -> float:
    """Of a circular pair without undercut, from tip and base radii: ISO 21771."""
    radii = np.array([first, second]) * MODULE / 2.0
    base, tip = radii * cos(angle), radii + MODULE
    length = np.sum(np.sqrt(tip**2 - base**2)) - np.sum(radii) * sin(angle)
    return float(length / (pi * MODULE * cos(angle)))


@pytest.mark.parametrize(
    ("name", "teeth", "angle_deg"),
    [
        ("uniform", 18, 20.0),
        ("uniform", 25, 20.0),
        ("uniform", 40, 20.0),
        ("uniform 1:2", 24, 20.0),
        ("uniform 3:2", 30, 20.0),
        ("uniform", 100, 14.5),
        ("uniform", 36, 14.5),
    ],
)
def test_contact_of_a_circular_pair_is_the_closed_form(name: str, teeth: int, angle_deg: float) -> None:
    pitch, pair = made(name, teeth, 0.05, angle_deg=angle_deg)
    expected = transverse_contact_ratio(teeth, pitch.size.driven_teeth, radians(angle_deg))
    found = flank_contact(pair)
    assert found.least_ratio == pytest.approx(expected, abs=1e-9)
    assert found.least_simultaneous == floor(expected)


def test_some_pairs_have_two_teeth_in_contact_always() -> None:
    """So that the test above saw more than ones."""
    assert floor(transverse_contact_ratio(100, 100, radians(14.5))) == 2


def test_undercut_shortens_contact() -> None:
    """12 teeth: the flank ends above its base circle, where the cusp was; contact then ends there, not at the tip."""
    _, pair = made("uniform", 12)
    _, bottom = pair.driving.sides.flank_range()
    assert np.ptp(bottom) < 1e-9
    assert bottom[0] > -12.0 * sin(ALPHA) ** 2
    # Mates touch between -low and low: both flanks end at the same depth and their tips reach farther.
    expected = -2.0 * bottom[0] / (sin(ALPHA) * cos(ALPHA)) / (pi * MODULE)
    assert flank_contact(pair).least_ratio == pytest.approx(expected, abs=1e-9)
    assert expected < transverse_contact_ratio(12, 12, ALPHA)


@dataclass(frozen=True)
class FlankPair:
    """A driving flank, one of its mates found by where both cross the pitch curves, and the heights both still have."""

    crossing_mm: float
    side: float
    low_mm: float
    high_mm: float


def flank_pairs(pair: Made) -> tuple[list[FlankPair], float]:
    """All pairs of flanks that meet in a meeting cycle, and the cycle's length."""
    driving, driven = pair[1].driving, pair[1].driven
    turns = lcm(driving.teeth, driven.teeth) // driving.teeth
    (top, bottom), (other_top, other_bottom) = (gear.sides.flank_range() for gear in (driving, driven))
    own, other = driving.flanks, driven.flanks
    found = []
    for number, cross in enumerate(own.crossing_mm):
        for crossing in cross + np.arange(turns) * own.curve.length_mm:
            gap = np.abs(np.mod(other.crossing_mm - crossing + 1.0, other.curve.length_mm) - 1.0)
            mate = int(np.argmin(gap))
            assert gap[mate] < 1e-6
            low, high = max(bottom[number], -other_top[mate]), min(top[number], -other_bottom[mate])
            found.append(FlankPair(crossing, own.side[number], low, high))
    return found, turns * own.curve.length_mm


def counted(pair: Made, sigma: Array) -> int:
    """Least number of flank pairs that touch at rolled lengths, by asking each in turn; the worse side of the teeth."""
    pairs, cycle = flank_pairs(pair)
    totals = {1.0: np.zeros(sigma.size, dtype=int), -1.0: np.zeros(sigma.size, dtype=int)}
    for one in pairs:
        ahead = np.mod(one.crossing_mm - sigma + cycle / 2.0, cycle) - cycle / 2.0
        height = one.side * ahead * sin(ALPHA) * cos(ALPHA)
        totals[one.side] += (height >= one.low_mm) & (height <= one.high_mm)
    return int(min(total.min() for total in totals.values()))


@pytest.mark.parametrize(("name", "teeth"), [("uniform", 18), ("ellipse", 37), ("sine", 25), ("baler", 86)])
def test_least_number_in_contact_is_what_counting_finds(name: str, teeth: int) -> None:
    pair = made(name, teeth)
    sigma = np.linspace(0.0, pair[0].driving.length_mm, 40 * teeth, endpoint=False)
    assert counted(pair, sigma) == flank_contact(pair[1]).least_simultaneous == 1


@pytest.mark.parametrize(("name", "teeth"), [("uniform 3:2", 30), ("ellipse", 37), ("sine", 25), ("baler", 86)])
def test_least_contact_ratio_is_that_of_the_worst_pair_of_flanks(name: str, teeth: int) -> None:
    pair = made(name, teeth)
    arcs = [one.high_mm - one.low_mm for one in flank_pairs(pair)[0]]
    expected = min(arcs) / (sin(ALPHA) * cos(ALPHA)) / (pi * MODULE)
    assert flank_contact(pair[1]).least_ratio == pytest.approx(expected, rel=1e-12)


def test_counting_sees_the_gap_in_the_undercut_balers_contact() -> None:
    pair = made("baler", 25)
    sigma = np.linspace(0.0, pair[0].driving.length_mm, 5000, endpoint=False)
    found = flank_contact(pair[1])
    assert counted(pair, sigma) == found.least_simultaneous == 0
    assert found.least_ratio < 1.0


@pytest.mark.parametrize("name", ["ellipse", "sine"])
def test_contact_ratio_of_mild_curves_is_near_that_of_circles(name: str) -> None:
    """The sharpest stretch has the least, like a circular gear of its radius of curvature against a rack or less."""
    found = flank_contact(made(name, 37)[1])
    assert transverse_contact_ratio(18, 18, ALPHA) < found.least_ratio < transverse_contact_ratio(60, 60, ALPHA)


def test_backlash_takes_nothing_off_the_contact_of_flanks() -> None:
    """Flanks of thinner teeth pass the pitch curve elsewhere, but end at the same depth and the same tip circles."""
    exact = transverse_contact_ratio(25, 25, ALPHA)
    assert flank_contact(made("uniform", 25, TOLERANCE, 0.1)[1]) == FlankContact(pytest.approx(exact, abs=1e-9), 1)


# --- positions ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("driving", "driven", "turns", "count"),
    [(25, 25, 1.0, 500), (24, 48, 2.0, 960), (30, 20, 2.0, 1200), (8, 8, 1.0, 400), (17, 19, 19.0, 6460)],
)
def test_positions_cover_a_meeting_cycle_evenly(driving: int, driven: int, turns: float, count: int) -> None:
    phi1 = positions(driving, driven)
    step = np.diff(phi1)
    assert phi1.size == count
    assert phi1[0] == 0.0
    assert step == pytest.approx(2.0 * pi * turns / count, rel=1e-9)
    assert phi1[-1] + step[0] == pytest.approx(2.0 * pi * turns, rel=1e-12)
    # Every pair of teeth that can meet does, and at 20 positions of its own.
    meeting = np.floor(phi1 / (2.0 * pi / driving) + 1e-9).astype(int)
    pairs = set(zip((meeting % driving).tolist(), (meeting % driven).tolist(), strict=True))
    assert len(pairs) == lcm(driving, driven)
    assert np.bincount(meeting).min() >= 20


def test_pair_contact_takes_those_positions_and_both_measures() -> None:
    pitch, pair = made("uniform 1:2", 24)
    found = pair_contact(pitch, pair)
    assert np.array_equal(found.outlines.phi1_rad, positions(24, 48))
    assert found.flanks == flank_contact(pair)
    error = np.ptp(play((pitch, pair), positions(24, 48)).backward_rad)
    assert found.outlines.transmission_error_rad == pytest.approx(error, rel=1e-9)
