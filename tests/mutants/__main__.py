"""Draw mutations of every room, run the tests on each, and say what survives."""

from __future__ import annotations

import argparse
import json
import sys
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from mutants.collected import TESTS, Collected, Test, collect
from mutants.covering import Covering, covering, hashed
from mutants.drawn import ROOT, Mutant, drawn, rooms
from mutants.forked import Work, results
from mutants.mutations import Mutation
from mutants.survivors import Verdict, page

MARKS = {"quick": "not thorough and not slow", "readme": "not slow"}
"""The tests of ``make quick``, and those of README's command."""

PAGE = ROOT / "benchmarks" / "mutants.md"
"""Where survivors of all rooms are kept."""

LONGEST = 3.0
"""Share of a test's processor time after which a mutation counts as found: it does not end."""

LEAST_S = 20.0
"""Least of that time in s."""


class Judge:
    """What finds each mutation.

    What is known is kept in a folder while module and test files stay as they are: other files that tests share may not
    change, or the folder has to be removed.
    """

    def __init__(self, collected: Collected, known: Covering, kept: Path) -> None:
        self._collected, self._known, self._kept = collected, known, kept
        self._hashes = {test: f"{test.unit} {hashed([TESTS / test.file])}" for test in collected.tests}
        self._tests = {test.unit: test for test in collected.tests}
        kept.mkdir(parents=True, exist_ok=True)

    def verdicts(self, mutants: Sequence[Mutant], processes: int) -> dict[Mutant, Verdict]:
        """What finds each of some mutations."""
        found = {mutant: self._read(mutant) for mutant in mutants}
        no_judges: dict[Mutant, set[Test]] = {mutant: set() for mutant in mutants}
        works: deque[Work[tuple[Mutant, Test | None]]] = deque()
        # Tests that failed on some mutation and pass without it.
        judges = set[Test]()

        def begin(mutant: Mutant) -> None:
            tests = [test for test in self._asked(mutant, found[mutant]) if test not in no_judges[mutant]]
            if tests:
                works.append(self._work(mutant, tests, None))

        def end(mutant: Mutant, by: str) -> None:
            asked = self._asked(mutant, found[mutant])
            passed = {*found[mutant].passed, *(self._hashes[test] for test in asked)}
            if by or not found[mutant].by:
                found[mutant] = Verdict(by, sorted(passed))
            self._write(mutant, found[mutant])
            print(f"{by or 'SURVIVES'}: {mutant.module}:{mutant.line}", flush=True, file=sys.stderr)

        for mutant in mutants:
            begin(mutant)
        for (mutant, judge), result in results(works, processes):
            if judge is not None and result is not None and not result["failed"]:
                judges.add(judge)
                end(mutant, judge.unit)
            elif judge is not None:
                no_judges[mutant].add(judge)
                begin(mutant)
            elif result is None:
                end(mutant, "time")
            elif result["failed"] and self._tests[result["failed"]] in judges:
                end(mutant, result["failed"])
            elif result["failed"]:
                # A test that fails without the mutation too, since it measures time, say, has found nothing.
                test = self._tests[result["failed"]]
                same = replace(mutant, mutation=Mutation(0, 0, "", mutant.line))
                works.appendleft(replace(self._work(same, [test], test), key=(mutant, test)))
            else:
                end(mutant, "")
        return found

    def _asked(self, mutant: Mutant, found: Verdict) -> list[Test]:
        """Tests that run a line and are not known to pass; none where a quick one fails."""
        if found.quick:
            return []
        tests = [test for test in self._known.of(mutant.module, mutant.line) if not found.by or test.tier == "quick"]
        return [test for test in tests if self._hashes[test] not in found.passed]

    def _work(self, mutant: Mutant, tests: Sequence[Test], judge: Test | None) -> Work[tuple[Mutant, Test | None]]:
        longest_s = {test: max(LEAST_S, LONGEST * self._known.ran[test].seconds) for test in tests}
        return Work((mutant, judge), partial(self._collected.under, mutant, longest_s), sum(longest_s.values()))

    def _place(self, mutant: Mutant) -> Path:
        return self._kept / f"{mutant.key}-{mutant.written}.json"

    def _read(self, mutant: Mutant) -> Verdict:
        place = self._place(mutant)
        return Verdict(**json.loads(place.read_text())) if place.exists() else Verdict("", [])

    def _write(self, mutant: Mutant, verdict: Verdict) -> None:
        self._place(mutant).write_text(json.dumps({"by": verdict.by, "passed": verdict.passed}))


def main() -> None:
    """Draw, judge, tell."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--tests", choices=MARKS, default="readme")
    asked.add_argument("--each", type=int, default=8, help="mutations of each room")
    asked.add_argument("--seed", type=int, default=38)
    asked.add_argument("--room", nargs="*", help="only these rooms")
    asked.add_argument("--processes", type=int, default=2)
    asked.add_argument("--kept", type=Path, default=ROOT / "export" / "mutants")
    given = asked.parse_args()
    chosen = [room for room in rooms() if given.room is None or room.name in given.room]
    mutants = [mutant for room in chosen for mutant in drawn(room, given.each, given.seed)]

    def then(collected: Collected) -> None:
        known = covering(collected, given.kept, given.processes)
        verdicts = Judge(collected, known, given.kept / "judged").verdicts(mutants, given.processes)
        text = page(verdicts, given.each, given.seed, given.tests)
        (PAGE if given.room is None else given.kept / PAGE.name).write_text(text, encoding="utf-8")

    collect(then, MARKS[given.tests])


if __name__ == "__main__":
    main()
