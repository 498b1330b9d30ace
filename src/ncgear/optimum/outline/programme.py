"""One step towards the nearest curve: a quadratic programme about the curve so far.

Nearest points of outline and curve make the squared distances quadratic, point to tangent; conditions are taken with
their slopes, and once more with their values at the answer (a second-order correction: R. Fletcher, 1982), since a
moved axis bends them.  It is solved by Clarabel (P. J. Goulart and Y. Chen, 2024), and its answer is judged by the
caller.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate
from math import pi, tau

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.outline.conditions import ROUNDING, CurveLimits, conditions, excess
from ncgear.optimum.outline.outline import Outline
from ncgear.optimum.outline.rolled import MatePlace, Rolled, rays

POINTS = 600
"""Points of the outline and of the curve whose distances count."""

SLACK_WEIGHT = 100.0
"""Cost of violating a condition by 1, in squares of the outline's size: far more than any distance gains."""

SMOOTHING = 1e-7
"""Weight of a step's size: it keeps coefficients in place that affect no point."""

TOUCHING = 1e-3
"""Share of the size within which points touch: there the curve's normal is the way to the outline."""


NEAR, TIGHT = 0.1, 1e-9
"""Distance from its bound within which a row is taken at once, and a violation that counts as none."""

WIDTHS = {"axis": 2, "distance": 1, "module": 1, "slack": 1, "greatest": 1}
MATE_WIDTHS = {"mate_axis": 2, "mate_turn": 1, "mate_scale": 1}
"""The unknowns of a mate with an outline, with their numbers, after the unknowns of the curve."""


EQUATIONS = 2
"""The rows that come first are equations: the mate closes, and length and module fit each other."""


@dataclass(frozen=True, eq=False)
class MateWanted:
    """The outline that the mate follows, the share of its distances in the total (0 to 1), its axis where it is fixed,
    and whether its drawing keeps its size."""

    outline: Outline
    share: float
    axis_mm: Array | None = None
    fixed_size: bool = False


@dataclass(frozen=True, eq=False)
class OutlineAim:
    """The aim: the least mean square, or with ``greatest`` the least greatest distance; a fixed or a free axis; the
    module in mm where it is given; and an outline of the mate."""

    greatest: bool = False
    fixed_axis: bool = False
    module_mm: float | None = None
    mate: MateWanted | None = None


def missed(curve: Rolled, limits: CurveLimits, wanted: OutlineAim) -> float:
    """The largest violation of conditions, of the mate's closing and of the wanted module; below 0 where all hold."""
    off = abs(curve.module_mm / wanted.module_mm - 1.0) if wanted.module_mm else 0.0
    return max(excess(curve, limits), off - ROUNDING)


def distances(outline: Outline, curve: Rolled) -> tuple[dict[str, Array], Array]:
    """Distances to be made small as columns by the names of unknowns, 2 * POINTS rows, and their values there.

    The sum of columns times unknowns, less the values, are the distances, first of the outline's points, then of the
    curve's.
    """
    index, way, aims = _feet(outline, *curve.points())
    outwards, _ = rays(curve.basis.phi_rad[index])
    along = np.sum(way * outwards, axis=1)
    radius = curve.basis.fine[0][index].toarray() * along[:, None]
    return {"radius": radius, "axis": way}, np.sum(way * aims, axis=1)


def mate_distances(outline: Outline, curve: Rolled) -> tuple[dict[str, Array], Array]:
    """As ``distances``, of the mate's curve and its outline."""
    place = curve.mate_place
    assert place is not None
    points, normals = curve.mate_in_drawing()
    index, way, aims = _feet(outline, points / place.scale, normals)
    radius, distance, turn = curve.mate_rows(index, way)
    rows = {"radius": radius, "distance": distance[:, None], "mate_axis": way, "mate_turn": turn[:, None]}
    rows["mate_scale"] = -np.sum(way * aims, axis=1)[:, None]
    now = radius @ curve.coefficients + distance * curve.center_distance_mm + way @ place.axis_mm
    now += turn * place.turned_rad + rows["mate_scale"][:, 0] * place.scale
    return rows, now - np.sum(way * (points[index] - place.scale * aims), axis=1)


