"""Every code block of README.md and docs/ runs, page by page, as a reader would run it."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from documented.blocks import Block, blocks_of
from documented.designs import with_keys, with_sections
from documented.installing import INSTALLS, ROOT, left_to_run, uninstalled
from documented.pages import PAGES, prepare, run_block, run_page, run_steps
from documented.sessions import Step, differs, steps_of
from documented.shell import WIDTH
from ncgear.errors import WrongInput
from tiers import long_but

LONG = (
    "fit",
    "from-a-drawing-to-gears",
    "tutorial",
    "build",
    "tolerance",
    "frontier",
    "optimize",
    "simulate",
    "new",
    "size",
    "strength",
    "baler",
    "design",
)
THOROUGH = ["docs/commands/balance.md"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", WIDTH)
    monkeypatch.delenv("NCGEAR_DEBUG", raising=False)
    # Python that starts ncgear finds it as a shell does in which the environment is active.
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    return tmp_path


with_code = [page for page in PAGES if blocks_of(page.read_text(encoding="utf-8"))]


@pytest.mark.tiers(thorough=THOROUGH, rest="slow")
@pytest.mark.parametrize(
    "page",
    long_but([page for page in with_code if page.stem not in LONG], with_code),
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_page(page: Path, folder: Path) -> None:
    prepare(folder)
    run_page(page)


def test_what_is_left_out_is_what_ci_installs() -> None:
    assert uninstalled() == []


def test_every_listed_install_is_documented() -> None:
    written = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert [install for install in INSTALLS if install not in written] == []


def test_what_follows_an_install_is_run() -> None:
    assert left_to_run(f"{INSTALLS[0]}.venv/bin/ncgear build designs/pusher.yaml") == "ncgear build designs/pusher.yaml"


@pytest.mark.parametrize("command", ["pip install x", "npm install", "python3 -m venv .venv && rm -r x"])
def test_an_install_that_is_not_listed_is_run(command: str) -> None:
    assert left_to_run(command) == command


class TestFaults:
    """What a page may not have, so that the tests above can fail."""

    @pytest.mark.parametrize(
        "block",
        [
            Block("", "ncgear --help\n", 1),
            Block("text", "words\n", 1),
            Block("yaml", "name: x\n", 1),
            Block("yaml", "# x.yaml\nname: x\n", 1),
            Block("console", "ncgear --version\n", 1),
            Block("console", "$ ncgear --version\nncgear 99\n", 1),
            Block("console", "$ ncgear --version\n", 1),
            Block("console", "$ ncgear nonsense\n...\n", 1),
            Block("console", "$ false\n$ echo $?\n0\n", 1),
            Block("sh", "false\n", 1),
            Block("python", ">>> 1 + 1\n3\n", 1),
            Block("python", "assert False\n", 1),
        ],
        ids=lambda block: f"{block.language}-{block.text[:24]}",
    )
    def test_block(self, block: Block, folder: Path) -> None:
        with pytest.raises((AssertionError, WrongInput)):
            run_block(block, {}, "here")

    def test_an_open_fence(self) -> None:
        with pytest.raises(AssertionError, match="not closed"):
            blocks_of("```sh\nls\n")


def test_blocks_know_their_lines() -> None:
    page = "one\n\n```sh\nls\n```\n```\nbare\n```\n"
    assert blocks_of(page) == [Block("sh", "ls\n", 4), Block("", "bare\n", 7)]


def test_steps_of_a_session() -> None:
    assert steps_of("$ one \\\n> more\na\n\n$ two\n") == [Step("one \\\nmore", "a"), Step("two", "")]


def test_an_ellipsis_stands_for_anything_and_nothing_else_does() -> None:
    assert not differs("a ... d\n...", "a b c d\n\nend  \n")
    assert differs("a  b", "a b")


def test_a_failure_that_is_shown_is_none(folder: Path) -> None:
    run_steps(steps_of("$ sh -c 'exit 3'\n$ echo $?\n3\n"))


def test_a_section_takes_the_place_of_the_files_own() -> None:
    text = "a: 1\nb:  # old\n  c: 2\n\n# d\ne: 3\n"
    assert with_sections(text, "b:\n- 1\nf: 4\n") == "a: 1\nb:\n- 1\n\n# d\ne: 3\nf: 4\n"


def test_keys_are_added_however_deep() -> None:
    assert with_keys("a:\n  b: 1\n  c: 2\n", "a:\n  c: 3\n  d: {e: 4}\n") == "a:\n  b: 1\n  c: 3\n  d: {e: 4}\n"
