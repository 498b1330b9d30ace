"""The pace of a carrier that does not turn evenly, so that stretches of a path take their time or are passed slowly.

With c the carrier's turn and t the share of the cycle, p(c) = 2 pi dt/dc is the speed of an even shaft over that of the
carrier.  Its mean is 1, and with n arms it repeats n times a turn, so that every arm moves as the first one.  Of a
stretch between two places of the path, the time is the integral of p; the tip's speed there is |d tip/dc| over p.  Both
are linear in the waves of p, and the smoothest p that keeps all is the answer of a quadratic programme.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Mask
from ncgear.trains.tip_path import FINE, TipMotion, WishedPath

WAVES = 12
"""Waves of p in each repetition: a stretch of a tenth of a repetition has a wave of its own."""

PLACES = 720
"""Places of a turn at which the limits of p are kept, and the length of the answer: 60 for the shortest wave of one
arm; any number of arms up to six divides it."""

LEAST_PACE = 0.2
"""Least p: the carrier turns five times as fast as on average, which a pair of gears still makes."""

MARGIN = 0.003
"""Share by which speeds stay under their limits, for what lies between the places."""

KEPT = 1e-6
"""Share by which a condition may be missed as rounding of the programme."""


@dataclass(frozen=True)
class PacedStretch:
    """A stretch from one point of a path to another, by their places among the points.

    ``share`` is its wanted share of the cycle, ``speed_mm_s`` the greatest speed of the tip on it; None for any.
    """

    start: int
    end: int
    share: float | None = None
    speed_mm_s: float | None = None


def _passed_at(motion: TipMotion, path: WishedPath) -> Array:
    """The carrier's turns from its first place at which the tip is nearest to each point, shape (n,)."""
    step = 2.0 * pi / FINE
    w = np.linspace(0.0, 2.0 * pi, FINE, endpoint=False)
    squares = np.abs(motion.tip(w) - path.points[:, None]) ** 2
    nearest = squares.argmin(axis=1)
    before, there, after = (np.take_along_axis(squares, (nearest[:, None] + by) % FINE, 1)[:, 0] for by in (-1, 0, 1))
    # The least of the parabola through three squares
    between = (before - after) / (before - 2.0 * there + after) / 2.0
    found: Array = motion.carrier_rad((nearest + between) * step) - motion.carrier_rad(np.zeros(1))
    return found % (2.0 * pi)


def carrier_pace(
    motion: TipMotion, path: WishedPath, stretches: Sequence[PacedStretch], arms: int, speed_rad_s: float
) -> Array:
    """The pace p at PLACES even turns of the carrier from its first place on, shape (PLACES,).

    ``speed_rad_s`` is the mean speed of the carrier.  Raises NoSuchMechanism, key ``path.pace``.
    """
    from scipy.optimize import minimize

    w = np.linspace(0.0, 2.0 * pi, FINE, endpoint=False)
    u = motion.carrier_rad(w)
    at = _passed_at(motion, path)
    c = np.linspace(0.0, 2.0 * pi, PLACES, endpoint=False)
    turned = np.interp(c + u[0], np.append(u, u[0] + 2.0 * pi), np.append(w, 2.0 * pi))
    rate = 1.0 - 1.0 / motion.carrier_rad(turned, 1)
    way_mm = np.abs(motion.carrier_mm + motion.arm_mm * rate * np.exp(-1j * turned))
    least, equal, shares = np.full(PLACES, LEAST_PACE), list[Array](), list[float]()
    orders = arms * np.arange(1.0, WAVES + 1.0)
    for stretch in stretches:
        start, length = at[stretch.start], (at[stretch.end] - at[stretch.start]) % (2.0 * pi) or 2.0 * pi
        if stretch.share is not None:
            ends = np.array([[start + length], [start]])
            integral = np.concatenate([np.sin(ends * orders) / orders, -np.cos(ends * orders) / orders], axis=1)
            equal.append((integral[0] - integral[1]) / (2.0 * pi))
            shares.append(stretch.share - length / (2.0 * pi))
        if stretch.speed_mm_s is not None:
            # With a place beyond either end.
            within: Mask = (c - start + c[1]) % (2.0 * pi) <= length + 2.0 * c[1]
            limit = way_mm * speed_rad_s / stretch.speed_mm_s * (1.0 + MARGIN)
            least = np.maximum(least, np.where(within, limit, 0.0))
    # Arms take turns: what one needs at a place, all need there.
    least = least.reshape(arms, -1).max(axis=0)
    places = c[: least.size]
    waves = np.concatenate([np.cos(places[:, None] * orders), np.sin(places[:, None] * orders)], axis=1)
    rough = np.tile((orders / arms) ** 4, 2)
    conditions = [{"type": "ineq", "fun": lambda x: 1.0 + waves @ x - least, "jac": lambda _: waves}]
    if equal:
        rows, wanted = np.array(equal), np.array(shares)
        conditions.append({"type": "eq", "fun": lambda x: rows @ x - wanted, "jac": lambda _: rows})
    found = minimize(
        lambda x: float(rough @ x**2),
        np.zeros(2 * WAVES),
        jac=lambda x: 2.0 * rough * x,
        method="SLSQP",
        constraints=conditions,
        options={"maxiter": 500, "ftol": 1e-12},
    ).x
    pace = 1.0 + np.tile(waves @ found, PLACES // places.size)
    short = float((1.0 + waves @ found - least).min())
    missed = max((float(np.abs(row @ found - share)) for row, share in zip(equal, shares, strict=True)), default=0.0)
    if short < -KEPT or missed > KEPT:
        needed = float(least.mean())
        said = f"the stretches as slow as that take {needed:.3g} cycles" if needed > 1.0 else "one hinders another"
        alike = f"; with {arms} arms the carrier does {arms} times a turn what one of them needs" if arms > 1 else ""
        raise NoSuchMechanism(
            f"no smooth turning of the carrier keeps all of them: {said}{alike}; greater speeds, shares nearer to "
            "those of an even carrier, or fewer arms are right",
            key="path.pace",
        )
    return pace
