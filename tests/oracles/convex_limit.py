"""The least acceleration as a convex programme, solved by an interior-point solver.

Unknowns are q = (dphi2/dphi1)^2 at even crank angles.  With u = (omega x')^2 q / 2, the kinetic energy of a unit mass,
the mean acceleration of a cell is the difference of u over that of x; time is the integral of 1 / sqrt(q), written with
a second-order cone for each place and each cell.  Scaled so that the stroke and the cycle's time are one.
"""

from __future__ import annotations

from math import pi

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

FloatArray = NDArray[np.float64]


def displacement(crank_mm: float, rod_mm: float, angle: FloatArray) -> FloatArray:
    """Of the slider of an in-line crank, from its retracted end."""
    beside = np.sqrt(rod_mm**2 - (crank_mm * np.sin(angle)) ** 2)
    return crank_mm * (1.0 - np.cos(angle)) + beside - rod_mm


def speed_per_rad(crank_mm: float, rod_mm: float, angle: FloatArray) -> FloatArray:
    """Its derivative by the crank angle."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return crank_mm * sine - crank_mm**2 * sine * cosine / np.sqrt(rod_mm**2 - (crank_mm * sine) ** 2)


def least_acceleration(
    crank_mm: float,
    rod_mm: float,
    force_n: FloatArray,
    power_w: float,
    omega: float,
    ratios: tuple[float, float],
) -> float:
    """In mm/s^2; ``force_n`` at even crank angles over a whole turn, an odd number, zero in the return."""
    angle = np.linspace(0.0, 2.0 * pi, force_n.size)
    x = displacement(crank_mm, rod_mm, angle) / (2.0 * crank_mm)
    turning = np.abs(speed_per_rad(crank_mm, rod_mm, angle)) / (2.0 * crank_mm) * 2.0 * pi
    turning[[0, angle.size // 2, -1]] = 0.0
    force = np.where(force_n > 0.0, force_n, 1e-300)
    by_power = power_w * 1000.0 / force / (2.0 * crank_mm) * (2.0 * pi / omega)
    highest = np.minimum(turning / ratios[0], by_power) ** 2 / 2.0
    lowest = (turning / ratios[1]) ** 2 / 2.0
    return _solved(np.abs(np.diff(x)), highest, lowest) * 2.0 * crank_mm * (omega / (2.0 * pi)) ** 2


def _solved(lengths: FloatArray, highest: FloatArray, lowest: FloatArray) -> float:
    """Variables: acceleration, u (n + 1), speeds b with b^2 <= 2 u (n + 1), times t with t (b + b') >= 2 h (n)."""
    n = lengths.size
    u, b, t = 1 + np.arange(n + 1), n + 2 + np.arange(n + 1), 2 * n + 3 + np.arange(n)
    size = 3 * n + 3
    rows: list[tuple[dict[int, float], float]] = []
    for i, length in enumerate(lengths.tolist()):
        rows.append(({u[i + 1]: 1.0 / length, u[i]: -1.0 / length, 0: -1.0}, 0.0))
        rows.append(({u[i + 1]: -1.0 / length, u[i]: 1.0 / length, 0: -1.0}, 0.0))
    rows.extend(({u[i]: 1.0}, top) for i, top in enumerate(highest.tolist()))
    rows.extend(({u[i]: -1.0}, -bottom) for i, bottom in enumerate(lowest.tolist()))
    rows.append((dict.fromkeys(t.tolist(), 1.0), 1.0))
    linear = len(rows)
    for i in range(n + 1):  # (1 + 2 u)/2 >= |((1 - 2 u)/2, b)|
        rows.extend([({u[i]: -1.0}, 0.5), ({u[i]: 1.0}, 0.5), ({b[i]: -1.0}, 0.0)])
    for i, length in enumerate(lengths.tolist()):  # (t + v)/2 >= |((t - v)/2, sqrt(2 h))|, v = b + b'
        sums = {b[i]: -0.5, b[i + 1]: -0.5}
        rows.append(({t[i]: -0.5, **sums}, 0.0))
        rows.append(({t[i]: -0.5, b[i]: 0.5, b[i + 1]: 0.5}, 0.0))
        rows.append(({}, float(np.sqrt(2.0 * length))))
    entries = [(row, column, value) for row, (terms, _) in enumerate(rows) for column, value in terms.items()]
    at, column, value = zip(*entries, strict=True)
    matrix = sparse.csc_matrix((value, (at, column)), shape=(len(rows), size))
    cones = [clarabel.NonnegativeConeT(linear), *[clarabel.SecondOrderConeT(3)] * (2 * n + 1)]
    goal = np.zeros(size)
    goal[0] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    limits = np.array([limit for _, limit in rows])
    solution = clarabel.DefaultSolver(sparse.csc_matrix((size, size)), goal, matrix, limits, cones, settings).solve()
    if "Solved" not in str(solution.status):
        raise ArithmeticError(str(solution.status))
    return float(solution.obj_val)
