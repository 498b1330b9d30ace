"""Pins and spans: against the closed forms of circular gears, an ellipse at 50 digits, and searches by brute force."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import atan, cos, pi, radians, sin, tan
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import shapely

from at_once import at_once
from engaged import MODULE, TOLERANCE, made
from ncgear.design.reading.design_file import load
from ncgear.metrology import best_fit
from ncgear.metrology.pins import (
    NEAR,
    SHARES,
    SOLD_MM,
    Misfit,
    Pins,
    WorkingFlanks,
    nominal_pin_mm,
    over_two_pins,
    pins_in_spaces,
    pins_to_try,
    working_flanks,
)
from ncgear.metrology.span import STEPS, MeasuringChords, _middles, measuring_chords, spans
from ncgear.pitch.pair import sized_pair
from ncgear.project.drive import Drive
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.form import Backlash, TipRelief, ToothForm
from ncgear.teeth.gear import ToothedGear, toothed_pair
from ncgear.teeth.reach import reach_of
from pairs import rack

DESIGNS = Path(__file__).parents[1] / "designs"

ANGLE = radians(20.0)

AGREEMENT = 1e-9
"""Relative, of what a workshop reads: a ten-thousandth of a micrometre in 100 mm; Newton's method ends far below."""


def involute(angle: mpmath.mpf) -> mpmath.mpf:
    return mpmath.tan(angle) - angle


@cache
def circular(teeth: int, shift: float = 0.0, backlash_mm: float = 0.0) -> ToothedGear:
    """A driving gear of circular pitch curves; backlash lets both shifts be positive."""
    pitch = sized_pair(uniform_law(Lobes()), teeth, MODULE, None)
    form = ToothForm(rack(), shift * MODULE, -shift * MODULE, backlash=Backlash(backlash_mm))
    return toothed_pair(pitch, form, TOLERANCE).driving


def pins(gear: ToothedGear, diameter: float, working: WorkingFlanks | None = None) -> Pins:
    return pins_in_spaces(working or working_flanks(gear), diameter, gear.outline_mm, TOLERANCE)


def center_radius(teeth: int, diameter: float, thickness: float, cosine: float = 1.0, *, ring: bool = False) -> float:
    """m z cos(alpha) / (2 cos(alpha_M)) of teeth of a thickness along the pitch circle, at 50 digits."""
    with mpmath.workdps(50):
        module, alpha = mpmath.mpf(MODULE), mpmath.radians(20)
        space = mpmath.pi * module - thickness
        half = diameter / cosine / (module * teeth * mpmath.cos(alpha)) - space / (module * teeth)
        goal = involute(alpha) + (-half if ring else half)
        found = mpmath.findroot(lambda angle: involute(angle) - goal, (mpmath.mpf("0.2"), mpmath.mpf("0.7")))
        return float(module * teeth * mpmath.cos(alpha) / (2 * mpmath.cos(found)))


@pytest.mark.judges("metrology")
@at_once(("teeth", "shift", "backlash"), [(22, 0.0, 0.0), (21, 0.0, 0.0), (30, 0.3, 0.1), (45, -0.2, 0.0)])
def test_over_pins_of_a_circular_gear_is_the_closed_form(teeth: int, shift: float, backlash: float) -> None:
    gear = circular(teeth, shift, backlash)
    thickness = pi * MODULE / 2.0 + 2.0 * shift * MODULE * tan(ANGLE) - backlash / 2.0 / cos(ANGLE)
    found = pins(gear, 3.75)
    center = center_radius(teeth, 3.75, thickness)
    assert found.misfits == {}
    np.testing.assert_allclose(found.over_mm, center + 1.875, rtol=AGREEMENT)
    two = over_two_pins(working_flanks(gear), found)
    assert two.first.size == (teeth // 2 if teeth % 2 == 0 else teeth)
    across = 2.0 * center * (1.0 if teeth % 2 == 0 else cos(pi / 2.0 / teeth)) + 3.75
    np.testing.assert_allclose(two.distance_mm, across, rtol=AGREEMENT)


@pytest.mark.slow
def test_between_pins_of_a_circular_ring_is_the_closed_form() -> None:
    ring = made("ring 1:2", 30)[1].driven
    found = pins(ring, 3.5)
    center = center_radius(60, 3.5, pi * MODULE / 2.0, ring=True)
    np.testing.assert_allclose(found.over_mm, center - 1.75, rtol=AGREEMENT)
    two = over_two_pins(working_flanks(ring), found)
    np.testing.assert_allclose(two.distance_mm, 2.0 * center - 3.5, rtol=AGREEMENT)


def test_balls_of_a_circular_helical_gear_are_the_closed_form() -> None:
    """inv(alpha_Mt) = inv(alpha_t) + d / (z m_n cos(alpha_n)) - space / (m_t z), written in normal quantities."""
    gear, helix = circular(40), radians(25.0)
    normal_angle = atan(tan(ANGLE) * cos(helix))
    assert cos(ANGLE) * working_flanks(gear, helix).base_cosine[0] == pytest.approx(cos(helix) * cos(normal_angle))
    found = pins(gear, 3.5, working_flanks(gear, helix))
    cosine = cos(helix) * cos(normal_angle) / cos(ANGLE)
    center = center_radius(40, 3.5, pi * MODULE / 2.0, cosine)
    np.testing.assert_allclose(found.over_mm, center + 1.75, rtol=AGREEMENT)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("ellipse", 37), ("baler", 60), ("ring", 32), ("deep sine", 60)])
