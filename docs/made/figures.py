"""Every picture of README.md and docs/, and what makes it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from made import drawings, gallery

DOCS = Path(__file__).parents[1]
IMAGES = DOCS / "images"


def _report() -> bytes:
    # Imported here: a browser is needed for nothing else.
    from made.screenshots import report

    return report()


def _studio() -> bytes:
    from made.screenshots import studio

    return studio()


def _studio_in_use() -> bytes:
    from made.screenshots import studio_in_use

    return studio_in_use()


DRAWN: dict[str, Callable[[], bytes]] = {
    "method-inversion.png": drawings.inversion,
    "method-rack.png": drawings.rack,
    "stroke-keys.png": drawings.stroke,
    "method-contact.png": drawings.contact,
    "heart-drawing.png": drawings.heart_drawing,
    "heart-check.png": drawings.heart_check,
    "heart-fit.png": drawings.heart_fit,
    "heart-gears.png": drawings.heart_gears,
    "pusher-report.png": _report,
    "studio.png": _studio,
    "studio.gif": _studio_in_use,
    **{f"{gallery.PREFIX}{name}.png": partial(gallery.thumbnail, name) for name in gallery.PATHS},
}
"""Pictures made for a page, by their names in docs/images."""

COMMANDS: dict[str, dict[str, str]] = {
    "build designs/baler-86.yaml --out {folder}": {"tooth_pair.png": "baler-86-tooth-pair.png"},
    "build designs/rounded-square.yaml --out {folder}": {"tooth_pair.png": "rounded-square-tooth-pair.png"},
    "build designs/lobed-motor.yaml --out {folder}": {"train.png": "lobed-motor.png"},
    "build designs/pusher.yaml --out {folder}": {
        "tooth_pair.png": "pusher-tooth-pair.png",
        "motion.png": "pusher-motion.png",
        "power.png": "pusher-power.png",
    },
    "build designs/baler.yaml --format drawing --out {folder}": {
        "driving_drawing.svg": "baler-driving-drawing.svg",
        "pair_drawing.svg": "baler-pair-drawing.svg",
    },
    "animate designs/pusher.yaml --frames 36 --width 640 --out {folder}/pusher.gif": {"pusher.gif": "pusher.gif"},
    **{
        f"animate designs/{name}.yaml --frames 24 --width 480 --out {{folder}}/{name}.gif": {
            f"{name}.gif": f"{name}.gif"
        }
        for name in (
            "rocker-drive",
            "quick-return-shaper",
            "scotch-yoke-pump",
            "rack-feed",
            "spiral-pair",
            "oval-flow-meter",
        )
    },
    "build designs/transplanter.yaml --out {folder}": {"train.png": "transplanter.png"},
    "animate designs/transplanter.yaml --frames 36 --width 400 --out {folder}/transplanter.gif": {
        "transplanter.gif": "transplanter.gif"
    },
    "frontier designs/baler-frontier.yaml --out {folder}": {"frontier.png": "baler-frontier.png"},
    "strength designs/baler-half-dynamics.yaml --out {folder}": {
        "strength.png": "baler-half-strength.png",
        "strength-cycle.png": "baler-half-strength-cycle.png",
    },
    "tolerance designs/oval-flow-meter.yaml --out {folder}": {
        "spread.png": "oval-flow-meter-tolerance.png",
        "sources.png": "oval-flow-meter-tolerance-sources.png",
    },
}
"""Commands, and what of their output in a folder goes into docs/images under which name."""


def pictures() -> set[str]:
    """Names of all pictures in docs/images."""
    return {*DRAWN, *(name for found in COMMANDS.values() for name in found.values())}


def make_pictures() -> None:
    """Make every picture of docs/images anew."""
    for name, draw in DRAWN.items():
        (IMAGES / name).write_bytes(draw())
    for command, found in COMMANDS.items():
        _copy_from(command, found)


def _copy_from(command: str, found: dict[str, str]) -> None:
    with TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "ncgear", *command.format(folder=folder).split()]
        subprocess.run(words, cwd=DOCS.parent, check=True, stdout=subprocess.DEVNULL)
        for written, name in found.items():
            (IMAGES / name).write_bytes((Path(folder) / written).read_bytes())
