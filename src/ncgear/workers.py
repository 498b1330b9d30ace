"""Independent tasks on the processes of this computer, or on a Dask cluster, with the same results.

A task is a value that can be pickled, and the function that computes it is a module's own.  Results come as they are
finished, with the task that they belong to.  A process that dies on the way is replaced, and its tasks are done again.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from itertools import islice
from math import inf
from multiprocessing import get_context, parent_process
from operator import length_hint
from pathlib import Path
from time import monotonic, perf_counter
from typing import Any, ParamSpec, TypeVar

from ncgear import __version__
from ncgear.errors import WrongInput
from ncgear.interrupts import deaf_processes, end_processes, end_with_parent, uninterrupted
from ncgear.memory import begin_worker, keep_freed_memory

Task = TypeVar("Task")
Result = TypeVar("Result")
Given = ParamSpec("Given")

OPTION = "--scheduler"

LOCAL = "local"
"""The scheduler that stands for a Dask cluster of this computer's own."""

AHEAD = 4
"""Tasks handed out for each process: one at work, the others so that it never waits, few so that memory stays small."""

AT_FIRST_ON_CLUSTER = 256
"""Fewest tasks handed out to a cluster as long as none is finished, one by one: its processes may be still to come."""

AHEAD_ON_CLUSTER = 2
"""Bundles of tasks handed out for each process of a cluster: one at work, and one that waits."""

HANDING_S, LONGEST_BUNDLE_S = 0.01, 5.0
"""Seconds of work of a bundle for each process of a cluster, and at most.

Client and scheduler each spend some two milliseconds on a bundle, however long it is (benchmarks/sweeping.md): all
processes have a new one before the first has done its own, and five seconds are enough for two thousand of them."""

LOOK_S = 1.0
"""Seconds after which the processes of a cluster are counted anew."""

