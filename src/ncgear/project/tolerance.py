"""From keys to values: the assemblies of a design within its tolerances, and their needed backlash."""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from ncgear.contact.placement import placed
from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.bounds import rounded_up, shown_above
from ncgear.project.drive import Drive
from ncgear.project.tolerance_limits import TURNING, Process, backlash_key, left_of_backlash, limits_of, tolerances_of
from ncgear.solids.helical.sections import said_of_section
from ncgear.teeth.gear import ToothedPair
from ncgear.tolerances.assemblies import Assemblies, AssembliesTask, Lot, lot_of_pairs
from ncgear.tolerances.drawn import DeviationLimits, reachable
from ncgear.tolerances.mesh import Face, LinearMesh, mesh_of, straight_face
from ncgear.tolerances.outlines import exact_of
from ncgear.tolerances.study import (
    Index,
    OnDone,
    PairStudy,
    Share,
    Workers,
    as_designed,
    assemblies_of,
    drawn_at_random,
    drawn_evenly,
    finer_by,
    jammed,
    knocking,
    pair_study,
    reversals,
    sobol_indices_of,
    sobol_tasks,
    surpassed,
)

PER_TOOTH = 10
"""Positions per tooth pitch: with twice as many, errors and plays of single assemblies differ by a few per cent of
their size at most, since teeth take over from each other between positions (tests/test_tolerances.py)."""

LEAST_WITHIN, MOST_WITHIN, SPARE = 0.03, 0.5, 1.5
"""Least and greatest depth to which places of contact are followed, in modules; and their depth as a multiple of the
possible displacement of the flanks."""

CHECKED_POSITIONS = 60
"""Number of positions at which assemblies are checked by their outlines."""

FINE_IN_MODULES = 1e-3, 1e-4
"""Chord tolerances of the outlines of the check, and of their flanks."""

KNOCKING = 2.0, 0.05
"""Play above which teeth knock: as a multiple of the largest designed play, and at least in modules."""


@dataclass(frozen=True)
class NeededBacklash:
    """The backlash with which 99.9 % of all assemblies turn, with 95 % confidence, by its key in the design file.

    ``of_pairs`` are the backlashes that each pair needs by itself; the key applies to all pairs.  ``jammed`` is the
    share of jamming assemblies among fresh assemblies of the gears with this backlash.  It is None where these gears
    cannot be made, for the reason ``refused``.
    """

    key: str
    value: float
    given: float
    of_pairs: tuple[float, ...]
    jammed: Share | None
    refused: str = ""


@dataclass(frozen=True, eq=False)
class Tolerated:
    """The behaviour of a design's assemblies within its tolerances: of the machine, and of each of its pairs.

    A machine jams or knocks where one of its pairs does.  ``process`` is the process whose usual tolerances are
    assumed; None where the file gives tolerances.  ``needed`` is None where too few assemblies are drawn to determine
    it.  ``knock`` is None where the torque of no driven gear ever reverses; ``loaded`` tells whether any load is known:
    if not, the torque counts as reversing at every angle.
    """

    drive: Drive
    tolerances: AssemblyTolerances
    process: Process | None
    seed: int
    assemblies: Assemblies
    nominal: Assemblies
    pairs: tuple[PairStudy, ...]
    jam: Share
    knock: Share | None
    loaded: bool
    indices: dict[str, tuple[Index, ...]]
    index_samples: int
    needed: NeededBacklash | None


