"""Places nearest on fillets, chords that touch, polar outlines, rings, turns and sizes of pictures, by hand."""

from __future__ import annotations

import asyncio
from math import pi, tau
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from matplotlib.colors import LogNorm, Normalize
from shapely import Point, Polygon

import ncgear.contact.written.apart as apart
import ncgear.drawings.plots.canvas as canvas
import ncgear.files.strength as strength_files
import ncgear.files.tolerance as tolerance_files
import ncgear.project.face_load as face_load
import ncgear.project.outline_trial as outline_trial
import ncgear.solids.helical.mesh as helical_mesh
import ncgear.solids.helical.patches as patches
import ncgear.studio.open_page as open_page
from at_once import at_once
from ncgear.contact.designed.clearance import _nearest
from ncgear.design.laws.pitch_curve import PitchCurve
from ncgear.drawings.charts.chart import ChartLine, Role
from ncgear.drawings.page.page_charts import _closed, _with_extremes
from ncgear.errors import NoSuchMechanism, RefusedAt
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.teeth.contour import SHORTEST_IN_MODULES
from ncgear.trains.loads import body_of
from ncgear.trains.tip_path import HARMONICS, TipMotion
from ncgear.trains.train import Part

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
@at_once("at", [-0.2, 0.0371, 0.1617, 0.2713, 0.4409, 0.6])
@at_once("sense", [1.0, -1.0])
def test_the_nearest_place_of_a_fillet_is_at_the_foot_or_an_end(at: float, sense: float) -> None:
    """A round fillet of 5 mm from 0 to 0.5 rad, its parameter falling or rising, in four chords; points beside it."""
    end = 0.5 if sense > 0.0 else 0.0
    ends = np.linspace(0.5 - end, end, 5)

    def fillet(owner: Any, parameter: Any) -> Any:
        around = 5.0 * np.exp(1j * parameter)
        return tuple(np.stack([one.real, one.imag], -1) for one in (around, 1j * around))

    paths: Any = Made(
        chord=lambda flank, number: (np.zeros(1, dtype=int), number), flanks=Made(fillet=fillet),
        parameter=ends[None], runs=Made(owner=np.zeros(1, dtype=int), start=ends[:1], end=ends[-1:]),
    )  # fmt: skip
    nearest = np.array([int(np.clip(np.abs(ends[:-1] - at).argmin(), 0, 3))])
    found, slope = _nearest(paths, (np.zeros(1, dtype=int), nearest), np.array([5.4 * np.exp(1j * at)]))
    assert np.angle(found) == pytest.approx([min(max(at, 0.0), 0.5)], abs=0.125 / 4.0**3 / 1.99)
    assert slope == pytest.approx(1j * found)


@pytest.mark.judges("contact")
@at_once("pitch", [0.3, 20.0])
@at_once(("end", "crosses"), [(-0.5, True), (0.5, False), (-1e-14, True)])
def test_chords_that_hardly_touch_may_cross(pitch: float, end: float, crosses: bool) -> None:
    """A chord of one pitch up, whose lower end is beside the middle of another chord, or on it to rounding."""
    parallel = Made(start=np.array([[0j]]), against=np.array([[1.0 + 0j]]), length_mm=np.array([[pitch]]))
    across = Made(
        start=np.array([[pitch * (0.5 + 1j * end)]]), against=np.array([[-1j]]), length_mm=np.array([[pitch]])
    )
    placement: Any = Made(pitch_mm=pitch)
    setting: Any = Made(placement=placement, stretches=Made(position=np.array([[0]])))
    far = np.full((2, 2, 1), np.inf)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(apart, "_placed", lambda *_: (across, parallel))
        patch.setattr(apart, "_least_turns", lambda *_: far)
        _, free = apart._block_play(setting, Made(row=np.array([0])), np.array([0]), 9.0)
    assert free.tolist() == [not crosses]


@pytest.mark.judges("contact")
@at_once(("grain", "size"), [(3.0, 6.0), (0.001, 0.05)])
def test_cells_are_two_grains_wide_or_a_two_thousandth_of_the_outline(
    monkeypatch: pytest.MonkeyPatch, grain: float, size: float
) -> None:
    """An outline of 50 mm about its axis; chords of up to 4 mm move by one and a half grains."""
    monkeypatch.setattr(apart, "cells_near", lambda chords, near_mm, cell_mm: (near_mm, cell_mm))
    of: Any = Made(
        _known_cells={},
        chords=Made(half_mm=np.array([1.0, 2.0])),
        grain_mm=grain,
        driven=np.array([30.0, -50j]),
        once=None,
    )
    assert apart.Facing.cells(of, 0.5) == pytest.approx((0.5 + 2.0 + 1.5 * grain, size))


