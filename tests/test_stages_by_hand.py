"""Stages of bench, searches of outlines and knocks of toleranced pairs, by stand-ins of a few numbers."""

from __future__ import annotations

from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.extrema import Extremum
from ncgear.pitch.shape import Gear
from ncgear.project import bench, outline_fit, outline_trial, tolerance

Made: Any = SimpleNamespace

# --- stages of bench


def asked_of(stage: Any, drive: Any, **patches: Any) -> dict[str, Any]:
    """What a stage gives to the trials: settings, finer settings, what is computed, its judge, the error asked for."""
    got: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:
        for place, value in patches.items():
            patch.setattr(place.replace("__", "."), value)
        patch.setattr(bench, "_tried", lambda *given: got.append(given) or ())
        stage(drive)
    return dict(zip(("settings", "finer", "compute", "judge", "asked"), got[0], strict=True))


@pytest.mark.judges("project")
def test_the_motion_is_judged_by_its_peak_among_rows_and_the_pitch_curve_by_its_chords() -> None:
    """A peak of 8 mm/s2, of which the rows of a fifth of a turn catch 8 cos(pi/5); a circle of 10 mm."""
    machine = Made(motion=lambda phi: Made(acceleration=-8.0 * np.cos(phi - pi)))
    check = Made(peak_acceleration_cycle=Extremum(8.0, 0.0))
    of = asked_of(bench._motion, Made(machine=machine, check=check, transmission=Made(cycle_rad=2.0 * pi)))
    assert (of["finer"](125.0), of["judge"](np.array([-6.0, 4.0]))) == (250.0, (pytest.approx(0.25), 2))
    error, rows = of["judge"](of["compute"](5.0))
    assert (error, rows) == (pytest.approx(0.0, abs=1e-12), 6)

    circle = Made(
        length_mm=20.0 * pi, at_length=lambda at: Made(position=10.0 * np.stack([np.cos(at / 10), np.sin(at / 10)], 1))
    )
    of = asked_of(bench._pitch_curves, Made(pitch=Made(driving=circle), chord_tolerance_mm=0.01))
    error, count = of["judge"](of["compute"](6.0))
    assert (error, count, of["asked"]) == (pytest.approx(20.0 * pi - 60.0), 6, 0.01)
    assert 0.0 < of["judge"]((21.0 * pi, 5))[0] < 1e-13


@pytest.mark.judges("project")
def test_outlines_are_judged_by_their_farthest_exact_point_down_to_the_finest_that_is_made() -> None:
    gears = {Gear.DRIVING: Made(outline_mm=[0] * 30), Gear.DRIVEN: Made(outline_mm=[0] * 50)}
    drive = Made(chord_tolerance_mm=0.02, teeth=Made(of=gears.get), pitch=Made(size=Made(module_mm=2.0)), toothed=None)
    of = asked_of(
        bench._teeth, drive,
        ncgear__metrology__exact_outline__exact_points=lambda gear: gear,
        ncgear__metrology__exact_outline__farthest_mm=lambda exact, outline: 1e-3 * len(outline),
    )  # fmt: skip
    assert of["settings"] == pytest.approx([0.32, 0.16, 0.08, 0.04, 0.02])
    assert of["judge"](drive.teeth) == (pytest.approx(0.05), 80)
    least = bench.LEAST_IN_MODULES * 2.0
    assert (of["finer"](2.1 * least), of["finer"](1.9 * least)) == (pytest.approx(1.05 * least), None)


