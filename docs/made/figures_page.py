"""The page of the figures that several commands tell, and of the one function that each comes from."""

from __future__ import annotations

from made.sources import SOURCES
from ncgear.figures.numbers import name_of
from ncgear.figures.tables import markdown

NAME = "figures.md"

INTRODUCTION = """\
# One machine, one figure

<!-- Made by `make docs` from the list of sources. -->

What several commands tell of a machine is computed once, with everything that the design file gives: resistance both
ways, friction of the slider and in its guide, gravity, masses, and the inertia of crank, rod and gears. A gear whose
moment of inertia the file leaves out has that of its own body; of two pairs in series, the shaft between them turns
with both its gears. `check`, `build`, `report`, `studio`, `sweep`, `optimize`, `frontier`, `simulate`, `strength`,
`size` and the drivetrain take these figures from the functions below, and
[tests/test_one_machine.py](../tests/test_one_machine.py) compares what they tell.

Where a file gives no masses, the powers are those of the resistance alone, and the answer says so. Where it gives
them, the resistance alone stands beside them. The uniform crank always has the same masses.

"""


def figures_page() -> str:
    """The page: a row for each figure."""
    rows = [[name_of(key), f"`{key}`", f"`{source.name}`"] for key, source in SOURCES.items()]
    return INTRODUCTION + "\n".join(markdown(["figure", "key", "computed by"], rows)) + "\n"
