"""One step towards the nearest curve: a quadratic programme about the curve so far.

Nearest points of outline and curve make the squared distances quadratic, point to tangent; conditions are taken with
their slopes.  It is solved by Clarabel (P. J. Goulart and Y. Chen, 2024), and its answer is judged by the caller.
"""

from __future__ import annotations

from math import pi, tau

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import Limits, conditions
from ncgear.optimum.outline.outline import Outline
from ncgear.optimum.outline.rolled import Rolled, rays

POINTS = 600
"""Points of the outline and of the curve whose distances count."""

SLACK_WEIGHT = 100.0
"""What missing a condition by 1 costs, in squares of the outline's size: far more than any distance gains."""

SMOOTHING = 1e-7
"""Weight of a step's own size, which keeps coefficients that no point tells of where they are."""

TOUCHING = 1e-3
"""Share of the size within which points touch: there the curve's normal is the way to the outline."""


@dataclass(frozen=True)
class Wanted:
    """What is sought: ``greatest`` the least greatest distance instead of the least mean square, with the axis held
    where it is or free, and the module in mm where it is given."""

    greatest: bool = False
    fixed_axis: bool = False
    module_mm: float | None = None


def distances(outline: Outline, curve: Rolled) -> tuple[Array, Array]:
    """Distances to be made small as rows of coefficients and axis, shape (2 * POINTS, n + 2), and their values there.

    ``rows @ (coefficients, axis) - values`` are the distances, first of the outline's points, then of the curve's.
    """
    points, normals = curve.points()
    given = outline.even(POINTS)
    _, foot = cKDTree(points).query(given)
    lengths = np.cumsum(np.hypot(*(np.roll(points, -1, axis=0) - points).T))
    own = np.searchsorted(lengths, (np.arange(POINTS) + 0.5) / POINTS * lengths[-1])
    nearest, away = outline.nearest(points[own])
    far = away > TOUCHING * outline.size_mm
    ways = np.where(far[:, None], (points[own] - nearest) / np.maximum(away, 1e-300)[:, None], normals[own])
    index, way = np.concatenate([foot, own]), np.concatenate([normals[foot], ways])
    aims = np.concatenate([given, nearest])
    outwards, _ = rays(curve.basis.phi_rad[index])
    along = np.sum(way * outwards, axis=1)
    rows = np.column_stack([along[:, None] * curve.basis.fine[0][index], way])
    return rows, np.sum(way * aims, axis=1)


def step(outline: Outline, curve: Rolled, limits: Limits, wanted: Wanted, most_mm: float) -> Rolled:
    """The curve that the programme finds, each radius and the axis moved by no more than ``most_mm``.

    Raises NoSuchMechanism where the solver finds none.
    """
    import clarabel

    count = curve.basis.count
    # The unknowns: coefficients, axis (2), centre distance, module, slack, and the greatest distance.
    size = count + 6
    distance_at, module_at, slack_at, greatest_at = count + 2, count + 3, count + 4, count + 5
    known = np.concatenate([curve.coefficients, curve.axis_mm, [curve.center_distance_mm, curve.module_mm, 0.0, 0.0]])
    square, linear = np.zeros((size, size)), np.zeros(size)
    rows, aims = distances(outline, curve)
    share = 1e-2 if wanted.greatest else 1.0
    square[: count + 2, : count + 2] = share * (rows.T @ rows) / POINTS
    linear[: count + 2] = -share * (rows.T @ aims) / POINTS
    square[np.arange(count), np.arange(count)] += SMOOTHING
    linear[:count] -= SMOOTHING * curve.coefficients
    linear[slack_at] = SLACK_WEIGHT * outline.size_mm**2 / 64.0
    blocks, bounds = list[Array](), list[Array]()

    def below(block: Array, bound: Array) -> None:
        blocks.append(block)
        bounds.append(bound)

    def row(at: int, sign: float, bound: float) -> None:
        block = np.zeros((1, size))
        block[0, at] = sign
        below(block, np.array([bound]))

    b0 = curve.basis.places[0]
    places = len(b0)
    closing, length = np.zeros((1, size)), np.zeros((1, size))
    r, distance = curve.radius[0], curve.center_distance_mm
    closing[0, :count] = (distance / (distance - r) ** 2) @ b0 / places
    closing[0, distance_at] = -np.mean(r / (distance - r) ** 2)
    below(closing, np.array([1.0 - np.mean(curve.turned)]) + closing @ known)
    length[0, :count] = curve.speed_rows.mean(axis=0) * (tau / (pi * curve.teeth))
    length[0, module_at] = -1.0
    below(length, length @ known)
    equal = 2
    if wanted.module_mm is not None:
        row(module_at, 1.0, wanted.module_mm)
        equal = 3
    for one in conditions(curve, limits):
        block = np.zeros((places, size))
        block[:, :count], block[:, distance_at], block[:, module_at] = one.rows, one.by_distance, one.by_module
        bound = block @ known - one.value
        block[:, slack_at] = -1.0
        below(block, bound)
    for sign in (1.0, -1.0):
        block = np.zeros((places, size))
        block[:, :count] = sign * b0
        below(block, sign * r + most_mm)
        for axis in (0, 1):
            row(count + axis, sign, sign * curve.axis_mm[axis] + (0.0 if wanted.fixed_axis else most_mm))
    row(slack_at, -1.0, 0.0)
    if wanted.greatest:
        linear[greatest_at] = outline.size_mm / 64.0
        for sign in (1.0, -1.0):
            block = np.zeros((len(rows), size))
            block[:, : count + 2], block[:, greatest_at] = sign * rows, -1.0
            below(block, sign * aims)
    matrix = sparse.csc_matrix(np.concatenate(blocks))
    bound = np.concatenate(bounds)
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    cones = [clarabel.ZeroConeT(equal), clarabel.NonnegativeConeT(bound.size - equal)]
    form = sparse.csc_matrix(np.triu(square))
    solved = clarabel.DefaultSolver(form, linear, matrix, bound, cones, settings).solve()
    found = np.array(solved.x)
    if str(solved.status) not in ("Solved", "AlmostSolved") or not np.all(np.isfinite(found)):
        raise NoSuchMechanism(f"no pitch curve near the outline was found ({solved.status})", key="motion")
    return Rolled(curve.basis, found[:count], found[count : count + 2], float(found[distance_at]), curve.teeth)
