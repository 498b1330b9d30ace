"""Borders at which a thing is refused, and drawings of a few lines: by hand, where whole designs seldom come."""

from __future__ import annotations

import os
from contextlib import nullcontext
from math import pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from pydantic import ValidationError

from at_once import at_once
from ncgear.cli.arguments import pasted
from ncgear.contact.designed.extremes import ValueRange, _settled
from ncgear.contact.written.as_written import require_reached
from ncgear.design.keys.pitch_shapes import RationalCurve
from ncgear.drawings.charts.teeth_charts import backlash, transmission_error
from ncgear.drawings.scene.standing import SUPPORT, supports_mm
from ncgear.dynamics.history import PER_TURN, _slide, even_times_s
from ncgear.errors import NoSuchMechanism
from ncgear.figures.advice.given_advice import BEYOND_ALL, _is_empty
from ncgear.figures.advice.strength_advice import THINNEST_WEB, _thin_body
from ncgear.figures.numbers import to_size
from ncgear.files.workshop.sheet_files import _circle
from ncgear.files.workshop.sheets.sheet import Ring
from ncgear.kinematics.check import SIDE_RAD, both_sides_rad
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.mechanisms.rack_pinion import TEETH, RackPinion
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.metrology.round_tool import _free
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Gear
from ncgear.ratio.return_stroke import ReturnLaw
from ncgear.ratio.sampled_strokes import Returns
from ncgear.teeth.sides import refuse_sharp_curve, refuse_sharp_places
from ncgear.teeth.tool import gouged_mm, least_concave_radius_mm
from ncgear.tolerances.iso286 import LEAST_MM, standard_tolerance_mm
from ncgear.trains.contact import _Meeting
from ncgear.trains.planetary_told import _closing
from ncgear.wishes.constant_speed import ConstantSpeed
from ncgear.wishes.positions import Position
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, SpeedWithin, TimeWithin
from pairs import rack

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
@pytest.mark.parametrize("place", range(3))
def test_one_clearance_that_is_no_number_is_refused(place: int) -> None:
    """Play upwards or downwards at one of three positions, or one of two tips."""
    values = [np.array([0.1, 0.1, 0.1]), np.array([0.1, 0.1, 0.1]), np.array([0.2, 0.2])]
    outlines = Made(source="csv")
    require_reached(outlines, Made(up_rad=values[0], down_rad=values[1]), *values[2])
    values[place][1] = np.nan if place == 2 else np.inf
    with pytest.raises(NoSuchMechanism, match="do not reach each other"):
        require_reached(outlines, Made(up_rad=values[0], down_rad=values[1]), *values[2])


@pytest.mark.judges("drawings")
def test_a_support_stands_evenly_under_its_axis() -> None:
    linkage = Made(crank_mm=100.0, pivots_mm={"first": (0.0, 5.0), "rocker": (210.0, -20.0)}, guides_mm=())
    lines = supports_mm(linkage)
    assert len(lines) == 4
    for (x, y), wedge, ground in zip(linkage.pivots_mm.values(), lines[::2], lines[1::2], strict=True):
        assert wedge[1] == pytest.approx([x, y])
        for line in (wedge, ground):
            assert line[0] + line[-1] == pytest.approx([2.0 * x, 2.0 * (y - SUPPORT * 100.0)])
            assert line[0, 0] < x < line[-1, 0]
        assert wedge[2, 0] - wedge[0, 0] == pytest.approx(2.0 * SUPPORT * 100.0)


@pytest.mark.judges("drawings")
def test_errors_and_play_are_drawn_in_millionths_of_a_rad() -> None:
    angle = np.array([0.0, 1.0, 2.0])
    placement = Made(phi1_rad=angle, cycle_rad=3.0)
    designed = Made(
        placement=placement,
        phi1_rad=angle,
        pushing=Made(error_rad=np.array([1e-5, 2e-5, 3e-5])),
        backlash_rad=np.array([4e-4, 5e-4, 6e-4]),
    )
    written = [Made(transmission_error_rad=worst, pushing_rad=worst * np.ones(3)) for worst in (1e-6, 7e-6)]
    chart = transmission_error(Made(as_designed=designed, as_written=written))
    assert chart.lines[0].values == pytest.approx([10.0, 20.0, 30.0])
    assert chart.lines[1].values == pytest.approx([7.0, 7.0, 7.0])
    assert backlash(designed).lines[0].values == pytest.approx([400.0, 500.0, 600.0])


