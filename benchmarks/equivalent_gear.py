"""The equivalent-gear method beside the exact one: speed and error.  Writes benchmarks/equivalent-gear.md.

Run as ``make bench`` or ``python benchmarks/equivalent_gear.py``.  Each tooth of the one comes from the circular
gear of the local radius of curvature, of the other from the pitch curve itself.  Times are the least of several runs,
imports not counted; errors do not depend on the machine.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import log, radians
from pathlib import Path
from time import perf_counter

from ncgear.contact.designed.as_designed import as_designed
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines, as_written, reach_mm
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import BasicRack, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair

PAGE = Path(__file__).parent / "equivalent-gear.md"
MODULE_MM = 1.5
TOLERANCE_MM = 0.005
FLANK_TOLERANCE_MM = 1e-6
"""Of the outlines that are turned against each other as written: a thousandth of the errors to be seen."""

RUNS = 5
TEETH = (25, 50, 100, 200)
LAWS: dict[str, Callable[[], Transmission]] = {
    "circular": lambda: uniform_law(Lobes()),
    "phi - 0.08 sin 2 phi": lambda: driven_angle_expression_law("phi - 0.08*sin(2*phi)", Lobes()),
    "ellipse, eccentricity 0.3": lambda: elliptical_law(0.3, 0.0, Lobes()),
}


@dataclass(frozen=True)
class Method:
    """One method's pair: seconds to both outlines, transmission errors in rad, peak to peak."""

    seconds: float
    designed_rad: float
    written_rad: float


def pair_of(pitch: PitchPair, equivalent: bool, flank_tolerance_mm: float | None = None) -> ToothedPair:
    """The teeth of a pair by one of the methods."""
    rack = BasicRack(MODULE_MM, radians(20.0), MODULE_MM, 1.25 * MODULE_MM, 0.3 * MODULE_MM)
    form = ToothForm(rack, limits=TipLimits(0.2 * MODULE_MM), equivalent=equivalent)
    return toothed_pair(pitch, form, TOLERANCE_MM, flank_tolerance_mm=flank_tolerance_mm)


def least_seconds(make: Callable[[], object]) -> float:
    """The shortest of several runs, after one that warms up."""
    make()
    seconds = []
    for _ in range(RUNS):
        start = perf_counter()
        make()
        seconds.append(perf_counter() - start)
    return min(seconds)


def measured(law: Transmission, teeth: int, equivalent: bool) -> Method:
    """Speed and error of one method on one law."""
    pitch = sized_pair(law, teeth, MODULE_MM, None)
    fine = pair_of(pitch, equivalent, FLANK_TOLERANCE_MM)
    at = placed(pitch)
    outlines = Outlines("memory", fine.driving.outline_mm, fine.driven.outline_mm)
    written = as_written(outlines, fine, at, reach_mm(pitch, fine))
    return Method(
        least_seconds(lambda: pair_of(sized_pair(law, teeth, MODULE_MM, None), equivalent)),
        as_designed(fine, at).pushing.transmission_error_rad,
        written.transmission_error_rad,
    )


def row(name: str, teeth: int, exact: Method, equivalent: Method) -> str:
    """One line of the table."""
    cells = [
        name,
        f"{teeth}",
        f"{1e3 * exact.seconds:.0f}",
        f"{1e3 * equivalent.seconds:.0f}",
        f"{exact.designed_rad:.1e}",
        f"{equivalent.designed_rad:.1e}",
        f"{exact.written_rad:.1e}",
        f"{equivalent.written_rad:.1e}",
    ]
    return f"| {' | '.join(cells)} |"


def order(errors: list[float]) -> str:
    """The powers of the tooth number with which errors fall from row to row; none for rounding errors."""
    rates = [log(first / second) / log(2.0) for first, second in pairwise(errors) if second > 1e-12]
    return ", ".join(f"{rate:.1f}" for rate in rates) or "-"


def table() -> list[str]:
    """Rows of all laws, and the rates at which the equivalent gear's error falls."""
    rows, rates = [], []
    for name, law in LAWS.items():
        errors = []
        for teeth in TEETH:
            exact, equivalent = (measured(law(), teeth, method) for method in (False, True))
            rows.append(row(name, teeth, exact, equivalent))
            errors.append(equivalent.designed_rad)
        rates.append(f"- {name}: {order(errors)}")
    return [*rows, "", "Powers of the tooth number by which the equivalent gears' error falls, row to row:", "", *rates]


def page() -> str:
    """The whole page."""
    head = (
        "| law | teeth | exact, ms | equivalent, ms | exact as designed, rad | equivalent as designed, rad "
        "| exact as written, rad | equivalent as written, rad |"
    )
    return "\n".join(
        [
            "# Equivalent gears beside exact teeth",
            "",
            f"Written by `python benchmarks/equivalent_gear.py`: {os.cpu_count()} cores, Python "
            f"{platform.python_version()}.",
            "",
            f"Module {MODULE_MM:g} mm, one to one. Times: from the law's pitch curves to both outlines at "
            f"{TOLERANCE_MM:g} mm, least of {RUNS} runs. Errors: transmission error, peak to peak, over a cycle at 20 "
            "positions and more a tooth; as designed from the exact curves of each method, as written from outlines "
            f"whose flanks are followed to {FLANK_TOLERANCE_MM:g} mm.",
            "",
            head,
            "|---" * (head.count("|") - 1) + "|",
            *table(),
            "",
        ]
    )


if __name__ == "__main__":
    text = page()
    PAGE.write_text(text, encoding="utf-8")
    print(text)
