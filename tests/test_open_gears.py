"""Gears that turn less than once: laws over a range, their continuation, teeth and heels, contact from end to end.

The judge of teeth is brute force: both outlines as polygons, turned by the law at positions of the golden ratio.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import degrees, exp, hypot, log, pi, radians
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mpmath import mp
from shapely import Polygon, affinity

from at_once import at_once
from drives import built, drive, drive_of_text
from ncgear.contact.designed.as_designed import AsDesigned, as_designed
from ncgear.contact.pair import short_contacts
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines, as_written, reach_mm
from ncgear.drawings.scene.scene import scene_of
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.figures.advice.given_advice import without_effect
from ncgear.figures.assembly import assembly_of
from ncgear.pitch import continued, shape
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.expression import open_driven_angle_law, open_ratio_law
from ncgear.ratio.laws.function_generator import generated_function
from ncgear.ratio.laws.spiral import logarithmic_spirals
from ncgear.ratio.transmission import Transmission, WholeTurns
from ncgear.teeth.form import BasicRack, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from ncgear.teeth.outline import whole_curves
from pairs import rack

TOLERANCE_MM = 0.01
GOLDEN = (5.0**0.5 - 1.0) / 2.0


def golden(end: float, count: int) -> np.ndarray:
    """Places from 0 to an end that no pattern of the program can share, and both ends."""
    return np.concatenate([[0.0, end], end * np.mod(GOLDEN * np.arange(1, count), 1.0)])


def spiral(start: float, end: float, range_deg: float) -> Transmission:
    return logarithmic_spirals(start, end, radians(range_deg))


def generator(text: str, first: float, last: float, driving_deg: float, driven_deg: float) -> Transmission:
    return generated_function(text, (first, last), radians(driving_deg), radians(driven_deg))


LAWS = {
    "spiral": lambda: spiral(1.6, 0.7, 200.0),
    "long spiral": lambda: spiral(1.05, 0.95, 325.0),
    "short steep spiral": lambda: spiral(1.6, 0.9, 20.0),
    "rising spiral": lambda: spiral(0.6, 1.8, 250.0),
    "log": lambda: generator("log(x)", 1.0, 10.0, 300.0, 175.0),
    "square": lambda: generator("x**2", 0.5, 1.5, 180.0, 200.0),
    "falling": lambda: generator("1/x", 1.0, 3.0, 220.0, 180.0),
    "wavy": lambda: generator("x + 0.15*sin(3*x)", 0.0, 3.0, 260.0, 240.0),
    "formula": lambda: open_ratio_law("1.2 + 0.3*cos(phi)", radians(270.0)),
    "driven angle": lambda: open_driven_angle_law("phi + 0.2*sin(phi)", radians(190.0)),
}
MODULES = {"long spiral": 1.0, "short steep spiral": 1.0, "log": 1.0, "square": 1.5}


@cache
def law(name: str) -> Transmission:
    return LAWS[name]()


@cache
def pitch(name: str) -> PitchPair:
    return sized_pair(law(name), None, MODULES.get(name, 2.0), 110.0)


def form(module: float) -> ToothForm:
    return ToothForm(rack(module=module))


@cache
def teeth(name: str) -> ToothedPair:
    return toothed_pair(pitch(name), form(pitch(name).size.module_mm), TOLERANCE_MM)


@cache
def contact(name: str) -> AsDesigned:
    return as_designed(teeth(name), placed(pitch(name)))


every_law = pytest.mark.parametrize("name", LAWS)


# --- laws


@pytest.mark.slow
def test_spirals_have_one_pressure_angle_and_roll_on_each_other() -> None:
    """m = ln(r1 end / r1 start) / phi1 everywhere; the driven curve falls as exp(-m phi2); closed-form lengths."""
    found, turned = law("spiral"), radians(200.0)
    start, end = 1.0 / 2.6, 1.0 / 1.7
    growth = log(end / start) / turned
    phi1 = golden(turned, 60)
    slope = found.driven_angle(phi1, 3).differentiated()
    assert shape.tangent_slope(slope, Mesh.EXTERNAL).value == pytest.approx(np.full(phi1.size, growth), rel=1e-13)
    first, second = (shape.radius(slope, gear, Mesh.EXTERNAL).value for gear in Gear)
    assert first == pytest.approx(start * np.exp(growth * phi1), rel=1e-13)
    phi2 = found.driven_angle(phi1).value
    assert second == pytest.approx(1.0 - first, rel=1e-13)
    curve = pitch("spiral")
    wanted = 110.0 * start * (exp(growth * turned) - 1.0) * hypot(1.0, growth) / growth
    assert [curve.length_mm(gear) for gear in Gear] == pytest.approx([wanted] * 2, rel=1e-13)
    # r2 by its own angle: dr2/dphi2 = (dr2/dphi1) / (dphi2/dphi1).
    by_own = np.gradient(np.log(np.sort(second)[::-1]), np.sort(phi2))
    assert np.median(by_own) == pytest.approx(-growth, rel=0.05)


def test_the_driven_angle_of_spirals_is_the_integral_of_the_inverse_ratio() -> None:
    with mp.workdps(30):
        growth = mp.log(mp.mpf("2.6") / mp.mpf("1.7")) / (mp.pi * 10 / 9)

        def slope(phi: Any) -> Any:
            radius = mp.exp(growth * phi) / mp.mpf("2.6")
            return radius / (1 - radius)

        for phi1 in (1e-9, 0.3, 2.0, radians(200.0)):
            wanted = float(mp.quad(slope, [0, phi1]))
            assert law("spiral").driven_angle(np.array([phi1])).value[0] == pytest.approx(wanted, rel=1e-14)


@pytest.mark.parametrize(("name", "y", "ends"), [("log", mp.log, (1, 10)), ("falling", lambda x: 1 / x, (1, 3))])
def test_function_generators_compute_their_function(name: str, y: Any, ends: tuple[int, int]) -> None:
    covered = law(name).lobes.range
    assert covered is not None
    phi1 = golden(covered.driving_rad, 20)
    first, last = (mp.mpf(end) for end in ends)
    with mp.workdps(30):
        xs = [first + (last - first) * mp.mpf(float(at)) / mp.mpf(covered.driving_rad) for at in phi1]
        wanted = [float(covered.driven_rad * (y(x) - y(first)) / (y(last) - y(first))) for x in xs]
    assert law(name).driven_angle(phi1).value == pytest.approx(wanted, abs=1e-14)
    assert abs(law(name).closure_error_rad) <= 1e-14


@at_once(
    ("text", "ends", "said"),
    [
        ("x**2", (-1.0, 1.0), "rises or falls throughout"),
        ("x**2 - 0.2*x", (-1.0, 2.0), r"stands still or turns round at x = 0\.1:"),
        ("sin(x)", (1.0, 2.5), r"turns round at x = 1\.5708:"),
        ("-sin(2*x)", (0.1, 1.2), r"turns round at x = 0\.785398:"),
        ("x**3", (-1.0, 2.0), r"turns round at x = 0:"),
        ("sqrt(x)", (0.0, 1.0), "not smooth near x = 0"),
        ("abs(x) + 2*x", (-1.0, 1.0), "a corner at x = 0"),
        ("x if x < 1 else x + 1", (0.0, 2.0), "jumps at x = 1, from 1 to 2"),
    ],
)
def test_functions_that_gears_cannot_follow_are_refused_with_their_x(
    text: str, ends: tuple[float, float], said: str
) -> None:
    with pytest.raises(NoSuchMechanism, match=said) as refusal:
        generated_function(text, ends, 2.0, 2.0)
    assert refusal.value.key == "motion.function"


def test_spirals_that_are_circles_are_refused() -> None:
    with pytest.raises(WrongInput, match="circles") as refusal:
        spiral(1.0, 1.0, 90.0)
    assert refusal.value.key == "motion.ratio_end"


# --- the continuation


@pytest.mark.tiers(slow=["spiral", "short steep spiral", "log", "falling", "formula"], rest="long")
@every_law
def test_curves_go_on_to_whole_turns_and_whole_pitches(name: str) -> None:
    found, known = pitch(name).transmission, law(name)
    lobes, toothed = found.lobes, pitch(name).toothed
    assert isinstance(lobes, WholeTurns)
    assert toothed is not None
    assert abs(found.closure_error_rad) <= 1e-12 * lobes.driven_turns
    phi1 = golden(lobes.of.driving_rad, 30)[2:]
    assert found.driven_angle(phi1).value == pytest.approx(known.driven_angle(phi1).value, rel=1e-15)
    for before, after in zip((found.pieces[-1], *found.pieces), found.pieces, strict=False):
        sides = [
            piece.slope(np.array([at]), 3).coefficients[:, 0]
            for piece, at in ((before, before.end_rad), (after, after.start_rad))
        ]
        assert sides[0] == pytest.approx(sides[1], rel=1e-9, abs=1e-9)
    pitches = pitch(name).arc.period * 110.0 / (np.pi * pitch(name).size.module_mm)
    assert pitches == pytest.approx(toothed.around, abs=1e-9)


def test_the_continuation_brings_the_driven_gear_round() -> None:
    """By Gauss-Legendre sums of dphi2/dphi1 over all pieces: whole turns, to rounding."""
    unit, weights = np.polynomial.legendre.leggauss(120)
    for name in ("spiral", "log"):
        whole, turned = pitch(name).transmission, 0.0
        assert isinstance(whole.lobes, WholeTurns)
        for piece in whole.pieces:
            half = (piece.end_rad - piece.start_rad) / 2.0
            turned += half * float(weights @ piece.slope(piece.start_rad + half * (1.0 + unit), 0).value)
        assert turned == pytest.approx(2.0 * pi * round(turned / (2.0 * pi)), abs=1e-12)


@pytest.mark.slow
def test_the_teeth_of_the_range_do_not_depend_on_the_continuation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two continuations of other turns: flanks that are touched within the range are the same to rounding."""
    own = pitch("spiral")
    monkeypatch.setattr(continued, "LEVELLINGS", (0.1,))
    monkeypatch.setattr(continued, "LEVELLING_SHARE", 0.15)
    monkeypatch.setattr(continued, "LEAST_WAY_RAD", 4.0)
    other = sized_pair(law("spiral"), None, 2.0, 110.0)
    assert own.toothed is not None
    assert other.toothed is not None
    assert other.toothed.around != own.toothed.around
    both = [teeth("spiral"), toothed_pair(other, form(2.0), TOLERANCE_MM)]
    covered = own.toothed.covered_mm
    for gear in Gear:
        first, second = (pair.of(gear).flanks for pair in both)
        flank = np.repeat(np.arange(2 * first.teeth), 41)
        height = np.tile(np.linspace(-2.0, 2.0, 41), 2 * first.teeth)
        rolled = first.rolled_mm(flank, height)
        within = (rolled >= 0.0) & (rolled <= covered)
        assert np.count_nonzero(within) > 0.8 * 41 * 2 * (first.teeth - 3)
        points = [flanks.flank(flank[within], height[within])[0] for flanks in (first, second)]
        assert np.abs(points[0] - points[1]).max() <= 1e-11
        assert first.crossing_mm[: 2 * first.teeth] == pytest.approx(second.crossing_mm[: 2 * first.teeth], abs=1e-11)
    # Tips of the last teeth end beyond the range, where the curves differ; all others touch for as long.
    arcs = [found.pushing.pairs.arcs[3:-3] for found in (contact("spiral"), as_designed(both[1], placed(other)))]
    assert arcs[0].size > 20
    assert arcs[0] == pytest.approx(arcs[1], abs=1e-9)


