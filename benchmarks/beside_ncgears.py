"""ncgear beside ncgears, the other program of the field, on one law in one run.  Writes benchmarks/beside-ncgears.md.

Run as ``make beside`` or ``python benchmarks/beside_ncgears.py``; nearly all of the few minutes it takes are ncgears'.
Both make the same pair of gears from the same law and rack and verify it by their own means; both outlines are then
judged by ``outline_judge.py``, which uses neither.  Imports are not in the times.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from math import radians
from pathlib import Path
from time import perf_counter

from ncgear.contact.designed.as_designed import as_designed
from ncgear.contact.pair import pair_contact, refuse_bad_outlines, refuse_overlap
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines as Written
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.form import BasicRack, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from outline_judge import Array, Flanks, Outline, judged_flanks, judged_outline, sine_law

Outlines = tuple[Array, Array]

PAGE = Path(__file__).parent / "beside-ncgears.md"
INSTALL = "python -m pip install -e '.[bench]'"
DEPTH = 0.08
LAW = f"phi - {DEPTH}*sin(2*phi)"
TEETH = (25, 50, 100, 200)
MODULE_MM = 1.5
PRESSURE_ANGLE_DEG = 20.0
ADDENDUM, DEDENDUM, ROOT_RADIUS = 1.0, 1.2, 0.3
"""The rack in modules: what ncgears takes when nothing is said."""

DEFAULT_TOLERANCE_MM = 0.005

FINE_IN_MODULES = 0.5e-6
"""How far chords of working flanks stray to both sides of the exact curve in the fine outlines: two leave a gap of
a millionth of a module at most."""


@dataclass(frozen=True)
class Run:
    """One program's pair: how long it took to make and verify, and what the judge says."""

    program: str
    teeth: int
    seconds: float
    outlines: tuple[Outline, Outline]
    flanks: Flanks

    @property
    def points(self) -> int:
        """Points of the longer outline."""
        return max(outline.points for outline in self.outlines)


def made(teeth: int, flank_tolerance_mm: float | None) -> tuple[PitchPair, ToothedPair]:
    """ncgear's pair: law, pitch curves, teeth; the chords of fillets and lands are as they come."""
    law = driven_angle_expression_law(LAW, Lobes())
    addendum, dedendum, root_radius = (factor * MODULE_MM for factor in (ADDENDUM, DEDENDUM, ROOT_RADIUS))
    rack = BasicRack(MODULE_MM, radians(PRESSURE_ANGLE_DEG), addendum, dedendum, root_radius)
    pitch = sized_pair(law, teeth, MODULE_MM, None)
    return pitch, toothed_pair(
        pitch,
        ToothForm(rack),
        DEFAULT_TOLERANCE_MM,
        flank_tolerance_mm=flank_tolerance_mm,
        straddling=flank_tolerance_mm is not None,
    )


def by_ncgear(teeth: int, flank_tolerance_mm: float | None) -> Outlines:
    """ncgear's pair, verified as designed and as it would be written, at 20 positions a tooth and on both flanks."""
    pitch, pair = made(teeth, flank_tolerance_mm)
    designed = as_designed(pair, placed(pitch))
    refuse_overlap(designed, DEFAULT_TOLERANCE_MM)
    written = Written("memory", pair.driving.outline_mm, pair.driven.outline_mm)
    refuse_bad_outlines(pair_contact(pitch, pair, designed, [written]), DEFAULT_TOLERANCE_MM)
    return pair.driving.outline_mm, pair.driven.outline_mm


def by_ncgears(teeth: int) -> Outlines:
    """The same pair by ncgears, which verifies it before it gives it away, and writes files on the way."""
    import ncgears

    with tempfile.TemporaryDirectory() as folder:
        pair = ncgears.generate(
            LAW,
            teeth=teeth,
            module=MODULE_MM,
            pressure_angle_deg=PRESSURE_ANGLE_DEG,
            addendum_factor=ADDENDUM,
            dedendum_factor=DEDENDUM,
            fillet_factor=ROOT_RADIUS,
            output_directory=folder,
        )
    return _open(pair.drive_outline), _open(pair.driven_outline)


