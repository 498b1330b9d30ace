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
from ncgear.optimum.outline.conditions import ROUNDING, Limits, conditions, excess
from ncgear.optimum.outline.outline import Outline
from ncgear.optimum.outline.rolled import Rolled, rays, scaled

POINTS = 600
"""Points of the outline and of the curve whose distances count."""

SLACK_WEIGHT = 100.0
"""What missing a condition by 1 costs, in squares of the outline's size: far more than any distance gains."""

SMOOTHING = 1e-7
"""Weight of a step's own size, which keeps coefficients that no point tells of where they are."""

TOUCHING = 1e-3
"""Share of the size within which points touch: there the curve's normal is the way to the outline."""


WIDTHS = {"radius": 0, "axis": 2, "distance": 1, "module": 1, "slack": 1, "greatest": 1}
"""The unknowns in order, with their numbers; the radius has as many as coefficients."""


EQUATIONS = 2
"""The rows that come first are equations: the mate closes, and length and module fit each other."""


@dataclass(frozen=True)
class Wanted:
    """What is sought: ``greatest`` the least greatest distance instead of the least mean square, with the axis held
    where it is or free, and the module in mm where it is given."""

    greatest: bool = False
    fixed_axis: bool = False
    module_mm: float | None = None


def missed(curve: Rolled, limits: Limits, wanted: Wanted) -> float:
    """By how much conditions, the mate's closing and the wanted module are missed at most; below 0 where none is."""
    off = abs(curve.module_mm / wanted.module_mm - 1.0) if wanted.module_mm else 0.0
    return max(excess(curve, limits), off - ROUNDING)


def distances(outline: Outline, curve: Rolled) -> tuple[sparse.csr_array, Array]:
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
    rows = sparse.hstack([scaled(along, curve.basis.fine[0][index]), sparse.csr_array(way)], format="csr")
    return rows, np.sum(way * aims, axis=1)


def step(outline: Outline, curve: Rolled, limits: Limits, wanted: Wanted, most_mm: float) -> Rolled:
    """The curve that the programme finds, each radius and the axis moved by no more than ``most_mm``.

    Raises NoSuchMechanism where the solver finds none.
    """
    import clarabel

    count = curve.basis.count
    # The unknowns: coefficients, axis (2), centre distance, module, slack, and the greatest distance.
    size = count + 6
    distance_at, slack_at, greatest_at = count + 2, count + 4, count + 5
    square, linear = np.zeros((size, size)), np.zeros(size)
    rows, aims = distances(outline, curve)
    # Of the greatest distance, the mean square only decides among curves that have it alike.
    share = 1e-2 if wanted.greatest else 1.0
    square[: count + 2, : count + 2] = (rows.T @ rows).toarray() * (share / POINTS)
    linear[: count + 2] = (rows.T @ aims) * (-share / POINTS)
    square[np.arange(count), np.arange(count)] += SMOOTHING
    linear[:count] -= SMOOTHING * curve.coefficients
    linear[slack_at] = SLACK_WEIGHT * outline.size_mm**2 / 64.0
    blocks, bounds = list[sparse.csr_array](), list[Array]()

    def below(bound: Array, **columns: sparse.csr_array | Array) -> None:
        """Rows of unknowns, by the names of their columns, that are at most ``bound``."""
        parts = [sparse.csr_array((bound.size, width)) for width in WIDTHS.values()]
        parts[0] = sparse.csr_array((bound.size, count))
        for name, rows in columns.items():
            wide = rows if sparse.issparse(rows) else np.reshape(rows, (bound.size, -1))
            parts[list(WIDTHS).index(name)] = sparse.csr_array(wide)
        blocks.append(sparse.hstack(parts, format="csr"))
        bounds.append(bound)

    b0 = curve.basis.places[0]
    places = b0.shape[0]
    r, distance = curve.radius[0], curve.center_distance_mm
    # What is linear in the step: its value at the curve so far moves to the other side.
    so_far = curve.coefficients
    closing = ((distance / (distance - r) ** 2) @ b0)[None, :] / places
    by_distance = -np.mean(r / (distance - r) ** 2)
    below(
        np.array([1.0 - np.mean(curve.turned) + closing[0] @ so_far + by_distance * distance]),
        radius=closing,
        distance=np.array([by_distance]),
    )
    length = (np.ones(places) @ curve.speed_rows)[None, :] * (tau / places / (pi * curve.teeth))
    below(np.array([length[0] @ so_far - curve.module_mm]), radius=length, module=np.array([-1.0]))
    if wanted.module_mm is not None:
        for sign in (1.0, -1.0):
            miss = np.array([sign / wanted.module_mm])
            below(np.array([sign]), module=miss, slack=np.array([-1.0]))
    for one in conditions(curve, limits):
        rows_of, by_distance_of, by_module = one.slopes()
        bound = rows_of @ so_far + by_distance_of * distance + by_module * curve.module_mm - one.value
        below(bound, radius=rows_of, distance=by_distance_of, module=by_module, slack=np.full(places, -1.0))
    most_axis = 0.0 if wanted.fixed_axis else most_mm
    for sign in (1.0, -1.0):
        below(sign * r + most_mm, radius=sign * b0)
        below(sign * curve.axis_mm + most_axis, axis=sign * np.eye(2))
    below(np.zeros(1), slack=np.array([-1.0]))
    if wanted.greatest:
        linear[greatest_at] = outline.size_mm / 64.0
        for sign in (1.0, -1.0):
            part = sign * rows
            below(sign * aims, radius=part[:, :count], axis=part[:, count:], greatest=np.full(aims.size, -1.0))
    matrix, bound = sparse.csc_matrix(sparse.vstack(blocks)), np.concatenate(bounds)
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    cones = [clarabel.ZeroConeT(EQUATIONS), clarabel.NonnegativeConeT(bound.size - EQUATIONS)]
    form = sparse.csc_matrix(np.triu(square))
    solved = clarabel.DefaultSolver(form, linear, matrix, bound, cones, settings).solve()
    found = np.array(solved.x)
    if str(solved.status) not in ("Solved", "AlmostSolved") or not np.all(np.isfinite(found)):
        raise NoSuchMechanism(f"no pitch curve near the outline was found ({solved.status})", key="motion")
    return Rolled(curve.basis, found[:count], found[count : count + 2], float(found[distance_at]), curve.teeth)
