"""Internal pairs: a driving gear inside a driven ring, from the law that allows it to the solid that is written."""

from __future__ import annotations

from functools import cache
from math import pi

import numpy as np
import pytest
from mpmath import mp

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import CurvePoints, PitchCurve
from ncgear.pitch.internal import LEAST_RATIO
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from test_pitch import turned

DISTANCE = 60.0

every_gear = pytest.mark.parametrize("gear", list(Gear), ids=lambda gear: gear.value)

VARIABLE = "2 + 0.3*cos(phi)"
"""Its mean is 2, but the mean of its inverse is not 1/2: it is scaled to close."""


@cache
def variable_law() -> Transmission:
    """A ratio that varies about 2, for one lobe on two."""
    return ratio_expression_law(VARIABLE, Lobes(1, 2), scale_to_close=True)


@cache
def variable() -> PitchPair:
    """The internal pair of that law, 60 teeth in a ring of 120."""
    return sized_pair(variable_law(), 60, None, DISTANCE, Mesh.INTERNAL)


def curve(of: PitchPair, gear: Gear) -> PitchCurve:
    """One of the two curves."""
    return of.driving if gear is Gear.DRIVING else of.driven


# --- circles -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("lobes", [Lobes(1, 2), Lobes(1, 3), Lobes(2, 3), Lobes(7, 8)])
def test_a_constant_ratio_makes_a_circle_in_a_circle(lobes: Lobes) -> None:
    found = sized_pair(uniform_law(lobes), 21 * lobes.driving, None, DISTANCE, Mesh.INTERNAL)
    radii = {
        Gear.DRIVING: DISTANCE * lobes.driving / (lobes.driven - lobes.driving),
        Gear.DRIVEN: DISTANCE * lobes.driven / (lobes.driven - lobes.driving),
    }
    for gear, outward in ((Gear.DRIVING, 1.0), (Gear.DRIVEN, -1.0)):
        radius = radii[gear]
        points = curve(found, gear).at_angle(np.linspace(0.0, 9.0, 31))
        assert np.hypot(*points.position.T) == pytest.approx(np.full(31, radius), rel=1e-13)
        assert points.normal == pytest.approx(outward * points.position / radius, abs=1e-14)
        # The ring's material lies outside its curve and is concave
        assert points.curvature == pytest.approx(np.full(31, outward / radius), rel=1e-13)
        assert found.length_mm(gear) == pytest.approx(2.0 * pi * radius, rel=1e-13)
        # As closed curves both are convex
        assert found.convex(gear)
        assert found.least_radius_mm(gear) == pytest.approx(radius, rel=1e-13)
        assert found.least_concave_radius_mm(gear) is None
        assert found.concave_ranges(gear) == []
    assert found.size.driven_teeth == 21 * lobes.driven
    assert found.size.module_mm == pytest.approx(2.0 * DISTANCE / (21 * (lobes.driven - lobes.driving)), rel=1e-13)
    assert found.pitch_point_mm(np.array([0.0, 1.0])) == pytest.approx([-radii[Gear.DRIVING]] * 2, rel=1e-13)
    assert found.largest_tangent_angle_rad.value == pytest.approx(0.0, abs=1e-15)


# --- rolling -------------------------------------------------------------------------------------------------------

ANGLES = np.linspace(0.05, 4.0 * pi, 43)
"""A turn of the ring, which is two of the driving gear."""


def exact_ratio(angle: float) -> mp.mpf:
    """The scaled ratio: the mean of 1/(2 + 0.3 cos) is 1/sqrt(4 - 0.09), and must be 1/2 for one lobe on two."""
    return (2 + mp.mpf("0.3") * mp.cos(mp.mpf(angle))) * 2 / mp.sqrt(4 - mp.mpf("0.09"))


def test_the_closed_form_of_the_scaled_ratio_is_the_laws() -> None:
    slope = variable_law().driven_angle(ANGLES, 1).derivative(1)
    assert 1.0 / slope == pytest.approx([float(exact_ratio(angle)) for angle in ANGLES], rel=1e-13)


def assembled(of: PitchPair, phi1: Array) -> tuple[CurvePoints, CurvePoints]:
    """The points that touch at driving angles, in the fixed frame: both gears turned in the same sense."""
    driven_angle = of.transmission.driven_angle(phi1).value
    driving, driven = of.driving.at_angle(phi1), of.driven.at_angle(phi1)
    axis = np.array([of.center_distance_mm, 0.0])
    return (
        CurvePoints(
            turned(driving.position, phi1),
            turned(driving.tangent, phi1),
            turned(driving.normal, phi1),
            driving.curvature,
        ),
        CurvePoints(
            turned(driven.position, driven_angle) + axis,
            turned(driven.tangent, driven_angle),
            turned(driven.normal, driven_angle),
            driven.curvature,
        ),
    )


def test_both_points_meet_beyond_the_driving_axis_where_velocities_agree() -> None:
    driving, driven = assembled(variable(), ANGLES)
    pitch_point = variable().pitch_point_mm(ANGLES)
    for points in (driving, driven):
        # 180 mm, angles of up to 12 rad rounded
        assert np.max(np.abs(points.position - np.column_stack([pitch_point, np.zeros(43)]))) <= 1e-12
    assert pitch_point.max() < 0.0
    slope = variable().transmission.driven_angle(ANGLES, 1).derivative(1)
    # w1 x = w2 (x - a): both gears turn counter-clockwise
    assert pitch_point == pytest.approx(slope * (pitch_point - DISTANCE), rel=1e-13)


