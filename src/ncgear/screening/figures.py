"""The figures of many sampled laws: peaks of the motion, range of the ratio, and the pitch curves of external pairs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.sampled import extremes, integration, tails
from ncgear.optimum.makeable.quantities import driven_curvature, driving_curvature, length_rate, tangent
from ncgear.ratio.transmission import CLOSED, STANDSTILL
from ncgear.screening.samples import Samples

RESOLVED = 1e-12
"""Last coefficients, relative to a quantity's largest value, up to which a law counts as resolved: its least value, a
hundredth of that where the ratio varies by 1:100, still has ten digits (tests/test_screening.py)."""

Ranges = dict[str, tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class LawFigures:
    """Of n laws, shape (n,) each; per radian of the driving angle and at unit centre distance.

    ``ranges`` has the smallest and largest value of the ratio, the tangent of the pitch curves' inclination, their
    curvatures, the slider's velocity and acceleration over the cycle and over the working stroke, and the power.
    ``length`` is that of the pitch curves over one turn of the driven gear, ``resolved`` says whose figures hold.
    """

    ranges: Ranges
    length: Array
    closing_error_rad: Array
    resolved: Mask

    def largest(self, name: str) -> Array:
        """Largest magnitude of a quantity."""
        low, high = self.ranges[name]
        magnitude: Array = np.maximum(-low, high)
        return magnitude


def law_figures(samples: Samples, force_n: Callable[[Array], Array]) -> LawFigures:
    """The figures of laws against a resistance, as a function of displacements in mm (any shape)."""
    working = samples.displacement_mm.shape[1]
    quantities = _quantities(samples, force_n)
    resolved = _resolved(samples, quantities)
    quantities["working_acceleration"] = samples.acceleration[:, :working]
    length, turned = (_integral(values) for values in (samples.turning * length_rate(samples.at), samples.turning))
    return LawFigures(_ranges(quantities, samples.there, resolved), length, turned - 2.0 * np.pi, resolved)


def _quantities(samples: Samples, force_n: Callable[[Array], Array]) -> dict[str, Array]:
    at, working = samples.at, samples.displacement_mm.shape[1]
    return {
        "ratio": at.ratio,
        "tangent": tangent(at),
        "driving_curvature": driving_curvature(at),
        "driven_curvature": driven_curvature(at),
        "velocity": samples.velocity,
        "acceleration": samples.acceleration,
        "power": force_n(samples.displacement_mm) * samples.velocity[:, :working],
    }


def _resolved(samples: Samples, quantities: dict[str, Array]) -> Mask:
    """Laws that are sound, all of whose quantities and lengths have died away, and which close."""
    rates = samples.turning * length_rate(samples.at)
    resolved = samples.sound.copy()
    for values in (*quantities.values(), rates, samples.turning):
        there = samples.there[:, : values.shape[1]]
        size = np.where(there, np.abs(values).max(axis=2), 0.0)
        small = tails(values) * size <= RESOLVED * size.max(axis=1, keepdims=True)
        resolved &= (small | ~there).all(axis=1)
    ratio = np.where(samples.there[..., None], samples.at.ratio, samples.at.ratio[:, :1])
    lowest, highest = ratio.min(axis=(1, 2)), ratio.max(axis=(1, 2))
    closed = np.abs(_integral(samples.turning) - 2.0 * np.pi) <= CLOSED
    answer: Mask = resolved & closed & (lowest > 2.0 * STANDSTILL * highest)
    return answer


def _ranges(quantities: dict[str, Array], there: Mask, resolved: Mask) -> Ranges:
    """Smallest and largest value of every quantity over the pieces that are there; zeros for laws not resolved."""
    laws = np.where(resolved[:, None], there, np.arange(there.shape[1]) == 0)
    rows, owners = [], []
    for number, values in enumerate(quantities.values()):
        law, piece = np.nonzero(laws[:, : values.shape[1]])
        rows.append(np.where(resolved[law][:, None], values[law, piece], 0.0))
        owners.append(law + number * len(laws))
    low, high = extremes(np.vstack(rows), np.concatenate(owners))
    lows, highs = (side.reshape(len(quantities), -1) for side in (low, high))
    return {name: (lows[number], highs[number]) for number, name in enumerate(quantities)}


def _integral(values: Array) -> Array:
    """Of values per share of each piece, over all pieces; shape (n,)."""
    total: Array = (values @ integration(values.shape[-1])[-1]).sum(axis=1)
    return total