def test_a_pin_touches_both_flanks_of_its_space_and_nothing_else(name: str, teeth: int) -> None:
    """The outline, whose flanks stray by less than a tolerance, is as far from the centre as the pin's radius."""
    for gear in (made(name, teeth)[1].driving, made(name, teeth)[1].driven):
        found = pins(gear, 4.0)
        assert found.space.size > teeth // 3
        outline = shapely.linearrings(gear.outline_mm)
        distance = shapely.distance(shapely.points(found.center_mm), outline)
        np.testing.assert_allclose(distance, 2.0, atol=1.1 * TOLERANCE)
        working = working_flanks(gear)
        for offset in (1, 2):
            which = (2 * (found.space - 1) + offset) % working.flanks.count
            heights = np.linspace(working.low_mm[which], working.high_mm[which], 4001, axis=1)
            points = working.flanks.flank(which[:, None], heights)[0]
            nearest = np.linalg.norm(points - found.center_mm[:, None], axis=2).min(axis=1)
            np.testing.assert_allclose(nearest, 2.0, atol=1e-6)


def test_pins_that_measure_nothing_say_why() -> None:
    gear = circular(30)
    reasons = {diameter: set(pins(gear, diameter).misfits.values()) for diameter in (1.2, 2.6, 3.3, 3.75, 6.5)}
    assert reasons[1.2] <= {Misfit.DEEP, Misfit.ROOT}
    assert reasons[1.2]
    assert reasons[2.6] == {Misfit.HIDDEN}
    assert reasons[3.75] == set()
    assert reasons[6.5] == {Misfit.HIGH}


def test_two_pins_measure_where_both_stand_out_of_the_whole_outline() -> None:
    """With 21 teeth they lie askew: small ones, each of which stands out by itself, are hidden from the plates."""
    gear, hidden, measured = circular(21), 0, 0
    for diameter in np.arange(2.8, 3.6, 0.05):
        found = pins(gear, float(diameter))
        if found.space.size < 21:
            continue
        two = over_two_pins(working_flanks(gear), found)
        one, other = found.center_mm[0], found.center_mm[10]
        way = (one - other) / np.linalg.norm(one - other)
        out = one @ way + diameter / 2.0 > (gear.outline_mm @ way).max()
        assert two.first.size == (21 if out else 0)
        hidden, measured = hidden + (not out), measured + out
    assert hidden > 0
    assert measured > 0


def test_tip_relief_ends_the_flank_that_is_measured() -> None:
    relief = TipRelief(0.02, 0.2, 2.0)
    assert pins(made("uniform", 30)[1].driving, 4.0).misfits == {}
    assert set(pins(made("uniform", 30, relief=relief)[1].driving, 4.0).misfits.values()) == {Misfit.HIGH}


def span_of(teeth: int, over: int, shift: float = 0.0, backlash: float = 0.0) -> float:
    width = pi * (over - 0.5) + teeth * (tan(ANGLE) - ANGLE)
    return MODULE * cos(ANGLE) * width + 2.0 * shift * MODULE * sin(ANGLE) - backlash / 2.0


