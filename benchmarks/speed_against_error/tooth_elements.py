"""The studies of finite elements: root stress and deflection of a tooth of the baler, by order and size of elements.

The reference is made with scikit-fem alone: triangles with polynomials of degree 4, which are assembled and solved, and
whose stress is recovered, in other ways than ncgear's.  It has the outline in common with ncgear's elements, and where
the body is held.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree
from skfem import Basis, ElementTriP4, ElementVector, FacetBasis, MeshTri, MeshTri2, condense, solve
from skfem.models.elasticity import lame_parameters, linear_elasticity

from ncgear.design.reading.design_file import load
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import across
from ncgear.project.drive import Drive
from ncgear.strength.elements.landmarks import outline_of
from ncgear.strength.elements.loaded import LoadedTeeth, loaded_teeth
from ncgear.strength.elements.mesh import MeshSize, nodes_of, topology_of
from ncgear.strength.elements.teeth import CLEAR, DEPTH, POSITIONS, SIZE
from ncgear.strength.material import EnduredStress, Material, MaterialFamily
from ncgear.teeth.gear import ToothedGear
from speed_against_error.study import Level, Method, Study

NEVER = EnduredStress(np.array([1.0]), np.array([1.0]))
STEEL = Material("steel", MaterialFamily.STEEL, 206_000.0, 0.3, 7850.0, None, NEVER, "elastic constants alone")

TOOTH = 16
"""Number from 0 of the driving tooth of the baler whose back flank is hardest to mesh: errors at others are less."""

PLACES = (10, 15, 20)
"""Loaded places of the back flank: the middle, three quarters, the edge of the tip.  All meshes have nodes there."""

FINE = MeshSize().times(4)
"""The reference's mesh, before each quadrilateral is halved."""

TIMES = (1, 2, 3, 4)
STRAIGHT = (2, 3, 4, 6)
NINE, FOUR = "elements of nine nodes", "elements of four nodes"
FINENESS = "parts of each side"


def root_stress_study() -> Study:
    """The root stress at the loaded side of one tooth."""
    return Study(
        key="tooth-root-stress",
        title="Root stress of a tooth of the baler by finite elements",
        unit="share of the largest tension at the root, worst of three loaded places",
        reference="triangles of degree 4 on the same outline, stress from the gradients beside the edge; good to 1e-3. "
        "Times are for all 25 teeth with 42 loads each",
        methods=_methods(lambda teeth: teeth.root_stress_mpa(CLEAR * _module_mm())[0][TOOTH, 0, PLACES]),
        error=lambda stress: float(np.abs(stress / reference()[0] - 1.0).max()),
        chosen=(NINE, 3),
        enough=0.01,
        because="it is the coarsest mesh with which the largest root stress of every tooth of the worked designs is "
        "within a percent of its limit",
    )


def deflection_study() -> Study:
    """How far the tooth's middle moves."""
    return Study(
        key="tooth-deflection",
        title="Deflection of a tooth of the baler by finite elements",
        unit="share of the way of the tooth's middle along the load, worst of three loaded places",
        reference="triangles of degree 4 on the same outline. Times are for all 25 teeth with 42 loads each",
        methods=_methods(lambda teeth: teeth.middle_mm()[1][TOOTH, 0, PLACES], four=2.0),
        error=lambda moved: float(np.abs(moved / reference()[1] - 1.0).max()),
        chosen=(NINE, 3),
        enough=0.01,
        because="stresses are found from the same elements and need them as fine",
    )


def _methods(read: Callable[[LoadedTeeth], Array], four: float | None = None) -> tuple[Method, ...]:
    """Both elements; ``four`` is the order of convergence in theory of those of four nodes."""

    def by(order: int, times: Level) -> Array:
        return read(by_elements(MeshSize(order).times(int(times))))

    return (
        Method(NINE, FINENESS, TIMES, partial(by, 2)),
        Method(FOUR, FINENESS, STRAIGHT, partial(by, 1), order=four),
    )


def by_elements(size: MeshSize) -> LoadedTeeth:
    """As ncgear does it."""
    gear = driving()
    return loaded_teeth(gear, outline_of(gear), STEEL, size, POSITIONS, DEPTH * _module_mm())


