"""Which test files run which lines: every file by itself, so that what one has kept for all others is run by each."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from coverage import CoverageData

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent

TIERS = {"quick": "not thorough and not slow", "readme": "not slow", "slow": "not long"}
"""Tests by the name of their tier, as pytest's marks say it."""

NO_TESTS = 5
"""Status of pytest where a file has no test of a tier."""


@dataclass(frozen=True)
class Covering:
    """The lines that a test file runs by module, and how long it takes."""

    seconds: Mapping[str, float] = field(default_factory=dict)
    lines: Mapping[str, Mapping[str, set[int]]] = field(default_factory=dict)

    def of(self, module: str, line: int) -> list[str]:
        """The test files that run a line, those that run fewest lines of all first: they are about it."""
        found = [name for name, run in self.lines.items() if line in run.get(module, ())]
        return sorted(found, key=lambda name: sum(map(len, self.lines[name].values())))


def covering(tier: str, folder: Path, source: Path, processes: int) -> Covering:
    """What the test files of a tier run of a source; each is kept in a folder until it is removed."""
    names = sorted(path.name for path in TESTS.glob("test_*.py"))
    names += sorted(str(path.relative_to(TESTS)) for path in TESTS.glob("*/test_*.py"))
    folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(processes) as pool:
        found = list(pool.map(lambda name: _run(name, tier, folder, source), names))
    kept = {name: one for name, one in zip(names, found, strict=True) if one is not None}
    lines = {name: {module: set(rows) for module, rows in one["lines"].items()} for name, one in kept.items()}
    return Covering({name: one["seconds"] for name, one in kept.items()}, lines)


def _run(name: str, tier: str, folder: Path, source: Path) -> dict[str, object] | None:
    stem = name.replace("/", "-").removesuffix(".py")
    kept, data = folder / f"{stem}.json", folder / f"{stem}.coverage"
    if not kept.exists():
        command = [sys.executable, "-m", "coverage", "run", f"--data-file={data}", f"--source={source / 'ncgear'}"]
        begun = time.monotonic()
        status = subprocess.run([*command, "-m", *pytest_of(tier), name], **quiet(source)).returncode
        took = time.monotonic() - begun
        read = CoverageData(str(data))
        if status not in (0, NO_TESTS):
            raise SystemExit(f"{name} fails as it is: status {status}")
        read.read()
        lines = {str(Path(file).relative_to(source)): sorted(read.lines(file) or ()) for file in read.measured_files()}
        kept.write_text(json.dumps(None if status == NO_TESTS else {"seconds": took, "lines": lines}))
        data.unlink(missing_ok=True)
    found: dict[str, object] | None = json.loads(kept.read_text())
    return found


def pytest_of(tier: str) -> list[str]:
    """pytest on tests of a tier, in one process, up to the first failure."""
    return ["pytest", "-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", "-o", "addopts=", "-m", TIERS[tier]]


def quiet(source: Path) -> dict[str, object]:
    """How pytest runs on a source: among the tests, with one thread, and nothing of what it says."""
    environment = {**os.environ, "PYTHONPATH": str(source), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return {"cwd": TESTS, "env": environment, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