@pytest.mark.judges("project")
def test_contact_is_judged_by_error_and_least_play_at_the_largest_radius() -> None:
    """At 40 mm: errors of 3e-4 rad of transmission, 5e-4 rad of the least play, whichever is greater."""
    exact = Made(transmission_error_rad=1e-3, backlash_rad=Made(low=Extremum(2e-3, 0.0)))
    pitch = Made(radius_range_mm=lambda gear: (10.0, 40.0) if gear is Gear.DRIVEN else (1.0, 99.0))
    gear = Made(outline_mm=None)
    drive = Made(pitch=pitch, teeth=Made(driving=gear, driven=gear), chord_tolerance_mm=0.01)
    of = asked_of(
        bench._contact, drive,
        ncgear__contact__placement__placed=lambda pitch, per_tooth=20: Made(per_tooth=per_tooth),
        ncgear__contact__written__as_written__Outlines=lambda *_: None,
        ncgear__contact__written__as_written__as_written=lambda *given: given,
        ncgear__contact__written__as_written__reach_mm=lambda *_: 9.0,
        ncgear__contact__written__extremes__play_extremes=lambda *_: exact,
    )  # fmt: skip
    for error, play, missed in ((7e-4, 2.2e-3, 3e-4), (9e-4, 2.5e-3, 5e-4), (1.1e-3, 1.6e-3, 4e-4)):
        found = Made(transmission_error_rad=error, backlash_rad=np.array([9.0, play]), pushing_rad=np.zeros(7))
        assert of["judge"](found) == (pytest.approx(40.0 * missed), 7)
    assert [of["finer"](count) for count in (16.0, 32.0, 33.0)] == [32.0, 64.0, None]


@pytest.mark.judges("project")
def test_elements_are_judged_by_the_largest_stress_of_each_tooth() -> None:
    """Two teeth of 100 and 80 MPa by the reference, 98 and 84 MPa by a coarser mesh: 5 % off."""
    fine, coarse = (Made(tension_mpa=np.array(of)) for of in ([100.0, 30.0, 70.0, 80.0], [98.0, 20.0, 84.0, 11.0]))
    gear = Made(teeth=2)
    of = asked_of(
        bench._elements, Made(teeth=Made(driving=gear), materials=["steel"]),
        ncgear__strength__elements__mesh__topology_of=lambda size: Made(cells=[0] * 6),
        ncgear__strength__elements__teeth__elements_of=lambda *_: fine,
    )  # fmt: skip
    assert of["judge"]((coarse, 12)) == (pytest.approx(0.05), 12)
    assert [of["finer"](parts) for parts in (2.0, 3.0, 4.0)] == [3.0, 4.0, None]


@pytest.mark.judges("project")
def test_solids_are_judged_by_section_and_volume_over_the_tooth_faces() -> None:
    """Volumes 6 and 9 mm3 off, over outlines 30 and 20 mm long and 3 mm wide: 0.067 and 0.15 mm; sections 0.1 mm."""

    def square(side: float) -> Any:
        return side / 4.0 * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])

    teeth = {Gear.DRIVING: Made(outline_mm=square(40.0)), Gear.DRIVEN: Made(outline_mm=square(80.0 / 3.0))}
    made = Made(of=teeth.get)

    def pair(*volumes: float) -> Any:
        solids = {gear: Made(mesh=Made(volume=one, faces=[0] * 5)) for gear, one in zip(Gear, volumes, strict=True)}
        return Made(of=solids.get)

    drive = Made(
        chord_tolerance_mm=0.016, gears=Made(face_width_mm=3.0), pitch=Made(size=Made(module_mm=1.0)), teeth=made,
        toothed=lambda tolerance: made, crank_pin=None,
    )  # fmt: skip
    patches = {
        "ncgear__metrology__exact_outline__exact_points": lambda gear: gear,
        "ncgear__project__gear_solids__straight_solids": lambda *_: pair(300.0, 200.0),
    }
    for away, error in ((0.1, 0.15), (0.2, 0.2)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(bench, "_section_error_mm", lambda exact, mesh, height, away=away: away * height / 1.5)
            of = asked_of(bench._solids, drive, **patches)
            assert of["judge"](pair(294.0, 209.0)) == (pytest.approx(error), 10)


# --- searches of outlines


def search(away_mm: Any, refused: set[int], written: set[int]) -> tuple[int, list[Any]]:
    """The trial that a search for an outline ends with, and the limits of all, by distances of its trials.

    Some trials are refused by their teeth, and some by their written outlines.
    """
    limits: list[Any] = []
    count = iter(range(100))

    def made_pair(design: Any, curve: Any, own: Any) -> Any:
        limits.append(own)
        number = next(count)
        refusal = NoSuchMechanism("they clash", key="gears") if number in refused else None
        return Made(number=number, refusal=refusal, curve=number, drive=None)

    def judged(made: Any, require: Any) -> Any:
        return (
            Made(**{**vars(made), "refusal": NoSuchMechanism("short", key="gears")}) if made.number in written else made
        )

    finder: Any = Made(outline=None, design=None, wanted=None, axis_mm=None, limits="first")
    finder._away_mm = lambda made: away_mm[made.number]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outline_fit, "nearest_curve", lambda *_: None)
        for name, function in {
            "made_pair": made_pair,
            "judged": judged,
            "drawn_in": lambda made, times: ("in", made.number, times),
            "between": lambda good, bad: ("between", good.number, None if bad is None else bad.number),
            "most_lacking": lambda made: "",
        }.items():
            patch.setattr(outline_trial, name, function)
        found = outline_fit._Search.best(finder, 30, None, lambda trial, of: None)
    return found.number, limits


