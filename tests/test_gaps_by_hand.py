"""Formulas of several rooms on a few numbers that are done by hand: lattices, reaches, returns, steps in time, bins."""

from __future__ import annotations

from math import pi, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from shapely.geometry import Point

from ncgear.balance.gears import Drills, _places
from ncgear.contact.written import as_written
from ncgear.design.space import Listed, Ranged
from ncgear.dynamics import train_knocks
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures import wished
from ncgear.figures.numbers import shown
from ncgear.files.workshop.sheets import gear_tables
from ncgear.files.workshop.sheets.frame import ROW_MM
from ncgear.formulas.laws import _logarithms
from ncgear.kinematics import crank_stretches
from ncgear.kinematics.crank_stretches import End, nearest_dwell_mm
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.numerics.highest import golden_section
from ncgear.numerics.periodic_cubic import PeriodicCubic
from ncgear.numerics.rational import arc, closed_uniform
from ncgear.pitch.shape import Mesh
from ncgear.ratio.laws.curve_shapes import ellipse
from ncgear.ratio.laws.table import AT_DEAD_CENTRE, _strokes
from ncgear.ratio.sampled_strokes import PeakedReturns, _between
from ncgear.screening.overview import BINS, Effects, _bins

Made: Any = SimpleNamespace


@pytest.mark.judges("balance")
@pytest.mark.parametrize("rows", [0.8, 1.3, 2.9, 3.2])
def test_places_of_holes_are_a_lattice_of_hexagons_as_far_as_there_is_room(rows: float) -> None:
    """Holes of 8 mm with walls of 2 mm: 10 mm apart; all within a circle whose edge is 6 mm from their centres."""
    radius = 6.0 + rows * 10.0 * sqrt(3.0) / 2.0
    found = _places(Point(0.0, 0.0).buffer(radius, quad_segs=90), Drills(8.0, 3.0, 2.0), "key")
    some = np.arange(-9, 10)
    every = (10.0 * (some[:, None] + 0.5 * some + 0.5j * sqrt(3.0) * some)).ravel()
    wanted = every[np.abs(every) < radius - 6.0]
    assert found.size == wanted.size
    assert np.abs(found[:, None] - wanted).min(axis=1).max() < 1e-9


@pytest.mark.judges("contact")
@pytest.mark.parametrize(("convex", "factor"), [((True, True), 1.0), ((True, False), as_written.BOWL)])
def test_outlines_are_compared_along_the_line_of_action_and_further_in_bowls(
    convex: tuple[bool, bool], factor: float
) -> None:
    """Heights of 2.5 mm under 30 deg reach 5 mm along the flatter flank's line of action."""
    flanks = [
        Made(rack=Made(dedendum_mm=depth, angles_rad=(pi / 6.0, pi / 4.0)), full_tip_mm=np.array([1.0, tip]))
        for depth, tip in ((2.5, 2.0), (1.5, 2.4))
    ]
    teeth: Any = Made(driving=Made(flanks=flanks[0]), driven=Made(flanks=flanks[1]))
    both = iter(convex)
    pitch: Any = Made(mesh=Mesh.EXTERNAL, convex=lambda _: next(both))
    assert as_written.reach_mm(pitch, teeth) == pytest.approx(as_written.BEYOND * 5.0 * factor)


