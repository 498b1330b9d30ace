"""Reading a balance file, with measurements and designs that it names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ncgear.design.balance import Balance
from ncgear.design.load import LARGEST_MB, LoadedDesign, load, of_key, wrong_input
from ncgear.design.messages import problems
from ncgear.design.points_file import Columns, PointsFile, read_points
from ncgear.design.positions import Document, Place, read_yaml
from ncgear.design.text_file import read_text
from ncgear.errors import DesignError, WrongInput

RUNS = Columns((("weight_deg",), ("amplitude",), ("phase_deg",)), 1000)
RUNS_KEY = "chain_drive.runs"
FILE_KEY = "chain_drive.file"


@dataclass(frozen=True)
class BalanceSource:
    """Where the values stand: in the balance file, and the runs of a chain drive perhaps in a CSV file."""

    document: Document
    runs: PointsFile | None

    def place(self, key: str) -> Place:
        """Where ``key`` (dotted) stands, or its nearest parent that does."""
        row = key.removeprefix(f"{RUNS_KEY}.").partition(".")[0]
        if self.runs is not None and key.startswith(f"{RUNS_KEY}.") and row.isdigit():
            return self.runs.place(int(row))
        return self.document.place(FILE_KEY if self.runs is not None and key == RUNS_KEY else key)


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
    source = BalanceSource(document, _runs(document, path))
    try:
        balance = Balance.model_validate(_with_runs(document.data, source.runs))
    except ValidationError as error:
        raise wrong_input(problems(error, Balance), source) from error
    return LoadedBalance(balance, source, _designs(balance, document, path))


def _runs(document: Document, path: Path) -> PointsFile | None:
    """The CSV file of a chain drive; one that is no text is left to the schema."""
    chain = document.data.get("chain_drive")
    if not isinstance(chain, dict) or not isinstance(chain.get("file"), str):
        return None
    if chain.get("runs") is not None:
        raise WrongInput("given beside file; keep one of them", key=RUNS_KEY, location=str(document.place(RUNS_KEY)))
    file = path.parent / chain["file"]
    try:
        return read_points(file, RUNS)
    except WrongInput as error:
        raise of_key(error, file, FILE_KEY, document) from error


def _with_runs(data: dict[str, Any], runs: PointsFile | None) -> dict[str, Any]:
    if runs is None:
        return data
    rows = zip(*runs.columns.values(), strict=True)
    items = [dict(zip(runs.columns, row, strict=True)) for row in rows]
    return {**data, "chain_drive": {**data["chain_drive"], "runs": items}}


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
