"""The page of licences has every library, with the licence that its own package says."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import PackageNotFoundError, metadata

import pytest

from commands import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = {
    name: libraries for name, libraries in PROJECT["optional-dependencies"].items() if name not in ("dev", "bench")
}
PAGE = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
ROWS = [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in PAGE.splitlines() if line[:2] == "| "]
OWN = {row[0]: row[1] for row in ROWS if len(row) == 2}
OF_EXTRAS = {(row[0], row[1]): row[2] for row in ROWS if len(row) == 3}

WORDS = {"The MIT License (MIT)": "MIT", "BSD": "BSD-3-Clause", "BSD License": "BSD-3-Clause", "MIT License": "MIT"}
WORDS |= {"ISC License (ISCL)": "ISC", "Apache Software License": "Apache-2.0"}
"""What packages call licences that have a shorter name."""


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[^\w.-]", one)[0] for one in requirements}


def test_every_library_has_its_row() -> None:
    assert set(OWN) - {"library"} == names(PROJECT["dependencies"])
    assert set(OF_EXTRAS) - {("extra", "library")} == {
        (extra, name) for extra, libraries in EXTRAS.items() for name in names(libraries)
    }


@pytest.mark.parametrize("name", sorted({*OWN, *(name for _, name in OF_EXTRAS)} - {"library"}))
def test_a_library_says_the_same_of_itself(name: str) -> None:
    told = ({name: licence for (_, name), licence in OF_EXTRAS.items()} | OWN)[name]
    try:
        about = metadata(name)
    except PackageNotFoundError:
        pytest.skip(f"{name} is not installed")
    said = [about.get("License-Expression") or "", (about.get("License") or "").partition("\n")[0]]
    said += [one.rpartition(":: ")[2] for one in about.get_all("Classifier") or () if one.startswith("License")]
    own = re.split(r"[;,]", told.removeprefix("of its own, after the "))[0]
    assert any(own in (WORDS.get(one, one), one) or own.split("-")[0] in one for one in said if one), said
