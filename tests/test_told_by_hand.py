"""What is told, drawn and written, on a few numbers that are done by hand: figures, supports, notes, splines, laws."""

from __future__ import annotations

import json
from math import asin, degrees, pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.special import ellipe

from drives import drive_of_text
from ncgear.design.laws.ellipse import Ellipse
from ncgear.design.laws.harmonic_ratio import HarmonicRatio
from ncgear.design.laws.spiral import Spiral
from ncgear.design.trains.tip_path import TipPathKeys
from ncgear.drawings.scene.standing import SUPPORT, SUPPORT_HATCHES, support_hatches_mm
from ncgear.dynamics.history import BETWEEN_BEARING, CRANK_BEARING, MESH_BEFORE, Peak
from ncgear.figures import compared
from ncgear.figures.advice.teeth_advice import idle_flanks
from ncgear.figures.advice.values import Kind
from ncgear.figures.side_by_side import design_figures
from ncgear.figures.simulated import _lasting_s, _peak_at, dynamic_table
from ncgear.files.editor import with_member
from ncgear.files.workshop.drawing import gear_notes
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.pitch.shape import Gear
from ncgear.studio.worker import _line

Made: Any = SimpleNamespace

ELLIPSE = """\
name: wheel
operation: {speed_rpm: 60}
motion: {law: ellipse, eccentricity: 0.3}
gears: {teeth: 30, module_mm: 2, face_width_mm: 10}
"""


@pytest.mark.judges("drawings")
def test_strokes_below_supports_and_behind_guides_lean_backwards_at_even_steps() -> None:
    """Below an axis they go down, beside a guide to the left of its way; each length of a crank has six."""
    linkage: Any = Made(crank_mm=100.0, pivots_mm={"crank": (10.0, 20.0)}, guides_mm=[((0.0, 50.0), (200.0, 50.0))])
    slanted: Any = Made(crank_mm=100.0, pivots_mm={}, guides_mm=[((0.0, 0.0), (60.0, 80.0))])
    stroke = support_hatches_mm(slanted)[-1]
    assert stroke[0] == pytest.approx([60.0, 80.0])
    assert stroke[1] - stroke[0] == pytest.approx(0.4 * SUPPORT * 100.0 * np.array([-1.4, -0.2]))
    strokes = support_hatches_mm(linkage)
    below, beside = strokes[:SUPPORT_HATCHES], strokes[SUPPORT_HATCHES:]
    size = SUPPORT * 100.0
    assert len(beside) == 2 * SUPPORT_HATCHES
    assert below[:, 0, 1] == pytest.approx(20.0 - size)
    assert below[-1, 0, 0] == pytest.approx(10.0 - 1.4 * size)
    assert np.diff(below[:, 0, 0]) == pytest.approx(-2.8 * size / SUPPORT_HATCHES)
    assert below[:, 1] - below[:, 0] == pytest.approx(np.tile([0.4 * size, -0.4 * size], (SUPPORT_HATCHES, 1)))
    assert beside[:, 0] == pytest.approx(np.stack([np.arange(1, 13) * 200.0 / 12.0, np.full(12, 50.0)], axis=1))
    assert beside[:, 1] - beside[:, 0] == pytest.approx(np.tile([-0.4 * size, 0.4 * size], (12, 1)))


@pytest.mark.judges("design")
def test_gentler_laws_are_a_share_of_what_is_uneven() -> None:
    """Half of an eccentricity, of waves of ln i12, of the way from a geometric mean: 1, 9 become 3^(1/2), 3^(3/2)."""
    assert Ellipse.gentler(Made(eccentricity=0.4), 0.5, "") == {"eccentricity": pytest.approx(0.2)}
    waves = Made(second_stage=None, cosine=(0.4, 0.2), sine=(0.1, -0.3))
    gentler = HarmonicRatio.gentler(waves, 0.5, "")
    assert (gentler["cosine"], gentler["sine"]) == (pytest.approx((0.2, 0.1)), pytest.approx((0.05, -0.15)))
    assert HarmonicRatio.gentler(Made(second_stage=1), 0.5, "") == {}
    spiral = Spiral.gentler(Made(ratio_start=1.0, ratio_end=9.0), 0.5, "")
    assert spiral == {"ratio_start": pytest.approx(3.0**0.5), "ratio_end": pytest.approx(3.0**1.5)}


