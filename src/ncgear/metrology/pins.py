"""Pins (or balls) in the spaces of a gear: where each touches both flanks, and how far it stands out.

The centre of a pin of radius r lies on the curves at distance r outside both flanks of its space; Newton's method finds
where they cross, from the height at which the pin would touch a rack.  On a circular gear this is inv(alpha_M) =
inv(alpha) + d / (m z cos(alpha)) - (space width along the pitch circle) / (m z).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import cos, tan

import numpy as np
import shapely

from ncgear.metrology.working import WorkingFlanks
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import refined_crossings
from ncgear.teeth.tips import AGREEMENT


class Misfit(Enum):
    """Why a pin measures nothing in a space."""

    NOWHERE = "the pin finds no place where it touches both flanks"
    DEEP = "the pin touches below a flank's end; a larger pin may do"
    HIGH = "the pin touches above a flank's end or on its tip relief; a smaller pin may do"
    ROOT = "the pin is held by the bottom of the space or by another tooth before it touches both flanks"
    HIDDEN = "the pin does not stand out of the tips beside it; a larger pin may do"


@dataclass(frozen=True, eq=False)
class Pins:
    """Pins of one diameter where they measure; space i lies between teeth i and i + 1.

    ``space`` (shape (n,), numbers from 1), ``center_mm`` (shape (n, 2), in the gear's own frame) and ``over_mm`` (shape
    (n,)), the distance from the axis to the pin's far side, of a ring to its near side.  ``misfits`` tells why others
    measure nothing, by their number.
    """

    diameter_mm: float
    space: IndexArray
    center_mm: Array
    over_mm: Array
    misfits: dict[int, Misfit]


def pins_in_spaces(working: WorkingFlanks, diameter_mm: float, outline_mm: Array, astray_mm: float) -> Pins:
    """Pins of a diameter in all spaces of a gear with an outline (shape (n, 2)).

    ``astray_mm`` is how far the outline may stand into spaces by its chords, and by the thickness of its teeth where
    these are thinner.
    """
    flanks, radius = working.flanks, diameter_mm / 2.0 / working.base_cosine
    front = np.arange(1, flanks.count, 2)
    both = np.stack([front, (front + 1) % flanks.count])
    center, heights, met = _resting(working, both, radius)
    sense = -1.0 if working.is_ring else 1.0
    reach = np.linalg.norm(center, axis=1)
    outwards = sense * center / reach[:, None]
    tests: dict[Misfit, Mask] = {
        Misfit.NOWHERE: ~met,
        Misfit.DEEP: np.any(heights < working.low_mm[both], axis=0),
        Misfit.HIGH: np.any(heights > working.high_mm[both], axis=0),
        Misfit.ROOT: _held(center, diameter_mm / 2.0, outline_mm, astray_mm),
        Misfit.HIDDEN: ~stands_out(working, np.arange(front.size), center, diameter_mm / 2.0, outwards),
    }
    return _kept(diameter_mm, center, reach + sense * diameter_mm / 2.0, tests)


def _kept(diameter_mm: float, center: Array, over: Array, tests: dict[Misfit, Mask]) -> Pins:
    """The pins that pass all tests, and the first test that each of the others fails."""
    failed = np.array(list(tests.values()))
    good = np.nonzero(~failed.any(axis=0))[0]
    first = failed.argmax(axis=0)
    misfits = {int(i) + 1: list(tests)[first[i]] for i in np.nonzero(failed.any(axis=0))[0]}
    return Pins(diameter_mm, good + 1, center[good], over[good], misfits)


def _resting(working: WorkingFlanks, both: IndexArray, radius: float) -> tuple[Array, Array, Mask]:
    """Centres (z, 2) of pins between the front and back flanks of spaces (shape (2, z)), the heights (2, z) at which
    they touch, and whether they do."""
    flanks, (front, back) = working.flanks, both
    angle, tolerance = flanks.rack.pressure_angle_rad, AGREEMENT * flanks.rack.module_mm
    width = np.mod(flanks.crossing_mm[back] - flanks.crossing_mm[front], flanks.curve.length_mm)
    start = (radius * cos(angle) - width / 2.0) / tan(angle)
    at_front, at_back, met = refined_crossings(
        lambda height: working.parallel(front, height, radius),
        lambda height: working.parallel(back, height, radius),
        start,
        start,
        tolerance,
    )
    at_front, at_back = np.where(met, at_front, start), np.where(met, at_back, start)
    return working.parallel(front, at_front, radius)[0], np.stack([at_front, at_back]), met


def _held(center: Array, radius: float, outline: Array, astray: float) -> Mask:
    """Whether pins are nearer to the outline than by their radius, what it strays aside."""
    ring = shapely.linearrings(outline)
    shapely.prepare(ring)
    held: Mask = shapely.distance(shapely.points(center), ring) < radius - 2.0 * astray
    return held


def stands_out(working: WorkingFlanks, space: IndexArray, center: Array, radius: float, outwards: Array) -> Mask:
    """Whether pins in spaces (numbered from 0, shape (n,)) reach farther in directions (n, 2) than the tips beside."""
    beside = working.tips_mm[(space[:, None] + np.arange(2)) % len(working.tips_mm)]
    highest = np.einsum("ntpk,nk->ntp", beside, outwards).max(axis=(1, 2))
    reached: Mask = np.einsum("nk,nk->n", center, outwards) + radius > highest
    return reached
