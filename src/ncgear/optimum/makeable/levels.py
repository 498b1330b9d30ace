"""A level: a number that bounds something around the turn.  A limit holds it down; a goal makes it as low as it goes.

What a level bounds is told by terms at one place of the crank (``quantities.py``) and by its kind: the largest value of
the terms, how far they spread, an integral of them over the driving angle, or how far such an integral swings.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from math import inf, pi

from ncgear.frozen import dataclass
from ncgear.optimum.makeable.quantities import Place, Slider, Term, pairs, with_shaft_between
from ncgear.optimum.offers import Offer

OF_LIMITS = "optimize.limits."
"""The group of keys of limits, with its dot."""


def limit_offer(name: str, words: str, number: str) -> Offer:
    """The offer of a limit by its name under ``optimize.limits``; its number stands in the words for the braces."""
    return Offer(words.format(number), ((f"{OF_LIMITS}{name}", float(number)),))


Sides = Callable[[Place, Slider, Term], tuple[Term, ...]]
"""Place, slider, and length of the driving curve over the centre distance, to the terms of a level."""


class Kind(Enum):
    """What a level bounds, from its terms at the places of its stretch.

    An integral is one over the driving angle phi1 in rad, so that of the term 1.0 is the driving angle that a stretch
    takes, and of a term divided by the cycle the term's mean over time.
    """

    PEAK = "peak"
    """The largest value of every term."""

    SPREAD = "spread"
    """The largest value of every term less its least one."""

    INTEGRAL = "integral"
    """Every term's integral over the stretch, less ``target``: at most the level.  Negative terms bound it below."""

    DEVIATION = "deviation"
    """How far every term's integral over the stretch is from ``target``, to either side."""

    SWING = "swing"
    """The largest less the least value of the running integral of every term less its mean, over the whole turn."""


@dataclass(frozen=True)
class Stretch:
    """The crank angles from ``start_rad`` on to ``end_rad``: one place where both are equal, a turn at most.

    ``start_rad`` is between minus a turn and a turn, so that a stretch may lie around the retracted dead centre.
    """

    start_rad: float
    end_rad: float

    def __post_init__(self) -> None:
        turn = 2.0 * pi
        if not (abs(self.start_rad) <= turn and 0.0 <= self.end_rad - self.start_rad <= turn):
            raise ValueError(f"no stretch of a turn: from {self.start_rad:g} to {self.end_rad:g} rad")


TURN = Stretch(0.0, 2.0 * pi)


@dataclass(frozen=True)
class Level:
    """One level: the ``wish`` that it comes from, its ``limit`` (None: none) and its ``weight`` in the goal.

    Terms and limit are in units in which they are of the order of one; ``shown`` says what the user's limit would
    have to be for a level that exceeds it.  ``of_pairs`` is true for a level of every pair of gears, false for
    one of the machine as a whole.  Beyond ``widest`` no limit can be asked for.  Integrals and swings are levels of the
    machine as a whole; the integral of a pair's term would be one over the driving angle of the whole train, too.

    ``group`` is the group of keys that the wish belongs to, with its dot.  Below ``floor`` a level costs no less.
    ``share_of_goal`` is what one unit costs in shares of what is least without any such level: so soft wishes count.
    """

    wish: str
    limit: float | None
    weight: float
    sides: Sides
    shown: Callable[[float], Offer]
    of_pairs: bool = False
    widest: float = inf
    kind: Kind = Kind.PEAK
    stretch: Stretch = TURN
    target: float = 0.0
    group: str = OF_LIMITS
    floor: float = -inf
    share_of_goal: float = 0.0

    @property
    def key(self) -> str:
        """The wish's dotted key in a design file."""
        return f"{self.group}{self.wish}"

    @property
    def least(self) -> float:
        """The least value that counts: the floor; a deviation to either side is never negative."""
        return max(self.floor, 0.0) if self.kind is Kind.DEVIATION else self.floor

    @property
    def cap(self) -> float:
        """The limit; infinite where there is none."""
        return inf if self.limit is None else self.limit

    def terms(self, ratios: Sequence[Place], slider: Slider, lengths: Sequence[Term]) -> tuple[Term, ...]:
        """The level's terms, from i12, and iB where there are two pairs, and every pair's length."""
        if not self.of_pairs:
            return self.sides(ratios[0], with_shaft_between(slider, ratios), lengths[0])
        return tuple(
            side for at, length in zip(pairs(ratios), lengths, strict=True) for side in self.sides(at, slider, length)
        )
