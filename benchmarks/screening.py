"""Screening designs: time and agreement, one by one and together.  Writes benchmarks/screening.md.

Run as ``make bench`` or ``python benchmarks/screening.py``.  Law, closure, pitch curves and all scalar checks of a
design, no teeth, on one core; variations of a shipped design, all of which can be made.  Processor time, the
smallest of several runs.
"""

from __future__ import annotations

import os

# One core: the libraries read this as they are loaded.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import platform
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from ncgear.screening.screen import computed_together, screened

from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import load
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.screening import screen
from ncgear.screening.rows import single_figures

ROOT = Path(__file__).parents[1]
COUNTS = (1, 10, 100, 1000, 10_000)
DESIGNS = {"baler": "three_segment_stroke", "baler-66": "harmonic_ratio, 36 harmonics"}
SPREAD = 0.02
"""By which v1, or the first coefficients, are varied up and down."""

COMPARED = 25
RESIDUALS = ("closure.residual_rad", "closure.stroke_residual_mm")
TOGETHER = (16, 32, 64, 128, 256, 512)


def variations(name: str, count: int) -> list[Design]:
    """Designs about a shipped one."""
    data = load(ROOT / "designs" / f"{name}.yaml").data
    return [Design.model_validate({**data, "motion": varied(data["motion"], factor)}) for factor in factors(count)]


def factors(count: int) -> list[float]:
    """Even steps about 1."""
    return np.linspace(1.0 - SPREAD, 1.0 + SPREAD, count).tolist() if count > 1 else [1.0]


def varied(motion: dict[str, Any], factor: float) -> dict[str, Any]:
    """A stroke with another v1, or a series with another first coefficient."""
    if motion["law"] == "three_segment_stroke":
        return {**motion, "v1_mm_s": motion["v1_mm_s"] * factor}
    return {**motion, "cosine": [motion["cosine"][0] * factor, *motion["cosine"][1:]]}


def least_ms(work: Callable[[], object], runs: int) -> float:
    """Smallest time of several runs."""
    times = []
    for _ in range(runs):
        start = process_time()
        work()
        times.append(process_time() - start)
    return 1000.0 * min(times)


def steps(name: str) -> Iterator[str]:
    """Where the time of one design goes, by itself."""
    taken: dict[str, list[float]] = {}
    for design in variations(name, 9):
        drive, clock = Drive(design), [process_time()]
        for step, ask in ASKED.items():
            ask(drive)
            clock.append(process_time())
            taken.setdefault(step, []).append(clock[-1] - clock[-2])
    for step, times in taken.items():
        yield f"| {step} | {1000.0 * min(times):.2f} |"


ASKED: dict[str, Callable[[Drive], object]] = {
    "law and closure": lambda drive: drive.law,
    "peaks of the motion and of power": lambda drive: drive.check,
    "pitch curves and their size": lambda drive: drive.pitch,
    "lengths of both curves": lambda drive: [drive.pitch.length_mm(gear) for gear in Gear],
    "radii, convexity": lambda drive: [drive.pitch.least_radius_mm(gear) for gear in Gear],
    "pressure angle": lambda drive: drive.pitch.largest_pressure_angle_deg(0.3),
}


def disagreement(name: str) -> float:
    """Largest relative difference of any figure, and the absolute one of the residuals."""
    designs = variations(name, COMPARED)
    found = screened(designs).figures
    alone = [single_figures(design) for design in designs]
    return max(
        float(np.max(np.abs(values - [one[key] for one in alone]) / (1.0 if key in RESIDUALS else scale(values))))
        for key, values in found.items()
    )


def scale(values: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Magnitudes to divide by; what is zero is so on both ways."""
    return np.where(values == 0.0, 1.0, np.abs(values))


def rows(name: str) -> Iterator[str]:
    """Milliseconds a design by itself and together with others."""
    alone = least_ms(lambda: [single_figures(design) for design in variations(name, 5)], 5) / 5.0
    for count in COUNTS:
        designs = variations(name, count)
        together = least_ms(partial(screened, designs), 5 if count < 1000 else 2) / count
        sure: dict[int, object] = {}
        computed_together(designs[:100], screen.COUNTS, sure.update)
        assert len(sure) == len(designs[:100])
        yield f"| {count} | {alone:.1f} | {together:.3f} | {alone / together:.0f} |"


def block_rows() -> Iterator[str]:
    """Milliseconds a design against the designs computed at once."""
    designs, usual = variations("baler", 1024), screen.TOGETHER
    for block in TOGETHER:
        screen.TOGETHER = block
        yield f"| {block} | {least_ms(lambda: screened(designs), 3) / len(designs):.3f} |"
    screen.TOGETHER = usual


def report() -> str:
    """The whole page."""
    lines = [
        "# Screening designs",
        "",
        "Written by `python benchmarks/screening.py`: law, closure, pitch curves and all scalar checks of a design, no",
        f"teeth, on one of {os.cpu_count()} cores, Python {platform.python_version()}; processor time, the smallest of",
        "several runs.",
    ]
    for name, law in DESIGNS.items():
        lines += ["", f"## `designs/{name}.yaml`, {law}", "", "One design by itself:", ""]
        lines += ["| step | ms |", "|---|---|", *steps(name), ""]
        lines += ["| designs | one by one, ms each | together, ms each | times as fast |", "|---|---|---|---|"]
        lines += [*rows(name), ""]
        lines.append(f"Largest disagreement of any figure over {COMPARED} designs: {disagreement(name):.1e}.")
    lines += ["", "## Designs computed at once", "", "Of 1024 balers:", "", "| at once | ms each |", "|---|---|"]
    return "\n".join([*lines, *block_rows(), ""])


if __name__ == "__main__":
    page = report()
    (ROOT / "benchmarks" / "screening.md").write_text(page, encoding="utf-8")
    print(page)
