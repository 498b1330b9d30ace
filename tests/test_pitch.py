"""Pitch curves against circles, ellipses and the laws of rolling, and the published baler against mpmath."""

from __future__ import annotations

import itertools
from functools import cache
from math import cos, hypot, pi, radians, sin, sqrt

import numpy as np
import pytest
from mpmath import mp
from numpy.polynomial import Chebyshev, legendre

from at_once import at_once
from ncgear.design.keys import gears
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch import shape
from ncgear.pitch.arc_length import FEW
from ncgear.pitch.curve import CurvePoints
from ncgear.pitch.pair import MOST_TEETH, PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission
from oracles import stroke as oracle
from pairs import one_of
from plane import turned
from test_laws import LAWS, law

DISTANCE = 200.0


def pair_of(transmission: Transmission, distance: float = DISTANCE) -> PitchPair:
    """A pair of 25 teeth a lobe at a centre distance."""
    return sized_pair(transmission, 25 * transmission.lobes.driving, None, distance)


@cache
def pair(name: str) -> PitchPair:
    """The pair of a law of the list, made once."""
    return pair_of(law(name))


every_law = at_once("name", LAWS)
every_gear = at_once("gear", list(Gear))


# --- circles -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("lobes", [Lobes(), Lobes(1, 2), Lobes(3, 2)])
def test_a_constant_ratio_makes_circles(lobes: Lobes) -> None:
    found = pair_of(uniform_law(lobes))
    radii = {Gear.DRIVING: lobes.driving, Gear.DRIVEN: lobes.driven}
    for gear, share in radii.items():
        radius = DISTANCE * share / (lobes.driving + lobes.driven)
        points = one_of(found, gear).at_angle(np.linspace(0.0, 9.0, 31))
        assert np.hypot(*points.position.T) == pytest.approx(np.full(31, radius), rel=1e-14)
        assert points.curvature == pytest.approx(np.full(31, 1.0 / radius), rel=1e-14)
        assert points.normal == pytest.approx(points.position / radius, abs=1e-14)
        assert one_of(found, gear).length_mm == pytest.approx(2.0 * pi * radius, rel=1e-14)
        assert found.length_mm(gear) == pytest.approx(2.0 * pi * radius, rel=1e-14)
        assert found.convex(gear)
        assert found.least_radius_mm(gear) == pytest.approx(radius, rel=1e-14)
        assert found.least_concave_radius_mm(gear) is None
        assert found.concave_ranges(gear) == []
    assert found.largest_tangent_angle_rad.value == pytest.approx(0.0, abs=1e-15)
    assert found.largest_pressure_angle_deg(radians(20.0)) == pytest.approx(20.0, rel=1e-14)


# --- ellipses ------------------------------------------------------------------------------------------------------

ELLIPSES = [(0.1, 0.0), (0.35, 3.49), (0.7, -1.2)]
every_ellipse = at_once(("eccentricity", "phase"), ELLIPSES)


def focal_distances(positions: Array, eccentricity: float, direction: float) -> tuple[Array, Array]:
    """Distances from the axis and from the other focus; ``direction`` is the polar angle of the nearest point."""
    other = -DISTANCE * eccentricity * np.array([cos(direction), sin(direction)])
    return np.hypot(*positions.T), np.hypot(*(positions - other).T)


@pytest.mark.judges("pitch")
@every_ellipse
@every_gear
def test_elliptical_gears_are_ellipses_about_a_focus(eccentricity: float, phase: float, gear: Gear) -> None:
    """The string construction: distances from both foci add up to the centre distance, the major axis.

    Points of the driving gear meet the centre line at polar angle -phi1; the driven gear meets its nearest point half
    a turn of its ellipse later, in the opposite direction of the line.
    """
    transmission = elliptical_law(eccentricity, phase, Lobes())
    phi1 = np.linspace(0.0, 2.0 * pi, 61)
    points = one_of(pair_of(transmission), gear).at_angle(phi1)
    if gear is Gear.DRIVING:
        direction = -phase
    else:
        direction = pi + float(transmission.driven_angle(np.array([phase + pi])).value[0])
    near, far = focal_distances(points.position, eccentricity, direction)
    # Lengths of 200 mm from ten operations: 1e-13 relative allows for angles of up to 4 pi, rounded
    assert near + far == pytest.approx(np.full(61, DISTANCE), rel=1e-13)
    # k = A B / (d1 d2)^(3/2), A and B the half axes
    half_axes = (DISTANCE / 2.0) ** 2 * sqrt(1.0 - eccentricity**2)
    assert points.curvature == pytest.approx(half_axes / (near * far) ** 1.5, rel=1e-11)


