"""Runs all hard cases and writes docs/hard-cases.md: ``PYTHONPATH=tests python -m hard.table``, or ``make docs``."""

from __future__ import annotations

from pathlib import Path

from hard.case import Case, cases
from hard.condition import conditions
from hard.judged import CANCELLING, FACTOR, LARGE, Made, Refused, in_roundings, judged

PAGE = Path(__file__).parents[2] / "docs" / "hard-cases.md"

INTRO = """# Hard cases

Written by `make docs` (`python -m hard.table`); the tests assert what it says (`tests/test_cases.py`). Each case is a
design file in [`tests/cases`](../tests/cases), or is made by `tests/hard/case.py`.

The figures of a case that is made are its driven angle at seven angles, smallest and largest ratio, peak
acceleration, peak power and length of the pitch curve. **Error** is the largest relative error of all of these, against
a reference of 40 digits that shares nothing with ncgear (`tests/oracles/laws.py`), and the figure that has it.
**Condition** is, for that figure, the sum of its relative changes per relative change of each input. Numbers in a file
have 16 digits, so no method can do better than the condition times 2.2e-16. **Roundings** is the largest error of any
figure in that unit; up to {factor:.0f} the error is the problem's and not the method's: 18 rounding errors are
the tail at which a Chebyshev form counts as resolved, the rest goes to the operations between an input and a figure.
Held to a hundred: {names}, whose returns take over the rounding error of terms much larger than their ratio.
Conditions over 1e6 are listed below the table.

"""

HEAD = "| case | what makes it hard | error | condition | roundings | closure, rad | verdict |\n" + 7 * "|---" + "|\n"


def row(case: Case) -> tuple[str, list[str]]:
    """The line of a case, and lines on conditions that are large."""
    verdict = judged(case)
    about = f"| `{case.name}` | {case.data['description']} |"
    if isinstance(verdict, Refused):
        return f"{about} | | | | refused ({verdict.exit_status}): {verdict.message} |", []
    condition = conditions(case.data)
    worst = max(verdict.errors, key=lambda name: verdict.errors[name])
    numbers = f" {verdict.errors[worst]:.1e}, {worst} | {condition[worst]:.2g} | {roundings(verdict, condition):.2g} |"
    large = [f"- `{case.name}`: {name} {value:.10g}" for name, value in condition.items() if value > LARGE]
    return f"{about}{numbers} {verdict.closure_rad:.1e} | made |", large


def roundings(made: Made, condition: dict[str, float]) -> float:
    """The largest error in rounding errors times the condition."""
    return max(in_roundings(made, condition).values())


def page() -> str:
    """The whole page."""
    rows = [row(case) for case in cases()]
    large = [line for _, lines in rows for line in lines]
    tail = "\nConditions over 1e6:\n\n" + "\n".join(large) + "\n" if large else "\nNo condition is over 1e6.\n"
    names = " and ".join(f"`{name}`" for name in CANCELLING)
    return INTRO.format(factor=FACTOR, names=names) + HEAD + "\n".join(line for line, _ in rows) + "\n" + tail


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