DEATHS = 3
"""Deaths of processes without a single result between them after which a run gives up: the tasks themselves kill."""

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Each process has one core, so several threads of linear algebra in it would only hinder each other."""


def core_count() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def free_cores() -> int:
    """The number of cores that this process may use and on which nothing else runs at this moment, its own included.

    Linux tells how many processes run now.  Elsewhere their mean number over the last minute must do.
    """
    try:
        others = int(Path("/proc/loadavg").read_text().split()[3].partition("/")[0]) - 1
    except OSError:
        others = round(os.getloadavg()[0]) if hasattr(os, "getloadavg") else 0
    return core_count() - others


def finished(
    function: Callable[[Task], Result],
    tasks: Iterable[Task],
    scheduler: str | None = None,
    processes: int | None = None,
    count: int | None = None,
) -> Iterator[tuple[Task, Result]]:
    """Every task with its result, in the order in which they are finished.

    Without ``scheduler`` the tasks run on ``processes`` processes of this computer, one for each core where None is
    given; a single one is this process itself.  ``scheduler`` is the address of a Dask scheduler, as
    ``tcp://host:8786``, or ``local`` for a Dask cluster of ``processes`` processes on this computer.  Tasks are taken
    from ``tasks`` a few at a time, so that it may be endless.  A cluster gets bundles of tasks, which towards the end
    are so small that all its processes stay at work; ``count`` is how many tasks there are, where ``tasks`` does not
    tell.

    Raises what the function raises, WrongInput where the scheduler cannot be used or ends on the way, and RuntimeError
    where processes die again and again without a result.
    """
    if scheduler is not None:
        left = length_hint(tasks, -1) if count is None else count
        with _cluster(scheduler, processes or core_count()) as client:
            yield from _through_cluster(client, partial(_on_cluster, function), iter(tasks), left if left >= 0 else inf)
    elif (cores := processes or core_count()) == 1:
        yield from ((task, function(task)) for task in tasks)
    else:
        with _pools(cores) as new_pool:
            yield from _through(new_pool, AHEAD * cores, function, iter(tasks))


def _on_cluster(function: Callable[[Task], Result], tasks: list[Task]) -> tuple[float, list[Result]]:
    """Tasks on a worker that others have begun: the seconds that they took, and their results."""
    keep_freed_memory()
    start = perf_counter()
    results = [function(task) for task in tasks]
    return perf_counter() - start, results


def _through(
    new_executor: Callable[[], Executor], ahead: int, function: Callable[[Task], Result], tasks: Iterator[Task]
) -> Iterator[tuple[Task, Result]]:
    """Results of tasks, at most ``ahead`` of which are handed out; a broken executor is replaced by a new one."""
    executor, deaths = new_executor(), 0
    running: dict[Future[Result], Task] = {}
    while True:
        for task in islice(tasks, ahead - len(running)):
            running[_handed_out(executor, function, task)] = task
        if not running:
            return
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        # Those that broke with their executor stay, and are handed out again below.
        for future in [one for one in done if not isinstance(one.exception(), BrokenProcessPool)]:
            yield running.pop(future), future.result()
            done.remove(future)
            deaths = 0
        if done:
            deaths += 1
            if deaths == DEATHS:
                raise RuntimeError(f"{DEATHS} processes in a row died without a result; is there enough memory?")
            executor, again = new_executor(), list(running.values())
            running = {_handed_out(executor, function, task): task for task in again}


def _through_cluster(
    client: Any,
    function: Callable[[list[Task]], tuple[float, list[Result]]],
    tasks: Iterator[Task],
    left: float,
) -> Iterator[tuple[Task, Result]]:
    """Results of tasks on a cluster, which replaces its own processes; ``left`` tasks are to be handed out."""
    from distributed import as_completed

    running: dict[Any, list[Task]] = {}
    threads, looked_s, seconds, finished_tasks = _threads(client), monotonic(), 0.0, 0
    # With results: Dask's own executor fails where a process dies between the end of its task and the reading of it.
    done = as_completed(with_results=True)

    def hand_out() -> int:
        """Hand out a bundle where one is wanted, and return how many tasks it holds."""
        ahead = AHEAD_ON_CLUSTER * threads if finished_tasks else max(AHEAD_ON_CLUSTER * threads, AT_FIRST_ON_CLUSTER)
        if len(running) >= ahead:
            return 0
        size = bundle_size(seconds / finished_tasks, left, threads) if finished_tasks else 1
        if bundle := list(islice(tasks, size)):
            future = client.submit(function, bundle, pure=False)
            running[future] = bundle
            done.add(future)
        return len(bundle)

    while handed := hand_out():
        left -= handed
    for future, result in done:
        if isinstance(result, CancelledError):
            raise result
        bundle, (took_s, results) = running.pop(future), result
        seconds, finished_tasks = seconds + took_s, finished_tasks + len(bundle)
        if monotonic() - looked_s > LOOK_S:
            threads, looked_s = _threads(client), monotonic()
        while handed := hand_out():
            left -= handed
        yield from zip(bundle, results, strict=True)


def bundle_size(seconds: float, left: float, threads: int) -> int:
    """How many tasks of so many seconds each one of a cluster's threads gets at a time.

    They are enough work for the time in which all threads get their bundles, but not more than a share of what is
    ``left``, so that all threads end together.
    """
    long_enough = min(HANDING_S * threads, LONGEST_BUNDLE_S) / max(seconds, 1e-6)
    return max(1, int(min(long_enough, left / (AHEAD_ON_CLUSTER * threads))))


def _threads(client: Any) -> int:
    """The number of tasks that a cluster can compute at a time; 1 before its first process has come."""
    threads: int = sum(client.nthreads().values())
    return max(1, threads)


def _handed_out(executor: Executor, function: Callable[[Task], Result], task: Task) -> Future[Result]:
    """The result to come of a task; it is broken at once where the executor is."""
    try:
        return executor.submit(function, task)
    except BrokenProcessPool as death:
        broken: Future[Result] = Future()
        broken.set_exception(death)
        return broken


@contextmanager
def _pools(count: int) -> Iterator[Callable[[], Executor]]:
    """A context with a function that begins a pool of processes; at its end all processes are gone."""
    pools: list[Pool] = []

    def new_pool() -> Executor:
        pools.append(Pool(count))
        return pools[-1]

    with one_thread_each():
        try:
            yield new_pool
        except BaseException:
            end_processes()
            for pool in pools:
                pool.shutdown(wait=False, cancel_futures=True)
            raise
        for pool in pools:
            pool.shutdown()


class Pool(ProcessPoolExecutor):
    """Processes that end with this one, and ignore Ctrl-C, which this one hears.

    They begin when the first tasks are handed out.
    """

    def __init__(self, count: int) -> None:
        with deaf_processes():
            super().__init__(count, get_context("spawn"), _begin)

    def submit(self, function: Callable[Given, Result], /, *given: Given.args, **named: Given.kwargs) -> Future[Result]:
        """As every executor; a process that begins is never left without what it waits for."""
        with uninterrupted(), deaf_processes():
            return super().submit(function, *given, **named)


def _begin() -> None:
    """Prepare a process that has been begun by this module."""
    parent = parent_process()
    assert parent is not None
    end_with_parent(parent.join)
    if not parent.is_alive():
        # Linux was asked too late, and a task may give threads no turn.
        os._exit(0)
    begin_worker()


def dask_setup(_: Any) -> None:
    """What Dask calls in each worker of a cluster of this computer as it begins."""
    _begin()


@contextmanager
def one_thread_each() -> Iterator[None]:
    """A context in which new processes use one thread each; variables that the user has set stay."""
    with _same_environment():
        os.environ.update({name: value for name, value in ONE_THREAD.items() if name not in os.environ})
        yield


@contextmanager
def _same_environment() -> Iterator[None]:
    """A context at whose end the environment's variables are as before."""
    before = dict(os.environ)
    try:
        yield
    finally:
        for name in os.environ.keys() - before.keys():
            del os.environ[name]
        os.environ.update(before)