@every_ellipse
@every_gear
def test_perimeter_and_curvature_range_of_the_ellipse(eccentricity: float, phase: float, gear: Gear) -> None:
    found = pair_of(elliptical_law(eccentricity, phase, Lobes()))
    perimeter = float(4 * mp.mpf(DISTANCE) / 2 * mp.ellipe(mp.mpf(eccentricity) ** 2))
    assert one_of(found, gear).length_mm == pytest.approx(perimeter, rel=1e-13)
    assert found.length_mm(gear) == pytest.approx(perimeter, rel=1e-13)
    half = DISTANCE / 2.0
    low, high = found.curvature_range[gear]
    # B / A^2 at the ends of the minor axis, A / B^2 at those of the major
    assert low.value == pytest.approx(sqrt(1.0 - eccentricity**2) / half, rel=1e-12)
    assert high.value == pytest.approx(1.0 / (half * (1.0 - eccentricity**2)), rel=1e-12)
    assert found.least_radius_mm(gear) == pytest.approx(half * (1.0 - eccentricity**2), rel=1e-12)
    assert found.convex(gear)


@every_ellipse
def test_the_ellipse_is_steepest_where_its_focal_radii_are_equal(eccentricity: float, phase: float) -> None:
    """tan of the tangent's angle is r'/r = e sin x / (1 + e cos x), largest e / sqrt(1 - e^2), so its sine is e."""
    steepest = pair_of(elliptical_law(eccentricity, phase, Lobes())).largest_tangent_angle_rad
    assert sin(steepest.value) == pytest.approx(eccentricity, rel=1e-12)


# --- rolling, for every law ----------------------------------------------------------------------------------------


def angles_of(transmission: Transmission, count: int = 41) -> Array:
    """Driving angles over a whole cycle, joints left out."""
    return np.linspace(0.003, 0.997, count) * transmission.cycle_rad


@every_law
def test_both_points_are_on_the_centre_line_together(name: str) -> None:
    found = pair(name)
    phi1 = angles_of(found.transmission)
    series = found.transmission.driven_angle(phi1, 1)
    driving = turned(found.driving.at_angle(phi1).position, phi1)
    driven = turned(found.driven.at_angle(phi1).position, -series.value) + np.array([DISTANCE, 0.0])
    ratio = 1.0 / series.derivative(1)
    exact = np.column_stack([DISTANCE / (1.0 + ratio), np.zeros(phi1.size)])
    # Angles up to 6 pi carry rounding of 2e-15, times the 200 mm
    assert np.max(np.abs(driving - exact)) <= 2e-12
    assert np.max(np.abs(driven - exact)) <= 2e-12


@every_law
def test_tangents_agree_and_normals_are_opposite(name: str) -> None:
    found = pair(name)
    phi1 = angles_of(found.transmission)
    driven_angle = found.transmission.driven_angle(phi1).value
    driving, driven = found.driving.at_angle(phi1), found.driven.at_angle(phi1)
    tangents = [turned(driving.tangent, phi1), turned(driven.tangent, -driven_angle)]
    normals = [turned(driving.normal, phi1), turned(driven.normal, -driven_angle)]
    assert np.max(np.abs(tangents[0] - tangents[1])) <= 1e-13  # unit vectors; rounding of the angles and slopes
    assert np.max(np.abs(normals[0] + normals[1])) <= 1e-13
    assert np.max(np.abs(np.sum(tangents[0] * normals[0], axis=1))) <= 1e-15
    assert np.all(normals[0][:, 0] > 0.0)  # away from the driving gear's axis


