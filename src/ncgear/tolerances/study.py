"""Many assemblies of a machine: their figures and chances, the tolerances that matter, and the needed play."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from math import sqrt

import numpy as np

from ncgear.contact.placement import BACK, PUSHING
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.tolerances.assemblies import (
    TOGETHER,
    Assemblies,
    AssembliesTask,
    Lot,
    PairAssemblies,
    PairLot,
    computed,
    of_pair,
    sobol_points,
    tasks_of,
)
from ncgear.tolerances.drawn import COUNT, DeviationSource, spread
from ncgear.tolerances.mesh import Deviations, LinearMesh
from ncgear.tolerances.outlines import Exact, LinearError, linear_errors
from ncgear.workers import finished

JAMMED_RAD = 1e-9
"""Overlap of the driven gear's angle above which teeth jam, and spread of an angle that counts: rounding is less."""

ALONE = 3e9
"""Most places of contact times assemblies that this process computes alone, unless processes are asked for.  They take
some ten seconds, and other processes would hardly have begun by then."""

OnDone = Callable[[int, int], None]


@dataclass(frozen=True)
class Workers:
    """Scheduler and processes for tasks, as ``ncgear.workers.finished`` takes them."""

    scheduler: str | None = None
    processes: int | None = None


def assemblies_of(
    lot: Lot, tasks: list[AssembliesTask], workers: Workers, on_done: OnDone = lambda done, total: None
) -> Assemblies:
    """The assemblies of tasks, in the order of tasks; the workers do not change them."""
    total = sum(task.pairs.shape[1] for task in tasks)
    alone = workers.scheduler is None and lot.places * total < ALONE
    processes = workers.processes or (1 if alone else None)
    found: dict[int, Assemblies] = {}
    done = 0
    for task, made in finished(partial(computed, lot), tasks, workers.scheduler, processes):
        found[task.number] = made
        done += made.count
        on_done(done, total)
    return Assemblies.joined([found[task.number] for task in tasks])


def drawn_evenly(count: int, seed: int, pairs: int = 1) -> list[AssembliesTask]:
    """Tasks of assemblies whose pairs are drawn from scrambled points of Sobol; ``count`` is a power of two."""
    return tasks_of(sobol_points(count, seed, pairs * COUNT), seed, 0)


def drawn_at_random(count: int, seed: int, pairs: int = 1) -> list[AssembliesTask]:
    """Tasks of assemblies whose pairs and teeth are drawn at random."""
    return tasks_of(np.random.default_rng([seed, 1]).random((pairs * COUNT, count)), seed, 1)


def as_designed(lot: Lot, task: AssembliesTask) -> Assemblies:
    """The assembly without deviations; any task of the lot gives the shapes."""
    perfect = replace(lot, pairs=tuple(replace(pair, limits=pair.limits.none) for pair in lot.pairs))
    return perfect.assembled([own.one(0) for own in perfect.drawn(task)])


@dataclass(frozen=True)
class Share:
    """A share of the drawn assemblies, and the range of the share of all assemblies with 95 % confidence (Wilson)."""

    value: float
    least: float
    largest: float


def share_of(count: int, total: int) -> Share:
    """The share of ``count`` of ``total`` drawn assemblies."""
    from scipy.stats import binomtest

    interval = binomtest(count, total).proportion_ci(0.95, method="wilson")
    return Share(count / total, float(interval.low), float(interval.high))


def jammed(pairs: Sequence[PairAssemblies]) -> Share:
    """The share with a pair that jams: somewhere in the cycle both flanks of a tooth touch and are pressed."""
    jam = np.logical_or.reduce([pair.least_play_rad < -JAMMED_RAD for pair in pairs])
    return share_of(int(np.count_nonzero(jam)), jam.size)


def knocking(pairs: Sequence[PairAssemblies], largest_mm: Sequence[float]) -> Share:
    """The share with a pair that knocks: its play is larger than ``largest_mm`` where its torque turns."""
    knock = np.logical_or.reduce(
        [pair.reversal_play_mm > largest for pair, largest in zip(pairs, largest_mm, strict=True)]
    )
    return share_of(int(np.count_nonzero(knock)), knock.size)


CONFIDENCE = 0.95
NORMAL_95 = 1.96
"""Standard deviations to either side of a normal distribution's mean with 95 % of it between them."""


def surpassed(values: Array, share: float) -> float | None:
    """A value that ``share`` of all assemblies surpass, with 95 % confidence; None where too few are drawn.

    It is the greatest of the n values that lies below the quantile with this confidence (Wilks 1941).
    """
    from scipy.stats import binom

    numbers = np.arange(1, values.size + 1)
    sure = binom.sf(numbers - 1, values.size, 1.0 - share) >= CONFIDENCE
    return float(np.sort(values)[np.count_nonzero(sure) - 1]) if sure[0] else None


