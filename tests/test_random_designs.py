"""Random design files end as a result that holds or as a named error, and as nothing else.

More of them: `make fuzz`, which is `NCGEAR_FUZZ=10 python -m pytest -m slow tests/test_random_designs.py`: ten times as
many.  The same number draws the same designs each time; a larger one goes on from there.  Those beyond .ci/run are
checked and built on all cores, or on the Dask cluster whose address is in NCGEAR_SCHEDULER.
"""

from __future__ import annotations

import json
import os
import re
import warnings
from collections import Counter
from collections.abc import Callable
from functools import partial
from io import BytesIO, StringIO
from math import isfinite, pi, radians
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from shapely import Polygon

from commands import Run
from drives import design_of
from ncgear.cli.arguments import opened
from ncgear.design.laws.function_generator import FunctionGenerator
from ncgear.drawings.beside import Here
from ncgear.errors import DesignError
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.tables import outline_csv
from ncgear.files import build as build_module
from ncgear.files.read_back import outline_of_csv
from ncgear.files.workshop.formats import USUAL, WRITTEN
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import OpenRange
from ncgear.workers import finished
from oracles import meshing
from random_designs import Data, designs, spoiled_designs

TIMES = int(os.environ.get("NCGEAR_FUZZ", "1"))

CHECKED, BATCHES = 100, 100 * TIMES
"""Designs in a batch that are checked, with their pitch curves: ten thousand in all."""

BUILT, BUILT_BATCHES = 8, 8 * TIMES
"""Designs in a batch that are built: teeth, contact, solids and all tables."""

CLOSED_RAD = 1e-12

POSITIONS = 97


def each(count: int, number: int, strategy: st.SearchStrategy[Data], judged: Callable[[Data], str]) -> Counter[str]:
    """How often each verdict was given to ``count`` designs, the same at each run with the same ``number``."""
    found: Counter[str] = Counter()

    @seed(number)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    @given(strategy)
    def judge_all(data: Data) -> None:
        found[judged(data)] += 1

    judge_all()
    return found


def written(folder: Path, data: Data) -> Path:
    """The design as a file."""
    path = folder / "d.yaml"
    path.write_text(json.dumps(data).replace("NaN", ".nan").replace("Infinity", ".inf"), encoding="utf-8")
    return path


def verdict(folder: Path, data: Data, use: Callable[[Drive], None]) -> str:
    """What became of a design as the command line would say it; any other exception, a warning too, goes through."""
    path = written(folder, data)
    try:
        with opened(path) as loaded:
            use(Drive(loaded.design))
    except DesignError as error:
        assert error.exit_status in (2, 3)
        assert error.location.startswith(f"{path}:")
        assert len(error.problem) > 10
        assert "nan" not in error.problem.replace(".nan", "")
        return f"refused {error.exit_status}"
    return "made"


def numbers_in(values: Any) -> list[float]:
    """All numbers in plain values."""
    if isinstance(values, dict | list):
        inner = values.values() if isinstance(values, dict) else values
        return [number for value in inner for number in numbers_in(value)]
    return [values] if isinstance(values, int | float) else []


def range_holds(drive: Drive, covered: OpenRange) -> None:
    """An open law covers what its keys say, and what its slope adds up to by Gauss's rule."""
    motion = drive.design.motion
    asked = motion.driving_range_deg if isinstance(motion, FunctionGenerator) else motion.range_deg
    assert covered.driving_rad == pytest.approx(radians(asked), rel=1e-14)
    if isinstance(motion, FunctionGenerator):
        assert covered.driven_rad == pytest.approx(radians(motion.driven_range_deg), rel=1e-12)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    phi1 = covered.driving_rad * (nodes + 1.0) / 2.0
    slope = drive.transmission.driven_angle(phi1, 1).differentiated().value
    assert covered.driving_rad / 2.0 * weights @ slope == pytest.approx(covered.driven_rad, rel=1e-9)