@every_law
@every_gear
def test_the_curves_roll_without_slip(name: str, gear: Gear) -> None:
    """Arc length of each curve as a chord sum of its own points, extrapolated, against the arc length in common."""
    found = pair(name)
    piece = found.transmission.pieces[0]
    end = piece.knots_rad[0] if piece.knots_rad else piece.end_rad
    start, lengths = 0.1 * end, []
    for count in (512, 1024, 2048):
        points = one_of(found, gear).at_angle(np.linspace(start, 0.9 * end, count + 1)).position
        lengths.append(float(np.hypot(*np.diff(points, axis=0).T).sum()))
    once = [(4.0 * fine - coarse) / 3.0 for coarse, fine in itertools.pairwise(lengths)]
    extrapolated = (16.0 * once[1] - once[0]) / 15.0
    low, high = found.arc.length(np.array([start, 0.9 * end])) * DISTANCE
    # Chord sums have an error series in h^2; two extrapolations leave h^6, below 1e-9 for the sharpest of these laws
    assert extrapolated == pytest.approx(float(high - low), rel=1e-9)


@every_law
def test_both_gears_have_lengths_in_the_ratio_of_their_lobes(name: str) -> None:
    found, lobes = pair(name), law(name).lobes
    driving, driven = found.length_mm(Gear.DRIVING), found.length_mm(Gear.DRIVEN)
    assert driving / lobes.driving == pytest.approx(driven / lobes.driven, rel=1e-12)  # the agreement promised
    for gear in Gear:
        assert one_of(found, gear).length_mm == pytest.approx(found.length_mm(gear), rel=1e-12)
    assert found.size.module_mm * pi * found.size.driven_teeth == pytest.approx(driven, rel=1e-12)


@every_law
def test_arc_length_and_its_inverse(name: str) -> None:
    found = pair(name)
    arc, turn = found.arc, found.transmission.cycle_rad
    phi1 = np.concatenate([np.linspace(-1.3, 2.4, 301) * turn, found.transmission.joints_rad])
    back = arc.angle(arc.length(phi1))
    # The round trip's promise; angles of up to 2.4 turns
    assert np.max(np.abs(back - phi1)) <= 1e-12 * turn
    assert np.all(np.diff(arc.length(np.sort(phi1))) >= 0.0)
    assert arc.length(np.array([2.0 * arc.angle_period_rad]))[0] == pytest.approx(2.0 * arc.period, rel=1e-14)


@every_law
@every_gear
def test_the_curve_closes_after_its_own_turn(name: str, gear: Gear) -> None:
    of = one_of(pair(name), gear)
    turn = of.turn_rad
    assert turn == pytest.approx(2.0 * pi if gear is Gear.DRIVING else pair(name).transmission.cycle_rad, rel=1e-15)
    phi1 = np.linspace(0.003, 0.997, 23) * turn
    once, again = of.at_angle(phi1), of.at_angle(phi1 + turn)
    assert np.max(np.abs(once.position - again.position)) <= 1e-11  # 1e-12 rad of closure, 200 mm, half of it
    assert np.max(np.abs(once.tangent - again.tangent)) <= 1e-11
    both = of.at_length(np.array([0.0, of.length_mm, 1e-9 - of.length_mm])).position
    assert np.max(np.abs(both - both[0])) <= 1e-8


@every_law
@every_gear
def test_lobes_repeat_by_rotation(name: str, gear: Gear) -> None:
    of, lobes = one_of(pair(name), gear), law(name).lobes
    count = lobes.driving if gear is Gear.DRIVING else lobes.driven
    side = -1.0 if gear is Gear.DRIVING else 1.0
    phi1 = np.linspace(0.01, 0.99, 17) * lobes.driving_period_rad
    first, second = of.at_angle(phi1), of.at_angle(phi1 + lobes.driving_period_rad)
    step = np.full(17, side * 2.0 * pi / count)
    assert np.max(np.abs(turned(first.position, step) - second.position)) <= 1e-11


def stacked(points: CurvePoints, size: float) -> Array:
    """All columns of curve points at unit size."""
    return np.column_stack([points.position / size, points.tangent, points.normal, points.curvature * size])


@every_law
@every_gear
def test_points_by_length_are_points_by_angle(name: str, gear: Gear) -> None:
    of = one_of(pair(name), gear)
    sigma = np.linspace(0.003, 0.997, 47) * of.length_mm
    by_length = stacked(of.at_length(sigma), DISTANCE)
    by_angle = stacked(of.at_angle(of.driving_angle(sigma)), DISTANCE)
    scale = np.maximum(np.abs(by_angle).max(), 1.0)
    # Chebyshev forms resolved to 4e-15 of the largest column, the curvature, through an angle inverted to 1e-14
    assert np.max(np.abs(by_length - by_angle)) <= 1e-11 * scale
    assert of.at_length(sigma.reshape(1, 47)).position.shape == (1, 47, 2)


