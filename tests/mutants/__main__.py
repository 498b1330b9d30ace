"""Draw mutations of every room, run the tests on each, and say what survives."""

from __future__ import annotations

import argparse
import difflib
import json
import random
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from queue import SimpleQueue

from mutants.covering import ROOT, TIERS, Covering, covering, pytest_of, quiet
from mutants.mutations import Mutation, mutations

SOURCE = ROOT / "src"

LONGEST = 3.0
"""Share of the time of its test files after which a mutation counts as found: it does not end."""

LEAST_S = 60.0
"""Least of that time in s: Python and its libraries take seconds to begin."""


@dataclass(frozen=True)
class Mutant:
    """A mutation of a module, which is named from ``src`` on."""

    module: str
    mutation: Mutation

    @property
    def room(self) -> str:
        """The folder of ``ncgear`` that the module is in."""
        return self.module.split("/")[1]

    @property
    def key(self) -> str:
        """What stays the same while the module does not change: its hash with the mutation."""
        return sha256(self.mutation.applied((SOURCE / self.module).read_bytes())).hexdigest()[:16]

    @property
    def difference(self) -> str:
        """The line before and after."""
        before = (SOURCE / self.module).read_bytes()
        pair = (text.decode().splitlines() for text in (before, self.mutation.applied(before)))
        changed = list(difflib.unified_diff(*pair, n=0, lineterm=""))[3:]
        return "\n".join(changed)


def drawn(room: Path, count: int, seed: int) -> list[Mutant]:
    """So many mutations of a room at random, the same ones for the same seed while the room does not change."""
    every = [
        Mutant(str(path.relative_to(SOURCE)), one)
        for path in sorted(room.rglob("*.py"))
        for one in mutations(path.read_bytes())
    ]
    chosen = random.Random(f"{seed} {room.name}")
    return chosen.sample(every, min(count, len(every)))


def killers(mutant: Mutant, known: Covering, tier: str, copy: Path) -> str:
    """What finds a mutation: a test file, time, or nothing, which is an empty text."""
    path = copy / mutant.module
    before = path.read_bytes()
    path.write_bytes(mutant.mutation.applied(before))
    try:
        for some in _shares(known.of(mutant.module, mutant.mutation.line)):
            longest_s = max(LEAST_S, LONGEST * sum(known.seconds[name] for name in some))
            try:
                status = subprocess.run(
                    [sys.executable, "-m", *pytest_of(tier), *some], timeout=longest_s, **quiet(copy)
                ).returncode
            except subprocess.TimeoutExpired:
                return "time"
            if status:
                return " ".join(some)
        return ""
    finally:
        path.write_bytes(before)


def _shares(names: Sequence[str]) -> Iterator[Sequence[str]]:
    """A few test files first, then more and more of them."""
    first, count = 0, 4
    while first < len(names):
        yield names[first : first + count]
        first, count = first + count, 2 * count


def judged(mutants: Sequence[Mutant], tier: str, kept: Path, processes: int) -> dict[Mutant, str]:
    """What finds each mutation; what was found before is not run again."""
    known = covering(tier, kept / f"covering-{tier}", SOURCE, processes)
    copies: SimpleQueue[Path] = SimpleQueue()
    for number in range(processes):
        copy = kept / f"source-{number}"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns("__pycache__"))
        copies.put(copy)

    def one(mutant: Mutant) -> str:
        place = kept / tier / mutant.key
        if not place.exists():
            copy = copies.get()
            try:
                found = killers(mutant, known, tier, copy)
            finally:
                copies.put(copy)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(json.dumps(found))
            print(
                f"{'found' if found else 'SURVIVES'}: {mutant.module}:{mutant.mutation.line} {found[:60]}", flush=True
            )
        return str(json.loads(place.read_text()))

    with ThreadPoolExecutor(processes) as pool:
        return dict(zip(mutants, pool.map(one, mutants), strict=True))


def main() -> None:
    """Draw, judge, tell."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--tests", choices=TIERS, default="readme")
    asked.add_argument("--each", type=int, default=10, help="mutations of each room")
    asked.add_argument("--seed", type=int, default=0)
    asked.add_argument("--room", nargs="*", help="only these rooms")
    asked.add_argument("--processes", type=int, default=2)
    asked.add_argument("--out", type=Path, default=ROOT / "export" / "mutants")
    given = asked.parse_args()
    rooms = [path for path in sorted((SOURCE / "ncgear").iterdir()) if path.is_dir() and path.name != "__pycache__"]
    chosen = [room for room in rooms if given.room is None or room.name in given.room]
    mutants = [mutant for room in chosen for mutant in drawn(room, given.each, given.seed)]
    found = judged(mutants, given.tests, given.out, given.processes)
    total, killed = (Counter(mutant.room for mutant in found if found[mutant] or every) for every in (True, False))
    for room in total:
        print(f"{room:12} {killed[room]:4} of {total[room]:4}")
    survivors = [mutant for mutant in mutants if not found[mutant]]
    text = "\n".join(f"{one.module}:{one.mutation.line} {one.key}\n{one.difference}\n" for one in survivors)
    (given.out / f"survivors-{given.tests}-{given.seed}.txt").write_text(text, encoding="utf-8")
    print(f"{sum(killed.values())} of {len(mutants)} found; the others stand in {given.out}")


if __name__ == "__main__":
    main()
