"""Whether two checkouts of ncgear give a user the same: everything is run with both, and what comes out is compared.

    python tests/every_output.py record FOLDER [--source CHECKOUT] [--only quick]
    python tests/every_output.py compare FOLDER FOLDER [--group]

A record holds a folder for each run, with ``outcome.txt`` (arguments, exit status, stdout, stderr) and the files that
the run wrote; ``hashes.json``; and ``seconds.json``. Designs are those of the checkout this script is in.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from hashlib import sha256
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory

from every_command import ROOT, Run, all_runs, completing

Ended = tuple[object, str, str]
"""Exit status, stdout and stderr."""

PROCESSES = 2
TOGETHER = {"build": 5, "varied build": 25, "varied balance": 60}
"""How many runs share an interpreter at most; 150 where nothing is said."""

SETTING = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "COLUMNS": "100",
    "TERM": "dumb",
    "PYTHONUTF8": "1",
    "PYTHONHASHSEED": "0",
}

LIBRARIES = "ncgear|python|numpy|scipy|shapely|trimesh|mapbox-earcut|matplotlib|pydantic|ruamel.yaml"
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
TIMING = re.compile(r'"timing_s": \{[^{}]*\}'), re.compile(r"^Time in s\n(?:  .*\n?)+", re.MULTILINE)
VERSION = (
    re.compile(rf'(<tr><th scope="row">(?:{LIBRARIES})</th><td>)[^<]+'),
    re.compile(rf'("(?:{LIBRARIES})": ")[\d.]+(?=")'),
    re.compile(r'(content="ncgear |^ncgear )[\d.]+(?=">|$)', re.MULTILINE),
    re.compile(r"(Open CASCADE STEP processor )[\d.]+"),
)

DIGEST = re.compile(r'"sha256": "[0-9a-f]{64}"')
CLASS = "  0\nCLASS\n"
CLASSES = re.compile(rf"(?:{CLASS}(?:.*\n.*\n){{7}})+")


def normal(content: bytes, place: Path, source: Path, name: str = "") -> bytes:
    """Without what may differ from run to run: seconds, versions, the temporary folder, the place of the checkout."""
    text = _text(content)
    if text is None:
        return content
    text = text.replace(str(place), "<folder>").replace(str(source), "<source>")
    for timing in TIMING:
        text = timing.sub(
            lambda found: re.sub(r"(?<= )[\d.]+(?:e-\d+)?(?=,?$)", "0", found[0], flags=re.MULTILINE), text
        )
    for version in VERSION:
        text = version.sub(r"\1-", text)
    if name.endswith(".dxf"):
        # The library that writes drawings lists its classes in the order of a set.
        text = CLASSES.sub(lambda found: CLASS + CLASS.join(sorted(found[0].split(CLASS)[1:])), text)
    if name == "manifest.json":
        # Of files that say how long a run took.
        text = DIGEST.sub('"sha256": "-"', text)
    if name == "frontier-points.jsonl":
        # Processes side by side end in any order.
        text = "\n".join(sorted(text.splitlines()))
    return text.encode()


def _text(content: bytes) -> str | None:
    with contextlib.suppress(UnicodeDecodeError):
        return None if b"\0" in content else content.decode()
    return None


@contextlib.contextmanager
def _place_for(run: Run) -> Iterator[Path]:
    """A folder with the designs and the run's own files."""
    with TemporaryDirectory(prefix="ncgear-") as name:
        place = Path(name)
        shutil.copytree(ROOT / "designs", place / "designs")
        for file, text in run.texts.items():
            (place / file).write_bytes(text.encode())
        yield place


def _stamps(place: Path) -> dict[Path, tuple[int, int]]:
    """Size and time of each file of a folder."""
    files = [path for path in sorted(place.rglob("*")) if path.is_file()]
    return {path.relative_to(place): (path.stat().st_size, path.stat().st_mtime_ns) for path in files}


