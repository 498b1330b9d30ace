"""Flanks: the involute in closed form, the law of gearing, derivatives, cusps, tip relief, where teeth stand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest
from scipy.optimize import brentq

from at_once import at_once
from ncgear.numerics.plane import as_complex
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import FILLET, FLANK, Flanks, flanks_of
from ncgear.teeth.form import BasicRack, TipRelief
from ncgear.teeth.tool import RackLine
from oracles.rack_cut import involute
from pairs import baler_law, rack
from plane import cross, fourth_order, turned

MODULE = 2.0
ALPHA = radians(20.0)

LAWS: dict[str, tuple[Callable[[], Transmission], int]] = {
    "uniform": (lambda: uniform_law(Lobes(1, 2)), 24),
    "ellipse": (lambda: elliptical_law(0.35, 0.0, Lobes()), 37),
    "ellipse 2:3": (lambda: elliptical_law(0.15, 0.4, Lobes(2, 3)), 30),
    "expression": (lambda: driven_angle_expression_law("phi - 0.08*sin(2*phi)", Lobes()), 25),
    "baler": (baler_law, 25),
}

Array = np.ndarray


@cache
def pitch_pair(name: str) -> PitchPair:
    """The pitch curves of one of the laws at module 2."""
    law, teeth = LAWS[name][0](), LAWS[name][1]
    return sized_pair(law, teeth, MODULE, None)


def flanks(
    name: str,
    gear: Gear,
    basic: BasicRack | None = None,
    half_widths_mm: tuple[float, float] | None = None,
    turn_rad: float = 0.0,
) -> Flanks:
    """The flanks of one gear, at full height and depth."""
    pair, basic = pitch_pair(name), basic or rack()
    if gear is Gear.DRIVING:
        return flanks_of(pair.driving, basic, pair.size.driving_teeth, RackLine(), 0.0, half_widths_mm, turn_rad)
    start, teeth = basic.pitch_mm / 2.0, pair.size.driven_teeth
    return flanks_of(pair.driven, basic, teeth, RackLine(), start, half_widths_mm, turn_rad)


def pitch_radius(gear: Gear) -> float:
    """Of the uniform pair, in closed form."""
    return LAWS["uniform"][1] * MODULE / 2.0 * (1.0 if gear is Gear.DRIVING else 2.0)


def wrapped(angle: Array) -> Array:
    """Angles brought to -pi..pi."""
    return np.mod(angle + pi, 2.0 * pi) - pi


# --- circular gears ----------------------------------------------------------------------------------------------


@at_once("gear", Gear)
@at_once("turn_rad", [0.0, 0.003, -0.02])
def test_flank_of_a_circular_gear_is_the_involute(gear: Gear, turn_rad: float) -> None:
    own, radius = flanks("uniform", gear, turn_rad=turn_rad), pitch_radius(gear)
    number = np.arange(own.count)[:, None]
    point, _ = own.flank(number, np.linspace(-0.9, 0.95, 31) * MODULE)
    distance = np.hypot(point[..., 0], point[..., 1])
    # The driving gear's arc length runs clockwise from polar angle 0, the driven one's counter-clockwise from pi.
    sense, start, first = (-1.0, 0.0, 0.0) if gear is Gear.DRIVING else (1.0, pi, 0.5)
    middle = (number // 2 + first) * 2.0 * pi / own.tooth.max()
    half = pi * MODULE / 4.0 / radius + involute(ALPHA) - involute(np.arccos(radius * cos(ALPHA) / distance))
    # Back flanks stand turned against the clock.
    expected = start + sense * (middle + own.side[:, None] * half) + np.where(own.side < 0.0, turn_rad, 0.0)[:, None]
    error = distance * wrapped(np.arctan2(point[..., 1], point[..., 0]) - expected)
    # Rounding: a few dozen units of 1e-16, more near the base circle where the involute's angle goes as a square root.
    assert np.max(np.abs(error)) < 1e-12 * radius
    assert distance.min() < radius - 0.5 * MODULE < radius + 0.9 * MODULE < distance.max()


@pytest.mark.parametrize("gear", Gear)
def test_cusp_of_a_circular_gear_is_on_its_base_circle(gear: Gear) -> None:
    own, every = flanks("uniform", gear), np.arange(2)
    height = -pitch_radius(gear) * sin(ALPHA) ** 2
    point, slope = own.flank(every, np.full(2, height))
    assert np.hypot(*point.T) == pytest.approx(pitch_radius(gear) * cos(ALPHA), rel=1e-14)
    assert np.abs(slope).max() < 1e-13
    assert own.regularity(every, np.full(2, height)) == pytest.approx(0.0, abs=1e-14)


# --- law of gearing ----------------------------------------------------------------------------------------------


def mates(own: Flanks, other: Flanks, number: Array) -> Array:
    """The other gear's flanks that cross the pitch curve at the same arc length, cycle after cycle."""
    gap = np.mod(own.crossing_mm[number][:, None] - other.crossing_mm + 1e-6, other.curve.length_mm)
    found = np.argmin(gap, axis=1)
    assert np.max(gap[np.arange(number.size), found]) < 2e-6
    return found


