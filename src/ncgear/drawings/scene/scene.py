"""The scene of a drive: all moving and standing parts of a machine, and their places at any driving angle.

The frame is the frame of the mechanism: the crank's axis is at the origin, the slider moves along +x, and the crank
turns clockwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from math import gcd, pi

import numpy as np

from ncgear.design.keys.machine import Resistance
from ncgear.drawings.scene import bodies
from ncgear.drawings.scene.geared_pairs import SceneGear, ScenePair, scene_pairs, teeth_alone
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine, OutputMotion
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import turned
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import PairsInSeries


@dataclass(frozen=True, eq=False)
class ScenePoses:
    """The places of all parts at n driving angles.

    ``shaft_angles_rad`` (shape (shafts, n)) are the angles by which the shafts have turned, from the driving shaft to
    the crank's.  ``places`` has the places of each body by its name, ``pitch_points_mm`` (shape (n, 2) each) the pitch
    point of each pair.  ``material_mm`` (shape (n,)) is the depth of the material before the chamber's end,
    ``material_behind_mm`` the depth of the material behind the slider.
    """

    motion: OutputMotion
    shaft_angles_rad: Array
    places: Mapping[str, bodies.BodyPlaces]
    pitch_points_mm: tuple[Array, ...]
    material_mm: Array
    material_behind_mm: Array


SWEEP = 73
"""Crank angles of a cycle whose link positions give the box of a view."""


@dataclass(frozen=True, eq=False)
class Scene:
    """All visible parts of a machine; ``pairs`` are in their order from the driving shaft, and empty without gears."""

    name: str
    machine: Machine
    train: PairsInSeries
    pairs: tuple[ScenePair, ...]
    chamber: bodies.Chamber | None

    @property
    def swings(self) -> bool:
        """Whether the gears turn to and fro, less than once."""
        return not self.machine.transmission.lobes.repeats

    def evenly_in_time(self, count: int) -> Array:
        """Driving angles in rad of a number of frames, shape (n,), over the loop without its end, or forth and back."""
        share = np.linspace(0.0, 1.0, count, endpoint=False)
        return self.loop_rad * (1.0 - np.abs(1.0 - 2.0 * share) if self.swings else share)

    @property
    def loop_rad(self) -> float:
        """Least driving angle after which every body is back in its pose and every gear has made whole turns.

        For gears that turn less than once, the driving angle from one end to the other, where they turn back.
        """
        lobes = self.machine.transmission.lobes
        if self.swings:
            return lobes.driving_period_rad
        return 2.0 * pi * lobes.driven / gcd(lobes.driving, lobes.driven)

    @cached_property
    def links(self) -> tuple[bodies.Body, ...]:
        """The output, the crank, and the links between them from back to front; none for a shaft by itself."""
        linkage = self.machine.linkage
        names = list(linkage.links(Jet(np.zeros((1, 1)))))
        if not names:
            return ()
        output, *others = names
        made = [bodies.Body(output, bodies.BodyKind.SLIDER, bodies.output_shape(linkage, self.chamber))]
        for name in others:
            crank = name == "crank"
            contours = bodies.crank_shape(linkage) if crank else bodies.link_shape(linkage, name)
            made.append(bodies.Body(name, bodies.BodyKind.CRANK if crank else bodies.BodyKind.ROD, contours))
        return tuple(made)

    @cached_property
    def swept_mm(self) -> Mapping[str, Array]:
        """The outer contours of the links at SWEEP angles of a cycle, by their names, shape (SWEEP, n, 2) each."""
        driven = self.machine.transmission.driven_angle(np.array([self.machine.transmission.cycle_rad])).value[0]
        places = self._link_places(np.linspace(0.0, driven, SWEEP))
        found = {}
        for body in self.links:
            at = places[body.name]
            found[body.name] = turned(body.contours_mm[0], at.angle_rad[:, None]) + at.origin_mm[:, None, :]
        return found

    @property
    def gears(self) -> tuple[SceneGear, ...]:
        """All gears, from the driving shaft on."""
        return tuple(gear for pair in self.pairs for gear in (pair.driving, pair.driven))

    @property
    def crank_is_behind(self) -> bool:
        """Whether the gears are drawn over the crank: they are if they are smaller, so that both are visible."""
        return bool(self.pairs) and self.pairs[-1].driven.body.reach_mm < self.machine.linkage.crank_mm

    @property
    def axes_mm(self) -> tuple[tuple[float, float], ...]:
        """The places of the shafts' axes, from the driving shaft to the crank's."""
        return (*(pair.mounting.driving_axis_mm for pair in self.pairs), (0.0, 0.0))

    def shaft_angles_rad(self, phi1_rad: Array) -> Array:
        """The angles in rad by which the shafts have turned, each in its own direction, at driving angles (n,).

        The shape is (shafts, n).
        """
        angles = [phi1_rad]
        for pair in self.train.pairs[:-1]:
            angles.append(pair.transmission.driven_angle(angles[-1]).value)
        return np.stack([*angles, self.train.whole.driven_angle(phi1_rad).value])

    def poses(self, phi1_rad: Array) -> ScenePoses:
        """The places of all parts at driving angles in rad, shape (n,), over any number of turns."""
        angles, motion = self.shaft_angles_rad(phi1_rad), self.machine.motion(phi1_rad)
        gears = {gear.body.name: gear.places(angles) for gear in self.gears}
        working = self.machine.working(motion.phi2_rad)
        return ScenePoses(
            motion,
            angles,
            {**gears, **self._link_places(angles[-1])},
            tuple(pair.pitch_point_mm(angles) for pair in self.pairs),
            *self._material_mm(motion.displacement, working),
        )

    def strips_mm(self, poses: ScenePoses) -> dict[str, tuple[Array, Array]]:
        """Left end and length of the material in front of the slider and behind it, shape (n,) each; only if present.

        A carton that is pushed along keeps its length.
        """
        chamber, found = self.chamber, dict[str, tuple[Array, Array]]()
        if chamber is not None and chamber.begins_mm is not None:
            depth, pushed = poses.material_mm, chamber.pushed_mm
            length = depth if pushed is None else np.full_like(depth, pushed)
            found["material"] = chamber.end_mm - depth, length
        if chamber is not None and chamber.behind_mm is not None:
            behind = poses.material_behind_mm
            found["material-behind"] = np.full_like(behind, chamber.start_mm), behind
        return found

    def _material_mm(self, displacement_mm: Array, working: Mask) -> tuple[Array, Array]:
        if self.chamber is None:
            return np.zeros_like(displacement_mm), np.zeros_like(displacement_mm)
        found = self.chamber.material_mm, self.chamber.material_behind_mm
        before, behind = (depth(displacement_mm, working) for depth in found)
        return before, behind

    def _link_places(self, phi2_rad: Array) -> dict[str, bodies.BodyPlaces]:
        return {
            name: bodies.BodyPlaces(np.stack([link.origin.x.value, link.origin.y.value], axis=-1), link.angle.value)
            for name, link in self.machine.linkage.links(Jet(phi2_rad[None, :])).items()
        }


def scene_of(drive: Drive) -> Scene:
    """The scene of a drive, with all pairs of gears of the design; it is not checked whether their teeth mesh.

    Raises WrongInput or NoSuchMechanism where law, pitch curves or teeth cannot be made.
    """
    return replace(scene_without_gears(drive), pairs=scene_pairs(drive))


def scene_of_teeth(drive: Drive) -> Scene:
    """The scene of a drive with gears without bore and holes, as soon as their teeth are known."""
    return replace(scene_without_gears(drive), pairs=scene_pairs(drive, teeth_alone))


def scene_without_gears(drive: Drive) -> Scene:
    """The scene of a drive's mechanism only; raises WrongInput or NoSuchMechanism where its law cannot be made."""
    machine, asked = drive.machine, drive.design.resistance
    chamber = bodies.chamber_of(
        drive.linkage, machine.load, asked.shown_as if isinstance(asked, Resistance) else "load"
    )
    return Scene(drive.design.name, machine, drive.law.train, (), chamber)
