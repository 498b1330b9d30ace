"""The page of what survives: a table by room, and each survivor with its reason."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ruamel.yaml import YAML

from mutants.drawn import Mutant

REASONS = Path(__file__).with_name("reasons.yaml")

HEAD = """# Which broken lines no test finds

Lines of each room's mathematics are broken one at a time, {each} of each room, drawn by seed {seed}, and the tests that
run them have to fail ([how it is tested](../docs/how-it-is-tested.md)). An equivalent mutation changes nothing that
anybody can see; the shares are of the others. `make mutants` writes this page.

| room | drawn | equivalent | {columns} |
|---|---|---|{rules}|
"""

COLUMNS = {"quick": ("quick tests find",), "readme": ("quick tests find", "README's tests find")}
"""What is told of each room where these tests were run."""


@dataclass(frozen=True)
class Verdict:
    """What finds a mutation: a test with its tier, time, or nothing; and which tests, as they stand, do not."""

    by: str
    passed: Sequence[str]

    @property
    def quick(self) -> bool:
        """Whether quick tests find it."""
        return self.by == "time" or self.by.endswith(" quick")


@dataclass(frozen=True)
class Reason:
    """Why no test finds a mutation, and whether none could."""

    reason: str
    equivalent: bool = False


def page(verdicts: Mapping[Mutant, Verdict], each: int, seed: int, tests: str) -> str:
    """What stands on the page where the tests of ``make quick`` were run, or those of README's command."""
    columns = COLUMNS[tests]
    known = {key: Reason(**one) for key, one in (YAML(typ="safe").load(REASONS) or {}).items()}
    rooms: dict[str, list[tuple[Mutant, Verdict]]] = {}
    for mutant, verdict in verdicts.items():
        rooms.setdefault(mutant.room, []).append((mutant, verdict))
    rows = [_row(f"`{room}/`", some, known, len(columns)) for room, some in rooms.items()]
    rows.append(_row("all", list(verdicts.items()), known, len(columns)))
    told = [line for room, some in rooms.items() for line in _told(room, some, known, tests)]
    head = HEAD.format(each=each, seed=seed, columns=" | ".join(columns), rules="|".join(["---"] * len(columns)))
    return head + "\n".join([*rows, *told]) + "\n"


def _row(name: str, some: Sequence[tuple[Mutant, Verdict]], known: Mapping[str, Reason], columns: int) -> str:
    equivalent = sum(_equivalent(mutant, verdict, known) for mutant, verdict in some)
    real = len(some) - equivalent
    quick, readme = (sum(map(bool, found)) for found in zip(*((one.quick, one.by) for _, one in some), strict=True))
    shares = (f"{count} ({100 * count / max(real, 1):.0f} %)" for count in (quick, readme)[:columns])
    return f"| {name} | {len(some)} | {equivalent} | {' | '.join(shares)} |"


def _equivalent(mutant: Mutant, verdict: Verdict, known: Mapping[str, Reason]) -> bool:
    return not verdict.by and mutant.key in known and known[mutant.key].equivalent


def _told(room: str, some: Sequence[tuple[Mutant, Verdict]], known: Mapping[str, Reason], tests: str) -> Iterator[str]:
    """Those of a room that quick tests do not find."""
    left = [(mutant, verdict) for mutant, verdict in some if not verdict.quick]
    if left:
        yield f"\n## `{room}/`\n"
    for mutant, verdict in left:
        module = mutant.module.removeprefix("ncgear/")
        line = f"- `{module}` ({mutant.key}): `{mutant.before}` becomes `{mutant.after}`."
        reason = known.get(mutant.key)
        if verdict.by:
            yield f"{line} Found by `{verdict.by.partition(' ')[0]}`, which is thorough."
        elif reason is not None:
            yield f"{line} {'Equivalent: ' if reason.equivalent else ''}{reason.reason}"
        elif not verdict.passed:
            yield f"{line} {'No quick test' if tests == 'quick' else 'No test of README'} runs this line."
        else:
            yield f"{line} Nobody has looked at it."