class Meeting:
    """Random contacts of a pair of gears, each placed in the fixed frame as the law says."""

    def __init__(self, name: str, count: int = 400) -> None:
        random = np.random.default_rng(20)
        self.pair, law = pitch_pair(name), pitch_pair(name).transmission
        own, other = flanks(name, Gear.DRIVING), flanks(name, Gear.DRIVEN)
        number = random.integers(own.count, size=count)
        self.height = random.uniform(-0.99, 0.99, count) * MODULE
        sigma = own.rolled_mm(number, self.height)
        self.phi1 = own.curve.driving_angle(sigma)
        angle = law.driven_angle(self.phi1, 1)
        self.phi2, self.speed = angle.value, angle.derivative(1)
        self.mate = mates(own, other, number)
        self.axis = np.array([self.pair.center_distance_mm, 0.0])
        self.own, self.own_along = self._placed(own.flank(number, self.height), self.phi1, 0.0 * self.axis)
        self.other, self.other_along = self._placed(other.flank(self.mate, -self.height), -self.phi2, self.axis)
        self.sides = own.side[number], other.side[self.mate]

    @staticmethod
    def _placed(flank: tuple[Array, Array], angle: Array, axis: Array) -> tuple[Array, Array]:
        point, slope = flank
        length = np.linalg.norm(slope, axis=1)[:, None]
        return turned(point, angle) + axis, turned(slope / length, angle)

    @property
    def pitch_point(self) -> Array:
        """On the line of centres, dividing it by the law's momentary ratio."""
        radius = self.pair.center_distance_mm * self.speed / (1.0 + self.speed)
        return np.column_stack([radius, np.zeros_like(radius)])


@at_once("name", LAWS)
def test_flanks_of_both_gears_touch_in_the_fixed_frame(name: str) -> None:
    meeting = Meeting(name)
    assert np.all(meeting.sides[0] == -meeting.sides[1])
    # Largest seen 2e-13 mm; frames turned by up to 2 pi at radii of 50 mm round to 1e-14 mm each.
    assert np.linalg.norm(meeting.own - meeting.other, axis=1).max() < 1e-11 * MODULE
    assert np.abs(cross(meeting.own_along, meeting.other_along)).max() < 1e-11


@at_once("name", LAWS)
def test_common_normal_goes_through_the_pitch_point(name: str) -> None:
    meeting = Meeting(name)
    arm = meeting.own - meeting.pitch_point
    for along in (meeting.own_along, meeting.other_along):
        assert np.abs(np.sum(arm * along, axis=1)).max() < 1e-11 * MODULE
    assert np.linalg.norm(arm, axis=1) == pytest.approx(np.abs(meeting.height) / sin(ALPHA), abs=1e-11)


@at_once("name", LAWS)
def test_touching_flanks_move_alike_along_their_normal(name: str) -> None:
    """The law of gearing itself, from both bodies' velocities by phi1; the driven gear turns the other way."""
    meeting = Meeting(name)
    normal = np.column_stack([-meeting.own_along[:, 1], meeting.own_along[:, 0]])
    own = np.column_stack([-meeting.own[:, 1], meeting.own[:, 0]])
    arm = meeting.other - meeting.axis
    other = -meeting.speed[:, None] * np.column_stack([-arm[:, 1], arm[:, 0]])
    assert np.abs(np.sum((own - other) * normal, axis=1)).max() < 1e-11 * MODULE


