"""A gear corrected by holes, by a boss, or by holes first and a boss for what they leave; judged by its mesh."""

from __future__ import annotations

from dataclasses import dataclass

from shapely import Polygon
from trimesh import Trimesh

from ncgear.balance.boss import Boss, balancing_boss
from ncgear.balance.drilling import Drills, drilled, drilled_holes
from ncgear.balance.gear_body import GearBody, mesh_body
from ncgear.solids.body import Layer
from ncgear.solids.inertia import area_moments
from ncgear.solids.layered import layered
from ncgear.solids.round_hole import RoundHole

BALANCED = 1e-9
"""Share of area to the power 3/2 below which a first moment is rounding error, and no boss has a direction."""


@dataclass(frozen=True)
class BossSize:
    """Height of a boss over the face and its wall to every edge, in mm."""

    height_mm: float
    wall_mm: float


@dataclass(frozen=True)
class Means:
    """What may be done to a gear."""

    drills: Drills | None = None
    boss: BossSize | None = None


@dataclass(frozen=True, eq=False)
class Corrected:
    """The gear with its corrections: its holes and boss, the mesh, and what the mesh's own integrals say of it."""

    holes: list[RoundHole]
    boss: Boss | None
    mesh: Trimesh
    body: GearBody


def corrected(
    section: Polygon, face_width_mm: float, density_kg_m3: float, means: Means, tolerance_mm: float, key: str
) -> Corrected:
    """A straight gear, its section in mm, brought to balance about the origin as far as the means go.

    ``tolerance_mm`` is that of the holes' chords; ``key`` names the means in errors.  Raises NoSuchMechanism where a
    hole or a boss has no room, or the boss is too low.
    """
    holes, boss = [], None
    if means.drills is not None:
        holes = drilled_holes(section, area_moments(section).first_mm3, means.drills, f"{key}.holes")
        section = drilled(section, holes, tolerance_mm)
    moment = area_moments(section).first_mm3 * face_width_mm
    if means.boss is not None and abs(moment) > BALANCED * section.area**1.5 * face_width_mm:
        boss = balancing_boss(section, moment, means.boss.height_mm, means.boss.wall_mm, f"{key}.boss.height_mm")
    gear = Layer(section, 0.0, face_width_mm)
    mesh = layered((gear, *([Layer(boss.section, face_width_mm, face_width_mm + boss.height_mm)] if boss else [])))
    return Corrected(holes, boss, mesh, mesh_body(mesh, density_kg_m3))
