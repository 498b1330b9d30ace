"""The functions that an interior-point method needs, assembled from a small function of a single place.

A ratio at a place depends on four coefficients of its spline, and every row is a sum of terms local to places.  The
terms at one place, with their first and second derivatives by casadi, therefore give all sparse matrices: the entries
are the values of the small function at all places, times constant matrices that are made once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi
import numpy as np
from scipy import sparse

from ncgear.frozen import dataclass
from ncgear.optimum.makeable.levels import WishLevel
from ncgear.optimum.makeable.quantities import RatioPlace, Slider
from ncgear.optimum.makeable.rows import ProgrammeRows, WholeLaw, closing_terms, level_terms
from ncgear.optimum.makeable.spline import NEAR, SplineRows

LOCAL = 3
"""Of a ratio at a place: its logarithm, and the first two derivatives of that by the crank's angle."""


@dataclass(frozen=True, eq=False)
class LocalTerms:
    """Terms at one place, and all entries of their first and second derivatives that are not always zero.

    ``values`` and ``slopes`` are casadi functions of the variables at a place and of the slider there.  The variables
    are those of the ratios (3 per pair), then those of the whole law on which terms depend.  ``bends`` also takes
    weights of the terms, and derives their weighted sum twice.  ``of_slopes`` names the entries by term and variable,
    ``of_bends`` by two variables, shape (2, entries).  ``counts`` are the numbers of every level's terms.
    """

    counts: Sequence[int]
    values: Any
    slopes: Any
    bends: Any
    of_slopes: Any
    of_bends: Any


def local_terms(levels: Sequence[WishLevel], pairs: int) -> LocalTerms:
    """The terms of levels, and the terms that close the turn."""
    ratio = [casadi.SX.sym("ratio", LOCAL) for _ in range(pairs)]
    length = [casadi.SX.sym("length") for _ in range(pairs)]
    data = casadi.SX.sym("slider", len(Slider._fields))
    whole = _Symbols()
    at = [RatioPlace(f, casadi.exp(f), casadi.exp(-f), *rates) for f, *rates in map(casadi.vertsplit, ratio)]
    terms = level_terms(levels, at, Slider(*casadi.vertsplit(data)), length, whole)
    every = casadi.vertcat(*(term for own in terms for term in own), *closing_terms(at))
    angle = [whole.angle_rad] if any(level.order is not None for level in levels) else []
    variables, weights = (
        casadi.vertcat(*ratio, *length, *whole.unknowns, *angle),
        casadi.SX.sym("weights", every.shape[0]),
    )
    slopes = casadi.jacobian(every, variables)
    bends = casadi.triu(casadi.hessian(casadi.dot(weights, every), variables)[0])
    return LocalTerms(
        [len(own) for own in terms],
        casadi.Function("terms", [variables, data], [every]),
        casadi.Function("slopes", [variables, data], [_entries(slopes)]),
        casadi.Function("bends", [variables, data, weights], [_entries(bends)]),
        np.array(slopes.sparsity().get_triplet(), dtype=int),
        np.array(bends.sparsity().get_triplet(), dtype=int),
    )


class _Symbols(WholeLaw):
    """Variables of the whole law as symbols, in the order in which terms ask for them."""

    def __init__(self) -> None:
        self.unknowns: list[Any] = []
        self.angle_rad = casadi.SX.sym("angle")

    def mean_of(self, term: Any) -> Any:
        """A new symbol."""
        self.unknowns.append(casadi.SX.sym("unknown"))
        return self.unknowns[-1]

    def fitted(self, term: Any, waves: Sequence[Any]) -> list[Any]:
        """New symbols."""
        return [self.mean_of(term) for _ in waves]

    def size_of(self, square: Any, cycle_rad: float) -> Any:
        """A new symbol."""
        return self.mean_of(square)

    def wave(self, angle_rad: Any) -> tuple[Any, Any]:
        """Cosine and sine."""
        return casadi.cos(angle_rad), casadi.sin(angle_rad)


