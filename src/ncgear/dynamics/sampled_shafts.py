"""Demands on the driving shafts of many laws on one mechanism, with masses, from samples of the laws.

Inertia and weights load the crank by functions of its angle alone: M, M'/2 and U' of ``dynamics.crank_load``.  They are
Fourier series, tabled as Taylor series about even angles.  With i = dphi1/dphi2, s = 1/i and f = ln i,

    driving torque = s (w^2 s^2 (M'/2 - M f') + U') + load times dx/dphi1,   primes by phi2
"""

from __future__ import annotations

from math import factorial, pi

import numpy as np

from ncgear.dynamics.crank_load import of_crank_angle
from ncgear.dynamics.driving_shaft import counted
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.sampled import Functions, Sought, extremes, integrated, integration
from ncgear.numerics.units import N_M_PER_N_MM, N_PER_KG_MM_S2

ANGLES = 1024
"""Even crank angles from whose values the Fourier series is made."""

DIED_AWAY = 1e-13
"""Share of the largest coefficient, or value, under which the last eighth of a series, or its last term, must lie."""

NODES, TERMS = 16384, 5
"""Even angles of the table, a power of two, and terms of the Taylor series about each."""


@dataclass(frozen=True, eq=False)
class CrankTable:
    """M'/2 and M in N mm s^2, and U' in N mm, as Taylor series, shape (TERMS, 3, NODES).

    They are NaN where a series has not died away, since results would be uncertain.
    """

    series: Array

    def torque_n_mm(self, crank_rad: Array, slope: Array, first: Array, speed_rad_s: Array) -> Array:
        """Torque of masses and weights on the driving shaft, for s and f' at crank angles, shape (..., n)."""
        place = np.rint(crank_rad * (NODES / (2.0 * pi)))
        beyond, node = crank_rad - place * (2.0 * pi / NODES), place.astype(np.intp) & (NODES - 1)
        values = self.series[-1].take(node, axis=1)
        for term in self.series[-2::-1]:
            values *= beyond
            values += term.take(node, axis=1)
        turned = speed_rad_s * slope
        torque: Array = slope * (turned * turned * (values[0] - values[1] * first) + values[2])
        return torque


def crank_table(linkage: Mechanism, masses: Masses) -> CrankTable:
    """The table of a mechanism with its masses."""
    even = np.linspace(0.0, 2.0 * pi, ANGLES, endpoint=False)
    inertia, change, weight = of_crank_angle(linkage, masses, even)
    rows = np.stack([change * (N_PER_KG_MM_S2 / 2.0), inertia * N_PER_KG_MM_S2, weight.derivative(1)])
    waves = np.fft.rfft(rows) * (NODES / ANGLES)
    order = 1j * np.arange(waves.shape[1])
    series = np.stack([np.fft.irfft(waves * order**term, NODES) / factorial(term) for term in range(TERMS)])
    sizes, last = np.abs(waves), np.abs(series[-1]).max(axis=1) * (pi / NODES) ** (TERMS - 1)
    rest = sizes[:, -ANGLES // 16 :].max(axis=1) > DIED_AWAY * sizes.max(axis=1)
    unsure = rest | (last > DIED_AWAY * np.abs(series[0]).max(axis=1))
    return CrankTable(np.where(unsure[:, None], np.nan, series))


def torque_figures(torque: Functions, turning: Array, there: Mask, speed_rad_s: Array) -> dict[str, Array]:
    """The figures of power of ``kinematics.check`` but the mean by their keys, shape (n,) each, from torques in N mm.

    ``turning`` is the driving angle per share of a piece, of the torques' shape; ``there`` (shape (p, n)) marks the
    pieces that count.
    """
    cycle_rad = integrated(turning)
    mean, square = (integrated(values * turning) / cycle_rad for values in (torque.values, torque.values**2))
    inner = integration(turning.shape[1]) @ ((mean - torque.values) * turning)
    stored = Functions(inner + (np.cumsum(inner[:, -1:], axis=0) - inner[:, -1:]))
    sought = [Sought(of, there, (sign,)) for of in (torque, stored) for sign in (1.0, -1.0)]
    most, least, full, empty = extremes(sought)
    watts = N_M_PER_N_MM * speed_rad_s
    return {
        "peak_power_w": np.maximum(most, 0.0) * watts,
        "braking_power_w": counted(np.maximum(least, 0.0), -least, most) * watts,
        "rms_torque_n_m": np.sqrt(square) * N_M_PER_N_MM,
        "energy_swing_j": counted(full + empty, -least, most) * N_M_PER_N_MM,
    }
