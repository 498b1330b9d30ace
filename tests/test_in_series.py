"""Pairs in series, each with a law of its own (``in_series``), judged by ellipses: two in phase are one of another
eccentricity, and each pair is the pair that a file with its law alone has."""

from __future__ import annotations

from functools import cache
from operator import itemgetter
from pathlib import Path

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.design.reading.design_file import load
from ncgear.errors import DesignError, WrongInput
from ncgear.figures.answers.machine import _gears_of_all, _ratios
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive
from ncgear.project.strengthening import rating_of
from ncgear.strength.holding import Damage

MACHINE = """\
name: series
linkage: {{crank_mm: 60, rod_mm: 200}}
operation: {{speed_rpm: 60}}
motion: {motion}
gears: {{teeth: 40, module_mm: 2, face_width_mm: 20, backlash_mm: 0.05{more}}}
resistance: {{polynomial_n: [300]}}
"""

FIRST, SECOND = "{law: ellipse, eccentricity: 0.2}", "{law: ellipse, eccentricity: 0.15}"


def text(motion: str, more: str = "") -> str:
    return MACHINE.format(motion=motion, more=more)


def series(*pairs: str) -> str:
    return f"{{law: in_series, pairs: [{', '.join(pairs)}]}}"


@cache
def made(motion: str) -> Drive:
    return drive_of_text(text(motion))


def machine_figures(drive: Drive) -> list[float]:
    check = drive.check
    peaks = check.peak_power_w, check.peak_acceleration_cycle, *drive.transmission.ratio_range
    return [peak.value for peak in peaks]


def test_two_ellipses_in_phase_are_one_ellipse_to_the_machine() -> None:
    """tan(phi2/2) = (1+e)/(1-e) tan(phi1/2) of each: the factors of both multiply, as speeds in relativity add."""
    both = (0.2 + 0.15) / (1.0 + 0.2 * 0.15)
    one, two = made(f"{{law: ellipse, eccentricity: {both!r}}}"), made(series(FIRST, SECOND))
    assert machine_figures(two) == pytest.approx(machine_figures(one), rel=1e-9)
    angles = np.linspace(0.0, 2.0 * np.pi, 97)
    driven = two.transmission.driven_angle(angles).value
    assert driven == pytest.approx(one.transmission.driven_angle(angles).value, abs=1e-11)
    other = made(series(FIRST, SECOND.replace("}", ", phase_deg: 20}")))
    assert np.abs(other.transmission.driven_angle(angles).value - driven).max() > 0.05


def test_each_pair_is_that_of_a_file_with_its_law_alone() -> None:
    pairs = FIRST, SECOND, "{law: ratio_expression, ratio: 1 + 0.1*sin(2*phi), scale_to_close: true}"
    drive = made(series(*pairs))
    assert drive.design.stages == 3
    for law, stage in zip(pairs, drive.by_stage, strict=True):
        alone = made(law)
        assert stage.pitch.center_distance_mm == pytest.approx(alone.pitch.center_distance_mm, rel=1e-12)
        assert stage.largest_pressure_angle_deg == pytest.approx(alone.largest_pressure_angle_deg, rel=1e-9)
        assert stage.teeth.driving.outline_mm == pytest.approx(alone.teeth.driving.outline_mm, abs=1e-6)