@pytest.mark.judges("dynamics")
def test_a_train_under_even_torques_moves_with_even_acceleration(monkeypatch: pytest.MonkeyPatch) -> None:
    """Torques of 7 and 5 against 4 and 1 at a slope of 2: 7 - 4 - 10 + 2 and 4; places of the held pairs to both sides.

    The second pair takes 10 from the shaft between; without friction, these are 5 times the slope.
    """
    step, held = 1e-3, train_knocks.HELD
    asked: list[tuple[str, float]] = []

    def moments(impact: None, near: Any, ahead: float, speed: float, later_s: float = 0.0) -> tuple[float, float]:
        asked.append((near, later_s))
        return {"first": (6.5, 7.0), "second": (4.5, 5.0), "held": (0.5, 10.0)}[near]

    monkeypatch.setattr(train_knocks, "moments_n_mm", moments)
    pairs = [Made(meshing=Made(impact=None))] * 2
    along: Any = Made(slope=np.array([[1.0], [2.0]]), inertia=np.array([[10.0], [0.5]]), asked=np.array([[4.0], [1.0]]))
    state = train_knocks._State([0.1, 0.2], [3.0, 4.0])
    owner: Any = Made(pairs=pairs)
    near: Any = [[["first"], ["second"]], [["held"]]]
    borne, last, met = train_knocks.KnockingTrain._stepped(owner, state, near, along, slice(0, 1), step)
    time = held * step
    assert [*last.ahead_rad, *last.momentum] == pytest.approx(
        (
            0.1 + 0.3 * time - 0.5 * 0.5 * time**2,
            0.2 + 8.0 * time + 0.5 * 8.0 * time**2,
            3.0 - 5.0 * time,
            4.0 + 4.0 * time,
        )
    )
    assert (borne.shape, borne[..., 0].tolist(), met) == ((2, 2, held), [[6.5, 4.5], [7.0, 5.0]], [])
    for near in ("first", "second", "held"):
        times = [later for one, later in asked if one == near]
        assert times == pytest.approx(step * (np.arange(held + 1) - held / 2.0))


@pytest.mark.judges("figures")
def test_lists_of_tables_are_told_by_their_number() -> None:
    lists: list[list[Any]] = [[{"a": 1}, {"b": 2}], [{"a": 1}, "b"], ["a", "b"], []]
    assert [shown(items) for items in lists] == ["2", "2", "a, b", "none"]


@pytest.mark.judges("figures")
def test_an_even_stretch_is_told_in_shares_of_the_stroke(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wished, "motion_line", lambda *_: "")
    monkeypatch.setattr(wished, "EVEN", 0.04)
    found: Any = Made(even={}, dwell_rad={}, time_ratio=1.5, near_mm=2.0)
    linkage: Any = Made(OUTPUT=Made(place=Made(ending="mm", factor=1.0)), stroke_mm=80.0)
    told = wished.motion_summary(found, linkage)
    assert (told["even_within_percent"], told["dwell_within_mm"], told["time_ratio"]) == (pytest.approx(4.0), 2.0, 1.5)


@pytest.mark.judges("files")
def test_tables_of_measurements_share_the_lines_of_a_sheet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 21 lines the first of two tables has 10, with 8 rows below its two heads; the other one what is left."""
    two, spans = [("1", "9", 31.25)] * 40, [("1", "3", "", "", 22.5)] * 40
    found = iter([two, [], spans])
    monkeypatch.setattr(gear_tables, "rows_found", lambda part: next(found))
    measured: Any = Made(pins=Made(diameter_mm=4.0), section_z_mm=None, working=Made(is_ring=False), tool="pin")
    made = gear_tables._measurements(measured, 90.0, 21.4 * ROW_MM)
    assert [len(table.rows) for table in made] == [8, 21 - round(made[0].height_mm() / ROW_MM) - 2]
    assert sum(table.height_mm() for table in made) <= 22.0 * ROW_MM


# --- laws


@pytest.mark.judges("ratio")
def test_a_peaked_return_is_its_polynomial_with_its_derivatives_by_the_driving_angle() -> None:
    """numpy's polynomial about 0.3 of a return of 1.7 rad; the second coefficient of Taylor is half the derivative."""
    coefficients = np.array([0.4, -0.2, 1.3, 0.7, -0.5, 0.2])
    returns = PeakedReturns(coefficients[:, None], np.array([0.3]), np.array([1.7]))
    found = returns.polynomial(Made(count=4), 2)
    edges = returns._edges[0]
    tau, whole = _between(edges[None], 4)[0], Polynomial(coefficients)
    for order in range(3):
        assert found.derivative(order) == pytest.approx(whole.deriv(order)(tau) / 1.7**order if order else whole(tau))
    assert returns.widths_rad(Made()).sum() == pytest.approx(1.7)


