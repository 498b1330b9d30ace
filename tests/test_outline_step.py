"""Steps towards the nearest pitch curve: back to a curve that is known, with what is held; searches that begin near."""

from __future__ import annotations

from dataclasses import replace
from math import pi, tau

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import minimize

from ncgear.numerics.arrays import Array
from ncgear.optimum.outline import nearest
from ncgear.optimum.outline.conditions import CurveLimits, excess
from ncgear.optimum.outline.nearest import away_mm, deviation, mate_deviation, nearest_curve
from ncgear.optimum.outline.outline import Outline, outline_of
from ncgear.optimum.outline.programme import EQUATIONS, MateWanted, OutlineAim, _solved, missed, step
from ncgear.optimum.outline.rolled import MatePlace, Rolled, SplineBasis, closing_distance_mm

pytest.importorskip("clarabel")
pytestmark = pytest.mark.judges("optimum")

COUNT, TEETH = 32, 40
PHI = tau * np.arange(COUNT) / COUNT


def curve(radius_mm: Array, axis: tuple[float, float] = (0.0, 0.0), place: MatePlace | None = None) -> Rolled:
    """The curve through radii at even polar angles, on which its mate closes."""
    basis = SplineBasis(COUNT)
    made = Rolled(basis, basis.through(radius_mm), np.array(axis), 1.0, TEETH, place)
    return replace(made, center_distance_mm=closing_distance_mm(made.radius[0]))


KNOWN = curve(30.0 + 2.0 * np.cos(PHI) + 1.0 * np.sin(2.0 * PHI), (2.0, -1.0))
NEAR = curve(30.3 + 2.2 * np.cos(PHI) + 0.7 * np.sin(2.0 * PHI), (2.2, -1.3))
LIMITS = CurveLimits()


def of(known: Rolled) -> Outline:
    return outline_of(known.points()[0][::3], "")


def length_mm(one: Rolled) -> float:
    points = one.points()[0]
    return float(np.hypot(*(np.roll(points, -1, axis=0) - points).T).sum())


def test_a_step_comes_back_to_a_curve_that_is_known() -> None:
    """What is left goes with the square of what was away; the mate closes, and teeth fill the curve, but for that."""
    outline = of(KNOWN)
    before = away_mm(outline, NEAR, OutlineAim(), 500)
    found = step(outline, NEAR, LIMITS, OutlineAim(), 2.0)
    assert away_mm(outline, found, OutlineAim(), 500) < 0.15 * before
    assert np.mean(found.turned) == pytest.approx(1.0, abs=2e-3)
    assert found.module_mm == pytest.approx(length_mm(found) / (pi * TEETH), rel=1e-4)
    twice = step(outline, found, LIMITS, OutlineAim(), 2.0)
    assert np.mean(twice.turned) == pytest.approx(1.0, abs=1e-5)


def test_the_mate_closes_but_for_the_third_order_of_the_step() -> None:
    """Half as long a step leaves an eighth: the second solution removes what goes with the square."""
    outline, left = of(KNOWN), list[float]()
    for share in (1.0, 0.5):
        off = 30.0 + (2.0 + 0.8 * share) * np.cos(PHI) + (1.0 - share) * np.sin(2.0 * PHI)
        found = step(outline, curve(off, (2.0 + share, -1.0 - share)), LIMITS, OutlineAim(), 4.0)
        left.append(abs(float(np.mean(found.turned)) - 1.0))
    assert left[1] < left[0] / 6.0


def test_the_least_of_a_form_over_many_rows_is_that_of_scipy() -> None:
    """Most rows bind nowhere; the start keeps none of them in view."""
    drawn = np.random.default_rng(5)
    size, count = 6, 300
    root, linear = drawn.normal(size=(size, size)), drawn.normal(size=size)
    square = root @ root.T + np.eye(size)
    rows, bound = drawn.normal(size=(count, size)), drawn.uniform(0.02, 3.0, count)
    bound[:EQUATIONS] = 0.0
    form = sparse.csc_matrix(np.triu(square))
    found = _solved(form, linear, sparse.csr_array(rows), bound, np.zeros(size))
    equal, below = rows[:EQUATIONS], rows[EQUATIONS:]
    judged = minimize(
        lambda x: x @ square @ x / 2.0 + linear @ x,
        np.zeros(size),
        jac=lambda x: square @ x + linear,
        method="SLSQP",
        constraints=[
            {"type": "eq", "fun": lambda x: equal @ x, "jac": lambda x: equal},
            {"type": "ineq", "fun": lambda x: bound[EQUATIONS:] - below @ x, "jac": lambda x: -below},
        ],
        options={"ftol": 1e-14},
    )
    assert np.count_nonzero(bound[EQUATIONS:] - below @ judged.x < 1e-6) > 0
    assert found == pytest.approx(judged.x, abs=1e-5)


