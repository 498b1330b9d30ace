"""Speed against error: rates are the theory's, what ncgear uses is exact, and the page says what is measured."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from commands import ROOT
from ncgear.errors import WrongInput
from speed_against_error import study as frame
from speed_against_error.driven_angle import driven_angle_error_rad, panels, read, return_of_baler
from speed_against_error.inversion import angles, by_half_angle, by_law_of_cosines, inversion_error
from speed_against_error.page import level_text, page
from speed_against_error.pitch_curves import (
    Curve,
    baler_curve,
    curvature_by_derivatives,
    curvature_error,
    ellipse_curve,
    length_by_panels,
    length_error,
)
from speed_against_error.return_period import (
    basis_error,
    by_end_conditions,
    by_linear_system,
    closed_by_ncgear,
    closure_error_rad,
    global_powers,
)
from speed_against_error.run import STUDIES, run
from speed_against_error.study import Measured, Method, Point, Size, Study, knee, measured, order, rates

PAGE = ROOT / "docs" / "speed-against-error.md"

every_study = at_once("key", STUDIES)


@cache
def of(key: str) -> Measured:
    """Each level once: errors do not depend on how often."""
    return measured(STUDIES[key](), timed_s=0.0)


# --- studies ---------------------------------------------------------------------------------------------------------

BOUNDS = {
    "inversion": 5e-15,
    "closure": 1e-14,
    "return-basis": 1e-14,
    "driven-angle-ellipse": 1e-12,
    "driven-angle-return": 5e-15,
    "pitch-length-ellipse": 1e-15,
    "pitch-length-baler": 1e-15,
    "curvature-ellipse": 2e-15,
    "curvature-baler": 5e-15,
}
"""Error of what ncgear does: some rounding errors; of phi2 on the ellipse, whose slopes go up to 99, as many more."""

RATED = [key for key in BOUNDS if key != "return-basis"]
"""Studies with a method whose rate theory tells."""

RATE_BAND = 0.3
"""The error's constant changes with where the samples fall between the points looked at."""


@every_study
def test_a_study_is_known_by_its_own_key(key: str) -> None:
    assert STUDIES[key]().key == key


@pytest.mark.tiers(thorough=["inversion", "return-basis"], long=["driven-angle-return", "curvature-baler"], rest="slow")
@pytest.mark.parametrize("key", BOUNDS)
def test_what_ncgear_does_is_exact(key: str) -> None:
    assert of(key).chosen[1].error <= BOUNDS[key]


@pytest.mark.tiers(slow=["pitch-length-ellipse"], rest="long")
@pytest.mark.parametrize("key", RATED)
def test_rates_are_the_theorys(key: str) -> None:
    found = rates(of(key))
    assert found
    for rate in found:
        assert abs(rate.fitted - rate.theory) <= RATE_BAND, rate


def test_the_law_of_cosines_is_lost_at_the_dead_centres() -> None:
    """Half the digits go at both: the reference tells what is wrong by more than rounding."""
    assert inversion_error(by_half_angle(angles())) <= 5e-15
    assert inversion_error(by_law_of_cosines(angles())) >= 1e-3


@pytest.mark.parametrize("row", [0, 1])
def test_a_planted_error_of_an_inversion_is_told(row: int) -> None:
    planted = by_half_angle(angles())
    planted[row, 200] *= 1.0 + 1e-10
    assert inversion_error(planted) >= 5e-11


@pytest.mark.slow
def test_a_planted_error_of_phi2_is_told() -> None:
    stretch = return_of_baler()
    planted = read(stretch, lambda at: panels(stretch, 24)(at + 1e-10))
    assert driven_angle_error_rad(stretch, planted) >= 5e-11


@pytest.mark.slow
def test_a_planted_error_of_closure_is_told() -> None:
    law = closed_by_ncgear()
    assert closure_error_rad(replace(law, local=law.local * (1.0 + 1e-10))) >= 5e-11


def test_a_return_in_powers_of_phi1_loses_half_its_digits() -> None:
    assert basis_error(by_end_conditions()) <= 1e-14
    assert basis_error(by_linear_system(global_powers)) >= 1e-9


@pytest.mark.tiers(slow=["ellipse of eccentricity 0.5"], rest="long")
@pytest.mark.parametrize("curve", [ellipse_curve(), baler_curve()], ids=lambda curve: curve.name)
def test_planted_errors_of_pitch_curves_are_told(curve: Curve) -> None:
    length, bent = length_by_panels(curve, 24), curvature_by_derivatives(curve)
    bent[3] += 1e-10 * np.max(np.abs(bent))
    assert length_error(curve, length * (1.0 + 1e-10)) == pytest.approx(1e-10, rel=1e-4)
    assert curvature_error(curve, bent) == pytest.approx(1e-10, rel=1e-3)


@pytest.mark.slow
def test_the_exact_length_is_the_published_one() -> None:
    assert 200.0 * float(baler_curve().exact_length()) == pytest.approx(629.2813, abs=5e-5)