@pytest.mark.judges("ratio")
@pytest.mark.parametrize("off", [0.9, -0.9, 1.1])
def test_points_within_a_millionth_of_a_dead_centre_are_there(off: float) -> None:
    """A stroke of 2000 mm: two micrometres."""
    linkage, near = ScotchYoke(1000.0), AT_DEAD_CENTRE * 2000.0
    phi1, places = np.array([0.0, 1.0, 2.0, 3.0]), np.array([off * near, 700.0, 2000.0 - off * near, 900.0])
    if off > 1.0:
        for wrong in (places, np.array([0.0, *places[1:]])):
            with pytest.raises(WrongInput):
                _strokes(phi1, wrong, linkage, "key")
        return
    snapped, back = _strokes(phi1, places, linkage, "key")
    assert snapped.tolist() == [0.0, 700.0, 2000.0, 900.0]
    assert back.tolist() == [False, False, False, True]


@pytest.mark.judges("ratio")
@pytest.mark.parametrize(("x", "y", "inside"), [(24.0, 12.2, False), (24.0, 11.8, True), (-18.2, -16.0, False)])
def test_an_ellipse_turns_about_points_inside(x: float, y: float, inside: bool) -> None:
    """Semi axes of 30 and 20 mm: at four fifths of the one, three fifths of the other are its edge."""
    if inside:
        ellipse(30.0, 20.0, (x, y), "key")
    else:
        with pytest.raises(NoSuchMechanism, match="not inside the ellipse"):
            ellipse(30.0, 20.0, (x, y), "key")


@pytest.mark.judges("formulas")
def test_pieces_of_a_ratio_over_the_driven_angle_end_at_shares_of_its_knots() -> None:
    """Knots 0, 2 and 2 pi of two lobes: in a half turn pieces that end at 1 and pi."""
    series = PeriodicCubic(np.array([0.0, 2.0, 2.0 * pi]), np.ones((4, 2)))
    pieces = list(_logarithms(2, series))
    assert [name for name, *_ in pieces] == ["piece 1", "piece 2"]
    assert [ends for _, ends, *_ in pieces] == [pytest.approx((0.0, 1.0)), pytest.approx((1.0, pi))]


# --- screening


@pytest.mark.judges("screening")
def test_bins_are_about_few_values_or_even_parts_of_a_range() -> None:
    edges, places = _bins(Listed("x", (3.0, 1.0, 7.0)))
    assert edges[:4].tolist() == [1.0, 2.0, 5.0, np.inf]
    assert (edges.size, places.size) == (BINS + 1, BINS)
    assert places[:3].tolist() == [1.0, 3.0, 7.0]
    assert np.isnan(places[3:]).all()
    many = tuple(float(number) for number in range(BINS + 1))
    for varied in (Listed("x", many), Ranged("x", 0.0, float(BINS))):
        edges, places = _bins(varied)
        assert edges == pytest.approx(np.arange(BINS + 1.0))
        assert places == pytest.approx(np.arange(BINS) + 0.5)


@pytest.mark.judges("screening")
def test_a_key_explains_the_variance_of_its_bins_less_that_of_chance() -> None:
    """Values 1 3 in the first bin and 7 9 in the second: 9 of 10 are explained, a third by chance."""
    values = np.array([[1.0, 3.0], [7.0, 9.0]])
    sums, squares = values.sum(axis=1)[None, :, None], (values**2).sum(axis=1)[None, :, None]
    kept = np.full((1, 2), 2.0)
    effects = Effects(np.empty((1, 3)), np.empty((1, 2)), 4.0 * kept, 3.0 * kept, kept, sums, squares, np.array([10.0]))
    assert effects.explained == pytest.approx((0.9 - 1.0 / 3.0) / (1.0 - 1.0 / 3.0))
    assert effects.refused_share == pytest.approx(np.full((1, 2), 0.25))
    assert effects.means[0, :, 0] == pytest.approx([12.0, 18.0])


# --- kinematics


def reached(speed: list[float], most: float) -> list[tuple[int, float, float]]:
    """For each sample the last one up to which speeds are within a factor, with the highest and the lowest of them."""
    found = []
    for start in range(len(speed)):
        last = start
        while last + 1 < len(speed) and max(speed[start : last + 2]) <= most * min(speed[start : last + 2]):
            last += 1
        found.append((last, max(speed[start : last + 1]), min(speed[start : last + 1])))
    return found


