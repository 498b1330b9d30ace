"""Measuring pins (or balls) in the spaces of a gear: their contacts with both flanks, and how far they stand out.

The centre of a pin of radius r lies on the curves at distance r outside both flanks of its space; Newton's method finds
where they cross, from the heights at which the pin would touch a rack.  On a circular gear this is inv(alpha_M) =
inv(alpha) + d / (m z cos(alpha)) - (space width along the pitch circle) / (m z); where the flanks have unequal pressure
angles, the mean of both sides' terms counts, with angles at the pin's centre of its base circles.

The measurement over two pins (between them, in a ring) is taken in spaces that lie nearly opposite each other.

Pins and plates touch flanks without tip relief, in one section.  All flanks of one side are parallel curves: the rolled
length c at which a flank crosses the pitch curve moves it along its normals by s cos(alpha) dc (teeth/flank.py).  So a
tooth that is thicker by dE along the pitch curve has the same normals, and the curve at a distance r outside a flank is
a flank again, with c + s r / cos(alpha).

On helical teeth the surface's normal leans out of the section by the base helix angle beta_b, tan(beta_b) = tan(beta)
cos(alpha), by the same angle everywhere.  A ball of radius r therefore meets a section's flanks as a pin of r /
cos(beta_b) would, and plates are cos(beta_b) times as far apart as in the section.  On circular gears both are the
usual formulas, cos(beta_b) = cos(beta) cos(alpha_n) / cos(alpha).
"""

from __future__ import annotations

from dataclasses import replace
from enum import Enum
from math import atan, ceil, cos, floor, log10, tan

import numpy as np
import shapely

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import refined_crossings
from ncgear.numerics.plane import turned
from ncgear.teeth.flank import Flanks
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.tool import AGREEMENT


@dataclass(frozen=True, eq=False)
class WorkingFlanks:
    """Flanks in one section, and the heights over the rack's pitch line between which each is exact, shape (2 z,).

    ``tips_mm`` (shape (z, 3, 2)) holds both ends and the middle of each tip land; ``base_cosine`` (shape (2 z,)) is the
    cosine of each flank's base helix angle, 1 for straight teeth.
    """

    flanks: Flanks
    low_mm: Array
    high_mm: Array
    tips_mm: Array
    base_cosine: Array

    @property
    def is_ring(self) -> bool:
        """Whether the teeth point towards the axis."""
        return self.flanks.curve.is_ring

    def thicker(self, allowance_mm: float) -> WorkingFlanks:
        """The same teeth with idle flanks that stand out by an allowance along the pitch curve; back if negative."""
        idle = np.where(self.flanks.idle, self.flanks.side, 0.0)
        crossing = self.flanks.crossing_mm + idle * allowance_mm
        return replace(self, flanks=replace(self.flanks, crossing_mm=crossing))

    def parallel(self, flank: IndexArray, height_mm: Array, distance_mm: Array) -> tuple[Array, Array]:
        """Points at distances outside the points where flanks touch at heights, and derivatives by the height."""
        slant, side = self.flanks.slant.of(flank), self.flanks.side[flank][..., None]
        sine, cosine = (np.broadcast_to(value, flank.shape)[..., None] for value in (slant.sine, slant.cosine))
        at = self.flanks.at_rolled(flank, self.flanks.rolled_mm(flank, height_mm)).turned(self.flanks.turn_rad[flank])
        farther = height_mm / slant.sine + distance_mm
        along = cosine * at.normal - side * sine * at.tangent
        speed = (slant.sine + farther * at.curvature) / slant.height_per_rolled
        point = at.position + farther[..., None] * (side * cosine * at.tangent + sine * at.normal)
        return point, speed[..., None] * along


def working_flanks(gear: ToothedGear, helix_rad: float = 0.0) -> WorkingFlanks:
    """The flanks of a section of a gear whose teeth have the helix angle ``helix_rad`` (0 <= beta < pi/2)."""
    high, low = gear.sides.flank_range()
    rack = gear.flanks.rack
    if rack.relief is not None:
        high = np.minimum(high, rack.relief.start_mm)
    leaning = [cos(atan(tan(helix_rad) * cos(angle))) for angle in rack.angles_rad]
    base = np.where(gear.flanks.idle, leaning[1], leaning[0])
    along, height = gear.sides.tip_mm.reshape(-1, 2), gear.flanks.tip_height_mm.reshape(-1, 2)
    ends = np.stack([along[:, 0], along.mean(axis=1), along[:, 1]], axis=1)
    heights = np.stack([height[:, 0], height.mean(axis=1), height[:, 1]], axis=1)
    turn = gear.flanks.turn_rad.reshape(-1, 2)
    over = np.stack([turn[:, 0], turn.mean(axis=1), turn[:, 1]], axis=1)
    tips = turned(gear.flanks.offset(ends, heights)[0], over)
    return WorkingFlanks(replace(gear.flanks, rack=replace(rack, relief=None)), low, high, tips, base)