@pytest.mark.slow
def test_trapezoids_are_spectral_on_a_smooth_closed_curve() -> None:
    """Halving the gaps squares the error; with the baler's joints it only quarters it."""
    ellipse, jointed = of("pitch-length-ellipse"), of("pitch-length-baler")
    rows = [dict(zip((m.name for m in one.study.methods), one.points, strict=True)) for one in (ellipse, jointed)]
    smooth, kinked = ([point.error for point in row["trapezoids"]] for row in rows)
    assert smooth[1] <= 1e-15
    assert kinked[1] >= 1e-5


# --- measuring -------------------------------------------------------------------------------------------------------


def by_hand(*rows: tuple[Point, ...], enough: float = 0.0) -> Measured:
    """A study of made-up points; the first point of the first method is what is chosen."""
    methods = tuple(Method(f"m{i}", "steps", tuple(p.level for p in row), float) for i, row in enumerate(rows))
    chosen = "m0", rows[0][0].level
    return Measured(Study("made", "Made up", "mm", "none", methods, float, chosen, enough, "it is first"), rows)


def test_a_rate_is_the_slope_of_the_logarithms() -> None:
    points = [Point(n, 1.0, 7.0 / n**3) for n in (2, 4, 8, 16)]
    assert order(points, 0.0) == pytest.approx(3.0, abs=1e-12)


def test_rounding_does_not_count_for_a_rate() -> None:
    """Neither what lies under the floor nor what grows again behind the least error."""
    points = [Point(n, 1.0, e) for n, e in ((1, 1.0), (2, 0.25), (4, 0.0625), (8, 1e-15), (16, 0.5))]
    assert order(points, 1e-12) == pytest.approx(2.0, abs=1e-12)


def test_errors_that_are_no_rounding_all_count_for_a_rate() -> None:
    points = tuple(Point(n, 1.0, 1e-3 / n**2) for n in (1, 2, 4))
    made = by_hand(points)
    method = replace(made.study.methods[0], order=2.0)
    (rate,) = rates(replace(made, study=replace(made.study, methods=(method,))))
    assert rate.fitted == pytest.approx(2.0, abs=1e-12)


def test_one_point_tells_no_rate() -> None:
    with pytest.raises(ValueError, match="no rate can be told"):
        order([Point(1, 1.0, 1.0), Point(2, 1.0, 1e-16)], 1e-12)


def test_an_error_that_is_no_number_is_refused() -> None:
    study = Study("s", "S", "mm", "-", (Method("m", "", (0,), lambda _: np.nan),), float, ("m", 0), 0.0, "-")
    with pytest.raises(ArithmeticError, match="s: the error of 'm' at level 0 is nan"):
        measured(study, timed_s=0.0)


