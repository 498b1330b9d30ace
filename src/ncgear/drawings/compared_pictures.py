"""The pictures of measured gears: PNG by file name."""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.drawings.charts.chart import Chart, Line, Role
from ncgear.drawings.charts.drawer import CONTACT_COLUMN, CONTACT_LOOK, column_png
from ncgear.drawings.plots.deviations_plot import deviations_png, heading
from ncgear.figures.numbers import MICRORAD
from ncgear.project.compared import ComparedPair

MEASURED, EXACT = "pair as measured", "exact outlines"


def compared_pictures(pair: ComparedPair, name: str) -> dict[str, bytes]:
    """Each measured gear with its deviations, and play and transmission error of the pair over the cycle."""
    gears = {f"measured-{one.gear.value}.png": deviations_png(one, heading(one, name)) for one in pair.gears}
    angle, end = np.degrees(pair.placement.phi1_rad), degrees(pair.placement.cycle_rad)
    charts = [
        Chart(
            quantity,
            unit,
            (Line(Role.OTHER, EXACT, angle, exact), Line(Role.OWN, MEASURED, angle, measured)),
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
