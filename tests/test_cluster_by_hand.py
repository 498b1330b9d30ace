"""A Dask cluster that was begun by hand, whose scheduler, worker or client is ended at any moment of a sweep.

A sweep whose scheduler has gone says so and is gone itself; one whose client was ended leaves no process; the same
command then goes on to the same bytes.  One of whose workers has gone goes on with the other.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from pathlib import Path
from shutil import rmtree

import pytest

from commands import environment
from test_no_process_left import MOMENTS, PROMPT_S, SIGNALS, begun, ended, seconds_until_gone, wait_for
from test_sweep_processes import tables
from test_sweep_processes import wait_for as wait_for_file

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="reads the system's table of processes"),
]

SWEEP = [
    "sweep",
    "d.yaml",
    "--vary=motion.cosine.0=0.02:0.5",
    "--samples=24",
    "--stage=teeth",
    "--keep=16",
    "--out=out",
]

GONE = "begin it again, and give the same command"
NEVER_THERE = "no Dask scheduler answers"


@contextmanager
def process(folder: Path, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A command of Dask as the documentation gives it, in a group of its own; killed at the end with all it began."""
    command = [sys.executable, "-m", "dask", *arguments]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    run = subprocess.Popen(command, cwd=folder, env=environment(), start_new_session=True, **quiet)
    try:
        yield run
    finally:
        with suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
        run.wait()


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler, and its process with those of two workers."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    with ExitStack() as stack:
        here = ("--host=127.0.0.1", "--no-dashboard", "--port=0", f"--scheduler-file={file.name}")
        scheduler = stack.enter_context(process(folder, "scheduler", *here))
        wait_for(lambda: file.exists() and file.read_text())
        address = json.loads(file.read_text())["address"]
        yield address, [scheduler, *(stack.enter_context(worker(folder, address)) for _ in range(2))]


def worker(folder: Path, address: str) -> AbstractContextManager[subprocess.Popen[bytes]]:
    """A worker of one process."""
    return process(folder, "worker", address, "--host=127.0.0.1", "--no-dashboard", "--nworkers=1", "--nthreads=1")


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The tables that a single process writes."""
    folder = tmp_path_factory.mktemp("alone")
    with begun([*SWEEP, "--processes=1"], folder) as (run, _):
        assert run.wait() == 0
    return tables(folder / "out")


def goes_on(folder: Path, address: str) -> dict[str, bytes]:
    """The tables of the same command, given again."""
    with begun([*SWEEP, f"--scheduler={address}"], folder) as (run, _):
        _, err = run.communicate()
    assert run.returncode == 0, err
    return tables(folder / "out")


@pytest.mark.long
@pytest.mark.parametrize("who", ["scheduler", "worker", "client"])
def test_whoever_is_ended_at_any_moment(tmp_path: Path, alone: dict[str, bytes], who: str) -> None:
    """At half as many moments as ``MOMENTS``, by each signal in turn."""
    pytest.importorskip("distributed")
    with cluster(tmp_path) as (address, _):
        start = time.monotonic()
        goes_on(tmp_path, address)
        taken = time.monotonic() - start
    longest = dict.fromkeys(SIGNALS, 0.0)
    for moment in range(MOMENTS // 2):
        number = SIGNALS[moment % len(SIGNALS)]
        rmtree(tmp_path / "out", ignore_errors=True)
        with cluster(tmp_path) as (address, (scheduler, first, _)):
            with begun([*SWEEP, f"--scheduler={address}"], tmp_path) as (run, mark):
                time.sleep(taken * (moment + 0.5) / (MOMENTS // 2))
                if who == "client":
                    seconds, status, err = ended(run, mark, number)
                    assert status in (0, -number if number == signal.SIGKILL else 128 + number), err
                else:
                    os.killpg((scheduler if who == "scheduler" else first).pid, number)
                    _, err = run.communicate()
                    seconds, status = seconds_until_gone(mark), run.returncode
                    if who == "worker":
                        assert status == 0, err
                    else:
                        assert status in (0, 2), err
                        assert status == 0 or GONE in err or NEVER_THERE in err, err
            assert "Traceback" not in err
            assert seconds < PROMPT_S
            longest[number] = max(longest[number], seconds)
            if who == "client":
                assert goes_on(tmp_path, address) == alone
        if who == "scheduler":
            with cluster(tmp_path) as (address, _):
                assert goes_on(tmp_path, address) == alone
        assert tables(tmp_path / "out") == alone
    print(f"{who}: {taken:.1f} s; gone after", {one.name: round(seconds, 2) for one, seconds in longest.items()})


@pytest.mark.long
def test_a_sweep_without_workers_waits_for_one(tmp_path: Path, alone: dict[str, bytes]) -> None:
    pytest.importorskip("distributed")
    with (
        cluster(tmp_path) as (address, (_, *workers)),
        begun([*SWEEP, f"--scheduler={address}"], tmp_path) as (run, _),
    ):
        wait_for_file(tmp_path / "out" / "teeth.parquet" / "part-000000.parquet", run)
        for one in workers:
            os.killpg(one.pid, signal.SIGKILL)
        time.sleep(1.0)
        assert run.poll() is None
        with worker(tmp_path, address):
            _, err = run.communicate()
    assert run.returncode == 0, err
    assert tables(tmp_path / "out") == alone