def enough_samples(share: float) -> int:
    """The least number of drawn assemblies with which ``surpassed`` has a value."""
    return int(np.ceil(np.log(1.0 - CONFIDENCE) / np.log(share)))


INDEXED = "least_play_mm", "transmission_error_mm", "motion_error", "peak_acceleration"
"""The figures whose indices of Sobol are computed."""


@dataclass(frozen=True)
class Index:
    """Indices of Sobol of a source: the share of the variance that it causes alone, and together with other sources.

    ``error`` is half the width of the 95 % range of ``total``, whose estimator is a mean (Jansen 1999).
    """

    source: DeviationSource
    first: float
    total: float
    error: float


def sobol_tasks(lot: Lot, count: int, seed: int) -> list[AssembliesTask]:
    """Saltelli's tasks with a source's numbers exchanged: A, B, a set per source, of ``count``, a power of two."""
    half = COUNT * len(lot.pairs)
    points = sobol_points(count, seed, 2 * half)
    own, others = tasks_of(points[:half], seed, 2), tasks_of(points[half:], seed, 3)
    swapped = [
        replace(task, source=source, other=other)
        for source in lot.sources
        for task, other in zip(own, others, strict=True)
    ]
    return [replace(task, number=number) for number, task in enumerate(own + others + swapped)]


def sobol_indices_of(lot: Lot, found: Assemblies) -> dict[str, tuple[Index, ...]]:
    """The indices of INDEXED from ``sobol_tasks``, the greatest first; none for figures that do not vary."""
    from scipy.stats import sobol_indices

    sources, follower = lot.sources, lot.follower
    count = found.count // (len(sources) + 2)
    turned = dict.fromkeys(INDEXED[:2], follower.radius_mm) | {"motion_error": follower.slope}
    indices: dict[str, tuple[Index, ...]] = {}
    for name in INDEXED:
        values = getattr(found, name).reshape(len(sources) + 2, 1, count)
        if np.ptp(values) <= JAMMED_RAD * float(np.abs(turned.get(name, values)).max()):
            continue
        if len(sources) == 1:
            indices[name] = (Index(sources[0], 1.0, 1.0, 0.0),)
            continue
        result = sobol_indices(func={"f_A": values[0], "f_B": values[1], "f_AB": values[2:]}, n=count)
        squared = (values[0] - values[2:])[:, 0] ** 2 / (2.0 * values[:2].var())
        error = NORMAL_95 * squared.std(axis=1) / sqrt(count)
        rows = zip(sources, np.ravel(result.first_order), np.ravel(result.total_order), error, strict=True)
        own = [Index(source, *map(float, numbers)) for source, *numbers in rows]
        indices[name] = tuple(sorted(own, key=lambda index: -index.total))
    return indices


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """Standard deviations of the play to first order, and drawn, in mm along the normal, shape (p,) each.

    There is a play at each position.  ``by_source`` is each source's part of ``linear_mm``.
    """

    linear_mm: Array
    drawn_mm: Array
    by_source: dict[str, Array]

    @property
    def difference(self) -> float:
        """Largest difference of both, as a share of the largest drawn deviation; 0 where no play varies."""
        largest = float(self.drawn_mm.max())
        return float(np.abs(self.linear_mm - self.drawn_mm).max() / largest) if largest else 0.0


def first_order(lot: Lot, number: int, tasks: Iterable[AssembliesTask]) -> FirstOrder:
    """The spread of the play of the pair ``number`` of the lot: to first order, and of drawn assemblies.

    The first order takes the root of the sum of squares.  It knows one place of contact at each position and side,
    where the pair without deviations touches, and no tilt.
    """
    mesh, known = lot.pairs[number].mesh, spread(lot.pairs[number].limits)
    arm = mesh.arm_mm[BACK]
    rows = mesh.foremost
    variance: dict[str, Array] = {}
    rates = (mesh.rigid[rows[PUSHING]] + mesh.rigid[rows[BACK]]) @ known.rigid
    for source, rate in zip(known.sources, rates.T, strict=True):
        variance[source] = variance.get(source, 0.0) + rate**2
    for source, shares, sizes in (
        ("pitch", mesh.pitch_share, known.pitch_mm),
        ("profile", mesh.profile_share, known.profile_mm),
    ):
        variance[source] = sum(
            (shares[gear][row] * sizes[mesh.flank[gear][row]]) ** 2 for gear in (0, 1) for row in rows
        )
    plays = np.concatenate([-mesh.leads(lot.drawn(task)[number]).sum(axis=0) for task in tasks], axis=1)
    by_source = {source: np.sqrt(variance_of) * arm for source, variance_of in variance.items()}
    spread_rad = np.where(np.ptp(plays, axis=1) > JAMMED_RAD, plays.std(axis=1), 0.0)
    return FirstOrder(np.sqrt(sum(variance.values())) * arm, spread_rad * arm, by_source)


