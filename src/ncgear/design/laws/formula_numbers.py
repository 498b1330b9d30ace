"""The numbers of a formula that shape a law, each with the text before and after it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ncgear.design.laws.base import LawNumber


def numbers_of(key: str, formula: str) -> tuple[LawNumber, ...]:
    """The numbers of a formula under a key, in their order.

    Exponents and whole multiples of the variable stay: with others the law would not close, or be another one.
    """
    text = formula.strip()
    tree = ast.parse(text, mode="eval")
    kept = set(_kept(tree))
    found = [one for one in ast.walk(tree) if isinstance(one, ast.Constant) and one not in kept]
    return tuple(
        LawNumber(f"{text[one.col_offset : one.end_col_offset]} in the formula", key, float(one.value), before, after)
        for one in sorted(found, key=lambda one: one.col_offset)
        if isinstance(one.value, int | float) and one.lineno == one.end_lineno == 1
        for before, after in [(text[: one.col_offset], text[one.end_col_offset :])]
    )


def _kept(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.walk(tree):
        if not isinstance(node, ast.BinOp):
            continue
        if isinstance(node.op, ast.Pow):
            yield node.right
        elif isinstance(node.op, ast.Mult | ast.Div) and any(
            isinstance(one, ast.Name) for one in (node.left, node.right)
        ):
            yield from (one for one in (node.left, node.right) if _is_whole(one))


def _is_whole(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int)
