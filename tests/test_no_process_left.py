"""Whatever ends a command, at any moment: no process that it has begun is left in the system's table.

Processes are known by a variable that a command and all that it begins inherit, so none can hide behind another parent.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from uuid import uuid4

import pytest

from commands import ROOT, environment
from ncgear.workers import core_count
from studios import Page, running

if os.name != "posix" or not Path("/proc/self/environ").exists():
    pytest.skip("reads the system's table of processes, as Linux has it", allow_module_level=True)

MARK = "NCGEAR_TEST_RUN"
PATIENCE_S = 60.0
"""Time after which a process counts as left."""

PROMPT_S = 2.0
"""Time within which a command that is ended is gone, however busy the computer is: that in which none of its processes
waits for a processor."""

TEXT = """
name: small
linkage: {crank_mm: 40, rod_mm: 90}
operation: {speed_rpm: 30}
motion: {law: harmonic_ratio, cosine: [0.1]}
gears: {teeth: 14, module_mm: 2, face_width_mm: 10}
"""

TWO = "--processes=2"
SWEEP = ["sweep", "d.yaml", "--vary=motion.cosine.0=0.02:0.5", "--samples=600", "--stage=teeth", "--keep=60"]
BUILD = ["build", "designs/ellipse.yaml", "--report"]
COMMANDS: dict[str, list[str]] = {
    "build": BUILD,
    "report": ["report", "designs/ellipse.yaml"],
    "animate": ["animate", "designs/ellipse.yaml", "--frames=12", "--width=320", "--out=loop.mp4"],
    "sweep": [*SWEEP, TWO],
    "sweep-cluster": [*SWEEP, TWO, "--scheduler=local"],
    "tolerance": ["tolerance", "designs/ellipse.yaml", "--samples=4096", TWO],
    "design": ["design", "designs/pusher.yaml", TWO],
    "optimize": ["optimize", "designs/pusher.yaml", "--starts=3", TWO],
    "frontier": ["frontier", "designs/baler-frontier.yaml", "--points=2", TWO],
}
"""Every command that begins processes of its own, but for the studio."""

NEEDED = {
    "animate": "imageio_ffmpeg",
    "sweep-cluster": "distributed",
    "design": "casadi",
    "optimize": "casadi",
    "frontier": "casadi",
}

BEGUN = """
from ncgear import workers
workers.free_cores = lambda: 2
from ncgear.cli import main
print("begun", flush=True)
main()
"""
"""A run that says when it begins, and which thinks that a second core is free."""

SIGNALS = signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT
AS_A_TERMINAL = signal.SIGHUP, signal.SIGINT
"""A terminal sends these to all processes of a command at once."""


def processes_of(mark: str) -> dict[int, str]:
    """The processes that run with a mark, and their command lines."""
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if mark.encode() in (place / "environ").read_bytes():
                found[int(place.name)] = (place / "cmdline").read_bytes().replace(b"\0", b" ").decode()[:120]
        except OSError:
            # It has just ended, or is another user's.
            continue
    return found


def seconds_until_gone(mark: str) -> float:
    """Seconds until no process of a mark is left, less those in which the one that waited longest had no processor."""
    begun, waited = time.monotonic(), dict[int, tuple[float, float]]()
    while left := processes_of(mark):
        assert time.monotonic() < begun + PATIENCE_S, left
        for process in left:
            now = without_processor_s(process)
            waited[process] = (waited.get(process, (now, now))[0], now)
        time.sleep(0.02)
    return time.monotonic() - begun - max((last - first for first, last in waited.values()), default=0.0)


def without_processor_s(process: int) -> float:
    """Seconds for which the main thread of a process was ready and had no processor, where the system tells."""
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError):
        return 0.0


@contextmanager
def busy() -> Iterator[None]:
    """A context in which other work asks for every core, with the lower priority that such work is given."""
    line = [sys.executable, "-c", "import os\nos.nice(10)\nwhile True: pass"]
    work = [subprocess.Popen(line) for _ in range(core_count())]
    try:
        yield
    finally:
        for one in work:
            one.kill()
            one.wait()


@contextmanager
def marked(arguments: list[str], folder: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A run of Python that has said that it has begun, and its mark; nothing is left even where a test fails."""
    value = uuid4().hex
    run = subprocess.Popen(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment(**{MARK: value}),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # Tests that run below nohup hand on that the signal is ignored.
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL),
    )
    try:
        assert run.stdout is not None
        assert run.stdout.readline() == "begun\n"
        yield run, value
    finally:
        for left in processes_of(value):
            os.kill(left, signal.SIGKILL)
        run.communicate()


