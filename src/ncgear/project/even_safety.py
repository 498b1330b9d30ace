"""Parts of a ratio with which two pairs in series are equally safe.

Both pairs pass the same power and have gears of one size, so the parts move the safeties by a few per cent only: of a
ratio in proportion to (1 + 0.4 cos phi1)^2 by 1 to 11 %, over all parts and under five torques.  Even safeties exist
where the torque is small while the driven shaft is fast.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isinf

from ncgear.errors import NoSuchMechanism, WrongInput

EVENLY_SAFE = 0.002
"""Largest difference of both safeties that counts as none, as a share of their sum."""

ENDS = 0.98, 0.02
"""Greatest and least part of the first pair: beyond them the gears of a pair are round but for little."""

NEAR = 1e-4
"""Error of a part at which its search ends in any case."""


def evenly_safe(shares: Callable[[float], tuple[float, ...]]) -> float:
    """The part of the first pair, from 0 to 1, with which both pairs have the same least safety.

    ``shares`` tells each pair's least safety over the wanted safety for a part of the first pair; zero for gears that
    cannot be rated.  Raises WrongInput where the teeth carry no load, NoSuchMechanism where one pair is the safer with
    all parts, or where the safeties jump past each other.
    """
    from scipy.optimize import brentq

    known = dict[float, tuple[float, ...]]()

    def uneven(part: float) -> float:
        """The difference of both safeties over their sum; zero where it counts as none."""
        if part not in known:
            known[part] = shares(part)
        first, second = known[part]
        if isinf(first + second):
            raise WrongInput("the teeth carry no load at any angle, so none is safer than another", key="resistance")
        difference = (first - second) / (first + second)
        return difference if abs(difference) > EVENLY_SAFE else 0.0

    middle = uneven(0.5)
    if middle == 0.0:
        return 0.5
    end = next((part for part in ENDS if uneven(part) * middle <= 0.0), None)
    found = 0.5 if end is None else float(brentq(uneven, 0.5, end, xtol=NEAR))
    if uneven(found) == 0.0:
        return found
    if end is None:
        words = f"pair {1 if middle > 0.0 else 2} is the safer whatever part of the ratio pair 1 takes"
    else:
        words = f"the safeties jump past each other where pair 1 takes {found:.4g} of the ratio"
    told = "; ".join(f"{first:.4g} and {second:.4g} at {part:.4g}" for part, (first, second) in sorted(known.items()))
    raise NoSuchMechanism(
        f"{words} (safeties over the wanted ones: {told}); another sharing or gears.parts is right", key="gears.sharing"
    )
