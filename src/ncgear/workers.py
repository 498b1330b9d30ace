"""Independent tasks on the processes of this computer, or on a Dask cluster, with the same results.

A task is a value that can be pickled, and the function that computes it is defined in a module.  Results come as they
are finished, each with its task.  A process that dies is replaced, and its tasks are done again.
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
"""Name of the scheduler that means a Dask cluster on this computer."""

AHEAD = 4
"""Tasks handed out for each process: one in work, the others so that it never waits, few so that memory stays small."""

AT_FIRST_ON_CLUSTER = 256
"""Least number of tasks handed out singly to a cluster before the first is finished: its processes may still be
starting."""

AHEAD_ON_CLUSTER = 2
"""Bundles of tasks handed out for each process of a cluster: one in work, and one waiting."""

HANDING_S, LONGEST_BUNDLE_S = 0.01, 5.0
"""Seconds of work in a bundle for each process of a cluster, and their upper limit.

Client and scheduler each spend about a millisecond on a bundle of any length (benchmarks/sweeping.md).  So all
processes have a new bundle before the first has finished its own; five seconds are enough for three thousand."""

LOOK_S = 1.0
"""Seconds after which the processes of a cluster are counted again."""

DEATHS = 3
"""Deaths of processes without any result in between after which a run stops: the tasks themselves kill them."""

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Each process has one core, so several threads of linear algebra in it would only hinder each other."""


def core_count() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def free_cores() -> int:
    """The number of cores that this process may use and that are free at this moment, including its own core.

    Linux tells how many processes run now.  On other systems it is their mean number over the last minute.
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
    given; with 1, this process computes them itself.  ``scheduler`` is the address of a Dask scheduler, for example
    ``tcp://host:8786``, or ``local`` for a Dask cluster of ``processes`` processes on this computer.  Tasks are taken
    from ``tasks`` a few at a time, so ``tasks`` may be endless.  A cluster gets bundles of tasks, which become small
    towards the end so that all its processes have work; ``count`` is the number of tasks, if ``tasks`` has no length.

    Raises the errors of the function, WrongInput where the scheduler cannot be used or ends during the work, and
    RuntimeError where processes die again and again without a result.
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
    """Tasks on a worker of another program: the seconds that they took, and their results."""
    keep_freed_memory()
    start = perf_counter()
    results = [function(task) for task in tasks]
    return perf_counter() - start, results


def _through(
    new_executor: Callable[[], Executor], ahead: int, function: Callable[[Task], Result], tasks: Iterator[Task]
) -> Iterator[tuple[Task, Result]]:
    """Results of tasks, of which at most ``ahead`` are handed out; a broken executor is replaced by a new one."""
    executor, deaths = new_executor(), 0
    running: dict[Future[Result], Task] = {}
    while True:
        for task in islice(tasks, ahead - len(running)):
            running[_handed_out(executor, function, task)] = task
        if not running:
            return
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        # Tasks that broke with their executor stay, and are handed out again below.
        for future in [future for future in done if not isinstance(future.exception(), BrokenProcessPool)]:
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
    client: Any, function: Callable[[list[Task]], tuple[float, list[Result]]], tasks: Iterator[Task], left: float
) -> Iterator[tuple[Task, Result]]:
    """Results of tasks on a cluster, which replaces its own processes; ``left`` is the number of tasks to hand out."""
    from distributed import as_completed

    running: dict[Any, list[Task]] = {}
    threads, looked_s, seconds, finished_tasks = _threads(client), monotonic(), 0.0, 0
    # With results: Dask's own executor fails where a process dies between the end of a task and the reading of its
    # result.
    done = as_completed(with_results=True)

    def hand_out() -> int:
        """Hand out a bundle if another is needed, and return its number of tasks."""
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
    """Number of tasks, each of so many seconds, in a bundle for one of a cluster's threads.

    A bundle is enough work for the time in which all threads get their bundles, but not more than a share of the
    ``left`` tasks, so that all threads end together.
    """
    long_enough = min(HANDING_S * threads, LONGEST_BUNDLE_S) / max(seconds, 1e-6)
    return max(1, int(min(long_enough, left / (AHEAD_ON_CLUSTER * threads))))


def _threads(client: Any) -> int:
    """The number of tasks that a cluster can compute at a time; 1 before its first process has started."""
    threads: int = sum(client.nthreads().values())
    return max(1, threads)


def _handed_out(executor: Executor, function: Callable[[Task], Result], task: Task) -> Future[Result]:
    """The future result of a task; it is broken at once if the executor is broken."""
    try:
        return executor.submit(function, task)
    except BrokenProcessPool as death:
        broken: Future[Result] = Future()
        broken.set_exception(death)
        return broken


@contextmanager
def _pools(count: int) -> Iterator[Callable[[], Executor]]:
    """A context with a function that starts a pool of processes; at its end all processes are gone."""
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
    """Processes that end with this process, and ignore Ctrl-C, which this process handles.

    They start when the first tasks are handed out.
    """

    def __init__(self, count: int) -> None:
        with deaf_processes():
            super().__init__(count, get_context("spawn"), _begin)

    def submit(self, function: Callable[Given, Result], /, *given: Given.args, **named: Given.kwargs) -> Future[Result]:
        """As in every executor; a process that starts always gets the data that it waits for."""
        with uninterrupted(), deaf_processes():
            return super().submit(function, *given, **named)


def _begin() -> None:
    """Prepare a process that this module has started."""
    parent = parent_process()
    assert parent is not None
    end_with_parent(parent.join)
    if not parent.is_alive():
        # Linux was asked too late, and a task may give threads no turn.
        os._exit(0)
    begin_worker()


def dask_setup(_: Any) -> None:
    """Dask calls this in each worker of a cluster on this computer when the worker starts."""
    _begin()


@contextmanager
def one_thread_each() -> Iterator[None]:
    """A context in which new processes use one thread each; variables set by the user stay."""
    with _same_environment():
        os.environ.update({name: value for name, value in ONE_THREAD.items() if name not in os.environ})
        yield


@contextmanager
def _same_environment() -> Iterator[None]:
    """A context that restores the environment's variables at its end."""
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
            # A worker may end meanwhile
            _require_same_version(client.run(_version, on_error="return"))
            yield client
        except Exception as error:
            # Only the end of the scheduler cancels tasks; the client may not know of it yet.
            if client.status == "running" and not isinstance(error, CancelledError | CommClosedError):
                raise
            problem = (
                f"the Dask scheduler at {scheduler!r} has gone; begin it again, and give the same command: sweep and "
                "frontier go on from their finished parts"
            )
            raise WrongInput(problem, location=OPTION) from error


@contextmanager
def _without_logs() -> Iterator[None]:
    """A context without the logs of libraries: when a cluster ends, they write pages of traces."""
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
        # Dask sets variables for its workers; they would stay.
        with _same_environment():
            # Its threads start the workers, and ignore the signals that are ignored here.
            with uninterrupted(), deaf_processes():
                made = LocalCluster(
                    n_workers=0,
                    threads_per_worker=1,
                    # Any free port: two clusters on one computer do not conflict.
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.ERROR,
                    preload=[__name__],
                )
                client = Client(made)
            try:
                made.scale(processes)
                yield client
            finally:
                # Ctrl-C is repeated, and workers that end by themselves take seconds.
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

    ``versions`` has the error in place of the version where a worker did not tell it; a worker that has ended is left
    out.
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
