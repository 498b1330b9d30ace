"""The pictures of a build as PNG."""

from __future__ import annotations

from ncgear.drawings.assembled import Pictures
from ncgear.drawings.charts.drawer import (
    CONTACT_COLUMN,
    CONTACT_LOOK,
    MOTION_COLUMN,
    MOTION_LOOK,
    beside_png,
    column_png,
)
from ncgear.drawings.plots.assembled_pair import pitch_curves_png, teeth_png


def drawn(shown: Pictures) -> dict[str, bytes]:
    """The pictures by the names of their files."""
    pair = shown.pair
    return {
        "pitch_curves.png": pitch_curves_png(*shown.pitch_curves, f"{pair}: pitch curves at phi1 = 0"),
        "tooth_pair.png": teeth_png(shown.teeth, shown.module_mm, shown.positions, f"{pair}: tooth outlines in mesh"),
        "motion.png": column_png(shown.motion, shown.of_machine("motion"), MOTION_LOOK, MOTION_COLUMN),
        "contact.png": column_png(shown.contact, f"{pair}: contact of the teeth", CONTACT_LOOK, CONTACT_COLUMN),
        "power.png": beside_png(shown.load, shown.of_machine(f"{shown.load_name} and power")),
    }