@every_law
@every_gear
def test_tangent_and_curvature_are_derivatives_along_the_curve(name: str, gear: Gear) -> None:
    """Interpolants of position and tangent over a short stretch by arc length, differentiated in its middle."""
    of, joints = one_of(pair(name), gear), pair(name).transmission.joints_rad
    for low, high in list(itertools.pairwise(joints))[::7]:
        ends = of.arc.length(np.array([low, high])) * DISTANCE
        centre, half = float(ends.mean()), min(0.3 * float(ends[1] - ends[0]), 4.0)
        sigma = centre + half * np.cos(np.pi * (np.arange(13) + 0.5) / 13.0)
        around, at = of.at_angle(of.driving_angle(sigma)), of.at_angle(of.driving_angle(np.array([centre])))
        domain = [centre - half, centre + half]
        slope = [Chebyshev.fit(sigma, column, 12, domain=domain).deriv()(centre) for column in around.position.T]
        bend = [Chebyshev.fit(sigma, column, 12, domain=domain).deriv()(centre) for column in around.tangent.T]
        # Rounding of 200 mm amplified by 12^2 / half width
        assert slope == pytest.approx(at.tangent[0], abs=200.0 * 1e-14 * 144.0 / half + 1e-10)
        # Convex bends turn the tangent against the outward normal: dt/ds = -k n
        assert bend == pytest.approx(-at.curvature[0] * at.normal[0], abs=1e-13 * 144.0 / half + 1e-9)


@pytest.mark.tiers(quick=["driven"], rest="slow")
@every_law
@pytest.mark.parametrize("gear", list(Gear), ids=lambda gear: gear.value)
def test_curvature_range_bounds_a_dense_sample(name: str, gear: Gear) -> None:
    found = pair(name)
    phi1 = np.linspace(0.0, found.transmission.lobes.driving_period_rad, 8009)[:-1]
    sampled = one_of(found, gear).at_angle(phi1).curvature
    low, high = found.curvature_range[gear]
    slack = 1e-11 * max(abs(low.value), abs(high.value))  # rounding of two derivatives, one evaluation against another
    assert low.value <= sampled.min() + slack
    assert high.value >= sampled.max() - slack
    assert found.convex(gear) == bool(sampled.min() * DISTANCE >= -1e-9)
    # Reached by the sample but for half a step off an end or a top
    reach = high.value - low.value
    assert sampled.min() - low.value <= 0.01 * reach + slack
    assert high.value - sampled.max() <= 0.01 * reach + slack


@pytest.mark.tiers(quick=["driven"], rest="slow")
@every_law
@pytest.mark.parametrize("gear", list(Gear), ids=lambda gear: gear.value)
def test_curvature_between_arc_lengths_bounds_a_dense_sample(name: str, gear: Gear) -> None:
    """Also across the seam, from another turn, over several turns and at a single place."""
    curve = one_of(pair(name), gear)
    first = np.array([-2.1, -0.01, 0.0, 0.02, 0.3, 0.3, 1.95, 7.0]) * curve.length_mm
    last = first + np.array([0.2, 0.02, 1.0, 0.0, 0.001, 0.3, 0.1, 2.5]) * curve.length_mm
    low, high = curve.curvature_between(first, last)
    curvature = curve.at_length(np.linspace(first, last, 4_001)).curvature
    rounding = 1e-12 * np.abs(curvature).max()
    assert np.all(low <= curvature.min(axis=0) + rounding)
    assert np.all(high >= curvature.max(axis=0) - rounding)
    # Both lie on whole cells, of which there are a hundred at least.
    spread = np.ptp(curvature[:, 2])
    assert np.all(curvature.min(axis=0) - low <= 0.2 * spread + rounding)
    assert np.all(high - curvature.max(axis=0) <= 0.2 * spread + rounding)


@pytest.mark.tiers(quick=["driven"], rest="thorough")
@every_law
@pytest.mark.parametrize("gear", list(Gear), ids=lambda gear: gear.value)
def test_curve_bends_below_what_is_more_than_its_least_curvature(name: str, gear: Gear) -> None:
    """The least curvature is that of the closed form, the answer comes from the Chebyshev form."""
    found = pair(name)
    low, high = (extremum.value for extremum in found.curvature_range[gear])
    aside = 1e-9 * max(abs(low), abs(high))
    assert not one_of(found, gear).bends_below(low - aside)
    assert one_of(found, gear).bends_below(low + aside)


