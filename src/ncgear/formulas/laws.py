"""The pieces of every law in closed form, written from the functions and values that make its driven angle.

A new law has a line in ``FORMS``, or a line in ``NO_FORMULA`` that says why it has no closed form.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
import sympy
from numpy.polynomial import Polynomial
from scipy.interpolate import BSpline

from ncgear.formulas import linkages
from ncgear.formulas.written import FormulaWriter, WrittenPiece, integral, polynomial, symbol
from ncgear.frozen import dataclass
from ncgear.mechanisms.driven_shaft import DrivenShaft
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.formula import Formula
from ncgear.numerics.periodic_cubic import PeriodicCubic
from ncgear.numerics.tape import ON_NUMBERS
from ncgear.ratio.laws import (
    ellipse,
    expression,
    function_generator,
    integrated,
    pitch_curve,
    row,
    spiral,
    table,
    uniform,
)
from ncgear.ratio.laws.harmonic import LogSeries
from ncgear.ratio.laws.over_driven_angle import LogRatioLaw, StagedLaw
from ncgear.ratio.laws.three_segment import approach_angle, braking_angle, pressing_angle
from ncgear.ratio.return_stroke import ReturnLaw
from ncgear.ratio.transmission import JetFunction, Lobes, Piece
from ncgear.ratio.working_stroke import ClosedStroke

INTEGRAL = "phi_2 is the integral of 1/i_12 over phi_1, which has no closed form"
OVER_DRIVEN = "phi_1 is the integral of i_12 over phi_2, which has no closed form"
SHARED = "the shafts between the pairs turn by integrals of powers of 1/i_12, which have no closed form"
ROW = "the driven angle is that of all pairs, one after the other"
TRACED = "the pitch curve is followed point by point: its radius is known by a table of its angles"


class NoFormula(Exception):
    """A law or a part of it has no closed form; the message says why."""


@dataclass(frozen=True)
class Sizes:
    """Sizes from which the radii of a pair follow: the distance of its axes, 1 if unknown, and +1 for a driven ring."""

    center_distance: float = 1.0
    sense: int = -1


@dataclass(frozen=True, eq=False)
class PiecePart:
    """A stretch of a piece as its form has written it, without the quantities that all laws have."""

    name: str
    ends: tuple[float, float]
    write: FormulaWriter
    without: str = ""


Form = Callable[..., Iterator[PiecePart]]


def mechanism(linkage: Mechanism, end_rad: float) -> WrittenPiece:
    """The displacement over the driven angle."""
    write = FormulaWriter("phi_2")
    linkages.displacement(write, linkage, write.variable)
    return write.written("mechanism", (0.0, end_rad), {})


def pieces_of(pieces: tuple[Piece, ...], linkage: Mechanism | None, sizes: Sizes | None) -> Iterator[WrittenPiece]:
    """All pieces of a law, with displacement and radii where mechanism and sizes are given; raises NoFormula."""
    for piece in pieces:
        made, arguments = _made_by(piece.driven_angle)
        if made not in FORMS:
            raise NoFormula(NO_FORMULA[made])
        for part in FORMS[made](piece, *arguments):
            yield _whole(part, linkage, sizes)


def is_first_of_two(pieces: tuple[Piece, ...]) -> bool:
    """Whether a law is that of the first of two pairs, which is written over the angle of the crank."""
    return _made_by(pieces[0].driven_angle)[0] is StagedLaw.shaft_angle


def _made_by(turned: JetFunction) -> tuple[Any, tuple[Any, ...]]:
    """The function that gives a driven angle, and the arguments bound to it."""
    if isinstance(turned, partial):
        return turned.func, turned.args
    return turned.__func__, (turned.__self__,)  # type: ignore[attr-defined]


def _whole(part: PiecePart, linkage: Mechanism | None, sizes: Sizes | None) -> WrittenPiece:
    write, x, phi_2, ratio = part.write, symbol("x"), symbol("phi_2"), symbol("i_12")
    moved = None if isinstance(linkage, DrivenShaft) else linkage
    without = {"phi_2": part.without} if part.without and write.variable != phi_2 else {}
    if moved is not None and x not in write.steps and write.variable != phi_2:
        if phi_2 in write.steps:
            linkages.displacement(write, moved, phi_2)
        else:
            without["x"] = "it follows from phi_2 by the formula of the mechanism"
    if ratio not in write.steps:
        write.step("i_12", 1 / write.slope(phi_2))
    if sizes is not None:
        a, beyond = write.number("a", sizes.center_distance), ratio - sizes.sense
        write.step("r_1", a / beyond)
        write.step("r_2", a * ratio / beyond)
    if write.variable == phi_2:
        without["phi_1"] = part.without
    return write.written(part.name, part.ends, without)


def _ends(piece: Piece) -> tuple[float, float]:
    return piece.start_rad, piece.end_rad


def _approach(piece: Piece, stroke: ClosedStroke, linkage: Mechanism) -> Iterator[PiecePart]:
    write, phi_1 = FormulaWriter("phi_1"), symbol("phi_1")
    quotient = write.step("q", polynomial(write.coefficients("q", stroke.approach_root), phi_1))
    x = write.step("x", phi_1**2 * quotient)
    left = write.step("left", sympy.sqrt(write.number("stroke", stroke.stroke_mm) - x))
    gone = write.step("gone", phi_1 * write.step("root", sympy.sqrt(quotient)))
    linkages.driven_angle(write, linkage, x, gone, left)
    yield PiecePart("approach", _ends(piece), write)


def _pressing(piece: Piece, stroke: ClosedStroke, linkage: Mechanism) -> Iterator[PiecePart]:
    write, phi_1 = FormulaWriter("phi_1"), symbol("phi_1")
    start, speed = write.number("x_2", stroke.pressing_start_mm), write.number("v", stroke.pressing_mm_rad)
    x = write.step("x", start + speed * (phi_1 - write.number("theta_2", stroke.theta2_rad)))
    left = write.step("left", sympy.sqrt(write.number("stroke", stroke.stroke_mm) - x))
    linkages.driven_angle(write, linkage, x, write.step("gone", sympy.sqrt(x)), left)
    yield PiecePart("constant speed", _ends(piece), write)


def _braking(piece: Piece, stroke: ClosedStroke, linkage: Mechanism) -> Iterator[PiecePart]:
    write = FormulaWriter("phi_1")
    before = write.step("delta", write.number("theta_4", stroke.theta4_rad) - write.variable)
    quotient = write.step("q", polynomial(write.coefficients("q", stroke.braking_root), before))
    x = write.step("x", write.number("stroke", stroke.stroke_mm) - before**2 * quotient)
    gone, root = write.step("gone", sympy.sqrt(x)), write.step("root", sympy.sqrt(quotient))
    left = write.step("left", before * root)
    linkages.driven_angle(write, linkage, x, gone, left)
    yield PiecePart("braking", _ends(piece), write)


def _return(piece: Piece, law: ReturnLaw) -> Iterator[PiecePart]:
    """The polynomial in tau, the share of the return; its coefficients ``d`` close the cycle."""
    write, ends = FormulaWriter("phi_1"), law.ends
    start, length = write.number("start", ends.start_rad), write.number("length", ends.length_rad)
    tau = write.step("tau", (write.variable - start) / length)
    about = write.number("about", law.about) if law.about else 0
    local = write.coefficients("c", law.local.coef.tolist())
    fine = write.coefficients("d", law.correction.coef.tolist())
    value = write.step("p", polynomial(local, tau - about) + polynomial(fine, tau))
    if not law.inverse:
        write.step("i_12", value)
        yield PiecePart("return", _ends(piece), write, INTEGRAL)
        return
    covered = integral(local, tau - about) - integral(local, -about) + integral(fine, tau)
    write.step("phi_2", write.number("phi_start", ends.start_driven_rad) + length * covered)
    write.step("i_12", 1 / value)
    yield PiecePart("return", _ends(piece), write)


def _even(piece: Piece, slope: float) -> Iterator[PiecePart]:
    write = FormulaWriter("phi_1")
    write.step("phi_2", write.number("w", slope) * write.variable)
    yield PiecePart("even", _ends(piece), write)


def _elliptical(piece: Piece, skew: float, phase: float, lobes: Lobes, start: float) -> Iterator[PiecePart]:
    write = FormulaWriter("phi_1")
    s = write.number("s", skew)
    around = write.step("around", lobes.driving * (write.variable - (write.number("phase", phase) if phase else 0)))
    turned = around - 2 * sympy.atan(s * sympy.sin(around) / (1 + s * sympy.cos(around)))
    write.step("phi_2", turned / lobes.driven - (write.number("phi_start", start) if start else 0))
    even = sympy.Rational(lobes.driven, lobes.driving)
    write.step("i_12", even * (1 + s**2 + 2 * s * sympy.cos(around)) / (1 - s**2))
    yield PiecePart("ellipse", _ends(piece), write)


def _spiral(piece: Piece, ratio_start: float, growth: float) -> Iterator[PiecePart]:
    write = FormulaWriter("phi_1")
    first, m = write.number("i_start", ratio_start), write.number("m", growth)
    write.step("phi_2", -sympy.log(1 - (sympy.exp(m * write.variable) - 1) / first) / m)
    write.step("i_12", (1 + first) * sympy.exp(-m * write.variable) - 1)
    yield PiecePart("spiral", _ends(piece), write)


OPERATIONS: dict[str, Callable[..., Any]] = {
    **{name: getattr(sympy, name) for name in ON_NUMBERS if hasattr(sympy, name)},
    **{"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "negative": operator.neg},
}


def in_sympy(write: FormulaWriter, formula: Formula, argument: Any) -> Any:
    """A formula without choices, operation by operation."""
    done: list[Any] = []
    for operation in formula.tape.operations:
        inputs = [done[place] for place in operation.operands]
        match operation.name:
            case "variable":
                done.append(argument)
            case "number":
                done.append(write.literal(operation.number))
            case "power":
                done.append(inputs[0] ** write.literal(operation.number))
            case name:
                done.append(OPERATIONS[name](*inputs))
    return done[-1]


def _formula_angle(piece: Piece, formula: Formula, zero: float, factor: float) -> Iterator[PiecePart]:
    write = FormulaWriter("phi_1")
    yield from _scaled(piece, write, in_sympy(write, formula, write.variable), zero, factor)


def _generated(
    piece: Piece, formula: Formula, first: float, rate: float, zero: float, by: float
) -> Iterator[PiecePart]:
    write = FormulaWriter("phi_1")
    given = write.step("u", write.number("first", first) + write.number("rate", rate) * write.variable)
    yield from _scaled(piece, write, in_sympy(write, formula, given), zero, by)


def _scaled(piece: Piece, write: FormulaWriter, turned: Any, zero: float, factor: float) -> Iterator[PiecePart]:
    less = turned - write.number("zero", zero) if zero else turned
    write.step("phi_2", less if factor == 1.0 else less * write.number("factor", factor))
    yield PiecePart("formula", _ends(piece), write)


def _integrated(piece: Piece, slope: integrated.Slope, start: float, factor: float) -> Iterator[PiecePart]:
    """Parts where 1/i12 is a formula, or a spline, with a known integral."""
    made, arguments = _made_by(slope.jets)
    if made in NO_FORMULA:
        raise NoFormula(NO_FORMULA[made])
    if made is expression.by_angle:
        write = FormulaWriter("phi_1")
        (inverse,) = arguments
        write.step("i_12", 1 / (in_sympy(write, inverse, write.variable) * _factor(write, factor)))
        yield PiecePart("formula", _ends(piece), write, INTEGRAL)
        return
    (spline,), turned = arguments, start
    for name, ends, write, u, coefficients in _splined(spline, piece):
        value = write.step("p", polynomial(coefficients, u))
        write.step("phi_2", (write.number("turned", turned) + integral(coefficients, u)) * _factor(write, factor))
        write.step("i_12", 1 / (value * _factor(write, factor)))
        yield PiecePart(name, ends, write)
        known = [write.numbers.get(coefficient, 0.0) for coefficient in coefficients]
        turned += float(Polynomial(known).integ()(ends[1] - ends[0]))


def _factor(write: FormulaWriter, factor: float) -> Any:
    return 1 if factor == 1.0 else write.number("factor", factor)


def _splined(spline: BSpline, piece: Piece) -> Iterator[tuple[str, tuple[float, float], FormulaWriter, Any, list[Any]]]:
    """Between each two knots: the distance ``u`` from the first knot, and the coefficients of its powers."""
    edges = [piece.start_rad, *piece.knots_rad, piece.end_rad]
    coefficients = table.spline_jet(spline, np.array(edges[:-1]), spline.k).coefficients
    for number, ends in enumerate(pairwise(edges)):
        write = FormulaWriter("phi_1")
        u = write.step("u", write.variable - (write.number("knot", ends[0]) if ends[0] else 0))
        yield f"piece {number + 1}", ends, write, u, write.coefficients("c", coefficients[:, number].tolist())


def _splined_angle(piece: Piece, spline: BSpline, lobes: int) -> Iterator[PiecePart]:
    for name, ends, write, u, coefficients in _splined(spline, piece):
        write.step("phi_2", lobes * write.variable + polynomial(coefficients, u))
        yield PiecePart(name, ends, write)


def _over_driven(piece: Piece, law: LogRatioLaw) -> Iterator[PiecePart]:
    lobes = law.lobes
    for name, ends, write, (f,) in _logarithms(lobes.driven, law.series):
        mean = write.number("mean", law.integral.mean)
        write.step("i_12", sympy.exp(f) * sympy.Rational(lobes.driven, lobes.driving) / mean)
        yield PiecePart(name, ends, write, OVER_DRIVEN)


def _first_of_two(piece: Piece, law: StagedLaw) -> Iterator[PiecePart]:
    for name, ends, write, (f, g) in _logarithms(1, law.whole.series, law.second.series):
        means = write.number("mean_f", law.whole.integral.mean), write.number("mean_g", law.second.integral.mean)
        write.step("i_12", sympy.exp(f - g) * means[1] / means[0])
        yield PiecePart(name, ends, write, OVER_DRIVEN)


def _logarithms(lobes: int, *series: Any) -> Iterator[tuple[str, tuple[float, float], FormulaWriter, list[Any]]]:
    """ln i12 without its constant, of one series or of two over the same angles."""
    end = 2.0 * pi / lobes
    if all(isinstance(logarithm, LogSeries) for logarithm in series):
        write = FormulaWriter("phi_2")
        yield "series", (0.0, end), write, [_harmonics(write, *n, lobes) for n in zip(series, "fg", strict=False)]
        return
    knots = series[0].knots.tolist()
    for number, (first, last) in enumerate(pairwise(knots)):
        write = FormulaWriter("phi_2")
        u = write.step("u", lobes * write.variable - (write.number("knot", first) if first else 0))
        found = []
        for logarithm, name in zip(series, "fg", strict=False):
            assert isinstance(logarithm, PeriodicCubic)
            coefficients = write.coefficients(name, logarithm.coefficients[:, number].tolist())
            found.append(write.step(name, polynomial(coefficients, u)))
        yield f"piece {number + 1}", (first / lobes, last / lobes), write, found


def _harmonics(write: FormulaWriter, series: LogSeries, name: str, lobes: int) -> Any:
    parts = {"c": (sympy.cos, series.cosine.tolist()), "s": (sympy.sin, series.sine.tolist())}
    terms = [
        of(k * lobes * write.variable) * coefficient
        for kind, (of, values) in parts.items()
        for k, coefficient in enumerate(write.coefficients(f"{name}_{kind}", values, 1), start=1)
    ]
    return write.step(name, sympy.Add(*terms))


FORMS: dict[Any, Form] = {
    approach_angle: _approach,
    pressing_angle: _pressing,
    braking_angle: _braking,
    ReturnLaw.driven_angle: _return,
    uniform.even_angle: _even,
    ellipse.elliptical_angle: _elliptical,
    spiral.spiral_angle: _spiral,
    expression.formula_angle: _formula_angle,
    function_generator.generated_angle: _generated,
    integrated.integrated_angle: _integrated,
    table.splined_angle: _splined_angle,
    LogRatioLaw.driven_angle: _over_driven,
    StagedLaw.shaft_angle: _first_of_two,
}
"""Writers of the pieces of a law, by the function that makes its driven angle."""

NO_FORMULA: dict[Any, str] = {
    pitch_curve.rolled: TRACED,
    pitch_curve.inverted_angle: TRACED,
    row.shared_angle: SHARED,
    row.row_angle: ROW,
}
"""Why a law has no closed form, by the function that makes its driven angle or its slope."""
