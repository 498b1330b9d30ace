"""The answer about the nearest pair to an outline."""

from __future__ import annotations

from math import degrees

from ncgear.figures.answers.answer import Answer, Row
from ncgear.figures.numbers import fixed, placed, shown, to_digits
from ncgear.figures.outline_fit import bound_words
from ncgear.project.outline_fit import OutlineFit

MET = 2e-5
"""Share of its size by which an outline that can be toothed as it is may be missed: a micrometre of 50 mm."""


def fitted_answer(name: str, found: OutlineFit, then: str) -> Answer:
    """How far the curve strays from the outline, where and why, and what more teeth would bring."""
    away, size, curve = found.deviation, found.outline.size_mm, found.curve
    of = "outline" if away.of_outline else "pitch curve"
    where = f"{_place(*away.at_mm)} of the {of}, {placed(degrees(found.greatest_at_rad))} deg about the axis"
    axis = _place(*curve.axis_mm.tolist())
    rows = [
        Row("teeth", (f"{curve.teeth} : {curve.teeth}, module {shown(curve.module_mm)} mm",)),
        Row("axes", (f"{shown(curve.center_distance_mm)} mm apart; that in the drawing at {axis}",)),
        Row("contact ratio", (shown(found.contact_ratio),)),
        Row("ratio", (" to ".join(shown(one.value) for one in found.drive.transmission.ratio_range),)),
        Row("pressure angle", (f"up to {shown(found.pressure_angle_deg)} deg",)),
        Row("deviation, r.m.s.", (_length(away.root_mean_square_mm, size),)),
        Row("deviation, greatest", (_length(away.greatest_mm, size),)),
    ]
    strays = away.greatest_mm > MET * size
    if strays:
        rows += [Row("  where", (where,)), Row("  because of", (bound_words(found),))]
    for one in found.next_sizes if strays else ():
        told = f"{fixed(one.root_mean_square_mm, 2)} mm r.m.s., {fixed(one.greatest_mm, 1)} mm at most"
        rows.append(Row(f"with {one.teeth} teeth", (f"{told}, module {to_digits(one.module_mm, 3)} mm (not made)",)))
    return Answer(
        f"{name}: the nearest pitch curve to an outline of {shown(size)} mm whose pair can be made",
        tuple(rows),
        good="Its exact teeth are made and keep contact; ncgear build judges the files that it writes.",
        then=then,
    )


def _place(x: float, y: float) -> str:
    return f"({fixed(x, 2)}, {fixed(y, 2)}) mm"


def _length(length_mm: float, size_mm: float) -> str:
    return f"{fixed(length_mm, 3)} mm, {fixed(100.0 * length_mm / size_mm, 2)} % of its size"