@every_law
@every_gear
def test_concave_ranges_are_where_curvature_is_negative(name: str, gear: Gear) -> None:
    found = pair(name)
    period = found.transmission.lobes.driving_period_rad
    phi1 = np.linspace(0.0, period, 3001)[:-1]
    curvature = one_of(found, gear).at_angle(phi1).curvature * DISTANCE
    ranges, step = found.concave_ranges(gear), 1e-9
    inside = np.zeros(phi1.size, dtype=bool)
    near = np.zeros(phi1.size, dtype=bool)
    for start, end in ranges:
        # Samples have the right-hand limit at a joint, where a stretch may end.
        inside |= (phi1 >= start) & (phi1 < end - 1e-9)
        near |= (phi1 >= start - 1.01 * step) & (phi1 <= end + 1.01 * step)
    assert np.all(curvature[inside] < 1e-6 * np.abs(curvature).max())
    assert np.all(curvature[~near] >= -1e-9)
    if found.convex(gear):
        assert not ranges


def test_a_dent_narrower_than_any_even_samples_is_told() -> None:
    """A ratio that wavers by a part in a million, 0.4 mrad wide: its curve is dented there and nowhere else."""
    knots = (1.2345 - 2e-3, 1.2345 - 4e-4, 1.2345, 1.2345 + 4e-4, 1.2345 + 2e-3)

    def driven_angle(phi1: Array, order: int) -> Jet:
        angle = Jet.variable(phi1, order)
        apart = (angle - 1.2345) * (1.0 / 2e-4)
        return angle + jet.exp(-(apart * apart)) * 2e-8

    law = Transmission((Piece(0.0, 2.0 * pi, driven_angle, knots),), Lobes())
    found = sized_pair(law, 20, 2.0, None)
    ranges = found.concave_ranges(Gear.DRIVING)
    assert not found.convex(Gear.DRIVING)
    assert ranges
    for start, end in ranges:
        assert 1.2345 - 1e-3 < start < end < 1.2345 + 1e-3
        ends = found.driving.at_angle(np.array([start, (start + end) / 2.0, end])).curvature
        assert ends[1] < -1e-3
        assert ends[[0, 2]] == pytest.approx(0.0, abs=1e-6)


@every_law
def test_largest_tangent_angle_bounds_a_dense_sample(name: str) -> None:
    found = pair(name)
    phi1 = np.linspace(0.0, found.transmission.lobes.driving_period_rad, 8009)[:-1]
    tangents = turned(found.driving.at_angle(phi1).tangent, phi1)
    steep = np.arcsin(np.clip(np.abs(tangents[:, 0]), 0.0, 1.0)).max()
    largest = found.largest_tangent_angle_rad.value
    assert steep <= largest + 1e-12
    assert steep == pytest.approx(largest, abs=1e-3)  # half a step, 4e-4 rad, off a joint where it may be a corner
    assert found.largest_pressure_angle_deg(radians(20.0)) == pytest.approx(np.degrees(largest) + 20.0, rel=1e-14)


# --- the published baler at 200 mm ---------------------------------------------------------------------------------


@cache
def exact_cycle() -> oracle.Cycle:
    """The oracle's law of Table 1 with e = 0."""
    return oracle.cycle(oracle.BALER, "0")


def exact_radius(phi1: Array) -> Array:
    """The driving pitch radius by the oracle's ratio."""
    return np.array([DISTANCE / (1.0 + float(exact_cycle().ratio(angle))) for angle in phi1.tolist()])


@cache
def exact_radii() -> list[tuple[tuple[float, float], Chebyshev]]:
    """The driving radius on each of the four parts, a Chebyshev interpolant of 50-digit ratios at 48 points."""
    joints = [0.0, 0.7 * pi, pi, 1.3 * pi, 2.0 * pi]
    parts = []
    for low, high in itertools.pairwise(joints):
        parts.append(((low, high), Chebyshev.interpolate(exact_radius, 47, domain=[low, high])))
    return parts


@pytest.mark.slow
def test_the_interpolants_of_the_exact_radius_are_resolved() -> None:
    for _, radius in exact_radii():
        assert np.abs(radius.coef[-3:]).max() <= 1e-11 * DISTANCE