@pytest.mark.judges("project")
def test_a_search_for_an_outline_goes_between_made_and_refused_pairs_until_nothing_is_worth_it() -> None:
    worth, nearer = outline_fit.WORTH, outline_fit.NEARER
    # Refused at first, made at the third trial; the fourth is nearer, and as near as the refused pair but for a little.
    away = [1.0, 1.0, 3.0, 1.0 + 0.9 * worth]
    number, limits = search(away, {0, 1}, set())
    assert (number, limits) == (3, ["first", ("in", 0, 0), ("in", 1, 1), ("between", 2, 1)])
    # A nearer pair is never found: so many more trials as are left.
    number, limits = search([1.0, 2.0, *[3.0] * 50], {0}, set())
    assert (number, len(limits)) == (1, 2 + nearer)
    assert limits[2:] == [("between", 1, 0)] * nearer


@pytest.mark.judges("project")
def test_a_search_for_an_outline_ends_where_all_pairs_are_refused() -> None:
    with pytest.raises(NoSuchMechanism, match="can be made with 30 teeth; more teeth"):
        search([1.0] * 60, set(range(60)), set())
    # A pair that is refused as written: its limits are drawn in as if it had been refused before, then by trials.
    number, limits = search([1.0, 2.0, 1.0, 1.0], {0}, {1})
    assert number > 1
    assert limits[-1][0] in ("in", "between")


@pytest.mark.judges("project")
@at_once(
    ("given", "play", "knocking"),
    [(0.0, 0.01, 0.1), (0.0, 0.2, 0.4), (0.15, 0.2, 0.15)],
)
def test_teeth_knock_beyond_twice_the_play_or_a_twentieth_of_a_module(
    given: float, play: float, knocking: float
) -> None:
    asked: dict[str, Any] = {}
    pair = Made(limits="limits", mesh=None)
    drive = Made(pitch=Made(size=Made(module_mm=2.0)), gears=Made(drives="both_ways"), stage=None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tolerance, "face_of", lambda drive, tolerances: tolerances)
        patch.setattr(tolerance, "placed", lambda *_: None)
        patch.setattr(tolerance, "finer_by", lambda pair: 3)
        patch.setattr(tolerance, "_mesh", lambda drive, limits, per_tooth: per_tooth)
        patch.setattr(tolerance, "exact_of", lambda pitch, face, *_, both_ways: (face, both_ways))
        patch.setattr(tolerance, "pair_study", lambda *_, **named: asked.update(named))
        found: Any = Made(pairs=[Made(largest_play_mm=np.array([play]))])
        tolerance._pair(drive, 0, Made(largest_play_mm=given), Made(pairs=[pair]), found, found, [])
    assert asked["knocking_mm"] == pytest.approx(knocking)
    assert asked["finer"] == 3 * tolerance.PER_TOOTH
    assert asked["exact"] == (pytest.approx((2e-3, 2e-4)), True)
