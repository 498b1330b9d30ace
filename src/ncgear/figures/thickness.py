"""Play and contact over the band of tooth thickness that the file allows, for summary.json and for the data sheet."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.figures.quantities import told
from ncgear.figures.tables import Column, Table
from ncgear.project.drive import Drive
from ncgear.teeth.backlash import Play

if TYPE_CHECKING:
    from ncgear.project.thickness import AtThickness

BAND = "thinnest", "outlines", "thickest"
"""The teeth of a band, in the order of its values."""

TITLE = "Play and contact over the band of tooth thickness"

NOTE = (
    "outlines, drawings and solids stand in the middle of the band; idle flanks have the whole deviation, so that "
    "pushing flanks keep the law"
)


def play_figures(play: Play, least_rad: float, greatest_rad: float) -> dict[str, float]:
    """The play along the normal and of the driven gear, whose greatest is told where it is another than its least."""
    return {
        "backlash_mm": play.least_normal_mm.value,
        "backlash_max_mm": play.largest_normal_mm.value,
        "play_rad": least_rad,
        **({"play_greatest_rad": greatest_rad} if play.thicker_mm else {}),
    }


def thickness_summary(drive: Drive) -> dict[str, dict[str, float]]:
    """Figures of the pair by the teeth of ``BAND``; empty where the file gives no band."""
    return {name: _figures(one) for name, one in zip(BAND, drive.thickness_band, strict=False)}


def _figures(one: AtThickness) -> dict[str, float]:
    extremes, contact = one.extremes, one.contact
    play = extremes.backlash_rad
    return {
        "thickness_deviation_mm": one.deviation_mm,
        **play_figures(one.play, play.low.value, play.high.value),
        "play_greatest_rad": play.high.value,
        "contact_ratio_mean": contact.contact_ratio,
        "contact_ratio_min": contact.least_arc,
        "contact_ratio_back_min": contact.back.pairs.least_arc,
        "transmission_error_rad": extremes.pushing_error_rad.width,
        "transmission_error_back_rad": extremes.back_error_rad.width,
    }


def band_table(drive: Drive) -> tuple[Table, ...]:
    """The figures of the band side by side; no table where the file gives none."""
    band = tuple(thickness_summary(drive).values())
    if not band:
        return ()
    rows = [[told(key, one[key]) for one in band] for key in band[0]]
    heads = Column(""), *(Column(name) for name in BAND), Column("unit")
    cells = tuple((row[0][0], *(text for _, text, _ in row), row[0][2]) for row in rows)
    return (Table(TITLE, heads, cells, (NOTE,)),)
