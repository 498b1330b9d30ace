"""The pairs of gears of a scene, each at its place in the machine, and each gear on its shaft.

In the frame of a pair, the driving axis is at (0, 0), the driven axis at (a, 0), and the driving gear turns
counter-clockwise.  In the frame of the scene, the frame of the mechanism, the crank's axis is at the origin, the slider
moves along +x, and the crank turns clockwise.  The driven gear of the last pair turns with the crank.  So this pair is
viewed from the side on which its driven gear turns clockwise: an external pair from the front, an internal pair from
behind.  Each earlier pair is viewed from the side on which the shaft that it shares with the next pair turns in the
same direction.  All axes are on one line.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, sin

import numpy as np
from shapely import Polygon

from ncgear.drawings.scene.bodies import Body, BodyKind, BodyPlaces
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.project.drive import Drive
from ncgear.project.tooth_form import driving_axes_rad
from ncgear.solids.plan.areas import rings
from ncgear.solids.plan.body import BodyPlan, circle_points

CRANK_SENSE = -1.0
"""The crank turns clockwise."""


@dataclass(frozen=True)
class Mounting:
    """The place of one pair in the frame of the mechanism.

    ``turn_rad`` is the direction from the driving axis to the driven axis.  ``hand`` is -1 for a pair viewed from
    behind, whose own y axis then points the other way; otherwise it is 1.
    """

    mesh: Mesh
    driving_axis_mm: tuple[float, float]
    driven_axis_mm: tuple[float, float]
    turn_rad: float
    hand: float

    def axis_mm(self, gear: Gear) -> tuple[float, float]:
        """The axis of one of the gears."""
        return self.driving_axis_mm if gear is Gear.DRIVING else self.driven_axis_mm

    def sense(self, gear: Gear) -> float:
        """The direction in which one of the gears turns: +1 counter-clockwise, -1 clockwise."""
        return self.hand if gear is Gear.DRIVING else self.hand * self.mesh.sense

    def seen(self, points_mm: Array) -> Array:
        """Points of a gear's own frame (shape (n, 2)) in the view of the scene, before the gear turns."""
        return points_mm * np.array([1.0, self.hand])

    def on_centres_mm(self, distance_mm: Array) -> Array:
        """Points (n, 2) on the line of centres, at distances (n,) from the driving axis towards the driven axis."""
        along = np.array([cos(self.turn_rad), sin(self.turn_rad)])
        return np.array(self.driving_axis_mm) + distance_mm[:, None] * along


def mountings(
    meshes: Sequence[Mesh], center_distances_mm: Sequence[float], driving_axes_rad: Sequence[float]
) -> list[Mounting]:
    """The mountings of pairs in series, in their order; the last pair turns the crank.

    ``driving_axes_rad`` are the directions from the driven to the driving axis of each pair, counter-clockwise from +x.
    """
    made: list[Mounting] = []
    sense, axis = CRANK_SENSE, (0.0, 0.0)
    from_last = zip(reversed(meshes), reversed(center_distances_mm), reversed(driving_axes_rad), strict=True)
    for mesh, distance, direction in from_last:
        before = axis[0] + distance * cos(direction), axis[1] + distance * sin(direction)
        made.insert(0, Mounting(mesh, before, axis, direction - pi, sense * mesh.sense))
        sense, axis = sense * mesh.sense, before
    return made


NUMBER_DEPTH = 2.2
"""Depth of a tooth's number below the pitch curve in modules, under its root."""

CURVE_POINTS = 721
"""Points of a drawn pitch curve: one every half degree of the driving angle."""


@dataclass(frozen=True, eq=False)
class SceneGear:
    """A gear in the view of the scene, the number of its shaft (0 is the driving shaft), and its closed pitch curve.

    The curve is in mm, shape (n, 2).  Where gears turn less than once, straight sides to the axis close it.
    ``teeth_mm`` (shape (z, 2)) are the middles of the teeth on the pitch curve, from tooth 1 on.  ``numbers_mm`` are
    the places of their numbers, below the roots.
    """

    body: Body
    gear: Gear
    shaft: int
    mounting: Mounting
    pitch_curve_mm: Array
    teeth_mm: Array
    numbers_mm: Array

    @property
    def axis_mm(self) -> tuple[float, float]:
        """The place of its axis."""
        return self.mounting.axis_mm(self.gear)

    @property
    def facing_rad(self) -> float:
        """Angle from the direction of the mate's axis to the direction of the pitch point: 0, or pi in a ring's pair.

        In an internal pair the pitch point lies beyond the driving axis, seen from the driven axis.
        """
        own = meeting_direction_rad(self.gear, self.mounting.mesh)
        return own if self.gear is Gear.DRIVING else own - pi

    def places(self, shaft_angles_rad: Array) -> BodyPlaces:
        """The places of the gear when the shafts have turned by angles in rad, shape (shafts, n)."""
        angle = self.mounting.turn_rad + self.mounting.sense(self.gear) * shaft_angles_rad[self.shaft]
        return BodyPlaces(np.tile(self.axis_mm, (angle.size, 1)), angle)


