"""Plane strain in meshes of one topology: stiffness, displacements under many loads, stresses.

All meshes are assembled at once, since they differ only in the places of their nodes; each is factorised once.  Shape
functions and quadrature are scikit-fem's.  Displacements are complex, x + i y.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu
from skfem import ElementQuad1, ElementQuad2
from skfem.quadrature import get_quadrature
from skfem.refdom import RefQuad

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import along, square
from ncgear.strength.elements.mesh import Topology
from ncgear.strength.material import Material


@dataclass(frozen=True, eq=False)
class Gradients:
    """Gradients of shape functions by x and y, shape (2, z, e, q, nodes), at q places of each of e elements.

    ``area_mm2`` (shape (z, e, q)) is the part of the element that each place stands for, of either sign.
    """

    by: Array
    area_mm2: Array


def gradients_at(topology: Topology, nodes: ComplexArray, places: Array, weight: Array) -> Gradients:
    """Gradients at places of the unit square (shape (2, q), weights (q,)) in meshes with ``nodes``, shape (z, n)."""
    order = topology.order
    element = {1: ElementQuad1, 2: ElementQuad2}[order]()
    number = np.rint(element.doflocs * order).astype(int) @ [order + 1, 1]
    reference = np.empty((2, places.shape[1], len(number)))
    for own, ours in enumerate(number):
        reference[:, :, ours] = element.lbasis(places, own)[1]
    around = nodes[:, topology.cells]
    first, second = (around @ slope.T for slope in reference)
    area = np.imag(np.conj(first) * second)
    # The inverse of the matrix of derivatives (first, second) of x and y.
    with np.errstate(divide="ignore", invalid="ignore"):
        by_first, by_second = first / area, second / area
    u, v = reference
    by_x = by_second.imag[..., None] * u - by_first.imag[..., None] * v
    by_y = by_first.real[..., None] * v - by_second.real[..., None] * u
    return Gradients(np.stack([by_x, by_y]), area * weight)


def inner_gradients(topology: Topology, nodes: ComplexArray) -> Gradients:
    """Gradients at the points of integration of the stiffness."""
    return gradients_at(topology, nodes, *get_quadrature(RefQuad, 2 * topology.order + 1))


def lame_mpa(material: Material) -> tuple[float, float]:
    """Lame's constants: of the change of volume, and the shear modulus."""
    modulus, poisson = material.youngs_modulus_mpa, material.poisson
    shear = modulus / (2.0 * (1.0 + poisson))
    return 2.0 * shear * poisson / (1.0 - 2.0 * poisson), shear


def element_stiffness(gradients: Gradients, material: Material) -> Array:
    """Stiffness of all elements in N/mm for a width of 1 mm, shape (z, e, 2 nodes, 2 nodes), x and y of each node."""
    volume, shear = lame_mpa(material)
    x, y = gradients.by
    weighted = np.abs(gradients.area_mm2)[..., None]
    xx, yy, xy = (np.swapaxes(a, -1, -2) @ (weighted * b) for a, b in ((x, x), (y, y), (x, y)))
    count = xx.shape[-1]
    stiffness = np.empty((*xx.shape[:-2], count, 2, count, 2))
    stiffness[..., :, 0, :, 0] = (volume + 2.0 * shear) * xx + shear * yy
    stiffness[..., :, 1, :, 1] = (volume + 2.0 * shear) * yy + shear * xx
    stiffness[..., :, 0, :, 1] = volume * xy + shear * np.swapaxes(xy, -1, -2)
    stiffness[..., :, 1, :, 0] = np.swapaxes(stiffness[..., :, 0, :, 1], -1, -2)
    return stiffness.reshape(*xx.shape[:-2], 2 * count, 2 * count)


@dataclass(frozen=True, eq=False)
class Pattern:
    """Places of elements' entries in the matrix of the free unknowns: sorted entries, and the first of each sum."""

    free: IndexArray
    entry: IndexArray
    first: IndexArray
    row: IndexArray
    start: IndexArray


def pattern_of(topology: Topology) -> Pattern:
    """The pattern of the free unknowns (x and y of each free node)."""
    free = np.flatnonzero(~np.repeat(topology.held, 2))
    number = np.full(2 * topology.held.size, -1)
    number[free] = np.arange(free.size)
    unknown = number[(2 * topology.cells[:, :, None] + np.arange(2)).reshape(len(topology.cells), -1)]
    row, column = np.broadcast_arrays(unknown[:, :, None], unknown[:, None, :])
    key = (column * free.size + row).ravel()
    entry = np.flatnonzero((row >= 0).ravel() & (column >= 0).ravel())
    entry = entry[np.argsort(key[entry], kind="stable")]
    key, first = np.unique(key[entry], return_index=True)
    start = np.searchsorted(key, np.arange(free.size + 1) * free.size)
    return Pattern(free, entry, first, key % free.size, start)


