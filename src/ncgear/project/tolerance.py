"""From keys to values: the assemblies of a design within its tolerances, and what they say of it."""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from ncgear.contact.placement import Placement, placed
from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.bounds import rounded_up, shown_above
from ncgear.project.drive import Drive
from ncgear.project.tolerance_limits import TURNING, backlash_key, left_of_backlash, limits_of, nothing
from ncgear.project.usual_tolerances import Process, tolerances_of
from ncgear.solids.helical.sections import said_of_section
from ncgear.teeth.gear import ToothedPair, toothed_pair
from ncgear.tolerances.assemblies import (
    TOGETHER,
    Assemblies,
    Lot,
    PairAssemblies,
    PairLot,
    Task,
    lot_of_pairs,
)
from ncgear.tolerances.drawn import Limits, reachable
from ncgear.tolerances.mesh import Deviations, Face, Mesh, mesh_of, straight_face
from ncgear.tolerances.outlines import LinearError, exact_of, linear_errors
from ncgear.tolerances.study import (
    BetweenPositions,
    FirstOrder,
    Index,
    OnDone,
    Share,
    Workers,
    assemblies_of,
    between_positions,
    drawn_at_random,
    drawn_evenly,
    enough_samples,
    first_order,
    jammed,
    knocking,
    sobol_indices_of,
    sobol_tasks,
    surpassed,
)

PER_TOOTH = 10
"""Positions per tooth pitch: with twice as many, errors and plays of single assemblies differ by a few per cent of
their size at most, since teeth take over from each other between positions (tests/test_tolerances.py)."""

FINER, MOST_POSITIONS = 8, 20_000
"""How many times as many positions tell what those miss, and how many these are at most; twice as many at least."""

LEAST_WITHIN, MOST_WITHIN, SPARE = 0.03, 0.5, 1.5
"""Places of contact are followed to this depth at least and at most, in modules; and this many times as deep as flanks
may be displaced."""

CHECKED, CHECKED_POSITIONS = 2, 60
"""How many assemblies are checked by their outlines besides the one with the least play, and at how many positions."""

FINE_IN_MODULES = 1e-3, 1e-4
"""Chord tolerances of the outlines of the check, and of their flanks."""

KNOCKING = 2.0, 0.05
"""Play above which teeth knock: times the largest as designed, and in modules at least."""


@dataclass(frozen=True)
class Needed:
    """The backlash with which 99.9 % of all assemblies turn, with 95 % confidence, by its key in the design file.

    ``of_pairs`` are those with which each pair would by itself; the key holds for all of them.  ``jammed`` is the share
    of fresh assemblies of the gears with that backlash that jam.  It is None where these gears cannot be made, for the
    reason ``refused``.
    """

    key: str
    value: float
    given: float
    of_pairs: tuple[float, ...]
    jammed: Share | None
    refused: str = ""


@dataclass(frozen=True, eq=False)
class ToleratedPair:
    """What one pair does in the assemblies of a design.

    ``knock`` is None where the torque of its driven gear never turns round.  ``errors`` are those of the linear mesh
    for its assembly with the least play and for the first ones, ``between`` what the first ones do between positions.
    """

    drive: Drive
    lot: PairLot
    assemblies: PairAssemblies
    nominal: PairAssemblies
    jam: Share
    knock: Share | None
    knocking_mm: float
    first_order: FirstOrder
    errors: tuple[LinearError, ...]
    between: BetweenPositions

    @property
    def flank_limits_mm(self) -> tuple[Array, Array]:
        """Tolerances of the pitch and of the profile of all flanks that touch any, shape (k,) each."""
        flank = np.unique(self.lot.mesh.flank)
        return self.lot.limits.pitch_mm[flank], self.lot.limits.profile_mm[flank]


