"""Driving angles at which pictures mark the joints of a law."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.ratio.transmission import Transmission


def joints_up_to(transmission: Transmission, end_rad: float) -> Array:
    """Where the law's pieces meet up to a driving angle, the seam between periods too; none if it is of one piece."""
    starts = [piece.start_rad for piece in transmission.pieces]
    if len(starts) == 1:
        return np.empty(0)
    period = transmission.lobes.driving_period_rad
    cycles = np.arange(round(end_rad / period)) * period
    repeated: Array = (cycles[:, None] + np.array(starts)).ravel()
    return repeated[1:]
