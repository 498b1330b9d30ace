"""The page of the conditions that the verdict on a machine tells."""

from __future__ import annotations

from ncgear.figures.advice.verdict import CONDITIONS, Condition, KnownParts
from ncgear.figures.tables import markdown

NAME = "conditions.md"

INTRODUCTION = """\
# What is judged of a machine

<!-- Made by `make docs` from the list of conditions. -->

`check`, `build`, `strength`, `simulate`, the report and the studio end in one verdict. It is made from this list, the
most serious condition first. Each that concerns a design is kept, broken, or not judged, and then the answer says why.
"No warnings." stands only over machines of which all was judged. `--verbose` prints every row, `--json` has them under
`verdict`.

A check makes no teeth. What only these can tell it names as not judged, and strength it judges roughly where it can.
`simulate` and the report make teeth where they need them. `tolerance` ends in the row of assembly as its own assemblies
show it, and in two rows that it alone has: whether assemblies knock, and whether its linear model is near to outlines.

"""


def conditions_page() -> str:
    """The page: a row for each condition."""
    rows = [
        [one.name, one.kept, _from(one), "each pair" if one.of_pair else "the machine"] for one in CONDITIONS.values()
    ]
    return INTRODUCTION + "\n".join(markdown(["condition", "what is kept", "judged by", "of"], rows)) + "\n"


def _from(condition: Condition) -> str:
    if condition.needs is KnownParts.MOTION:
        return "a check"
    return "a build" if condition.roughly is None else "a build, roughly by a check"