@pytest.mark.slow
def test_baler_length_against_quadrature_of_the_exact_law() -> None:
    """629.2813 mm, not the 628.94 mm that a coarse sample gives."""
    unit, weights = legendre.leggauss(200)
    total = 0.0
    for (low, high), radius in exact_radii():
        phi1 = (low + high) / 2.0 + (high - low) / 2.0 * unit
        total += (high - low) / 2.0 * float(weights @ np.hypot(radius(phi1), radius.deriv()(phi1)))
    assert total == pytest.approx(629.2813, abs=5e-5)
    assert pair("stroke, e = 0").driving.length_mm == pytest.approx(total, rel=1e-10)  # the interpolant's derivative


def exact_curvatures(gear: Gear) -> list[tuple[float, float]]:
    """Driving angle and curvature from the interpolants: k = (r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^(3/2)."""
    found = []
    for (low, high), radius in exact_radii():
        phi1 = np.linspace(low, high, 1501)
        r, r1, r2 = radius(phi1), radius.deriv()(phi1), radius.deriv(2)(phi1)
        if gear is Gear.DRIVEN:
            # d phi2 = w d phi1, w = r / (a - r); the driven radius is a - r
            w, w1 = r / (DISTANCE - r), r1 * DISTANCE / (DISTANCE - r) ** 2
            r, r1, r2 = DISTANCE - r, -r1 / w, -(r2 - r1 * w1 / w) / w**2
        curvature = (r**2 + 2.0 * r1**2 - r * r2) / np.hypot(r, r1) ** 3
        found += list(zip(phi1.tolist(), curvature.tolist(), strict=True))
    return found


@pytest.mark.slow
@every_gear
def test_baler_curvature_range_against_the_exact_law(gear: Gear) -> None:
    low, high = pair("stroke, e = 0").curvature_range[gear]
    values = exact_curvatures(gear)
    # A sample of 1500 to a part: half a step of 7e-4 rad off a top; both ends of each part are sampled
    assert min(values, key=lambda v: v[1])[1] == pytest.approx(low.value, rel=1e-5)
    assert max(values, key=lambda v: v[1])[1] == pytest.approx(high.value, rel=1e-5)


def test_baler_figures_at_200_mm() -> None:
    """Known independently: concave radius 36.66 (about 37), smallest driven radius about 20 mm, not convex."""
    found = pair("stroke, e = 0")
    assert not found.convex(Gear.DRIVING)
    concave = found.least_concave_radius_mm(Gear.DRIVING)
    assert concave == pytest.approx(36.66, abs=0.005)
    assert found.least_radius_mm(Gear.DRIVEN) == pytest.approx(20.0, abs=0.5)


@pytest.mark.slow
def test_baler_curvature_jumps_at_its_inner_joints() -> None:
    """Acceleration is continuous at theta2 and theta3 but its derivative is not, so the curvature jumps there."""
    jumps = pair("stroke, e = 0").curvature_jumps()
    assert [jump.phi1_rad for jump in jumps] == pytest.approx([0.0, 0.7 * pi, pi, 1.3 * pi])
    for jump in jumps[1:3]:
        sides = [exact_side(jump.phi1_rad, after) for after in (False, True)]
        # Two derivatives at the end of an interpolant of degree 47 multiply rounding by 47^4 / 3 and more
        assert (jump.driving_before, jump.driving_after) == pytest.approx(tuple(sides), abs=1e-8)
        assert abs(jump.driving_after - jump.driving_before) > 1e-3 / DISTANCE


@pytest.mark.parametrize(("lobes", "rise"), [(Lobes(), 0.04), (Lobes(2, 1), -0.07), (Lobes(1, 2), 0.02)])
def test_a_law_whose_slope_jumps_where_the_cycle_begins_again_has_no_gears(lobes: Lobes, rise: float) -> None:
    """No number of teeth helps: the message has the corner of the pitch curve, by r = a / (1 + i)."""
    period = lobes.driving_period_rad
    bowed = ratio_expression_law(f"1 + {rise}*phi*({period!r} - phi)", lobes, scale_to_close=True)
    # The law scales the expression, which is 1 there, to the ratio that closes the cycle
    ratio = 1.0 / float(bowed.driven_angle(np.zeros(1), 1).derivative(1)[0])
    slope = np.array([-1.0, 1.0]) * rise * period
    corner = np.degrees(np.diff(np.arctan(ratio * slope / (1.0 + ratio))))[0]
    with pytest.raises(NoSuchMechanism) as caught:
        sized_pair(bowed, 40 * lobes.driving, 2.0, None)
    assert f"a corner of {abs(corner):.4g} deg at phi1 = 0 rad" in caught.value.problem
    assert "where the cycle begins again" in caught.value.problem
    assert "more teeth" not in caught.value.problem


