"""Sweeps on several processes and on a Dask cluster: the same files to the byte, whoever dies on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from commands import environment

TEXT = """
name: small
linkage: {crank_mm: 40, rod_mm: 90}
operation: {speed_rpm: 30}
motion: {law: harmonic_ratio, cosine: [0.1]}
gears: {teeth: 14, module_mm: 2, face_width_mm: 10}
"""

DESIGNS, FOLLOWED = 40, 24


def command(folder: Path, *options: str) -> list[str]:
    (folder.parent / "d.yaml").write_text(TEXT, encoding="utf-8")
    asked = ["--vary", "motion.cosine.0=0.02:0.5", f"--samples={DESIGNS}", "--stage=teeth", f"--keep={FOLLOWED}"]
    run = [sys.executable, "-m", "ncgear", "sweep", str(folder.parent / "d.yaml"), *asked, "--out", str(folder)]
    return [*run, *options]


def swept(folder: Path, *options: str) -> str:
    return subprocess.run(
        command(folder, *options), check=True, capture_output=True, text=True, env=environment(), timeout=300
    ).stdout


def tables(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.glob("*.parquet/*"))}


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The tables that a single process writes."""
    folder = tmp_path_factory.mktemp("alone") / "out"
    assert f"{DESIGNS} designs, of which" in swept(folder, "--processes=1")
    found = tables(folder)
    # A run file and a part of all designs; a run file and parts of four of those that were followed.
    assert len(found) == 2 + 1 + FOLLOWED // 4
    return found


@pytest.mark.tiers(slow=["two"], rest="long")
@pytest.mark.parametrize("options", [["--processes=2"], ["--scheduler=local", "--processes=2"]], ids=["two", "cluster"])
def test_files_are_the_same_to_the_byte_although_a_process_dies(
    tmp_path: Path, alone: dict[str, bytes], options: list[str]
) -> None:
    pytest.importorskip("distributed")
    psutil = pytest.importorskip("psutil")
    run = subprocess.Popen(command(tmp_path / "out", *options), env=environment(), stdout=subprocess.DEVNULL)
    wait_for(tmp_path / "out" / "teeth.parquet" / "part-000001.parquet", run)
    workers = [
        child
        for child in psutil.Process(run.pid).children(recursive=True)
        if "spawn_main" in " ".join(child.cmdline()) and not child.children()
    ]
    assert workers
    os.kill(workers[-1].pid, signal.SIGKILL)
    assert run.wait(timeout=240) == 0
    assert tables(tmp_path / "out") == alone


@pytest.mark.slow
def test_a_killed_sweep_goes_on_where_it_was(tmp_path: Path, alone: dict[str, bytes]) -> None:
    run = subprocess.Popen(command(tmp_path / "out", "--processes=1"), env=environment(), stdout=subprocess.DEVNULL)
    wait_for(tmp_path / "out" / "teeth.parquet" / "part-000001.parquet", run)
    os.kill(run.pid, signal.SIGKILL)
    assert run.wait() == -signal.SIGKILL
    before = {path: path.stat().st_mtime_ns for path in tmp_path.glob("out/*.parquet/part*")}
    assert 3 <= len(before) < 1 + FOLLOWED // 4
    swept(tmp_path / "out", "--processes=1")
    assert tables(tmp_path / "out") == alone
    assert {path: path.stat().st_mtime_ns for path in before} == before


def wait_for(path: Path, run: subprocess.Popen[Any]) -> None:
    for _ in range(2400):
        if path.exists():
            return
        assert run.poll() is None, "it ended before there was a part"
        time.sleep(0.05)
    raise AssertionError(f"no {path} in two minutes")