def _feet(outline: Outline, points: Array, normals: Array) -> tuple[IndexArray, Array, Array]:
    """Points of a curve by their index, the directions of their moves, and their targets at an outline.

    First the nearest points to even points of the outline, then even points of the curve: 2 * POINTS.
    """
    given = outline.even(POINTS)
    _, foot = cKDTree(points).query(given)
    lengths = np.cumsum(np.hypot(*(np.roll(points, -1, axis=0) - points).T))
    own = np.searchsorted(lengths, (np.arange(POINTS) + 0.5) / POINTS * lengths[-1])
    nearest, away = outline.nearest(points[own])
    far = away > TOUCHING * outline.size_mm
    ways = np.where(far[:, None], (points[own] - nearest) / np.maximum(away, 1e-300)[:, None], normals[own])
    return np.concatenate([foot, own]), np.concatenate([normals[foot], ways]), np.concatenate([given, nearest])


class _Rows:
    """Rows of the programme in the order of their addition, each at most a bound; ``begins`` has the first columns."""

    def __init__(self, begins: Mapping[str, int]) -> None:
        self.begins, self.count = begins, 0
        self.parts = list[tuple[Array, IndexArray, IndexArray]]()
        self.bounds = list[Array]()

    def add(self, bound: Array, **columns: sparse.csr_array | Array) -> None:
        """Rows by the names of their columns that are at most ``bound``."""
        for name, rows in columns.items():
            if isinstance(rows, np.ndarray):
                wide = rows.reshape(bound.size, -1)
                place, column = np.indices(wide.shape).reshape(2, -1)
                values = wide.ravel()
            else:
                place, column, values = np.repeat(np.arange(bound.size), np.diff(rows.indptr)), rows.indices, rows.data
            self.parts.append((values, place + self.count, column + self.begins[name]))
        self.bounds.append(bound)
        self.count += bound.size

    @property
    def bound(self) -> Array:
        """All bounds."""
        return np.concatenate(self.bounds)

    def matrix(self, size: int) -> sparse.csr_array:
        """All rows, for ``size`` unknowns."""
        values, rows, columns = (np.concatenate(part) for part in zip(*self.parts, strict=True))
        return sparse.csr_array((values, (rows, columns)), shape=(self.count, size))


def _solved(form: sparse.csc_matrix, linear: Array, rows: sparse.csr_array, bound: Array, start: Array) -> Array:
    """The least of a quadratic form where the first rows times the unknowns equal their bounds and no other is above.

    Few rows bind: the rows near their bounds at ``start`` are taken, and those that the answer violates, until it
    violates none.  Raises NoSuchMechanism where the solver finds none.
    """
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    # Further refinement of its equations changes no digit that counts.
    settings.iterative_refinement_max_iter = 1
    found, taken, near = start, np.arange(bound.size) < EQUATIONS, NEAR
    while np.any(more := (bound - rows @ found < near) & ~taken):
        taken |= more
        cones = [clarabel.ZeroConeT(EQUATIONS), clarabel.NonnegativeConeT(int(taken.sum()) - EQUATIONS)]
        some = sparse.csc_matrix(rows[taken])
        solved = clarabel.DefaultSolver(form, linear, some, bound[taken], cones, settings).solve()
        found, near = np.array(solved.x), -TIGHT
        if str(solved.status) not in ("Solved", "AlmostSolved") or not np.all(np.isfinite(found)):
            raise NoSuchMechanism(f"no pitch curve near the outline was found ({solved.status})", key="motion")
    return found