@contextmanager
def _cluster(scheduler: str, processes: int) -> Iterator[Any]:
    """A context with the client of a Dask cluster.

    Raises WrongInput where its scheduler ends before it does.
    """
    from distributed.comm.core import CommClosedError

    with _without_logs(), _client(scheduler, processes) as client:
        try:
            # A worker may end on the way
            _require_same_version(client.run(_version, on_error="return"))
            yield client
        except Exception as error:
            # Tasks are cancelled by the end of the scheduler alone, which the client may not know yet.
            if client.status == "running" and not isinstance(error, CancelledError | CommClosedError):
                raise
            problem = (
                f"the Dask scheduler at {scheduler!r} has gone; begin it again, and give the same command: sweep and "
                "frontier go on from their finished parts"
            )
            raise WrongInput(problem, location=OPTION) from error


@contextmanager
def _without_logs() -> Iterator[None]:
    """A context without the logs of libraries: whatever ends a cluster, they write pages of traces."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(before)


@contextmanager
def _client(scheduler: str, processes: int) -> Iterator[Any]:
    """A context with the client of a Dask scheduler, or of a cluster of this computer that ends with it."""
    from distributed import Client, LocalCluster

    if scheduler == LOCAL:
        # Dask sets variables for its workers, which stay.
        with _same_environment():
            # Its threads begin the workers, and ignore what is ignored here.
            with uninterrupted(), deaf_processes():
                made = LocalCluster(
                    n_workers=0,
                    threads_per_worker=1,
                    # Any port that is free: two clusters of one computer do not get into each other's way.
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.ERROR,
                    preload=[__name__],
                )
                client = Client(made)
            try:
                made.scale(processes)
                yield client
            finally:
                # Ctrl-C comes again, and those that end by themselves take seconds.
                with uninterrupted():
                    for nanny in made.workers.values():
                        nanny.auto_restart = False
                    end_processes()
                    client.close()
                    made.close()
        return
    try:
        client = Client(scheduler, timeout="10s")
    except (OSError, ValueError, TypeError) as error:
        problem = f"no Dask scheduler answers at {scheduler!r} ({error}); an address as tcp://host:8786 is right"
        raise WrongInput(problem, location=OPTION) from error
    with client:
        yield client


def _version() -> str:
    return __version__


def _require_same_version(versions: Mapping[str, str | BaseException]) -> None:
    """Raise WrongInput where a worker of a cluster has another version of ncgear than this process, or none.

    ``versions`` has the error in place of the version where a worker did not tell it; one that has ended is left out.
    """
    told = {worker: version for worker, version in versions.items() if not isinstance(version, OSError)}
    other = {worker: version for worker, version in told.items() if version != __version__}
    if other:
        worker, version = next(iter(other.items()))
        raise WrongInput(
            f"{len(other)} of {len(told)} workers have another ncgear than {__version__}, as {worker} has "
            f"{version if isinstance(version, str) else f'none ({version})'}; install the same version there",
            location=OPTION,
        )
