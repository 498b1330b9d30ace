"""Processor time of the functions of ncgear, with that of the libraries below them."""

from __future__ import annotations

import builtins
import cProfile
import os
import pstats
import re
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NamedTuple

import ncgear

SOURCE = str(Path(ncgear.__file__).parent) + os.sep

CLASSES = {"DefaultSolver": "clarabel"}
"""Libraries of compiled classes that do not name their module."""

WITHIN = {"<listcomp>", "<genexpr>", "<dictcomp>", "<setcomp>"}
"""Parts of the function that they stand in."""

DEEPEST, NOTHING_S = 200, 1e-6
"""How many calls of libraries lie within each other at most, and the time that is lost between two of them."""


class Step(NamedTuple):
    """A function by its file, first line and name, as a profile names it."""

    path: str
    line: int
    name: str


@dataclass(frozen=True)
class Taken:
    """Processor seconds of a step: of itself and in libraries below it, by library, in so many calls."""

    calls: int
    own: float
    below: dict[str, float]

    @property
    def seconds(self) -> float:
        return self.own + sum(self.below.values())


def profiled(work: Callable[[], object]) -> dict[Step, Taken]:
    """The functions of ncgear that run, each with its processor time; loading of modules is left out."""
    profile = cProfile.Profile()
    clock, start = perf_counter(), process_time()
    profile.runcall(work)
    used = (process_time() - start) / (perf_counter() - clock)
    stats: dict[Any, Any] = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    own = {one for one in stats if one[0].startswith(SOURCE) and one[2] not in WITHIN}
    below = below_own(stats, own)
    return {
        Step(*one): Taken(
            stats[one][1],
            used * (stats[one][2] + below[one].pop("ncgear", 0.0)),
            {name: used * seconds for name, seconds in below[one].items()},
        )
        for one in own
        if one[2] != "<module>"
    }


def below_own(stats: dict[Any, Any], own: set[Any]) -> dict[Any, dict[str, float]]:
    """Seconds that libraries take for these functions, by library: a function's time goes to those that call it."""
    below: dict[Any, dict[str, float]] = defaultdict(lambda: defaultdict(float))
    going = {(one, library_of(one, row[4])): row[2] for one, row in stats.items() if one not in own}
    for _ in range(DEEPEST):
        arriving: dict[Any, float] = defaultdict(float)
        for (one, library), seconds in going.items():
            callers = {caller: row[3] for caller, row in stats[one][4].items() if caller != one and row[3] > 0.0}
            for caller, weight in callers.items():
                share = seconds * weight / sum(callers.values())
                if caller in own:
                    below[caller][library] += share
                elif "importlib" not in caller[0]:
                    arriving[caller, library] += share
        going = {one: seconds for one, seconds in arriving.items() if seconds > NOTHING_S}
    return below


def library_of(function: Any, callers: Iterable[Any]) -> str:
    """The library of a function of a profile; Python's own is one.  Some compiled functions are only named."""
    path, _, name = function
    if path.startswith(SOURCE):
        return "ncgear"
    if path != "~":
        found = re.search(r"site-packages/_?(\w+)", path)
        return found[1] if found else "Python"
    found = re.search(r"(?:method |' of ')([\w.]+)", name)
    owner = (found[1] if found else name).removeprefix("builtins.").split(".")[0]
    if hasattr(builtins, owner) or owner in sys.stdlib_module_names:
        return "Python"
    if owner.lstrip("_") in sys.modules:
        return owner.lstrip("_")
    above = (library_of(one, ()) for one in callers if "site-packages" in one[0])
    return CLASSES.get(owner) or next(above, "Python")