@cache
def driving() -> ToothedGear:
    """The baler's driving gear."""
    return Drive(load(Path(__file__).parents[2] / "designs" / "baler.yaml").design).teeth.driving


def _module_mm() -> float:
    return driving().flanks.rack.module_mm


@cache
def reference() -> tuple[Array, Array]:
    """The largest tension in MPa at the loaded root, and the way of the tooth's middle in mm; one for each place."""
    gear, topology = driving(), topology_of(FINE)
    nodes = nodes_of(outline_of(gear), FINE, _module_mm(), DEPTH * _module_mm())[TOOTH]
    mesh, corners = curved_triangles(topology.cells, nodes)
    constants = lame_parameters(STEEL.youngs_modulus_mpa, STEEL.poisson)
    basis = Basis(mesh, ElementVector(ElementTriP4()), intorder=8)
    stiffness = linear_elasticity(*constants).assemble(basis)
    boundary = mesh.boundary_facets()
    edges = corners[mesh.facets[:, boundary]]
    held = basis.get_dofs(facets=boundary[topology.held[edges].all(axis=0)]).all()
    teeth = by_elements(SIZE)
    clear = np.abs(nodes[topology.sides[0, : topology.root_nodes]] - teeth.point_mm[TOOTH, 0, 0]).argmin()
    root = np.isin(edges, topology.sides[0, : clear + 1]).all(axis=0)
    along_root = FacetBasis(mesh, ElementVector(ElementTriP4()), facets=boundary[root], intorder=8)
    corner_of = {int(node): corner for corner, node in enumerate(corners)}
    middle = [corner_of[node] for node in topology.middle[::2].tolist()]
    line = mesh.p[0, middle] + 1j * mesh.p[1, middle]
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])
    stresses, ways = [], []
    for place in PLACES:
        point, inwards = teeth.point_mm[TOOTH, 0, place], teeth.inwards[TOOTH, 0, place]
        load = np.zeros(stiffness.shape[0])
        node = int(np.argmin(np.abs(mesh.p[0] + 1j * mesh.p[1] - point)))
        load[basis.nodal_dofs[:, node]] = inwards.real, inwards.imag
        moved = solve(*condense(stiffness, load, D=held))
        stresses.append(_stress_along(along_root, moved, constants).max())
        crossing = CubicSpline(length, across(inwards, line - point)).roots(extrapolate=False)[0]
        ways.append(CubicSpline(length, [inwards.real, inwards.imag] @ moved[basis.nodal_dofs[:, middle]])(crossing))
    return np.array(stresses), np.array(ways)


def curved_triangles(cells: IndexArray, nodes: ComplexArray) -> tuple[MeshTri2, IndexArray]:
    """Each element of nine nodes as two curved triangles of six; also the number that each corner has in ``nodes``."""
    halves = np.concatenate([cells[:, [0, 6, 8, 3, 7, 4]], cells[:, [0, 8, 2, 4, 5, 1]]])
    corners, number = np.unique(halves[:, :3], return_inverse=True)
    points = np.array([nodes[corners].real, nodes[corners].imag])
    straight = MeshTri2.from_mesh(MeshTri(points, number.reshape(-1, 3).T))
    ends = np.concatenate([halves[:, [0, 1]], halves[:, [1, 2]], halves[:, [0, 2]]])
    there = np.concatenate([nodes[ends].mean(axis=1), nodes[corners]])
    target = np.concatenate([nodes[halves[:, 3:].T.ravel()], nodes[corners]])
    nearest = cKDTree(np.column_stack([there.real, there.imag])).query(straight.doflocs.T)[1]
    return MeshTri2(np.array([target[nearest].real, target[nearest].imag]), straight.t), corners


def _stress_along(edge: FacetBasis, moved: Array, constants: tuple[float, float]) -> Array:
    """The stress along an edge in MPa from the gradients beside it."""
    gradient = edge.interpolate(moved).grad
    strain = (gradient + np.swapaxes(gradient, 0, 1)) / 2.0
    tangent = np.stack([-edge.normals[1], edge.normals[0]])
    stretched = np.einsum("i...,ij...,j...->...", tangent, strain, tangent)
    return np.asarray(constants[0] * (strain[0, 0] + strain[1, 1]) + 2.0 * constants[1] * stretched)
