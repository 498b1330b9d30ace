"""What all tests share: their tiers, one thread per worker, few collections, and the command line in this process.

Tests run on all cores already, and linear algebra on threads of its own would only wait.  Thousands of tests and the
libraries stay until the end, and to look through them for what nothing needs any more would only take time.
"""

from __future__ import annotations

import os

# numpy, which the files of tests load, reads the numbers as it is loaded.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import gc
import sys
from collections.abc import Generator, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer.main

import ncgear.cli
from commands import FOLDERS, Outcome, Run, signals_kept
from ncgear.cli.progress import Steps
from shuffled import shuffled
from tiers import Collected, quarter_of, tier_of

gc.disable()
gc.set_threshold(100_000)

# What typer reads from the functions of all commands is the same in every run; to read it takes 50 ms each time.
typer.main.get_command = cache(typer.main.get_command)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the order in which tests run, and the quarter of them that runs."""
    parser.addoption("--shuffled", type=int, metavar="SEED", help="run tests in the random order of a seed")
    parser.addoption("--quarter", type=int, choices=range(4), help="run a quarter of the tests")


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Say the seed by which an order can be repeated."""
    seed = config.getoption("shuffled")
    return [] if seed is None else [f"order: --shuffled {seed}"]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the other three quarters, and put tests into the order that is asked for."""
    if (quarter := config.getoption("quarter")) is not None:
        others = [item for item in items if quarter_of(item.nodeid) != quarter]
        config.hook.pytest_deselected(items=others)
        items[:] = [item for item in items if quarter_of(item.nodeid) == quarter]
    if (seed := config.getoption("shuffled")) is not None:
        items[:] = shuffled(items, lambda item: item.path, seed)


def pytest_configure(config: pytest.Config) -> None:
    """Begin the list of all tests."""
    config.stash[Collected] = []


def pytest_unconfigure() -> None:
    """Remove the folders that tests have shared."""
    FOLDERS.close()


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark each parameter of a test that has ``tiers`` by its id; one that is slow already can only become long."""
    item.config.stash[Collected].append(item)
    tiers, callspec = item.get_closest_marker("tiers"), getattr(item, "callspec", None)
    if tiers and callspec:
        tier = tier_of(callspec.id, **tiers.kwargs)
        if tier == "long" or not item.get_closest_marker("slow"):
            for mark in {"quick": [], "long": ["slow", "long"]}.get(tier, [tier]):
                item.add_marker(mark)


def pytest_collection_finish() -> None:
    """Leave all that is there before the first test out of what is looked through from now on."""
    gc.freeze()
    gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Leave the words by which tests are chosen out of what workers send of each test three times."""
    report = yield
    report.keywords = {}
    return report


class CountedSteps(Steps):
    """Steps that count how often they are told."""

    def __init__(self, shown: Any, count: int) -> None:
        super().__init__(shown, count)
        self.count, self.told = count, 0

    def __call__(self, step: str) -> None:
        super().__call__(step)
        self.told += 1


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    """Run the command line in this process, in an empty folder: ``run("check", "d.yaml")``.

    A command that ends well has told as many steps of its progress as it had announced.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("NCGEAR_DEBUG", raising=False)
    # No line of progress, however slow the machine is: what a command says would depend on it.
    monkeypatch.setattr("ncgear.cli.progress.LINE_SECONDS", 1e6)

    announced: list[CountedSteps] = []

    def counted(*given: Any) -> CountedSteps:
        announced.append(CountedSteps(*given))
        return announced[-1]

    monkeypatch.setattr("ncgear.cli.progress.Steps", counted)
    hook = sys.unraisablehook

    def run_once(*arguments: str) -> Outcome:
        announced.clear()
        monkeypatch.setattr(sys, "argv", ["ncgear", *arguments])
        with pytest.raises(SystemExit) as exit_, signals_kept():
            ncgear.cli.main()
        monkeypatch.setattr(sys, "unraisablehook", hook)
        out, err = capsys.readouterr()
        status = int(exit_.value.code or 0)
        assert status or all(steps.told == steps.count for steps in announced), [vars(steps) for steps in announced]
        return status, out, err

    return run_once


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium without a window, for the tests of one file."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    # It loads numpy, which must not happen before the number of threads is set.
    from scenes import CHROMIUM, FLAGS

    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield started
        started.close()