def test_a_step_is_no_longer_than_it_may_be_and_holds_what_is_held() -> None:
    outline = of(KNOWN)
    found = step(outline, NEAR, LIMITS, OutlineAim(fixed_axis=True), 0.05)
    assert np.abs(found.radius[0] - NEAR.radius[0]).max() == pytest.approx(0.05, rel=1e-3)
    assert found.axis_mm == pytest.approx(NEAR.axis_mm, abs=1e-6)
    moved = step(outline, NEAR, LIMITS, OutlineAim(), 0.05)
    assert np.abs(moved.axis_mm - NEAR.axis_mm).max() == pytest.approx(0.05, rel=1e-3)
    wanted = OutlineAim(module_mm=1.01 * KNOWN.module_mm)
    assert missed(NEAR, LIMITS, wanted) == pytest.approx(abs(NEAR.module_mm / wanted.module_mm - 1.0), abs=2e-9)
    held = step(outline, step(outline, NEAR, LIMITS, wanted, 2.0), LIMITS, wanted, 2.0)
    assert held.module_mm == pytest.approx(1.01 * KNOWN.module_mm, rel=1e-4)


@pytest.mark.slow
def test_the_greatest_distance_is_less_where_it_is_asked_for() -> None:
    """About a square, whose corners the mean square follows less than the greatest distance does."""
    outline = outline_of(np.array([[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]]), "")
    start, rigid = curve(33.0 + 2.0 * np.cos(4.0 * (PHI - pi / 4.0))), CurveLimits()
    mean, most = OutlineAim(), OutlineAim(greatest=True)
    results = [start, start]
    for _ in range(2):
        results = [step(outline, one, rigid, two, 4.0) for one, two in zip(results, (mean, most), strict=True)]
    roots, greatest = zip(*([away_mm(outline, one, two, 400) for two in (mean, most)] for one in results), strict=True)
    assert greatest[1] < 0.98 * greatest[0]
    assert roots[0] < roots[1]
    assert greatest[0] == pytest.approx(deviation(outline, results[0], 400).greatest_mm)


def test_both_gears_come_back_to_outlines_that_are_known() -> None:
    """The mate's own drawing, turned, moved and larger; its axis and its size may be held."""
    place = MatePlace(np.array([3.0, 1.0]), 0.3, 1.2)
    known = replace(KNOWN, mate_place=place)
    mate = outline_of(known.mate_in_drawing()[0][::3] / place.scale, "")
    outline, share = of(known), 0.4
    near = replace(NEAR, mate_place=MatePlace(np.array([3.2, 0.8]), 0.31, 1.19))
    wanted = OutlineAim(mate=MateWanted(mate, share))
    before = away_mm(outline, near, wanted, 500)
    assert before**2 == pytest.approx(
        (1.0 - share) * deviation(outline, near, 500).root_mean_square_mm ** 2
        + share * mate_deviation(mate, near, 500).root_mean_square_mm ** 2,
        rel=1e-6,
    )
    found = step(outline, near, LIMITS, wanted, 2.0)
    assert away_mm(outline, found, wanted, 500) < 0.3 * before
    again = step(outline, found, LIMITS, wanted, 2.0)
    assert again.mate_place is not None
    assert again.mate_place.scale == pytest.approx(1.2, rel=2e-3)
    assert again.mate_place.turned_rad == pytest.approx(0.3, abs=5e-3)
    fixed = OutlineAim(mate=MateWanted(mate, share, axis_mm=np.array([2.5, 0.8]), fixed_size=True))
    held = step(outline, near, LIMITS, fixed, 2.0).mate_place
    assert held is not None
    assert held.scale == pytest.approx(1.19, abs=1e-6)
    assert held.axis_mm == pytest.approx(1.19 * np.array([2.5, 0.8]), abs=1e-5)


def test_a_search_from_a_near_curve_ends_at_the_curve_that_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    outline = of(KNOWN)
    found = nearest_curve(outline, TEETH, LIMITS, OutlineAim(), start=NEAR)
    # The outline has chords of the known curve, whose radius of curvature is over 25 mm: they sag by less than that
    chords = np.diff(outline.corners, axis=0, append=outline.corners[:1])
    assert deviation(outline, found).greatest_mm < np.max(np.sum(chords**2, axis=1)) / (8.0 * 25.0) < 4e-3
    assert excess(found, LIMITS) < 1e-6
    # From the axis alone: the radii are those of rays, smoothed
    monkeypatch.setattr(nearest, "coefficients_for", lambda teeth: COUNT)
    monkeypatch.setattr(nearest, "HEATS", ((1, 4),))
    found = nearest_curve(outline, TEETH, LIMITS, OutlineAim(fixed_axis=True), axis_mm=np.array([2.0, -1.0]))
    assert found.axis_mm == pytest.approx([2.0, -1.0], abs=1e-6)
    assert deviation(outline, found).greatest_mm < 5e-3
