"""The teeth of one gear by plane finite elements: tables over the places where each flank is loaded.

Each tooth is loaded at ``POSITIONS`` places of each flank with 1 N per mm of face width along the flank's normal, from
the foot to the edge of the tip.  Between these places what is asked for is interpolated by the height along the tooth.

Plane strain: a face is several modules wide.  Root stresses hardly depend on that; the compliance of plane stress is
greater by 1 / (1 - nu^2), a tenth for steel.

The load of elements is a force at a point, under which displacements grow without end as meshes get finer.  So the
compliance is taken as C. Weber did ("The deformations of loaded gears and the effect on their load-carrying capacity",
1949): from the elements the displacement of the tooth's middle where the load's line crosses it, and from there to the
contact, at a distance h, the closed form of a half-plane under Hertz's pressure of half-width b (K. L. Johnson, "Contact
Mechanics", 1985, section 5.6, from a secondary source):

    2 (1 - nu^2) / (pi E) (ln(2 h / b) - nu / (2 (1 - nu)))
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import across, along
from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.elements.landmarks import outline_of
from ncgear.strength.elements.mesh import MeshSize, Topology, nodes_of, topology_of
from ncgear.strength.elements.plane import (
    displacements,
    edge_stress,
    edge_values,
    inner_gradients,
    von_mises_mpa,
)
from ncgear.strength.material import Material
from ncgear.strength.method import RootStress
from ncgear.teeth.gear import ToothedGear

POSITIONS = 21
"""Loaded places on each flank."""

DEPTH = 3.5
"""Depth in modules below the corners of the teeth at which the body is held."""


CLEAR = 0.25
"""Distance in modules from the load within which no root stress is read; a few elements, beyond which the mesh does not
tell a force at a point from a spread one."""

SIZE = MeshSize()
"""The mesh that is used: the largest root stress of any tooth of the baler within 1 % of that of much finer meshes."""

WITHIN = 1e-6
"""Share of a flank by which directions are taken within its ends."""


@dataclass(frozen=True, eq=False)
class Solved:
    """How z teeth move under a load at each of L places of their flanks, those of the back flank first.

    ``nodes_mm`` has shape (z, n).  ``point_mm`` and ``inwards``, the unit direction of the load, have shape (z, L).
    ``moved_mm`` (shape (z, L, n)) are the displacements for 1 N per mm of face width.
    """

    topology: Topology
    material: Material
    nodes_mm: ComplexArray
    point_mm: ComplexArray
    inwards: ComplexArray
    moved_mm: ComplexArray

    def root_stress(self, clear_mm: float) -> tuple[Array, Array]:
        """Largest tension at the loaded side and compression at the other side of the roots, shape (z, L) each.

        What is within ``clear_mm`` of the load does not count: the load's own spot is no root.
        """
        roots = self.topology.sides[:, : self.topology.root_nodes]
        stress, place = edge_stress(
            self.topology.order, self.nodes_mm[:, None, roots], self.moved_mm[:, :, roots], self.material
        )
        half = stress.shape[1] // 2
        own, other = (np.concatenate([stress[:, :half, s], stress[:, half:, 1 - s]], axis=1) for s in (0, 1))
        places = [np.repeat(place[:, 0, order], half, axis=1) for order in ([0, 1], [1, 0])]
        middle = self.nodes_mm[:, roots]
        ends = np.repeat(place[:, 0, :, -1], half, axis=1)
        foot = np.repeat(middle[:, :, -1], half, axis=1)
        far = ends[..., None] - places[0] + np.abs(foot - self.point_mm)[..., None] > clear_mm
        return _peaks(places[0], np.where(far, own, -np.inf)), _peaks(places[1], -other)

    def middle(self) -> tuple[Array, Array]:
        """Depth of the tooth's middle below the loaded places along the loads, and how far it moves, shape (z, L)."""
        line = self.nodes_mm[:, None, self.topology.middle]
        aside = across(self.inwards[..., None], line - self.point_mm[..., None])
        # From the tip down, the first step that crosses the load's line; the last one if none does.
        crossed = np.signbit(aside[..., :-1]) != np.signbit(aside[..., 1:])
        crossed[..., -1] = True
        step = np.argmax(crossed, axis=-1)[..., None]

        def ends(values: Array) -> list[Array]:
            full = np.broadcast_to(values, aside.shape)
            return [np.take_along_axis(full, step + end, axis=-1)[..., 0] for end in (0, 1)]

        first, last = ends(aside)
        share = np.clip(first / (first - last), 0.0, 1.0)
        place, moved = (a + (b - a) * share for a, b in map(ends, (line, self.moved_mm[..., self.topology.middle])))
        return along(self.inwards, place - self.point_mm), along(self.inwards, moved)


