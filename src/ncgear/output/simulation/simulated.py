"""What a simulation of any level hands over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ncgear.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Simulated:
    """``table`` holds columns of one length by name, ``figures`` sections of plain values, ``pictures`` PNGs by file.

    Names and keys end in their unit.
    """

    table: Mapping[str, Array]
    figures: Mapping[str, Any]
    pictures: Mapping[str, bytes]
