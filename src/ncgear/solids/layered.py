"""A solid of layers that stand on each other, each of one section, as one closed mesh."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from shapely import Polygon
from trimesh import Trimesh

from ncgear.solids.bevel import Bevel
from ncgear.solids.body import Layer
from ncgear.solids.sheets import faces, joined, walls
from ncgear.solids.sound import require_sound

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
