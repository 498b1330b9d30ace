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

import numpy as np
from scipy.interpolate import BSpline

from ncgear.contact.designed.as_designed import as_designed
from ncgear.contact.pair import pair_contact, refuse_bad_outlines, refuse_overlap
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines as Written
from ncgear.numerics.plane import as_points, signed_area
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.contour import CURVES_SHARE, DEGREE, Arc, Contour, Spline, contour_of
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
"""How far flanks of splines stray to both sides of the exact ones: two leave a gap of a millionth of a module at most.
"""

SEEN = np.array([0.191, 0.691])
"""Shares of each span of a spline that make its outline for the contact as written, off the fit's own places."""

JUDGED = np.linspace(0.002, 0.997, 200)
"""The same for the judge: between them chords stray by a ten-millionth of a module."""


@dataclass(frozen=True)
class Run:
    """One program's pair: how long it took to make and verify, and what the judge says."""

    program: str
    teeth: int
    seconds: float
    points: tuple[int, int]
    outlines: tuple[Outline, Outline]
    flanks: Flanks


def made(teeth: int) -> tuple[PitchPair, ToothedPair]:
    """ncgear's pair: law, pitch curves, teeth."""
    law = driven_angle_expression_law(LAW, Lobes())
    addendum, dedendum, root_radius = (factor * MODULE_MM for factor in (ADDENDUM, DEDENDUM, ROOT_RADIUS))
    rack = BasicRack(MODULE_MM, radians(PRESSURE_ANGLE_DEG), addendum, dedendum, root_radius)
    pitch = sized_pair(law, teeth, MODULE_MM, None)
    return pitch, toothed_pair(pitch, ToothForm(rack), DEFAULT_TOLERANCE_MM)


def verified(pitch: PitchPair, pair: ToothedPair, outlines: Outlines) -> None:
    """Refuse the pair as designed or as it would be written, at 20 positions a tooth and on both flanks."""
    designed = as_designed(pair, placed(pitch))
    refuse_overlap(designed, DEFAULT_TOLERANCE_MM)
    contact = pair_contact(pitch, pair, designed, [Written("memory", *outlines)])
    refuse_bad_outlines(contact, DEFAULT_TOLERANCE_MM)


def by_ncgear(teeth: int) -> Outlines:
    """ncgear's pair as chords."""
    pitch, pair = made(teeth)
    outlines = pair.driving.outline_mm, pair.driven.outline_mm
    verified(pitch, pair, outlines)
    return outlines


def by_ncgear_in_curves(teeth: int) -> tuple[Contour, Contour]:
    """ncgear's pair as lines, arcs and splines, each held against its exact curve, and the contact of all of them."""
    pitch, pair = made(teeth)
    elsewhere = CURVES_SHARE * DEFAULT_TOLERANCE_MM
    driving, driven = (contour_of(pair.of(gear), elsewhere, FINE_IN_MODULES * MODULE_MM) for gear in Gear)
    verified(pitch, pair, (sampled(driving, SEEN), sampled(driven, SEEN)))
    return driving, driven


def sampled(contour: Contour, shares: Array) -> Array:
    """Points of a contour, shape (n, 2): where its curves begin, and at shares of each span of its splines and arcs."""
    rows = []
    for curve in contour.curves:
        rows.append(curve.start[None])
        if isinstance(curve, Spline):
            ends = np.unique(curve.knots)
            places = (ends[:-1, None] + np.diff(ends)[:, None] * shares).ravel()
            rows.append(BSpline(curve.knots, curve.poles_mm, DEGREE)(places))
        elif isinstance(curve, Arc):
            rows.append(along_arc(curve, shares))
    outline = np.concatenate(rows)
    return outline if signed_area(outline) > 0.0 else outline[::-1]


def along_arc(arc: Arc, shares: Array) -> Array:
    """Points at shares of an arc's angle, shape (n, 2)."""
    start, middle, end = (complex(*point) for point in (arc.start, arc.middle, arc.end))
    half = np.angle((end - middle) / (middle - start))
    turned = np.expm1(2j * half * shares) / np.expm1(2j * half)
    return as_points(start + (end - start) * turned)


def points_of(contour: Contour) -> int:
    """Poles of splines, three points of arcs, two of lines, those counted once at which curves join."""
    return sum(len(one.poles_mm) - 1 if isinstance(one, Spline) else 1 + isinstance(one, Arc) for one in contour.curves)


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


def judged(program: str, teeth: int, make: Callable[[], Outlines | tuple[Contour, Contour]]) -> Run:
    """One program's pair, timed and judged; curves by points that lie much closer than their spans are long."""
    start = perf_counter()
    both = make()
    seconds = perf_counter() - start
    points = tuple(points_of(one) if isinstance(one, Contour) else len(one) for one in both)
    driving, driven = (sampled(one, JUDGED) if isinstance(one, Contour) else one for one in both)
    outlines = judged_outline(driving, MODULE_MM), judged_outline(driven, MODULE_MM)
    flanks = judged_flanks(driving, driven, sine_law(DEPTH), teeth, MODULE_MM, radians(PRESSURE_ANGLE_DEG))
    return Run(program, teeth, seconds, (points[0], points[1]), outlines, flanks)


def own_rows(teeth: int) -> dict[str, Callable[[], Outlines | tuple[Contour, Contour]]]:
    """ncgear as it comes, and with curves instead of chords, by the names of the rows."""
    return {
        f"ncgear, {DEFAULT_TOLERANCE_MM:g} mm": lambda: by_ncgear(teeth),
        "ncgear, splines": lambda: by_ncgear_in_curves(teeth),
    }


def runs(teeth: int) -> list[Run]:
    """ncgears, then ncgear."""
    other = judged("ncgears", teeth, lambda: by_ncgears(teeth))
    return [other, *(judged(name, teeth, make) for name, make in own_rows(teeth).items())]


def row(run: Run, other: Run) -> str:
    """One line of the table; shares are of ncgears' figures."""
    one, two = run.outlines
    cells = [
        f"{run.teeth}",
        run.program,
        f"{run.seconds:.3g}",
        f"{run.seconds / other.seconds:.3f}",
        f"{run.points[0]} + {run.points[1]}",
        f"{max(run.points) / max(other.points):.3f}",
        f"{1e6 * run.flanks.gap:.3g}",
        f"{run.flanks.gap / other.flanks.gap:.3g}",
        f"{1e6 * run.flanks.overlap:.2g}",
        f"{one.reversals + two.reversals}",
        f"{one.repeated + two.repeated}",
        "no" if one.simple and two.simple else "yes",
    ]
    return f"| {' | '.join(cells)} |"


HEAD = (
    "| teeth | program | time, s | share | points | share | flank gap, 1e-6 module | share "
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
        "figure for the same number of teeth. Points are those of the driving and of the driven outline. With "
        f"splines they are poles; flanks are within {FINE_IN_MODULES:g} module of the exact ones, fillets and "
        f"lands within {CURVES_SHARE * DEFAULT_TOLERANCE_MM:g} mm; the judge gets points much closer than spans are "
        "long.",
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