def test_tangents_agree_and_the_normals_point_away_from_each_gears_material() -> None:
    driving, driven = assembled(variable(), ANGLES)
    assert np.max(np.abs(driving.tangent - driven.tangent)) <= 1e-13
    assert np.max(np.abs(driving.normal + driven.normal)) <= 1e-13
    assert np.all(driving.normal[:, 0] < 0.0)  # away from the driving axis, which lies to the right of the pitch point
    assert np.all(driven.normal[:, 0] > 0.0)  # towards both axes


@every_gear
def test_derivatives_along_the_curve_are_tangent_and_curvature(gear: Gear) -> None:
    """dX/dsigma = T and dT/dsigma = -k N by central differences, whose error of h^2 is extrapolated away."""
    of = curve(variable(), gear)
    sigma, tangents, bends = np.linspace(1.0, of.length_mm - 1.0, 37), [], []
    for step in (0.02, 0.01):
        before, after = of.at_length(sigma - step), of.at_length(sigma + step)
        tangents.append((after.position - before.position) / (2.0 * step))
        bends.append((after.tangent - before.tangent) / (2.0 * step))
    at = of.at_length(sigma)
    # Left: h^4 / 30 of the fifth derivative, 1e-8 / 1e4 mm^4; rounding 200 mm 1e-16 / h
    assert (4.0 * tangents[1] - tangents[0]) / 3.0 == pytest.approx(at.tangent, abs=1e-10)
    assert (4.0 * bends[1] - bends[0]) / 3.0 == pytest.approx(-at.curvature[:, None] * at.normal, abs=1e-11)


@every_gear
def test_arc_lengths_are_those_of_an_independent_quadrature(gear: Gear) -> None:
    """mpmath on r1 = a/(i - 1) and r2 = a i/(i - 1) from the ratio's own formula: the curves roll without slip."""

    def speed(angle: mp.mpf) -> mp.mpf:
        ratio = exact_ratio(angle)
        ratio_slope = mp.diff(exact_ratio, angle)
        radius = DISTANCE / (ratio - 1) if gear is Gear.DRIVING else DISTANCE * ratio / (ratio - 1)
        turned_by = 1 if gear is Gear.DRIVING else 1 / ratio
        return mp.hypot(radius * turned_by, DISTANCE * ratio_slope / (ratio - 1) ** 2)

    of = variable()
    for end in (1.0, 2.5, 2.0 * pi):
        expected = float(mp.quad(speed, mp.linspace(0, end, 5)))
        assert float(of.arc.length(np.array(end))) * DISTANCE == pytest.approx(expected, rel=1e-12)
    assert of.length_mm(Gear.DRIVEN) == pytest.approx(2.0 * of.length_mm(Gear.DRIVING), rel=1e-13)


def test_curvatures_differ_as_euler_and_savary_say() -> None:
    """The common tangent turns by w1 dphi - k1 dsigma on one gear and by w2 dphi + k2 dsigma on the other."""
    of = variable()
    slope = of.transmission.driven_angle(ANGLES, 1).derivative(1)
    total = of.driving.at_angle(ANGLES).curvature + of.driven.at_angle(ANGLES).curvature
    speed = np.gradient(of.arc.length(np.linspace(-1e-4, 1e-4, 3)[:, None] + ANGLES) * DISTANCE, 1e-4, axis=0)[1]
    assert total == pytest.approx((1.0 - slope) / speed, rel=1e-7)


# --- refusals ------------------------------------------------------------------------------------------------------


def test_a_ratio_that_falls_to_one_is_refused_with_its_angle() -> None:
    law = ratio_expression_law("2 + 1.2*cos(phi)", Lobes(1, 2), scale_to_close=True)
    with pytest.raises(NoSuchMechanism, match=r"phi1 = 3\.14\d* rad") as caught:
        sized_pair(law, 60, 2.0, None, Mesh.INTERNAL)
    assert caught.value.key == "gears.mesh"
    assert f"{law.ratio_range[0].value:.6g}" in caught.value.problem
    assert "a smaller range of the ratio" in caught.value.problem
    assert sized_pair(law, 60, 2.0, None).center_distance_mm > 0.0


@pytest.mark.parametrize("lobes", [Lobes(), Lobes(2, 1)])
def test_too_few_driven_lobes_are_named(lobes: Lobes) -> None:
    with pytest.raises(NoSuchMechanism, match="more lobes of the driven gear") as caught:
        sized_pair(uniform_law(lobes), 60, 2.0, None, Mesh.INTERNAL)
    assert caught.value.key == "gears.mesh"


def nearly_one(least: float) -> Transmission:
    """A closed ratio c (1 + e cos) whose least value c (1 - e) is given; it closes where c = 2 / sqrt(1 - e^2)."""
    depth = (4.0 - least**2) / (4.0 + least**2)
    return ratio_expression_law(f"1 + {depth!r}*cos(phi)", Lobes(1, 2), scale_to_close=True)


def test_the_least_ratio_that_makes_a_ring() -> None:
    law = nearly_one(LEAST_RATIO + 1e-6)
    assert law.ratio_range[0].value == pytest.approx(LEAST_RATIO + 1e-6, rel=1e-9)
    pair = sized_pair(law, 6000, None, 1.0, Mesh.INTERNAL)
    assert -pair.pitch_point_mm(np.array([pi]))[0] == pytest.approx(1.0 / (LEAST_RATIO + 1e-6 - 1.0), rel=1e-6)
    with pytest.raises(NoSuchMechanism, match=r"falls to 1\.0009 at"):
        sized_pair(nearly_one(LEAST_RATIO - 1e-4), 6000, None, 1.0, Mesh.INTERNAL)
