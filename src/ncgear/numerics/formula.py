"""Expressions in one variable: read through a whitelist of Python's grammar, run and differentiated by jets.

The text is never evaluated.  It is parsed to a syntax tree; only numbers, the variable, ``pi``, the four operations,
powers with constant exponents, the functions listed below and a condition between two expressions are accepted;
anything else is refused by name.  The accepted text becomes a tape of operations in the order in which they are
written: a formula is rewritten only where operations on numbers are done at once, and where the root of an even power
becomes an absolute value.  The tape runs on Taylor arithmetic, so derivatives cost no more than the text is long, and
on discs, so no feature of the formula stays unseen (``ncgear.numerics.proven``).

A Python function is written down as such text by calling it once with a symbol.  This works for functions that do
arithmetic and call functions of numpy; a function that needs the number itself, as ``math.sin``, ``if`` and tables do,
cannot be written down.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.discs import DISC_FUNCTIONS, Disc
from ncgear.numerics.jet import Jet
from ncgear.numerics.tape import NotReal, Tape, TapeWriter

FUNCTIONS: dict[str, Callable[[Jet], Jet]] = {
    "sin": lambda argument: jet.sin_cos(argument)[0],
    "cos": lambda argument: jet.sin_cos(argument)[1],
    "tan": lambda argument: jet.sin_cos(argument)[0] / jet.sin_cos(argument)[1],
    "exp": jet.exp,
    "log": jet.log,
    "sqrt": jet.sqrt,
    "atan": jet.arctan,
    "sinh": lambda argument: jet.sinh_cosh(argument)[0],
    "cosh": lambda argument: jet.sinh_cosh(argument)[1],
    "tanh": jet.tanh,
}
CHOICES: dict[str, int] = {"abs": 1, "sign": 1, "min": 2, "max": 2}
"""Functions that change from one expression to another, with the number of their arguments."""

LONGEST, DEEPEST, LARGEST_POWER = 1000, 40, 64
"""Most characters, most levels of nesting and the largest exponent that an expression may have."""

HUGE, MODERATE = 1e200, 1e100
"""A number below MODERATE divided by a number above HUGE is zero by every tolerance of a design."""

SHOWN = 40
"""Most characters of a formula that a refusal repeats."""


@dataclass(frozen=True)
class Formula:
    """A function of one variable; each method takes the variable as an array, a jet or discs."""

    tape: Tape

    def __call__(self, argument: Jet) -> Jet:
        """The function's jet for the jet of its argument; not finite where the function has no value."""
        with np.errstate(all="ignore"):
            result = self.tape.run(argument, _JET_FUNCTIONS)
        return result if isinstance(result, Jet) else argument * 0.0 + float(result)

    def values(self, points: Array) -> Array:
        """The function's values at points of shape (n,)."""
        return self(Jet(points[None, :])).value

    def spread(self, center: Array, radius: Array, *, real: bool) -> Array:
        """Greatest distance of values on discs about ``center`` (n,) from some number; inf where unknown.  No choices.

        A finite spread proves the function analytic on the disc; with ``real`` it proves only the spread of
        real values.
        """
        with np.errstate(all="ignore"):
            result = self.tape.run(Disc.about(center, radius, real=real), DISC_FUNCTIONS)
        return result.radius if isinstance(result, Disc) else np.zeros_like(center)

    @property
    def condition(self) -> Formula | None:
        """Formula whose changes of sign change the function's expression; None for a function of one expression."""
        found = self.tape.first_condition
        return None if found is None else Formula(found)

    def where(self, *, negative: bool) -> Formula:
        """The function where its ``condition`` is negative, or where it is not."""
        return Formula(self.tape.chosen(negative))

    def reciprocal(self) -> Formula:
        """One divided by the function."""
        return Formula(self.tape.reciprocal())

    def from_end(self, end: float, width: float) -> Formula:
        """The function of u, the variable being ``end + width u**2``: a root at the end becomes a power of u."""
        writer = TapeWriter()
        square = writer.power(writer.variable(), 2.0)
        place = writer.apply("+", writer.number(end), writer.apply("*", writer.number(width), square))
        return Formula(self.tape.of(writer.tape(place)))

    def derivative(self) -> Formula:
        """The derivative by the variable."""
        return Formula(self.tape.derivative())


def composed(text: str, key: str, variable: str) -> Formula:
    """The formula of an expression; raises WrongInput, naming ``key``, for anything outside the whitelist."""
    return Formula(_Reader(variable, key, text).tape())


