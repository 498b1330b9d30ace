"""Levels of simulation: time against error, and the solvers of the motion in time.  Writes benchmarks/simulation.md.

Run as ``make bench`` or ``python benchmarks/simulation.py``.  Errors are those of the driven angle against the level
dynamic at an accuracy of 1e-10: what a level leaves out is its error.  Teeth and their tables, which all but the rigid
level need, are counted apart.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from functools import partial
from math import pi
from pathlib import Path
from time import perf_counter
from typing import TypeVar

import numpy as np
from scipy.integrate import solve_ivp

from ncgear.design.load import load
from ncgear.drive import Drive
from ncgear.dynamics.integration import Course, course
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.numerics.arrays import Array

ROOT = Path(__file__).parents[1]
DESIGNS = ("baler-dynamics", "baler-half")
SOLVERS = ("LSODA", "Radau", "BDF")
ACCURACIES = (1e-4, 1e-6, 1e-8)
EXACT = 1e-10

HEAD = """\
`python benchmarks/simulation.py`. Errors are those of the driven angle over a turn against the level dynamic at an
accuracy of 1e-10: what a level leaves out is its error. Times are the faster of two runs."""


T = TypeVar("T")


def timed(compute: Callable[[], T]) -> tuple[float, T]:
    """Seconds of the faster of two runs, and the result."""
    seconds = []
    for _ in range(2):
        start = perf_counter()
        found = compute()
        seconds.append(perf_counter() - start)
    return min(seconds), found


def again(drive: Drive, accuracy: float) -> Course:
    """The drive's motion in time at an accuracy."""
    return course(drive.course.mechanism, drive.course.states[:, 0], drive.design.simulation.turns, accuracy)


def levels(drive: Drive) -> list[str]:
    """One line for each level, and for the dynamic one at several accuracies."""
    exact, phi1 = again(drive, EXACT), drive.motion.phi1_rad
    torque = drive.rigid.machine.at(phi1).driven_torque.value
    rigid_s, _ = timed(lambda: drive.rigid.machine.at(phi1))
    static_s, loaded = timed(lambda: loaded_contact(drive.meshing, phi1, torque, drive.machine.speed_rad_s))
    times = phi1 / drive.machine.speed_rad_s
    inside = times <= exact.time_s[-1]
    true = exact.at(times[inside])[2] - drive.meshing.law.at(phi1[inside])[0]
    lines = [line("rigid", rigid_s, true), line("quasi_static", static_s, true - loaded.error_rad[inside])]
    for accuracy in (1e-5, 1e-7):
        seconds, found = timed(partial(again, drive, accuracy))
        within = np.minimum(times[inside], found.time_s[-1])
        missed = true - (found.at(within)[2] - drive.meshing.law.at(phi1[inside])[0])
        lines.append(line(f"dynamic, {accuracy:g}", seconds, missed))
    return lines


def line(level: str, seconds: float, missed_rad: Array) -> str:
    """Time, and root mean square and largest error in mrad."""
    errors = 1e3 * float(np.sqrt(np.mean(missed_rad**2))), 1e3 * float(np.abs(missed_rad).max())
    return f"| {level} | {seconds:.3f} | {errors[0]:.3g} | {errors[1]:.3g} |"


def solvers(drive: Drive) -> list[str]:
    """One line for each solver and accuracy: time, calls, error of the crank's speed after a turn."""
    mechanism, state = drive.course.mechanism, drive.course.states[:, 0]
    span = 0.0, 2.0 * pi / drive.machine.speed_rad_s
    scale = 1e-2 * np.array([1.0, 2.0, 1.0, 2.0, 1e6, 1e6])

    def end(method: str, accuracy: float) -> tuple[float, int]:
        out = solve_ivp(mechanism.change, span, state, method, rtol=accuracy, atol=accuracy * scale)
        return float(out.y[3, -1]), int(out.nfev)

    exact, _ = end("LSODA", EXACT)
    lines = []
    for method in SOLVERS:
        for accuracy in ACCURACIES:
            seconds, (speed, calls) = timed(partial(end, method, accuracy))
            lines.append(f"| {method} | {accuracy:g} | {seconds:.2f} | {calls} | {abs(speed / exact - 1.0):.1e} |")
    return lines


def page() -> str:
    """The whole text."""
    parts = ["# Levels of simulation: time against error", "", HEAD, "", machine(), ""]
    drives = {name: Drive(load(ROOT / "designs" / f"{name}.yaml").design) for name in DESIGNS}
    for name, drive in drives.items():
        heads = ["| level | time in s | rms error in mrad | largest error in mrad |", "|---|---|---|---|"]
        parts += [f"## {name}", "", *heads, *levels(drive), ""]
        besides = sum(drive.timing_s[stage] for stage in ("teeth", "contact", "gaps"))
        parts += [f"Teeth, contact and tables besides: {besides:.2f} s.", ""]
    heads = ["| solver | accuracy | time in s | calls | error of the crank's speed |", "|---|---|---|---|---|"]
    parts += ["## Solvers, on baler-dynamics", "", *heads, *solvers(drives["baler-dynamics"]), ""]
    return "\n".join(parts)


def machine() -> str:
    """Where it was measured."""
    return f"Python {platform.python_version()} on {platform.machine()}, {os.cpu_count()} cores."


if __name__ == "__main__":
    (ROOT / "benchmarks" / "simulation.md").write_text(page(), encoding="utf-8")