def test_a_wrong_driven_angle_parts_the_flanks() -> None:
    """Negative control: a millionth of a radian is seen as its arc."""
    meeting = Meeting("expression", 50)
    arm = meeting.other - meeting.axis
    parted = turned(arm, np.full(50, 1e-6)) + meeting.axis - meeting.own
    assert np.linalg.norm(parted, axis=1) == pytest.approx(1e-6 * np.linalg.norm(arm, axis=1), rel=1e-4)


# --- derivatives -------------------------------------------------------------------------------------------------


def smooth_places(own: Flanks, height: float) -> tuple[Array, Array]:
    """Flanks and heights, as far as no joint of the law is near."""
    every = np.arange(own.count)
    at = np.full(own.count, height)
    period = own.curve.arc.period * own.curve.center_distance_mm
    joints = own.curve.arc.length(own.curve.transmission.joints_rad) * own.curve.center_distance_mm
    gap = np.mod(own.rolled_mm(every, at)[:, None] - joints, period)
    far = np.min(np.minimum(gap, period - gap), axis=1) > 1.5 * MODULE
    return every[far], at[far]


RELIEF = TipRelief(0.02 * MODULE, 0.3 * MODULE, MODULE)


@at_once("name", ["uniform", "ellipse", "baler"])
@at_once("gear", Gear)
@at_once("relief", [None, RELIEF])
def test_derivatives_are_the_limits_of_fourth_order_differences(
    name: str, gear: Gear, relief: TipRelief | None
) -> None:
    own = flanks(name, gear, replace(rack(), relief=relief))
    number, at = smooth_places(own, 0.2 * MODULE if relief is None else 0.7 * MODULE)
    slope = own.flank(number, at)[1]
    step = 0.08 * MODULE  # flanks are so smooth that less would be lost in rounding
    coarse, fine = (
        np.linalg.norm(fourth_order(lambda t: own.flank(number, t)[0], at, step) - slope, axis=1).max()
        for step in (2.0 * step, step)
    )
    # Order 4: halving the step divides the error by 16, less what the sixth derivative and rounding (1e-12) add.
    assert coarse / fine == pytest.approx(16.0, rel=0.15)
    # A wrong derivative would stop the fall, so the rate judges to a tenth of this.
    assert fine < 1e-3


@pytest.mark.parametrize("gear", Gear)
def test_offset_curve_has_the_stated_derivative(gear: Gear) -> None:
    own = flanks("expression", gear)
    sigma = np.linspace(1.0, 150.0, 40)
    for height in (MODULE, -1.25 * MODULE):
        slope = own.offset(sigma, height)[1]
        coarse, fine = (
            np.abs(fourth_order(lambda s, h=height: own.offset(s, h)[0], sigma, step) - slope).max()
            for step in (0.2, 0.1)
        )
        assert coarse / fine == pytest.approx(16.0, rel=0.1)
        assert fine < 1e-6


@pytest.mark.parametrize("gear", Gear)
def test_mixed_curves_are_the_single_ones(gear: Gear) -> None:
    own = flanks("baler", gear)
    kind, number = np.array([FLANK, FILLET, FLANK, FILLET]), np.array([3, 8, 20, 2])
    at = np.where(kind == FLANK, 0.3, own.crossing_mm[number])
    points, slopes = own.curve_of(kind, number, at)
    for k, i, t, point, slope in zip(kind, number, at, points, slopes, strict=True):
        single = (own.flank, own.fillet)[k](np.array([i]), np.array([t]))
        assert np.array_equal(single[0][0], point)
        assert np.array_equal(single[1][0], slope)


# --- cusps -----------------------------------------------------------------------------------------------------