@at_once(("teeth", "shift", "backlash"), [(17, 0.0, 0.0), (40, 0.0, 0.0), (30, 0.3, 0.1), (61, -0.2, 0.06)])
def test_span_of_a_circular_gear_is_the_closed_form(teeth: int, shift: float, backlash: float) -> None:
    found = spans(working_flanks(circular(teeth, shift, backlash)))
    assert found.everywhere
    assert found.first.size == teeth
    assert len(set(found.teeth)) == 1
    np.testing.assert_allclose(found.distance_mm, span_of(teeth, found.teeth[0], shift, backlash), rtol=AGREEMENT)
    # Its middle comes to the pitch point a tooth later for each tooth.
    order = np.argsort(found.first)
    assert np.diff(np.unwrap(found.phi1_rad[order])) == pytest.approx(2.0 * pi / teeth, rel=1e-9)


def test_span_of_a_circular_helical_gear_is_that_of_its_normal_section() -> None:
    """W_n = m_n cos(alpha_n) (pi (k - 1/2) + z inv(alpha_t))."""
    helix = radians(20.0)
    found = spans(working_flanks(circular(40), helix))
    normal_angle = atan(tan(ANGLE) * cos(helix))
    share = cos(helix) * cos(normal_angle) / cos(ANGLE)
    np.testing.assert_allclose(found.distance_mm, share * span_of(40, found.teeth[0]), rtol=AGREEMENT)


def ellipse_span(length: float, eccentricity: float, *, at_major: bool, crossings_mm: float) -> float:
    """Span over flanks so far apart along the curve, at 50 digits: its chord is square to an axis of the ellipse.

    The chord from -t to t about the major vertex of (A cos t, B sin t) makes the angle alpha with the curve where
    tan t = (B / A) tan(alpha), and about the minor one with A and B exchanged.
    """
    with mpmath.workdps(50):
        e = mpmath.mpf(eccentricity)
        semi_major = mpmath.mpf(length) / (4 * mpmath.ellipe(e**2))
        semi_minor, alpha = semi_major * mpmath.sqrt(1 - e**2), mpmath.radians(20)
        near, across = (semi_major, semi_minor) if at_major else (semi_minor, semi_major)
        t = mpmath.atan(across / near * mpmath.tan(alpha))
        arc = 2 * mpmath.quad(
            lambda s: mpmath.sqrt((near * mpmath.sin(s)) ** 2 + (across * mpmath.cos(s)) ** 2), [0, t]
        )
        return float(2 * across * mpmath.sin(t) + mpmath.cos(alpha) * (crossings_mm - arc))


@pytest.mark.thorough
def test_spans_of_an_ellipse_lie_across_its_axes() -> None:
    gear = made("ellipse", 37)[1].driving
    found = spans(working_flanks(gear))
    assert found.first.size == 4
    pitch_mm = gear.flanks.curve.length_mm / 37
    for distance, teeth, least in zip(found.distance_mm, found.teeth, found.least, strict=True):
        crossings = (teeth - 0.5) * pitch_mm
        expected = ellipse_span(gear.flanks.curve.length_mm, 0.35, at_major=bool(least), crossings_mm=crossings)
        assert distance == pytest.approx(expected, rel=AGREEMENT)


def way_of(chords: MeasuringChords, gear: ToothedGear) -> np.ndarray:
    first, last = (gear.flanks.curve.at_length(end).position for end in (chords.start_mm, chords.end_mm))
    return np.asarray(last - first)


def caliper(gear: ToothedGear, first: int, last: int, turn_rad: np.ndarray) -> np.ndarray:
    """Distances of plates at turns from the line between two flanks' middles, by brute force over their points."""
    high, low = gear.sides.flank_range()
    back, front = 2 * (first - 1), 2 * (last - 1) + 1
    one, other = (
        gear.flanks.flank(np.array([flank]), np.linspace(low[flank], high[flank], 20001)[:, None])[0][:, 0]
        for flank in (back, front)
    )
    way = other.mean(axis=0) - one.mean(axis=0)
    angle = np.arctan2(way[1], way[0]) + turn_rad
    direction = np.stack([np.cos(angle), np.sin(angle)])
    return (other @ direction).max(axis=0) - (one @ direction).min(axis=0)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("ellipse", 37), ("sine", 30), ("baler", 60)])