@pytest.mark.parametrize(("takes_s", "runs"), [(1e-9, frame.MOST_RUNS), (0.01, 5), (0.04, 3), (0.3, 2), (0.6, 1)])
def test_slow_levels_are_run_again_unless_they_are_very_slow(
    takes_s: float, runs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock, count = [0.0], [0]

    def run(_: float) -> float:
        clock[0], count[0] = clock[0] + takes_s, count[0] + 1
        return 1.0

    monkeypatch.setattr(frame, "perf_counter", lambda: clock[0])
    study = Study("s", "S", "mm", "-", (Method("m", "", (0,), run),), float, ("m", 0), 0.0, "-")
    measured(study, timed_s=0.0499)
    assert count[0] == runs


def test_the_knee_is_the_quickest_that_is_exact_enough() -> None:
    exact, rough, slow = Point(1, 1.0, 2e-15), Point(1, 0.1, 1e-3), Point(1, 9.0, 1e-15)
    told = knee(by_hand((exact,), (rough,), (slow,)))
    assert told.is_chosen
    assert told.error == pytest.approx(1e-14)
    assert told.cheaper is not None
    assert told.dearer is not None
    assert (told.cheaper[1], told.dearer[1]) == (rough, slow)


def test_what_is_enough_need_not_be_beaten() -> None:
    """Where a point reaches it, it is the bound; where none does, ten times the least error is."""
    points = (Point(1, 1.0, 1e-3),), (Point(1, 0.1, 5e-3),)
    assert knee(by_hand(*points, enough=2e-3)).error == 2e-3
    assert knee(by_hand(*points, enough=1e-4)).error == pytest.approx(1e-2)


@pytest.mark.parametrize(("word", "said"), [("points", "8 points"), ("degree", "degree 8"), ("", "-")])
def test_levels_are_counted_or_named(word: str, said: str) -> None:
    assert level_text(Method("m", word, (8,), float), Point(8, 1.0, 1.0)) == said


def test_a_fixed_rule_is_told_its_points_by_the_exact_result() -> None:
    """An adaptive choice may be the knee of its kind; the page says both."""
    found = by_hand((Point(1, 2.0, 1e-15),), (Point(1, 1.0, 1e-15),))
    assert "That is not the knee" in page([found])
    methods = tuple(replace(one, adaptive=one.name == "m0") for one in found.study.methods)
    adaptive = replace(found, study=replace(found.study, methods=methods))
    assert not knee(adaptive).is_chosen
    assert knee(adaptive, unaided=True).is_chosen
    assert "That is the knee among methods that find by themselves" in page([adaptive])
    assert "2 times as fast" in page([adaptive])


def test_a_choice_that_is_slow_or_wrong_is_no_knee() -> None:
    good = Point(1, 1.0, 1e-15)
    assert not knee(by_hand((Point(1, 2.0, 1e-15),), (good,))).is_chosen
    assert not knee(by_hand((Point(1, 0.5, 1e-13),), (good,))).is_chosen
    assert knee(by_hand((Point(1, 0.5, 1e-13),), (good,), enough=1e-12)).is_chosen


@pytest.mark.parametrize(
    ("chosen", "said"),
    [
        (Point(1, 1.0, 1e-15), "That is the knee"),
        (Point(1, 8.0, 1e-15), "That is not the knee: m1, 1 steps (2 s) has an error of at most 1.0e-14 too, 4 times"),
        (Point(1, 1.0, 1e-3), "That is not the knee: its error is larger than 1.0e-14"),
    ],
)
def test_the_page_says_whether_the_choice_is_the_knee(chosen: Point, said: str) -> None:
    assert said in page([by_hand((chosen,), (Point(1, 2.0, 1e-15),))])


# --- run and page ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_writes_page_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(["--out", str(tmp_path), "--only", "return-basis", "--only", "inversion"], timed_s=0.0)
    keys = ["inversion", "return-basis"]
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == keys
    text = (tmp_path / "speed-against-error.md").read_text(encoding="utf-8")
    for key in keys:
        assert (tmp_path / "speed-against-error" / f"{key}.png").read_bytes().startswith(b"\x89PNG")
        assert f"(speed-against-error/{key}.png)" in text
    assert titles(text) == [STUDIES[key]().title for key in keys]


def test_sizes_have_a_column_of_their_own() -> None:
    made = by_hand((Point(1, 1.0, 1e-15, size=37396.0),))
    text = page([replace(made, study=replace(made.study, size=Size("triangles", float)))])
    assert "| method | level | triangles | time | error |" in text
    assert "| **m0** | **1 steps** | **37396** | **1 s** | **1.0e-15** |" in text
    assert "triangles" not in page([made])


def test_an_unknown_study_is_refused_with_the_known_ones(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run(["--out", str(tmp_path), "--only", "inversion", "--only", "inversoin"])
    err = capsys.readouterr().err
    assert all(key in err for key in STUDIES)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "docs").write_text("a file")
    with pytest.raises(WrongInput, match="is no folder"):
        run(["--out", str(tmp_path / "docs")])
    assert capsys.readouterr().out == ""


def titles(text: str) -> list[str]:
    return re.findall(r"^## (.*)$", text, flags=re.MULTILINE)


def sections(text: str) -> dict[str, str]:
    return dict(zip(titles(text), re.split(r"^## .*$", text, flags=re.MULTILINE)[1:], strict=True))


def rows(section: str) -> list[tuple[str, str]]:
    """Method and level of each row of a table of the page, bold marks included."""
    return re.findall(r"^\| ([^|]+) \| ([^|]+) \|(?: [^|]+ \|)? [^|]+ \| [^|]+ \|$", section, flags=re.MULTILINE)[1:]


def test_the_page_in_docs_has_every_study_and_no_other() -> None:
    made = [make() for make in STUDIES.values()]
    assert titles(PAGE.read_text(encoding="utf-8")) == [study.title for study in made]
    pictures = {path.name for path in (PAGE.parent / "speed-against-error").iterdir()}
    assert pictures == {f"{key}.png" for key in STUDIES}


@every_study
def test_the_page_in_docs_has_the_methods_levels_and_choices_of_today(key: str) -> None:
    """So the page cannot go stale unseen: every row, and in bold what is chosen."""
    study = STUDIES[key]()
    wanted = []
    for method in study.methods:
        for level in method.levels:
            cells = method.name, level_text(method, Point(level, 1.0, 1.0))
            wanted.append(tuple(f"**{cell}**" for cell in cells) if (method.name, level) == study.chosen else cells)
    section = sections(PAGE.read_text(encoding="utf-8"))[study.title]
    assert [row for row in rows(section) if row[0] != "---"] == wanted
    assert study.because in section
    assert study.reference in section


@pytest.mark.tiers(long=["driven-angle-return"], rest="slow")
@pytest.mark.parametrize("key", BOUNDS)
def test_the_errors_in_the_page_are_todays(key: str) -> None:
    """What ncgear works at: rounding errors differ between machines, their size does not."""
    section = sections(PAGE.read_text(encoding="utf-8"))[of(key).study.title]
    told = re.search(r"^\| \*\*.* \| \*\*(\S+)\*\* \|$", section, flags=re.MULTILINE)
    assert told is not None
    assert float(told[1]) <= BOUNDS[key]