@pytest.mark.judges("kinematics")
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_stretches_of_nearly_even_speed_reach_as_far_as_they_can(seed: int) -> None:
    """Tried sample by sample."""
    speed = np.exp(np.cumsum(np.random.default_rng(seed).normal(0.0, 0.04, 41)))
    last, highest, lowest = crank_stretches._reach(speed, 1.1)
    assert [*zip(last.tolist(), highest, lowest, strict=True)] == reached(speed.tolist(), 1.1)
    share, level = crank_stretches._beyond(speed, last, highest, lowest, 1.1)
    for row, end in enumerate(last.tolist()):
        if end + 1 == speed.size:
            assert share[row] == 0.0
            continue
        wanted = 1.1 * lowest[row] if speed[end + 1] > speed[end] else highest[row] / 1.1
        assert (1.0 - share[row]) * speed[end] + share[row] * speed[end + 1] == pytest.approx(wanted)
        assert level[row] == wanted


@pytest.mark.judges("kinematics")
def test_an_even_step_adds_nothing_to_a_stretch() -> None:
    share, level = crank_stretches._beyond(np.array([2.0, 2.0]), np.array([0]), np.array([3.0]), np.array([1.0]), 1.5)
    assert (share.tolist(), level.tolist()) == ([0.0], [2.0])


@pytest.mark.judges("kinematics")
def test_the_nearest_dwell_is_reached_on_both_sides_of_a_dead_centre() -> None:
    """A yoke's place is r (1 - cos phi): half of the crank's angle on each side; a whole turn takes the stroke."""
    yoke = ScotchYoke(50.0)
    for end in End:
        for angle, ratio in ((1.0, 2.0), (3.0, 1.5)):
            found = nearest_dwell_mm(yoke, end, angle, ratio)
            assert found == pytest.approx(50.0 * (1.0 - np.cos(angle / ratio / 2.0)))
        assert nearest_dwell_mm(yoke, end, 2.0 * pi, 1.0) == pytest.approx(100.0)
    rod = CrankSlider(50.0, 150.0)
    phi = 0.25

    def away(phi: float) -> float:
        return 50.0 * (1.0 - np.cos(phi)) + 150.0 - sqrt(150.0**2 - (50.0 * np.sin(phi)) ** 2)

    near = {round(nearest_dwell_mm(rod, end, 1.0, 2.0), 9) for end in End}
    assert near == {round(away(phi), 9), round(100.0 - away(pi - phi), 9)}


# --- numerics


@pytest.mark.judges("numerics")
@pytest.mark.parametrize("least", [0.31, 1.7, 2.9])
def test_a_golden_section_closes_in_on_the_least_value(least: float) -> None:
    asked: list[float] = []

    def function(place: float) -> float:
        asked.append(place)
        return (place - least) ** 2

    found = golden_section(function, 0.0, 3.0, 1e-3)
    assert [one.value for one in found] == [(one.at - least) ** 2 for one in found]
    assert all(abs(one.at - least) < 1e-3 for one in found)
    # Each section takes one value and leaves 0.618 of the width: 17 of them make a thousandth of 3.
    assert len(asked) == 2 + 17
    assert min(asked) >= 0.0
    assert max(asked) <= 3.0


@pytest.mark.judges("numerics")
def test_arcs_and_closed_splines_are_where_geometry_has_them() -> None:
    made = arc((3.0, -2.0), 5.0, 0.4, -1.1)
    assert made.points[[0, 2]] == pytest.approx(
        np.array([[3.0 + 5.0 * np.cos(a), -2.0 + 5.0 * np.sin(a)] for a in (0.4, -0.7)])
    )
    middle = (made.points[0] + 2.0 * made.weights[1] * made.points[1] + made.points[2]) / (2.0 + 2.0 * made.weights[1])
    assert np.hypot(*(middle - [3.0, -2.0])) == pytest.approx(5.0)
    ring = closed_uniform(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [0.5, -0.5]]), 3)
    assert ring.knots == pytest.approx(np.arange(-3.0, 9.0))
    assert ring.points[5:] == pytest.approx(ring.points[:3])
