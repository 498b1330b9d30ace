"""Even stretches as told, widths and thicknesses that just do, bins of designs and laws of each power, by hand."""

from __future__ import annotations

from math import pi, radians, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mpmath import mp
from scipy.interpolate import BSpline

from at_once import at_once
from ncgear.drawings.scene.geared_pairs import SceneGear
from ncgear.dynamics.driven_side import Ways
from ncgear.errors import WrongInput
from ncgear.figures.wished import _even
from ncgear.files.workshop.step import _through
from ncgear.optimum.certified.cycle import _turns_of_load
from ncgear.optimum.makeable.search import goal_weights
from ncgear.optimum.outline.nearest import _steepness
from ncgear.pitch.lobed import _polar_path
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project import sizing
from ncgear.screening import overview
from ncgear.screening.overview import BINS, Effects
from ncgear.teeth.shifts import LEAST_THICKNESS, tooth_shifts
from ncgear.whole_machines import laws

Made: Any = SimpleNamespace


@pytest.mark.judges("figures")
def test_an_even_stretch_is_told_from_its_lower_end_and_as_a_share_of_the_stroke() -> None:
    """30 of 120 mm on the way back, from 80 to 50 mm; in hundredths where the output's factor says so."""
    stretch = Made(length_mm=30.0, start_mm=80.0, end_mm=50.0, speed_mm_s=9.0)
    output = Made(place=Made(ending="cm", factor=0.1), speed=Made(ending="mm_s"))
    found = _even(Made(even={"return": stretch}), "return", Made(OUTPUT=output, stroke_mm=120.0))  # type: ignore[arg-type]
    told = {"length_cm": 3.0, "length_percent": 25.0, "from_cm": 5.0, "to_cm": 8.0, "speed_mm_s": 9.0}
    assert found == pytest.approx(told)


@pytest.mark.judges("drawings")
@at_once(
    ("mesh", "gear", "facing"),
    [(Mesh.EXTERNAL, gear, 0.0) for gear in Gear]
    + [(Mesh.INTERNAL, Gear.DRIVING, pi), (Mesh.INTERNAL, Gear.DRIVEN, 0.0)],
)
def test_a_gear_faces_its_mate_but_inside_a_ring(mesh: Mesh, gear: Gear, facing: float) -> None:
    """The pitch point of a ring's pair is beyond the pinion's axis, as the ring's axis sees it."""
    assert SceneGear.facing_rad.fget(Made(gear=gear, mounting=Made(mesh=mesh))) == pytest.approx(facing)  # type: ignore[attr-defined]


@pytest.mark.judges("optimum")
def test_steepness_is_a_share_of_a_right_angle() -> None:
    """A slope of 45 degrees down is half of it."""
    curve: Any = Made(radius=(np.array([20.0, 10.0, 5.0]), np.array([3.0, -10.0, 1.0]), None))
    assert _steepness(curve) == pytest.approx(0.5)


@pytest.mark.judges("project")
@at_once(("shares", "guess"), [((0.6, 1.2), 17.0), ((2.4, 1.2), 15.0)])
def test_the_next_width_follows_the_power_of_the_share_or_is_the_mean(shares: Any, guess: float) -> None:
    """Widths of 10 and 20 mm, of which only the second holds: 20 / 1.2 = 16.7 mm, or the root of 200."""
    own = [
        Made(teeth=20, module_mm=2.0, face_width_mm=width, share=share, holds=width == 20.0)
        for width, share in zip((10.0, 20.0), shares, strict=True)
    ]
    asked: list[float] = []
    search: Any = Made(
        widths_mm=lambda module: (5.0, 50.0), computed=[None, *own], narrowings=0, most_narrowed=5,
        made=lambda teeth, module, width: asked.append(width),
    )  # fmt: skip
    assert sizing._Search.narrowed(search, own[1]) == (own[1], False)
    assert asked == [guess]


@pytest.mark.judges("teeth")
@at_once("module", [1.0, 4.0])
@at_once("way", [1.0, -1.0])
def test_shifts_leave_a_fifth_of_a_tooth_at_least(module: float, way: float) -> None:
    """A shift of x thins one gear's teeth by 2 x tan(20 deg); a tooth has half a pitch."""
    most = (1.0 - LEAST_THICKNESS) * pi * module / 2.0 / (2.0 * tan(radians(20.0)))
    angles = (radians(20.0),) * 2
    driving, driven = tooth_shifts(np.full(12, 0.999 * way * most), module, angles, (12, 12))
    assert (driving.outwards_mm.sum() < 0.0, driven.outwards_mm.sum() < 0.0) == (way < 0.0, way > 0.0)
    with pytest.raises(WrongInput, match="driven gear" if way > 0.0 else "driving gear"):
        tooth_shifts(np.full(12, 1.001 * way * most), module, angles, (12, 12))


@pytest.mark.judges("screening")
def test_the_greatest_value_is_in_the_last_bin() -> None:
    """Values at both ends, just below the second edge and in the middle, of which two keep all and are made."""
    none, sums = np.zeros((1, BINS)), np.zeros((1, BINS, 1))
    edges = np.linspace(0.0, 1.0, BINS + 1)[None]
    values = np.array([0.0, 0.999 / BINS, 1.0, 1.0])
    made = np.array([True, False, True, True])
    part: Any = Made(
        column=lambda name: np.array([5.0, 6.0, 7.0, 9.0]), numbers=np.arange(4), values={"a": values}, made=made
    )
    effects = Effects(edges, none, none, none, none, sums, sums)
    found = overview._effects(effects, Made(objectives=[Made(name="w")]), part, made)
    assert (found.designs[0, 0], found.designs[0, -1], found.designs.sum()) == (2.0, 2.0, 4.0)
    assert (found.made[0, 0], found.kept[0, -1]) == (1.0, 2.0)
    # Sums go from the first kept design on: 7 - 5 and 9 - 5.
    assert (found.sums[0, -1, 0], found.squares[0, -1, 0]) == (6.0, 20.0)


