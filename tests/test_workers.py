"""Tasks on processes and on a Dask cluster: the same results, deaths made up for, few tasks at a time."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from math import inf
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear import workers
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.workers import core_count, finished, free_cores


def squared(number: int) -> int:
    return number * number


def dying_once(folder: str, number: int) -> int:
    """The square; the process that has the fifth task first dies of it."""
    mark = Path(folder) / "died"
    if number == 5 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def dying(number: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return number


def refusing(number: int) -> int:
    if number == 3:
        raise NoSuchMechanism("no such thing", key="motion.v1_mm_s")
    return number


SQUARES = {number: number * number for number in range(40)}


def test_one_process_is_this_one() -> None:
    assert list(finished(os.path.abspath, ["a"], processes=1)) == [("a", str(Path("a").absolute()))]


@pytest.mark.thorough
def test_a_core_on_which_another_process_runs_is_not_free(monkeypatch: pytest.MonkeyPatch) -> None:
    """As Linux tells: two others beside this one; and without it, by the mean over a minute; nothing less than all."""
    monkeypatch.setattr(workers, "core_count", lambda: 8)
    told = type("Told", (), {"__init__": lambda self, path: None, "read_text": lambda self: "5.3 4.2 2.0 3/205 77\n"})
    monkeypatch.setattr(workers, "Path", told)
    assert workers.free_cores() == 6
    monkeypatch.undo()
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(core_count())]
    try:
        time.sleep(0.2)
        assert free_cores() <= 0
        monkeypatch.setattr(workers, "Path", lambda path: Path("no such file"))
        monkeypatch.setattr(os, "getloadavg", lambda: (3.4, 0.0, 0.0))
        assert free_cores() == core_count() - 3
    finally:
        for one in busy:
            one.kill()
            one.wait()


@pytest.mark.slow
def test_two_processes_give_every_result_once() -> None:
    found = list(finished(squared, range(40), processes=2))
    assert len(found) == 40
    assert dict(found) == SQUARES


@pytest.mark.slow
def test_a_process_that_dies_is_made_up_for(tmp_path: Path) -> None:
    found = list(finished(partial(dying_once, str(tmp_path)), range(40), processes=2))
    assert len(found) == 40
    assert dict(found) == SQUARES
    assert (tmp_path / "died").exists()


@pytest.mark.slow
def test_processes_that_die_while_nothing_is_asked_are_made_up_for() -> None:
    found = finished(squared, range(40), processes=2)
    results = [next(found)]
    for process in active_children():
        process.kill()
        process.join()
    results.extend(found)
    assert len(results) == 40
    assert dict(results) == SQUARES


@pytest.mark.slow
def test_tasks_that_kill_every_process_end_the_run() -> None:
    with pytest.raises(RuntimeError, match="3 processes in a row died"):
        list(finished(dying, range(4), processes=2))


@pytest.mark.slow
def test_what_a_task_raises_is_raised_with_its_key() -> None:
    with pytest.raises(NoSuchMechanism, match="no such thing") as refusal:
        list(finished(refusing, range(40), processes=2))
    assert refusal.value.key == "motion.v1_mm_s"


@pytest.mark.thorough
def test_tasks_are_taken_as_they_are_needed() -> None:
    taken = []

    def endless() -> Iterator[int]:
        while True:
            taken.append(len(taken))
            yield taken[-1]

    found = finished(squared, endless(), processes=2)
    for count in range(1, 30):
        next(found)
        assert len(taken) <= count + 2 * workers.AHEAD
    found.close()


@pytest.mark.slow
def test_a_cluster_of_this_computer_gives_the_same(tmp_path: Path) -> None:
    """With a worker killed in the run."""
    pytest.importorskip("distributed")
    assert dict(finished(partial(dying_once, str(tmp_path)), range(40), scheduler="local", processes=2)) == SQUARES
    assert (tmp_path / "died").exists()


@at_once(
    ("seconds", "left", "threads", "size"),
    [
        (0.3, 1e6, 1000, 16),  # five seconds
        (0.3, inf, 1000, 16),
        (0.3, 1e6, 100, 3),  # a second: a hundredth for each thread
        (0.3, 1e6, 2, 1),
        (0.001, 1e6, 2, 20),
        (0.3, 3000, 1000, 1),  # all of them stay at work to the end
        (0.3, 12000, 1000, 6),
        (60.0, 1e6, 1000, 1),
        (0.0, 40, 2, 10),
    ],
)
def test_bundles_grow_with_the_number_of_processes_and_shrink_to_the_end(
    seconds: float, left: float, threads: int, size: int
) -> None:
    assert workers.bundle_size(seconds, left, threads) == size


@pytest.mark.slow
def test_a_cluster_gets_bundles_and_gives_every_result(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a generator too, whose number of tasks is told: bundles of several tasks, single ones at the end."""
    pytest.importorskip("distributed")
    monkeypatch.setattr(workers, "AT_FIRST_ON_CLUSTER", 1)
    sizes, really = [], workers.bundle_size
    monkeypatch.setattr(workers, "bundle_size", lambda *given: sizes.append(really(*given)) or sizes[-1])
    found = list(finished(squared, (number for number in range(400)), "local", 2, count=400))
    assert len(found) == 400
    assert dict(found) == {number: number * number for number in range(400)}
    assert max(sizes) > 50
    assert sizes[-1] == 1