def tolerated(drive: Drive, samples: int, seed: int, workers: Workers, on_done: OnDone) -> Tolerated:
    """The behaviour of ``samples`` assemblies, a power of two; calls ``on_done`` with the numbers done and in all.

    Raises WrongInput where a grade does not hold for the gears, and as the drive does.
    """
    given, process = tolerances_of(drive)
    lot = lot_of(drive, given)
    tasks = drawn_evenly(samples, seed, len(lot.pairs))
    nominal = as_designed(lot, tasks[0])
    found = assemblies_of(lot, tasks, workers, on_done)
    index_samples = max(samples // 8, 64)
    indices = sobol_indices_of(lot, assemblies_of(lot, sobol_tasks(lot, index_samples, seed), workers, on_done))
    needed = _needed(drive, given, lot, found, samples, seed, workers, on_done)
    pairs = tuple(_pair(pair, number, given, lot, found, nominal, tasks) for number, pair in enumerate(drive.by_stage))
    turning = [(pair.assemblies, pair.knocking_mm) for pair in pairs if pair.knock is not None]
    return Tolerated(
        drive=drive,
        tolerances=given,
        process=process,
        seed=seed,
        assemblies=found,
        nominal=nominal,
        pairs=pairs,
        jam=jammed(found.pairs),
        knock=knocking(*zip(*turning, strict=True)) if turning else None,
        loaded=_is_loaded(drive),
        indices=indices,
        index_samples=index_samples,
        needed=needed,
    )


def _pair(
    drive: Drive,
    number: int,
    given: AssemblyTolerances,
    lot: Lot,
    found: Assemblies,
    nominal: Assemblies,
    tasks: list[AssembliesTask],
) -> PairStudy:
    """The behaviour of the pair ``number`` of a lot in the assemblies found; its drive is given."""
    pair, module = lot.pairs[number], drive.pitch.size.module_mm
    play_mm = float(nominal.pairs[number].largest_play_mm[0])
    coarse, fine = (share * module for share in FINE_IN_MODULES)
    face, both = face_of(drive, (coarse, fine)), drive.gears.drives == "both_ways"
    return pair_study(
        lot,
        number,
        found.pairs[number],
        nominal.pairs[number],
        tasks,
        stage=drive.stage,
        knocking_mm=given.largest_play_mm or max(KNOCKING[0] * play_mm, KNOCKING[1] * module),
        finer=_mesh(drive, pair.limits, finer_by(pair) * PER_TOOTH),
        exact=exact_of(drive.pitch, face, placed(drive.pitch, PER_TOOTH), pair.mesh, CHECKED_POSITIONS, both_ways=both),
    )


def face_of(drive: Drive, tolerances_mm: tuple[float, float] | None = None) -> Face:
    """The sections of a pair: one for straight teeth, PER_TOOTH for each pitch that helical teeth advance.

    The outlines are the outlines of the design, or have the given chord tolerances: the second tolerance is for flanks.
    Raises NoSuchMechanism, naming the height, where no tooth can stand.
    """
    helix = drive.helix
    chord, flank = tolerances_mm or (drive.chord_tolerance_mm, None)

    def made(advance_mm: float) -> ToothedPair:
        if tolerances_mm is None and advance_mm == 0.0:
            return drive.teeth
        return drive.toothed(chord, flank, advance_mm)

    if helix is None:
        return straight_face(made(0.0), drive.gears.face_width_mm)
    steps = ceil(PER_TOOTH * drive.overlap_ratio)
    above_mm, sections = [], []
    for height in np.linspace(0.0, helix.rise_mm, steps + 1).tolist():
        with said_of_section(height):
            sections.append(made(helix.advance_mm(height)))
        middle = helix.face_width_mm / 2.0
        above_mm.append(middle - height if helix.herringbone else height - middle)
    return Face(tuple(sections), tuple(above_mm), helix.herringbone, drive.overlap_ratio)


def lot_of(drive: Drive, given: AssemblyTolerances) -> Lot:
    """The data from which assemblies are computed; raises as ``Drive.designed_contact`` where teeth are not sound.

    Raises WrongInput for a row of gears that do not all turn alike.
    """
    gears = drive.gears
    if gears.idlers is not None and {gears.lobes.driven, *gears.idlers.lobes} != {gears.lobes.driving}:
        raise WrongInput(
            "given with other lobes than the first gear has; assemblies are computed of rows whose gears turn alike",
            key="gears.idlers",
        )
    peak = drive.check.peak_acceleration_cycle.value
    made = [(*_mesh_and_limits(pair, given), _reversals(pair), pair.pair) for pair in drive.by_stage]
    first = drive.by_stage[0]
    toothed = first.pitch.toothed
    pitches = first.teeth.driving.teeth if toothed is None else toothed.covered_mm / first.rack.pitch_mm
    return lot_of_pairs(drive.machine, made, pitches, abs(peak))


def _mesh_and_limits(drive: Drive, given: AssemblyTolerances) -> tuple[LinearMesh, DeviationLimits]:
    _ = drive.designed_contact
    limits, gears = limits_of(drive, given), drive.gears
    if gears.idlers is not None:
        # An idler needs no keyway: both its meshes turn with one gear.
        first, last = limits.index_rad
        ends = drive.stage == 1, drive.stage == drive.design.stages
        limits = replace(limits, index_rad=(first * ends[0], last * ends[1]))
    return _mesh(drive, limits, PER_TOOTH), limits


def _mesh(drive: Drive, limits: DeviationLimits, per_tooth: int) -> LinearMesh:
    """The linear mesh of one pair with limits of deviations, at ``per_tooth`` positions per tooth pitch."""
    size, module = drive.pitch.center_distance_mm, drive.pitch.size.module_mm
    within = float(np.clip(SPARE * limits.displaced_mm(size), LEAST_WITHIN * module, MOST_WITHIN * module))
    face, both = face_of(drive), drive.gears.drives == "both_ways"
    return reachable(mesh_of(face, placed(drive.pitch, per_tooth), within, both_ways=both), limits)


def _is_loaded(drive: Drive) -> bool:
    return drive.design.masses is not None or drive.design.resistance is not None


def _reversals(drive: Drive) -> IndexArray:
    """The positions of one pair next to which the torque of its driven gear reverses; all where no load is known."""
    placement = placed(drive.pitch, PER_TOOTH)
    if not _is_loaded(drive):
        return np.arange(placement.count)
    return reversals(drive.tooth_load.torque_n_mm(placement.phi1_rad), closed=placement.toothed is None)


def _needed(
    drive: Drive,
    given: AssemblyTolerances,
    lot: Lot,
    found: Assemblies,
    samples: int,
    seed: int,
    workers: Workers,
    on_done: OnDone,
) -> NeededBacklash | None:
    """The needed backlash; play by turning adds the same angle everywhere, so the quantile gives it."""
    gears = drive.gears
    key, decimals = backlash_key(gears), 4 if gears.backlash_deg is not None else 3
    left = [left_of_backlash(pair, own.least_play_rad) for pair, own in zip(drive.by_stage, found.pairs, strict=True)]

    def enough(values: Array) -> float | None:
        lost = surpassed(values, TURNING)
        if lost is None:
            return None
        step, needs = 10.0**-decimals, max(-lost, 0.0)
        # Nobody makes usual teeth to finer steps; tiny teeth get two digits.
        return rounded_up(needs, step) if needs > 10.0 * step else float(shown_above(needs, 2))

    value = enough(np.minimum.reduce(left))
    if value is None:
        return None
    of_pairs = tuple(one for values in left if (one := enough(values)) is not None)
    told = key, value, float(getattr(gears, key)), of_pairs
    changed = gears.model_copy(update={key: value})
    try:
        other = Drive(drive.design.model_copy(update={"gears": changed}))
        fresh = assemblies_of(lot_of(other, given), drawn_at_random(samples, seed, len(lot.pairs)), workers, on_done)
    except (NoSuchMechanism, WrongInput) as error:
        return NeededBacklash(*told, None, str(error))
    return NeededBacklash(*told, jammed(fresh.pairs))
