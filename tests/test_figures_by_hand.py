"""Figures and words of answers on a few numbers that are done by hand: units, sizes, places, counts."""

from __future__ import annotations

from math import pi, radians
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.figures.strong as strong
from at_once import at_once
from ncgear.balance.mechanism import JointMasses
from ncgear.figures import compared, simulated
from ncgear.figures.advice import given_advice, teeth_advice
from ncgear.figures.answers import machine
from ncgear.figures.assembly import _end_stops, _in_row
from ncgear.figures.balance.shaking import _crank, _massive
from ncgear.figures.bench import time_words
from ncgear.figures.ledger import _places
from ncgear.figures.outline_fit import _deviation, _outline, _strays
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.plane import Vector
from ncgear.pitch.shape import Gear, Mesh
from ncgear.strength.holding import Damage
from ncgear.teeth.tips import Limit

Made: Any = SimpleNamespace


def force(x: list[float], y: list[float]) -> Vector:
    return Vector(Made(value=np.array(x)), Made(value=np.array(y)))


@pytest.mark.judges("figures")
def test_torques_of_a_table_are_in_newton_metres() -> None:
    loads: Any = Made(
        driving_torque=Made(value=np.array([1500.0])),
        driven_torque=Made(value=np.array([-2500.0])),
        joints={"wrist": force([1.0], [2.0])},
        crank_bearing=force([3.0], [4.0]),
        guide=Made(value=np.array([5.0])),
        mesh=None,
        meshes_before=(),
        between_bearings=(),
    )
    columns = simulated._load_columns(Made(CRANK="crank", GUIDED=True), loads)
    assert {name: values.tolist() for name, values in columns.items()} == {
        "driving_torque_n_m": [1.5],
        "driven_torque_n_m": [-2.5],
        "wrist_x_n": [1.0],
        "wrist_y_n": [2.0],
        "crank_bearing_x_n": [3.0],
        "crank_bearing_y_n": [4.0],
        "guide_n": [5.0],
    }


@pytest.mark.judges("figures")
def test_teeth_under_load_have_the_least_contact_of_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulated, "_about", lambda *_: {})
    monkeypatch.setattr(simulated, "_stiffness", lambda _: {})
    peaks = Made(
        transmission_error_rad=3e-6,
        tooth_force_n=Extremum(500.0, 0.1),
        depth_mm=Extremum(0.01, 0.2),
        driving_torque_n_mm=Extremum(7000.0, 0.3),
        most_pairs=3,
    )
    sides = Made(contact_ratio=1.6, least_arc=1.5), Made(contact_ratio=1.4, least_arc=1.2)
    drive: Any = Made(loaded_peaks=peaks, designed_contact=None, pairs_under_load=sides)
    drive.loaded_peaks_with = lambda factor: Made(**{**vars(peaks), "tooth_force_n": Extremum(500.0 * factor, 0.1)})
    drive.by_stage, drive.transmission_error_with = (drive,), lambda factor: 3e-6 / factor
    figures = simulated.quasi_static_figures(drive)
    told = figures["loaded_contact"]
    assert (told["contact_ratio_mean"], told["contact_ratio_min"]) == (1.4, 1.2)
    assert told["peak_driving_torque_n_m"] == pytest.approx(7.0)
    for name, factor in (("softer", simulated.SOFTER), ("stiffer", simulated.STIFFER)):
        band = figures["band_of_stiffness"][name]
        assert (band["stiffness_factor"], band["peak_tooth_force_n"]) == (factor, pytest.approx(500.0 * factor))


@pytest.mark.judges("figures")
def test_a_peak_of_nothing_is_at_no_place_and_spans_add_up() -> None:
    found: Any = Made(value=2000.0, phi1_rad=0.4)
    assert simulated._peak_at("peak", "n_m", found, 0.001) == {"peak_n_m": 2.0, "peak_at_rad": 0.4}
    assert simulated._peak_at("peak", "n", Made(value=0.0, phi1_rad=0.4)) == {"peak_n": 0.0, "peak_at_rad": None}
    assert simulated._lasting_s(np.array([[0.1, 0.4], [1.0, 1.5]])) == pytest.approx(0.8)


