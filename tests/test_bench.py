"""Speed against error of a design's own stages: rates of convergence, and recommendations that keep what is asked.

Times are told, not judged.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache, partial
from math import pi
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.integrate import quad
from shapely import Polygon

import ncgear
from commands import Run
from drives import DESIGNS, drive, drive_of_text
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines, as_written, reach_mm
from ncgear.figures.answers.answer import COLUMNS, LINES, answer_text
from ncgear.figures.bench import bench_answer
from ncgear.pitch.shape import Gear
from ncgear.project import bench
from ncgear.project.bench import BenchStage, TimedStage
from ncgear.teeth.gear import toothed_pair

NAME = "ellipse"


def stage_of(errors: list[float], asked: float) -> BenchStage:
    trials = tuple(TimedStage(2.0**n, 1e-3 * 2.0**n, error, 2**n) for n, error in enumerate(errors))
    return BenchStage("points", "nothing", "nothing", asked, 4.0, trials, name="made up")


class TestRecommendation:
    def test_the_coarsest_that_is_good_enough(self) -> None:
        stage = stage_of([1.0, 0.25, 0.0625, 0.015625], 0.1)
        assert stage.recommended is stage.trials[2]
        assert stage.order == pytest.approx(2.0, rel=1e-12)

    def test_luck_does_not_count(self) -> None:
        """An error below what is asked that a finer setting does not have."""
        stage = stage_of([1.0, 0.01, 0.2, 0.05], 0.1)
        assert stage.recommended is stage.trials[3]

    def test_nothing_is_recommended_where_nothing_is_good_enough(self) -> None:
        """Negative control: it is told as a warning, and has no row."""
        stage = stage_of([1.0, 0.5], 0.1)
        assert stage.recommended is None
        text = answer_text(bench_answer([stage], "d", "nothing"))
        assert "no points tried is within 100 µm; the finest has 500 µm" in text
        assert "takes longest" not in text

    def test_finer_settings_are_tried_until_one_is_good_enough(self) -> None:
        tried = partial(bench._tried, [1.0, 2.0], bench._twice, lambda n: n, lambda n: (1.0 / n**2, int(n)))
        assert [trial.setting for trial in tried(0.5)] == [1.0, 2.0]
        assert [trial.setting for trial in tried(0.02)] == [1.0, 2.0, 4.0, 8.0]
        # Negative control: an error that cannot be reached ends.
        assert len(tried(1e-30)) == 2 + bench.MOST_FINER


@cache
def stages() -> dict[str, BenchStage]:
    return {stage.name: stage for stage in bench.benched(drive(NAME), lambda name: None)}


ORDERS = {"pitch curves": (1.9, 2.1), "teeth": (0.9, 1.1), "solids": (0.9, 1.1)}
"""Chords miss a length with the square of their number; what is made to a tolerance errs in proportion to it."""


@pytest.mark.long
@pytest.mark.slow
def test_errors_fall_as_theory_says() -> None:
    for name, (least, most) in ORDERS.items():
        order = stages()[name].order
        assert order is not None
        assert least < order < most, name
    elements = bench._elements(drive("baler"))
    assert elements.order is not None
    assert elements.order > 2.0
    assert elements.recommended is not None


@pytest.mark.slow
def test_what_is_recommended_is_as_good_as_asked() -> None:
    """By other means than the command's: SciPy's quadrature, distances and areas by GEOS of far finer outlines."""
    own = drive(NAME)
    asked = own.chord_tolerance_mm
    pitch = own.pitch.driving
    # The length of the pitch curve from its radius over the polar angle, phi1 = -angle.
    count = int(chosen("pitch curves").setting)
    ratio = own.transmission

    def speed(phi: float) -> float:
        slope = ratio.driven_angle(np.array([phi]), 2)
        turn, change = float(slope.derivative(1)[0]), float(slope.derivative(2)[0])
        centre = own.pitch.center_distance_mm
        return float(np.hypot(centre * turn / (1.0 + turn), centre * change / (1.0 + turn) ** 2))

    length, _ = quad(speed, 0.0, 2.0 * np.pi, epsabs=1e-10, epsrel=1e-12, limit=400)
    points = pitch.at_length(np.linspace(0.0, pitch.length_mm, count + 1)).position
    assert 0.0 < length - np.linalg.norm(np.diff(points, axis=0), axis=1).sum() < asked
    fine = toothed_pair(own.pitch, own.tooth_form, asked / 50.0)
    for name in ("teeth", "solids"):
        made = toothed_pair(own.pitch, own.tooth_form, chosen(name).setting)
        coarse = toothed_pair(own.pitch, own.tooth_form, 16.0 * asked)
        for gear in Gear:
            exact = Polygon(fine.of(gear).outline_mm)
            assert hausdorff_mm(Polygon(made.of(gear).outline_mm), exact) < 1.05 * asked
            # Negative control: what is not recommended is farther off.
            assert hausdorff_mm(Polygon(coarse.of(gear).outline_mm), exact) > asked


def chosen(name: str) -> TimedStage:
    found = stages()[name].recommended
    assert found is not None
    return found


def hausdorff_mm(made: Polygon, exact: Polygon) -> float:
    return float(made.exterior.distance(shapely.points(np.array(exact.exterior.coords))).max())


@pytest.mark.slow
def test_the_command(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """A screen, and the files; the stages are those computed above."""
    computed = list(stages().values())
    monkeypatch.setattr(bench, "benched", lambda _, on_step: [on_step(one.name) or one for one in computed])
    arguments = "bench", str(DESIGNS / f"{NAME}.yaml")
    status, out, err = run(*arguments)
    assert (status, err) == (0, "")
    assert len(out.splitlines()) <= LINES
    assert max(map(len, out.splitlines())) <= COLUMNS
    assert "..." not in out.partition("Written")[0]
    told = json.loads(Path(f"export/{NAME}-bench/bench.json").read_text())
    assert set(told["stages"]) == {name.replace(" ", "_") for name in stages()}
    rows = Path(f"export/{NAME}-bench/bench.csv").read_text().splitlines()
    assert len(rows) == 1 + sum(len(stage.trials) for stage in stages().values())
    for name in stages():
        assert Path(f"export/{NAME}-bench/bench-{name.replace(' ', '-')}.png").stat().st_size > 5000
    status, out, _ = run(*arguments, "--verbose")
    assert status == 0
    assert "  reference    points of the exact flanks" in out


TWO_PAIRS = """\
name: two-pairs
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 60}
motion: {law: harmonic_ratio, cosine: [-0.2], sine: [0.1], second_stage: {cosine: [-0.1]}}
gears: {teeth: 24, module_mm: 1.5, face_width_mm: 10}
"""


@pytest.mark.slow
def test_both_of_two_pairs_are_measured() -> None:
    """Each by its own curves: their length by quadrature, less that of fifty chords."""
    machine = drive_of_text(TWO_PAIRS)
    names: list[str] = []
    found = {stage.name: stage for stage in bench.benched(machine, names.append)}
    assert list(found) == names
    assert len(names) == bench.step_count(machine) == 1 + 2 * 4
    for pair in machine.by_stage:
        trials = found[f"pitch curves of stage {pair.stage}"].trials
        curve = pair.pitch.driving
        points = curve.at_length(np.linspace(0.0, curve.length_mm, 51)).position
        chords = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        assert trials[0].error == pytest.approx(curve.length_mm - chords, rel=1e-6)
        teeth = found[f"teeth of stage {pair.stage}"]
        assert teeth.recommended is not None
        assert teeth.recommended.error <= pair.chord_tolerance_mm


def test_a_tolerance_that_is_asked_for_decides() -> None:
    """The same errors, asked for ten times as fine, ask for a finer setting."""
    stage = stage_of([1.0, 0.25, 0.0625, 0.015625], 0.3)
    finer = replace(stage, asked_error=stage.asked_error / 10.0).recommended
    assert stage.recommended is not None
    assert finer is not None
    assert finer.setting > stage.recommended.setting


@pytest.mark.slow
def test_errors_of_positions_are_those_of_the_searched_extremes() -> None:
    """Brute force at 301 positions a tooth misses more than the 16 tried, and no more than what the bench tells."""
    one = ncgear.load("designs/ellipse.yaml")
    pitch, teeth = one.pitch, one.teeth
    outlines = Outlines("brute force", teeth.driving.outline_mm, teeth.driven.outline_mm)
    dense, coarse = (
        as_written(outlines, teeth, placed(pitch, count), reach_mm(pitch, teeth)).transmission_error_rad
        for count in (301, 16)
    )
    radius_mm = np.linalg.norm(pitch.driven.at_angle(np.linspace(0.0, 2.0 * pi, 9999)).position, axis=1).max()
    [told] = [trial.error for trial in bench._contact(one).trials if trial.setting == 16.0]
    assert radius_mm * (dense - coarse) <= told <= 1.8 * radius_mm * (dense - coarse)
