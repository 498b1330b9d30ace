"""Common part of laws given by their ratio: 1/i12 is integrated, and a constant factor closes the cycle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from math import inf

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.ratio.transmission import JetFunction, Lobes, Piece, Transmission

NEARLY_CLOSED = 1e-9
"""Relative closure error that is removed even without ``scale_to_close``: a ratio with ten digits has an error of this
size."""


@dataclass(frozen=True, eq=False)
class Slope:
    """dphi2/dphi1 on a stretch of the period, and its integral from the stretch's start.

    The integral's breaks are the ends of the panels that resolve it, the ends of the stretch and the places where a
    high derivative jumps.
    """

    jets: JetFunction
    integral: PiecewiseChebyshev

    @property
    def knots_rad(self) -> tuple[float, ...]:
        """Inner breaks: knots of the law, so that later steps see all that the integral had to resolve."""
        return tuple(self.integral.breaks[1:-1].tolist())


@contextmanager
def smooth_or_refused(key: str) -> Iterator[None]:
    """Turns a slope or a ratio that is not smooth into NoSuchMechanism for ``key``."""
    try:
        yield
    except NotSmooth as fault:
        raise NoSuchMechanism(
            f"the ratio is zero, infinite or jumps near phi1 = {in_words(fault.at)}, or changes there faster than can "
            "be followed; it must be smooth and positive over the whole cycle",
            key=key,
        ) from fault


def splined_slope(jets: JetFunction, knots: Array, lobes: Lobes, key: str) -> Slope:
    """A slope that is smooth between ``knots`` (shape (m,), inner points of [0, period]); raises NoSuchMechanism."""
    breaks = np.concatenate([[0.0], knots, [lobes.driving_period_rad]])
    with smooth_or_refused(key):
        return Slope(jets, chebyshev.fitted(lambda phi1: jets(phi1, 0).value, breaks).integrated())


def integrated_law(slopes: Sequence[Slope], lobes: Lobes, *, scale_to_close: bool, key: str) -> Transmission:
    """The law of consecutive stretches of dphi2/dphi1, times the constant that closes the cycle.

    Raises NoSuchMechanism where the constant is not 1 and ``scale_to_close`` is false.
    """
    starts = np.cumsum([0.0, *(slope.integral.final for slope in slopes)])
    factor = _closing_factor(float(starts[-1]), lobes, scale_to_close, key)
    pieces = [stretched(slope, float(start), factor) for slope, start in zip(slopes, starts, strict=False)]
    return Transmission(tuple(pieces), lobes)


def stretched(slope: Slope, start: float, factor: float) -> Piece:
    """The integral of a slope from the value ``start``, all times a factor."""
    first, last = slope.integral.breaks[[0, -1]].tolist()
    return Piece(first, last, partial(integrated_angle, slope, start, factor), slope.knots_rad)


def integrated_angle(slope: Slope, start: float, factor: float, phi1: Array, order: int) -> Jet:
    """phi2 in rad, with derivatives."""
    values = factor * (start + slope.integral(phi1))
    return (slope.jets(phi1, order - 1) * factor).integrated(values) if order else Jet(values[None, :])


def _closing_factor(covered: float, lobes: Lobes, scale_to_close: bool, key: str) -> float:
    """The factor of 1/i12 that makes the driven gear, which turns by ``covered`` rad, turn by its period."""
    target = lobes.driven_period_rad
    refuse_without_turn(covered, "cycle", key)
    factor = target / covered
    if not scale_to_close and abs(factor - 1.0) > NEARLY_CLOSED:
        raise NoSuchMechanism(
            f"the cycle does not close: the driven gear turns by {covered:.12g} rad while the driving gear turns by "
            f"{lobes.driving_period_rad:.6g} rad, and it must turn by {target:.12g}; multiply the ratio by "
            f"{1.0 / factor:.12g}, or set scale_to_close: true{closing_lobes(covered, lobes)}",
            key=key,
        )
    return factor


def refuse_without_turn(covered: float, over: str, key: str) -> None:
    """Raise NoSuchMechanism where the driven gear turns by no positive angle, ``covered``, in rad over the cycle."""
    if covered < 0.0:
        raise NoSuchMechanism(f"the ratio is negative; it must be positive over the whole {over}", key=key)
    if not covered > 0.0:
        raise NoSuchMechanism(
            "the ratio is too large to be computed; leave out its common factor",
            key=key,
        )


def closing_lobes(covered: float, lobes: Lobes) -> str:
    """Words for the lobes of one gear with which a law closes that turns the driven gear by ``covered`` rad in a period
    of the driving gear; empty where there are none."""
    if not 0.0 < covered < inf:
        return ""
    share = covered / lobes.driving_period_rad
    driving, driven = max(round(share), 1), max(round(1.0 / share), 1)
    if abs(share * driven / driving - 1.0) > NEARLY_CLOSED or driving == driven:
        return ""
    repeats = f"for a law that repeats {driving} times a turn, " if driving > 1 else ""
    return f"; {repeats}gears.lobes: {{driving: {driving}, driven: {driven}}} is right"
