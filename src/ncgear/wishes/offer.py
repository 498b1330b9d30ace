"""What could be asked for in place of a wish or a limit that no law keeps."""

from __future__ import annotations

from ncgear.frozen import dataclass

Value = float | bool


@dataclass(frozen=True)
class Offer:
    """What could be asked for instead, in words, and the dotted keys of a design file with the values that ask for it.

    ``key`` is that of the wish or limit that is eased, where messages name it.
    """

    said: str
    values: tuple[tuple[str, Value], ...] = ()
    key: str = ""

    def __str__(self) -> str:
        return f"{self.said} ({self.key})" if self.key else self.said
