"""A function of one variable as a list of operations, each on earlier results: run on jets, on discs, differentiated.

Equal operations are stored once, and operations on numbers are done at once, so that a formula costs no more than its
text is long, and ``u*u`` and ``sqrt(u**2)`` are recognised.  A function with absolute values, ``min``, ``max``,
``sign`` or conditions holds choices: one result where another is negative, a second one elsewhere. ``chosen`` gives the
function of either side alone, which goes on smoothly beyond the place where the choice changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

from ncgear.frozen import dataclass

VARIABLE, NUMBER, POWER, CHOICE = "variable", "number", "power", "choice"

ON_NUMBERS: dict[str, Callable[..., float]] = {
    "+": lambda left, right: left + right,
    "-": lambda left, right: left - right,
    "*": lambda left, right: left * right,
    "/": lambda left, right: left / right,
    "negative": lambda value: -value,
    **{
        name: getattr(math, name)
        for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "atan", "sinh", "cosh", "tanh")
    },
}


class NotReal(ValueError):
    """An operation on numbers whose result is not real and finite."""


@dataclass(frozen=True)
class TapeOperation:
    """One operation on earlier results, by their places; ``number`` is a constant's value or a power's exponent."""

    name: str
    operands: tuple[int, ...] = ()
    number: float = 0.0


class TapeWriter:
    """Writes operations one after the other, equal ones once; every method returns the place of a result."""

    def __init__(self) -> None:
        self.operations: list[TapeOperation] = []
        self._places: dict[TapeOperation, int] = {}

    def append(self, operation: TapeOperation) -> int:
        """The place of an operation's result; an equal earlier operation keeps its place."""
        place = self._places.setdefault(operation, len(self.operations))
        if place == len(self.operations):
            self.operations.append(operation)
        return place

    def variable(self) -> int:
        """The variable."""
        return self.append(TapeOperation(VARIABLE))

    def number(self, value: float) -> int:
        """A constant; raises NotReal for a value that is no finite real number."""
        try:
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            number = math.nan
        if not math.isfinite(number):
            raise NotReal
        return self.append(TapeOperation(NUMBER, number=number))

    def constant(self, place: int) -> float | None:
        """The value of a result that is a number, None for other results."""
        operation = self.operations[place]
        return operation.number if operation.name == NUMBER else None

    def apply(self, name: str, *operands: int) -> int:
        """One of the four operations, the negative or a function; raises NotReal."""
        values = [self.constant(place) for place in operands]
        known = [value for value in values if value is not None]
        if len(known) == len(values):
            try:
                return self.number(ON_NUMBERS[name](*known))
            except (ArithmeticError, ValueError):
                raise NotReal from None
        if name == "-" and operands[0] == operands[1]:
            return self.number(0.0)
        if name == "*" and operands[0] == operands[1]:
            return self.power(operands[0], 2.0)
        if name == "sqrt" and self._even(operands[0]):
            return self.power(operands[0], 0.5)
        return self.append(TapeOperation(name, operands))

    def power(self, base: int, exponent: float) -> int:
        """A constant power; the root of an even power is a power of the absolute value.  Raises NotReal."""
        value = self.constant(base)
        if value is not None:
            try:
                return self.number(value**exponent)
            except ArithmeticError:
                raise NotReal from None
        if exponent == 0.0:
            return self.number(1.0)
        if exponent == 1.0:
            return base
        if self._even(base) and not exponent.is_integer():
            inner = self.operations[base]
            return self.power(self.absolute(inner.operands[0]), inner.number * exponent)
        return self.append(TapeOperation(POWER, (base,), exponent))

    def absolute(self, place: int) -> int:
        """The absolute value."""
        return self.choice(place, self.apply("negative", place), place)

    def choice(self, condition: int, negative: int, otherwise: int) -> int:
        """One result where a condition is negative, another result elsewhere."""
        value = self.constant(condition)
        if value is not None:
            return negative if value < 0.0 else otherwise
        if negative == otherwise:
            return negative
        return self.append(TapeOperation(CHOICE, (condition, negative, otherwise)))

    def again(self, operation: TapeOperation, operands: Sequence[int]) -> int:
        """An operation of another tape on results of this one."""
        match operation.name:
            case "variable" | "number":
                return self.append(operation)
            case "power":
                return self.power(operands[0], operation.number)
            case "choice":
                return self.choice(*operands)
        return self.apply(operation.name, *operands)

    def tape(self, result: int) -> Tape:
        """The operations that a result needs."""
        needed = {result}
        for place in range(result, -1, -1):
            if place in needed:
                needed.update(self.operations[place].operands)
        order = sorted(needed)
        moved = {place: index for index, place in enumerate(order)}
        kept = (self.operations[place] for place in order)
        return Tape(tuple(TapeOperation(o.name, tuple(moved[p] for p in o.operands), o.number) for o in kept))

    def _even(self, place: int) -> bool:
        operation = self.operations[place]
        return operation.name == POWER and operation.number > 0.0 and operation.number % 2.0 == 0.0


