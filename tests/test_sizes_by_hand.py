"""Sizes, places and pictures of many rooms, each on a few numbers that are done by hand."""

from __future__ import annotations

from math import degrees, inf, log, pi, radians, sin, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from pydantic import BaseModel

from at_once import at_once
from drives import drive_of_text
from ncgear.design.trains.tip_path import TipPathKeys
from ncgear.drawings.animation import artists
from ncgear.drawings.scene import standing
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.advice.machine_advice import _of_unit
from ncgear.metrology.deviations import TIP_LAND_CURVE, is_metal
from ncgear.optimum.makeable import law
from ncgear.project import tolerance_limits
from ncgear.project.law_task import _of_undercut
from ncgear.ratio.sampled_strokes import EVERYWHERE, edges_about
from ncgear.screening.rows import _steeper_deg
from ncgear.studio import form
from ncgear.teeth import fouling
from ncgear.trains import path_search
from ncgear.wishes.dwell import Dwell

Made: Any = SimpleNamespace


@pytest.mark.judges("pitch")
@at_once(("ratio_start", "ratio_end"), [(0.5, 2.0), (1.5, 0.8)])
def test_teeth_of_a_module_fill_a_logarithmic_spiral(ratio_start: float, ratio_end: float) -> None:
    """Of radii a/(1 + i) over 300 deg its length is their difference times sqrt(1 + g^2)/g, g = ln(r2/r1)/angle."""
    motion = f"{{law: spiral, ratio_start: {ratio_start}, ratio_end: {ratio_end}, range_deg: 300}}"
    head = f"name: spiral\noperation: {{speed_rpm: 60}}\nmotion: {motion}\n"
    size = drive_of_text(f"{head}gears: {{teeth: 40, module_mm: 1.5, face_width_mm: 10}}\n").pitch.size
    radii = 1.0 / (1.0 + ratio_start), 1.0 / (1.0 + ratio_end)
    growth = abs(log(radii[1] / radii[0])) / radians(300.0)
    length = abs(radii[1] - radii[0]) * sqrt(1.0 + growth**2) / growth
    assert size.center_distance_mm == pytest.approx(40.0 * pi * 1.5 / length)


@pytest.mark.judges("project")
def test_teeth_of_a_law_are_free_of_undercut_by_the_height_of_the_straight_flank() -> None:
    """k h < sin^2: over z pi/lobes of the curve for a rack of 1.4 modules, 0.3 of them round; 20 deg before 28."""
    angles = radians(28.0), radians(20.0)
    rack = Made(dedendum_mm=1.4, root_radius_mm=0.3, angles_rad=angles)

    def gears(teeth: int, lobes: int) -> Any:
        return Made(teeth=teeth, lobes=Made(driving=lobes), rack=Made(in_mm=lambda module: rack))

    straight = 1.4 - 0.3 * (1.0 - sin(angles[1]))
    for teeth, lobes in ((60, 1), (80, 2)):
        (found,) = _of_undercut(Made(free_of_undercut=True), gears(teeth, lobes))
        assert found.turns == pytest.approx(sin(angles[1]) ** 2 * teeth * pi / lobes / straight)
    with pytest.raises(WrongInput, match=f"over {2.0 * straight / sin(angles[1]) ** 2:.4g} are right"):
        list(_of_undercut(Made(free_of_undercut=True), gears(20, 1)))
    assert list(_of_undercut(Made(free_of_undercut=False), None)) == []


@pytest.mark.judges("project")
@at_once(
    ("given", "web", "width"),
    [(0.0, 0.0, 10.0), (0.5, 0.0, 25.0), (0.5, 24.0, 25.0), (0.5, 26.0, None), (9.0, 0.0, 39.9), (-1.0, 0.0, None)],
)
def test_a_face_is_as_wide_as_a_usual_backlash_is_enough_for(given: float, web: float, width: float | None) -> None:
    """A face of 40 mm that needs a 50th of its width: what modules of 2 mm may have, or what the file has, decides.

    A face no wider than a web has no room for it.
    """
    usual = 0.2 if given >= 0.0 else 1e-6
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tolerance_limits, "MOST_BACKLASH", usual / 2.0)
        patch.setattr(tolerance_limits, "SURELY", 1.0)
        patch.setattr(tolerance_limits, "widths_mm", lambda design: (web, inf))
        patch.setattr(tolerance_limits, "with_width", lambda design, width: {"gears.face_width_mm": width})
        patch.setattr(tolerance_limits, "changed_drive", lambda whole, changes: changes["gears.face_width_mm"])
        patch.setattr(tolerance_limits, "backlash_needed", lambda width: width / 50.0)
        patch.setattr(tolerance_limits, "enough", lambda needed, share: needed)
        patch.setattr(tolerance_limits, "_made_up", lambda needed: needed)
        gears, pitch = Made(face_width_mm=40.0), Made(size=Made(module_mm=2.0))
        drive: Any = Made(gears=gears, pitch=pitch, helix=None, whole=None, design=None)
        found = tolerance_limits._narrower(drive, "backlash_mm", given)
    if width is None:
        assert found == {}
    else:
        assert found["gears.face_width_mm"] == pytest.approx(width, rel=0.02)
        assert ("gears.backlash_mm" in found) is (width / 50.0 > given)