@dataclass(frozen=True, eq=False)
class Tolerated:
    """What the assemblies of a design within its tolerances do: the machine, and each of its pairs.

    A machine jams or knocks where one of its pairs does.  ``process`` is that whose usual tolerances are assumed; None
    where the file gives some.  ``needed`` is None where fewer assemblies are drawn than tell
    it.  ``knock`` is None where the torque of no driven gear ever turns round; ``loaded`` tells whether any load is
    known: if not, every angle counts as one where it does.
    """

    drive: Drive
    tolerances: AssemblyTolerances
    process: Process | None
    seed: int
    assemblies: Assemblies
    nominal: Assemblies
    pairs: tuple[ToleratedPair, ...]
    jam: Share
    knock: Share | None
    loaded: bool
    indices: dict[str, tuple[Index, ...]]
    index_samples: int
    needed: Needed | None

    @property
    def too_few(self) -> int:
        """The least number of samples that tells the needed backlash."""
        return enough_samples(TURNING)


def tolerated(
    drive: Drive,
    samples: int,
    seed: int,
    workers: Workers,
    on_done: OnDone,
) -> Tolerated:
    """What ``samples`` assemblies do, a power of two; calls ``on_done`` with the numbers done and in all.

    Raises WrongInput where a grade does not hold for the gears, and as the drive does.
    """
    given, process = tolerances_of(drive)
    lot = lot_of(drive, given)
    tasks = drawn_evenly(samples, seed, len(lot.pairs))
    perfect = replace(lot, pairs=tuple(replace(pair, limits=nothing(pair.limits)) for pair in lot.pairs))
    nominal = perfect.assembled([own.one(0) for own in perfect.drawn(tasks[0])])
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
    tasks: list[Task],
) -> ToleratedPair:
    """What the pair ``number`` of a lot, whose drive is given, does in the assemblies found."""
    own, designed, pair = found.pairs[number], nominal.pairs[number], lot.pairs[number]
    knocking_mm = given.largest_play_mm or max(
        KNOCKING[0] * float(designed.largest_play_mm[0]), KNOCKING[1] * drive.pitch.size.module_mm
    )
    return ToleratedPair(
        drive=drive,
        lot=pair,
        assemblies=own,
        nominal=designed,
        jam=jammed([own]),
        knock=knocking([own], [knocking_mm]) if pair.reversals.size else None,
        knocking_mm=knocking_mm,
        first_order=first_order(lot, number, tasks[: max(len(tasks) // 4, 1)]),
        errors=_checked(drive, number, lot, own, tasks),
        between=_between(drive, pair, lot.drawn(tasks[0])[number]),
    )


def _between(drive: Drive, pair: PairLot, of: Deviations) -> BetweenPositions:
    """What some assemblies of a pair do between its positions."""
    finer = int(np.clip(MOST_POSITIONS // pair.mesh.phi1_rad.size, 2, FINER))
    return between_positions(pair, _mesh(drive, pair.limits, finer * PER_TOOTH), of)


def _checked(drive: Drive, number: int, lot: Lot, found: PairAssemblies, tasks: list[Task]) -> tuple[LinearError, ...]:
    """The errors of the linear mesh by the outlines of the assembly with the least play, and of the first ones."""
    assemblies = []
    for chosen in (int(np.argmin(found.least_play_rad)), *range(CHECKED)):
        task, place = divmod(chosen, TOGETHER)
        assemblies.append(lot.drawn(tasks[task])[number].one(place))
    coarse, fine = (share * drive.pitch.size.module_mm for share in FINE_IN_MODULES)
    face, both = face_of(drive, (coarse, fine)), drive.gears.drives == "both_ways"
    mesh = lot.pairs[number].mesh
    exact = exact_of(drive.pitch, face, placement_of(drive), mesh, CHECKED_POSITIONS, both_ways=both)
    return tuple(linear_errors(exact, assemblies))


def face_of(drive: Drive, tolerances_mm: tuple[float, float] | None = None) -> Face:
    """The sections of a pair: straight teeth have one, helical ones PER_TOOTH for each pitch that they advance.

    Their outlines are those of the design, or have the given chord tolerances, the second on flanks.  Raises
    NoSuchMechanism, naming the height, where no tooth can stand.
    """
    form, pitch, helix = drive.tooth_form, drive.pitch, drive.helix
    chord, flank = tolerances_mm or (drive.chord_tolerance_mm, None)

    def made(advance_mm: float) -> ToothedPair:
        if tolerances_mm is None and advance_mm == 0.0:
            return drive.teeth
        return toothed_pair(pitch, form, chord, flank_tolerance_mm=flank, advance_mm=advance_mm)

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


def placement_of(drive: Drive, per_tooth: int = PER_TOOTH) -> Placement:
    """The positions at which assemblies are looked at."""
    return placed(drive.pitch, per_tooth)


def lot_of(drive: Drive, given: AssemblyTolerances) -> Lot:
    """What assemblies of a design are computed from; raises as ``Drive.designed_contact`` where teeth are not sound."""
    peak = drive.check.peak_acceleration_cycle.value
    made = [(*_mesh_and_limits(pair, given), _reversals(pair), pair.pair) for pair in drive.by_stage]
    first = drive.by_stage[0]
    toothed = first.pitch.toothed
    pitches = first.teeth.driving.teeth if toothed is None else toothed.covered_mm / first.rack.pitch_mm
    return lot_of_pairs(drive.machine, made, pitches, abs(peak))


def _mesh_and_limits(drive: Drive, given: AssemblyTolerances) -> tuple[Mesh, Limits]:
    """The linear mesh of one pair, and what it may deviate by."""
    _ = drive.designed_contact
    limits = limits_of(drive, given)
    return _mesh(drive, limits, PER_TOOTH), limits


def _mesh(drive: Drive, limits: Limits, per_tooth: int) -> Mesh:
    """The linear mesh of one pair whose deviations have limits, at so many positions per tooth pitch."""
    size, module = drive.pitch.center_distance_mm, drive.pitch.size.module_mm
    within = float(np.clip(SPARE * limits.displaced_mm(size), LEAST_WITHIN * module, MOST_WITHIN * module))
    face, both = face_of(drive), drive.gears.drives == "both_ways"
    return reachable(mesh_of(face, placement_of(drive, per_tooth), within, both_ways=both), limits)


def _is_loaded(drive: Drive) -> bool:
    return drive.design.masses is not None or drive.design.resistance is not None


def _reversals(drive: Drive) -> IndexArray:
    """The positions of one pair beside which the torque of its driven gear turns round; all where no load is known.

    Where gears turn to and fro it turns round at both ends of the range, since loads act against the motion.
    """
    placement = placement_of(drive)
    if not _is_loaded(drive):
        return np.arange(placement.count)
    sign = _sides(drive.tooth_load.torque_n_mm(placement.phi1_rad))
    if placement.toothed is not None:
        turning = np.flatnonzero(sign[1:] * sign[:-1] < 0.0)
        return np.unique(np.concatenate([[0], turning, turning + 1, [placement.count - 1]]))
    turning = np.flatnonzero(sign * np.roll(sign, -1) < 0.0)
    return np.unique(np.concatenate([turning, (turning + 1) % placement.count]))


NO_TORQUE = 1e-9
"""Share of the greatest torque that counts as none: a million rounding errors of it."""


def _sides(torque_n_mm: Array) -> Array:
    """The sign of a torque at positions around a turn, shape (n,); where it counts as none, that of the one before."""
    sign = np.sign(np.where(np.abs(torque_n_mm) > NO_TORQUE * np.abs(torque_n_mm).max(), torque_n_mm, 0.0))
    known = np.flatnonzero(sign)
    if not known.size:
        return sign
    kept: Array = sign[known[np.searchsorted(known, np.arange(sign.size), side="right") - 1]]
    return kept


def _needed(
    drive: Drive,
    given: AssemblyTolerances,
    lot: Lot,
    found: Assemblies,
    samples: int,
    seed: int,
    workers: Workers,
    on_done: OnDone,
) -> Needed | None:
    """The backlash that is needed; play by turning adds the same angle everywhere, so that the quantile tells it."""
    gears = drive.gears
    key, decimals = backlash_key(gears), 4 if gears.backlash_deg is not None else 3
    left = [left_of_backlash(pair, own.least_play_rad) for pair, own in zip(drive.by_stage, found.pairs, strict=True)]

    def enough(values: Array) -> float | None:
        lost = surpassed(values, TURNING)
        if lost is None:
            return None
        step, needs = 10.0**-decimals, max(-lost, 0.0)
        # Nobody makes usual teeth to finer steps; tiny ones have two digits.
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
        return Needed(*told, None, str(error))
    return Needed(*told, jammed(fresh.pairs))