def test_a_span_is_where_the_reading_of_a_tilted_caliper_turns(name: str, teeth: int) -> None:
    gear = made(name, teeth)[1].driving
    found = spans(working_flanks(gear))
    assert found.first.size
    for first, last, distance, least in zip(found.first, found.last, found.distance_mm, found.least, strict=True):
        turn = np.linspace(-0.15, 0.15, 601)
        reading = caliper(gear, int(first), int(last), turn)
        turning = np.nonzero(np.diff(np.sign(np.diff(reading))))[0] + 1
        at = turning[np.argmin(np.abs(reading[turning] - distance))]
        assert reading[at] == pytest.approx(distance, abs=2e-6 * MODULE)
        assert (reading[at] < reading[at - 1]) == bool(least)


@pytest.mark.thorough
def test_elsewhere_the_reading_of_a_tilted_caliper_does_not_turn() -> None:
    """So the test above can be failed: five teeth of the ellipse between two of its axes."""
    reading = caliper(made("ellipse", 37)[1].driving, 4, 8, np.linspace(-0.03, 0.03, 201))
    assert np.all(np.diff(reading) > 0.0) or np.all(np.diff(reading) < 0.0)


@pytest.mark.slow
def test_chords_begin_and_end_where_the_curve_is_convex() -> None:
    pitch = made("deep sine", 60)[0]
    chords = measuring_chords(pitch.driving, ANGLE)
    assert not pitch.convex(pitch.driving.gear)
    assert chords.start_mm.size
    for ends in (chords.start_mm, chords.end_mm):
        assert np.all(pitch.driving.at_length(ends).curvature > 0.0)


@pytest.mark.parametrize(
    ("cosine", "sine", "angle_deg"),
    [
        ((0.095, 0.053, -0.01), (0.091, 0.103, -0.031), 22.5),  # convex; no end was found here
        ((-0.533, -0.061, -0.071), (0.124, 0.275, 0.342), 20.0),  # dented; ends that leap over the dent counted
    ],
)
def test_chords_leave_and_come_in_at_the_pressure_angle(
    cosine: tuple[float, ...], sine: tuple[float, ...], angle_deg: float
) -> None:
    curve = sized_pair(harmonic_law(np.array(cosine), np.array(sine), Lobes()), 51, 1.7, None).driven
    chords = measuring_chords(curve, radians(angle_deg))
    first, last = curve.at_length(chords.start_mm), curve.at_length(chords.end_mm)
    way = last.position - first.position
    way /= np.linalg.norm(way, axis=1)[:, None]
    assert len(way) >= 2
    for tangent in (first.tangent, last.tangent):
        np.testing.assert_allclose(np.degrees(np.arccos(np.sum(tangent * way, axis=1))), angle_deg, atol=1e-7)


@pytest.mark.slow
def test_the_rounded_corners_of_a_square_have_the_spans_of_a_circle() -> None:
    """Each corner is an arc of 25 mm over 90 deg, on which chords of 40 deg are all alike."""
    drive = Drive(load(DESIGNS / "rounded-square.yaml").design)
    gear = drive.teeth.driving
    chords = measuring_chords(gear.flanks.curve, ANGLE)
    length = gear.flanks.curve.length_mm
    corners = np.isclose(np.linalg.norm(way_of(chords, gear), axis=1), 50.0 * sin(ANGLE), rtol=AGREEMENT)
    assert np.count_nonzero(corners) == 4
    middles = np.sort((chords.start_mm + chords.end_mm)[corners] / 2.0 % length)
    np.testing.assert_allclose(np.diff(middles), length / 4.0, atol=2.0 * length / STEPS)
    found = spans(working_flanks(gear))
    for first, last, distance in zip(found.first, found.last, found.distance_mm, strict=True):
        reading = caliper(gear, int(first), int(last), np.linspace(-0.15, 0.15, 601))
        assert reading.max() == pytest.approx(distance, abs=2e-6 * MODULE)
        assert (np.ptp(reading) < 2e-6 * MODULE) == (first == last)
    assert np.count_nonzero(found.first == found.last) == 4


@pytest.mark.slow
def test_a_ring_has_no_span() -> None:
    assert spans(working_flanks(made("ring", 32)[1].driven)).first.size == 0