OUTSIDE, IN_RING = 1.728, 1.68
"""Diameter in normal modules, for external teeth and for a ring, of a pin that touches flanks of 20 degrees near the
pitch curve and stands out of the space (Van Keuren's rule, values from secondary sources)."""

SOLD_MM = (
    *(0.17, 0.195, 0.22, 0.25, 0.29, 0.335, 0.39, 0.455, 0.53, 0.62, 0.725, 0.895, 1.1, 1.35, 1.5, 1.65, 1.75, 2.0),
    *(2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 5.0, 5.25, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0, 9.0, 10.0, 10.5),
    *(11.0, 12.0, 14.0, 15.0, 16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 30.0, 35.0, 40.0, 45.0, 50.0),
)
"""Commonly sold diameters of such pins in mm, after DIN 3977 and, below 1.5 mm, the wires of DIN 2269 (values from
secondary sources, not compared with the standards)."""

NEAR = 1.3
"""Largest tried factor of the nominal diameter; larger pins touch near the tips."""

SHARES = tuple(np.linspace(1.0, NEAR, 7).tolist())
"""Sizes that are tried where none is sold, as shares of the nominal size."""


def nominal_pin_mm(normal_module_mm: float, *, internal: bool) -> float:
    """The nominal pin diameter in mm, from which a sold diameter is then chosen."""
    return (IN_RING if internal else OUTSIDE) * normal_module_mm


def pins_to_try(nominal_mm: float) -> tuple[float, ...]:
    """Sold diameters from the nominal one to ``NEAR`` times it, rising, or the next larger one.

    Above all sold diameters whole mm are tried, below them two digits.
    """
    if not SOLD_MM[0] / NEAR <= nominal_mm <= SOLD_MM[-1]:
        step = 1.0 if nominal_mm > SOLD_MM[-1] else 10.0 ** (floor(log10(nominal_mm)) - 1)
        return tuple(dict.fromkeys(float(f"{ceil(share * nominal_mm / step) * step:.6g}") for share in SHARES))
    larger = [diameter for diameter in SOLD_MM if diameter >= nominal_mm]
    near = [diameter for diameter in larger if diameter <= NEAR * nominal_mm]
    return tuple(near or larger[:1])


class Misfit(Enum):
    """Reasons why a pin measures nothing in a space."""

    NOWHERE = "the pin finds no place where it touches both flanks"
    DEEP = "the pin touches below a flank's end; a larger pin may do"
    HIGH = "the pin touches above a flank's end or on its tip relief; a smaller pin may do"
    ROOT = "the pin is held by the bottom of the space or by another tooth before it touches both flanks"
    HIDDEN = "the pin does not stand out of the tips beside it; a larger pin may do"


@dataclass(frozen=True, eq=False)
class Pins:
    """Pins of one diameter where they measure; space i lies between teeth i and i + 1.

    ``space`` (shape (n,)) numbers the spaces from 1; ``center_mm`` (shape (n, 2)) are the pins' centres in the gear's
    own frame; ``over_mm`` (shape (n,)) is the distance from the axis to a pin's far side, in a ring to its near side.
    ``misfits`` has the reasons why pins in the other spaces measure nothing, by the number of the space.
    """

    diameter_mm: float
    space: IndexArray
    center_mm: Array
    over_mm: Array
    misfits: dict[int, Misfit]


def pins_in_spaces(working: WorkingFlanks, diameter_mm: float, outline_mm: Array, astray_mm: float) -> Pins:
    """Pins of a diameter in all spaces of a gear with an outline (shape (n, 2)).

    ``astray_mm`` is the most that the outline may stand into the spaces because of its chords and, where the measured
    teeth are thinner than the outline's, because of that thickness.
    """
    flanks = working.flanks
    # For gears that turn less than once, spaces between two teeth.
    front = np.arange(1, flanks.count if flanks.made is None else 2 * flanks.made - 1, 2)
    both = np.stack([front, (front + 1) % flanks.count])
    center, heights, met = _resting(working, both, diameter_mm / 2.0 / working.base_cosine[both])
    sense = -1.0 if working.is_ring else 1.0
    reach = np.linalg.norm(center, axis=1)
    outwards = sense * center / reach[:, None]
    tests: dict[Misfit, Mask] = {
        Misfit.NOWHERE: ~met,
        Misfit.DEEP: np.any(heights < working.low_mm[both], axis=0),
        Misfit.HIGH: np.any(heights > working.high_mm[both], axis=0),
        Misfit.ROOT: _held(center, diameter_mm / 2.0, outline_mm, astray_mm),
        Misfit.HIDDEN: ~_stands_out(working, np.arange(front.size), center, diameter_mm / 2.0, outwards),
    }
    over = reach + sense * diameter_mm / 2.0
    failed = np.array(list(tests.values()))
    good = np.nonzero(~failed.any(axis=0))[0]
    first = failed.argmax(axis=0)
    misfits = {int(i) + 1: list(tests)[first[i]] for i in np.nonzero(failed.any(axis=0))[0]}
    return Pins(diameter_mm, good + 1, center[good], over[good], misfits)