def check_holds(drive: Drive) -> None:
    """The figures of a check are finite and the law closes, by its own word and by its values at both ends."""
    summary = check_summary(drive)
    assert all(isfinite(number) for number in numbers_in(summary))
    assert summary["closure"]["residual_rad"] <= CLOSED_RAD
    linkage, place = drive.linkage, drive.linkage.OUTPUT.place
    residuals = {key: value for key, value in summary["closure"].items() if key.startswith("stroke_residual")}
    assert residuals.keys() == ({f"stroke_residual_{place.ending}"} if linkage.RETURNS else set())
    assert sum(residuals.values()) <= CLOSED_RAD * place.factor * linkage.stroke_mm
    lobes = drive.transmission.lobes
    ends = drive.transmission.driven_angle(np.array([0.0, lobes.driving_period_rad * (1.0 - 1e-15)])).value
    assert abs(ends[1] - ends[0] - lobes.driven_period_rad) <= 2.0 * CLOSED_RAD
    if lobes.range is None:
        assert lobes.driven_period_rad == 2.0 * pi / lobes.driven
    else:
        range_holds(drive, lobes.range)
    assert 0.0 < summary["ratio"]["min"] <= summary["ratio"]["max"]


def curves_hold(drive: Drive) -> None:
    """Pitch curves are finite and touch on the line of centres all the way."""
    for pair in drive.by_stage:
        pitch, phi1 = pair.pitch, np.linspace(0.0, 2.0 * pi, 50)
        distance = [
            float(np.hypot(*curve.at_angle(np.zeros(1)).position.T)[0]) for curve in (pitch.driving, pitch.driven)
        ]
        apart = distance[1] - distance[0] if pitch.driven.is_ring else distance[0] + distance[1]
        assert apart == pytest.approx(pitch.center_distance_mm, rel=1e-9)
        assert np.isfinite(pitch.pitch_point_mm(phi1)).all()


def checked(drive: Drive) -> None:
    check_holds(drive)
    curves_hold(drive)


def judge_checks(number: int, count: int = CHECKED) -> Counter[str]:
    """The verdicts on a batch of checks."""
    with TemporaryDirectory() as folder:
        return each(count, number, spoiled_designs(), lambda data: verdict(Path(folder), data, checked))


def judged_batches(judge: Callable[[int], Counter[str]], count: int) -> dict[int, Counter[str]]:
    """What a judge says of each of ``count`` batches, in whatever process."""
    found = dict(finished(partial(strictly, judge), range(count), os.environ.get("NCGEAR_SCHEDULER")))
    assert len(found) == count
    return found