@pytest.mark.judges("figures")
def test_a_motion_in_time_is_told_in_newton_metres_with_the_bearing_of_its_crank() -> None:
    slide = Made(displacement=np.array([1.0]), velocity=np.array([2.0]), acceleration=np.array([3.0]))
    one = np.array([1.0])
    force = Made(x=np.array([4.0]), y=np.array([5.0]))
    history = Made(
        time_s=one, phi1_rad=one, phi2_rad=one, slide=slide, law=slide, error_rad=one, pushing_n=one, back_n=one
    )
    history.forces = {CRANK_BEARING: force, "pin": force, f"{MESH_BEFORE} 0": force, f"{BETWEEN_BEARING} 0": force}
    history.before = (Made(pushing_n=8.0 * one, back_n=9.0 * one),)
    history.torque_n_mm, history.joints = np.array([6000.0]), Made(guide_n=np.array([7.0]))
    table = dynamic_table(history, CrankSlider(40.0, 90.0, 0.0))
    assert table["driving_torque_n_m"] == pytest.approx([6.0])
    assert (table["crank_bearing_x_n"], table["crank_bearing_y_n"], table["pin_x_n"]) == (4.0, 5.0, 4.0)
    assert table["guide_n"] == 7.0
    assert (table["first_mesh_x_n"], table["shaft_between_bearing_y_n"]) == (4.0, 5.0)
    assert (table["first_pushing_force_n"], table["first_back_force_n"]) == (8.0, 9.0)
    assert _peak_at("most", "n_m", Peak(3.0, 0.1, 0.2), 0.5) == {"most_n_m": 1.5, "most_at_rad": 0.2}
    assert _peak_at("most", "n", Peak(0.0, 0.1, 0.2)) == {"most_n": 0.0, "most_at_rad": None}
    assert _lasting_s(np.array([[1.0, 1.5], [4.0, 6.0]])) == pytest.approx(2.5)


