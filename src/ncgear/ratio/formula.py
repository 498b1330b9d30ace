"""Expressions in ``phi``: read through a whitelist of Python's own grammar, differentiated and compiled by sympy.

The text is never evaluated.  It is parsed to a syntax tree of which only numbers, ``phi``, ``pi``, the four operations,
powers with constant exponents and the functions listed below are translated; anything else is refused by name.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

if TYPE_CHECKING:
    import sympy

FUNCTIONS = ("sin", "cos", "tan", "exp", "log", "sqrt", "atan", "sinh", "cosh", "tanh")
NAMES = ("phi", "pi")
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
LONGEST, DEEPEST, LARGEST_POWER = 1000, 40, 64


def compiled(text: str, order: int, key: str) -> Callable[[Array], Jet]:
    """A function of phi (shape (n,)) that returns the expression's jet of ``order``.

    Raises WrongInput, naming ``key`` and the offending name or construct, for anything outside the whitelist.
    """
    import sympy  # heavy, and needed by this law only

    phi = sympy.Symbol("phi", real=True)
    expression = _Translator(sympy, phi, key).translated(text)
    derivatives = [expression]
    for _ in range(order):
        derivatives.append(sympy.diff(derivatives[-1], phi))
    scaled = [term / math.factorial(k) for k, term in enumerate(derivatives)]
    function = sympy.lambdify(phi, scaled, modules="numpy", cse=True)

    def jet(points: Array) -> Jet:
        with np.errstate(all="ignore"):
            rows = function(points)
        return Jet(np.array([np.broadcast_to(np.asarray(row, dtype=float), points.shape) for row in rows]))

    return jet


class _Translator:
    """Syntax tree to sympy, one whitelisted node at a time."""

    def __init__(self, sympy: Any, phi: sympy.Symbol, key: str) -> None:
        self._sympy, self._key = sympy, key
        self._names = {"phi": phi, "pi": sympy.pi}

    def translated(self, text: str) -> Any:
        if len(text) > LONGEST:
            raise WrongInput(f"an expression of {len(text)} characters; at most {LONGEST} are read", key=self._key)
        try:
            tree = ast.parse(text.strip(), mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError) as fault:
            raise WrongInput(
                f"{text!r} is not an expression: {fault}; example: 1 + 0.3*cos(phi)", key=self._key
            ) from None
        return self._node(tree.body, 0)

    def _node(self, node: ast.AST, depth: int) -> Any:
        if depth > DEEPEST:
            raise self._refusal(f"nested more than {DEEPEST} deep")
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
            return self._number(float(node.value))
        if isinstance(node, ast.Name):
            return self._name(node.id)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
            inner = self._node(node.operand, depth + 1)
            return -inner if isinstance(node.op, ast.USub) else inner
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return self._operation(node, depth)
        if isinstance(node, ast.Call):
            return self._call(node, depth)
        raise self._refusal(f"{ast.unparse(node)!r} is not allowed")

    def _number(self, value: float) -> Any:
        if not math.isfinite(value):
            raise self._refusal(f"{value} is not a finite number")
        return (
            self._sympy.Integer(int(value))
            if value.is_integer() and abs(value) < 1e15
            else self._sympy.Float(value, 17)
        )

    def _name(self, name: str) -> Any:
        if name not in self._names:
            raise self._refusal(f"unknown name {name!r}")
        return self._names[name]

    def _operation(self, node: ast.BinOp, depth: int) -> Any:
        left, right = self._node(node.left, depth + 1), self._node(node.right, depth + 1)
        if isinstance(node.op, ast.Pow):
            if right.free_symbols or not abs(float(right)) <= LARGEST_POWER:
                raise self._refusal(
                    f"a power must be a number of at most {LARGEST_POWER}, not {ast.unparse(node.right)!r}"
                )
            return left**right if left.free_symbols else self._number(self._constant(left, right))
        symbol = OPERATORS[type(node.op)]
        if symbol == "/" and right == 0:
            raise self._refusal("division by zero")
        return {"+": left + right, "-": left - right, "*": left * right, "/": left / right if right != 0 else None}[
            symbol
        ]

    def _constant(self, base: Any, power: Any) -> float:
        """A constant power in floating point: exact integers could grow without bound."""
        try:
            return float(float(base) ** float(power))
        except (OverflowError, ZeroDivisionError, TypeError):
            raise self._refusal(f"{base}**{power} is not a finite number") from None

    def _call(self, node: ast.Call, depth: int) -> Any:
        if not (isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS):
            raise self._refusal(f"unknown function {ast.unparse(node.func)!r}")
        if len(node.args) != 1 or node.keywords:
            raise self._refusal(f"{node.func.id} takes one argument")
        return getattr(self._sympy, node.func.id)(self._node(node.args[0], depth + 1))

    def _refusal(self, problem: str) -> WrongInput:
        allowed = f"known are the names {', '.join(NAMES)}, the functions {', '.join(FUNCTIONS)} and + - * / **"
        return WrongInput(f"{problem}; {allowed}", key=self._key)
