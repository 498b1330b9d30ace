"""Measured gears as files: figures, a table with a row per flank, all points with their deviations, pictures.

A picture shows a gear's deviations, enlarged, on the exact outline, and the mean of every flank as bars.
"""

from __future__ import annotations

from itertools import pairwise
from math import degrees, floor, log10

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from ncgear.drawings.charts.chart import Chart, ChartLine, Role
from ncgear.drawings.charts.drawer import CONTACT_COLUMN, CONTACT_LOOK, column_png
from ncgear.drawings.palette import EXCESS
from ncgear.drawings.plots import canvas
from ncgear.figures.compared import compared_csv, compared_figures, points_csv
from ncgear.figures.numbers import MICRORAD, json_text, micrometres
from ncgear.figures.tables import outline_csv
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_points
from ncgear.project.compared import ComparedGear, ComparedPair

WIDTH_IN, HEIGHT_IN = 8.6, 10.6

ENLARGED_IN_MODULES = 1.0
"""Drawn length of the worst deviation in modules, about."""

EXCESS_SCALE = LinearSegmentedColormap.from_list("excess", EXCESS)

MANY_TEETH = 40
"""Number of teeth from which only every fifth tooth has its number."""

BELOW_IN_MODULES = 3.2
"""Distance of a tooth's number from its tip, into the gear."""

NOISE_IN_MODULES = 3e-7
"""Deviations up to this, a nanometre of teeth of module 3, are drawn on the scale of it: rounding is no deviation."""


def deviations_png(gear: ComparedGear, title: str) -> bytes:
    """The gear in its own frame, points on working flanks coloured by their deviation, and bars for every flank."""
    made = canvas.figure(WIDTH_IN, HEIGHT_IN, title)
    counted = gear.fit.feet.kept(gear.fit.counted)
    worst = max(float(np.abs(counted.distance_mm).max()), NOISE_IN_MODULES * gear.outline.gear.flanks.rack.module_mm)
    _draw_gear(made, gear, worst)
    _draw_bars(made.add_axes((0.1, 0.06, 0.86, 0.2)), gear)
    return canvas.png(made)


def _draw_gear(made: Figure, gear: ComparedGear, worst_mm: float) -> None:
    axes = made.add_axes((0.02, 0.335, 0.96, 0.61))
    outline = gear.outline.gear.outline_mm
    low, high = np.minimum(outline.min(axis=0), 0.0), np.maximum(outline.max(axis=0), 0.0)
    middle, size = (low + high) / 2.0, float((high - low).max()) / 2.0 * 1.05
    module = gear.outline.gear.flanks.rack.module_mm
    if gear.outline.gear.flanks.curve.is_ring:
        size += 2.0 * module
        canvas.ring_area(axes, outline, (0.0, 0.0), size - module / 2.0, canvas.REFERENCE, 0.8)
    else:
        canvas.area(axes, outline, canvas.REFERENCE, 0.8)
    counted, norm = gear.fit.feet.kept(gear.fit.counted), Normalize(-worst_mm, worst_mm)
    factor = _round_factor(ENLARGED_IN_MODULES * module / worst_mm)
    drawn = counted.foot + factor * counted.distance_mm * counted.outwards
    colors = EXCESS_SCALE(norm(counted.distance_mm))
    spikes = np.stack([as_points(counted.foot), as_points(drawn)], axis=1)
    axes.add_collection(LineCollection(list(spikes), colors=colors, linewidths=0.9), autolim=False)
    for line in _along_flanks(gear, as_points(drawn)):
        axes.plot(*line.T, color=canvas.INK, linewidth=0.6)
    axes.plot([0.0], [0.0], "+", color=canvas.INK, markersize=9)
    _number(axes, gear, module)
    canvas.look_at(axes, (middle[0] - size, middle[1] - size, 2.0 * size, 2.0 * size))
    said = f"deviation in \u00b5m, drawn {factor:g} times as long (right: metal in excess)"
    in_um = Normalize(-1e3 * worst_mm, 1e3 * worst_mm)
    canvas.color_bar(made, in_um, EXCESS_SCALE, (0.25, 0.318, 0.5, 0.013), said)


def _round_factor(factor: float) -> float:
    """The factor, rounded down to one digit."""
    digit = 10.0 ** floor(log10(factor))
    return float(floor(factor / digit + 1e-9) * digit)


