"""A law of transmission as a table, for solvers that ask for it at single angles."""

from __future__ import annotations

from math import ceil

import numpy as np

from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.periodic_table import PeriodicTable, quintics
from ncgear.ratio.transmission import Piece, Transmission

INTERVALS = 2048
"""Intervals of the table in a period; quintics then miss the shipped laws by 1e-13 rad or less
(tests/test_periodic_table.py)."""


def law_table(transmission: Transmission) -> PeriodicTable:
    """The driven angle in rad over a period of the driving angle, exact with two derivatives at all joints."""
    lobes = transmission.lobes
    parts = [_piece(piece, lobes.driving_period_rad / INTERVALS) for piece in transmission.pieces]
    # A second pair's law begins at 0 but for rounding, and no angle may lie before all intervals.
    inner = np.concatenate([knots[:-1] for knots, _ in parts])[1:]
    breaks = np.concatenate([[0.0], inner, [lobes.driving_period_rad]])
    return PeriodicTable(breaks, np.concatenate([table for _, table in parts], axis=1), lobes.driven_period_rad)


def _piece(piece: Piece, step_rad: float) -> tuple[Array, Array]:
    count = ceil((piece.end_rad - piece.start_rad) / step_rad) + 1
    knots = distinct(np.append(np.linspace(piece.start_rad, piece.end_rad, count), piece.knots_rad))
    angle = piece.driven_angle(knots, 2)
    values = [angle.value, angle.derivative(1), angle.derivative(2)]
    return knots, quintics(np.diff(knots), [value[:-1] for value in values], [value[1:] for value in values])