def _quotient(over: Jet | float, under: Jet | float) -> Jet:
    """A quotient of jets or numbers; a quotient by a huge number, whose derivatives overflow, is zero."""
    result = over / under
    assert isinstance(result, Jet)
    if not isinstance(under, Jet):
        return result
    value = over.value if isinstance(over, Jet) else over
    return Jet(np.where((np.abs(under.value) > HUGE) & (np.abs(value) < MODERATE), 0.0, result.coefficients))


def _either(condition: Jet, negative: Jet | float, otherwise: Jet | float) -> Jet:
    sides = [side if isinstance(side, Jet) else condition * 0.0 + side for side in (negative, otherwise)]
    return Jet(np.where(condition.value < 0.0, sides[0].coefficients, sides[1].coefficients))


_JET_FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    **FUNCTIONS,
    "/": _quotient,
    "power": lambda base, exponent: base**exponent,
    "choice": _either,
}

_OPERATIONS: dict[type, str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}


class _Reader:
    """Syntax tree to tape, one whitelisted node at a time."""

    def __init__(self, variable: str, key: str, text: str) -> None:
        self._variable, self._key, self._text = variable, key, text.strip()
        self._writer = TapeWriter()

    def tape(self) -> Tape:
        if len(self._text) > LONGEST:
            raise WrongInput(
                f"an expression of {len(self._text)} characters; at most {LONGEST} are read", key=self._key
            )
        try:
            tree = ast.parse(self._text, mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError) as fault:
            said = fault.msg if isinstance(fault, SyntaxError) else fault
            problem = f"{self._text!r} is not an expression: {said}; example: 1 + 0.3*cos({self._variable})"
            raise WrongInput(problem, key=self._key) from None
        return self._writer.tape(self._node(tree.body, 0))

    def _node(self, node: ast.expr, depth: int) -> int:
        if depth > DEEPEST:
            raise self._refusal(f"nested more than {DEEPEST} deep")
        try:
            return self._place(node, depth)
        except NotReal:
            raise self._refusal(f"{self._written(node)} is not a finite real number") from None

    def _place(self, node: ast.expr, depth: int) -> int:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
            return self._writer.number(node.value)
        if isinstance(node, ast.Name):
            if node.id == self._variable:
                return self._writer.variable()
            if node.id != "pi":
                raise self._refusal(f"unknown name {node.id[:SHOWN]!r}")
            return self._writer.number(math.pi)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            inner = self._node(node.operand, depth + 1)
            return self._writer.apply("negative", inner) if isinstance(node.op, ast.USub) else inner
        if isinstance(node, ast.BinOp):
            return self._chain(node, depth)
        if isinstance(node, ast.Call):
            return self._call(node, depth)
        if isinstance(node, ast.IfExp):
            return self._conditional(node, depth)
        if isinstance(node, ast.Tuple):
            raise self._refusal(f"{self._written(node)} is not allowed: the decimal sign is a point, not a comma")
        if isinstance(node, ast.Compare | ast.BoolOp):
            advice = "a condition stands as in a if u < v else b"
            raise self._refusal(f"{self._written(node)} is not allowed: {advice}")
        raise self._refusal(f"{self._written(node)} is not allowed")

    def _chain(self, node: ast.BinOp, depth: int) -> int:
        """Does the operations of the left side one after the other, so that a long sum does not count as deep."""
        links: list[ast.BinOp] = []
        first: ast.expr = node
        while isinstance(first, ast.BinOp):
            links.append(first)
            first = first.left
        value = self._node(first, depth + 1)
        for link in reversed(links):
            try:
                value = self._operation(link, value, self._node(link.right, depth + 1))
            except NotReal:
                raise self._refusal(f"{self._written(link)} is not a finite real number") from None
        return value

    def _operation(self, node: ast.BinOp, left: int, right: int) -> int:
        if isinstance(node.op, ast.Pow):
            exponent = self._writer.constant(right)
            if exponent is None or abs(exponent) > LARGEST_POWER:
                written = self._written(node.right)
                raise self._refusal(f"a power must be a number of at most {LARGEST_POWER}, not {written}")
            return self._writer.power(left, exponent)
        name = _OPERATIONS.get(type(node.op))
        if isinstance(node.op, ast.BitXor):
            raise self._refusal(f"{self._written(node)} is not allowed: a power is written with **, not with ^")
        if name is None:
            raise self._refusal(f"{self._written(node)} is not allowed")
        if name == "/" and self._writer.constant(right) == 0.0:
            raise self._refusal("division by zero")
        return self._writer.apply(name, left, right)

    def _call(self, node: ast.Call, depth: int) -> int:
        if not (isinstance(node.func, ast.Name) and node.func.id in {**FUNCTIONS, **CHOICES}):
            raise self._refusal(f"unknown function {self._written(node.func)}")
        name = node.func.id
        count = CHOICES.get(name, 1)
        if len(node.args) != count or node.keywords or any(isinstance(part, ast.Starred) for part in node.args):
            raise self._refusal(f"{name} takes {'one argument' if count == 1 else 'two arguments'}")
        places = [self._node(part, depth + 1) for part in node.args]
        writer = self._writer
        match name:
            case "abs":
                return writer.absolute(places[0])
            case "sign":
                return writer.choice(places[0], writer.number(-1.0), writer.number(1.0))
            case "min":
                return writer.choice(writer.apply("-", *places), *places)
            case "max":
                return writer.choice(writer.apply("-", *places), places[1], places[0])
        return writer.apply(name, *places)

    def _conditional(self, node: ast.IfExp, depth: int) -> int:
        """``a if u < v else b``; at u = v itself both must agree anyway."""
        test = node.test
        if not (isinstance(test, ast.Compare) and len(test.ops) == 1 and type(test.ops[0]) in _LESS):
            advice = "one of < <= > >= between two expressions is, and another condition can stand in a or b"
            raise self._refusal(f"{self._written(test)} is no condition; {advice}")
        left, right = self._node(test.left, depth + 1), self._node(test.comparators[0], depth + 1)
        sides = self._node(node.body, depth + 1), self._node(node.orelse, depth + 1)
        low, high = (left, right) if _LESS[type(test.ops[0])] else (right, left)
        return self._writer.choice(self._writer.apply("-", low, high), *sides)

    def _written(self, node: ast.AST) -> str:
        """A part of the formula as it was written; of a long part the beginning."""
        text = ast.get_source_segment(self._text, node) or self._text
        return repr(text if len(text) <= SHOWN else text[:SHOWN] + "...")

    def _refusal(self, problem: str) -> WrongInput:
        functions = ", ".join([*FUNCTIONS, *CHOICES])
        allowed = (
            f"known are the names {self._variable}, pi, the functions {functions}, + - * / ** and a if u < v else b"
        )
        return WrongInput(f"{problem}; {allowed}", key=self._key)


