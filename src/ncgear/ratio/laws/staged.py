"""A law shared over two pairs in series: ln i12 = ln iA + ln iB, both as series over the crank's angle phi2.

    ln i12 = f(phi2),   ln iB = g(phi2),   ln iA = f - g

The second pair, iB, drives the crank: by its own driven angle its ratio is a series as it stands.  The first pair's
driven angle is that of the shaft between, phim = integral of exp(g) dphi2, which comes round with the crank.  With
t = phi2, dphim/dphi1 = exp(g - f) and dt/dphi1 = exp(-f), constants that close both included.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.harmonic import NODES_PER_KNOT, HarmonicLaw, along, closed_harmonics
from ncgear.ratio.train import Pair, Train
from ncgear.ratio.transmission import Lobes, Piece, Transmission


@dataclass(frozen=True, eq=False)
class StagedLaw:
    """The whole law and that of the second pair, one lobe each."""

    whole: HarmonicLaw
    second: HarmonicLaw

    def shaft_angle(self, phi1: Array, order: int) -> Jet:
        """phim in rad with derivatives by phi1, at driving angles of one turn in rad, shape (n,)."""
        turned = self.whole.driven_angle(phi1, 0).value
        values = self.second.integral.at(turned)
        if not order:
            return Jet(values[None, :])
        speed = self.whole.speed(turned, order - 1)
        return along(values, speed / self.second.speed(turned, order - 1), speed)

    def shaft_speed(self, phim: Array) -> Array:
        """Speed of the shaft between over that of the driving shaft, at its own angles in rad, shape (n,)."""
        turned = self.second.driven_angle(np.mod(phim, 2.0 * pi), 0).value
        speed: Array = self.whole.speed(turned, 0).value / self.second.speed(turned, 0).value
        return speed

    @property
    def first(self) -> Transmission:
        """The first pair's law phim(phi1)."""
        return Transmission((Piece(0.0, 2.0 * pi, self.shaft_angle, self._knots_rad),), Lobes())

    @property
    def _knots_rad(self) -> tuple[float, ...]:
        """Driving angles at the nodes of the finer series."""
        nodes = max(self.whole.integral.nodes, self.second.integral.nodes, key=len)
        return tuple(self.whole.integral.at(nodes[NODES_PER_KNOT:-1:NODES_PER_KNOT]).tolist())

    @property
    def train(self) -> Train:
        """Both pairs."""
        pairs = Pair(self.first, np.ones_like), Pair(self.second.transmission, self.shaft_speed)
        return Train(self.whole.transmission, pairs)


def staged_law(cosine: Array, sine: Array, second_cosine: Array, second_sine: Array) -> StagedLaw:
    """The law of f's coefficients and g's, from the first harmonic on, shape (n,) each, lengths of their own.

    Raises WrongInput for coefficients that are not finite and NoSuchMechanism where a ratio's range is beyond 1e6; keys
    ``motion.cosine``, ``motion.second_stage.cosine`` and the like.
    """
    return StagedLaw(
        closed_harmonics(cosine, sine, Lobes()),
        closed_harmonics(second_cosine, second_sine, Lobes(), "motion.second_stage"),
    )
