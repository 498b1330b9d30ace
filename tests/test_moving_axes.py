"""Gears on axes whose distance changes: pitch point by velocities, rolling, and teeth by polygons."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import pi

import numpy as np
import pytest
from mpmath import mp, mpc, mpf

import drives
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch.moving_axes import MovingAxes, even_distances, round_driving_law
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.trains.contact import contacts_of
from ncgear.trains.train import Poses

GIVEN_MM = np.array([60.0, 64.5, 68.0, 64.5])

train_of = partial(drives.train_of, "moving-axis")

ROUND = (("  distances_mm", "  round_driving: true\n  distances_mm"),)
UNEVEN = (("distances_mm: [60, 64.5, 68, 64.5]", "distance_mm: 64 - 3*cos(phi)\n  ratio: 1 + 0.2*sin(phi)"),)
LOBES = (("distances_mm: [60, 64.5, 68, 64.5]", "distances_mm: [60, 61, 60]\n  driving_lobes: 2\n  driven_lobes: 3"),)


@pytest.mark.judges("pitch")
def test_the_pitch_point_is_where_both_gears_have_one_velocity() -> None:
    """Material points of both gears by their motion, differentiated at 40 digits; nothing of the formula is used."""
    law = ratio_expression_law("1 + 0.2*sin(phi)", Lobes(), scale_to_close=True)
    axes = MovingAxes(law, even_distances(GIVEN_MM, 1))
    factor = float(law.driven_angle(np.zeros(1), 1).derivative(1)[0])
    with mp.workdps(40):

        def slope(phi: mpf) -> mpf:
            return mpf(factor) / (1 + mpf("0.2") * mp.sin(phi))

        def distance(phi: mpf) -> mpf:
            return mpf("64.25") - 4 * mp.cos(phi) - mpf("0.25") * mp.cos(2 * phi)

        for at in (0.0, 0.7, 2.3, 4.4):
            now = mpf(at)
            moving = mp.diff(distance, now)
            # v1 = i p, v2 = A' - i psi' (p - A): solved for p as two real equations.
            rate = slope(now)
            system = mp.matrix([[0, -1 - rate], [1 + rate, 0]])
            x, y = mp.lu_solve(system, mp.matrix([moving, rate * distance(now)]))
            point = mpc(x, y)
            step = mpf(10) ** -15

            def driving(to: mpf, point: mpc = point, now: mpf = now) -> mpc:
                return point * mp.exp(1j * (to - now))

            def driven(to: mpf, point: mpc = point, now: mpf = now, rate: mpf = rate) -> mpc:
                return distance(to) + (point - distance(now)) * mp.exp(-1j * rate * (to - now))

            speeds = [(way(now + step) - way(now - step)) / (2 * step) for way in (driving, driven)]
            assert abs(speeds[0] - speeds[1]) < mpf(10) ** -20
            found = axes.pitch_point(np.array([at]), 0)
            assert [one.value[0] for one in found] == pytest.approx([float(x), float(y)], abs=1e-11)


def test_distances_go_through_their_values() -> None:
    """Four values and their least polynomial by hand; an odd number; more lobes."""
    phi = np.linspace(0.0, 2.0 * pi, 33)
    found = even_distances(GIVEN_MM, 1)(phi, 1)
    assert found.value == pytest.approx(64.25 - 4.0 * np.cos(phi) - 0.25 * np.cos(2.0 * phi), rel=1e-14)
    assert found.derivative(1) == pytest.approx(4.0 * np.sin(phi) + 0.5 * np.sin(2.0 * phi), abs=1e-12)
    for values, lobes in (([60.0, 62.0, 61.0], 2), ([60.0, 62.0, 61.0, 63.0, 60.5, 60.0], 3)):
        steps = np.arange(2 * len(values)) * 2.0 * pi / len(values) / lobes
        assert even_distances(np.array(values), lobes)(np.asarray(steps), 0).value == pytest.approx(
            values * 2, rel=1e-14
        )


@pytest.mark.judges("pitch")
def test_at_a_fixed_distance_it_is_the_pair_of_the_law() -> None:
    law = elliptical_law(0.3, 0.4, Lobes(2, 3))
    pitch = sized_pair(law, 48, None, 80.0)
    axes = MovingAxes(law, lambda phi, order: Jet.variable(phi, order) * 0.0 + 80.0)
    for gear in Gear:
        sigma = np.linspace(0.0, pitch.of(gear).length_mm, 57)
        ours, theirs = axes.curve(gear).at_length(sigma), pitch.of(gear).at_length(sigma)
        for name in ("position", "tangent", "normal", "curvature"):
            assert getattr(ours, name) == pytest.approx(getattr(theirs, name), abs=1e-9)
        assert axes.curve(gear).mate_curvature(3.0) == pytest.approx(pitch.of(gear).mate_curvature(3.0), abs=1e-9)


@pytest.mark.judges("pitch")
def test_both_curves_roll_on_each_other() -> None:
    """Arc lengths of both by chords of many points, and contact of both curves at every position."""
    axes = MovingAxes(uniform_law(Lobes()), even_distances(GIVEN_MM, 1))
    driving, driven = (axes.curve(gear) for gear in Gear)
    phi = np.linspace(0.0, 2.0 * pi, 40_001)
    lengths = [np.abs(np.diff(path(phi)[0])).sum() for path in (axes.driving_path, axes.driven_path)]
    assert lengths == pytest.approx([driving.length_mm, driven.length_mm], rel=1e-8)
    assert driving.length_mm == pytest.approx(driven.length_mm, rel=1e-12)
    at = np.linspace(0.0, 6.0, 11)
    seen = axes.driving_path(at)[0] * np.exp(1j * at)
    others = axes.distance(at, 0).value + axes.driven_path(at)[0] * np.exp(-1j * at)
    assert seen == pytest.approx(others, abs=1e-11)
    # The sum of curvatures is what each curve's own says.
    sigma = driving.arc.length(at)
    both = driving.at_length(sigma).curvature + driven.at_length(sigma).curvature
    assert both == pytest.approx(axes.turning(at), rel=1e-8)


@pytest.mark.judges("pitch")
@pytest.mark.parametrize("lobes", [Lobes(), Lobes(2, 3)])
def test_a_round_driving_gear_has_a_mate_that_closes(lobes: Lobes) -> None:
    distance = even_distances(GIVEN_MM, lobes.driving)
    law, radius = round_driving_law(distance, lobes, "train.round_driving")
    phi = np.linspace(0.0, 2.0 * pi, 25)
    assert np.abs(MovingAxes(law, distance).driving_path(phi)[0]) == pytest.approx(np.full(25, radius), rel=1e-9)
    turned = law.driven_angle(np.array([2.0 * pi])).value[0]
    assert turned == pytest.approx(2.0 * pi * lobes.driving / lobes.driven, rel=1e-12)


def test_an_axis_that_is_too_fast_and_a_distance_that_jumps_are_refused() -> None:
    swinging = even_distances(np.array([30.0, 64.0, 98.0, 64.0]), 1)
    with pytest.raises(NoSuchMechanism, match="too fast for a round driving gear"):
        round_driving_law(swinging, Lobes(), "train.round_driving")
    with pytest.raises(NoSuchMechanism, match="distance jumps"):
        train_of((("distances_mm: [60, 64.5, 68, 64.5]", "distance_mm: 60 + phi"),))
    with pytest.raises(NoSuchMechanism, match="must be positive"):
        train_of((("distances_mm: [60, 64.5, 68, 64.5]", "distance_mm: 10 + 20*cos(phi)"),))
    with pytest.raises(WrongInput, match="leave it out"):
        train_of((("teeth: 48", "teeth: 48\n    module_mm: 2"),))
    with pytest.raises(DesignError) as refused:
        train_of((("distances_mm: [60, 64.5, 68, 64.5]", "distance_mm: 64 + 0*phi\n  ratio: cos(phi)"),))
    assert refused.value.key == "train.ratio"


@pytest.mark.slow
@pytest.mark.judges("trains")
@pytest.mark.parametrize(
    "changes", [(), *(pytest.param(one, marks=pytest.mark.slow) for one in (ROUND, UNEVEN, LOBES))]
)
def test_teeth_touch_and_do_not_overlap(changes: tuple[tuple[str, str], ...]) -> None:
    """By the polygons of both gears at many positions, and the distances that were asked for."""
    train = train_of(changes)
    (found,) = contacts_of(train, {part.name: part.outline_mm for part in train.parts})
    assert found.penetration_max_mm < train.tolerance_mm
    assert found.gap_max_mm < 3.0 * train.tolerance_mm
    if not changes:
        poses = train.poses_at(np.arange(4) * pi / 2.0)
        assert poses.x_mm[1] == pytest.approx(GIVEN_MM, rel=1e-14)


def test_a_cusp_of_a_pitch_curve_is_refused_where_it_is() -> None:
    """Where A + A'' vanishes both pitch curves of an even law stand still, here at cos(2 phi) = 2/3."""
    with pytest.raises(NoSuchMechanism, match="turn too sharply") as fault:
        train_of((("[60, 64.5, 68, 64.5]", "[60, 20, 60, 20]"),))
    assert fault.value.key == "train.distances_mm"
    told = float(str(fault.value).partition("phi1 = ")[2].split()[0])
    assert told == pytest.approx(np.arccos(2.0 / 3.0) / 2.0, abs=2.0 * pi / 1024)


@pytest.mark.slow
def test_the_same_gears_at_a_fixed_distance_clash() -> None:
    train = train_of()

    def poses_at(driving_rad: Array) -> Poses:
        poses = train.poses_at(driving_rad)
        return replace(poses, x_mm=np.stack([poses.x_mm[0], np.full(driving_rad.size, GIVEN_MM.mean())]))

    (found,) = contacts_of(replace(train, poses_at=poses_at), {part.name: part.outline_mm for part in train.parts})
    assert found.penetration_max_mm > 1.0


@pytest.mark.parametrize(("driving", "driven"), [(1, 1), (2, 3), (4, 2), (3, 6)])
def test_a_cycle_is_the_least_driving_angle_of_whole_turns_on_both_gears(driving: int, driven: int) -> None:
    """The driven gear makes as many turns for one of the driving gear as driving lobes over driven ones."""
    axes = MovingAxes(uniform_law(Lobes(driving, driven)), lambda phi, order: Jet(np.zeros((order + 1, phi.size))))
    turns = axes.cycle_rad / (2.0 * pi)
    whole = [one for one in range(1, 20) if one * driving % driven == 0]
    assert turns == pytest.approx(min(whole), rel=1e-12)
