"""Deviations of a measured gear, flank by flank: pitch, thickness, profile, points beside the flanks; its outline.

A flank's deviation is the deviation of its points along the exact normals, positive for metal in excess.  Its mean e
moves the flank along the pitch curve by e / cos(alpha), and so

    tooth thickness   t = e_front / cos(alpha_front) + e_back / cos(alpha_back)
    position          d = side e / cos(alpha)            in the sense of growing arc length
    single pitch      f_p = d - d of the flank before    F_p = greatest d less least d, of the flanks of one side

as ISO 1328-1 defines f_p and F_p for circular gears; here they are along the pitch curve.  The profile is a line over
the height: its rise from the lowest to the highest working place is the slope deviation, the rest on both sides of it
the form deviation, and both together, from least to greatest, the total deviation.

The outline as it was measured goes through measured points.  Between the points of a flank the deviation along the
normal is interpolated along the outline; beyond them, up to the flank's ends, it is the deviation of the nearest point.
Between flanks, at tip and root, the outline moves evenly from one flank's deviation to the other's, unless points were
measured there.  Only the middle third of a tip land counts: a flank that stands back takes the land's ends with it.
Points that stand alone are left out.  Flanks without points stay exact.
"""

from __future__ import annotations

import numpy as np
from shapely import Polygon, is_valid_reason

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.metrology.best_fit import BestFit, is_astray
from ncgear.metrology.exact_outline import FLANK_CURVE, TIP_LAND_CURVE, ExactOutline
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import as_complex, as_points, signed_area

FEWEST_OF_PROFILE = 4
"""Fewest points of a flank for its slope and form."""

LEAST_SPREAD = 0.3
"""Share of the working height that these points must cover."""


@dataclass(frozen=True, eq=False)
class FlankDeviations:
    """Deviations in mm of the 2 z made flanks (back and front flank of tooth 1, of tooth 2, ...), shape (2 z,) each.

    Unknown values are NaN: all of a flank without points, slope and form of a flank with few points.
    """

    points: IndexArray
    mean_mm: Array
    least_mm: Array
    greatest_mm: Array
    slope_mm: Array
    form_mm: Array
    position_mm: Array
    single_pitch_mm: Array

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return self.points.size // 2

    @property
    def total_mm(self) -> Array:
        """Total profile deviation of each flank: greatest less least, shape (2 z,)."""
        return self.greatest_mm - self.least_mm

    @property
    def measured(self) -> Mask:
        """Mask of flanks with points."""
        return self.points > 0

    def side(self, values: Array, front: bool) -> Array:
        """The values of one side's flanks, shape (z,)."""
        return values[int(front) :: 2]

    def largest(self, values: Array) -> float | None:
        """The value that is largest in size, None without known values."""
        known = values[np.isfinite(values)]
        return float(known[np.argmax(np.abs(known))]) if known.size else None

    def cumulative_mm(self, front: bool) -> float | None:
        """Cumulative pitch deviation F_p of one side; None where fewer than two of its flanks have points."""
        known = self.side(self.position_mm, front)
        known = known[np.isfinite(known)]
        return float(np.ptp(known)) if known.size > 1 else None


@dataclass(frozen=True, eq=False)
class GearDeviations:
    """Deviations of a measured gear: its flanks, its tooth thicknesses (shape (z,), NaN where a side is missing).

    ``beside`` counts the points on no working flank, by their place: ``root``, ``tip``, ``astray`` (bore, hub and other
    points far from the outline).
    """

    flanks: FlankDeviations
    thickness_mm: Array
    beside: dict[str, int]

    @property
    def missing_teeth(self) -> list[int]:
        """Numbers, from 1, of the teeth with a flank that has no points."""
        both = self.flanks.measured.reshape(-1, 2).all(axis=1)
        return [int(tooth) + 1 for tooth in np.flatnonzero(~both)]


def deviations(outline: ExactOutline, fit: BestFit) -> GearDeviations:
    """The deviations of a gear in its pose of best fit."""
    gear, feet = outline.gear, fit.feet
    count = 2 * gear.teeth
    counted = feet.kept(fit.counted)
    flank, error = outline.flank[counted.row], counted.distance_mm
    points = np.bincount(flank, minlength=count)
    known = points > 0
    mean = np.where(known, np.bincount(flank, error, count) / np.maximum(points, 1), np.nan)
    least, greatest = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(least, flank, error)
    np.maximum.at(greatest, flank, error)
    slope, form = _profiles(outline, flank, outline.height_mm(counted.row, counted.share), error)
    cosine = np.broadcast_to(gear.flanks.slant.cosine, gear.flanks.side.shape)[:count]
    along = mean / cosine
    position = gear.flanks.side[:count] * along
    single = position - np.roll(position, 2)
    if gear.flanks.made is not None:
        single[:2] = np.nan
    least, greatest = (np.where(known, values, np.nan) for values in (least, greatest))
    flanks = FlankDeviations(points, mean, least, greatest, slope, form, position, single)
    return GearDeviations(flanks, along[0::2] + along[1::2], _beside(outline, fit))


