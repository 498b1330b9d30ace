"""A gear's section as a polygon: the disc inside its tooth outline, and its room for the bore."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely import Polygon

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.bore import Bore, bore_points
from ncgear.solids.largest import largest_fitting, said_largest
from ncgear.teeth.soundness import simple_polygon


def disc_with_room(outline_mm: Array, bore: Bore | None, chord_tolerance_mm: float, key: str) -> Polygon:
    """The full disc inside a tooth outline (mm, shape (n, 2)), known to have room for the bore.

    ``key`` (``gears.driving``) names the gear in errors: NoSuchMechanism where the outline crosses itself, WrongInput
    when the bore does not fit.
    """
    disc = full_disc(outline_mm, key)
    if bore is not None:
        require_room(disc, bore, chord_tolerance_mm, key)
    return disc


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


def require_room(disc: Polygon, bore: Bore, chord_tolerance_mm: float, key: str, clearance_mm: float = 0.0) -> None:
    """Raise WrongInput for ``key``.bore_mm unless bore and keyway leave a wall of one chord tolerance everywhere.

    They are widened by the clearance first.  The message states the largest bore that fits.
    """
    if _has_room(disc, bore.widened(clearance_mm), chord_tolerance_mm):
        return
    largest = largest_bore_mm(disc, bore, chord_tolerance_mm, clearance_mm)
    cut = "a bore" if bore.keyway is None else "a bore with this keyway"
    right = said_largest(largest, "none fits; a larger gear is needed")
    problem = f"{cut} of {bore.diameter_mm:g} mm reaches the tooth outline; {right}"
    raise WrongInput(problem, key=f"{key}.bore_mm")


def largest_bore_mm(disc: Polygon, bore: Bore, chord_tolerance_mm: float, clearance_mm: float = 0.0) -> float:
    """Largest diameter in mm, up to ``bore``'s own, at which it fits with the same keyway; 0 when none does.

    A bore lies within every larger one with the same keyway, so that what fits is one interval.
    """

    def fits(diameter: float) -> bool:
        return _has_room(disc, replace(bore, diameter_mm=diameter).widened(clearance_mm), chord_tolerance_mm)

    return largest_fitting(fits, bore.keyway.width_mm if bore.keyway else 0.0, bore.diameter_mm)


def _has_room(disc: Polygon, bore: Bore, wall: float) -> bool:
    # The true circle bulges beyond its inscribed polygon by up to one chord tolerance, hence twice the wall.
    cut = Polygon(bore_points(bore, wall))
    return bool(disc.contains(cut) and cut.distance(disc.exterior) >= 2.0 * wall)