@pytest.mark.parametrize(
    ("pair", "key", "said"),
    [
        ("{law: ellipse, eccentricity: 1.2}", "motion.pairs.1.eccentricity", "a number under 1"),
        ("{law: ellipse, eccentricty: 0.2}", "motion.pairs.1.eccentricty", "did you mean eccentricity"),
        ("{law: three_segment_strok}", "motion.pairs.1.law", "did you mean three_segment_stroke"),
        (series(FIRST, SECOND), "motion.pairs.1.law", "uniform_crank, spiral or function_generator is right"),
        ("{law: harmonic_ratio, second_stage: {}}", "motion.pairs.1.law", "give each as an item of pairs"),
        (
            "{law: spiral, range_deg: 200, ratio_start: 1, ratio_end: 2}",
            "motion.pairs.1.law",
            "leave the range out",
        ),
        (
            "{law: pitch_curve, ellipse: {semi_major_mm: 40, semi_minor_mm: 36}}",
            "motion.pairs.1.law",
            "solve_for: scale is right",
        ),
        (
            "{law: pitch_curve, solve_for: scale, points: {file: none.csv, tolerance_mm: 0.1}}",
            "motion.pairs.1.points.file",
            "cannot be read",
        ),
    ],
)
def test_a_wrong_pair_is_told_by_its_own_key(tmp_path: Path, pair: str, key: str, said: str) -> None:
    path = tmp_path / "d.yaml"
    path.write_text(text(series(FIRST, pair)))
    with pytest.raises(WrongInput, match=said) as refused:
        load(path)
    assert refused.value.key == key
    assert refused.value.location.startswith(f"{path}:4:")


def test_a_law_that_is_not_made_names_its_pair() -> None:
    with pytest.raises(DesignError) as refused:
        _ = made(series(FIRST, "{law: ratio_expression, ratio: 1 + cos(phi)}")).law
    assert refused.value.key == "motion.pairs.1.ratio"


@pytest.mark.parametrize(
    ("more", "key"),
    [(", pairs: 2", "gears.pairs"), (", lobes: {driving: 1, driven: 2}", "gears.lobes")],
)
def test_what_shares_a_ratio_a_second_time_is_refused(tmp_path: Path, more: str, key: str) -> None:
    path = tmp_path / "d.yaml"
    path.write_text(text(series(FIRST, SECOND), more))
    with pytest.raises(WrongInput) as refused:
        load(path)
    assert refused.value.key == key


def test_a_pair_may_have_its_points_in_a_file(tmp_path: Path) -> None:
    """The points of an ellipse about its focus make the machine of the ellipse."""
    turned = np.linspace(0.0, 2.0 * np.pi, 121)[:-1]
    rows = np.column_stack([turned, 40.0 * (1.0 - 0.15**2) / (1.0 + 0.15 * np.cos(turned))])
    np.savetxt(tmp_path / "p.csv", rows, delimiter=",", header="phi_rad,radius_mm", comments="")
    path = tmp_path / "d.yaml"
    drawn = "{law: pitch_curve, solve_for: scale, points: {file: p.csv, tolerance_mm: 0.0001}}"
    path.write_text(text(series(FIRST, drawn)))
    drive = Drive(load(path).design)
    assert machine_figures(drive) == pytest.approx(machine_figures(made(series(FIRST, SECOND))), rel=1e-4)


@pytest.mark.slow
def test_three_pairs_are_told_on_one_screen() -> None:
    """The ratios and angles of all in a row each, what is alike once, and the least safety with its pair."""
    drive = made(series(FIRST, SECOND, "{law: uniform_crank}"))
    ratios = {row.name: row.texts[0] for row in _ratios(drive)}
    assert ratios["ratio of each pair"] == "0.667 to 1.5; 0.739 to 1.35; 1 to 1"
    assert ratios["greatest pressure angle"] == "31.5, 28.6, 20 deg, pair by pair"
    told = {row.name: row.texts[0] for row in _gears_of_all(drive)}
    assert told["teeth"].startswith("40 : 40, module 2 mm")
    assert [name for name in told if name.endswith("centre distance")] == [
        f"stage {number}: centre distance" for number in (1, 2, 3)
    ]
    weakest = [
        (each.safety / each.wanted, number, each)
        for number, stage in enumerate(drive.by_stage, 1)
        for each in rating_of(stage).weakest
    ]
    for damage in Damage:
        _, number, least = min((one for one in weakest if one[2].damage is damage), key=itemgetter(0))
        assert f"against {damage.words} in stage {number}" in told["safety"]
        assert f"{to_digits(least.safety, 3)} against {damage.words}" in told["safety"]
