"""Expressions in one variable: read through a whitelist of Python's grammar, compiled by sympy, differentiated by jets.

The text is never evaluated.  It is parsed to a syntax tree of which only numbers, the variable, ``pi``, the four
operations, powers with constant exponents and the functions listed below are translated; anything else is refused by
name.  The compiled expression runs on Taylor arithmetic, so that derivatives cost no more than the text is long.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

if TYPE_CHECKING:
    import sympy

FUNCTIONS: dict[str, Callable[[Jet], Jet]] = {
    "sin": lambda argument: jet.sin_cos(argument)[0],
    "cos": lambda argument: jet.sin_cos(argument)[1],
    "tan": lambda argument: jet.sin_cos(argument)[0] / jet.sin_cos(argument)[1],
    "exp": jet.exp,
    "log": jet.log,
    "sqrt": jet.sqrt,
    "atan": jet.arctan,
    "sinh": lambda argument: (jet.exp(argument) - jet.exp(-argument)) * 0.5,
    "cosh": lambda argument: (jet.exp(argument) + jet.exp(-argument)) * 0.5,
    "tanh": lambda argument: 1.0 - 2.0 / (jet.exp(2.0 * argument) + 1.0),
}
LONGEST, DEEPEST, LARGEST_POWER = 1000, 40, 64
"""Most characters, most levels of nesting and the largest exponent that an expression may have."""

LONGEST_SHOWN = 40
"""Characters of a part of an expression in a message."""

WHOLE = 1e15
"""Whole numbers up to here are kept as such; larger ones are not all exact in floating point anyway."""


def compiled(text: str, key: str) -> Callable[[Array, int], Jet]:
    """A function of phi (shape (n,)) and an order that returns the expression's jet.

    Raises WrongInput, naming ``key`` and the offending name or construct, for anything outside the whitelist.
    """
    function = composed(text, key, "phi")

    def evaluated(points: Array, order: int) -> Jet:
        return function(Jet.variable(points, order))

    return evaluated


def composed(text: str, key: str, variable: str) -> Callable[[Jet], Jet]:
    """A function from the jet of ``variable`` to the expression's jet; raises the same errors as ``compiled``."""
    import sympy  # heavy, and needed by expressions only

    symbol = sympy.Symbol(variable, real=True)
    expression = _Translator(sympy, symbol, key).translated(text)
    function = sympy.lambdify(symbol, expression, modules=[FUNCTIONS])

    def evaluated(argument: Jet) -> Jet:
        with np.errstate(all="ignore"):
            result = function(argument)
        return result if isinstance(result, Jet) else argument * 0.0 + float(result)

    return evaluated


class _Translator:
    """Syntax tree to sympy, one whitelisted node at a time; constants are folded in floating point as they arise."""

    def __init__(self, sympy: Any, symbol: sympy.Symbol, key: str) -> None:
        self._sympy, self._key, self._text = sympy, key, ""
        self._names = {symbol.name: symbol, "pi": sympy.Float(math.pi, 17)}

    def translated(self, text: str) -> Any:
        if len(text) > LONGEST:
            raise WrongInput(f"an expression of {len(text)} characters; at most {LONGEST} are read", key=self._key)
        try:
            self._text = text.strip()
            tree = ast.parse(self._text, mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError) as fault:
            problem = f"{text!r} is not an expression: {fault}; example: 1 + 0.3*cos({next(iter(self._names))})"
            raise WrongInput(problem, key=self._key) from None
        return self._node(tree.body, 0)

    def _node(self, node: ast.AST, depth: int) -> Any:
        if depth > DEEPEST:
            raise self._refusal(f"nested more than {DEEPEST} deep")
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
            return self._number(node.value)
        if isinstance(node, ast.Name):
            if node.id not in self._names:
                raise self._refusal(f"unknown name {node.id!r}")
            return self._names[node.id]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            inner = self._node(node.operand, depth + 1)
            return -inner if isinstance(node.op, ast.USub) else inner
        if isinstance(node, ast.BinOp):
            return self._chain(node, depth)
        if isinstance(node, ast.Call):
            return self._call(node, depth)
        raise self._refusal(f"{self._written(node)!r} is not allowed")

    def _number(self, value: Any) -> Any:
        """A finite real number; whole ones stay whole, so that powers stay powers."""
        try:
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            number = math.nan
        if not math.isfinite(number):
            raise self._refusal(f"{str(value)[:LONGEST_SHOWN]} is not a finite real number")
        if number.is_integer() and abs(number) < WHOLE:
            return self._sympy.Integer(int(number))
        return self._sympy.Float(number, 17)

    def _chain(self, node: ast.BinOp, depth: int) -> Any:
        """Works off the operations of the left side one after the other, so that a long sum does not count as deep."""
        links: list[ast.BinOp] = []
        first: ast.expr = node
        while isinstance(first, ast.BinOp):
            links.append(first)
            first = first.left
        value = self._node(first, depth + 1)
        for link in reversed(links):
            value = self._settled(self._operation(link, value, self._node(link.right, depth + 1)))
        return value

    def _operation(self, node: ast.BinOp, left: Any, right: Any) -> Any:
        match node.op:
            case ast.Add():
                return left + right
            case ast.Sub():
                return left - right
            case ast.Mult():
                return left * right
            case ast.Div() if right == 0:
                raise self._refusal("division by zero")
            case ast.Div():
                return left / right
            case ast.Pow() if not right.free_symbols and abs(float(right)) <= LARGEST_POWER:
                return left**right
            case ast.Pow():
                written = self._written(node.right)
                raise self._refusal(f"a power must be a number of at most {LARGEST_POWER}, not {written!r}")
        raise self._refusal(f"{self._written(node)!r} is not allowed")

    def _call(self, node: ast.Call, depth: int) -> Any:
        if not (isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS):
            raise self._refusal(f"unknown function {self._written(node.func)!r}")
        if len(node.args) != 1 or node.keywords:
            raise self._refusal(f"{node.func.id} takes one argument")
        return self._settled(getattr(self._sympy, node.func.id)(self._node(node.args[0], depth + 1)))

    def _settled(self, value: Any) -> Any:
        """The value with constants in floating point; what is not real and finite is refused where it arises."""
        if not value.free_symbols:
            return self._number(value)
        if value.has(self._sympy.I, self._sympy.zoo, self._sympy.oo, -self._sympy.oo, self._sympy.nan):
            raise self._refusal(f"{str(value)[:LONGEST_SHOWN]} is not a real expression")
        return value

    def _written(self, node: ast.AST) -> str:
        """The text of a part, shortened; a tree of any depth has one, where ``ast.unparse`` would nest as deep."""
        return (ast.get_source_segment(self._text, node) or "")[:LONGEST_SHOWN]

    def _refusal(self, problem: str) -> WrongInput:
        allowed = f"known are the names {', '.join(self._names)}, the functions {', '.join(FUNCTIONS)} and + - * / **"
        return WrongInput(f"{problem}; {allowed}", key=self._key)