AT_ONCE = 4
"""Loads that are solved together.  For larger groups linear algebra libraries share products of very small matrices
among their threads, which takes up to ten times as long; single loads take up to three times as long."""

RESIDUAL = 1e-8
"""Part of a load that may be left unbalanced at any node; rounding leaves 1e-12."""


def displacements(
    topology: Topology, nodes: ComplexArray, material: Material, at: Array, force: ComplexArray
) -> ComplexArray:
    """Displacements of all nodes in mm under forces of N per mm of width, shape (z, loads, nodes).

    ``nodes`` has shape (z, nodes).  ``at`` (shape (loads, nodes)) spreads each load over the nodes, alike in all
    meshes; ``force`` has shape (z, loads).
    """
    stiffness = element_stiffness(inner_gradients(topology, nodes), material).reshape(len(nodes), -1)
    pattern = pattern_of(topology)
    moved = np.zeros((len(nodes), *at.shape), dtype=complex)
    size = pattern.free.size
    for mesh, entries in enumerate(stiffness):
        values = np.add.reduceat(entries[pattern.entry], pattern.first)
        matrix = csc_array((values, pattern.row, pattern.start), shape=(size, size))
        solver = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        load = (at * force[mesh][:, None]).view(float)[:, pattern.free].T
        groups = range(0, len(at), AT_ONCE)
        solved = np.concatenate([solver.solve(load[:, first : first + AT_ONCE]) for first in groups], axis=1)
        if not np.abs(matrix @ solved - load).max() <= RESIDUAL * np.abs(load).max():
            raise Unanswered("the displacements of a tooth do not balance its load")
        found = np.zeros((len(at), 2 * topology.held.size))
        found[:, pattern.free] = solved.T
        moved[mesh] = found.view(complex)
    return moved


def edge_values(order: int, places: Array) -> tuple[Array, Array]:
    """The shape functions of an edge from 0 to 1, and their derivatives, at places; shape (places, order + 1) each."""
    powers = np.linalg.inv(np.vander(np.linspace(0.0, 1.0, order + 1), increasing=True))
    exponents = np.arange(order + 1)
    slopes = exponents[1:] * places[:, None] ** exponents[:-1]
    return places[:, None] ** exponents @ powers, slopes @ powers[1:]


def edge_stress(order: int, nodes: ComplexArray, moved: ComplexArray, material: Material) -> tuple[Array, Array]:
    """Stresses along free edges in MPa, shape (..., k), and their places from the first node in mm.

    ``nodes`` and ``moved`` have shape (..., nodes along the way) and broadcast.  On an unloaded edge, the stress along
    it is E / (1 - nu^2) times the strain along it, which is most exact at the Gauss points of each element's edge, and
    is taken there.
    """
    gauss = (1.0 + np.polynomial.legendre.leggauss(order)[0]) / 2.0
    _, slopes = edge_values(order, gauss)

    def by_share(values: ComplexArray) -> ComplexArray:
        along_edges = np.lib.stride_tricks.sliding_window_view(values, order + 1, axis=-1)[..., ::order, :]
        return np.asarray(along_edges @ slopes.T)

    step, stretched = by_share(nodes), by_share(moved)
    strain = along(step, stretched) / square(step)
    length = np.abs(step).mean(axis=-1, keepdims=True)
    place = np.cumsum(length, axis=-2) - length + length * gauss
    modulus = material.youngs_modulus_mpa / (1.0 - material.poisson**2)
    return modulus * strain.reshape(*strain.shape[:-2], -1), place.reshape(*place.shape[:-2], -1)


def von_mises_mpa(topology: Topology, nodes: ComplexArray, moved: ComplexArray, material: Material) -> Array:
    """Von Mises' stress at the nodes in MPa, the mean of the elements that meet there; shape (z, n).

    ``nodes`` and ``moved`` have shape (z, n).
    """
    order, count = topology.order, topology.cells.shape[1]
    own = np.stack(np.divmod(np.arange(count), order + 1)) / order
    gradients = gradients_at(topology, nodes, own, np.ones(count))
    around = moved[:, topology.cells][:, :, None, :]
    by_x, by_y = (np.sum(by * around, axis=-1) for by in gradients.by)
    volume, shear = lame_mpa(material)
    mean = volume * (by_x.real + by_y.imag)
    normal = [mean + 2.0 * shear * by_x.real, mean + 2.0 * shear * by_y.imag, mean]
    shearing = shear * (by_x.imag + by_y.real)
    node = (np.arange(len(nodes))[:, None] * topology.held.size + topology.cells.ravel()).ravel()
    shared = [np.bincount(node, values.ravel()) / np.bincount(node) for values in (*normal, shearing)]
    x, y, z, xy = (values.reshape(nodes.shape) for values in shared)
    return np.asarray(np.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2.0 + 3.0 * xy**2))