@pytest.mark.judges("design")
@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, ""),
        ({"weights": [1.0, -1.0]}, "must be over 0"),
        ({"weights": [0.0, 1.0]}, "must be over 0"),
        ({"knots": [0.0, 0.0, 1.0, 0.5]}, "must rise"),
        ({"knots": [0.0, 1.0, 1.0, 1.0]}, "no length"),
        ({"knots": [0.0, 0.0, 1.0]}, "2 control points need as many weights, and 4 knots"),
        ({"degree": 2, "knots": [0.0, 0.0, 0.0, 1.0, 1.0]}, "more control points than the degree"),
    ],
)
def test_a_part_of_a_contour_is_a_curve(changed: dict[str, Any], said: str) -> None:
    given = {"degree": 1, "knots": [0.0, 0.0, 1.0, 1.0], "x": [0.0, 1.0], "y": [0.0, 2.0], "weights": [1.0, 0.5]}
    with pytest.raises(ValidationError, match=said) if said else nullcontext():
        RationalCurve.model_validate(given | changed)


@pytest.mark.judges("figures")
def test_lengths_in_files_have_eight_digits_of_the_largest() -> None:
    assert [to_size(1.23456789, largest) for largest in (1.5, 15.0, 150.0, 0.15)] == [
        1.2345679,
        1.234568,
        1.23457,
        1.23456789,
    ]


@pytest.mark.judges("figures")
def test_a_web_is_thin_by_its_share_of_the_face() -> None:
    for more, thin in ((0.99, True), (1.01, False)):
        body = Made(web=Made(thickness_mm=more * THINNEST_WEB * 20.0))
        gears = Made(face_width_mm=20.0, driving=Made(web=None), driven=body)
        assert bool(_thin_body(Made(gears=gears))) is thin


@pytest.mark.judges("figures")
def test_a_time_is_asked_for_in_vain_where_every_ratio_keeps_it() -> None:
    """A stretch of 1 rad takes 1 over the greatest ratio to the greatest ratio; the rest of the turn likewise."""
    cycle, stretch = 2.0 * np.pi, CrankStretch(0.5, 1.5)
    drive, rest = Made(transmission=Made(cycle_rad=cycle)), cycle - 1.0
    least, most = max(1.0 / BEYOND_ALL, cycle - rest * BEYOND_ALL), min(BEYOND_ALL, cycle - rest / BEYOND_ALL)
    assert _is_empty(drive, TimeWithin(stretch, 0.99 * least, 1.01 * most))
    assert not _is_empty(drive, TimeWithin(stretch, 1.01 * least, 1.01 * most))
    assert not _is_empty(drive, TimeWithin(stretch, 0.99 * least, 0.99 * most))


@pytest.mark.judges("figures")
def test_speeds_and_decelerations_are_asked_for_in_vain_where_every_ratio_keeps_them() -> None:
    """Of a yoke, x = c (1 - cos(phi)): speeds w c s sin(phi), s at most R; decelerations w^2 c (s^2 cos + s s' sin).

    s' is at most (1 + R) R.  Whatever is asked up to these bounds is asked for; a tenth beyond them nothing is.
    """
    crank, speed, most = 30.0, 4.0, BEYOND_ALL
    linkage = ScotchYoke(crank)
    drive = Made(linkage=linkage, machine=Made(speed_rad_s=speed), transmission=Made(cycle_rad=2.0 * np.pi))
    stretch = CrankStretch(0.4, 1.2)
    highest, lowest = speed * crank * most * np.sin(1.2), speed * crank / most * np.sin(0.4)
    assert _is_empty(drive, SpeedWithin(stretch, 0.9 * lowest, 1.1 * highest))
    assert not _is_empty(drive, SpeedWithin(stretch, 1.001 * lowest, 1.1 * highest))
    assert not _is_empty(drive, SpeedWithin(stretch, 0.9 * lowest, 0.999 * highest))
    phi = np.linspace(0.4, 1.2, 1001)
    hardest = speed**2 * crank * float((most**2 * np.cos(phi) + most * (1.0 + most) * most * np.sin(phi)).max())
    assert _is_empty(drive, DecelerationWithin(stretch, 1.1 * hardest))
    assert not _is_empty(drive, DecelerationWithin(stretch, 0.999 * hardest))
    # Over so little the ratio itself changes by exp((1 + R) R 0.001) at most.
    short = CrankStretch(1.0, 1.001)
    spread = np.sin(1.001) / np.sin(1.0) * np.exp((1.0 + most) * most * 0.001)
    assert _is_empty(drive, EvenSpeed(short, 1.2 * spread))
    assert not _is_empty(drive, EvenSpeed(short, 0.999 * spread))
    assert not _is_empty(drive, EvenSpeed(CrankStretch(0.0, 0.5), 1e9))


