"""A pair of gears as parts of build123d, with exact faces: no facets, and every flank one face.

``ncgear.cad.pair(ncgear.load("designs/ellipse.yaml"))`` has the parts; the extra ``build123d`` installs the library.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.extras import require
from ncgear.files.workshop.step import exact_solids, pitch_spline
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.brep.gear import geometry_of, solids_of
from ncgear.teeth.contour import CURVES_SHARE

if TYPE_CHECKING:
    from build123d import Compound, Edge

__all__ = ["pair", "pitch_curve"]


def pair(drive: Drive) -> Compound:
    """Both gears in the pose of phi1 = 0, in mm: driving axis at the origin, driven axis at x = centre distance.

    A compound with the design's name, whose children are the solids ``driving`` and ``driven``.  For two pairs in
    series, pass one of ``drive.by_stage``.  Raises the errors of the teeth, and WrongInput for shapes that only meshes
    have and where build123d is not installed.
    """
    require("build123d", "build123d", "ncgear.cad")
    from build123d import Compound, Location, Solid

    places = {Gear.DRIVING: 0.0, Gear.DRIVEN: drive.pitch.center_distance_mm}
    parts = {gear.value: Solid(solids_of(shape)[0]) for gear, (shape, _) in exact_solids(drive).items()}
    for gear, x_mm in places.items():
        parts[gear.value].label = gear.value
        parts[gear.value].location = Location((x_mm, 0.0, 0.0))
    return Compound(label=drive.design.name, children=list(parts.values()))


def pitch_curve(drive: Drive, gear: str) -> Edge:
    """The pitch curve of the ``driving`` or the ``driven`` gear in its own frame, axis at the origin, in mm.

    For gears that turn less than once it is the curve of the range.  Raises WrongInput where build123d is not
    installed.
    """
    require("build123d", "build123d", "ncgear.cad")
    from build123d import Edge
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

    spline = pitch_spline(drive.pitch.of(Gear(gear)), CURVES_SHARE * drive.chord_tolerance_mm)
    return Edge(BRepBuilderAPI_MakeEdge(geometry_of(spline, 0.0)).Edge())