@pytest.mark.judges("figures")
@pytest.mark.parametrize(
    ("drives", "short", "parted", "told"),
    [
        ("one_way", None, (), None),
        ("one_way", "a short contact", (), "a short contact"),
        ("one_way", None, (1,), "at some positions none touch"),
        ("both_ways", "a short contact", (1,), None),
    ],
)
def test_idle_flanks_are_told_of_where_only_pushing_ones_must_hold(
    drives: str, short: str | None, parted: Any, told: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ncgear.figures.advice.teeth_advice._parts", lambda drive, back: parted)
    found = idle_flanks(Made(designed_contact=Made(back=None), short_contacts=(None, short), gears=Made(drives=drives)))
    assert (found and (found.kind, found.meaning.partition(";")[0])) == (told and (Kind.IDLE_FLANKS, told))


@pytest.mark.judges("files")
def test_a_drawing_says_what_its_lines_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ncgear.files.workshop.drawing._scale", lambda _: "1:1")
    drive: Any = Made(title="d", pitch=Made(size=Made(module_mm=2.0)), helix=None)

    def notes(**changes: Any) -> str:
        plan = {"face_width_mm": 10.0, "web": None, "hub": None, "clearance_mm": 0.0, "chamfer_mm": 0.0}
        return "\n".join(gear_notes(drive, Gear.DRIVING, Made(**{**plan, **changes}))[4:])

    assert notes() == ""
    assert notes(chamfer_mm=0.4) == "lower edges bevelled by 0.4 mm"
    assert "0.2 mm taken off" in notes(clearance_mm=0.2)
    assert "a kerf of 0.3 mm" in notes(clearance_mm=-0.15)
    assert "0.15 mm outside" in notes(clearance_mm=-0.15)
    assert "down to 3 mm" in notes(web=Made(thickness_mm=3.0))
    assert "HUB 5 mm" in notes(hub=Made(height_mm=5.0))


@pytest.mark.judges("files")
def test_the_spline_of_a_pitch_curve_is_on_it_between_its_knots() -> None:
    """An ellipse about its focus, p/(1 + e cos(phi)) in polar form, at a thousand places; finer ones are nearer."""
    pytest.importorskip("OCP", reason="the kernel for STEP is not installed")
    from ncgear.files.workshop.step import _missed_mm, pitch_spline

    curve = drive_of_text(ELLIPSE).pitch.driving
    spline = pitch_spline(curve, 1e-3)
    x, y = BSpline(spline.knots, spline.poles_mm, 3)(np.linspace(spline.knots[0], spline.knots[-1], 1000)).T
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    semi_latus = 2.0 / (1.0 / radius.min() + 1.0 / radius.max())
    waves = np.linalg.lstsq(np.stack([np.cos(angle), np.sin(angle)], 1), semi_latus / radius - 1.0, rcond=None)[0]
    assert np.hypot(*waves) == pytest.approx(0.3, abs=1e-4)
    polar = semi_latus / (1.0 + np.stack([np.cos(angle), np.sin(angle)], 1) @ waves)
    assert radius == pytest.approx(polar, abs=2e-3)
    assert spline.poles_mm[0] == pytest.approx(spline.poles_mm[-1], abs=1e-9)
    assert len(pitch_spline(curve, 1e-5).knots) > len(spline.knots)
    assert _missed_mm(curve, np.unique(spline.knots), spline) <= 1e-3


@pytest.mark.judges("figures")
def test_measured_gears_are_told_by_the_teeth_that_jam_and_points_that_stand_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two of many are named at most as many as a line holds; lengths are angles times the pitch radius."""
    jams = [(number, number + 1) for number in range(1, compared.MOST_TEETH + 3)]
    (fault,) = compared._jams(Made(jams=jams, needed_backlash_mm=0.012))
    assert "12 µm at teeth 1/2, 2/3" in fault.what
    assert fault.what.endswith(" and 2 more")
    (fault,) = compared._jams(Made(jams=jams[: compared.MOST_TEETH], needed_backlash_mm=0.012))
    assert "more" not in fault.what
    range_: Any = Made(backlash_rad=Made(low=Made(value=4e-4)), tightest_teeth=(3, 5))
    pair: Any = Made(measured_extremes=range_, exact_extremes=range_, lever_mm=50.0)
    assert compared._play(pair, measured=True) == "20 µm at driving tooth 3, driven tooth 5"
    assert compared._play(pair, measured=False) == "20 µm"
    points = [Made(tooth=tooth, off_mm=-0.03) for tooth in (4, 4, 7)]
    monkeypatch.setattr(compared, "alone_points", lambda one: points[: one.count])
    told = [compared._alone(Made(gear=Gear.DRIVING, count=count)) for count in (0, 1, 2, 3)]
    assert told[0] == []
    assert told[1][0].what == "driving gear: 1 point stands alone, by up to 30 µm at tooth 4; not counted"
    assert told[2][0].what == "driving gear: 2 points stand alone, by up to 30 µm at tooth 4; not counted"
    assert told[3][0].what == "driving gear: 3 points stand alone, by up to 30 µm at teeth 4, 7; not counted"
    many = list(range(1, compared.MOST_TEETH + 2))
    assert (compared._first(many)[-5:], compared._first(many[:-1])[-1]) == (f"{many[-2]} ...", str(many[-2]))


@pytest.mark.judges("files")
def test_members_of_settings_are_put_in_changed_or_left() -> None:
    text = '{\n  "a": {"b": 1}, // kept\n  "c": [2]\n}\n'
    assert with_member(text, ("a", "b"), 1) == text
    assert with_member(text, ("a", "b"), 5) == text.replace('"b": 1', '"b": 5')
    added = with_member(text, ("a", "d", "e"), [7])
    assert "// kept" in added
    assert json.loads(added.replace(" // kept", "")) == {"a": {"b": 1, "d": {"e": [7]}}, "c": [2]}
    close = '{"a":{"b":1},"c":[2,[3]],"d":{}}'
    assert with_member(close, ("c",), 5) == '{"a":{"b":1},"c":5,"d":{}}'
    assert json.loads(with_member(close, ("d", "e"), 1)) == {"a": {"b": 1}, "c": [2, [3]], "d": {"e": 1}}
    assert json.loads(with_member("", ("x",), 1)) == {"x": 1}


@pytest.mark.judges("design")
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, ""),
        ({"axis_to_mm": [0.0, 5.0]}, "0 given, but axis_from_mm has 0 there; more is right"),
        ({"tool": [{"point": 7, "angle_deg": 1.0}]}, "7 given; 1 to 6 are right"),
        ({"tool": [{"point": 6, "angle_deg": 1.0}]}, ""),
        ({"straight": [1, 7]}, "7 given; 1 to 6 are right"),
        ({"straight": [6]}, ""),
    ],
)
def test_points_of_a_tip_path_are_there(changes: dict[str, Any], said: str) -> None:
    """Six points, and a rectangle for the axis whose second corner is beyond the first."""
    points = [[100.0, 0.0], [60.0, 80.0], [0.0, 100.0], [-90.0, 30.0], [-60.0, -80.0], [30.0, -90.0]]
    given = {"points_mm": points, "axis_from_mm": [0.0, -5.0], "axis_to_mm": [9.0, 5.0]} | changes
    made = TipPathKeys.model_construct(**dict.fromkeys(TipPathKeys.model_fields) | given)
    made.__dict__["tool"] = [Made(**one) for one in given["tool"]] if "tool" in given else None
    faults = [str(one) for one in (*made._corners_are_apart(), *made._points_are_there())]
    assert faults == ([said] if said else [])


@pytest.mark.judges("figures")
def test_one_pair_is_compared_by_its_pitch_curves_too() -> None:
    """Equal ellipses, whose perimeter 4 a E(e^2) holds 30 teeth of 2 mm; p is the least radius."""
    figures = design_figures(drive_of_text(ELLIPSE))
    semi = 60.0 * pi / (4.0 * float(ellipe(0.3**2)))
    assert figures["center_distance_mm"] == pytest.approx(2.0 * semi)
    assert figures["length_driven_mm"] == pytest.approx(60.0 * pi)
    assert figures["min_radius_driving_mm"] == pytest.approx(semi * (1.0 - 0.3**2))
    assert figures["max_tangent_angle_deg"] == pytest.approx(degrees(asin(0.3)))
    assert (figures["ratio_min"], figures["ratio_max"]) == pytest.approx((0.7 / 1.3, 1.3 / 0.7))
    assert not [key for key in figures if "power" in key]


@pytest.mark.judges("studio")
def test_answers_of_the_studio_are_lines_of_json() -> None:
    line = _line("done", 3, "gears", {"a": [1.5]})
    assert line.endswith(b"\n")
    assert line.count(b"\n") == 1
    assert json.loads(line) == {"is": "done", "n": 3, "from": "gears", "content": {"a": [1.5]}}
