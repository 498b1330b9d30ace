"""Commands that install: what is tested of them is that `.ci/run` installs as much.

They are the only commands of the documentation that the tests leave out; whatever follows one on its line is run.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]

INSTALLS = (
    "python3 -m venv .venv && .venv/bin/pip install -q -e . && ",
    "python3 -m venv .venv && .venv/bin/pip install -q -e '.[dev]' && ",
    ".venv/bin/pip install -q -e '.[optimize]'",
    ".venv/bin/pip install -q -e '.[step]'",
    ".venv/bin/pip install -q -e '.[sweep]'",
    ".venv/bin/pip install -q -e '.[video]'",
    ". .venv/bin/activate",
)

TESTS = ".venv/bin/pytest"
"""The command that these tests are themselves run by."""


def left_to_run(command: str) -> str:
    """A command without the part that installs; empty where nothing is left."""
    start = next((install for install in INSTALLS if command.startswith(install)), "")
    rest = command.removeprefix(start)
    return "" if rest == TESTS else rest.replace(".venv/bin/", "")


def uninstalled() -> list[str]:
    """Packages that a listed command installs and `.ci/run` does not."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    assert ".venv/bin/pip install -q -e '.[dev]'" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    named = [extra for install in INSTALLS for extra in re.findall(r"\[(\w+)\]", install)]
    return [package for extra in named for package in extras[extra] if package not in extras["dev"]]