@pytest.mark.judges("metrology")
def test_edges_of_lands_and_points_that_stand_alone_are_no_metal() -> None:
    """The middle third of a land counts; of flanks all, but for ends, points far away and those that stand alone."""
    share = np.array([0.4, 0.3, 0.65, 0.9, 0.1, 0.5, 0.5, 0.5])
    part = np.array([TIP_LAND_CURVE] * 4 + [TIP_LAND_CURVE + 1] * 4)
    number = np.arange(8)
    feet = Made(row=number, share=share, at_end=number == 5, distance_mm=np.where(number == 6, 9.0, 0.0))
    outline: Any = Made(part=part, gear=Made(flanks=Made(rack=Made(module_mm=2.0))))
    fit: Any = Made(feet=feet, alone=number == 7)
    assert is_metal(outline, fit).tolist() == [True, False, True, False, True, False, False, False]


@pytest.mark.judges("figures")
def test_a_drawing_in_another_unit_is_told_with_its_size_in_both() -> None:
    """A contour of 254 by 50 mm, taken in inches, would be 10 by 1.97 mm if it were in mm."""
    given: Any = Made(unit="inch", unit_mm=25.4)
    assert "about 254 by 50 mm; in mm it would be 10 by 1.97 mm" in str(_of_unit(given, "mm", [254.0, 50.0]))


@pytest.mark.judges("drawings")
def test_the_view_of_a_machine_without_gears_is_a_square_about_its_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("supports_mm", "walls_mm"):
        monkeypatch.setattr(standing, name, lambda _: [])
    for name in ("support_hatches_mm", "hatches_mm"):
        monkeypatch.setattr(standing, name, lambda _: np.empty((0, 2, 2)))
    scene = Made(machine=Made(linkage=Made(crank_mm=100.0)), links=(), pairs=(), gears=[], swept_mm={})
    (left, bottom, width, height) = standing.views.__wrapped__(scene)["machine"]
    assert (left + width / 2.0, bottom + height / 2.0) == pytest.approx((0.0, 0.0))
    assert width == height == pytest.approx(2.0 * 100.0 * (1.0 + standing.CRANK_EYE) * (1.0 + 2.0 * standing.SLACK))


@pytest.mark.judges("drawings")
def test_a_strip_of_material_lies_where_its_pose_has_it() -> None:
    """Squeezed to 30 mm from 10 mm on, 8 mm high about a level of 2 mm, in the coordinates of its axes."""
    axes = Figure().subplots()
    axes.set_xlim(0.0, 100.0)
    chamber: Any = Made(straw=False, material_height_mm=8.0, level_mm=2.0)
    scene: Any = Made(strips_mm=lambda poses: {"charge": (np.array([0.0, 10.0]), np.array([0.0, 30.0]))})
    strip = artists._strip(axes, scene, chamber, "charge")
    strip.pose(Made(), 1)
    (block,) = strip.artists
    corners = axes.transData.inverted().transform(block.get_transform().transform([[0.0, 0.0], [1.0, 1.0]]))
    assert corners == pytest.approx(np.array([[10.0, -2.0], [40.0, 6.0]]))
    assert block.get_visible()
    strip.pose(Made(), 0)
    assert not block.get_visible()


@pytest.mark.judges("ratio")
def test_pieces_about_a_place_of_a_return_are_quartered_towards_it() -> None:
    """About 0.3 of it: the ends, the place itself, a quarter and a sixteenth to both sides, and no place beyond."""
    edges = edges_about(np.array([0.3, 0.9]), 2)
    for own, about in zip(edges, (0.3, 0.9), strict=True):
        assert (own[0], own[-1]) == pytest.approx((-about, 1.0 - about))
        assert (np.diff(own) >= 0.0).all()
        assert 0.0 in own
    for wanted in (0.25, -0.25, 0.0625, -0.0625):
        assert np.abs(edges[0] - wanted).min() < 1e-12
    # All pieces between are those of the whole return.
    assert set(np.round(np.array(EVERYWHERE) - 0.3, 9)) <= set(np.round(edges[0], 9))


@pytest.mark.judges("screening")
def test_the_steeper_of_both_flanks_counts() -> None:
    racks = [Made(gears=None), *(Made(gears=Made(rack=Made(angles_deg=one))) for one in ((20.0, 25.0), (28.0, 14.5)))]
    batch: Any = Made(written=racks, follows=np.array([2, 0, 1, 1]))
    assert _steeper_deg(batch).tolist() == [28.0, -np.inf, 25.0, 25.0]


