"""Gears that compute a function y = f(x): both angles are linear scales, one of x and one of y.

phi1 = R1 (x - x0) / (x1 - x0) and phi2 = R2 (y - y0) / (y1 - y0), so that dphi2/dphi1 is proportional to f'(x), over a
range of x on which f rises or falls throughout.  Where it falls, the driven scale runs from the greatest y
to the least (F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K. Hayasaka, "Noncircular Gears", Cambridge 2009).
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth
from ncgear.numerics.formula import Formula, composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.proven import proven, smooth_parts
from ncgear.ratio.transmission import DrivenGearStops, OpenRange, Piece, Transmission

NO_JUMP = 1e-9
"""Largest jump where one formula follows another, as a share of the function's whole change."""

PLACES = 1025
"""Places of a formula's range between which its slope may change its sign; if it touches zero in between, the place of
the least slope is named."""


def generated_function(
    text: str, x_range: tuple[float, float], driving_rad: float, driven_rad: float, key: str = "motion.function"
) -> Transmission:
    """The law of a function of x over a range of x, with the ranges of both angles in rad.

    Raises WrongInput for a text that is no formula of x, and NoSuchMechanism, with the x, for a function that is not
    smooth, that jumps, or that does not rise or fall throughout.
    """
    first, last = x_range
    rate = (last - first) / driving_rad
    try:
        parts = smooth_parts(composed(text, key, "x"), first, last)
        _refuse_jumps(parts, key)
        start, end = (_value(formula, x) for formula, x in ((parts[0][2], first), (parts[-1][2], last)))
        if not (np.isfinite(start) and np.isfinite(end) and abs(end - start) > 0.0):
            raise NoSuchMechanism(
                f"y is {start:.6g} at x = {first:g} and {end:.6g} at x = {last:g}; a function that rises or falls "
                "throughout is needed",
                key=key,
            )
        scale = driven_rad / (end - start)
        # The last piece ends at the end of the range, whatever rounding makes of it.
        ends = [*((part[1] - first) / rate for part in parts[:-1]), driving_rad]
        pieces = tuple(_piece(part, end, first, rate, start, scale) for part, end in zip(parts, ends, strict=True))
    except NotSmooth as fault:
        raise NoSuchMechanism(
            f"the function is not smooth near x = {fault.at:.6g}: its value or its slope is infinite or changes there "
            "faster than can be followed; a range of x without that place is right",
            key=key,
        ) from fault
    try:
        return Transmission(pieces, OpenRange(driving_rad=driving_rad, driven_rad=driven_rad))
    except DrivenGearStops as stop:
        x = _stop(parts, first + rate * stop.at_rad)
        raise NoSuchMechanism(
            f"the function stands still or turns round at x = {x:.6g}: gears need one that "
            "rises or falls throughout; a range of x on one side of that place is right",
            key=key,
        ) from stop


def _piece(
    part: tuple[float, float, Formula], end_rad: float, first: float, rate: float, zero: float, scale: float
) -> Piece:
    """A stretch of x as a piece of the law."""
    start, end, formula = part
    knots = proven(formula.derivative(), start, end).breaks[1:-1]
    driven_angle = partial(generated_angle, formula, first, rate, zero, scale)
    return Piece((start - first) / rate, end_rad, driven_angle, tuple(((knots - first) / rate).tolist()))


def generated_angle(
    formula: Formula, first: float, rate: float, zero: float, scale: float, phi1: Array, order: int
) -> Jet:
    """phi2 in rad, with derivatives: ``scale`` times the function less ``zero``, at x = first + rate phi1."""
    return (formula(Jet.variable(phi1, order) * rate + first) - zero) * scale


def _stop(parts: list[tuple[float, float, Formula]], least: float) -> float:
    """The x where the slope of a function first changes its sign, or ``least``, its least slope's place, at a touch."""
    for start, end, formula in parts:
        slope = formula.derivative()
        places = np.linspace(start, end, PLACES)
        turns = np.flatnonzero(np.diff(np.sign(slope.values(places))))
        if turns.size:
            return float(brentq(lambda x, of=slope: _value(of, x), places[turns[0]], places[turns[0] + 1]))
    return least


def _value(formula: Formula, x: float) -> float:
    return float(formula.values(np.array([float(x)]))[0])


def _refuse_jumps(parts: list[tuple[float, float, Formula]], key: str) -> None:
    """Refuse a jump of the function or of its slope where one formula follows another."""
    change = abs(_value(parts[-1][2], parts[-1][1]) - _value(parts[0][2], parts[0][0]))
    for (_, joint, before), (_, _, after) in pairwise(parts):
        sides = _value(before, joint), _value(after, joint)
        if not abs(sides[1] - sides[0]) <= NO_JUMP * change:
            raise NoSuchMechanism(
                f"the function jumps at x = {joint:.6g}, from {sides[0]:.9g} to {sides[1]:.9g}", key=key
            )
        slopes = _value(before.derivative(), joint), _value(after.derivative(), joint)
        if not abs(slopes[1] - slopes[0]) <= NO_JUMP * max(map(abs, slopes)):
            raise NoSuchMechanism(
                f"the function has a corner at x = {joint:.6g}, where its slope jumps from {slopes[0]:.9g} to "
                f"{slopes[1]:.9g}: the ratio of the gears would jump",
                key=key,
            )
