"""Motions in time, bodies and outlines on a few numbers that are done by hand: gaps of contact, peaks, moments."""

from __future__ import annotations

from itertools import pairwise
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ncgear.cli.progress import Lines
from ncgear.dynamics import history
from ncgear.dynamics.history import _passings_s, _sizes, meetings_s, partings_s, pressed_rad
from ncgear.dynamics.meshing import TwoShafts
from ncgear.figures.data_sheet.entries import shafts_below
from ncgear.optimum.outline import nearest
from ncgear.project.passing import CRANK_PIN
from ncgear.ratio.laws.curve_shapes import smoothed_points
from ncgear.trains.loads import body_of
from ncgear.whole_machines import limits

Made: Any = SimpleNamespace


@pytest.mark.judges("dynamics")
def test_flanks_meet_where_their_depth_changes_its_sign() -> None:
    """A sine of 3 t passes zero at pi/3 and 2 pi/3 between 0.5 and 2.5."""
    found = meetings_s(lambda time: np.sin(3.0 * time), np.linspace(0.5, 2.5, 21))
    assert found == pytest.approx([pi / 3.0, 2.0 * pi / 3.0])
    assert meetings_s(np.exp, np.linspace(0.5, 2.5, 21)).size == 0


@pytest.mark.judges("dynamics")
def test_flanks_are_pressed_by_how_far_they_are_beyond_their_first_touch() -> None:
    """Pushing flanks touch 1 mrad ahead of the law, backs 3: a gear 2 mrad ahead touches neither, one at 0 pushes."""
    gaps = Made(play_rad=lambda phi: (np.full(phi.size, 0.001), np.full(phi.size, 0.003)))
    meshing: Any = Made(gaps=gaps, law=Made(at=lambda phi: (2.0 * phi, None)))
    shafts = TwoShafts(np.full(3, 0.5), 0.0, 1.0 + np.array([0.0, 0.002, 0.004]), 0.0)
    assert pressed_rad(meshing, shafts) == pytest.approx(np.array([[0.001, -0.001, -0.003], [-0.003, -0.001, 0.001]]))