def test_a_law_is_levelled_within_a_way_without_a_jump_of_its_curvature() -> None:
    """From its value, slope, bend and third derivative to none of them, by the polynomial itself."""
    taylor, width = np.array([0.3, -1.2, 0.7, 2.5]), 0.8
    found = np.polynomial.Polynomial(continued._levelling(taylor, width))
    for order, wanted in enumerate((0.3, -1.2, 2.0 * 0.7, 6.0 * 2.5)):
        assert found.deriv(order)(0.0) / width**order == pytest.approx(wanted)
        if order:
            assert found.deriv(order)(1.0) == pytest.approx(0.0, abs=1e-12)


# --- teeth


def brute_force(found: ToothedPair, curves: PitchPair, count: int) -> tuple[float, float]:
    """The largest overlap in mm2 and the largest gap in mm at positions over the range."""
    covered = curves.transmission.lobes.range
    assert covered is not None
    bodies = [Polygon(found.of(gear).outline_mm) for gear in Gear]
    phi1 = golden(covered.driving_rad, count)
    overlap, gap = 0.0, 0.0
    for first, second in zip(phi1, curves.transmission.driven_angle(phi1).value, strict=True):
        driving = affinity.rotate(bodies[0], first, origin=(0, 0), use_radians=True)
        driven = affinity.rotate(bodies[1], -second, origin=(0, 0), use_radians=True)
        driven = affinity.translate(driven, curves.center_distance_mm)
        overlap = max(overlap, driving.intersection(driven).area)
        gap = max(gap, driving.distance(driven))
    return overlap, gap