def _keep(run: Run, ended: Ended, place: Path, before: dict[Path, tuple[int, int]], task: Task) -> None:
    status, out, err = ended
    outcome = f"arguments: {json.dumps(run.arguments)}\nstatus: {status}\n--- stdout\n{out}\n--- stderr\n{err}\n"
    after = _stamps(place)
    written = {path: (place / path).read_bytes() for path in after if before.get(path) != after[path]}
    gone = {path: b"(removed)" for path in before if path not in after}
    for path, content in {Path("outcome.txt"): outcome.encode(), **written, **gone}.items():
        kept = task.folder / run.name / path
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_bytes(normal(content, place, task.source, path.name))


class Task:
    """Where a record is to be, and of which checkout."""

    def __init__(self, folder: Path, source: Path) -> None:
        self.folder, self.source = folder.resolve(), source.resolve()
        inherited = {name: value for name, value in os.environ.items() if not name.startswith(("NCGEAR", "PYTHON"))}
        self.environment = {**inherited, **SETTING, "PYTHONPATH": str(self.source / "src")}


def _run_alone(run: Run, task: Task) -> dict[str, float]:
    command = [sys.executable, "-m", "ncgear", *run.arguments]
    with _place_for(run) as place:
        before, start = _stamps(place), time.perf_counter()
        environment = {**task.environment, **run.environment}
        quiet = subprocess.DEVNULL
        done = subprocess.run(command, cwd=place, env=environment, stdin=quiet, capture_output=True, encoding="utf-8")
        seconds = time.perf_counter() - start
        _keep(run, (done.returncode, done.stdout, done.stderr), place, before, task)
    return {run.name: seconds}


def _run_together(runs: list[Run], task: Task) -> dict[str, float]:
    """In one interpreter of the other checkout, by this script itself."""
    order = json.dumps([str(task.folder), str(task.source), *map(asdict, runs)])
    command = [sys.executable, __file__, "batch"]
    done = subprocess.run(command, env=task.environment, input=order, stdout=subprocess.PIPE, encoding="utf-8")
    if done.returncode:
        sys.exit(f"{runs[0].name} and {len(runs) - 1} more: ended with {done.returncode}")
    seconds: dict[str, float] = json.loads(done.stdout)
    return seconds


def batch() -> None:
    """Do the runs that stdin tells of, one after the other, and say how long each took."""
    import ncgear.cli

    folder, source, *orders = json.load(sys.stdin)
    task, seconds = Task(Path(folder), Path(source)), {}
    here, hook = Path.cwd(), sys.unraisablehook
    for run in (Run(**order) for order in orders):
        with _place_for(run) as place:
            before, start = _stamps(place), time.perf_counter()
            os.chdir(place)
            os.environ.update(run.environment)
            out, err, status = io.StringIO(), io.StringIO(), None
            sys.argv = ["ncgear", *run.arguments]
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                try:
                    ncgear.cli.main()
                except SystemExit as ended:
                    status = ended.code
            signal.signal(signal.SIGINT, signal.default_int_handler)
            sys.unraisablehook = hook
            for name in run.environment:
                del os.environ[name]
            os.chdir(here)
            seconds[run.name] = time.perf_counter() - start
            _keep(run, (status or 0, out.getvalue(), err.getvalue()), place, before, task)
    print(json.dumps(seconds))


def _known_keys(task: Task) -> dict[str, list[str]]:
    """The keys that the checkout's ``explain`` offers to the shell."""
    code = "import sys; sys.argv = ['ncgear']; from ncgear.cli import main; main()"
    known = {}
    for kind in ("design", "balance"):
        environment = {**task.environment, **completing(f"ncgear explain --of {kind} ")}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        known[kind] = done.stdout.split()
    return known


