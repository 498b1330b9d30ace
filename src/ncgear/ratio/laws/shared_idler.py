"""The law of a row of three gears, one idler between two, whose last gear turns as prescribed.

The driving gear turns by M(v) while the idler turns by v.  A place of the idler meets the last gear after the idler has
turned by beta more than from the driving gear.  With one lobe each and equal centre distances the last gear is then a
gear like the driving one, beta later, and the whole law T is made where

    M(v + beta) = T(M(v)) + c,   M(0) = 0.

M turns T + c into an even turn by beta.  For a smooth T there are such M and c if beta is far from all simple fractions
of a turn (Herman, Yoccoz); no angle is farther from them than the golden section of a turn.  For other angles some laws
are made and some are not; a straight row, beta = pi, makes only laws that undo themselves when they are done twice.

Newton's method, as in Kolmogorov's, Arnold's and Moser's proofs: with M + M' w for M, and e for what is left of the
equation, w(v + beta) - w(v) = (dc - e(v)) / M'(v + beta), but for squares of w; each wave of w follows by itself.  The
start is the even law, from which T is reached in steps.
"""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, pi, sqrt

import numpy as np
from scipy.optimize import brentq

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.ratio.laws.harmonic import LogSeries, closed_harmonics, harmonic_law, series_of
from ncgear.ratio.laws.over_driven_angle import LogRatioLaw
from ncgear.ratio.transmission import Lobes, Transmission

GOLDEN_RAD = pi * (3.0 - sqrt(5.0))
"""The golden section of a turn, 137.508 degrees."""

MOST_WAVES = 200
"""Most waves of ln M': as many as the law of a design file has."""

NODES = 1024
"""Nodes of a turn, five for each wave, so that products of waves are resolved."""

ORDERS = np.arange(NODES // 2 + 1)
V_RAD = np.arange(NODES) * (2.0 * pi / NODES)

KEPT_RAD = 1e-6
"""Greatest error of the last gear's angle that is accepted; gears of 100 mm are cut ten times less exactly."""

SHORTEST_STEP = 1.0 / 256.0
"""Least step on the way from the even law to the prescribed one."""


@dataclass(frozen=True, eq=False)
class SharedIdler:
    """ln i12 of the first mesh over the idler's angle, and the greatest error of the last gear's angle in rad."""

    series: LogSeries
    missed_rad: float

    @property
    def first(self) -> Transmission:
        """The law of the first mesh."""
        return harmonic_law(self.series.cosine, self.series.sine, Lobes())


def shared_by_idler(whole: Transmission, beta_rad: float, key: str) -> SharedIdler:
    """The law of the first of two meshes that make a whole law, one lobe of each gear.

    The last gear is ``beta_rad`` of the idler ahead of the driving one.  Raises NoSuchMechanism, with ``key``, where no
    waves make the law within KEPT_RAD.
    """

    def turned(angle: Array) -> Array:
        turns, within = np.divmod(angle, 2.0 * pi)
        return whole.driven_angle(within).value + turns * (2.0 * pi)

    found, done, step = (np.zeros(NODES), beta_rad), 0.0, 1.0
    while done < 1.0:
        share = min(done + step, 1.0)
        better = _newton(turned, share, beta_rad, *found)
        if better is not None:
            found, done = better, share
        elif step <= SHORTEST_STEP:
            raise _not_made(beta_rad, key)
        else:
            step /= 2.0
    series = _log_rate(found[0])
    first = closed_harmonics(series.cosine, series.sine, Lobes())
    missed_rad = _missed_rad(first, turned, beta_rad)
    if not missed_rad < KEPT_RAD:
        raise _not_made(beta_rad, key)
    return SharedIdler(series, missed_rad)


def _not_made(beta_rad: float, key: str) -> NoSuchMechanism:
    bend, golden = degrees(abs(pi - beta_rad % (2.0 * pi))), degrees(pi - GOLDEN_RAD)
    right = "a law that is more even is right, or the same bend to the other side"
    if abs(bend - golden) > 1e-3:
        right = (
            f"{golden:.3f} degrees to either side is right, by the golden section of a turn, or a law that is more even"
        )
    return NoSuchMechanism(
        f"no idler makes this law where the line of centres turns by {bend:.6g} degrees; {right}", key=key
    )


def _newton(
    turned: Callable[[Array], Array], share: float, beta_rad: float, swing: Array, offset: float
) -> tuple[Array, float] | None:
    """M - v at V_RAD and c for a share of T's deviation from the even law; None where M would turn back."""
    later = np.exp(1j * ORDERS * beta_rad)
    divisor = later - 1.0
    divisor[0] = np.inf
    before = np.inf
    while True:
        spectrum = np.fft.rfft(swing)
        rate = 1.0 + np.fft.irfft(1j * ORDERS * spectrum)
        if not rate.min() > 0.0:
            return None
        angle = V_RAD + swing
        left = V_RAD + beta_rad + np.fft.irfft(later * spectrum) - angle - share * (turned(angle) - angle) - offset
        worst = float(np.abs(left).max())
        # Squares of errors until rounding or the waves left out are reached
        if not worst < before / 2.0:
            return (swing, offset) if worst < KEPT_RAD else None
        before = worst
        weight = 1.0 / (1.0 + np.fft.irfft(later * 1j * ORDERS * spectrum))
        change = float(left @ weight / weight.sum())
        waves = np.fft.rfft((change - left) * weight) / divisor
        waves[NODES // 3 :] = 0.0
        swing, offset = swing + rate * np.fft.irfft(waves), offset + change


def _log_rate(swing: Array) -> LogSeries:
    """ln M' from M - v at V_RAD, counted from the place where M = 0."""
    spectrum = np.fft.rfft(swing)
    beyond = 1.0 + float(np.abs(swing).max())  # by which a series between its nodes may be larger, and more
    start = float(brentq(lambda v: v + np.fft.irfft(np.exp(1j * ORDERS * v) * spectrum)[0], -beyond, beyond))
    rate = 1.0 + np.fft.irfft(1j * ORDERS * np.exp(1j * ORDERS * start) * spectrum)
    return series_of(np.log(rate), MOST_WAVES)


def _missed_rad(first: LogRatioLaw, turned: Callable[[Array], Array], beta_rad: float) -> float:
    """Greatest error of the last gear's angle in rad, at angles of the idler that are no nodes."""

    def driving(v: Array) -> Array:
        turns, within = np.divmod(v, 2.0 * pi)
        return first.integral.at(within) + turns * (2.0 * pi)

    v = np.remainder(np.arange(float(JUDGED)) * GOLDEN_RAD, 2.0 * pi)
    last = driving(v + beta_rad) - driving(np.array([beta_rad]))
    return float(np.abs(last - turned(driving(v))).max())


JUDGED = 2500
"""Angles at which the error is judged, more than twelve for each wave."""