@dataclass(frozen=True)
class Tape:
    """Operations, each on earlier results; the last one's result is the function's value."""

    operations: tuple[TapeOperation, ...]

    def run(self, argument: Any, functions: Mapping[str, Callable[..., Any]]) -> Any:
        """The result for an argument with + - * and the negative, ``functions`` for all else; constants are floats."""
        values: list[Any] = []
        for operation in self.operations:
            inputs = [values[place] for place in operation.operands]
            match operation.name:
                case "variable":
                    value = argument
                case "number":
                    value = operation.number
                case "+":
                    value = inputs[0] + inputs[1]
                case "-":
                    value = inputs[0] - inputs[1]
                case "*":
                    value = inputs[0] * inputs[1]
                case "negative":
                    value = -inputs[0]
                case "power":
                    value = functions[POWER](inputs[0], operation.number)
                case name:
                    value = functions[name](*inputs)
            values.append(value)
        return values[-1]

    @cached_property
    def first_condition(self) -> Tape | None:
        """The condition of the first choice, which holds no choice itself; None without choices."""
        place = self._first_choice
        return None if place is None else self._written().tape(self.operations[place].operands[0])

    def chosen(self, negative: bool) -> Tape:
        """The function with one side of its first choice in the place of the choice."""
        writer, places = TapeWriter(), list[int]()
        for place, operation in enumerate(self.operations):
            if place == self._first_choice:
                places.append(places[operation.operands[1 if negative else 2]])
            else:
                places.append(writer.again(operation, [places[operand] for operand in operation.operands]))
        return writer.tape(places[-1])

    def reciprocal(self) -> Tape:
        """One divided by the function; raises NotReal for the number zero."""
        writer = self._written()
        return writer.tape(writer.apply("/", writer.number(1.0), len(self.operations) - 1))

    def of(self, inner: Tape) -> Tape:
        """The function with the result of another tape in the place of the variable."""
        writer, places = inner._written(), list[int]()
        for operation in self.operations:
            found = len(inner.operations) - 1
            if operation.name != VARIABLE:
                found = writer.again(operation, [places[operand] for operand in operation.operands])
            places.append(found)
        return writer.tape(places[-1])

    def derivative(self) -> Tape:
        """The derivative by the variable; for a choice, the choice of the derivatives."""
        writer, slopes = self._written(), list[int]()
        for place, operation in enumerate(self.operations):
            slopes.append(_slope(writer, operation, place, [slopes[operand] for operand in operation.operands]))
        return writer.tape(slopes[-1])

    @property
    def _first_choice(self) -> int | None:
        return next((place for place, made in enumerate(self.operations) if made.name == CHOICE), None)

    def _written(self) -> TapeWriter:
        """A writer that holds this tape's operations at their places."""
        writer = TapeWriter()
        for operation in self.operations:
            writer.append(operation)
        return writer


def _slope(writer: TapeWriter, operation: TapeOperation, place: int, slopes: Sequence[int]) -> int:
    """The place of an operation's derivative, by the derivatives of its operands."""
    if operation.name in (VARIABLE, NUMBER):
        return writer.number(1.0 if operation.name == VARIABLE else 0.0)
    inner = operation.operands[0]

    def product(first: int, second: int) -> int:
        values = writer.constant(first), writer.constant(second)
        if 0.0 in values:
            return writer.number(0.0)
        return second if values[0] == 1.0 else first if values[1] == 1.0 else writer.apply("*", first, second)

    match operation.name:
        case "+" | "-":
            return writer.apply(operation.name, *slopes)
        case "negative":
            return writer.apply("negative", *slopes)
        case "*":
            second = operation.operands[1]
            return writer.apply("+", product(slopes[0], second), product(inner, slopes[1]))
        case "/":
            divisor = operation.operands[1]
            return writer.apply("/", writer.apply("-", slopes[0], product(place, slopes[1])), divisor)
        case "power":
            lower = writer.power(inner, operation.number - 1.0)
            return product(product(writer.number(operation.number), lower), slopes[0])
        case "choice":
            return writer.choice(inner, slopes[1], slopes[2])
    return product(_outer_slope(writer, operation.name, inner, place), slopes[0])


def _outer_slope(writer: TapeWriter, name: str, inner: int, place: int) -> int:
    """The derivative of a function of one argument by that argument; ``place`` is the function's own result."""
    one = writer.number(1.0)
    match name:
        case "sin":
            return writer.apply("cos", inner)
        case "cos":
            return writer.apply("negative", writer.apply("sin", inner))
        case "tan":
            return writer.apply("+", one, writer.power(place, 2.0))
        case "exp":
            return place
        case "log":
            return writer.apply("/", one, inner)
        case "sqrt":
            return writer.apply("/", writer.number(0.5), place)
        case "atan":
            return writer.apply("/", one, writer.apply("+", one, writer.power(inner, 2.0)))
        case "sinh":
            return writer.apply("cosh", inner)
        case "cosh":
            return writer.apply("sinh", inner)
        case "tanh":
            return writer.apply("-", one, writer.power(place, 2.0))
    raise KeyError(name)