@pytest.mark.judges("figures")
def test_crank_masses_count_by_the_cranks_length_in_the_sense_of_its_turning(monkeypatch: pytest.MonkeyPatch) -> None:
    import ncgear.figures.balance.shaking as shaking

    masses = {"one": JointMasses(3.0, 2.0), "no rod": JointMasses(3.0, 0.0), "no pin": JointMasses(0.0, 2.0)}
    monkeypatch.setattr(shaking, "joint_masses", lambda linkage, of: masses[of])

    def mounted(of: str, mirrored: bool) -> Any:
        return Made(mirrored=mirrored, phase_rad=0.7, mechanism=Made(linkage=Made(crank_mm=40.0), masses=of))

    assert [_massive(mounted(of, False)) for of in masses] == [True, False, False]
    for mirrored, sense in ((False, 1), (True, -1)):
        crank = _crank(mounted("one", mirrored))
        assert (crank.masses.rotating_kg, crank.masses.reciprocating_kg) == (120.0, 80.0)
        assert [crank.sense, crank.phase_rad] == [sense, pytest.approx(0.7 * sense)]


@pytest.mark.judges("figures")
@at_once(
    ("places", "text"),
    [
        (["eq. 1", "eq. 2", "fig. 3"], "eq. 1, 2, fig. 3"),
        (["eq. 1", "fig. 3", "eq. 2"], "eq. 1, fig. 3, eq. 2"),
    ],
)
def test_each_kind_of_place_is_named_once(places: list[str], text: str) -> None:
    assert _places(places) == text


@pytest.mark.judges("figures")
def test_an_outline_is_told_in_its_own_size() -> None:
    """A drawing of 200 mm whose curve is 50 mm: loops of 4 mm are 1 mm of it; misses are shares of it."""
    drawing: Any = Made(size_mm=200.0, left_out_mm=4.0, corners=(1, 2))
    assert _outline(drawing, 50.0) == {"size_mm": 50.0, "corners": 2, "left_out_mm": 1.0}
    away: Any = Made(root_mean_square_mm=0.5, greatest_mm=2.0, at_mm=(1.0, 2.0), of_outline=False)
    told = _deviation(away, 50.0, ())
    assert (told["root_mean_square_share"], told["greatest_share"]) == (0.01, 0.04)
    assert told["greatest_of"] == "pitch curve"


@pytest.mark.judges("figures")
def test_a_curve_that_misses_next_to_nothing_is_not_said_to_stray(monkeypatch: pytest.MonkeyPatch) -> None:
    import ncgear.figures.outline_fit as outline_fit

    monkeypatch.setattr(outline_fit, "bound_words", lambda *_: "why")
    rows = []
    for greatest in (0.9e-3, 1.1e-3):
        away: Any = Made(root_mean_square_mm=0.5e-3, greatest_mm=greatest, at_mm=(1.0, 2.0), of_outline=True)
        rows.append(len(list(_strays(Made(), away, 50.0, (), ""))))
    assert rows == [2, 4]


@pytest.mark.judges("figures")
def test_a_row_is_told_by_the_axes_and_side_of_each_pair() -> None:
    row = Made(
        axes_mm=[0.0, 30.0 + 40.0j, 100.0 + 40.0j],
        directions_rad=[0.9, 0.0],
        pairs=[Made(center_distance_mm=50.0)],
    )
    for stage, axes, behind in ((1, ([0.0, 0.0], [30.0, 40.0]), False), (2, ([30.0, 40.0], [100.0, 40.0]), True)):
        told = _in_row(Made(gears=Made(idlers=1), whole=Made(row=row), stage=stage))["row"]
        assert (told["driving_axis_mm"], told["driven_axis_mm"]) == axes
        assert (told["direction_rad"], told["seen_from_behind"]) == (row.directions_rad[stage - 1], behind)


@pytest.mark.judges("figures")
@pytest.mark.parametrize("mesh", list(Mesh))
def test_end_stops_are_told_counter_clockwise(mesh: Mesh) -> None:
    """Gears with outer teeth turn in opposite senses; in a ring the gear turns in the same sense."""
    covered = Made(driving_rad=2.0, driven_rad=1.5)
    bodies = Made(end_stop=None)
    drive: Any = Made(
        pitch=Made(transmission=Made(lobes=Made(range=covered)), mesh=mesh),
        gears=Made(driving=bodies, driven=bodies),
        solids=Made(of=lambda _: Made(plan=Made(pin_mm=None))),
    )
    told = _end_stops(drive)["end_stops"]
    assert told == {"driving_rad": [0.0, 2.0], "driven_rad": [0.0, 1.5 if mesh is Mesh.INTERNAL else -1.5]}


# --- measured gears