@pytest.mark.judges("dynamics")
def test_a_course_is_told_at_even_times_so_many_in_a_turn() -> None:
    course = Made(states=np.array([[0.5, 0.5 + 5.0 * np.pi]]), time_s=np.array([0.0, 3.0]))
    times = even_times_s(course)
    assert (times.size, times[0], times[-1]) == (round(2.5 * PER_TURN) + 1, 0.0, 3.0)
    assert np.ptp(np.diff(times)) < 1e-12
    assert even_times_s(course, 9 * PER_TURN).size == 9 * PER_TURN + 1


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("left", [0.0, 0.3])
def test_a_free_disc_touches_the_other_point(left: float) -> None:
    """Its middle is its radius and what is left away along the normal, and its radius away from the other point."""
    generator = np.random.default_rng(2)
    point, other = generator.normal(size=(2, 50, 2))
    turn = generator.uniform(0.0, 6.3, 50)
    normal = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    radius = _free(point, normal, other, left)
    middle = point + normal * (radius + left)[:, None]
    touching = (radius > 0.0) & np.isfinite(radius)
    assert touching.sum() > 10
    assert np.hypot(*(middle - other).T)[touching] == pytest.approx(radius[touching])


@pytest.mark.judges("mechanisms")
def test_a_drawn_pinion_has_the_heights_of_its_rack() -> None:
    module = 2.0 * 40.0 / TEETH
    radii = np.hypot(*np.array(RackPinion(40.0)._pinion()).T)
    assert (radii.min(), radii.max()) == pytest.approx((40.0 - 1.25 * module, 40.0 + module))


@pytest.mark.judges("tolerances")
def test_widths_below_the_standard_go_with_the_size() -> None:
    least = standard_tolerance_mm(7, LEAST_MM)
    assert least is not None
    assert standard_tolerance_mm(7, LEAST_MM / 4.0) == pytest.approx(least / 4.0)


@pytest.mark.judges("teeth")
@pytest.mark.parametrize("sharpest", [1.99, -1.99, 2.01, -2.01])
def test_a_place_sharper_than_a_quarter_of_the_module_is_refused(sharpest: float) -> None:
    """On a bulge or in a hollow, of the curve alone and of a law's pair, with its radius and angle."""
    curve = Made(
        curvature_bounds=(min(sharpest, -0.01), max(sharpest, 0.01)),
        panels_mm=np.linspace(0.0, 10.0, 21),
        curvature_at=lambda sigma: sharpest * np.exp(-((sigma - 5.0) ** 2)),
        driving_angle=lambda sigma: sigma / 10.0,
    )
    ends = tuple(Extremum(value, 0.5) for value in curve.curvature_bounds)
    level = (Extremum(0.01, 0.0), Extremum(0.01, 0.0))
    ranges = {Gear.DRIVING: level, Gear.DRIVEN: ends}
    round_curve = Made(curvature_bounds=(0.01, 0.01))
    curves = {Gear.DRIVING: round_curve, Gear.DRIVEN: curve}
    pair = Made(size=Made(module_mm=2.0), of=curves.__getitem__, curvature_range=ranges)
    for refuse in (lambda: refuse_sharp_curve(curve, 2.0, "gears.teeth"), lambda: refuse_sharp_places(pair)):
        if abs(sharpest) < 2.0:
            refuse()
        else:
            with pytest.raises(NoSuchMechanism, match=r"radius of 0\.4975 mm at phi1 = 0\.5 rad"):
                refuse()


