"""All teeth of a gear under a load at many places of each flank, and the stresses and ways that follow."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import across, along
from ncgear.strength.elements.landmarks import MarkedOutline
from ncgear.strength.elements.mesh import MeshSize, Topology, nodes_of, topology_of
from ncgear.strength.elements.plane import displacements, edge_stress, edge_values, inner_gradients
from ncgear.strength.material import Material
from ncgear.teeth.gear import ToothedGear


@dataclass(frozen=True, eq=False)
class LoadedTeeth:
    """How z teeth move under a load at each of p places of both flanks.

    ``nodes_mm`` has shape (z, n).  ``point_mm`` and ``inwards``, the unit direction of the load, have shape (z, 2, p),
    the back flank first, from the foot to the tip.  ``moved_mm`` (shape (z, 2, p, n)) are the displacements for 1 N per
    mm of face width.
    """

    topology: Topology
    material: Material
    nodes_mm: ComplexArray
    point_mm: ComplexArray
    inwards: ComplexArray
    moved_mm: ComplexArray

    def root_stress_mpa(self, clear_mm: float) -> tuple[Array, Array]:
        """Largest tension at the loaded side and compression at the other side of the root, shape (z, 2, p) each.

        0 where there is none.  Places within ``clear_mm`` of the load do not count, since the load's spot is no root.
        """
        topology = self.topology
        roots = topology.sides[:, : topology.root_nodes]
        outline = self.nodes_mm[:, None, None, roots]
        stress, place = edge_stress(topology.order, outline, self.moved_mm[..., roots], self.material)
        # From (..., loaded flank, place, side, k) to that at the loaded flank's and at the other side, (z, 2, p, k).
        places = np.broadcast_to(place, (len(place), 2, *place.shape[2:]))
        own, other = (np.stack([stress[:, s, :, o] for s, o in ((0, a), (1, b))], axis=1) for a, b in ((0, 1), (1, 0)))
        near, away = (np.stack([places[:, s, :, o] for s, o in ((0, a), (1, b))], axis=1) for a, b in ((0, 1), (1, 0)))
        # The load stands beyond the foot, at the end of the root's outline or farther.
        foot = self.nodes_mm[:, roots[:, -1]][..., None]
        beyond = near[..., -1:] - near + np.abs(self.point_mm - foot)[..., None]
        return _highest(near, np.where(beyond > clear_mm, own, 0.0)), _highest(away, -other)

    def middle_mm(self) -> tuple[Array, Array]:
        """Depth of the tooth's middle under the loaded places along the load, and the way by which the load moves it.

        In mm, shape (z, 2, p) each.
        """
        middle = self.topology.middle
        line = self.nodes_mm[:, None, None, middle]
        aside = across(self.inwards[..., None], line - self.point_mm[..., None])
        # From the tip down, the first step that crosses the load's line; the last step if none does.
        crosses = np.signbit(aside[..., :-1]) != np.signbit(aside[..., 1:])
        crosses[..., -1] = True
        step = np.argmax(crosses, axis=-1)
        first, last = _ends(aside, step)
        share = np.clip(first / (first - last), 0.0, 1.0)
        ends = _ends(np.broadcast_to(line, aside.shape), step), _ends(self.moved_mm[..., middle], step)
        place, moved = (start + (end - start) * share for start, end in ends)
        return along(self.inwards, place - self.point_mm), along(self.inwards, moved)


Values = TypeVar("Values", Array, ComplexArray)
"""Numbers or places."""


def _ends(values: Values, step: IndexArray) -> tuple[Values, Values]:
    """Values at both ends of a step of each row, from values of shape (..., k) and steps of shape (...)."""
    first, last = (np.take_along_axis(values, step[..., None] + end, axis=-1)[..., 0] for end in (0, 1))
    return first, last


def _highest(place: Array, stress: Array) -> Array:
    """Largest value of each row of shape (..., k), but at least 0, by a parabola through it and its neighbours."""
    top = np.argmax(stress, axis=-1)
    inner = np.clip(top, 1, stress.shape[-1] - 2)
    (x0, x1), (y0, y1) = (_ends(values, inner - 1) for values in (place, stress))
    (_, x2), (_, y2) = (_ends(values, inner) for values in (place, stress))
    first, second = (y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)
    bend = np.minimum((second - first) / (x2 - x0), 0.0)
    slope = first + bend * (x1 - x0)
    rise = np.divide(-(slope**2), 4.0 * bend, out=np.zeros_like(bend), where=(bend < 0.0) & (inner == top))
    return np.asarray(np.maximum(np.max(stress, axis=-1) + rise, 0.0))


WITHIN = 1e-6
"""Distance from a flank's ends, as a share of it, at which directions are taken, since the ends are corners."""


def loaded_teeth(
    gear: ToothedGear, outline: MarkedOutline, material: Material, size: MeshSize, positions: int, depth_mm: float
) -> LoadedTeeth:
    """All teeth of a gear, loaded at a number of places of each flank, evenly spaced from its foot to its tip.

    Raises NoSuchMechanism, naming the tooth, where the mesh of a tooth folds.
    """
    topology = topology_of(size)
    nodes = nodes_of(outline, size, gear.flanks.rack.module_mm, depth_mm)
    refuse_folded(gear, topology, nodes)
    share = np.linspace(0.0, 1.0, positions)
    # All elements along a flank are equally long.
    element = np.minimum((share * size.flank).astype(int), size.flank - 1)
    values, _ = edge_values(size.order, share * size.flank - element)
    step = topology.root_nodes - 1 + element[:, None] * size.order + np.arange(size.order + 1)
    spread = np.zeros((2, positions, nodes.shape[1]))
    for side in (0, 1):
        np.put_along_axis(spread[side], topology.sides[side, step], values, axis=1)
    foot, length = outline.foot_mm[..., None], (outline.tip_mm - outline.foot_mm)[..., None]
    point = outline.at(foot + length * share)
    along_flank = outline.way.at(foot + length * np.clip(share, WITHIN, 1.0 - WITHIN))[1]
    # The normal that leads towards the other side.
    width = np.diff(outline.at(outline.corner_mm), axis=1)
    inwards = 1j * along_flank * np.sign(along(1j * along_flank, np.concatenate([width, -width], axis=1)[..., None]))
    force = inwards.reshape(len(nodes), -1)
    moved = displacements(topology, nodes, material, spread.reshape(2 * positions, -1), force)
    return LoadedTeeth(topology, material, nodes, point, inwards, moved.reshape(*point.shape, -1))


def refuse_folded(gear: ToothedGear, topology: Topology, nodes: ComplexArray) -> None:
    """Raise NoSuchMechanism for the first tooth with elements turned inside out, and name the tooth."""
    area = inner_gradients(topology, nodes).area_mm2
    sense = np.sign(area.sum(axis=(1, 2)))
    folded = np.flatnonzero(~np.all(area * sense[:, None, None] > 0.0, axis=(1, 2)))
    if folded.size:
        raise NoSuchMechanism(
            f"no mesh of elements fits tooth {folded[0] + 1} of the {gear.flanks.curve.gear.value} gear: the gear is "
            "curved too sharply there; the method estimate, or more teeth of a smaller module, are right",
            key="strength.method",
        )