@pytest.mark.judges("figures")
def test_least_play_is_told_as_a_length_at_the_tightest_teeth() -> None:
    def extremes(play: float) -> Any:
        return Made(backlash_rad=Made(low=Made(value=play)), tightest_teeth=(3, 7))

    pair: Any = Made(measured_extremes=extremes(0.001), exact_extremes=extremes(0.002), lever_mm=50.0)
    assert compared._play(pair, measured=True).replace("\u00b5", "u").startswith("50")
    assert compared._play(pair, measured=True).endswith("at driving tooth 3, driven tooth 7")
    assert compared._play(pair, measured=False).startswith("100")


@pytest.mark.judges("figures")
@pytest.mark.parametrize("more", [-1, 0, 2])
def test_many_teeth_are_named_by_the_first_of_them(more: int) -> None:
    count = compared.MOST_TEETH + more
    teeth = list(range(1, count + 1))
    assert compared._first(teeth).endswith(" ...") is (more > 0)
    assert compared._first(teeth).removesuffix(" ...").split(", ")[-1] == str(min(count, compared.MOST_TEETH))
    pair: Any = Made(jams=[(number, number) for number in teeth], needed_backlash_mm=0.02)
    (fault,) = compared._jams(pair)
    assert ("more" in fault.what) is (more > 0)
    assert more <= 0 or f"and {more} more" in fault.what


@pytest.mark.judges("figures")
def test_points_that_stand_alone_are_counted_with_their_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [Made(tooth=3, off_mm=-0.05), Made(tooth=5, off_mm=0.03)]
    monkeypatch.setattr(compared, "alone_points", lambda _: points)
    (fault,) = compared._alone(Made(gear=Gear.DRIVING))
    assert "2 points stand alone" in fault.what
    assert "at teeth 3, 5" in fault.what
    points.pop()
    (fault,) = compared._alone(Made(gear=Gear.DRIVING))
    assert "1 point stands alone" in fault.what
    assert "at tooth 3" in fault.what
    assert "50" in fault.what


# --- strength


@pytest.mark.judges("figures")
def test_the_least_safety_of_each_damage_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """By their shares of what is wanted, of the driving and the driven gear."""
    weakest = [
        Made(damage=damage, share=share, safety=safety, wanted=wanted)
        for damage, share, safety, wanted in (
            (Damage.BENDING, 1.5, 2.1, 1.4),
            (Damage.CONTACT, 1.2, 1.2, 1.0),
            (Damage.BENDING, 1.2, 1.68, 1.4),
            (Damage.CONTACT, 1.9, 1.9, 1.0),
        )
    ]
    rating = object.__new__(machine.Rating)
    monkeypatch.setattr(machine.Rating, "weakest", weakest, raising=False)
    monkeypatch.setattr(machine, "known_rating", lambda _: rating)
    assert machine.safeties(Made()) == [("breakage", "1.68", "1.4"), ("pitting", "1.2", "1")]
    rough = Made(
        needs_teeth=False,
        safeties=[Made(safety=1.0, wanted=2.0), Made(safety=0.9, wanted=1.0)],
    )
    monkeypatch.setattr(machine, "known_rating", lambda _: "refused")
    monkeypatch.setattr(machine, "beside_refusal", lambda *_: rough)
    monkeypatch.setattr(machine, "rough_damage", lambda *_: "breakage")
    assert machine.safeties(Made()) == [("breakage", "about 1", "2")]


@pytest.mark.judges("figures")
def test_the_load_that_makes_the_largest_force_is_told_and_the_fastest_knock() -> None:
    slow, fast = Made(speed_mm_s=3.0, phi1_rad=0.1), Made(speed_mm_s=9.0, phi1_rad=pi / 2.0)
    assert strong.knock_figures([slow, fast]) == {
        "knocks": 2,
        "knock_max_mm_s": 9.0,
        "knock_max_at_rad": pi / 2.0,
    }
    words = strong.knock_words([slow, fast])
    assert words.startswith("2 in a turn")
    assert "9" in words
    assert "90" in words
    assert strong.knock_words([]) == ""


@pytest.mark.judges("figures")
def test_thin_walls_are_told_where_they_raise_the_stress_of_a_weak_root() -> None:
    rims = [Made(factor=np.array([1.0, 1.25]), wall_mm=np.array([9.0, 3.0]))] * 2
    weakest = [
        Made(gear=Gear.DRIVING, damage=Damage.BENDING, tooth=1),
        Made(gear=Gear.DRIVEN, damage=Damage.BENDING, tooth=2),
        Made(gear=Gear.DRIVEN, damage=Damage.CONTACT, tooth=2),
    ]
    words = strong.rim_words(Made(rims=rims), Made(weakest=weakest))
    assert words == "thin wall of 3 mm under tooth 2 of the driven gear, stress times 1.25"
    assert strong.rim_words(Made(rims=rims), Made(weakest=weakest[:1])) == ""


