"""Speed against error of a user's design: each stage with several settings, its time, and its error.

Errors are measured against references that the stage does not use: exact peaks from closed forms, lengths by
quadrature, points of the exact curves between the chords, or the same stage with a much finer setting.  The recommended
setting is the coarsest with a measured error within the error that the file asks for.  If no setting is fine enough,
finer settings are tried.

The file asks for an error by ``output.chord_tolerance_mm``: the largest distance between written and exact teeth.
Errors that are lengths are compared with it.  Errors that are shares have no key; they are compared with a thousandth
of a peak and a hundredth of a stress.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

if TYPE_CHECKING:
    from trimesh import Trimesh

    from ncgear.contact.written.as_written import AsWritten
    from ncgear.solids.mesh.pair import SolidPair
    from ncgear.strength.elements.teeth import Elements
    from ncgear.teeth.gear import ToothedPair

Result = TypeVar("Result")

PEAK_SHARE, STRESS_SHARE = 1e-3, 1e-2
"""Errors of peaks and of stresses, as shares, that count as asked for."""

REPEATS, SHORT_S = 3, 0.5
"""Number of timings of a stage that takes less than ``SHORT_S``, of which the median is told; a longer stage is timed
once."""

MOST_FINER = 4
"""Most finer settings that are tried where none of the first settings is fine enough."""

LEAST_IN_MODULES = 3e-6
"""The least chord tolerance that is tried: finer chords are more points than an outline may have."""


@dataclass(frozen=True)
class TimedStage:
    """A stage at one setting: its time, its error, and its size in points, positions, triangles or elements."""

    setting: float
    time_s: float
    error: float
    size: int


@dataclass(frozen=True)
class BenchStage:
    """One stage at several settings, from coarse to fine.

    ``varied`` names the setting; ``error_of`` and ``error_unit`` name the error, ``reference`` the reference value.
    ``asked_error`` is the error that the file asks for, ``asked_by`` its key or None, ``used`` the setting of a build.
    """

    varied: str
    error_of: str
    reference: str
    asked_error: float
    used: float
    trials: tuple[TimedStage, ...]
    varied_unit: str = ""
    error_unit: str = "mm"
    asked_by: str | None = "output.chord_tolerance_mm"
    name: str = ""

    @property
    def recommended(self) -> TimedStage | None:
        """The coarsest trial with an error within the asked error, as for all finer trials; None where there is none.

        At a single setting samples may hit the extremes by luck.
        """
        found = None
        for trial in reversed(self.trials):
            if trial.error > self.asked_error:
                break
            found = trial
        return found

    @property
    def order(self) -> float | None:
        """The power of the fineness with which the error falls, by least squares in logarithms; None where it does not.

        The fineness is the inverse of a tolerance, and any other setting itself.
        """
        rows = [(trial.setting, trial.error) for trial in self.trials if trial.error > 0.0]
        if len({error for _, error in rows}) < 2:
            return None
        setting, error = np.log(np.array(rows)).T
        falls = float(np.polyfit(setting, error, 1)[0])
        return falls if self.varied_unit else -falls


def benched(drive: Drive, on_step: Callable[[str], None]) -> list[BenchStage]:
    """All stages that a design has, from its motion to its finite elements; raises the errors of the drive's stages.

    Two pairs of gears have every stage but the motion twice, each named by its pair: ``teeth of stage 1``.
    """
    found = []
    for name, stage in _stages(drive):
        on_step(name)
        found.append(replace(stage(), name=name))
    return found


def step_count(drive: Drive) -> int:
    """Number of stages."""
    return sum(1 for _ in _stages(drive))


def _stages(drive: Drive) -> Iterator[tuple[str, Callable[[], BenchStage]]]:
    yield "motion", partial(_motion, drive)
    if drive.design.gears is None:
        return
    for pair in drive.by_stage:
        of = "" if pair.stage is None else f" of stage {pair.stage}"
        yield f"pitch curves{of}", partial(_pitch_curves, pair)
        yield f"teeth{of}", partial(_teeth, pair)
        yield f"contact{of}", partial(_contact, pair)
        if pair.helix is None:
            yield f"solids{of}", partial(_solids, pair)
            if drive.design.masses is not None or drive.design.resistance is not None:
                yield f"elements{of}", partial(_elements, pair)


def _timed(compute: Callable[[], Result]) -> tuple[Result, float]:
    """A result, and the median of its times."""
    start = perf_counter()
    result = compute()
    times = [perf_counter() - start]
    while times[0] < SHORT_S and len(times) < REPEATS:
        start = perf_counter()
        compute()
        times.append(perf_counter() - start)
    return result, median(times)


def _tried(
    settings: list[float],
    finer: Callable[[float], float | None],
    compute: Callable[[float], Result],
    judge: Callable[[Result], tuple[float, int]],
    asked: float,
) -> tuple[TimedStage, ...]:
    """Trials at settings and, until one is good enough, at finer settings; ``finer`` gives None when none is left."""
    trials: list[TimedStage] = []
    waiting = list(settings)
    while waiting:
        setting = waiting.pop(0)
        result, time_s = _timed(partial(compute, setting))
        error, size = judge(result)
        trials.append(TimedStage(setting, time_s, error, size))
        enough = any(trial.error <= asked for trial in trials)
        following = finer(setting)
        if not waiting and not enough and following is not None and len(trials) < len(settings) + MOST_FINER:
            waiting = [following]
    return tuple(trials)


def _twice(setting: float) -> float:
    return 2.0 * setting


def _motion(drive: Drive) -> BenchStage:
    machine, exact = drive.machine, drive.check.peak_acceleration_cycle.value
    cycle = drive.transmission.cycle_rad

    def judge(accelerations: Array) -> tuple[float, int]:
        return abs(float(np.abs(accelerations).max()) / exact - 1.0), accelerations.size

    def compute(count: float) -> Array:
        return machine.motion(np.linspace(0.0, cycle, int(count) + 1)).acceleration

    trials = _tried([125.0, 250.0, 500.0, 1000.0, 2000.0], _twice, compute, judge, PEAK_SHARE)
    return BenchStage(
        "rows a cycle",
        "peak acceleration among the rows",
        "the exact peak, from zeros of the derivative in closed form",
        PEAK_SHARE,
        2000.0,
        trials,
        error_unit="of the peak",
        asked_by=None,
    )


def _pitch_curves(drive: Drive) -> BenchStage:
    pitch, asked = drive.pitch, drive.chord_tolerance_mm
    length = pitch.driving.length_mm

    def compute(count: float) -> tuple[float, int]:
        points = pitch.driving.at_length(np.linspace(0.0, length, int(count) + 1)).position
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()), int(count)

    def judge(found: tuple[float, int]) -> tuple[float, int]:
        # The rounding of a sum of lengths is not an error of the chords.
        return max(length - found[0], np.finfo(float).eps * length), found[1]

    trials = _tried([50.0, 100.0, 200.0, 400.0, 800.0], _twice, compute, judge, asked)
    reference = "the length by Gauss-Legendre quadrature, piece by piece"
    return BenchStage("points", "length of the driving pitch curve by chords", reference, asked, 720.0, trials)


def _tolerances(drive: Drive) -> list[float]:
    asked = drive.chord_tolerance_mm
    return [asked * times for times in (16.0, 8.0, 4.0, 2.0, 1.0)]


def _teeth(drive: Drive) -> BenchStage:
    """The outlines by chord tolerance, beside points of the exact curves between all chords."""
    from ncgear.metrology.exact_outline import exact_points, farthest_mm

    asked = drive.chord_tolerance_mm
    exact = {gear: exact_points(drive.teeth.of(gear)) for gear in Gear}

    def judge(teeth: ToothedPair) -> tuple[float, int]:
        found = [farthest_mm(exact[gear], teeth.of(gear).outline_mm) for gear in Gear]
        return max(found), sum(len(teeth.of(gear).outline_mm) for gear in Gear)

    least_mm = LEAST_IN_MODULES * drive.pitch.size.module_mm
    return BenchStage(
        "tolerance",
        "farthest exact point from both outlines",
        "points of the exact flanks, fillets and lands, beside all places that chords go by",
        asked,
        asked,
        _tried(_tolerances(drive), lambda mm: mm / 2.0 if mm / 2.0 >= least_mm else None, drive.toothed, judge, asked),
        "mm",
    )


PER_TOOTH, MOST_PER_TOOTH = (4.0, 8.0, 16.0, 32.0), 64.0
"""Positions per tooth in the first trials, and the most."""


def _contact(drive: Drive) -> BenchStage:
    """The extremes of the contact of the outlines among positions, and the extremes searched between them."""
    from ncgear.contact.placement import placed
    from ncgear.contact.written.as_written import Outlines, as_written, reach_mm
    from ncgear.contact.written.extremes import play_extremes

    pitch, teeth, asked = drive.pitch, drive.teeth, drive.chord_tolerance_mm
    reach = reach_mm(pitch, teeth)
    outlines = Outlines("bench", teeth.driving.outline_mm, teeth.driven.outline_mm)

    def compute(per_tooth: float) -> AsWritten:
        return as_written(outlines, teeth, placed(pitch, int(per_tooth)), reach)

    exact = play_extremes(outlines, pitch, compute(placed(pitch).per_tooth), placed(pitch), reach)
    radius_mm = pitch.radius_range_mm(Gear.DRIVEN)[1]

    def judge(found: AsWritten) -> tuple[float, int]:
        error = abs(found.transmission_error_rad - exact.transmission_error_rad)
        missed = error, abs(float(found.backlash_rad.min()) - exact.backlash_rad.low.value)
        return radius_mm * max(missed), found.pushing_rad.size

    def finer(per_tooth: float) -> float | None:
        return 2.0 * per_tooth if 2.0 * per_tooth <= MOST_PER_TOOTH else None

    return BenchStage(
        "positions a tooth",
        "transmission error and least play of the outlines among the positions, at the largest driven pitch radius",
        "the extremes searched between positions",
        asked,
        placed(pitch).per_tooth,
        _tried(list(PER_TOOTH), finer, compute, judge, asked),
    )


FINER_SOLIDS = 16.0
"""Ratio of the asked chord tolerance to the chord tolerance of the reference of solids."""


def _solids(drive: Drive) -> BenchStage:
    """The meshes by chord tolerance: a section beside points of the exact curves, the volume beside finer meshes."""
    from ncgear.metrology.exact_outline import exact_points
    from ncgear.project.gear_solids import straight_solids

    asked, gears, pitch = drive.chord_tolerance_mm, drive.gears, drive.pitch

    def compute(tolerance: float, teeth: ToothedPair) -> SolidPair:
        return straight_solids(gears, pitch, teeth, tolerance, drive.crank_pin)

    exact = {gear: exact_points(drive.teeth.of(gear)) for gear in Gear}
    reference_mm = max(asked / FINER_SOLIDS, LEAST_IN_MODULES * pitch.size.module_mm)
    teeth = {tolerance: drive.toothed(tolerance) for tolerance in (*_tolerances(drive), reference_mm)}
    finest = compute(reference_mm, teeth[reference_mm])
    length = {
        gear: float(np.linalg.norm(np.diff(teeth[reference_mm].of(gear).outline_mm, axis=0), axis=1).sum())
        for gear in Gear
    }

    def judge(found: SolidPair) -> tuple[float, int]:
        missed = [
            abs(found.of(gear).mesh.volume - finest.of(gear).mesh.volume) / (length[gear] * gears.face_width_mm)
            for gear in Gear
        ]
        away = (_section_error_mm(exact[gear], found.of(gear).mesh, gears.face_width_mm / 2.0) for gear in Gear)
        return max(*missed, *away), sum(len(found.of(gear).mesh.faces) for gear in Gear)

    return BenchStage(
        "tolerance",
        "section halfway up, and volume as the mean distance of the tooth faces",
        f"points of the exact curves, and meshes of a tolerance of {reference_mm:g} mm",
        asked,
        asked,
        _tried(_tolerances(drive), lambda _: None, lambda mm: compute(mm, teeth[mm]), judge, asked),
        "mm",
    )


def _section_error_mm(exact: Array, mesh: Trimesh, height_mm: float) -> float:
    """The largest distance of exact points of a tooth outline from the nearest line of a mesh's section."""
    from ncgear.metrology.exact_outline import farthest_mm
    from ncgear.solids.mesh.triangles import section_rings

    rings = section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces), height_mm)
    if not rings:
        raise Unanswered(f"a gear's mesh has no section at z = {height_mm:g} mm")
    return min(farthest_mm(exact, ring) for ring in rings)