def _entries(matrix: Any) -> Any:
    """Entries of a sparse matrix that can differ from zero, as a column."""
    return matrix[matrix.sparsity()].nz[:]


@dataclass(frozen=True, eq=False)
class _Combined:
    """A sparse matrix whose entries are constant, or constant combinations of local entries."""

    sparsity: Any
    combining: Any
    fixed: Any

    def matrix(self, local: Any) -> Any:
        """The matrix from all local entries, shape (entries, places)."""
        return casadi.MX(self.sparsity, casadi.mtimes(self.combining, casadi.vec(local)) + self.fixed)


def _combined(row: Any, column: Any, source: Any, weight: Any, fixed: Any, sources: int) -> _Combined:
    """A matrix with local entries ``source``, times ``weight``, at (row, column), and the entries of ``fixed``."""
    height, width = fixed.shape
    own, always = column.astype(np.int64) * height + row, fixed.col.astype(np.int64) * height + fixed.row
    places, which = np.unique(np.concatenate([own, always]), return_inverse=True)
    combining = sparse.csc_matrix((weight, (which[: own.size], source)), shape=(places.size, sources))
    starts = np.searchsorted(places, np.arange(width + 1, dtype=np.int64) * height)
    sparsity = casadi.Sparsity(height, width, starts.tolist(), (places % height).tolist())
    constant = np.bincount(which[own.size :], fixed.data, places.size)
    return _Combined(sparsity, casadi.DM(combining), casadi.DM(constant))


