"""The nearest pair to an outline: its figures, the fitted design file, what keeps it away in words, and the answer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from math import degrees
from typing import Any

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.rewritten import design_copy
from ncgear.design.words import ending_in
from ncgear.figures.answers.answer import Answer, Row
from ncgear.figures.numbers import fixed, placed, shown, to_digits
from ncgear.optimum.outline.conditions import Subject
from ncgear.optimum.outline.nearest import Deviation
from ncgear.optimum.outline.outline import Outline
from ncgear.pitch.shape import Gear
from ncgear.project.outline_fit import OutlineFit

SUFFIX = "-fitted"

OTHER = {Gear.DRIVING: Gear.DRIVEN, Gear.DRIVEN: Gear.DRIVING}

WORDS = {
    Subject.HOLLOW_OWN: "the {own} gear is concave there: its tips would run into the {mate} gear's, as those of a "
    "ring and too large a pinion",
    Subject.HOLLOW_MATE: "the {mate} gear is concave there: its tips would run into the {own} gear's, as those of a "
    "ring and too large a pinion",
    Subject.HOLLOW_CORNER_OWN: "a concave corner of the {own} gear: no flank rolls in a sharper one",
    Subject.HOLLOW_CORNER_MATE: "a concave corner of the {mate} gear: no flank rolls in a sharper one",
    Subject.CORNER_OWN: "a convex corner of the {own} gear: no tooth stands on a sharper one",
    Subject.CORNER_MATE: "a convex corner of the {mate} gear: no tooth stands on a sharper one",
    Subject.STEEP: "the pressure angle: the curve may run no steeper against the ray from its axis",
    Subject.ROOM: "the room beside the axis of the {mate} gear",
}
"""What keeps a curve from its outline."""

UNBOUND = (
    "no condition of the teeth at this very place: it lies behind another part of the outline as seen from the axis, "
    "or the curve gives way for the places beside it"
)


def bound_words(found: OutlineFit, bound_by: Sequence[Subject]) -> str:
    """What keeps a curve from its outline where they are farthest apart, by the conditions that bind there."""
    own = found.given_gear
    words = [WORDS[kind].format(own=own.value, mate=OTHER[own].value) for kind in bound_by[:1]]
    return words[0] if words else UNBOUND


def fitted_design(loaded: LoadedDesign, found: OutlineFit) -> str:
    """The text of the design file with the fitted curve in place of its outline; comments elsewhere stay."""
    values: dict[str, Any] = {"name": ending_in(SUFFIX, loaded.design.name), "motion": dict(found.motion)}
    gears, asked = loaded.design.gears, loaded.design.outline
    if asked is not None and asked.mate is not None:
        # Both outlines are in the curve.
        values["outline.mate" if asked.model_fields_set - {"mate"} else "outline"] = None
    if gears is not None and loaded.design.motion.gives_center_distance:
        # The curve has the size: its teeth are counted, and the module follows.
        values |= {"gears.teeth": found.curve.teeth, "gears.module_mm": None, "gears.center_distance_mm": None}
    return design_copy(loaded, values)


def fit_figures(found: OutlineFit) -> dict[str, Any]:
    """Deviation with its place and cause, sizes, and what other sizes would cost."""
    mate = found.mate
    figures = {
        "outline": _outline(found.outline, found.outline.size_mm),
        "deviation": _deviation(found.deviation, found.outline.size_mm, found.bound_by)
        | {"greatest_at_deg": degrees(found.greatest_at_rad)},
        "pair": {
            "given_gear": found.given_gear.value,
            "axis_mm": found.curve.axis_mm.tolist(),
            "center_distance_mm": found.curve.center_distance_mm,
            "teeth": found.curve.teeth,
            "module_mm": found.curve.module_mm,
            "contact_ratio": found.contact_ratio,
            "shortest_contact_pitches": found.shortest_contact,
            "max_pressure_angle_deg": found.pressure_angle_deg,
            "ratio_min": found.drive.transmission.ratio_range[0].value,
            "ratio_max": found.drive.transmission.ratio_range[1].value,
        },
        "next_sizes": [
            {name: value for name, value in asdict(size).items() if value is not None} for size in found.next_sizes
        ],
    }
    if mate is None:
        return figures
    figures["mate"] = {
        "outline": _outline(mate.outline, mate.size_mm) | {"scale": mate.scale},
        "axis_mm": mate.axis_mm.tolist(),
        "deviation": _deviation(mate.deviation, mate.size_mm, mate.bound_by),
    }
    return figures


def _outline(outline: Outline, size_mm: float) -> dict[str, Any]:
    left_out = {"left_out_mm": size_mm / outline.size_mm * outline.left_out_mm} if outline.left_out_mm else {}
    return {"size_mm": size_mm, "corners": len(outline.corners), **left_out}


def _deviation(away: Deviation, size_mm: float, bound_by: Sequence[Subject]) -> dict[str, Any]:
    return {
        "root_mean_square_mm": away.root_mean_square_mm,
        "root_mean_square_share": away.root_mean_square_mm / size_mm,
        "greatest_mm": away.greatest_mm,
        "greatest_share": away.greatest_mm / size_mm,
        "greatest_at_mm": list(away.at_mm),
        "greatest_of": "outline" if away.of_outline else "pitch curve",
        "bound_by": [kind.value for kind in bound_by],
    }


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
        Row("ratio", (" to ".join(shown(extremum.value) for extremum in found.drive.transmission.ratio_range),)),
        Row("pressure angle", (f"up to {shown(found.pressure_angle_deg)} deg",)),
    ]
    if (length := found.length_by_size) is not None:
        told = f"teeth and module_mm give a curve {to_digits(length, 3)} times as long as the outline's hull"
        rows.append(Row("size", (f"{told}; leave one of them out to have the outline's size",)))
    about = f", {placed(degrees(found.greatest_at_rad))} deg about the axis"
    rows += _strays(found, found.deviation, size, found.bound_by, about)
    if loops := found.outline.left_out_mm:
        told = f"crosses itself in loops, which reach up to {to_digits(loops, 2)} mm from its outer border"
        rows.append(Row("outline", (f"{told}; the border is followed",)))
    if mate is not None:
        sized = f"an outline of {shown(mate.size_mm)} mm, {shown(mate.scale)} times its drawing"
        rows.append(Row("the mate", (f"{sized}; its axis there at {_place(*mate.axis_mm.tolist())}",)))
        rows += _strays(found, mate.deviation, mate.size_mm, mate.bound_by, "")
    misses = [found.deviation.greatest_mm / size, *([mate.deviation.greatest_mm / mate.size_mm] if mate else [])]
    for next_size in found.next_sizes if max(misses) > MET else ():
        told = f"{fixed(next_size.root_mean_square_mm, 2)} mm r.m.s., {fixed(next_size.greatest_mm, 1)} mm at most"
        if next_size.mate_root_mean_square_mm is not None and next_size.mate_greatest_mm is not None:
            other = f"{fixed(next_size.mate_root_mean_square_mm, 2)} and {fixed(next_size.mate_greatest_mm, 1)} mm"
            told = f"{told}, of the mate {other}"
        rows.append(
            Row(f"with {next_size.teeth} teeth", (f"{told}, module {to_digits(next_size.module_mm, 3)} mm (not made)",))
        )
    head = f"{name}: the nearest pitch curve to an outline of {shown(size)} mm whose pair can be made"
    return Answer(
        head if mate is None else f"{name}: the nearest pair to an outline of {shown(size)} mm and one of its mate",
        tuple(rows),
        good="Its exact teeth are made and keep contact; ncgear build judges the files that it writes.",
        then=then,
    )


def _strays(
    found: OutlineFit, away: Deviation, size_mm: float, bound_by: tuple[Subject, ...], about: str
) -> Iterator[Row]:
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
