"""The answer about the nearest pair to an outline."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

from ncgear.figures.answers.answer import Answer, Row
from ncgear.figures.numbers import fixed, placed, shown, to_digits
from ncgear.figures.outline_fit import bound_words
from ncgear.optimum.outline.conditions import Kind
from ncgear.optimum.outline.nearest import Deviation
from ncgear.project.outline_fit import OutlineFit

MET = 2e-5
"""Share of its size by which an outline that can be toothed as it is may be missed: a micrometre of 50 mm."""


def fitted_answer(name: str, found: OutlineFit, then: str) -> Answer:
    """How far the curve strays from the outline, where and why, and what more teeth would bring."""
    size, curve, mate = found.outline.size_mm, found.curve, found.mate
    axis = _place(*curve.axis_mm.tolist())
    rows = [
        Row("teeth", (f"{curve.teeth} : {curve.teeth}, module {shown(curve.module_mm)} mm",)),
        Row("axes", (f"{shown(curve.center_distance_mm)} mm apart; that in the drawing at {axis}",)),
        Row(
            "contact ratio",
            (f"{shown(found.contact_ratio)}, shortest contact {shown(found.shortest_contact)} pitches",),
        ),
        Row("ratio", (" to ".join(shown(one.value) for one in found.drive.transmission.ratio_range),)),
        Row("pressure angle", (f"up to {shown(found.pressure_angle_deg)} deg",)),
    ]
    if (length := found.length_by_size) is not None:
        told = f"teeth and module_mm give a curve {to_digits(length, 3)} times as long as the outline's hull"
        rows.append(Row("size", (f"{told}; leave one of them out to have the outline's size",)))
    about = f", {placed(degrees(found.greatest_at_rad))} deg about the axis"
    rows += _strays(found, found.deviation, size, found.bound_by, about)
    if mate is not None:
        sized = f"an outline of {shown(mate.size_mm)} mm, {shown(mate.scale)} times its drawing"
        rows.append(Row("the mate", (f"{sized}; its axis there at {_place(*mate.axis_mm.tolist())}",)))
        rows += _strays(found, mate.deviation, mate.size_mm, mate.bound_by, "")
    misses = [found.deviation.greatest_mm / size, *([mate.deviation.greatest_mm / mate.size_mm] if mate else [])]
    for one in found.next_sizes if max(misses) > MET else ():
        told = f"{fixed(one.root_mean_square_mm, 2)} mm r.m.s., {fixed(one.greatest_mm, 1)} mm at most"
        if one.mate_root_mean_square_mm is not None and one.mate_greatest_mm is not None:
            other = f"{fixed(one.mate_root_mean_square_mm, 2)} and {fixed(one.mate_greatest_mm, 1)} mm"
            told = f"{told}, of the mate {other}"
        rows.append(Row(f"with {one.teeth} teeth", (f"{told}, module {to_digits(one.module_mm, 3)} mm (not made)",)))
    head = f"{name}: the nearest pitch curve to an outline of {shown(size)} mm whose pair can be made"
    return Answer(
        head if mate is None else f"{name}: the nearest pair to an outline of {shown(size)} mm and one of its mate",
        tuple(rows),
        good="Its exact teeth are made and keep contact; ncgear build judges the files that it writes.",
        then=then,
    )


def _strays(
    found: OutlineFit, away: Deviation, size_mm: float, bound_by: tuple[Kind, ...], about: str
) -> Iterator[Row]:
    """How far a curve strays from its outline, and where and why if it does."""
    yield Row("deviation, r.m.s.", (_length(away.root_mean_square_mm, size_mm),))
    yield Row("deviation, greatest", (_length(away.greatest_mm, size_mm),))
    if away.greatest_mm > MET * size_mm:
        of = "outline" if away.of_outline else "pitch curve"
        yield Row("  where", (f"{_place(*away.at_mm)} of the {of}{about}",))
        yield Row("  because of", (bound_words(found, bound_by),))


def _place(x: float, y: float) -> str:
    return f"({fixed(x, 2)}, {fixed(y, 2)}) mm"


def _length(length_mm: float, size_mm: float) -> str:
    return f"{fixed(length_mm, 3)} mm, {fixed(100.0 * length_mm / size_mm, 2)} % of its size"
