"""A makeable law: the best spline of ln i12 under all limits, or the limits that exclude each other.

Where no law keeps all limits, the nearest law shows which of them press; for each of these, a search finds the nearest
value with which all others can be kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from math import ceil, pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.makeable.driving_ranges import best_held, held_as, ranges
from ncgear.optimum.makeable.levels import OF_LIMITS, WishLevel
from ncgear.optimum.makeable.programme import Solution
from ncgear.optimum.makeable.search import Kept, LawSearch, cost, goal_weights, kept, searched
from ncgear.optimum.makeable.wishes import CONVEX, Wishes
from ncgear.optimum.offers import Refused
from ncgear.optimum.task import Task
from ncgear.ratio.laws.spline import spline_ratio_law, spline_ratio_staged
from ncgear.ratio.transmission import Lobes, PairsInSeries, single
from ncgear.wishes.wish import Offer

NO_EXCESS = 1e-6
"""Excess over caps that counts as none: far below the excess between the places of the programme."""

PRESSING = 1e-4
"""Share of a cap in the excess below which the cap counts as not pressing."""

DEARER = 10.0
"""Ratio of the cost of an excess over the other caps to its gain: an excess remains only where every law has one."""

CHEAP = 0.1
"""Share of the excess below which a higher price may remove the rest."""

TOGETHER = 1e3
"""Price of an excess over all caps where several levels are free, in units of the order of 1."""

ANY_DENT = 10.0
"""Depth of a dent, in units of the level of convexity, that no law of any use has."""


CLEAR = 1e-2
"""Excess of a law of few knots that more knots do not do away with: they take a hundredth of it or so."""

FEW_KNOTS = (90, 45)
"""Most knots of laws in the search where certainly no law keeps all limits; the second number where the first fails."""

EVEN = Motion(np.array([0.0, pi]), np.ones(2))
"""A crank that turns evenly."""

NONE = "no law was found that keeps all limits"

BETWEEN = "a law was found that keeps all limits at the places of the search, and none that keeps them everywhere"


@dataclass(frozen=True, eq=False)
class MakeableLaw:
    """Ratios i12 at driven angles in rad, shape (knots,) both, and the levels of the spline through them.

    With two stages, ``second`` holds the second stage's ratios at the same angles.
    """

    driven_angle_rad: Array
    ratio: Array
    levels: Sequence[WishLevel]
    reached: Array
    second: Array | None = None

    def train(self, lobes: Lobes) -> PairsInSeries:
        """The law as gears follow it."""
        if self.second is None:
            return single(spline_ratio_law(self.driven_angle_rad, self.ratio, lobes))
        return spline_ratio_staged(self.driven_angle_rad, self.ratio, self.second).train

    @property
    def motion(self) -> Motion:
        """How the crank turns at the knots."""
        return Motion(self.driven_angle_rad, 1.0 / self.ratio)

    @property
    def goal(self) -> float:
        """The minimized value, in units of the levels."""
        return float(sum(level.weight * value for level, value in zip(self.levels, self.reached, strict=True)))

    def cost(self, first: float) -> float:
        """The goal; where it is ``first``, with the costs of soft wishes."""
        return cost(self.levels, goal_weights(self.levels, first), self.reached)


def makeable_law(task: Task, wishes: Wishes, start: Motion) -> MakeableLaw:
    """The best law found from a motion.

    It is a local optimum that keeps every limit also between the programme's places; where the motion leads to no law,
    the search starts from an even crank.  Two stages start with half of ln i12 each, and end so that the larger of
    their pressure angles is least.  Raises NoSuchMechanism with the limits that cannot be kept together, and for each
    limit the nearest value with which the others can be kept.
    """
    if not ranges(wishes):
        return _held_law(task, wishes, start)
    begun = held_as(wishes, start, task.cycle_rad)
    first = _held_law(task, begun, start)
    return best_held(begun, first, partial(kept_law, task))


def _held_law(task: Task, wishes: Wishes, start: Motion) -> MakeableLaw:
    """The best law found with every driving range held over the crank angles that its wish names."""
    search = searched(task, wishes)
    begun = search.begun(start)
    found = kept(search, begun) or _from_even(search)
    if found is not None:
        return _weighed(search, law_of(search, found))
    if instead := found_instead(task, wishes, CLEAR):
        raise _offered(NONE, [offer for eased in instead for offer in eased(0.0)])
    return _weighed(search, _kept_at_last(search, begun))


def nearest_law(task: Task, wishes: Wishes) -> MakeableLaw:
    """The law nearest to keeping all limits, where no law keeps them; raises NoSuchMechanism without a law."""
    search = searched(task, wishes)
    near = _nearest(search, search.begun(EVEN)).coefficients
    return law_of(search, Kept(search.rounded(near), search.reached(near)))


def law_from(task: Task, wishes: Wishes, start: Motion, number: int) -> MakeableLaw | None:
    """The best law from another start with a number (``LawSearch.elsewhere``); None without a law."""
    return kept_law(task, held_as(wishes, start, task.cycle_rad), start, number)


def kept_law(task: Task, wishes: Wishes, start: Motion, number: int | None = None) -> MakeableLaw | None:
    """The best law found from a motion, or from another start with a number; None without a law."""
    search = searched(task, wishes)
    begun = search.begun(start)
    found = kept(search, begun if number is None else search.elsewhere(begun, number))
    return None if found is None else _weighed(search, law_of(search, found))


def _weighed(search: LawSearch, law: MakeableLaw) -> MakeableLaw:
    """The law found from another law, with the costs of soft wishes in shares of the other law's goal."""
    if not any(level.share_of_goal for level in law.levels):
        return law
    ratio = [law.ratio] if law.second is None else [law.ratio, law.second]
    start = np.concatenate([search.programme.knots.coefficients(np.log(own)) for own in ratio])
    found = kept(replace(search, weights=goal_weights(law.levels, law.goal)), start)
    return law if found is None else law_of(search, found)