def _peaks(place: Array, stress: Array) -> Array:
    """Largest values of rows of shape (..., k), by parabolas through them and their neighbours."""
    top = np.argmax(stress, axis=-1)
    inner = np.clip(top, 1, stress.shape[-1] - 2)[..., None]
    (x0, x1, x2), (y0, y1, y2) = (
        [np.take_along_axis(values, inner + step, axis=-1)[..., 0] for step in (-1, 0, 1)] for values in (place, stress)
    )
    first, second = (y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)
    bend = (second - first) / (x2 - x0)
    slope = first + bend * (x1 - x0)
    largest = np.max(stress, axis=-1)
    vertex = np.isfinite(bend) & (bend < 0.0) & (inner[..., 0] == top)
    over = np.where(vertex, y1 - slope**2 / (4.0 * np.where(vertex, bend, -1.0)), largest)
    return np.maximum(np.where(np.isfinite(over), over, largest), largest)


def solved_teeth(gear: ToothedGear, material: Material, size: MeshSize, positions: int, depth_mm: float) -> Solved:
    """All teeth of a gear, loaded at so many places of each flank.

    Raises NoSuchMechanism, naming the tooth, where the mesh of a tooth folds.
    """
    outline, topology = outline_of(gear), topology_of(size)
    nodes = nodes_of(outline, size, gear.flanks.rack.module_mm, depth_mm)
    refuse_folded(gear, topology, nodes)
    p, share = size.order, np.linspace(0.0, 1.0, positions)
    # All elements along a flank are equally long.
    element = np.minimum((share * size.flank).astype(int), size.flank - 1)
    first = topology.root_nodes - 1 + element * p
    spread = np.zeros((2, positions, nodes.shape[1]))
    values, _ = edge_values(p, share * size.flank - element)
    for side in (0, 1):
        np.put_along_axis(spread[side], topology.sides[side, first[:, None] + np.arange(p + 1)], values, axis=1)
    length = outline.tip_mm - outline.foot_mm
    point = outline.at(outline.foot_mm[..., None] + length[..., None] * share)[0]
    # Directions are taken just within the flank, whose ends are corners.
    way = outline.at(outline.foot_mm[..., None] + length[..., None] * np.clip(share, WITHIN, 1.0 - WITHIN))[1]
    width = np.diff(outline.at(outline.corner_mm)[0], axis=1)
    normal = 1j * way
    normal *= np.sign(along(normal, np.concatenate([width, -width], axis=1)[..., None]))
    count = len(nodes)
    point, normal = point.reshape(count, -1), normal.reshape(count, -1)
    moved = displacements(topology, nodes, material, spread.reshape(2 * positions, -1), normal)
    return Solved(topology, material, nodes, point, normal, moved)


def refuse_folded(gear: ToothedGear, topology: Topology, nodes: ComplexArray) -> None:
    """Raise NoSuchMechanism, naming the first tooth with elements that are turned inside out."""
    area = inner_gradients(topology, nodes).area_mm2
    sense = np.sign(area.sum(axis=(1, 2)))
    folded = np.flatnonzero(~np.all(area * sense[:, None, None] > 0.0, axis=(1, 2)))
    if folded.size:
        raise NoSuchMechanism(
            f"no mesh of elements fits tooth {folded[0] + 1} of the {gear.flanks.curve.gear.value} gear: the gear is "
            "curved too sharply there; the method estimate, or more teeth of a smaller module, are right",
            key="strength.method",
        )