@pytest.mark.judges("teeth")
@pytest.mark.tiers(quick=["spiral", "rising spiral"], rest="slow")
@every_law
def test_outlines_mesh_without_overlap_over_the_whole_range(name: str) -> None:
    found = teeth(name)
    for gear in Gear:
        outline = Polygon(found.of(gear).outline_mm)
        assert outline.is_valid
        assert outline.exterior.is_ccw
        assert found.of(gear).teeth == getattr(pitch(name).size, f"{gear.value}_teeth")
    overlap, gap = brute_force(found, pitch(name), 14)
    # An overlap as deep as the chord tolerance would be this large on a tenth of a module of flank.
    assert overlap <= 0.1 * pitch(name).size.module_mm * TOLERANCE_MM
    assert gap <= 2.0 * TOLERANCE_MM


@pytest.mark.parametrize("name", ["spiral", "rising spiral"])
@pytest.mark.parametrize("gear", list(Gear))
def test_behind_the_last_tooth_are_radial_walls_round_corners_and_a_heel(name: str, gear: Gear) -> None:
    """One closed chain without corners but where walls meet lands; its slopes are those of differences."""
    found, module = teeth(name).of(gear), pitch(name).size.module_mm
    *_, between, before, heel = whole_curves(found.tips, found.sides)
    rows, share = np.arange(heel.owner.size)[:, None], np.linspace(0.0, 1.0, 401)
    point, slope = (array @ [1.0, 1.0j] for array in heel.at(rows, share))
    last = between.kept(between.owner == 2 * found.teeth - 1)
    ends = last.at(np.zeros(1, dtype=int), np.ones(1))[0], before.at(np.zeros(1, dtype=int), np.zeros(1))[0]
    assert [point[0, 0], point[-1, -1]] == pytest.approx([complex(*end[0]) for end in ends], abs=1e-9)
    assert point[1:, 0] == pytest.approx(point[:-1, -1], abs=1e-9)
    assert np.abs(np.angle(slope[1:, 0] / slope[:-1, -1])).max() < 1e-3
    for part, own, rate in zip(heel.owner, point, slope, strict=True):
        assert rate[1:-1] == pytest.approx((own[2:] - own[:-2]) / (2.0 / 400.0), abs=1e-4 * np.abs(rate).max())
        radius = np.abs(own)
        if part in (0, 4):
            assert np.abs(np.angle(own / own[0])).max() < 1e-12
        elif part in (1, 3):
            # Of a module, or of half the wall's height where that is less.
            high, low = (point[0, 0], own[-1]) if part == 1 else (point[-1, -1], own[0])
            rounding = min(module, (abs(high) - abs(low)) / 2.0)
            center = own[0] + 1j * rate[0] / abs(rate[0]) * rounding * (1.0 if gear is Gear.DRIVING else -1.0)
            assert np.abs(own - center) == pytest.approx(np.full(401, rounding), rel=1e-9)
        else:
            assert np.diff(radius) == pytest.approx(np.full(400, (radius[-1] - radius[0]) / 400.0), abs=1e-9)
            assert np.ptp(radius) < 0.25 * module
            assert radius.max() - 1e-9 <= min(abs(point[0, 0]), abs(point[-1, -1])) + 1e-9


