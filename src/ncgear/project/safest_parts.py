"""Parts of a ratio with which the weakest of all pairs in series is as safe as it can be.

All pairs pass the same power and have gears of one size, so the parts move the safeties little: of a
ratio in proportion to (1 + 0.4 cos phi1)^2 by 1 to 15 %, over all parts of two pairs and under five torques.  Where the
torque is small while the driven shaft is fast, the safest parts make all pairs equally safe
(tests/test_shared_pairs.py); under an even torque one pair stays the weaker whatever its part.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isinf, log

import numpy as np

from ncgear.errors import DesignError, WrongInput
from ncgear.numerics.arrays import Array

CLOSE = 0.004
"""Share of the wanted safety within which the search ends: the estimate of strength is within some per cent."""

NEAR, STEP = 0.05, 0.8
"""Error of the logarithms of parts at which the search ends, 1.3 % of the ratio, and its first step."""

WIDEST = log(49.0)
"""Largest logarithm of a part over the last one: from parts of 98 and 2 % on the gears of a pair are next to round."""

MOST_RATED = 40
"""Most parts for which pairs are rated, times the number of pairs less one: two pairs take about 15, three about 45."""

Parts = tuple[float, ...]


def safest_parts(share: Callable[[Parts, int], float], count: int) -> Parts:
    """The parts of ``count`` pairs, of the sum 1, with which the least of their safeties is greatest.

    ``share`` tells the least safety over the wanted safety of a pair, numbered from 0, for given parts, or raises
    DesignError: such parts are as good as no safety.  Of all parts that the search rates, from even ones on, the safest
    count; safeties have kinks and jumps, and others may be safer still.  Raises WrongInput where the teeth carry no
    load, and the refusal of even parts where none of the parts that are tried can be rated.
    """
    from scipy.optimize import minimize

    rated, refused = dict[Parts, float](), list[DesignError]()

    def danger(logarithms: Array) -> float:
        parts = np.exp([*logarithms, 0.0])
        shares: Parts = tuple((parts / parts.sum()).tolist())
        # The search comes back to its bounds and corners.
        if shares not in rated:
            try:
                rated[shares] = min(share(shares, pair) for pair in range(count))
            except DesignError as refusal:
                refused.append(refusal)
                rated[shares] = 0.0
        if isinf(rated[shares]):
            raise WrongInput("the teeth carry no load at any angle, so no parts are safer", key="resistance")
        return -rated[shares]

    begin = np.zeros(count - 1)
    options = {
        "initial_simplex": np.vstack([begin, STEP * np.eye(count - 1)]),
        "xatol": NEAR,
        "fatol": CLOSE,
        "maxfev": MOST_RATED * (count - 1),
    }
    bounds = [(-WIDEST, WIDEST)] * (count - 1)
    minimize(danger, begin, method="Nelder-Mead", bounds=bounds, options=options)
    if not any(rated.values()):
        raise refused[0]
    return max(rated, key=rated.__getitem__)
