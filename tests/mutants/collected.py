"""All tests of README's command, collected once, and what of them runs in a process that is forked off."""

from __future__ import annotations

import gc
import importlib
import os
import pkgutil
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from resource import RLIMIT_CPU, getrlimit, setrlimit
from types import CodeType, FunctionType
from typing import Any

import coverage
import pytest

import ncgear
from mutants.drawn import ROOT, SOURCE, Mutant

TESTS = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Test:
    """A test function of a tier, with all its parameters of that tier."""

    __test__ = False

    name: str
    tier: str
    items: Sequence[pytest.Item] = field(compare=False)

    @property
    def file(self) -> str:
        """Its file, from the folder of tests on."""
        return self.name.partition("::")[0]

    @property
    def unit(self) -> str:
        """Name and tier."""
        return f"{self.name} {self.tier}"


@dataclass(frozen=True)
class Ran:
    """What a test runs: lines by module, and the processor time that it takes in s."""

    seconds: float
    lines: dict[str, list[int]]


class Collected:
    """A plugin of pytest that calls a function with all tests in place of running them."""

    def __init__(self, then: Callable[[Collected], None]) -> None:
        self._then = then
        self._failed = False
        self.tests: list[Test] = []

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Collect by functions, and go on."""
        found: dict[tuple[str, str], list[pytest.Item]] = {}
        for item in session.items:
            tier = "thorough" if item.get_closest_marker("thorough") else "quick"
            name = f"{item.path.relative_to(TESTS)}::{item.nodeid.partition('[')[0].partition('::')[2]}"
            found.setdefault((name, tier), []).append(item)
        self.tests = [Test(name, tier, items) for (name, tier), items in found.items()]
        for module in pkgutil.walk_packages(ncgear.__path__, "ncgear."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
        gc.unfreeze()
        self._functions = [one for one in gc.get_objects() if isinstance(one, FunctionType)]
        gc.freeze()
        self._then(self)
        return True

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Remember a failure."""
        self._failed = self._failed or report.failed

    def ran(self, tests: Sequence[Test]) -> dict[str, Any]:
        """What some tests run, and whether they fail, by their units; in a process of its own."""
        record = coverage.Coverage(data_file=None, include=[f"{SOURCE}/*"])
        record.set_option("run:disable_warnings", ["no-data-collected"])
        found: dict[str, Any] = {test.unit: {"seconds": 0.0, "failed": False, "lines": {}} for test in tests}
        record.start()
        for unit, item, after in _in_order(tests):
            record.switch_context(unit)
            begun = time.process_time()
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
            found[unit]["seconds"] += time.process_time() - begun
            found[unit]["failed"] |= self._failed
            self._failed = False
        record.stop()
        data = record.get_data()
        for file in data.measured_files():
            if not file.endswith(".py"):
                continue
            module = str(Path(file).relative_to(SOURCE))
            for line, units in data.contexts_by_lineno(file).items():
                for unit in filter(None, units):
                    found[unit]["lines"].setdefault(module, []).append(line)
        return found

    def under(self, mutant: Mutant, longest_s: Mapping[Test, float]) -> dict[str, str | None]:
        """The first of some tests that fails under a mutation, by its unit; in a process of its own.

        The process ends where a test takes more processor time than is given for it.
        """
        self._mutate(mutant)
        longest, (_, most_s) = {test.unit: given for test, given in longest_s.items()}, getrlimit(RLIMIT_CPU)
        for unit, item, after in _in_order(list(longest_s)):
            setrlimit(RLIMIT_CPU, (min(int(time.process_time() + longest[unit]) + 1, most_s), most_s))
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
            if self._failed:
                return {"failed": unit}
        return {"failed": None}

    def _mutate(self, mutant: Mutant) -> None:
        """Put a mutation into this process and into a source that processes begun by tests run."""
        os.environ["PYTHONPATH"] = str(_source(mutant, Path(tempfile.mkdtemp())))
        path = SOURCE / mutant.module
        before, after = (compile(text, path, "exec", dont_inherit=True) for text in (path.read_bytes(), mutant.source))
        codes = dict(zip(_codes(before), _codes(after), strict=True))
        for function in self._functions:
            if function.__code__.co_filename == str(path):
                function.__code__ = codes[function.__code__]


def _in_order(tests: Sequence[Test]) -> Iterator[tuple[str, pytest.Item, pytest.Item | None]]:
    """The unit, the test that runs, and the one after it; pytest says nothing of them from now on."""
    plugins = tests[0].items[0].config.pluginmanager
    if plugins.has_plugin("terminalreporter"):
        plugins.unregister(name="terminalreporter")
    items = [(test.unit, item) for test in tests for item in test.items]
    for (unit, item), after in zip(items, [*(item for _, item in items[1:]), None], strict=True):
        yield unit, item, after


def _source(mutant: Mutant, folder: Path) -> Path:
    """A source with one other module; the rest of it is links."""
    (folder / "designs").symlink_to(ROOT / "designs")
    old, new = SOURCE, folder / "src"
    for part in Path(mutant.module).parts:
        new.mkdir()
        for path in old.iterdir():
            if path.name == "__pycache__":
                shutil.copytree(path, new / path.name)
            elif path.name != part:
                (new / path.name).symlink_to(path)
        old, new = old / part, new / part
    new.write_bytes(mutant.source)
    return folder / "src"


def _codes(code: CodeType) -> list[CodeType]:
    """A code and all codes within."""
    return [code, *(below for one in code.co_consts if isinstance(one, CodeType) for below in _codes(one))]


def collect(then: Callable[[Collected], None], marks: str) -> None:
    """Collect the tests that marks ask for, in one process and with one thread, and go on with them."""
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    os.chdir(TESTS.parent)
    fixed = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-o", "addopts="]
    pytest.main([*fixed, "-m", marks, str(TESTS)], plugins=[Collected(then)])
