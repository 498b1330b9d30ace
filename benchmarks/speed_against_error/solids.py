"""The studies of solids: triangles against the error of the volume, and against the distance from the exact surface."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, tan

import numpy as np
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.solids.helical.helix import Hand, Helix
from ncgear.solids.helical.mesh import helical_pair
from ncgear.solids.mesh.pair import gear_solid
from ncgear.solids.plan.body import Blank
from ncgear.teeth.gear import toothed_pair
from speed_against_error.exact_gears import area_mm2
from speed_against_error.outlines import MODULE_MM, TOLERANCE_MM, circular_gear, circular_pair, even_outlines, form
from speed_against_error.study import Method, Size, Study

FACE_WIDTH_MM = 20.0
BLANK = Blank(FACE_WIDTH_MM)
HELIX = Helix(radians(15.0), FACE_WIDTH_MM, Hand.RIGHT)

TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016, 5e-4, 1.6e-4, 5e-5)
HELICAL_TOLERANCES_MM = (0.05, 0.016, TOLERANCE_MM, 0.0016)
COUNTS = (8, 16, 32, 64)
"""Fewer chords leave visible facets, up to 0.07 mm from the surface."""

ENOUGH_VOLUME = 1e-3
"""Castings and printed parts weigh what they should to a few thousandths at best."""

END_NORMAL = 0.99
"""Facets whose normal has a larger part along the axis belong to an end; those of a helix lean far less."""

SPREAD = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [0, 1, 1], [1, 0, 1], [1, 1, 0]], dtype=float)
"""Places on a facet at which its distance from the surface is taken, as weights of its corners."""

STRAIGHT, HELICAL, EVEN = "straight teeth", "helical teeth", "straight teeth, even parameters"
TOLERANCE = "tolerance in mm"


@dataclass(frozen=True, eq=False)
class Solid:
    """A mesh of the driving gear, and how far its teeth advance along the pitch circle per unit of height."""

    mesh: Trimesh
    advance: float = 0.0


TRIANGLES = Size("triangles", lambda solid: len(solid.mesh.faces))


def volume_study() -> Study:
    """The volume of a circular gear."""
    return Study(
        key="solid-volume",
        title="Volume of a solid",
        unit="share",
        reference="the section's area by Green's theorem on the closed form of a circular gear, times the face width; "
        "of helical teeth the same by Cavalieri's principle",
        methods=_methods(),
        error=volume_error,
        chosen=(STRAIGHT, TOLERANCE_MM),
        enough=ENOUGH_VOLUME,
        because="at the default tolerance the volume is right to a ten-thousandth, better than any part is cast or "
        "printed. Even parameters fill the fillets too much and the flanks too little, which cancels here but not in "
        "the surface",
        size=TRIANGLES,
    )


def surface_study() -> Study:
    """The distance of a circular gear's facets from the exact teeth."""
    return Study(
        key="solid-surface",
        title="Surface of a solid",
        unit="mm",
        reference="the closed form of a circular gear, in the transverse section, turned with the helix",
        methods=_methods(),
        error=surface_error_mm,
        chosen=(STRAIGHT, TOLERANCE_MM),
        enough=TOLERANCE_MM,
        because="facets stray no farther than the tolerance that was asked for, on straight and on helical teeth; even "
        "parameters need twice the triangles for the same",
        size=TRIANGLES,
    )


def volume_error(solid: Solid) -> float:
    """The relative error of a mesh's volume."""
    return abs(solid.mesh.volume / (area_mm2(circular_gear()) * FACE_WIDTH_MM) - 1.0)


def surface_error_mm(solid: Solid) -> float:
    """The largest distance of the facets between the ends from the gear's closed form, in the transverse section."""
    gear = circular_gear()
    corners = solid.mesh.triangles[np.abs(solid.mesh.face_normals[:, 2]) < END_NORMAL]
    places = np.concatenate([np.einsum("c,tcx->tx", weight / weight.sum(), corners) for weight in SPREAD])
    # A right-hand helix rises counter-clockwise: its places are turned back clockwise.
    turned = places[:, 2] * solid.advance / gear.pitch_radius_mm
    flat = (places[:, 0] + 1j * places[:, 1]) * np.exp(-1j * turned)
    return float(np.max(gear.distance_mm(np.column_stack([flat.real, flat.imag]))))


def _methods() -> tuple[Method, ...]:
    return (
        Method(STRAIGHT, TOLERANCE, TOLERANCES_MM, _straight, -1.0, adaptive=True),
        Method(EVEN, "chords per curve", COUNTS, _straight_even, 2.0),
        Method(HELICAL, TOLERANCE, HELICAL_TOLERANCES_MM, _helical, -1.0, adaptive=True),
    )


def _straight(tolerance: float) -> Solid:
    teeth = toothed_pair(circular_pair(), form(), tolerance)
    return _extruded((teeth.driving.outline_mm, teeth.driven.outline_mm))


def _straight_even(count: int) -> Solid:
    return _extruded(even_outlines(circular_pair(), form(), count))


def _extruded(outlines: tuple[Array, Array]) -> Solid:
    """Both gears, as a build makes them; the driving one."""
    driving, _ = (gear_solid(Gear.DRIVING, outline, BLANK, MODULE_MM, TOLERANCE_MM).mesh for outline in outlines)
    return Solid(driving)


def _helical(tolerance: float) -> Solid:
    blanks = dict.fromkeys(Gear, BLANK)
    pair = helical_pair(circular_pair(), form(), HELIX, blanks, tolerance)
    return Solid(pair.driving.mesh, tan(HELIX.angle_rad))