PARTS, REFERENCE_PARTS = (1.0, 2.0, 3.0), 5
"""Number of parts on each side into which elements of the coarsest mesh are divided, and the same for the reference."""


def _elements(drive: Drive) -> BenchStage:
    """The largest root stress of the driving gear's teeth by mesh size, beside a finer mesh."""
    from ncgear.strength.elements.mesh import MeshSize, topology_of
    from ncgear.strength.elements.teeth import elements_of

    gear, material = drive.teeth.driving, drive.materials[0]

    def compute(parts: float) -> tuple[Elements, int]:
        size = MeshSize().times(int(parts))
        cells = len(topology_of(size).cells)
        return elements_of(gear, material, size), cells * gear.teeth

    finest, _ = compute(REFERENCE_PARTS)
    largest = finest.tension_mpa.reshape(gear.teeth, -1).max(axis=1)

    def judge(found: tuple[Elements, int]) -> tuple[float, int]:
        stress = found[0].tension_mpa.reshape(gear.teeth, -1).max(axis=1)
        return float(np.abs(stress / largest - 1.0).max()), found[1]

    def finer(parts: float) -> float | None:
        return parts + 1.0 if parts + 1.0 < REFERENCE_PARTS else None

    return BenchStage(
        "parts a side",
        "largest root stress of each tooth of the driving gear",
        f"{REFERENCE_PARTS} parts of each side",
        STRESS_SHARE,
        3.0,
        _tried(list(PARTS), finer, compute, judge, STRESS_SHARE),
        error_unit="of the stress",
        asked_by=None,
    )


def dominating(stages: list[BenchStage]) -> BenchStage | None:
    """The stage that takes longest with its recommended setting; None where nothing is recommended."""
    known = [(stage.recommended.time_s, stage) for stage in stages if stage.recommended is not None]
    return max(known, key=lambda pair: pair[0])[1] if known else None
