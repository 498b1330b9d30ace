"""Which tests run which lines: every file by itself, so that what one has kept for all others is run by each."""

from __future__ import annotations

import json
import sys
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from mutants.collected import TESTS, Collected, Ran, Test
from mutants.drawn import SOURCE
from mutants.forked import Work, results

LONGEST_S = 600.0
"""Processor time after which a file of tests is no judge, in s."""

OTHERS_S = 10.0
"""Processor time of tests that do not run a line, but may use what is kept in their file, in s."""


@dataclass(frozen=True)
class Covering:
    """What each test runs."""

    ran: Mapping[Test, Ran]

    def of(self, module: str, line: int) -> list[Test]:
        """Quick tests before others, and of these first the tests that run a line, those that run fewest lines first.

        After those of a tier come others of their files for a limited time: they may use what is kept in a file of a
        line that ran before.
        """
        found = {test for test, ran in self.ran.items() if line in ran.lines.get(module, ())}
        files, left_s = {test.file for test in found}, OTHERS_S

        def place(test: Test) -> tuple[bool, bool, int]:
            return test.tier != "quick", test not in found, self._counts[test]

        tests = list[Test]()
        for test in sorted((test for test in self.ran if test.file in files), key=place):
            left_s -= 0.0 if test in found else self.ran[test].seconds
            if test in found or left_s > 0.0:
                tests.append(test)
        return tests

    @cached_property
    def _counts(self) -> dict[Test, int]:
        return {test: sum(map(len, ran.lines.values())) for test, ran in self.ran.items()}


def covering(collected: Collected, kept: Path, processes: int) -> Covering:
    """What each test runs of the source; what is known of a test file stays while it and what it runs do not change."""
    folder = kept / "covering"
    folder.mkdir(parents=True, exist_ok=True)
    modules = {str(path.relative_to(SOURCE)): hashed([path]) for path in SOURCE.rglob("*.py")}
    files: dict[str, list[Test]] = {}
    for test in collected.tests:
        files.setdefault(test.file, []).append(test)
    known = {
        file: _Known(folder / f"{file.replace('/', '-')}-{hashed([TESTS / file])}.json", modules) for file in files
    }
    missing = {file: [test for test in tests if test.unit not in known[file].ran] for file, tests in files.items()}
    works = deque(Work(file, partial(collected.ran, tests), LONGEST_S) for file, tests in missing.items() if tests)
    for file, ran in results(works, processes):
        for unit, one in (ran or {}).items():
            if one.pop("failed"):
                print(f"{unit} fails without a mutation: it is no judge here", file=sys.stderr)
                one |= {"seconds": 0.0, "lines": {}}
        known[file].write(ran or {test.unit: {"seconds": 0.0, "lines": {}} for test in missing[file]})
    return Covering({test: Ran(**known[file].ran[test.unit]) for file, tests in files.items() for test in tests})


class _Known:
    """What is known of the tests of a file, kept in a file beside the hashes of the modules that they run."""

    def __init__(self, path: Path, modules: Mapping[str, str]) -> None:
        self._path, self._modules = path, modules
        kept = json.loads(path.read_text()) if path.exists() else {"modules": {}, "ran": {}}
        same = all(modules.get(module) == written for module, written in kept["modules"].items())
        self.ran: dict[str, Any] = kept["ran"] if same else {}

    def write(self, more: Mapping[str, Any]) -> None:
        self.ran |= more
        run = {module for one in self.ran.values() for module in one["lines"]}
        written = {module: self._modules[module] for module in sorted(run)}
        self._path.write_text(json.dumps({"modules": written, "ran": self.ran}))


def hashed(paths: Sequence[Path]) -> str:
    """What stays the same while some files do not change."""
    return sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:8]