@pytest.mark.judges("whole_machines")
def test_of_two_laws_under_a_cap_the_law_of_less_flank_load_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Towards more power and back each cap has a law; only laws that gain on all of less power are kept."""

    def law(power_w: float, load: float) -> Any:
        return Made(found=Made(peak_power_w=power_w), flank_load_n_mm=load, motion=load)

    up, back = {2.0: law(2.0, 50.0), 3.0: law(3.0, 30.0)}, {3.0: law(3.0, 28.0), 2.0: law(2.0, 42.0)}
    ways = iter([up[2.0], up[3.0], back[3.0], back[2.0]])
    search: Any = Made(task=None, wishes=None, least_power=lambda start: law(1.0, 60.0), caps_w=lambda *_: [2.0, 3.0])
    search.capped = lambda cap, motions: law(4.0, 29.0) if cap is None else next(ways)
    monkeypatch.setattr(laws, "start_motion", lambda *_: None)
    found = laws._Search.laws(search)
    assert [(one.found.peak_power_w, one.flank_load_n_mm) for one in found] == [(1.0, 60.0), (2.0, 42.0), (3.0, 28.0)]


@pytest.mark.judges("pitch")
def test_a_polar_path_has_the_derivatives_of_its_points() -> None:
    """r = 3 + cos 2t at the angle t + 0.2 sin t, differentiated as complex functions by 40 digits."""
    at = np.array([0.3, 1.9, 4.4])
    radius = 3.0 + np.cos(2.0 * at), -2.0 * np.sin(2.0 * at), -4.0 * np.cos(2.0 * at)
    turned = at + 0.2 * np.sin(at), 1.0 + 0.2 * np.cos(at), -0.2 * np.sin(at)
    found = _polar_path(radius, *turned)
    with mp.workdps(40):
        for order, values in enumerate(found):
            for place, value in zip(at.tolist(), values.tolist(), strict=True):
                wanted = mp.diff(lambda t: (3 + mp.cos(2 * t)) * mp.expj(t + mp.mpf("0.2") * mp.sin(t)), place, order)
                assert value == pytest.approx(complex(wanted), rel=1e-12)


@pytest.mark.judges("optimum")
def test_turns_of_the_load_come_with_the_largest_force_first() -> None:
    """Turns at 10 and 30 mm of the way out with 5 and 50 N, at 20 mm of the way back with 20 N."""
    load = Made(
        turns_mm=lambda _, back: np.array([20.0] if back else [10.0, 30.0]),
        against_n=lambda at, back: np.array([20.0]) if back else at * at / 18.0,
    )
    linkage = Made(stroke_mm=40.0, crank_angle=lambda at, back: at / 100.0 + np.where(back, 3.0, 0.0))
    assert _turns_of_load(Made(load=load, linkage=linkage)) == pytest.approx([0.3, 3.2, 0.1])
    still = Made(turns_mm=lambda *_: np.array([]), against_n=None)
    assert _turns_of_load(Made(load=still, linkage=linkage)) == []


@pytest.mark.judges("optimum")
def test_a_level_costs_its_weight_and_its_share_of_the_goal() -> None:
    levels = [Made(weight=2.0, share_of_goal=0.0), Made(weight=0.5, share_of_goal=0.1)]
    assert goal_weights(levels, 30.0) == pytest.approx([2.0, 3.5])


@pytest.mark.judges("dynamics")
@at_once(
    ("phi1", "number", "row"),
    [(1.0, 0, 0), (1.19, 0, 1), (1.2, 0, 2), (1.999, 0, 4), (2.05, 1, 0), (5.55, 4, 3)],
)
def test_a_place_of_ways_is_the_last_one_up_to_an_angle(phi1: float, number: int, row: int) -> None:
    """Ways of 1 rad from 1 rad on, each with places 0, 0.1, 0.2 and on from 0.2 rad."""
    ways = Ways(lambda begin, end: Made(phi1_rad=begin + np.array([0.0, 0.1, 0.2, 0.5, 0.9])), 1.0, 1.0)
    assert ways.place(phi1) == (number, row)


@pytest.mark.judges("files")
def test_a_spline_of_a_file_has_the_points_and_tangents_of_its_curve() -> None:
    """A circle of 5 mm by its arc length; scipy's B-spline of the same knots and poles is differentiated."""
    curve: Any = Made(
        at_length=lambda s: Made(
            position=5.0 * np.column_stack([np.cos(s / 5.0), np.sin(s / 5.0)]),
            tangent=np.column_stack([-np.sin(s / 5.0), np.cos(s / 5.0)]),
        )
    )
    knots = np.array([0.0, 1.0, 2.5, 3.0])
    made = _through(curve, knots)
    spline = BSpline(made.knots, made.poles_mm, 3)
    assert spline(knots) == pytest.approx(curve.at_length(knots).position, abs=1e-12)
    inner = knots[:-1]
    assert spline(inner, 1) == pytest.approx(curve.at_length(inner).tangent, abs=1e-12)
    between = np.array([0.4, 1.7, 2.8])
    # h^4 / 384 of the fourth derivative, 1/125 per mm, of the longest span
    assert spline(between) == pytest.approx(curve.at_length(between).position, abs=1.5**4 / 384.0 / 125.0 * 1.1)