def _along_flanks(gear: ComparedGear, points: Array) -> list[Array]:
    """The enlarged deviations of each flank as a line along it."""
    counted = gear.fit.feet.kept(gear.fit.counted)
    flank = gear.outline.flank[counted.row]
    order = np.lexsort((counted.place_mm, flank))
    ends = np.searchsorted(flank[order], np.arange(gear.deviations.flanks.points.size + 1))
    return [points[order[low:high]] for low, high in pairwise(ends.tolist()) if high > low]


def _number(axes: Axes, gear: ComparedGear, module_mm: float) -> None:
    """The number of every tooth below its root, on the side of the material."""
    flanks, teeth = gear.outline.gear.flanks, gear.deviations.flanks.teeth
    middle = flanks.crossing_mm.reshape(-1, 2)[:teeth].mean(axis=1)
    places, _ = flanks.offset(middle, (1.0 - BELOW_IN_MODULES) * module_mm)
    for number, place in enumerate(places, 1):
        if teeth < MANY_TEETH or number % 5 == 0:
            canvas.number(axes, place, str(number))


def _draw_bars(axes: Axes, gear: ComparedGear) -> None:
    """The mean deviation of back and front flank of every tooth, with the range of its points."""
    flanks = gear.deviations.flanks
    numbers = np.arange(1, flanks.teeth + 1)
    for front, (color, name) in enumerate(((canvas.DRIVING, "back flanks"), (canvas.DRIVEN, "front flanks"))):
        place = numbers + (0.2 if front else -0.2)
        mean, least, greatest = (
            1e3 * flanks.side(values, bool(front)) for values in (flanks.mean_mm, flanks.least_mm, flanks.greatest_mm)
        )
        axes.bar(place, np.nan_to_num(mean), 0.38, color=color, alpha=0.75, label=name)
        axes.vlines(place, least, greatest, color=canvas.INK, linewidth=0.8)
    unmeasured = gear.deviations.missing_teeth
    if unmeasured:
        axes.plot(unmeasured, np.zeros(len(unmeasured)), "x", color=canvas.INK, markersize=6, label="without points")
    axes.axhline(0.0, color=canvas.INK, linewidth=0.8)
    axes.set_xlim(0.3, flanks.teeth + 0.7)
    canvas.dress(axes, f"tooth of the {gear.gear.value} gear", "mean deviation in \u00b5m")
    canvas.legend_above(axes)


MEASURED, EXACT = "pair as measured", "exact outlines"


def compared_pictures(pair: ComparedPair, name: str) -> dict[str, bytes]:
    """Each measured gear with its deviations, and play and transmission error of the pair over the cycle."""
    gears = {
        f"measured-{gear.gear.value}.png": deviations_png(
            gear, f"{name}: {gear.gear.value} gear as measured, r.m.s. deviation {micrometres(gear.fit.rms_mm)}"
        )
        for gear in pair.gears
    }
    angle, end = np.degrees(pair.placement.phi1_rad), degrees(pair.placement.cycle_rad)
    charts = [
        Chart(
            quantity,
            unit,
            (ChartLine(Role.OTHER, EXACT, angle, exact), ChartLine(Role.OWN, MEASURED, angle, measured)),
            end,
            axis_label=label,
        )
        for quantity, unit, label, measured, exact in (
            (
                "play",
                "mm",
                "play along the normal\nin \u00b5m (below 0: jams)",
                1e3 * pair.lever_mm * pair.measured.backlash_rad,
                1e3 * pair.lever_mm * pair.exact.backlash_rad,
            ),
            (
                "transmission error",
                MICRORAD,
                f"error of driven\nangle in {MICRORAD}",
                1e6 * pair.measured.pushing_rad,
                1e6 * pair.exact.pushing_rad,
            ),
        )
    ]
    contact = column_png(charts, f"{name}: contact of the pair as measured", CONTACT_LOOK, CONTACT_COLUMN)
    return {**gears, "measured-contact.png": contact}


def compared_files(pair: ComparedPair, name: str) -> dict[str, bytes]:
    """The files by their names; measured outlines have the form of a build's outlines."""
    files = {
        "measured.json": json_text(compared_figures(pair, name)).encode(),
        "measured.csv": compared_csv(pair).encode(),
        **compared_pictures(pair, name),
    }
    for gear in pair.gears:
        files[f"measured-{gear.gear.value}-points.csv"] = points_csv(gear).encode()
        files[f"measured-{gear.gear.value}-outline.csv"] = outline_csv(gear.outline_mm).encode()
    return files