def test_a_wrong_angle_is_seen_by_the_judge() -> None:
    """A negative control: pushed on by a fiftieth of a radian, the driven gear runs into the driving one."""
    curves = pitch("spiral")
    pushed = replace(curves, transmission=curves.transmission.made)
    shifted = open_driven_angle_law("1.02*phi", radians(200.0))
    overlap, _ = brute_force(teeth("spiral"), replace(pushed, transmission=shifted), 5)
    assert overlap > 1.0


def made_otherwise(name: str, more: int) -> AsDesigned:
    """The contact of a pair with so many more teeth on the driving gear, or fewer."""
    curves = pitch(name)
    assert curves.toothed is not None
    toothed = replace(curves.toothed, driving_teeth=curves.toothed.driving_teeth + more)
    size = replace(curves.size, driving_teeth=toothed.driving_teeth)
    other = replace(curves, toothed=toothed, size=size)
    return as_designed(toothed_pair(other, form(size.module_mm), TOLERANCE_MM), placed(other))


@pytest.mark.judges("contact")
@pytest.mark.parametrize("name", ["spiral", "log"])
def test_the_teeth_that_are_made_suffice(name: str) -> None:
    """Two more teeth are touched nowhere within the range."""
    found, more = contact(name), made_otherwise(name, 2)
    assert more.contact_ratio == pytest.approx(found.contact_ratio, rel=1e-12)
    for side in ("pushing", "back"):
        touched = getattr(more, side).touching.driving
        assert int(touched.max()) // 2 + 1 <= pitch(name).size.driving_teeth