@at_once("name", LAWS)
@at_once("gear", Gear)
def test_speed_of_a_flank_is_its_regularity(name: str, gear: Gear) -> None:
    own, number = flanks(name, gear), np.arange(flanks(name, gear).count)[:, None]
    height = np.linspace(-1.0, 1.0, 21) * MODULE
    speed = np.linalg.norm(own.flank(number, height)[1], axis=-1)
    expected = np.abs(own.regularity(number, height)) / (sin(ALPHA) ** 2 * cos(ALPHA))
    assert speed == pytest.approx(expected, abs=1e-13)


def cusps(own: Flanks) -> list[tuple[int, float]]:
    """Flanks whose regularity changes its sign, and the height at which it does, away from jumps."""
    heights = np.linspace(-0.99, 0.99, 199) * MODULE
    found = []
    for number in range(own.count):
        regular = own.regularity(np.full(heights.size, number), heights)
        for k in np.nonzero(np.diff(np.sign(regular)))[0]:

            def value(height: float, number: int = number) -> float:
                return float(own.regularity(np.array([number]), np.array([height]))[0])

            root = brentq(value, heights[k], heights[k + 1], xtol=1e-15)
            if abs(value(root)) < 1e-12:
                found.append((number, root))
    return found


@pytest.mark.parametrize("gear", Gear)
def test_flank_turns_back_where_its_regularity_changes_sign(gear: Gear) -> None:
    own = flanks("baler", gear)
    found = cusps(own)
    assert len(found) >= 10  # the baler's 25 teeth are undercut on sharp stretches of both gears
    step = 1e-4 * MODULE
    for number, height in found:
        around = height + step * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
        point, slope = own.flank(np.full(5, number), around)
        assert np.linalg.norm(slope[2]) < 1e-10
        before, after = point[1] - point[0], point[4] - point[3]
        cosine = before @ after / np.linalg.norm(before) / np.linalg.norm(after)
        # The curve comes back on itself: its two branches part as the 3/2 power of the distance.
        assert cosine < -0.999


@pytest.mark.parametrize("gear", Gear)
def test_regular_flanks_never_turn_back(gear: Gear) -> None:
    own, number = flanks("expression", gear), np.arange(flanks("expression", gear).count)[:, None]
    height = np.linspace(-0.99, 0.99, 199) * MODULE
    assert own.regularity(number, height).min() > 0.0
    chord = np.diff(own.flank(number, height)[0], axis=1)
    assert np.sum(chord[:, 1:] * chord[:, :-1], axis=-1).min() > 0.0


# --- where teeth stand -------------------------------------------------------------------------------------------


