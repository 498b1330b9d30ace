"""Steps of Newton's method, of contacts and of paths that no test had judged by themselves: against plain algebra."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.polynomial import Polynomial
from scipy.interpolate import CubicHermiteSpline

from at_once import at_once
from ncgear.contact.designed.edges import _on_cubics
from ncgear.contact.designed.extremes import _level_mm
from ncgear.contact.designed.tangency import _correction, _Rates
from ncgear.contact.written.apart import MOST_TOGETHER, _together
from ncgear.drawings.page.data import LOOKED_AT, _cubics
from ncgear.dynamics.crank_load import INTERVALS, LEAST_WAY, CrankLoad, _knots, _stretch
from ncgear.dynamics.flank_changes import JUMP, SAMPLES, turns_of
from ncgear.dynamics.history import _slide
from ncgear.dynamics.mesh_force import MeshPlace, _directions
from ncgear.dynamics.rigid import refuse_locked_at
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.jet import Jet
from ncgear.numerics.periodic_table import PeriodicTable
from ncgear.pitch.shape import Mesh
from ncgear.teeth.chords import _standing_off
from ncgear.teeth.fouling import BEYOND, _way_out_mm
from ncgear.teeth.root_radius import deepest_rounded, largest_root_radius
from ncgear.teeth.tips import HALFWAY, _crossing_on_circle
from ncgear.teeth.tool import PinionCircle
from ncgear.trains.contact import _greatest
from ncgear.trains.loads import _derivative, moments_of
from ncgear.trains.path_search import _arm, segment_distances
from ncgear.trains.planetary import _bar_mm
from ncgear.trains.planetary_told import _over_ground
from ncgear.trains.tip_path import TipMotion, _link_rad

Made: Any = SimpleNamespace


# --- contact


@pytest.mark.judges("contact")
def test_a_step_to_a_tangency_solves_its_three_linear_equations() -> None:
    """Gap along and across the driven tangent and the angle of both, by heights and angle, as numpy solves them."""
    rng = np.random.default_rng(3)
    own, other, slip, along, across, own_bend, other_bend, bend = rng.uniform(0.3, 2.0, (8, 20))
    gap, tangent = rng.normal(size=(2, 20)) + 1j * rng.normal(size=(2, 20))
    unit = tangent / np.abs(tangent)
    at: Any = Made(other_slope=unit * other, gap=gap, bend_rad=bend)
    found = _correction(at, _Rates(own, other, slip, along, across, own_bend, other_bend))
    ahead = gap * unit.conj()
    zero, one = np.zeros(20), np.ones(20)
    moved = np.array([[own, -other, along], [slip, zero, across], [own_bend, -other_bend, one]]).transpose(2, 0, 1)
    wanted = np.linalg.solve(moved, np.array([ahead.real, ahead.imag, bend]).T[..., None])[..., 0]
    assert pytest.approx(wanted, rel=1e-9) == np.array(found).T


@pytest.mark.judges("contact")
@at_once("start", [0.58, 0.65])
def test_a_chord_of_a_cubic_meets_a_circle_where_the_cubic_does(start: float) -> None:
    curve = Polynomial([5.0 + 1.0j, 2.0 + 0.5j, -0.4 + 0.7j, 0.3 - 0.6j])
    first, last, hit = 0.2, 0.9, 0.64
    ends = np.array([first, last])
    paths = Made(point=curve(ends)[None], slope=curve.deriv()(ends)[None])
    same = lambda values, position: values  # noqa: E731
    hits: Any = Made(
        ends=(np.array([first]), np.array([last])),
        run=np.array([0]),
        chord=np.array([0]),
        position=None,
        curves=Made(paths=paths, directions=same, points=same),
        share=np.array([start]),
        corner=np.array([abs(curve(hit)) * 1j]),
    )
    assert _on_cubics(hits) == pytest.approx([(hit - first) / (last - first)], abs=1e-7)


@pytest.mark.judges("contact")
@at_once("steps", [0.0, 0.25, 1.0, 3.0])
def test_positions_within_some_steps_stand_together(steps: float) -> None:
    rolled = np.array([0.0, 0.1, 0.2, 1.0, 1.1, 2.0, 2.5, 3.0, 3.1, 6.0])
    rows = _together(Made(count=10, rolled_mm=2.0 * rolled, step_mm=2.0), steps)
    assert [number for row in rows for number in dict.fromkeys(row.tolist())] == list(range(10))
    for row in rows:
        same = np.floor(rolled[row] / steps + 1e-9) if steps else row
        assert np.ptp(same) == 0
    most = {0.0: 1, 0.25: 3, 1.0: 3, 3.0: 7}[steps]
    assert rows.shape[1] == most


@pytest.mark.judges("contact")
def test_many_positions_in_a_step_are_parted_evenly() -> None:
    count = 2 * MOST_TOGETHER + 1
    rows = _together(Made(count=count, rolled_mm=np.linspace(0.0, 0.9, count), step_mm=1.0), 1.0)
    assert rows.shape == (3, count // 3 + 1)
    assert np.unique(rows).tolist() == list(range(count))


@pytest.mark.judges("contact")
@at_once("side", [0, 1])
def test_the_level_pressure_angle_is_where_the_cubic_of_four_positions_has_it(side: int) -> None:
    """Rolled lengths that are a cubic of the angle: the place of the angle 0 is its constant."""
    angle = np.array([-0.3, -0.17, -0.05, 0.06, 0.2, 0.33])
    rolled = Polynomial([7.0, 2.0, -0.8, 1.5])(angle)
    tangent = np.exp(0.4j) * np.ones(6)
    alike = np.zeros(6, dtype=int)
    first = Made(tangent=tangent, point=tangent * np.exp(1j * angle), flanks=alike == 0, driving=alike, driven=alike)
    none = Made(**{**vars(first), "flanks": alike == 1})
    pair = [Made(first=first), Made(first=none)][:: 1 if side == 0 else -1]
    designed: Any = Made(pushing=pair[0], back=pair[1], placement=Made(rolled_mm=rolled))
    assert _level_mm(designed, side) == pytest.approx(7.0, abs=1e-12)
    assert _level_mm(designed, 1 - side) is None


# --- dynamics


@pytest.mark.judges("dynamics")
@at_once("moment", [0.0, 40.0, -15.0])
def test_the_power_of_a_moment_is_the_change_of_energy(moment: float) -> None:
    """d/dt (J w^2 / 2) = M w with J = 3 + 0.7 phi."""
    speed, inertia, change = 5.0, 3.0, 0.7
    table = PeriodicTable(np.array([0.0, 6.0]), np.array([[[change, 0.0]], [[inertia, 0.0]]]))
    found = CrankLoad(table, (0.0, 3.0)).acceleration_rad_s2(np.array(0.0), np.array(speed), np.array(moment))
    assert change * speed**3 / 2.0 + inertia * speed * found == pytest.approx(moment * speed)


@pytest.mark.judges("dynamics")
def test_knots_are_even_and_a_stretch_has_its_least_distance() -> None:
    knots = _knots(0.5, 2.0)
    step = 2.0 * pi / INTERVALS
    assert (knots[0], knots[-1]) == (0.5, 2.0)
    assert step * 0.99 < np.diff(knots).max() <= step * (1.0 + 1e-9)
    assert _stretch(np.array([0.0, 1.0, 1.5, 1.6, 2.0, 2.01]), 1.0, 2.0) == pytest.approx((1.0, 2.0, 0.1))
    assert _stretch(np.array([0.0, 1.0, 1.0 + 1e-13, 3.0]), 1.0, 3.0)[2] == pytest.approx(2.0 * LEAST_WAY)


@pytest.mark.judges("dynamics")
def test_teeth_lock_where_a_loaded_flank_leans_a_right_angle() -> None:
    phi1, right = np.array([0.0, 1.0, 2.0, 3.0]), pi / 2.0
    refuse_locked_at(phi1, np.array([5.0, 1e-12, -5.0, 5.0]), np.array([1.0, 2.0, 1.5, 0.0]))
    with pytest.raises(NoSuchMechanism, match=r"push the driven gear at phi1 = .*, where .* is 97.4 deg"):
        refuse_locked_at(phi1, np.array([5.0, 1e-12, -5.0, 5.0]), np.array([right, 2.0, 1.5, 1.7]))
    with pytest.raises(NoSuchMechanism, match=r"hold the driven gear back at phi1 = .*, where .* is 90 deg"):
        refuse_locked_at(phi1, np.array([5.0, 1e-12, -5.0, 5.0]), np.array([1.0, 2.0, right, 1.5]))


@pytest.mark.judges("dynamics")
def test_a_slide_follows_its_angle_by_the_chain_rule() -> None:
    """x = 2 + 3 p + p^3 with p = 0.5 + 4 t + 6 t^2 at t = 0, whose polynomial in t is differentiated."""
    turned, way = Polynomial([0.5, 4.0, 6.0]), Polynomial([2.0, 3.0, 0.0, 1.0])
    in_time = way(turned)
    jet = Jet.variable(np.array([0.5]), 2)
    found = _slide(2.0 + 3.0 * jet + jet**3, np.array([4.0]), np.array([12.0]))
    for own, order in zip((getattr(found, name) for name in found.__dataclass_fields__), range(3), strict=True):
        assert own == pytest.approx([in_time.deriv(order)(0.0) if order else in_time(0.0)])


@pytest.mark.judges("dynamics")
@at_once("sense", [-1.0, 1.0])
@at_once("mesh", list(Mesh))
def test_a_driven_gear_moves_across_the_line_of_axes(sense: float, mesh: Mesh) -> None:
    """Its pitch point lies towards the driving axis at 0.6 rad: i exp(0.6 i) where it turns counter-clockwise."""
    turning, apart = _directions(MeshPlace(90.0, radians(20.0), mesh, 0.6, driven_sense=sense))
    assert complex(turning.x, turning.y) == pytest.approx(sense * 1j * np.exp(0.6j))
    away = -1.0 if mesh is Mesh.EXTERNAL else 1.0
    assert complex(apart.x, apart.y) == pytest.approx(away * np.exp(0.6j))


@pytest.mark.judges("dynamics")
def test_torques_hurry_where_they_jump_or_turn() -> None:
    """Of two pairs whose torque is even but for a jump of the first one, and a turn of the second one."""
    asked = np.full((2, 12), 10.0)
    asked[0, 4:] += 2.0 * JUMP * 10.0
    asked[1, 8:] = -10.0
    step = 2.0 * pi / SAMPLES / 6.0
    rows, flanks = turns_of(asked, np.array([11.0, 10.0]), np.full((2, 12), 900.0 * step))
    assert {3, 7, 11} <= set(rows.tolist()) <= {2, 3, 6, 7, 10, 11}
    assert flanks[1].tolist() == [1] * 8 + [-1] * 4
    # A change of slope counts by the square of swings in a sample, and by their number where this is over 1.
    bent = np.full((2, 12), 10.0) + np.abs(np.arange(12) - 6.0) * [[1e-4], [0.0]]
    few = 0.9 * sqrt(2e-4 / (0.03 * 11.0)) * 6.0 * SAMPLES / (2.0 * pi)
    for swings, wanted in ((few, True), (few / 0.81, False)):
        rows, _ = turns_of(bent, np.array([11.0, 11.0]), np.full((2, 12), swings * step))
        assert (5 in rows.tolist() or 4 in rows.tolist()) is wanted


# --- teeth


@pytest.mark.judges("teeth")
@at_once("angles", [(20.0, 20.0), (25.0, 14.5), (10.0, 30.0)])
def test_the_deepest_cutter_with_a_rounding_has_it_as_its_largest(angles: tuple[float, float]) -> None:
    given = radians(angles[0]), radians(angles[1])
    slope = (tan(given[0]) + tan(given[1])) / 2.0
    length = (1.0 / cos(given[0]) + 1.0 / cos(given[1])) / 2.0
    for radius in (0.1, 0.25):
        deepest = deepest_rounded(given, radius, pi / 4.0)
        assert 1.0 - 1e-8 < deepest / ((pi / 4.0 - radius * (length - slope)) / slope) < 1.0
        assert largest_root_radius(given, deepest, pi / 4.0) == pytest.approx(radius, rel=1e-6)
    # A rounding touches the flank r (1 - sin a) above the tip: there is no room where the tooth is less deep.
    full = pi / 4.0 / (length - slope + slope * (1.0 - sin(min(given))))
    assert deepest_rounded(given, 1.01 * full, pi / 4.0) == 0.0
    assert deepest_rounded(given, 0.99 * full, pi / 4.0) > 0.0


@pytest.mark.judges("teeth")
@at_once("curvature", [0.0, 0.02, -0.01])
def test_a_flank_meets_its_tip_land_on_a_circle(curvature: float) -> None:
    """(1 + h k)^2 + (h k cot a)^2 = (1 + k tip)^2, and the angle atan(h k cot a / (1 + h k)) over k along the curve.

    The angle is by a fraction of the tangent x = 0.1, whose series differs from the arc's by x^5 / 11, 5e-5 mm.
    """
    angle, tip = radians(20.0), np.array([2.0, 1.6])
    side, at, asked = np.array([1.0, -1.0]), np.array([30.0, 40.0]), list[Any]()
    flanks: Any = Made(
        slant=Made(of=lambda which: Made(sine=np.full(2, sin(angle)), tangent=np.full(2, tan(angle)))),
        tip_height_mm=tip,
        side=side,
        curve=Made(curvature_at=lambda rolled: (asked.append(rolled), np.full(2, curvature))[1]),
        rolled_mm=lambda which, height: at + 0.3 * height,
    )
    height, sigma = _crossing_on_circle(flanks, np.arange(2))
    assert asked[0] == pytest.approx(at + 0.3 * HALFWAY * tip)
    up, aside = 1.0 + height * curvature, height * curvature / tan(angle)
    assert up**2 + aside**2 == pytest.approx((1.0 + curvature * tip) ** 2, rel=1e-12)
    along = height / tan(angle) if not curvature else np.arctan(aside / up) / curvature
    assert sigma == pytest.approx(at + 0.3 * height + side * along, abs=1e-4)
    assert np.all(height > 0.0)


@pytest.mark.judges("teeth")
def test_a_cutter_tooth_leaves_its_space_by_the_curvatures_of_both() -> None:
    """It rises by s^2 / 2 times 1/20 + 1/50; on a ring of more curvature, by half a turn of the tool."""
    tool = PinionCircle(20, 2.0)
    for least, wanted in ((0.02, BEYOND * sqrt(2.0 * 4.75 / 0.07)), (-0.06, 20.0 * pi), (-0.0499, 20.0 * pi)):
        flanks = Made(
            tool=tool,
            root_depth_mm=np.array([2.0, 2.5]),
            tip_height_mm=np.array([2.25, 1.0]),
            curve=Made(curvature_bounds=(least, 1.0)),
        )
        tips: Any = Made(flanks=flanks)
        assert _way_out_mm(tips) == pytest.approx(wanted)


@pytest.mark.judges("teeth")
def test_points_stand_off_by_half_the_smaller_sagitta_beside_them() -> None:
    chords: Any = Made(is_first=np.array([True, False, False, False, False]))
    found = _standing_off(chords, np.array([0.2, 0.3, 0.1, -0.4, -0.9]), np.full(5, 0.12))
    assert found == pytest.approx([0.0, 0.1, 0.05, 0.0, -0.12])


# --- trains


@pytest.mark.judges("trains")
def test_distances_of_segments_are_those_of_shapely() -> None:
    rng = np.random.default_rng(7)
    a, b, c, d = rng.normal(size=(4, 200)) + 1j * rng.normal(size=(4, 200))
    lines = [
        shapely.linestrings(np.stack([[p.real, p.imag], [q.real, q.imag]]).transpose(2, 0, 1))
        for p, q in ((a, b), (c, d))
    ]
    assert segment_distances(a, b, c, d) == pytest.approx(shapely.distance(*lines), abs=1e-12)


def motion(carrier_mm: float, arm_mm: float, *, clockwise: bool = False) -> TipMotion:
    return TipMotion(10.0 + 5.0j, carrier_mm, arm_mm, 0.3, np.zeros(2), clockwise)


@pytest.mark.judges("trains")
@at_once("clockwise", [False, True])
def test_the_tip_is_at_the_end_of_the_arm_on_the_carrier(clockwise: bool) -> None:
    w, u = np.array([0.0, 0.4, 2.0]), np.array([0.3, 1.1, 2.5])
    found = motion(100.0, 40.0, clockwise=clockwise).tip_where(w, u)
    x = 100.0 * np.cos(u) + 40.0 * np.cos(u - w)
    y = 100.0 * np.sin(u) + 40.0 * np.sin(u - w)
    assert found.real == pytest.approx(10.0 + x)
    assert found.imag == pytest.approx(5.0 + (-y if clockwise else y))


@pytest.mark.judges("trains")
@at_once("lengths", [(100.0, 40.0), (40.0, 100.0)])
def test_the_direction_to_the_tip_is_continuous(lengths: tuple[float, float]) -> None:
    carrier, arm = lengths
    w = np.linspace(-3.0, 9.0, 500)
    found = _link_rad(w, carrier, arm)
    assert np.exp(1j * found) == pytest.approx(np.exp(1j * np.angle(carrier + arm * np.exp(-1j * w))))
    assert np.abs(np.diff(found)).max() < 0.1
    assert abs(found[np.argmin(np.abs(w))]) < 0.05


@pytest.mark.judges("trains")
def test_an_arm_stands_on_its_planet_turned_against_the_carrier() -> None:
    """The planet turns by w = 2 (u - 0.3) here, and a turn later by a whole turn more."""
    w = np.linspace(0.0, 2.0 * pi, 5)
    u = 0.3 + w
    at = np.array([0.3, 1.0, 0.3 + 2.0 * pi + 0.7, 0.3 - 0.2])
    planet, tip = _arm(motion(100.0, 40.0), at, w, u)
    assert planet == pytest.approx(100.0 * np.exp(1j * at))
    assert tip - planet == pytest.approx(np.full(4, 40.0 * np.exp(0.3j)))


@pytest.mark.judges("trains")
def test_the_greatest_value_is_searched_between_the_angles() -> None:
    angles = np.linspace(0.5, 0.5 + 2.0 * pi, 60, endpoint=False)
    best, at = _greatest(lambda angle: cos(angle - 1.2345), angles, np.cos(angles - 1.2345))
    assert (best, at) == (pytest.approx(1.0, abs=1e-6), pytest.approx(1.2345, abs=2e-3))


@pytest.mark.judges("trains")
def test_periodic_values_are_differentiated_wave_by_wave() -> None:
    at = np.arange(16) * 3.0 / 16.0
    wave = np.exp(2j * pi * 2.0 * at / 3.0)
    for order in (1, 2):
        assert _derivative(wave, order, 3.0) == pytest.approx((4j * pi / 3.0) ** order * wave, abs=1e-9)
    highest = np.cos(pi * np.arange(16)).astype(complex)
    assert _derivative(highest, 1, 3.0) == pytest.approx(np.zeros(16), abs=1e-9)
    assert _derivative(highest, 2, 3.0) == pytest.approx(-((16.0 * pi / 3.0) ** 2) * highest)


@pytest.mark.judges("trains")
def test_moments_of_a_rectangle_away_from_the_origin() -> None:
    """8 by 6 mm about (5, -2): area 48, and 48 (8^2 + 6^2) / 12 about its middle."""
    corners = 5.0 - 2.0j + np.array([-4.0 - 3.0j, 4.0 - 3.0j, 4.0 + 3.0j, -4.0 + 3.0j])
    area, first, second = moments_of(corners)
    assert area == pytest.approx(48.0)
    assert first == pytest.approx(48.0 * (5.0 - 2.0j))
    assert second == pytest.approx(48.0 * (100.0 / 12.0 + 29.0))


@pytest.mark.judges("trains")
def test_a_bar_has_round_ends_and_its_width() -> None:
    outline = _bar_mm([0.0, 30.0 + 40.0j], 8.0, 0.01)
    area, first, _ = moments_of(outline @ [1.0, 1.0j])
    assert 0.0 < 8.0 * 50.0 + 16.0 * pi - area < 0.01 * 8.0 * pi
    assert first / area == pytest.approx(15.0 + 20.0j)


@pytest.mark.judges("trains")
def test_a_tip_moves_over_the_ground_at_its_lowest_place() -> None:
    """Three tips at 30 r/min pass every 2/3 s: 600 mm/s of ground go by 400 mm, and the tip slips by 600 - 550 mm/s."""
    train: Any = Made(traces=(0, 1, 2), cycle_rad=2.0 * pi, speed_rpm=30.0)
    places, speed = np.array([1.0 + 2.0j, 3.0 - 5.0j, 0.0]), np.array([1.0, -550.0 + 7.0j, 3.0])
    (_, said), figures = _over_ground(places, speed, train, 600.0)
    assert figures == pytest.approx({"forward_mm_s": 600.0, "spacing_mm": 400.0, "lowest_speed_over_ground_mm_s": 50.0})
    assert "every 400 mm of ground, there 50 mm/s" in said


# --- drawings


@pytest.mark.judges("drawings")
def test_cubics_between_ends_are_those_of_hermite() -> None:
    low, high = np.array([[1.0, 4.0], [2.0, -1.0], [0.5, 3.0]]), np.array([[3.0, 4.5], [5.0, 2.0], [-1.0, 0.2]])
    found = _cubics(low, high)
    for step in range(2):
        curve = CubicHermiteSpline(*np.stack([low[:, step], high[:, step]], axis=1))
        at = low[0, step] + np.array(LOOKED_AT) * (high[0, step] - low[0, step])
        assert found[:, step] == pytest.approx(curve(at))