@pytest.mark.thorough
def test_a_tooth_fewer_at_the_end_loses_contact() -> None:
    """A negative control: without the last two teeth nothing touches at the end of the range."""
    fewer = made_otherwise("spiral", -2)
    short = short_contacts(fewer, teeth("spiral"), 1.0)
    assert short[0] is not None or short[1] is not None
    assert fewer.longest_gap_pitches > 0.05


@pytest.mark.tiers(quick=["spiral", "rising spiral"], rest="slow")
@every_law
def test_contact_goes_from_end_to_end_without_a_gap(name: str) -> None:
    found, covered = contact(name), law(name).lobes.range
    assert covered is not None
    assert found.placement.phi1_rad[[0, -1]] == pytest.approx([0.0, covered.driving_rad], abs=1e-12)
    assert np.all(np.diff(found.placement.rolled_mm) > 0.0)
    assert found.placement.count >= 400
    assert found.pushing.transmission_error_rad <= 1e-12
    assert found.longest_gap_pitches == 0.0
    assert found.pushing.pairs.fewest >= 1
    assert 1.2 < found.least_arc <= 2.0
    assert found.contact_ratio >= found.least_arc - 1.0 / found.pushing.pairs.pitches


@pytest.mark.slow
@pytest.mark.parametrize("name", ["spiral", "log", "wavy"])
def test_written_outlines_touch_where_the_exact_teeth_do(name: str) -> None:
    found, pair = contact(name), teeth(name)
    outlines = Outlines("csv", *(pair.of(gear).outline_mm for gear in Gear))
    written = as_written(outlines, pair, found.placement, reach_mm(pitch(name), pair))
    assert written.overlap_mm.max() <= TOLERANCE_MM
    assert written.transmission_error_rad <= 4.0 * TOLERANCE_MM / pitch(name).radius_range_mm(Gear.DRIVEN)[0]
    module = pitch(name).size.module_mm
    # Gears with concave curves cut each other, with tips that are shortened so as not to foul.
    if name != "wavy":
        # Lands slope: at one end they are nearer to the mate than in the middle.
        assert 0.19 * module <= min(written.driving_tips_mm, written.driven_tips_mm) <= 0.3 * module


@pytest.mark.slow
def test_any_module_suits_any_centre_distance_and_teeth_count_the_pitches_of_the_range() -> None:
    for module in (0.77, 1.9, 3.3):
        curves = sized_pair(law("spiral"), None, module, 110.0)
        assert curves.size.module_mm == module
        assert curves.toothed is not None
        assert curves.size.driving_teeth == pytest.approx(curves.toothed.covered_mm / (np.pi * module) + 2.0, abs=1.3)
    by_teeth = sized_pair(law("spiral"), 30, 2.0, None)
    assert by_teeth.length_mm(Gear.DRIVING) == pytest.approx(30 * 2.0 * np.pi, rel=1e-13)
    with pytest.raises(WrongInput, match="do not fit a centre distance"):
        sized_pair(law("spiral"), 30, 2.0, 100.0)


@pytest.mark.slow
def test_flatter_racks_have_more_teeth_beside_the_range() -> None:
    """At 14.5 deg flanks touch over 1.3 pitches to each side, so a tooth more stands before the range."""
    steep, flat = (sized_pair(law("spiral"), None, 2.0, 110.0, reach_in_pitches=reach) for reach in (1.0, 1.32))
    assert steep.toothed is not None
    assert flat.toothed is not None
    assert (steep.toothed.before, flat.toothed.before) == (1, 2)
    assert flat.size.driving_teeth > steep.size.driving_teeth
    flatter = ToothForm(BasicRack(2.0, radians(14.5), 2.0, 2.5, 0.5))
    found = as_designed(toothed_pair(flat, flatter, TOLERANCE_MM), placed(flat))
    assert found.longest_gap_pitches == 0.0
    assert found.pushing.touching.driving.max() // 2 + 1 <= flat.size.driving_teeth