def begun(arguments: list[str], folder: Path) -> AbstractContextManager[tuple[subprocess.Popen[str], str]]:
    """A command, as ``marked``."""
    (folder / "d.yaml").write_text(TEXT, encoding="utf-8")
    if not (folder / "designs").exists():
        (folder / "designs").symlink_to(ROOT / "designs")
    return marked(["-c", BEGUN, *arguments], folder)


def ended(run: subprocess.Popen[str], mark: str, number: signal.Signals) -> tuple[float, int, str]:
    """Seconds until a command that gets a signal has left no process, its exit status, and stderr."""
    (os.killpg if number in AS_A_TERMINAL else os.kill)(run.pid, number)
    seconds = seconds_until_gone(mark)
    _, err = run.communicate()
    return seconds, run.returncode, err


def wait_for(found: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE_S
    while not found():
        assert time.monotonic() < end
        time.sleep(0.02)


def drawing(mark: str) -> bool:
    """Whether a command has begun its second process, and that process computes."""
    return any("spawn_main" in line for line in processes_of(mark).values())


@pytest.mark.slow
@pytest.mark.parametrize("number", SIGNALS)
def test_a_build_leaves_no_process(tmp_path: Path, number: signal.Signals) -> None:
    with begun(BUILD, tmp_path) as (run, mark):
        wait_for(lambda: drawing(mark))
        _, status, err = ended(run, mark, number)
    if number == signal.SIGKILL:
        assert status == -signal.SIGKILL
    else:
        assert (status, err) == (128 + number, "interrupted; what earlier runs have written is untouched\n")


POOL = """
import sys, time
from ncgear import interrupts
from ncgear.workers import Pool

if {elsewhere}:
    interrupts.sys = type("Sys", (), {{"platform": "elsewhere"}})

def work(number):
    open(f"at work {{number}}", "w").close()
    {work}

if __name__ == "__main__":
    with Pool(2) as pool:
        for number in range(2):
            pool.submit(work, number)
        print("begun", flush=True)
        time.sleep(600)
"""
DEAF, ASLEEP = "sum(range(10**12))", "time.sleep(600)"
"""Work during which no thread of a process gets its turn, and work during which each does."""


@pytest.mark.slow
@pytest.mark.parametrize(("elsewhere", "work"), [(False, DEAF), (True, ASLEEP)], ids=["Linux", "elsewhere"])
def test_processes_end_by_themselves(tmp_path: Path, elsewhere: bool, work: str) -> None:
    """Linux ends them whatever they do; on other systems a thread of theirs waits for the end of the parent."""
    if not elsewhere and sys.platform != "linux":
        pytest.skip("of Linux")
    path = tmp_path / "pool.py"
    path.write_text(POOL.format(elsewhere=elsewhere, work=work), encoding="utf-8")
    with marked([str(path)], tmp_path) as (run, mark):
        wait_for(lambda: len(list(tmp_path.glob("at work *"))) == 2)
        # The two, their parent, and what multiprocessing clears up with.
        assert len(processes_of(mark)) == 4
        run.kill()
        seconds_until_gone(mark)


@contextmanager
def studio_at_work(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str, Page]]:
    """A studio of which a page is open, and the mark of its processes."""
    path = folder / "ellipse.yaml"
    shutil.copy(ROOT / "designs" / "ellipse.yaml", path)
    mark = uuid4().hex
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv(MARK, mark)
        with running(path, folder / "export") as studio, studio.page() as page:
            patched.undo()
            page.until("state")
            yield studio.process, mark, page


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status"),
    [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, 0)],
)
def test_a_studio_leaves_no_process_of_its_own_or_of_its_commands(
    tmp_path: Path, number: signal.Signals, status: int
) -> None:
    with studio_at_work(tmp_path) as (process, mark, page):
        page.send("run", command="animate")
        # The server, its two processes, and the command.
        wait_for(lambda: len(processes_of(mark)) >= 4)
        process.send_signal(number)
        seconds_until_gone(mark)
        assert process.wait() == status


