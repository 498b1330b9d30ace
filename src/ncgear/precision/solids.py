"""Studies of solids: triangles against the error of the volume, and against the distance from the exact surface."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import radians, tan

import numpy as np
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.precision import teeth_pairs
from ncgear.precision.circular_area import area_mm2
from ncgear.precision.circular_gear import CircularGear
from ncgear.precision.even_outline import even_outlines
from ncgear.precision.study import Method, Size, Study
from ncgear.precision.teeth_pairs import MODULE_MM, TEETH, TOLERANCE_MM
from ncgear.solids.helical.helix import Hand, Helix
from ncgear.solids.helical.mesh import helical_pair
from ncgear.solids.mesh.pair import driving_solid
from ncgear.solids.plan.body import Blank
from ncgear.teeth.gear import toothed_pair

FACE_WIDTH_MM = 20.0
BLANK = Blank(FACE_WIDTH_MM)
HELIX = Helix(radians(15.0), FACE_WIDTH_MM, Hand.RIGHT)

TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016, 5e-4, 1.6e-4, 5e-5)
HELICAL_TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016)
COUNTS = (8, 16, 32, 64)
"""Fewer chords leave a surface that is seen to be faceted, 0.07 mm astray."""

ENOUGH = 1e-3
"""Of the volume: castings and printed parts weigh what they should to a few thousandths at best."""

ENDS = 0.99
"""Part along the axis of the normal of a facet, from which on it belongs to an end; a helix leans by far less."""

SPREAD = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [0, 1, 1], [1, 0, 1], [1, 1, 0]], dtype=float)
"""Places on a facet at which its distance from the surface is taken, as weights of its corners."""

STRAIGHT, HELICAL, EVEN = "straight teeth", "helical teeth", "straight teeth, even parameters"
TOLERANCE = "tolerance in mm"


@dataclass(frozen=True, eq=False)
class Solid:
    """A mesh of the driving gear, and how far its teeth advance along the pitch circle per unit of height."""

    mesh: Trimesh
    advance: float = 0.0


def volume() -> Study:
    """Relative error of a circular gear's volume."""
    return Study(
        key="solid-volume",
        title="Volume of a solid",
        unit="share",
        reference="the section's area by Green's theorem on the closed form of a circular gear, times the face width; "
        "of helical teeth the same by Cavalieri's principle",
        methods=_methods(),
        error=volume_error,
        chosen=(STRAIGHT, TOLERANCE_MM),
        enough=ENOUGH,
        because="at the default tolerance the volume is right to a ten-thousandth, better than any part is cast or "
        "printed. Even parameters fill the fillets too much and the flanks too little, which cancels here but not in "
        "the surface",
        size=_TRIANGLES,
    )


def surface() -> Study:
    """Distance of a circular gear's facets from the exact teeth."""
    return Study(
        key="solid-surface",
        title="Surface of a solid",
        unit="mm",
        reference="the closed form of a circular gear, in the transverse section, turned with the helix",
        methods=_methods(),
        error=largest_distance_mm,
        chosen=(STRAIGHT, TOLERANCE_MM),
        enough=TOLERANCE_MM,
        because="facets stray no farther than the tolerance that was asked for, on straight and on helical teeth; even "
        "parameters need twice the triangles for the same",
        size=_TRIANGLES,
    )


_TRIANGLES = Size("triangles", lambda solid: len(solid.mesh.faces))


@cache
def gear() -> CircularGear:
    """The closed form."""
    return CircularGear(TEETH, teeth_pairs.rack())


def volume_error(solid: Solid) -> float:
    """Relative difference of a mesh's volume from the gear's, either way."""
    return abs(float(solid.mesh.volume) / (area_mm2(gear()) * FACE_WIDTH_MM) - 1.0)


def largest_distance_mm(solid: Solid) -> float:
    """Of the facets of a mesh between its ends from the gear's closed form, in the transverse section."""
    corners = np.asarray(solid.mesh.triangles)[np.abs(solid.mesh.face_normals[:, 2]) < ENDS]
    places = np.concatenate([np.einsum("c,tcx->tx", weight / weight.sum(), corners) for weight in SPREAD])
    turned = places[:, 2] * solid.advance / gear().pitch_radius_mm
    return float(np.max(gear().distance_mm(_turned_back(places[:, :2], turned))))


def _turned_back(places: Array, angle: Array) -> Array:
    """Places, shape (n, 2), turned clockwise by angles: a right-hand helix rises counter-clockwise."""
    turned = (places[:, 0] + 1j * places[:, 1]) * np.exp(-1j * angle)
    return np.column_stack([turned.real, turned.imag])


def _methods() -> tuple[Method, ...]:
    return (
        Method(STRAIGHT, TOLERANCE, TOLERANCES_MM, _straight, -1.0, adaptive=True),
        Method(EVEN, "chords per curve", COUNTS, _evenly, 2.0),
        Method(HELICAL, TOLERANCE, HELICAL_TOLERANCES_MM, _helical, -1.0, adaptive=True),
    )


def _straight(tolerance: float) -> Solid:
    teeth = toothed_pair(teeth_pairs.circular(), teeth_pairs.form(), tolerance)
    return _extruded((teeth.driving.outline_mm, teeth.driven.outline_mm))


def _evenly(count: int) -> Solid:
    return _extruded(even_outlines(teeth_pairs.circular(), teeth_pairs.form(), count))


def _extruded(outlines: tuple[Array, Array]) -> Solid:
    """Both gears, as a build makes them; the driving one."""
    driving, _ = (driving_solid(outline, BLANK, MODULE_MM, TOLERANCE_MM).mesh for outline in outlines)
    return Solid(driving)


def _helical(tolerance: float) -> Solid:
    blanks = dict.fromkeys(Gear, BLANK)
    pair = helical_pair(teeth_pairs.circular(), teeth_pairs.form(), HELIX, blanks, tolerance)
    return Solid(pair.driving.mesh, tan(HELIX.angle_rad))