@dataclass(frozen=True, eq=False)
class Elements:
    """The teeth of one gear by plane finite elements; a ``ToothMethod``.

    ``height_mm`` (shape (2 z, positions), rising) are the heights of the loaded places of each flank along the tooth's
    ``axis`` (shape (z,)) over its ``base_mm`` (shape (z,)).  The tables of the same shape are for 1 N per mm of face
    width: the root stresses, the depth of the tooth's middle along the load, and how far the middle moves.
    """

    material: Material
    solved: Solved
    axis: ComplexArray
    base_mm: ComplexArray
    height_mm: Array
    tension_mpa: Array
    compression_mpa: Array
    middle_depth_mm: Array
    middle_moved_mm: Array

    @property
    def name(self) -> str:
        """The method's word."""
        return "elements"

    def root_stress(self, places: FlankPlaces) -> RootStress:
        """The stresses at the root."""
        step, share = self._steps(places)
        return RootStress(*(_mixed(t, places.flank, step, share) for t in (self.tension_mpa, self.compression_mpa)))

    def compliance(self, places: FlankPlaces, reach_mm: Array) -> Array:
        """How far flanks give way along the load, in mm for 1 N per mm of face width; see ``ToothMethod``.

        ``reach_mm`` is above 0.  Where the contact is wider than the tooth is thick nothing is pressed in.
        """
        step, share = self._steps(places)
        depth, moved = (_mixed(t, places.flank, step, share) for t in (self.middle_depth_mm, self.middle_moved_mm))
        return moved + pressed_in_mm(self.material, depth, reach_mm)

    def painted(self, places: FlankPlaces, load_n_mm: Array) -> Painted:
        """Von Mises' stress of all teeth, each loaded at one of z places (of tooth 1, 2, ...), in N per mm of width."""
        step, share = self._steps(places)
        tooth, positions = places.flank // 2, self.height_mm.shape[1]
        first = places.flank % 2 * positions + step
        moved = [load_n_mm[:, None] * self.solved.moved_mm[tooth, first + k] for k in (0, 1)]
        return painted(self.solved, tooth, moved[0] + (moved[1] - moved[0]) * share[:, None])

    def _steps(self, places: FlankPlaces) -> tuple[IndexArray, Array]:
        """Number of the table's place below each of n places, and the share of the way to the next, from 0 to 1."""
        tooth, heights = places.flank // 2, self.height_mm[places.flank]
        height = along(self.axis[tooth], places.point - self.base_mm[tooth])
        step = np.clip(np.sum(heights <= height[:, None], axis=1) - 1, 0, heights.shape[1] - 2)
        low, high = (np.take_along_axis(heights, step[:, None] + k, axis=1)[:, 0] for k in (0, 1))
        return step, np.clip((height - low) / (high - low), 0.0, 1.0)


def _mixed(table: Array, flank: IndexArray, step: IndexArray, share: Array) -> Array:
    """Values of a table between its places."""
    low, high = table[flank, step], table[flank, step + 1]
    return np.asarray(low + (high - low) * share)


def pressed_in_mm(material: Material, depth_mm: Array, reach_mm: Array) -> Array:
    """How far a contact comes nearer to what lies at a depth under it, in mm for 1 N per mm of face width."""
    poisson = material.poisson
    over = np.log(2.0 * depth_mm / reach_mm) - poisson / (2.0 * (1.0 - poisson))
    return np.maximum(2.0 * (1.0 - poisson**2) / (pi * material.youngs_modulus_mpa) * over, 0.0)


def elements_of(
    gear: ToothedGear, material: Material, size: MeshSize = SIZE, *, depth_modules: float = DEPTH
) -> Elements:
    """All teeth of a gear by plane finite elements.

    Raises NoSuchMechanism, naming the tooth, where no mesh fits it.
    """
    module, axis = gear.flanks.rack.module_mm, outline_of(gear).axis
    solved = solved_teeth(gear, material, size, POSITIONS, depth_modules * module)
    base = solved.nodes_mm[:, solved.topology.middle[-1]]
    flanks = 2 * gear.teeth, POSITIONS
    height = along(axis[:, None], solved.point_mm - base[:, None]).reshape(flanks)
    tables = [table.reshape(flanks) for table in (*solved.root_stress(CLEAR * module), *solved.middle())]
    return Elements(material, solved, axis, base, height, *tables)


@dataclass(frozen=True, eq=False)
class Painted:
    """A field of n nodes for pictures: own frame in mm, triangles of nodes (shape (t, 3)), and values in MPa."""

    place_mm: ComplexArray
    triangles: IndexArray
    von_mises_mpa: Array


def painted(solved: Solved, tooth: IndexArray, moved: ComplexArray) -> Painted:
    """The stress of teeth (numbered from 0) and the body under them up to the middles of the spaces beside them.

    ``moved`` has shape (teeth, nodes).
    """
    topology, nodes = solved.topology, solved.nodes_mm[tooth]
    stress = von_mises_mpa(topology, nodes, moved, solved.material)
    grid = topology.cells[topology.own].reshape(-1, topology.order + 1, topology.order + 1)
    low, right, left, high = grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, :-1, 1:], grid[:, 1:, 1:]
    halves = np.concatenate([np.stack([low, right, high], axis=-1), np.stack([low, high, left], axis=-1)])
    used, triangles = np.unique(halves.reshape(-1, 3), return_inverse=True)
    each = np.arange(len(tooth))[:, None, None] * used.size + triangles.reshape(-1, 3)
    return Painted(nodes[:, used].ravel(), each.reshape(-1, 3), stress[:, used].ravel())