def faults_of_arrays(count: int) -> int:
    """Pages that so many arrays of 300 kB, one after the other, had to be given by the system."""
    import resource

    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(count):
        np.ones(40_000)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="of the GNU C library")
def test_processes_use_the_memory_of_arrays_again() -> None:
    """On a cluster too, whose variables would have each array's 73 pages given anew, as the negative control shows."""
    pytest.importorskip("distributed")
    before = dict(os.environ)
    for scheduler in (None, "local"):
        ((_, faults), *_) = finished(faults_of_arrays, [1000, 1000], scheduler, 2)
        assert faults < 1000
    assert dict(os.environ) == before
    code = "import test_workers; print(test_workers.faults_of_arrays(1000))"
    environment = {**before, "MALLOC_TRIM_THRESHOLD_": "65536", "PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, env=environment)
    assert int(run.stdout) > 70 * 1000


@pytest.mark.slow
def test_an_address_without_a_scheduler_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    with pytest.raises(WrongInput, match="no Dask scheduler answers"):
        list(finished(squared, range(4), scheduler="tcp://127.0.0.1:9"))


CLUSTER = """
from distributed import LocalCluster

if __name__ == "__main__":
    here = {"processes": False, "protocol": "tcp", "dashboard_address": None}
    with LocalCluster(n_workers=1, threads_per_worker=1, **here) as cluster:
        print(cluster.scheduler_address, flush=True)
        input()
"""


@pytest.mark.slow
def test_a_scheduler_that_dies_is_wrong_input() -> None:
    """While a task runs there, and before another is asked for."""
    pytest.importorskip("distributed")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    line, pipe = [sys.executable, "-c", CLUSTER], subprocess.PIPE
    with subprocess.Popen(line, stdin=pipe, stdout=pipe, text=True, env=environment) as cluster:
        assert cluster.stdout is not None
        found = finished(time.sleep, [0.0, 600.0, 600.0], cluster.stdout.readline().strip())
        assert next(found) == (0.0, None)
        cluster.kill()
        with pytest.raises(WrongInput, match=r"^--scheduler: the Dask scheduler at 'tcp://.*' has gone; begin"):
            list(found)


@pytest.mark.slow
def test_a_scheduler_that_dies_before_any_task_is_wrong_input(monkeypatch: pytest.MonkeyPatch) -> None:
    """While workers are asked for their version."""
    distributed = pytest.importorskip("distributed")
    really = distributed.Client.run

    def dies(client: Any, *given: Any, **named: Any) -> Any:
        cluster.kill()
        cluster.wait()
        return really(client, *given, **named)

    monkeypatch.setattr(distributed.Client, "run", dies)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    line, pipe = [sys.executable, "-c", CLUSTER], subprocess.PIPE
    with subprocess.Popen(line, stdin=pipe, stdout=pipe, text=True, env=environment) as cluster:
        assert cluster.stdout is not None
        with pytest.raises(WrongInput, match=r"^--scheduler: the Dask scheduler at 'tcp://.*' has gone; begin"):
            list(finished(squared, [1], cluster.stdout.readline().strip()))


def test_workers_with_another_version_or_none_are_refused() -> None:
    """One that has ended as it was asked is not."""
    same, gone = {"tcp://a": workers.__version__}, {"tcp://c": ConnectionError("closed")}
    workers._require_same_version(same | gone)
    with pytest.raises(WrongInput, match=r"1 of 2 workers have another ncgear than .* tcp://b has 0.0.1;"):
        workers._require_same_version({**same, "tcp://b": "0.0.1", **gone})
    with pytest.raises(WrongInput, match=r"tcp://b has none \(No module named 'ncgear'\)"):
        workers._require_same_version({**same, "tcp://b": ModuleNotFoundError("No module named 'ncgear'")})
