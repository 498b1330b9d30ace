"""The overview of a sweep, gathered part by part: counts, refusals, best designs, Pareto set, effects of keys.

Its size grows with the Pareto set alone, not with the number of designs.  The order in which parts are computed does
not matter, since they are gathered in the order of their numbers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ncgear.design.space import Listed, Ranged, Space
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.screening.designs import Designs, joined
from ncgear.screening.wanted import DIGITS, Wanted, non_dominated, rounded_to

BEST = 5
"""Number of best designs that are kept for each objective."""

ALIKE = 5
"""Digits of an objective, as many as are shown; the next objective decides between designs with the same digits."""

DRAWN = 4000
"""Number of randomly drawn designs that are kept for pictures and rank correlations."""

BINS = 10
"""Number of equal parts of a key's range, unless the key has fewer values."""


@dataclass(frozen=True)
class Refusal:
    """A problem that ``count`` designs share apart from its numbers; the first of them, and its verdict."""

    count: int
    values: dict[str, float]
    verdict: str


@dataclass(frozen=True, eq=False)
class Effects:
    """Designs by the values of each key: shape (keys, bins) each, and (keys, bins, objectives) for the sums.

    ``edges`` has shape (keys, bins + 1), and ``places`` the middles, or the values themselves where a key has few; bins
    that a key does not need stay empty.  ``sums`` and ``squares`` are of the objectives minus ``origin``, over the kept
    designs.
    """

    edges: Array
    places: Array
    designs: Array
    made: Array
    kept: Array
    sums: Array
    squares: Array
    origin: Array | None = None

    @property
    def refused_share(self) -> Array:
        """The share of designs that cannot be made, shape (keys, bins); NaN for bins without designs."""
        with np.errstate(invalid="ignore"):
            share: Array = 1.0 - self.made / self.designs
        return share

    @property
    def means(self) -> Array:
        """The mean of each objective over the kept designs, shape (keys, bins, objectives)."""
        assert self.origin is not None
        with np.errstate(invalid="ignore"):
            means: Array = self.origin + self.sums / self.kept[..., None]
        return means

    @property
    def explained(self) -> Array:
        """The share of the variance of each objective that each key explains alone, shape (keys, objectives).

        It is the correlation ratio: the variance of the means in the bins over the whole variance, minus its
        expectation for keys without effect, ``(bins - 1) / (n - 1)``.  For independently sampled keys it estimates
        Sobol's index of first order.  NaN where an objective does not vary.
        """
        count = self.kept.sum(axis=1)[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = self.sums.sum(axis=1) / count
            whole = self.squares.sum(axis=1) / count - mean**2
            of_bins = np.nansum(self.sums**2 / self.kept[..., None], axis=1) / count - mean**2
            chance = ((self.kept > 0.0).sum(axis=1)[:, None] - 1.0) / (count - 1.0)
            scale = np.maximum(np.abs(mean), np.abs(self.origin if self.origin is not None else 0.0))
            varies = whole > (1e-9 * scale) ** 2
            share = np.where(varies, (of_bins / whole - chance) / (1.0 - chance), np.nan)
        return np.clip(share, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Overview:
    """The results of the parts so far; ``best`` has the best designs of each objective.

    ``fronts`` are Pareto sets of successive parts, each more than twice as large as the next, so that large sets are
    seldom joined.  ``drawn`` are randomly drawn kept designs, and ``lots`` their random numbers, shape (n,).
    """

    space: Space
    wanted: Wanted
    effects: Effects
    count: int = 0
    made: int = 0
    kept: int = 0
    refusals: tuple[tuple[str, Refusal], ...] = ()
    best: tuple[Designs, ...] = ()
    fronts: tuple[Designs, ...] = ()
    drawn: Designs | None = None
    lots: Array | None = None

    @property
    def frequent_refusals(self) -> list[Refusal]:
        """The refusals, the most frequent first."""
        return sorted((refusal for _, refusal in self.refusals), key=lambda refusal: -refusal.count)

    @cached_property
    def front(self) -> Designs | None:
        """The Pareto set."""
        return self._not_dominated(self.fronts) if self.fronts else None

    def _not_dominated(self, sets: Sequence[Designs]) -> Designs:
        designs = joined(sets)
        return designs.at(non_dominated(self.wanted.costs(designs)))

    def _fronts(self, kept: Designs) -> tuple[Designs, ...]:
        fronts = [*self.fronts, self._not_dominated([kept])]
        while len(fronts) > 1 and len(fronts[-2].numbers) <= 2 * len(fronts[-1].numbers):
            fronts[-2:] = [self._not_dominated(fronts[-2:])]
        return tuple(fronts)

    def with_part(self, part: Designs) -> Overview:
        """The same with the designs of a further part."""
        made, keeps = part.made, self.wanted.kept(part)
        found = replace(
            self,
            count=self.count + len(part.numbers),
            made=self.made + int(made.sum()),
            kept=self.kept + int(keeps.sum()),
            refusals=_refusals(dict(self.refusals), part.at(~made)),
        )
        kept = part.at(keeps)
        found = replace(found, effects=_effects(self.effects, self.wanted, part, keeps))
        if not len(kept.numbers):
            return found
        lots = np.random.default_rng([self.space.seed, int(part.numbers[0])]).random(len(part.numbers))[keeps]
        drawn = kept if self.drawn is None else joined([self.drawn, kept])
        lots = lots if self.lots is None else np.concatenate([self.lots, lots])
        first = np.sort(np.argsort(lots, kind="stable")[:DRAWN])
        before = self.best or (kept.at(slice(0)),) * len(self.wanted.objectives)
        return replace(
            found,
            best=tuple(_best(joined([part, kept]), self.wanted, place) for place, part in enumerate(before)),
            fronts=self._fronts(kept),
            drawn=drawn.at(first),
            lots=lots[first],
        )


def no_overview(space: Space, wanted: Wanted) -> Overview:
    """The overview of no part yet."""
    keys, objectives = len(space.varied), len(wanted.objectives)
    edges, places = (np.array(rows) for rows in zip(*map(_bins, space.varied), strict=True))
    none, sums = np.zeros((keys, BINS)), np.zeros((keys, BINS, objectives))
    return Overview(space, wanted, Effects(edges, places, none, none, none, sums, sums))


def _bins(varied: Listed | Ranged) -> tuple[Array, Array]:
    """The edges of a key's bins and their places: about its values where they are few, else parts of its range."""
    if isinstance(varied, Listed) and len(varied.values) <= BINS:
        values, left = np.sort(varied.values), BINS - len(varied.values)
        middles = 0.5 * (values[1:] + values[:-1])
        edges = np.concatenate([values[:1], middles, np.full(left + 1, np.inf)])
        return edges, np.concatenate([values, np.full(left, np.nan)])
    low, high = (min(varied.values), max(varied.values)) if isinstance(varied, Listed) else (varied.low, varied.high)
    edges = np.linspace(low, high, BINS + 1)
    return edges, 0.5 * (edges[1:] + edges[:-1])


def _effects(effects: Effects, wanted: Wanted, part: Designs, keeps: Mask) -> Effects:
    columns = [part.column(objective.name) for objective in wanted.objectives]
    objectives = np.array(columns).reshape(len(columns), len(part.numbers)).T
    origin = effects.origin
    if origin is None and keeps.any():
        origin = objectives[keeps][0]
    known = np.where(keeps[:, None], objectives - (0.0 if origin is None else origin), 0.0)
    rows = []
    for edges, values in zip(effects.edges, part.values.values(), strict=True):
        bins = np.minimum(np.searchsorted(edges[1:], values, side="right"), BINS - 1)
        weights = [np.ones(len(values)), part.made, keeps, *known.T, *(known**2).T]
        rows.append([np.bincount(bins, weight, BINS) for weight in weights])
    found, count = np.array(rows), len(wanted.objectives)
    designs, made, kept = found[:, 0], found[:, 1], found[:, 2]
    sums, squares = found[:, 3 : 3 + count].transpose(0, 2, 1), found[:, 3 + count :].transpose(0, 2, 1)
    return replace(
        effects,
        designs=effects.designs + designs,
        made=effects.made + made,
        kept=effects.kept + kept,
        sums=effects.sums + sums,
        squares=effects.squares + squares,
        origin=origin,
    )


def _best(designs: Designs, wanted: Wanted, place: int) -> Designs:
    """The best designs by one objective; the others decide between designs with the same shown digits."""
    costs = wanted.costs(designs)
    alike = rounded_to(costs[:, place], ALIKE)
    others = [costs[:, other] for other in range(costs.shape[1]) if other != place]
    order: IndexArray = np.lexsort((designs.numbers, *others[::-1], alike))
    return designs.at(order[:BEST])


NUMBERS = b"0123456789.-+e"
"""The characters of which numbers consist; without them, verdicts are the same where only their numbers differ."""

ANGLE = b" rad ( dg)"
"""What is left of an angle, which is told in rad and in degrees, or as 0 alone."""


def _refusals(known: dict[str, Refusal], refused: Designs) -> tuple[tuple[str, Refusal], ...]:
    verdicts = "\0".join(refused.verdicts.tolist()).encode()
    problems = verdicts.translate(None, NUMBERS).replace(ANGLE, b"").decode().split("\0")[: len(refused.numbers)]
    for problem, count in Counter(problems).items():
        refusal = known.get(problem)
        if refusal is None:
            row = problems.index(problem)
            values = {key: float(column[row]) for key, column in refused.values.items()}
            known[problem] = Refusal(count, values, str(refused.verdicts[row]))
        else:
            known[problem] = replace(refusal, count=refusal.count + count)
    return tuple(known.items())


def rank_correlations(overview: Overview) -> Array:
    """Spearman's rank correlation of each key with each objective, shape (keys, objectives), of the designs drawn.

    NaN where a key or an objective does not vary.
    """
    drawn, objectives = overview.drawn, overview.wanted.objectives
    keys = overview.space.keys
    if drawn is None or len(drawn.numbers) < 3:
        return np.full((len(keys), len(objectives)), np.nan)
    values = np.array([_ranks(drawn.values[key]) for key in keys])
    figures = np.array([_ranks(rounded_to(drawn.column(objective.name), DIGITS)) for objective in objectives])
    values, figures = (rows - rows.mean(axis=1, keepdims=True) for rows in (values, figures))
    size = np.sqrt((values**2).sum(axis=1)[:, None] * (figures**2).sum(axis=1)[None])
    with np.errstate(invalid="ignore"):
        found: Array = values @ figures.T / np.where(size > 0.0, size, np.nan)
    return found


def _ranks(values: Array) -> Array:
    """Ranks, equal values sharing the mean of theirs."""
    _, group, counts = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(counts) - 0.5 * (counts - 1.0))[group]