@pytest.mark.judges("teeth")
def test_a_rack_cuts_into_a_round_hollow_by_the_square_of_its_way() -> None:
    """sin(alpha) w^2 / (2 R) over the way w of the straight edge, in steps of a sixteenth of the module."""
    basic, radius = rack(), 150.0
    hollow = Made(
        length_mm=60.0,
        bends_below=lambda limit: -1.0 / radius < limit,
        at_length=lambda sigma: Made(curvature=np.full(sigma.shape, -1.0 / radius)),
    )
    sine, cosine = np.sin(basic.pressure_angle_rad), np.cos(basic.pressure_angle_rad)
    way = (basic.tip_height_mm + basic.flank_depth_mm) / (sine * cosine)
    step = basic.module_mm / 16.0
    way = np.ceil(way / step) * step
    assert gouged_mm(hollow, basic) == pytest.approx(sine * way**2 / (2.0 * radius), rel=1e-3)
    # A tool as round as the hollow goes in, and one half as flat cuts half as deep.
    assert gouged_mm(hollow, basic, 1.0 / radius) == 0.0
    assert gouged_mm(hollow, basic, 0.5 / radius) == pytest.approx(sine * way**2 / (4.0 * radius), rel=1e-3)


@pytest.mark.judges("teeth")
def test_the_least_concave_radius_is_that_of_the_sharper_hollow() -> None:
    def pair(*least: float) -> Any:
        ends = {gear: (Extremum(one, 0.0), Extremum(1.0, 0.0)) for gear, one in zip(Gear, least, strict=True)}
        return Made(curvature_range=ends, center_distance_mm=80.0)

    assert least_concave_radius_mm(pair(-0.1, -0.02)) == pytest.approx(10.0)
    assert least_concave_radius_mm(pair(0.3, -0.02)) == pytest.approx(50.0)
    assert least_concave_radius_mm(pair(0.3, 0.1)) is None


@pytest.mark.judges("dynamics")
def test_a_slider_moves_by_the_chain_rule() -> None:
    """Of the cube of an angle: 3 a^2 w, and 6 a w^2 + 3 a^2 times the angle's acceleration."""
    angle, speed, faster = np.array([0.5, 2.0]), np.array([3.0, 0.25]), np.array([-1.0, 4.0])
    found = _slide(Jet(np.stack([angle**3, 3.0 * angle**2, 3.0 * angle])), speed, faster)
    assert found.displacement == pytest.approx(angle**3)
    assert found.velocity == pytest.approx(3.0 * angle**2 * speed)
    assert found.acceleration == pytest.approx(6.0 * angle * speed**2 + 3.0 * angle**2 * faster)


@pytest.mark.judges("wishes")
def test_a_wished_speed_is_a_band_about_it_and_a_place_is_one_too() -> None:
    """1 % about 200 mm/s over a stretch; 2 mm about 30 mm, where a yoke of 40 mm is at 60 deg."""
    yoke = ScotchYoke(40.0)
    (asked,) = ConstantSpeed(from_mm=20.0, to_mm=60.0, tolerance=0.01, speed_mm_s=200.0).requirements(yoke, 2.0 * pi)
    assert isinstance(asked, SpeedWithin)
    assert (asked.least_mm_s, asked.most_mm_s) == pytest.approx((198.0, 202.0))
    machine = Made(
        linkage=yoke, extended_rad=pi, displacement=lambda phi, order: Made(value=40.0 * (1.0 - np.cos(phi)))
    )
    told = Position(at_mm=30.0, phi1_rad=pi / 3.0, tolerance_mm=2.0).outcome(machine)
    assert (told.achieved, told.least, told.most, told.missed_by) == pytest.approx((20.0, 28.0, 32.0, 8.0))


@pytest.mark.judges("contact")
def test_a_small_pressure_angle_is_zero_only_within_rounding() -> None:
    def least(low: float) -> float:
        return _settled(ValueRange(Extremum(low, 1.0), Extremum(0.5, 2.0))).low.value

    assert [least(1e-6), least(4e-7)] == [1e-6, 0.0]


@pytest.mark.judges("mechanisms")
def test_a_pinion_works_over_one_turn() -> None:
    assert RackPinion(12.0).working_angle_rad == pytest.approx(2.0 * pi)