@pytest.mark.judges("contact")
@at_once(("beyond", "met"), [(0.0, True), (0.5, True), (2.0, False)])
def test_chords_are_longer_by_a_slack(beyond: float, met: bool) -> None:
    """A vertex that turns about the driven axis to a chord from 10 to 14 mm, which it meets beside the chord's end."""
    slack = 1e-3
    radius = 14.0 + beyond * slack
    start, against = np.array([[10.0 + 0j]]), np.array([[1.0 + 0j]])
    chord: Any = Made(start=start, against=against, length_mm=np.array([[4.0]]))
    vertex = radius * np.exp(0.01j) - start
    found = apart._least_turns(vertex, chord, np.zeros(1, dtype=int), 1, 1.0, slack)
    assert found[np.isfinite(found)] == pytest.approx([0.01] * met)


@pytest.mark.judges("design")
@at_once(("gear", "drawn", "sense"), [("driving", False, -1.0), ("driven", False, 1.0), ("driving", True, 1.0)])
@at_once("points", [False, True])
def test_a_polar_curve_becomes_an_outline(gear: str, drawn: bool, sense: float, points: bool) -> None:
    """Radii of 10 to 40 mm over a turn; the angle of a formula is the turn of a driving gear, against the drawing."""
    angle = np.arange(4) * tau / 4.0 + 0.3
    radius = np.array([10.0, 20.0, 30.0, 40.0])

    def polar(at: Any, order: int) -> Any:
        return Made(value=at), Made(value=10.0 + 30.0 * (at - 0.3) / (tau * 0.75))

    part = Made(start=0.3, end=0.3 + tau, polar=polar)
    given = Made(polar=lambda: (angle, radius), in_plane=False) if points else None
    of: Any = Made(
        contour=None, b_spline=None, points=given, formula="r", gear=gear, _found_key=None, _is_drawn=drawn,
        _curves=lambda key, order: (lambda size: Made(stretches=[part]), None, None),
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ncgear.design.laws.pitch_curve.given", lambda *_: ["formula"])
        patch.setattr("ncgear.design.laws.pitch_curve.PER_STRETCH", 4)
        found, axis, _ = PitchCurve.outline_mm(of)
    assert found @ [1.0, 1j] == pytest.approx(radius * np.exp(1j * sense * angle))
    assert axis.tolist() == [0.0, 0.0]


@pytest.mark.judges("drawings")
@at_once(("last", "count"), [(300.0, 4), (360.0 * (1.0 - 1e-13), 3), (359.0, 4)])
def test_a_line_of_a_cycle_ends_as_it_begins(last: float, count: int) -> None:
    line = ChartLine(Role.OTHER, "a", np.array([0.0, 100.0, last]), np.array([5.0, 7.0, 6.0]))
    found = _closed(line, 360.0, Role.OWN, "b")
    assert (found.role, found.label, len(found.x)) == (Role.OWN, "b", count)
    assert count == 3 or (found.x[-1], found.values[-1]) == (360.0, 5.0)


@pytest.mark.judges("drawings")
def test_extremes_stand_in_a_line_at_their_places() -> None:
    """The least value lies between two places, the greatest at one."""
    line = ChartLine(Role.OWN, "a", np.array([0.0, 90.0, 180.0]), np.array([5.0, 7.0, 6.0]))
    low, high = Made(at=2.0 * pi / 3.0, value=0.004), Made(at=pi / 2.0, value=0.009)
    found = _with_extremes(line, Made(low=low, high=high), 1000.0)
    assert found.x == pytest.approx([0.0, 90.0, 120.0, 180.0])
    assert found.values == pytest.approx([5.0, 7.0, 4.0, 6.0])


@pytest.mark.judges("files")
@at_once("norm", [Normalize(0.0, 1.0), LogNorm(0.1, 10.0)])
def test_a_scale_of_colours_lies_below_the_gears(monkeypatch: pytest.MonkeyPatch, norm: Any) -> None:
    """0.62 inches over the lower edge of a picture 8 inches high, 0.16 inches thick."""
    asked = list[Any]()
    monkeypatch.setattr(canvas, "color_bar", lambda made, norm, scale, box, label, extend: asked.extend([box, extend]))
    strength_files.PairPicture.with_scale(Made(height_in=8.0, made=None), norm, None, "")  # type: ignore[arg-type]
    assert asked == [pytest.approx((0.2, 0.0775, 0.6, 0.02)), "both" if isinstance(norm, LogNorm) else "max"]


@pytest.mark.judges("files")
def test_causes_of_figures_stand_below_each_other_with_their_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two figures of three sources, the largest on top; an error does not reach below nothing."""
    sizes, axes = list[Any](), MagicMock()
    made = Made(add_subplot=lambda: axes)
    monkeypatch.setattr(canvas, "figure", lambda *given: (sizes.extend(given[:2]), made)[1])  # type: ignore[func-returns-value]
    monkeypatch.setattr(canvas, "png", lambda made: b"")
    monkeypatch.setattr(canvas, "dress", lambda *_: None)
    first = {"pitch": (0.25, 0.5), "bore": (0.5, 0.1)}
    tolerance_files.sources({"play": first, "error": {"runout": (0.75, 0.0), "bore": (0.125, 0.0)}}, "")
    assert sizes == pytest.approx([8.2, 1.5 + 0.42 * 3])
    (places, values, thick), (below, others, _) = (call.args for call in axes.barh.call_args_list)
    assert axes.set_yticks.call_args.args[1] == ["pitch", "bore", "runout"]
    assert values == pytest.approx([25.0, 50.0, 0.0])
    assert others == pytest.approx([0.0, 12.5, 75.0])
    assert thick == pytest.approx(0.4)
    # Both bars of a source fill 0.8 of its row about the middle
    assert places == pytest.approx([0.2, 1.2, 2.2])
    assert below == pytest.approx([-0.2, 0.8, 1.8])
    assert axes.barh.call_args_list[0].kwargs["xerr"] == pytest.approx(np.array([[25.0, 10.0, 0.0], [50.0, 10.0, 0.0]]))
    assert axes.set_ylim.call_args.args == pytest.approx((-0.7, 2.7))


@pytest.mark.judges("project")
@at_once("thrust_on", ["a", "b"])
def test_one_bearing_bears_the_thrust(monkeypatch: pytest.MonkeyPatch, thrust_on: str) -> None:
    monkeypatch.setattr(face_load, "_bearing", lambda given, bears_thrust: (given, bears_thrust))
    shaft: Any = Made(bearing_a="a", bearing_b="b", thrust_on=thrust_on)
    found: Any = face_load.seats_of(shaft)
    assert found.bearings == (("a", thrust_on == "a"), ("b", thrust_on == "b"))
    assert face_load.seats_of(Made(bearing_a=None, bearing_b="b", thrust_on="a")) is None


@pytest.mark.judges("project")
def test_places_that_lack_contact_are_those_of_short_arcs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Arcs of half, just over and under what is short; a place that clashes is told where it is refused."""
    monkeypatch.setattr(outline_trial, "replace", lambda found, **changes: changes)
    monkeypatch.setattr(outline_trial, "_places", lambda curve, at: np.array([7.0]))
    monkeypatch.setattr(outline_trial, "given_gear", lambda motion: None)
    short = outline_trial.SHORT
    pitch = Made(of=lambda gear: Made(at_angle=lambda phi1: phi1))
    found: Any = Made(
        arcs=short * np.array([0.5, 1.01, 0.99]), meetings_mm=np.array([1.0, 2.0, 3.0]), lacking=np.array([[9.0, 9.0]]),
        drive=Made(pitch=pitch), curve=None, motion=None,
    )  # fmt: skip

    def refused(error: Exception) -> Any:
        def judge(made: Any) -> Any:
            raise error

        changes: Any = outline_trial.judged(found, judge)
        return changes["lacking"]

    lacking = np.array([[9.0, 9.0], [1.0, 0.5 * short], [3.0, 0.01 * short]])
    assert refused(NoSuchMechanism("no")) == pytest.approx(lacking)
    clash = np.array([[9.0, 9.0], [7.0, outline_trial.CLASH]])
    assert refused(RefusedAt("no", phi1_rad=1.5)) == pytest.approx(clash)


@pytest.mark.judges("solids")
def test_a_lofted_solid_has_the_volume_between_its_rings_less_its_holes() -> None:
    """A square that turns up to three heights, with two round holes: each section has its area, by shapely."""
    square = np.array([[20.0, 20.0], [-20.0, 20.0], [-20.0, -20.0], [20.0, -20.0]])
    holes = [np.array(Point(x, 2.0).buffer(3.0, 2).exterior.coords)[:-1][::-1] for x in (-8.0, 8.0)]
    rings = np.stack([square, square, 0.9 * square])
    found = helical_mesh.lofted(rings, np.array([0.0, 6.0, 10.0]), holes)
    a, b, c = (found.vertices[found.faces[:, corner]] for corner in range(3))
    volume = float(np.sum(a * np.cross(b, c)) / 6.0)
    gone = sum(Polygon(hole).area for hole in holes)
    # A frustum of squares of 40 and 36 mm over 4 mm
    exact = 1600.0 * 6.0 + 4.0 / 3.0 * (1600.0 + 1440.0 + 1296.0) - 10.0 * gone
    assert volume == pytest.approx(exact, rel=1e-6)
    assert isinstance(found, TriangleMesh)


@pytest.mark.judges("solids")
@at_once("module", [0.5, 4.0])
def test_the_shortest_curve_of_a_surface_is_told_in_modules(monkeypatch: pytest.MonkeyPatch, module: float) -> None:
    asked = list[float]()

    def require(curves: Any, gear: Any, shortest_mm: float) -> None:
        asked.append(shortest_mm)
        raise NoSuchMechanism("asked")

    monkeypatch.setattr(patches, "_curves", lambda sections, gear, height: height)
    monkeypatch.setattr(patches, "_require_alike", require)
    section = Made(of=lambda gear: Made(flanks=Made(rack=Made(module_mm=module))))
    sections: Any = Made(helix=Made(rise_mm=8.0), at=lambda height: section)
    with pytest.raises(NoSuchMechanism):
        patches._interpolated(sections, None, 2, 2)  # type: ignore[arg-type]
    assert asked == [pytest.approx(SHORTEST_IN_MODULES * module)]


@pytest.mark.judges("studio")
def test_states_of_a_page_are_numbered_upwards() -> None:
    """A state has a number of its own after all that was asked before, and no older answer is shown."""
    told, asked = list[str](), list[Any]()

    async def tell(text: str) -> None:
        told.append(text)

    async def ask(number: int, *given: Any) -> None:
        asked.append((number, given[1]))

    page = object.__new__(next(one for one in vars(open_page).values() if hasattr(one, "_show")))
    page.__dict__.update(
        number=4, _shown=2, _asking=asyncio.Lock(), _state=lambda: {"text": "now"}, _draft_problem=lambda text: "",
        _tell=tell, _chains=Made(ask=ask), file=Made(path="d.yaml"),
    )  # fmt: skip
    asyncio.run(page._show())
    asyncio.run(page._show())
    assert (page.number, page._shown, asked) == (6, 6, [(5, {}), (6, {})])
    assert '"n": 6' in told[-1]


@pytest.mark.judges("trains")
def test_a_turn_of_a_carrier_is_closed_by_a_whole_turn() -> None:
    waves = np.zeros(2 * HARMONICS)
    waves[[0, HARMONICS + 1]] = 0.2, -0.1
    motion = TipMotion(0j, 30.0, 20.0, 0.7, waves, clockwise=False)
    w, u = motion.turn
    assert (w[0], w[-1], u[-1] - u[0]) == pytest.approx((0.0, tau, tau))
    assert u == pytest.approx(w + 0.7 + 0.2 * np.cos(w) - 0.1 * np.sin(2.0 * w))


@pytest.mark.judges("trains")
def test_the_centre_of_a_ring_lies_away_from_its_hole() -> None:
    """A square hole of 8 mm about 2 mm to the right and 1 mm up in a disc of 20 mm: by the square's own moments."""
    hole = np.array([[6.0, 5.0], [-2.0, 5.0], [-2.0, -3.0], [6.0, -3.0]])
    reach = float(np.hypot(6.0, 5.0))
    found = body_of(Part("ring", hole, 10.0, teeth=9, rim_mm=20.0 - reach), 1e5)
    kg, gone = 1e-3 * (400.0 * pi), 1e-3 * 64.0
    assert found.kg == pytest.approx(kg - gone)
    center = -gone * (2.0 + 1.0j) / (kg - gone)
    assert found.center_mm == pytest.approx(center)
    about_axis = kg * 200.0 - gone * (64.0 / 6.0 + 5.0)
    assert found.kg_mm2 == pytest.approx(about_axis - (kg - gone) * abs(center) ** 2)