def step(outline: Outline, curve: Rolled, limits: CurveLimits, wanted: OutlineAim, most_mm: float) -> Rolled:
    """The curve that the programme finds; each radius and the axis move by at most ``most_mm``.

    Raises NoSuchMechanism where the solver finds none.
    """
    count, mate, place = curve.basis.count, wanted.mate, curve.mate_place
    widths = {"radius": count, **WIDTHS, **(MATE_WIDTHS if mate else {})}
    begins = dict(zip(widths, accumulate(widths.values(), initial=0), strict=False))
    size = sum(widths.values())
    square, linear, programme = np.zeros((size, size)), np.zeros(size), _Rows(begins)
    below = programme.add
    followed = [(*distances(outline, curve), 1.0 - mate.share if mate else 1.0)]
    if mate:
        followed.append((*mate_distances(mate.outline, curve), mate.share))
    # Of the greatest distance, the mean square only decides among curves that have it alike.
    share = 1e-2 if wanted.greatest else 1.0
    for columns, aim, weight in followed:
        rows = np.hstack(list(columns.values()))
        at = np.concatenate([begins[name] + np.arange(widths[name]) for name in columns])
        # Without BLAS, whose threads wait for each other at sizes as small as these.
        square[np.ix_(at, at)] += np.einsum("ki,kj->ij", rows, rows) * (share * weight / POINTS)
        linear[at] -= np.einsum("ki,k->i", rows, aim) * (share * weight / POINTS)
    square[np.arange(count), np.arange(count)] += SMOOTHING
    linear[:count] -= SMOOTHING * curve.coefficients
    linear[begins["slack"]] = SLACK_WEIGHT * outline.size_mm**2 / 64.0
    b0 = curve.basis.places[0]
    places = b0.shape[0]
    r, distance = curve.radius[0], curve.center_distance_mm
    closing = ((distance / (distance - r) ** 2) @ b0)[None, :] / places
    length = (np.ones(places) @ curve.speed_rows)[None, :] * (tau / places / (pi * curve.teeth))
    below(np.zeros(1), radius=closing, distance=np.array([-np.mean(r / (distance - r) ** 2)]))
    below(np.zeros(1), radius=length, module=np.array([-1.0]))
    for condition in conditions(curve, limits):
        rows_of, by_distance, by_module = condition.slopes()
        slack = np.full(places, -1.0)
        below(np.zeros(places), radius=rows_of, distance=by_distance, module=by_module, slack=slack)
    curved = programme.count
    if wanted.module_mm is not None:
        for sign in (1.0, -1.0):
            miss = np.array([sign / wanted.module_mm])
            below(np.array([sign]), module=miss, slack=np.array([-1.0]))
    most_axis = 0.0 if wanted.fixed_axis else most_mm
    for sign in (1.0, -1.0):
        below(sign * r + most_mm, radius=sign * b0)
        below(sign * curve.axis_mm + most_axis, axis=sign * np.eye(2))
        if mate:
            assert place is not None
            most_scale = 0.0 if mate.fixed_size else most_mm / mate.outline.size_mm
            below(sign * place.axis_mm + most_mm, mate_axis=sign * np.eye(2))
            below(np.array([sign * place.turned_rad + most_mm / distance]), mate_turn=np.array([sign]))
            below(np.array([sign * place.scale + most_scale]), mate_scale=np.array([sign]))
            if mate.axis_mm is not None:
                # The axis in the pair's size is that of the drawing.
                below(np.zeros(2), mate_axis=sign * np.eye(2), mate_scale=-sign * mate.axis_mm)
    below(np.zeros(1), slack=np.array([-1.0]))
    if wanted.greatest:
        linear[begins["greatest"]] = outline.size_mm / 64.0
        most = max(weight for *_, weight in followed)
        for sign in (1.0, -1.0):
            for columns, aim, weight in followed:
                by = sign * weight / most
                part = {name: by * rows for name, rows in columns.items()}
                below(by * aim, **part, greatest=np.full(aim.size, -1.0))
    form, rows, bound = sparse.csc_matrix(np.triu(square)), programme.matrix(size), programme.bound
    found = curve
    for _ in range(2):
        # The second time with the same slopes and the values of the curve that was found: a second-order correction.
        unknowns = _unknowns(found, widths)
        bound[:curved] = rows[:curved] @ unknowns - _values(found, limits)
        solved = _solved(form, linear, rows, bound, unknowns)
        values = {name: solved[begin : begin + widths[name]] for name, begin in begins.items()}
        if mate:
            turned, scale = float(values["mate_turn"][0]), float(values["mate_scale"][0])
            place = MatePlace(values["mate_axis"], turned, scale)
        found = Rolled(curve.basis, values["radius"], values["axis"], float(values["distance"][0]), curve.teeth, place)
    return found


def _values(curve: Rolled, limits: CurveLimits) -> Array:
    """How far the mate is from closing and the module from the length, and the values of all conditions."""
    return np.concatenate(
        [[np.mean(curve.turned) - 1.0, 0.0], *(condition.value for condition in conditions(curve, limits))]
    )


def _unknowns(curve: Rolled, widths: Mapping[str, int]) -> Array:
    """The unknowns of a curve, without slack, in the order of ``widths``."""
    known: dict[str, Array | float] = {"radius": curve.coefficients, "axis": curve.axis_mm}
    known |= {"distance": curve.center_distance_mm, "module": curve.module_mm}
    if (place := curve.mate_place) is not None:
        known |= {"mate_axis": place.axis_mm, "mate_turn": place.turned_rad, "mate_scale": place.scale}
    return np.concatenate([np.broadcast_to(known.get(name, 0.0), width) for name, width in widths.items()])