@pytest.mark.slow
@at_once(
    ("made", "said"),
    [
        (lambda: spiral(1.1, 0.9, 350.0), "deg must be left of a turn"),
        (lambda: spiral(0.5, 0.45, 300.0), "the teeth of the driven gear reach over"),
        (lambda: generator("exp(4*x)", 0.0, 1.0, 60.0, 200.0), "cannot be continued"),
        (lambda: generator("x**1.5", 0.0, 1.0, 200.0, 200.0), "not smooth near x = 0"),
    ],
)
def test_what_leaves_no_room_or_cannot_go_on_is_refused(made: Any, said: str) -> None:
    with pytest.raises(NoSuchMechanism, match=said):
        toothed_pair(sized_pair(made(), None, 2.0, 110.0), form(2.0), TOLERANCE_MM)


# --- designs


def test_the_machine_goes_from_end_to_end_and_no_farther() -> None:
    found = drive("spiral-pair")
    assert found.motion.phi1_rad[[0, -1]] == pytest.approx([0.0, radians(230.0)], abs=1e-15)
    assert np.all(np.diff(found.motion.displacement) > 0.0)
    assert found.stroke_residual <= 1e-9
    # The energy that the slider takes on its way, by the trapezoid rule, is the mean power times the time.
    time_s = radians(230.0) / found.machine.speed_rad_s
    work = np.trapezoid(found.motion.load, found.motion.displacement) / 1000.0
    assert found.check.mean_power_w * time_s == pytest.approx(work, rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("range_deg", "holds"), [(12.0, False), (16.0, True)])
def test_a_range_must_hold_the_whole_arc_of_a_pair_of_flanks(range_deg: float, holds: bool) -> None:
    """Module 2 at 110 mm: 12 deg are 2.6 pitches long, 16 deg 3.0, and a pair of flanks touches over 1.8 pitches."""
    text = OPEN.replace("range_deg: 200, ratio_start: 1.6", f"range_deg: {range_deg}, ratio_start: 1.6")
    found = drive_of_text(text)
    if holds:
        assert found.designed_contact.least_arc == pytest.approx(1.8, abs=0.05)
        return
    with pytest.raises(NoSuchMechanism, match=r"tooth pitches long, and no pair of .* flanks") as refusal:
        _ = found.designed_contact
    assert refusal.value.key == "gears.module_mm"


def test_a_range_that_ends_before_the_sharp_corner_of_a_short_rod_is_checked() -> None:
    """A rod of the crank's length but 0.1 % has its corner at half a turn of the crank, which this range never sees."""
    short = OPEN.replace("range_deg: 200, ratio_start: 1.6", "range_deg: 60, ratio_start: 1.6")
    found = drive_of_text(short.replace("rod_mm: 200", "rod_mm: 60.06"))
    velocity = found.machine.motion(golden(radians(60.0), 2000)).velocity
    assert found.check.peak_speed.value == pytest.approx(np.abs(velocity).max(), rel=1e-3)


def test_a_range_may_swing_a_rocker() -> None:
    """The wishes of an output that turns are other ones than a slider's, and none of them is given."""
    linkage = "{kind: crank_rocker, crank_mm: 40, coupler_mm: 130, rocker_mm: 90, ground_mm: 140}"
    short = OPEN.replace("range_deg: 200, ratio_start: 1.6", "range_deg: 60, ratio_start: 1.6")
    found = drive_of_text(short.replace("{crank_mm: 60, rod_mm: 200}", linkage))
    end = found.transmission.driven_angle(np.array([radians(60.0)]))
    swung = found.motion.displacement[[0, -1]]
    assert swung == pytest.approx([0.0, found.linkage.displacement(end).value[0]], abs=1e-12)


@pytest.mark.slow
def test_solids_are_watertight_and_have_the_area_of_their_outline() -> None:
    case = built("spiral-pair")
    for gear in ("driving", "driven"):
        mesh = trimesh.load_mesh(str(case.folder / f"{gear}.stl"))
        assert mesh.is_watertight
        # A bore of 14 mm and an index hole of 2 mm.
        area = Polygon(case.outline(gear)).area - np.pi * (7.0**2 + 1.0)
        if gear == "driving":
            # Its slot is 5.2 mm wide, and the play shorter than the range.
            area -= 5.2 * 20.0 * (radians(230.0) - 0.2 / 20.0) + np.pi * 2.6**2
        assert mesh.volume == pytest.approx(15.0 * area, rel=1e-4)