def _kept_at_last(search: LawSearch, start: Array) -> MakeableLaw:
    """The law found from the nearest law to all limits; raises NoSuchMechanism where no law keeps them."""
    near = _nearest(search, start)
    if near.excess > NO_EXCESS:
        raise _cannot_be(search, near)
    found = kept(search, near.coefficients)
    return _kept_between(search, near.coefficients) if found is None else law_of(search, found)


def _nearest(search: LawSearch, start: Array) -> Solution:
    near = search.nearest(start)
    if near is None:
        raise NoSuchMechanism("no law was found, not even one that oversteps the limits", key="optimize.limits")
    return near


def _kept_between(search: LawSearch, near: Array) -> MakeableLaw:
    """A law that keeps all limits between the places too, from coefficients that keep them at the places.

    Raises NoSuchMechanism with the least value of each limit with which a law keeps all others everywhere; without such
    laws, with the values that the coefficients reach of the limits that they exceed.
    """
    levels, reached = search.programme.levels, search.reached(near)
    limited = dict.fromkeys(level.wish for level in levels if level.limit is not None and level.wish != CONVEX)
    found = {wish: law for wish in limited if (law := _kept_without(search, [wish], near)) is not None}
    for law in (Kept(search.rounded(near), reached), *found.values()):
        if not np.any(law.reached > search.caps):
            return law_of(search, law)
    if found:
        eased = [easing for wish, law in found.items() for easing in _easing(search, wish, law.reached)]
        raise _offered(BETWEEN, eased)
    over = dict.fromkeys(level.wish for level, yes in zip(levels, reached > search.caps, strict=True) if yes)
    eased = [easing for wish in over for easing in _easing(search, wish, reached)]
    raise _offered(BETWEEN, eased, each=False)