def _resting(working: WorkingFlanks, both: IndexArray, radius: Array) -> tuple[Array, Array, Mask]:
    """Centres of pins between front and back flanks (shape (2, z)), the heights at which they touch, and whether they
    touch both.

    Pins' radii (shape (2, z)) are as flanks of the section see them.  Shapes (z, 2), (2, z) and (z,).
    """
    flanks, (front, back), (first, second) = working.flanks, both, radius
    one, other = flanks.slant.of(front), flanks.slant.of(back)
    width = np.mod(flanks.crossing_mm[back] - flanks.crossing_mm[front], flanks.curve.length_mm)
    # In a rack's space the centre is as far along and as high from both places of contact.
    lower = first * one.sine - second * other.sine
    room = (first * one.cosine + second * other.cosine) / 2.0 - width / 2.0 - lower * other.tangent / 2.0
    start_front = room / ((one.tangent + other.tangent) / 2.0)
    start_back = start_front + lower
    at_front, at_back, met = refined_crossings(
        lambda height: working.parallel(front, height, first),
        lambda height: working.parallel(back, height, second),
        start_front,
        start_back,
        AGREEMENT * flanks.rack.module_mm,
    )
    at_front, at_back = np.where(met, at_front, start_front), np.where(met, at_back, start_back)
    return working.parallel(front, at_front, first)[0], np.stack([at_front, at_back]), met


def _held(center: Array, radius: float, outline: Array, astray: float) -> Mask:
    """Whether pins are nearer to the outline than their radius, by more than the outline strays."""
    ring = shapely.linearrings(outline)
    # With a prepared ring only the part near a pin is examined.
    shapely.prepare(ring)
    return shapely.dwithin(ring, shapely.points(center), radius - 2.0 * astray)


def _stands_out(working: WorkingFlanks, space: IndexArray, center: Array, radius: float, outwards: Array) -> Mask:
    """Whether pins in spaces (numbered from 0, shape (n,)) reach farther in directions (n, 2) than the tips beside."""
    beside = working.tips_mm[(space[:, None] + np.arange(2)) % len(working.tips_mm)]
    highest = np.einsum("ntpk,nk->ntp", beside, outwards).max(axis=(1, 2))
    return np.einsum("nk,nk->n", center, outwards) + radius > highest


@dataclass(frozen=True, eq=False)
class TwoPins:
    """Pairs of spaces (numbers from 1) and the distance over, or in a ring between, their pins in mm; shape (n,)."""

    first: IndexArray
    second: IndexArray
    distance_mm: Array


def over_two_pins(working: WorkingFlanks, pins: Pins) -> TwoPins:
    """The distances over the pins (in a ring: between them) of all pairs of spaces half the teeth apart.

    Pairs whose pins measure nothing, or do not stand out of the tips as seen from each other's far side, are left out.
    Gears that turn less than once have none.
    """
    teeth = working.flanks.teeth
    row = np.full(teeth + 1, -1)
    row[pins.space] = np.arange(pins.space.size)
    first = np.arange(1, teeth // 2 + 1 if teeth % 2 == 0 else teeth + 1)
    if working.flanks.made is not None:
        first = first[:0]
    second = (first + teeth // 2 - 1) % teeth + 1
    both = np.nonzero((row[first] >= 0) & (row[second] >= 0))[0]
    return _apart(working, pins, row[first[both]], row[second[both]])


def _apart(working: WorkingFlanks, pins: Pins, numbers: IndexArray, other: IndexArray) -> TwoPins:
    sense, radius = (-1.0 if working.is_ring else 1.0), pins.diameter_mm / 2.0
    way = pins.center_mm[numbers] - pins.center_mm[other]
    length = np.linalg.norm(way, axis=1)
    outwards = sense * way / length[:, None]
    free = _stands_out(working, pins.space[numbers] - 1, pins.center_mm[numbers], radius, outwards)
    free &= _stands_out(working, pins.space[other] - 1, pins.center_mm[other], radius, -outwards)
    distance = length + sense * pins.diameter_mm
    return TwoPins(pins.space[numbers[free]], pins.space[other[free]], distance[free])