@dataclass(frozen=True, eq=False)
class ScenePair:
    """Two gears in mesh."""

    pitch: PitchPair
    module_mm: float
    mounting: Mounting
    driving: SceneGear
    driven: SceneGear

    @property
    def shaft(self) -> int:
        """Number of the driving gear's shaft; 0 is the shaft that drives the machine."""
        return self.driving.shaft

    def pitch_point_mm(self, shaft_angles_rad: Array) -> Array:
        """The points in mm where the pitch curves touch, shape (n, 2)."""
        return self.mounting.on_centres_mm(self.pitch.pitch_point_mm(shaft_angles_rad[self.shaft]))


GearShape = tuple[Polygon, list[Array]]
"""The section of a gear in its own frame, and the edges visible on its upper face."""


def whole_body(drive: Drive, gear: Gear) -> GearShape:
    """One gear of a drive with its bore, holes and hub; raises as the drive's solids do."""
    plan = drive.solids.of(gear).plan
    return plan.section, _edges(plan)


def teeth_alone(drive: Drive, gear: Gear) -> GearShape:
    """One gear of a drive without bore and holes, which takes a tenth of the time; for a ring the whole body."""
    if gear is Gear.DRIVEN and drive.pitch.driven.is_ring:
        return whole_body(drive, gear)
    return Polygon(drive.teeth.of(gear).outline_mm), []


def scene_pairs(drive: Drive, shape: Callable[[Drive, Gear], GearShape] = whole_body) -> tuple[ScenePair, ...]:
    """The pairs of a drive from the driving shaft on; none where its design has no gears.

    ``shape`` gives the visible shape of each gear.  The contact of the teeth is not checked.  Raises WrongInput or
    NoSuchMechanism where the teeth cannot be made.
    """
    gears = drive.design.gears
    if gears is None:
        return ()
    pitches = [pair.pitch for pair in drive.by_stage]
    distances = [pitch.center_distance_mm for pitch in pitches]
    found = mountings([pitch.mesh for pitch in pitches], distances, driving_axes_rad(gears, len(pitches)))
    pairs = []
    for number, (pair, mounting) in enumerate(zip(drive.by_stage, found, strict=True)):
        driving, driven = (_gear(pair, gear, number, mounting, *shape(pair, gear)) for gear in Gear)
        pairs.append(ScenePair(pair.pitch, pair.pitch.size.module_mm, mounting, driving, driven))
    return tuple(pairs)


def _gear(drive: Drive, gear: Gear, number: int, mounting: Mounting, section: Polygon, edges: list[Array]) -> SceneGear:
    name = gear.value if drive.stage is None else f"{gear.value}-{drive.stage}"
    outer, *holes = (mounting.seen(ring) for ring in rings(section))
    # The outer contour comes first and counter-clockwise
    contours = tuple(ring[:-1] for ring in rings(Polygon(outer, holes)))
    body = Body(name, BodyKind(gear.value), contours, tuple(map(mounting.seen, edges)))
    points = drive.pitch.of(gear).drawn(CURVE_POINTS).position
    if drive.pitch.toothed is not None:
        # The straight sides from both ends to the axis lie on the line of centres at the end stops.
        points = np.vstack([points, np.zeros((1, 2))])
    flanks = drive.teeth.of(gear).flanks
    back, front = flanks.crossing_mm[: 2 * flanks.teeth].reshape(-1, 2).T
    middle = flanks.curve.at_length((back + front) / 2.0)
    below = middle.position - NUMBER_DEPTH * drive.pitch.size.module_mm * middle.normal
    shaft = number + (gear is Gear.DRIVEN)
    return SceneGear(body, gear, shaft, mounting, *map(mounting.seen, (points, middle.position, below)))


def _edges(plan: BodyPlan) -> list[Array]:
    pockets = plan.web.pockets if plan.web else ()
    edges = [ring for pocket in pockets for ring in (pocket.exterior, *pocket.interiors)]
    hub = [circle_points(plan.hub.diameter_mm / 2.0, plan.chord_tolerance_mm)] if plan.hub else []
    return [np.asarray(ring.coords)[:-1] for ring in edges] + hub
