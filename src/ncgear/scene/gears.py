"""The toothed gears of a scene, each on its shaft."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

import numpy as np
from shapely import Polygon
from shapely.geometry.polygon import orient

from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.scene.bodies import Body, Kind, Places
from ncgear.scene.mounting import Mounting, mountings
from ncgear.solids.body import BodyPlan
from ncgear.solids.bore import circle_points

CURVE_POINTS = 721
"""Points of a drawn pitch curve: one every half degree of the driving angle."""


@dataclass(frozen=True, eq=False)
class SceneGear:
    """A gear as it is seen, its shaft's number from the driving one on, and its closed pitch curve in mm, (n, 2)."""

    body: Body
    gear: Gear
    shaft: int
    mounting: Mounting
    pitch_curve_mm: Array

    @property
    def axis_mm(self) -> tuple[float, float]:
        """Where it turns."""
        return self.mounting.axis_mm(self.gear)

    def places(self, shaft_angles_rad: Array) -> Places:
        """Where it is when all shafts, shape (shafts, n), have turned by angles in rad."""
        angle = self.mounting.turn_rad + self.mounting.sense(self.gear) * shaft_angles_rad[self.shaft]
        return Places(np.tile(self.axis_mm, (angle.size, 1)), angle)


@dataclass(frozen=True, eq=False)
class ScenePair:
    """Two gears in mesh; ``shaft`` is the number of the driving one's."""

    pitch: PitchPair
    module_mm: float
    mounting: Mounting
    driving: SceneGear
    driven: SceneGear

    @property
    def shaft(self) -> int:
        """Number of the driving gear's shaft."""
        return self.driving.shaft

    def pitch_point_mm(self, shaft_angles_rad: Array) -> Array:
        """Where the pitch curves touch, shape (n, 2)."""
        return self.mounting.on_centres_mm(self.pitch.pitch_point_mm(shaft_angles_rad[self.shaft]))


def scene_pairs(drive: Drive) -> tuple[ScenePair, ...]:
    """The pairs of a drive from the driving shaft on, each found to mesh; none where its design has no gears.

    Raises WrongInput and NoSuchMechanism as the teeth do.
    """
    gears = drive.design.gears
    if gears is None:
        return ()
    pitches = [pair.pitch for pair in drive.by_stage]
    distances = [pitch.center_distance_mm for pitch in pitches]
    found = mountings([pitch.mesh for pitch in pitches], distances, radians(gears.driving_axis_deg))
    placed = zip(drive.by_stage, found, strict=True)
    return tuple(_pair(pair, number, mounting) for number, (pair, mounting) in enumerate(placed))


def _pair(drive: Drive, number: int, mounting: Mounting) -> ScenePair:
    drive.require_sound_teeth()
    driving, driven = (_gear(drive, gear, number, mounting) for gear in Gear)
    return ScenePair(drive.pitch, drive.pitch.size.module_mm, mounting, driving, driven)


def _gear(drive: Drive, gear: Gear, number: int, mounting: Mounting) -> SceneGear:
    name = gear.value if drive.stage is None else f"{gear.value}-{drive.stage}"
    plan = drive.solids.of(gear).plan
    edges = tuple(mounting.seen(edge) for edge in _edges(plan))
    body = Body(name, Kind(gear.value), _seen(plan.section, mounting), edges)
    curve = drive.pitch.of(gear)
    points = curve.at_angle(np.linspace(0.0, curve.turn_rad, CURVE_POINTS)).position
    return SceneGear(body, gear, number + (gear is Gear.DRIVEN), mounting, mounting.seen(points))


def _edges(plan: BodyPlan) -> list[Array]:
    """Pockets and hub as they are seen on the upper face."""
    pockets = plan.web.pockets if plan.web else ()
    rings = [ring for pocket in pockets for ring in (pocket.exterior, *pocket.interiors)]
    hub = [circle_points(plan.hub.diameter_mm / 2.0, plan.chord_tolerance_mm)] if plan.hub else []
    return [np.asarray(ring.coords)[:-1] for ring in rings] + hub


def _seen(section: Polygon, mounting: Mounting) -> tuple[Array, ...]:
    """The contours of a section as they are seen, the outer one first and counter-clockwise."""
    rings = section.exterior, *section.interiors
    seen = [mounting.seen(np.asarray(ring.coords)) for ring in rings]
    whole = orient(Polygon(seen[0], seen[1:]))
    return tuple(np.asarray(ring.coords)[:-1] for ring in (whole.exterior, *whole.interiors))