def test_a_slope_that_jumps_by_a_rounding_is_no_corner() -> None:
    wave = ratio_expression_law("1 + 0.1*sin(phi) + 1e-7*phi*(2*pi - phi)", Lobes(), scale_to_close=True)
    assert sized_pair(wave, 40, 2.0, None).size.driven_teeth == 40


def exact_side(joint: float, after: bool) -> float:
    """Exact driving curvature just before or after a joint."""
    index = 0 if after else 1
    (_, radius) = next(part for part in exact_radii() if abs(part[0][index] - joint) < 1e-9)
    r, r1, r2 = (float(radius.deriv(k)(joint)) if k else float(radius(joint)) for k in range(3))
    return (r**2 + 2.0 * r1**2 - r * r2) / hypot(r, r1) ** 3


def test_a_scaled_pair_is_the_same_pair() -> None:
    small, large = pair("stroke, e = 0"), pair_of(law("stroke, e = 0"), 3.0 * DISTANCE)
    for gear in Gear:
        assert large.length_mm(gear) == pytest.approx(3.0 * small.length_mm(gear), rel=1e-14)
        assert large.least_radius_mm(gear) == pytest.approx(3.0 * small.least_radius_mm(gear), rel=1e-14)
    assert large.largest_tangent_angle_rad == small.largest_tangent_angle_rad


@every_gear
def test_shape_functions_are_consistent_with_each_other(gear: Gear) -> None:
    """r1 + r2 = 1, r1 = w r2, and arc speed from radius and its slope."""
    slope = law("driven angle").pieces[0].slope(np.linspace(0.1, 6.0, 20), 3)
    radii = [shape.radius(slope, each, Mesh.EXTERNAL).value for each in Gear]
    assert radii[0] + radii[1] == pytest.approx(np.ones(20), rel=1e-15)
    assert radii[0] / radii[1] == pytest.approx(slope.value, rel=1e-14)
    speeds = shape.speed(slope, gear, Mesh.EXTERNAL).value
    own = 1.0 if gear is Gear.DRIVING else slope.value
    radius_slope = shape.radius_slope(slope, gear, Mesh.EXTERNAL).value
    assert speeds == pytest.approx(
        own * np.hypot(shape.radius(slope, gear, Mesh.EXTERNAL).value, radius_slope), rel=1e-14
    )


def test_more_teeth_than_a_file_may_ask_for_are_refused() -> None:
    law = uniform_law(Lobes(1, 1))
    assert MOST_TEETH == gears.MOST_TEETH
    assert sized_pair(law, None, 0.02, 0.02 * MOST_TEETH).size.driving_teeth == MOST_TEETH
    with pytest.raises(WrongInput, match="10000 at most are right"):
        sized_pair(law, None, 0.02, 0.02 * (MOST_TEETH + 1))


def test_the_second_gear_gets_from_the_first_what_both_ask_of_the_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """It asks for nothing where the first has asked already, and gets the same points as without it."""
    asked, plain = [], Transmission.driven_angle

    def counted(transmission: Transmission, phi1: Array, order: int = 0) -> Jet:
        asked.append(np.size(phi1))
        return plain(transmission, phi1, order)

    transmission, phi1 = elliptical_law(0.3, 0.0, Lobes()), np.linspace(0.0, 6.0, 31)
    both, alone = pair_of(transmission), pair_of(transmission)
    monkeypatch.setattr(Transmission, "driven_angle", counted)
    both.driving.at_angle(phi1)
    assert asked == [31]
    found = both.driven.at_angle(phi1)
    assert asked == [31]
    assert np.array_equal(found.position, alone.driven.at_angle(phi1).position)
    assert asked == [31, 31]


def test_answers_for_the_other_gear_do_not_pile_up_where_one_is_asked_alone() -> None:
    found = pair_of(law("spline"))
    for angle in range(50):
        found.driving.at_angle(np.array([0.1 * angle]))
    assert 0 < len(found.driving.arc._asked) <= FEW
