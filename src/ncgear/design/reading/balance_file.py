"""Reading a balance file, with measurements and designs that it names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from ncgear.design.keys.balance import Balance
from ncgear.design.reading.design_file import LARGEST_MB, LoadedDesign, load, of_key, wrong_input
from ncgear.design.reading.messages import problems
from ncgear.design.reading.points import Measured, measured
from ncgear.design.reading.text import read_text
from ncgear.design.reading.yaml import Document, Place, read_yaml
from ncgear.errors import DesignError, WrongInput

OF_A_DESIGN = {"linkage", "motion"}
"""Keys that every design file has and no balance file: said once, instead of a fault for each of its keys."""


@dataclass(frozen=True)
class BalanceSource:
    """Where the values stand: in the balance file, and measurements perhaps in CSV files by their group."""

    document: Document
    measured: dict[str, Measured]

    def place(self, key: str) -> Place:
        """Where ``key`` (dotted) stands, or its nearest parent that does."""
        group, _, inner = key.partition(".")
        if group not in self.measured:
            return self.document.place(key)
        stands_for_file = inner.partition(".")[0] in self.measured[group].values
        return self.measured[group].place(inner) or self.document.place(f"{group}.file" if stands_for_file else key)


@dataclass(frozen=True)
class LoadedBalance:
    """A balance file, the designs it names by their keys, and where everything stands."""

    balance: Balance
    source: BalanceSource
    designs: dict[str, LoadedDesign]

    def located(self, error: DesignError) -> DesignError:
        """``error``, which knows only its key, with the place of that key; an error that has a place keeps it."""
        if not error.location:
            error.location = str(self.source.place(error.key))
        return error


def load_balance(path: Path) -> LoadedBalance:
    """Read and check a balance file and the designs it names; WrongInput says where and what is wrong."""
    document = read_yaml(read_text(path, limit_mb=LARGEST_MB), str(path))
    if not isinstance(document.data, dict):
        problem = "holds no balance; a balance file is lines of `key: value`, and begins with `name:`"
        raise WrongInput(problem, location=str(document.place("")))
    if document.data.keys() >= OF_A_DESIGN:
        problem = (
            "is a design file; a balance file is needed, in which mechanisms.design or gears.design names this one"
        )
        raise WrongInput(problem, location=str(document.place("")))
    found = measured(document, path, lambda error, file, key: of_key(error, file, key, document))
    source = BalanceSource(document, found)
    data = {**document.data, **{group: {**document.data[group], **one.values} for group, one in found.items()}}
    try:
        balance = Balance.model_validate(data)
    except ValidationError as error:
        raise wrong_input(problems(error, Balance), source) from error
    return LoadedBalance(balance, source, _designs(balance, document, path))


def _designs(balance: Balance, document: Document, path: Path) -> dict[str, LoadedDesign]:
    named = {f"mechanisms.{k}.design": one.design for k, one in enumerate(balance.mechanisms) if one.design is not None}
    if balance.gears is not None:
        named["gears.design"] = balance.gears.design
    found = {}
    for key, name in named.items():
        try:
            found[key] = load(path.parent / name)
        except WrongInput as error:
            raise of_key(error, path.parent / name, key, document) from error
    return found