@pytest.mark.judges("teeth")
def test_a_tooth_that_fouls_without_a_tip_below_is_refused_by_its_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of three teeth the second has no tip on its lower height."""
    met = np.array([True, False, True])
    monkeypatch.setattr(fouling, "_lowered", lambda *_: None)
    monkeypatch.setattr(fouling, "tip_crossing", lambda flanks: (None, None, met))
    monkeypatch.setattr(fouling, "no_tip", lambda flanks, number: NoSuchMechanism(f"no tip {number}"))
    own: Any = Made(flanks=None, height_mm=None)
    paths: Any = Made(own=np.zeros(3, dtype=int), kept=lambda mask: None)
    with pytest.raises(NoSuchMechanism, match="no tip 1"):
        fouling._free_of(own, paths, lambda *_: np.array([True]))
    assert fouling._free_of(own, paths, lambda *_: np.array([False])) is own


@pytest.mark.judges("wishes")
def test_a_dwell_is_offered_within_what_the_output_can_keep_in_its_own_unit(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.02 rad from an end are 1.15 deg, told a little above; other ends, lengths and ratios go on to the search."""
    asked: list[Any] = []
    monkeypatch.setattr("ncgear.wishes.dwell.nearest_dwell_mm", lambda *given: asked.append(given) or 0.02)
    linkage: Any = Made(OUTPUT=Made(place=Made(factor=180.0 / pi, text="deg", ending="deg")))
    wish: Any = Made(end="extended", for_rad=0.5, eased=lambda words, **keys: (words, keys))
    ((words, keys),) = Dwell.instead(wish, linkage, 4.0)
    assert asked == [(linkage, "extended", 0.5, 4.0)]
    assert list(keys) == ["within_deg"]
    assert float(keys["within_deg"]) == pytest.approx(degrees(0.02), rel=1e-3)
    assert words == f"one within {keys['within_deg']} deg"


@pytest.mark.judges("optimum")
def test_a_search_from_an_even_crank_goes_on_from_the_law_that_comes_nearest(monkeypatch: pytest.MonkeyPatch) -> None:
    found: dict[str, Any] = {}
    monkeypatch.setattr(law, "kept", lambda search, start: found.get(start))

    def search(near: Any) -> Any:
        return Made(begun=lambda _: "begun", nearest=lambda start: near)

    near = Made(excess=0.5 * law.NO_EXCESS, coefficients="near")
    assert law._from_even(search(near)) is None
    found["near"] = 2
    assert law._from_even(search(near)) == 2
    assert law._from_even(search(Made(excess=2.0 * law.NO_EXCESS, coefficients="near"))) is None
    assert law._from_even(search(None)) is None
    found["begun"] = 1
    assert law._from_even(search(near)) == 1


@pytest.mark.judges("design")
def test_a_tip_goes_straight_from_the_point_with_the_number_that_is_given() -> None:
    """From the second of six points, counted from 1: more places lie on the line to the third."""
    points = [[100.0, 0.0], [60.0, 80.0], [0.0, 100.0], [-90.0, 30.0], [-60.0, -80.0], [30.0, -90.0]]
    tool = [{"point": 3, "angle_deg": 90.0}]
    path = TipPathKeys(points_mm=points, straight=[2], tolerance_mm=0.2, tool=tool).wished()
    more = path.points.size - 6
    assert more > 0
    assert path.points[1] == 60.0 + 80.0j
    between = path.points[2 : 2 + more]
    share = (between - (60.0 + 80.0j)) / (-60.0 + 20.0j)
    assert share.imag == pytest.approx(0.0, abs=1e-12)
    assert ((share.real > 0.0) & (share.real < 1.0)).all()
    ((place, angle),) = path.tool_rad
    assert (path.points[place], angle) == (100.0j, pytest.approx(pi / 2.0))
    assert path.tolerance_mm == pytest.approx(0.2)


@pytest.mark.judges("trains")
@at_once(("least", "words"), [(-0.2, "would have to turn back"), (0.001, "all but stands")])
def test_a_carrier_that_cannot_go_on_is_told_where(least: float, words: str) -> None:
    """Near the second of three points, where the tip is when the ratio is least."""
    ratio = np.array([1.0, least, 0.5])
    motion: Any = Made(hardness=([ratio], np.arange(3.0)), tip=lambda w: np.array([10.0j + w[0]]))
    path: Any = Made(points=np.array([0.0, 10.0j, 30.0]), name=lambda number: number + 1)
    with pytest.raises(NoSuchMechanism, match=f"the carrier {words} against the sun near point 2, at 1, 10 mm"):
        path_search._accepted(motion, path, Made(low=None), None)


@pytest.mark.judges("studio")
@at_once(("value", "step"), [(123.4, 1.0), (8.0, 0.01), (0.5, 0.001), (45_000.0, 100.0), (None, 0.01), (-25.0, 0.1)])
def test_a_step_of_a_field_is_a_hundredth_as_a_power_of_ten(value: Any, step: float) -> None:
    key: Any = Made(rule={"type": "number"})
    assert form._step(key, value, BaseModel) == step
    key.rule = {"type": "integer"}
    assert form._step(key, value, BaseModel) == 1
