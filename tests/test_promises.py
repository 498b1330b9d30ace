"""What is promised to stay is there, and the pages use nothing else of a drive."""

from __future__ import annotations

import re

import pytest

import ncgear
from at_once import at_once
from commands import ROOT, Run
from ncgear.design.keys.balance import Balance
from ncgear.design.keys.design import Design

PAGES = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "notebook").glob("*.ipynb")]
STABLE = (ROOT / "docs" / "promises.md").read_text(encoding="utf-8")
CELLS = [line.split("|")[1] for line in STABLE.splitlines() if line.startswith("| `")]
NAMES = [name for cell in CELLS for name in re.findall(r"`([\w.]+)`", cell)]
OF_DRIVE = {name for name in NAMES if "." not in name}


def test_all_that_ncgear_offers_is_promised() -> None:
    assert sorted(name.removeprefix("ncgear.") for name in NAMES if "." in name) == sorted(ncgear.__all__)


def test_what_is_promised_of_a_drive_is_there() -> None:
    drive = ncgear.load(ncgear.examples()["uniform-crank"])
    assert [name for name in OF_DRIVE if name not in vars(drive) and not hasattr(type(drive), name)] == []


@at_once("page", PAGES)
def test_pages_use_nothing_else_of_a_drive(page: object) -> None:
    text = page.read_text(encoding="utf-8")  # type: ignore[attr-defined]
    code = "\n".join(line for line in text.splitlines() if re.match(r"\s*(>>>|\.\.\.|\")", line))
    assert set(re.findall(r"\bdrive\.([a-z]\w*)\b(?!\.(?:yaml|py|png|gif))", code)) <= OF_DRIVE


@pytest.mark.parametrize("model", [Design, Balance])
def test_a_file_without_a_format_has_the_first(model: type) -> None:
    assert model.model_fields["format"].default == 1  # type: ignore[attr-defined]


def test_a_later_format_is_refused_at_its_line(run: Run) -> None:
    text = (ROOT / "designs" / "pusher.yaml").read_text(encoding="utf-8")
    for number, status in ((1, 0), (2, 2)):
        with open("later.yaml", "w", encoding="utf-8") as file:
            file.write(text.replace("name: pusher", f"name: later\nformat: {number}"))
        assert run("check", "later.yaml")[0] == status
    assert "later.yaml:3:1: format: 2 given; 1 is needed" in run("check", "later.yaml")[2]