def _kept_without(search: LawSearch, wishes: Sequence[str], *starts: Array | Solution) -> Kept | None:
    """Coefficients that keep all limits but a few everywhere, and come near these few, from the first start."""
    freed = _freed(search, wishes)
    return next((found for start in starts if (found := kept(freed, start)) is not None), None)


def _freed(search: LawSearch, wishes: Sequence[str]) -> LawSearch:
    """The search that keeps all other limits, and comes as near as it can to both sides of these wishes."""
    levels = search.programme.levels
    freed = np.array([level.wish in wishes for level in levels])
    dents = np.array([level.wish == CONVEX for level in levels])
    floored = [
        replace(level, floor=max(level.floor, level.limit)) if yes and level.limit is not None else level
        for level, yes in zip(levels, freed & ~dents, strict=True)
    ]
    return replace(
        search,
        programme=replace(search.programme, levels=floored),
        caps=np.where(freed, np.where(dents, ANY_DENT, np.inf), search.caps),
        weights=np.where(freed & ~dents, 1.0, 0.0),
    )


def law_of(search: LawSearch, found: Kept) -> MakeableLaw:
    """The law that a search has found."""
    first, *second = found.ratio
    programme = search.programme
    return MakeableLaw(programme.knots.angle_rad, first, programme.levels, found.reached, *second)


def _cannot_be(search: LawSearch, near: Solution) -> Refused:
    """The refusal: the value that each limit needs with all other limits, or the values of several limits together."""
    alone = [
        easing
        for wish, found in _eased(search, near)
        for easing in _easing(search, wish, search.reached(found.coefficients))
    ]
    if alone:
        return _offered(NONE, alone)
    freed, found = _freed_together(search, near, lambda level: True)
    reached = None if found is None else search.reached(found.coefficients)
    eased = [] if reached is None else [list(_easing(search, wish, reached)) for wish in freed]
    return _offered(NONE, list(chain(*eased)) if all(eased) else [], each=False)


def _offered(said: str, easings: Sequence[Offer], *, each: bool = True) -> Refused:
    key = easings[0].key if easings else "optimize.limits"
    enough = "one of these is enough" if each else "all of these are enough together"
    return Refused(said, easings, key, partial(_told, enough), each=each, found=True)


def _told(enough: str, said: str, offers: Sequence[Offer]) -> str:
    return f"{said}; {enough}: {', '.join(map(str, offers)) or 'none known'}"


def _eased(search: LawSearch, near: Solution) -> Iterator[tuple[str, Solution]]:
    """Each wish that presses, without which a law of less excess exists, with the law that keeps all others, if any."""
    for wish in dict.fromkeys(level.wish for level, share in _shares(search, near) if share > PRESSING):
        share = sum(share for level, share in _shares(search, near) if level.wish == wish)
        found = _without(search, [wish], DEARER / share, near)
        if found is not None and found.excess <= NO_EXCESS:
            yield wish, found


Eased = Callable[[float], list[Offer]]
"""Offers eased more than the found law needs; the argument is the addition as a share of their levels."""


def found_instead(task: Task, wishes: Wishes, over: float = NO_EXCESS) -> list[Eased]:
    """Limits and wishes, each eased alone to a value with which a law of few knots keeps all others everywhere.

    Empty where no law was found, and where a law exceeds all limits by no more than ``over``.
    """
    found = (list(_found_instead(search, over)) for search in _few_knots(task, wishes))
    return next(filter(None, found), [])