WAITING = """
import threading, signal, uvicorn
from ncgear.studio import server
server.LAST_SECONDS = 0.2
server._Server(uvicorn.Config(None)).handle_exit(signal.SIGHUP, None)
lock = threading.Lock()
lock.acquire()
print("waits", flush=True)
lock.acquire()
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs a timer that interrupts")
def test_a_server_that_was_ended_waits_for_no_thread_for_good() -> None:
    ended = subprocess.run([sys.executable, "-c", WAITING], capture_output=True, timeout=60, check=False)
    assert (ended.returncode, ended.stdout) == (129, b"waits\n")


MOMENTS = int(os.environ.get("NCGEAR_MOMENTS", "20"))


def seconds_of(arguments: list[str], folder: Path) -> float:
    """The time that a command takes."""
    start = time.monotonic()
    with begun(arguments, folder) as (run, _):
        _, err = run.communicate()
    assert run.returncode == 0, err
    return time.monotonic() - start


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_no_command_leaves_a_process_whenever_it_is_ended(tmp_path: Path, name: str) -> None:
    """At twenty moments, by each signal in turn, on a busy computer; gone within two seconds."""
    if name in NEEDED:
        pytest.importorskip(NEEDED[name])
    with busy():
        ended_at_all_moments(tmp_path, name)


def ended_at_all_moments(tmp_path: Path, name: str) -> None:
    taken = seconds_of(COMMANDS[name], tmp_path)
    longest = dict.fromkeys(SIGNALS, 0.0)
    for moment in range(MOMENTS):
        number = SIGNALS[moment % len(SIGNALS)]
        shutil.rmtree(tmp_path / "export", ignore_errors=True)
        with begun(COMMANDS[name], tmp_path) as (run, mark):
            time.sleep(taken * (moment + 0.5) / MOMENTS)
            if run.poll() is not None:
                continue
            seconds, status, err = ended(run, mark, number)
        longest[number] = max(longest[number], seconds)
        assert status in (0, -number if number == signal.SIGKILL else 128 + number), err
        assert "Traceback" not in err
        assert seconds < PROMPT_S
    print(f"{name}: {taken:.1f} s; gone after", {number.name: round(one, 2) for number, one in longest.items()})


@pytest.mark.slow
@pytest.mark.long
def test_no_studio_leaves_a_process_whenever_it_is_ended(tmp_path: Path) -> None:
    """While it answers a page and builds, at twenty moments of six seconds, on a busy computer; gone within two."""
    with busy():
        studio_ended_at_all_moments(tmp_path)


def studio_ended_at_all_moments(tmp_path: Path) -> None:
    longest = dict.fromkeys(SIGNALS, 0.0)
    for moment in range(MOMENTS):
        number = SIGNALS[moment % len(SIGNALS)]
        folder = tmp_path / str(moment)
        folder.mkdir()
        with studio_at_work(folder) as (process, mark, page):
            page.send("run", command="build")
            page.send("set", changes={"operation.speed_rpm": 88})
            time.sleep(6.0 * moment / MOMENTS)
            process.send_signal(number)
            longest[number] = max(longest[number], seconds_until_gone(mark))
        assert longest[number] < PROMPT_S
    print("studio: gone after", {number.name: round(one, 2) for number, one in longest.items()})
