"""What is told of measured gears: figures, a table with a row per flank, a table of all points, and text."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import degrees
from typing import Any

import numpy as np

from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.numbers import figure, fixed, known, micrometres, to_digits
from ncgear.figures.tables import csv_text, rows_text
from ncgear.frozen import dataclass
from ncgear.metrology.best_fit import FEWEST_PLACES, MOST, are_judged, rough_points
from ncgear.metrology.deviations import is_metal
from ncgear.metrology.exact_outline import FLANK_CURVE, TIP_LAND_CURVE
from ncgear.numerics.arrays import Array
from ncgear.project.compared import ComparedGear, ComparedPair, FittedQuantities

SIDES = ("back", "front")
"""Flanks of a tooth in their order; the driving gear pushes with its back flanks onto the driven front ones."""


def compared_figures(pair: ComparedPair, name: str) -> dict[str, Any]:
    """Plain values whose keys end in their unit."""
    measured, exact = pair.measured_extremes, pair.exact_extremes
    least, (driving, driven) = measured.backlash_rad.low, measured.tightest_teeth
    return {
        "design": {"name": name},
        **{gear.gear.value: gear_figures(gear) for gear in pair.gears},
        "contact": {
            "positions": pair.placement.count,
            "least_play_rad": least.value,
            "least_play_exact_rad": exact.backlash_rad.low.value,
            "least_play_at_rad": least.at,
            "least_play_driving_tooth": driving,
            "least_play_driven_tooth": driven,
            "transmission_error_rad": measured.transmission_error_rad,
            "transmission_error_exact_rad": exact.transmission_error_rad,
            "jams": [{"driving_tooth": driving, "driven_tooth": other} for driving, other in pair.jams],
            "needed_backlash_mm": pair.needed_backlash_mm,
            "driving_tip_clearance_mm": known(pair.measured.driving_tips_mm),
            "driven_tip_clearance_mm": known(pair.measured.driven_tips_mm),
        },
    }


def gear_figures(gear: ComparedGear) -> dict[str, Any]:
    """The fit of a gear, its worst deviations, and what its points miss."""
    fit, found = gear.fit, gear.deviations
    metal = fit.counted | is_metal(gear.outline, fit)
    flanks, thickness = found.flanks, found.thickness_mm[np.isfinite(found.thickness_mm)]
    shift = fit.pose.shift_mm
    moved = {"shift_x_mm": shift.real, "shift_y_mm": shift.imag, "shift_standard_deviation_mm": fit.shift_error_mm}
    sides = {
        side: {
            "single_pitch": flanks.largest(flanks.side(flanks.single_pitch_mm, bool(front))),
            "cumulative_pitch": flanks.cumulative_mm(bool(front)),
            **{
                f"profile_{name}": flanks.largest(flanks.side(getattr(flanks, f"{name}_mm"), bool(front)))
                for name in ("slope", "form", "total")
            },
        }
        for front, side in enumerate(SIDES)
    }
    ends: dict[str, Callable[[Array], Any]] = {"mean": np.mean, "least": np.min, "greatest": np.max}
    return {
        "file": gear.file.file,
        "points": len(gear.file.lines),
        "points_on_flanks": int(np.count_nonzero(fit.counted)),
        "points_on_root": found.beside["root"],
        "points_on_tip": found.beside["tip"],
        "points_astray": found.beside["astray"],
        "points_alone": int(np.count_nonzero(fit.alone)),
        "points_not_judged": int(np.count_nonzero(metal & ~are_judged(gear.outline, fit.feet))),
        "points_rough": rough_points(gear.outline, fit.feet),
        "alone": [vars(point) for point in alone_points(gear)],
        "flanks": [dict(zip(COLUMNS[1:], row[1:], strict=True)) for row in _rows(gear)],
        "teeth_with_missing_points": found.missing_teeth,
        "turned_rad": fit.pose.angle_rad,
        "turned_standard_deviation_rad": fit.angle_error_rad,
        **({} if fit.shift_error_mm is None else moved),
        "rms_mm": fit.rms_mm,
        **{f"{name}_{side}_mm": value for side, of in sides.items() for name, value in of.items()},
        **{f"thickness_{end}_mm": float(of(thickness)) if thickness.size else None for end, of in ends.items()},
    }


@dataclass(frozen=True)
class AlonePoint:
    """A point that stands alone and is not counted: its line in the file, where it is, and how far it stands off.

    The tooth counts from 1; of a root or tip land it is the tooth of the flank before.  The angle is the polar one in
    the gear's own frame.
    """

    line: int
    tooth: int
    on: str
    angle_deg: float
    off_mm: float


def alone_points(gear: ComparedGear) -> list[AlonePoint]:
    """The points that stand alone, the farthest first."""
    fit, outline = gear.fit, gear.outline
    found = np.flatnonzero(fit.alone)
    flank, part = (values[fit.feet.row[found]] for values in (outline.flank, outline.part))
    angle = np.degrees(np.angle(fit.feet.point[found]))
    places = {TIP_LAND_CURVE: "tip"}
    return [
        AlonePoint(
            gear.file.lines[row],
            int(flank[number]) // 2 + 1,
            SIDES[flank[number] % 2] if part[number] == FLANK_CURVE else places.get(int(part[number]), "root"),
            float(angle[number]),
            float(fit.alone_mm[row]),
        )
        for number, row in sorted(enumerate(found.tolist()), key=lambda pair: -abs(fit.alone_mm[pair[1]]))
    ]


DEVIATIONS = ("mean_mm", "least_mm", "greatest_mm", "slope_mm", "form_mm", "position_mm", "single_pitch_mm")
COLUMNS = ("gear", "tooth", "side", "points", *DEVIATIONS, "thickness_mm")


def compared_csv(pair: ComparedPair) -> str:
    """A row for each flank; cells are empty where its points do not tell."""
    return rows_text(COLUMNS, (row for gear in pair.gears for row in _rows(gear)))


def _rows(gear: ComparedGear) -> Iterable[list[object]]:
    flanks = gear.deviations.flanks
    columns: list[Array] = [getattr(flanks, name) for name in DEVIATIONS]
    for flank in range(flanks.points.size):
        values = [known(column[flank]) for column in columns]
        thickness = known(gear.deviations.thickness_mm[flank // 2])
        yield [gear.gear.value, flank // 2 + 1, SIDES[flank % 2], int(flanks.points[flank]), *values, thickness]


def points_csv(gear: ComparedGear) -> str:
    """All points of a gear in its own frame with their deviations, in the order of the file.

    ``flank`` is the number of the tooth with the sign of the side (+ front, - back), 0 of points that are on no working
    flank or stand alone; ``alone_mm`` is how far these stand off, 0 of the others.
    """
    feet, fit = gear.fit.feet, gear.fit
    flank = gear.outline.flank[feet.row]
    tooth = np.where(fit.counted, (flank // 2 + 1) * np.where(flank % 2 == 1, 1, -1), 0)
    columns = [np.array(gear.file.lines), feet.point.real, feet.point.imag, feet.distance_mm, tooth, fit.alone_mm]
    return csv_text(("line", "x_mm", "y_mm", "deviation_mm", "flank", "alone_mm"), columns)


def length_words(value_mm: float | None) -> str:
    """A deviation in micrometres, or a dash where the points do not tell."""
    return "-" if value_mm is None else micrometres(value_mm)


MOST_TEETH = 5
"""Teeth that a fault names."""


def compared_answer(pair: ComparedPair, name: str, fit: FittedQuantities, then: str) -> Answer:
    """Deviations of each gear in columns, the contact of both, and where they jam."""
    found = [gear_figures(gear) for gear in pair.gears]
    tolds = {
        "points on flanks": [f"{gear['points_on_flanks']} of {gear['points']}" for gear in found],
        "turned by": [f"{fixed(degrees(gear.fit.pose.angle_rad), 4)} deg" for gear in pair.gears],
        "axis at": [
            f"{fixed(gear['shift_x_mm'], 4)}, {fixed(gear['shift_y_mm'], 4)} mm"
            for gear in found
            if fit is FittedQuantities.RIGID
        ],
        "r.m.s. deviation": [length_words(gear["rms_mm"]) for gear in found],
        **{
            name: [
                " / ".join(length_words(gear[f"{name.replace(' ', '_')}_{side}_mm"]) for side in SIDES)
                for gear in found
            ]
            for name in ("single pitch", "cumulative pitch", "profile slope", "profile form")
        },
        "thickness, mean": [length_words(gear["thickness_mean_mm"]) for gear in found],
        "thickness, range": [
            " to ".join(length_words(gear[f"thickness_{end}_mm"]) for end in ("least", "greatest")) for gear in found
        ],
    }
    play, exact_play = (_play(pair, measured=measured) for measured in (True, False))
    heads = tuple(gear.gear.value for gear in pair.gears)
    # A single column stands under its head as several do.
    empty = ("",) if len(heads) == 1 else ()
    rows = (
        *(Row(name, (*texts, *empty)) for name, texts in tolds.items() if texts),
        Row("least play", (f"{play}; {exact_play} of the exact outlines",)),
        Row("transmission error", (_errors(pair),)),
    )
    return Answer(
        f"{name}: measured gears against the exact gears, best fit by {fit.value}",
        rows,
        (*_jams(pair), *(fault for gear in pair.gears for fault in (*_missing(gear), *_alone(gear)))),
        "Deviations are positive where there is metal in excess; back and front flanks are told apart",
        heads=(*heads, *empty),
        good="The pair as measured turns; all flanks were measured.",
        not_judged=_not_judged(pair, found),
        then=then,
    )


def _play(pair: ComparedPair, *, measured: bool) -> str:
    found = pair.measured_extremes if measured else pair.exact_extremes
    length = found.backlash_rad.low.value * pair.lever_mm
    driving, driven = found.tightest_teeth
    teeth = f" at driving tooth {driving}, driven tooth {driven}" if measured else ""
    return f"{micrometres(length)}{teeth}"


def _errors(pair: ComparedPair) -> str:
    key = "transmission_error_rad"
    measured, exact = (
        figure(key, ends.transmission_error_rad) for ends in (pair.measured_extremes, pair.exact_extremes)
    )
    return f"{measured}; {exact} of the exact outlines"


def _jams(pair: ComparedPair) -> list[Fault]:
    jams = pair.jams
    if not jams:
        return []
    named = ", ".join(f"{driving}/{driven}" for driving, driven in jams[:MOST_TEETH])
    more = f" and {len(jams) - MOST_TEETH} more" if len(jams) > MOST_TEETH else ""
    what = f"jams by {micrometres(pair.needed_backlash_mm)} at teeth {named}{more}"
    return [Fault(what, (f"gears.backlash_mm: {to_digits(pair.needed_backlash_mm, 2)} more", "more backlash"))]


def _missing(gear: ComparedGear) -> list[Fault]:
    teeth = gear.deviations.missing_teeth
    if not teeth:
        return []
    what = f"{gear.gear.value} gear: flanks without points at {len(teeth)} teeth ({_first(teeth)}), taken as exact"
    return [Fault(what, ("measure them",))]


def _first(teeth: list[int]) -> str:
    return ", ".join(map(str, teeth[:MOST_TEETH])) + (" ..." if len(teeth) > MOST_TEETH else "")


def _alone(gear: ComparedGear) -> list[Fault]:
    points = alone_points(gear)
    if not points:
        return []
    teeth = list(dict.fromkeys(point.tooth for point in points))
    many = f"{len(points)} points stand" if len(points) > 1 else "1 point stands"
    off, at = micrometres(abs(points[0].off_mm)), "teeth" if len(teeth) > 1 else "tooth"
    what = f"{gear.gear.value} gear: {many} alone, by up to {off} at {at} {_first(teeth)}; not counted"
    return [Fault(what, ("clean it and measure again", "measured.json has each"))]


def _not_judged(pair: ComparedPair, found: list[dict[str, Any]]) -> str:
    """Points that are taken as metal since too few are beside them, or since too many stand off."""

    def named(key: str) -> str:
        each = [(gear.gear.value, told[key]) for gear, told in zip(pair.gears, found, strict=True)]
        return ", ".join(f"{many} of the {gear} gear" for gear, many in each if many)

    few, rough = named("points_not_judged"), named("points_rough")
    said = [f"on flanks, roots and tip lands with fewer than {FEWEST_PLACES}: {few}"] if few else []
    said += [f"where over {100.0 * MOST:g} % stand off, which all count: {rough}"] if rough else []
    return f"Not judged: whether points stand alone {'; '.join(said)}" if said else ""
