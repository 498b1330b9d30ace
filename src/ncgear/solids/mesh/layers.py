"""The proof that a mesh is the closed solid it should be.

A solid of layers that stand on each other, each of one section, as one closed mesh.

A gear's section extruded along its axis into a solid that is known to be sound.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from shapely import Polygon
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.solids.mesh.bevel import Bevel
from ncgear.solids.mesh.sheets import faces, joined, walls
from ncgear.solids.plan.body import BodyPlan, Bore, Layer
from ncgear.solids.plan.room import disc_with_room


def require_sound(mesh: Trimesh, volume_mm3: float, tolerance: float) -> None:
    """Raise RuntimeError unless a mesh is closed, evenly wound, and of the volume given to a relative tolerance."""
    if not mesh.is_watertight:
        raise RuntimeError("a gear's mesh is not watertight")
    if not mesh.is_winding_consistent:
        raise RuntimeError("a gear's mesh has facets that face the wrong way")
    if not abs(float(mesh.volume) - volume_mm3) <= tolerance * volume_mm3:
        raise RuntimeError(f"a gear's mesh holds {mesh.volume:.9g} mm3 instead of {volume_mm3:.9g} mm3")


VOLUME_TOLERANCE = 1e-9
"""Relative difference allowed between the mesh's volume and section areas times heights: rounding only."""


def layered(layers: Sequence[Layer], bevel: Bevel | None = None) -> Trimesh:
    """The layers from the lowest up, each within the one below it; all in mm.

    A ``bevel`` is that of the first layer's section, which begins at z = 0, and lower than this layer.  The faces
    between layers are those of what ends there, so nothing lies within the body.  Raises RuntimeError if the mesh is
    not sound, a fault of ncgear.
    """
    lowest, top = layers[0], layers[-1]
    foot, slopes, start, off = (lowest.section, (), lowest.low_mm, 0.0) if bevel is None else _parts(bevel)
    sheets = [
        *faces(foot, lowest.low_mm, up=False),
        *slopes,
        *walls(lowest.section, start, lowest.high_mm),
        *(sheet for layer in layers[1:] for sheet in walls(layer.section, layer.low_mm, layer.high_mm)),
        *(sheet for below, above in pairwise(layers) for sheet in _ledges(below, above)),
        *faces(top.section, top.high_mm, up=True),
    ]
    mesh = joined(sheets)
    require_sound(mesh, sum(layer.section.area * layer.thickness_mm for layer in layers) - off, VOLUME_TOLERANCE)
    return mesh


def _parts(bevel: Bevel) -> tuple[Polygon, tuple[Trimesh, ...], float, float]:
    """Foot, slopes, where the walls begin, and the volume that is missing."""
    return bevel.foot, bevel.slopes, bevel.height_mm, bevel.below_mm3


def _ledges(below: Layer, above: Layer) -> list[Trimesh]:
    """What ends where the next layer begins."""
    return faces(below.section.difference(above.section), above.low_mm, up=True)


def gear_solid(
    outline_mm: Array, face_width_mm: float, bore: Bore | None, chord_tolerance_mm: float, *, key: str = "gears.driving"
) -> Trimesh:
    """The gear as a closed mesh in mm, in the outline's frame, z from 0 to the face width.

    ``outline_mm`` has shape (n, 2), counter-clockwise, first point not repeated; ``key`` names the gear in errors.
    Raises NoSuchMechanism where the outline crosses itself, WrongInput when the bore does not fit.
    """
    disc = disc_with_room(outline_mm, bore, chord_tolerance_mm, key)
    return extruded(BodyPlan(disc, face_width_mm, chord_tolerance_mm, bore).section, face_width_mm)


def extruded(section: Polygon, face_width_mm: float) -> Trimesh:
    """A valid section in mm, extruded from z = 0; raises RuntimeError if the mesh is not sound, a fault of ncgear."""
    return layered((Layer(section, 0.0, face_width_mm),))
