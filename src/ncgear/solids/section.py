"""A gear's section as a polygon: the disc inside its tooth outline, the room for the bore, and what is cut out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely import Polygon

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.bore import Bore, bore_points
from ncgear.solids.index_hole import IndexHole, hole_points
from ncgear.teeth.soundness import simple_polygon

BISECTIONS = 50
"""Halvings in the search for the largest bore: far below any chord tolerance."""


def disc_with_room(outline_mm: Array, bore: Bore | None, chord_tolerance_mm: float, key: str) -> Polygon:
    """The full disc inside a tooth outline (mm, shape (n, 2)), known to have room for the bore.

    ``key`` (``gears.driving``) names the gear in errors: NoSuchMechanism where the outline crosses itself, WrongInput
    when the bore does not fit.
    """
    disc = full_disc(outline_mm, key)
    if bore is not None:
        require_room(disc, bore, chord_tolerance_mm, key)
    return disc


def cut(disc: Polygon, bore: Bore | None, mark: IndexHole | None, chord_tolerance_mm: float) -> Polygon:
    """The disc without bore, keyway and index hole; these must lie apart from each other and from the outline."""
    holes = []
    if bore is not None:
        holes.append(bore_points(bore, chord_tolerance_mm))
    if mark is not None:
        holes.append(hole_points(mark, chord_tolerance_mm))
    return Polygon(disc.exterior, holes)


def full_disc(outline_mm: Array, key: str) -> Polygon:
    """The full disc inside a tooth outline (mm, shape (n, 2)).

    Raises NoSuchMechanism for ``key`` (``gears.driving``), naming the place, where the outline crosses itself.
    """
    return simple_polygon(_distinct(outline_mm), key)


def common_disc(outlines_mm: Sequence[Array], key: str) -> Polygon:
    """What all sections of a gear have in common around its axis; outlines of shape (n, 2) each, ``key`` as above."""
    common = shapely.intersection_all([full_disc(outline, key) for outline in outlines_mm])
    return max(shapely.get_parts(common), key=lambda part: part.area)


def _distinct(outline: Array) -> Array:
    """Without points so close to the one before that the single precision of STL files could merge the two."""
    step = 2.0 * float(np.spacing(np.float32(np.abs(outline).max())))
    gap = outline - np.roll(outline, 1, axis=0)
    return outline[np.hypot(gap[:, 0], gap[:, 1]) > step]


def require_room(disc: Polygon, bore: Bore, chord_tolerance_mm: float, key: str) -> None:
    """Raise WrongInput for ``key``.bore_mm unless bore and keyway leave a wall of one chord tolerance everywhere.

    The message states the largest bore that fits.
    """
    if _has_room(disc, bore, chord_tolerance_mm):
        return
    largest = largest_bore_mm(disc, bore, chord_tolerance_mm)
    cut = "a bore" if bore.keyway is None else "a bore with this keyway"
    right = (
        f"the largest that fits is {_floored(largest):g} mm" if largest > 0.0 else "none fits; a larger gear is needed"
    )
    problem = f"{cut} of {bore.diameter_mm:g} mm reaches the tooth outline; {right}"
    raise WrongInput(problem, key=f"{key}.bore_mm")


def largest_bore_mm(disc: Polygon, bore: Bore, chord_tolerance_mm: float) -> float:
    """Largest diameter in mm, up to ``bore``'s own, at which it fits with the same keyway; 0 when none does.

    A bore lies within every larger one with the same keyway, so that what fits is one interval.
    """
    low = bore.keyway.width_mm if bore.keyway else 0.0
    high, fitting = bore.diameter_mm, 0.0
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        if _has_room(disc, replace(bore, diameter_mm=middle), chord_tolerance_mm):
            low = fitting = middle
        else:
            high = middle
    return fitting


def _has_room(disc: Polygon, bore: Bore, wall: float) -> bool:
    # The true circle bulges beyond its inscribed polygon by up to one chord tolerance, hence twice the wall.
    cut = Polygon(bore_points(bore, wall))
    return bool(disc.contains(cut) and cut.distance(disc.exterior) >= 2.0 * wall)


def _floored(diameter: float) -> float:
    """Rounded down to 0.01 mm, so that the stated size itself fits; smaller ones as they are."""
    return float(np.floor(diameter * 100.0) / 100.0) or diameter