def record(folder: Path, source: Path, only: str | None) -> None:
    """Run everything, or what is quick, and keep what came out."""
    if folder.exists() and any(folder.iterdir()):
        sys.exit(f"{folder} is not empty")
    task, start = Task(folder, source), time.perf_counter()
    runs = [run for run in all_runs(_known_keys(task)) if run.quick or not only]
    assert len({run.name for run in runs}) == len(runs), "two runs of one name"
    shared = defaultdict(list)
    for run in runs:
        shared[run.together].append(run)
    seconds: dict[str, float] = {}
    with ThreadPoolExecutor(PROCESSES) as pool:
        jobs = [pool.submit(_run_alone, run, task) for run in shared.pop("", [])]
        for word, some in shared.items():
            size = TOGETHER.get(word, 150)
            jobs += [pool.submit(_run_together, some[at : at + size], task) for at in range(0, len(some), size)]
        for job in jobs:
            seconds |= job.result()
    hashes = {str(path): sha256((task.folder / path).read_bytes()).hexdigest() for path in _stamps(task.folder)}
    for name, content in (("hashes.json", hashes), ("seconds.json", dict(sorted(seconds.items())))):
        (folder / name).write_text(json.dumps(content, indent=1), encoding="utf-8")
    print(f"{len(runs)} runs, {len(hashes)} outputs, {time.perf_counter() - start:.0f} s")


def compare(one: Path, other: Path, group: bool) -> int:
    """Say what differs; the number of outputs that do."""
    left, right = (json.loads((folder / "hashes.json").read_text(encoding="utf-8")) for folder in (one, other))
    counts: Counter[str] = Counter(equal=sum(left[path] == right.get(path) for path in left))
    alike: dict[str, list[tuple[str, str, str]]] = defaultdict(list)
    for path in sorted(path for path in left.keys() | right.keys() if left.get(path) != right.get(path)):
        kind, said = f"only in {one if path in left else other}", list[str]()
        if path in left and path in right:
            kind, said = _difference((one / path).read_bytes(), (other / path).read_bytes())
        counts[kind] += 1
        if group and kind == "text":
            gone, come = ([line[1:] for line in said if line[0] == sign] for sign in "-+")
            for before, after in zip_longest(gone, come, fillvalue=""):
                words = [
                    [word for word in a.split() if word not in b.split()] for a, b in ((before, after), (after, before))
                ]
                alike[str(words)].append((path, before, after))
        else:
            more = [f"and {len(said) - 12} lines more"] if len(said) > 12 else []
            print("\n    ".join([f"{path}: {kind}", *(line[:200] for line in said[:12]), *more]))
    for found in sorted(alike.values(), key=len, reverse=True):
        path, before, after = found[0]
        print(f"{len(found)} times the like of {path}\n    - {before[:300]}\n    + {after[:300]}")
    print(", ".join(f"{count} {kind}" for kind, count in counts.items()))
    return counts.total() - counts["equal"]


def _difference(one: bytes, other: bytes) -> tuple[str, list[str]]:
    """Its kind, and lines that show it."""
    before, after = _text(one), _text(other)
    if before is None or after is None:
        return "binary", [f"{len(one)} and {len(other)} bytes"]
    if NUMBER.sub("0", before) == NUMBER.sub("0", after):
        pairs = [pair for pair in zip(NUMBER.findall(before), NUMBER.findall(after), strict=True) if pair[0] != pair[1]]
        worst = max(pairs, key=_relative)
        return "numbers", [f"{len(pairs)} differ, by {_relative(worst):.2g} at most: {worst[0]} and {worst[1]}"]
    return "text", list(difflib.unified_diff(before.splitlines(), after.splitlines(), n=0, lineterm=""))[2:]


def _relative(pair: tuple[str, str]) -> float:
    one, other = map(float, pair)
    return 0.0 if one == other else abs(one - other) / max(abs(one), abs(other))


def main() -> int:
    """Read the command line of this script."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    recording = commands.add_parser("record", help="run everything and keep what comes out")
    recording.add_argument("folder", type=Path)
    recording.add_argument("--source", type=Path, default=ROOT, help="checkout whose package is run")
    recording.add_argument("--only", choices=["quick"], help="the quick commands only")
    comparing = commands.add_parser("compare", help="say what differs between two records")
    comparing.add_argument("one", type=Path)
    comparing.add_argument("other", type=Path)
    comparing.add_argument("--group", action="store_true", help="each change of words once, with how often it occurs")
    commands.add_parser("batch", help="used by record")
    asked = parser.parse_args()
    if asked.command == "compare":
        return 1 if compare(asked.one, asked.other, asked.group) else 0
    if asked.command == "record":
        record(asked.folder, asked.source, asked.only)
    else:
        batch()
    return 0


if __name__ == "__main__":
    sys.exit(main())
