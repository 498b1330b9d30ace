"""The strength of a pair of gears as files: figures, a table with a row per tooth, pictures."""

from __future__ import annotations

from ncgear.drawings.strength_pictures import strength_pictures
from ncgear.figures.numbers import json_text
from ncgear.figures.strong import strength_csv, strength_figures
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Verdict


def strength_files(drive: Drive, verdict: Verdict, beside: Verdict | None = None) -> dict[str, bytes]:
    """Pictures, table and figures as files; ``beside`` is the verdict by another method, whose figures are told too."""
    return {
        **strength_pictures(drive, verdict),
        "strength.csv": strength_csv(verdict.strength).encode(),
        "strength.json": json_text(strength_figures(drive, verdict, beside)).encode(),
    }