@at_once("name", LAWS)
@at_once("gear", Gear)
def test_flanks_stand_a_tooth_thickness_apart(name: str, gear: Gear) -> None:
    own = flanks(name, gear, half_widths_mm=(1.7, 1.5))
    thickness = 3.2
    assert own.crossing_mm[1::2] - own.crossing_mm[0::2] == pytest.approx(thickness, rel=1e-12)
    assert np.diff(own.crossing_mm[0::2]) == pytest.approx(pi * MODULE, rel=1e-12)
    assert np.array_equal(own.tooth[::2], np.arange(1, own.count // 2 + 1))
    assert list(own.side[:4]) == [-1.0, 1.0, -1.0, 1.0]


@at_once("name", LAWS)
@at_once("gear", Gear)
def test_loaded_flanks_stand_where_they_would_without_play(name: str, gear: Gear) -> None:
    """Flanks, fillets and all that turned back flanks roll on turn about the axis; front flanks stay as they are."""
    turn = 0.01
    plain, own = flanks(name, gear), flanks(name, gear, turn_rad=turn)
    every = np.arange(own.count)[:, None]
    height, sigma = np.array([[-1.2, 0.3, 1.7]]), own.crossing_mm[:, None] + np.array([[-3.0, 0.0, 3.0]])
    turned = np.exp(1j * np.where(own.side < 0.0, turn, 0.0))[:, None]
    for curve, at in (("flank", height), ("fillet", sigma)):
        found, before = (getattr(one, curve)(every, at) for one in (own, plain))
        for one, other in zip(found, before, strict=True):
            assert as_complex(one) == pytest.approx(as_complex(other) * turned, abs=1e-12)


def test_a_gear_advanced_by_whole_turns_keeps_its_teeth_where_they_are() -> None:
    pair = pitch_pair("baler")
    once, again = (
        flanks_of(pair.driving, rack(), 25, RackLine(), 0.3 + turns * pair.driving.length_mm) for turns in (0.0, 3.0)
    )
    assert again.crossing_mm == pytest.approx(once.crossing_mm, abs=1e-12)


# --- tip relief --------------------------------------------------------------------------------------------------


@at_once("name", ["uniform", "baler"])
@at_once("gear", Gear)
def test_relief_takes_its_amount_off_the_tip_and_nothing_below_its_start(name: str, gear: Gear) -> None:
    plain, own = flanks(name, gear), flanks(name, gear, replace(rack(), relief=RELIEF))
    number = np.arange(own.count)[:, None]
    height = np.linspace(-0.9, 1.0, 39) * MODULE
    taken = own.flank(number, height)[0] - plain.flank(number, height)[0]
    share = np.maximum(height - RELIEF.start_mm, 0.0) / (RELIEF.full_mm - RELIEF.start_mm)
    assert np.linalg.norm(taken, axis=-1) == pytest.approx(
        np.broadcast_to(RELIEF.amount_mm * share**2, (own.count, height.size)), abs=1e-13
    )
    assert np.all(taken[:, height <= RELIEF.start_mm] == 0.0)
    # Along the normal, into the tooth: the line from the touching point to the pitch point leads there.
    pitch_point = own.curve.at_length(own.rolled_mm(number, height)).position
    towards = pitch_point - plain.flank(number, height)[0]
    above = share > 0.0
    cross_product = taken[..., 0] * towards[..., 1] - taken[..., 1] * towards[..., 0]
    assert np.abs(cross_product)[:, above].max() < 1e-12
    assert np.sum(taken * towards, axis=-1)[:, above].min() > 0.0


@at_once("relief", [None, RELIEF])
@at_once("gear", Gear)
def test_the_curvature_of_a_flank_is_that_of_the_circle_through_three_near_points(
    relief: TipRelief | None, gear: Gear
) -> None:
    """On circular gears, whose rolling curve bends alike everywhere: 4 areas over the product of the sides."""
    own = flanks("uniform", gear, replace(rack(), relief=relief))
    number, near = np.arange(2)[:, None, None], np.array([-1e-4, 0.0, 1e-4]) * MODULE
    height = np.array([-0.4, 0.1, 0.6, 0.8, 0.95])[:, None] * MODULE
    points = own.flank(number, height + near)[0] @ np.array([1.0, 1.0j])
    first, second = np.diff(points).transpose(2, 0, 1)
    twice = np.abs(np.imag(np.conj(first) * second))
    found = 2.0 * twice / (np.abs(first) * np.abs(second) * np.abs(first + second))
    assert own.curvature(number[..., 0], height[:, 0]) == pytest.approx(found, rel=1e-4)


@pytest.mark.parametrize("gear", Gear)
def test_relief_begins_tangentially(gear: Gear) -> None:
    own, every = flanks("ellipse", gear, replace(rack(), relief=RELIEF)), np.arange(flanks("ellipse", gear).count)
    below, above = (
        own.flank(every, np.full(own.count, RELIEF.start_mm + aside))[1] for aside in (-1e-7 * MODULE, 1e-7 * MODULE)
    )
    assert np.linalg.norm(above - below, axis=1).max() < 1e-6


# --- the pitch curve ---------------------------------------------------------------------------------------------


@at_once("name", LAWS)
@at_once("gear", Gear)
def test_flank_is_on_the_pitch_curve_at_its_crossing(name: str, gear: Gear) -> None:
    own, every = flanks(name, gear), np.arange(flanks(name, gear).count)
    point = own.flank(every, np.zeros(own.count))[0]
    angle = own.curve.driving_angle(own.crossing_mm)
    # at_angle is the closed form, flank reads the Chebyshev form by arc length.
    assert np.linalg.norm(point - own.curve.at_angle(angle).position, axis=1).max() < 1e-11 * MODULE
