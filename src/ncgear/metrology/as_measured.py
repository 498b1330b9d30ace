"""The outline of a gear as it was measured: the exact outline, moved by the deviations of its points.

The outline goes through measured points.  Between the points of a flank the deviation along the normal is interpolated
along the outline; beyond them, up to the flank's ends, it is the deviation of the nearest point.  Between flanks, at
tip and root, the outline moves evenly from one flank's deviation to the other's, unless points were measured there.
Only the middle third of a tip land counts: a flank that stands back takes the land's ends with it.  Points that stand
alone are left out.  Flanks without points stay exact.
"""

from __future__ import annotations

import numpy as np
from shapely import Polygon, is_valid_reason

from ncgear.errors import WrongInput
from ncgear.metrology.best_fit import BestFit, is_astray
from ncgear.metrology.exact_outline import FLANK_CURVE, TIP_LAND_CURVE, ExactOutline
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import as_complex, as_points, signed_area

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