def _open(outline_mm: Array) -> Array:
    """A closed outline without the first point's repetition at its end."""
    return outline_mm[:-1] if (outline_mm[0] == outline_mm[-1]).all() else outline_mm


def judged(program: str, teeth: int, make: Callable[[], Outlines]) -> Run:
    """One program's pair, timed and judged."""
    start = perf_counter()
    driving, driven = make()
    seconds = perf_counter() - start
    outlines = judged_outline(driving, MODULE_MM), judged_outline(driven, MODULE_MM)
    flanks = judged_flanks(driving, driven, sine_law(DEPTH), teeth, MODULE_MM, radians(PRESSURE_ANGLE_DEG))
    return Run(program, teeth, seconds, outlines, flanks)


def runs(teeth: int) -> list[Run]:
    """ncgears, ncgear as it comes, and ncgear with fine flanks."""
    other = judged("ncgears", teeth, lambda: by_ncgears(teeth))
    return [
        other,
        judged(f"ncgear, {DEFAULT_TOLERANCE_MM:g} mm", teeth, lambda: by_ncgear(teeth, None)),
        judged("ncgear, fine flanks", teeth, lambda: by_ncgear(teeth, FINE_IN_MODULES * MODULE_MM)),
    ]


def row(run: Run, other: Run) -> str:
    """One line of the table; shares are of ncgears' figures."""
    one, two = run.outlines
    cells = [
        f"{run.teeth}",
        run.program,
        f"{run.seconds:.3g}",
        f"{run.seconds / other.seconds:.3f}",
        f"{one.points} + {two.points}",
        f"{run.points / other.points:.3f}",
        f"{1e6 * run.flanks.gap:.3g}",
        f"{run.flanks.gap / other.flanks.gap:.3g}",
        f"{1e6 * run.flanks.overlap:.2g}",
        f"{one.reversals + two.reversals}",
        f"{one.repeated + two.repeated}",
        "no" if one.simple and two.simple else "yes",
    ]
    return f"| {' | '.join(cells)} |"


HEAD = (
    "| teeth | program, chord tolerance | time, s | share | points | share | flank gap, 1e-6 module | share "
    "| overlap, 1e-6 module | reversals | repeated points | crosses itself |"
)


def page() -> str:
    """The whole page."""
    lines = [
        "# Beside ncgears",
        "",
        f"Written by `python benchmarks/beside_ncgears.py`: ncgear {version('ncgear')}, ncgears {version('ncgears')}, "
        f"numpy {version('numpy')}, shapely {version('shapely')}, Python {platform.python_version()}, "
        f"{os.cpu_count()} cores.",
        "",
        f"phi2 = {LAW} at module {MODULE_MM:g} mm, rack of {PRESSURE_ANGLE_DEG:g} degrees, addendum {ADDENDUM:g}, "
        f"dedendum {DEDENDUM:g}, root radius {ROOT_RADIUS:g}. Time: from the law to both verified outlines, imports "
        "not counted; each program verifies by its own means, and ncgears writes its files on the way. One run each, "
        "one after the other: the machine's noise is in the seconds, less so in the shares, which are of ncgears' "
        "figure for the same number of teeth. Points are those of the driving and of the driven outline. Fine flanks: "
        f"chords straddle the exact flanks by {FINE_IN_MODULES:g} module to both sides.",
        "",
        "Flank gap and overlap: the worst of all pairs of flanks in mesh, along their normal at the point of contact, "
        "at 40 positions a tooth off any grid. Reversals: turns of more than 90 degrees from one chord to the next. "
        "All of it is judged by `outline_judge.py`, which uses neither program.",
        "",
        HEAD,
        "|---" * (HEAD.count("|") - 1) + "|",
    ]
    for teeth in TEETH:
        found = runs(teeth)
        lines += [row(run, found[0]) for run in found]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    if importlib.util.find_spec("ncgears") is None:
        print(f"ncgears is not installed; {INSTALL}", file=sys.stderr)
        sys.exit(2)
    text = page()
    PAGE.write_text(text, encoding="utf-8")
    print(text)