@pytest.mark.slow
def test_files_tell_the_end_stops() -> None:
    found = drive("spiral-pair")
    driven = float(found.transmission.driven_angle(np.array([radians(230.0)])).value[0])
    stops = assembly_of(found)["end_stops"]
    assert stops["driving_rad"] == pytest.approx([0.0, radians(230.0)], abs=1e-7)
    assert stops["driven_rad"] == pytest.approx([0.0, -driven], abs=1e-7)
    sheet = (built("spiral-pair").folder / "data_sheet.md").read_text(encoding="utf-8")
    row = next(line for line in sheet.splitlines() if line.startswith("| turn between the end stops |"))
    assert [float(cell) for cell in row.split("|")[2:4]] == pytest.approx([230.0, degrees(driven)], abs=1e-4)
    assert built("spiral-pair").summary["drive"]["driven_range_deg"] == pytest.approx(degrees(driven), rel=1e-13)


@pytest.mark.slow
def test_pictures_swing() -> None:
    scene = scene_of(drive("spiral-pair"))
    assert scene.swings
    forth_and_back = scene.evenly_in_time(8)
    assert forth_and_back == pytest.approx(radians(230.0) * np.array([0, 1, 2, 3, 4, 3, 2, 1]) / 4.0)
    # The straight sides of the drawn curve lie on the line of centres at the end stops.
    curve = scene.gears[0].pitch_curve_mm
    assert np.all(curve[-1] == 0.0)
    ends = np.angle(curve[[0, -2], 0] + 1j * curve[[0, -2], 1])
    turned = scene.gears[0].mounting.sense(Gear.DRIVING) * radians(230.0)
    assert np.mod(ends + np.array([0.0, turned]) + np.pi, 2.0 * np.pi) - np.pi == pytest.approx([0.0, 0.0], abs=1e-12)


OPEN = """
name: open
linkage: {crank_mm: 60, rod_mm: 200}
operation: {speed_rpm: 30}
motion: {law: spiral, range_deg: 200, ratio_start: 1.6, ratio_end: 1.0}
gears: {module_mm: 2, center_distance_mm: 110, face_width_mm: 15}
"""


@at_once(
    ("old", "new", "key"),
    [
        ("face_width_mm: 15", "face_width_mm: 15, mesh: internal", "gears.mesh"),
        (
            "face_width_mm: 15",
            "face_width_mm: 15, helix: {angle_deg: 15, kind: helical, hand: right}",
            "gears.helix",
        ),
        ("face_width_mm: 15", "face_width_mm: 15, lobes: {driving: 2}", "gears.lobes"),
        ("face_width_mm: 15", "face_width_mm: 15, method: equivalent_gear", "gears.method"),
        ("name: open", "name: open\nwishes: {time_ratio: {at_least: 1.5}}", "wishes"),
        ("name: open", "name: open\noptimize: {limits: {peak_power_w: 10}}", "optimize"),
        ("range_deg: 200", "range_deg: 2", "motion.range_deg"),
        ("range_deg: 200", "range_deg: 360", "motion.range_deg"),
        ("ratio_end: 1.0", "ratio_end: 0.4", "motion"),
        ("ratio_end: 1.0", "ratio_end: 1.6", "motion.ratio_end"),
        ("law: spiral", "law: function_generator", "motion.function"),
    ],
)
def test_what_is_not_offered_is_refused_by_its_key(old: str, new: str, key: str) -> None:
    with pytest.raises(DesignError) as refusal:
        _ = drive_of_text(OPEN.replace(old, new)).law
    assert refusal.value.key == key


@pytest.mark.parametrize("what", ["rigid", "masses", "best law"])
def test_what_needs_whole_turns_says_so(what: str) -> None:
    from ncgear.project.law_task import task_of
    from ncgear.project.moving import TrainInertia

    found = drive_of_text(OPEN)
    with pytest.raises(WrongInput, match="turn to and fro, less than once") as refusal:
        _ = task_of(found.design, TrainInertia()) if what == "best law" else getattr(found, what)
    assert refusal.value.key == "motion.law"


