"""The files of a run of tolerances: figures, assemblies and pictures."""

from __future__ import annotations

import numpy as np

from ncgear.drawings.plots.tolerance_plots import Spread, sources, spreads
from ncgear.figures.numbers import json_text
from ncgear.figures.toleranced import SOURCES, assemblies_csv, tolerance_json
from ncgear.project.tolerance import Tolerated

SHOWN = {
    "least_play_mm": "least play",
    "transmission_error_mm": "transmission error",
    "motion_error": "motion error",
}
"""The figures whose sources are drawn."""


def tolerance_files(tolerated: Tolerated) -> dict[str, bytes]:
    """JSON, CSV and pictures; that of sources only where something varies."""
    files = {
        "tolerance.json": json_text(tolerance_json(tolerated)).encode(),
        "assemblies.csv": assemblies_csv(tolerated).encode(),
        "spread.png": _spreads(tolerated),
    }
    shown = {name: tolerated.indices[name] for name in SHOWN if name in tolerated.indices}
    if shown:
        of = {
            SHOWN[name]: {SOURCES[one.source]: (max(one.total, 0.0), one.error) for one in found}
            for name, found in shown.items()
        }
        files["sources.png"] = sources(of, f"{tolerated.drive.design.name}: which tolerance matters")
    return files


def _spreads(tolerated: Tolerated) -> bytes:
    found, nominal, output = tolerated.assemblies, tolerated.nominal, tolerated.drive.linkage.OUTPUT
    knocking = tolerated.knocking_mm if tolerated.knock is not None else None
    place = output.place
    shown = [
        Spread("least play in mm", found.least_play_mm, float(nominal.least_play_mm[0]), 0.0, True, "jams"),
        Spread("transmission error in mm", found.transmission_error_mm, float(nominal.transmission_error_mm[0])),
        Spread(
            f"motion error of the {output.name} in {place.text}",
            place.factor * found.motion_error,
            place.factor * float(nominal.motion_error[0]),
        ),
    ]
    if knocking is not None:
        play = Spread(
            "play where the torque turns round in mm" if tolerated.loaded else "largest play in mm",
            found.reversal_play_mm,
            float(np.max(nominal.reversal_play_mm)),
            knocking,
            False,
            "knocks",
        )
        shown.insert(1, play)
    return spreads(shown, f"{tolerated.drive.design.name}: {found.count} assemblies")