_LESS: dict[type, bool] = {ast.Lt: True, ast.LtE: True, ast.Gt: False, ast.GtE: False}
"""The comparisons, and whether the left side is the smaller one."""


SAME_NAMES = ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "sign")
SYMBOLIC = {getattr(np, name): name for name in SAME_NAMES}
SYMBOLIC |= {np.arctan: "atan", np.absolute: "abs", np.minimum: "min", np.maximum: "max"}
OPERATIONS = {np.add: "+", np.subtract: "-", np.multiply: "*", np.true_divide: "/", np.power: "**"}


class NotTraced(TypeError):
    """The function does something with its argument that no formula has; its text says what."""


class Symbol(NDArrayOperatorsMixin):
    """A variable or a result, as the text of a formula."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Symbol:
        parts = [_text(operand) for operand in inputs]
        if method == "__call__" and not kwargs:
            if ufunc in SYMBOLIC:
                return Symbol(f"{SYMBOLIC[ufunc]}({', '.join(parts)})")
            if ufunc in OPERATIONS:
                return Symbol(f"({parts[0]} {OPERATIONS[ufunc]} {parts[1]})")
            if ufunc is np.negative:
                return Symbol(f"(-{parts[0]})")
            if ufunc is np.square:
                return Symbol(f"({parts[0]} ** 2)")
        raise NotTraced(f"numpy.{ufunc.__name__} is no function of formulas")

    def __bool__(self) -> bool:
        raise NotTraced("it decides by the number itself")


def _text(value: Any) -> str:
    if isinstance(value, Symbol):
        return value.text
    if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        return repr(float(value)) if value >= 0 else f"({float(value)!r})"
    raise NotTraced(f"it combines its argument with {type(value).__name__}")


def formula_of(function: Callable[[Any], Any], variable: str) -> str:
    """The formula of a function of one variable, named ``variable``; raises NotTraced where it has none."""
    try:
        return _text(function(Symbol(variable)))
    except NotTraced:
        raise
    except (TypeError, ValueError, AttributeError, IndexError) as fault:
        raise NotTraced(f"it needs numbers: {fault}") from fault
