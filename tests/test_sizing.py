"""Centre distance, module and teeth: any two give the third, and teeth always fill the pitch curve."""

from __future__ import annotations

from math import pi
from re import findall

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from at_once import at_once
from ncgear.errors import WrongInput
from ncgear.pitch.pair import Size, solved_size
from ncgear.ratio.transmission import Lobes

CIRCLES = pi
"""Driving pitch curve's length at unit centre distance of two equal circles: radius 1/2."""

SPUR = Size(driving_teeth=25, driven_teeth=25, module_mm=3.0, center_distance_mm=75.0)
"""Equal spur gears: a = m z."""


@at_once(("teeth", "module", "distance"), [(25, 3.0, None), (25, None, 75.0), (None, 3.0, 75.0), (25, 3.0, 75.0)])
def test_any_two_give_the_third(teeth: int | None, module: float | None, distance: float | None) -> None:
    found = solved_size(CIRCLES, Lobes(), teeth, module, distance)
    assert (found.driving_teeth, found.driven_teeth) == (25, 25)
    assert (found.module_mm, found.center_distance_mm) == pytest.approx((3.0, 75.0), rel=1e-15)


@at_once(("teeth", "module", "distance"), [(25, None, None), (None, 3.0, None), (None, None, 75.0), (None, None, None)])
def test_one_or_none_is_not_enough(teeth: int | None, module: float | None, distance: float | None) -> None:
    with pytest.raises(WrongInput) as caught:
        solved_size(CIRCLES, Lobes(), teeth, module, distance)
    assert caught.value.key == "gears"
    for name in ("teeth", "module_mm", "center_distance_mm"):
        assert name in caught.value.problem


@pytest.mark.slow
@settings(deadline=None)
@given(st.floats(1.0, 20.0), st.integers(5, 300), st.floats(0.2, 50.0), st.integers(1, 4), st.integers(1, 4))
def test_teeth_fill_the_curve_and_round_trip(
    length: float, teeth: int, module: float, driving: int, driven: int
) -> None:
    lobes = Lobes(driving, driven)
    teeth *= driving
    first = solved_size(length, lobes, teeth, module, None)
    assert first.center_distance_mm * length == pytest.approx(teeth * pi * module, rel=1e-14)
    assert first.driven_teeth * driving == teeth * driven
    again = solved_size(length, lobes, None, module, first.center_distance_mm)
    third = solved_size(length, lobes, teeth, None, first.center_distance_mm)
    assert again.driving_teeth == third.driving_teeth == teeth
    assert third.module_mm == pytest.approx(module, rel=1e-14)
    # The distance is computed afresh from teeth and module where those are known
    assert again.center_distance_mm == pytest.approx(first.center_distance_mm, rel=1e-14)


def test_the_baler_at_200_mm() -> None:
    """Curves of about 629 mm: 25 teeth need module 8.0, and 25 teeth of module 3 need a = 74.9 mm."""
    length = 629.28 / 200.0
    assert solved_size(length, Lobes(), 25, None, 200.0).module_mm == pytest.approx(8.0, abs=0.05)
    assert solved_size(length, Lobes(), 25, 3.0, None).center_distance_mm == pytest.approx(74.9, abs=0.05)


@at_once(
    ("distance", "fits"), [(75.0 * (1 + 0.9e-6), True), (75.0 * (1 + 1.1e-6), False), (75.1, False), (74.9, False)]
)
def test_three_values_may_disagree_by_seven_digits_only(distance: float, fits: bool) -> None:
    if fits:
        assert solved_size(CIRCLES, Lobes(), 25, 3.0, distance).center_distance_mm == pytest.approx(75.0, rel=1e-6)
        return
    with pytest.raises(WrongInput) as caught:
        solved_size(CIRCLES, Lobes(), 25, 3.0, distance)
    assert caught.value.key == "gears.center_distance_mm"


def test_the_three_ways_out_that_a_refusal_names_are_right() -> None:
    with pytest.raises(WrongInput) as caught:
        solved_size(CIRCLES, Lobes(), 25, 3.0, 80.0)
    values = [(key, float(value)) for key, value in findall(r"(\w+): ([0-9.]+)", caught.value.problem)]
    # The nearest whole number of teeth has a module of its own
    assert values == [
        ("center_distance_mm", 75.0),
        ("module_mm", 3.2),
        ("teeth", 27.0),
        ("module_mm", pytest.approx(80.0 / 27.0, rel=1e-8)),
    ]


def test_teeth_that_are_not_whole_are_refused_with_both_ways_out() -> None:
    with pytest.raises(WrongInput) as caught:
        solved_size(CIRCLES, Lobes(), None, 3.0, 76.0)
    assert caught.value.key == "gears.center_distance_mm"
    assert "25.3333 teeth" in caught.value.problem
    values = dict(findall(r"(\w+): ([0-9.]+)", caught.value.problem))
    for name in ("module_mm", "center_distance_mm"):
        given_values = {"module_mm": 3.0, "center_distance_mm": 76.0, name: float(values[name])}
        assert solved_size(CIRCLES, Lobes(), None, **given_values).driving_teeth == 25


def test_less_than_one_tooth_is_refused() -> None:
    with pytest.raises(WrongInput):
        solved_size(CIRCLES, Lobes(), None, 300.0, 75.0)


@at_once(("lobes", "teeth", "driven"), [((1, 2), 24, 48), ((2, 1), 24, 12), ((2, 3), 24, 36), ((3, 2), 24, 16)])
def test_driven_teeth_follow_the_lobes(lobes: tuple[int, int], teeth: int, driven: int) -> None:
    assert solved_size(4.0, Lobes(*lobes), teeth, 2.0, None).driven_teeth == driven


@at_once(("lobes", "teeth"), [((2, 1), 25), ((2, 3), 25), ((3, 2), 25), ((3, 1), 26)])
def test_teeth_that_do_not_divide_among_the_lobes_are_refused(lobes: tuple[int, int], teeth: int) -> None:
    with pytest.raises(WrongInput) as caught:
        solved_size(4.0, Lobes(*lobes), teeth, 2.0, None)
    assert caught.value.key == "gears.teeth"
    assert f"multiple of {lobes[0]}" in caught.value.problem


@at_once(("lobes", "teeth"), [((1, 2), 25), ((2, 2), 25), ((2, 4), 25), ((4, 2), 26)])
def test_equivalent_fractions_need_no_multiple(lobes: tuple[int, int], teeth: int) -> None:
    assert solved_size(4.0, Lobes(*lobes), teeth, 2.0, None).driven_teeth * lobes[0] == teeth * lobes[1]