@pytest.mark.judges("dynamics")
def test_times_without_contact_lie_between_meetings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pushing flanks are pressed by sin(t), backs by -0.5 - sin(t): neither where sin(t) is from -0.5 to 0."""

    def pressed(_: Any, time: np.ndarray) -> np.ndarray:
        return np.stack([np.sin(time), -0.5 - np.sin(time)])

    monkeypatch.setattr(history, "pressed_rad", pressed)
    fine = np.linspace(1.0, 6.0, 51)
    course: Any = Made(
        machine=Made(pairs=lambda time: [(None, time)]), at=lambda time: time, fine_s=fine, time_s=fine[::10]
    )
    assert partings_s(course)[0] == pytest.approx(np.array([[pi, 6.0]]))
    assert partings_s(course)[1] == pytest.approx(np.array([[pi, 7.0 * pi / 6.0], [11.0 * pi / 6.0, 6.0]]))


@pytest.mark.judges("dynamics")
def test_a_crank_passes_an_angle_once_in_each_turn() -> None:
    """At 2 rad a second it is at 1 rad after 0.5 s, and a turn later."""
    time = np.linspace(0.0, 6.0, 62)
    course: Any = Made(at=lambda time: np.stack([0.0 * time, 0.0 * time, 2.0 * time]), time_s=time)
    assert _passings_s(course, 1.0) == pytest.approx([0.5, 0.5 + pi])


@pytest.mark.judges("dynamics")
def test_peaks_are_those_of_sizes_and_of_a_torque_both_ways() -> None:
    def slide(*values: float) -> Any:
        return Made(**{key: np.array([value]) for key, value in zip(names, values, strict=True)})

    names = "displacement", "velocity", "acceleration"
    one = np.array([1.0])
    shown: Any = Made(slide=slide(1.0, -5.0, -7.0), law=slide(4.0, -3.0, -6.0), pushing_n=8.0 * one, back_n=9.0 * one)
    shown.before, shown.torque_n_mm, shown.forces = (), -10.0 * one, {"pin": Made(x=3.0 * one, y=-4.0 * one)}
    told = {name: float(value[0]) for name, value in _sizes(shown).items()}
    assert told == {
        "displacement_error": 3.0,
        "velocity_error": 2.0,
        "acceleration": 7.0,
        "pushing_n": 8.0,
        "back_n": 9.0,
        "most_torque_n_mm": -10.0,
        "least_torque_n_mm": 10.0,
        "pin force": 5.0,
    }


@pytest.mark.judges("trains")
@pytest.mark.parametrize("is_ring", [False, True])
def test_a_part_weighs_what_its_holes_leave_and_masses_add(is_ring: bool) -> None:
    """A square of 60 mm, whole or cut out of a disc of 50 mm of radius, 10 mm thick, of a density of 1 g/cm3."""
    corners = np.array([[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]])
    hole = Made(x_mm=12.0, y_mm=9.0, diameter_mm=8.0)
    part: Any = Made(outline_mm=corners, rim_mm=None, reach_mm=50.0, holes=[hole], bore_mm=6.0, face_width_mm=10.0)
    area, polar = 3600.0, 2.0 * 60.0**4 / 12.0
    if is_ring:
        part.rim_mm, disc = 5.0, pi * 50.0**2
        area, polar = disc - area, disc * 50.0**2 / 2.0 - polar
    gone, bored = pi * 16.0, pi * 9.0
    area -= gone + bored
    polar -= gone * (15.0**2 + 8.0) + bored * 4.5
    mass = area * 10.0 * 1e-6
    put: Any = Made(kg=0.004, at_mm=-20.0 + 0.0j)
    body = body_of(part, 1000.0, [put])
    assert body.kg == pytest.approx(mass + 0.004)
    first = -gone * (12.0 + 9.0j) * 1e-5 + 0.004 * -20.0
    center, inertia = first / body.kg, polar * 1e-5 + 0.004 * 400.0 - abs(first) ** 2 / body.kg
    told = [complex(value) for value in vars(body).values()]
    assert told == pytest.approx([body.kg, center, inertia])


@pytest.mark.judges("optimum")
def test_a_curve_is_away_from_both_outlines_by_their_shares(monkeypatch: pytest.MonkeyPatch) -> None:
    """Mean squares of 4 and 9 mm2, greatest distances of 5 and 2 mm; the mate is drawn at 1 to 3 and has a fifth."""
    squares, greatest = {"own": 4.0, "mate": 9.0}, {"own": 5.0, "mate": 2.0}
    drawn: dict[str, Any] = {}
    monkeypatch.setattr(nearest, "_mean_square", lambda one, points, count: drawn.update({one: points}) or squares[one])
    monkeypatch.setattr(nearest, "_apart", lambda one, points, count: Made(greatest_mm=greatest[one]))
    curve: Any = Made(
        points=lambda: (np.ones(2), None),
        mate_in_drawing=lambda: (np.full(2, 6.0), None),
        mate_place=Made(scale=3.0),
    )
    outline: Any = "own"

    def away(share: float | None, is_greatest: bool) -> float:
        mate = None if share is None else Made(outline="mate", share=share)
        return nearest.away_mm(outline, curve, Made(mate=mate, greatest=is_greatest))

    assert away(None, False) == pytest.approx(2.0)
    assert away(0.2, False) == pytest.approx((0.8 * 4.0 + 0.2 * 9.0 * 9.0) ** 0.5)
    assert drawn["mate"].tolist() == [2.0, 2.0]
    assert away(None, True) == 5.0
    assert away(0.2, True) == pytest.approx(max(5.0, 3.0 * 0.25 * 2.0))
    assert away(0.8, True) == pytest.approx(max(0.25 * 5.0, 3.0 * 2.0))


@pytest.mark.judges("figures")
def test_rods_that_meet_the_driving_shaft_must_end_below_it() -> None:
    def passing(part: str, meets: bool, about: bool) -> Any:
        return Made(part=part, meets=meets, standing=Made(name="shaft", about_driving_axis=about))

    drive: Any = Made(
        passings=[
            passing("rod", True, True),
            passing("rocker", False, True),
            passing("lever", True, False),
            passing(CRANK_PIN, True, True),
        ]
    )
    assert shafts_below(drive) == [("rod", "shaft")]


@pytest.mark.judges("cli")
@pytest.mark.parametrize(("total", "count"), [(None, ""), (1, ""), (2, " (1 of 2 done)"), (9, " (1 of 9 done)")])
def test_a_line_of_progress_counts_where_there_are_two_steps_or_more(total: int | None, count: str) -> None:
    assert Lines.line.fget(Made(now=("teeth", 1, total), seconds=12.2)) == f"12 s: teeth{count}"  # type: ignore[attr-defined]


@pytest.mark.judges("ratio")
def test_a_smooth_curve_through_points_that_begin_anywhere_goes_round_once() -> None:
    """10 + cos(2 a) from 0.7 rad on, of one lobe and of two; pieces follow each other over a whole turn."""
    for repeats in (1, 2):
        angle = 0.7 + 2.0 * pi / repeats * np.arange(80) / 80
        curve, missed = smoothed_points(angle, 10.0 + np.cos(2.0 * angle), 1e-3, repeats, "motion")
        parts = curve.stretches
        assert parts[-1].end - parts[0].start == pytest.approx(2.0 * pi)
        assert all(after.start == pytest.approx(one.end) for one, after in pairwise(parts))
        for part in parts:
            at = np.linspace(part.start, part.end, 30)
            turned, radius = part.polar(at, 0)
            assert radius.value == pytest.approx(10.0 + np.cos(2.0 * turned.value), abs=3e-3)
        assert missed <= 1e-3


@pytest.mark.judges("whole_machines")
@pytest.mark.parametrize(("mean_w", "least_w"), [(40.0, 60.0), (70.0, 70.0)])
def test_no_law_has_less_than_the_least_of_all_parts_of_the_range(
    mean_w: float, least_w: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Parts with 80 and 60 W; looked at up to the least power of all machines, and never under the mean power."""
    asked: list[Any] = []
    monkeypatch.setattr(limits, "swept_power", lambda sweeps, parts, most: asked.append(most) or np.array([80.0, 60.0]))
    monkeypatch.setattr(limits, "least_mean_power_w", lambda task: mean_w)
    machines = [Made(figures=Made(peak_power_w=power)) for power in (120.0, 90.0, 100.0)]
    one: Any = Made(machines=machines, sweeps=None, design=Made(masses=1), task=None)
    # What is left is raised by a programme, here by nothing
    one.motion, one.raised = lambda number: None, lambda bounds, jobs: bounds
    one._flywheel_parts = lambda: np.zeros((2, 2))
    assert limits.MachineLimits.power_w(one) == least_w
    assert asked[0] == pytest.approx([90.0, 90.0], rel=1e-3)
    assert (asked[0] >= 90.0).all()