def _few_knots(task: Task, wishes: Wishes) -> Iterator[LawSearch]:
    return (searched(task, replace(wishes, knots=wishes.knots // ceil(wishes.knots / most))) for most in FEW_KNOTS)


def _found_instead(search: LawSearch, over: float) -> Iterator[Eased]:
    near = search.nearest(search.begun(EVEN))
    if near is None or near.excess <= over:
        return
    for wish, found in _eased(search, near):
        law = _kept_without(search, [wish], found, found.coefficients)
        if law is not None and list(_easing(search, wish, law.reached)):
            yield _eased_by(search, [wish], law.reached)


def _eased_by(search: LawSearch, wishes: Sequence[str], reached: Array) -> Eased:
    def eased(room: float) -> list[Offer]:
        levels = reached + room * np.maximum(np.abs(reached), 1.0)
        return list(chain(*(_easing(search, wish, levels) for wish in wishes)))

    return eased


def _freed_together(
    search: LawSearch, near: Solution, may_give: Callable[[WishLevel], bool]
) -> tuple[list[str], Solution | None]:
    """Wishes to drop, the most pressing first, so that a law keeps all others at the places, and that law.

    A wish is kept again where the others are enough.  The law is None where no law was found.
    """
    freed: list[str] = []
    found: Solution | None = near
    while found is not None and found.excess > NO_EXCESS:
        shares = [
            share if may_give(level) and level.wish not in freed else 0.0 for level, share in _shares(search, found)
        ]
        if not max(shares) > 0.0:
            return freed, None
        freed.append(search.programme.levels[int(np.argmax(shares))].wish)
        found = _without(search, freed, TOGETHER, found)
    for wish in freed[:-1]:
        fewer = [other for other in freed if other != wish]
        enough = found and _without(search, fewer, TOGETHER, found)
        if enough is not None and enough.excess <= NO_EXCESS:
            freed, found = fewer, enough
    return freed, found


def found_together(task: Task, wishes: Wishes, *, limits_alone: bool) -> Eased | None:
    """Limits (and wishes, unless ``limits_alone``) to ease together, so that a law keeps all others."""
    found = (_found_together(search, limits_alone) for search in _few_knots(task, wishes))
    return next((law for law in found if law is not None), None)


def _found_together(search: LawSearch, limits_alone: bool) -> Eased | None:
    near = search.nearest(search.begun(EVEN))
    if near is None:
        return None
    freed, found = _freed_together(search, near, lambda level: not limits_alone or level.group == OF_LIMITS)
    if found is None:
        return None
    law = _kept_without(search, freed, found, found.coefficients)
    return None if law is None else _eased_by(search, freed, law.reached)


def keeps_all(task: Task, wishes: Wishes) -> bool:
    """Whether the search from an even crank finds a law that keeps all limits and wishes everywhere."""
    return _from_even(searched(task, wishes)) is not None


def _from_even(search: LawSearch) -> Kept | None:
    """The law found from an even crank: directly, or from the law that comes nearest to all limits."""
    begun = search.begun(EVEN)
    if (found := kept(search, begun)) is not None:
        return found
    near = search.nearest(begun)
    return None if near is None or near.excess > NO_EXCESS else kept(search, near.coefficients)


def _without(search: LawSearch, wishes: Sequence[str], price: float, near: Solution) -> Solution | None:
    """The law with the least levels of these wishes; an excess over all other caps costs the price.

    Where the method does not settle, it continues from all variables of the nearest law; a small excess costs more.
    """
    free = _freed(search, wishes)
    nearest = free.programme.nearest
    found = nearest(free.caps, free.weights, price, near.coefficients) or nearest(free.caps, free.weights, price, near)
    if found is not None and NO_EXCESS < found.excess < CHEAP * near.excess:
        return nearest(free.caps, free.weights, DEARER**2 * price, found) or found
    return found


def _shares(search: LawSearch, near: Solution) -> Iterator[tuple[WishLevel, float]]:
    return zip(search.programme.levels, near.pressing.tolist(), strict=True)


def _easing(search: LawSearch, wish: str, reached: Array) -> Iterator[Offer]:
    """The value that a law has reached; nothing where a file may not ask for so wide a limit."""
    levels = zip(reached, search.programme.levels, strict=True)
    value, level = max(((value, level) for value, level in levels if level.wish == wish), key=lambda eased: eased[0])
    if value < level.widest:
        yield replace(level.shown(float(value)), key=level.key)
