"""Many laws by harmonics of their ratio at once, sampled over the driven angle.

Equations as in ``ratio/laws/harmonic.py``.  All is smooth in the driven angle phi2, and the linkage knows its dead
centres there, so the pieces are cut by it.
"""

from __future__ import annotations

from math import log, pi

import numpy as np

from ncgear.machine.linkage import Linkages
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integration, shares
from ncgear.optimum.makeable.quantities import Place, Slider, acceleration, velocity
from ncgear.ratio.transmission import Lobes
from ncgear.screening.samples import Samples, repeated

PIECES = 4
"""Equal pieces of the working stroke, and of the return."""


def harmonic_samples(cosine: Array, sine: Array, linkage: Linkages[Array], lobes: Lobes, count: int) -> Samples:
    """Laws of coefficients of shape (n, harmonics) at ``count`` points a piece.

    The linkages (shape (n,)) must all have the first one's working angle, as those without offset have.
    """
    phi2, width = _angles(float(linkage.working_angle_rad[0]), count)
    at = _places(cosine, sine, lobes, phi2, width)
    everywhere = np.broadcast_to(phi2, at.log.shape)
    motion = repeated(linkage, phi2.size).displacement(Jet.variable(everywhere.ravel(), 2))
    displacement, first, second = (motion.derivative(k).reshape(everywhere.shape) for k in (0, 1, 2))
    slider = Slider(first, second, third=0.0, force_n=0.0)
    there = np.ones(everywhere.shape[:2], dtype=bool)
    return Samples(
        at,
        velocity(at, slider, 1.0),
        acceleration(at, slider, 1.0),
        displacement[:, :PIECES],
        np.broadcast_to(width[:, None], everywhere.shape),
        there,
        there[:, 0],
    )


def _angles(working_rad: float, count: int) -> tuple[Array, Array]:
    """phi2 at the points of the pieces, shape (p, count), and the pieces' widths, shape (p,)."""
    width = np.repeat([working_rad / PIECES, (2.0 * pi - working_rad) / PIECES], PIECES)
    return (np.cumsum(width) - width)[:, None] + width[:, None] * shares(count), width


def _places(cosine: Array, sine: Array, lobes: Lobes, phi2: Array, width: Array) -> Place:
    """ln i12 with two derivatives by phi2, closed: the mean of i12 over phi2 is that of one turn over the other."""
    wave = np.arange(1.0, cosine.shape[1] + 1.0) * lobes.driven
    turned = wave[:, None] * phi2.ravel()
    in_phase, quarter_on = np.cos(turned), np.sin(turned)
    rows = (
        cosine @ in_phase + sine @ quarter_on,
        (wave * sine) @ in_phase - (wave * cosine) @ quarter_on,
        -((wave**2 * cosine) @ in_phase + (wave**2 * sine) @ quarter_on),
    )
    series, first, second = (row.reshape(-1, *phi2.shape) for row in rows)
    mean = (np.exp(series) @ integration(phi2.shape[1])[-1]) @ width / (2.0 * pi)
    log_ratio = series + (log(lobes.driven / lobes.driving) - np.log(mean))[:, None, None]
    return Place(log_ratio, np.exp(log_ratio), np.exp(-log_ratio), first, second)
