"""What a batch of laws comes to: ratio and motion of the slider at Chebyshev points of each piece of the cycle."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from ncgear.numerics.arrays import Array, Mask
from ncgear.optimum.makeable.quantities import Place

Rows = TypeVar("Rows")


@dataclass(frozen=True, eq=False)
class Samples:
    """n laws over one cycle of the slider, cut into p pieces of m points each; arrays have shape (n, p, m).

    ``at`` holds ln i12 and what follows from it; velocities are in mm/rad and accelerations in mm/rad^2 of the driving
    angle.  ``displacement_mm`` (shape (n, w, m)) is that of the first w pieces, which make the working stroke.
    ``turning`` is the driven angle per share of the piece, ``there`` (shape (n, p)) where a piece has any length,
    ``sound`` (shape (n,)) where the law is known to be one.
    """

    at: Place
    velocity: Array
    acceleration: Array
    displacement_mm: Array
    turning: Array
    there: Mask
    sound: Mask


def place_of(slope: Array, first: Array, second: Array) -> Place:
    """The ratio from dphi2/dphi1 and its derivatives by phi1: d/dphi2 = i d/dphi1, ln i = -ln s."""
    ratio = 1.0 / slope
    return Place(
        log=np.log(ratio),
        ratio=ratio,
        slope=slope,
        first=-first * ratio**2,
        second=(2.0 * first**2 * ratio - second) * ratio**3,
    )


def stacked(places: list[Place]) -> Place:
    """Places of shape (n, m) as pieces, shape (n, p, m)."""
    return Place(*(np.stack(column, axis=1) for column in zip(*places, strict=True)))


def repeated(many: Any, count: int) -> Any:
    """A dataclass whose arrays count designs along their last axis, each design ``count`` times."""
    return replace(many, **{key: np.repeat(value, count, axis=-1) for key, value in _arrays(many).items()})


def _arrays(many: Any) -> dict[str, Array]:
    values = {field.name: getattr(many, field.name) for field in fields(many)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


@dataclass(frozen=True, eq=False)
class Sampled:
    """Samples of n laws and what is known of them besides, shape (n,) each.

    ``sound`` says where the design is known to be one.
    """

    samples: Samples
    sound: Mask
    stroke_mm: Array
    law_speed_rpm: Array
    stroke_error_mm: Array
