"""How pairs of gears lie in the machine: from each pair's own frame into that of the linkage.

A pair's frame has its driving axis at (0, 0) and its driven one at (a, 0), and its driving gear turns
counter-clockwise.  The linkage's frame has the crank's axis at the origin, the slider moving along +x, and the crank
turning clockwise.  The driven gear of the last pair turns with the crank, so that pair is seen from the side from
which its driven gear turns clockwise: an external pair as it is, an internal one from behind.  Pairs before it are seen
from the side on which the shaft that two pairs share turns alike.  All axes lie on one line.

The toothed gears of a scene, each on its shaft.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np
from shapely import Polygon
from shapely.geometry.polygon import orient

from ncgear.drawings.scene.bodies import Body, Kind, Places
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.drive import Drive
from ncgear.solids.plan.body import BodyPlan, circle_points

CRANK_SENSE = -1.0
"""The crank turns clockwise."""


@dataclass(frozen=True)
class Mounting:
    """Where one pair lies in the frame of the linkage.

    ``turn_rad`` is the direction of the driven axis from the driving one; ``hand`` is -1 where the pair is seen from
    behind, its own y axis pointing the other way.
    """

    mesh: Mesh
    driving_axis_mm: tuple[float, float]
    driven_axis_mm: tuple[float, float]
    turn_rad: float
    hand: float

    def axis_mm(self, gear: Gear) -> tuple[float, float]:
        """The axis of one of its gears."""
        return self.driving_axis_mm if gear is Gear.DRIVING else self.driven_axis_mm

    def sense(self, gear: Gear) -> float:
        """Sense in which one of its gears turns, counter-clockwise being +1."""
        return self.hand if gear is Gear.DRIVING else self.hand * self.mesh.sense

    def seen(self, points_mm: Array) -> Array:
        """Points of a gear's own frame as they are seen, before it is turned; shape (n, 2)."""
        seen: Array = points_mm * np.array([1.0, self.hand])
        return seen

    def on_centres_mm(self, distance_mm: Array) -> Array:
        """Points of the line of centres, so far from the driving axis towards the driven one; (n,) to (n, 2)."""
        along = np.array([cos(self.turn_rad), sin(self.turn_rad)])
        points: Array = np.array(self.driving_axis_mm) + distance_mm[:, None] * along
        return points


def mountings(meshes: Sequence[Mesh], center_distances_mm: Sequence[float], driving_axis_rad: float) -> list[Mounting]:
    """The mountings of pairs in series, the one that turns the crank last.

    ``driving_axis_rad`` is the direction from the crank's axis to the driving one's, counter-clockwise from +x.
    """
    made: list[Mounting] = []
    sense, axis = CRANK_SENSE, (0.0, 0.0)
    for mesh, distance in zip(reversed(meshes), reversed(center_distances_mm), strict=True):
        before = axis[0] + distance * cos(driving_axis_rad), axis[1] + distance * sin(driving_axis_rad)
        made.insert(0, Mounting(mesh, before, axis, driving_axis_rad - pi, sense * mesh.sense))
        sense, axis = sense * mesh.sense, before
    return made


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