def test_a_thicker_tooth_widens_the_span_by_its_cosine_and_pins_as_the_closed_form() -> None:
    gear = made("ellipse", 37)[1].driving
    working = working_flanks(gear)
    moved = spans(working.thicker(-0.1)).distance_mm - spans(working).distance_mm
    np.testing.assert_allclose(moved, -0.1 * cos(ANGLE), rtol=1e-9)
    round_one = circular(30)
    thinner = pins(round_one, 3.75, working_flanks(round_one).thicker(-0.1))
    center = center_radius(30, 3.75, pi * MODULE / 2.0 - 0.1)
    np.testing.assert_allclose(thinner.over_mm, center + 1.875, rtol=AGREEMENT)


def test_tip_and_root_radii_of_a_circular_gear() -> None:
    gear = circular(30, 0.3, 0.1)
    np.testing.assert_allclose(reach_of(gear).tip_mm, 30.0 + 2.0 + 0.6, rtol=1e-12)
    np.testing.assert_allclose(reach_of(gear).root_mm, 30.0 - 2.5 + 0.6, rtol=1e-12)


@at_once("module", [2e-6, 0.0013, 0.07, 0.2, 0.7, 2.0, 6.0, 28.0, 60.0])
def test_pins_to_try_rise_from_the_nominal_diameter(module: float) -> None:
    nominal = nominal_pin_mm(module, internal=False)
    tried = pins_to_try(nominal)
    assert tried
    assert nominal <= tried[0]
    assert all(low < high for low, high in pairwise(tried))
    assert len(tried) == 1 or tried[-1] <= 1.06 * NEAR * nominal
    assert set(tried) <= set(SOLD_MM) or not SOLD_MM[0] / NEAR <= nominal <= SOLD_MM[-1]


@at_once("module", [3e-6, 0.004, 0.03, 420.0])
def test_pins_follow_the_module_where_none_are_sold(module: float) -> None:
    """As many sizes as of module 2; two digits or whole mm round a size up by a tenth at most."""
    at_two = pins_to_try(nominal_pin_mm(2.0, internal=False))
    nominal = nominal_pin_mm(module, internal=False)
    tried = pins_to_try(nominal)
    assert len(tried) >= len(at_two)
    assert tried[0] / nominal < 1.1
    assert all(0.0 <= size / (share * nominal) - 1.0 < 0.1 for size, share in zip(tried, SHARES, strict=True))


@at_once(
    ("even", "apart_after", "middles"),
    [
        ("-----", (), []),
        ("-xxx-", (), [2]),
        ("-xxx-x", (), [2, 5]),
        ("-xxxx-", (2,), [2, 4]),
        ("xx-xx", (), [0]),
        ("xxx--xxx", (), [0]),
        ("xxxxx", (), [2]),
    ],
)
def test_a_stretch_of_even_chords_has_one_in_its_middle(
    even: str, apart_after: tuple[int, ...], middles: list[int]
) -> None:
    """The last start of a turn is its first: a stretch may go on from the end of the turn to its beginning."""
    follow = np.ones(len(even) - 1, dtype=bool)
    follow[list(apart_after)] = False
    assert _middles(np.array([letter == "x" for letter in even]), follow).tolist() == middles


@at_once("best", [0.0, 0.4, -3.1, 2.0])
def test_the_nearest_angle_is_found_between_two_that_were_tried(best: float) -> None:
    """Not farther than half a step of the second round, which goes one step of the first to both sides."""
    count = 40
    step = 2.0 * pi / count
    at = best + 0.45 * step

    def nearness(outline: object, points: object, probe_mm: float, pose: best_fit.Pose) -> float:
        return abs(sin((pose.angle_rad - at) / 2.0))

    tried = [best + step * number for number in range(-(count // 2), count // 2)]
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(best_fit, "_nearness_mm", nearness)
        poses = [best_fit.Pose(angle, 0j) for angle in tried]
        patched.setattr(best_fit, "_begun", lambda *_: [(nearness(None, None, 0.0, pose), pose) for pose in poses])
        nothing: Any = None
        found = best_fit.nearness_mm(nothing, np.zeros(9, dtype=complex), 0.0)
    assert found <= sin(step / (2.0 * best_fit.BEGUN_PER_TOOTH) / 2.0) * (1.0 + 1e-9)