@pytest.mark.slow
def test_a_formula_may_have_a_range() -> None:
    text = 'motion: {law: ratio_expression, ratio: "1.5 - 0.1*phi", range_deg: 150}'
    found = drive_of_text(OPEN.replace("motion: {law: spiral, range_deg: 200, ratio_start: 1.6, ratio_end: 1.0}", text))
    covered = found.transmission.lobes.range
    assert covered is not None
    assert covered.driven_rad == pytest.approx(-10.0 * log(1.0 - 0.1 * radians(150.0) / 1.5), rel=1e-13)
    assert found.designed_contact.longest_gap_pitches == 0.0
    with pytest.raises(WrongInput) as refusal:
        drive_of_text(
            OPEN.replace(
                "law: spiral, range_deg: 200, ratio_start: 1.6, ratio_end: 1.0",
                "law: ratio_expression, ratio: '1', range_deg: 200, scale_to_close: true",
            )
        )
    assert refusal.value.key == "motion.scale_to_close"


# --- random ones

spirals = st.tuples(st.floats(0.4, 2.5), st.floats(0.4, 2.5), st.floats(20.0, 330.0)).map(
    lambda values: ("spiral", *values)
)
generators = st.tuples(
    st.sampled_from([("log(x)", 1.0, 5.0), ("exp(x)", 0.0, 1.2), ("1/x", 1.0, 2.5), ("x + 0.1*sin(3*x)", 0.0, 3.0)]),
    st.floats(60.0, 320.0),
    st.floats(60.0, 320.0),
).map(lambda values: ("generator", *values[0], *values[1:]))


def judged_or_refused(drawn: tuple[Any, ...], module: float) -> bool:
    """Whether a random pair stands; it is refused with a reason, or it meshes without overlap over its range."""
    kind, *values = drawn
    try:
        curves = sized_pair((spiral if kind == "spiral" else generator)(*values), None, module, 120.0)
        pair = toothed_pair(curves, form(module), TOLERANCE_MM)
        found = as_designed(pair, placed(curves))
    except DesignError as refusal:
        assert refusal.key
        return False
    if found.overlap_mm.max() > TOLERANCE_MM:
        return False
    overlap, gap = brute_force(pair, curves, 8)
    assert overlap <= 0.1 * module * TOLERANCE_MM + 1e-9
    assert gap <= 3.0 * TOLERANCE_MM
    return True


@pytest.mark.slow
@settings(max_examples=8, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(drawn=st.one_of(spirals, generators), module=st.floats(1.0, 3.0))
def test_random_pairs_mesh_or_are_refused(drawn: tuple[Any, ...], module: float) -> None:
    judged_or_refused(drawn, module)


@pytest.mark.slow
@pytest.mark.long
@settings(max_examples=150, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(drawn=st.one_of(spirals, generators), module=st.floats(0.6, 4.0))
def test_many_random_pairs_mesh_or_are_refused(drawn: tuple[Any, ...], module: float) -> None:
    judged_or_refused(drawn, module)


@pytest.mark.long
@pytest.mark.slow
def test_most_random_spirals_that_leave_room_stand() -> None:
    """Refusals are no way out: of moderate spirals nearly all are made."""
    generator_of = np.random.default_rng(7)
    stood = [
        judged_or_refused(
            ("spiral", *np.exp(generator_of.uniform(-0.5, 0.5, 2)), generator_of.uniform(60.0, 200.0)), 1.5
        )
        for _ in range(12)
    ]
    assert sum(stood) >= 11


YOKED = OPEN.replace("{crank_mm: 60, rod_mm: 200}", "{kind: scotch_yoke, crank_mm: 25}")
MASSES = "masses: {slider_kg: 2, crank: {mass_kg: 1, center_mm: 0, inertia_kg_mm2: 100}}\n"
FRICTION = "drivetrain: {guide_friction: 0.1}\n"


@pytest.mark.parametrize("given", [FRICTION, MASSES, MASSES + FRICTION])
def test_no_remedy_leads_to_another_refusal(given: str) -> None:
    """What is not offered for open gears is to be left out, not completed by what is not offered either."""
    with pytest.raises(WrongInput, match="not offered for gears that turn to and fro") as refused:
        drive_of_text(f"{YOKED}{given}")
    assert refused.value.key in given
    assert "give" not in refused.value.problem.replace("given", "")


def test_nothing_asks_open_gears_for_masses() -> None:
    open_drive = drive_of_text(
        f"{YOKED.replace('200, ratio_start: 1.6', '130, ratio_start: 1.1')}simulation: {{turns: 2}}\n"
        "resistance: {polynomial_n: [5]}\n"
    )
    (advice,) = without_effect(open_drive)
    assert advice.what.startswith("simulation is given with gears that turn less than once")
    assert [remedy.text for remedy in advice.remedies] == ["leave it out"]
    assert open_drive.masses_left_out == "gears turn less than once"