@pytest.mark.judges("figures")
def test_a_jam_is_told_in_newton_metres_with_the_least_safety_of_both_gears(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        strong,
        "lives_of",
        lambda _, gear: {
            Damage.BENDING: Made(safety_min=3.0 if gear is Gear.DRIVING else 2.0),
            Damage.CONTACT: Made(safety_min=1.1 if gear is Gear.DRIVING else 1.5),
        },
    )
    drive: Any = Made(
        conditions=Made(overload=Made(driving_n_mm=8000.0, times=20)),
        judged_teeth=lambda _: Made(jammed=Made(peak_pair_n=500.0)),
    )
    rating: Any = Made(strength=Made(method="estimate"))
    told = strong._jam_figures(drive, rating)["jam"]
    assert (told["driving_torque_n_m"], told["times"], told["driven"]["bending_safety_min"]) == (8.0, 20, 2.0)
    words = strong.jam_words(drive, rating)
    assert words.startswith("8")
    assert "safety 2 against breakage, 1.1 against pitting" in words


# --- advice


@pytest.mark.judges("figures")
@pytest.mark.parametrize(("limit", "tip", "lowered"), [(Limit.LAND, 2.9, True), (Limit.LAND, 3.0, False)])
def test_tips_are_lowered_where_a_limit_is_below_the_full_height(limit: Any, tip: float, lowered: bool) -> None:
    flanks = Made(tip_height_mm=np.array([tip, 2.9]), full_tip_mm=np.array([3.0, 3.0]))
    tips = Made(limit=np.array([limit, Limit.FULL], dtype=object))
    found = teeth_advice._lowered(Made(flanks=flanks, tips=tips), Limit.LAND)
    assert found.tolist() == [lowered, False]


@pytest.mark.judges("figures")
@pytest.mark.parametrize(("partings", "said"), [(0, "never part"), (1, "part once"), (3, "part 3 times")])
def test_partings_in_time_are_counted(partings: int, said: str) -> None:
    found = teeth_advice.parted_in_time(partings, 0.02, 1.5)
    assert said in found.what
    assert bool(found.meaning) is (partings > 0)


@pytest.mark.judges("figures")
@pytest.mark.parametrize(("hand", "towards"), [("right", "growing"), ("left", "falling")])
def test_a_thrust_pushes_both_gears_to_opposite_sides(hand: str, towards: str) -> None:
    bare = Made(drivetrain=None)
    found = teeth_advice.thrust(Made(helix=Made(thrust_share=0.25, hand=hand), design=bare))
    assert found is not None
    assert f"driving gear towards {towards} z" in found.meaning
    assert teeth_advice.thrust(Made(helix=Made(thrust_share=0.0, hand=hand), design=bare)) is None


@pytest.mark.judges("figures")
def test_gears_of_a_row_that_touch_meet() -> None:
    rooms = [
        Made(first="driving", second="idler_2", least_distance_mm=least, at_rad=radians(90.0))
        for least in (0.1, 0.0, -2.0)
    ]
    found = teeth_advice.room(Made(whole=Made(row_room=rooms)))
    assert [one.what for one in found] == ["driving and idler 2 meet at phi1 = 90 deg"] * 2


@pytest.mark.judges("figures")
@at_once(
    ("places", "forces", "idle"),
    [
        ((0.0, 50.0, 100.0), (1.0, 2.0, 3.0), 0),
        ((-20.0, -10.0, 0.0, 100.0), (9.0, 4.0, 2.0, 3.0), 1),
        ((0.0, 100.0, 120.0, 150.0), (1.0, 2.0, 5.0, 6.0), 1),
        ((-30.0, -20.0, 120.0), (1.0, 2.0, 3.0), 0),
        ((-10.0, 120.0), (1.0, 3.0), 0),
        ((110.0, 120.0), (1.0, 3.0), 1),
    ],
)
def test_points_of_a_table_beyond_the_stroke_are_idle_where_none_within_hangs_on_them(
    places: tuple[float, ...], forces: tuple[float, ...], idle: int
) -> None:
    """A stroke of 100 mm: a smooth curve between two points hangs on one more point on each side of them."""
    assert given_advice._idle_points(places, forces, 100.0) == idle


@pytest.mark.judges("figures")
def test_times_are_told_in_seconds_or_thousandths() -> None:
    assert [time_words(time_s) for time_s in (12.34, 1.0, 0.999, 0.0123)] == ["12.3 s", "1 s", "999 ms", "12 ms"]
