"""A page of the documentation, run from top to bottom in a folder of its own."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from documented.blocks import Block, blocks_of
from documented.designs import put
from documented.installing import ROOT, left_to_run
from documented.python import run_python
from documented.sessions import Step, differs, steps_of
from documented.shell import run_line

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]

STATUS = "echo $?"
"""The command that shows how the one before it ended; without it a command has to end well."""


def prepare(folder: Path) -> None:
    """What a reader has after cloning, as far as the pages speak of it."""
    shutil.copytree(ROOT / "designs", folder / "designs")


def run_page(page: Path) -> None:
    """Run every block of a page in the current folder; AssertionError names page, line and what came instead."""
    names: dict[str, Any] = {"__name__": page.stem}
    for block in blocks_of(page.read_text(encoding="utf-8")):
        place = f"{page.relative_to(ROOT)}:{block.line}"
        try:
            run_block(block, names, place)
        except Exception as error:
            raise AssertionError(f"{place}: {block.language or 'no language'}: {error}") from error


def run_block(block: Block, names: dict[str, Any], place: str) -> None:
    """Run one block; a language that is not known is an error."""
    match block.language:
        case "sh":
            run_steps([Step(line, "...") for line in block.text.splitlines()])
        case "console":
            run_steps(steps_of(block.text))
        case "python":
            run_python(block.text, names, place)
        case "yaml":
            put(block.text)
        case _:
            raise AssertionError("sh, console, python or yaml is right")


def run_steps(steps: list[Step]) -> None:
    """Run commands one after the other; AssertionError where one prints something else, or fails unannounced."""
    status = 0
    for step, after in zip(steps, [*steps[1:], None], strict=True):
        if step.command == STATUS:
            printed = f"{status}\n"
        else:
            status, printed = run_line(left_to_run(step.command))
            announced = after is not None and after.command == STATUS
            assert announced or status == 0, f"{step.command!r} ended with {status}:\n{printed}"
        assert not differs(step.shown, printed), f"{step.command!r} printed\n{printed}\nnot\n{step.shown}"
