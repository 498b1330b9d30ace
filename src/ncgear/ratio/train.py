"""The pairs of gears between the driving shaft and the crank: one, or two in series."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.ratio.transmission import Transmission


@dataclass(frozen=True, eq=False)
class Pair:
    """The law of one pair by its own driving angle, and how fast its driving gear turns.

    ``speed`` is that gear's speed over the driving shaft's, at its own angles in rad; shape (n,) to shape (n,).
    """

    transmission: Transmission
    speed: Callable[[Array], Array] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Train:
    """The law phi2(phi1) of the whole, and its pairs from the driving shaft on; a single pair has the whole law."""

    whole: Transmission
    pairs: tuple[Pair, ...]


def single(transmission: Transmission) -> Train:
    """One pair between the driving shaft and the crank."""
    return Train(transmission, (Pair(transmission, np.ones_like),))
