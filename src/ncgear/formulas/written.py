"""A piece of a law as numbers and expressions of sympy, in order; each uses the variable and the symbols before it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import Any

import mpmath
import sympy

from ncgear.frozen import dataclass

QUANTITIES = {
    "x": "displacement",
    "phi_2": "driven_angle",
    "i_12": "ratio",
    "r_1": "driving_radius",
    "r_2": "driven_radius",
}
"""Quantities of a piece that are told where they have a closed form, and their words."""

DIGITS = 50

LARGEST_WHOLE = 1e9
"""Whole numbers up to it are told as whole numbers, larger ones with a point, as the language C needs it."""


def symbol(name: str) -> Any:
    """The real symbol of a name."""
    return sympy.Symbol(name, real=True)


@dataclass(frozen=True, eq=False)
class WrittenPiece:
    """A piece from ``start_rad`` to ``end_rad`` of its variable, phi_1 or phi_2.

    ``numbers`` are the numbers with which the law itself computes.  ``steps`` are expressions by their symbols, in the
    order of computation; their only literal numbers are whole numbers and quotients of them.  The name of a number in a
    user's formula is its digits.  ``without`` has the quantities without closed form, and why.
    """

    name: str
    variable: Any
    start_rad: float
    end_rad: float
    numbers: Mapping[Any, float]
    steps: Mapping[Any, Any]
    without: Mapping[str, str]

    @property
    def quantities(self) -> tuple[str, ...]:
        """The names of the quantities with a closed form."""
        return tuple(name for name in QUANTITIES if symbol(name) in self.steps)

    def needed(self, name: str) -> list[Any]:
        """The symbols of steps and numbers that a quantity needs, in order, its own symbol last."""
        wanted = {symbol(name)}
        for step_name in reversed(list(self.steps)):
            if step_name in wanted:
                wanted |= self.steps[step_name].free_symbols
        return [name for name in (*self.numbers, *self.steps) if name in wanted]

    def expression(self, name: str) -> Any:
        """A quantity as one expression of the variable; its numbers have the exact values of the law's numbers."""
        known = {name: sympy.Float(value, DIGITS) for name, value in self.numbers.items()}
        for step_name in self.needed(name):
            if step_name in self.steps:
                known[step_name] = self.steps[step_name].xreplace(known)
        return known[symbol(name)]

    def values(self, places: Iterable[float]) -> dict[str, list[Any]]:
        """The quantities at places of the variable, to 50 digits."""
        found: dict[str, list[Any]] = {name: [] for name in self.quantities}
        with mpmath.workdps(DIGITS):
            for place in places:
                known = {**self.numbers, self.variable: mpmath.mpf(place)}
                for step_name, step in self.steps.items():
                    names, function = _compiled(step)
                    known[step_name] = function(*(mpmath.mpf(known[name]) for name in names))
                for name in found:
                    found[name].append(known[symbol(name)])
        return found


@cache
def _compiled(expression: Any) -> tuple[list[Any], Callable[..., Any]]:
    names = sorted(expression.free_symbols, key=str)
    return names, sympy.lambdify(names, expression, "mpmath")


class FormulaWriter:
    """Writes the numbers and the steps of a piece; every method returns the symbol or the expression of a result."""

    def __init__(self, variable: str) -> None:
        self.variable = symbol(variable)
        self.numbers: dict[Any, float] = {}
        self.steps: dict[Any, Any] = {}
        self._slopes: dict[Any, Any] = {}

    def number(self, name: str, value: float) -> Any:
        """The symbol of a number of the law."""
        self.numbers[symbol(name)] = float(value)
        return symbol(name)

    def literal(self, value: float) -> Any:
        """A number of a user's formula: itself if it is whole or a half, else a symbol named by its digits."""
        if abs(value) < LARGEST_WHOLE and (2.0 * value).is_integer():
            return sympy.Rational(int(2.0 * value), 2)
        return -self.number(repr(-value), -value) if value < 0.0 else self.number(repr(value), value)

    def step(self, name: str, expression: Any) -> Any:
        """The symbol of an expression that uses the symbols written so far."""
        if symbol(name) in self.steps:
            raise ValueError(f"{name} is written twice")
        self.steps[symbol(name)] = sympy.sympify(expression)
        return symbol(name)

    def coefficients(self, name: str, values: Iterable[float], first: int = 0) -> list[Any]:
        """Symbols of numbers with one name, counted from ``first``; zeros stay zeros."""
        return [self.number(f"{name}_{k}", value) if value else 0 for k, value in enumerate(values, start=first)]

    def slope(self, of: Any) -> Any:
        """The derivative of a step by the variable, from the derivatives of earlier steps, each written once."""
        if of not in self._slopes:
            step = self.steps[of]
            change = step.diff(self.variable)
            for inner in (name for name in list(self.steps) if name in step.free_symbols):
                change += step.diff(inner) * self.slope(inner)
            change = sympy.factor(change)
            self._slopes[of] = self.step(f"d{of}", change) if change.free_symbols else change
        return self._slopes[of]

    def written(self, name: str, ends: tuple[float, float], without: Mapping[str, str]) -> WrittenPiece:
        """The finished piece."""
        return WrittenPiece(name, self.variable, *ends, self.numbers, self.steps, without)


def polynomial(coefficients: list[Any], argument: Any) -> Any:
    """A polynomial in Horner's form, of coefficients from the constant term upwards."""
    value: Any = sympy.Integer(0)
    for coefficient in reversed(coefficients):
        value = value * argument + coefficient
    return value


def integral(coefficients: list[Any], argument: Any) -> Any:
    """The integral of a polynomial from 0 on."""
    return argument * polynomial(
        [coefficient / sympy.Integer(k) for k, coefficient in enumerate(coefficients, start=1)], argument
    )
