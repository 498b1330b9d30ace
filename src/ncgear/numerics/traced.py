"""The formula of a Python function of one variable, by calling it once with a symbol that writes down the operations.

The result is text that ``ncgear.numerics.formula`` reads, so the function becomes a formula with all proofs of
formulas.  This works for functions that do arithmetic and call functions of numpy; a function that needs the number
itself, as ``math.sin``, ``if`` and tables do, cannot be written down.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

SAME_NAMES = ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "sign")
FUNCTIONS = {getattr(np, name): name for name in SAME_NAMES}
FUNCTIONS |= {np.arctan: "atan", np.absolute: "abs", np.minimum: "min", np.maximum: "max"}
OPERATIONS = {np.add: "+", np.subtract: "-", np.multiply: "*", np.true_divide: "/", np.power: "**"}


class NotTraced(TypeError):
    """The function does something with its argument that no formula has; its text says what."""


class Symbol(NDArrayOperatorsMixin):
    """A variable or a result, as the text of a formula."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Symbol:
        parts = [_text(one) for one in inputs]
        if method == "__call__" and not kwargs:
            if ufunc in FUNCTIONS:
                return Symbol(f"{FUNCTIONS[ufunc]}({', '.join(parts)})")
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
