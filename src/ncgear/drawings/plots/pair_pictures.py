"""The pictures of a build as PNG, by the names of their files."""

from __future__ import annotations

from ncgear.drawings.assembled import GearPictures, LoadPictures, MotionPicture
from ncgear.drawings.charts.drawer import (
    CONTACT_COLUMN,
    CONTACT_LOOK,
    MOTION_COLUMN,
    MOTION_LOOK,
    beside_png,
    column_png,
)
from ncgear.drawings.plots.assembled_pair import pitch_curves_png, teeth_png


def motion_drawn(shown: MotionPicture) -> dict[str, bytes]:
    """The picture of the machine's motion."""
    return {"motion.png": column_png(shown.charts, shown.title, MOTION_LOOK, MOTION_COLUMN)}


def gears_drawn(shown: GearPictures) -> dict[str, bytes]:
    """The pictures of the pitch curves and of the teeth."""
    pair = shown.pair
    return {
        "pitch_curves.png": pitch_curves_png(*shown.pitch_curves, f"{pair}: pitch curves at phi1 = 0"),
        "tooth_pair.png": teeth_png(shown.teeth, shown.module_mm, shown.positions, f"{pair}: tooth outlines in mesh"),
    }


def load_drawn(shown: LoadPictures) -> dict[str, bytes]:
    """The pictures of contact and load."""
    return {
        "contact.png": column_png(shown.contact, f"{shown.pair}: contact of the teeth", CONTACT_LOOK, CONTACT_COLUMN),
        "power.png": beside_png(shown.load, shown.load_title),
    }
