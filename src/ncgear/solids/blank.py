"""What is asked of a gear's body, before it is known what there is room for; all lengths in mm."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.solids.body import Hub
from ncgear.solids.bore import Bore


@dataclass(frozen=True)
class WebSize:
    """A web under pockets: its thickness, the least wall to the tooth roots, the diameter left about the axis."""

    thickness_mm: float
    rim_mm: float
    hub_mm: float


@dataclass(frozen=True)
class HoleSet:
    """Round holes evenly about the axis with their least wall to every edge and to each other.

    Of one diameter, the largest possible where none is given.
    """

    count: int
    wall_mm: float
    diameter_mm: float | None = None


@dataclass(frozen=True)
class Blank:
    """What makes a tooth outline a body: face width, bore, and whether an index hole is wanted, hub, web, holes.

    ``clearance_mm`` is what the process wants outline and bore moved into the material by, ``chamfer_mm`` the bevel of
    the lower edges.
    """

    face_width_mm: float
    bore: Bore | None = None
    index_hole: bool = False
    hub: Hub | None = None
    web: WebSize | None = None
    holes: HoleSet | None = None
    chamfer_mm: float = 0.0
    clearance_mm: float = 0.0
