"""Plane areas in mm: their outlines and moments, their parallels, and the largest size that fits.

An area is one shapely polygon or several.  Its parallel is the area with its edges moved along the normal by one
distance everywhere.  Where a polygon's chords stray from a curve by a tolerance, the polygon's parallel strays from the
curve's parallel by no more.  Where one section lies within another, its parallel lies within the other's parallel.
Each edge keeps its direction, and neighbouring ones are prolonged to meet (mitred), so that moving back gives the edges
again.  In a hollow of radius r, by a distance d, the corners between prolonged edges stray by d / r of the tolerance:
less than the tolerance up to the radius of the fillets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil, floor, log10

import numpy as np
import shapely
from numpy.typing import ArrayLike
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_complex

SHARPEST = 10.0
"""A corner is prolonged by up to this many times the distance moved: corners down to 12 degrees stay corners."""

RESOLUTION, NEXT_TO_NOTHING = 1e-4, 1e-6
"""Accuracy to which the largest size is found, as a share of that size, and as a share of the largest size tried."""


class TooThick(WrongInput):
    """The process takes off or adds more along the edges than a gear has room for; ``largest_mm`` has room."""

    def __init__(self, problem: str, *, key: str = "", location: str = "", largest_mm: float = 0.0) -> None:
        super().__init__(problem, key=key, location=location)
        self.largest_mm = largest_mm


def polygons(area: BaseGeometry) -> list[Polygon]:
    """The polygons of an area, none where it is empty."""
    return [part for part in shapely.get_parts(area) if isinstance(part, Polygon) and not part.is_empty]


def rings(area: BaseGeometry) -> Iterator[Array]:
    """All outlines of an area, shape (n, 2) each, first point repeated: the material on the left."""
    for polygon in polygons(area):
        oriented = shapely.orient_polygons(polygon)
        yield from (shapely.get_coordinates(ring) for ring in (oriented.exterior, *oriented.interiors))


@dataclass(frozen=True)
class AreaMoments:
    """Area, first moment (x + i y) and polar second moment about the origin."""

    area_mm2: float
    first_mm3: complex
    polar_mm4: float


def area_moments(area: BaseGeometry) -> AreaMoments:
    """The moments of an area with its holes, by Green's theorem on its outlines; zero where it is empty."""
    found = [_moments_within(ring) for ring in rings(area)]
    size, first, polar = np.sum(found, axis=0) if found else (0.0, 0.0, 0.0)
    return AreaMoments(float(np.real(size)), complex(first), float(np.real(polar)))


def _moments_within(ring: Array) -> tuple[complex, complex, complex]:
    """Area, first and polar moment within a closed ring (shape (n, 2), first point repeated); negative clockwise.

    Edge by edge, the triangle of the origin, p and q: p x q times 1/2, (p + q)/6 and (p.p + p.q + q.q)/12.
    """
    p, q = as_complex(ring[:-1]), as_complex(ring[1:])
    across = (np.conj(p) * q).imag
    polar = np.abs(p) ** 2 + (np.conj(p) * q).real + np.abs(q) ** 2
    return complex(across.sum() / 2.0), complex((across * (p + q)).sum() / 6.0), complex((across * polar).sum() / 12.0)


def parallel(area: BaseGeometry, distance_mm: float) -> BaseGeometry:
    """The outer parallel of an area; for a negative distance the inner parallel."""
    moved = area.buffer(distance_mm, join_style="mitre", mitre_limit=SHARPEST)
    return shapely.remove_repeated_points(moved, stl_resolution_mm(area.bounds))


def stl_resolution_mm(coordinates_mm: ArrayLike) -> float:
    """Distance below which the single precision of STL files may merge two points, by the largest coordinate."""
    return 2.0 * float(np.spacing(np.float32(np.abs(coordinates_mm).max())))


def moved_inwards(section: Polygon, distance_mm: float, tolerance_mm: float, key: str) -> Polygon:
    """The inner parallel of a section; raises TooThick for ``key`` where moving it back does not give the section."""
    inner = parallel(section, -distance_mm)
    if _comes_back(section, inner, distance_mm, tolerance_mm):
        return shapely.get_parts(inner)[0]
    largest = largest_fitting(
        lambda size: _comes_back(section, parallel(section, -size), size, tolerance_mm), 0.0, distance_mm
    )
    right = said_largest(largest, "none can be taken; larger teeth are needed")
    problem = f"{distance_mm:g} mm off the edges is more than half of the thinnest part of the gear; {right}"
    raise TooThick(problem, key=key, largest_mm=largest)


def moved_outwards(section: Polygon, distance_mm: float, tolerance_mm: float, key: str) -> Polygon:
    """The outer parallel of a section; raises TooThick for ``key`` where a cutter along it leaves too much."""
    outer = parallel(section, distance_mm)
    if _leaves(section, outer, distance_mm, tolerance_mm):
        return shapely.get_parts(outer)[0]
    largest = largest_fitting(
        lambda size: _leaves(section, parallel(section, size), size, tolerance_mm), 0.0, distance_mm
    )
    right = "no kerf works; larger teeth or a larger root radius are needed"
    if largest > 0.0:
        right = f"{-floored(largest):.10g} mm, a kerf of {2.0 * floored(largest):.10g} mm, is the most"
    problem = f"a kerf of {2.0 * distance_mm:g} mm is wider than the narrowest fillet or space of the gear; {right}"
    raise TooThick(problem, key=key, largest_mm=largest)


def _leaves(section: Polygon, outer: BaseGeometry, distance: float, tolerance: float) -> bool:
    """Whether a cutter along the outer parallel leaves the section and nothing more."""
    if len(shapely.get_parts(outer)) != 1 or len(outer.interiors) != len(section.interiors):
        return False
    return bool(section.symmetric_difference(parallel(outer, -distance)).buffer(-tolerance / 2.0).is_empty)


def _comes_back(section: Polygon, inner: BaseGeometry, distance: float, tolerance: float) -> bool:
    """Whether nothing is lost: the parallel is in one piece, and its own parallel is the section."""
    if inner.is_empty or len(shapely.get_parts(inner)) != 1 or len(inner.interiors) != len(section.interiors):
        return False
    # Where a tip's land is lost, its prolonged flanks meet beyond it: added material counts as a change too.
    changed = section.symmetric_difference(parallel(inner, distance))
    return bool(changed.buffer(-tolerance / 2.0).is_empty)


def largest_fitting(fits: Callable[[float], bool], low_mm: float, high_mm: float) -> float:
    """The largest size in mm that fits between two, by bisection, ``low_mm`` not tried; 0 where no size fits."""
    fitting, least = 0.0, NEXT_TO_NOTHING * high_mm
    while high_mm - low_mm > max(RESOLUTION * high_mm, least):
        middle = (low_mm + high_mm) / 2.0
        if fits(middle):
            low_mm = fitting = middle
        else:
            high_mm = middle
    return fitting


def floored(size_mm: float) -> float:
    """A size rounded down to 0.01 mm, so that the stated size itself fits; a size below 1 mm to two digits."""
    decimals = max(2, 1 - floor(log10(size_mm))) if size_mm > 0.0 else 2
    return floor(size_mm * 10.0**decimals) / 10.0**decimals


def raised(size_mm: float) -> float:
    """A size rounded up to 0.01 mm, so that the stated size itself is enough."""
    return ceil(size_mm * 100.0) / 100.0


def said_largest(largest_mm: float, otherwise: str) -> str:
    """The end of an error message: the largest size that fits, or the other remedy where no size fits."""
    return f"the largest that fits is {floored(largest_mm):.10g} mm" if largest_mm > 0.0 else otherwise
