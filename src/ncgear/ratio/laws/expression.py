"""A law written as an expression in ``phi``: the ratio i12 itself, or the driven angle phi2.

Where an expression changes from one form to another, as ``abs`` and ``max`` do, the law has a joint.  The ratio must be
continuous there and at the seam.  Its slope may jump, though pitch curves refuse that (``ncgear.pitch.pair``). A law of
gears that turn less than once holds for a range of the driving angle, and has no seam.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.formula import Formula, composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.proven import proven, smooth_parts
from ncgear.numerics.tape import NotReal
from ncgear.numerics.units import in_words
from ncgear.ratio.laws import integrated
from ncgear.ratio.transmission import JetFunction, Lobes, OpenRange, Piece, Transmission

NO_JUMP = 1e-9
"""Relative difference of the ratio on both sides of a joint that counts as rounding to ten written digits."""


def ratio_expression_law(text: str, lobes: Lobes, *, scale_to_close: bool) -> Transmission:
    """The law of a ratio i12(phi); raises WrongInput or NoSuchMechanism for the key ``motion.ratio``."""
    key = "motion.ratio"
    parts = _parts(composed(text, key, "phi"), lobes, key)
    _refuse_jumps([(start, end, partial(by_angle, ratio)) for start, end, ratio in parts], "the ratio", lobes, key)
    slopes = [_inverse(ratio, start, end, key) for start, end, ratio in parts]
    return integrated.integrated_law(slopes, lobes, scale_to_close=scale_to_close, key=key)


def open_ratio_law(text: str, driving_rad: float) -> Transmission:
    """The law of a ratio i12(phi) from phi = 0 to ``driving_rad``; raises as ``ratio_expression_law``."""
    key = "motion.ratio"
    parts = _open_parts(text, driving_rad, key)
    _refuse_jumps([(start, end, partial(by_angle, ratio)) for start, end, ratio in parts], "the ratio", None, key)
    slopes = [_inverse(ratio, start, end, key) for start, end, ratio in parts]
    starts = np.cumsum([0.0, *(slope.integral.final for slope in slopes)])
    pieces = tuple(integrated.stretched(slope, float(start), 1.0) for slope, start in zip(slopes, starts, strict=False))
    integrated.refuse_without_turn(float(starts[-1]), "range", key)
    return Transmission(pieces, OpenRange(driving_rad=driving_rad, driven_rad=float(starts[-1])))


def open_driven_angle_law(text: str, driving_rad: float) -> Transmission:
    """The law of a driven angle phi2(phi) from phi = 0 to ``driving_rad``, shifted so that phi2 = 0 at phi1 = 0."""
    key = "motion.driven_angle"
    parts = _open_parts(text, driving_rad, key)
    _refuse_jumping_angle(parts, key)
    _refuse_jumps([(start, end, _slope_of(angle)) for start, end, angle in parts], "dphi2/dphi1", None, key)
    start, end = _value(parts[0][2], 0.0), _value(parts[-1][2], driving_rad)
    if not end > start:
        raise NoSuchMechanism(
            f"the driven angle goes from {start:.6g} to {end:.6g} rad over the range; it must grow", key=key
        )
    covered = OpenRange(driving_rad=driving_rad, driven_rad=end - start)
    return Transmission(tuple(_angle_piece(part, start, 1.0, key) for part in parts), covered)


def driven_angle_expression_law(text: str, lobes: Lobes) -> Transmission:
    """The law of a driven angle phi2(phi), shifted so that phi2 = 0 at phi1 = 0; key ``motion.driven_angle``."""
    key = "motion.driven_angle"
    parts = _parts(composed(text, key, "phi"), lobes, key)
    _refuse_jumping_angle(parts, key)
    _refuse_jumps([(start, end, _slope_of(angle)) for start, end, angle in parts], "dphi2/dphi1", lobes, key)
    start, end = _value(parts[0][2], 0.0), _value(parts[-1][2], lobes.driving_period_rad)
    if not abs(end - start - lobes.driven_period_rad) <= integrated.NEARLY_CLOSED * lobes.driven_period_rad:
        raise NoSuchMechanism(
            f"the cycle does not close: the driven angle grows by {end - start:.12g} rad over a cycle, "
            f"and must grow by {lobes.driven_period_rad:.12g}{integrated.closing_lobes(end - start, lobes)}",
            key=key,
        )
    factor = lobes.driven_period_rad / (end - start)
    return Transmission(tuple(_angle_piece(part, start, factor, key) for part in parts), lobes)


_Part = tuple[float, float, Formula]
"""A stretch of the period, from start to end in rad, with the expression there."""


def _parts(formula: Formula, lobes: Lobes, key: str) -> list[_Part]:
    with integrated.smooth_or_refused(key):
        return smooth_parts(formula, 0.0, lobes.driving_period_rad)


def _open_parts(text: str, driving_rad: float, key: str) -> list[_Part]:
    with integrated.smooth_or_refused(key):
        return smooth_parts(composed(text, key, "phi"), 0.0, driving_rad)


def _inverse(ratio: Formula, start: float, end: float, key: str) -> integrated.Slope:
    """The slope 1/i12 of a ratio."""
    try:
        inverse = ratio.reciprocal()
    except NotReal:
        raise NoSuchMechanism("the ratio is zero; it must be positive over the whole cycle", key=key) from None
    with integrated.smooth_or_refused(key):
        return integrated.Slope(partial(by_angle, inverse), proven(inverse, start, end).integrated())


def _angle_piece(part: _Part, zero: float, factor: float, key: str) -> Piece:
    """A stretch of a driven angle; its knots are the breaks that resolve its slope."""
    start, end, angle = part
    with integrated.smooth_or_refused(key):
        knots = proven(angle.derivative(), start, end).breaks[1:-1]
    return Piece(start, end, partial(formula_angle, angle, zero, factor), tuple(knots.tolist()))


def formula_angle(formula: Formula, zero: float, factor: float, phi1: Array, order: int) -> Jet:
    """phi2 in rad, with derivatives: a factor times a formula of phi1 less ``zero``."""
    return (by_angle(formula, phi1, order) - zero) * factor


def by_angle(formula: Formula, phi1: Array, order: int) -> Jet:
    """A formula of phi1 with derivatives."""
    return formula(Jet.variable(phi1, order))


def _slope_of(angle: Formula) -> JetFunction:
    return lambda phi1, order: angle(Jet.variable(phi1, order + 1)).differentiated()


def _value(formula: Formula, phi1: float) -> float:
    return float(formula.values(np.array([phi1]))[0])


def _refuse_jumping_angle(parts: Sequence[_Part], key: str) -> None:
    for (_, joint, before), (_, _, after) in pairwise(parts):
        sides = _value(before, joint), _value(after, joint)
        if not abs(sides[1] - sides[0]) <= NO_JUMP * max(1.0, *map(abs, sides)):
            raise NoSuchMechanism(
                f"the driven angle jumps at phi1 = {in_words(joint)}, from {sides[0]:.9g} to {sides[1]:.9g} rad",
                key=key,
            )


def _refuse_jumps(parts: Sequence[tuple[float, float, JetFunction]], named: str, lobes: Lobes | None, key: str) -> None:
    """Refuse a ratio, ``named`` so, with a jump or an infinite slope or curvature at a joint or at the seam.

    A jump of the ratio would be a jump of the slider's velocity.  Without ``lobes`` there is no seam.
    """
    meeting = pairwise(parts) if lobes is None else zip([parts[-1], *parts[:-1]], parts, strict=True)
    for (_, end, before), (start, _, after) in meeting:
        sides = [jets(np.array([phi1]), 2).coefficients[:, 0] for jets, phi1 in ((before, end), (after, start))]
        ratio, next_ratio = (float(side[0]) for side in sides)
        size = max(abs(ratio), abs(next_ratio))
        seam = start == 0.0
        place = "where the cycle begins again, at phi1 = 0" if seam else f"at phi1 = {in_words(start)}"
        problem = None
        if not np.isfinite(size):
            ends = "at the cycle's ends, phi1 = 0 or its period" if seam else place
            problem = f"the expression has no finite value {ends}"
        elif abs(next_ratio - ratio) > NO_JUMP * size:
            wanted = f"; an expression of period {lobes.driving_period_rad:.6g} rad is needed" if seam and lobes else ""
            problem = f"{named} jumps {place}: it goes from {ratio:.9g} before it to {next_ratio:.9g} after it{wanted}"
        elif not np.all(np.isfinite(sides)):
            problem = f"{named} has an infinite slope or curvature {place}; the pitch curves would have a point there"
        if problem:
            raise NoSuchMechanism(problem, key=key)
