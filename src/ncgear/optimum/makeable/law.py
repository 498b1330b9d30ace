"""Where searches for a makeable law begin: at the fastest motion that the limits allow, and at random.

A makeable law: the best harmonics under all limits, which then hold between the places of the programme, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.profile import fastest_motion
from ncgear.optimum.makeable.kept import NO_EXCESS, Easing, Kept, Search, easings, easings_together, kept, searched
from ncgear.optimum.makeable.levels import Level
from ncgear.optimum.makeable.programme import Solution
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task
from ncgear.ratio.laws.harmonic import LogSeries, harmonic_law, staged_law
from ncgear.ratio.transmission import Lobes, Train, single

SPREAD = 0.3
"""Standard deviation of the first harmonics of a start at random; higher ones fall off with their number."""

RESAMPLED = 16
"""Places per harmonic at which the fastest motion is read."""


def rough_start(task: Task, wishes: Wishes, peak_acceleration_mm_s2: float) -> Array:
    """Coefficients cos 1.., sin 1.. of the fastest motion under a peak of acceleration, its corners smoothed.

    Its ratio jumps; each harmonic is taken with Lanczos' factor, which takes the overshoot from jumps.
    """
    limits = replace(wishes.limits, peak_acceleration_mm_s2=peak_acceleration_mm_s2)
    motion = fastest_motion(task, limits)
    count = RESAMPLED * wishes.harmonics
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    lowest, highest = np.log(limits.ratio_min), np.log(limits.ratio_max)
    logarithm = np.clip(-np.log(np.interp(angle, motion.crank_angle_rad, motion.slope)), lowest, highest)
    spectrum = np.fft.rfft(logarithm)[1 : wishes.harmonics + 1] * (2.0 / count)
    smoothed = spectrum * np.sinc(np.arange(1, wishes.harmonics + 1) / (wishes.harmonics + 1))
    return np.concatenate([smoothed.real, -smoothed.imag])


def random_starts(harmonics: int, count: int, seed: int) -> Sequence[Array]:
    """So many starts; the same seed gives the same."""
    random = np.random.default_rng(seed)
    falling = SPREAD / np.tile(np.arange(1.0, harmonics + 1.0), 2)
    return [random.normal(size=2 * harmonics) * falling for _ in range(count)]


BETWEEN = (
    "a law was found that keeps all limits at the places of the search, and none that keeps them everywhere; limits a "
    "little wider can be kept"
)


@dataclass(frozen=True, eq=False)
class MakeableLaw:
    """Harmonics of ln i12 over the driven angle, shape (harmonics,) each, and the levels reached on the finer grid.

    Of two stages, ``second`` are those of the second one's ratio.
    """

    cosine: Array
    sine: Array
    levels: Sequence[Level]
    reached: Array
    second: LogSeries | None = None

    def train(self, lobes: Lobes) -> Train:
        """The law as gears follow it."""
        if self.second is None:
            return single(harmonic_law(self.cosine, self.sine, lobes))
        return staged_law(self.cosine, self.sine, self.second.cosine, self.second.sine).train

    @property
    def goal(self) -> float:
        """What was to be least, in units of the levels."""
        return float(sum(level.weight * value for level, value in zip(self.levels, self.reached, strict=True)))


def makeable_law(task: Task, wishes: Wishes, starts: Sequence[Array]) -> MakeableLaw:
    """The best law found from starts (coefficients cos 1.., sin 1.., shape (2 harmonics,) each).

    A local optimum, with every limit kept on a grid twenty times finer than the programme's.  Two stages begin by
    halves of the ratio, and end so that the larger of their pressure angles is least.  Raises NoSuchMechanism with
    the limits that cannot be kept together, and for each the nearest value that can be had with the others.
    """
    search = searched(task, wishes)
    # Every pair but the first has an even share of ln i12 at the start
    shared = [np.concatenate([start / (1 + pair) for pair in range(wishes.pairs)]) for start in starts]
    found = [law for start in shared if (law := _kept(search, start)) is not None]
    return min(found, key=lambda law: law.goal) if found else _kept_at_last(search, task, wishes, shared[0])


def shared_law(task: Task, wishes: Wishes, cosine: Array, sine: Array) -> MakeableLaw:
    """A law as it stands, shared over two pairs so that the larger pressure angle is least.

    Coefficients of ln i12 have shape (wishes.harmonics,), and of the wishes only those count that concern each pair.
    Raises NoSuchMechanism where no share keeps them.
    """
    alone = replace(wishes, limits=replace(wishes.limits, working_rad=None))
    search = searched(task, alone)
    named = [(level.of_pairs, level.wish == "pressure_angle_deg") for level in search.programme.levels]
    of_pairs, angle = np.array(named).T
    whole = np.concatenate([cosine, sine])
    split = replace(
        search,
        programme=replace(search.programme, held=whole),
        caps=np.where(of_pairs, search.caps, np.inf),
        weights=angle.astype(float),
    )
    start = np.concatenate([whole, whole / 2.0])
    return _kept(split, start) or _kept_at_last(split, task, alone, start)


def _kept_at_last(search: Search, task: Task, wishes: Wishes, start: Array) -> MakeableLaw:
    """The law from the one that comes nearest to keeping all limits; raises NoSuchMechanism where there is none."""
    near = search.programme.nearest(search.caps, np.zeros(search.caps.size), 1.0, start)
    if near is None:
        raise NoSuchMechanism("no law was found, not even one that oversteps the limits", key="optimize.limits")
    if near.excess <= NO_EXCESS:
        law = _kept(search, near.coefficients)
        if law is None:
            raise NoSuchMechanism(BETWEEN, key="optimize.limits")
        return law
    raise _cannot_be(search, near, _free_working(task, wishes, near))


def _kept(search: Search, start: Array) -> MakeableLaw | None:
    """The law from one start; None where none is found."""
    found = kept(search, start)
    return None if found is None else _law(search, found)


def _law(search: Search, found: Kept) -> MakeableLaw:
    cosine, sine, *second = found.coefficients.reshape(2 * search.programme.pairs, -1)
    return MakeableLaw(cosine, sine, search.programme.levels, found.reached, LogSeries(*second) if second else None)


def _cannot_be(search: Search, near: Solution, others: Sequence[Easing]) -> NoSuchMechanism:
    """The refusal: what each limit would have to be with all the others, or all of them together."""
    given = search.programme, search.caps, near, search.reached
    said, found = "no law was found that keeps all limits; one of these is enough", [*easings(*given), *others]
    if not found:
        said, found = (
            said.replace("one of these is enough", "all of these are enough together"),
            list(easings_together(*given)),
        )
    return NoSuchMechanism(
        f"{said}: {', '.join(map(str, found)) or 'none known'}",
        key=f"optimize.limits.{found[0].wish}" if found else "optimize.limits",
    )


def _free_working(task: Task, wishes: Wishes, near: Solution) -> list[Easing]:
    """Whether a working stroke of another driving angle would be enough."""
    if wishes.limits.working_rad is None:
        return []
    search = searched(task, replace(wishes, limits=replace(wishes.limits, working_rad=None)))
    found = search.programme.nearest(search.caps, np.zeros(search.caps.size), 1.0, near.coefficients)
    kept = found is not None and found.excess <= NO_EXCESS
    return [Easing("working_angle_rad", "a working stroke of another driving angle")] if kept else []