@dataclass(frozen=True, eq=False)
class Assembly:
    """Splines at all places of rows, and the rows' local terms."""

    local: LocalTerms
    rows: ProgrammeRows
    basis: SplineRows
    knots: int
    pairs: int

    @property
    def _places(self) -> int:
        return self.rows.at.count

    @property
    def _splines(self) -> int:
        """Number of coefficients, which are the first variables."""
        return self.pairs * self.knots

    @property
    def variables(self) -> int:
        """Number of all variables: coefficients, then variables of the whole law."""
        return self._splines + self.rows.wholes

    def _reach(self, variable: Any, place: Any) -> tuple[Any, Any]:
        """Which variables a variable at a place depends on, and how strongly: columns and weights, shape (n, 4)."""
        of_spline = variable < LOCAL * self.pairs
        orders = np.stack([self.basis.value, self.basis.first, self.basis.second])
        spline = self.basis.columns[place] + (variable // LOCAL * self.knots)[:, None]
        number = variable - LOCAL * self.pairs
        if self.rows.first_angle is not None:
            number = np.where(number == self.rows.columns.first_level, self.rows.first_angle + place, number)
        whole = np.full((variable.size, NEAR), self._splines) + number[:, None]
        once = np.array([1.0, 0.0, 0.0, 0.0])
        return (
            np.where(of_spline[:, None], spline, whole),
            np.where(of_spline[:, None], orders[variable % LOCAL, place], once),
        )

    def _slopes(self, local_rows: Any, whole_rows: Any) -> _Combined:
        term, variable = self.local.of_slopes
        place = local_rows.col // self.rows.terms
        row, source, each, weight = [], [], [], []
        for entry in range(term.size):
            own = np.nonzero(local_rows.col % self.rows.terms == term[entry])[0]
            row.append(local_rows.row[own])
            weight.append(local_rows.data[own])
            source.append(place[own] * term.size + entry)
            each.append(np.full(own.size, variable[entry]))
        rows, sources, weights = np.concatenate(row), np.concatenate(source), np.concatenate(weight)
        columns, reach = self._reach(np.concatenate(each), sources // term.size)
        there = reach != 0.0
        fixed = sparse.coo_matrix(
            (whole_rows.data, (whole_rows.row, whole_rows.col + self._splines)), (self.rows.count, self.variables)
        )
        return _combined(
            np.repeat(rows, NEAR)[there.ravel()],
            columns[there],
            np.repeat(sources, NEAR)[there.ravel()],
            (weights[:, None] * reach)[there],
            fixed,
            term.size * self._places,
        )

    def _bends(self) -> _Combined:
        """The second derivatives of the rows' weighted sum, the upper triangle."""
        first, second = self.local.of_bends
        place, entry = (each.ravel() for each in np.indices((self._places, first.size)))
        row, of_row = self._reach(first[entry], place)
        column, of_column = self._reach(second[entry], place)
        weight = of_row[:, :, None] * of_column[:, None, :]
        source = np.broadcast_to((place * first.size + entry)[:, None, None], weight.shape)
        rows, columns = (np.broadcast_to(each, weight.shape) for each in (row[:, :, None], column[:, None, :]))
        mixed = np.broadcast_to((first != second)[entry][:, None, None], weight.shape)
        # An entry of two different variables stands on both sides of the diagonal
        both = [
            (rows, columns, (rows <= columns) & (weight != 0.0)),
            (columns, rows, (columns <= rows) & (weight != 0.0) & mixed),
        ]
        parts = [(one[inside], other[inside], source[inside], weight[inside]) for one, other, inside in both]
        one, other, inner, weights = (np.concatenate(each) for each in zip(*parts, strict=True))
        nothing = sparse.coo_matrix((self.variables, self.variables))
        return _combined(one, other, inner, weights, nothing, first.size * self._places)

    def problem(self, levels: int) -> tuple[dict[str, Any], dict[str, Any]]:
        """The programme for casadi, with the prices of levels and excess as parameters, and its derivatives."""
        local_rows, whole_rows, constants = self.rows.matrices()
        x, p = casadi.MX.sym("x", self.variables), casadi.MX.sym("p", levels + 1)
        first = self._splines + self.rows.columns.first_level
        priced, terms = x[first : first + levels + 1], self.rows.terms
        at = self._at_places(x)
        values = self._mapped(self.local.values, at)
        by_rows = casadi.DM(sparse.csc_matrix(local_rows))
        by_whole = casadi.DM(sparse.csc_matrix(whole_rows))
        rows = casadi.mtimes(by_rows, casadi.vec(values)) + casadi.mtimes(by_whole, x[self._splines :]) + constants
        slopes = self._slopes(local_rows, whole_rows).matrix(self._mapped(self.local.slopes, at))
        price, of_rows = casadi.MX.sym("lam_f"), casadi.MX.sym("lam_g", self.rows.count)
        weights = casadi.reshape(casadi.mtimes(by_rows.T, of_rows), terms, self._places)
        bends = self._bends().matrix(self._mapped(self.local.bends, at, weights))
        problem = {"x": x, "p": p, "f": casadi.dot(p, priced), "g": rows}
        given = {
            "jac_g": casadi.Function("jac_g", [x, p], [rows, slopes], ["x", "p"], ["g", "jac_g_x"]),
            "hess_lag": casadi.Function(
                "hess_lag", [x, p, price, of_rows], [bends], ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]
            ),
        }
        return problem, given

    def _at_places(self, x: Any) -> Any:
        """Variables at all places, shape (variables at a place, places)."""
        every = np.arange(LOCAL * self.pairs)
        variable, place = np.tile(every, self._places), np.repeat(np.arange(self._places), every.size)
        columns, weights = self._reach(variable, place)
        splines = sparse.csc_matrix(
            (weights.ravel(), (np.repeat(np.arange(variable.size), NEAR), columns.ravel())),
            (variable.size, self._splines),
        )
        local = casadi.mtimes(casadi.DM(splines), x[: self._splines])
        wholes = x[self._splines : self._splines + self.rows.columns.first_level]
        at = [casadi.reshape(local, every.size, self._places), casadi.repmat(wholes, 1, self._places)]
        if self.rows.first_angle is not None:
            first = self._splines + self.rows.first_angle
            at.append(x[first : first + self._places].T)
        return casadi.vertcat(*at)

    def _mapped(self, function: Any, at: Any, *more: Any) -> Any:
        data = casadi.DM(np.vstack(self.rows.at.slider))
        return function.map(self._places)(at, data, *more)
