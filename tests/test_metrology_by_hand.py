"""Measured gears and round tools on plain curves: circles, wheels that roll, poses of a few points, by closed forms."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.metrology.best_fit as best_fit
import ncgear.metrology.round_tool as round_tool
from at_once import at_once
from ncgear.metrology.best_fit import Pose
from ncgear.metrology.deviations import _in_order, is_metal
from ncgear.metrology.exact_outline import FLANK_CURVE, TIP_LAND_CURVE
from ncgear.teeth.flank import FILLET, FLANK

Made: Any = SimpleNamespace


# --- round tools


class Circles:
    """Two round bodies of 8 mm, their middles 22 mm apart along a direction: a gap of 6 mm between them."""

    kind = np.array([0, round_tool.ROOT_LAND])

    def __init__(self, towards: float, count: int = 71) -> None:
        self.middles = 11.0 * np.exp(1j * towards) * np.array([1.0, -1.0])
        self.share = np.arange(count) / count

    def at(self, place: Any) -> tuple[Any, Any]:
        """Points and normals out of the bodies."""
        out = np.exp(2j * pi * place)
        point = self.middles[np.floor(place).astype(int) % 2] + 8.0 * out
        return np.stack([point.real, point.imag], axis=-1), np.stack([out.real, out.imag], axis=-1)

    def everywhere(self) -> tuple[Any, Any]:
        """Even places of both bodies."""
        return np.concatenate([self.share, 1.0 + self.share]), np.full(2 * self.share.size, self.share[1])


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("left", [0.0, 0.3])
@pytest.mark.parametrize("towards", [0.4, 2.2])
def test_the_largest_disc_between_two_bodies_fills_their_gap(towards: float, left: float) -> None:
    """It touches one body and comes within what may be left of the other one."""
    radius, places = round_tool._smallest_disc(Circles(towards), 40.0, left)  # type: ignore[arg-type]
    assert radius == pytest.approx((6.0 - left) / 2.0, abs=2e-6)
    turned = np.angle(np.exp(2j * pi * np.array(places)) * np.exp(-1j * towards))
    assert sorted(np.abs(turned)) == pytest.approx([0.0, pi], abs=2e-3)
    assert {int(place) % 2 for place in places} == {0, 1}


@pytest.mark.judges("metrology")
@at_once("at_mm", [-3.0, -1.0, 0.5, 2.0, 6.0])
@at_once("deep_mm", [2.5, 0.4, -0.4])
def test_a_fillet_is_the_way_of_a_round_tip_that_rolls_along(at_mm: float, deep_mm: float) -> None:
    """A straight tool rolls on a circle of 20 mm; the middle of its tip is under its pitch line: speeds by hand."""
    pitch_mm, round_mm = 20.0, 0.7
    arm = at_mm + 1j * deep_mm
    # The middle is e^(i s / R) (R + i arm) with the arm (s0 - s) + i depth along the tangent and to its left, inwards.
    inner = pitch_mm - deep_mm + 1j * at_mm
    speed = 1j / pitch_mm * inner - 1j
    bend = (1j / pitch_mm) * speed + (1j / pitch_mm) * (-1j)
    turns = (np.conj(speed) * bend).imag
    wanted = abs(speed) ** 3 / abs(turns) + round_mm
    tool = Made(position=np.zeros((1, 1, 2)), normal=np.array([[[0.0, 1.0]]]), curvature=np.zeros((1, 1)))
    flanks: Any = Made(
        at_rolled=lambda owner, parameter: Made(curvature=np.full((1, 1), 1.0 / pitch_mm)),
        tool=Made(at_length=lambda parameter: tool),
        rounding=Made(center_mm=np.array([[arm.real, arm.imag]])),
        root_radius_mm=np.array([round_mm]),
    )
    curve: Any = Made(start=np.array([0.0]), end=np.array([1.0]), owner=np.array([0]))
    (found,) = round_tool._hollow_mm(flanks, FILLET, curve, np.array([[0]]), np.array([0.5]))[0]
    hollow = abs(arm) ** 2 / pitch_mm > -deep_mm
    assert found == (pytest.approx(wanted) if hollow else np.inf)


@pytest.mark.judges("metrology")
@at_once("height", [-1.0, 0.0, 1.5])
def test_flanks_and_lands_of_a_hollow_pitch_curve_are_hollow(height: float) -> None:
    """The flank of a ring of 30 mm is the involute of 30 cos a: its radius r tan a' at the height h / sin a."""
    alpha, ring = 0.35, -30.0
    seen: list[Any] = []
    flanks: Any = Made(
        slant=Made(of=lambda owner: Made(sine=sin(alpha))),
        rolling_curvature=lambda owner, parameter: seen.append(parameter) or np.full(parameter.shape, 1.0 / ring),
        curve=Made(at_length=lambda place: Made(curvature=np.full(place.shape, 1.0 / ring))),
        tip_height_mm=np.array([9.0, height]),
    )
    curve: Any = Made(start=np.array([0.0, height - 1.0]), end=np.array([0.0, height + 1.0]), owner=np.array([0, 1]))
    found = round_tool._hollow_mm(flanks, FLANK, curve, np.array([[1]]), np.array([0.5, 1.0]))[0]
    assert found == pytest.approx([(30.0 * sin(alpha) ** 2 - one) / sin(alpha) for one in (height, height + 1.0)])
    assert seen[0] == pytest.approx(np.array([[height, height + 1.0]]))
    land = round_tool._hollow_mm(flanks, round_tool.TIP_LAND, curve, np.array([[1]]), np.array([0.5]))
    assert land == pytest.approx(30.0 - height)
    flanks.curve.at_length = lambda place: Made(curvature=np.full(place.shape, 1.0 / 30.0))
    assert np.isinf(round_tool._hollow_mm(flanks, round_tool.TIP_LAND, curve, np.array([[1]]), np.array([0.5])))


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("best", [0.0, 0.137, 0.6502, 1.0])
def test_the_least_hollow_is_found_between_places_that_are_tried(best: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Radii 2 + (share - best)^2 on the fourth fillet of six, 3 on flanks and 2.5 on lands."""
    curves = [Made(owner=np.arange(10 * kind, 10 * kind + 6)) for kind in range(4)]
    monkeypatch.setattr(round_tool, "whole_curves", lambda tips, sides: curves)

    def hollow(flanks: Any, kind: int, curve: Any, rows: Any, share: Any) -> Any:
        assert np.all((share >= 0.0) & (share <= 1.0))
        if kind != FILLET:
            return np.full(np.broadcast(rows, share).shape, 3.0 if kind == FLANK else 2.5)
        return np.where(rows == 3, 2.0, 2.2) + (share - best) ** 2

    monkeypatch.setattr(round_tool, "_hollow_mm", hollow)
    radius, flank = round_tool.least_hollow(Made(flanks=None, tips=None, sides=None))
    assert radius == pytest.approx(2.0, abs=1e-7)
    assert flank == curves[FILLET].owner[3]


@pytest.mark.judges("metrology")
@at_once(
    ("curves", "space", "passage"),
    [
        (((FLANK, 0), (FILLET, 0)), 20, False),
        (((FLANK, 1), (FLANK, 2)), 1, True),
        (((FILLET, 2), (FLANK, 1)), 1, True),
        (((FLANK, 3), (round_tool.ROOT_LAND, 4)), 2, False),
        (((FLANK, 39), (FLANK, 40)), 20, True),
    ],
)
def test_a_round_tool_belongs_to_the_space_between_two_flanks(curves: Any, space: int, passage: bool) -> None:
    """Flanks 1 and 2 face each other across the first space, flanks 39 and 0 across the last of twenty."""
    gear: Any = Made(flanks=Made(count=40, rack=Made(module_mm=2.0)))
    asked: list[float] = []
    outline = Made(curve=lambda place: curves[place])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(round_tool, "_Outline", lambda gear: outline)
        patch.setattr(round_tool, "_smallest_disc", lambda own, most, left: asked.append(most) or (1.5, (0, 1)))
        patch.setattr(round_tool, "least_hollow", lambda gear: (0.6, 4))
        found = round_tool.round_tool(gear, 0.02)
    assert (found.diameter_mm, found.left_mm, found.space, found.passage) == (3.0, 0.02, space, passage)
    assert (found.hollow_mm, found.hollow_space, asked) == (0.6, 2, [40.0])


# --- poses


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("rigid", [True, False])
def test_slopes_of_distances_are_those_of_differences(rigid: bool) -> None:
    """Distances from a line, along its normal, of points that are turned back and moved back."""
    points = np.array([3.0 + 1.0j, -2.0 + 4.0j, 1.0 - 5.0j])
    out = np.exp(1j * np.array([0.3, 2.0, 4.4]))
    values = np.array([0.2, 0.5, -0.4] if rigid else [0.2])

    def distance(numbers: Any) -> Any:
        return (best_fit._pose(numbers).of_gear(points) * np.conj(out)).real

    feet: Any = Made(point=best_fit._pose(values).of_gear(points), outwards=out)
    found = best_fit._slopes(feet, values)
    step = 1e-6 * np.eye(values.size)
    wanted = [(distance(values + one) - distance(values - one)) / 2e-6 for one in step]
    assert found == pytest.approx(np.column_stack(wanted), abs=1e-8)


@pytest.mark.judges("metrology")
def test_errors_of_a_pose_are_those_of_a_mean_and_a_slope() -> None:
    """The line a + b x through five places: the errors of a and b from the scatter over three degrees of freedom."""
    x, left = np.arange(-2.0, 3.0), np.array([0.1, -0.2, 0.05, 0.15, -0.1])
    found = best_fit._spread(np.column_stack([x, np.ones(5)]), left, np.array([0.25, 1.0]))
    scatter = sqrt(float(left @ left) / 3.0)
    assert found == pytest.approx([scatter / sqrt(10.0), scatter / sqrt(5.0)])


@pytest.mark.judges("metrology")
@pytest.mark.parametrize(("begun", "ends"), [(0, 3), (5, 3), (9, 13), (18, 13)])
def test_a_rigid_fit_goes_on_tooth_by_tooth_while_it_gets_better(
    begun: int, ends: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Twenty teeth, best at the third and the thirteenth; the middle of the gear stays where it is."""
    step, own = 2.0 * pi / 20.0, 3.0 - 1.0j
    middle = 7.0 + 2.0j
    outline: Any = Made(gear=Made(flanks=Made(count=40)), middle_mm=own)

    def fitted(outline: Any, points: Any, probe: float, pose: Pose, rigid: bool, rounds: int) -> Any:
        assert pose.shift_mm + own * np.exp(1j * pose.angle_rad) == pytest.approx(middle)
        tooth = round(pose.angle_rad / step)
        assert pose.angle_rad == pytest.approx(tooth * step)
        away = min(abs(tooth - one) % 20 for one in (3, 13))
        return Made(pose=pose, rms_mm=0.01 * (1.0 + min(away, 20 - away)))

    monkeypatch.setattr(best_fit, "_fitted", fitted)
    pose = Pose(begun * step, middle - own * complex(np.exp(1j * begun * step)))
    found = best_fit._by_teeth(outline, np.zeros(1), 0.0, fitted(outline, None, 0.0, pose, True, 1))
    assert round(found.pose.angle_rad / step) == ends


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("by_middle", [False, True])
def test_fits_begin_twelve_times_in_a_pitch(by_middle: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(best_fit, "_nearness_mm", lambda outline, points, probe, pose: 0.3)
    outline: Any = Made(gear=Made(flanks=Made(count=10)), middle_mm=2.0 + 1.0j)
    points = np.array([4.0 + 1.0j, 6.0 + 3.0j])
    found = [pose for _, pose in best_fit._begun(outline, points, 0.0, by_middle=by_middle)]
    angles = np.array([pose.angle_rad for pose in found])
    assert angles == pytest.approx(2.0 * pi * np.arange(-30, 30) / 60.0)
    middles = np.array([pose.shift_mm for pose in found]) + (2.0 + 1.0j) * np.exp(1j * angles) * by_middle
    assert middles == pytest.approx(np.full(60, 5.0 + 2.0j if by_middle else 0j))


@pytest.mark.judges("metrology")
def test_the_best_beginnings_and_those_that_turn_least_are_taken() -> None:
    """Lowest places at six angles: the three best, and of those within half as much again the three that turn least."""
    angles = np.linspace(-3.0, 3.0, 13)
    worth = np.full(13, 9.0)
    worth[[1, 3, 5, 7, 9, 11]] = [1.0, 1.4, 1.49, 1.45, 1.51, 1.2]
    begun = [(float(value), Pose(float(angle))) for value, angle in zip(worth, angles, strict=True)]
    found = [pose.angle_rad for pose in best_fit._chosen(begun)]
    assert found == pytest.approx([-2.5, 2.5, -1.5, -0.5, 0.5])


@pytest.mark.judges("metrology")
def test_points_near_an_outline_count_by_their_distance_and_others_by_a_quarter_of_a_module() -> None:
    outline: Any = Made(gear=Made(flanks=Made(rack=Made(module_mm=2.0))), near_mm=lambda points: points.real)
    found = best_fit._nearness_mm(outline, np.array([0.4, -0.2, 3.0, 1.0]), 0.1, Pose(0.0, 0.0))
    assert found == pytest.approx(sqrt((0.3**2 + 0.3**2 + 0.5**2 + 0.5**2) / 4.0))


@pytest.mark.judges("metrology")
@at_once(
    ("part", "share", "height", "away", "counts"),
    [
        (FLANK_CURVE, 0.5, 0.0, 0.1, True),
        (TIP_LAND_CURVE, 0.5, 0.0, 0.1, False),
        (FLANK_CURVE, 0.99995, 0.0, 0.1, False),
        (FLANK_CURVE, 0.00005, 0.0, 0.1, False),
        (FLANK_CURVE, 0.5, -1.4999, 0.1, False),
        (FLANK_CURVE, 0.5, -1.4997, 0.1, True),
        (FLANK_CURVE, 0.5, 0.0, -0.51, False),
        (FLANK_CURVE, 0.5, 0.0, -0.49, True),
    ],
)
def test_points_of_working_flanks_turn_a_gear(
    part: int, share: float, height: float, away: float, counts: bool
) -> None:
    """Teeth of 2 mm that are met 1.5 mm deep: points in the middle of a flank, and less than half a millimetre away."""
    outline: Any = Made(
        part=np.array([part]),
        flank=np.array([0]),
        gear=Made(flanks=Made(rack=Made(module_mm=2.0)), tips=Made(met_depth_mm=np.array([1.5]))),
        height_mm=lambda row, share: np.array([height]),
    )
    feet: Any = Made(row=np.array([0]), share=np.array([share]), distance_mm=np.array([away]))
    assert best_fit.on_flanks(outline, feet).tolist() == [counts]


# --- outlines as measured


@pytest.mark.judges("metrology")
def test_an_outline_goes_through_points_that_are_metal() -> None:
    """No points astray, alone, beyond an end, or on the outer thirds of a tip land."""
    outline: Any = Made(part=np.array([FLANK_CURVE, TIP_LAND_CURVE]), gear=Made(flanks=Made(rack=Made(module_mm=2.0))))
    feet: Any = Made(
        row=np.array([0, 0, 0, 0, 1, 1, 1, 1]),
        share=np.array([0.1, 0.1, 0.1, 0.1, 0.3, 0.34, 0.66, 0.7]),
        distance_mm=np.array([0.1, 0.6, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1]),
        at_end=np.arange(8) == 3,
    )
    found = is_metal(outline, Made(feet=feet, alone=np.arange(8) == 2))
    assert found.tolist() == [True, False, False, False, False, True, True, False]


@pytest.mark.judges("metrology")
def test_points_at_one_place_are_one_point() -> None:
    place, shift = _in_order(np.array([5.0, 1.0, 5.001, 3.0, 4.999]), np.array([1.0, 2.0, 3.0, 4j, 5.0 + 3j]), 0.01)
    assert place == pytest.approx([1.0, 3.0, 5.0])
    assert shift == pytest.approx([2.0, 4j, 3.0 + 1j])


@pytest.mark.judges("metrology")
def test_a_pose_turns_and_moves_a_gear_to_its_points() -> None:
    pose = Pose(0.5, 3.0 - 2.0j)
    own = np.array([1.0 + 0j, 2.0j])
    file = np.array([3.0 + cos(0.5) + (sin(0.5) - 2.0) * 1j, 3.0 - 2.0 * sin(0.5) + (2.0 * cos(0.5) - 2.0) * 1j])
    assert pose.of_gear(file) == pytest.approx(own)
