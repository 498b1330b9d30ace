"""The answer about measured gears: what each is like, and whether the pair as measured turns."""

from __future__ import annotations

from typing import Any

from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.compared import SIDES, alone_points, gear_figures, length_words, turned_words
from ncgear.figures.numbers import fixed, micrometres, to_digits
from ncgear.figures.quantities import figure
from ncgear.metrology.alone import FEWEST_PLACES, MOST
from ncgear.project.compared import ComparedGear, ComparedPair, Fit

MOST_TEETH = 5
"""Teeth that a fault names."""


def compared_answer(pair: ComparedPair, name: str, fit: Fit, then: str) -> Answer:
    """Deviations of each gear in columns, the contact of both, and where they jam."""
    told = {one.gear: gear_figures(one) for one in pair.gears}
    found = list(told.values())
    both = [
        Row(label, tuple(_sides(one, key) for one in found))
        for label, key in (
            ("single pitch", "single_pitch"),
            ("cumulative pitch", "cumulative_pitch"),
            ("profile slope", "profile_slope"),
            ("profile form", "profile_form"),
        )
    ]
    moved = (
        [Row("axis at", tuple(f"{fixed(one['shift_x_mm'], 4)}, {fixed(one['shift_y_mm'], 4)} mm" for one in found))]
        if fit is Fit.RIGID
        else []
    )
    rows = (
        Row("points on flanks", tuple(f"{one['points_on_flanks']} of {one['points']}" for one in found)),
        Row("turned by", tuple(turned_words(one) for one in pair.gears)),
        *moved,
        Row("r.m.s. deviation", tuple(length_words(one["rms_mm"]) for one in found)),
        *both,
        Row("thickness, mean", tuple(length_words(one["thickness_mean_mm"]) for one in found)),
        Row(
            "thickness, range",
            tuple(
                f"{length_words(one['thickness_least_mm'])} to {length_words(one['thickness_greatest_mm'])}"
                for one in found
            ),
        ),
        Row("least play", (f"{_play(pair, measured=True)}; {_play(pair, measured=False)} of the exact outlines",)),
        Row("transmission error", (_errors(pair),)),
    )
    # A single column stands under its head as several do.
    heads = tuple(one.gear.value for one in pair.gears)
    if len(heads) == 1:
        heads, rows = (*heads, ""), tuple(_widened(row, rows) for row in rows)
    return Answer(
        f"{name}: measured gears against the exact ones, best fit by {fit.value}",
        rows,
        (*_jams(pair), *(fault for one in pair.gears for fault in (*_missing(one), *_alone(one)))),
        "Deviations are positive where there is metal in excess; back and front flanks are told apart",
        heads=heads,
        good="The pair as measured turns; all flanks were measured.",
        not_judged=_not_judged(pair, found),
        then=then,
    )


def _widened(row: Row, rows: tuple[Row, ...]) -> Row:
    return row if row in rows[-2:] else Row(row.name, (*row.texts, ""))


def _sides(found: dict[str, object], key: str) -> str:
    """The worst deviation of back and of front flanks."""
    return " / ".join(length_words(found[f"{key}_{side}_mm"]) for side in SIDES)  # type: ignore[arg-type]


def _play(pair: ComparedPair, *, measured: bool) -> str:
    found = pair.measured_extremes if measured else pair.exact_extremes
    length = found.backlash_rad.low.value * pair.lever_mm
    driving, driven = found.tightest_teeth
    teeth = f" at driving tooth {driving}, driven tooth {driven}" if measured else ""
    return f"{micrometres(length)}{teeth}"


def _errors(pair: ComparedPair) -> str:
    key = "transmission_error_rad"
    measured, exact = (figure(key, one.transmission_error_rad) for one in (pair.measured_extremes, pair.exact_extremes))
    return f"{measured}; {exact} of the exact outlines"


def _jams(pair: ComparedPair) -> list[Fault]:
    jams = pair.jams
    if not jams:
        return []
    named = ", ".join(f"{driving}/{driven}" for driving, driven in jams[:MOST_TEETH])
    more = f" and {len(jams) - MOST_TEETH} more" if len(jams) > MOST_TEETH else ""
    return [
        Fault(
            f"jams by {micrometres(pair.needed_backlash_mm)} at teeth {named}{more}",
            (f"gears.backlash_mm: {to_digits(pair.needed_backlash_mm, 2)} more", "more backlash"),
        )
    ]


def _missing(one: ComparedGear) -> list[Fault]:
    teeth = one.deviations.missing_teeth
    if not teeth:
        return []
    what = f"{one.gear.value} gear: flanks without points at {len(teeth)} teeth ({_first(teeth)}), taken as exact"
    return [Fault(what, ("measure them",))]


def _first(teeth: list[int]) -> str:
    """The numbers of the first of some teeth."""
    return ", ".join(map(str, teeth[:MOST_TEETH])) + (" ..." if len(teeth) > MOST_TEETH else "")


def _alone(one: ComparedGear) -> list[Fault]:
    points = alone_points(one)
    if not points:
        return []
    teeth = list(dict.fromkeys(point.tooth for point in points))
    many = f"{len(points)} points stand" if len(points) > 1 else "1 point stands"
    off, at = micrometres(abs(points[0].off_mm)), "teeth" if len(teeth) > 1 else "tooth"
    what = f"{one.gear.value} gear: {many} alone, by up to {off} at {at} {_first(teeth)}; not counted"
    return [Fault(what, ("clean it and measure again", "measured.json has each"))]


def _not_judged(pair: ComparedPair, found: list[dict[str, Any]]) -> str:
    """Points that are taken as metal since too few are beside them, or since too many stand off."""

    def named(key: str) -> str:
        each = [(one.gear.value, told[key]) for one, told in zip(pair.gears, found, strict=True)]
        return ", ".join(f"{many} of the {gear} gear" for gear, many in each if many)

    few, rough = named("points_not_judged"), named("points_rough")
    said = [f"on flanks, roots and tip lands with fewer than {FEWEST_PLACES}: {few}"] if few else []
    said += [f"where over {100.0 * MOST:g} % stand off, which all count: {rough}"] if rough else []
    return f"Not judged: whether points stand alone {'; '.join(said)}" if said else ""