@pytest.mark.judges("trains")
def test_the_deeper_of_two_parts_tells_how_deep_they_are_in_each_other() -> None:
    """A corner of 90 deg goes 1 mm into a straight side: the side's points are at most 1/sqrt(2) mm in the corner."""
    side = np.linspace(0.0, 1.0, 201)[:-1]
    corners = np.array([[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]])
    square = np.concatenate(
        [a + side[:, None] * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]
    )
    turn = np.exp(1j * pi / 4.0)
    meeting, place = _Meeting(square, square, ring=False), 5.0 + 5.0 * np.sqrt(2.0) - 1.0
    deep, gap = meeting.depth_mm(place, turn), meeting.gap_mm(place, turn)
    assert (deep, gap) == (pytest.approx(1.0, abs=1e-9), pytest.approx(0.0, abs=1e-9))


@pytest.mark.judges("trains")
def test_a_train_closes_where_parts_turn_whole_times_against_the_carrier() -> None:
    """The carrier goes 0.3 turns on, and a planet 2.3: the train stands as at first about the carrier."""

    def train(turns: float) -> Any:
        angles = 2.0 * pi * np.array([[0.0, 0.3], [0.0, turns]])
        return Made(poses_at=lambda _: Made(angle_rad=angles), cycle_rad=2.0 * pi, number=lambda _: 0)

    assert (_closing(train(2.3)).holds, _closing(train(2.4)).holds) == (True, False)


@pytest.mark.judges("cli")
def test_a_path_with_blanks_is_quoted_for_the_shell_at_hand() -> None:
    """Within single quotes, where a shell of Unix expands nothing; of Windows within double ones."""
    assert pasted(Path("a b/$x.yaml")) == ('"a b\\$x.yaml"' if os.name == "nt" else "'a b/$x.yaml'")


@pytest.mark.judges("kinematics")
def test_both_sides_of_a_jump_are_within_the_range() -> None:
    told = both_sides_rad([0.0, 1.0], 2.0)
    assert told.tolist() == [0.0, SIDE_RAD, 1.0 - SIDE_RAD, 1.0, 1.0 + SIDE_RAD]


@pytest.mark.judges("files")
def test_a_circle_on_a_sheet_goes_round_its_centre() -> None:
    """Quarters from compass point to compass point, whose middles are on the circle to a thousandth."""
    words = _circle(Ring((10.0, 20.0), 5.0)).split()
    places = np.array([float(word) for word in words if word not in "mc"]).reshape(-1, 2) @ [1.0, 1.0j]
    assert words.count("c") == 4
    quarters = np.array([places[at : at + 4] for at in range(0, 12, 3)])
    assert np.angle(quarters[:, 0] - (10.0 + 20.0j)) == pytest.approx([0.0, pi / 2.0, pi, -pi / 2.0], abs=1e-4)
    middles = quarters @ np.array([1.0, 3.0, 3.0, 1.0]) / 8.0
    assert np.abs(middles - (10.0 + 20.0j)) == pytest.approx(5.0, rel=1e-3)
    assert places[-1] == pytest.approx(places[0])


@pytest.mark.judges("ratio")
def test_a_sampled_return_is_a_cubic_and_a_skew_bump() -> None:
    """A quarter into a return of 2 rad: tau^2 (1 - tau)^2 is 9/256, and the skew counts half against the bump."""
    returns = Returns(np.zeros((4, 2)), np.array([3.0, 0.0]), np.array([2.0, 2.0]), np.array([2.0, 2.0]))
    assert returns.at(np.array([0.5, 0.5])) == pytest.approx([2.0 * 9.0 / 256.0, -9.0 / 256.0])


@pytest.mark.judges("ratio")
@at_once(("inverse", "value"), [(True, 3.0), (False, 1.0 / 3.0)])
def test_a_return_is_its_polynomial_and_what_closes_it(inverse: bool, value: float) -> None:
    """At tau = 3/4, a quarter beyond the place of the least value: 1.25 + 4/4, and 3/4 that close the cycle."""
    parts = {"local": Polynomial([1.25, 4.0]), "about": 0.5, "correction": Polynomial([0.0, 1.0])}
    stroke: Any = Made(ends=Made(start_rad=1.0, length_rad=2.0), inverse=inverse, **parts)
    assert ReturnLaw.slope(stroke, np.array([2.5]), 0).value == pytest.approx(value)