@dataclass(frozen=True)
class BetweenPositions:
    """Excess of figures between positions over the figures at them, in mm, to about a tenth."""

    assemblies: int
    least_play_mm: float
    largest_play_mm: float
    transmission_error_mm: float


def between_positions(pair: PairLot, finer: LinearMesh, of: Deviations) -> BetweenPositions:
    """The figures that the positions of a pair miss; ``finer`` has the same positions and many more between them."""
    own = of_pair(pair, of, pair.mesh.leads(of))
    found = of_pair(replace(pair, mesh=finer, reversals=pair.reversals[:0]), of, finer.leads(of))

    def beyond(name: str, sign: float) -> float:
        return float(np.max(sign * (getattr(found, name) - getattr(own, name)), initial=0.0)) + 0.0

    signs = {"least_play_mm": -1.0, "largest_play_mm": 1.0, "transmission_error_mm": 1.0}
    return BetweenPositions(own.least_arc.size, **{name: beyond(name, sign) for name, sign in signs.items()})


NO_TORQUE = 1e-9
"""Share of the greatest torque that counts as zero: a million rounding errors of the greatest torque."""


def reversals(torque_n_mm: Array, *, closed: bool) -> IndexArray:
    """Positions beside which a torque changes its sense, in a cycle or, not ``closed``, a range with both its ends."""
    sign = signs_of(torque_n_mm)
    count = sign.size
    turning = np.flatnonzero(sign * np.roll(sign, -1) < 0.0)
    if closed:
        return np.unique(np.concatenate([turning, (turning + 1) % count]))
    turning = turning[turning < count - 1]
    return np.unique(np.concatenate([[0], turning, turning + 1, [count - 1]]))


def signs_of(torque_n_mm: Array) -> Array:
    """The sign of a torque at positions around a turn, shape (n,); without torque the sign of the position before."""
    sign = np.sign(np.where(np.abs(torque_n_mm) > NO_TORQUE * np.abs(torque_n_mm).max(), torque_n_mm, 0.0))
    known = np.flatnonzero(sign)
    if not known.size:
        return sign
    return sign[known[np.searchsorted(known, np.arange(sign.size), side="right") - 1]]


FINER, MOST_POSITIONS = 8, 20_000
"""Largest factor of positions of a finer mesh (the least is 2), and its largest number of positions."""

CHECKED = 2
"""Number of assemblies that are checked by outlines besides the assembly with the least play."""


@dataclass(frozen=True, eq=False)
class PairStudy:
    """Figures of one pair in many assemblies, and errors of the linear mesh; ``stage`` is None for a single pair.

    ``knock`` is None where the torque of the driven gear never turns round.  ``errors`` are the errors of the linear
    mesh for the assembly with the least play and for the first assemblies.  ``between`` has the figures of these
    between positions.
    """

    stage: int | None
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
        """Tolerances of the pitch and of the profile of all flanks that touch others, shape (k,) each."""
        flank = np.unique(self.lot.mesh.flank)
        return self.lot.limits.pitch_mm[flank], self.lot.limits.profile_mm[flank]


def finer_by(pair: PairLot) -> int:
    """Fineness factor of the mesh that shows the figures between a pair's positions."""
    return int(np.clip(MOST_POSITIONS // pair.mesh.phi1_rad.size, 2, FINER))


def pair_study(
    lot: Lot,
    number: int,
    found: PairAssemblies,
    nominal: PairAssemblies,
    tasks: Sequence[AssembliesTask],
    *,
    stage: int | None,
    knocking_mm: float,
    finer: LinearMesh,
    exact: Exact,
) -> PairStudy:
    """The study of pair ``number`` in found assemblies of tasks; ``finer`` has more positions, ``exact`` outlines."""
    pair = lot.pairs[number]

    def one_of(assembly: int) -> Deviations:
        task, place = divmod(assembly, TOGETHER)
        return lot.drawn(tasks[task])[number].one(place)

    return PairStudy(
        stage=stage,
        lot=pair,
        assemblies=found,
        nominal=nominal,
        jam=jammed([found]),
        knock=knocking([found], [knocking_mm]) if pair.reversals.size else None,
        knocking_mm=knocking_mm,
        first_order=first_order(lot, number, tasks[: max(len(tasks) // 4, 1)]),
        errors=tuple(linear_errors(exact, [*map(one_of, (int(np.argmin(found.least_play_rad)), *range(CHECKED)))])),
        between=between_positions(pair, finer, lot.drawn(tasks[0])[number]),
    )
