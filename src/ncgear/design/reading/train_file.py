"""Reading the design file of a train of gears."""

from __future__ import annotations

from pathlib import Path

from ncgear.design.reading.design_file import LARGEST_MB
from ncgear.design.reading.messages import checked
from ncgear.design.reading.places import Source
from ncgear.design.reading.points import FileKind, values_from_files
from ncgear.design.reading.text import read_text
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.trains.registry import TrainFile, train_model
from ncgear.errors import WrongInput, located
from ncgear.frozen import dataclass

FILES: dict[str, FileKind] = {}
"""Groups of a train file that can name a file: none."""


@dataclass(frozen=True)
class LoadedTrain:
    """A train file and the places of its values."""

    file: TrainFile
    source: Source


def load_train(path: Path) -> LoadedTrain:
    """Read and check a train file; WrongInput says where and what is wrong, up to ten faults."""
    document = read_yaml(read_text(path, limit_mb=LARGEST_MB), str(path))
    if not isinstance(document.data, dict) or "train" not in document.data:
        raise WrongInput("holds no train; a train file has name: and train:", location=str(document.place("")))
    source = Source(document, values_from_files(document, path, FILES))
    with located(source):
        model = train_model(document.data)
    return LoadedTrain(checked(model, source), source)