def _profiles(outline: ExactOutline, flank: IndexArray, height_mm: Array, error_mm: Array) -> tuple[Array, Array]:
    """Slope and form deviation of each flank, by a line of least squares over the height; shape (2 z,) each."""
    gear = outline.gear
    count = 2 * gear.teeth
    highest, lowest = (values[:count] for values in gear.sides.flank_range())
    working = highest - np.maximum(lowest, -gear.tips.met_depth_mm[:count])
    points = np.maximum(np.bincount(flank, minlength=count), 1)
    middle, mean = (np.bincount(flank, values, count) / points for values in (height_mm, error_mm))
    high, error = height_mm - middle[flank], error_mm - mean[flank]
    squares = np.bincount(flank, high * high, count)
    rise = np.bincount(flank, high * error, count) / np.maximum(squares, 1e-300)
    left = error - rise[flank] * high
    lowest, highest = np.zeros((2, count)), np.zeros((2, count))
    for row, values in enumerate((left, high)):
        np.minimum.at(lowest[row], flank, values)
        np.maximum.at(highest[row], flank, values)
    form, spread = highest - lowest
    told = (points >= FEWEST_OF_PROFILE) & (spread >= LEAST_SPREAD * working)
    return np.where(told, rise * working, np.nan), np.where(told, form, np.nan)


def _beside(outline: ExactOutline, fit: BestFit) -> dict[str, int]:
    rest = fit.feet.kept(~fit.counted & ~fit.alone)
    astray = is_astray(outline, rest)
    on_tip = (outline.part[rest.row] == TIP_LAND_CURVE) | (
        (outline.part[rest.row] == FLANK_CURVE) & (outline.height_mm(rest.row, rest.share) > 0.0)
    )
    return {
        "root": int(np.count_nonzero(~astray & ~on_tip)),
        "tip": int(np.count_nonzero(~astray & on_tip)),
        "astray": int(np.count_nonzero(astray)),
    }


ALIKE = 1e-8
"""Share of the way around: points whose feet are nearer to each other count as one, their mean; so do vertices."""


def outline_as_measured(outline: ExactOutline, fit: BestFit) -> Array:
    """The outline in mm, (n, 2), counter-clockwise, in the gear's frame; raises WrongInput where it crosses itself."""
    sound = fit.feet.kept(is_metal(outline, fit))
    place, moved = sound.place_mm, sound.distance_mm * sound.outwards
    end_place, end_moved = _flank_ends(outline, sound.row, sound.place_mm, sound.distance_mm)
    places, shifts = _in_order(
        np.concatenate([place, end_place]), np.concatenate([moved, end_moved]), ALIKE * outline.around_mm
    )
    vertex = as_complex(outline.gear.outline_mm)
    every_place = np.concatenate([outline.feet(vertex).place_mm, places])
    exact = np.concatenate([vertex, outline.at_place(places)])
    order = np.argsort(every_place, kind="stable")
    every_place, exact, period = every_place[order], exact[order], outline.around_mm
    # Of vertices that nearly coincide one is kept: a chord between them would have no direction.
    apart = np.diff(every_place, append=every_place[0] + period) > ALIKE * period
    every_place, exact = every_place[apart], exact[apart]
    shift = np.interp(every_place, places, shifts.real, period=period) + 1j * np.interp(
        every_place, places, shifts.imag, period=period
    )
    found = as_points(exact + shift)
    polygon = Polygon(found)
    if not polygon.is_valid:
        raise WrongInput(
            f"the outline through the points crosses itself ({is_valid_reason(polygon)} in mm of the gear's frame); "
            "points that follow each other along the flanks, and no faulty ones, are right"
        )
    return found[::-1].copy() if signed_area(found) < 0.0 else found


def is_metal(outline: ExactOutline, fit: BestFit) -> Mask:
    """Mask of points that the outline as measured goes through, shape (n,)."""
    feet = fit.feet
    beside_edge = (outline.part[feet.row] == TIP_LAND_CURVE) & (np.abs(feet.share - 0.5) > 1.0 / 6.0)
    return ~is_astray(outline, feet) & ~fit.alone & ~feet.at_end & ~beside_edge


def _flank_ends(outline: ExactOutline, row: IndexArray, place: Array, error: Array) -> tuple[Array, ComplexArray]:
    """Both ends of each flank's curves, and their movement: as the nearest point of that flank, or none."""
    flanks = np.flatnonzero(outline.part == FLANK_CURVE)
    rows, share = np.repeat(flanks, 2), np.tile([0.0, 1.0], flanks.size)
    ends = outline.begin_mm[rows] + share * outline.length_mm[rows]
    _, slope = outline.at(rows, share)
    outwards = -1j * outline.material * slope / np.maximum(np.abs(slope), 1e-300)
    on_flank: Mask = outline.part[row] == FLANK_CURVE
    order = np.lexsort((place[on_flank], outline.flank[row[on_flank]]))
    owner, places, errors = outline.flank[row[on_flank]][order], place[on_flank][order], error[on_flank][order]
    found = np.zeros(rows.size)
    for end, flank in enumerate(outline.flank[rows]):
        low, high = np.searchsorted(owner, [flank, flank + 1])
        if high > low:
            found[end] = np.interp(ends[end], places[low:high], errors[low:high])
    return ends, found * outwards


def _in_order(place: Array, shift: ComplexArray, alike_mm: float) -> tuple[Array, ComplexArray]:
    """Places in growing order and their shifts; shifts of places within ``alike_mm`` are averaged."""
    order = np.argsort(place, kind="stable")
    place, shift = place[order], shift[order]
    group = np.cumsum(np.append(0, np.diff(place) > alike_mm))
    count = np.bincount(group)
    real, imag = (np.bincount(group, part) / count for part in (shift.real, shift.imag))
    return np.bincount(group, place) / count, real + 1j * imag