def strictly(judge: Callable[[int], Counter[str]], batch: int) -> Counter[str]:
    """What a judge says; a warning is a fault in other processes too, as it is in that of the test."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return judge(batch)


@pytest.mark.slow
def test_random_designs_are_checked_or_refused() -> None:
    found = judge_checks(10**6, 36)
    assert min(found["made"], found["refused 2"]) >= 3, found
    assert found["refused 3"] > 0, found


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.attack
def test_many_random_designs_are_checked_or_refused() -> None:
    for batch, found in judged_batches(judge_checks, BATCHES).items():
        assert found["made"] >= 0.2 * CHECKED, (batch, found)


def solid_holds(stl: bytes) -> None:
    mesh = trimesh.load_mesh(BytesIO(stl), file_type="stl")
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0.0
    assert np.isfinite(mesh.vertices).all()


def gears_hold(drive: Drive, files: dict[str, bytes]) -> None:
    """Written outlines never overlap while they turn by the law."""
    pitch, tolerance = drive.pitch, drive.chord_tolerance_mm
    covered = pitch.transmission.lobes.range
    phi1 = np.linspace(0.0, covered.driving_rad if covered else pitch.driving.turn_rad, POSITIONS + 1)
    phi2 = pitch.transmission.driven_angle(phi1).value
    driving, driven = (Polygon(outline_of_csv(files[f"{gear}.csv"])) for gear in ("driving", "driven"))
    if pitch.driven.is_ring:
        driven = driven.buffer(5.0 * drive.rack.module_mm).difference(driven)
        phi2 = -phi2
    report = meshing.Pair(driving, driven, phi1, phi2, pitch.center_distance_mm).report(POSITIONS)
    assert report.overlap_depth.max() <= 1.2 * tolerance


def files_hold(drive: Drive, files: dict[str, bytes]) -> None:
    """Finite tables, closed solids, gears that run in each other."""
    summary = json.loads(files["summary.json"])
    assert all(isfinite(number) for number in numbers_in(summary))
    assert summary["closure"]["residual_rad"] <= CLOSED_RAD
    for table in ("law.csv", "driving.csv", "driven.csv", "contact.csv"):
        assert np.isfinite(np.loadtxt(StringIO(files[table].decode()), delimiter=",", skiprows=1)).all()
    for solid in ("driving.stl", "driven.stl"):
        solid_holds(files[solid])
    gears_hold(drive, files)


def build_holds(drive: Drive) -> None:
    """The files of every pair."""
    for pair in drive.by_stage:
        files_hold(pair, build_module._made(pair, lambda _: None, USUAL, Undrawn()).files)


def judge_builds(number: int, count: int = BUILT) -> Counter[str]:
    """Verdicts on ``count`` designs, or on more until one is made, as a quarter are; the rest is not judged."""
    found: list[str] = []

    def judged(data: Data) -> str:
        if len(found) >= count and "made" in found:
            return "not judged"
        with TemporaryDirectory() as folder:
            found.append(verdict(Path(folder), data, build_holds))
        return found[-1]

    each(16 * count, number, designs(teeth=(12, 45)), judged)
    return Counter(found)


class Undrawn(Here):
    """Draws no picture, which takes longer than all the rest of a small build; makes the other files."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        return super().begun(drawing, *given) if drawing == WRITTEN else dict


@pytest.mark.slow
@pytest.mark.attack
def test_random_designs_are_built_or_refused() -> None:
    found = judge_builds(10**6, 4)
    assert found["made"] >= 1, found


def without_a_facet(stl: bytes) -> bytes:
    count = int.from_bytes(stl[80:84], "little")
    return stl[:80] + (count - 1).to_bytes(4, "little") + stl[84:-50]


def thickened(table: bytes) -> bytes:
    outline = outline_of_csv(table) * 1.01
    return outline_csv(outline).encode()


SPOILERS: dict[str, Callable[[bytes], bytes]] = {
    "summary.json": lambda text: re.sub(rb'"residual_rad": [^,]*', b'"residual_rad": 2e-12', text, count=1),
    "law.csv": lambda text: text + b"nan,1,1,1,1,1,1,1\n",
    "driven.stl": without_a_facet,
    "driving.csv": thickened,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SPOILERS)
def test_the_judge_sees_what_is_wrong_in_a_file(name: str) -> None:
    gears = {"teeth": 20, "module_mm": 2.0, "face_width_mm": 10.0}
    linkage, motion = {"crank_mm": 10.0, "rod_mm": 30.0}, {"law": "uniform_crank"}
    values = {"name": "a", "linkage": linkage, "operation": {"speed_rpm": 1.0}, "motion": motion, "gears": gears}
    drive = Drive(design_of(values))
    files = build_module._made(drive, lambda _: None, (), Undrawn()).files
    files_hold(drive, files)
    spoiled = {**files, name: SPOILERS[name](files[name])}
    assert spoiled != files
    with pytest.raises(AssertionError):
        files_hold(drive, spoiled)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.attack
def test_many_random_designs_are_built_or_refused() -> None:
    for batch, found in judged_batches(judge_builds, BUILT_BATCHES).items():
        assert found["made"] >= 1, (batch, found)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.attack
def test_the_program_ends_with_the_status_of_the_verdict(run: Run, tmp_path: Path) -> None:
    status = {"made": 0, "refused 2": 2, "refused 3": 3}

    def judged(data: Data) -> str:
        expected = verdict(tmp_path, data, check_holds)
        ended, out, err = run("check", "d.yaml", "--json")
        assert ended == status[expected], err
        assert bool(out) == (expected == "made")
        return expected

    assert len(each(25, 10**6, spoiled_designs(), judged)) == 3
