"""The worked designs, loaded, computed and built once per process for all tests.

A drive computes each value when it is first asked for, so tests that ask the same drive share its teeth and solids.  A
test that looks at what a drive has not yet computed makes one of its own.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from commands import new_folder
from ncgear.design.keys.design import Design, design_model
from ncgear.design.reading.design_file import LoadedDesign, load, load_train
from ncgear.design.reading.text import has_train
from ncgear.drawings.beside import Here
from ncgear.files.build import build
from ncgear.project.drive import Drive
from ncgear.trains.train import Train

DESIGNS = Path(__file__).parents[1] / "designs"

MACHINES, TRAINS = (
    {
        path.stem: path
        for path in sorted(DESIGNS.glob("*.yaml"))
        if has_train(path.read_text(encoding="utf-8")) is of_train
    }
    for of_train in (False, True)
)
"""The files of designs/ by their names: machines of one motion, and trains of gears."""


@cache
def train_of(name: str, changes: tuple[tuple[str, str], ...] = ()) -> Train:
    """The train of a file of designs/ with texts in place of others."""
    text = TRAINS[name].read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "changed.yaml"
        path.write_text(text, encoding="utf-8")
        return load_train(path).file.train.train()


FILES = {
    "summary.json",
    "manifest.json",
    "assembly.json",
    "law.csv",
    "pitch.csv",
    "data_sheet.md",
    "contact.csv",
    "driving.csv",
    "driven.csv",
    "driving.stl",
    "driven.stl",
}
PICTURES = {f"{name}.png" for name in ("pitch_curves", "tooth_pair", "contact", "motion", "power")}
"""What a build of one pair writes when nothing else is asked for."""


def designs_with(*sections: str) -> list[str]:
    """Files of designs/ that have one of some sections, by their text: to load all of them takes a second."""
    begins = re.compile(rf"^({'|'.join(sections)}):", flags=re.MULTILINE)
    return [name for name, path in MACHINES.items() if begins.search(path.read_text(encoding="utf-8"))]


@cache
def loaded(name: str) -> LoadedDesign:
    """A file of designs/; whoever changes its data changes a copy."""
    return load(DESIGNS / f"{name}.yaml")


@cache
def drive(name: str) -> Drive:
    """The drive of a file of designs/."""
    return Drive(loaded(name).design)


def design_of(data: dict[str, Any]) -> Design:
    """A design from plain values, of whatever mechanism they name."""
    return design_model(data).model_validate(data)


def drive_of_text(text: str) -> Drive:
    """The drive of a design file's text, computed by nobody else."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "own.yaml"
        path.write_text(text, encoding="utf-8")
        return Drive(load(path).design)


@dataclass(frozen=True)
class Built:
    """A built design: its folder and its summary."""

    folder: Path
    summary: dict[str, Any]

    def table(self, name: str) -> np.ndarray:
        """A table of the folder, its columns by name."""
        return np.genfromtxt(self.folder / name, delimiter=",", names=True)

    def outline(self, gear: str) -> np.ndarray:
        """The written outline of a gear, shape (n, 2)."""
        table = self.table(f"{gear}.csv")
        return np.column_stack([table["x_mm"], table["y_mm"]])


class _WithoutPictures(Here):
    """Draws nothing."""

    def begun(self, drawing: str, *given: Any) -> Callable[[], Any]:
        return dict


@cache
def built(name: str) -> Built:
    """A file of designs/ as a user builds it, but for its pictures, which take half of the time."""
    folder = new_folder() / name
    build(drive(name), folder, lambda step: None, drawer=_WithoutPictures())
    return Built(folder, json.loads((folder / "summary.json").read_text()))
