"""The files of a run of tolerances: figures, assemblies and pictures."""

from __future__ import annotations

from math import degrees

import numpy as np

from ncgear.drawings.plots.tolerance_plots import Spread, sources, spreads
from ncgear.figures.numbers import json_text
from ncgear.figures.toleranced import assemblies_csv, source_words, tolerance_json
from ncgear.files.build import folder_of
from ncgear.project.tolerance import Tolerated, ToleratedPair

SHOWN = {
    "least_play_mm": "least play",
    "transmission_error_mm": "transmission error",
    "motion_error": "motion error",
}
"""The figures whose sources are drawn."""


def tolerance_files(tolerated: Tolerated) -> dict[str, bytes]:
    """JSON, CSV and pictures; that of sources only where something varies, those of two pairs in their folders."""
    files = {
        "tolerance.json": json_text(tolerance_json(tolerated)).encode(),
        "assemblies.csv": assemblies_csv(tolerated).encode(),
        "spread.png": _spreads(tolerated),
    }
    if len(tolerated.pairs) > 1:
        files |= {
            f"{folder_of(pair.drive.stage)}spread.png": _pair_spreads(tolerated, pair) for pair in tolerated.pairs
        }
    shown = {name: tolerated.indices[name] for name in SHOWN if name in tolerated.indices}
    if shown:
        of = {
            SHOWN[name]: {source_words(one.source): (max(one.total, 0.0), one.error) for one in found}
            for name, found in shown.items()
        }
        files["sources.png"] = sources(of, f"{tolerated.drive.design.name}: which tolerance matters")
    return files


def _spreads(tolerated: Tolerated) -> bytes:
    """The machine's figures; those of plays too of a single pair, and the play of both together of two."""
    found, nominal, output = tolerated.assemblies, tolerated.nominal, tolerated.drive.linkage.OUTPUT
    place, pair = output.place, tolerated.pairs[0]
    motion = Spread(
        f"motion error of the {output.name} in {place.text}",
        place.factor * found.motion_error,
        place.factor * float(nominal.motion_error[0]),
    )
    if len(tolerated.pairs) == 1:
        shown = [*_of_pair(tolerated, pair), motion]
    else:
        shown = [
            Spread("least play of either pair in mm", found.least_play_mm, float(nominal.least_play_mm[0]), *JAMS),
            Spread(
                "play of the last driven gear in deg, at most",
                np.degrees(found.play_max_rad),
                degrees(nominal.play_max_rad[0]),
            ),
            Spread(
                "transmission error of both pairs in mm",
                found.transmission_error_mm,
                float(nominal.transmission_error_mm[0]),
            ),
            motion,
        ]
    return spreads(shown, f"{tolerated.drive.design.name}: {found.count} assemblies")


def _pair_spreads(tolerated: Tolerated, pair: ToleratedPair) -> bytes:
    """The figures of one of two pairs."""
    title = f"{tolerated.drive.design.name}, stage {pair.drive.stage}: {tolerated.assemblies.count} assemblies"
    return spreads(_of_pair(tolerated, pair), title)


JAMS = 0.0, True, "jams"
"""The limit of the least play, on which side of it is bad, and what assemblies do there."""


def _of_pair(tolerated: Tolerated, pair: ToleratedPair) -> list[Spread]:
    found, nominal = pair.assemblies, pair.nominal
    shown = [
        Spread("least play in mm", found.least_play_mm, float(nominal.least_play_mm[0]), *JAMS),
        Spread("transmission error in mm", found.transmission_error_mm, float(nominal.transmission_error_mm[0])),
    ]
    if pair.knock is not None:
        play = Spread(
            "play where the torque turns round in mm" if tolerated.loaded else "largest play in mm",
            found.reversal_play_mm,
            float(np.max(nominal.reversal_play_mm)),
            pair.knocking_mm,
            False,
            "knocks",
        )
        shown.insert(1, play)
    return shown
