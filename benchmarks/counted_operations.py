"""Counts the operations of single functions of ncgear while a command runs.

The module of a function is compiled anew: each operation in the function's body is handed to its ``Counts``.  Functions
that live get the new code, so that whoever has imported them runs it.
"""

from __future__ import annotations

import ast
import gc
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from types import CodeType, FunctionType
from typing import Any

import numpy as np

from profiled_steps import Step

CACHE_BYTES = 1 << 20
"""Larger arrays are counted apart: they do not stay in the cache from one operation to the next."""

ASKS_ITS_FRAME = {"super", "locals", "globals", "vars", "dir"}
"""Functions that look at who calls them, and so have to be called where they stand."""


NO_LIBRARY = sys.stdlib_module_names | {"ncgear"}


@dataclass
class Counts:
    """Operations that meet arrays, the elements of these within the cache and beyond it, and all other operations."""

    arrays: int = 0
    near: int = 0
    far: int = 0
    others: int = 0
    compiled: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    """Seconds in compiled functions, by library; a profile does not see all of these."""

    def seen(self, value: Any) -> Any:
        """The value of an operator or a subscript; a view has no elements of its own."""
        self._add(value, isinstance(value, np.ndarray) and value.base is not None)
        return value

    def asked(self, function: Callable[..., Any], *given: Any, **named: Any) -> Any:
        """What a function returns.  One of a library handles as many elements as the largest array that it meets."""
        start = perf_counter()
        value = function(*given, **named)
        library = _library_of(function)
        if not isinstance(getattr(function, "__func__", function), FunctionType | type) and library not in NO_LIBRARY:
            self.compiled[library] += perf_counter() - start
        met = [one for one in (value, getattr(function, "__self__", None), *given) if isinstance(one, np.ndarray)]
        if met and library != "ncgear":
            largest = max(met, key=np.size)
            self._add(largest, "out" not in named and getattr(value, "base", None) is not None)
            # Each element becomes an object of Python.
            self.others += largest.size if isinstance(value, list) else 0
        else:
            self.others += 1
        return value

    def written(self, target: Any, part: Any) -> None:
        """What was written into a target; it has the part now."""
        self._add(part if isinstance(target, np.ndarray) and isinstance(part, np.ndarray) else None, False)

    def _add(self, value: Any, is_view: bool) -> None:
        if not isinstance(value, np.ndarray):
            self.others += 1
            return
        self.arrays += 1
        if not is_view:
            self.near += value.size if value.nbytes <= CACHE_BYTES else 0
            self.far += value.size if value.nbytes > CACHE_BYTES else 0


def _library_of(function: Any) -> str:
    module = getattr(function, "__module__", None) or type(getattr(function, "__self__", None)).__module__
    return str(module).split(".")[0]


class _Counting(ast.NodeTransformer):
    """Hands each operation of a body to counts; functions that are defined within the body are other steps."""

    def __init__(self, counts: str) -> None:
        self.counts = counts

    def _to(self, method: str, *given: ast.expr, named: list[ast.keyword] | None = None) -> ast.Call:
        counts = ast.Attribute(ast.Name(self.counts, ast.Load()), method, ast.Load())
        return ast.Call(counts, list(given), named or [])

    def _seen(self, node: Any) -> ast.expr:
        self.generic_visit(node)
        return self._to("seen", node) if isinstance(getattr(node, "ctx", None), ast.Load | None) else node

    visit_BinOp = visit_UnaryOp = visit_Compare = visit_Subscript = _seen

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.func, ast.Name) and node.func.id in ASKS_ITS_FRAME:
            return node
        return self._to("asked", node.func, *node.args, named=node.keywords)

    def _assigned(self, node: Any) -> list[ast.stmt]:
        is_one = isinstance(node, ast.AugAssign)
        targets = [
            one for one in ([node.target] if is_one else node.targets) if is_one or isinstance(one, ast.Subscript)
        ]
        owners = [ast.unparse(one.value if isinstance(one, ast.Subscript) else one) for one in targets]
        texts = [
            f"{self.counts}.written({owner}, {ast.unparse(one)})" for owner, one in zip(owners, targets, strict=True)
        ]
        self.generic_visit(node)
        return [node, *(statement for text in texts for statement in ast.parse(text).body)]

    visit_Assign = visit_AugAssign = _assigned

    def _left(self, node: Any) -> Any:
        return node

    visit_FunctionDef = visit_Lambda = visit_ClassDef = visit_MatchValue = _left


def counting(steps: Iterable[Step]) -> dict[Step, Counts]:
    """The counts of steps, which grow from now on."""
    found = {step: Counts() for step in steps}
    for path in {step.path for step in found}:
        _replace(path, {f"_counts_{step.line}": step for step in found if step.path == path}, found)
    return found


def _replace(path: str, named: dict[str, Step], found: dict[Step, Counts]) -> None:
    tree = ast.parse(Path(path).read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        for name, step in named.items():
            if _is_step(node, step):
                body, visit = node.body, _Counting(name).visit  # type: ignore[attr-defined]
                node.body = visit(ast.Module(body, [])).body if isinstance(body, list) else visit(body)  # type: ignore[attr-defined]
    compiled = compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)
    codes = {(code.co_qualname, code.co_firstlineno): code for code in _all_codes(compiled)}
    for function in gc.get_objects():
        if isinstance(function, FunctionType) and function.__code__.co_filename == path:
            old = function.__code__
            function.__code__ = codes[old.co_qualname, old.co_firstlineno]
            function.__globals__.update({name: found[step] for name, step in named.items()})


def _is_step(node: ast.AST, step: Step) -> bool:
    if isinstance(node, ast.FunctionDef):
        first: ast.stmt | ast.expr = node.decorator_list[0] if node.decorator_list else node
        return (node.name, first.lineno) == (step.name, step.line)
    return isinstance(node, ast.Lambda) and (step.name, step.line) == ("<lambda>", node.lineno)


def _all_codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield from _all_codes(one)
