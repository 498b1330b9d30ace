"""How much of an error is the problem's: figures from inputs that are a little off.

A figure q of inputs p_i that are each off by up to one part in 1/eps is off by up to eps K,

    K = sum_i |p_i/q dq/dp_i|

(N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition, SIAM 2002, section 1.6).  Numbers in a
file are rounded to 16 digits, so no method can do better than K rounding errors, and one that is off by a modest
multiple of K is backward stable: its result is the exact one of a file that differs in the last digits.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from hard.case import drive_of
from hard.figures import reported
from ncgear.errors import DesignError

STEP = 1e-8
"""Relative step: figures good to 1e-14 give K to 1e-6, and where K is 1e6 a figure changes by a hundredth."""

NUMBER = re.compile(r"\d+\.\d*(?:e-?\d+)?")
"""Numbers in a formula that are inputs; whole ones, as the waves to a turn, are its form."""

Path = tuple[str | int, ...]


def conditions(data: dict[str, Any]) -> dict[str, float]:
    """K of every figure of a design that is made."""
    base = {name: figure.value for name, figure in reported(drive_of(data)).items()}
    total = dict.fromkeys(base, 1.0)
    for moved in (_moved(data, path) for path in _inputs(data)):
        for name, value in moved.items():
            total[name] += abs(value / base[name] - 1.0) / STEP
    return total


def _moved(data: dict[str, Any], path: Path) -> dict[str, float]:
    """Figures with one input a little larger; a little smaller, where that makes no design."""
    try:
        return {name: figure.value for name, figure in reported(drive_of(_with(data, path, 1.0 + STEP))).items()}
    except DesignError:
        return {name: figure.value for name, figure in reported(drive_of(_with(data, path, 1.0 - STEP))).items()}


def _inputs(data: dict[str, Any]) -> Iterator[Path]:
    """Where the scalar inputs stand: lengths, speeds, forces, the law's numbers and those in its formula."""
    for group in ("linkage", "operation", "motion", "resistance"):
        yield from _scalars(data.get(group), (group,))


def _scalars(value: Any, path: Path) -> Iterator[Path]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _scalars(inner, (*path, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _scalars(inner, (*path, index))
    elif isinstance(value, str) and path[-1] in ("ratio", "driven_angle"):
        yield from ((*path, index) for index in range(len(NUMBER.findall(value))))
    elif isinstance(value, int | float) and not isinstance(value, bool) and value:
        yield path


def _with(data: dict[str, Any], path: Path, factor: float) -> dict[str, Any]:
    """The design with one input multiplied."""
    changed = deepcopy(data)
    *inner, last = path
    place: Any = changed
    for key in inner[:-1]:
        place = place[key]
    if isinstance(place[inner[-1]], str):
        place[inner[-1]] = _formula_with(place[inner[-1]], int(last), factor)
    else:
        place[inner[-1]][last] = place[inner[-1]][last] * factor
    return changed


def _formula_with(text: str, index: int, factor: float) -> str:
    found = list(NUMBER.finditer(text))[index]
    return f"{text[: found.start()]}{float(found.group()) * factor!r}{text[found.end() :]}"
