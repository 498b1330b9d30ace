"""What is told of tolerated assemblies and of measured gears: counted and converted here from made-up values."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drives import drive
from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.figures.compared import COLUMNS, alone_points, compared_csv, gear_figures, points_csv
from ncgear.figures.toleranced import (
    _first,
    _power_of_two,
    assemblies_csv,
    jam_words,
    judged_assemblies,
    knock_words,
    needed_words,
    tolerance_answer,
    tolerance_json,
)
from ncgear.metrology.best_fit import BestFit, Pose, on_flanks
from ncgear.metrology.deviations import deviations
from ncgear.metrology.exact_outline import exact_outline
from ncgear.numerics.plane import as_complex
from ncgear.pitch.shape import Gear
from ncgear.tolerances.assemblies import Assemblies, PairAssemblies
from ncgear.tolerances.drawn import DeviationSource
from ncgear.tolerances.study import Index, Share

pytestmark = pytest.mark.judges("figures")

Made: Any = SimpleNamespace

COUNT = 200
"""Assemblies whose figures rise evenly: the n-th percentile lies n hundredths of the way."""


def rising(low: float, high: float) -> np.ndarray:
    return np.random.default_rng(1).permutation(np.linspace(low, high, COUNT))


def pair(stage: int | None, low: float) -> Any:
    """Play from ``low`` on, an error of twice that, and limits of 11 and 22 um."""
    assemblies = PairAssemblies(
        rising(1e-4, 2e-4), rising(0.010, 0.030), rising(0.001, 0.002), rising(low, low + 0.1),
        rising(0.2, 0.3), rising(0.15, 0.25), rising(1.2, 1.6),
    )  # fmt: skip
    nominal = PairAssemblies(*(np.array([float(one.mean())]) for one in vars(assemblies).values()))
    return Made(
        stage=stage,
        assemblies=assemblies,
        nominal=nominal,
        jam=Share(0.04, 0.03, 0.06),
        knock=Share(0.25, 0.2, 0.3),
        knocking_mm=0.22,
        flank_limits_mm=(np.array([0.011, 0.02]), np.array([0.022])),
        first_order=Made(
            linear_mm=np.array([0.01, 0.03]), drawn_mm=np.array([0.02]), difference=0.05,
            by_source={"pitch": np.array([0.001, 0.004])},
        ),
        errors=(Made(error_mm=0.002, displaced_mm=0.1), Made(error_mm=0.0015, displaced_mm=0.01)),
        between=Made(assemblies=64, least_play_mm=0.0007, largest_play_mm=0.0, transmission_error_mm=0.0003),
    )  # fmt: skip


def tolerated(two: bool = False, **changes: Any) -> Any:
    pairs = [pair(1, 0.02), pair(2, -0.01)] if two else [pair(None, 0.02)]
    found = tuple(one.assemblies for one in pairs), *(rising(low, 2.0 * low) for low in (1e-4, 0.02, 2e-3, 0.3, 900.0))
    nominal = tuple(one.nominal for one in pairs), *(np.array([low]) for low in (1e-4, 0.02, 2e-3, 0.3, 900.0))
    values = {
        "drive": drive("ellipse"),
        "pairs": pairs,
        "assemblies": Assemblies(*found),  # type: ignore[arg-type]
        "nominal": Assemblies(*nominal),  # type: ignore[arg-type]
        "jam": Share(0.04, 0.03, 0.06),
        "knock": Share(0.25, 0.2, 0.3),
        "loaded": True,
        "process": None,
        "tolerances": AssemblyTolerances(grade=8),
        "seed": 1,
        "needed": Made(key="backlash_mm", value=0.08, given=0.05, of_pairs=(0.08, 0.07), jammed=Share(0.0, 0.0, 0.01),
                       refused=""),
        "indices": {
            "least_play_mm": (
                Index(DeviationSource("pitch"), 0.5, 0.62, 0.1), Index(DeviationSource("wear"), 0.1, 0.019, 0.1)
            ),
            "motion_error": (Index(DeviationSource("tilt_driven", 2), 0.5, 0.4, 0.1),),
        },
        "index_samples": 64,
    }  # fmt: skip
    return Made(**values | changes)


def test_percentiles_are_told_on_the_bad_side() -> None:
    """99 of 100 keep more play and contact than the first percentile, and less of all else than the last."""
    told = tolerance_json(tolerated())["figures"]
    play, error, arc = (told[key] for key in ("least_play_mm", "transmission_error_mm", "contact_ratio_min"))
    assert (play["least"], play["median"], play["largest"]) == pytest.approx((0.02, 0.07, 0.12))
    assert (play["as_designed"], play["of_99_percent"]) == pytest.approx((0.07, 0.021))
    assert (error["of_99_percent"], error["as_designed"]) == pytest.approx((0.0398, 0.02))
    assert arc["of_99_percent"] == pytest.approx(1.204)
    assert told["reversal_play_mm"]["of_99_percent"] == pytest.approx(0.249)
    assert told["motion_error_mm"]["largest"] == pytest.approx(0.6)
    assert told["peak_acceleration_mm_s2"]["least"] == pytest.approx(900.0)
    assert "play_max_rad" not in told
    two = tolerance_json(tolerated(two=True))
    assert two["figures"]["play_max_rad"]["largest"] == pytest.approx(4e-3)
    assert two["figures"]["least_play_mm"]["least"] == pytest.approx(-0.01)
    stages = two["stages"]
    assert [stages[f"stage_{n}"]["figures"]["least_play_mm"]["least"] for n in (1, 2)] == pytest.approx([0.02, -0.01])
    assert [stages[f"stage_{n}"]["backlash_needed"] for n in (1, 2)] == [0.08, 0.07]
    assert "reversal_play_mm" not in tolerance_json(tolerated(loaded=False))["figures"]
    open_ended = tolerated()
    open_ended.assemblies.pairs[0].least_arc[3] = np.inf
    assert "contact_ratio_min" not in tolerance_json(open_ended)["figures"]


def test_checks_and_grades_are_told_by_their_extremes() -> None:
    told = tolerance_json(tolerated())
    assert told["single_pitch_um"] == [11.0, 20.0]
    assert told["total_profile_um"] == [22.0, 22.0]
    first = told["first_order"]
    assert (first["play_deviation_mm"], first["play_deviation_drawn_mm"]) == (0.03, 0.02)
    assert first["by_source_mm"] == {"pitch": 0.004}
    assert told["knock"]["largest_play_mm"] == 0.22


def test_assemblies_have_a_row_each_and_pairs_their_own_columns() -> None:
    for two in (False, True):
        heads, *rows = assemblies_csv(tolerated(two=two)).splitlines()
        assert len(rows) == COUNT
        assert ("stage_2_least_play_mm" in heads.split(",")) == two


def test_verdicts_are_those_of_the_shares() -> None:
    def broken(**changes: Any) -> list[str]:
        return [one.broken for one in judged_assemblies(tolerated(**changes))]

    jams, knocks, linear = broken()
    assert (jams, knocks) == ("4 % of the assemblies jam", "25 % of the assemblies knock")
    # 1.5 um of 10 um, though another is off by more of more.
    assert "off by up to 15 %" in linear
    none = Share(0.0, 0.0, 0.01)
    assert broken(jam=none, knock=none)[:2] == ["", ""]
    assert broken(knock=None)[1] == ""
    exact = tolerated()
    exact.pairs[0].errors = (Made(error_mm=0.0009, displaced_mm=0.01),)
    assert judged_assemblies(exact)[2].broken == ""


def test_words_about_assemblies() -> None:
    one, two = tolerated(), tolerated(two=True)
    assert jam_words(one) == "4 % (3 to 6 % of all)"
    assert jam_words(two).endswith("; stage 1: 4 %, stage 2: 4 %")
    assert knock_words(one) == "25 % (20 to 30 % of all): play over 0.22 mm where the torque turns round"
    assert "stage 1: 0.22 mm, stage 2: 0.22 mm anywhere" in knock_words(tolerated(two=True, loaded=False))
    assert needed_words(one) == "99.9 % turn with 0.08 (0.05 given); fresh ones: 0 % (0 to 1 % of all) jam"
    assert "stage 1: 0.08, stage 2: 0.07" in needed_words(two)
    assert needed_words(tolerated(needed=None)) == "not told of so few; --samples 4096 or more is right"
    assert [_power_of_two(count) for count in (1, 2, 3, 4096, 4097)] == [1, 2, 4, 4096, 8192]
    long = ", ".join(f"source number {number} {90 - number} %" for number in range(9))
    kept = _first(long)
    assert long.startswith(kept)
    assert len(kept) <= 70 < len(", ".join(long.split(", ")[: len(kept.split(", ")) + 1]))


def test_the_answer_has_the_worst_of_its_checks() -> None:
    """The largest error in micrometres, with its own displacement; small sources are left out."""
    answer = tolerance_answer(tolerated())
    rows = {row.name: row.texts for row in answer.rows}
    assert rows["checked"] == ("linear model off the outlines of 2 assemblies by 2 of 100 \u00b5m",)
    assert rows["between"][0].startswith("up to 0.7 \u00b5m less play, 0.3 \u00b5m more")
    assert rows["least play"] != ()
    assert [row.texts for row in answer.rows if "varies with" in row.texts[0]] == [
        ("varies with pitch 62 %",),
        ("varies with stage 2 driven bore tilted 40 %",),
    ]
    assert "all but 8 of the assemblies turn" in answer.good
    assert len(answer.faults) == 3
    two = tolerance_answer(tolerated(two=True))
    assert [row.name for row in two.rows[:2]] == ["stage 1: least play", "stage 2: least play"]


# --- measured gears --------------------------------------------------------------------------------------------------


def test_figures_of_a_measured_gear_are_counts_and_extremes_of_its_flanks() -> None:
    """Front flanks stand out by 10 um, back flanks by 4; tooth 5 has no points, and two are far away."""
    gear = drive("ellipse").teeth.driving
    outline = exact_outline(gear)
    high, low = gear.sides.flank_range()
    low = np.maximum(low, -gear.tips.met_depth_mm)
    flank = np.repeat([row for row in range(2 * gear.teeth) if row // 2 != 4], 4)
    height = low[flank] + (high - low)[flank] * np.tile([0.2, 0.4, 0.6, 0.8], flank.size // 4)
    before, at, after = (as_complex(gear.flanks.flank(flank, height + step)[0]) for step in (-1e-4, 0.0, 1e-4))
    normal = 1j * (after - before) / np.abs(after - before)
    tangent = as_complex(gear.flanks.curve.at_length(gear.flanks.crossing_mm[flank]).tangent)
    normal = np.where(gear.flanks.side[flank] * np.real(normal * tangent.conj()) > 0.0, normal, -normal)
    points = np.append(at + np.where(flank % 2 == 1, 0.010, 0.004) * normal, [300.0, 300.0j])
    feet = outline.feet(points)
    alone = np.zeros(points.size)
    alone[[2, 7]] = 0.1, -0.3
    counted = on_flanks(outline, feet) & (alone == 0.0)
    fit = BestFit(Pose(0.2), feet, counted, 1e-5, None, alone)
    one: Any = Made(
        gear=Gear.DRIVING, outline=outline, fit=fit, deviations=deviations(outline, fit),
        file=Made(file="p.csv", lines=tuple(range(10, 10 + points.size))),
    )  # fmt: skip
    told = gear_figures(one)
    assert (told["points"], told["points_on_flanks"], told["points_alone"]) == (points.size, points.size - 4, 2)
    assert (told["points_astray"], told["teeth_with_missing_points"]) == (2, [5])
    cosine = np.cos(np.radians(20.0))
    assert told["thickness_mean_mm"] == pytest.approx(0.014 / cosine, abs=1e-5)
    assert told["thickness_least_mm"] <= told["thickness_mean_mm"] <= told["thickness_greatest_mm"]
    assert told["cumulative_pitch_back_mm"] == pytest.approx(0.0, abs=1e-5)
    assert "shift_x_mm" not in told
    first, second = alone_points(one)
    assert (first.line, first.off_mm, first.tooth, first.on) == (17, -0.3, 1, "front")
    assert (second.line, second.off_mm, second.tooth, second.on) == (12, 0.1, 1, "back")
    assert first.angle_deg == pytest.approx(np.degrees(np.angle(feet.point[7])))
    rows = compared_csv(Made(gears=[one])).splitlines()
    assert rows[0] == ",".join(COLUMNS)
    assert len(rows) == 1 + 2 * gear.teeth
    assert rows[8 + 1].split(",")[1:4] == ["5", "back", "0"]
    assert float(rows[2].split(",")[4]) == pytest.approx(0.010, abs=1e-6)
    table = [line.split(",") for line in points_csv(one).splitlines()[1:]]
    assert [int(float(row[0])) for row in table] == list(one.file.lines)
    wanted = np.where(counted[:-2], (flank // 2 + 1) * np.where(flank % 2 == 1, 1, -1), 0)
    assert [int(float(row[4])) for row in table] == [*wanted, 0, 0]
