"""A line of the data sheet."""

from __future__ import annotations

from ncgear.figures.tables import Value, cell_text
from ncgear.frozen import dataclass


@dataclass(frozen=True)
class Entry:
    """One line of the sheet: a value of the ``pair``, or one each of the ``driving`` and the ``driven`` gear.

    ``unit`` may be empty.
    """

    label: str
    unit: str = ""
    pair: Value = None
    driving: Value = None
    driven: Value = None

    @property
    def of_pair(self) -> bool:
        """Whether the value belongs to the pair, so that it needs one cell only."""
        return self.pair is not None

    @property
    def texts(self) -> tuple[str, ...]:
        """The value of the pair, or those of both gears, for reading, to the decimals of their unit."""
        values = (self.pair,) if self.of_pair else (self.driving, self.driven)
        return tuple(cell_text(value, self.unit) for value in values)
