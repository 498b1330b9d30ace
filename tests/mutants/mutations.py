"""Mutations of a module's mathematics: a sign, a factor, a constant, a comparison, a function for its counterpart."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator
from dataclasses import dataclass

OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.Pow: ("**", "*"),
}

COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", ">"),
    ast.LtE: ("<=", ">="),
    ast.Gt: (">", "<"),
    ast.GtE: (">=", "<="),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
}

COUNTERPARTS = {"sin": "cos", "cos": "sin", "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"}
COUNTERPARTS |= {"argmin": "argmax", "argmax": "argmin", "floor": "ceil", "ceil": "floor", "all": "any", "any": "all"}

FACTOR = 1.2
"""A constant is made so much larger: what nobody notices of that is not judged."""

ARITHMETIC = (ast.BinOp, ast.Compare)


@dataclass(frozen=True, order=True)
class Mutation:
    """What stands in a source from one offset in bytes to another, and what stands there instead."""

    start: int
    end: int
    new: str
    line: int

    def applied(self, source: bytes) -> bytes:
        """The mutated source."""
        return source[: self.start] + self.new.encode() + source[self.end :]


def mutations(source: bytes) -> list[Mutation]:
    """Every mutation of what the functions of a source compute."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tree = ast.parse(source)
    return sorted(set(_below(tree, source, starts, computes=False)))


def _below(node: ast.AST, source: bytes, starts: list[int], *, computes: bool) -> Iterator[Mutation]:
    """Mutations of a node and of all below it; ``computes`` in a function."""
    if computes:
        yield from _of(node, source, starts)
    for child in _computed(node):
        inside = computes or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        yield from _below(child, source, starts, computes=inside)


def _computed(node: ast.AST) -> Iterator[ast.AST]:
    """Children that compute values; no messages, annotations, defaults, or places in arrays."""
    match node:
        case ast.Raise() | ast.Assert() | ast.JoinedStr() | ast.Constant():
            return
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            yield from node.body
        case ast.AnnAssign(value=value):
            if value is not None:
                yield value
        case ast.Subscript(value=value):
            yield value
        case _:
            yield from ast.iter_child_nodes(node)


def _of(node: ast.AST, source: bytes, starts: list[int]) -> Iterator[Mutation]:
    """Mutations of one node alone."""

    def at(line: int, column: int) -> int:
        return starts[line - 1] + column

    def between(left: ast.expr, right: ast.expr, old: str, new: str) -> Mutation:
        assert left.end_lineno is not None
        assert left.end_col_offset is not None
        first, last = at(left.end_lineno, left.end_col_offset), at(right.lineno, right.col_offset)
        place = source.index(old.encode(), first, last)
        return Mutation(place, place + len(old), new, left.end_lineno)

    def instead(old: ast.expr, new: str) -> Mutation:
        assert old.end_lineno is not None
        assert old.end_col_offset is not None
        first, last = at(old.lineno, old.col_offset), at(old.end_lineno, old.end_col_offset)
        return Mutation(first, last, new, old.lineno)

    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS and not _is_text(left, right):
            yield between(left, right, *OPERATORS[type(op)])
        case ast.AugAssign(target=target, op=op, value=value) if type(op) in OPERATORS and not _is_text(value):
            yield between(target, value, *OPERATORS[type(op)])
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in COMPARISONS:
            yield between(left, right, *COMPARISONS[type(op)])
        case ast.UnaryOp(op=ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
            sign = at(node.lineno, node.col_offset)
            yield Mutation(sign, sign + 1, "", node.lineno)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name) as called) if _has_counterpart(called, source):
            assert called.end_lineno is not None
            assert called.end_col_offset is not None
            end = at(called.end_lineno, called.end_col_offset)
            yield Mutation(end - len(name), end, COUNTERPARTS[name], called.end_lineno)
    if isinstance(node, ARITHMETIC):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Constant) and type(child.value) in (int, float) and child.value:
                larger = child.value + 1 if isinstance(child.value, int) else child.value * FACTOR
                yield instead(child, repr(larger))


def _has_counterpart(called: ast.Name | ast.Attribute, source: bytes) -> bool:
    """Whether the counterpart of a function is there: a name that is not imported would end every test."""
    if isinstance(called, ast.Attribute):
        return called.attr in COUNTERPARTS
    new = COUNTERPARTS.get(called.id)
    return new is not None and (hasattr(builtins, new) or re.search(rf"\b{new}\b".encode(), source) is not None)


def _is_text(*sides: ast.expr) -> bool:
    """Whether an operator joins texts or lists, as far as can be seen."""
    kinds = ast.JoinedStr, ast.List, ast.Tuple, ast.ListComp
    ways = [way for one in sides for way in ((one.body, one.orelse) if isinstance(one, ast.IfExp) else (one,))]
    return any(
        isinstance(one, kinds) or (isinstance(one, ast.Constant) and isinstance(one.value, str | bytes)) for one in ways
    )
